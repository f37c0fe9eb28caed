"""The result of full stick, and its ratio ``q/p``, whose largest modulus is the critical friction.

p is the pressure, q the traction and s the radius over that of the contact. The series of a
traction is that of the *shear* q/s. The ratio is evaluated in the depth ``x = -ln y``, ``y = 1 -
s**2``, in which the panels of the shear have equal widths.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, inf, log
from typing import NamedTuple

import numpy as np

from spectral_contact.contact.resolution import EPSILON_DEPTH, sample_depths
from spectral_contact.contact.tuning import (
    FIELD_ROUNDING,
    RATIO_BOUND_FACTOR,
    SAMPLES,
    TRACTION_ROUNDING,
)
from spectral_contact.fields.series import Array, DiskSeries, PressureField
from spectral_contact.spectral.panels import LogPanels

#: Depths of the samples in the tail beyond the panels of q, less the depth of the panels' end.
_TAIL_DEPTHS = np.linspace(0.0, EPSILON_DEPTH, SAMPLES)[1:]


class FullStick(NamedTuple):
    """Full stick for unit load; without elastic coupling q and its integrals are for kappa = 1.

    If only approach and total shear are wanted, the fields are None, and the other attributes have
    their defaults.

    Attributes
    ----------
    approach, total_shear : float
        delta and ``Q = 2 pi int q s ds``, dimensionless.
    approach_error, shear_error : float
        Estimates of their relative errors.
    pressure : PressureField or None
        p.
    traction : DiskSeries or None
        q.
    opening : float or None
        Distance ``1 - s`` from the edge at which the pressure changes sign first; None if it is
        positive.
    edge_ratio : float or None
        ``q/p`` at the edge; None where it has no limit, or is not wanted.
    critical : float
        The largest ``|q|/p``, the critical friction, which is compared with f; infinite where the
        pressure changes sign.
    critical_y : float
        ``y = 1 - s**2`` at that maximum.
    pressure_error, traction_error : float
        Estimates of the relative errors of p and of the shear ``u = q/s``, pointwise. Where p
        changes sign the first is relative to ``sqrt(p^2 + u^2)``, and where u changes sign the
        second is to ``sqrt(u^2 + (kappa p)^2)``.
    edge_error, critical_error : float
        Estimates of the relative errors of `edge_ratio` and of `critical`.
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
        self, depth: float, changes: Sequence[tuple[LogPanels, Array]], edge_change: float
    ) -> FullStick:
        """Return full stick with q/p at the edge and at its maximum.

        A change is the difference of a field to that in the coarser space without the top two
        degrees. The relative error of q/p at one radius is estimated by RATIO_BOUND_FACTOR times
        the sum of the relative changes of p and q on its panel.

        Parameters
        ----------
        depth : float
            Depth at which the panels of the traction end and the tail begins. The maximum may be in
            the tail.
        changes : sequence of (LogPanels, ndarray)
            The panels of each field, with its relative change on every one.
        edge_change : float
            Sum of the relative changes of the fields at the edge. It is added without a factor: the
            coarser space lacks one function of a tail that has few, so that the change is no larger
            than the error.
        """
        assert self.pressure is not None
        assert self.traction is not None
        edge, critical, critical_y = largest_ratio(self.pressure, self.traction, depth)

        def error(y: float) -> float:
            """Estimate the relative error of q/p at one y."""
            panel_changes = sum(_change_at(panels, change, y) for panels, change in changes)
            tail_change = edge_change if y < exp(-depth) else 0.0
            return FIELD_ROUNDING + RATIO_BOUND_FACTOR * panel_changes + tail_change

        return self._replace(
            edge_ratio=edge,
            critical=critical,
            critical_y=critical_y,
            edge_error=error(0.0) if 0.0 < abs(edge) < inf else FIELD_ROUNDING,
            critical_error=error(critical_y) if critical < inf else FIELD_ROUNDING,
        )


def _change_at(panels: LogPanels, changes: Array, y: float) -> float:
    """Return the larger change of the panel at a y and of the nearer one of its neighbours.

    The true maximum of the ratio may lie on either.
    """
    last = panels.count - 1
    depth_in_panels = -log(y) / panels.width if y > 0.0 else inf
    k = int(min(depth_in_panels, last))  # the last panel stands for the tail, too
    adjacent = min(max(k + (1 if depth_in_panels > k + 0.5 else -1), 0), last)
    return float(max(changes[k], changes[adjacent]))


class LargestRatio(NamedTuple):
    """q/p at the edge, its largest modulus, and ``y = 1 - s**2`` where that is reached."""

    edge: float
    largest: float
    y: float


def largest_ratio(pressure: PressureField, traction: DiskSeries, depth: float) -> LargestRatio:
    """Return q/p at the edge and its largest modulus, on panels to a depth and in their tail.

    The ratio is sampled, and four times more between the neighbours of the largest sample. Each
    time the distance of samples falls to 1/64, in the end to some 1e-8 in x; the maximum, a
    parabola there, is then right to rounding. It is that at the edge unless one of the first
    samples exceeds it by more than rounding.
    """
    series = traction.series
    assert series is not None
    edge_pressure = pressure.value(0.0)

    def ratio(x: Array) -> Array:
        """Return ``|q/p|``."""
        y = np.exp(-x)
        s = np.sqrt(-np.expm1(-x))
        return np.abs(s * series(y) / pressure.evaluate(y))

    edge = 0.0 if edge_pressure == inf else series.limit / edge_pressure
    if edge == inf:
        return LargestRatio(inf, inf, 0.0)
    x = np.concatenate([sample_depths(depth, SAMPLES), depth + _TAIL_DEPTHS])
    values = ratio(x)
    # In the tail the ratio is nearly that at the edge. Samples there have to exceed it by more than
    # the rounding of the traction.
    values[SAMPLES:] *= 1.0 - TRACTION_ROUNDING
    i = int(np.argmax(values))
    if values[i] <= abs(edge) * (1.0 + FIELD_ROUNDING):
        return LargestRatio(edge, abs(edge), 0.0)
    for _ in range(4):
        x = np.linspace(x[max(i - 1, 0)], x[min(i + 1, len(x) - 1)], SAMPLES)
        values = ratio(x)
        i = int(np.argmax(values))
    return LargestRatio(edge, float(values[i]), float(np.exp(-x[i])))
