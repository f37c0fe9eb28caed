r"""Full stick with elastic coupling: the traction acts back on the pressure.

    alpha p + N p - kappa int_s^1 q deta = delta,    beta q + T q - kappa g = 0,

one symmetric positive definite system for both, for unit load. Under a thin layer, and on a smooth
surface always, both tractions oscillate near the edge, and the pressure would be negative in
places: there the contact would open. What is returned solves the equations as they stand, in which
the surfaces cannot part; `CoupledStick.opening` says where they would.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, atanh, ceil, exp, inf, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_parts import LEADING, leading_depth, root_error
from spectral_contact.contact.ratio import AT_ONE_PLACE, largest_ratio
from spectral_contact.contact.refine import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.resolution import (
    ROUNDING,
    TRACTION_ROUNDING,
    decay_rates,
    expected_error,
    panel_of,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields.series import EDGE, DiskSeries, LogSeries, PressureField
from spectral_contact.spectral.coupled import CoupledFactored, CoupledSpace, Pair, coupled_space

__all__ = ["CoupledStick", "solve_coupled_stick"]

Array = NDArray[np.float64]

#: At the centre, where q/s is weakly determined, it rounds by so much more than without coupling.
_CENTRE = 5.0
#: Most corrections, and what share of its step the first one leaves; measured.
_CORRECTIONS, _LEFT = 6, 0.01
#: Distances below this are no place that `Solution` can be asked about.
_CLOSEST = 1e-300


@dataclass(frozen=True, slots=True)
class CoupledStick:
    """Solution of the coupled full-stick problem for unit load.

    Attributes
    ----------
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    pressure : PressureField or None
        ``p*``; None if only the two above were wanted, as with what follows.
    traction : DiskSeries or None
        ``q*``.
    opening : float or None
        Distance from the edge within which the pressure changes sign; None if it is positive.
    edge_ratio : float or None
        ``q/p`` at the edge; None where it has no limit or no meaning.
    critical : float
        The largest ``|q|/p``; infinite where the pressure changes sign.
    approach_error, shear_error, pressure_error, traction_error : float
        Estimates of relative errors. Those of the fields are pointwise, of p and of q/s; where
        one of the two changes sign they are relative to the root of the sum of both squares, in
        which the traction's has the pressure times kappa.
    edge_error, critical_error : float
        Estimates of the relative errors of the two ratios.
    """

    approach: float
    total_shear: float
    approach_error: float
    shear_error: float
    pressure: PressureField | None = None
    traction: DiskSeries | None = None
    opening: float | None = None
    edge_ratio: float | None = None
    critical: float = inf
    pressure_error: float = inf
    traction_error: float = inf
    edge_error: float = 4.0 * ROUNDING
    critical_error: float = 4.0 * ROUNDING

    @property
    def slips_inside(self) -> bool:
        """Whether slip begins away from the edge."""
        return self.edge_ratio is not None and self.edge_ratio < self.critical


class _CoupledProblem:
    """Spaces for the coupled problem; pointwise, or for approach and shear alone."""

    def __init__(
        self, alpha: float, beta: float, kappa: float, tolerance: float, *, pointwise: bool
    ) -> None:
        self.alpha, self.beta, self.kappa = alpha, beta, kappa
        self.tolerance = tolerance
        self.pointwise = pointwise
        self.smooth = alpha == 0.0 == beta
        # without compliance the edge singularity y**(-1/2) is in the basis
        self.powers = tuple(-0.5 if c == 0.0 else 0.0 for c in (alpha, beta))
        self.layers = [-log(min(c, 1.0)) for c in (alpha, beta) if c > 0.0]
        self.leading = leading_depth(alpha, beta, 1.0)

    def start(self) -> Resolution:
        # on a smooth surface the end of the panels is felt like exp(-x), and there is no layer
        layer = max(self.layers, default=LEADING if self.pointwise else -log(self.tolerance) / 2.0)
        # one compliance alone: the field under it has a square root at the edge
        rate = 0.5 if len(self.layers) == 1 else 1.0
        # the error of approach and shear is the square of that of the fields
        tolerance = self.tolerance if self.pointwise else sqrt(self.tolerance)
        return starting_resolution(
            layer, tolerance, rate=rate, power=self.powers[0], bends=tuple(self.layers)
        )

    def attempt(self, resolution: Resolution) -> Attempt[CoupledStick]:
        space = coupled_space(resolution.panels, self.powers[1], resolution.degrees)
        factored = space.factor(self.alpha, self.beta, self.kappa)
        pair = factored.solve()
        rates = _rates(resolution, pair)
        solved, parts = self._integrals(factored, pair, rates, resolution)
        if not self.pointwise:
            error = max(solved.approach_error, solved.shear_error)
            return Attempt(solved, error, parts, rates**2, space.unknowns)
        # not before: a correction of a coarse solution moves the integrals by more than it gains
        sizes = self._sizes(space, pair)
        pair, left = self._corrected(factored, pair, sizes)
        changes = Pair(*(one.coefficients for one in factored.change(pair)))
        shares = self._shares(space, changes, sizes)
        expected = [expected_error(share, rates) for share in shares]
        tails = self._tail_errors(space, changes, sizes)
        pressure, traction = self._fields(space, pair.times(solved.approach))
        solved = replace(
            solved,
            pressure=PressureField(None, pressure),
            traction=DiskSeries(EDGE, traction),
            opening=_opening(pressure),
            pressure_error=max(float(expected[0].max()), tails[0]) + left + 40.0 * ROUNDING,
            traction_error=max(float(expected[1].max()), tails[1])
            + left
            + _CENTRE * TRACTION_ROUNDING,
        )
        if solved.opening is None and not self.smooth:
            solved = self._with_ratios(solved, factored, pair, changes, shares)
        error = max(solved.pressure_error, solved.traction_error)
        return Attempt(solved, error, np.maximum(*expected), rates, space.unknowns)

    def _integrals(
        self, factored: CoupledFactored, pair: Pair, rates: Array, resolution: Resolution
    ) -> tuple[CoupledStick, Array]:
        """Return approach and shear, and by how much every panel moves them."""
        space = factored.space
        changes = factored.change(pair)
        energies = changes[0].energies + changes[1].energies
        load = 2.0 * float(space.normal.constant_moments @ pair.normal[space.normal.index])
        approach = 1.0 / (2.0 * pi * load)
        approach_error = float(energies[:-1] @ rates**2 + energies[-1]) / load + 2.0 * ROUNDING
        moments = space.tangential.shear_moments
        shear = float(moments @ pair.tangential)
        dual = factored.dual(moments)
        # the energy product of the errors of the solution and of the functional's dual
        pairs = zip(changes, factored.change(dual), strict=True)
        products = [np.sqrt(one.energies * other.energies) for one, other in pairs]
        parts = (products[0] + products[1]) / shear
        shear_error = float(parts[:-1] @ (rates * _rates(resolution, dual)) + parts[-1])
        solved = CoupledStick(
            approach,
            shear * approach,
            approach_error,
            shear_error + approach_error + 4.0 * ROUNDING,
        )
        return solved, (energies / load + parts)[:-1]

    def _corrected(
        self, factored: CoupledFactored, pair: Pair, sizes: list[Array]
    ) -> tuple[Pair, float]:
        """Return the solution corrected, and an estimate of what rounding leaves of its error."""
        before, left = inf, inf
        for _ in range(_CORRECTIONS):
            step = factored.correction(pair)
            pair = pair.plus(step)
            size = float(np.max(self._shares(factored.space, step, sizes)))
            left = size * max(_LEFT, min(size / before, 1.0))
            if left < max(0.02 * self.tolerance, ROUNDING):
                break
            before = size
        return pair, left

    def _sizes(self, space: CoupledSpace, pair: Pair) -> list[Array]:
        """Return what errors of p and of q/s are relative to, at the ends of the panels."""
        p, q = (series_of(*one) for one in zip(space.panels, _parts(pair), strict=True))
        y = np.exp(-_samples(space.panels[0].panels, space.panels[0].width))
        if all((one(y) * one(y[:1]) > 0.0).all() for one in (p, q)):
            return [p.at_ends(), q.at_ends()]
        pressure, traction = p.at_ends(), q.at_ends()
        return [np.hypot(pressure, traction), np.hypot(traction, self.kappa * pressure)]

    def _shares(self, space: CoupledSpace, change: Pair, sizes: list[Array]) -> list[Array]:
        """Return a change of both fields on every panel, relative to their sizes there."""
        return [
            share_of_change(own, part, size, leading=self.leading if own.power else inf)
            for own, part, size in zip(space.panels, _parts(change), sizes, strict=True)
        ]

    def _tail_errors(self, space: CoupledSpace, change: Pair, sizes: list[Array]) -> list[float]:
        """Return the errors at the edge of what has a root there."""
        if len(self.layers) != 1:
            return [0.0, 0.0]
        return [
            0.0 if own.power else root_error(own, part, size[-1])
            for own, part, size in zip(space.panels, _parts(change), sizes, strict=True)
        ]

    def _fields(self, space: CoupledSpace, pair: Pair) -> list[LogSeries]:
        """Return p and q/s; singular ones have their leading term as the tail."""
        series = [series_of(*one) for one in zip(space.panels, _parts(pair), strict=True)]
        count = ceil(self.leading / space.panels[0].width)
        if count > space.panels[0].panels:
            return series
        a, b = (float(one.coefficients[count - 1].sum()) for one in series)
        # p + i q, times sqrt(y), goes over into exp(i theta x) with theta = ln(3 - 4 nu)/(2 pi)
        theta = atanh(2.0 * self.kappa) / pi if self.smooth else 0.0
        tails = [(a, -b), (b, a)] if self.smooth else [(a,), (b,)]
        return [
            replace(
                one, coefficients=one.coefficients[:count], tail=np.array(tail), oscillation=theta
            )
            if one.power
            else one
            for one, tail in zip(series, tails, strict=True)
        ]

    def _with_ratios(
        self,
        solved: CoupledStick,
        factored: CoupledFactored,
        pair: Pair,
        changes: Pair,
        shares: list[Array],
    ) -> CoupledStick:
        """Return the solution with q/p at the edge and at its largest."""
        panels = factored.space.panels
        assert solved.pressure is not None
        assert solved.traction is not None
        depth = panels[0].panels * panels[0].width
        edge, critical, where = largest_ratio(solved.pressure, solved.traction, depth)
        rounding, at_edge = 20.0 * ROUNDING, 0.0
        if self.powers == (0.0, 0.0):
            lesser = Pair(*(one.coefficients for one in factored.change(pair, degrees=1)))
            for k, one in enumerate(panels):
                limits = [series_of(one, _parts(pair)[k]).limit for pair in (changes, lesser)]
                at_edge += max(map(abs, limits)) / abs(series_of(one, _parts(pair)[k]).limit)

        def ratio_error(y: float) -> float:
            """Estimate the error of q/p at one place: what its panels contribute."""
            places = sum(float(share[panel_of(panels[0], y)]) for share in shares)
            return rounding + AT_ONE_PLACE * places + (at_edge if y == 0.0 else 0.0)

        return replace(
            solved,
            edge_ratio=edge,
            critical=critical,
            edge_error=ratio_error(0.0) if 0.0 < edge < inf else rounding,
            critical_error=ratio_error(where) if critical < inf else rounding,
        )


def solve_coupled_stick(
    alpha: float,
    beta: float,
    kappa: float,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[CoupledStick]:
    """Solve the coupled full-stick problem for unit load.

    Parameters
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    kappa : float
        ``(1 - 2 nu)/(4 (1 - nu))``, positive.
    tolerance : float
        Bound on the relative error of both fields, or of approach and shear.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the fields are wanted; approach and shear alone need far fewer unknowns.

    Returns
    -------
    Refinement
    """
    problem = _CoupledProblem(alpha, beta, kappa, tolerance, pointwise=pointwise)
    return refine(problem, tolerance, max_unknowns // 2)


def _parts(pair: Pair) -> tuple[Array, Array]:
    return pair.normal, pair.tangential


def _rates(resolution: Resolution, pair: Pair) -> Array:
    """Return by what factor a coefficient of the slower field falls with one degree."""
    return np.maximum(*(decay_rates(resolution, one) for one in _parts(pair)))


def _samples(panels: int, width: float) -> Array:
    """Return ``x`` close enough on so many panels to see every change of sign."""
    return np.linspace(1e-3, panels * width, 8 * panels + 1)


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance from the edge at which the pressure first changes sign."""
    depth = len(pressure.coefficients) * pressure.width
    x = _samples(len(pressure.coefficients), pressure.width)
    negative = np.flatnonzero(pressure(np.exp(-x)) <= 0.0)
    if len(negative):
        i = int(negative[0])
        low, high = float(x[i - 1]), float(x[i])
        for _ in range(52):
            depth = (low + high) / 2.0
            low, high = (depth, high) if pressure(np.array(exp(-depth))) > 0.0 else (low, depth)
    elif pressure.oscillation:
        depth += atan2(pressure.tail[0], -pressure.tail[1]) / pressure.oscillation
    else:
        return None
    y = exp(-depth)
    distance = y / (1.0 + sqrt(1.0 - y))
    return distance if distance > _CLOSEST else None
