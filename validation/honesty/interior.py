"""Honesty of stress and displacement in the body: true errors against estimates, at many points.

    python validation/honesty/interior.py [--scenes 1000] [--seconds 600]

Points lie at every distance from edge and surface (1e-12 to 30). Groups: rings of load against
point forces added up in mpmath; Sneddon's punch against its closed form; smooth contacts that
stick against complex integrals in mpmath; random scenes, with slip and coupling, against doubly
exponential quadrature over the rings, with all digits and with rtol 1e-8; random profiles, with
layers and friction, and points next to breaks and to zone boundaries, against the same; many
points at once, to a tolerance, against one by one. Writes validation/results/interior.json and
.md; what is there is not measured again, so a run that was stopped, or ran out of its seconds,
goes on. Fails if a true error is above its estimate.
"""

import math
import signal
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))
from oracles.inside_oracle import over_rings, ring, stuck
from profiles import drawn
from reporting import options, stored, table, write

from spectral_contact import Scene, SpectralContactError, solve
from spectral_contact.closed_forms import flat_punch_displacement, flat_punch_stress
from spectral_contact.equations.interior import ring_loads

SEED, POINTS, MANY = 20, 10, 6000
#: Seconds for a solve.
PATIENCE = 5
#: How many rows each group has, but the random scenes.
SIZES = {"rings": 100, "sneddon": 20, "sticking": 50, "many": 40, "profiles": 200, "zones": 200}
#: What ring kernels may miss by, relative to the largest of the five, or one over the distance.
RING_BOUND = 1e-13
#: Largest error of the quadrature that is compared with, for a point to count.
KNOWN = 1e-10


def points(rng, count):
    """Return distances from the edge (negative outside) and depths, over all scales."""
    size = 10.0 ** rng.uniform(-12.0, 0.0, count)
    kind = rng.integers(0, 3, count)
    from_edge = np.choose(kind, [size, -10.0 * size, 1.0 - size])
    z = 10.0 ** rng.uniform(-12.0, 1.5, count)
    close = rng.random(count) < 0.3
    return from_edge, np.where(close, np.abs(from_edge) * rng.uniform(0.05, 5.0, count), z)


def compare(body, from_edge, z, expected, known=0.0, rtol=None):
    """Return true errors, less what is not known of them, and estimates, of all points."""
    stress = body.stress(from_edge=from_edge, z=z, rtol=rtol)
    moved = body.displacement(from_edge=from_edge, z=z, rtol=rtol)
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz, moved.r, moved.z])
    apart = np.maximum(np.abs(got - np.array(expected)) - known, 0.0)
    true = np.array([apart[:4].max(axis=0) / stress.norm, apart[4:].max(axis=0) / moved.modulus])
    return np.ravel(true), np.ravel([stress.error, moved.error])


def row_of(pairs):
    """Return what is stored of true errors and estimates."""
    true, estimate = (np.concatenate([np.ravel(pair[k]) for pair in pairs]) for k in (0, 1))
    return {
        "values": int(true.size),
        "error": float(true.max()),
        "estimate": float(np.median(estimate)),
        "largest_estimate": float(estimate.max()),
        "worse": int((true > estimate).sum()),
    }


def of_ring(rng):
    """Compare a ring of pressure and one of traction with point forces, in mpmath."""
    nu, s = rng.choice([-0.5, 0.0, 0.3, 0.5]), rng.uniform(0.02, 1.0)
    r = max(s + 10.0 ** rng.uniform(-12.0, 0.0) * rng.choice([-1.0, 1.0]), 1e-3)
    z, ahead = 10.0 ** rng.uniform(-12.0, 1.0), r - s
    g = ring_loads.geometry(*(np.array([one]) for one in (r, z, r - ahead, ahead)))
    of = (
        (ring_loads.normal_stress, ring_loads.normal_displacement),
        (ring_loads.radial_stress, ring_loads.radial_displacement),
    )
    got = np.array([[*(one[0] for one in a(g, nu)), b(g, nu)[0][0]] for a, b in of])
    expected = ring(nu, r, z, s, ahead)
    # where its own components nearly vanish, a ring is as strong as a line load a little aside
    size = np.maximum(np.abs(expected).max(axis=1), 1.0 / math.hypot(ahead, z))
    true = np.abs(got - expected).max(axis=1) / size
    return row_of([(true, np.full(2, RING_BOUND))])


