"""Zones that stick or slip, in parts: a family of panels to every end of each."""

from __future__ import annotations

from dataclasses import dataclass, replace

from spectral_contact.fields.series import CENTRE, EDGE, Radius
from spectral_contact.spectral.annulus import Family, gap
from spectral_contact.spectral.panels import LogPanels

__all__ = ["Part", "zone_parts"]

Degrees = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """Half a zone, or the central disk: a family of panels, and how the surface moves on it.

    Attributes
    ----------
    zone : int
        From the centre outward.
    state : int
        0 for stick, +1 or -1 for slip with this sign of the traction.
    boundary : int
        Number of the boundary that the panels are graded to; -1 for the edge.
    family, shear : Family
        With the panels of the pressure, and with those of q/s, the same but for the endpoint
        weight.
    degrees : tuple of int
        Highest degree on every panel.
    """

    zone: int
    state: int
    boundary: int
    family: Family
    shear: Family
    degrees: Degrees


def zone_parts(
    radii: tuple[Radius, ...],
    states: tuple[int, ...],
    panels: list[LogPanels],
    degrees: list[Degrees],
    beta: float,
) -> list[Part]:
    """Return the parts of all zones, outward; parameters are those of `System`.

    Without tangential compliance the traction is singular at an edge that sticks.
    """
    bounds = (CENTRE, *radii, EDGE)
    parts = []
    each = iter(zip(panels, degrees, strict=True))
    for zone, state in enumerate(states):
        inner, outer = bounds[zone : zone + 2]
        last = zone if zone < len(radii) else -1
        ends = [(outer, -1, last)] if zone == 0 else [(inner, 1, zone - 1), (outer, -1, last)]
        for boundary, sign, number in ends:
            own, used = next(each)
            family = Family(boundary, sign, gap(inner, outer) / len(ends), own)
            power = own.power if state else -0.5 if beta == 0.0 and number < 0 else 0.0
            alike = power == own.power
            shear = family if alike else replace(family, panels=replace(own, power=power))
            parts.append(Part(zone, state, number, family, shear, used))
    return parts
