"""The faults of ../validation/mutants are those of lines that are there."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
TABLE = runpy.run_path(str(ROOT / "validation" / "mutants" / "mutants_table.py"))


@pytest.mark.parametrize(("name", "least"), [("MUTANTS", 30), ("SURVIVORS", 0)])
def test_every_fault_is_of_a_text_that_is_there_once(name, least):
    assert len(TABLE[name]) >= least
    for one in TABLE[name]:
        assert (ROOT / one.file).read_text(encoding="utf-8").count(one.old) == 1, one.fault


def test_a_survivor_is_of_the_core_and_no_mutant():
    killed = {(one.file, one.old, one.new) for one in TABLE["MUTANTS"]}
    for one in TABLE["SURVIVORS"]:
        assert one.file.split("/")[1] in ("contact", "spectral")
        assert (one.file, one.old, one.new) not in killed
