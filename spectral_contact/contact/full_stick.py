"""Full stick: one zone without a boundary, equation (4.2), with elastic coupling or without.

Without coupling everything is computed for kappa = 1; the traction is proportional to it. With
coupling, on a smooth surface and under a thin layer, pressure and traction oscillate near the edge,
and the pressure is negative in places: there the contact would open. The result solves the
equations as they stand, in which the surfaces cannot part; `FullStick.opening` is where they would.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan2, exp, inf, log, pi, sqrt

import numpy as np

from spectral_contact.contact.error_estimate import ZoneSolution, relative_changes
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Refinement, SpaceSolution
from spectral_contact.contact.resolution import (
    TINY,
    NormalContact,
    first_sign_change,
    relative_panel_changes,
    sample_depths,
)
from spectral_contact.contact.tuning import FIELD_ROUNDING
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
    """Return a solution that sticks everywhere as full stick, for unit load.

    Parameters
    ----------
    solved : Refinement
        As `solve_stick` returns it.
    contact : NormalContact, optional
        The normal contact with the pressure, if that was known.
    pointwise : bool
        Whether the fields are wanted; under a known pressure they always come along.
    ratios : bool
        Whether the ratios of traction to pressure are wanted, under a known pressure.
    """
    zones = solved.best.value
    if contact is None:
        approach = zones.approach
        approach_error = zones.approach_error
    else:
        approach = contact.approach
        approach_error = contact.approach_error
    stick = FullStick(
        approach=approach,
        total_shear=zones.total_shear,
        approach_error=approach_error,
        shear_error=zones.shear_error,
    )
    if contact is not None:
        stick = _with_known_pressure(stick, solved.best, contact, ratios=ratios)
    elif pointwise:
        stick = _with_unknown_pressure(stick, zones)
    best = replace(solved.best, value=stick)  # type: ignore[arg-type]
    return replace(solved, best=best)  # type: ignore[return-value]


def smooth_full_stick(contact: NormalContact) -> FullStick:
    """Return full stick on a smooth surface under the pressure that it has without friction.

    The weight ``-ln(y) / (s^2 sqrt y)`` is the exact solution, with ``Q* = 2 kappa ln 2``
    (docs/theory), and there is nothing to refine.
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


def _with_unknown_pressure(stick: FullStick, zones: ZoneSolution) -> FullStick:
    """Return full stick with both fields, and with their ratio if the pressure is positive."""
    system = zones.system
    parameters = system.parameters
    p, q = with_asymptotic_tail(zones.pressures[0], zones.shears[0], parameters, 1.0)
    opening = _opening(p)
    stick = stick._replace(
        pressure=PressureField(None, p),
        traction=DiskSeries(EDGE, q),
        opening=opening,
        pressure_error=zones.pressure_error,
        traction_error=zones.traction_error,
    )
    if opening is not None or p.oscillation:
        return stick
    panels = system.fields[-1].panels
    field_changes = relative_changes(system, zones.solution[:, 0], zones.solution[:, 1])
    changes = [(panels, change) for change in field_changes]
    return stick.with_ratios(panels.panels * panels.width, changes, _edge_change(zones))


def _with_known_pressure(
    stick: FullStick, solution: SpaceSolution[ZoneSolution], contact: NormalContact, *, ratios: bool
) -> FullStick:
    """Return full stick with both fields, and with their ratio if it is wanted."""
    zones = solution.value
    stick = stick._replace(
        pressure=contact.pressure,
        traction=DiskSeries(EDGE, zones.shears[0]),
        pressure_error=contact.pressure_error,
        traction_error=zones.traction_error,
    )
    if not ratios:
        return stick
    panels = zones.system.fields[-1].panels
    changes = [(panels, solution.indicators)]
    edge_change = _edge_change(zones)
    if contact.panels is not None and contact.changes:
        top = contact.changes[0].coefficients
        relative = relative_panel_changes(contact.panels, top, contact.pressure.at_ends())
        changes.append((contact.panels, relative))
        edge_change += abs(series_of(contact.panels, top).limit / contact.pressure.value(0.0))
    return stick.with_ratios(panels.panels * panels.width, changes, edge_change)


def _edge_change(zones: ZoneSolution) -> float:
    """Return the sum of the relative changes of the unknown fields at the edge.

    It is 0 if one of them is singular there: the ratio is 0 or infinite then.
    """
    fields = zones.system.fields
    if any(field.panels.power for field in fields):
        return 0.0
    total = 0.0
    for field in fields:
        limit, *changes = (
            series_of(field.panels, column).limit for column in field.coefficients(zones.solution).T
        )
        total += max(map(abs, changes)) / abs(limit)
    return total


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance ``1 - s`` from the edge at which the pressure first changes sign."""
    count = len(pressure.coefficients)
    depth = count * pressure.width
    # as many points as coefficients show every change of sign
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
    distance = y / (1.0 + sqrt(1.0 - y))  # 1 - s, without cancellation
    return distance if distance > TINY else None
