"""Scenes in SI units, as a grid, a list or a table, and the results of their sweep in SI units.

The solver knows the parameters of docs/theory.md alone: compliances in contact radii or, under a
profile, in its unit of length, and loads over E', which is a quarter of the plane-strain modulus
E*. Scenes in SI units that have the same such parameters are solved once. Tables may also have the
dimensionless parameters themselves.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.fields import Array
from spectral_contact.io.checks import reals
from spectral_contact.io.choices import one_of
from spectral_contact.io.columns import Expected, parse_columns, read_columns
from spectral_contact.io.parameters import SCENE, SI, parameters_of
from spectral_contact.io.physical_data import PhysicalData
from spectral_contact.io.units import in_si
from spectral_contact.profiles.control import ALL_CONTROLS, KINDS
from spectral_contact.quantities import FIELDS
from spectral_contact.scene import Scene
from spectral_contact.sweeps.request import Request
from spectral_contact.sweeps.sweep_parameters import (
    KAPPA,
    PARAMETERS,
    Indices,
    SweepParameters,
    listed,
)

if TYPE_CHECKING:
    import xarray

#: The SI units of the parameters that a scene may have, in the order of a dataset.
SI_UNITS: Final[Mapping[str, str]] = {
    name: {**SCENE, **SI}[name].unit
    for name in (
        *("youngs_modulus", "poisson_ratio", "reduced_modulus"),
        *("punch_youngs_modulus", "punch_poisson_ratio", "radius"),
        *PARAMETERS[1:],
    )
}
#: The parameters of these that no dimensionless scene has.
OF_SI_ALONE: Final = tuple(name for name in SI_UNITS if name not in PARAMETERS)
#: Meanings and SI units of results.
_RESULTS: Final[Mapping[str, tuple[str, str]]] = {
    "contact_radius": ("contact radius a", "m"),
    "load": ("load P", "N"),
    "approach": ("approach δ", "m"),
    "stiffness": ("stiffness dP/dδ", "N/m"),
    "stiffness_on_branch": ("stiffness dP/dδ along the curve of states", "N/m"),
    "indentation_work": ("work of the load", "J"),
    "stick_radius": ("stick radius c", "m"),
    "total_shear": ("total shear Q", "N"),
    "pressure": ("pressure p", "Pa"),
    "traction": ("traction q", "Pa"),
    "slip": ("slip u_r", "m"),
}
#: Name of the radius of a flat punch, or of a profile that has a radius.
_RADIUS: Final = "radius"
#: Suffix of the name of a number in SI units that has a dimensionless namesake.
_SI_SUFFIX: Final = "_si"
#: Largest number of scenes of a grid in SI units or of a table: each is a `Scene` in memory.
_MOST_SCENES: Final = 10**6


class DifferentScenes(NamedTuple):
    """Scenes, and one scene for each of their problems: many may be the same one in other units.

    Attributes
    ----------
    every : SweepParameters
        All scenes.
    different : SweepParameters
        One scene of each problem.
    which : ndarray of int
        Of every scene, its index in `different`.
    """

    every: SweepParameters
    different: SweepParameters
    which: Indices


@dataclass(frozen=True, slots=True, eq=False)
class PhysicalScenes:
    """Scenes of a grid or a list in SI units, or of a table in SI units or without units.

    Attributes
    ----------
    scenes : tuple of Scene
        All in SI units or none; all flat punches or all under profiles. The last dimension of a
        grid varies fastest.
    given : dict of str to ndarray
        What varies: the values of each dimension of a grid, or the columns of a table.
    fixed : dict of str to float
        What does not vary, of scenes in SI units.
    is_table : bool
        Whether they are a table or a list, with one dimension, ``scene``.
    read_as : str
        How a table was read.
    """

    scenes: tuple[Scene, ...]
    given: dict[str, Array]
    fixed: dict[str, float]
    is_table: bool
    read_as: str = ""

    @property
    def physical(self) -> bool:
        """Whether they are in SI units."""
        return self.scenes[0].physical is not None

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return ("scene",) if self.is_table else tuple(map(self._named, self.given))

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of every dimension."""
        return (len(self.scenes),) if self.is_table else tuple(map(len, self.given.values()))

    def _named(self, name: str) -> str:
        """Return the name of a parameter in a dataset.

        It has the suffix "_si" where a parameter without units has the same name and another value.
        """
        same_value = name in ("poisson_ratio", "friction", "unloaded_to") or name in OF_SI_ALONE
        return name if same_value or not self.physical else f"{name}{_SI_SUFFIX}"

    def different(self) -> DifferentScenes:
        """Return all scenes, and those of them that are different problems.

        The problem of a scene is its parameters without units, which are a column of a table, and
        its *form* (`SceneForm`), which has what is no number, such as the profile.
        """
        every = listed(self.scenes)
        assert every.table is not None
        forms = every.forms if len(every.forms) > 1 else every.forms * len(self.scenes)
        numbers: dict[Any, int] = {}
        representatives: list[Scene] = []
        which = np.empty(len(self.scenes), dtype=np.intp)
        for i, (scene, form) in enumerate(zip(self.scenes, forms, strict=True)):
            key = every.table[:, i].tobytes(), form
            if key not in numbers:
                numbers[key] = len(representatives)
                representatives.append(scene)
            which[i] = numbers[key]
        return DifferentScenes(every, listed(representatives), which)

    def shaped(self, dataset: xarray.Dataset) -> xarray.Dataset:
        """Return a dataset with the dimensions and coordinates of these scenes.

        Parameters
        ----------
        dataset : Dataset
            Of the same scenes, with the one dimension ``scene``.
        """
        variables: dict[Any, Any] = {}
        coordinates: dict[Any, Any] = {}
        for name, variable in dataset.variables.items():
            values = np.asarray(variable.values)
            dims = variable.dims
            if dims[:1] == ("scene",):
                constant = name in dataset.coords and not self.is_table and _is_constant(values)
                dims = () if constant else (*self.dims, *dims[1:])
                values = values[0] if constant else values.reshape((*self.shape, *values.shape[1:]))
            (coordinates if name in dataset.coords else variables)[name] = (
                dims,
                values,
                variable.attrs,
            )
        coordinates |= self._coordinates()
        # a parameter that is given is no result: it is a coordinate
        variables = {
            name: variable
            for name, variable in variables.items()
            if name.removesuffix("_error") not in coordinates
        }
        attributes = dict(dataset.attrs)
        if self.physical:
            attributes["convention"] += (
                "; parameters with another unit and names with _si: SI units"
            )
        if self.read_as:
            attributes["table"] = self.read_as
        return type(dataset)(variables, coordinates, attributes)

    def _coordinates(self) -> dict[Any, Any]:
        """Return the parameters that vary and, in SI units, those that do not, as coordinates."""
        coordinates: dict[Any, Any] = {}
        for name, value in self.fixed.items():
            coordinates[self._named(name)] = (), value, self._attributes(name)
        for name, values in self.given.items():
            dims = ("scene",) if self.is_table else (self._named(name),)
            coordinates[self._named(name)] = dims, values, self._attributes(name)
        return coordinates

    def _attributes(self, name: str) -> dict[str, str]:
        """Return meaning and unit of a parameter."""
        profile = self.scenes[0].profile
        parameter = (SI if self.physical and name in SI else SCENE)[name]
        if name == _RADIUS and profile is not None:
            parameter = parameters_of(type(profile))[name]
        unit = parameter.unit if self.physical else ""
        return {"long_name": parameter.meaning, **({"units": unit} if unit else {})}


