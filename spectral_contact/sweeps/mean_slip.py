"""The mean slip of a flat punch, weighted by the pressure, over the coefficient of friction.

``A(f) = 2 pi int p |u| s ds`` under unit load. It is 0 from the critical friction R on, and what
cycles of the load dissipate are integrals of it from some friction to R (docs/cycles). Between two
thresholds of friction, at which zones appear, ``ln A`` is smooth in ``tau = -ln((R - f)/(R - f0))``
if R is finite, else in ``tau = ln(1 + (f - f0)/scale)``. Chebyshev series on panels go through what
is solved.
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

#: What is asked of each friction.
ASKED: Final = ("approach", "pressure", "traction", "slip", "zones", "stick_radius", "total_shear")
#: Degrees that are tried on a panel, each with the nodes of the one before.
_DEGREES: Final = (8, 16)
#: Width of the first panel, and the narrowest.
_WIDTH, _NARROWEST = 2.0, 0.02
#: How well a threshold is found, and how close to the begin of a panel one may be.
_BRACKET, _STILL = 2e-3, 1e-9
#: How many of the last coefficients tell what is missing, and by how much it may be more.
_LAST, _SAFETY = 3, 2.0
#: Most panels.
_PANELS: Final = 60
#: Gauss points of the rule, and of the one that it is compared with; e-folds of the distance to an
#: end of a zone that are resolved, in its root.
_POINTS, _FEWER, _FOLDS = 16, 12, 32
#: Gauss points of an integral over friction, on panels of a ratio of at most 2.
_INNER: Final = 20


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
    value = other = weight = largest = 0.0
    for zone in solution.zones:
        if zone.kind != "slip":
            continue
        for points in (_POINTS, _FEWER):
            from_edge, area = annulus_nodes(zone.inner_from_edge, zone.outer_from_edge, points)
            slip = np.abs(solution.slip(from_edge=from_edge))
            load = 2.0 * np.pi * solution.pressure(from_edge=from_edge) * area
            if points == _POINTS:
                value += float(load @ slip)
                weight += float(load.sum())
                largest = max(largest, float(slip.max()))
            else:
                other += float(load @ slip)
    if value == 0.0:  # slip that is too small for a digit, if there is any
        return ValueWithError(0.0, math.inf if solution.error.slip else 0.0)
    # the error of the slip is relative to its largest modulus
    of_slip = (solution.error.slip or 0.0) * largest * weight / value
    of_rule = abs(value - other) / value
    return ValueWithError(value, of_rule + of_slip + (solution.error.pressure or 0.0))


def annulus_nodes(
    inner_from_edge: float, outer_from_edge: float, points: int
) -> tuple[Array, Array]:
    """Return the distances of nodes from the edge, and weights of ``s ds``, graded to both ends.

    Parameters
    ----------
    inner_from_edge, outer_from_edge : float
        One minus the radii of the annulus.
    points : int
        On each panel.
    """
    x, w = leggauss(points)
    ends = np.append(0.0, np.exp(-np.arange(_FOLDS, -1.0, -1.0)))
    root = (ends[:-1, None] + np.diff(ends)[:, None] * (x + 1.0) / 2.0).ravel()
    weight = (np.diff(ends)[:, None] * w / 2.0).ravel()
    half = (inner_from_edge - outer_from_edge) / 2.0
    offset, length = half * root**2, 2.0 * half * root * weight
    from_edge = np.concatenate([inner_from_edge - offset, outer_from_edge + offset])
    return from_edge, (1.0 - from_edge) * np.concatenate([length, length])


@dataclass(frozen=True, slots=True)
class _SeriesPanel:
    """``ln A`` between two values of tau, as a Chebyshev series; `error` is that of A, relative."""

    start: float
    stop: float
    series: Array
    error: float

    def mean(self, tau: Array) -> Array:
        """Return A inside the panel."""
        local = (2.0 * tau - self.start - self.stop) / (self.stop - self.start)
        return np.asarray(np.exp(chebyshev.chebval(local, self.series)))


class MeanSlipCurve:
    """The mean slip from some friction on to where nothing slips.

    Parameters
    ----------
    solve : callable
        Returns the solution at a friction, with the quantities `ASKED`, converged or not.
    lowest, highest : float
        The curve begins at `lowest`. Integrals from anywhere up to `highest` are to have their
        digits.
    critical : float
        Critical friction R, infinite without tangential compliance.
    scale : float
        Friction over which the mean slip changes if R is infinite.
    rtol : float
        Relative tolerance of the integrals.

    Attributes
    ----------
    states : list of Solution
        What was solved, by rising friction.
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
        self._solve, self._lowest, self._critical, self._scale = solve, lowest, critical, scale
        self._solved: dict[float, tuple[Solution, ValueWithError]] = {}
        self._panels: list[_SeriesPanel] = []
        #: short intervals of tau in which zones appear or vanish
        self._crossings: dict[float, float] = {}
        #: what the integral of A beyond the last panel is at most
        self._beyond = 0.0
        if lowest < critical:
            self._build(self._place(highest), rtol)

    @property
    def states(self) -> list[Solution]:
        """Return what was solved, by rising friction."""
        return [self._solved[tau][0] for tau in sorted(self._solved)]

    def _place(self, friction: float) -> float:
        """Return tau of a friction."""
        if self._critical == math.inf:
            return math.log1p((friction - self._lowest) / self._scale)
        return -math.log((self._critical - friction) / (self._critical - self._lowest))

    def _friction(self, tau: Array) -> Array:
        """Return the frictions at some tau."""
        if self._critical == math.inf:
            return np.asarray(self._lowest + self._scale * np.expm1(tau))
        width = self._critical - self._lowest
        # next to R its distance counts, next to the lowest friction the distance from there
        near = self._lowest - width * np.expm1(-tau)
        return np.where(tau < 0.5, near, self._critical - width * np.exp(-tau))

    def _slope(self, tau: Array) -> Array:
        """Return the derivative of the friction by tau."""
        if self._critical == math.inf:
            return np.asarray(self._scale * np.exp(tau))
        return np.asarray((self._critical - self._lowest) * np.exp(-tau))

    def _mean(self, tau: float) -> ValueWithError:
        if tau not in self._solved:
            solution = self._solve(float(self._friction(np.array(tau))))
            mean = mean_slip(solution)
            if solution.ending is Ending.ZONES:
                mean = ValueWithError(mean.value, math.inf)
            self._solved[tau] = solution, mean
        return self._solved[tau][1]

    def _density(self, tau: float) -> float:
        """Return A times the slope, which is integrated over tau."""
        return self._mean(tau).value * float(self._slope(np.array(tau)))

    def _build(self, last: float, rtol: float) -> None:
        """Add panels until what is beyond them does not count for integrals from `last` on."""
        start, width, whole = 0.0, _WIDTH, self._density(last)
        while len(self._panels) < _PANELS:
            here = self._density(start)
            if not self._mean(start).error < 1.0:  # next to R, where slip has no digits any more
                self._beyond = here * _WIDTH
                break
            # where A has fallen, fewer of its digits count
            share = min(here / whole, 1.0) if whole > 0.0 else 1.0
            if start in self._crossings:
                panel: _SeriesPanel | float = self._crossing(start)
            else:
                panel = self._panel(start, start + width, min(rtol / share, 1e-3))
            if not isinstance(panel, _SeriesPanel):
                width = panel
                continue
            self._panels.append(panel)
            after = self._density(panel.stop)
            length = panel.stop - panel.start
            fall = math.log(here / after) / length if 0.0 < after < here else 1.0 / length
            self._beyond = after / fall
            if panel.stop >= last and self._beyond <= 0.1 * rtol * whole:
                break
            width = _WIDTH / 4.0 if start in self._crossings else min(2.0 * width, _WIDTH)
            start = panel.stop
        else:
            self._beyond = math.inf

    def _panel(self, start: float, stop: float, tolerance: float) -> _SeriesPanel | float:
        """Return the series on a panel, or the width of a narrower one to be tried."""
        for degree in _DEGREES:
            local = -np.cos(np.pi * np.arange(degree + 1) / degree)
            taus = [start, *(start + (stop - start) * (local[1:-1] + 1.0) / 2.0).tolist(), stop]
            means = [self._mean(tau) for tau in taus]
            threshold = self._threshold(taus)
            if threshold is not None:
                return threshold - start
            values = np.array([one.value for one in means])
            if not (values > 0.0).all():
                break
            terms = chebyshev.chebfit(local, np.log(values), degree)
            missing = _SAFETY * float(np.abs(terms[-_LAST:]).max())
            known = max(one.error for one in means)
            if not known < 1.0:
                break
            if missing <= max(tolerance, known):
                return _SeriesPanel(start, stop, terms, missing + _SAFETY * known)
        if stop - start > 2.0 * _NARROWEST:
            return (stop - start) / 2.0
        logs = np.log(np.maximum(values, np.finfo(float).tiny))
        return _SeriesPanel(start, stop, chebyshev.chebfit(local, logs, degree), math.inf)

    def _zones(self, tau: float) -> list[str]:
        self._mean(tau)
        return [zone.kind for zone in self._solved[tau][0].zones]

    def _threshold(self, taus: list[float]) -> float | None:
        """Return a place just before zones appear or vanish, None if they are the same at all."""
        kinds = [self._zones(tau) for tau in taus]
        changes = [i for i, one in enumerate(kinds) if one != kinds[0]]
        if not changes:
            return None
        low, high = taus[changes[0] - 1], taus[changes[0]]
        while high - low > _BRACKET or (low == taus[0] and high - low > _STILL):
            middle = (low + high) / 2.0
            low, high = (middle, high) if self._zones(middle) == kinds[0] else (low, middle)
        self._crossings[low] = high
        return low

    def _crossing(self, start: float) -> _SeriesPanel:
        """Return the panel on which zones appear or vanish: so short that A is a parabola."""
        stop = self._crossings[start]
        local = np.array([-1.0, 0.0, 1.0])
        means = [self._mean(tau) for tau in (start, (start + stop) / 2.0, stop)]
        values = np.maximum([one.value for one in means], np.finfo(float).tiny)
        terms = chebyshev.chebfit(local, np.log(values), 2)
        known = max(one.error for one in means)
        return _SeriesPanel(start, stop, terms, _SAFETY * (abs(float(terms[2])) + known))

    def integrate(
        self, weight: Callable[[Array], Array], friction: float, step: float
    ) -> ValueWithError:
        """Return the integral of A times a weight that falls, from a friction on.

        Parameters
        ----------
        weight : callable
            Of the difference of frictions from `friction`.
        friction : float
        step : float
            The difference over which the weight is smooth.

        Returns
        -------
        ValueWithError
            The error is absolute.
        """
        value = error = 0.0
        x, w = leggauss(_INNER)
        first = self._place(friction)
        for panel, (start, stop) in self._pieces(first, step):
            ahead = start + (stop - start) * (x + 1.0) / 2.0
            tau = first + ahead
            density = self._slope(tau) * panel.mean(tau)
            terms = (stop - start) / 2.0 * w * density * weight(self._difference(first, ahead))
            value += float(terms.sum())
            error += float(terms.sum()) * panel.error
        if self._beyond > 0.0:
            last = max(self._panels[-1].stop - first if self._panels else 0.0, 0.0)
            error += self._beyond * float(weight(self._difference(first, np.array([last])))[0])
        return ValueWithError(value, error)

    def _difference(self, first: float, ahead: Array) -> Array:
        """Return by how much the friction rises from tau = `first` on, free of cancellation."""
        slope = self._slope(np.array(first))
        return slope * (np.expm1(ahead) if self._critical == math.inf else -np.expm1(-ahead))

    def _pieces(
        self, first: float, step: float
    ) -> Iterator[tuple[_SeriesPanel, tuple[float, float]]]:
        """Yield panels and the ends of pieces of them, less `first`; the pieces grow from there."""
        fine = step / float(self._slope(np.array(first))) * 2.0 ** np.arange(60)
        for panel in self._panels:
            start, stop = max(panel.start - first, 0.0), panel.stop - first
            if start >= stop:
                continue
            inner = fine[(fine > start) & (fine < stop)].tolist()
            for piece in pairwise([start, *inner, stop]):
                yield panel, piece
