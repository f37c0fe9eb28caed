"""True errors of the first unloading against their estimates.

A stratum of honesty.py. Scenes have random compliances, Poisson's ratios, frictions, load ratios
down to where slip back begins and below, and tolerances. The truth of the shear is another
solver (tests/oracles/graded_elements.py): Legendre polynomials on graded elements, with boundaries
of its own, which begin at those found. It has ten digits of the shear, and room for that is given;
where that is too few, finer elements have twelve. It has fewer digits of the fields and boundaries;
of these the truth is a solve to 1e-12, with its estimates as room. The traction is compared at
places that the boundaries fix.

The second stratum is of loads below the turning ratio, down to a millionth of it: each must be
refused for that reason. A state there is refused if a slip zone shrinks as the load falls on, which
is seen at that state alone; so a zone that has begun to shrink must not grow again.
"""

from __future__ import annotations

import numpy as np
from oracles import graded_elements
from strata import Outcome, decade

from spectral_contact import NotComputedError, Scene, Solution, solve

#: Elements of the truth, and what the shear may be off by on them, over the friction.
MESHES = (
    (graded_elements.USUAL, 3e-11),
    (graded_elements.Fineness(degree=16, narrowest=1e-8, points=48), 1e-12),
)
#: The tolerance of the other truth.
CLOSE = 1e-12
#: Compliances, in decades; thinner layers take more elements.
LEAST, MOST = -1.5, 2.5
#: How far loads may be above the shakedown ratio, in decades of the way to the largest load.
CLOSEST = -3.0
#: How far they may be below the largest load, in decades of it.
NEAREST = -5.0, -2.0
#: Places in a zone, in the square of the radius.
PLACES = np.array([0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98])
#: Loads over the turning ratio, in the second stratum: in decades, and the most.
DEEPEST, HIGHEST = -6.0, 0.999


def punch(rng: np.random.Generator) -> tuple[Scene, float]:
    """Return a flat punch at its largest load, and its shakedown ratio."""
    alpha = decade(rng, LEAST, MOST)
    beta = alpha if rng.random() < 0.25 else float(np.clip(alpha * decade(rng, -1, 1), 0.02, 500.0))
    nu = float(rng.choice([0.0, 0.1, 0.3, 0.45]))
    base = Scene(nu, alpha, beta, np.inf)
    critical = solve(base, 1e-8, ["critical_friction"]).critical_friction
    share = rng.uniform(0.05, 0.95)
    return base.replace(friction=critical * share), (1.0 - share) / (1.0 + share)


def drawn(rng: np.random.Generator) -> tuple[Scene, float]:
    """Return a scene and a tolerance."""
    loaded, shakedown = punch(rng)
    place = rng.random()
    if place < 0.15:
        ratio = 1.0 - decade(rng, *NEAREST)
    else:
        distance = decade(rng, CLOSEST, 0.0) if place < 0.4 else rng.uniform(-0.01, 0.99)
        ratio = shakedown + (1.0 - shakedown) * distance
    return loaded.replace(unloaded_to=float(ratio)), decade(rng, -9.0, -2.0)


def states(solution: Solution) -> tuple[int, ...]:
    """Return the states of the zones: 0 in stick, the sense in slip."""
    return tuple(zone.sense if zone.kind == "slip" else 0 for zone in solution.zones)


def truth_of(
    scene: Scene, found: Solution, fineness: graded_elements.Fineness
) -> graded_elements.ZonesOnElements:
    """Return the truth on zones of the same states."""
    given = scene.normal_compliance, scene.tangential_compliance, scene.friction / scene.kappa
    largest = solve(scene.replace(unloaded_to=1.0), 1e-8, ["zones"])
    guess = [zone.outer for zone in largest.zones[:-1]]
    before = graded_elements.loaded(*given, guess, states(largest), fineness)
    guess = [zone.outer for zone in found.zones[:-1]]
    return graded_elements.unloaded(
        *given, scene.unloaded_to, guess, states(found), before, states(largest), fineness
    )


def traction_off(scene: Scene, found: Solution, truth: Solution) -> float:
    """Return the largest error of the traction, relative as its estimate is."""
    largest = 0.0
    for zone, exact in zip(found.zones, truth.zones, strict=True):
        places, true_places = (
            np.sqrt(one.inner**2 + PLACES * (one.outer**2 - one.inner**2)) for one in (zone, exact)
        )
        q = truth.traction(true_places)
        size = scene.friction * truth.pressure(true_places) if exact.memory else np.abs(q)
        largest = max(largest, float((np.abs(found.traction(places) - q) / size).max()))
    return largest


def unloading(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a random scene."""
    scene, tolerance = drawn(rng)
    label = f"{scene!r}, rtol = {tolerance:.1e}"
    asked = "traction", "pressure", "zones", "stick_radius", "total_shear"
    found = solve(scene, tolerance, asked, strict=False)
    close = solve(scene, CLOSE, asked, strict=False)
    error, room = ({name: getattr(one.error, name) for name in asked} for one in (found, close))
    shear = 0.0
    for fineness, off in MESHES:
        exact = scene.kappa * truth_of(scene, close, fineness).total_shear
        allowed = error["total_shear"] * abs(exact) + off * (scene.friction or 0.0)
        shear = abs(found.total_shear - exact) / allowed
        if shear <= 1.0:
            break
    zones = max(
        abs(zone.outer - known.outer) / min(known.outer, known.outer_from_edge)
        for zone, known in zip(found.zones[:-1], close.zones[:-1], strict=True)
    )
    traction = traction_off(scene, found, close)
    own = {
        "total shear": shear,
        "zones": zones / (error["zones"] + room["zones"]),
        "traction": traction / (error["traction"] + room["traction"]),
    }
    return Outcome(own, label, found.converged)


def unloaded_too_far(rng: np.random.Generator, _: int) -> Outcome:
    """Return 0 of a load below the turning ratio that is refused as such, and 2 of another."""
    loaded, shakedown = punch(rng)
    between = loaded.replace(unloaded_to=(1.0 + shakedown) / 2.0)
    turning = solve(between, 1e-6, ["turning_ratio"]).turning_ratio
    scene = loaded.replace(unloaded_to=turning * min(decade(rng, DEEPEST, 0.0), HIGHEST))
    label = f"{scene!r}, turning ratio {turning:.9g}"
    try:
        solve(scene, 1e-6, ["total_shear"], strict=False)
    except NotComputedError as refusal:
        if "below the turning ratio" in str(refusal):
            return Outcome({"refused": 0.0}, label)
    return Outcome({"refused": 2.0}, label)
