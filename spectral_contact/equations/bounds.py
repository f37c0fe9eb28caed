r"""Two-sided bounds of the approach, from any pressure and its residual.

With ``A = alpha + N`` and the product ``<a, b> = int a b s ds``, the pressure under unit approach
is ``A^-1 1``, and its load over 2 pi is ``m = <1, A^-1 1> = 1/(2 pi delta)``. Any pressure u leaves
a residual ``r = 1 - A u``, and

    m - (<1, u> + <r, u>) = <r, A^-1 r>,   0 <= <r, A^-1 r> <= <r, r>/alpha,

because N is positive: the energy (Ritz) bounds m from below and the complementary energy from
above. With elastic coupling and full stick the same holds for the system of both equations, whose
elastic part is positive because it is the work on an elastic body: A, u and r have two components,
and the last bound is ``<r_1, r_1>/alpha + <r_2, r_2>/beta``. The residual is computed with the
elliptic kernels (`equations.residuals`), by quadrature that shares no step with the solver; from
the solver come u itself and the ends of its panels. So the bounds are rigorous up to the rounding
and the quadrature of these integrals.
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
#: Nodes of the quadrature on every panel (chosen).
_POINTS = 28


@dataclass(frozen=True, slots=True)
class CoupledTraction:
    """The traction of full stick, which acts back on the pressure.

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
        ``delta*`` as computed: the pressure over this is u. It need not be accurate, as the bounds
        hold for any u.
    pressure : PressureField
        ``p*``.
    coupled : CoupledTraction, optional
        With elastic coupling.
    """
    assert pressure.series is not None

    def pressure_at(from_edge: np.ndarray) -> np.ndarray:
        return pressure.evaluate(from_edge * (2.0 - from_edge))

    y, weights, breaks = _points(pressure.series)
    p = pressure.evaluate(y)
    from_edge = y / (1.0 + np.sqrt(1.0 - y))  # 1 - s
    places = from_edge.tolist()
    deflection = np.array([normal_displacement(pressure_at, d, breaks) for d in places])
    residual = approach - compliance * p - deflection
    # compliance, field and residual of each equation; with the approach delta, as computed, fields
    # are delta u and residuals delta r
    equations = [(compliance, p, residual)]
    if coupled is not None:
        traction = coupled.field
        kappa = coupled.kappa

        def traction_at(from_edge: np.ndarray) -> np.ndarray:
            return traction(1.0 - from_edge, from_edge)

        lift = np.array([shear_lift(traction_at, kappa, d, breaks) for d in places])
        displacements = [
            tangential_displacement(traction_at, pressure_at, kappa, d, breaks) for d in places
        ]
        outward, inward = np.array(displacements).T
        q = traction_at(from_edge)
        equations = [
            (compliance, p, residual + lift),
            (coupled.compliance, q, inward - outward - coupled.compliance * q),
        ]
    # 2 pi delta m is at least 2 pi delta (<1, u> + <r, u>); the bound from above is larger by
    # `excess`. The approach itself is 1/(2 pi m).
    least = 2.0 * pi * load(pressure_at, breaks=breaks)
    least += sum(2.0 * pi * float(weights @ (r * u)) / approach for _, u, r in equations)
    excess = sum(2.0 * pi * float(weights @ r**2) / (c * approach) for c, _, r in equations)
    upper = approach / least
    lower = approach / (least + excess)
    return lower * (1.0 - _ROUNDING), upper * (1.0 + _ROUNDING)


class _PanelPoints(NamedTuple):
    """Quadrature over the contact, on the panels of a pressure and on its tail.

    Attributes
    ----------
    y : ndarray
        Points, as ``y = 1 - s**2``.
    weights : ndarray
        Of the measure ``s ds``.
    ends : list of float
        Distances from the edge, ``1 - s``, at which panels end.
    """

    y: np.ndarray
    weights: np.ndarray
    ends: list[float]


def _points(series: LogSeries) -> _PanelPoints:
    panels = len(series.coefficients)
    nodes, node_weights = roots_legendre(_POINTS)
    # A coarse pressure jumps between panels, so that the residual has logarithms at their ends.
    # The substitution g (3 - g**2)/2, whose derivative is 0 at the ends, makes them integrable.
    g = nodes * (3.0 - nodes**2) / 2.0
    w = node_weights * 1.5 * (1.0 - nodes**2)
    x = series.width * (np.arange(panels)[:, None] + (1.0 + g) / 2.0)
    y = np.exp(-x)
    tail_length = exp(-panels * series.width)
    tail = tail_length * (1.0 + g) / 2.0
    # s ds = -dy/2, and dy = -y dx on the panels
    weights = np.concatenate([(y * w * series.width / 4.0).ravel(), w * tail_length / 4.0])
    ends = [exp(-k * series.width) for k in range(1, panels + 1)]
    ends = [y_end / (1.0 + sqrt(1.0 - y_end)) for y_end in ends]
    return _PanelPoints(np.concatenate([y.ravel(), tail]), weights, ends)
