"""The faults of ../validation/mutants are in lines that are there, and short tests see them."""

import json
import sys
import tomllib
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "validation" / "mutants"))

import mutants

ROOT = Path(__file__).parents[2]
TABLE = tomllib.loads((ROOT / "validation" / "mutants" / "mutants.toml").read_text("utf-8"))


def test_every_fault_is_of_a_text_that_is_there_once():
    assert len(TABLE["mutant"]) > 30
    for one in (*TABLE["mutant"], *TABLE["survivor"]):
        text = (ROOT / one["file"]).read_text(encoding="utf-8")
        assert text.count(one["old"]) == 1, one["fault"]
    names = [one["fault"] for one in (*TABLE["mutant"], *TABLE["survivor"])]
    assert len(set(names)) == len(names)


def test_a_survivor_is_of_the_core_and_no_mutant():
    killed = {(one["file"], one["old"], one["new"]) for one in TABLE["mutant"]}
    for one in TABLE["survivor"]:
        assert one["file"].split("/")[1] in ("contact", "spectral")
        assert (one["file"], one["old"], one["new"]) not in killed


def test_nine_of_ten_faults_are_detected_without_the_extended_tests():
    """For most faults `python -m pytest` runs the test, or some cases of it, that detected them."""
    extended = tomllib.loads((ROOT / "tests" / "extended.toml").read_text("utf-8"))
    found = json.loads((ROOT / "validation" / "results" / "mutants.json").read_text("utf-8"))
    moved = []
    for row in found["rows"]:
        file, _, name = row["killer"].partition("::")
        if extended.get(f"tests/{file}", {}).get(name) == []:
            moved.append(row)
    assert len(found["rows"]) > 30
    assert len(moved) <= 0.1 * len(found["rows"])
    # `mutants.py` runs an extended test if it is told to
    assert all("-m extended" in row["tests"] for row in moved)


@pytest.mark.parametrize(
    ("test", "killer", "complaint"),
    [
        ("def test_it(): assert ONE == 1", "test_it", ""),
        ("def test_it(): assert ONE > 0", "", "lives"),
        (
            "@pytest.fixture\ndef one(): assert ONE == 1\n\ndef test_it(one): pass",
            "test_it",
            "",
        ),
        ("assert ONE == 1\n\ndef test_it(): pass", "", "cannot be run"),
    ],
    ids=["fails", "passes", "its fixture fails", "its module cannot be imported"],
)
def test_a_test_notices_a_fault_if_it_fails_or_its_fixture(
    test, killer, complaint, tmp_path, monkeypatch
):
    (tmp_path / "number.py").write_text("ONE = 1\n", encoding="utf-8")
    module = tmp_path / "test_number.py"
    module.write_text(f"import pytest\nfrom number import ONE\n\n{test}\n", encoding="utf-8")
    monkeypatch.setattr(mutants, "REPOSITORY", tmp_path)
    fault = mutants.Mutant("one is two", "number.py", "ONE = 1", "ONE = 2", module.name)
    outcome = mutants.tried(fault, tmp_path)
    assert outcome.killer == (f"{module.name}::{killer}" if killer else "")
    assert complaint in outcome.complaint
    assert (outcome.complaint == "") == (complaint == "")
    assert (tmp_path / "number.py").read_text(encoding="utf-8") == "ONE = 1\n"


def test_a_row_is_kept_for_the_same_fault_alone(monkeypatch):
    """A row says which test found one text in place of another, and nothing of other texts."""
    one = mutants.Mutant("one is two", "number.py", "ONE = 1", "ONE = 2", "test_number.py")
    changed = one._replace(fault="two is three", old="TWO = 2", new="TWO = 3")
    new = one._replace(fault="three is four", old="THREE = 3", new="THREE = 4")
    kept = one._asdict() | {"killer": "test_one"}
    stale = changed._replace(old="TWO = 1 + 1")._asdict() | {"killer": "test_two"}
    written = {}
    monkeypatch.setattr(mutants, "chosen", lambda words: [one, changed, new])
    monkeypatch.setattr(mutants, "stored", lambda name: {"rows": [kept, stale]})
    monkeypatch.setattr(mutants, "write", lambda name, text, record: written.update(record))
    mutants.report([new], [mutants.Outcome("", "lives", 1.0)])
    assert written["rows"] == [kept, new._asdict() | {"killer": ""}]
    assert written["survivors"] == ["three is four"]
