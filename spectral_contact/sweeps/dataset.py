"""Results of a sweep, or of one solution, as an `xarray.Dataset` with units and meanings."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.errors import NotComputedError, optional
from spectral_contact.io.documents import netcdf, replace_file, reported
from spectral_contact.io.parameters import SCENE
from spectral_contact.processes import VERSION
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.quantities import FIELDS, OUTPUTS
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import ENDINGS, Outcome, Request, Rows, requested
from spectral_contact.sweeps.sweep_parameters import KAPPA, Indices, SweepParameters, alone
from spectral_contact.view.radii import graded_radii
from spectral_contact.view.report import table

if TYPE_CHECKING:
    import xarray

#: Units of parameters of scenes without SI data that are not 1; empty for what is no number.
_UNITS: Final = {"separation": "L", "work_of_adhesion": "E'L", "coupling": "", "branch": ""}
#: Meaning and unit of everything in a dataset.
_MEANINGS: Final = {
    **{
        name: (f"{one.meaning} {one.symbol}".strip(), _UNITS.get(name, "1"))
        for name, one in SCENE.items()
    },
    **{one.name: (one.meaning, one.unit) for one in OUTPUTS},
    "s": ("radius s = r/a", "1"),
    "from_edge": ("distance from the edge 1 − r/a", "1"),
    "profile": ("shape of the punch", ""),
    "layer": ("law of the layer", ""),
    "zone_kind": (
        "kind of a zone, outward: 1 stick, 2 slip, 3 stick with memory, 4 slip back, 0 none",
        "1",
    ),
    "zone_outer": ("outer radius of a zone", "a"),
    "zone_outer_from_edge": ("distance of the outer radius of a zone from the edge", "a"),
    "ending": ("how the solve ended", ""),
    "message": ("why it did not converge", ""),
}
#: Meanings and units that are others for a scene with a profile, where E' = E/(4(1−ν²)).
_WITH_PROFILE: Final = {
    **{one.name: one.under_profile for one in OUTPUTS if one.under_profile},
    "normal_compliance": ("normal compliance αE'/L", "1"),
    "tangential_compliance": ("tangential compliance βE'/L", "1"),
}
#: Parameters that some scenes may lack; loads, approaches and radii are then results.
_MAY_BE_ABSENT: Final = (*ALL_CONTROLS, "work_of_adhesion")


class Collected:
    """The results of all scenes, filled chunk by chunk.

    Parameters
    ----------
    size : int
        Number of scenes.

    Attributes
    ----------
    values : dict of str to ndarray, shape (scenes, ...)
        By the name of a variable.
    endings : ndarray of int8, shape (scenes,)
        Codes, which are places in `ENDINGS`. They count once every scene has been put.
    messages : dict of int to str
        Why a scene did not converge, by its number.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self.values: dict[str, NDArray[Any]] = {}
        self.endings = np.zeros(size, dtype=np.int8)
        self.messages: dict[int, str] = {}

    def put(self, scenes: Indices, outcome: Outcome) -> None:
        """Take the outcome of some scenes."""
        for name, values in outcome.values.items():
            part: tuple[Any, ...] = (scenes, *map(slice, values.shape[1:]))
            self._column(name, values)[part] = values
        self.endings[scenes] = outcome.endings
        for i, text in outcome.messages.items():
            self.messages[int(scenes[i])] = text

    def taken(self, which: Indices) -> Collected:
        """Return the results of some scenes, in the order of their numbers, which may repeat."""
        found = Collected(len(which))
        found.values = {name: values[which] for name, values in self.values.items()}
        found.endings = self.endings[which]
        for i, number in enumerate(which.tolist()):
            if number in self.messages:
                found.messages[i] = self.messages[number]
        return found

    def _column(self, name: str, like: NDArray[Any]) -> NDArray[Any]:
        """Return the column of a variable, made as wide as `like` if it is narrower.

        Its width is the largest number of zones so far, or the number of places of a field.
        """
        known = self.values.get(name)
        width = like.shape[1:] if known is None else np.maximum(known.shape[1:], like.shape[1:])
        if known is None or known.shape[1:] != tuple(width):
            empty = np.nan if like.dtype.kind == "f" else 0
            wider = np.full((self._size, *width), empty, dtype=like.dtype)
            if known is not None:
                wider[(slice(None), *map(slice, known.shape[1:]))] = known
            self.values[name] = wider
        return self.values[name]


