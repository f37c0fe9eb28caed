"""What a coarser space tells of the errors of coupled fields, part by part and panel by panel."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_parts import leading_depth, root_error, rounding_depth
from spectral_contact.contact.refine import Resolution
from spectral_contact.contact.resolution import (
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
)
from spectral_contact.spectral.system import System

__all__ = ["FieldErrors", "field_errors", "shares_of", "sizes_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class FieldErrors:
    """Estimates for p and for q/s; what every panel adds, and its fall with one more degree."""

    pressure: float
    traction: float
    indicators: Array
    rates: Array


def field_errors(
    spaces: list[Resolution], system: System, whole: Array, change: Array
) -> FieldErrors:
    """Return what the change of a solution tells of the errors of its fields."""
    pressure, shear = system.split(whole)
    rates = [
        [decay_rates(space, one) for one in (pressure[k], shear.get(k)) if one is not None]
        for k, space in enumerate(spaces)
    ]
    expected = [
        [expected_error(*pair) for pair in zip(*both, strict=True)]
        for both in zip(shares_of(system, change, sizes_of(system, whole)), rates, strict=True)
    ]
    roots = _root_errors(system, change, whole)
    return FieldErrors(
        max(roots[0], *(float(one[0].max()) for one in expected)),
        max(roots[1], *(float(one[-1].max()) for one in expected)),
        np.concatenate([np.max(one, axis=0) for one in expected]),
        np.concatenate([np.max(one, axis=0) for one in rates]),
    )


def sizes_of(system: System, values: Array) -> list[list[Array]]:
    """Return what changes of p and of q/s in stick are relative to, at the ends of the panels.

    Part by part. Where one of them changes sign in full stick it is the root of the sum of both
    squares.
    """
    pressure, shear = system.split(values)
    sizes = []
    for k, part in enumerate(system.parts):
        ends = [series_of(part.family.panels, pressure[k]).at_ends()]
        if k in shear:
            ends.append(series_of(part.shear.panels, shear[k]).at_ends())
        if system.symmetric and any((one * one[0] <= 0.0).any() for one in ends):
            ends = [np.hypot(*ends), np.hypot(ends[1], system.parameters.kappa * ends[0])]
        sizes.append(ends)
    return sizes


def shares_of(system: System, change: Array, sizes: list[list[Array]]) -> list[list[Array]]:
    """Return a change of p and of q/s in stick on every panel, relative to their sizes there."""
    alpha, beta, _, _ = system.parameters
    pressure, shear = system.split(change)
    shares = []
    for k, part in enumerate(system.parts):
        fields = [(part.family.panels, pressure[k])]
        if k in shear:
            fields.append((part.shear.panels, shear[k]))
        singular = any(panels.power for panels, _ in fields)
        leading = leading_depth(alpha, beta, part.family.reach) if singular else inf
        known = (
            inf if part.boundary < 0 else rounding_depth(part.family.boundary, part.family.reach)
        )
        shares.append(
            [
                share_of_change(panels, step, size, leading=leading, known=known)
                for (panels, step), size in zip(fields, sizes[k], strict=True)
            ]
        )
    return shares


def _root_errors(system: System, change: Array, whole: Array) -> tuple[float, float]:
    """Return the errors of p and of q/s at an edge that sticks, where one has a root there.

    That is the one whose compliance is not zero if the other's is.
    """
    part, (alpha, beta, _, _) = system.parts[-1], system.parameters
    if part.state != 0 or (alpha > 0.0) == (beta > 0.0):
        return 0.0, 0.0
    moved, values = system.split(change), system.split(whole)
    last = len(system.parts) - 1
    panels = (part.family if beta == 0.0 else part.shear).panels
    field = int(beta > 0.0)
    error = root_error(
        panels, moved[field][last], series_of(panels, values[field][last]).at_ends()[-1]
    )
    return (0.0, error) if field else (error, 0.0)
