"""Full stick with elastic coupling: one zone without a boundary, and the ratios q/p in it.

Under a thin layer, and on a smooth surface always, both tractions oscillate near the edge, and the
pressure would be negative in places: there the contact would open. What is returned solves the
equations as they stand, in which the surfaces cannot part; `CoupledStick.opening` says where they
would.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, exp, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_assessment import CoupledZones
from spectral_contact.contact.coupled_errors import shares_of, sizes_of
from spectral_contact.contact.coupled_parts import ended
from spectral_contact.contact.coupled_problem import solve_coupled_zones
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.ratio import AT_ONE_PLACE, largest_ratio
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.resolution import ROUNDING, panel_of, series_of
from spectral_contact.fields.series import EDGE, DiskSeries, LogSeries, PressureField
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.tangential import Tangential

__all__ = ["CoupledStick", "solve_coupled_stick"]

Array = NDArray[np.float64]

#: What rounding leaves of q/p.
_ROUNDING = 20.0 * ROUNDING
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
    critical_at : float
        ``y`` where that is.
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
    edge_error: float = 4.0 * ROUNDING
    critical_error: float = 4.0 * ROUNDING

    @property
    def slips_inside(self) -> bool:
        """Whether slip begins away from the edge."""
        return self.edge_ratio is not None and self.edge_ratio < self.critical


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
    parameters, layout = Parameters(alpha, beta, kappa, inf), Layout((), (0,))
    found = solve_coupled_zones(parameters, layout, tolerance, max_unknowns, pointwise=pointwise)
    solved = found.best.value
    stick = CoupledStick(
        solved.approach, solved.total_shear, solved.approach_error, solved.shear_error
    )
    if pointwise:
        stick = _with_fields(stick, solved)
    best = replace(found.best, value=stick)  # type: ignore[arg-type]
    return replace(found, best=best)  # type: ignore[return-value]


def _with_fields(stick: CoupledStick, solved: CoupledZones) -> CoupledStick:
    """Return full stick with its fields, and their ratio where it means something."""
    system, [pressure], [shear] = solved.system, solved.pressures, solved.shears
    assert shear is not None
    p, q = ended(pressure, shear, system.parameters, 1.0)
    stick = replace(
        stick,
        pressure=PressureField(None, p),
        traction=DiskSeries(EDGE, q),
        opening=_opening(p),
        pressure_error=solved.pressure_error,
        traction_error=solved.traction_error,
    )
    if stick.opening is None and not p.oscillation:
        return _with_ratios(stick, system, solved.solution)
    return stick


def _with_ratios(stick: CoupledStick, system: Tangential, solution: Array) -> CoupledStick:
    """Return full stick with q/p at the edge and at its largest."""
    panels = system.parts[0].family.panels
    assert stick.pressure is not None
    assert stick.traction is not None
    edge, critical, where = largest_ratio(
        stick.pressure, stick.traction, panels.panels * panels.width
    )
    shares = shares_of(system, solution[:, 1], sizes_of(system, solution[:, 0]))
    at_edge = _change_at_edge(system, solution) if 0.0 < edge < inf else 0.0

    def error(y: float) -> float:
        """Estimate the error of q/p at one place: what its panels contribute."""
        places = sum(float(share[panel_of(panels, y)]) for share in shares)
        return _ROUNDING + AT_ONE_PLACE * places + (at_edge if y == 0.0 else 0.0)

    return replace(
        stick,
        edge_ratio=edge,
        critical=critical,
        critical_at=where,
        edge_error=error(0.0) if 0.0 < edge < inf else _ROUNDING,
        critical_error=error(where) if critical < inf else _ROUNDING,
    )


def _change_at_edge(system: Tangential, solution: Array) -> float:
    """Return what the top two degrees or the top one change at the edge, the larger of both."""
    limits = [
        [abs(series_of(one.panels, values).limit) for values in one.of(solution).T]
        for one in system.fields
    ]
    return sum(max(changes) / whole for whole, *changes in limits)


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance from the edge at which the pressure first changes sign."""
    count = len(pressure.coefficients)
    depth = count * pressure.width
    x = np.linspace(1e-3, depth, 8 * count + 1)  # close enough to see every change of sign
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