def of_sneddon(rng):
    """Compare a smooth punch without friction with its closed form."""
    nu = rng.uniform(-0.9, 0.5)
    from_edge, z = points(rng, 100)
    forms = flat_punch_stress, flat_punch_displacement
    exact = [part for form in forms for part in form(nu, from_edge=from_edge, z=z)]
    body = solve(Scene(nu), rtol=1e-12).inside
    return row_of([compare(body, from_edge, z, exact, rtol=rtol) for rtol in (None, 1e-8)])


def of_sticking(rng):
    """Compare a smooth contact that sticks with complex integrals in mpmath, at one point."""
    nu = rng.uniform(-0.5, 0.45)
    body = solve(Scene(nu, friction=math.inf), rtol=1e-12).inside
    from_edge, z = (float(one[0]) for one in points(rng, 1))
    exact = stuck(nu, 1.0 - from_edge, z, from_edge)
    return row_of([compare(body, from_edge, z, exact, rtol=rtol) for rtol in (None, 1e-8)])


def draw(rng):
    """Return a random scene: smooth or rough, sticking or slipping, coupled or not."""
    alpha, beta = np.where(rng.random(2) < 0.15, 0.0, 10.0 ** rng.uniform(-6.0, 1.0, 2))
    friction = math.inf if rng.random() < 0.2 else float(10.0 ** rng.uniform(-1.5, 0.3))
    nu = rng.uniform(-0.3, 0.49)
    return Scene(nu, float(alpha), float(beta), friction, coupling=bool(rng.random() < 0.4))


