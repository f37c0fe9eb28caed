"""Measure how sharp the error estimates are, against the gold tables.

Run as ``python validation/honesty/sharpness.py``; writes validation/results/sharpness.json and .md.
Every gold scene is solved at four tolerances. The ratio is that of the estimate to the true error
or ten roundings, whichever is larger; where no digit is known there is none.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.gold_errors import TOLERANCES, errors
from reporting import table, write

from spectral_contact import gold, solve

EPS = 2.2e-16


def ratios(rtol: float) -> dict[str, list[float]]:
    """Return the ratios of all gold scenes by quantity."""
    found = defaultdict(list)
    for each in gold.tables():
        for true in each.solutions:
            double = solve(true.scene, rtol, strict=False)
            for name, error in errors(double, true).items():
                estimate = getattr(double.error, name)
                if np.isfinite(estimate):
                    found[name].append(float(estimate / max(error, 10 * EPS)))
    return found


def main() -> None:
    """Measure and store."""
    rows = []
    for rtol in TOLERANCES:
        for name, values in ratios(rtol).items():
            within = float(np.mean(np.array(values) <= 100.0))
            row = {"rtol": rtol, "quantity": name, "scenes": len(values)}
            rows.append(row | {"median": float(np.median(values)), "share_within_100": within})
    scenes = sum(len(each.solutions) for each in gold.tables())
    about = (
        f"{scenes} gold scenes: the share of estimates that are at most 100 times the "
        "true error or ten roundings, whichever is larger, and the median ratio."
    )
    cells = []
    for name in dict.fromkeys(row["quantity"] for row in rows):
        own = [row for row in rows if row["quantity"] == name]
        shown = (f"{100 * r['share_within_100']:.0f} %, {r['median']:.0f}" for r in own)
        cells.append((name.replace("_", " "), own[0]["scenes"], *shown))
    heading = " | ".join(["quantity", "scenes", *(f"rtol = {rtol:g}" for rtol in TOLERANCES)])
    record = {"scenes": scenes, "rows": rows}
    write("sharpness", f"{about}\n\n{table(heading, cells)}", record)


if __name__ == "__main__":
    main()
