"""The fields and numbers of full stick: one zone without a boundary, equation (4.2) of the paper.

Radii s are over the radius of the contact; ``y = 1 - s**2`` is the distance from the edge, and
``x = -ln y`` the depth there. kappa is the coupling parameter of docs/theory.

Without elastic coupling the traction is proportional to kappa, and everything is computed for
kappa = 1. With coupling, on a smooth surface and under a thin layer, pressure and traction
oscillate near the edge, and the pressure is negative in places: there the contact would open. The
result solves the equations as they stand, in which the surfaces cannot part; `FullStick.opening` is
where they would.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan2, exp, inf, log, pi, sqrt

import numpy as np

from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement, SpaceSolution
from spectral_contact.contact.relative_changes import relative_changes
from spectral_contact.contact.resolution import (
    TINY,
    first_sign_change,
    relative_panel_changes,
    sample_depths,
)
from spectral_contact.contact.tuning import FIELD_ROUNDING
from spectral_contact.contact.zone_solution import ZoneSolution
from spectral_contact.contact.zone_spaces import with_asymptotic_tail
from spectral_contact.fields.series import EDGE, DiskSeries, EdgeWeight, LogSeries, PressureField
from spectral_contact.spectral.transforms import series_of


def full_stick(
    solved: Refinement[ZoneSolution],
    contact: NormalContact | None = None,
    *,
    pointwise: bool = True,
    ratios: bool = True,
) -> Refinement[FullStick]:
    """Return the refinement of a contact that sticks everywhere, with `FullStick` as its value.

    Parameters
    ----------
    solved : Refinement
        What `solve_stick` returns, for unit load. Its best solution is that of the largest space.
    contact : NormalContact, optional
        The normal contact whose pressure was known: without elastic coupling.
    pointwise : bool
        Whether pressure and traction are wanted as functions of the radius, and not only approach
        and total shear. Under a known pressure both are there in any case.
    ratios : bool
        Whether the ratios of traction to pressure are wanted, under a known pressure.
    """
    zones = solved.best.value
    normal = zones if contact is None else contact
    result = FullStick(
        approach=normal.approach,
        total_shear=zones.total_shear,
        approach_error=normal.approach_error,
        shear_error=zones.shear_error,
    )
    if contact is not None:
        result = _with_known_pressure(result, solved.best, contact, ratios=ratios)
    elif pointwise:
        result = _with_unknown_pressure(result, zones)
    best = replace(solved.best, value=result)  # type: ignore[arg-type]
    return replace(solved, best=best)  # type: ignore[return-value]


def smooth_full_stick(contact: NormalContact) -> FullStick:
    """Return full stick on a smooth surface under the pressure that it has without friction.

    The exact traction is ``q = -kappa ln(y) / (pi**2 s sqrt(y))``, an endpoint weight without a
    series, and the total shear is ``2 kappa ln 2`` (docs/theory). There is nothing to refine.
    """
    return FullStick(
        approach=contact.approach,
        total_shear=2.0 * log(2.0),
        approach_error=contact.approach_error,
        shear_error=FIELD_ROUNDING,
        pressure=contact.pressure,
        traction=DiskSeries(EDGE, None, EdgeWeight(1.0 / pi**2, 0.0, logarithmic=True)),
        edge_ratio=inf,
        pressure_error=contact.pressure_error,
        traction_error=FIELD_ROUNDING,
    )


def _with_unknown_pressure(totals: FullStick, zones: ZoneSolution) -> FullStick:
    """Add both fields to the totals, and their ratio if the pressure is positive.

    Pressure and traction are both unknown fields of the system: with elastic coupling.
    """
    system = zones.system
    parameters = system.parameters
    pressure, shear = with_asymptotic_tail(zones.pressures[0], zones.shears[0], parameters, 1.0)
    opening = _opening(pressure)
    result = totals._replace(
        pressure=PressureField(None, pressure),
        traction=DiskSeries(EDGE, shear),
        opening=opening,
        pressure_error=zones.pressure_error,
        traction_error=zones.traction_error,
    )
    if opening is not None or pressure.oscillation:
        return result
    panels = system.fields[-1].panels
    # column 0 holds the coefficients of the solution, column 1 what the top two degrees contribute
    field_changes = relative_changes(system, zones.solution[:, 0], zones.solution[:, 1])
    changes = [(panels, change) for change in field_changes]
    return result.with_ratios(panels.count * panels.width, changes, _edge_change(zones))


def _with_known_pressure(
    totals: FullStick,
    solution: SpaceSolution[ZoneSolution],
    contact: NormalContact,
    *,
    ratios: bool,
) -> FullStick:
    """Add both fields to the totals, and their ratio if it is wanted.

    The pressure is that of the normal contact, the traction is the unknown field of the system.
    """
    zones = solution.value
    result = totals._replace(
        pressure=contact.pressure,
        traction=DiskSeries(EDGE, zones.shears[0]),
        pressure_error=contact.pressure_error,
        traction_error=zones.traction_error,
    )
    if not ratios:
        return result
    panels = zones.system.fields[-1].panels
    changes = [(panels, solution.indicators)]
    edge_change = _edge_change(zones)
    if contact.panels is not None and contact.changes:
        top = contact.changes[0].coefficients
        pressure_changes = relative_panel_changes(contact.panels, top, contact.pressure.at_ends())
        changes.append((contact.panels, pressure_changes))
        edge_change += abs(series_of(contact.panels, top).limit / contact.pressure.value(0.0))
    return result.with_ratios(panels.count * panels.width, changes, edge_change)


def _edge_change(zones: ZoneSolution) -> float:
    """Return the sum of the relative changes of the unknown fields at the edge.

    It is 0 if one of them is singular there (its panels have a power), because the ratio is then 0
    or infinite, and has no error.
    """
    fields = zones.system.fields
    if any(field.panels.power for field in fields):
        return 0.0
    total = 0.0
    for field in fields:
        limit, *changes = (
            series_of(field.panels, coefficients).limit
            for coefficients in field.coefficients(zones.solution).T
        )
        total += max(map(abs, changes)) / abs(limit)
    return total


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance ``1 - s`` from the edge of the innermost place where the pressure is 0.

    Outward from the centre, where it is positive, that is the first change of sign. None if there
    is none, or if it is nearer to the edge than doubles resolve.
    """
    panel_count = len(pressure.coefficients)
    depth = panel_count * pressure.width
    # by experience as many points as coefficients show every change of sign
    x = sample_depths(depth, pressure.coefficients.size + 1)
    negative = np.flatnonzero(pressure(np.exp(-x)) <= 0.0)
    if len(negative):
        i = int(negative[0])
        depth = first_sign_change(lambda x: pressure(np.exp(-x)), x[i - 1], x[i])
    elif pressure.oscillation:
        # the tail is a cos(theta x) + b sin(theta x), with x from the end of the panels
        depth += atan2(pressure.tail[0], -pressure.tail[1]) / pressure.oscillation
    else:
        return None
    y = exp(-depth)
    distance = y / (1.0 + sqrt(1.0 - y))  # 1 - s without cancellation
    return distance if distance > TINY else None
