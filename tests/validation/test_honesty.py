"""The strata of validation/honesty run, a scene or two of each, and write what they measured."""

import importlib
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

VALIDATION = Path(__file__).parents[2] / "validation"
HONESTY = VALIDATION / "honesty"
#: Strata of which a scene takes a second or a few.
SHORT = ("profiles", "layers", "bent_layers", "lines", "curves", "coupled_slip", "adhesion")


@pytest.fixture(scope="module", autouse=True)
def modules():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(HONESTY))
        yield
    for path in HONESTY.glob("*.py"):  # names such as profiles are no others' then
        sys.modules.pop(path.stem, None)


@pytest.fixture
def strata(monkeypatch, tmp_path):
    found = importlib.import_module("strata")
    monkeypatch.setattr(found, "RESULTS", tmp_path)
    return found


@pytest.mark.parametrize("name", SHORT)
def test_a_scene_of_each_stratum_is_within_its_estimates(name, strata, tmp_path):
    honesty = importlib.import_module("honesty")
    assert honesty.main([name, "--scenes", "1", "--seed", "3"]) == 0
    page = (tmp_path / f"honesty_{name}.md").read_text(encoding="utf-8")
    assert re.search(r"^1 random scenes, seed 3, by validation/honesty/", page, re.M)
    rows = re.findall(r"^\| [a-z -]+ \| ([0-9.e-]+) \| [0-9.e-]+ \| 0 \|$", page, re.M)
    assert len(rows) >= 2
    assert max(map(float, rows)) <= 1.0


def made_up(rng, number):
    """Return an outcome, or refuse a scene."""
    if number == 1:
        raise ArithmeticError("refused")
    ratios = {"load": (0.5, None, 1.5)[number], "work": 0.25}
    return importlib.import_module("strata").Outcome(ratios, "a scene", converged=number == 0)


def test_errors_above_their_estimates_and_refusals_are_counted(strata, tmp_path, capsys):
    given = {"refusals": ["ArithmeticError"], "refused": "{} unknown"}
    stratum = strata.Stratum("made_up", __name__, "Title", 3, **given)
    assert strata.run(stratum, 3, 1)
    page = (tmp_path / "honesty_made_up.md").read_text(encoding="utf-8")
    assert "1 scenes did not meet their tolerance and said so; 1 unknown." in page
    assert "| load | 1.5 | 1 | 1 |\n| work | 0.25 | 0.25 | 0 |" in page
    assert "- load 1.50, scene 2: a scene\n- not met: scene 2: a scene" in page
    assert "load 1.50, scene 2" in capsys.readouterr().out
    with pytest.raises(ArithmeticError):  # what is no refusal is an error of the study
        strata.run(strata.Stratum("made_up", __name__, "Title", 3), 3, 1)


@pytest.mark.parametrize(("ratio", "failed"), [(1.0, False), (1.01, True), (math.nan, True)])
def test_what_is_no_number_is_a_violation(strata, monkeypatch, ratio, failed):
    outcome = strata.Outcome({"x": ratio}, "")
    monkeypatch.setattr(sys.modules[__name__], "drawn", lambda rng, number: outcome)
    assert strata.run(strata.Stratum("drawn", __name__, ""), 1, 1) is failed


def test_a_run_without_a_scene_that_is_compared_fails(strata, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "drawn", lambda rng, number: None)
    assert strata.run(strata.Stratum("drawn", __name__, ""), 2, 1)


def drawn(rng, number):
    """Return an outcome with a random number."""
    return importlib.import_module("strata").Outcome({"x": float(rng.random())}, "")


def test_scenes_have_one_generator_or_each_their_own(strata):
    for key in (None, [], [1]):
        stratum = strata.Stratum("drawn", __name__, "", 4, key)
        found = [one.ratios["x"] for one in stratum.outcomes(7, 4, 1)]
        if key is None:
            assert found == np.random.default_rng(7).random(4).tolist()
        else:
            assert found == [np.random.default_rng([7, n, *key]).random() for n in range(4)]


def test_every_stratum_has_a_function_and_without_one_they_are_listed(strata):
    known = strata.strata()
    for name, stratum in known.items():
        module = importlib.import_module(stratum.module)
        assert callable(getattr(module, name if stratum.scenes else "main"))
        assert set(stratum.refusals) <= set(strata.REFUSALS)
    command = [sys.executable, str(HONESTY / "honesty.py"), "nothing"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert [line.split()[0] for line in run.stdout.splitlines()] == list(known)
