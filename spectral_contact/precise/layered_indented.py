r"""Normal contact through a nonlinear layer in fixed point: the overclosure at the nodes.

The equation is ``w + N p(w) = (delta - h - w0)/a`` on the disk of radius a, where w0 is the
overclosure at which the pressure begins, the `origin` of the law, and w counts from it, over a. It
is solved by Newton's method: the residual has all digits, the correction comes from a matrix in
doubles. If the contact has an edge, a multiple of ``dw/ddelta`` is added so that w is zero there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import ConvergenceError
from spectral_contact.layers import Layer
from spectral_contact.precise.fixed import DoubleFactors, Ints
from spectral_contact.precise.indented_rough import DiskInParts, RoughContact, RoughIndented
from spectral_contact.precise.layer_laws import Law, law_of
from spectral_contact.profiles import Flat, Profile
from spectral_contact.threads import cached_property

_MOST_SWEEPS = 30
#: Each of so many first corrections has a matrix of its own; later ones keep the last of these.
_ANEW = 3


@dataclass(frozen=True)
class InitialContact:
    """A contact in double precision, where Newton's method starts.

    Attributes
    ----------
    radius, approach : float
    pressure : callable
        Takes distances from the edge over the radius.
    thin : float
        The layer's compliance at the largest pressure, where it is least.
    cuts : tuple of float
        If there is no edge: the radii at which the disk is cut into parts. Else empty.
    """

    radius: float
    approach: float
    pressure: Callable[[NDArray[np.float64]], Any]
    thin: float
    cuts: tuple[float, ...] = ()


@dataclass(frozen=True)
class LayeredContact(RoughContact):
    """A contact on a nonlinear layer; `values` are those of the overclosure.

    Attributes
    ----------
    compression : Law
    edged : bool
        Whether the contact has an edge at which overclosure and pressure are zero.
    """

    compression: Law
    edged: bool

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii over a, whose distances to the edge are given, too."""
        overclosures = super().pressures(s, from_edge)
        law = np.frompyfunc(lambda w: self.compression.pressure(w * self.radius), 1, 1)
        return law(overclosures)

    @property
    def _vanishes(self) -> bool:
        return self.edged

    def margins(self) -> tuple[Any, Any]:
        """Return the least overclosure inside, and the least gap, outside over the approach.

        The overclosure has the sign of the pressure; it is over the radius and the mean pressure.
        Under a law with pressure at every gap neither has to be positive: 1 stands for both.
        """
        if self.compression.gapless:
            return self.fixed.mp.one, self.fixed.mp.one
        return super().margins()

    @property
    def _approach_of_gap(self) -> Any:
        """The approach, counted from where the layer begins to carry."""
        return self.approach - self.compression.origin


@dataclass(frozen=True)
class _Fields:
    """The solution at the nodes, with lengths over the radius.

    Attributes
    ----------
    overclosure, rate, slope : ndarray of int
        w, ``dw/ddelta`` and ``dp/dw``.
    more : int
        What the approach is more than on a smooth surface.
    """

    overclosure: Ints
    more: Any
    rate: Ints
    slope: Ints


