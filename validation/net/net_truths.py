"""Compute the scenes and truths that the net keeps, by the code of one early commit.

Run as ``python validation/net/net_truths.py`` (some minutes); writes validation/net/kept.json.gz.
Draws and truths are those of honesty.py and coupled_slip_honesty.py at the commit `TRUTHS_OF`;
thresholds are listed here. Scenes whose truth does not come out are left out, and the next are
drawn. Slip that has just begun at the edge is narrower there than doubles knew at that commit: its
zones are those of `reference`, of the library as it is. The truths do not depend on the commit that
the net compares with, which ``python validation/net/net.py --rebase COMMIT`` changes.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

import itertools
import json
import math
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

sys.path.append(str(Path(__file__).parents[1] / "honesty"))


HERE = Path(__file__).parent
#: The commit that computed the truths.
TRUTHS_OF = "1534185287957ff4abdeca3ccefcf474e4770f6b"
COUNTS = {"uncoupled": 192, "coupled stick": 60, "coupled slip": 36, "coupled annuli": 12}
SEED, TRUE_RTOL = 1, 1e-12
#: At a threshold with coupling a tighter solve takes long to end in rounding.
COUPLED_RTOL = 1e-9
#: At that commit its boundaries differ between tolerances by ten times their estimates.
UNSURE = "coupled edge of 1e-10"
BEGUN = "edge onset, 1e-12", "edge onset, 1e-14"
Row = dict[str, Any]


def drawn(kind: str) -> Iterator[Row]:
    """Yield random scenes of a kind with their truths, without end."""
    import coupled_slip_honesty as slipping
    import honesty_scenes as drawing
    from net_kept import NEAR, kept_row, row_of, zones_row

    from spectral_contact import ConvergenceError, NotComputedError, solve

    for number in itertools.count():
        row: Row = {"kind": "coupled slip" if kind == "coupled annuli" else kind}
        try:
            if kind in ("uncoupled", "coupled stick"):
                scene, rtol = drawing.random_scene(SEED, number, kind == "coupled stick")
                row["truth"] = kept_row(drawing.true_solution(scene))
            else:
                draw = slipping.draw_annuli if kind == "coupled annuli" else slipping.draw
                scene, rtol = draw(number)
                truth = solve(scene, TRUE_RTOL, strict=False)
                if len(truth.zones) == 1 or not truth.error.zones < 0.01 * rtol:
                    continue
                row["truth"] = {
                    "sample": _sample(truth, NEAR),
                    "zones": zones_row(truth),
                    "zones_error": truth.error.zones,
                }
        except (ConvergenceError, NotComputedError):
            continue
        named = number + (1000 if kind == "coupled annuli" else 0)
        yield {"number": named, "scene": row_of(scene), "rtol": rtol} | row


def _sample(truth: Any, near: Any) -> Row:
    """Return the sample of a truth, its fields rounded."""
    from coupled_slip_errors import sample
    from net_kept import rounded

    row = asdict(sample(truth, near, centre=False))
    row["fields"] = {n: rounded(values) for n, values in row["fields"].items()}
    return row


def listed() -> Iterator[tuple[str, list[Any], float]]:
    """Yield scenes at thresholds: names, scenes as rows, tolerances."""
    from spectral_contact import Scene, solve

    nu, inf = 0.3, math.inf
    for k in range(5):
        f = 0.02941066 if k == 0 else 0.0294105 + 1e-7 * k
        yield f"second threshold, {k}", [nu, 0.05, 1.0, f, False], 1e-9
    third = 0.592739 / 7.0
    for shift in (-1e-2, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-2):
        row = [nu, 0.2, 0.5, third * (1.0 + shift), False]
        yield f"missing stick annulus, {shift:g}", row, 1e-3
    second = 0.08546448375462859
    for shift in (-1e-2, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-2):
        row = [nu, 0.2, 0.5, second * (1.0 + shift), True]
        yield f"coupled second threshold, {shift:g}", row, 1e-6
    for f in (1e-3, 1e-6, 1e-12, 1e-80):
        yield f"coupled little friction, {f:g}", [nu, 0.1, 0.1, f, True], 1e-6
    for f in (0.003, 0.01):
        yield f"coupled smooth little friction, {f:g}", [nu, 0.0, 0.0, f, True], 1e-6
    yield "coupled rounding", [0.0, 0.0, 0.0, 0.647468127, True], 1e-9
    almost = [
        0.3216563614452209,
        3.902806546943033,
        4.804038693556474e-12,
        14252.653932202149,
        True,
    ]
    yield UNSURE, almost, 1e-9
    divided = [0.0026911724429315997, 0.11389122079033816, 0.18100473323636496, 0.31113288558888375]
    yield "coupled division by zero", [*divided, True], 1e-6
    yield "coupled slow", [-0.9999992543677753, 0.0, 8.111e-12, 0.012363154, True], 1e-6
    tolerances = itertools.cycle((1e-3, 1e-6, 1e-9, 1e-12))
    for name, alpha, beta, coupling in (
        ("edge onset", 1.0, 0.5, False),
        ("inner onset", 0.05, 1.0, False),
        ("coupled edge onset", 1.0, 0.5, True),
        ("coupled inner onset", 0.05, 1.0, True),
    ):
        stick = Scene(nu, alpha, beta, inf, coupling=coupling)
        critical = solve(stick, 1e-12, ("critical_friction",), strict=False).critical_friction
        for k in (2, 4, 5, 6, 8, 10, 12, 14):
            row = [nu, alpha, beta, critical * (1.0 - 10.0**-k), coupling]
            yield f"{name}, 1e-{k}", row, next(tolerances)


def threshold(name: str, scene: list[Any], rtol: float) -> Row:
    """Return a scene at a threshold, with its zones where doubles know them."""
    from net_kept import scene_of, zones_row

    from spectral_contact import SpectralContactError, solve

    row = {"name": name, "scene": scene, "rtol": rtol, "zones": [], "slow": "slow" in name}
    tight = COUPLED_RTOL if scene[-1] else TRUE_RTOL
    try:
        truth = None if row["slow"] else solve(scene_of(scene), tight, strict=False)
    except (SpectralContactError, ArithmeticError):
        truth = None
    if truth is not None and truth.converged:
        row |= {"zones": zones_row(truth), "zones_error": truth.error.zones}
    print(name, bool(row["zones"]), file=sys.stderr, flush=True)
    return row


def keep() -> None:
    """Compute and store everything, with the library that is imported."""
    from net_kept import save

    rows = []
    for kind, count in COUNTS.items():
        for row in itertools.islice(drawn(kind), count):
            rows.append(row)
            print(len(rows), row["kind"], row["number"], file=sys.stderr, flush=True)
    hard = json.loads((HERE.parent / "results" / "hard_cases.json").read_text(encoding="utf-8"))
    kept = {
        "truths_of": TRUTHS_OF,
        "honesty": rows,
        "thresholds": [threshold(*one) for one in listed()],
        "hard": {row["name"]: row["truth"] for row in hard["cases"]},
    }
    save(kept)


def sharpen() -> None:
    """Take the zones of slip that has just begun at the edge from `reference`."""
    from net_kept import KeptZone, load, save, scene_of

    from spectral_contact import reference

    kept = load()
    for row in kept["thresholds"]:
        if row["name"] in BEGUN:
            # no more than the width is used, of which some digits are left
            found = reference(scene_of(row["scene"]), 15)
            ends = KeptZone._fields[1:]
            row["zones"] = [
                [z.kind, *(float(getattr(z, end)) for end in ends)] for z in found.zones
            ]
            row["zones_error"] = float(found.error.zones)
            print(row["name"], row["zones"], row["zones_error"], file=sys.stderr, flush=True)
        if row["name"] == UNSURE:
            row["zones"] = []
    save(kept)


def main() -> None:
    """Run this file once more, with the library of the commit, then sharpen."""
    from net_commit import checked_out

    with TemporaryDirectory() as folder:
        old = checked_out(Path(folder), TRUTHS_OF)
        paths = [old, old / "validation", HERE]
        path = os.pathsep.join(map(str, paths))
        code = "import net_truths; net_truths.keep()"
        # -P: nothing comes before the paths that are given
        command = [sys.executable, "-P", "-c", code]
        subprocess.run(command, check=True, env=os.environ | {"PYTHONPATH": path})
    sharpen()


if __name__ == "__main__":
    main()
