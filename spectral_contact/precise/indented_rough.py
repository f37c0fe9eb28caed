r"""Normal contact under a profile in fixed point, collocated on parts between the profile's breaks.

On the unit disk ``(alpha/a) p + N p = (delta - h(a s))/a``, with ``N p = (1/pi) int_0^s F(t) dt /
sqrt(s^2 - t^2)`` and the half-integral F of p. It is solved for two right-hand sides, ``(D - h)/a``
and 1. The second is the flat punch. To the solution of the first a multiple of that of the second
is added, such that the sum is zero at the edge; delta is D plus a times the multiple. D is
``H(a)/2``, the approach on a smooth surface: so the multiple is small, and no digit is lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log, log10
from typing import Any

import numpy as np

from spectral_contact.errors import ConvergenceError, NotComputedError
from spectral_contact.precise.annulus_mesh import AnnulusMesh, Blocks, PreciseAnnulusSeries
from spectral_contact.precise.between import Between
from spectral_contact.precise.fixed import DoubleFactors, Fixed, Ints
from spectral_contact.precise.heights import Heights, heights
from spectral_contact.precise.zone_trial import panel_points
from spectral_contact.profiles import Profile
from spectral_contact.threads import cached_property

_LN10 = log(10.0)
#: Refinement that takes more sweeps than this has stalled.
_MOST_SWEEPS = 20
#: Largest number of nodes: a dense factorisation in double precision then takes 2 GB.
_MOST_NODES = 12000


class Contact:
    """A contact under a profile in many digits.

    Attributes
    ----------
    radius, approach, load, stiffness, work : mpf
    growth : mpf
        ``ddelta/da``.
    unknowns : int
    """

    radius: Any
    approach: Any
    load: Any
    stiffness: Any
    work: Any
    growth: Any
    unknowns: int

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii over a, whose distances to the edge are given, too."""
        raise NotImplementedError

    def margins(self) -> tuple[Any, Any]:
        """Return the least pressure inside over its mean, and the least gap over the approach.

        In a contact both are positive.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class RoughContact(Contact):
    """A contact on a layer, with values and series of the pressure and values of F."""

    fixed: Fixed
    geometry: DiskInParts
    series: tuple[PreciseAnnulusSeries, ...]
    values: tuple[Ints, ...]
    half: tuple[Ints, ...]
    heights: Heights
    radius: Any
    approach: Any
    load: Any
    stiffness: Any
    work: Any
    growth: Any
    unknowns: int

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii over a, whose distances to the edge are given, too."""
        f = self.fixed
        places = self.geometry
        s = f.of(s)
        edge_distance = f.of(from_edge)
        y = f.times(edge_distance, f.one + s)
        z = np.where((s < edge_distance).astype(bool), f.times(s, s), f.one - y)
        inside = [z >= square for square in places.squares[1:-1]]
        part_of_point = sum((v.astype(int) for v in inside), np.zeros(len(z), dtype=int))
        values = np.empty(len(z), dtype=object)
        for k in np.unique(part_of_point):
            rows = part_of_point == k
            width = places.widths[k]
            series = self.series[k]
            above = np.maximum(f.over(z[rows] - places.squares[k], width), 0)
            below = np.maximum(f.over(y[rows] - places.rests[k + 1], width), 0)
            if k < len(self.series) - 1 or not self._vanishes:
                values[rows] = series.at(above, below)
                continue
            # in the tail next to the edge the pressure is proportional to the distance: it is
            # evaluated where the tail begins, and scaled
            least = series.mesh.outer_end
            clipped = np.maximum(below, least)
            at_tail = series.at(np.where(clipped > below, f.one - least, above), clipped)
            values[rows] = f.over(f.times(at_tail, below), clipped)
        return f.numbers(values)

    @property
    def _vanishes(self) -> bool:
        """Whether the function of `series` is zero at the edge."""
        return True

    @property
    def _approach_of_gap(self) -> Any:
        """The approach less the clearance that a nonlinear layer needs to begin to carry."""
        return self.approach

    def margins(self) -> tuple[Any, Any]:
        """Return the least pressure inside over its mean, and the least gap over the approach."""
        f = self.fixed
        mp = self.fixed.mp
        mean = self.load / (mp.pi * self.radius**2)
        least = min(v.min() for v in self.values)
        return f.numbers(least) / mean, self._least_gap() / self._approach_of_gap

    def _least_gap(self) -> Any:
        """Return the least gap at some places outside the contact."""
        f = self.fixed
        mp = self.fixed.mp
        places = self.geometry
        gaps = []
        weights = [
            f.over(f.times(w, m.weights), 2 * f.sqrt(z))
            for w, m, z in zip(places.widths, places.meshes, places.z, strict=True)
        ]
        for beyond in OUTSIDE:
            square = (1 + mp.mpf(beyond)) ** 2
            far = self.fixed.of(square - 1)
            potential = sum(
                f.over(f.times(w, half), f.sqrt(far + y)).sum()
                for w, half, y in zip(weights, self.half, places.y, strict=True)
            )
            r = self.radius * mp.sqrt(square)
            if r >= self.heights.reach:
                break
            # the pressure lowers the free surface by this
            surface_displacement = f.numbers(potential) / mp.pi * self.radius
            gaps.append(self.heights.height(r) - self._approach_of_gap + surface_displacement)
        return min(gaps, default=mp.one)


