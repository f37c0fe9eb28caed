"""The faults of ../validation/mutants are those of lines that are there."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[3]


def test_every_fault_is_of_a_text_that_is_there_once():
    mutants = runpy.run_path(str(ROOT / "validation" / "mutants" / "mutants_table.py"))["MUTANTS"]
    assert len(mutants) > 30
    for one in mutants:
        assert (ROOT / one.file).read_text(encoding="utf-8").count(one.old) == 1, one.fault
