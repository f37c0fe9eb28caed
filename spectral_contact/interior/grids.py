"""Stress and displacement as tables: named columns, an xarray dataset, a file."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import optional

if TYPE_CHECKING:
    import xarray

    from spectral_contact.interior.body import Inside

__all__ = ["QUANTITIES", "as_csv", "as_npz", "columns", "dataset", "unit_of"]

Array = NDArray[np.float64]

#: Columns of a table but for the places, and what they mean.
QUANTITIES = {
    "u_r": "displacement outward",
    "u_z": "displacement into the body",
    "sigma_rr": "radial stress, tension positive",
    "sigma_tt": "hoop stress",
    "sigma_zz": "axial stress",
    "sigma_rz": "shear stress",
    "von_mises": "equivalent stress of von Mises",
    "max_shear": "largest shear stress in any plane",
    "mean": "a third of the trace of the stress",
    "principal_1": "largest principal stress",
    "principal_2": "middle principal stress",
    "principal_3": "smallest principal stress",
    "displacement_error": "estimated error of u_r and u_z over the length of the displacement",
    "stress_error": "estimated error of the stresses over the root of the sum of their squares",
}


def columns(body: Inside, r: Array, z: Array, rtol: float | None) -> dict[str, Array]:
    """Return all columns, of the shape of the points; NaN for stresses at the edge itself.

    Parameters
    ----------
    body : Inside
    r, z : ndarray
        Of one shape.
    rtol : float or None
        As for `Inside.stress`.
    """
    moved = body.displacement(r, z, rtol=rtol)
    edge = body.at_edge(r, z)
    own = body.stress(np.where(edge, 0.0, r), z, rtol=rtol)
    stresses = {f"sigma_{part}": getattr(own, part) for part in ("rr", "tt", "zz", "rz")}
    stresses |= {name: getattr(own, name) for name in ("von_mises", "max_shear", "mean")}
    stresses |= {f"principal_{k + 1}": one for k, one in enumerate(own.principal)}
    stresses["stress_error"] = own.error
    found = {"u_r": moved.r, "u_z": moved.z, "displacement_error": moved.error}
    found |= {name: np.where(edge, np.nan, one) for name, one in stresses.items()}
    return {name: np.asarray(found[name]) for name in QUANTITIES}


def unit_of(name: str, si: bool) -> str:
    """Return the unit of a column."""
    if name.endswith("error"):
        return "1"
    of_length = name in ("r", "z") or name.startswith("u_")
    if si:
        return "m" if of_length else "Pa"
    if name in ("r", "z"):
        return "a"
    return "4 (1 - nu^2) P / (a E)" if of_length else "P / a^2"


def dataset(body: Inside, r: Array, z: Array, rtol: float | None) -> xarray.Dataset:
    """Return all columns over the grid of radii and depths.

    Raises
    ------
    MissingDependencyError
        If xarray is not installed.
    """
    made = optional("xarray", "sweep").Dataset
    found = columns(body, *np.meshgrid(r, z), rtol)
    variables = {name: (("z", "r"), one, _about(name, body.si)) for name, one in found.items()}
    axes = {
        name: (name, one, {"long_name": about, "units": unit_of(name, body.si)})
        for name, one, about in (("r", r, "distance from the axis"), ("z", z, "depth"))
    }
    found_there: xarray.Dataset = made(variables, axes, {"title": "inside the body"})
    return found_there


def _about(name: str, si: bool) -> dict[str, Any]:
    return {"long_name": QUANTITIES[name], "units": unit_of(name, si)}


def as_csv(table: dict[str, Array], si: bool) -> bytes:
    """Return a table as text: a line of units, a line of names, a line for each point."""
    units = ", ".join(f"{name} [{unit_of(name, si)}]" for name in table)
    rows = zip(*(np.ravel(column).tolist() for column in table.values()), strict=True)
    lines = [f"# {units}", ",".join(table), *(",".join(map(repr, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def as_npz(table: dict[str, Array]) -> bytes:
    """Return a table as an ``.npz`` file of its columns."""
    content = BytesIO()
    named: dict[str, Any] = dict(table)
    np.savez_compressed(content, **named)
    return content.getvalue()
