r"""Friction under a growing contact, by superposition of flat punches over the contact radius.

Without elastic coupling the load ``P(b)`` at every contact radius ``b`` is that of normal contact,
and while the load grows the rates of the traction are those of a flat punch of this radius (docs:
profiles). So with flat solutions on panels in ``u = ln b``, interpolated between Chebyshev points,

    q(r) = int q*(r/b; alpha/b, beta/b, f) dP/b^2,      Q = int Q* dP,      c(b) = b c*.

It holds as long as slip reaches the edge and ``c`` does not fall, which is checked at every radius.
Below the radius where slip begins everything sticks; panels are graded to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.errors import NotComputedError
from spectral_contact.fields.series import Radius
from spectral_contact.solution import Solution
from spectral_contact.spectral.jacobi import chebyshev_interpolation, gauss_rule
from spectral_contact.threads import cached_property

__all__ = ["Growth", "Panel", "Stage", "grown"]

Array = NDArray[np.float64]
#: Of a contact radius: the load, and the solution of a flat punch.
Stage = Callable[[float], tuple[float, Solution]]

#: Radii on a panel.
_COUNT = 10
_NODES: Array = chebyshev_interpolation(_COUNT)[0][::-1]
_FIT: Array = chebyshev_interpolation(_COUNT)[1][:, ::-1]
_BARYCENTRIC: Array = np.array(
    [(-1.0) ** j * math.sin(math.pi * (2 * j + 1) / (2 * _COUNT)) for j in range(_COUNT)]
)
#: Widths of panels in u; the first beyond the onset of slip, and by how much they grow.
_WIDTH, _AT_ONSET, _RATIO = 1.3, 3e-4, 3.5
#: What panels may leave out, of the tolerance, as there are some tens; they are not halved below.
_MARGIN, _SHORTEST = 0.02, 1e-4
#: By how much a stick radius may fall, as its own error may make it.
_FALL = 1e-8
#: Where the convergence of the fields over the radius is looked at, in the stuck disk.
_LOOKS: Array = np.array([0.1, 0.5, 0.8, 0.95, 0.999])


@dataclass(frozen=True)
class Panel:
    """Stages at Chebyshev points between two radii.

    Attributes
    ----------
    low, high : float
        Logarithms of the radii.
    loads : ndarray
        Logarithms of the loads.
    flats : tuple of Solution
    """

    low: float
    high: float
    loads: Array
    flats: tuple[Solution, ...]

    def local(self, u: Array) -> Array:
        """Return the places in [-1, 1]."""
        share = (u - self.low) / (self.high - self.low)
        return np.asarray(np.clip(2.0 * share - 1.0, -1.0, 1.0), dtype=np.float64)

    @cached_property
    def slips(self) -> bool:
        """Whether there is slip."""
        return len(self.flats[0].zones) > 1

    @cached_property
    def stick(self) -> Array:
        """``ln c*`` of the stages."""
        return np.array([math.log(_stick_radius(one).value) for one in self.flats])

    @cached_property
    def shears(self) -> Array:
        """``Q*`` of the stages."""
        return np.array([one.total_shear for one in self.flats])

    def log_load(self, t: Array) -> Array:
        """Return ``ln P``."""
        return np.asarray(chebyshev.chebval(t, _FIT @ self.loads))

    def increment(self, t: Array) -> Array:
        """Return ``dP/du``."""
        return np.asarray(np.exp(self.log_load(t)) * self.rate(self.loads, t))

    def rate(self, values: Array, t: Array) -> Array:
        """Return the derivative in ``u`` of what has these values in the stages."""
        slope = chebyshev.chebval(t, chebyshev.chebder(_FIT @ values))
        return np.asarray(slope * 2.0 / (self.high - self.low))

    def log_stick(self, t: Array) -> Array:
        """Return ``ln c*``."""
        return np.asarray(chebyshev.chebval(t, _FIT @ self.stick))

    def weights(self, t: Array) -> Array:
        """Return the weights of the stages in the interpolant, (points, stages)."""
        away = t[:, None] - _NODES
        away[away == 0.0] = 1e-300
        weights = _BARYCENTRIC / away
        return np.asarray(weights / weights.sum(axis=1, keepdims=True))

    def traction(self, t: Array, d: Array) -> Array:
        """Return ``q*`` where sticks, at ``1 - (s/c*)**2 = d``."""
        found, inside = np.zeros(len(t)), np.sqrt(1.0 - d)
        for weight, one in zip(self.weights(t).T, self.flats, strict=True):
            c = _stick_radius(one)
            s = c.value * inside
            from_edge = c.from_edge + c.value * d / (1.0 + inside)
            found += weight * _traction(one, s, from_edge)
        return found

    def pressure(self, t: Array, s: Array, from_edge: Array) -> Array:
        """Return ``p*``."""
        found = np.zeros(len(t))
        for weight, one in zip(self.weights(t).T, self.flats, strict=True):
            assert one.pressure_field is not None
            found += weight * one.pressure_field(s, from_edge)
        return found

    @cached_property
    def shear_error(self) -> float:
        """How much the interpolants of load and shear leave out, relative to the largest shear."""
        size = max(float(np.abs(self.shears).max()), 1e-300)
        return max(_left_out(self.loads), _left_out(self.shears) / size)

    @cached_property
    def error(self) -> float:
        """The same of everything, relative to the largest of what is interpolated."""
        d = 1.0 - _LOOKS**2
        values = np.array([self.traction(np.full(len(d), t), d) for t in _NODES])
        size = max(float(np.abs(values).max()), 1e-300)
        of_field = max(_left_out(column) for column in values.T) / size
        of_stick = _left_out(self.stick) if self.slips else 0.0
        return max(self.shear_error, of_stick, of_field)


def _left_out(values: Array) -> float:
    """Return the estimate of what an interpolant leaves out: its last two terms, decaying on."""
    terms = np.abs(_FIT @ values)
    last, before = float(terms[-2:].max()), float(terms[-4:-2].max())
    return last * min(last / before, 1.0) if before > 0.0 else last


def _stick_radius(flat: Solution) -> Radius:
    zone = flat.zones[0]
    return Radius(zone.outer, zone.outer_from_edge)


def _traction(flat: Solution, s: Array, from_edge: Array) -> Array:
    field = flat.traction_field
    return np.zeros(len(s)) if field is None else field(s, from_edge)


@dataclass(frozen=True)
class Growth:
    """The history of a contact.

    Attributes
    ----------
    panels : tuple of Panel
        From where the load is negligible to today.
    onset : float or None
        Radius at which slip begins; 0 if there is slip from the first touch, None if there is none.
    radius : float
        Today's contact radius.
    """

    panels: tuple[Panel, ...]
    onset: float | None
    radius: float

    @cached_property
    def total_shear(self) -> float:
        """``Q = int Q* dP``."""
        g, w = gauss_rule(2 * _COUNT)
        first = self.panels[0]
        # before the first panel there is next to no load
        total = first.flats[0].total_shear * math.exp(first.log_load(np.array([-1.0]))[0])
        for one in self.panels:
            shear = chebyshev.chebval(g, _FIT @ one.shears)
            total += (one.high - one.low) / 2.0 * float(w @ (shear * one.increment(g)))
        return float(total)

    @cached_property
    def shear_error(self) -> float:
        """Estimate of the relative error of the shear."""
        worst = max((one.shear_error * self._share(one) for one in self.panels), default=0.0)
        return len(self.panels) * worst + 2.0 * self._of_flats("total_shear", "approach")

    @cached_property
    def stick_rate(self) -> float:
        """``dln c*/dln b`` today."""
        last = self.panels[-1]
        return abs(float(last.rate(last.stick, np.ones(1))[0])) if last.slips else 0.0

    @cached_property
    def shear_rate(self) -> float:
        """``dln Q/dln b`` today."""
        last = self.panels[-1]
        rate = float(last.increment(np.ones(1))[0]) * last.shears[-1]
        return abs(rate / self.total_shear) if self.total_shear else 0.0

    @cached_property
    def error(self) -> float:
        """Estimate of the error of the traction, relative to its largest value."""
        worst = max((one.error * self._share(one) for one in self.panels), default=0.0)
        flats = self._of_flats("traction", "pressure")
        return len(self.panels) * worst + 2.0 * flats

    def _share(self, panel: Panel) -> float:
        return _share(panel, self.radius, self.panels[-1].loads[-1])

    def _of_flats(self, *names: str) -> float:
        errors = [one.error for panel in self.panels for one in panel.flats]
        return max(getattr(error, name) or 0.0 for error in errors for name in names)

    @cached_property
    def stages(self) -> list[tuple[float, float]]:
        """Contact radii ``b`` with the stick radii ``c(b)``."""
        return [
            (b := math.exp(float(u)), b * math.exp(float(stick)))
            for one in self.panels
            for u, stick in zip(
                one.low + (one.high - one.low) * (1.0 + _NODES) / 2.0, one.stick, strict=True
            )
        ]


def _share(panel: Panel, radius: float, log_load: float) -> float:
    """Return what a panel contributes to load or traction at most, relative to all of it."""
    load = math.exp(panel.loads[-1] - log_load)
    return load * max(1.0, math.exp(2.0 * (math.log(radius) - panel.high)))


def grown(
    stage: Stage,
    radius: float,
    load: float,
    least: float,
    onset: float | None,
    tolerance: float,
) -> Growth:
    """Return the history of a contact.

    Parameters
    ----------
    stage : callable
        Of a contact radius: its load, and a flat punch's solution.
    radius, load : float
        Today's.
    least : float
        Where the load is negligible.
    onset : float or None
        As of `Growth`.
    tolerance : float
        Panels are halved until what they leave out is less, relative to all.

    Raises
    ------
    NotComputedError
        If slip does not reach the edge at some radius, or the stick radius falls.
    """
    todo, panels = list(_ends(least, radius, onset))[::-1], []
    while todo:
        low, high = todo.pop()
        panel = _panel(stage, low, high)
        off = panel.error * _share(panel, radius, math.log(load))
        if off > _MARGIN * tolerance and high - low > _SHORTEST:
            middle = (low + high) / 2.0
            todo += [(middle, high), (low, middle)]
        else:
            panels.append(panel)
    found = Growth(tuple(panels), onset, radius)
    _check(found)
    return found


def _panel(stage: Stage, low: float, high: float) -> Panel:
    radii = np.exp(low + (high - low) * (1.0 + _NODES) / 2.0).tolist()
    pairs = [stage(b) for b in radii]
    kinds = [[zone.kind for zone in flat.zones] for _, flat in pairs]
    for b, kind in zip(radii, kinds, strict=True):
        if kind not in (["stick"], ["stick", "slip"]) or kind != kinds[0]:
            told = f"at the contact radius {b:.6g} slip does not simply reach the edge"
            raise NotComputedError("traction", f"{told}: it takes increments of the load")
    return Panel(low, high, np.log([load for load, _ in pairs]), tuple(flat for _, flat in pairs))


def _ends(least: float, radius: float, onset: float | None) -> Iterator[tuple[float, float]]:
    """Yield the ends of the first panels, which grow away from the onset of slip."""
    low, high = math.log(least), math.log(radius)
    cuts = [low, high]
    if onset is not None and least < onset < radius:
        step, steps = _AT_ONSET, [math.log(onset)]
        while steps[-1] + step < high:
            steps.append(steps[-1] + step)
            step = min(step * _RATIO, _WIDTH)
        cuts = [low, *steps, high]
    for start, stop in pairwise(cuts):
        count = max(math.ceil((stop - start) / _WIDTH), 1)
        for k in range(count):
            yield start + (stop - start) * k / count, start + (stop - start) * (k + 1) / count


def _check(growth: Growth) -> None:
    """Raise if what has stuck would slip again."""
    for (_, before), (b, after) in pairwise(growth.stages):
        if after < before * (1.0 - _FALL):
            told = f"the stick radius falls at the contact radius {b:.6g}"
            raise NotComputedError("traction", f"{told}: what has stuck slips again")
