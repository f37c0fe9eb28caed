"""The two studies: solvers are run and timed, and their solutions compared with the truth."""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import real
from spectral_contact.io.choices import function, instance, listed
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve
from spectral_contact.studies.machine import Machine, this_machine
from spectral_contact.studies.named_solvers import Solver, solver_name
from spectral_contact.studies.study_results import Convergence, Point, WorkPrecision
from spectral_contact.studies.study_store import StudyStore
from spectral_contact.studies.timing import Stopwatch, Times, times_of
from spectral_contact.studies.truth import Truth, chosen, estimate_of, given_truth
from spectral_contact.view.progress import ProgressLine

_STOPWATCH: Final = Stopwatch()
_OF_SCENES: Final = "a scene and a resolution"
#: Digits of a reference that is the truth.
_DIGITS: Final = 20
#: The loosest tolerance that `solve` takes; a looser solve would not be cheaper.
_LOOSEST: Final = 1e-2


def convergence(
    solver: Solver,
    scene: Scene,
    resolutions: Sequence[float],
    truth: Any = None,
    *,
    quantities: Sequence[str] | None = None,
    name: str | None = None,
    stopwatch: Stopwatch | None = _STOPWATCH,
    store: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
) -> Convergence:
    """Measure the errors of a solver over the number of unknowns, and its times.

    Parameters
    ----------
    solver : callable
        ``solver(scene, resolution)`` returns any object with some of ``approach``,
        ``total_shear``, ``stick_radius``, ``pressure(s)`` and ``traction(s)``, dimensionless as in
        `Solution`; functions of arrays of s, or of distances if they take ``from_edge``. Optional
        are ``unknowns``, ``refinements``, and estimates of the relative errors in ``error``.
        `OwnSolver` is this library's.
    scene : Scene
    resolutions : sequence of (int or float)
        What the solver is called with, in this order: a number of elements, a tolerance. All
        different, positive and finite.
    truth : object, optional
        See `truth_of`: gold if the scene is there, else `reference`, is the default.
    quantities : sequence of str, optional
        Out of `QUANTITIES`; the default is all that the truth has, and of them what the solver has.
    name : str, optional
        What the solver is called; its own name is the default.
    stopwatch : Stopwatch or None
        How times are taken; None for no times.
    store : path, optional
        A file that keeps every point as it is done, so that the same call goes on after it was
        stopped. It knows solvers by name: take another file when the solver has changed.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    Convergence

    Raises
    ------
    SceneError
        For an argument out of its range, or a quantity asked for that the solver lacks.
    NotComputedError
        If there is no truth; see `truth_of`.
    SolutionFileError
        If the store cannot be written, is damaged, or belongs to another study.

    Notes
    -----
    An exception of the solver is recorded in the point as its failure, and the study continues.

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> from spectral_contact.studies import OwnSolver, convergence
    >>> study = convergence(OwnSolver(), Scene(0.1, 0.5), [1e-3, 1e-6, 1e-9], stopwatch=None)
    >>> all(point.errors["pressure"] < point.resolution for point in study.points)
    True
    """
    asked = _resolutions("resolutions", resolutions)
    if name is not None:
        instance("name", name, str)
    if stopwatch is not None:
        instance("stopwatch", stopwatch, Stopwatch)
    called = function("solver", solver, _OF_SCENES)
    tell = ProgressLine(progress)
    true = truth_of(scene, truth, progress=progress)
    case = _Case(name or solver_name(called), called, asked, true)
    with tell:
        run = _Study("convergence", [case], quantities, stopwatch, store, tell)
        points = tuple(
            run.point(case, resolution, i / len(asked)) for i, resolution in enumerate(asked)
        )
        tell("", 1.0)
    return Convergence(
        case.name, scene, true.source, true.error, run.shown(points), points, stopwatch, run.machine
    )


