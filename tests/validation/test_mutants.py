"""The faults of ../validation/mutants are those of lines that are there."""

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
