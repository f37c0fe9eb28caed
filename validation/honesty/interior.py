"""True errors of stress and displacement in the body against their estimates, at many points.

A stratum of honesty.py, of a second a scene, whose points lie at every distance from edge and
surface (1e-12 to 30). Scenes take turns:

- rings of load against point forces added up in mpmath;
- Sneddon's punch against its closed form;
- smooth contacts that stick against complex integrals in mpmath;
- many points at once, to a tolerance, against the same points one by one;
- random flat punches, with slip and coupling, against doubly exponential quadrature over rings;
- random profiles, with layers and friction, against the same, also next to breaks;
- flat punches against the same, also next to zone boundaries.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from oracles.inside_oracle import over_rings, ring, stuck
from profiles import drawn
from strata import Outcome

from spectral_contact import Scene, Solution, solve
from spectral_contact.closed_forms import flat_punch_displacement, flat_punch_stress
from spectral_contact.equations.interior import Inside, ring_loads

POINTS, MANY = 10, 6000
#: The tolerance of solves, and that of contacts that grow with friction, which take longer.
RTOL, GROWN_RTOL = 1e-10, 1e-4
#: Tolerances of points that are looked at one by one; without one they have all digits.
TOLERANCES = (None, 1e-8)
#: Error that ring kernels may have, relative to their largest component of stress or displacement,
#: or to one over the distance from the ring if that is larger.
RING_BOUND = 1e-13
#: A point counts if the quadrature that it is compared with has a relative error below this.
MAX_REFERENCE_ERROR = 1e-10

Pair = tuple[np.ndarray, np.ndarray]


def points(rng: np.random.Generator, count: int) -> Pair:
    """Return distances from the edge (negative outside) and depths, over all scales."""
    size = 10.0 ** rng.uniform(-12.0, 0.0, count)
    kind = rng.integers(0, 3, count)
    from_edge = np.choose(kind, [size, -10.0 * size, 1.0 - size])
    z = 10.0 ** rng.uniform(-12.0, 1.5, count)
    close = rng.random(count) < 0.3
    return from_edge, np.where(close, np.abs(from_edge) * rng.uniform(0.05, 5.0, count), z)


def worst(
    body: Inside, from_edge: Any, z: Any, exact: Sequence[Any], reference_error: Any = 0.0
) -> float:
    """Return the largest error over its estimate at these points.

    The error of `exact` itself is subtracted from the difference.
    """
    ratios = []
    for rtol in TOLERANCES:
        stress = body.stress(from_edge=from_edge, z=z, rtol=rtol)
        moved = body.displacement(from_edge=from_edge, z=z, rtol=rtol)
        got = np.array([stress.rr, stress.tt, stress.zz, stress.rz, moved.r, moved.z])
        apart = np.maximum(np.abs(got - np.array(exact)) - reference_error, 0.0)
        ratios.append(apart[:4].max(axis=0) / stress.norm / stress.error)
        ratios.append(apart[4:].max(axis=0) / moved.modulus / moved.error)
    return float(np.max(ratios))


def rings(rng: np.random.Generator) -> tuple[float, str]:
    """Compare a ring of pressure and one of traction with point forces, in mpmath."""
    nu, s = float(rng.choice([-0.5, 0.0, 0.3, 0.5])), float(rng.uniform(0.02, 1.0))
    r = max(s + 10.0 ** rng.uniform(-12.0, 0.0) * rng.choice([-1.0, 1.0]), 1e-3)
    z, ahead = 10.0 ** rng.uniform(-12.0, 1.0), r - s
    g = ring_loads.geometry(*(np.array([one]) for one in (r, z, r - ahead, ahead)))
    of = (
        (ring_loads.normal_stress, ring_loads.normal_displacement),
        (ring_loads.radial_stress, ring_loads.radial_displacement),
    )
    got = np.array([[*(one[0] for one in a(g, nu)), b(g, nu)[0][0]] for a, b in of])
    exact = ring(nu, r, z, s, ahead)
    # next to places where all components of a ring nearly vanish, they are as large as those of a
    # line load
    size = np.maximum(np.abs(exact).max(axis=1), 1.0 / math.hypot(ahead, z))
    off = np.abs(got - exact).max(axis=1) / size
    return float(off.max()) / RING_BOUND, f"nu {nu:g}, s {s!r}, r {r!r}, z {z!r}"


def sneddon(rng: np.random.Generator) -> tuple[float, str]:
    """Compare a smooth punch without friction with its closed form."""
    scene = Scene(rng.uniform(-0.9, 0.5))
    from_edge, z = points(rng, 100)
    forms = flat_punch_stress, flat_punch_displacement
    exact = [part for form in forms for part in form(scene.poisson_ratio, from_edge=from_edge, z=z)]
    return worst(solve(scene, 1e-12).inside, from_edge, z, exact), repr(scene)


def sticking(rng: np.random.Generator) -> tuple[float, str]:
    """Compare a smooth contact that sticks with complex integrals in mpmath, at one point."""
    scene = Scene(rng.uniform(-0.5, 0.45), friction=math.inf)
    from_edge, z = (float(one[0]) for one in points(rng, 1))
    exact = stuck(scene.poisson_ratio, 1.0 - from_edge, z, from_edge)
    return worst(solve(scene, 1e-12).inside, from_edge, z, exact), repr(scene)


def flat_punch(rng: np.random.Generator) -> Solution:
    """Return a random contact: smooth or rough, sticking or slipping, coupled or not."""
    alpha, beta = np.where(rng.random(2) < 0.15, 0.0, 10.0 ** rng.uniform(-6.0, 1.0, 2))
    friction = math.inf if rng.random() < 0.2 else float(10.0 ** rng.uniform(-1.5, 0.3))
    nu, coupling = rng.uniform(-0.3, 0.49), bool(rng.random() < 0.4)
    scene = Scene(nu, float(alpha), float(beta), friction, coupling=coupling)
    return solve(scene, RTOL, strict=False)


def many(rng: np.random.Generator) -> tuple[float, str]:
    """Compare many points at once, to a tolerance, with some of them one by one."""
    solution = flat_punch(rng)
    from_edge, z = points(rng, MANY)
    some, rtol = rng.choice(MANY, 30, replace=False), float(10.0 ** rng.uniform(-12.0, -4.0))
    ratios = []
    for method, parts, size in (
        ("stress", ("rr", "tt", "zz", "rz"), "norm"),
        ("displacement", ("r", "z"), "modulus"),
    ):
        field = getattr(solution.inside, method)
        found = field(from_edge=from_edge, z=z, rtol=rtol)
        exact = field(from_edge=from_edge[some], z=z[some])
        apart = [np.abs(getattr(found, part)[some] - getattr(exact, part)) for part in parts]
        ratios.append(np.max(apart, axis=0) / getattr(exact, size) / found.error[some])
    return float(np.max(ratios)), f"{solution.scene!r}, rtol {rtol:.1e}"


def scenes(rng: np.random.Generator) -> tuple[float | None, str]:
    """Compare a random contact with quadrature over rings."""
    return over_points(flat_punch(rng), *points(rng, POINTS))


def zones(rng: np.random.Generator) -> tuple[float | None, str]:
    """Compare a random contact at points next to the boundaries of its zones, if it has some."""
    solution = flat_punch(rng)
    if len(solution.zones) < 2:
        return None, ""
    return over_points(solution, *next_to(solution, [], rng))


def profiled(rng: np.random.Generator) -> tuple[float | None, str]:
    """Compare a contact under a random profile, with points next to its breaks."""
    profile, radius = drawn(rng)
    alpha, beta = np.where(rng.random(2) < 0.25, 0.0, radius * 10.0 ** rng.uniform(-5.0, 2.0, 2))
    friction = None
    if rng.random() < 0.25 and not profile.breaks:
        friction = math.inf if rng.random() < 0.3 else float(10.0 ** rng.uniform(-1.5, 0.3))
    given = {"friction": friction, "profile": profile, "contact_radius": radius}
    scene = Scene(rng.uniform(-0.3, 0.5), float(alpha), float(beta), **given)
    solution = solve(scene, RTOL if friction is None else GROWN_RTOL, strict=False)
    breaks = [1.0 - b / radius for b in profile.breaks if b < radius]
    return over_points(solution, *next_to(solution, breaks, rng))


def next_to(solution: Solution, places: list[float], rng: np.random.Generator) -> Pair:
    """Return points, every second one next to one of these places or of the zone boundaries."""
    from_edge, z = points(rng, POINTS)
    ends = places + [zone.outer_from_edge for zone in solution.zones if zone.outer_from_edge > 0.0]
    if ends:
        place = rng.choice(ends, POINTS // 2)
        size = 10.0 ** rng.uniform(-12.0, -1.0, POINTS // 2) * np.minimum(place, 1.0 - place)
        from_edge[::2] = place + size * rng.choice([-1.0, 1.0], POINTS // 2)
        z[::2] = size * rng.uniform(0.05, 5.0, POINTS // 2)
    return from_edge, z


def over_points(solution: Solution, from_edge: Any, z: Any) -> tuple[float | None, str]:
    """Compare the points that quadrature over rings is accurate at."""
    ratios = []
    for place in zip(from_edge.tolist(), z.tolist(), strict=True):
        exact, errors = over_rings(solution, *place)
        size = np.abs(exact[:4]).max(), np.abs(exact[4:]).max()
        if max(max(errors[:4]) / size[0], max(errors[4:]) / size[1]) < MAX_REFERENCE_ERROR:
            ratios.append(worst(solution.inside, *place, exact, np.array(errors)))
    return float(np.max(ratios)) if ratios else None, repr(solution.scene)


#: What is compared, and in how many of twelve scenes.
TURNS = {rings: 1, sneddon: 1, sticking: 1, many: 1, scenes: 4, profiled: 2, zones: 2}
KINDS = [kind for kind, count in TURNS.items() for _ in range(count)]


def interior(rng: np.random.Generator, number: int) -> Outcome | None:
    """Return what becomes of a random scene."""
    kind = KINDS[number % len(KINDS)]
    ratio, label = kind(rng)
    return None if ratio is None else Outcome({kind.__name__: ratio}, label)
