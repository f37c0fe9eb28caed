"""`convergence` and `work_precision`: solvers are run, timed, and compared with the truth."""

from __future__ import annotations

import math
import numbers
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Final

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import real, whole, within
from spectral_contact.io.choices import function, instance, listed
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve
from spectral_contact.spectral.cache import clear_caches
from spectral_contact.studies.study_results import Convergence, Point, WorkPrecision
from spectral_contact.studies.timing import this_machine, times_of
from spectral_contact.studies.truth import Truth, attribute_of, chosen, estimate_of, given_truth
from spectral_contact.view.progress import ProgressLine

#: ``solver(scene, resolution)`` returns any object with some of the quantities of a study.
Solver = Callable[[Scene, Any], Any]

#: What is to be run: name, solver, resolutions and truth.
_Case = tuple[str, Solver, tuple[float, ...], Truth]

#: Arguments of a solver, as an error names them.
_OF_SCENES: Final = "a scene and a resolution"
#: Most repeats of a timed solve, chosen: more say nothing more about a time.
_MOST_REPEATS: Final = 10_000
#: Digits of the `reference` that is the truth by default.
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
    repeats: int = 5,
    progress: bool | None = None,
) -> Convergence:
    """Measure the errors of a solver over the number of unknowns, and its times.

    Parameters
    ----------
    solver : callable
        ``solver(scene, resolution)`` returns any object with some of ``approach``,
        ``total_shear``, ``stick_radius``, ``pressure(s)`` and ``traction(s)``, dimensionless as in
        `Solution`; functions of arrays of s, or of distances if they take ``from_edge``. Optional
        are ``unknowns``, and estimates of the relative errors in ``error``. `OwnSolver` is this
        library's.
    scene : Scene
    resolutions : sequence of (int or float)
        What the solver is called with, in this order: a number of elements, a tolerance. All
        different, positive and finite.
    truth : object, optional
        See `truth_of`: gold if the scene is there, else `reference`, is the default.
    quantities : sequence of str, optional
        Out of `QUANTITIES`; by default those that both the truth and the solver have.
    name : str, optional
        What the solver is called; its own name is the default.
    repeats : int
        Least number of solves that are timed at each resolution, at most 10,000; 0 for no times.
        Short solves are repeated for 0.2 s, or a thousand times. A solver with a function
        ``clear_caches`` is timed with empty caches, too.
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

    Notes
    -----
    An exception of the solver is recorded in the point as its failure, and the study continues.

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> from spectral_contact.studies import OwnSolver, convergence
    >>> study = convergence(OwnSolver(), Scene(0.1, 0.5), [1e-3, 1e-6, 1e-9], repeats=0)
    >>> all(point.errors["pressure"] < point.resolution for point in study.points)
    True
    """
    levels = _resolutions("resolutions", resolutions)
    solver = function("solver", solver, _OF_SCENES)
    title = _name(solver) if name is None else instance("name", name, str)
    repeats = whole("repeats", repeats, 0, _MOST_REPEATS)
    true = truth_of(scene, truth, progress=progress)
    runs = _Runs(chosen(quantities, [true]), quantities is not None, repeats)
    measured, points = runs.measured([(title, solver, levels, true)], None, progress)
    return Convergence(title, scene, true.source, true.error, measured, points, this_machine())


