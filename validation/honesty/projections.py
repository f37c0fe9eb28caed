"""Compare entries of the Galerkin matrices with double integrals of the elliptic kernels.

Run as ``python validation/honesty/projections.py``; writes validation/results/projections.json and
.md. The matrices are those of the solver at a tolerance of 1e-12
(tests/oracles/projection_cases.py): on disks, on a stick annulus and between it and its stick disk,
and the right-hand side of the endpoint lift. Pairs of panels of every kind give the entries of the
lowest and the highest degree. The oracle is mpmath, tests/oracles/projection_oracle.py; it shares
no code with the library. It computes every entry with two densities of its rules and keeps the
denser; to how many digits they agree is the accuracy of the other. Differences and digits are
relative to ``sqrt(A_ii A_jj)``, the scale of the Cholesky factor: entries between distant panels of
high degree are themselves far smaller.

A run that was stopped goes on where it was: of every pair of panels, whose entries share their
points, the result is kept in validation/results/projections.partial until the tables are written.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.projection_cases import TAIL, Case, disk_case, interior_slip, lift_case
from oracles.projection_oracle import FINE, FINER, mp
from reporting import RESULTS, resumed, table, write

from spectral_contact import __version__
from spectral_contact.contact.resolution import graded_space
from spectral_contact.spectral.panels import DiscreteSpace

PARTIAL = RESULTS / "projections.partial"
TOLERANCE = 1e-12
EPS = 2.0**-52

SOFT, THIN = (graded_space(-math.log(layer), TOLERANCE) for layer in (0.5, 1e-6))
MESHES = {
    "0.5, plain": SOFT,
    "1e-6, plain": THIN,
    "1e-6, weight": THIN._replace(panels=replace(THIN.panels, power=-0.5)),
    # half-integer powers fall too slowly to taper panels above a root tail
    "1e-6, root tail": DiscreteSpace(
        replace(THIN.panels, count=12, root_tail=True), (*THIN.degrees[:11], THIN.degrees[0])
    ),
}
LIFTED = 1e-6
NOTE = (
    "The solver itself does not use K1 with a weight or a root tail. Differences above 10 ulp "
    "belong to degree 0 beside a high degree. Where they were traced, to the central panel's "
    "neighbour and to the root tail, a nearly constant kernel leaves an ulp or less of itself in "
    "the high degree, of one sign at all points, because the Gauss nodes and what is made of them "
    "are rounded."
)


def pairs(degrees: tuple[int, ...]) -> dict[str, tuple[int, int]]:
    """Return pairs of panels of every kind; the panel away from the ends has a high degree."""
    last = len(degrees) - 1
    peak = int(np.argmax(degrees[1 : last - 1])) + 1
    return {
        "central": (0, 0),
        "central, its neighbour": (0, 1),
        "central, last": (0, last),
        "central, tail": (0, TAIL),
        "same": (peak, peak),
        "neighbours": (peak, peak + 1),
        "far": (peak, peak + 2),
        "last": (last, last),
        "last, tail": (last, TAIL),
        "tail": (TAIL, TAIL),
    }


def cases() -> Iterator[tuple[str, str, Callable[[], Case]]]:
    """Yield mesh, class and how to get the case."""
    for mesh, resolution in MESHES.items():
        for name, pair in pairs(resolution.degrees).items():
            yield mesh, name, partial(disk_case, resolution, *pair)
    resolution = MESHES["1e-6, plain"]
    degrees = resolution.degrees
    for number in (0, int(np.argmax(degrees)), len(degrees) - 1, TAIL):
        place = "tail" if number == TAIL else "last" if number == len(degrees) - 1 else "panel"
        name = "lift, " + ("central" if number == 0 else place)
        yield "1e-6, plain", name, partial(lift_case, resolution, LIFTED, number)
    zones = interior_slip()
    last = [len(zones.half(half).degrees) - 1 for half in (0, 1)]
    for name, one, two in (
        ("annulus, same", (0, 1), (0, 1)),
        ("annulus, neighbours", (0, 1), (0, 2)),
        ("annulus, far", (0, 1), (0, 4)),
        ("annulus, at the middle", (0, 0), (1, 0)),
        ("annulus, across the middle", (0, 2), (1, 2)),
        ("annulus, inner tail", (0, TAIL), (0, TAIL)),
        ("annulus, last and inner tail", (0, last[0]), (0, TAIL)),
        ("annulus, last at the edge", (1, last[1]), (1, last[1])),
        ("annulus, last and edge tail", (1, last[1]), (1, TAIL)),
        ("annulus, edge tail", (1, TAIL), (1, TAIL)),
        ("annulus, both tails", (0, TAIL), (1, TAIL)),
    ):
        yield "stick annulus", name, partial(zones.annulus_case, one, two)
    for number, other in ((0, (0, 0)), (1, (1, 0)), (TAIL, (0, TAIL)), (TAIL, (1, TAIL))):
        yield "stick annulus", "disk and annulus", partial(zones.cross_case, number, other)


def compared(make: Callable[[], Case]) -> list[dict]:
    """Return the entries of a case, by the library and by the oracle."""
    case = make()
    coarse, exact = case.exact(FINE), case.exact(FINER)
    found = []
    for kernel, (block, left, right) in case.doubles.items():
        same = case.places[0] == case.places[1]
        for a, i in enumerate(case.places[0]):
            for b, j in enumerate(case.places[1]):
                if same and i > j:  # the matrices are symmetric
                    continue
                double, value = float(block[a, b]), exact[kernel][a, b]
                scale = mp.mpf(left[a]) * mp.mpf(right[b])
                doubt = abs(value - coarse[kernel][a, b]) / scale
                found.append(
                    {
                        "kernel": kernel,
                        "row": i,
                        "column": j,
                        "mpmath": mp.nstr(value, 30),
                        "double": double.hex(),
                        "ulp": float((double - value) / (EPS * scale)),
                        "digits": float(-mp.log10(max(doubt, mp.mpf(10) ** -40))),
                    }
                )
    return found


def study() -> dict:
    """Run the study and return its record."""
    version = f"{__version__} {FINE} {FINER}"
    named = {f"{version} {i} {one[0]}: {one[1]}": one for i, one in enumerate(cases())}
    done = resumed(PARTIAL, {key: partial(compared, case) for key, (_, _, case) in named.items()})
    found = [
        {"mesh": mesh, "case": name} | entry
        for key, (mesh, name, _) in named.items()
        for entry in done[key]
    ]
    return {
        "count": len(found),
        "densities": [FINE, FINER],
        "working_digits": mp.dps,
        "meshes": {
            mesh: {"panels": asdict(r.panels), "degrees": r.degrees} for mesh, r in MESHES.items()
        },
        "entries": found,
    }


def page(record: dict) -> str:
    """Return the record as Markdown."""
    found = record["entries"]
    about = (
        f"{record['count']} entries. One ulp is $2^{{-52}}\\sqrt{{A_{{ii}}A_{{jj}}}}$, and digits "
        "count from $\\sqrt{A_{ii}A_{jj}}$; more than 40 are not told apart."
    )
    parts = [about, NOTE]
    for column, title in (("case", "panels"), ("mesh", "mesh: layer, form")):
        cells = []
        for key in dict.fromkeys((e[column], e["kernel"]) for e in found):
            some = [e for e in found if (e[column], e["kernel"]) == key]
            ulp, digits = max(abs(e["ulp"]) for e in some), min(e["digits"] for e in some)
            cells.append((*key, len(some), f"{ulp:.1f}", f"{digits:.1f}"))
        heading = "kernel | entries | largest difference, ulp | mpmath digits, at least"
        parts.append(table(f"{title} | {heading}", cells))
    return "\n\n".join(parts)


def main() -> None:
    """Run the study and keep its results."""
    record = study()
    write("projections", page(record), record)
    PARTIAL.unlink()


if __name__ == "__main__":
    main()
