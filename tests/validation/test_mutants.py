"""The faults of ../validation/mutants are in lines that are there, and short tests see them."""

import json
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
TABLE = tomllib.loads((ROOT / "validation" / "mutants" / "mutants.toml").read_text("utf-8"))


def test_every_fault_is_of_a_text_that_is_there_once():
    assert len(TABLE["mutant"]) > 30
    for one in (*TABLE["mutant"], *TABLE["survivor"]):
        text = (ROOT / one["file"]).read_text(encoding="utf-8")
        assert text.count(one["old"]) == 1, one["fault"]


def test_a_survivor_is_of_the_core_and_no_mutant():
    killed = {(one["file"], one["old"], one["new"]) for one in TABLE["mutant"]}
    for one in TABLE["survivor"]:
        assert one["file"].split("/")[1] in ("contact", "spectral")
        assert (one["file"], one["old"], one["new"]) not in killed


def test_what_detects_a_fault_is_not_for_a_release_alone():
    """What `python -m pytest` runs has the test, or some cases, that detected each fault."""
    extended = tomllib.loads((ROOT / "tests" / "extended.toml").read_text("utf-8"))
    found = json.loads((ROOT / "validation" / "results" / "mutants.json").read_text("utf-8"))
    killers = {row["killer"] for row in found["rows"]}
    assert len(killers) > 30
    moved = []
    for killer in killers:
        file, _, name = killer.partition("::")
        if extended.get(f"tests/{file}", {}).get(name) == []:
            moved.append(killer)
    assert moved == []
