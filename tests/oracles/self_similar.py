"""Contacts that are similar to themselves at all times: superpositions of one flat punch.

Under a profile ``c r**n`` on a smooth surface all contacts have the ratio of radii of the flat
punch with the same friction, and the load grows like ``a**(n + 1)``.
"""

from __future__ import annotations

import math

from spectral_contact import Solution
from spectral_contact.spectral.jacobi import graded_rule


def superposed(flat: Solution, name: str, power: float, r: float) -> float:
    """Return a field for unit load, similar to itself at all times, by quadrature over radii."""
    points, weights = graded_rule(20, 50, 0.2)
    stick, total = flat.stick_radius, 0.0
    # where it slips the traction is a multiple of the pressure
    friction = (flat.scene.friction or 0.0) * math.copysign(1.0, flat.scene.kappa)
    for low, high in ((r, stick), (max(r, stick), 1.0)):
        half = (high - low) / 2.0
        if half <= 0.0:
            continue
        slips = high > stick
        field = flat.pressure_field if slips or name == "pressure" else flat.traction_field
        factor = friction if slips and name == "traction" else 1.0
        for s, from_edge in (
            (low + half * points, 1.0 - low - half * points),
            (high - half * points, 1.0 - high + half * points),
        ):
            values = field(s, from_edge) * (r / s) ** (power - 1.0) / s
            total += factor * half * float(weights @ values)
    return (power + 1.0) * total
