"""Zones with given boundaries, in fixed point: the residual of the tangential equation.

The equation, that the displacement u_r is zero, is collocated at the Gauss points of the zones that
stick. What is its residual there is the displacement in the zones that slip.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log, log10, pi, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.precise.annulus_mesh import AnnulusMesh, Blocks, PreciseAnnulusSeries
from spectral_contact.precise.between import Between
from spectral_contact.precise.fixed import Fixed, Ints
from spectral_contact.spectral.parts import z_difference
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.precise.drive import PreciseDrive


Array = NDArray[np.float64]

_LN10 = log(10.0)


@dataclass(frozen=True)
class PreciseLayout:
    """What every zone does, and roughly where it ends.

    Attributes
    ----------
    states : tuple of int
        From the centre outward: 0 for stick, +1 or -1 for slip with that sign.
    radii : tuple of Radius
        The boundaries between the zones, one fewer.
    """

    states: tuple[int, ...]
    radii: tuple[Radius, ...]

    @property
    def widths(self) -> list[float]:
        """Widths of the zones in ``s**2``."""
        boundaries = [Radius(0.0, 1.0), *self.radii, EDGE]
        return [z_difference(a, b) for a, b in pairwise(boundaries)]

    def decades(self, alpha: float, beta: float, digits: int, width: float) -> float:
        """Return how many decades below 1 the last digit of the smallest number is."""
        deepest = width * max(map(max, self.panels(alpha, beta, digits, width))) / _LN10
        # a solution divides by the diagonal, beta s^2; at the innermost nodes s^2 is down to 1e-8
        # of that of the first boundary
        first = log10(self.radii[0].square) if self.radii else 0.0
        return digits + deepest + 8.0 + abs(log10(beta or 1.0)) - 2.0 * first

    def panels(self, alpha: float, beta: float, digits: int, width: float) -> list[tuple[int, int]]:
        """Return the number of panels in the inner and the outer half of every zone.

        At a distance d that is below all scales of the problem, the traction differs from its value
        at a boundary by ``d**2 ln d``, and at the edge by ``d ln d``. In slip under a pressure that
        is infinite at the edge it is a root.
        """
        widths = self.widths
        settle = (digits + 2.0) * _LN10
        log_ends = []  # logarithms of the distances at which panels end and the tail begins
        for b, near in zip(self.radii, pairwise(widths), strict=True):
            layers = beta * b.value or 1.0, b.rest + alpha
            log_ends.append(log(min(*near, *layers)) - settle / 2.0)
        rooted = alpha == 0.0 and self.states[-1] != 0
        settle *= 2.0 if rooted else 1.0
        log_ends.append(log(min(widths[-1], beta or 1.0, alpha or 1.0)) - settle)
        # at the centre the traction is smooth: the mesh is not graded to it
        pairs = pairwise([log(widths[0]), *log_ends])
        depths = [[log(w) - end for end in pair] for w, pair in zip(widths, pairs, strict=True)]
        return [(max(ceil(a / width), 1), max(ceil(b / width), 1)) for a, b in depths]

    def meshes(
        self, fixed: Fixed, alpha: float, beta: float, digits: int, width: float
    ) -> list[AnnulusMesh]:
        """Return the meshes of the zones."""
        blocks = Blocks(fixed, width, panel_points(digits, width), digits)
        return [AnnulusMesh(blocks, *n) for n in self.panels(alpha, beta, digits, width)]


@dataclass(frozen=True)
class Zones:
    """Boundaries and tractions of the stick zones.

    Attributes
    ----------
    logits : tuple of mpf
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    tractions : tuple of PreciseAnnulusSeries or None
        ``q / (kappa s)`` in every zone that sticks.
    total_shear : int
    unknowns : int
    slopes : ndarray or None
        Derivatives of `ZoneTrial.mismatch` by the logits, at tractions that solve the equation for
        each set of boundaries.
    """

    logits: tuple[Any, ...]
    tractions: tuple[PreciseAnnulusSeries | None, ...]
    total_shear: Any
    unknowns: int
    slopes: Array | None


def panel_points(digits: int, width: float) -> int:
    """Return how many nodes of a panel resolve a function whose singularities are ``i pi`` away.

    With the panel as [-1, 1] they are ``i reach`` away. Its Chebyshev series converges like the
    powers of ``reach + sqrt(1 + reach**2)``, the sum of the semi-axes of the ellipse through them.
    """
    reach = 2.0 * pi / width
    return ceil((digits + 4.0) / log10(reach + sqrt(1.0 + reach * reach))) + 4


class ZoneProblem:
    """States and meshes of the zones, and where the unknowns of each begin in a flat vector.

    Parameters
    ----------
    drive : PreciseDrive
    alpha, beta : float
        ``alpha*`` and ``beta*``.
    friction : int
        ``f / kappa`` in fixed point.
    layout : PreciseLayout
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width.
    """

    def __init__(
        self,
        drive: PreciseDrive,
        alpha: float,
        beta: float,
        friction: Any,
        layout: PreciseLayout,
        digits: int,
        width: float,
    ) -> None:
        self.drive = drive
        self.friction = friction
        self.states = layout.states
        self.digits = digits
        f = drive.fixed
        self.beta = f.of(beta)
        self.meshes = layout.meshes(f, alpha, beta, digits, width)
        self.sticking = [k for k, state in enumerate(self.states) if state == 0]
        sizes = [self.meshes[k].above.size for k in self.sticking]
        self.offsets = np.cumsum([0, *sizes])

    def split(self, flat: Any) -> dict[int, Any]:
        """Return the values in every zone that sticks."""
        pieces = zip(self.sticking, pairwise(self.offsets), strict=True)
        return {k: flat[a:b].reshape(self.meshes[k].above.shape) for k, (a, b) in pieces}

    def relative_step(self, step: Array, flat: Ints) -> float:
        """Return the largest step relative to the largest value in its zone."""
        f = self.drive.fixed
        steps = self.split(step)
        values = self.split(flat)
        return max(
            float(np.abs(steps[k]).max() / np.abs(f.floats(values[k])).max()) for k in self.sticking
        )


class _StuckEnd(NamedTuple):
    """At a boundary: the zone that sticks, the end of it (0 the inner one), and ``s / (f p)``."""

    zone: int
    end: int
    factor: Any


class ZoneTrial:
    """The problem with given boundaries.

    Parameters
    ----------
    problem : ZoneProblem
    logits : sequence of mpf
        ``ln(b**2/(1 - b**2))`` of the boundaries, outward.
    last : int, optional
        The last zone at whose nodes the equation is evaluated; by default the last that sticks.
    """

    def __init__(
        self, problem: ZoneProblem, logits: Sequence[Any], last: int | None = None
    ) -> None:
        self.problem = problem
        self.logits = logits
        f = problem.drive.fixed
        mp = problem.drive.fixed.mp
        #: logits of the ends of all zones, infinite at the centre and at the edge
        self.ends = [-mp.inf, *logits, mp.inf]
        self._f = f
        self.squares = [0 * f.one, *(f.of(1 / (1 + mp.exp(-x))) for x in logits), f.one]
        self.rests = [f.one, *(f.of(1 / (1 + mp.exp(x))) for x in logits), 0 * f.one]
        self.widths = [b - a for a, b in pairwise(self.squares)]
        zones = list(zip(problem.meshes, self.widths, strict=True))
        self.z = [s + f.times(w, m.above) for (m, w), s in zip(zones, self.squares, strict=False)]
        self.y = [r + f.times(w, m.below) for (m, w), r in zip(zones, self.rests[1:], strict=True)]
        self.slip = {k: state * self.bound(k) for k, state in enumerate(problem.states) if state}
        self.last = problem.sticking[-1] if last is None else last
        self._loads: dict[int, Ints] = {}

    def bound(self, zone: int) -> Ints:
        """Return ``f p / (kappa s)`` at the nodes of a zone, the bound of ``|q| / (kappa s)``."""
        f = self._f
        p = self.problem.drive.pressure(self.y[zone])
        return np.asarray(f.over(f.times(self.problem.friction, p), f.sqrt(self.z[zone])))

    def load(self, zone: int) -> Ints:
        """Return ``int_0^s p s ds`` at the nodes of a zone."""
        if zone not in self._loads:
            self._loads[zone] = self.problem.drive.load_inside(self.y[zone])
        return self._loads[zone]

    @cached_property
    def between(self) -> dict[tuple[int, int], Between]:
        """The operators that integrate over one zone at the nodes of another."""
        meshes = self.problem.meshes
        return {
            (a, b): Between(
                meshes[a],
                meshes[b],
                (self.widths[a], self.widths[b]),
                self.squares[b] - self.squares[a + 1],
            )
            for a in range(self.last + 1)
            for b in range(a + 1, len(meshes))
        }

    def residual(self, flat: Ints) -> Ints:
        """Return the residual of the equation at the nodes of the zones that stick."""
        left = self.displacement(self.problem.split(flat), self.problem.sticking)
        return np.concatenate([left[k].ravel() for k in self.problem.sticking])

    def displacement(self, sticking: dict[int, Ints], wanted: Sequence[int]) -> dict[int, Ints]:
        """Return ``s u_r / kappa = s (beta q + T q - kappa g) / kappa`` at the nodes of zones.

        Parameters
        ----------
        sticking : dict of int to ndarray
            ``q / (kappa s)`` at the nodes of the zones that stick.
        wanted : sequence of int
            Zones, up to `last`.
        """
        f = self._f
        problem = self.problem
        values = {**self.slip, **sticking}
        inner = []
        for k in range(max(wanted) + 1):
            total = f.times(f.sqrt(self.widths[k]), problem.meshes[k].half_integral(values[k]))
            for b in range(k + 1, len(problem.states)):
                total = total + self.between[k, b].half_integral(values[b])
            inner.append(f.times(f.sqrt(self.z[k]), total))
        result = {}
        for k in wanted:
            total = f.times(f.sqrt(self.widths[k]), problem.meshes[k].inner_integral(inner[k]))
            for a in range(k):
                total = total + self.between[a, k].inner_integral(inner[a])
            own = f.times(problem.beta, self.z[k], values[k])
            result[k] = own + f.over(total, f.of(f.mp.pi)) - self.load(k)
        return result

    def mismatch(self, flat: Ints) -> Ints:
        """Return the jumps of the traction at the boundaries, over f p."""
        f = self._f
        values = self.problem.split(flat)
        limits = {k: self.problem.meshes[k].limits(v) for k, v in values.items()}
        # one of two neighbours sticks, with the state 0; the state of the other, which slips, is
        # the sign of the traction at their boundary
        senses = [a + b for a, b in pairwise(self.problem.states)]
        found = [
            f.times(factor, limits[k][end]) - sense * f.one
            for (k, end, factor), sense in zip(self._stuck_ends, senses, strict=True)
        ]
        return np.array(found, dtype=object)

    @cached_property
    def _stuck_ends(self) -> list[_StuckEnd]:
        """The ends of zones that stick, one at each boundary."""
        f = self._f
        problem = self.problem
        p = problem.drive.pressure(np.array(self.rests[1:-1], dtype=object))
        factors = f.over(f.sqrt(np.array(self.squares[1:-1])), f.times(problem.friction, p))
        return [
            _StuckEnd(j + 1, 0, factor) if problem.states[j] else _StuckEnd(j, 1, factor)
            for j, factor in enumerate(factors)
        ]

    def conditions(self) -> Array:
        """Return the derivative of the mismatch by the unknowns in double precision."""
        f = self._f
        problem = self.problem
        rows = np.zeros((len(self._stuck_ends), problem.offsets[-1]))
        for row, (k, end, factor) in zip(rows, self._stuck_ends, strict=True):
            limit = problem.meshes[k].blocks.limit
            values = problem.split(row)[k]
            values[-end] = f.floats(f.times(factor, limit[::-1] if end else limit))
        return rows

    def matrix(self) -> Array:
        """Return the matrix of the residual in double precision."""
        f = self._f
        problem = self.problem
        matrix = np.zeros((problem.offsets[-1],) * 2)
        parts = pairwise(problem.offsets)
        places = {k: slice(a, b) for k, (a, b) in zip(problem.sticking, parts, strict=True)}
        for k in range(self.last + 1):
            mesh = problem.meshes[k]
            own = sqrt(float(f.numbers(self.widths[k])))
            root = np.sqrt(f.floats(self.z[k])).reshape(-1, 1) / pi
            outward = [c for c in problem.sticking if c >= k]
            half = {
                c: root * (self.between[k, c].matrix() if c > k else own * mesh.matrix())
                for c in outward
            }
            for r in outward:
                inner = self.between[k, r].inner_matrix() if r > k else own * mesh.inner_matrix()
                inner = np.ascontiguousarray(inner)
                for c in outward:
                    matrix[places[r], places[c]] += inner @ half[c]
        z = np.concatenate([f.floats(self.z[k]).ravel() for k in problem.sticking])
        matrix[np.diag_indices(len(matrix))] += float(f.numbers(problem.beta)) * z
        return matrix

    def outcome(self, flat: Ints, slopes: Array | None = None) -> Zones:
        """Return the solution."""
        f = self._f
        problem = self.problem
        values = {**self.slip, **problem.split(flat)}
        shear = 0
        for k, mesh in enumerate(problem.meshes):
            density = f.times(self.widths[k], mesh.weights, f.sqrt(self.z[k]))
            shear += f.times(f.of(f.mp.pi), f.times(density, values[k]).sum())
        tractions = tuple(
            None if state else problem.meshes[k].series(values[k])
            for k, state in enumerate(problem.states)
        )
        return Zones(tuple(self.logits), tractions, shear, int(problem.offsets[-1]), slopes)
