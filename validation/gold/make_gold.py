"""Make the gold tables.

Run as ``python validation/gold/make_gold.py [--workers N] [--digits N] [table ...]``.

The scenes are those of the tables, one JSON file a table in validation/gold/tables, which is a link
to spectral_contact/gold/tables; docs/gold.md describes them. A table is written anew after every
scene, and scenes whose numbers are of this library's version and have as many digits are kept: a
run that was stopped goes on. One scene takes half a minute to some minutes.

``--add FILE ...`` adds scenes to one table, each as `Scene.to_json` has it; a new table needs
``--regime TEXT``, too. ``--output FOLDER`` makes tables again, in another folder, and says for
every scene how its numbers differ from those in the tables.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from time import perf_counter
from typing import Any

from mpmath import mp

from spectral_contact import ConvergenceError, Scene, __version__, gold
from spectral_contact.io.documents import replace_file
from spectral_contact.io.kinds import kind_tree
from spectral_contact.precise import reference
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.records import PROFILE_QUANTITIES

sys.path.insert(0, str(Path(__file__).parent))

import precise_unloading

TABLES = Path(__file__).parents[2] / "spectral_contact" / "gold" / "tables"
SCHEMA, VERSION, SCRIPT = "spectral_contact.gold", 1, "validation/gold/make_gold.py"
SIDES = ("inner", "outer", "inner_from_edge", "outer_from_edge")
FIELDS = ("pressure", "traction")
DIGITS = 27
LARGEST_ERROR = 1e-25
#: The first unloading takes two to five times as long, and fewer digits are asked for.
UNLOADED_DIGITS = 18


def named(scene: Scene) -> str:
    """Return the parameters as a name."""
    text = f"nu={scene.poisson_ratio:g} alpha={scene.normal_compliance:g}"
    if scene.profile is not None:
        given = {name: getattr(scene, name) for name in CONTROLS}
        told = " ".join(f"{name}={value:g}" for name, value in given.items() if value is not None)
        law = "" if scene.layer is None else f"{scene.layer.brief} "
        if scene.work_of_adhesion is not None:
            law = f"w={scene.work_of_adhesion:g} branch={scene.branch} "
        return f"{text} {law}{scene.profile.brief} {told}"
    if scene.friction is None:
        return text
    text += f" beta={scene.tangential_compliance:g} f={scene.friction:.9g}"
    if scene.unloaded_to < 1.0:
        text += f" unloaded_to={scene.unloaded_to:g}"
    return f"{text} coupled" if scene.coupling else text


def depths(solution: Any) -> list[float]:
    """Return distances to the edge: decades, eighths, the edge, and around zone boundaries."""
    found = {0.0, *(k / 8 for k in range(1, 9)), *(float(f"1e-{k}") for k in range(1, 13))}
    for zone in solution.zones[:-1]:
        odds = zone.outer_from_edge / zone.outer
        found |= {float(odds * k / (1 + odds * k)) for k in (0.5, 0.9, 1.1, 2)}
    if solution.scene.couples and mp.isnan(solution.pressure(from_edge=0.0)):
        found.remove(0.0)  # where the fields have no limit
    return sorted(found, reverse=True)


def double(value: float | None) -> Any:
    """Return an input: hexadecimal for exactness, decimal for reading."""
    return None if value is None else {"hex": value.hex(), "decimal": repr(value)}


def inputs(scene: Scene) -> dict[str, Any]:
    """Return what a scene is made of; coupling only where it is."""
    names = "poisson_ratio", "normal_compliance", "tangential_compliance", "friction"
    values = {name: double(getattr(scene, name)) for name in names}
    if scene.profile is not None:
        given = {name: double(getattr(scene, name)) for name in CONTROLS}
        law: dict[str, Any] = {} if scene.layer is None else {"layer": kind_tree(scene.layer)}
        if scene.work_of_adhesion is not None:
            law = {"work_of_adhesion": double(scene.work_of_adhesion), "branch": scene.branch}
        return {**values, "profile": kind_tree(scene.profile), **law, **given}
    if scene.unloaded_to < 1.0:
        values["unloaded_to"] = double(scene.unloaded_to)
    return {**values, "coupling": True} if scene.coupling else values


def digits_of(scene: Scene, digits: int) -> int:
    """Return how many of the digits asked for are computed."""
    return min(digits, UNLOADED_DIGITS) if scene.unloaded_to < 1.0 else digits


def solved(scene: Scene, digits: int) -> dict[str, Any]:
    """Return the entry of a scene; of the first unloading with `UNLOADED_DIGITS` at most."""
    unloaded_below = scene.unloaded_to < 1.0
    digits = digits_of(scene, digits)
    try:
        solution = (precise_unloading.reference if unloaded_below else reference)(scene, digits)
    except ConvergenceError as error:  # some digits less may do
        solution = error.solution
        if solution is None:
            raise

    def text(value: Any) -> str | None:
        if value is None or mp.isinf(value):
            return None if value is None else str(float(value))
        return mp.nstr(value, digits + 3, strip_zeros=False) if value else "0"

    at = depths(solution)
    pressure, traction = solution.pressure(from_edge=at), solution.traction(from_edge=at)
    error = solution.error
    errors = {
        name: getattr(error, name)
        for name in ("approach", "total_shear", "zones", "edge_ratio", "pressure", "traction")
    }
    pressed = PROFILE_QUANTITIES if scene.profile is not None else ()
    errors |= {name: getattr(error, name) for name in pressed}
    if scene.friction is None:  # zeros by definition, and no zones
        errors |= {"total_shear": 0.0, "zones": 0.0, "traction": 0.0}
    worst = max(e for e in errors.values() if e is not None)
    if not worst <= (10.0**-digits if unloaded_below else LARGEST_ERROR):
        raise ConvergenceError(f"the error is {worst:.1e}", "leave the scene out")
    coupled = {"opening": text(solution.opening)} if scene.coupling else {}
    return {
        "name": named(scene),
        "scene": inputs(scene),
        "library": __version__,
        "digits": digits,
        "approach": text(solution.approach),
        "total_shear": text(solution.total_shear),
        "zones": [
            {"kind": zone.kind}
            | {side: text(getattr(zone, side)) for side in SIDES}
            | ({"sense": zone.sense, "memory": zone.memory} if unloaded_below else {})
            for zone in solution.zones
        ],
        "edge_ratio": text(solution.edge_ratio),
        **coupled,
        **{name: text(getattr(solution, name)) for name in pressed},
        "points": [
            {"from_edge": double(e), "pressure": text(p), "traction": text(q)}
            for e, p, q in zip(at, pressure, traction, strict=True)
        ],
        "error": errors,
    }


def layout(value: Any, indent: str = "") -> str:
    """Return JSON text in which what fits a line is one."""
    text = json.dumps(value, allow_nan=False)
    if not isinstance(value, (dict, list)) or len(text) <= 240:
        return text
    more = indent + " "
    if isinstance(value, dict):
        lines = [f"{more}{json.dumps(key)}: {layout(item, more)}" for key, item in value.items()]
    else:
        lines = [more + layout(item, more) for item in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{opening}\n" + ",\n".join(lines) + f"\n{indent}{closing}"


def numbers(entry: dict[str, Any]) -> dict[str, tuple[float, str]]:
    """Return the numbers of an entry by what they are, each with the relative error of its kind."""
    error = entry["error"]
    names = "approach", "total_shear", "edge_ratio", *PROFILE_QUANTITIES
    found = {name: (error[name], entry[name]) for name in names if name in entry}
    for k, zone in enumerate(entry["zones"]):
        found |= {f"zone {k} {zone['kind']} {side}": (error["zones"], zone[side]) for side in SIDES}
    for point in entry["points"]:
        at = point["from_edge"]["hex"]
        found |= {f"{name} at {at}": (error[name], point[name]) for name in FIELDS}
    return {name: (size, value) for name, (size, value) in found.items() if value is not None}


def difference(entry: dict[str, Any], other: dict[str, Any] | None) -> str:
    """Return in words how two entries of a scene differ."""
    if other is None:
        return "new"
    mine, its = numbers(entry), numbers(other)
    if mine.keys() != its.keys():
        return "OTHER ZONES OR PLACES"
    worst, limit = mp.zero, mp.zero
    with mp.workdps(60):
        for name, (size, a) in mine.items():
            other_size, b = its[name]
            if a != b:
                shift = abs(mp.mpf(a) / mp.mpf(b) - 1) if mp.mpf(b) else mp.inf
                worst, limit = max(worst, shift), max(limit, shift / (size + other_size))
    return f"off by {float(worst):.0e}, {float(limit):.1g} of the errors"


class Table:
    """One file: the scenes that it is to have, and its entries so far."""

    def __init__(
        self, name: str, folder: Path = TABLES, added: Sequence[Scene] = (), regime: str = ""
    ) -> None:
        self.path = folder / f"{name}.json"
        self.regime, self.scenes = regime, list(added)
        if (TABLES / f"{name}.json").exists():
            table = gold.load(TABLES / f"{name}.json")
            self.regime, self.scenes = table.regime, [one.scene for one in table.solutions]
            self.scenes += added
        self.entries: dict[str, dict[str, Any]] = {}
        if self.path.exists():
            document = json.loads(self.path.read_text(encoding="utf-8"))
            self.entries = {entry["name"]: entry for entry in document["scenes"]}

    def missing(self, digits: int) -> list[Scene]:
        """Return the scenes that have to be solved."""

        def there(scene: Scene) -> bool:
            entry = self.entries.get(named(scene))
            return (
                entry is not None
                and entry["library"] == __version__
                and entry["digits"] >= digits_of(scene, digits)
                and entry["scene"] == inputs(scene)
            )

        return [scene for scene in self.scenes if not there(scene)]

    def write(self, entry: dict[str, Any]) -> None:
        """Add an entry; the file is complete or as it was before."""
        self.entries[entry["name"]] = entry
        names = [named(scene) for scene in self.scenes]
        document = {
            "schema": SCHEMA,
            "version": VERSION,
            "table": self.path.stem,
            "regime": self.regime,
            "script": SCRIPT,
            "scenes": [self.entries[name] for name in names if name in self.entries],
        }
        replace_file(str(self.path), (layout(document) + "\n").encode())


def results(todo: list[tuple[Table, Scene]], digits: int, workers: int) -> Iterator[Any]:
    """Yield tables and scenes with their entries, or with what was raised, as they are ready."""
    pool = ProcessPoolExecutor(workers)
    try:
        running = {pool.submit(solved, scene, digits): (table, scene) for table, scene in todo}
        for future in as_completed(running):
            yield *running[future], future.exception() or future.result()
    finally:  # of an interrupt, too
        pool.shutdown(cancel_futures=True)


def main() -> int:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description="Make the gold tables.")
    known = sorted(path.stem for path in TABLES.glob("*.json"))
    parser.add_argument("tables", nargs="*", help=f"of {', '.join(known)}; default: all")
    parser.add_argument("--add", type=Path, nargs="+", default=[], help="scenes for one table")
    parser.add_argument("--regime", default="", help="what the scenes of a new table share")
    parser.add_argument("--digits", type=int, default=DIGITS, help="asked for, 26 and more")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--output", type=Path, default=TABLES, help="folder; default: the tables")
    options = parser.parse_args()
    if options.add and len(options.tables) != 1:
        parser.error("--add takes one table")
    unknown = set(options.tables) - set(known)
    if unknown and not (options.add and options.regime):
        parser.error(f"no such table: {', '.join(sorted(unknown))}; a new one needs --regime")
    added = [Scene.from_json(path.read_text(encoding="utf-8")) for path in options.add]
    options.output.mkdir(parents=True, exist_ok=True)
    names = options.tables or known
    tables = [Table(name, options.output, added, options.regime) for name in names]
    todo = [(table, scene) for table in tables for scene in table.missing(options.digits)]
    count = sum(len(table.scenes) for table in tables)
    done, failed, begin = count - len(todo), 0, perf_counter()
    print(f"{done} of {count} scenes are there", file=sys.stderr)
    for table, scene, outcome in results(todo, options.digits, options.workers):
        done += 1
        if isinstance(outcome, dict):
            before = Table(table.path.stem).entries.get(outcome["name"])
            told = f"{max(e for e in outcome['error'].values() if e is not None):.0e}, "
            told += difference(outcome, before)
            table.write(outcome)
        else:
            failed += 1
            told = f"LEFT OUT, {type(outcome).__name__}: {outcome}"
        line = f"{done}/{count} {perf_counter() - begin:6.0f} s  {table.path.stem}: {named(scene)}"
        print(f"{line}  {told}", file=sys.stderr, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
