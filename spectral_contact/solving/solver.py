"""The one entry: plan, run the steps that the scene calls for, return the solution."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.io import checks
from spectral_contact.io.choices import suggesting
from spectral_contact.records import Ending
from spectral_contact.scene import Scene
from spectral_contact.solution import Plan, Solution
from spectral_contact.solving.asked import checked_tolerance, closer_tolerance
from spectral_contact.solving.planning import plan
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import Shared
from spectral_contact.solving.uncoupled_run import FrictionOf, UncoupledRun
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

#: By how much looser tolerances are at which zones are found that are not at one asked for.
_LOOSER = 10.0, 100.0


@suggesting()
def solve(
    scene: Scene,
    rtol: float = 1e-10,
    quantities: Iterable[str] | None = None,
    *,
    max_unknowns: int = 20_000,
    strict: bool = True,
    progress: bool | None = None,
) -> Solution:
    """Solve a scene to a relative tolerance.

    Parameters
    ----------
    scene : Scene
    rtol : float
        Bound on the relative error of the approach, the total shear, and of p and q/s pointwise,
        the edge included; from 1e-12 to 1e-2, and down to 1e-13 where only approach, total shear
        and stick radius are asked for.
    quantities : iterable of str, optional
        What to compute, from `QUANTITIES`; by default everything the scene has. The refinement
        adapts to these quantities.
    max_unknowns : int
        Largest number of unknowns of one linear system.
    strict : bool
        Raise an error if the tolerance cannot be met (default); else return the best solution.
    progress : bool, optional
        Whether long solves, as with friction under a profile, show progress (extra: progress);
        by default on a terminal and in notebooks.

    Returns
    -------
    Solution

    Raises
    ------
    SceneError
        For an argument out of its range.
    ConvergenceError
        If the tolerance cannot be met; it carries the best solution and says what to do.
    NotComputedError
        If no zones are found that obey the friction law, in a scene with elastic coupling.
    MissingDependencyError
        If progress is wanted and tqdm is not installed.
    """
    if not isinstance(scene, Scene):
        raise SceneError("scene", scene, "a Scene")
    todo = plan(scene, quantities)
    rtol = checked_tolerance(rtol, todo.quantities)
    strict = checks.flag("strict", strict)
    max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
    if progress is not None:
        ProgressLine(progress)  # refuses what it cannot be
    run = _run(scene, todo, rtol, max_unknowns, Shared(progress))
    with one_thread():
        solution = run.solution()
        if _unsure(solution):
            again, tighter = Shared(progress), closer_tolerance(rtol)
            closer = _run(scene, todo, tighter, max_unknowns, again).solution()
            if closer.converged and not _zone_missing(closer):
                solution = replace(closer, rtol=rtol)
        if solution.ending is Ending.ZONES and scene.profile is None:
            solution = _from_looser(scene, todo, rtol, max_unknowns, progress) or solution
    if strict and not solution.converged:
        worst = max(run.bounded_errors(), default=math.nan)
        raise ConvergenceError(
            f"the error estimate {worst:.1e} does not meet rtol = {rtol:.1e}",
            solution.ending.value,
            solution,
        )
    return solution


def _from_looser(
    scene: Scene, todo: Plan, rtol: float, max_unknowns: int, progress: bool | None
) -> Solution | None:
    """Return the solution with zones that are found at a looser tolerance, if any are.

    Next to a threshold a search fails by accident of rounding: of 16 scenes within 1e-12 of one
    that are refused at 1e-9 or 1e-12 this finds all.
    """
    for tolerance in sorted({min(factor * rtol, 1e-2) for factor in _LOOSER} - {rtol}):
        shared = Shared(progress)
        if _run(scene, todo, tolerance, max_unknowns, shared).solution().converged:
            found = _run(scene, todo, rtol, max_unknowns, shared).solution()
            if found.converged:
                return found
    return None


def _unsure(solution: Solution) -> bool:
    """Return whether there is slip in places, and at a tighter tolerance zones may be known."""
    if not _zone_missing(solution) or len(solution.zones) < 2:
        return False
    return closer_tolerance(solution.rtol) < solution.rtol


def _zone_missing(solution: Solution) -> bool:
    zones = solution.error.zones
    return zones is not None and zones >= 1.0


class Continuation:
    """Solve scenes one after another, each with what the one before it can hand on.

    Scenes of the same normal compliance share their pressure, those of the same compliances their
    full-stick traction. So a list is best sorted by compliances.

    Parameters
    ----------
    rtol, quantities, max_unknowns
        As of `solve`.

    Raises
    ------
    SceneError
        For an argument out of its range.
    """

    def __init__(self, rtol: float, quantities: Iterable[str], max_unknowns: int) -> None:
        self._quantities = tuple(quantities)
        self._rtol = checked_tolerance(rtol, self._quantities)
        self._max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
        self._shared = Shared()

    def solve(self, scene: Scene, more: Iterable[str] = ()) -> Solution:
        """Return the solution of the next scene, converged or not, and more quantities of it."""
        todo = plan(scene, (*self._quantities, *more))
        with one_thread():
            return _run(scene, todo, self._rtol, self._max_unknowns, self._shared).solution()

    def given_radius(self, scene: Scene, logit: float) -> FrictionOf | None:
        """Return the friction with which a scene has one stick disk of this radius, if any has.

        That of the scene does not count.
        """
        todo = plan(scene, self._quantities)
        with one_thread():
            run = UncoupledRun(scene, todo, self._rtol, self._max_unknowns, self._shared)
            return run.given_radius(logit)


def _run(scene: Scene, todo: Plan, rtol: float, max_unknowns: int, shared: Shared) -> Run:
    """Return the run that the scene calls for."""
    if scene.profile is not None:
        from spectral_contact.solving.profile_run import ProfileRun

        def flat(one: Scene, asked: Iterable[str], tolerance: float, others: Shared) -> Solution:
            return _run(one, plan(one, asked), tolerance, max_unknowns, others).solution()

        return ProfileRun(scene, todo, rtol, max_unknowns, shared, flat)
    if scene.coupling and scene.friction is not None and scene.poisson_ratio != 0.5:
        from spectral_contact.solving.coupled_run import CoupledRun

        return CoupledRun(scene, todo, rtol, max_unknowns, shared)
    return UncoupledRun(scene, todo, rtol, max_unknowns, shared)
