"""Digits that are certified: two solutions on different meshes are compared.

The solver in double precision, which provides first guesses, is an argument.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, inf
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from mpmath.ctx_mp import MPContext

from spectral_contact.contact.layered_setting import setting_at_approach
from spectral_contact.errors import ConvergenceError, NotComputedError, SceneError
from spectral_contact.fields.series import Radius
from spectral_contact.io import checks
from spectral_contact.layers.scene_layer import endless
from spectral_contact.precise.layer_laws import law_of
from spectral_contact.precise.layered_indented import InitialContact
from spectral_contact.precise.precise_coupled_run import PreciseCoupledRun
from spectral_contact.precise.precise_profile_run import PreciseProfileRun, compared
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.reference_solution import ReferenceSolution
from spectral_contact.precise.search import lawful, solved
from spectral_contact.precise.zone_trial import PreciseLayout
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import refuse_unloaded
from spectral_contact.records import ErrorEstimates, Zone
from spectral_contact.scene import Scene
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    from spectral_contact.solution import Solution


_Solve: TypeAlias = "Callable[..., Solution]"

#: The solution aims at this many digits more than are asked for (first number), on panels of this
#: width (second number).
_SOLUTION = (4, 2.0)
#: The same of the second solution, which checks it.
_CHECK = (2, 1.5)
_MOST_DIGITS = 60
#: Tolerance of the solution in double precision of a contact on a nonlinear layer.
_DOUBLE = 1e-11
#: A contact without an edge is cut off where the pressure is below the largest one by the digits
#: asked for and this many more.
_SPARE_DIGITS = 8
#: Steps of bisection for the radius of the cut: 40 give it twelve digits.
_BISECTIONS = 40
#: Places in a stick zone at which tractions are compared, as fractions of its width.
_STICK_PLACES = (1e-9, 1e-3, 0.25, 0.5, 0.75, 0.999, 1.0 - 1e-9)


def certified(
    scene: Scene, digits: int, solve: _Solve, *, progress: bool | None = None
) -> ReferenceSolution:
    """Solve a scene to any number of digits.

    Parameters
    ----------
    scene, digits, progress
        As of `reference`, which has its errors, too.
    solve : callable
        Solves scenes in double precision, for first guesses: none of its digits are used.
    """
    if not isinstance(scene, Scene):
        raise SceneError("scene", scene, "a Scene")
    refuse_unloaded(scene, "reference")
    digits = checks.whole("digits", digits, 15)
    if digits > _MOST_DIGITS:
        raise SceneError("digits", digits, f"at most {_MOST_DIGITS}")
    if scene.separation is not None:
        allowed = "None for reference: give the approach that solve finds"
        raise SceneError("separation", scene.separation, allowed)
    with ProgressLine(progress) as tell, one_thread():
        if scene.profile is not None:
            return _under_profile(scene, digits, solve, tell)
        return _flat_punch(scene, digits, solve, tell)


def _flat_punch(scene: Scene, digits: int, solve: _Solve, tell: ProgressLine) -> ReferenceSolution:
    """Solve on two meshes and compare."""
    began = perf_counter()
    given_scene = scene
    # with the sign of kappa traction and shear change theirs, and nothing else changes
    if scene.mismatch is not None:
        scene = scene.replace(kappa=abs(scene.mismatch), physical=None)
    tell("zones, in double precision", 0.0)
    layout = _layout(scene, solve)
    tell("", 0.02)
    first, second = (_steps_on_mesh(number, tell) for number in (1, 2))
    run = lawful(scene, digits + _SOLUTION[0], _SOLUTION[1], layout, first)
    tell("", 0.55)
    check = solved(scene, digits + _CHECK[0], _CHECK[1], run.layout, second, run)
    tell("comparison", 0.95)
    error, worst = _compare(run, check)
    run.fixed.mp.dps = digits + 3
    solution = ReferenceSolution(
        given_scene,
        digits,
        run.approach,
        -run.total_shear if (given_scene.mismatch or 0.0) < 0.0 else run.total_shear,
        run.radius[0] if scene.friction is not None else None,
        _zones(run),
        run.edge_ratio(),
        run.opening,
        error,
        _has_digits(worst, digits),
        run.unknowns,
        run.fixed.bits,
        perf_counter() - began,
        run,
    )
    run.release()
    tell("", 1.0)
    return _certified(solution, worst)


def _has_digits(worst: float, digits: int) -> bool:
    """Return whether the largest error leaves that many digits."""
    return worst <= 10.0**-digits


def _certified(solution: ReferenceSolution, worst: float) -> ReferenceSolution:
    """Return a solution if it has its digits; raise an error that carries it if not."""
    if not solution.converged:
        raise ConvergenceError(
            f"the error estimate {worst:.1e} does not meet {solution.digits} digits",
            "ask for fewer digits, or take `solution` of this error",
            solution,
        )
    return solution


def _under_profile(
    scene: Scene, digits: int, solve: _Solve, tell: ProgressLine
) -> ReferenceSolution:
    """Solve a scene with a profile on two meshes with different precisions, and compare."""
    began = perf_counter()
    tell("contact radius, in double precision", 0.0)
    start = None if scene.layer is None else _initial_contact(scene, digits, solve)
    guess = _guess_of_radius(scene, start, solve)
    first, second = (_steps_on_mesh(number, tell) for number in (1, 2))
    run = PreciseProfileRun(scene, digits + _SOLUTION[0], _SOLUTION[1], guess, first, start)
    tell("", 0.55)
    place = run.mp.mpf(run.place)
    check = PreciseProfileRun(scene, digits + _CHECK[0], _CHECK[1], place, second, start)
    tell("comparison", 0.95)
    error, worst = compared(run, check)
    run.mp.dps = digits + 3
    values = {name: +run.mp.mpf(value) for name, value in run.values.items()}
    zero = run.mp.zero
    one = run.mp.one
    radius = None
    zones = tuple[Zone, ...]()
    ratio = None
    if scene.friction is not None:  # one zone, stick or slip, and no traction in it
        sticks = scene.kappa == 0.0
        zones = (Zone("stick" if sticks else "slip", zero, one, one, zero),)
        radius, ratio = (one, zero) if sticks else (zero, None)
        error = replace(error, traction=0.0, zones=0.0, stick_radius=0.0, total_shear=0.0)
    solution = ReferenceSolution(
        scene=scene,
        digits=digits,
        total_shear=zero,
        stick_radius=radius,
        zones=zones,
        edge_ratio=ratio,
        opening=None,
        error=error,
        converged=_has_digits(worst, digits),
        unknowns=run.unknowns,
        bits=run.bits,
        seconds=perf_counter() - began,
        _run=run,
        **values,
    )
    tell("", 1.0)
    return _certified(solution, worst)


def _guess_of_radius(scene: Scene, start: InitialContact | None, solve: _Solve) -> float:
    """Return the contact radius in double precision, or the approach where that is the unknown."""
    if _has_traction(scene):
        raise NotComputedError("the reference", "with a profile it solves normal contact alone")
    if isinstance(scene.profile, Flat) and scene.layer is None:
        reason = "the flat punch with a linear layer is a scene without profile"
        if scene.work_of_adhesion is not None:
            reason += ", and adhesion changes nothing of it but how far it can be pulled"
        raise NotComputedError("the reference", reason)
    if scene.contact_radius is not None:
        return scene.contact_radius
    if start is not None:
        return start.approach if start.cuts or isinstance(scene.profile, Flat) else start.radius
    double = solve(scene, 1e-12, ("contact_radius",), strict=False)
    return float(double.contact_radius)


def _initial_contact(scene: Scene, digits: int, solve: _Solve) -> InitialContact:
    """Return a contact through a nonlinear layer in double precision."""
    layer = scene.layer
    profile = scene.profile
    assert layer is not None
    assert profile is not None
    law_of(MPContext(), layer)  # raises an error for laws that are not solved
    if _has_traction(scene):
        raise NotComputedError("the reference", "with a profile it solves normal contact alone")
    double = solve(scene, _DOUBLE, ("approach", "contact_radius", "pressure"), strict=False)
    grid = np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 200)])
    most = layer.overclosure(float(np.max(double.pressure(from_edge=grid))))
    thin = 1.0 / float(layer.stiffness(most))
    if not endless(scene):
        return InitialContact(
            double.contact_radius, double.approach, lambda d: double.pressure(from_edge=d), thin
        )
    cells = setting_at_approach(profile, layer, double.approach).cells
    if cells is None:
        reason = "without a contact edge, profile and law must have no tips, breaks or bends"
        raise NotComputedError("the reference", reason)
    domain = double.domain_radius
    radius = _domain(scene, double.approach, most, digits)
    ends = domain * np.sqrt(np.array(cells.offsets[1:-1]) + cells.pivot.square)
    cuts = [*ends.tolist(), domain]
    # beyond the domain in doubles, parts no wider than half of it
    cuts += np.linspace(domain, radius, ceil(2.0 * (radius / domain - 1.0)) + 1)[1:-1].tolist()

    def pressure(from_edge: Any) -> Any:
        s = (1.0 - from_edge) * radius / domain
        return np.where(s < 1.0, double.pressure(np.minimum(s, 1.0)), 0.0)

    return InitialContact(radius, double.approach, pressure, thin, tuple(cuts))


def _domain(scene: Scene, approach: float, most: float, digits: int) -> float:
    """Return the radius beyond which the pressure is too small to change any of the digits.

    `most` is the largest overclosure of the layer.
    """
    layer = scene.layer
    profile = scene.profile
    assert layer is not None
    assert profile is not None
    room = approach - layer.overclosure(layer.pressure(most) * 10.0 ** -(digits + _SPARE_DIGITS))
    high = 1.0
    while profile.height(high) < room:
        high *= 2.0
    while profile.height(high / 2.0) >= room > 0.0:
        high /= 2.0
    low = high / 2.0
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if profile.height(middle) < room else (low, middle)
    return high


def _steps_on_mesh(number: int, tell: ProgressLine) -> Callable[[str], None]:
    """Return a function that reports the steps of the solution on one of the two meshes."""
    return lambda step: tell(f"mesh {number} of 2: {step}")


def _layout(scene: Scene, solve: _Solve) -> PreciseLayout | None:
    """Return the zones in double precision, a guess; None if q = 0."""
    if not _has_traction(scene):
        return None
    if scene.couples:
        _check_full_stick(scene, solve)
        return PreciseLayout((0,), ())
    solution = solve(scene, 1e-9, ("zones", "traction"), strict=False)
    zones = solution.zones
    middles = [(z.inner_from_edge + z.outer_from_edge) / 2.0 for z in zones]
    signs = np.sign(solution.traction(from_edge=middles)).astype(int).tolist()
    states = [0 if zone.kind == "stick" else sign for zone, sign in zip(zones, signs, strict=True)]
    compliance = scene.tangential_compliance
    error = solution.error.zones
    if states[0] != 0 or (len(states) > 2 and compliance == 0.0):
        kinds = ", ".join(zone.kind for zone in zones)
        raise NotComputedError("the reference", f"its zones are {kinds}")
    unresolved = error is not None and not error < 1.0
    # the zones that `solve` found are no guess. With tangential compliance slip is about to begin,
    # and the search starts in full stick
    if unresolved and compliance > 0.0:
        return PreciseLayout((0,), ())
    # without it the edge slips, if in a zone too narrow for doubles, and there is no guess
    if unresolved and states == [0]:
        raise NotComputedError("the reference", "double precision does not resolve its zones")
    radii = tuple(Radius(zone.outer, zone.outer_from_edge) for zone in zones[:-1])
    return PreciseLayout(tuple(states), radii)


def _has_traction(scene: Scene) -> bool:
    """Return whether a scene has a traction other than 0."""
    return bool(scene.friction) and scene.kappa != 0.0


def _check_full_stick(scene: Scene, solve: _Solve) -> None:
    """Raise an error if a coupled scene slips."""
    friction = scene.friction
    assert friction is not None
    if friction == inf:
        return
    stick = solve(replace(scene, friction=inf), 1e-9, ("critical_friction",))
    needed = stick.critical_friction * (1.0 + (stick.error.critical_friction or 0.0))
    if friction < needed:
        raise NotComputedError(
            "the reference", f"with coupling it is of full stick, which needs friction of {needed}"
        )


def _zones(run: PreciseRun | PreciseCoupledRun) -> tuple[Zone, ...]:
    """Return the zones; their ends are numbers of mpmath."""
    scene = run.scene
    mp = run.fixed.mp
    if scene.friction is None:
        return ()
    ends = [(mp.zero, mp.one), *run.radii, (mp.one, mp.zero)]
    states = run.layout.states if run.layout is not None else (0,)
    if scene.friction == 0.0 and scene.kappa != 0.0:
        states = (1,)
    return tuple(
        Zone("slip" if state else "stick", a[0], b[0], a[1], b[1])
        for state, a, b in zip(states, ends, ends[1:], strict=False)
    )


def _compare(
    run: PreciseRun | PreciseCoupledRun, check: PreciseRun | PreciseCoupledRun
) -> tuple[ErrorEstimates, float]:
    """Return error estimates: twice the relative differences of two runs.

    None is below the accuracy that the second run aims at. The largest is returned, too.
    """
    mp = run.fixed.mp
    floor = 10.0**-check.digits

    def error(a: Any, b: Any, sizes: Any = None) -> float:
        """Return the largest difference, relative to `b` or to sizes of its own."""
        a = np.atleast_1d(a)
        b = np.atleast_1d(b)
        pairs = zip(a, b, b if sizes is None else sizes, strict=True)
        ratios = [abs((v - mp.mpf(w)) / mp.mpf(size)) for v, w, size in pairs if v != w]
        return max(2.0 * float(max(ratios, default=0.0)), floor)

    depths = np.concatenate([np.linspace(0.02, 0.98, 25), np.exp(-np.linspace(1.0, run.depth, 60))])
    depths = np.array([mp.mpf(v) for v in depths])
    # inside the stick zones, too, however narrow
    shares = np.array([mp.mpf(v) for v in _STICK_PLACES])
    stick_zones = [z for z in _zones(run) if z.kind == "stick"]
    inside = [1 - depths, *(z.inner + (z.outer - z.inner) * shares for z in stick_zones)]
    s = np.concatenate(inside)
    depths = np.concatenate([depths, *(1 - v for v in inside[1:])])
    fields_of_run, fields_of_check = (
        (solved_run.pressures(s, depths), solved_run.tractions(s, depths))
        for solved_run in (run, check)
    )
    fields = list(map(error, fields_of_run, fields_of_check, _sizes(run, s, *fields_of_check)))
    shear = traction = zones = radius = ratio = None
    if run.scene.friction is not None:
        shear = error(run.total_shear, check.total_shear)
        traction = fields[1]
        radius = error(run.radius, check.radius)
        zones = max([radius, *map(error, run.radii, check.radii)])
        if run.edge_ratio() is not None:
            ratio = error(run.edge_ratio(), check.edge_ratio())
    estimates = ErrorEstimates(
        approach=error(run.approach, check.approach),
        pressure=fields[0],
        traction=traction,
        zones=zones,
        stick_radius=radius,
        total_shear=shear,
        edge_ratio=ratio,
    )
    errors = [estimates.approach, *fields, shear, zones, ratio]
    if run.opening is not None:
        errors.append(inf if check.opening is None else error(run.opening, check.opening))
    return estimates, max(error for error in errors if error is not None)


def _sizes(run: PreciseRun | PreciseCoupledRun, s: Any, p: Any, q: Any) -> tuple[Any, Any]:
    """Return the sizes that errors of p and q are relative to.

    These are p and q themselves. With coupling, if one of them is not positive at all radii, they
    are those of the two together, at all radii.
    """
    if not run.scene.couples or min(p.min(), q.min()) > 0:
        return p, q
    hypot = run.fixed.mp.hypot
    kappa = run.kappa
    pairs = list(zip(p, q / s, strict=True))
    both = np.array([[hypot(v, u), hypot(u, kappa * v)] for v, u in pairs], dtype=object)
    return both[:, 0], both[:, 1] * s
