"""The results of ../validation that are kept: of this version, of full size, no violations."""

import json
from pathlib import Path

import pytest

from spectral_contact import __version__

RESULTS = Path(__file__).parents[2] / "validation" / "results"


# groups are parts of all cases, quantities are seen in the same scenes
@pytest.mark.parametrize(
    ("study", "counted", "least", "total"),
    [("bad_inputs", "cases", 10_000, sum), ("honesty", "scenes", 800, max)],
)
def test_results_are_fresh_of_full_size_and_without_violations(study, counted, least, total):
    record = json.loads((RESULTS / f"{study}.json").read_text(encoding="utf-8"))
    assert record["schema"] == f"spectral_contact.validation.{study}"
    assert record["library"] == __version__
    assert record[counted] >= least
    assert record[counted] == total(group[counted] for group in record["summary"].values())
    assert record["violations"] == []
