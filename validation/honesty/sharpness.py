"""Measure how sharp the error estimates are, against the gold tables.

Run as ``python validation/honesty/sharpness.py``; writes validation/results/sharpness.json and .md.
Every gold scene is solved at four tolerances. The ratio is that of the estimate to the true error
or ten roundings, whichever is larger; where no digit is known there is none.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from oracles.gold_errors import TOLERANCES, errors

from spectral_contact import __version__, gold, solve

RESULTS = Path(__file__).parents[1] / "results"
EPS = 2.2e-16


def ratios(rtol: float) -> dict[str, list[float]]:
    """Return the ratios of all gold scenes by quantity."""
    found = defaultdict(list)
    for table in gold.tables():
        for true in table.solutions:
            double = solve(true.scene, rtol, strict=False)
            for name, error in errors(double, true).items():
                estimate = getattr(double.error, name)
                if np.isfinite(estimate):
                    found[name].append(float(estimate / max(error, 10 * EPS)))
    return found


def record() -> dict:
    """Return the record of the study."""
    rows = []
    for rtol in TOLERANCES:
        for name, values in ratios(rtol).items():
            within = float(np.mean(np.array(values) <= 100.0))
            row = {"rtol": rtol, "quantity": name, "scenes": len(values)}
            rows.append(row | {"median": float(np.median(values)), "share_within_100": within})
    return {
        "schema": "spectral_contact.validation.sharpness",
        "version": 1,
        "library": __version__,
        "scenes": sum(len(table.solutions) for table in gold.tables()),
        "rows": rows,
    }


def table(found: dict) -> str:
    """Return the record as a Markdown table: quantities down, tolerances across."""
    cells = {(row["quantity"], row["rtol"]): row for row in found["rows"]}
    lines = [
        f"{found['scenes']} gold scenes: the share of estimates that are at most 100 times the "
        "true error or ten roundings, whichever is larger, and the median ratio.",
        "",
        "| quantity | scenes | " + " | ".join(f"rtol = {rtol:g}" for rtol in TOLERANCES) + " |",
        "|---" * (2 + len(TOLERANCES)) + "|",
    ]
    for name in dict.fromkeys(row["quantity"] for row in found["rows"]):
        row = [cells[name, rtol] for rtol in TOLERANCES]
        shown = (f"{100 * r['share_within_100']:.0f} %, {r['median']:.0f}" for r in row)
        lines.append(f"| {name.replace('_', ' ')} | {row[0]['scenes']} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure and store."""
    found = record()
    text = json.dumps(found, indent=1) + "\n"
    (RESULTS / "sharpness.json").write_text(text, encoding="utf-8")
    (RESULTS / "sharpness.md").write_text(table(found), encoding="utf-8")
    print(table(found))


if __name__ == "__main__":
    main()
