"""Whether solutions at thresholds obey the friction law within their estimates.

Strata of honesty.py: ``thresholds`` writes validation/results/honesty_thresholds.json and .md, and
its store keeps the scenes that are done; ``thresholds_precise``, of some twenty seconds of CPU a
scene, writes thresholds_precise.json and .md. Scenes of the first lie at relative distances of
10^-2 ... 10^-14 from the friction at which slip begins, at the edge or inside, and from the second
threshold, at which the edge begins to slip, too. The law is evaluated with the elliptic kernels,
which share nothing with the solver, on both sides of all boundaries; a zone that must be there is
looked for. A broken law that no estimate explains is wrong, and so is an infinite estimate of the
slip that a closer tolerance makes finite.

Precise scenes lie below the friction at which slip begins, at the edge or inside, by relative
distances of 10^-9 ... 10^-14, nearer than doubles can judge; `reference` takes its zones from the
friction law in mpmath, to 20 digits. Those that are in the file already are kept: their verdicts
are taken anew, in seconds. *Right*: the same zones, every boundary within its estimate. *Room*: the
estimate says that a zone may be missing, or that no digit is known. A stick radius that is off by
more than its estimate is wrong in any case.
"""

from __future__ import annotations

import functools
import itertools
import json
import math
from collections import Counter
from collections.abc import Sequence
from time import process_time
from types import SimpleNamespace
from typing import Any

import numpy as np
from honesty_errors import EPS, unexplained, zones_alike, zones_error
from reporting import options, stored, table, unit, write
from strata import kept_rows, store_of

from spectral_contact import ConvergenceError, NotComputedError, Scene, Solution, reference, solve
from spectral_contact.testing.solution_checks import _zone_checks, field_of

#: Scenes at thresholds unless another number is asked for, and the seed of precise scenes.
COUNT, SEED = 150, 18
VERDICTS = "right", "room", "refused", "wrong"
KINDS = "edge", "inside", "second"
LEAST, MOST = 2, 14
#: Poisson ratio and compliances of the scenes at second thresholds; how often the interval of
#: friction is halved that holds the threshold, with and without coupling.
BASES = (0.3, 0.2, 0.5), (0.3, 0.05, 1.0)
HALVINGS = {False: 40, True: 22}
#: By how much the quadrature may break the friction law, and how long a solve may take, in U.
FLOOR, SLOW = 1e-11, 250.0
#: Number of precise scenes, the digits of their truths, and the largest distance from the onset:
#: the friction is below it by less than 10^-(FARTHEST_DECADE + 1).
SCENES, DIGITS, FARTHEST_DECADE = 100, 20, 8

Record = dict[str, Any]


@functools.cache
def second_threshold(base: tuple[float, float, float], coupled: bool) -> float:
    """Return the friction below which the edge slips, by bisection on the zones found.

    Above it the edge sticks, around slip around stick: three zones.
    """
    stick = Scene(*base, math.inf, coupling=coupled)
    found = solve(stick, 1e-10, ("critical_friction", "edge_ratio"))
    low, high = found.edge_ratio, 0.5 * (found.critical_friction + found.edge_ratio)
    for _ in range(HALVINGS[coupled]):
        middle = 0.5 * (low + high)
        zones = solve(Scene(*base, middle, coupling=coupled), 1e-6, strict=False).zones
        low, high = (low, middle) if len(zones) == 3 else (middle, high)
    return 0.5 * (low + high)


def draw(number: int, seed: int) -> Record:
    """Return a scene at a threshold, how far it is, on which side, and a tolerance."""
    rng = np.random.default_rng([seed, number])
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
    pressure, traction = (field_of(solution, name) for name in ("pressure", "traction"))
    at = places(solution, rtol)
    checks = _zone_checks(scene, pressure, traction, rtol, cuts, at)
    return max(-float(pressure(at).min()), *(check.error for check in checks))


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


def judged(number: int, seed: int) -> Record:
    """Return a scene with its verdict, and the time of the processor in U."""
    drawn = draw(number, seed)
    solution = None
    begin = process_time()
    try:
        scene = Scene(*drawn["scene"], coupling=drawn["coupled"])
        solution = solve(scene, drawn["rtol"], strict=False)
    except NotComputedError as missing:
        drawn |= {"verdict": "refused", "why": str(missing)[:200]}
    except Exception as error:
        drawn |= {"verdict": "wrong", "why": f"{type(error).__name__}: {error!s:.200}"}
    drawn["u"] = (process_time() - begin) / unit()
    if solution is not None:
        drawn["verdict"] = verdict(drawn, solution)
    return drawn


def counted(rows: list[Record]) -> list[int]:
    """Return how many scenes there are, and how many of each verdict."""
    counts = Counter(row["verdict"] for row in rows)
    return [len(rows), *(counts[name] for name in VERDICTS)]


