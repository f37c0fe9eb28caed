"""The faults of ../validation/mutants are those of lines that are there."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]
TABLE = runpy.run_path(str(ROOT / "validation" / "mutants" / "mutants_table.py"))


def test_every_fault_is_of_a_text_that_is_there_once():
    assert len(TABLE["MUTANTS"]) > 30
    for one in (*TABLE["MUTANTS"], *(survivor.mutant for survivor in TABLE["SURVIVORS"])):
        assert (ROOT / one.file).read_text(encoding="utf-8").count(one.old) == 1, one.fault


def test_a_survivor_is_of_the_core_and_no_mutant():
    killed = {(one.file, one.old, one.new) for one in TABLE["MUTANTS"]}
    for one, _ in TABLE["SURVIVORS"]:
        assert one.file.split("/")[1] in ("contact", "spectral")
        assert (one.file, one.old, one.new) not in killed
