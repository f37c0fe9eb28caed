"""The work of a sweep, cut in chunks: scenes in, columns of results out; any process can do it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import NotComputedError
from spectral_contact.processes import end_with_parent
from spectral_contact.solution import Ending, Solution
from spectral_contact.solving.run import FrictionOf
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps.lines import between, lines
from spectral_contact.sweeps.parameters import Columns, Indices, changed
from spectral_contact.sweeps.pressed import along, indentation_curves
from spectral_contact.sweeps.request import ENDINGS, FIELDS, Request
from spectral_contact.sweeps.shortcuts import Served, served
from spectral_contact.threads import one_thread

__all__ = ["Outcome", "outcome_of", "solve_chunk"]

_CONVERGED, _FAILED = ENDINGS.index("converged"), ENDINGS.index("failed")
#: Codes of the kinds of zones; 0 is none.
_KINDS: Final = {"stick": 1, "slip": 2}


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


@one_thread()
def solve_chunk(columns: Columns, request: Request, asker: int) -> Outcome:
    """Solve some scenes one after another.

    Parameters
    ----------
    columns : Columns
        Sorted, so that neighbours share what they can.
    request : Request
    asker : int
        The process that asks; if it is the parent of this one, this one ends with it.
    """
    end_with_parent(asker)
    work = _Chunk(columns, request)
    if request.shared:
        work.rows.put(np.arange(len(columns)), served(columns, request))
    for line in lines(columns, work.rows.left, request):
        work.rows.put(line, between(columns[line], request, _OnLine(work, line)))
    for curve in indentation_curves(columns, work.rows.left, request):
        work.rows.put(curve, along(columns[curve], request, _OnLine(work, curve)))
    for i in work.rows.left.tolist():
        work.solve(i)
    return work.rows.outcome()


def outcome_of(solution: Solution, request: Request) -> Outcome:
    """Return what is asked of a scene that is solved."""
    rows = _Rows(1, request)
    rows.take(0, solution)
    return rows.outcome()


class _Chunk:
    """The scenes of a chunk as they are solved, each with what the one before it hands on."""

    def __init__(self, columns: Columns, request: Request) -> None:
        self.rows = _Rows(len(columns), request)
        self.columns = columns
        own = request.rtol, request.quantities, request.max_unknowns
        self.path = Continuation(*own)

    def solve(self, i: int) -> None:
        """Solve a scene."""
        try:
            self.rows.take(i, self.path.solve(self.columns.scene(i)))
        except Exception as error:  # whatever it is, the other scenes go on
            self.rows.fail(i, error)

    def with_more(self, i: int, more: tuple[str, ...]) -> Solution | None:
        """Solve a scene with more quantities, and return it if it converged."""
        try:
            solution = self.path.solve(self.columns.scene(i), more)
        except Exception:  # it is left to `solve`
            return None
        if solution.ending is not Ending.CONVERGED:
            return None
        self.rows.take(i, solution)
        return solution


class _OnLine:
    """Solves what a line or a curve asks for."""

    def __init__(self, work: _Chunk, line: Indices) -> None:
        self._work, self._line = work, line.tolist()
        self._first = work.columns.scene(self._line[0])

    def at_scene(self, i: int, more: tuple[str, ...]) -> Solution | None:
        """Solve a scene."""
        return self._work.with_more(self._line[i], more)

    def of_radius(self, radius: float, more: tuple[str, ...]) -> Solution | None:
        """Solve the first scene with another contact radius."""
        try:
            scene = changed(self._first, {"contact_radius": radius})
            solution = self._work.path.solve(scene, more)
        except Exception:  # the scenes are left to `solve`
            return None
        return solution if solution.ending is Ending.CONVERGED else None

    def at_radius(self, logit: float) -> FrictionOf | None:
        """Solve for the friction that a radius has."""
        try:
            return self._work.path.given_radius(self._first, logit)
        except Exception:  # the scenes are left to `solve`
            return None


class _Rows:
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
            kinds[i, k] = _KINDS[zone.kind]
            outer[:, i, k] = zone.outer, zone.outer_from_edge
    return {"zone_kind": kinds, "zone_outer": outer[0], "zone_outer_from_edge": outer[1]}
