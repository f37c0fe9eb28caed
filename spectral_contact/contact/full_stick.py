"""Full stick: one zone without a boundary, equation (4.2), with elastic coupling or without.

Without it everything is computed for kappa = 1; the traction is proportional to it. With it, under
a thin layer, and on a smooth surface always, both tractions oscillate near the edge, and the
pressure would be negative in places: there the contact would open. What is returned solves the
equations as they stand, in which the surfaces cannot part; `FullStick.opening` says where they
would.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan2, exp, inf, pi, sqrt

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.refine import Attempt, Refinement
from spectral_contact.contact.resolution import (
    CLOSED_FORM_ROUNDING,
    SAFETY,
    TINY,
    crossing,
    places,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.contact.zone_assessment import ZoneSolution, shares_of, sizes_of
from spectral_contact.contact.zone_spaces import ended
from spectral_contact.fields.series import EDGE, DiskSeries, EdgeWeight, LogSeries, PressureField
from spectral_contact.spectral.graded import graded_nodes


def full_stick(
    found: Refinement[ZoneSolution],
    drive: Drive | None = None,
    *,
    pointwise: bool = True,
    ratios: bool = True,
) -> Refinement[FullStick]:
    """Return a solution that sticks everywhere as full stick, for unit load.

    Parameters
    ----------
    found : Refinement
        As `solve_stick` returns it.
    drive : Drive, optional
        Of the pressure, if it was given.
    pointwise : bool
        Whether the fields are wanted.
    ratios : bool
        Whether the ratios of traction to pressure are, under a pressure that is given.
    """
    if drive is None:
        stick = _coupled(found.best.value, pointwise=pointwise)
    else:
        stick = _driven(found.best, drive, ratios=ratios)
    best = replace(found.best, value=stick)  # type: ignore[arg-type]
    return replace(found, best=best)  # type: ignore[return-value]


def smooth_full_stick(drive: Drive) -> FullStick:
    """Return full stick on a smooth surface under the pressure that it has without friction.

    The weight ``-ln(y) / (s^2 sqrt y)`` is the exact solution, and there is nothing to refine.
    """
    # the half-integral is R itself: Q = 2 pi int t R dt
    space = starting_resolution(0.0, float(np.finfo(float).eps))
    nodes, contact = graded_nodes(space.panels, space.degrees), drive.contact
    return FullStick(
        approach=contact.approach,
        total_shear=pi * float(nodes.weights @ Drive.targets([drive], nodes.d)[0]),
        approach_error=contact.approach_error,
        shear_error=CLOSED_FORM_ROUNDING,
        pressure=drive.pressure,
        traction=DiskSeries(EDGE, None, EdgeWeight(1.0 / pi**2, 0.0, logarithmic=True)),
        edge_ratio=inf,
        pressure_error=contact.pressure_error,
        traction_error=CLOSED_FORM_ROUNDING,
    )


def _driven(solved: Attempt[ZoneSolution], drive: Drive, *, ratios: bool) -> FullStick:
    """Return full stick under a given pressure."""
    zones, contact, pressure = solved.value, drive.contact, drive.pressure
    [shear], [field] = zones.shears, zones.system.fields
    assert shear is not None
    stick = FullStick(
        approach=contact.approach,
        total_shear=zones.total_shear,
        approach_error=contact.approach_error,
        shear_error=zones.shear_error,
        pressure=pressure,
        traction=DiskSeries(EDGE, shear),
        pressure_error=contact.pressure_error,
        traction_error=zones.traction_error,
    )
    if not ratios:
        return stick
    panels, shares = field.panels, [(field.panels, solved.indicators)]
    at_edge = 0.0 if panels.power else _at_edge(zones)
    if contact.panels is not None and contact.changes:
        lost = contact.changes[0].coefficients
        share = share_of_change(contact.panels, lost, pressure.at_ends())
        shares.append((contact.panels, SAFETY * contact.rate**2 * share))
        at_edge += abs(series_of(contact.panels, lost).limit / pressure.value(0.0))
    return stick.with_ratios(panels.panels * panels.width, shares, at_edge)


def _coupled(solved: ZoneSolution, *, pointwise: bool) -> FullStick:
    """Return full stick of one system, with the ratio of its fields where it means something."""
    stick = FullStick(
        approach=solved.approach,
        total_shear=solved.total_shear,
        approach_error=solved.approach_error,
        shear_error=solved.shear_error,
    )
    if not pointwise:
        return stick
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
    panels = system.parts[0].family.panels
    shares = [(panels, one) for one in changes]
    return stick.with_ratios(panels.panels * panels.width, shares, _at_edge(solved))


def _at_edge(solved: ZoneSolution) -> float:
    """Return the changes of the fields at the edge, relative to them."""
    total = 0.0
    for one in solved.system.fields:
        whole, *changed = (series_of(one.panels, v).limit for v in one.of(solved.solution).T)
        total += max(map(abs, changed)) / abs(whole)
    return total


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
