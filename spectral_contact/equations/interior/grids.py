"""Stress and displacement as tables: units, checks of lengths, named columns, datasets, files."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from spectral_contact.errors import SceneError, optional
from spectral_contact.fields import Array
from spectral_contact.io import checks

if TYPE_CHECKING:
    import xarray

    from spectral_contact.equations.interior.body import Inside
    from spectral_contact.solution import Solution

#: Columns of a table other than the places, with what they are.
QUANTITIES = {
    "u_r": "displacement outward",
    "u_z": "displacement into the body",
    "sigma_rr": "radial stress, tension positive",
    "sigma_tt": "hoop stress",
    "sigma_zz": "axial stress",
    "sigma_rz": "shear stress",
    "von_mises": "von Mises equivalent stress",
    "max_shear": "largest shear stress in any plane",
    "mean": "mean stress, a third of the trace",
    "principal_1": "largest principal stress",
    "principal_2": "middle principal stress",
    "principal_3": "smallest principal stress",
    "displacement_error": "estimated error of u_r and u_z, relative to its length",
    "stress_error": "estimated error of the stresses, relative to their Frobenius norm",
}
#: Suffixes of files: two of a table, and NetCDF of a grid.
SUFFIXES: Final = (".csv", ".npz", ".nc")
#: How far away points may be, in contact radii: seventh powers of distances must not overflow.
_FARTHEST = 1e30


class UnitNames(NamedTuple):
    """Names of the units of places, displacements and stresses."""

    place: str
    displacement: str
    stress: str

    @property
    def si_length(self) -> str:
        """The SI unit of places; "" if they are dimensionless."""
        return "m" if self.place == "m" else ""


_PAPER = UnitNames("a", "4 (1 - nu^2) P / (a E)", "P / a^2")


@dataclass(frozen=True, slots=True)
class Units:
    """Factors into the units that are asked for.

    Attributes
    ----------
    length, stress, displacement : float
        What places over the contact radius, and stresses and displacements as the body computes
        them from the loads, are multiplied by.
    names : tuple of str
        Of places, displacements and stresses, in this order.
    """

    length: float = 1.0
    stress: float = 1.0
    displacement: float = 1.0
    names: UnitNames = _PAPER


def own_units(solution: Solution) -> Units:
    """Return the units of the fields of a solution."""
    if solution.scene.profile is None:
        return Units()
    return Units(displacement=solution.contact_radius, names=UnitNames("a", "L", "E'"))


def si_units(length: float, stress: float, displacement: float) -> Units:
    """Return SI units."""
    return Units(length, stress, displacement, UnitNames("m", "m", "Pa"))


def scaled_lengths(name: str, values: Any, units: Units, high: float = _FARTHEST) -> Array:
    """Return lengths over the contact radius, from lengths that `checked_lengths` allows."""
    return np.asarray(checked_lengths(name, values, units, high) / units.length + 0.0)


def checked_lengths(name: str, values: Any, units: Units, high: float = _FARTHEST) -> Array:
    """Return lengths as doubles in their units; only `from_edge` may be negative."""
    largest = high * units.length
    smallest = -_FARTHEST * units.length if name == "from_edge" else 0.0
    allowed = f"in [{smallest:.17g}, {largest:.17g}]"
    given = checks.reals(name, values, allowed, unit=units.names.si_length).astype(np.float64)
    bad = ~((given >= smallest) & (given <= largest))
    if bad.any():
        raise SceneError(name, given[bad].flat[0], allowed)
    return given


def columns(body: Inside, r: Array, z: Array, rtol: float | None) -> dict[str, Array]:
    """Return all columns, of the shape of the points; NaN for stresses where there are none.

    Parameters
    ----------
    body : Inside
    r, z : ndarray
        Of one shape.
    rtol : float or None
        As for `Inside.stress`.
    """
    displacement = body.displacement(r, z, rtol=rtol)
    refused = body.is_singular(r, z)
    # `stress` refuses singular points: it gets others in their place, one contact radius deeper
    stress = body.stress(r, np.where(refused, body.radius, z), rtol=rtol)
    stresses = {f"sigma_{part}": getattr(stress, part) for part in ("rr", "tt", "zz", "rz")}
    stresses |= {name: getattr(stress, name) for name in ("von_mises", "max_shear", "mean")}
    stresses |= {f"principal_{k + 1}": values for k, values in enumerate(stress.principal)}
    stresses["stress_error"] = stress.error
    named = {"u_r": displacement.r, "u_z": displacement.z}
    named["displacement_error"] = displacement.error
    named |= {name: np.where(refused, np.nan, values) for name, values in stresses.items()}
    return {name: np.asarray(named[name]) for name in QUANTITIES}


def unit_of(name: str, units: UnitNames) -> str:
    """Return the unit of a column."""
    if name.endswith("error"):
        return "1"
    if name in ("r", "z"):
        return units.place
    return units.displacement if name.startswith("u_") else units.stress


def dataset(body: Inside, r: Array, z: Array, rtol: float | None) -> xarray.Dataset:
    """Return all columns over the grid of radii and depths, if xarray is installed."""
    make_dataset = optional("xarray", "sweep").Dataset  # "sweep" is the extra that installs it
    values = columns(body, *np.meshgrid(r, z), rtol)
    units = body.unit_names
    long_names = {**QUANTITIES, "r": "distance from the axis", "z": "depth"}
    attributes = {
        name: {"long_name": long_name, "units": unit_of(name, units)}
        for name, long_name in long_names.items()
    }
    variables = {name: (("z", "r"), grid, attributes[name]) for name, grid in values.items()}
    axes = {name: (name, places, attributes[name]) for name, places in (("r", r), ("z", z))}
    made: xarray.Dataset = make_dataset(variables, axes, {"title": "inside the body"})
    return made


def as_csv(table: dict[str, Array], units: UnitNames) -> bytes:
    """Return a table as text: a line of units, a line of names, a line for each point."""
    named = ", ".join(f"{name} [{unit_of(name, units)}]" for name in table)
    rows = zip(*(np.ravel(column).tolist() for column in table.values()), strict=True)
    lines = [f"# {named}", ",".join(table), *(",".join(map(repr, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def as_npz(table: dict[str, Array]) -> bytes:
    """Return a table as an ``.npz`` file of its columns."""
    content = BytesIO()
    named: dict[str, Any] = dict(table)
    np.savez_compressed(content, **named)
    return content.getvalue()
