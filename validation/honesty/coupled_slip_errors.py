"""True errors of coupled partial slip, at equal distances from the ends of the zones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spectral_contact import Solution

INTEGRALS = ("approach", "total_shear", "stick_radius")
FIELDS = ("pressure", "traction")
#: Distances from the ends of a zone, in its width.
NEAR = np.geomspace(1e-12, 0.45, 40)


@dataclass(frozen=True)
class Sample:
    """What is compared of a solution: numbers, ends of zones, and fields near these.

    Attributes
    ----------
    integrals : dict of str to float
    ends : list of pair of float
        Outer radius and its distance from the edge, of every zone but the last.
    fields : dict of str to list of float
        Pressure, traction and slip at equal distances from the ends of the zones.
    errors : dict of str to float
        Estimates of everything.
    """

    integrals: dict[str, float]
    ends: list[tuple[float, float]]
    fields: dict[str, list[float]]
    errors: dict[str, float]


def sample(solution: Solution, near: np.ndarray = NEAR, *, centre: bool = True) -> Sample:
    """Return the numbers to compare; for `near` and `centre` see `values`."""
    return Sample(
        {name: float(getattr(solution, name)) for name in INTEGRALS},
        [(zone.outer, zone.outer_from_edge) for zone in solution.zones[:-1]],
        {n: values(solution, n, near, centre=centre).tolist() for n in (*FIELDS, "slip")},
        {n: float(getattr(solution.error, n)) for n in (*INTEGRALS, *FIELDS, "slip", "zones")},
    )


def values(solution: Solution, name: str, near: np.ndarray, *, centre: bool = True) -> np.ndarray:
    """Return a field at places graded to both ends of every zone.

    They are `near` times the width of the zone away. The centre is an end where it slips, unless it
    is left out.
    """
    field, found = getattr(solution, name), []
    for zone in solution.zones:
        # a radius is known to its rounding, from the centre or from the edge
        if zone.outer < 0.5:
            width = zone.outer - zone.inner
            found.append(field(zone.outer - width * near))
        else:
            width = zone.inner_from_edge - zone.outer_from_edge
            found.append(field(from_edge=zone.outer_from_edge + width * near))
        if zone.inner < 0.5 and (zone.inner > 0.0 or (centre and zone.kind == "slip")):
            found.append(field(zone.inner + width * near))
        elif zone.inner >= 0.5:
            found.append(field(from_edge=zone.inner_from_edge - width * near))
    return np.concatenate(found)


def ratios(found: Sample, truth: Sample) -> dict[str, float]:
    """Return the true errors over the estimates, those of the truth included.

    Ends of zones are compared from the centre and from the edge.
    """
    # a stick disk that is too small to be felt has no radius
    sizes = {n: abs(truth.integrals[n]) or np.inf for n in INTEGRALS}
    errors = {n: abs(found.integrals[n] - truth.integrals[n]) / sizes[n] for n in INTEGRALS}
    first, second = ({n: np.array(f) for n, f in one.fields.items()} for one in (found, truth))
    for name in FIELDS:
        errors[name] = float(np.abs(first[name] / second[name] - 1.0).max())
    missed = np.abs(first["slip"] - second["slip"]).max()
    errors["slip"] = float(missed / np.abs(second["slip"]).max())
    apart = np.abs(np.array(found.ends) / np.array(truth.ends) - 1.0)
    errors["zones"] = float(apart.max(initial=0.0))
    return {
        name: error / (found.errors[name] + truth.errors[name]) for name, error in errors.items()
    }
