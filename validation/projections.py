"""Compare entries of the Galerkin matrices with double integrals of the elliptic kernels.

Run as ``python validation/projections.py``; writes validation/results/projections.json and .md.
The meshes are those of the solver at a tolerance of 1e-12. On each, pairs of panels of every kind
give the entries of the lowest and the highest degree, in the matrices of K1 and K2. The oracle is
mpmath, tests/projection_oracle.py; it shares no code with the library. It computes every entry
with two densities of its rules and keeps the denser; to how many digits they agree is the accuracy
of the other. Differences and digits are relative to ``sqrt(A_ii A_jj)``, the scale of the Cholesky
factor: entries between distant panels of high degree are themselves far smaller.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import json
import math
import sys
from collections.abc import Iterator
from dataclasses import asdict
from itertools import product
from pathlib import Path
from time import perf_counter

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from projection_oracle import FINE, FINER, basis, entries, mp, rows

from spectral_contact import __version__
from spectral_contact.contact.resolution import starting_resolution
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

RESULTS = Path(__file__).parent / "results"
TOLERANCE = 1e-12
EPS = 2.0**-52
TAIL = -1
FORMS: dict[str, dict[str, float]] = {
    "plain": {},
    "weight": {"power": -0.5},
    "root tail": {"root_tail": True},
}
MESHES = {
    f"{alpha:g}, {form}": starting_resolution(-math.log(alpha), TOLERANCE, **options).panels
    for alpha in (0.5, 1e-6)
    for form, options in FORMS.items()
}


def cases(panels: LogPanels) -> dict[str, tuple[int, int]]:
    """Return pairs of panels of every kind."""
    middle, last = panels.panels // 2, panels.panels - 1
    return {
        "central": (0, 0),
        "central, its neighbour": (0, 1),
        "central, last": (0, last),
        "central, tail": (0, TAIL),
        "same": (middle, middle),
        "neighbours": (middle, middle + 1),
        "next but one": (middle - 1, middle + 1),
        "last": (last, last),
        "last, tail": (last, TAIL),
        "tail": (TAIL, TAIL),
    }


def compare(panels: LogPanels, first: int, second: int) -> Iterator[dict]:
    """Yield the entries of a pair of panels, by the library and by the oracle."""
    numbers = dict.fromkeys((first, second))
    degrees = {n: (0, panels.tail_terms - 1 if n == TAIL else panels.degree) for n in numbers}
    pieces = {n: basis(panels, n, degrees[n]) for n in numbers}
    places = [rows(panels, n, degrees[n]) for n in (first, second)]
    coarse, exact = (entries(pieces[first], pieces[second], rule) for rule in (FINE, FINER))
    disk = disk_operators(panels)
    for k, (kernel, operator) in enumerate((("K1", disk.normal), ("K2", disk.tangential))):
        for (a, i), (b, j) in product(*map(enumerate, places)):
            if i > j:  # the matrices are symmetric
                continue
            double, value = float(operator.gram[i, j]), exact[k][a, b]
            scale = mp.sqrt(mp.mpf(operator.gram[i, i]) * mp.mpf(operator.gram[j, j]))
            doubt = abs(value - coarse[k][a, b]) / scale
            yield {
                "kernel": kernel,
                "row": i,
                "column": j,
                "mpmath": mp.nstr(value, 30),
                "double": double.hex(),
                "ulp": float((double - value) / (EPS * scale)),
                "digits": float(-mp.log10(max(doubt, mp.eps))),
            }


def study() -> dict:
    """Run the study and return its record."""
    found, begin = [], perf_counter()
    for mesh, panels in MESHES.items():
        for case, pair in cases(panels).items():
            found += [{"mesh": mesh, "case": case} | entry for entry in compare(panels, *pair)]
            if sys.stderr.isatty():
                line = f"\r{len(found)} entries, {perf_counter() - begin:.0f} s"
                print(line, end="", file=sys.stderr)
    return {
        "schema": "spectral_contact.validation.projections",
        "version": 1,
        "library": __version__,
        "working_digits": mp.dps,
        "seconds": perf_counter() - begin,
        "meshes": {mesh: asdict(panels) for mesh, panels in MESHES.items()},
        "entries": found,
    }


def table(record: dict) -> str:
    """Return the record as a Markdown table."""
    found = record["entries"]

    def figures(some: list[dict]) -> str:
        ulp = (max(abs(e["ulp"]) for e in some if e["kernel"] == kernel) for kernel in ("K1", "K2"))
        worst = " | ".join(f"{u:.2f}" for u in ulp)
        return f"{len(some)} | {worst} | {min(e['digits'] for e in some):.1f}"

    lines = [
        f"{len(found)} entries on {len(record['meshes'])} meshes of the solver. One ulp is "
        "$2^{-52}\\sqrt{A_{ii}A_{jj}}$, and digits count from $\\sqrt{A_{ii}A_{jj}}$.",
        "",
        "| panels | entries | largest difference, K1, ulp | K2, ulp | mpmath digits, at least |",
        "|---|---|---|---|---|",
    ]
    for case in dict.fromkeys(e["case"] for e in found):
        lines.append(f"| {case} | {figures([e for e in found if e['case'] == case])} |")
    lines += [
        "",
        "| mesh: compliance, form | panels | degree | entries | K1, ulp | K2, ulp | digits |",
        "|---|---|---|---|---|---|---|",
    ]
    for mesh, panels in record["meshes"].items():
        some = figures([e for e in found if e["mesh"] == mesh])
        lines.append(f"| {mesh} | {panels['panels']} | {panels['degree']} | {some} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run the study and keep its results."""
    record = study()
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "projections.json").write_text(json.dumps(record, indent=1) + "\n")
    (RESULTS / "projections.md").write_text(table(record))
    print(table(record))


if __name__ == "__main__":
    main()
