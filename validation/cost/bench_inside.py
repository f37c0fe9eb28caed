"""Stress in the body: group ``inside`` of bench.py.

Many points to two tolerances, all digits, and one point. True errors are against all digits, at
some points.
"""

from __future__ import annotations

import math
import os
import tracemalloc
from functools import partial

import numpy as np
from timed import Case, report, warm

from spectral_contact import Scene, solve

SEED, COUNT, ROUNDS, CHECKED = 20, 100_000, 3, 200
#: Of many points, by the name in bench.toml.
TOLERANCES = {"loose": 1e-8, "tight": 1e-10}
SCENES = {
    "smooth, no friction": Scene(0.3),
    "slip": Scene(0.3, 0.2, 0.2, 0.1),
    "coupled slip, 1e-3": Scene(0.2, 1e-3, 1e-3, 0.2, coupling=True),
}


def places(rng):
    """Return distances from the edge and depths of the points, by name."""
    r, z = np.meshgrid(np.linspace(0.0, 2.0, 316), np.linspace(0.0, 2.0, 317)[1:])
    size = 10.0 ** rng.uniform(-6.0, 0.0, COUNT)
    angle = rng.uniform(0.0, np.pi, COUNT)
    far = rng.uniform(0.0, 5.0, (2, COUNT))
    close = 10.0 ** rng.uniform(-12.0, 0.0, COUNT)
    close = np.choose(rng.integers(0, 3, COUNT), [close, -10.0 * close, 1.0 - close])
    return {
        "grid over two radii": (1.0 - r.ravel(), z.ravel()),
        "anywhere in five radii": (1.0 - far[0], far[1]),
        "every distance from the edge, 1e-6 to 1": (size * np.cos(angle), size * np.sin(angle)),
        "every distance and depth, 1e-12 to 30": (close, 10.0 ** rng.uniform(-12.0, 1.5, COUNT)),
    }


def row_of(scene, from_edge, z, rng):
    """Return the figures of one scene and one set of points."""
    body = solve(scene, rtol=1e-11).inside
    some = rng.choice(len(z), CHECKED, replace=False)
    exact = body.stress(from_edge=from_edge[some], z=z[some])

    def in_units(chosen, **options):
        call = partial(body.stress, from_edge=from_edge[chosen], z=z[chosen], **options)
        return warm(Case({}, lambda _: call, math.inf, ROUNDS))[1]

    row = {"one_of_100": in_units(some[:100]) / 100, "alone": in_units(0)}
    for name, rtol in TOLERANCES.items():
        found = body.stress(from_edge=from_edge, z=z, rtol=rtol)
        parts = ("rr", "tt", "zz", "rz")
        apart = [np.abs(getattr(found, one)[some] - getattr(exact, one)) for one in parts]
        row[name] = in_units(slice(None), rtol=rtol)
        row[f"{name}_error"] = (np.max(apart, axis=0) / exact.norm).max()
        row[f"{name}_estimate"] = found.error.max()
    tracemalloc.start()
    body.stress(from_edge=from_edge, z=z, rtol=TOLERANCES["loose"])
    row["megabytes"] = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    return row


def rows():
    """Yield the rows of all scenes and points."""
    rng = np.random.default_rng(SEED)
    for name, scene in SCENES.items():
        for where, points in places(rng).items():
            yield {"scene": name, "points": where, **row_of(scene, *points, rng)}


def main(group):
    """Measure and write."""
    report(group, rows(), load=os.getloadavg()[0], count=COUNT, **TOLERANCES)
