"""Full stick: one zone without a boundary, equation (4.2), with elastic coupling or without.

Without it everything is computed for kappa = 1; the traction is proportional to it. With it, under
a thin layer, and on a smooth surface always, both tractions oscillate near the edge, and the
pressure would be negative in places: there the contact would open. What is returned solves the
equations as they stand, in which the surfaces cannot part; `FullStick.opening` says where they
would.
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
from spectral_contact.contact.tuning import CLOSED_FORM_ROUNDING, FUNCTIONAL_SAFETY
from spectral_contact.contact.zone_spaces import with_asymptotic_tail
from spectral_contact.fields.series import EDGE, DiskSeries, EdgeWeight, LogSeries, PressureField
from spectral_contact.spectral.transforms import series_of


def full_stick(
    found: Refinement[ZoneSolution],
    contact: NormalContact | None = None,
    *,
    pointwise: bool = True,
    ratios: bool = True,
) -> Refinement[FullStick]:
    """Return a solution that sticks everywhere as full stick, for unit load.

    Parameters
    ----------
    found : Refinement
        As `solve_stick` returns it.
    contact : NormalContact, optional
        With the pressure, if it was known.
    pointwise : bool
        Whether the fields are wanted; under a pressure that is given they are at hand.
    ratios : bool
        Whether the ratios of traction to pressure are, under a pressure that is given.
    """
    zones, own = found.best.value, found.best.value if contact is None else contact
    stick = FullStick(
        approach=own.approach,
        total_shear=zones.total_shear,
        approach_error=own.approach_error,
        shear_error=zones.shear_error,
    )
    if pointwise or contact is not None:
        stick = _with_fields(stick, found.best, contact, ratios=ratios)
    best = replace(found.best, value=stick)  # type: ignore[arg-type]
    return replace(found, best=best)  # type: ignore[return-value]


def smooth_full_stick(contact: NormalContact) -> FullStick:
    """Return full stick on a smooth surface under the pressure that it has without friction.

    The weight ``-ln(y) / (s^2 sqrt y)`` is the exact solution, with ``Q* = 2 kappa ln 2``
    (docs/theory), and there is nothing to refine.
    """
    return FullStick(
        approach=contact.approach,
        total_shear=2.0 * log(2.0),
        approach_error=contact.approach_error,
        shear_error=CLOSED_FORM_ROUNDING,
        pressure=contact.pressure,
        traction=DiskSeries(EDGE, None, EdgeWeight(1.0 / pi**2, 0.0, logarithmic=True)),
        edge_ratio=inf,
        pressure_error=contact.pressure_error,
        traction_error=CLOSED_FORM_ROUNDING,
    )


def _with_fields(
    stick: FullStick,
    solved: SpaceSolution[ZoneSolution],
    contact: NormalContact | None,
    *,
    ratios: bool,
) -> FullStick:
    """Return full stick with its fields, and with their ratio where it means something."""
    zones, system, q, opening = solved.value, solved.value.system, solved.value.shears[0], None
    panels = system.fields[-1].panels
    if contact is None:
        p, q = with_asymptotic_tail(zones.pressures[0], q, system.parameters, 1.0)
        pressure, opening = PressureField(None, p), _opening(p)
        ratios = opening is None and not p.oscillation
        each = relative_changes(system, zones.solution[:, 0], zones.solution[:, 1])
        shares = [(panels, one) for one in each]
    else:
        pressure, shares = contact.pressure, [(panels, solved.indicators)]
    stick = stick._replace(
        pressure=pressure,
        traction=DiskSeries(EDGE, q),
        opening=opening,
        pressure_error=zones.pressure_error if contact is None else contact.pressure_error,
        traction_error=zones.traction_error,
    )
    if not ratios:
        return stick
    at_edge = 0.0 if any(one.panels.power for one in system.fields) else _at_edge(zones)
    if contact is not None and contact.panels is not None and contact.changes:
        mesh, lost = contact.panels, contact.changes[0].coefficients
        share = relative_panel_changes(mesh, lost, pressure.at_ends())
        shares.append((mesh, FUNCTIONAL_SAFETY * contact.rate**2 * share))
        at_edge += abs(series_of(mesh, lost).limit / pressure.value(0.0))
    return stick.with_ratios(panels.panels * panels.width, shares, at_edge)


def _at_edge(solved: ZoneSolution) -> float:
    """Return the changes of the fields at the edge, relative to them."""
    total = 0.0
    for one in solved.system.fields:
        whole, *changed = (
            series_of(one.panels, v).limit for v in one.coefficients(solved.solution).T
        )
        total += max(map(abs, changed)) / abs(whole)
    return total


def _opening(pressure: LogSeries) -> float | None:
    """Return the distance from the edge at which the pressure first changes sign."""
    count = len(pressure.coefficients)
    depth = count * pressure.width
    x = sample_depths(depth, 8 * count + 1)  # close enough to see every change of sign
    negative = np.flatnonzero(pressure(np.exp(-x)) <= 0.0)
    if len(negative):
        i = int(negative[0])
        depth = first_sign_change(lambda x: pressure(np.exp(-x)), x[i - 1], x[i])
    elif pressure.oscillation:
        depth += atan2(pressure.tail[0], -pressure.tail[1]) / pressure.oscillation
    else:
        return None
    y = exp(-depth)
    distance = y / (1.0 + sqrt(1.0 - y))
    return distance if distance > TINY else None
