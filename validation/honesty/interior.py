"""Honesty of stress and displacement in the body: true errors against estimates, at many points.

    python validation/honesty/interior.py [--points 300] [--seconds 240]

Random points at every distance from edge and surface (1e-12 to 30), in three groups: Sneddon's
punch against its closed form; smooth contacts that stick against complex integrals in mpmath; and
random scenes, with slip and coupling, against Hankel integrals at depths above 0.1. Prints, for
each group, how many values were compared, the largest true error, the largest estimate, and how
many values are worse than theirs; fails if one is. What does not fit into the time is left out.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from oracles.inside_oracle import hankel, stuck

from spectral_contact import Scene, solve
from spectral_contact.closed_forms import flat_punch_displacement, flat_punch_stress


def points(rng, count):
    """Return distances from the edge (negative outside) and depths, over all scales."""
    size = 10.0 ** rng.uniform(-12.0, 0.0, count)
    kind = rng.integers(0, 3, count)
    from_edge = np.choose(kind, [size, -10.0 * size, 1.0 - size])
    z = 10.0 ** rng.uniform(-12.0, 1.5, count)
    close = rng.random(count) < 0.3
    return from_edge, np.where(close, np.abs(from_edge) * rng.uniform(0.05, 5.0, count), z)


def measure(body, from_edge, z, expected):
    """Return (true error, estimate) of stress and displacement."""
    stress = body.stress(from_edge=from_edge, z=z)
    moved = body.displacement(from_edge=from_edge, z=z)
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
    of_stress = np.abs(got - np.array(expected[:4])).max(axis=0) / stress.norm
    shift = np.abs(np.array([moved.r, moved.z]) - np.array(expected[4:])).max(axis=0)
    return [(of_stress, stress.error), (shift / moved.modulus, moved.error)]


def sneddon(rng, count, _deadline):
    """Compare a smooth punch without friction with its closed form."""
    for nu in (-0.5, 0.0, 0.3, 0.499):
        from_edge, z = points(rng, count)
        forms = flat_punch_stress, flat_punch_displacement
        exact = [part for form in forms for part in form(nu, from_edge=from_edge, z=z)]
        yield from measure(solve(Scene(nu), rtol=1e-12).inside, from_edge, z, exact)


def sticking(rng, count, deadline):
    """Compare a smooth contact that sticks all over with complex integrals in mpmath."""
    body = solve(Scene(0.2, friction=math.inf), rtol=1e-12).inside
    for from_edge, z in zip(*points(rng, count // 5), strict=True):
        if time.monotonic() > deadline:
            return
        yield from measure(body, from_edge, z, stuck(0.2, 1.0 - from_edge, z, from_edge))


def scenes(rng, count, deadline):
    """Compare random scenes with Hankel integrals, three points each."""
    for _ in range(count // 3):
        if time.monotonic() > deadline:
            return
        alpha, beta = 10.0 ** rng.uniform(-5.0, 1.0, 2)
        friction = math.inf if rng.random() < 0.2 else float(10.0 ** rng.uniform(-1.5, 0.3))
        scene = Scene(rng.uniform(-0.2, 0.45), alpha, beta, friction, coupling=rng.random() < 0.4)
        solution = solve(scene, rtol=1e-10)
        body = solution.inside
        for r, z in zip(rng.uniform(0.01, 2.0, 3), 10.0 ** rng.uniform(-0.9, 0.7, 3), strict=True):
            yield from measure(body, 1.0 - r, z, hankel(solution, r, z))


def main():
    """Run the groups one after the other, each with its share of the time."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=300)
    parser.add_argument("--seconds", type=float, default=240.0)
    arguments = parser.parse_args()
    rng, broken = np.random.default_rng(20), 0
    for group in (sneddon, sticking, scenes):
        deadline = time.monotonic() + arguments.seconds / 3.0
        pairs = list(group(rng, arguments.points, deadline))
        true, estimate = (np.concatenate([np.ravel(p[i]) for p in pairs]) for i in (0, 1))
        worse = int((true > estimate).sum())
        broken += worse
        print(
            f"{group.__name__:9} {true.size:5} values: largest error {true.max():.1e}, estimates "
            f"{np.median(estimate):.1e} (median) to {estimate.max():.1e}, {worse} exceeded"
        )
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
