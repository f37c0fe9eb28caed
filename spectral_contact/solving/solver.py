"""The entry point `solve`, and `Continuation` for many scenes: make a plan, and run its steps."""

from __future__ import annotations

import math
from collections.abc import Iterable

from spectral_contact.errors import ConvergenceError, NotComputedError, SceneError
from spectral_contact.io import checks
from spectral_contact.io.choices import suggesting
from spectral_contact.records import Ending
from spectral_contact.scene import Scene
from spectral_contact.solution import Plan, Solution
from spectral_contact.solving.asked import checked_tolerance, closer_tolerance
from spectral_contact.solving.mirror import mirrored, with_positive_kappa
from spectral_contact.solving.planning import plan, possible_quantities
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import StepCache
from spectral_contact.solving.uncoupled_run import RadiusFriction, UncoupledRun
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

#: Factors by which the tolerance is loosened where no zones are found.
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
        What to compute, from `QUANTITIES`; by default everything the scene has except the load
        ratios `reverse_ratio` and `turning_ratio`. The refinement adapts to these quantities.
    max_unknowns : int
        Largest number of unknowns of one linear system.
    strict : bool
        Raise an error if the tolerance cannot be met (default); else return the best solution.
    progress : bool, optional
        Whether long solves, such as friction under a profile, show a progress bar (needs the extra
        `progress`); by default on a terminal and in notebooks.

    Returns
    -------
    Solution

    Raises
    ------
    SceneError
        For an argument out of its range.
    ConvergenceError
        If the tolerance cannot be met, or no zones are found that obey the friction law; it carries
        the best solution and says what to do.
    NotComputedError
        With a profile, if the contact cannot be followed as it grows; below the largest load, if
        the state depends on its history or no zones are found. The message says why.
    MissingDependencyError
        If progress is wanted and tqdm is not installed.
    """
    if not isinstance(scene, Scene):
        raise SceneError("scene", scene, "a Scene")
    given_scene = scene
    scene = with_positive_kappa(given_scene)
    todo = plan(scene, quantities)
    rtol = checked_tolerance(rtol, todo.quantities)
    strict = checks.flag("strict", strict)
    max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
    if progress is not None:
        # check this argument before any work
        ProgressLine(progress)
    run = _run(scene, todo, rtol, max_unknowns, StepCache(progress))
    with one_thread():
        solution = run.solution()
        solution = _resolved(run, solution, closer_for_zones=_zone_may_be_missing(solution))
        if solution.ending is Ending.ZONES and scene.profile is None:
            solution = _from_looser_tolerance(scene, todo, rtol, max_unknowns, progress) or solution
    solution = mirrored(solution, given_scene)
    if strict and not solution.converged:
        raise ConvergenceError(_failure_text(run, solution), solution.ending.value, solution)
    return solution


def _failure_text(run: Run, solution: Solution) -> str:
    """Return why a solution did not converge: no zones were found, or a tolerance is not met."""
    violation = solution.error.violation
    if solution.ending is Ending.ZONES and run.refusal:
        return run.refusal
    if solution.ending is Ending.ZONES and violation is not None:
        return f"the friction law is broken by {violation:.1e}, at rtol = {solution.rtol:.1e}"
    errors = (getattr(solution.error, name) for name in run.bounded)
    worst = max((error for error in errors if error is not None), default=math.nan)
    return f"the error estimate {worst:.1e} does not meet rtol = {solution.rtol:.1e}"


def _resolved(run: Run, solution: Solution, *, closer_for_zones: bool = False) -> Solution:
    """Return the solution of a run, or one to a tighter tolerance with better slip or zones.

    The slip in a narrow zone is as small as a power of the width of the zone, and may be less than
    the errors of the fields that it follows from. So the scene is solved to tighter tolerances
    until a digit of the slip is known. The tolerance that was asked for still decides on
    convergence.

    Parameters
    ----------
    run : Run
        That has the solution.
    solution : Solution
    closer_for_zones : bool
        Whether to try one tighter tolerance because a zone may be missing.
    """
    # A tighter tolerance takes even more unknowns. If a flat punch of a history has no zones, it
    # was solved to tighter tolerances already.
    if solution.ending is Ending.UNKNOWNS or (run.refusal and run.scene.profile is not None):
        return solution
    rtol = tolerance = solution.rtol
    least_unresolved = _unresolved(run)
    while closer_for_zones or run.slip_unresolved:
        closer = closer_tolerance(tolerance)
        if closer >= tolerance:
            break
        tolerance = closer
        cache = StepCache(run.cache.progress)
        run = _run(run.scene, run.plan, tolerance, run.max_unknowns, cache)
        try:
            closer_solution = run.solution(rtol)
        except NotComputedError:  # none at this tolerance: the one at hand is kept
            break
        unresolved = _unresolved(run)
        if closer_solution.converged and (not solution.converged or unresolved < least_unresolved):
            least_unresolved = unresolved
            solution = closer_solution
        closer_for_zones = False
    return solution


def _unresolved(run: Run) -> tuple[bool, float]:
    """Return whether no digit of the slip is known, and the error of the zones.

    A tighter tolerance should lower these two, which are compared in this order.
    """
    return run.slip_unresolved, run.errors.get("zones", 0.0)


def _from_looser_tolerance(
    scene: Scene, todo: Plan, rtol: float, max_unknowns: int, progress: bool | None
) -> Solution | None:
    """Return the solution with zones that are found at a looser tolerance, if any are.

    Next to a threshold of friction a search may fail by accident of rounding. The search at `rtol`
    then starts from the zones that a looser tolerance found. If it fails again, the solution to the
    looser tolerance is returned: it counts as converged only if its estimates happen to meet
    `rtol`. Of 16 scenes whose friction is within 1e-12 of a threshold, and that fail at rtol 1e-9
    or 1e-12, all are solved this way.
    """
    looser_solution = None
    for tolerance in sorted({min(factor * rtol, 1e-2) for factor in _LOOSER} - {rtol}):
        cache = StepCache(progress)
        try:
            looser = _run(scene, todo, tolerance, max_unknowns, cache).solution(rtol)
        except NotComputedError:  # none at this tolerance
            continue
        if looser.ending is not Ending.ZONES:
            from_looser = _run(scene, todo, rtol, max_unknowns, cache).solution()
            if from_looser.ending is not Ending.ZONES:
                return from_looser
            looser_solution = looser_solution or looser
    return looser_solution


def _zone_may_be_missing(solution: Solution) -> bool:
    """Return whether a zone may be missing that a tighter tolerance may find.

    The error of the zones is 1 or more then. A solution of one zone, full stick, is tried again
    only if it has not converged. Next to the threshold of slip it may depend on rounding whether
    the search finds a narrow zone at the edge: for a friction 1e-7 below the threshold, with NumPy
    and SciPy of the oldest versions, rtol 1e-11 and 5e-12 ended in full stick, not converged, and
    1e-12 found the zone.
    """
    return _zones_uncertain(solution) and (len(solution.zones) >= 2 or not solution.converged)


def _zones_uncertain(solution: Solution) -> bool:
    """Return whether the error of the zones is at least 1: one may be missing or superfluous."""
    zones = solution.error.zones
    return zones is not None and zones >= 1.0


class Continuation:
    """Solve scenes one after another, each from results of the one before.

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
        self._quantities = frozenset(quantities)
        self._rtol = checked_tolerance(rtol, self._quantities)
        self._max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
        self._cache = StepCache()

    def solve(self, scene: Scene, more: Iterable[str] = ()) -> Solution:
        """Return the solution of the next scene, converged or not; `more` are further quantities.

        Quantities that scenes of its kind do not have are left out.

        Raises `NotComputedError` as `solve` does.
        """
        mirror = with_positive_kappa(scene)
        todo = plan(mirror, self._quantities.union(more).intersection(possible_quantities(scene)))
        run = _run(mirror, todo, self._rtol, self._max_unknowns, self._cache)
        with one_thread():
            return mirrored(_resolved(run, run.solution()), scene)

    def given_radius(self, scene: Scene, logit: float) -> RadiusFriction | None:
        """Return the friction with which a flat punch without coupling has one stick disk.

        The friction of the scene does not matter. If its κ is negative, the result is that of its
        mirror image, with κ and total shear positive.

        Parameters
        ----------
        scene : Scene
        logit : float
            Of the stick radius c, in contact radii: ``ln(c**2/(1 - c**2))``.

        Returns
        -------
        RadiusFriction or None
            As `UncoupledRun.given_radius`.
        """
        scene = with_positive_kappa(scene)
        todo = plan(scene, self._quantities)
        with one_thread():
            return UncoupledRun(
                scene, todo, self._rtol, self._max_unknowns, self._cache
            ).given_radius(logit)


def _run(scene: Scene, todo: Plan, rtol: float, max_unknowns: int, cache: StepCache) -> Run:
    """Return the run that the scene calls for."""
    if scene.profile is not None:
        from spectral_contact.solving.profile_run import ProfileRun
        from spectral_contact.solving.stages import NoFlatPunchError

        def flat(
            flat_scene: Scene, quantities: Iterable[str], tolerance: float, flat_cache: StepCache
        ) -> Solution:
            stage = _run(
                flat_scene, plan(flat_scene, quantities), tolerance, max_unknowns, flat_cache
            )
            solution = stage.solution()
            if stage.refusal:
                raise NoFlatPunchError(stage.refusal)
            return solution

        return ProfileRun(scene, todo, rtol, max_unknowns, cache, flat)
    if scene.coupling and scene.friction is not None and scene.kappa != 0.0:
        from spectral_contact.solving.coupled_run import CoupledRun

        return CoupledRun(scene, todo, rtol, max_unknowns, cache)
    return UncoupledRun(scene, todo, rtol, max_unknowns, cache)
