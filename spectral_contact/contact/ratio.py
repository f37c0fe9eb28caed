"""Full stick, with elastic coupling or without, and its ratio of traction to pressure."""

from __future__ import annotations

from collections.abc import Iterable
from math import exp, inf, log
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legder, legroots

from spectral_contact.contact.resolution import sample_depths
from spectral_contact.contact.tuning import (
    CLOSED_FORM_ROUNDING,
    FIELD_ROUNDING,
    LEADING_TERM_DEPTH,
    TRACTION_ROUNDING,
)
from spectral_contact.fields.series import Array, DiskSeries, PressureField
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix
from spectral_contact.spectral.panels import LogPanels

#: A share bounds the change on its whole panel by moduli of coefficients. At the place of the
#: largest q/p that is too much: with this factor none of 10,000 errors is above 0.6 of its
#: estimate; with 1/6 one was 1.8 times that.
_AT_ONE_PLACE = 0.5
#: Places of the first look, and the nodes of a polynomial between two of these: as q/p is analytic
#: in ``x`` up to an imaginary part of pi or so, that is right to rounding.
_GRID, _POINTS = 129, 16
#: Further places in the tail, in ``-ln y`` past the panels: loose spaces have none there.
_IN_TAIL = np.linspace(0.0, LEADING_TERM_DEPTH, 65)[1:]
_NODES, _ = gauss_rule(_POINTS)
#: From values at the nodes to the Legendre coefficients of the slope.
_SLOPE = legder(legendre_expansion_matrix(_POINTS, _POINTS - 1))


class FullStick(NamedTuple):
    """Full stick for unit load; without elastic coupling everything tangential is for kappa = 1.

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
        ``q/p`` at the edge; None where it has no limit or no meaning, or is not wanted.
    critical : float
        The largest ``|q|/p``; infinite where the pressure changes sign.
    critical_at : float
        ``y = 1 - s**2`` where that is.
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
    critical_at: float = 0.0
    pressure_error: float = inf
    traction_error: float = inf
    edge_error: float = CLOSED_FORM_ROUNDING
    critical_error: float = CLOSED_FORM_ROUNDING

    def with_ratios(
        self, depth: float, shares: Iterable[tuple[LogPanels, Array]], at_edge: float
    ) -> FullStick:
        """Return full stick with q/p at the edge and at its largest.

        Parameters
        ----------
        depth : float
            ``-ln y`` of the panels, in whose tail the maximum may be, too.
        shares : iterable of (LogPanels, ndarray)
            Changes of the fields on their panels, relative to them.
        at_edge : float
            The same at the edge: the tail sheds one function of few, so that the change is as
            large as the error there.
        """
        assert self.pressure is not None
        assert self.traction is not None
        edge, critical, where = largest_ratio(self.pressure, self.traction, depth)

        def error(y: float) -> float:
            """Estimate the error of q/p at one place: what its panels contribute."""
            places = sum(_share_at(*one, y) for one in shares)
            return FIELD_ROUNDING + _AT_ONE_PLACE * places + (at_edge if y < exp(-depth) else 0.0)

        return self._replace(
            edge_ratio=edge,
            critical=critical,
            critical_at=where,
            edge_error=error(0.0) if 0.0 < edge < inf else FIELD_ROUNDING,
            critical_error=error(where) if critical < inf else FIELD_ROUNDING,
        )


def _share_at(panels: LogPanels, share: Array, y: float) -> float:
    """Return the larger share of the two panels next to a place: it may be on either in truth."""
    last, depth = panels.panels - 1, -log(y) / panels.width if y > 0.0 else inf
    k = int(min(depth, last))  # the last one holds the tail
    beside = min(max(k + (1 if depth > k + 0.5 else -1), 0), last)
    return float(max(share[k], share[beside]))


class LargestRatio(NamedTuple):
    """q/p at the edge, its largest modulus, and ``y = 1 - s**2`` where that is reached."""

    edge: float
    largest: float
    y: float


def largest_ratio(pressure: PressureField, traction: DiskSeries, depth: float) -> LargestRatio:
    """Return q/p at the edge and at its largest, on panels to a depth and in their tail."""
    series, at_edge = traction.series, pressure.value(0.0)
    assert series is not None
    alike = pressure.series is not None and pressure.series.on_panels_of(series)

    def ratio(x: Array) -> Array:
        y = np.exp(-x)
        s = np.sqrt(-np.expm1(-x))
        if not alike:
            return np.abs(s * series(y) / pressure.at(y))
        above, below = PressureField.several([PressureField(None, series), pressure], y)
        return np.asarray(np.abs(s * above / below))

    edge = 0.0 if at_edge == inf else series.limit / at_edge
    if edge == inf:
        return LargestRatio(inf, inf, 0.0)
    x = np.concatenate([sample_depths(depth, _GRID), depth + _IN_TAIL])
    values = ratio(x)
    values[_GRID:] *= 1.0 - TRACTION_ROUNDING  # in the tail it differs from the edge by that
    i = int(np.argmax(values))
    if values[i] <= abs(edge) * (1.0 + CLOSED_FORM_ROUNDING):  # the difference is rounding
        return LargestRatio(edge, abs(edge), 0.0)
    low, high = float(x[max(i - 1, 0)]), float(x[min(i + 1, len(x) - 1)])
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    near = middle + half * _NODES
    around = ratio(near)
    roots = legroots(_SLOPE @ around)
    tops = middle + half * roots[(roots.imag == 0.0) & (np.abs(roots) <= 1.0)].real
    # of what was seen the largest counts, so that a jump between panels does no harm
    seen = np.concatenate([values, around, ratio(tops)])
    i = int(np.argmax(seen))
    where = np.concatenate([x, near, tops])[i]
    return LargestRatio(edge, float(seen[i]), float(np.exp(-where)))
