"""Pressure p and traction q on zones, from the series on their parts.

A zone that is an annulus has two parts, its inner and its outer half; the stick disk is one part.
The series of a traction is that of the *shear* q/s. s is the radius over that of the contact, and
``y = 1 - s**2``; alpha, beta, kappa, f are the compliances, the coupling and the friction of
docs/theory, in `Parameters`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import exp, gamma

import numpy as np

from spectral_contact.contact.friction_law import DISTANCES
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.tuning import MAX_STEPS
from spectral_contact.contact.zone_solution import ZoneSolution
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
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import z_difference


def all_positive(pressures: Sequence[LogSeries]) -> bool:
    """Return whether the pressure is positive on all parts; if not, the contact would open."""
    return bool(np.min([pressure(DISTANCES) for pressure in pressures]) > 0.0)


def fields_in_stick(
    system: ContactSystem, pressures: Sequence[LogSeries], shears: Mapping[int, LogSeries]
) -> Iterator[tuple[Array, Array]]:
    """Yield q and p at `DISTANCES` on every part that sticks, from p and q/s on the parts."""
    for k, shear in shears.items():
        points = system.parts[k].mesh.points(DISTANCES)
        s = np.sqrt(np.maximum(points.z, 0.0))
        yield s * shear(DISTANCES), pressures[k](DISTANCES)


def stick_tractions(
    states: tuple[int, ...], bounds: Sequence[Radius], shears: Mapping[int, LogSeries]
) -> dict[int, DiskSeries | AnnulusSeries]:
    """Return the traction q of each stick zone, by the number of the zone.

    Parameters
    ----------
    states : tuple of int
        Of the zones: 0 for stick.
    bounds : sequence of Radius
        The centre, the boundaries between the zones, and the edge.
    shears : mapping of int to LogSeries
        q/s on each part in stick: part 0 is the disk, parts ``2 k - 1`` and ``2 k`` are the halves
        of zone k.
    """
    tractions: dict[int, DiskSeries | AnnulusSeries] = {}
    for zone, state in enumerate(states):
        if state != 0:
            continue
        if zone == 0:
            # its series is multiplied by s over the radius of the disk, not by s
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


def estimated_stick_radius(parameters: Parameters) -> float:
    """Return the stick radius of a smooth surface under little friction, to a factor of 2.

    It is estimated by the sum of its asymptotes: ``4 exp(-2 kappa/f)`` without tangential
    compliance, and ``2 beta f/kappa`` with much of it.
    """
    ratio = parameters.friction / parameters.kappa
    return 4.0 * exp(-2.0 / ratio) + 2.0 * parameters.beta * ratio


def estimated_edge_stick_width(parameters: Parameters, theta: float) -> float:
    """Return an estimate of the width w in y of the stick at the edge of a smooth surface.

    Under little friction the body displaces the edge by ``u_r = -kappa/(2 pi)``, and next to it
    ``p = y**(theta - 1/2)/(2 pi)``. The edge sticks where the displacement of the compliance,
    ``beta f p``, exceeds that: ``w**(1/2 - theta) = beta f/kappa`` (docs/coupling.md). With f/kappa
    from 0.3 to 4 the width is ``exp(f/kappa)`` times that, to a factor of 6.

    Parameters
    ----------
    parameters : Parameters
        With tangential compliance. Without elastic coupling those for kappa = 1.
    theta : float
        `zone_spaces.edge_exponent` with elastic coupling, else 0.
    """
    ratio = parameters.friction / parameters.kappa
    with np.errstate(all="ignore"):  # a width beyond the range of doubles is 0 or infinite
        return float(np.exp(ratio + np.log(parameters.beta * ratio) / (0.5 - theta)))


def with_central_asymptote(
    pressure: ZonalField, radius: Radius, parameters: Parameters
) -> ZonalField:
    """Return the pressure on a smooth surface, replaced inside a radius by its asymptote.

    In slip next to the centre ``p ~ s**-e / sqrt(1 - s**2)``, down to the stick disk, in which p is
    regular.

    Parameters
    ----------
    pressure : ZonalField
        Its first piece is replaced.
    radius : Radius
        The radius, at which the asymptote is scaled to the pressure.
    parameters : Parameters
    """
    exponent = _central_exponent(parameters.kappa * parameters.friction)
    value = float(pressure(np.array([radius.value]), np.array([radius.from_edge]))[0])
    pieces = [_power_piece(radius, value, -exponent), *pressure.pieces[1:]]
    stick_radius = estimated_stick_radius(parameters)
    if stick_radius > np.sqrt(TINY):
        value_at_rim = value * (radius.value / stick_radius) ** exponent
        rim = Radius(stick_radius, 1.0 - stick_radius)
        pieces.insert(0, _power_piece(rim, value_at_rim, 0.0))
    return ZonalField(tuple(pieces))


def _power_piece(outer: Radius, outer_value: float, exponent: float) -> ZonePiece:
    """Return the multiple of ``s**exponent / sqrt(1 - s**2)`` that has a given value at `outer`."""
    # 1 - s**2 = outer**2 (d + shift) with the distance d = 1 - s**2/outer**2 on the disk
    shift = (1.0 - outer.square) / outer.square
    weight = EdgeWeight(outer_value * float(np.sqrt(shift)), shift)
    return ZonePiece(outer, DiskSeries(outer, None, weight, power=0, exponent=exponent))


def _central_exponent(coupling: float) -> float:
    """Return the exponent e of ``p ~ s**-e`` next to the centre, from a fixed-point iteration.

    With ``q = f p`` the normal displacements by p and by q are powers of s, too, and have to
    cancel. Each round lowers the error by a factor ``3 kappa f``, which is 1/20 at most.

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
    """Return the pressure on the last part.

    If it is singular at the edge, and the edge sticks, its tail is replaced by its leading term.
    """
    series = solved.pressures[-1]
    if series.power == 0.0 or solved.system.states[-1]:
        return series
    shear = solved.shears[2 * len(solved.system.radii)]
    return with_asymptotic_tail(
        series, shear, parameters, z_difference(*solved.system.bounds[-2:]) / 2.0
    )[0]
