"""Changes of the fields of a contact, relative to the fields themselves, on every panel."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.contact.resolution import REGULARISING_COMPLIANCE, relative_panel_changes
from spectral_contact.contact.zone_spaces import leading_depth, rounding_depth
from spectral_contact.fields.series import Array
from spectral_contact.spectral.transforms import series_of

if TYPE_CHECKING:
    from spectral_contact.spectral.contact_system import ContactSystem


def relative_changes(system: ContactSystem, values: Array, change: Array) -> list[Array]:
    """Return for each unknown field a bound of its change on every panel, relative to the field.

    Parameters
    ----------
    system : ContactSystem
    values, change : ndarray, shape (unknowns,)
        The vector of the system, and a change of it.
    """
    # In a part where one of the fields is singular at the edge, both fields are their leading terms
    # beyond some depth ``x = -ln d``. d is the distance from the edge in units of the extent of the
    # part; distance and extent are differences of s**2.
    singular_parts = {field.part for field in system.fields if field.panels.power}
    changes = []
    for field, size in zip(system.fields, _reference_sizes(system, values), strict=True):
        part = system.parts[field.part]
        extent = part.mesh.extent
        leading = inf
        if field.part in singular_parts:
            leading = leading_depth(system.parameters, extent)
        # next to a boundary between zones fields are rounding at some depth; a part that is graded
        # to the edge of the contact instead has the boundary number -1
        cutoff = inf
        if part.boundary_number >= 0:
            cutoff = rounding_depth(part.mesh.boundary, extent)
        changes.append(
            relative_panel_changes(
                field.panels,
                field.coefficients(change),
                size,
                leading_depth=leading,
                cutoff_depth=cutoff,
            )
        )
    return changes


def pressure_cancellation(system: ContactSystem, values: Array) -> float:
    """Return the rounding of p by cancellation, in units of one rounding of p.

    With elastic coupling p is a sum of terms of the size of ``u = q/s``. At an edge that sticks
    they may nearly cancel, and their rounding is then large beside p. In full stick the largest
    ``u/p`` is returned, with u no closer to the edge than alpha, as the normal compliance smooths
    the terms over that distance. Where parts of the contact slip, q is at most ``f p`` everywhere,
    and f is returned; under a known pressure 0.
    """
    parameters = system.parameters
    if system.pressure_known:
        return 0.0
    if system.radii:
        return parameters.friction
    pressure, shear = _reference_sizes(system, values)
    ends = series_of(system.fields[0].panels, system.fields[0].coefficients(values)).ends
    outside_layer = int(np.count_nonzero(ends >= min(parameters.alpha, 1.0)))
    shear[outside_layer:] = shear[outside_layer - 1]
    return float(np.abs(shear / pressure).max())


def _reference_sizes(system: ContactSystem, values: Array) -> list[Array]:
    """Return the sizes to which changes of the unknown fields are relative, at the ends of panels.

    The sizes are the fields themselves, with three exceptions.

    - If p or ``u = q/s`` changes sign in full stick, that is, does not have the sign of its first
      value everywhere: the size for p is ``sqrt(p^2 + u^2)``, and that for u is
      ``sqrt(u^2 + (kappa p)^2)``.
    - In a part that sticks again after slip, whose displacement is known, u may change sign, too.
      Its size there is ``f p/s``, the most that u can be. Without elastic coupling f is divided by
      kappa, as in `Parameters`.
    - The tangential compliance REGULARISING_COMPLIANCE says that there is a regularising disk. Its
      traction is the last field. It is rounding that changes no other field, so its size is
      infinite.
    """
    parameters = system.parameters
    sizes = [
        series_of(field.panels, field.coefficients(values)).at_ends() for field in system.fields
    ]
    changes_sign = any((size * size[0] <= 0.0).any() for size in sizes)
    if changes_sign and not (system.pressure_known or system.radii):  # in full stick
        pressure, shear = sizes
        sizes = [np.hypot(pressure, shear), np.hypot(shear, parameters.kappa * pressure)]
    if parameters.beta == REGULARISING_COMPLIANCE:
        sizes[-1][:] = inf
    if system.displacement_coefficients:
        pressures, _ = system.series(values)
        for i, field in enumerate(system.fields):
            if field.part in system.displacement_coefficients:
                series = pressures[field.part]
                radii = np.sqrt(system.parts[field.part].mesh.points(series.ends).z)
                sizes[i] = parameters.friction * series.at_ends() / radii
    return sizes
