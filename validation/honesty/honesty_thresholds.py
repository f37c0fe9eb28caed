"""Whether solutions at thresholds obey the friction law within their estimates.

Run as ``python validation/honesty/honesty_thresholds.py [seconds]``; writes
validation/results/honesty_thresholds.json and .md. Scenes lie at relative distances of
10^-2 ... 10^-14 from the friction at which slip begins, at the edge or inside, and from the second
threshold, at which the edge begins to slip, too. The law is
evaluated with the elliptic kernels, which share nothing with the solver, on both sides of all
boundaries; a zone that must be there is looked for. A broken law that no estimate explains is
wrong, and so is an infinite estimate of the slip that a closer tolerance makes finite.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import functools
import itertools
import json
import math
import sys
from collections import Counter
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

sys.path.append(str(Path(__file__).parents[1] / "cost"))

import numpy as np
from bench_solve import dense_solve
from honesty_errors import unexplained

import spectral_contact
from spectral_contact import NotComputedError, Scene, Solution, solve
from spectral_contact.equations.residuals import tangential_displacement

RESULTS = Path(__file__).parents[1] / "results"
SEED, SECONDS = 18, 540.0
KINDS = "edge", "inside", "second"
LEAST, MOST = 2, 14
#: Where the second threshold is looked for, and to how many digits.
BASES = (0.3, 0.2, 0.5), (0.3, 0.05, 1.0)
HALVINGS = {False: 40, True: 22}
#: What the quadrature leaves of the law, and what a solve may take, in U.
FLOOR, SLOW = 1e-11, 250.0

Record = dict[str, Any]


@functools.cache
def second_threshold(base: tuple[float, float, float], coupled: bool) -> float:
    """Return the friction below which the edge slips, by bisection on the zones found."""
    stick = Scene(*base, math.inf, coupling=coupled)
    found = solve(stick, 1e-10, ("critical_friction", "edge_ratio"))
    low, high = found.edge_ratio, 0.5 * (found.critical_friction + found.edge_ratio)
    for _ in range(HALVINGS[coupled]):
        middle = 0.5 * (low + high)
        scene = Scene(*base, middle, coupling=coupled)
        low, high = (
            (low, middle) if len(solve(scene, 1e-6, strict=False).zones) == 3 else (middle, high)
        )
    return 0.5 * (low + high)


def draw(number: int) -> Record:
    """Return a scene at a threshold, how far it is, on which side, and a tolerance."""
    rng = np.random.default_rng([SEED, number])
    kind, coupled = KINDS[number % 3], bool(number // 3 % 2)
    decade = LEAST + number // 6 % (MOST - LEAST + 1)
    distance = 10.0**-decade * (1.0 if rng.random() < 0.8 else -1.0)
    rtol = 10.0 ** -int(rng.integers(2, 12))
    if kind == "second":
        base = BASES[0 if coupled else int(rng.integers(2))]
        threshold = second_threshold(base, coupled)
    else:
        # thinner layers have no critical friction with coupling: full stick would open at the edge
        larger = 10.0 ** rng.uniform(-1.5 if coupled else -3.0, 1.0)
        pair = larger, larger * 10.0 ** rng.uniform(-1.5, -0.1)
        base = (float(rng.uniform(-0.5, 0.49)), *(pair if kind == "edge" else pair[::-1]))
        stick = Scene(*base, math.inf, coupling=coupled)
        threshold = solve(stick, 1e-12, ("critical_friction",), strict=False).critical_friction
    return {
        "number": number,
        "kind": kind,
        "coupled": coupled,
        "decade": decade,
        "below": distance > 0.0,
        "scene": [*base, threshold * (1.0 - distance)],
        "rtol": rtol,
    }


def places(solution: Solution, rtol: float) -> np.ndarray:
    """Return distances from the edge, graded to all boundaries, but for what is too near them."""
    ends = [0.0, *(z.outer_from_edge for z in reversed(solution.zones[:-1])), 1.0]
    found = [10.0 ** -np.arange(1.0, 8.0), np.linspace(0.15, 0.95, 9)]
    for near, far in itertools.pairwise(ends):
        half = (far - near) / 2.0
        graded = half * 10.0 ** -np.linspace(0.0, 5.0, 8)
        found += [near + graded, far - graded]
    d = np.unique(np.concatenate(found))
    d = d[(d > 1e-9) & (d < 0.999)]
    apart = [np.abs(d / end - 1.0) > math.sqrt(rtol) for end in ends[1:-1]]
    return d[np.all(apart, axis=0)] if apart else d


def broken(solution: Solution, rtol: float) -> float:
    """Return by how much the law is broken, relative to friction or to what the pressure moves."""
    scene = solution.scene
    cuts = [z.outer_from_edge for z in solution.zones[:-1]]
    layers = [c for c in (scene.normal_compliance, scene.tangential_compliance) if c]
    cuts += [10.0**-k for k in range(1, 15) if 10.0**-k > min([*layers, 1.0]) / 30.0]
    d = places(solution, rtol)

    def field(name: str) -> Any:
        return lambda x: getattr(solution, name)(from_edge=x)

    p, q = solution.pressure(from_edge=d), solution.traction(from_edge=d)
    parts = [
        tangential_displacement(field("traction"), field("pressure"), scene.kappa, float(x), cuts)
        for x in d
    ]
    outward, inward = np.array(parts).T
    moved = (scene.tangential_compliance * q + outward - inward) / inward
    share = np.abs(q) / (scene.friction * p)
    slips = share > 1.0 - 4.0 * rtol
    wrong = np.where(slips, np.maximum(moved * np.sign(q), 0.0), np.abs(moved))
    return float(max(wrong.max(), share.max() - 1.0, -p.min()))


def verdict(drawn: Record, solution: Solution) -> str:
    """Return right, room, refused or wrong."""
    if not solution.converged:
        return "refused"
    rtol, error = drawn["rtol"], solution.error
    miss = broken(solution, rtol)
    drawn |= {"broken": miss, "zones": len(solution.zones), "zones_error": error.zones}
    estimates = [e for e in (error.approach, error.pressure, error.traction, error.zones) if e]
    if any(math.isnan(e) for e in estimates):
        return "wrong"
    slips = any(zone.kind == "slip" for zone in solution.zones)
    certain = error.zones is not None and error.zones < 1.0
    absent = drawn["kind"] != "second" and slips != drawn["below"]
    closest = None
    if error.slip == math.inf:
        closest = solve(solution.scene, 1e-12, strict=False)
    drawn["unexplained"] = unexplained(solution, closest)
    if drawn["unexplained"]:
        return "wrong"
    if miss > 2.0 * rtol + FLOOR or (absent and certain):
        spared = not certain and miss <= max(error.violation or 0.0, 2.0 * rtol + FLOOR)
        return "room" if spared else "wrong"
    return "right" if certain else "room"


def judged(number: int) -> Record:
    """Return a scene with its verdict, and the time of the processor in U."""
    drawn = draw(number)
    scene = Scene(*drawn["scene"], coupling=drawn["coupled"])
    unit = dense_solve()
    begin = process_time()
    try:
        solution = solve(scene, drawn["rtol"], strict=False)
    except NotComputedError as missing:
        drawn["verdict"], drawn["why"] = "refused", str(missing)[:200]
    except Exception as error:
        drawn["verdict"], drawn["why"] = "wrong", f"{type(error).__name__}: {error!s:.200}"
    else:
        drawn["u"] = (process_time() - begin) / unit
        drawn["verdict"] = verdict(drawn, solution)
    drawn.setdefault("u", (process_time() - begin) / unit)
    return drawn


def table(rows: list[Record]) -> str:
    """Return the counts as Markdown."""
    names = "right", "room", "refused", "wrong"
    lines = [
        f"{len(rows)} scenes at relative distances 10^-2 ... 10^-14 from a threshold. *Room*: the "
        "zones' estimate says that one may be missing.",
        "",
        f"| threshold | coupled | scenes | {' | '.join(names)} | above {SLOW:g} U |",
        "|---" * 8 + "|",
    ]
    for kind in KINDS:
        for coupled in (False, True):
            own = [r for r in rows if r["kind"] == kind and r["coupled"] == coupled]
            counts = Counter(r["verdict"] for r in own)
            slow = sum(r["u"] > SLOW for r in own)
            cells = [kind, "yes" if coupled else "no", len(own), *(counts[n] for n in names), slow]
            lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main(seconds: float) -> None:
    """Judge as many scenes as the time allows, print and store."""
    rows: list[Record] = []
    begin = perf_counter()
    while perf_counter() - begin < seconds:
        rows.append(judged(len(rows)))
        print(json.dumps(rows[-1]), flush=True)
    record = {
        "schema": "spectral_contact.validation.honesty_thresholds",
        "version": 1,
        "library": spectral_contact.__version__,
        "seed": SEED,
        "scenes": len(rows),
        "rows": rows,
    }
    text = json.dumps(record, separators=(",", ":"))
    (RESULTS / "honesty_thresholds.json").write_text(f"{text}\n")
    (RESULTS / "honesty_thresholds.md").write_text(table(rows))
    print(table(rows))


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