@dataclass(frozen=True)
class AdhesiveContact(RoughContact):
    """A contact on a layer with adhesion."""

    @property
    def _vanishes(self) -> bool:
        return False

    def margins(self) -> tuple[Any, Any]:
        """Return one, as the pressure may be negative, and the least gap over the radius."""
        return self.fixed.mp.one, self._least_gap() / self.radius


#: Distances from the edge, over the radius, at which the gap is evaluated.
OUTSIDE = (1e-6, 1e-4, 0.01, 0.1, 0.5)


class DiskInParts:
    """The parts of the disk between breaks, in units of its radius, and integrals over them."""

    def __init__(self, f: Fixed, meshes: list[AnnulusMesh], radius: Any, breaks: list[Any]) -> None:
        self._f = f
        self.meshes = meshes
        mp = f.mp
        inner = [b / radius for b in breaks]
        self.squares = np.array([0 * f.one, *(f.of(b * b) for b in inner), f.one])
        rests = [(radius - b) * (radius + b) / radius**2 for b in breaks]
        self.rests = np.array([f.one, *(f.of(v) for v in rests), 0 * f.one])
        # factored, as the difference of two squares in fixed point loses digits of narrow parts
        ends = [mp.zero, *breaks, radius]
        widths = [(b - a) * (b + a) / radius**2 for a, b in pairwise(ends)]
        self.widths = [f.of(w) for w in widths]
        meshes_and_widths = list(zip(meshes, self.widths, strict=True))
        self.z = [
            s + f.times(w, m.above)
            for (m, w), s in zip(meshes_and_widths, self.squares[:-1], strict=True)
        ]
        self.y = [
            r + f.times(w, m.below)
            for (m, w), r in zip(meshes_and_widths, self.rests[1:], strict=True)
        ]
        self.roots = [f.sqrt(z) for z in self.z]
        sizes = np.cumsum([0, *(m.above.size for m in meshes)])
        self.slices = [slice(a, b) for a, b in pairwise(sizes)]
        self.size = int(sizes[-1])
        count = range(len(meshes))
        self._between = {
            (a, b): Between(
                meshes[a],
                meshes[b],
                (self.widths[a], self.widths[b]),
                self.rests[a + 1] - self.rests[b],
            )
            for a in count
            for b in count
            if b > a
        }

    def half(self, values: list[Ints]) -> list[Ints]:
        """Return F at the nodes."""
        f = self._f
        halves = []
        for k, mesh in enumerate(self.meshes):
            total = f.times(f.sqrt(self.widths[k]), mesh.half_integral(values[k]))
            for b in range(k + 1, len(values)):
                total = total + self._between[k, b].half_integral(values[b])
            halves.append(total)
        return halves

    def normal(self, half: list[Ints]) -> list[Ints]:
        """Return ``N p`` at the nodes from F there."""
        f = self._f
        displacements = []
        sources = [f.over(v, t) for v, t in zip(half, self.roots, strict=True)]
        for k, mesh in enumerate(self.meshes):
            within_part = mesh.inner_integral(sources[k], pole=k == 0)
            total = f.times(f.sqrt(self.widths[k]), within_part)
            for a in range(k):
                total = total + self._between[a, k].inner_integral(sources[a])
            displacements.append(f.over(total, f.of(f.mp.pi)))
        return displacements

    def matrix(self) -> Any:
        """Return the matrix of N in double precision."""
        f = self._f
        count = len(self.meshes)
        matrix = np.zeros((self.size,) * 2)
        for k, mesh in enumerate(self.meshes):
            scale = float(f.numbers(f.sqrt(self.widths[k])))
            root = np.pi * f.floats(self.roots[k]).reshape(-1, 1)
            half = {
                c: (self._between[k, c].matrix() if c > k else scale * mesh.matrix()) / root
                for c in range(k, count)
            }
            for r in range(k, count):
                inner = (
                    self._between[k, r].inner_matrix()
                    if r > k
                    else scale * mesh.inner_matrix(pole=k == 0)
                )
                for c in range(k, count):
                    matrix[self.slices[r], self.slices[c]] += inner @ half[c]
        return matrix

    def integral(self, values: list[Ints]) -> Any:
        """Return ``int . s ds`` over the disk of values at the nodes."""
        f = self._f
        total = 0
        for w, mesh, part_values in zip(self.widths, self.meshes, values, strict=True):
            total += f.times(w, f.times(mesh.weights, part_values).sum())
        return f.numbers(total) / 2