def grid_of(base: Scene, axes: Mapping[str, Any]) -> PhysicalScenes:
    """Return the scenes in SI units of all combinations of values of some parameters.

    Parameters
    ----------
    base : Scene
        In SI units.
    axes : mapping of str to array_like
        Lists of values, by names of `SI_UNITS`.

    Raises
    ------
    SceneError
        For a value out of its range, or more than a million scenes.
    """
    given = {name: _numbers(name, values) for name, values in axes.items()}
    controls = [name for name in given if name in ALL_CONTROLS]
    if len(controls) > 1:
        allowed = f"left out if {controls[1]} is given: vary one of load, approach, contact radius"
        raise SceneError(controls[0], axes[controls[0]], allowed)
    count = math.prod(map(len, given.values()))
    if count > _MOST_SCENES:
        raise SceneError("number of scenes", count, f"at most {_MOST_SCENES} in SI units")
    positions = np.unravel_index(np.arange(count), tuple(map(len, given.values()))) if given else ()
    columns = [values[position] for values, position in zip(given.values(), positions, strict=True)]
    scenes = _changed(base, list(given), columns, count)
    return PhysicalScenes(scenes, given, _fixed(base, given), is_table=False)


def list_of(scenes: Iterable[Scene]) -> PhysicalScenes:
    """Return the scenes of a list, all in SI units."""
    listed_scenes = tuple(scenes)
    rows = [_given_in_si(scene) for scene in listed_scenes]
    given: dict[str, Array] = {}
    fixed: dict[str, float] = {}
    for name in SI_UNITS:
        values = np.array([row.get(name, math.nan) for row in rows])
        # a parameter that some scenes lack, as a load where others have an approach, is no
        # coordinate
        if np.isnan(values).any():
            continue
        if (values == values[0]).all():
            fixed[name] = float(values[0])
        else:
            given[name] = values
    return PhysicalScenes(listed_scenes, given, fixed, is_table=True)


