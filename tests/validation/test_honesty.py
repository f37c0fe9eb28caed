"""The strata of validation/honesty run, a scene or two of each, and write what they measured."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

VALIDATION = Path(__file__).parents[2] / "validation"
HONESTY = VALIDATION / "honesty"
#: Strata whose scenes are solved again or swept in a second or two.
SHORT = ("profiles", "layers", "bent_layers", "lines", "curves")


@pytest.fixture(scope="module", autouse=True)
def modules():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(HONESTY))
        yield
    for path in HONESTY.glob("*.py"):  # names such as profiles are no others' then
        sys.modules.pop(path.stem, None)


@pytest.fixture
def honesty_table(monkeypatch, tmp_path):
    found = importlib.import_module("honesty_table")
    monkeypatch.setattr(found, "RESULTS", tmp_path)
    return found


@pytest.mark.parametrize("name", SHORT)
def test_a_scene_of_each_stratum_is_within_its_estimates(name, honesty_table, tmp_path):
    honesty = importlib.import_module("honesty")
    assert honesty.main([name, "--scenes", "1", "--seed", "3"]) == 0
    page = (tmp_path / f"honesty_{name}.md").read_text(encoding="utf-8")
    assert re.search(r"^1 random scenes, seed 3, by validation/honesty/", page, re.M)
    rows = re.findall(r"^\| [a-z ]+ \| ([0-9.e-]+) \| [0-9.e-]+ \| 0 \|$", page, re.M)
    assert len(rows) >= 2
    assert max(map(float, rows)) <= 1.0


def test_errors_above_their_estimates_and_refusals_are_counted(honesty_table, tmp_path, capsys):
    def measure(rng, number):
        if number == 1:
            raise KeyError("refused")
        shares = {"load": (0.5, None, 1.5)[number], "work": 0.25}
        return honesty_table.Outcome(shares, "a scene", converged=number == 0)

    outcomes = honesty_table.in_turn(measure, (KeyError,))
    stratum = honesty_table.Stratum("Title", 3, outcomes, refused="{} unknown")
    assert honesty_table.run("made_up", stratum, 3, 1, 1)
    page = (tmp_path / "honesty_made_up.md").read_text(encoding="utf-8")
    assert "1 scenes did not meet their tolerance and said so; 1 unknown." in page
    assert "| load | 1.5 | 1 | 1 |\n| work | 0.25 | 0.25 | 0 |" in page
    assert "- load 1.50, scene 2: a scene\n- not met: scene 2: a scene" in page
    assert "load 1.50, scene 2" in capsys.readouterr().out


def test_every_stratum_has_a_module_and_without_one_they_are_listed():
    strata = importlib.import_module("honesty").STRATA
    assert all((HONESTY / f"{module}.py").is_file() for module, _ in strata.values())
    command = [sys.executable, str(HONESTY / "honesty.py"), "nothing"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert [line.split()[0] for line in run.stdout.splitlines()] == list(strata)