@contextmanager
def patience():
    """Give up after some seconds: the study is of the body, not of hard scenes."""

    def stop(_signal, _frame):
        raise TimeoutError(f"{PATIENCE} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def draw_profile(rng):
    """Return a random scene with a profile: smooth or rough, one in eight with friction."""
    profile, radius = drawn(rng)
    alpha, beta = np.where(rng.random(2) < 0.25, 0.0, radius * 10.0 ** rng.uniform(-5.0, 2.0, 2))
    friction = None
    if rng.random() < 0.25 and not profile.breaks:
        friction = math.inf if rng.random() < 0.3 else float(10.0 ** rng.uniform(-1.5, 0.3))
    nu = rng.uniform(-0.3, 0.5)
    scene = {"friction": friction, "profile": profile, "contact_radius": radius}
    return Scene(nu, float(alpha), float(beta), **scene)


class UnsolvedError(Exception):
    """A scene has no solution in time, or no boundary."""


def solved(scene, tolerances=(1e-12, 1e-10)):
    """Return the solution by the first tolerance that is met in time."""
    for rtol in tolerances:
        with suppress(SpectralContactError, ArithmeticError, TimeoutError), patience():
            return solve(scene, rtol=rtol)
    raise UnsolvedError(repr(scene))


def of_scene(rng):
    """Compare a random scene with quadrature over rings."""
    return of_solution(solved(draw(rng)), *points(rng, POINTS))


def of_profile(rng):
    """Compare a random profile, points next to its breaks added."""
    scene = draw_profile(rng)
    solution = solved(scene) if scene.friction is None else solved(scene, (1e-5, 1e-3))
    breaks = [1.0 - b / scene.contact_radius for b in scene.profile.breaks]
    return of_solution(solution, *next_to(solution, [one for one in breaks if one > 0.0], rng))


def of_zones(rng):
    """Compare a random scene with slip at points next to boundaries of its zones."""
    solution = solved(draw(rng))
    if len(solution.zones) < 2:
        raise UnsolvedError(repr(solution.scene))
    return of_solution(solution, *next_to(solution, [], rng))


def next_to(solution, places, rng):
    """Return points, every second one next to one of these places or of the zone boundaries."""
    from_edge, z = points(rng, POINTS)
    zones = [zone.outer_from_edge for zone in solution.zones if zone.outer_from_edge > 0.0]
    if places + zones:
        place = rng.choice(places + zones, POINTS // 2)
        size = 10.0 ** rng.uniform(-12.0, -1.0, POINTS // 2) * np.minimum(place, 1.0 - place)
        from_edge[::2] = place + size * rng.choice([-1.0, 1.0], POINTS // 2)
        z[::2] = size * rng.uniform(0.05, 5.0, POINTS // 2)
    return from_edge, z


def of_solution(solution, from_edges, depths):
    """Compare the points that quadrature over rings is accurate at."""
    body, pairs = solution.inside, []
    for from_edge, z in zip(from_edges, depths, strict=True):
        exact, known = over_rings(solution, float(from_edge), float(z))
        size = np.abs(exact[:4]).max(), np.abs(exact[4:]).max()
        if max(max(known[:4]) / size[0], max(known[4:]) / size[1]) < KNOWN:
            for rtol in (None, 1e-8):
                pairs.append(compare(body, from_edge, z, exact, np.array(known), rtol))
    told = {"scene": repr(solution.scene)}
    return (row_of(pairs) if pairs else {"values": 0}) | told


def of_many(rng):
    """Compare many points at once, to a tolerance, with some of them one by one."""
    solution = solved(draw(rng), (1e-10,))
    body = solution.inside
    from_edge, z = points(rng, MANY)
    some, rtol = rng.choice(MANY, 30, replace=False), float(10.0 ** rng.uniform(-12.0, -4.0))
    pairs = []
    for method, parts in (("stress", ("rr", "tt", "zz", "rz")), ("displacement", ("r", "z"))):
        many = getattr(body, method)(from_edge=from_edge, z=z, rtol=rtol)
        one = getattr(body, method)(from_edge=from_edge[some], z=z[some])
        apart = [np.abs(getattr(many, part)[some] - getattr(one, part)) for part in parts]
        size = one.norm if method == "stress" else one.modulus
        pairs.append((np.max(apart, axis=0) / size, many.error[some]))
    return row_of(pairs) | {"scene": repr(solution.scene), "rtol": rtol}


GROUPS = {
    "rings": of_ring,
    "sneddon": of_sneddon,
    "sticking": of_sticking,
    "scenes": of_scene,
    "many": of_many,
    "profiles": of_profile,
    "zones": of_zones,
}


def written(rows):
    """Write the results, a row for each group; return how many estimates were exceeded."""
    counted = sum(row["values"] > 0 for row in rows["scenes"].values())
    about = (
        f"{counted} random scenes with a flat punch, {POINTS} points each, and the other groups; "
        "errors are relative to the size of the stress or of the displacement."
    )
    cells, exceeded = [], 0
    for group, found in rows.items():
        some = [row for row in found.values() if row["values"]]
        if some:
            worse = sum(row["worse"] for row in some)
            exceeded += worse
            numbers = (
                max(row["error"] for row in some),
                np.median([row["estimate"] for row in some]),
                max(row["largest_estimate"] for row in some),
            )
            values = sum(row["values"] for row in some)
            cells.append((group, len(some), values, *(f"{one:.1e}" for one in numbers), worse))
    heading = "group | rows | values | largest true error | median estimate | largest | exceeded"
    record = {"scenes": counted, "exceeded": exceeded, "rows": rows}
    write("interior", f"{about}\n\n{table(heading, cells)}", record)
    return exceeded


def main():
    """Measure what is missing, as far as the time goes."""
    asked = options(__doc__, scenes=1000, seconds=600.0)
    rows = {group: {} for group in GROUPS} | stored("interior").get("rows", {})
    deadline = time.monotonic() + asked.seconds
    for index, (group, measure) in enumerate(GROUPS.items()):
        for number in range(SIZES.get(group, asked.scenes)):
            if str(number) not in rows[group] and time.monotonic() < deadline:
                rng = np.random.default_rng([SEED, index, number])
                try:
                    rows[group][str(number)] = measure(rng)
                except UnsolvedError as error:
                    rows[group][str(number)] = {"values": 0, "scene": str(error)}
                if number % 20 == 19:
                    written(rows)
    return int(written(rows) > 0)


if __name__ == "__main__":
    sys.exit(main())