class LayeredIndented(RoughIndented):
    """Contacts of a profile on a nonlinear layer.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    start : InitialContact
    digits, width
        As of `RoughIndented`.
    """

    def __init__(
        self, profile: Profile, layer: Layer, start: InitialContact, digits: int, width: float
    ) -> None:
        self._start = start
        super().__init__(profile, start.thin, start.radius, digits, width)
        self._law = law_of(self.fixed.mp, layer)
        self._edged = not (isinstance(profile, Flat) or start.cuts)
        #: overclosures of the last contact that was solved, and the matrix of N
        self._w: Ints | None = None
        self._normal: NDArray[np.float64] | None = None

    def _panels(self, radius: float, width: float) -> list[tuple[int, int]]:
        """Return the number of panels in the inner and the outer half of every part."""
        if self._start.cuts:
            return [(1, 1)] * (len(self._start.cuts) + 1)
        return super()._panels(radius, width)

    @cached_property
    def _breaks(self) -> list[Any]:
        if self._start.cuts:
            return [self.fixed.mp.mpf(one) for one in self._start.cuts]
        return self.heights.breaks[: len(self._meshes) - 1]

    def solve(self, given: Any) -> RoughContact:
        """Return the contact of a radius; of an approach under a flat punch or without an edge.

        Raises
        ------
        ConvergenceError
            If the iteration stalls.
        """
        f = self.fixed
        mp = self.fixed.mp
        law = self._law
        radius = given if self._edged else mp.mpf(self._start.radius)
        places = DiskInParts(f, self._meshes, radius, self._breaks)
        h = self._heights_at(places, radius)
        smooth = self.heights.transform(+radius) / 2 if self._edged else given - law.origin
        # the overclosure if nothing gave way
        room = np.concatenate([f.over(f.of(smooth) - v, f.of(radius)).ravel() for v in h])
        fields = self._newton(places, radius, room)
        w = fields.overclosure
        rate = fields.rate
        delta = smooth + law.origin + radius * f.numbers(fields.more)
        pressure_rate = self._split(places, f.times(fields.slope, rate))
        own = self._split(places, w)
        at = f.numbers(w) * radius
        pressure = np.frompyfunc(law.pressure, 1, 1)(at)
        p = self._split(places, f.of(pressure))
        stored = self._split(places, f.of(np.frompyfunc(law.energy, 1, 1)(at)))
        # p times the displacement of the body, whose integral is twice the elastic energy
        elastic = [
            f.times(v, f.over(f.of(delta - law.origin) - z, f.of(radius)) - u)
            for v, z, u in zip(p, h, own, strict=True)
        ]
        energy = places.integral(stored) + radius * places.integral(elastic) / 2
        growth = mp.zero
        if self._edged:
            growth = self._growth(places, own[-1], self._split(places, rate)[-1])
        return LayeredContact(
            f,
            places,
            tuple(mesh.series(v) for mesh, v in zip(self._meshes, own, strict=True)),
            tuple(own),
            tuple(places.half(p)),
            self.heights,
            radius,
            delta,
            2 * mp.pi * radius**2 * places.integral(p),
            2 * mp.pi * radius * places.integral(pressure_rate),
            2 * mp.pi * radius**2 * energy,
            growth,
            places.size,
            law,
            self._edged,
        )

    def _started(self, places: DiskInParts, radius: Any, room: Ints) -> Ints:
        """Return overclosures at the nodes from the contact in double precision."""
        f = self.fixed
        rests = [f.floats(y) for y in places.y]
        p = np.concatenate(
            [self._start.pressure(y / (1.0 + np.sqrt(1.0 - y))).ravel() for y in rests]
        )
        assert self._normal is not None
        more = 0.0  # as in `_Fields`
        if self._edged:
            more = self._start.approach - float(self._law.origin)
            more = (more - float(self.heights.transform(+radius)) / 2.0) / float(radius)
        return np.asarray(f.of(f.floats(room) + more - self._normal @ p))

    def _factored_at(self, w: Ints, radius: Any) -> DoubleFactors:
        """Factor Newton's matrix at overclosures."""
        assert self._normal is not None
        slope = np.frompyfunc(self._law.slope, 1, 1)(self.fixed.numbers(w) * radius) * radius
        matrix = self._normal * np.array(slope, dtype=float)
        matrix[np.diag_indices(len(matrix))] += 1.0
        return DoubleFactors(matrix)

    def _newton(self, places: DiskInParts, radius: Any, room: Ints) -> _Fields:
        """Return the solution at the nodes, and its derivative by the approach."""
        f = self.fixed
        law = self._law
        edge = self._meshes[-1]
        if self._normal is None:
            self._normal = places.matrix()
        w = self._started(places, radius, room) if self._w is None else self._w
        goal = 10.0 ** -(self.digits + 2)
        share = 0 * f.one  # what is added to the approach, over the radius
        one = 0 * room + f.one

        def limit(values: Ints) -> Any:
            """Return the value at the edge."""
            return edge.limits(self._split(places, values)[-1])[1]

        def image(p: Ints) -> Ints:
            """Return ``N p``."""
            half = places.half(self._split(places, p))
            return np.concatenate([v.ravel() for v in places.normal(half)])

        def applied(function: Any, values: Ints) -> Ints:
            """Return a function of the law at overclosures in units of the radius."""
            numbers = f.numbers(values) * radius
            return np.asarray(f.of(np.frompyfunc(function, 1, 1)(numbers)))

        for sweep in range(_MOST_SWEEPS):
            if sweep < _ANEW:
                factored = self._factored_at(w, radius)
            step = factored.corrected(f, room + share - w - image(applied(law.pressure, w)))
            if self._edged:
                rate = factored.corrected(f, one)
                more = -f.over(limit(w + step), limit(rate))
                share = share + more
                step = step + f.times(more, rate)
            w = w + step
            if self._relative_step(places, step, w) <= goal:
                break
        else:
            raise ConvergenceError(
                f"Newton's method stalls before {self.digits} digits", "ask for fewer digits"
            )
        self._w = w
        slope = applied(lambda v: law.slope(v) * radius, w)
        rate = factored.corrected(f, one)
        for _ in range(_MOST_SWEEPS):
            step = factored.corrected(f, one - rate - image(f.times(slope, rate)))
            rate = rate + step
            if self._relative_step(places, step, rate) <= goal:
                return _Fields(w, share, rate, slope)
        raise ConvergenceError(
            f"refinement stalls before {self.digits} digits", "ask for fewer digits"
        )
