"""Pressure and traction on zones, from the series on their parts.

A zone that is an annulus has two parts, its inner and its outer half; the stick disk is one part.
``y = 1 - s**2`` at the radius s; alpha, beta, kappa, f are those of `Parameters`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import atan, exp, gamma, pi
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.tuning import MAX_STEPS
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


def all_positive(pressures: Sequence[LogSeries]) -> bool:
    """Return whether the pressure is positive on all parts; else the contact would open."""
    return bool(np.min([pressure(DISTANCES) for pressure in pressures]) > 0.0)


def fields_in_stick(solved: ZoneSolution) -> Iterator[tuple[Array, Array]]:
    """Yield q and p at `DISTANCES` from every boundary of a stick zone."""
    for k, shear in solved.shears.items():
        points = solved.system.parts[k].mesh.points(DISTANCES)
        radius = np.sqrt(np.maximum(points.z, 0.0))
        yield radius * shear(DISTANCES), solved.pressures[k](DISTANCES)


def stick_tractions(
    states: tuple[int, ...], bounds: Sequence[Radius], shears: Mapping[int, LogSeries]
) -> dict[int, DiskSeries | AnnulusSeries]:
    """Return the traction of each stick zone by its number.

    Parameters
    ----------
    states : tuple of int
        Of the zones: 0 for stick.
    bounds : sequence of Radius
        Boundaries, with centre and edge.
    shears : mapping of int to LogSeries
        q/s on each part in stick: part 0 is the disk, parts ``2 k - 1`` and ``2 k`` are the halves
        of zone k.
    """
    tractions: dict[int, DiskSeries | AnnulusSeries] = {}
    for zone, state in enumerate(states):
        if state != 0:
            continue
        if zone == 0:
            tractions[zone] = DiskSeries(bounds[1], shears[0].times(bounds[1].value))
        else:
            inner_half = shears[2 * zone - 1]
            outer_half = shears[2 * zone]
            tractions[zone] = AnnulusSeries(bounds[zone], bounds[zone + 1], inner_half, outer_half)
    return tractions


def pressure_field(solved: ZoneSolution, parameters: Parameters) -> ZonalField:
    """Return the pressure on all zones."""
    series = [*solved.pressures[:-1], _pressure_at_edge(solved, parameters)]
    return ZonalField.on_parts(solved.system.bounds, series)


def min_stick_radius(parameters: Parameters) -> float:
    """Return the stick radius of a smooth surface under little friction, to a factor of 2.

    It is the sum of its limits: ``4 exp(-2 kappa/f)`` without tangential compliance, ``2 beta f``
    with much of it.
    """
    _, beta, kappa, friction = parameters
    return 4.0 * exp(-2.0 * kappa / friction) + 2.0 * beta * friction


def edge_stick_width(parameters: Parameters, theta: float) -> float:
    """Return about the width in y of the stick at the edge of a smooth surface.

    Under little friction ``u = -kappa/(2 pi)`` at the edge and ``p = y**(theta - 1/2)/(2 pi)`` next
    to it, and the layer makes up for u where ``beta f p`` does: ``w**(1/2 - theta) = beta
    f/kappa`` (docs/coupling.md). With f/kappa from 0.3 to 4 the width is ``exp(f/kappa)`` times
    that, to a factor of 6.

    Parameters
    ----------
    parameters : Parameters
        With tangential compliance. Without elastic coupling those for kappa = 1.
    theta : float
        `edge_exponent` with elastic coupling, else 0.
    """
    _, beta, kappa, friction = parameters
    ratio = friction / kappa
    with np.errstate(all="ignore"):  # a width beyond the range of doubles is 0 or infinite
        return float(np.exp(ratio + np.log(beta * ratio) / (0.5 - theta)))


def edge_exponent(parameters: Parameters) -> float:
    """Return theta of ``p ~ y**(theta - 1/2)`` next to a smooth edge in slip with coupling."""
    return atan(2.0 * parameters.kappa * parameters.friction) / pi


def with_central_asymptote(
    pressure: ZonalField, radius: Radius, parameters: Parameters
) -> ZonalField:
    """Return the pressure on a smooth surface with a closed form inside a radius.

    In slip ``p ~ s**-e / sqrt(1 - s**2)`` there, down to the stick disk, in which p is regular.

    Parameters
    ----------
    pressure : ZonalField
        Its first piece is replaced.
    radius : Radius
        Where the closed form takes its value from the pressure.
    parameters : Parameters
    """
    exponent = _central_exponent(parameters.kappa * parameters.friction)
    at_radius = float(pressure(np.array([radius.value]), np.array([radius.from_edge]))[0])
    pieces = [_power_piece(radius, at_radius, -exponent), *pressure.pieces[1:]]
    stick_radius = min_stick_radius(parameters)
    if stick_radius > np.sqrt(TINY):
        at_stick_radius = at_radius * (radius.value / stick_radius) ** exponent
        rim = Radius(stick_radius, 1.0 - stick_radius)
        pieces.insert(0, _power_piece(rim, at_stick_radius, 0.0))
    return ZonalField(tuple(pieces))


def _power_piece(outer: Radius, at_outer: float, exponent: float) -> ZonePiece:
    """Return ``s**exponent / sqrt(1 - s**2)`` inside a radius, scaled to a value there."""
    shift = (1.0 - outer.square) / outer.square
    weight = EdgeWeight(at_outer * float(np.sqrt(shift)), shift)
    return ZonePiece(outer, DiskSeries(outer, None, weight, power=0, exponent=exponent))


def _central_exponent(coupling: float) -> float:
    """Return the exponent e of ``p ~ s**-e``, from a fixed-point iteration.

    With ``q = f p`` the displacements that p and q make in normal direction are powers of s, too,
    and have to cancel. Each round lowers the error by the factor ``3 kappa f``, 1/20 at most.

    Parameters
    ----------
    coupling : float
        ``kappa f``.
    """
    e = 2.0 * coupling
    for _ in range(MAX_STEPS):
        ratio = gamma(1.0 + e / 2.0) * gamma((1.0 - e) / 2.0)
        e = 2.0 * coupling * (1.0 - e) * ratio / (gamma((1.0 + e) / 2.0) * gamma(1.0 - e / 2.0))
    return e


def _pressure_at_edge(solved: ZoneSolution, parameters: Parameters) -> LogSeries:
    """Return the pressure next to the edge; where it is singular it ends in its leading term."""
    series = solved.pressures[-1]
    if series.power == 0.0 or solved.system.states[-1]:
        return series
    shear = solved.shears[2 * len(solved.system.radii)]
    return with_asymptotic_tail(series, shear, parameters, gap(*solved.system.bounds[-2:]) / 2.0)[0]
