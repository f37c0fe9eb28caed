"""``spectral-contact cycle``."""

import pytest

from spectral_contact import Scene, SteadyCycle, steady_cycle
from spectral_contact.__main__ import main

OPTIONS = ["cycle", "--lowest", "0.15", "--rtol", "1e-2"]


def test_it_prints_the_loop_and_writes_files(capsys, tmp_path):
    table, picture = tmp_path / "loop.csv", tmp_path / "loop.png"
    assert main([*OPTIONS, "--output", str(table), "--plot", str(picture)]) == 0
    told = capsys.readouterr().out
    own = steady_cycle(Scene(0.1, 0.5, 0.5, 0.1), 0.15, rtol=1e-2)
    assert told == own.summary() + "\n"
    assert picture.stat().st_size > 1000
    assert table.read_text().splitlines()[-1].startswith("1.0,")


def test_it_stores_the_loop(capsys, tmp_path):
    path = tmp_path / "loop.NPZ"
    assert main(["cycle", "--lowest", "0.9", "--rtol", "1e-2", "--output", str(path)]) == 0
    assert capsys.readouterr().out == f"{SteadyCycle.load(path)}\n"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "--lowest"),
        (["--lowest", "1.5"], "--lowest = 1.5"),
        (["--lowest", "0.5", "--unload-to", "0.3"], "does not support --unload-to below 1"),
        (["--lowest", "0.5", "--coupling"], "--coupling = True"),
        (["--lowest", "0.5", "--friction", "none"], "--friction = none"),
        (
            ["--lowest", "0.5", "--output", "loop.txt"],
            "must be one of .npz, .json, .csv",
        ),
        (
            ["--lowest", "0.5", "--profile", "sphere", "--radius", "1", "--load", "1"],
            "--profile",
        ),
    ],
)
def test_bad_input_is_one_line(options, said, capsys):
    assert main(["cycle", *options]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_a_tolerance_that_is_not_met(capsys):
    options = ["cycle", "--lowest", "0.2", "--max-unknowns", "40"]
    assert main(options) == 1
    assert "--no-strict" in capsys.readouterr().err
    assert main([*options, "--no-strict"]) == 0
    assert "converged: no" in capsys.readouterr().out


def test_si_units(capsys):
    steel = ["--youngs-modulus", "210 GPa", "--poisson-ratio", "0.3", "--radius", "5 mm"]
    joint = ["--load", "5 kN", "--normal-compliance-si", "5e-15", "--friction", "0.3"]
    assert main(["cycle", *steel, *joint, "--lowest", "0.9", "--rtol", "1e-2"]) == 0
    told = capsys.readouterr().out
    assert " J " in told
    assert "not given, and so left out: --tangential-compliance-si" in told
