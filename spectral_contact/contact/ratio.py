"""The result of full stick, and its ratio ``q/p``, whose maximum is the critical friction.

With ``u = q/s`` the ratio is ``s u / p``. It is evaluated in the depth ``x = -ln y``, ``y = 1 -
s**2``, in which the panels of u have equal widths.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import exp, inf, log
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legder, legroots

from spectral_contact.contact.resolution import EPSILON_DEPTH, sample_depths
from spectral_contact.contact.tuning import (
    FIELD_ROUNDING,
    RATIO_BOUND_FACTOR,
    SAMPLES,
    TRACTION_ROUNDING,
)
from spectral_contact.fields.series import Array, DiskSeries, PressureField
from spectral_contact.spectral.jacobi import PANEL_SAMPLES, gauss_rule, legendre_expansion_matrix
from spectral_contact.spectral.panels import LogPanels

#: Depths of the samples in the tail beyond the panels of q, from the end of the panels.
_TAIL_DEPTHS = np.linspace(0.0, EPSILON_DEPTH, SAMPLES)[1:]
#: q/p between two of the samples is analytic up to an imaginary part of about pi in x.
_NODES, _ = gauss_rule(PANEL_SAMPLES)
#: From values at the nodes to the Legendre coefficients of the derivative.
_DERIVATIVE = legder(legendre_expansion_matrix(PANEL_SAMPLES, PANEL_SAMPLES - 1))


class FullStick(NamedTuple):
    """Full stick for unit load; without elastic coupling everything tangential is for kappa = 1.

    Attributes
    ----------
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    approach_error, shear_error : float
        Estimates of their relative errors.
    pressure : PressureField or None
        ``p*``; None, like all that follow, if only approach and shear are wanted.
    traction : DiskSeries or None
        ``q*``.
    opening : float or None
        Distance from the edge within which the pressure changes sign; None if it is positive.
    edge_ratio : float or None
        ``q/p`` at the edge; None where it has no limit, or is not wanted.
    critical : float
        The largest ``|q|/p``; infinite where the pressure changes sign.
    critical_y : float
        ``y = 1 - s**2`` at that maximum.
    pressure_error, traction_error : float
        Estimates of the relative errors of p and of ``u = q/s``, pointwise. Where one of the two
        changes sign they are relative to ``sqrt(p^2 + u^2)`` and ``sqrt(u^2 + (kappa p)^2)``.
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
    critical_y: float = 0.0
    pressure_error: float = inf
    traction_error: float = inf
    edge_error: float = FIELD_ROUNDING
    critical_error: float = FIELD_ROUNDING

    def with_ratios(
        self, depth: float, changes: Iterable[tuple[LogPanels, Array]], edge_change: float
    ) -> FullStick:
        """Return full stick with q/p at the edge and at its maximum.

        The relative error of q/p at one place is estimated by RATIO_BOUND_FACTOR times the sum of
        the relative changes of p and q on its panel.

        Parameters
        ----------
        depth : float
            Depth of the panels of the traction; the maximum may also be in the tail beyond.
        changes : iterable of (LogPanels, ndarray)
            Meshes, with relative changes of fields on their panels.
        edge_change : float
            Sum of the relative changes of the fields at the edge. As the change takes one of few
            functions of a tail, it is as large as the error there.
        """
        assert self.pressure is not None
        assert self.traction is not None
        edge, critical, critical_y = largest_ratio(self.pressure, self.traction, depth)

        def error(y: float) -> float:
            """Estimate the relative error of q/p at one place."""
            panel_changes = sum(_change_at(panels, change, y) for panels, change in changes)
            tail_change = edge_change if y < exp(-depth) else 0.0
            return FIELD_ROUNDING + RATIO_BOUND_FACTOR * panel_changes + tail_change

        return self._replace(
            edge_ratio=edge,
            critical=critical,
            critical_y=critical_y,
            edge_error=error(0.0) if 0.0 < edge < inf else FIELD_ROUNDING,
            critical_error=error(critical_y) if critical < inf else FIELD_ROUNDING,
        )


def _change_at(panels: LogPanels, changes: Array, y: float) -> float:
    """Return the larger change of the panel at a place and of the panel next to it.

    The true maximum may lie on either.
    """
    last = panels.panels - 1
    depth = -log(y) / panels.width if y > 0.0 else inf
    k = int(min(depth, last))  # the last panel stands for the tail, too
    adjacent = min(max(k + (1 if depth > k + 0.5 else -1), 0), last)
    return float(max(changes[k], changes[adjacent]))


class LargestRatio(NamedTuple):
    """q/p at the edge, its largest modulus, and ``y = 1 - s**2`` where that is reached."""

    edge: float
    largest: float
    y: float


def largest_ratio(pressure: PressureField, traction: DiskSeries, depth: float) -> LargestRatio:
    """Return q/p at the edge and its maximum, on panels to a depth and in their tail.

    The ratio is sampled; around the largest sample the maximum is a root of the derivative of an
    interpolating polynomial. The edge is the maximum if no sample is above it by more than
    rounding.
    """
    series = traction.series
    assert series is not None
    edge_pressure = pressure.value(0.0)
    same_panels = pressure.series is not None and pressure.series.on_panels_of(series)

    def ratio(x: Array) -> Array:
        y = np.exp(-x)
        s = np.sqrt(-np.expm1(-x))
        if not same_panels:
            return np.abs(s * series(y) / pressure.evaluate(y))
        q_over_s, p = PressureField.several([PressureField(None, series), pressure], y)
        return np.asarray(np.abs(s * q_over_s / p))

    edge = 0.0 if edge_pressure == inf else series.limit / edge_pressure
    if edge == inf:
        return LargestRatio(inf, inf, 0.0)
    x = np.concatenate([sample_depths(depth, SAMPLES), depth + _TAIL_DEPTHS])
    values = ratio(x)
    # in the tail the ratio exceeds that at the edge only if by more than rounding
    values[SAMPLES:] *= 1.0 - TRACTION_ROUNDING
    i = int(np.argmax(values))
    if values[i] <= abs(edge) * (1.0 + FIELD_ROUNDING):
        return LargestRatio(edge, abs(edge), 0.0)
    low = float(x[max(i - 1, 0)])
    high = float(x[min(i + 1, len(x) - 1)])
    middle = (low + high) / 2.0
    half = (high - low) / 2.0
    nodes = middle + half * _NODES
    node_values = ratio(nodes)
    roots = legroots(_DERIVATIVE @ node_values)
    extrema = middle + half * roots[(roots.imag == 0.0) & (np.abs(roots) <= 1.0)].real
    # the largest of all values that were evaluated, as the ratio may jump between panels
    candidates = np.concatenate([x, nodes, extrema])
    candidate_values = np.concatenate([values, node_values, ratio(extrema)])
    i = int(np.argmax(candidate_values))
    return LargestRatio(edge, float(candidate_values[i]), float(np.exp(-candidates[i])))
