"""Full stick with elastic coupling: one zone without a boundary, and the ratios q/p in it.

Under a thin layer, and on a smooth surface always, both tractions oscillate near the edge, and the
pressure would be negative in places: there the contact would open. What is returned solves the
equations as they stand, in which the surfaces cannot part; `FullStick.opening` says where they
would.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan2, exp, inf, sqrt

import numpy as np

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.resolution import TINY, crossing, places, series_of
from spectral_contact.contact.zone_assessment import ZoneSolution, shares_of, sizes_of
from spectral_contact.contact.zone_problem import solve_zones
from spectral_contact.contact.zone_spaces import ended
from spectral_contact.fields.series import EDGE, DiskSeries, LogSeries, PressureField
from spectral_contact.spectral.parameters import Parameters


def solve_coupled_stick(
    alpha: float,
    beta: float,
    kappa: float,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[FullStick]:
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
    """
    parameters, layout = Parameters(alpha, beta, kappa, inf), Layout((), (0,))
    found = solve_zones(parameters, layout, tolerance, max_unknowns, pointwise=pointwise)
    solved = found.best.value
    stick = FullStick(
        approach=solved.approach,
        total_shear=solved.total_shear,
        approach_error=solved.approach_error,
        shear_error=solved.shear_error,
    )
    if pointwise:
        stick = _with_fields(stick, solved)
    best = replace(found.best, value=stick)  # type: ignore[arg-type]
    return replace(found, best=best)  # type: ignore[return-value]


def _with_fields(stick: FullStick, solved: ZoneSolution) -> FullStick:
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
    if stick.opening is not None or p.oscillation:
        return stick
    changes = shares_of(system, solved.solution[:, 1], sizes_of(system, solved.solution[:, 0]))
    panels, at_edge = system.parts[0].family.panels, 0.0
    shares = [(panels, one) for one in changes]
    for one in system.fields:
        whole, *changed = (series_of(one.panels, v).limit for v in one.of(solved.solution).T)
        at_edge += max(map(abs, changed)) / abs(whole)
    return stick.with_ratios(panels.panels * panels.width, shares, at_edge)


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance from the edge at which the pressure first changes sign."""
    count = len(pressure.coefficients)
    depth = count * pressure.width
    x = places(depth, 8 * count + 1)  # close enough to see every change of sign
    negative = np.flatnonzero(pressure(np.exp(-x)) <= 0.0)
    if len(negative):
        i = int(negative[0])
        depth = crossing(lambda x: pressure(np.exp(-x)), x[i - 1], x[i])
    elif pressure.oscillation:
        depth += atan2(pressure.tail[0], -pressure.tail[1]) / pressure.oscillation
    else:
        return None
    y = exp(-depth)
    distance = y / (1.0 + sqrt(1.0 - y))
    return distance if distance > TINY else None