def needed() -> Any:
    """Return xarray."""
    return optional("xarray", "sweep")


def assembled(
    parameters: SweepParameters, request: Request, collected: Collected
) -> xarray.Dataset:
    """Return the dataset of a finished sweep."""
    dims, shape, shaped = parameters.dims, parameters.shape, parameters.shaped
    coordinates = _coordinates(parameters, request)
    variables = {}
    for name, values in collected.values.items():
        if name.removesuffix("_error") in coordinates:  # it is a parameter, as a load that is given
            continue
        more_dims = (request.places,) if name in FIELDS else ("zone",) * (values.ndim - 1)
        on_grid = values.reshape((*shape, *values.shape[1:]))
        variables[name] = (*dims, *more_dims), on_grid, _about(name, shaped)
    ending = np.array(ENDINGS, dtype=object)[collected.endings]
    message = np.full(parameters.size, "", dtype=object)
    for i, text in collected.messages.items():
        message[i] = text
    for name, texts in (("ending", ending), ("message", message)):
        variables[name] = dims, texts.reshape(shape), _about(name, shaped)
    punch, units = ("a flat punch", "docs/theory") if not shaped else ("a punch", "docs/profiles")
    attributes = {
        "title": f"scenes of {punch} on a rough elastic half-space",
        "source": f"spectral_contact {VERSION}",
        "rtol": request.rtol,
        "convention": f"dimensionless as in {units}; friction NaN: no friction at all",
    }
    dataset: xarray.Dataset = needed().Dataset(variables, coordinates, attributes)
    return dataset


def summary(dataset: xarray.Dataset) -> str:
    """Return how many scenes ended how, and the range of every quantity."""
    endings = Counter(dataset.ending.values.ravel().tolist())
    counts = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    cells: list[tuple[str, ...]] = [("quantity", "least", "largest", "largest error estimate")]
    for name, column in dataset.data_vars.items():
        if f"{name}_error" in dataset:
            error = dataset[f"{name}_error"]
            numbers = (column.min(), column.max(), error.max())
            cells.append((str(name), *(f"{float(one):.4g}" for one in numbers)))
    told = f"{dataset.ending.size} scenes: {counts}\n" + table(cells)
    return f"{dataset.attrs['table']}\n{told}" if "table" in dataset.attrs else told


def unsolved(dataset: xarray.Dataset) -> str:
    """Return how many scenes of a sweep did not converge, and why the first; empty if all did."""
    endings = dataset.ending.values.ravel().tolist()
    wrong = [k for k, ending in enumerate(endings) if ending != "converged"]
    if not wrong:
        return ""
    message = dataset.message.values.ravel().tolist()[wrong[0]]
    many = "none" if len(wrong) == len(endings) else f"{len(endings) - len(wrong)}"
    told = f"{many} of {len(endings)} scenes {'were' if many != 'none' else 'was'} solved"
    return f"{told}; the first that was not: {endings[wrong[0]]}, {message}"


def write(dataset: xarray.Dataset, path: str) -> None:
    """Write a sweep whole to a .nc file (NetCDF), or as a table to a .csv file."""
    if path.lower().endswith(".csv"):
        rows = dataset if dataset.sizes else dataset.expand_dims("scene")
        content = rows.to_dataframe().reset_index().to_csv(index=False).encode()
    else:
        content = netcdf(dataset)
    with reported(path, "cannot be written"):
        replace_file(path, content)