def work_precision(
    solvers: Mapping[str, Any],
    scenes: Scene | Sequence[Scene],
    accuracies: Sequence[float],
    truths: Sequence[Any] | None = None,
    *,
    quantities: Sequence[str] | None = None,
    stopwatch: Stopwatch = _STOPWATCH,
    store: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
) -> WorkPrecision:
    """Measure the time that each of several solvers needs to reach an accuracy.

    Every solver runs through its resolutions until all errors are below the least accuracy.

    Parameters
    ----------
    solvers : mapping of str to (callable or (callable, sequence))
        By name: a solver as in `convergence`, and the resolutions to try, from coarse to fine. A
        solver alone is called with the accuracies, as one whose resolution is a tolerance. The
        others are compared with the first.
    scenes : Scene or sequence of Scene
    accuracies : sequence of float
        Relative errors to be reached, in (0, 1).
    truths : sequence of object, optional
        The truth of each scene, see `truth_of`; None among them is its default.
    quantities, stopwatch, store, progress
        See `convergence`; there are always times here.

    Returns
    -------
    WorkPrecision

    Raises
    ------
    SceneError
        For an argument out of its range, or a quantity asked for that a solver lacks.
    NotComputedError
        If there is no truth; see `truth_of`.
    SolutionFileError
        If the store cannot be written, is damaged, or belongs to another study.
    """
    goals = tuple(sorted(_resolutions("accuracies", accuracies, high=1.0), reverse=True))
    several = [scenes] if isinstance(scenes, Scene) else listed("scenes", scenes, "scenes")
    solved = tuple(instance("scenes", scene, Scene) for scene in several)
    given = [None] * len(solved) if truths is None else listed("truths", truths, "truths")
    if not solved or len(set(solved)) < len(solved):
        raise SceneError("scenes", scenes, "at least one, and all different")
    if len(given) != len(solved):
        raise SceneError("truths", truths, f"as many as there are scenes, {len(solved)}")
    instance("stopwatch", stopwatch, Stopwatch)
    tell = ProgressLine(progress)
    called = _solvers(solvers, goals)
    found = [
        _truth_named("truths", scene, truth, progress)
        for scene, truth in zip(solved, given, strict=True)
    ]
    cases = [_Case(name, *one, true) for true in found for name, one in called.items()]
    points: list[Point] = []
    with tell:
        run = _Study("work-precision", cases, quantities, stopwatch, store, tell)
        for i, case in enumerate(cases):
            for k, resolution in enumerate(case.resolutions):
                share = (i + k / len(case.resolutions)) / len(cases)
                points.append(run.point(case, resolution, share))
                errors = points[-1].errors
                if errors and max(errors.values()) <= goals[-1]:
                    break
        tell("", 1.0)
    return WorkPrecision(
        tuple(called),
        solved,
        tuple(true.source for true in found),
        goals,
        run.shown(points),
        tuple(points),
        stopwatch,
        run.machine,
    )


def truth_of(scene: Scene, truth: Any = None, *, progress: bool | None = None) -> Truth:
    """Return the truth about a scene.

    Parameters
    ----------
    scene : Scene
    truth : object, optional
        A `GoldSolution`, a `ReferenceSolution`, or anything with some of the same attributes: a
        `Solution` to a tolerance far below the errors to be measured, a closed form. By default it
        is the gold solution of the scene if there is one, else `reference` to 20 digits, which
        takes from seconds to minutes.
    progress : bool, optional
        Whether to show that of `reference`; by default on a terminal and in notebooks.

    Returns
    -------
    Truth

    Raises
    ------
    SceneError
        If `truth` belongs to another scene, or has nothing to compare with.
    NotComputedError
        If `reference` does not solve the scene; give the truth then.
    """
    return _truth_named("truth", scene, truth, progress)


def _truth_named(name: str, scene: Scene, truth: Any, progress: bool | None) -> Truth:
    """Return the truth about a scene; an error calls what is given by its name."""
    instance("scene", scene, Scene)
    ProgressLine(progress)  # refuses what it cannot be
    if truth is not None:
        return given_truth(name, scene, truth)
    source, truth = _best(scene, progress)
    return given_truth(name, scene, truth, source)


def _best(scene: Scene, progress: bool | None) -> tuple[str, Any]:
    """Return the gold solution of a scene, or its reference, and what to call it."""
    # mpmath, on which both of them are built, is imported for studies alone
    from spectral_contact import gold
    from spectral_contact.precise.certified import certified

    solution = gold.find(scene)
    if solution is not None:
        return f"gold table {solution.table}, {solution.digits} digits", solution
    return f"reference, {_DIGITS} digits", certified(scene, _DIGITS, solve, progress=progress)


@dataclass(frozen=True, slots=True)
class OwnSolver:
    """`solve` of this library; the resolution is its ``rtol``, at most 1e-2.

    What cannot meet the tolerance is returned as far as it got, with its estimates.

    Parameters
    ----------
    quantities : tuple of str, optional
        What `solve` is asked for; the default is everything.
    """

    quantities: tuple[str, ...] | None = None

    @property
    def name(self) -> str:
        """The name in tables and figures."""
        return "spectral_contact"

    def __call__(self, scene: Scene, rtol: float) -> Solution:
        """Solve a scene to a tolerance."""
        asked = real("rtol", rtol, allowed=">= 1e-13", low=1e-13, infinite_ok=True)
        return solve(scene, min(asked, _LOOSEST), self.quantities, strict=False)


@dataclass(frozen=True, slots=True, eq=False)
class _Case:
    """One solver on one scene."""

    name: str
    solver: Solver
    resolutions: tuple[float, ...]
    truth: Truth


