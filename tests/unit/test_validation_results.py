"""The results of ../validation that are kept: of this version, of full size, no violations."""

import json
from pathlib import Path

import pytest

from spectral_contact import __version__

RESULTS = Path(__file__).parents[2] / "validation" / "results"


@pytest.mark.parametrize(("study", "counted", "least"), [("bad_inputs", "cases", 10_000)])
def test_results_are_fresh_of_full_size_and_without_violations(study, counted, least):
    record = json.loads((RESULTS / f"{study}.json").read_text(encoding="utf-8"))
    assert record["schema"] == f"spectral_contact.validation.{study}"
    assert record["library"] == __version__
    assert record[counted] >= least
    assert record[counted] == sum(group[counted] for group in record["summary"].values())
    assert record["violations"] == []
