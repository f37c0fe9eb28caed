"""The mean slip of a flat punch, weighted by the pressure, as a function of the friction.

It is ``A(f) = 2 pi int p |u| s ds`` under unit load, with the slip u. It is 0 from the critical
friction R on, and the energies that cycles of the load dissipate are integrals of it from some
friction to R (docs/cycles). The variable is ``tau = -ln((R - f)/(R - f0))`` if R is finite, else
``tau = ln(1 + (f - f0)/scale)``, where f0 is the lowest friction. Between two thresholds of
friction, at which zones appear or vanish, ``ln A`` is smooth in tau: on panels between them it is a
Chebyshev series through solved frictions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.polynomial.legendre import leggauss

from spectral_contact.fields import Array
from spectral_contact.records import Ending
from spectral_contact.solution import Solution

#: Quantities of a solution that are needed at each friction.
ASKED: Final = ("approach", "pressure", "traction", "slip", "zones", "stick_radius", "total_shear")
#: Degrees that are tried on a panel: the Chebyshev nodes of each are among those of the next.
_DEGREES: Final = (8, 16)
#: Largest width of a panel in tau, which the first panel has; chosen.
_WIDTH: Final = 2.0
#: Panels wider than twice this may be halved; chosen.
_NARROWEST: Final = 0.02
#: Width in tau to which a threshold is located by bisection: so short that ln A is a parabola on
#: it.
_BRACKET: Final = 2e-3
#: A threshold so close behind the start of a panel, in tau, is taken to be at the start.
_AT_START: Final = 1e-9
#: The error of a series is estimated by the largest of this many last coefficients times `_SAFETY`.
_LAST_COEFFICIENTS: Final = 3
#: Factor of the estimates of errors.
_SAFETY: Final = 2.0
#: Largest number of panels of a curve.
_MOST_PANELS: Final = 60
#: Gauss points on each panel of the quadrature over a zone.
_QUADRATURE_POINTS: Final = 16
#: The same of the coarser quadrature, whose difference is the error.
_FEWER_POINTS: Final = 12
#: Panels of that quadrature on each half of a zone, besides the one next to the end. In the root of
#: the distance from the end, the farther end of each is e times as far as that of the one before.
_PANELS_OF_HALF: Final = 32
#: Gauss points of an integral over friction, on pieces: see `MeanSlipCurve._pieces`.
_INTEGRAL_POINTS: Final = 20


class ValueWithError(NamedTuple):
    """A number that is not negative, and the estimate of its error."""

    value: float
    error: float


def mean_slip(solution: Solution) -> ValueWithError:
    """Return ``2 pi int p |u| s ds`` of a solution, by quadrature over the slip zones.

    Parameters
    ----------
    solution : Solution
        Under a flat punch, with pressure, slip and zones.

    Returns
    -------
    ValueWithError
        The error is relative, and infinite where no digit of the slip is known.
    """
    value = with_fewer = weight = largest = 0.0
    for zone in solution.zones:
        if zone.kind != "slip":
            continue
        for points in (_QUADRATURE_POINTS, _FEWER_POINTS):
            from_edge, area = annulus_nodes(zone.inner_from_edge, zone.outer_from_edge, points)
            slip = np.abs(solution.slip(from_edge=from_edge))
            load = 2.0 * np.pi * solution.pressure(from_edge=from_edge) * area
            if points == _QUADRATURE_POINTS:
                value += float(load @ slip)
                weight += float(load.sum())
                largest = max(largest, float(slip.max()))
            else:
                with_fewer += float(load @ slip)
    if value == 0.0:  # without slip, or with less than a digit of it
        return ValueWithError(0.0, math.inf if solution.error.slip else 0.0)
    # the error of the slip is relative to its largest modulus
    slip_error = (solution.error.slip or 0.0) * largest * weight / value
    quadrature_error = abs(value - with_fewer) / value
    return ValueWithError(value, quadrature_error + slip_error + (solution.error.pressure or 0.0))


def annulus_nodes(
    inner_from_edge: float, outer_from_edge: float, points: int
) -> tuple[Array, Array]:
    """Return nodes in an annulus, as distances from the edge, and their weights for ``s ds``.

    The nodes are graded to both ends: each half of the annulus has Gauss rules on panels in the
    root of the distance from its end, the ends of which are in the ratio e.

    Parameters
    ----------
    inner_from_edge, outer_from_edge : float
        One minus the radii of the annulus.
    points : int
        Of the rule on each panel.
    """
    x, w = leggauss(points)
    ends = np.append(0.0, np.exp(-np.arange(_PANELS_OF_HALF, -1.0, -1.0)))
    root = (ends[:-1, None] + np.diff(ends)[:, None] * (x + 1.0) / 2.0).ravel()
    weight = (np.diff(ends)[:, None] * w / 2.0).ravel()
    half = (inner_from_edge - outer_from_edge) / 2.0
    # the distance from the end, and its differential
    offset = half * root**2
    length = 2.0 * half * root * weight
    from_edge = np.concatenate([inner_from_edge - offset, outer_from_edge + offset])
    return from_edge, (1.0 - from_edge) * np.concatenate([length, length])


@dataclass(frozen=True, slots=True)
class _SeriesPanel:
    """``ln A`` between two values of tau, as a Chebyshev series.

    Attributes
    ----------
    start, stop : float
        The ends, in tau.
    series : ndarray
        Coefficients.
    error : float
        Relative error of A.
    """

    start: float
    stop: float
    series: Array
    error: float

    def mean(self, tau: Array) -> Array:
        """Return the mean slip A inside the panel."""
        local = (2.0 * tau - self.start - self.stop) / (self.stop - self.start)
        return np.asarray(np.exp(chebyshev.chebval(local, self.series)))


class MeanSlipCurve:
    """The mean slip from some friction up to the critical one, where nothing slips.

    Parameters
    ----------
    solve : callable
        Returns the solution at a friction, with the quantities `ASKED`, converged or not.
    lowest, highest : float
        The curve begins at `lowest`. Integrals to R from any friction between these two are
        accurate to `rtol`.
    critical : float
        Critical friction R, infinite without tangential compliance.
    scale : float
        Friction over which the mean slip changes if R is infinite.
    rtol : float
        Relative tolerance of the integrals.

    Attributes
    ----------
    states : list of Solution
        Solutions by rising friction.
    """

    def __init__(
        self,
        solve: Callable[[float], Solution],
        lowest: float,
        highest: float,
        critical: float,
        scale: float,
        rtol: float,
    ) -> None:
        self._solve = solve
        self._lowest = lowest
        self._critical = critical
        self._scale = scale
        #: solutions and their mean slips, by tau
        self._solved: dict[float, tuple[Solution, ValueWithError]] = {}
        self._panels: list[_SeriesPanel] = []
        #: the ends of the short intervals of tau in which zones appear or vanish, by their starts
        self._thresholds: dict[float, float] = {}
        #: an estimate of the integral of A beyond the last panel
        self._remainder = 0.0
        if lowest < critical:
            self._build(self._tau(highest), rtol)

    @property
    def states(self) -> list[Solution]:
        """Return the solutions by rising friction."""
        return [self._solved[tau][0] for tau in sorted(self._solved)]

    def _tau(self, friction: float) -> float:
        """Return the tau of a friction."""
        if self._critical == math.inf:
            return math.log1p((friction - self._lowest) / self._scale)
        return -math.log((self._critical - friction) / (self._critical - self._lowest))

    def _friction(self, tau: Array) -> Array:
        """Return the frictions at some values of tau."""
        if self._critical == math.inf:
            return np.asarray(self._lowest + self._scale * np.expm1(tau))
        width = self._critical - self._lowest
        # next to the lowest friction the result is a small step from it, next to R one from R, so
        # that neither difference cancels
        from_lowest = self._lowest - width * np.expm1(-tau)
        return np.where(tau < 0.5, from_lowest, self._critical - width * np.exp(-tau))

    def _slope(self, tau: Array) -> Array:
        """Return the derivative of the friction by tau."""
        if self._critical == math.inf:
            return np.asarray(self._scale * np.exp(tau))
        return np.asarray((self._critical - self._lowest) * np.exp(-tau))

    def _mean_slip(self, tau: float) -> ValueWithError:
        """Return the mean slip at tau, solved once; its error is infinite without valid zones."""
        if tau not in self._solved:
            solution = self._solve(float(self._friction(np.array(tau))))
            mean = mean_slip(solution)
            if solution.ending is Ending.ZONES:
                mean = ValueWithError(mean.value, math.inf)
            self._solved[tau] = solution, mean
        return self._solved[tau][1]

    def _density(self, tau: float) -> float:
        """Return the integrand over tau: A times the derivative of the friction."""
        return self._mean_slip(tau).value * float(self._slope(np.array(tau)))

    def _build(self, last: float, rtol: float) -> None:
        """Add panels until what is beyond them is negligible in integrals from `last` on."""
        start = 0.0
        width = _WIDTH
        density_at_last = self._density(last)
        while len(self._panels) < _MOST_PANELS:
            density_at_start = self._density(start)
            if (
                not self._mean_slip(start).error < 1.0
            ):  # next to R, where no digit of the slip is known
                self._remainder = density_at_start * _WIDTH
                break
            # where A has fallen, fewer digits of it are needed
            fraction = (
                min(density_at_start / density_at_last, 1.0) if density_at_last > 0.0 else 1.0
            )
            at_threshold = start in self._thresholds
            if at_threshold:
                panel: _SeriesPanel | float = self._threshold_panel(start)
            else:
                panel = self._panel(start, start + width, min(rtol / fraction, 1e-3))
            if not isinstance(panel, _SeriesPanel):
                width = panel
                continue
            self._panels.append(panel)
            density_at_stop = self._density(panel.stop)
            length = panel.stop - panel.start
            # the integrand falls on as fast as on this panel, by exp(-decay tau)
            decay = (
                math.log(density_at_start / density_at_stop) / length
                if 0.0 < density_at_stop < density_at_start
                else 1.0 / length
            )
            self._remainder = density_at_stop / decay
            if panel.stop >= last and self._remainder <= 0.1 * rtol * density_at_last:
                break
            width = _WIDTH / 4.0 if at_threshold else min(2.0 * width, _WIDTH)
            start = panel.stop
        else:
            self._remainder = math.inf

    def _panel(self, start: float, stop: float, tolerance: float) -> _SeriesPanel | float:
        """Return the series on a panel, or the width of a narrower panel to be tried instead.

        A narrower panel is tried if zones appear or vanish on this one, or if no degree reaches the
        tolerance. The narrowest panel has a series in any case, with an infinite error.
        """
        for degree in _DEGREES:
            local = -np.cos(np.pi * np.arange(degree + 1) / degree)
            taus = [start, *(start + (stop - start) * (local[1:-1] + 1.0) / 2.0).tolist(), stop]
            means = [self._mean_slip(tau) for tau in taus]
            threshold = self._threshold(taus)
            if threshold is not None:
                return threshold - start
            values = np.array([mean.value for mean in means])
            if not (values > 0.0).all():
                break
            terms = chebyshev.chebfit(local, np.log(values), degree)
            truncation = _SAFETY * float(np.abs(terms[-_LAST_COEFFICIENTS:]).max())
            solve_error = max(mean.error for mean in means)
            if not solve_error < 1.0:
                break
            if truncation <= max(tolerance, solve_error):
                return _SeriesPanel(start, stop, terms, truncation + _SAFETY * solve_error)
        if stop - start > 2.0 * _NARROWEST:
            return (stop - start) / 2.0
        logs = np.log(np.maximum(values, np.finfo(float).tiny))
        return _SeriesPanel(start, stop, chebyshev.chebfit(local, logs, degree), math.inf)

    def _zones(self, tau: float) -> list[str]:
        """Return the kinds of the zones at tau, from the centre."""
        self._mean_slip(tau)
        return [zone.kind for zone in self._solved[tau][0].zones]

    def _threshold(self, taus: list[float]) -> float | None:
        """Return a tau just before the first change of the zones; None if all have the same zones.

        The interval from there on, in which they change, is kept.
        """
        kinds = [self._zones(tau) for tau in taus]
        changes = [i for i, one in enumerate(kinds) if one != kinds[0]]
        if not changes:
            return None
        low = taus[changes[0] - 1]
        high = taus[changes[0]]
        # the panel up to `low` needs a length, so go on while that is the first tau
        while high - low > _BRACKET or (low == taus[0] and high - low > _AT_START):
            middle = (low + high) / 2.0
            if self._zones(middle) == kinds[0]:
                low = middle
            else:
                high = middle
        self._thresholds[low] = high
        return low

    def _threshold_panel(self, start: float) -> _SeriesPanel:
        """Return the panel on which zones appear or vanish: so short that ln A is a parabola."""
        stop = self._thresholds[start]
        local = np.array([-1.0, 0.0, 1.0])
        means = [self._mean_slip(tau) for tau in (start, (start + stop) / 2.0, stop)]
        values = np.maximum([mean.value for mean in means], np.finfo(float).tiny)
        terms = chebyshev.chebfit(local, np.log(values), 2)
        solve_error = max(mean.error for mean in means)
        return _SeriesPanel(start, stop, terms, _SAFETY * (abs(float(terms[2])) + solve_error))

    def integrate(
        self, weight: Callable[[Array], Array], friction: float, step: float
    ) -> ValueWithError:
        """Return the integral of A times a weight, over the friction from a given one to R.

        Parameters
        ----------
        weight : callable
            A function of the distance of the friction above `friction`, with which it falls.
        friction : float
            The lower end of the integral.
        step : float
            The distance above `friction` over which the weight changes by its own size.

        Returns
        -------
        ValueWithError
            The error is absolute.
        """
        value = error = 0.0
        x, w = leggauss(_INTEGRAL_POINTS)
        first = self._tau(friction)
        for panel, (start, stop) in self._pieces(first, step):
            # tau less that of the lower end
            tau_increment = start + (stop - start) * (x + 1.0) / 2.0
            tau = first + tau_increment
            density = self._slope(tau) * panel.mean(tau)
            terms = (
                (stop - start)
                / 2.0
                * w
                * density
                * weight(self._friction_increment(first, tau_increment))
            )
            value += float(terms.sum())
            error += float(terms.sum()) * panel.error
        if self._remainder > 0.0:
            last = max(self._panels[-1].stop - first if self._panels else 0.0, 0.0)
            error += self._remainder * float(
                weight(self._friction_increment(first, np.array([last])))[0]
            )
        return ValueWithError(value, error)

    def _friction_increment(self, first: float, tau_increment: Array) -> Array:
        """Return by how much the friction rises from `first` to `first + ahead`, both in tau.

        The difference of the two frictions would cancel.
        """
        slope = self._slope(np.array(first))
        return slope * (
            np.expm1(tau_increment) if self._critical == math.inf else -np.expm1(-tau_increment)
        )

    def _pieces(
        self, first: float, step: float
    ) -> Iterator[tuple[_SeriesPanel, tuple[float, float]]]:
        """Yield pieces of the panels behind `first`: the panel, and the ends in tau less `first`.

        The ends are those of panels, and about where the friction is `step`, 2 `step`, 4 `step` ...
        above that at `first`, so that the weight is smooth on every piece.
        """
        doublings = step / float(self._slope(np.array(first))) * 2.0 ** np.arange(60)
        for panel in self._panels:
            start, stop = max(panel.start - first, 0.0), panel.stop - first
            if start >= stop:
                continue
            inner = doublings[(doublings > start) & (doublings < stop)].tolist()
            for piece in pairwise([start, *inner, stop]):
                yield panel, piece
