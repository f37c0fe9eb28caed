"""What is asked of every scene of a sweep, checked once, and what comes of it, row by row."""

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

if TYPE_CHECKING:
    from spectral_contact.sweeps.sweep_parameters import Indices

#: Quantities that are a number for each scene: what a sweep asks for by default.
SCALARS: Final = tuple(name for name in NUMBERS if name in QUANTITIES)
#: The same with a profile.
_PROFILE_SCALARS: Final = tuple(
    one.name for one in OUTPUTS if one.kind == "number" and one.scenes in ("all", "profile")
)
#: How a scene can end, by code: the endings of `solve` in small letters, and failure.
ENDINGS: Final = ("converged", "unknowns", "rounding", "zones", "failed")
_CONVERGED, _FAILED = ENDINGS.index("converged"), ENDINGS.index("failed")
#: Codes of the kinds of zones, by whether they stick with memory or slip back; 0 is none.
_KINDS: Final = {
    ("stick", False): 1,
    ("slip", False): 2,
    ("stick", True): 3,
    ("slip", True): 4,
}


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is asked of every scene.

    Attributes
    ----------
    quantities : tuple of str
        In the order of `QUANTITIES`.
    rtol : float
    max_unknowns : int
    places : str
        The dimension of the fields: ``"s"`` or ``"from_edge"``; empty without fields.
    s, from_edge : ndarray, shape (places,)
        Where the fields are taken.
    shared : bool
        Whether there are so many compliances that decompositions which serve all of them pay.
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
        """How many numbers the results of a scene are, those of its zones as of one."""
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
    """Check what is asked, of scenes with a profile if they are shaped, with adhesion if adhesive.

    Below the largest load (`unloaded`) the thresholds of the load are not among the default.

    Raises
    ------
    SceneError
        For a quantity that there is not, a field without places or places without a field, or
        a value out of its range.
    """
    if quantities is None:
        scalars = _PROFILE_SCALARS if shaped else SCALARS
        asked = frozenset((*scalars, *ADHESION_QUANTITIES * adhesive))
    else:
        asked = asked_quantities(
            quantities, has_profile=shaped, adhesive=adhesive, unloaded=unloaded
        )
    if not asked:
        raise SceneError("quantities", [], "at least one name")
    chosen = tuple(one.name for one in OUTPUTS if one.name in asked)
    places = "s" if from_edge is None else "from_edge"
    return Request(
        chosen,
        checked_tolerance(rtol, chosen),
        checks.whole("max_unknowns", max_unknowns, 1),
        "" if s is None and from_edge is None else places,
        *_radii(places, [name for name in chosen if name in FIELDS], s, from_edge),
    )


def _radii(places: str, fields: list[str], s: Any, from_edge: Any) -> tuple[Array, Array]:
    """Return where the fields are taken: radii and distances from the edge."""
    if s is None and from_edge is None:
        if fields:
            told = "given with its radii (s= or from_edge=)"
            raise SceneError("quantities", fields[0], told)
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
    """What the spectra know.

    Attributes
    ----------
    mask : ndarray of bool, shape (scenes,)
        Of which scenes.
    values, errors : dict of str to ndarray
        By quantity, of these scenes alone.
    """

    mask: NDArray[np.bool_]
    values: dict[str, Array]
    errors: dict[str, Array]


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of some scenes.

    Attributes
    ----------
    values : dict of str to ndarray, shape (scenes, ...)
        By the name of a variable; NaN where there is no value.
    endings : ndarray of int8, shape (scenes,)
        Places in `ENDINGS`.
    messages : dict of int to str
        What is to be said of a scene of this chunk, if it did not converge.
    """

    values: dict[str, NDArray[np.generic]]
    endings: NDArray[np.int8]
    messages: dict[int, str] = field(default_factory=dict)


class Rows:
    """Results as they come, row by row."""

    def __init__(self, count: int, request: Request) -> None:
        self._request = request
        self._endings = np.full(count, _FAILED, dtype=np.int8)
        self._done = np.zeros(count, dtype=bool)
        self._messages: dict[int, str] = {}
        self._values: dict[str, NDArray[np.generic]] = {}
        self._zones: dict[int, Solution] = {}
        for name in request.quantities:
            if name in FIELDS:
                self._values[name] = np.full((count, len(request.s)), np.nan)
            elif name != "zones":
                self._values[name] = np.full(count, np.nan)
            self._values[f"{name}_error"] = np.full(count, np.nan)

    @property
    def left(self) -> Indices:
        """The scenes that need work."""
        return np.flatnonzero(~self._done)

    def take(self, i: int, solution: Solution) -> None:
        """Keep what was asked of a solution."""
        request = self._request
        self._done[i] = True
        self._endings[i] = ENDINGS.index(solution.ending.name.lower())
        if solution.ending is not Ending.CONVERGED:
            self._messages[i] = solution.ending.value
        for name in request.quantities:
            try:
                value = getattr(solution, name)
            except NotComputedError:  # a scene without friction has no slip and no ratios
                continue
            error = getattr(solution.error, name)
            if error is not None:
                self._values[f"{name}_error"][i] = error
            if name in FIELDS:
                self._values[name][i] = value(**{request.places: getattr(request, request.places)})
            elif name == "zones":
                self._zones[i] = solution
            elif value is not None:
                self._values[name][i] = value

    def put(self, scenes: Indices, known: Served) -> None:
        """Keep what is known of some scenes without a solve of their own."""
        own = scenes[known.mask]
        self._endings[own] = _CONVERGED
        self._done[own] = True
        for name in known.values:
            self._values[name][own] = known.values[name]
            self._values[f"{name}_error"][own] = known.errors[name]

    def fail(self, i: int, error: Exception) -> None:
        """Note that a scene could not be solved."""
        self._endings[i] = _FAILED
        text = " ".join(str(error).split())
        self._messages[i] = f"{type(error).__name__}: {text}" if text else type(error).__name__
        self._zones.pop(i, None)
        for values in self._values.values():
            values[i] = np.nan

    def outcome(self) -> Outcome:
        """Return everything."""
        if "zones" in self._request.quantities:
            self._values.update(_zone_columns(len(self._endings), self._zones))
        return Outcome(self._values, self._endings, self._messages)


def _zone_columns(count: int, solved: dict[int, Solution]) -> dict[str, NDArray[np.generic]]:
    """Return kind and outer radius of every zone, from the centre; 0 and NaN where is none."""
    most = max((len(one.zones) for one in solved.values()), default=0)
    kinds = np.zeros((count, most), dtype=np.int8)
    outer = np.full((2, count, most), np.nan)
    for i, solution in solved.items():
        for k, zone in enumerate(solution.zones):
            kinds[i, k] = _KINDS[zone.kind, zone.memory or zone.sense < 0]
            outer[:, i, k] = zone.outer, zone.outer_from_edge
    return {"zone_kind": kinds, "zone_outer": outer[0], "zone_outer_from_edge": outer[1]}