class RoughIndented:
    """Contacts of a profile on a layer, of neighbouring radii.

    Parameters
    ----------
    profile : Profile
    compliance : float
        ``alpha*``, positive.
    radius : float
        Roughly that of the contact; the meshes are made for it.
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width.
    adhesion : float
        Work of adhesion, 0 without.

    Raises
    ------
    NotComputedError
        If the profile has too many breaks for the digits.
    """

    def __init__(
        self,
        profile: Profile,
        compliance: float,
        radius: float,
        digits: int,
        width: float,
        adhesion: float = 0.0,
    ) -> None:
        self._adhesion = adhesion
        self._profile = profile
        self._compliance = compliance
        self.digits = digits
        pairs = self._panels(radius, width)
        points = panel_points(digits, width)
        nodes = points * sum(a + b + 2 for a, b in pairs)
        if nodes > _MOST_NODES:
            raise NotComputedError(
                "the reference", f"with {len(pairs) - 1} breaks it takes {nodes} unknowns"
            )
        deepest = width * max(map(max, pairs)) / _LN10
        scales = digits + deepest + 8.0 + abs(log10(compliance / radius))
        # numbers next to the centre are divided by s
        scales += width * pairs[0][0] / (2.0 * _LN10)
        f = self.fixed = Fixed(ceil((scales + 10.0) * 3.33) + 64)
        self.heights = heights(f.mp, profile)
        blocks = Blocks(f, width, points, digits)
        self._meshes = [AnnulusMesh(blocks, *pair) for pair in pairs]
        self._factored: DoubleFactors | None = None

    def _panels(self, radius: float, width: float) -> list[tuple[int, int]]:
        """Return the number of panels in the inner and the outer half of every part.

        The panels end where the terms that no polynomial has are below the digits. With the
        distance d from it, p varies next to the edge like ``d + d**2 ln d``, next to a break like
        ``1 + d + d**2 ln d``, and at the radius r under a tip like ``1 + r**n + r**(n+1) ln r``.
        Lengths are over the width of the edge layer, alpha over the radius; at the edge over the
        distance to the pole that the half-integral has beyond it, if that is less.
        """
        breaks = [b for b in self._profile.breaks if b < radius]
        inner = [0.0, *(b / radius for b in breaks), 1.0]
        widths = [(b - a) * (b + a) for a, b in pairwise(inner)]
        settle = (self.digits + 2.0) * _LN10
        layer = min(self._compliance / radius, 1.0)
        outer = [log(min(*pair, layer)) - settle / 2.0 for pair in pairwise(widths)]
        outer.append(log(min(widths[-1], layer, self._profile._to_pole(radius))) - settle)
        centre = log(widths[0])
        if self._profile.pointed:
            power = getattr(self._profile, "exponent", 1.0)
            # power of the first term that is not in the tail, a polynomial in r
            first = 2.0 if float(power).is_integer() else min(power, 2.0)
            centre = 2.0 * (log(min(inner[1], layer)) - settle / first)
        ends = [(centre, outer[0]), *pairwise(outer)]
        depths = [[log(w) - end for end in pair] for w, pair in zip(widths, ends, strict=True)]
        return [(max(ceil(a / width), 1), max(ceil(b / width), 1)) for a, b in depths]

    @cached_property
    def _breaks(self) -> list[Any]:
        return self.heights.breaks[: len(self._meshes) - 1]

    def solve(self, radius: Any) -> RoughContact:
        """Return the contact of a radius.

        Raises
        ------
        ConvergenceError
            If refinement stalls.
        """
        f = self.fixed
        mp = self.fixed.mp
        places = DiskInParts(f, self._meshes, radius, self._breaks)
        alpha = f.of(self._compliance / radius)
        if self._factored is None:
            matrix = places.matrix()
            matrix[np.diag_indices(len(matrix))] += float(f.numbers(alpha))
            self._factored = DoubleFactors(matrix)
        smooth = self.heights.transform(+radius) / 2
        h = self._heights_at(places, radius)
        ones = [0 * z + f.one for z in places.z]
        flat, _ = self._refined(places, alpha, ones)
        p, multiple = self._refined(
            places, alpha, [f.over(f.of(smooth) - v, f.of(radius)) for v in h], flat
        )
        approach = smooth + f.numbers(multiple) * radius
        growth = self._growth(places, p[-1], flat[-1])
        kind = RoughContact
        if self._adhesion:  # the pressure at the edge is the suction
            suction = mp.sqrt(2 * mp.mpf(self._adhesion) / mp.mpf(self._compliance))
            pull = f.over(f.of(suction), self._meshes[-1].limits(flat[-1])[1])
            p = [v - f.times(pull, one) for v, one in zip(p, flat, strict=True)]
            approach -= f.numbers(pull) * radius
            kind = AdhesiveContact
        flat_load = 2 * mp.pi * places.integral(flat)
        load = 2 * mp.pi * radius**2 * places.integral(p)
        # half of p times the displacement delta - h
        density = [f.times(v, f.of(approach) - w) for v, w in zip(p, h, strict=True)]
        work = mp.pi * radius**2 * places.integral(density)
        return kind(
            f,
            places,
            tuple(mesh.series(v) for mesh, v in zip(self._meshes, p, strict=True)),
            tuple(p),
            tuple(places.half(p)),
            self.heights,
            radius,
            approach,
            load,
            radius * flat_load,
            work,
            growth,
            places.size,
        )

    def _heights_at(self, places: DiskInParts, radius: Any) -> list[Ints]:
        """Return the heights at the nodes."""
        f = self.fixed
        mp = self.fixed.mp
        of_z = np.frompyfunc(
            lambda z: f.of(self.heights.height(radius * mp.sqrt(f.numbers(z)))), 1, 1
        )
        return [of_z(z) for z in places.z]

    def _growth(self, places: DiskInParts, last: Ints, rate: Ints) -> Any:
        """Return ``ddelta/da``.

        The pressure, or the overclosure, is zero at the edge: `last` has its values on the last
        part, and `rate` those of its derivative by delta at a fixed radius.
        """
        f = self.fixed
        mesh = self._meshes[-1]
        ends = f.one - mesh.outer_end, mesh.outer_end
        near = mesh.series(last).at(*(np.array([v], dtype=object) for v in ends))[0]
        edge_slope = f.over(near, f.times(places.widths[-1], mesh.outer_end))
        return 2 * f.numbers(edge_slope) / f.numbers(mesh.limits(rate)[1])

    def _refined(
        self, places: DiskInParts, alpha: Any, right: list[Ints], flat: list[Ints] | None = None
    ) -> tuple[list[Ints], Any]:
        """Return the pressure of a right-hand side.

        If `flat` is given, the pressure of the right-hand side 1, a multiple of it is added so that
        the sum is zero at the edge. The multiple is returned, too.
        """
        f = self.fixed
        factored = self._factored
        edge = self._meshes[-1]
        assert factored is not None
        right_side = np.concatenate([v.ravel() for v in right])
        p = 0 * right_side
        residual = right_side
        multiple = 0 * f.one
        flat_vector = 0 * right_side
        if flat is not None:
            flat_vector = np.concatenate([v.ravel() for v in flat])
            flat_edge = edge.limits(flat[-1])[1]
        goal = 10.0 ** -(self.digits + 2)
        for _ in range(_MOST_SWEEPS):
            step = factored.corrected(f, residual)
            if flat is not None:
                last = self._split(places, p + step)[-1]
                change = -f.over(edge.limits(last)[1], flat_edge)
                multiple = multiple + change
                step = step + f.times(change, flat_vector)
            p = p + step
            if self._relative_step(places, step, p) <= goal:
                return self._split(places, p), multiple
            half = places.half(self._split(places, p))
            image = np.concatenate([v.ravel() for v in places.normal(half)])
            residual = right_side + multiple - f.times(alpha, p) - image
        raise ConvergenceError(
            f"refinement stalls before {self.digits} digits", "ask for fewer digits"
        )

    def _split(self, places: DiskInParts, vector: Ints) -> list[Ints]:
        """Return the values on every part from those of all nodes in one vector."""
        parts = zip(self._meshes, places.slices, strict=True)
        return [vector[own].reshape(mesh.above.shape) for mesh, own in parts]

    def _relative_step(self, places: DiskInParts, step: Ints, p: Ints) -> float:
        """Return the largest step relative to the largest value in its cell."""
        f = self.fixed
        largest = 0.0
        for a, b in zip(self._split(places, step), self._split(places, p), strict=True):
            pairs = zip(np.abs(a).max(axis=1), np.abs(b).max(axis=1) + 1, strict=True)
            largest = max(largest, *(float(f.numbers(f.over(v, w))) for v, w in pairs))
        return largest
