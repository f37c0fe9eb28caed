r"""Normal and tangential contact as one symmetric system: elastic coupling.

With ``p`` and ``q = s u`` the tractions change each other's displacement by

    <phi, int_s^1 q deta> = <s psi, g[p]> = 1/4 int_0^1 phi(y) int_0^y psi(y') dy' dy

in the measure ``s ds`` and in ``y = 1 - s**2``: no kernel is left, and what lies on different
panels couples by the product of its moments. The system of both equations is the stiffness of an
elastic body, hence symmetric and positive definite. As in `galerkin`, the first-kind parts cancel
in it, and a correction with the residual taken in the half-integral, where nothing cancels,
restores what that loses: stick asks for

    F = 2 delta + kappa (2 int_0^1 q ds - t^2 R_u),    G = kappa R_p

with ``R_f(t) = (2/t) int_0^t s f ds / sqrt(t^2 - s^2)``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import tail_values
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.cholesky import Cholesky
from spectral_contact.spectral.galerkin import Change, DiskOperators, disk_operators
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values
from spectral_contact.spectral.panels import LogPanels

__all__ = [
    "CoupledFactored",
    "CoupledSpace",
    "Pair",
    "coupled_space",
    "inner_moments",
    "moments",
    "outer_moments",
    "tail_rule",
    "unit_masses",
]

Array = NDArray[np.float64]

_SPACES: BoundedCache[tuple[LogPanels, float, tuple[int, ...]], CoupledSpace] = BoundedCache(
    "coupled spaces", 12
)
_MOMENTS: BoundedCache[LogPanels, Array] = BoundedCache("moments", 48)
_MASSES: BoundedCache[tuple[LogPanels, tuple[int, ...]], tuple[Array, Array]] = BoundedCache(
    "masses", 32
)
_OUTER: BoundedCache[tuple[LogPanels, LogPanels, int], Array] = BoundedCache("outer moments", 24)
#: Gauss points on a tail, whose polynomials in ``d`` they integrate exactly.
_TAIL_POINTS = 12


@dataclass(frozen=True, slots=True)
class Pair:
    """Coefficients of a pressure and of a traction over s, zero outside their space."""

    normal: Array
    tangential: Array

    def times(self, factor: float) -> Pair:
        """Return both multiplied by a number."""
        return Pair(factor * self.normal, factor * self.tangential)

    def plus(self, other: Pair) -> Pair:
        """Return the sum."""
        return Pair(self.normal + other.normal, self.tangential + other.tangential)


def coupled_space(panels: LogPanels, power: float, degrees: tuple[int, ...]) -> CoupledSpace:
    """Return the space of a pressure and a traction on panels of these degrees (cached).

    Parameters
    ----------
    panels : LogPanels
        Of the pressure, with its endpoint weight.
    power : float
        Endpoint weight of the traction.
    degrees : tuple of int
        Highest degree of both on each panel.
    """

    def assembled() -> CoupledSpace:
        other = replace(panels, power=power)
        return CoupledSpace(disk_operators(panels), disk_operators(other), degrees)

    return _SPACES.get((panels, power, degrees), assembled)


def moments(panels: LogPanels) -> Array:
    """Return ``int_0^1 psi dy`` of all functions, shape (size,) (cached)."""
    return _MOMENTS.get(panels, lambda: _moments(panels))


def _moments(panels: LogPanels) -> Array:
    offsets, weights, basis = _panel_rule(panels)
    first = (weights * np.exp(-(1.0 + panels.power) * offsets)) @ basis
    fall = np.exp(-(1.0 + panels.power) * panels.width * np.arange(panels.panels))
    d, tail_weights, tail = tail_rule(panels)
    deepest = (tail_weights * d**panels.power) @ tail
    return np.concatenate([np.outer(fall, first).ravel(), deepest])


def inner_moments(panels: LogPanels, inner: LogPanels) -> Array:
    """Return ``int_0^1 phi(y) int_0^y psi(y') dy' dy``, shape (size, size).

    Parameters
    ----------
    panels, inner : LogPanels
        Of phi and of psi: the same but for the endpoint weight.
    """
    terms, h = panels.degree + 1, panels.width
    # psi on a deeper panel counts whole, on a shallower one not at all
    matrix = np.outer(moments(panels), moments(inner))
    x, weights, basis = _panel_rule(panels)
    g, w = gauss_rule(len(x))
    rest = h - x
    deeper = x[:, None] + rest[:, None] * (1.0 + g) / 2.0
    values = np.exp(-(1.0 + inner.power) * deeper) * w * rest[:, None] / 2.0
    within = np.einsum("iq,iqk->ik", values, legendre_values(2.0 * deeper / h - 1.0, panels.degree))
    own = (basis * (weights * np.exp(-(1.0 + panels.power) * x))[:, None]).T @ within
    fall = np.exp(-(2.0 + panels.power + inner.power) * h * np.arange(panels.panels))
    for j in range(panels.panels):
        rows = slice(j * terms, (j + 1) * terms)
        matrix[rows, : j * terms] = 0.0
        matrix[rows, rows] = fall[j] * own
    tail = panels.panels * terms
    matrix[tail:, :tail] = 0.0
    d, weights, basis = tail_rule(panels)
    v = np.sqrt(d / panels.end)
    deeper = d[:, None] * (d / panels.end)
    # dd' = end v**2 2 v' dv', with d' = end v**2 v'**2
    _, weight, _ = tail_rule(inner)
    values = weight * v[:, None] ** 2 * deeper**inner.power
    tails = tail_values(deeper, inner.end, inner.tail_terms, inner.root_tail)
    within = np.einsum("iq,iqk->ik", values, tails)
    matrix[tail:, tail:] = (basis * (weights * d**panels.power)[:, None]).T @ within
    return matrix


def outer_moments(panels: LogPanels, other: LogPanels, sign: int) -> Array:
    """Return ``int phi int psi`` over what of psi lies outside of phi, on a part of unit extent."""

    def made() -> Array:
        deeper = inner_moments(panels, other)
        return deeper if sign < 0 else np.outer(moments(panels), moments(other)) - deeper

    return _OUTER.get((panels, other, sign), made)


def unit_masses(panels: LogPanels, degrees: tuple[int, ...]) -> tuple[Array, Array]:
    """Return ``int phi psi dd`` and ``int phi psi d dd`` of functions, on a part of unit extent."""
    columns = panels.functions(degrees)
    return _MASSES.get(
        (panels, degrees), lambda: (panels.mass(columns, 1.0, 0.0), panels.mass(columns, 0.0, 1.0))
    )


def _panel_rule(panels: LogPanels) -> tuple[Array, Array, Array]:
    """Return offsets and ``dx`` weights on the first panel, and the polynomials there."""
    g, w = gauss_rule(panels.degree + 14)
    h = panels.width
    return h * (1.0 + g) / 2.0, w * h / 2.0, legendre_values(g, panels.degree)


def tail_rule(panels: LogPanels) -> tuple[Array, Array, Array]:
    """Return distances and ``dd`` weights on the tail, and the polynomials there."""
    g, w = gauss_rule(_TAIL_POINTS)
    v = (1.0 + g) / 2.0
    d = panels.end * v**2
    values = tail_values(d, panels.end, panels.tail_terms, panels.root_tail)
    return d, w * v * panels.end, values


class CoupledSpace:
    """A space for the pressure and one for the traction, of the same degrees.

    Parameters
    ----------
    normal, tangential : DiskOperators
        Of both, on the same panels but for the endpoint weight.
    degrees : tuple of int
        Highest degree of both on each panel.
    """

    def __init__(
        self, normal: DiskOperators, tangential: DiskOperators, degrees: tuple[int, ...]
    ) -> None:
        self.normal = normal.normal.space(degrees)
        self.tangential = tangential.tangential.space(degrees)
        self.panels = normal.panels, tangential.panels
        n, kept, but_one = self.normal.unknowns, self.normal.kept, self.normal.kept_but_one
        #: both, and of both the functions of the coarser spaces first
        ranges = [range(kept), range(kept, but_one), range(but_one, n)]
        self._order = np.concatenate([np.add.outer([0, n], one).ravel() for one in ranges])
        self.kept, self.kept_but_one = 2 * kept, 2 * but_one
        coupling = inner_moments(*self.panels)[np.ix_(self.normal.index, self.tangential.index)]
        self._matrix = np.zeros((2 * n, 2 * n))
        self._matrix[:n, :n] = self.normal.gram
        self._matrix[n:, n:] = self.tangential.gram
        self._coupling = coupling / 4.0
        self._moments = moments(tangential.panels)

    @property
    def unknowns(self) -> int:
        """Number of unknowns of both."""
        return len(self._order)

    def factor(self, alpha: float, beta: float, kappa: float) -> CoupledFactored:
        """Factor the system.

        Parameters
        ----------
        alpha, beta : float
            Normal and tangential compliance, at least 0.
        kappa : float
            The coupling, in [0, 3/8].
        """
        return CoupledFactored(self, alpha, beta, kappa)

    def misfit(self, pair: Pair, kappa: float) -> tuple[Array, Array]:
        """Return what F and G miss of what stick asks for, at the nodes, for unit approach."""
        p, u = pair.normal, pair.tangential
        disks = self.normal.operator.disk, self.tangential.operator.disk
        root = np.sqrt(disks[0].nodes.rest)
        # a correction jumps between panels: its integrals are taken at the nodes, not interpolated
        wanted = 2.0 + kappa * (self._moments @ u - 2.0 * root * disks[1].outer(u))
        return (
            wanted - self.normal.half_integral(p),
            kappa * 2.0 / root * disks[0].outer(p) - self.tangential.half_integral(u),
        )

    def pair(self, values: Array) -> Pair:
        """Return values in the order of the system as coefficients."""
        natural = np.empty_like(values)
        natural[self._order] = values
        fields = []
        for space, part in zip((self.normal, self.tangential), np.split(natural, 2), strict=True):
            full = np.zeros(space.operator.panels.size)
            full[space.index] = part
            fields.append(full)
        return Pair(*fields)

    def values(self, pair: Pair) -> Array:
        """Return coefficients in the order of the system."""
        parts = pair.normal[self.normal.index], pair.tangential[self.tangential.index]
        values: Array = np.concatenate(parts)[self._order]
        return values


class CoupledFactored:
    """Full stick with coupling in one space, factored."""

    def __init__(self, space: CoupledSpace, alpha: float, beta: float, kappa: float) -> None:
        self.space = space
        self.kappa = kappa
        self.compliances = alpha, beta
        n = space.normal.unknowns
        matrix = space._matrix.copy()
        matrix[:n, :n] += alpha * space.normal.mass
        matrix[n:, n:] += beta * space.tangential.mass
        matrix[:n, n:] -= kappa * space._coupling
        matrix[n:, :n] -= kappa * space._coupling.T
        self._cholesky = Cholesky(matrix.take(space._order, 0).take(space._order, 1))

    def solve(self) -> Pair:
        """Return pressure and traction of unit approach."""
        load = 2.0 * self.space.normal.constant_moments
        return self._solved([load, np.zeros_like(load)])

    def respond(self, normal: Array, tangential: Array) -> Pair:
        """Return what solves the system for any right-hand side.

        Parameters
        ----------
        normal, tangential : ndarray, shape (size,)
            Its values on the bases of the pressure and of the traction.
        """
        space = self.space
        return self._solved([normal[space.normal.index], tangential[space.tangential.index]])

    def _solved(self, right: list[Array]) -> Pair:
        """Return the solution for right-hand sides in the orders of the two spaces."""
        return self.space.pair(self._cholesky.solve(np.concatenate(right)[self.space._order]))

    def correction(self, pair: Pair) -> Pair:
        """Return by how much a solution is off, from its residual in the half-integral."""
        space, parts = self.space, []
        for one, missed, compliance, values in zip(
            (space.normal, space.tangential),
            space.misfit(pair, self.kappa),
            self.compliances,
            (pair.normal, pair.tangential),
            strict=True,
        ):
            residual = one.moments(missed)
            if compliance != 0.0:
                residual -= compliance * (one.mass @ values[one.index])
            parts.append(residual)
        return self._solved(parts)

    def dual(self, functional: Array) -> Pair:
        """Return the dual solution of a linear functional of the traction.

        Parameters
        ----------
        functional : ndarray, shape (size,)
            Its values on the basis.
        """
        return self.respond(np.zeros_like(functional), functional)

    def change(self, pair: Pair, *, degrees: int = 2) -> tuple[Change, Change]:
        """Return what the top two degrees of every panel, or the top one, contribute.

        It is the difference to the solution without them, of the pressure and of the traction.
        """
        space = self.space
        kept = space.kept if degrees == 2 else space.kept_but_one
        shed = self._cholesky.shed(space.values(pair), kept)
        change, energies = space.pair(shed), space.pair(shed**2 * self._cholesky.diagonal)
        first, second = space.panels
        return (
            Change(change.normal, _by_panel(first, energies.normal)),
            Change(change.tangential, _by_panel(second, energies.tangential)),
        )


def _by_panel(panels: LogPanels, values: Array) -> Array:
    """Return the sums over every panel, and over the tail."""
    table = values[: -panels.tail_terms].reshape(panels.panels, -1)
    return np.append(table.sum(axis=1), values[-panels.tail_terms :].sum())
