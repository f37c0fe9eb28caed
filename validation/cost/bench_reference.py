"""Measure what digits cost: python validation/cost/bench_reference.py.

Writes validation/results/bench_reference.json and .md. One process, one BLAS thread.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import math
import sys
from pathlib import Path
from time import process_time

from mpmath import libmp

from spectral_contact import Scene, __version__
from spectral_contact.precise import reference

RESULTS = Path(__file__).parents[1] / "results"
SCENES = {
    "normal and full stick, α* = β* = 0.5": Scene(0.1, 0.5, 0.5, math.inf),
    "normal and full stick, α* = β* = 1e-6": Scene(0.1, 1e-6, 1e-6, math.inf),
    "partial slip, α* = β* = 0.5, f = 0.1": Scene(0.1, 0.5, 0.5, 0.1),
    "partial slip, α* = β* = 1e-6, f = 0.1": Scene(0.1, 1e-6, 1e-6, 0.1),
    "slip inside, α* = 0.05, β* = 1, f = 0.0329": Scene(0.3, 0.05, 1.0, 0.0329),
    "slip inside, α* = 0, β* = 1e-6, f = 0.1": Scene(0.3, 0.0, 1e-6, 0.1),
    "coupled full stick, α* = β* = 0.5": Scene(0.1, 0.5, 0.5, math.inf, coupling=True),
    "coupled full stick, α* = β* = 1e-6": Scene(0.1, 1e-6, 1e-6, math.inf, coupling=True),
    "coupled full stick, α* = 0, β* = 1e-6": Scene(0.1, 0.0, 1e-6, math.inf, coupling=True),
    "coupled full stick, α* = β* = 0": Scene(0.1, 0.0, 0.0, math.inf, coupling=True),
}
DIGITS = (20, 30)
#: More, for the first scene alone.
MANY = 50


def main() -> None:
    """Run and write the results."""
    rows = []
    for name, scene in SCENES.items():
        for digits in (*DIGITS, MANY) if name == next(iter(SCENES)) else DIGITS:
            begin = process_time()
            solution = reference(scene, digits, progress=sys.stderr.isatty())
            seconds = process_time() - begin
            worst = max(
                e
                for e in (solution.error.pressure, solution.error.traction, solution.error.zones)
                if e is not None
            )
            rows.append(
                {
                    "scene": name,
                    "digits": digits,
                    "seconds": seconds,
                    "unknowns": solution.unknowns,
                    "bits": solution.bits,
                    "error": worst,
                }
            )
    record = {
        "schema": "spectral_contact.validation.bench_reference",
        "version": 1,
        "library": __version__,
        "integers": libmp.BACKEND,
        "rows": rows,
    }
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps(record, indent=1, ensure_ascii=False)
    (RESULTS / "bench_reference.json").write_text(text + "\n", encoding="utf-8")
    lines = [
        f"Integers of {libmp.BACKEND}; seconds of one processor for both solutions and the "
        "estimate.",
        "",
        "| scene | digits | seconds | unknowns | bits | error estimate |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['scene']} | {r['digits']} | {r['seconds']:.0f} | {r['unknowns']} | {r['bits']} "
        f"| {r['error']:.0e} |"
        for r in rows
    ]
    (RESULTS / "bench_reference.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
