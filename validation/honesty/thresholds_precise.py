"""Zones at thresholds nearer than doubles can judge, against `reference`.

Run as ``python validation/honesty/thresholds_precise.py [scenes]`` (half a minute to ten minutes
each); writes validation/results/thresholds_precise.json and .md. Scenes lie below the friction at
which slip begins, at the edge or inside, by relative distances of 10^-9 ... 10^-14; `reference`
takes its zones from the friction law in mpmath, to 20 digits. *Right*: the same zones, every
boundary within its estimate. *Room*: the estimate says that a zone may be missing, or that no digit
is known.
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
from time import perf_counter
from typing import Any

from honesty_thresholds import draw

import spectral_contact
from spectral_contact import NotComputedError, Scene, reference, solve

RESULTS = Path(__file__).parents[1] / "results"
SCENES, DIGITS, NEAR = 100, 20, 8
KINDS = "edge", "inside"


def judged(drawn: dict[str, Any]) -> dict[str, Any]:
    """Return a scene with its verdict."""
    begin = perf_counter()
    scene = Scene(*drawn["scene"])
    truth = [(z.kind, float(z.outer_from_edge)) for z in reference(scene, digits=DIGITS).zones]
    found = solve(scene, drawn["rtol"], strict=False)
    zones = [(z.kind, z.outer_from_edge) for z in found.zones]
    estimate = found.error.zones
    drawn |= {"truth": truth, "zones": zones, "estimate": estimate}
    drawn["off"] = off = max(
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
    return drawn | {"verdict": verdict, "seconds": perf_counter() - begin}


def table(rows: list[dict[str, Any]]) -> str:
    """Return the counts as Markdown."""
    names = "right", "room", "refused", "wrong"
    lines = [
        f"{len(rows)} scenes below the onset of slip by 10^-{NEAR + 1} ... 10^-14, against "
        f"`reference` to {DIGITS} digits, by validation/honesty/thresholds_precise.py.\n",
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
    rows: list[dict[str, Any]] = []
    numbers = (n for n in count() if n % 6 < len(KINDS))  # without coupling
    while len(rows) < scenes:
        try:
            drawn = draw(next(numbers))
            if drawn["decade"] > NEAR and drawn["below"]:
                rows.append(judged(drawn))
                print(json.dumps(rows[-1]), flush=True)
        except NotComputedError as missing:
            print(missing, flush=True)
        record = {"library": spectral_contact.__version__, "rows": rows}
        (RESULTS / "thresholds_precise.json").write_text(json.dumps(record, indent=1) + "\n")
        (RESULTS / "thresholds_precise.md").write_text(table(rows))
    print(table(rows))
    return sum(row["verdict"] == "wrong" for row in rows)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else SCENES))
