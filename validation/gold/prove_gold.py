"""Enclose the approach of gold scenes: flat punches at their largest load, without coupling.

Run as ``python validation/gold/prove_gold.py``.

Writes the bounds, by `proof.enclose_approach` with 20 digits or as many as it has, into the gold
tables as ``approach_bounds``, and validation/results/proved_gold.md. Fails if the approach of a
table is not between its bounds.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from make_gold import TABLES, layout
from reporting import table, write

from spectral_contact import ConvergenceError, Scene, gold, proof
from spectral_contact.io.documents import replace_file


def enclosure(compliance: float) -> proof.Enclosure:
    """Return the interval of a compliance, of 20 digits where they are reached."""
    scene = Scene(0.3, compliance)
    try:
        return proof.enclose_approach(scene)
    except ConvergenceError as error:
        found: proof.Enclosure = error.solution
        return found


def is_provable(scene: Scene) -> bool:
    """Return whether there are bounds of the approach, and they are those of its compliance."""
    return scene.profile is None and not scene.couples and scene.unloaded_to == 1.0


def main() -> None:
    """Prove, and write tables and results."""
    tables = {table.name: table for table in gold.tables()}
    provable = [
        one.scene.normal_compliance
        for table in tables.values()
        for one in table.solutions
        if is_provable(one.scene)
    ]
    found = {compliance: enclosure(compliance) for compliance in sorted(set(provable))}
    outside = []
    for name, gold_table in tables.items():
        document = json.loads((TABLES / f"{name}.json").read_text(encoding="utf-8"))
        for position, one in enumerate(gold_table.solutions):
            if not is_provable(one.scene):
                continue
            proved = found[one.scene.normal_compliance]
            if one.approach not in proved:
                outside.append(f"{name}: {one.name}")
            entry = document["scenes"][position]
            entry.pop("approach_bounds", None)
            items = list(entry.items())
            place = list(entry).index("approach") + 1
            items.insert(place, ("approach_bounds", str(proved)[1:-1].split(", ")))
            document["scenes"][position] = dict(items)
        replace_file(str(TABLES / f"{name}.json"), (layout(document) + "\n").encode())
    if outside:
        sys.exit("not between the bounds: " + "; ".join(outside))
    scenes = Counter(provable)
    rows = [
        (
            f"{compliance:g}",
            scenes[compliance],
            proved,
            f"{proved.width:.1e}" if proved.terms else "exact",
            proved.terms or "closed form",
        )
        for compliance, proved in found.items()
    ]
    about = (
        f"{len(provable)} gold scenes of {len(found)} compliances: each approach is in its bounds."
    )
    heading = "α* | scenes | δ* is proved to be in | width over δ* | polynomials"
    write("proved_gold", f"{about}\n\n{table(heading, rows)}")


if __name__ == "__main__":
    main()
