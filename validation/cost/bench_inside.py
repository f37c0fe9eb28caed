"""Stress in the body: group ``inside`` of bench.py.

Many points to two tolerances, all digits, and one point; the best of some rounds, with U measured
before and after. True errors are against all digits, at some points.
"""

from __future__ import annotations

import os
import tracemalloc

import numpy as np
from timed import seconds, table, unit, write

from spectral_contact import Scene, solve

SEED, COUNT, ROUNDS, CHECKED = 20, 100_000, 3, 200
TOLERANCES = (1e-8, 1e-10)
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


def in_units(call, repeats=1):
    """Return the best time of a call in U."""
    times = []
    for _ in range(ROUNDS):
        before = unit()
        spent = seconds(lambda: [call() for _ in range(repeats)]) / repeats
        times.append(spent / min(before, unit()))
    return min(times)


def row_of(name, scene, where, from_edge, z, rng):
    """Return the row of one scene and one set of points."""
    body = solve(scene, rtol=1e-11).inside
    some = rng.choice(len(z), CHECKED, replace=False)
    exact = body.stress(from_edge=from_edge[some], z=z[some])
    cells = [name, where]
    for rtol in TOLERANCES:
        body.stress(0.5, 0.5, rtol=rtol)  # panels are prepared once
        found = body.stress(from_edge=from_edge, z=z, rtol=rtol)
        parts = ("rr", "tt", "zz", "rz")
        apart = [np.abs(getattr(found, one)[some] - getattr(exact, one)) for one in parts]
        error = (np.max(apart, axis=0) / exact.norm).max()
        many = in_units(lambda rtol=rtol: body.stress(from_edge=from_edge, z=z, rtol=rtol))
        cells += [f"{many:.0f}", f"{error:.0e}", f"{found.error.max():.1e}"]
    tracemalloc.start()
    body.stress(from_edge=from_edge, z=z, rtol=TOLERANCES[0])
    cells.append(f"{tracemalloc.get_traced_memory()[1] / 1e6:.0f}")
    tracemalloc.stop()
    part = from_edge[some[:100]], z[some[:100]]
    hundred = in_units(lambda: body.stress(from_edge=part[0], z=part[1])) / 100
    one = in_units(lambda: body.stress(from_edge=from_edge[0], z=z[0]), 20)
    return [*cells, f"{hundred:.3f}", f"{one:.3f}"]


def main(name):
    """Measure and write."""
    rng, rows = np.random.default_rng(SEED), []
    for scene_name, scene in SCENES.items():
        for where, (from_edge, z) in places(rng).items():
            rows.append(row_of(scene_name, scene, where, from_edge, z, rng))
            print(*rows[-1], flush=True)
    each = " | ".join(f"{rtol:.0e} | true error | estimate" for rtol in TOLERANCES)
    about = (
        f"{COUNT} points of stress with rtol {' and '.join(f'{one:.0e}' for one in TOLERANCES)}, "
        f"times in U, the load of the machine was {os.getloadavg()[0]:.1f}; and one point of 100, "
        "and one alone, with all digits."
    )
    heading = f"scene | points | {each} | MB | one of 100 | alone"
    write(name, f"{about}\n\n{table(heading, rows)}")
