"""Pressure and traction on any zones, from the series of their parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import exp, gamma
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.zone_spaces import with_asymptotic_tail
from spectral_contact.fields.series import (
    AnnulusSeries,
    Array,
    DiskSeries,
    EdgeWeight,
    LogSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import gap

if TYPE_CHECKING:
    from spectral_contact.contact.error_estimate import ZoneSolution

#: Rounds of a fixed point whose error falls by 3 kappa f, a twentieth, in each.
_ROUNDS = 14


def positive(pressures: Sequence[LogSeries]) -> bool:
    """Return whether the pressure on all parts is: else the contact would open."""
    return bool(np.min([one(DISTANCES) for one in pressures]) > 0.0)


def in_stick(solved: ZoneSolution) -> Iterator[tuple[Array, Array]]:
    """Yield q and p at `DISTANCES` from every end of a stick zone."""
    for k, shear in solved.shears.items():
        at = solved.system.parts[k].family.points(DISTANCES)
        yield np.sqrt(np.maximum(at.z, 0.0)) * shear(DISTANCES), solved.pressures[k](DISTANCES)


def stick_series(
    states: tuple[int, ...], bounds: Sequence[Radius], shear: Mapping[int, LogSeries]
) -> dict[int, DiskSeries | AnnulusSeries]:
    """Return the tractions of the stick zones, of q/s on the parts."""
    found: dict[int, DiskSeries | AnnulusSeries] = {}
    for zone in (k for k, state in enumerate(states) if state == 0):
        if zone:
            both = shear[2 * zone - 1], shear[2 * zone]
            found[zone] = AnnulusSeries(bounds[zone], bounds[zone + 1], *both)
        else:
            found[zone] = DiskSeries(bounds[1], shear[0].times(bounds[1].value))
    return found


def pressure_field(solved: ZoneSolution, parameters: Parameters) -> ZonalField:
    """Return the pressure on all zones."""
    series = [*solved.pressures[:-1], _to_the_edge(solved, parameters)]
    return ZonalField.on_parts(solved.system.bounds, series)


def least_radius(parameters: Parameters) -> float:
    """Return the stick radius of a smooth surface under little friction, to a factor of 2."""
    _, beta, kappa, friction = parameters
    return 4.0 * exp(-2.0 * kappa / friction) + 2.0 * beta * friction


def to_the_centre(pressure: ZonalField, within: Radius, parameters: Parameters) -> ZonalField:
    """Return the pressure under a smooth punch with what it is within a radius from the centre.

    Where slip goes there ``p ~ s**-e / sqrt(1 - s**2)``, down to a stick disk that is not felt.
    """
    exponent = _central_exponent(parameters.kappa * parameters.friction)
    at_rim = float(pressure(np.array([within.value]), np.array([within.from_edge]))[0])
    pieces = [_around_centre(within, at_rim, -exponent), *pressure.pieces[1:]]
    stuck = least_radius(parameters)
    if stuck > np.sqrt(TINY):
        value = at_rim * (within.value / stuck) ** exponent
        pieces.insert(0, _around_centre(Radius(stuck, 1.0 - stuck), value, 0.0))
    return ZonalField(tuple(pieces))


def _around_centre(outer: Radius, at_rim: float, exponent: float) -> ZonePiece:
    """Return ``s**exponent / sqrt(1 - s**2)`` up to a radius, with this value there."""
    shift = (1.0 - outer.square) / outer.square
    weight = EdgeWeight(at_rim * float(np.sqrt(shift)), shift)
    return ZonePiece(outer, DiskSeries(outer, None, weight, power=0, exponent=exponent))


def _central_exponent(coupling: float) -> float:
    """Return e of ``s**-e``: by what this presses down the surface its traction lifts it."""
    e = 2.0 * coupling
    for _ in range(_ROUNDS):
        ratio = gamma(1.0 + e / 2.0) * gamma((1.0 - e) / 2.0)
        e = 2.0 * coupling * (1.0 - e) * ratio / (gamma((1.0 + e) / 2.0) * gamma(1.0 - e / 2.0))
    return e


def _to_the_edge(solved: ZoneSolution, parameters: Parameters) -> LogSeries:
    """Return the pressure next to the edge; where it is singular it ends in its leading term."""
    series = solved.pressures[-1]
    if series.power == 0.0 or solved.system.states[-1]:
        return series
    shear = solved.shears[2 * len(solved.system.radii)]
    return with_asymptotic_tail(series, shear, parameters, gap(*solved.system.bounds[-2:]) / 2.0)[0]