def table_of(base: Scene, table: Any) -> PhysicalScenes:
    """Return the scenes of a table, one for each row.

    Parameters
    ----------
    base : Scene
        Has the parameters that are not in the table. If it is in SI units, so is the table.
    table : DataFrame, mapping or path
        A table of pandas or a text file, whose headings have units; or arrays of one length.

    Raises
    ------
    SceneError
        For a value out of its range, or more than a million rows.
    SolutionFileError
        If it has no column of a parameter, or cannot be read.
    """
    columns, read_as = columns_of(table, physical=base.physical is not None)
    count = len(next(iter(columns.values())))
    if count > _MOST_SCENES:
        raise SceneError("number of scenes", count, f"at most {_MOST_SCENES} of a table")
    scenes = _changed(base, list(columns), list(columns.values()), count, of_table=True)
    return PhysicalScenes(scenes, columns, _fixed(base, columns), is_table=True, read_as=read_as)


def columns_of(
    table: Any, names: Iterable[str] | None = None, *, physical: bool
) -> tuple[dict[str, Array], str]:
    """Return the columns of a table by the names of parameters, and how it was read.

    Parameters
    ----------
    table : DataFrame, mapping or path
    names : iterable of str, optional
        The parameters that are looked for, any of which the table may lack. By default these are
        all that a scene has, and the table must have a column of at least one.
    physical : bool
        Whether they are in SI units.
    """
    known = tuple(SI_UNITS) if physical else (*PARAMETERS, KAPPA)
    if isinstance(table, Mapping):
        columns = {
            one_of("table", name, known): _numbers(str(name), values, physical)
            for name, values in table.items()
        }
        if not columns or len({len(values) for values in columns.values()}) > 1:
            raise SceneError("table", table, "of one array or more, all of one length")
        return columns, ""
    expected = [
        Expected(
            name,
            SI_UNITS[name] if physical else "",
            (name, *(SI if name in SI else SCENE)[name].headings),
            required=False,
        )
        for name in (known if names is None else names)
    ]
    # a DataFrame, by what it can do: pandas is not imported, and its headings are read as a file's
    if hasattr(type(table), "to_csv") and hasattr(table, "columns"):
        found = parse_columns("table", table.to_csv(index=False).encode(), expected)
    elif isinstance(table, str | os.PathLike):
        found = read_columns(table, expected)
    else:
        raise SceneError("table", table, "a DataFrame, a mapping of names to arrays, or a path")
    if not found.values and names is None:
        raise SolutionFileError(found.path, f"no column of {', '.join(known)}")
    return dict(found.values), str(found)