def of_solution(
    solution: Solution, s: ArrayLike | None = None, from_edge: ArrayLike | None = None
) -> xarray.Dataset:
    """Return the dataset of one solution; see `Solution.to_xarray`."""
    needed()
    scene = solution.scene
    quantities = solution.plan.quantities
    radii = None
    if not quantities:
        raise NotComputedError("a quantity to tabulate", "the solution has none")
    if s is None and from_edge is None and not set(FIELDS).isdisjoint(quantities):
        radii = graded_radii(solution)
        request = Request(quantities, solution.rtol, 1, "s", radii.s, radii.from_edge)
    else:
        kind = {"shaped": scene.profile is not None}
        kind["adhesive"] = scene.work_of_adhesion is not None
        kind["unloaded"] = scene.unloaded_to < 1.0
        request = requested(quantities, solution.rtol, 1, s, from_edge, **kind)
    rows = Rows(1, request)
    rows.take(0, solution)
    outcome = rows.outcome()
    if radii is not None:  # `Rows` evaluated at s alone, and distances are accurate at the edge
        for name in set(FIELDS).intersection(quantities):
            outcome.values[name][0] = radii.evaluate(getattr(solution, name))
    table = Collected(1)
    table.put(np.arange(1), outcome)
    return assembled(alone(scene), request, table)


def _coordinates(parameters: SweepParameters, request: Request) -> dict[str, Any]:
    """Return the coordinates: parameters that vary, the others as scalars, and the places.

    The places of fields are given as radii and as distances from the edge: that of the two which
    was asked for is their dimension.
    """
    found: dict[str, Any] = {}
    for k, name in enumerate(parameters.names):
        values: Any = parameters.fixed[k] if parameters.table is None else parameters.table[k]
        values = parameters.axes.get(name, values)
        if name == KAPPA and parameters.table is not None:
            # some scenes of the list may be given by Poisson's ratio: it is changed to kappa
            values = parameters.columns(np.arange(parameters.size)).kappa
        if name == "unloaded_to" and not parameters.unloaded and name not in parameters.axes:
            continue
        # a load or radius that not all scenes are given is a result
        if name not in _MAY_BE_ABSENT or np.isfinite(values).all():
            dims = parameters.dims if parameters.table is not None else (name,) * np.ndim(values)
            found[name] = dims, values, _about(name, parameters.shaped)
    found |= _forms(parameters)
    if request.places:
        for name in ("s", "from_edge"):
            found[name] = (request.places, getattr(request, name), _about(name))
    return found


def _forms(parameters: SweepParameters) -> dict[str, Any]:
    """Return the coordinates from the forms of scenes: profile, layer, coupling and branch."""
    found: dict[str, Any] = {}
    for part in ("profile", "layer") if parameters.shaped else ():
        briefs = _briefs(parameters, part)
        if any(briefs):
            brief = briefs[0] if parameters.table is None else np.array(briefs, dtype=object)
            found[part] = parameters.dims * np.ndim(brief), brief, _about(part)
    for name in ("coupling", "branch"):
        each = np.array([getattr(one, name) for one in parameters.forms])
        if each.any():
            dims, values = (parameters.dims, each) if len(each) > 1 else ((), each[0].item())
            found[name] = dims, values, _about(name)
    return found


def _briefs(parameters: SweepParameters, part: str) -> list[str]:
    """Return profiles or layers in a line each; empty where there is none.

    Parameters of a law that vary are written "…".
    """
    forms = [getattr(one, part) for one in parameters.forms]
    briefs = ["" if one is None else one.brief for one in forms]
    for name in parameters.law if part == "layer" else ():
        briefs = [re.sub(rf"\b{name}=[^,)]+", f"{name}=…", one) for one in briefs]
    return briefs


def _about(name: str, shaped: bool = False) -> dict[str, str]:
    """Return the attributes of a variable: its meaning, and its unit if it is a number."""
    meanings = {**_MEANINGS, **_WITH_PROFILE} if shaped else _MEANINGS
    quantity = name.removesuffix("_error")
    if quantity != name:
        known = meanings[quantity][0]
        return {"long_name": f"estimate of the relative error: {known}", "units": "1"}
    if name.startswith("layer_"):
        words = name.removeprefix("layer_").replace("_", " ")
        return {"long_name": f"{words} of the layer's law"}
    meaning, unit = meanings[name]
    return {"long_name": meaning, **({"units": unit} if unit else {})}
