r"""Two-sided bounds of the approach, from any pressure and its residual.

With ``A = alpha + N`` and the product ``<a, b> = int a b s ds``, the answer to unit approach is
``m = <1, A^-1 1> = 1/(2 pi delta)``. Any pressure u leaves a residual ``r = 1 - A u``, and

    m - (<1, u> + <r, u>) = <r, A^-1 r>,   0 <= <r, A^-1 r> <= <r, r>/alpha,

because N is positive: the energy (Ritz) bounds m from below and the complementary energy from
above. With elastic coupling and full stick the same holds of the system of both equations, of which
the elastic part is positive as the work on an elastic body is: A, u and r have two components, and
the last bound is ``<r_1, r_1>/alpha + <r_2, r_2>/beta``. The residual is taken with the elliptic
kernels (`equations`), which share no step with the solver. So the bounds are rigorous up to the
rounding and the quadrature of these integrals.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt
from typing import NamedTuple

import numpy as np
from scipy.special import roots_legendre

from spectral_contact.equations.residuals import (
    load,
    normal_displacement,
    shear_lift,
    tangential_displacement,
)
from spectral_contact.fields.series import DiskSeries, LogSeries, PressureField

#: Relative rounding of the integrals, measured; the bounds are widened by it.
_ROUNDING = 4e-15
_POINTS = 28


@dataclass(frozen=True, slots=True)
class CoupledTraction:
    """What acts back on the pressure in full stick.

    Attributes
    ----------
    compliance : float
        ``beta*``, positive.
    kappa : float
        ``(1 - 2 nu)/(4 (1 - nu))``.
    field : DiskSeries
        ``q*``, on the panels of the pressure.
    """

    compliance: float
    kappa: float
    field: DiskSeries


def approach_bounds(
    compliance: float,
    approach: float,
    pressure: PressureField,
    coupled: CoupledTraction | None = None,
) -> tuple[float, float]:
    """Bound the approach from below and above.

    Parameters
    ----------
    compliance : float
        ``alpha*``, positive.
    approach : float
        ``delta*`` as computed; it scales the pressure, and need not be accurate.
    pressure : PressureField
        ``p*``.
    coupled : CoupledTraction, optional
        With elastic coupling.
    """
    assert pressure.series is not None

    def field(d: np.ndarray) -> np.ndarray:
        return pressure.evaluate(d * (2.0 - d))

    y, weights, breaks = _points(pressure.series)
    p = pressure.evaluate(y)
    depths = y / (1.0 + np.sqrt(1.0 - y))
    deflection = np.array([normal_displacement(field, d, breaks) for d in depths.tolist()])
    residual = approach - compliance * p - deflection
    parts = [(compliance, p, residual)]
    if coupled is not None:
        other, kappa = coupled.field, coupled.kappa

        def traction(d: np.ndarray) -> np.ndarray:
            return other(1.0 - d, d)

        residual += [shear_lift(traction, kappa, d, breaks) for d in depths.tolist()]
        moved = [
            tangential_displacement(traction, field, kappa, d, breaks) for d in depths.tolist()
        ]
        outward, inward = np.array(moved).T
        q = traction(depths)
        parts.append((coupled.compliance, q, inward - outward - coupled.compliance * q))
    energy = 2.0 * pi * load(field, breaks=breaks)
    energy += sum(2.0 * pi * float(weights @ (r * u)) / approach for _, u, r in parts)
    excess = sum(2.0 * pi * float(weights @ r**2) / (c * approach) for c, _, r in parts)
    upper, lower = approach / energy, approach / (energy + excess)
    return lower * (1.0 - _ROUNDING), upper * (1.0 + _ROUNDING)


class _PanelPoints(NamedTuple):
    """Points ``y`` on every panel, weights of ``s ds``, and the panel ends ``1 - s``."""

    y: np.ndarray
    weights: np.ndarray
    ends: list[float]


def _points(series: LogSeries) -> _PanelPoints:
    panels = len(series.coefficients)
    # a coarse pressure jumps between panels, and the residual has logarithms there: blunt them
    g, w = roots_legendre(_POINTS)
    g, w = g * (3.0 - g**2) / 2.0, w * 1.5 * (1.0 - g**2)
    x = series.width * (np.arange(panels)[:, None] + (1.0 + g) / 2.0)
    y = np.exp(-x)
    end = exp(-panels * series.width)
    tail = end * (1.0 + g) / 2.0
    weights = np.concatenate([(y * w * series.width / 4.0).ravel(), w * end / 4.0])
    ends = [exp(-k * series.width) for k in range(1, panels + 1)]
    ends = [e / (1.0 + sqrt(1.0 - e)) for e in ends]
    return _PanelPoints(np.concatenate([y.ravel(), tail]), weights, ends)