def with_values(base: Scene, values: Mapping[str, Any]) -> Scene:
    """Return a scene with other values of some parameters.

    In SI units a radius is that of the profile, if there is one, and else that of the flat punch.

    Raises
    ------
    SceneError
        For a value out of its range, or a radius where the profile has none.
    """
    if base.physical is None or base.profile is None or values.get(_RADIUS) is None:
        return base.replace(**values)
    if _RADIUS not in parameters_of(type(base.profile)):
        kinds_with_radius = [kind for kind, cls in KINDS.items() if _RADIUS in parameters_of(cls)]
        allowed = (
            f"None with {base.profile.brief}, which has none, unlike {', '.join(kinds_with_radius)}"
        )
        raise SceneError(_RADIUS, values[_RADIUS], allowed)
    radius = in_si(_RADIUS, values[_RADIUS], SI_UNITS[_RADIUS])
    others = {name: one for name, one in values.items() if name != _RADIUS}
    shape: Any = base.profile
    return base.replace(**others, profile=replace(shape, radius=radius))


def _given_in_si(scene: Scene) -> dict[str, float]:
    """Return the parameters that a scene in SI units has."""
    given = {name: getattr(scene.physical, name, None) for name in SI_UNITS}
    if scene.profile is not None:
        given[_RADIUS] = getattr(scene.profile, _RADIUS, None)
    return {name: value for name, value in given.items() if value is not None}


