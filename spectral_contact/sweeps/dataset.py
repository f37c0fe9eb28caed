"""Results as an `xarray.Dataset` with names, units and meanings."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.errors import optional
from spectral_contact.processes import VERSION
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.quantities import FIELDS, OUTPUTS
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import ENDINGS, Outcome, Request, Rows, requested
from spectral_contact.sweeps.sweep_parameters import Indices, SweepParameters, alone
from spectral_contact.view.radii import graded_radii

if TYPE_CHECKING:
    import xarray

#: Meaning and unit of everything in a dataset.
_MEANINGS: Final = {
    **{one.name: (one.meaning, one.unit) for one in OUTPUTS},
    "poisson_ratio": ("Poisson's ratio ν", "1"),
    "kappa": ("coupling constant κ of two bodies", "1"),
    "normal_compliance": ("normal compliance α* = αE/(4(1−ν²)a)", "1"),
    "tangential_compliance": ("tangential compliance β* = βE/(4(1−ν²)a)", "1"),
    "friction": ("coefficient of friction f", "1"),
    "unloaded_to": ("load over the largest load λ", "1"),
    "s": ("radius s = r/a", "1"),
    "from_edge": ("distance from the edge 1 − r/a", "1"),
    "separation": ("separation at the deformed centre", "L"),
    "work_of_adhesion": ("work of adhesion w", "E'L"),
    "branch": ("stretch of the curve of states, from large contacts", ""),
    "profile": ("shape of the punch", ""),
    "layer": ("law of the layer", ""),
    "coupling": ("whether the traction acts back on the pressure", ""),
    "zone_kind": ("kind of a zone, from the centre: 1 stick, 2 slip, 0 none", "1"),
    "zone_outer": ("outer radius of a zone", "a"),
    "zone_outer_from_edge": ("distance of it from the edge", "a"),
    "ending": ("how the solve ended", ""),
    "message": ("what is to be said of it", ""),
}
#: What is otherwise with a profile, E' = E/(4(1−ν²)).
_WITH_PROFILE: Final = {
    **{one.name: one.under_profile for one in OUTPUTS if one.under_profile},
    "normal_compliance": ("normal compliance αE'/L", "1"),
    "tangential_compliance": ("tangential compliance βE'/L", "1"),
}
#: Parameters that scenes do not have, or that are results.
_MAY_BE_ABSENT: Final = (*ALL_CONTROLS, "work_of_adhesion")


class Collected:
    """The results of all scenes, filled chunk by chunk.

    Parameters
    ----------
    size : int
        Number of scenes.
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
        """Return the results of some scenes, each as often as it is named."""
        found = Collected(len(which))
        found.values = {name: values[which] for name, values in self.values.items()}
        found.endings = self.endings[which]
        each = enumerate(which.tolist())
        found.messages = {i: self.messages[k] for i, k in each if k in self.messages}
        return found

    def _column(self, name: str, like: NDArray[Any]) -> NDArray[Any]:
        """Return a column that is wide enough: scenes differ in how many zones they have."""
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


def assembled(parameters: SweepParameters, request: Request, table: Collected) -> xarray.Dataset:
    """Return the dataset of a finished sweep."""
    dims, shape, shaped = parameters.dims, parameters.shape, parameters.shaped
    coordinates = _coordinates(parameters, request)
    variables = {}
    for name, values in table.values.items():
        if name.removesuffix("_error") in coordinates:  # what is given of a contact
            continue
        own = (request.places,) if name in FIELDS else ("zone",) * (values.ndim - 1)
        whole = values.reshape((*shape, *values.shape[1:]))
        variables[name] = (*dims, *own), whole, _about(name, shaped)
    ending = np.array(ENDINGS, dtype=object)[table.endings]
    message = np.full(parameters.size, "", dtype=object)
    for i, text in table.messages.items():
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


def of_solution(
    solution: Solution, s: ArrayLike | None = None, from_edge: ArrayLike | None = None
) -> xarray.Dataset:
    """Return the dataset of one solution; see `Solution.to_xarray`."""
    needed()
    scene, quantities, radii = solution.scene, solution.plan.quantities, None
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
    if radii is not None:  # each from the side on which it is accurate
        for name in set(FIELDS).intersection(quantities):
            outcome.values[name][0] = radii.evaluate(getattr(solution, name))
    table = Collected(1)
    table.put(np.arange(1), outcome)
    return assembled(alone(scene), request, table)


def _coordinates(parameters: SweepParameters, request: Request) -> dict[str, Any]:
    """Return what varies as dimensions, the rest as scalars, and both forms of the places."""
    found: dict[str, Any] = {}
    for k, name in enumerate(parameters.names):
        values: Any = parameters.fixed[k] if parameters.table is None else parameters.table[k]
        values = parameters.axes.get(name, values)
        if name == "unloaded_to" and not parameters.unloaded and name not in parameters.axes:
            continue
        # a load or radius that is not given of every contact is a result
        if name not in _MAY_BE_ABSENT or np.isfinite(values).all():
            dims = parameters.dims if parameters.table is not None else (name,) * np.ndim(values)
            found[name] = dims, values, _about(name, parameters.shaped)
    found |= _forms(parameters)
    if request.places:
        for name in ("s", "from_edge"):
            found[name] = (request.places, getattr(request, name), _about(name))
    return found


def _forms(parameters: SweepParameters) -> dict[str, Any]:
    """Return what scenes have besides numbers: profile, layer, coupling and branch."""
    found: dict[str, Any] = {}
    for part in ("profile", "layer") if parameters.shaped else ():
        briefs = _briefs(parameters, part)
        if any(briefs):
            brief = briefs[0] if parameters.table is None else np.array(briefs, dtype=object)
            found[part] = parameters.dims * np.ndim(brief), brief, _about(part)
    for name in ("coupling", "branch"):
        each = np.array([getattr(one, name) for one in parameters.forms])
        if each.any():
            own = (parameters.dims, each) if len(each) > 1 else ((), each[0].item())
            found[name] = *own, _about(name)
    return found


def _briefs(parameters: SweepParameters, part: str) -> list[str]:
    """Return profiles or layers in a line each, without what varies; empty where there is none."""
    forms = [getattr(one, part) for one in parameters.forms]
    briefs = ["" if one is None else one.brief for one in forms]
    for name in parameters.law if part == "layer" else ():
        briefs = [re.sub(rf"\b{name}=[^,)]+", f"{name}=…", one) for one in briefs]
    return briefs


def _about(name: str, shaped: bool = False) -> dict[str, str]:
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
