"""What is asked of every scene of a sweep, checked once, and the results, a row for each scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields import Array
from spectral_contact.io import checks
from spectral_contact.quantities import FIELDS, NUMBERS, OUTPUTS
from spectral_contact.solution import ADHESION_QUANTITIES, QUANTITIES, Ending, Solution
from spectral_contact.solving.asked import asked_quantities, checked_tolerance
from spectral_contact.view.report import relative_to

if TYPE_CHECKING:
    from spectral_contact.sweeps.sweep_parameters import Indices

#: Quantities that are a number for each scene: what a sweep asks for by default.
SCALARS: Final = tuple(name for name in NUMBERS if name in QUANTITIES)
#: The same with a profile.
_PROFILE_SCALARS: Final = tuple(
    one.name for one in OUTPUTS if one.kind == "number" and one.scenes in ("all", "profile")
)
#: How a scene may end: the names of `Ending` in small letters, and "failed" if an exception was
#: raised. The code of an ending is its place in this tuple.
ENDINGS: Final = ("converged", "unknowns", "rounding", "zones", "failed")
_CONVERGED: Final = ENDINGS.index("converged")
_FAILED: Final = ENDINGS.index("failed")
#: Codes of zones, by their kind and whether stick has a memory or slip goes back; 0 is no zone.
_KINDS: Final = {
    ("stick", False): 1,
    ("slip", False): 2,
    ("stick", True): 3,
    ("slip", True): 4,
}


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """The quantities, tolerance and radii that are asked for, of every scene.

    Attributes
    ----------
    quantities : tuple of str
        In the order of `QUANTITIES`.
    rtol : float
    max_unknowns : int
    places : str
        The dimension of the fields: ``"s"`` or ``"from_edge"``; empty without fields.
    s, from_edge : ndarray, shape (places,)
        Where the fields are taken: the same places as radii and as distances from the edge.
    shared : bool
        Whether the spectra are used (`shortcuts`), which take seconds to build and serve all pairs
        of compliances.
    """

    quantities: tuple[str, ...]
    rtol: float
    max_unknowns: int
    places: str
    s: Array
    from_edge: Array
    shared: bool = False

    @property
    def at_edge_alone(self) -> bool:
        """Whether fields are wanted at the edge and nowhere else."""
        return bool((self.from_edge == 0.0).all())

    @property
    def values_of_a_scene(self) -> int:
        """Count of the numbers that a scene has as results, with zones counted as one number."""
        values = sum(len(self.s) if name in FIELDS else 1 for name in self.quantities)
        return values + len(self.quantities) + 1  # their errors, and how it ended

    def describe(self) -> dict[str, Any]:
        """Return the request as an object of JSON, exact."""
        return {
            "quantities": list(self.quantities),
            "rtol": self.rtol.hex(),
            "max_unknowns": self.max_unknowns,
            "places": self.places,
            "s": [one.hex() for one in self.s.tolist()],
            "from_edge": [one.hex() for one in self.from_edge.tolist()],
            "shared": self.shared,
        }


def requested(
    quantities: Iterable[str] | None,
    rtol: float,
    max_unknowns: int,
    s: Any,
    from_edge: Any,
    *,
    shaped: bool = False,
    adhesive: bool = False,
    unloaded: bool = False,
) -> Request:
    """Return the request of a sweep, after checking its parts.

    Parameters
    ----------
    quantities : iterable of str or None
        None for all scalars that the scenes have.
    rtol, max_unknowns
        As of `solve`.
    s, from_edge : array_like or None
        Where fields are taken.
    shaped, adhesive, unloaded : bool
        Whether the scenes have profiles, whether some have adhesion, and whether some are below
        their largest load.

    Raises
    ------
    SceneError
        For an unknown quantity, a field without places or places without a field, or a value out
        of its range.
    """
    if quantities is None:
        scalars = _PROFILE_SCALARS if shaped else SCALARS
        wanted = frozenset((*scalars, *ADHESION_QUANTITIES * adhesive))
    else:
        wanted = asked_quantities(
            quantities, has_profile=shaped, adhesive=adhesive, unloaded=unloaded
        )
    if not wanted:
        raise SceneError("quantities", [], "at least one name")
    chosen = tuple(one.name for one in OUTPUTS if one.name in wanted)
    fields = [name for name in chosen if name in FIELDS]
    rtol = checked_tolerance(rtol, chosen)
    max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
    places = "s" if from_edge is None else "from_edge"
    radii, distances = _radii(places, fields, s, from_edge)
    if s is None and from_edge is None:
        places = ""
    return Request(chosen, rtol, max_unknowns, places, radii, distances)


def _radii(places: str, fields: list[str], s: Any, from_edge: Any) -> tuple[Array, Array]:
    """Return the radii at which fields are taken, and their distances from the edge."""
    if s is None and from_edge is None:
        if fields:
            allowed = "given with its radii (s= or from_edge=)"
            raise SceneError("quantities", fields[0], allowed)
        return np.empty(0), np.empty(0)
    radii, distances = checks.radii(s, from_edge)
    given = s if from_edge is None else from_edge
    if not fields:
        raise SceneError(places, given, "None without a field")
    if radii.ndim != 1 or radii.size == 0:
        raise SceneError(places, given, "a list of radii")
    return radii, distances


@dataclass(frozen=True, slots=True, eq=False)
class Served:
    """Numbers of scenes that took no solve of their own: from spectra, a line or a curve.

    Attributes
    ----------
    mask : ndarray of bool, shape (scenes,)
        Which of the scenes these are.
    values, errors : dict of str to ndarray
        By quantity, of these scenes alone.
    """

    mask: NDArray[np.bool_]
    values: dict[str, Array]
    errors: dict[str, Array]


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """The results of the scenes of a chunk.

    Attributes
    ----------
    values : dict of str to ndarray, shape (scenes, ...)
        By the name of a variable; NaN where there is no value.
    endings : ndarray of int8, shape (scenes,)
        Codes: places in `ENDINGS`.
    messages : dict of int to str
        Why a scene did not converge, by its place in the chunk.
    """

    values: dict[str, NDArray[np.generic]]
    endings: NDArray[np.int8]
    messages: dict[int, str] = field(default_factory=dict)


class Rows:
    """The results of the scenes of a chunk as they are found, a row for each scene.

    Parameters
    ----------
    count : int
        Number of scenes.
    request : Request
    """

    def __init__(self, count: int, request: Request) -> None:
        self._request = request
        self._endings = np.full(count, _FAILED, dtype=np.int8)
        self._done = np.zeros(count, dtype=bool)
        self._messages: dict[int, str] = {}
        self._values: dict[str, NDArray[np.generic]] = {}
        #: the solutions of scenes whose zones are asked for
        self._with_zones: dict[int, Solution] = {}
        for name in request.quantities:
            if name in FIELDS:
                self._values[name] = np.full((count, len(request.s)), np.nan)
            elif name != "zones":
                self._values[name] = np.full(count, np.nan)
            self._values[f"{name}_error"] = np.full(count, np.nan)

    @property
    def unsolved(self) -> Indices:
        """Places of the scenes that have no results yet."""
        return np.flatnonzero(~self._done)

    def take(self, i: int, solution: Solution) -> None:
        """Keep the quantities of a solution that are asked for."""
        request = self._request
        self._done[i] = True
        self._endings[i] = ENDINGS.index(solution.ending.name.lower())
        if solution.ending is not Ending.CONVERGED:
            self._messages[i] = solution.ending.value
        for name in request.quantities:
            try:
                value = getattr(solution, name)
            except NotComputedError:  # as the slip of a scene without friction
                continue
            error = getattr(solution.error, name)
            if error:  # of a value that may vanish it is relative to another scale
                error *= relative_to(name, solution)
            if error is not None:
                self._values[f"{name}_error"][i] = error
            if name in FIELDS:
                self._values[name][i] = value(**{request.places: getattr(request, request.places)})
            elif name == "zones":
                self._with_zones[i] = solution
            elif value is not None:
                self._values[name][i] = value

    def put(self, scenes: Indices, served: Served) -> None:
        """Keep the numbers of some scenes that took no solve of their own."""
        served_scenes = scenes[served.mask]
        self._endings[served_scenes] = _CONVERGED
        self._done[served_scenes] = True
        for name in served.values:
            self._values[name][served_scenes] = served.values[name]
            self._values[f"{name}_error"][served_scenes] = served.errors[name]

    def fail(self, i: int, error: Exception) -> None:
        """Note that a scene could not be solved."""
        self._endings[i] = _FAILED
        text = " ".join(str(error).split())
        self._messages[i] = f"{type(error).__name__}: {text}" if text else type(error).__name__
        self._with_zones.pop(i, None)
        for values in self._values.values():
            values[i] = np.nan

    def outcome(self) -> Outcome:
        """Return the results; scenes that are left count as failed."""
        if "zones" in self._request.quantities:
            self._values.update(_zone_columns(len(self._endings), self._with_zones))
        return Outcome(self._values, self._endings, self._messages)


def _zone_columns(count: int, solved: dict[int, Solution]) -> dict[str, NDArray[np.generic]]:
    """Return kind and outer radius of all zones, from the centre on; 0 and NaN where is none."""
    largest_count = max((len(one.zones) for one in solved.values()), default=0)
    kinds = np.zeros((count, largest_count), dtype=np.int8)
    outer = np.full((2, count, largest_count), np.nan)
    for i, solution in solved.items():
        for k, zone in enumerate(solution.zones):
            kinds[i, k] = _KINDS[zone.kind, zone.memory or zone.sense < 0]
            outer[:, i, k] = zone.outer, zone.outer_from_edge
    return {"zone_kind": kinds, "zone_outer": outer[0], "zone_outer_from_edge": outer[1]}