def _fixed(base: Scene, given: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters of scenes in SI units that do not vary."""
    if base.physical is None:
        return {}
    varies_control = not set(ALL_CONTROLS).isdisjoint(
        given
    )  # a load takes the place of an approach
    parameters = _given_in_si(base).items()
    return {
        name: value
        for name, value in parameters
        if name not in given and not (varies_control and name in ALL_CONTROLS)
    }


def _changed(
    base: Scene, names: list[str], columns: list[Array], count: int, *, of_table: bool = False
) -> tuple[Scene, ...]:
    """Return a scene for every row of values; an error names the row of a table."""
    rows = zip(*(column.tolist() for column in columns), strict=True) if columns else [()] * count
    scenes = []
    for number, row in enumerate(rows, start=1):
        try:
            scenes.append(with_values(base, dict(zip(names, row, strict=True))))
        except SceneError as error:
            if not of_table:
                raise
            allowed = f"{error.allowed} (row {number} of the table)"
            raise SceneError(error.parameter, error.value, allowed) from None
    return tuple(scenes)


def _numbers(name: str, values: Any, physical: bool = True) -> Array:
    unit = SI_UNITS[name] if physical else ""
    array = np.asarray(reals(name, values, "a list of real numbers", unit=unit), dtype=np.float64)
    if array.ndim != 1 or array.size == 0:
        raise SceneError(name, values, "a list of at least one number")
    return array


def _is_constant(values: NDArray[Any]) -> bool:
    if values.dtype.kind == "f":
        return bool(np.all((values == values[0]) | (np.isnan(values) & np.isnan(values[0]))))
    return all(one == values[0] for one in values.tolist())


def quantities_for(scenes: PhysicalScenes, quantities: tuple[str, ...]) -> tuple[str, ...]:
    """Return quantities, with the approach or contact radius added if their SI units need it."""
    if not scenes.physical:
        return quantities
    data = [one.physical for one in scenes.scenes]
    if scenes.scenes[0].profile is None:
        needed = "approach"
        missing = any(one is not None and one.load is None for one in data)
    else:
        needed = "contact_radius"
        missing = "stick_radius" in quantities
    return (needed, *quantities) if missing and needed not in quantities else quantities


def si_results(
    scenes: tuple[Scene, ...], values: Mapping[str, NDArray[Any]], request: Request
) -> dict[str, Any]:
    """Return results in SI units, as variables of a dataset with the dimension ``scene``.

    Parameters
    ----------
    scenes : tuple of Scene
        In SI units, all flat punches or all under profiles.
    values : mapping of str to ndarray
        Results without units, those of `quantities_for` at least, and their errors as
        ``<name>_error``.
    request : Request
        Its `places` name the dimension along which fields are given.
    """
    data = [one.physical for one in scenes]
    results = {name: values[name] for name in _RESULTS if name in values}
    errors = {name: values[f"{name}_error"] for name in results}
    given = {
        name: np.array([_or_nan(one, name) for one in data])
        for name in ("load", "approach", "contact_radius", "radius")
    }
    modulus = np.array([_quarter(scene, one) for scene, one in zip(scenes, data, strict=True)])
    with np.errstate(all="ignore"):
        if scenes[0].profile is None:
            ratios = np.array([one.unloaded_to for one in scenes])
            scales, inherited = _flat_scales(results, errors, given, modulus, ratios)
            # scenes are given the approach at the largest load; below it is that of the results
            given["approach"] = ratios * given["approach"]
        else:
            scales, inherited = _profile_scales(results, errors, given, modulus)
        variables: dict[str, Any] = {}
        for name in results:
            if name not in scales:
                continue
            places = (request.places,) if name in FIELDS else ()
            scale = scales[name]
            result = results[name] * (scale[:, None] if places else scale)
            error = errors[name] + inherited.get(name, 0.0)
            if name in ("load", "approach", "contact_radius"):  # what is given is exact
                is_given = np.isfinite(given[name])
                result = np.where(is_given, given[name], result)
                error = np.where(is_given, 0.0, error)
            variables |= _variables(name, ("scene", *places), result, error)
        if scenes[0].profile is None and "load" in scales:
            variables |= _variables("load", ("scene",), ratios * scales["load"], inherited["load"])
    return variables


def _variables(name: str, dims: tuple[str, ...], result: Array, error: Array) -> dict[str, Any]:
    """Return a result and its error as variables of a dataset."""
    meaning, unit = _RESULTS[name]
    error_meaning = f"estimate of the relative error: {meaning}"
    return {
        f"{name}{_SI_SUFFIX}": (dims, result, {"long_name": meaning, "units": unit}),
        f"{name}{_SI_SUFFIX}_error": (
            ("scene",),
            error,
            {"long_name": error_meaning, "units": "1"},
        ),
    }


def _flat_scales(
    results: dict[str, Array],
    errors: dict[str, Array],
    given: dict[str, Array],
    modulus: Array,
    ratios: Array,
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the SI values of the units of results under flat punches, and their relative errors.

    Results are in units that follow from the largest load, and `ratios` are the loads over the
    largest load. Where the approach is given, the largest load follows from it, with the error of
    the approach of the solution.
    """
    load = given["load"]
    error = np.zeros(len(load))
    if "approach" in results:
        largest = results["approach"] / ratios
        by_approach = given["radius"] * modulus * given["approach"] / largest
        load = np.where(np.isfinite(load), load, by_approach)
        error = np.where(np.isfinite(given["load"]), 0.0, errors["approach"])
    stress = load / given["radius"] ** 2
    displacement = load / (given["radius"] * modulus)
    scales = {"load": load, "approach": displacement, "slip": displacement, "pressure": stress}
    scales |= {"traction": stress, "stick_radius": given["radius"], "total_shear": load}
    return scales, dict.fromkeys(("load", "slip", "pressure", "traction", "total_shear"), error)


def _profile_scales(
    results: dict[str, Array],
    errors: dict[str, Array],
    given: dict[str, Array],
    modulus: Array,
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the SI values of the units of results under profiles, and their relative errors.

    The unit of length is 1 m, so that those of stresses, in Pa, and of forces, in N, have the same
    value E'. The unit of the stick radius is the contact radius, which has an error unless it is
    given; the other units are known exactly.
    """
    forces = "load", "stiffness", "stiffness_on_branch", "indentation_work", "total_shear"
    scales = dict.fromkeys((*forces, "pressure", "traction"), modulus)
    scales |= dict.fromkeys(("approach", "contact_radius", "slip"), np.ones(len(modulus)))
    if "contact_radius" not in results:
        return scales, {}
    is_given = np.isfinite(given["contact_radius"])
    scales["stick_radius"] = np.where(is_given, given["contact_radius"], results["contact_radius"])
    return scales, {"stick_radius": np.where(is_given, 0.0, errors["contact_radius"])}


def _or_nan(data: PhysicalData | None, name: str) -> float:
    """Return a parameter in SI units, NaN if it is not given."""
    value = getattr(data, name)
    return math.nan if value is None else value


def _quarter(scene: Scene, data: PhysicalData | None) -> float:
    """Return E' [Pa], a quarter of the plane-strain modulus; it depends on Poisson's ratio."""
    assert data is not None
    return data.quarter_modulus(scene.poisson_ratio)