def work_precision(
    solvers: Mapping[str, Any],
    scenes: Scene | Sequence[Scene],
    accuracies: Sequence[float],
    truths: Sequence[Any] | None = None,
    *,
    quantities: Sequence[str] | None = None,
    repeats: int = 5,
    progress: bool | None = None,
) -> WorkPrecision:
    """Measure the time that each of several solvers needs to reach an accuracy.

    Every solver runs through its resolutions until no error is above the smallest of `accuracies`.

    Parameters
    ----------
    solvers : mapping of str to (callable or (callable, sequence))
        By name: a solver as in `convergence`, and the resolutions to try, from coarse to fine. A
        solver that is given without resolutions is called with the accuracies: its resolution is
        then a tolerance. The first solver is the one that the others are compared with.
    scenes : Scene or sequence of Scene
    accuracies : sequence of float
        Relative errors to be reached, in (0, 1).
    truths : sequence of object, optional
        The truth of each scene, see `truth_of`; None among them is its default.
    quantities, repeats, progress
        See `convergence`; `repeats` is at least 1.

    Returns
    -------
    WorkPrecision

    Raises
    ------
    SceneError
        For an argument out of its range, or a quantity asked for that a solver lacks.
    NotComputedError
        If there is no truth; see `truth_of`.
    """
    goals = tuple(sorted(_resolutions("accuracies", accuracies, "in (0, 1)"), reverse=True))
    several = [scenes] if isinstance(scenes, Scene) else listed("scenes", scenes, "scenes")
    solved = tuple(instance("scenes", scene, Scene) for scene in several)
    given = [None] * len(solved) if truths is None else listed("truths", truths, "truths")
    if not solved or len(set(solved)) < len(solved):
        raise SceneError("scenes", scenes, "at least one, and all different")
    if len(given) != len(solved):
        raise SceneError("truths", truths, f"as many as there are scenes, {len(solved)}")
    repeats = whole("repeats", repeats, 1, _MOST_REPEATS)
    by_name = _solvers(solvers, goals)
    found_truths = [
        _truth_named("truths", scene, truth, progress)
        for scene, truth in zip(solved, given, strict=True)
    ]
    runs = _Runs(chosen(quantities, found_truths), quantities is not None, repeats)
    cases = [
        (name, solver, levels, true)
        for true in found_truths
        for name, (solver, levels) in by_name.items()
    ]
    measured, points = runs.measured(cases, goals[-1], progress)
    sources = tuple(true.source for true in found_truths)
    return WorkPrecision(tuple(by_name), solved, sources, goals, measured, points, this_machine())


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
    """Return the truth about a scene; errors say that it was given as the argument `name`."""
    instance("scene", scene, Scene)
    ProgressLine(progress)  # refuses a wrong `progress`
    if truth is not None:
        return given_truth(name, scene, truth)
    # both import mpmath, which only studies need
    from spectral_contact import gold
    from spectral_contact.precise.certified import certified

    known = gold.find(scene)
    if known is not None:
        return given_truth(name, scene, known, f"gold table {known.table}, {known.digits} digits")
    solution = certified(scene, _DIGITS, solve, progress=progress)
    return given_truth(name, scene, solution, f"reference, {_DIGITS} digits")


@dataclass(frozen=True, slots=True)
class OwnSolver:
    """`solve` of this library; the resolution is its ``rtol``, at most 1e-2.

    A solution that cannot meet the tolerance is returned with what was reached, and its estimates.

    Parameters
    ----------
    quantities : tuple of str, optional
        Quantities of a study, which `solve` is asked for; the default is everything.
    """

    quantities: tuple[str, ...] | None = None
    name: ClassVar[str] = "spectral_contact"
    clear_caches: ClassVar[Callable[[], None]] = staticmethod(clear_caches)

    def __call__(self, scene: Scene, rtol: float) -> Solution:
        """Solve a scene to a tolerance."""
        asked = real("rtol", rtol, allowed=">= 1e-13", low=1e-13, infinite_ok=True)
        wanted = self.quantities and tuple(dict.fromkeys(map(attribute_of, self.quantities)))
        return solve(scene, min(asked, _LOOSEST), wanted, strict=False)


def named_solver(name: str) -> Solver:
    """Return the solver of that name.

    Parameters
    ----------
    name : str
        ``"module:function"``, or ``"module:Class"`` whose constructor takes scene and resolution.

    Raises
    ------
    SceneError
        If there is no such module or callable in it.
    """
    module, _, path = instance("name", name, str).partition(":")
    if not (module and path):
        raise SceneError("solver", name, "written module:function")
    try:
        found = pkgutil.resolve_name(name)
    except Exception as error:  # a user's module may raise anything when it is imported
        reason = f"a callable that can be imported ({type(error).__name__}: {error})"
        raise SceneError("solver", name, reason) from error
    return function("solver", found, _OF_SCENES)


