"""What a coarser space tells of the errors of coupled fields, part by part and panel by panel."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_parts import leading_depth, root_error, rounding_depth
from spectral_contact.contact.refine import Resolution
from spectral_contact.contact.resolution import (
    LEAST_RATE,
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
)
from spectral_contact.spectral.tangential import Tangential

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
    spaces: list[Resolution], system: Tangential, whole: Array, change: Array
) -> FieldErrors:
    """Return what the change of a solution tells of the errors of its fields."""
    fields, count = system.fields, system.count
    rates = [decay_rates(spaces[one.part], one.of(whole)) for one in fields]
    shares = shares_of(system, change, sizes_of(system, whole))
    expected = [expected_error(*pair) for pair in zip(shares, rates, strict=True)]
    pressure, traction = _root_errors(system, change, whole)
    for one, errors in zip(fields, expected, strict=True):
        if one.own.stop <= count:
            pressure = max(pressure, float(errors.max()))
        else:
            traction = max(traction, float(errors.max()))
    indicators = [np.zeros(len(one.degrees)) for one in spaces]
    slowest = [np.full(len(one.degrees), LEAST_RATE) for one in spaces]
    for own, errors, rate in zip(fields, expected, rates, strict=True):
        np.maximum(indicators[own.part], errors, out=indicators[own.part])
        np.maximum(slowest[own.part], rate, out=slowest[own.part])
    return FieldErrors(pressure, traction, np.concatenate(indicators), np.concatenate(slowest))


def sizes_of(system: Tangential, values: Array) -> list[Array]:
    """Return what changes of the fields are relative to, at the ends of the panels.

    Where p or q/s changes sign in full stick it is the root of the sum of both squares.
    """
    ends = [series_of(one.panels, one.of(values)).at_ends() for one in system.fields]
    if system.symmetric and any((one * one[0] <= 0.0).any() for one in ends):
        ends = [np.hypot(*ends), np.hypot(ends[1], system.parameters.kappa * ends[0])]
    return ends


def shares_of(system: Tangential, change: Array, sizes: list[Array]) -> list[Array]:
    """Return a change of the fields on every panel, relative to their sizes there."""
    alpha, beta, _, _ = system.parameters
    singular = {one.part for one in system.fields if one.panels.power}
    shares = []
    for one, size in zip(system.fields, sizes, strict=True):
        part = system.parts[one.part]
        reach = part.family.reach
        leading = leading_depth(alpha, beta, reach) if one.part in singular else inf
        known = inf if part.boundary < 0 else rounding_depth(part.family.boundary, reach)
        shares.append(
            share_of_change(one.panels, one.of(change), size, leading=leading, known=known)
        )
    return shares


def _root_errors(system: Tangential, change: Array, whole: Array) -> tuple[float, float]:
    """Return the errors of p and of q/s at an edge that sticks, where one has a root there.

    That is the one whose compliance is not zero if the other's is.
    """
    (alpha, beta, _, _), last = system.parameters, len(system.parts) - 1
    rooted = system.parts[last].state == 0 and (alpha > 0.0) != (beta > 0.0)
    errors = [0.0, 0.0]
    for one in system.fields:
        shear = one.own.start >= system.count
        if rooted and one.part == last and shear == (beta > 0.0):
            at_end = series_of(one.panels, one.of(whole)).at_ends()[-1]
            errors[shear] = root_error(one.panels, one.of(change), at_end)
    return errors[0], errors[1]
