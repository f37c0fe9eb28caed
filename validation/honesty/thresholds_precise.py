"""Zones at thresholds nearer than doubles can judge, against `reference`.

Run as ``python validation/honesty/thresholds_precise.py [scenes]`` (some twenty seconds of CPU
each); writes validation/results/thresholds_precise.json and .md. Scenes lie below the friction at
which slip begins, at the edge or inside, by relative distances of 10^-9 ... 10^-14; `reference`
takes its zones from the friction law in mpmath, to 20 digits. Those that are in the file already
are kept: their verdicts are taken anew, in seconds. *Right*: the same zones, every boundary within
its estimate. *Room*: the estimate says that a zone may be missing, or that no digit is known.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import sys
from collections import Counter
from itertools import count
from pathlib import Path
from time import process_time
from typing import Any

from honesty_thresholds import draw

import spectral_contact
from spectral_contact import ConvergenceError, NotComputedError, Scene, reference, solve

RESULTS = Path(__file__).parents[1] / "results"
SCENES, DIGITS, NEAR = 100, 20, 8
KINDS = "edge", "inside"


def with_truth(drawn: dict[str, Any]) -> dict[str, Any]:
    """Return a scene with its zones, and the CPU seconds that these took."""
    begin = process_time()
    zones = reference(Scene(*drawn["scene"]), digits=DIGITS).zones
    truth = [(z.kind, float(z.outer_from_edge)) for z in zones]
    return drawn | {"truth": truth, "seconds": process_time() - begin}


def judged(drawn: dict[str, Any]) -> dict[str, Any]:
    """Return a scene that has its zones with the verdict of the solver."""
    truth, found = drawn["truth"], solve(Scene(*drawn["scene"]), drawn["rtol"], strict=False)
    zones = [(z.kind, z.outer_from_edge) for z in found.zones]
    estimate = found.error.zones
    off = max(
        (
            abs(mine / other - 1.0) if other < 0.5 else abs(mine - other) / (1.0 - other)
            for (_, mine), (_, other) in zip(zones[:-1], truth[:-1], strict=False)
        ),
        default=0.0,
    )
    same = [kind for kind, _ in zones] == [kind for kind, _ in truth]
    if not found.converged:
        verdict = "refused"
    elif estimate is None or estimate >= 1.0:
        verdict = "room"
    else:
        verdict = "right" if same and off <= estimate else "wrong"
    return drawn | {"zones": zones, "estimate": estimate, "off": off, "verdict": verdict}


def table(rows: list[dict[str, Any]], unknown: int) -> str:
    """Return the counts as Markdown."""
    names = "right", "room", "refused", "wrong"
    lines = [
        f"{len(rows)} scenes below the onset of slip by 10^-{NEAR + 1} ... 10^-14, against "
        f"`reference` to {DIGITS} digits, by validation/honesty/thresholds_precise.py; "
        f"of {unknown} more it knows no zones.\n",
        f"| slip begins | scenes | {' | '.join(names)} | largest error over estimate |",
        "|---" * 7 + "|",
    ]
    for kind in KINDS:
        own = [row for row in rows if row["kind"] == kind]
        counts = Counter(row["verdict"] for row in own)
        ratios = [row["off"] / row["estimate"] for row in own if row["verdict"] == "right"]
        cells = [kind, len(own), *(counts[name] for name in names)]
        cells.append(f"{max(ratios):.2g}" if ratios else "")
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main(scenes: int) -> int:
    """Judge scenes, print and store."""
    path = RESULTS / "thresholds_precise.json"
    kept = json.loads(path.read_text()) if path.exists() else {"rows": []}
    rows, unknown = [judged(row) for row in kept["rows"]], kept.get("unknown", [])
    begin = max([*(row["number"] for row in rows), *unknown], default=-1) + 1
    numbers = (n for n in count(begin) if n % 6 < len(KINDS))  # without coupling
    while True:
        record = {"library": spectral_contact.__version__, "rows": rows, "unknown": unknown}
        path.write_text(json.dumps(record, indent=1) + "\n")
        path.with_suffix(".md").write_text(table(rows, len(unknown)))
        if len(rows) >= scenes:
            break
        number = next(numbers)
        try:
            drawn = draw(number)
            if drawn["decade"] > NEAR and drawn["below"]:
                rows.append(judged(with_truth(drawn)))
                print(json.dumps(rows[-1]), flush=True)
        except (NotComputedError, ConvergenceError) as missing:
            unknown.append(number)
            print(number, missing, flush=True)
    print(table(rows, len(unknown)))
    return sum(row["verdict"] == "wrong" for row in rows)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else SCENES))
