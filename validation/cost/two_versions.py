"""Time a warm solve of many kinds in this version and in another, in turns.

Run as ``python validation/cost/two_versions.py FOLDER``, with the other version checked out in the
folder; writes validation/results/two_versions.md. Each version has a process with one BLAS thread.
They solve a scene in turns, three times a turn, and the ratio is the median of those of the turns,
so that what else the machine does touches both alike. U is measured in the same run.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from math import inf
from pathlib import Path
from statistics import median
from time import process_time

ROOT = Path(__file__).parents[2]
TURNS, SOLVES = 11, 3
KAPPA = 0.8 / 3.6  # at nu = 0.1
#: name: alpha, beta, friction, coupling, rtol
CASES: dict[str, tuple[float, float, float, bool, float]] = {
    "full stick": (0.5, 0.5, inf, False, 1e-12),
    "full stick, thin": (1e-6, 1e-6, inf, False, 1e-12),
    "one disk": (0.5, 0.5, 0.5 * KAPPA, False, 1e-12),
    "one disk, loose": (0.5, 0.5, 0.5 * KAPPA, False, 1e-2),
    "one disk, thin": (1e-6, 1e-6, 0.9 * KAPPA, False, 1e-12),
    "one disk, β* = 0": (0.5, 0.0, 0.5 * KAPPA, False, 1e-12),
    "slip inside": (0.05, 1.0, 0.23 * KAPPA, False, 1e-8),
    "slip inside, tight": (0.05, 1.0, 0.23 * KAPPA, False, 1e-12),
    "coupled, full stick": (0.5, 0.5, inf, True, 1e-12),
    "coupled, one disk": (0.5, 0.5, 0.5 * KAPPA, True, 1e-12),
    "coupled, one disk, thin": (1e-6, 1e-6, 0.9 * KAPPA, True, 1e-12),
    "coupled, one disk, smooth": (0.0, 0.0, 0.9 * KAPPA, True, 1e-12),
    "coupled, slip inside": (0.05, 1.0, 0.23 * KAPPA, True, 1e-12),
}


def serve() -> None:
    """Time the cases that are asked for."""
    import numpy as np

    from spectral_contact import Scene, solve

    matrix, ones = np.random.default_rng(1).standard_normal((1000, 1000)), np.ones(1000)
    for line in sys.stdin:
        case, begin = json.loads(line), process_time()
        if case is None:
            np.linalg.solve(matrix, ones)
        else:
            alpha, beta, friction, coupling, rtol = case
            for _ in range(SOLVES):
                solve(Scene(0.1, alpha, beta, friction, coupling=coupling), rtol)
        print((process_time() - begin) / (1 if case is None else SOLVES), flush=True)


def start(folder: Path) -> subprocess.Popen[str]:
    """Return a process that serves with the version in a folder."""
    one = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), "1")
    return subprocess.Popen(
        [sys.executable, "-P", __file__, "--serve"],
        env={**os.environ, **one, "PYTHONPATH": str(folder)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def ask(process: subprocess.Popen[str], case: object) -> float:
    """Return the time that a process takes for a case, in s."""
    assert process.stdin is not None
    assert process.stdout is not None
    print(json.dumps(case), file=process.stdin, flush=True)
    return float(process.stdout.readline())


def main(other: Path) -> None:
    """Time all cases, and write the table."""
    versions = [start(other.resolve()), start(ROOT)]
    unit = median(ask(versions[1], None) for _ in range(TURNS))
    rows = ["| warm solve | `rtol` | other [U] | this [U] | ratio |", "|---|---|---|---|---|"]
    for name, case in CASES.items():
        for version in versions:
            ask(version, case)
        turns = []
        for turn in range(TURNS):
            order = versions if turn % 2 else versions[::-1]
            times = [ask(version, case) for version in order]
            turns.append(times if turn % 2 else times[::-1])
        before, now = (median(one) / unit for one in zip(*turns, strict=True))
        ratio = median(b / a for a, b in turns)
        rows.append(f"| {name} | {case[-1]:g} | {before:.3f} | {now:.3f} | {ratio:.2f} |")
        print(rows[-1], flush=True)
    text = "\n".join(rows) + "\n"
    (ROOT / "validation/results/two_versions.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.serve:
        serve()
    elif chosen.folder is None:
        parser.error("which folder holds the other version?")
    else:
        main(chosen.folder)