def counts_table(rows: list[Record], seed: int) -> str:
    """Return the counts as Markdown."""
    cells = []
    for kind, coupled in itertools.product(KINDS, (False, True)):
        own = [row for row in rows if row["kind"] == kind and row["coupled"] == coupled]
        slow = sum(row["u"] > SLOW for row in own)
        cells.append((kind, "yes" if coupled else "no", *counted(own), slow))
    heading = f"threshold | coupled | scenes | {' | '.join(VERDICTS)} | above {SLOW:g} U"
    return (
        f"{len(rows)} scenes, seed {seed}, at relative distances 10^-2 ... 10^-14 from a "
        "threshold. *Room*: the zones' estimate says that one may be missing.\n\n"
        f"{table(heading, cells)}"
    )


# --- against `reference` --------------------------------------------------------------------------


def with_truth(drawn: Record) -> Record:
    """Return a scene with its zones, and the CPU seconds that these took."""
    begin = process_time()
    zones = reference(Scene(*drawn["scene"]), digits=DIGITS).zones
    truth = [(z.kind, float(z.outer_from_edge)) for z in zones]
    return drawn | {"truth": truth, "seconds": process_time() - begin}


def judged_precisely(drawn: Record) -> Record:
    """Return a scene that has its zones with the verdict of the solver."""
    found = solve(Scene(*drawn["scene"]), drawn["rtol"], strict=False)
    truth = SimpleNamespace(
        zones=[
            SimpleNamespace(kind=kind, outer=1.0 - from_edge, outer_from_edge=from_edge)
            for kind, from_edge in drawn["truth"]
        ]
    )
    off, estimate = zones_error(found, truth), found.error.zones
    radius_off = abs(found.stick_radius / truth.zones[0].outer - 1.0)
    if not found.converged:
        verdict = "refused"
    elif not radius_off <= found.error.stick_radius + EPS:
        verdict = "wrong"
    elif estimate is None or estimate >= 1.0:
        verdict = "room"
    else:
        verdict = "right" if zones_alike(found, truth) and off <= estimate else "wrong"
    zones = [(z.kind, z.outer_from_edge) for z in found.zones]
    return drawn | {"zones": zones, "estimate": estimate, "off": off, "verdict": verdict}


def precise_table(rows: list[Record], unknown: int) -> str:
    """Return the counts as Markdown."""
    cells = []
    for kind in KINDS[:2]:
        own = [row for row in rows if row["kind"] == kind]
        ratios = [row["off"] / row["estimate"] for row in own if row["verdict"] == "right"]
        cells.append((kind, *counted(own), f"{max(ratios):.2g}" if ratios else ""))
    heading = f"slip begins | scenes | {' | '.join(VERDICTS)} | largest error over estimate"
    return (
        f"{len(rows)} scenes below the onset of slip by 10^-{FARTHEST_DECADE + 1} ... 10^-14, "
        f"against `reference` to {DIGITS} digits, by "
        f"validation/honesty/honesty.py thresholds_precise; of {unknown} more "
        f"it knows no zones.\n\n{table(heading, cells)}"
    )


def precise_rows(scenes: int) -> list[Record]:
    """Judge so many scenes, print and store them."""
    kept = stored("thresholds_precise") or {"rows": []}
    rows, unknown = [judged_precisely(row) for row in kept["rows"]], kept.get("unknown", [])
    begin = max([*(row["number"] for row in rows), *unknown], default=-1) + 1
    numbers = (n for n in itertools.count(begin) if n % 6 < 2)  # without coupling
    while True:
        record = {"rows": rows, "unknown": unknown}
        write("thresholds_precise", precise_table(rows, len(unknown)), record)
        if len(rows) >= scenes:
            return rows
        number = next(numbers)
        try:
            drawn = draw(number, SEED)
            if drawn["decade"] > FARTHEST_DECADE and drawn["below"]:
                rows.append(judged_precisely(with_truth(drawn)))
                print(json.dumps(rows[-1]), flush=True)
        except (NotComputedError, ConvergenceError) as missing:
            unknown.append(number)
            print(number, missing, flush=True)


def main(stratum: str, arguments: Sequence[str]) -> bool:
    """Run a stratum, and return whether a solution is wrong."""
    if stratum == "thresholds":
        counts = {"scenes": COUNT, "seed": 1, "workers": 1}
        asked = options(__doc__, arguments, **counts, store=store_of("honesty_thresholds"))
        work, made_with = functools.partial(judged, seed=asked.seed), {"seed": asked.seed}
        rows = kept_rows(work, asked.scenes, asked.workers, asked.store, **made_with)
        violations = [row for row in rows if row["verdict"] == "wrong"]
        record = made_with | {"scenes": len(rows), "violations": violations}
        write("honesty_thresholds", counts_table(rows, asked.seed), record, version=2)
        print(*violations, sep="\n")
    else:
        rows = precise_rows(options(__doc__, arguments, scenes=SCENES).scenes)
    return any(row["verdict"] == "wrong" for row in rows)