def _name(solver: Solver) -> str:
    """Return what a solver is called: its ``name``, or that of the function or class."""
    owner = solver.func if isinstance(solver, partial) else solver
    named = (getattr(owner, one, None) for one in ("name", "__name__"))
    return next((one for one in named if isinstance(one, str)), type(owner).__name__)


@dataclass(frozen=True, slots=True)
class _Runs:
    """What is measured in every run of a solver.

    Attributes
    ----------
    wanted : tuple of str
        Quantities.
    asked : bool
        Whether the user named them: then every solution must have each.
    repeats : int
        Least number of timed solves; 0 for no times.
    """

    wanted: tuple[str, ...]
    asked: bool
    repeats: int

    def measured(
        self, cases: Sequence[_Case], goal: float | None, progress: bool | None
    ) -> tuple[tuple[str, ...], tuple[Point, ...]]:
        """Run solvers, and return the quantities of a study and its points.

        A solver runs through its resolutions until all errors are at most the goal, or through all
        resolutions without a goal. The quantities are those that the user named, or else those that
        some solution has.
        """
        found: list[Point] = []
        with ProgressLine(progress) as tell:
            for i, (name, solver, resolutions, true) in enumerate(cases):
                for k, resolution in enumerate(resolutions):
                    tell(f"{name} at {resolution:g}", (i + k / len(resolutions)) / len(cases))
                    found.append(self._point(name, solver, true, resolution))
                    worst = max(found[-1].errors.values(), default=math.inf)
                    if goal is not None and worst <= goal:
                        break
            tell("", 1.0)
        known = tuple(name for name in self.wanted if any(name in one.errors for one in found))
        # `known` is empty if no solve was done
        return (self.wanted if self.asked else known or self.wanted), tuple(found)

    def _point(self, name: str, solver: Solver, truth: Truth, resolution: float) -> Point:
        """Run a solver once, compare it with the truth, and time it."""
        wanted = [one for one in self.wanted if one in truth.quantities]
        point = Point(name, truth.scene, resolution, _unknowns(None, resolution), {}, {}, None)
        try:
            solution = solver(truth.scene, resolution)
            point = replace(point, unknowns=_unknowns(solution, resolution))
            point = replace(point, errors=truth.errors(solution, wanted))
            known = {one: estimate_of(solution, one) for one in point.errors}
            estimates = {one: estimate for one, estimate in known.items() if estimate is not None}
            point = replace(point, estimates=estimates)
            if self.repeats:
                times = times_of(solver, truth.scene, resolution, self.repeats)
                point = replace(point, times=times)
        except Exception as error:  # a user's solver may raise anything
            return replace(point, failure=" ".join(f"{type(error).__name__}: {error}".split()))
        lacking = [one for one in wanted if one not in point.errors]
        if lacking and (self.asked or not point.errors):
            raise SceneError("solver", name, f"one whose solutions have {' or '.join(lacking)}")
        return point


def _unknowns(solution: Any, resolution: float) -> int | None:
    """Return the unknowns that a solution says it has; if it does not, a whole resolution."""
    work = getattr(solution, "work", None)
    known = (getattr(solution, "unknowns", None), getattr(work, "unknowns", None), resolution)
    whole_ones = (one for one in known if isinstance(one, numbers.Integral))
    return next((int(one) for one in whole_ones if not isinstance(one, bool)), None)


def _resolutions(parameter: str, values: Any, allowed: str = "finite and > 0") -> tuple[float, ...]:
    """Return numbers of a range in words that are all different, whole ones as ints."""
    found: list[float] = []
    for value in listed(parameter, values, "numbers"):
        number = within(parameter, value, allowed)
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
        solver, resolutions = one if isinstance(one, tuple) and len(one) == 2 else (one, goals)
        solver = function("solvers", solver, _OF_SCENES)
        found[instance("solvers", name, str)] = solver, _resolutions("solvers", resolutions)
    return found