class _Study:
    """Points from the store or from a solver, for either study."""

    def __init__(
        self,
        kind: str,
        cases: Sequence[_Case],
        quantities: Sequence[str] | None,
        stopwatch: Stopwatch | None,
        store: str | os.PathLike[str] | None,
        tell: ProgressLine,
    ) -> None:
        self.wanted = chosen(quantities, [case.truth for case in cases])
        self.machine: Machine = this_machine()
        self._asked = quantities is not None
        self._stopwatch = stopwatch
        identity = {
            "study": kind,
            "quantities": list(self.wanted),
            "stopwatch": None if stopwatch is None else asdict(stopwatch),
            "machine": asdict(self.machine),
        }
        known = {(case.name, case.truth.scene): case.truth.identity for case in cases}
        self._store = StudyStore(store, identity, known)
        self._tell = tell

    def point(self, case: _Case, resolution: float, share: float) -> Point:
        """Return a point; the share in [0, 1] of all work is done before it."""
        self._tell(f"{case.name} at {resolution:g}", share)
        known = self._store.get(case.name, case.truth.scene, resolution)
        if known is None:
            known = self._measured(case, resolution)
            self._store.add(known)
        return known

    def shown(self, points: Sequence[Point]) -> tuple[str, ...]:
        """Return the quantities asked for, or those that were there."""
        if self._asked:
            return self.wanted
        return tuple(q for q in self.wanted if any(q in p.errors for p in points)) or self.wanted

    def _measured(self, case: _Case, resolution: float) -> Point:
        scene = case.truth.scene
        wanted = [name for name in self.wanted if name in case.truth.quantities]
        solution, times, failure = None, None, ""
        errors: dict[str, float] = {}
        estimates: dict[str, float] = {}
        try:
            solution = case.solver(scene, resolution)
            errors = case.truth.errors(solution, wanted)
            known = {name: estimate_of(solution, name) for name in errors}
            estimates = {name: one for name, one in known.items() if one is not None}
        except Exception as error:  # a user's solver may raise anything
            failure = _said(error)
        else:
            lacking = [name for name in wanted if name not in errors]
            if lacking and (self._asked or not errors):
                allowed = f"one whose solutions have {' or '.join(lacking)}"
                raise SceneError("solver", case.name, allowed)
            times, failure = self._timed(case, resolution)
        unknowns = _counted(solution, "unknowns")
        if unknowns is None and isinstance(resolution, int):
            unknowns = resolution
        return Point(
            case.name,
            scene,
            resolution,
            unknowns,
            _counted(solution, "refinements"),
            errors,
            estimates,
            times,
            failure,
        )

    def _timed(self, case: _Case, resolution: float) -> tuple[Times | None, str]:
        """Return the times that are asked for, and what went wrong."""
        if self._stopwatch is None:
            return None, ""
        try:
            return times_of(case.solver, case.truth.scene, resolution, self._stopwatch), ""
        except Exception as error:
            return None, _said(error)


def _said(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


def _counted(solution: Any, name: str) -> int | None:
    """Return a count of a solution, or of its work."""
    for owner in (solution, getattr(solution, "work", None)):
        value = getattr(owner, name, None)
        if isinstance(value, numbers.Integral) and not isinstance(value, bool):
            return int(value)
    return None


def _resolutions(parameter: str, values: Any, high: float = math.inf) -> tuple[float, ...]:
    """Return numbers that are positive and different, whole ones as ints."""
    allowed = "finite and > 0" if high == math.inf else f"in (0, {high:g})"
    limits: dict[str, Any] = {"low": 0.0, "low_open": True, "high": high, "high_open": True}
    found: list[float] = []
    for value in listed(parameter, values, "numbers"):
        number = real(parameter, value, allowed=allowed, **limits)
        found.append(int(value) if isinstance(value, numbers.Integral) else number)
    if not found or len(set(found)) < len(found):
        raise SceneError(parameter, values, "a list of numbers, all different")
    return tuple(found)


def _solvers(solvers: Any, goals: tuple[float, ...]) -> dict[str, tuple[Solver, tuple[float, ...]]]:
    """Return the solvers with their resolutions, by name."""
    if not isinstance(solvers, Mapping) or not solvers:
        raise SceneError("solvers", solvers, "a mapping of names to solvers")
    found = {}
    for name, one in solvers.items():
        instance("solvers", name, str)
        pair = isinstance(one, tuple) and len(one) == 2
        solver, resolutions = one if pair else (one, goals)
        called = function("solvers", solver, _OF_SCENES)
        found[name] = called, _resolutions("solvers", resolutions) if pair else goals
    return found
