"""Nonlinear layers on the command line."""

import pytest

from spectral_contact import Scene, Solution, layers, profiles
from spectral_contact.__main__ import main

BALL = ("--profile", "parabola", "--radius", "1", "--approach", "0.2", "--rtol", "1e-4")
POWER = ("--layer", "power-law", "--layer-coefficient", "5", "--layer-exponent", "2")


def run(capsys, *options):
    """Return the exit status, stdout and stderr."""
    status = main([*options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


LAWS = [
    (POWER[1:], layers.PowerLaw(5.0, 2.0)),
    (
        ("exponential", "--layer-zero-pressure", "1", "--layer-clearance", "0.1"),
        layers.Exponential(1.0, 0.1),
    ),
    (
        ("calculix", "--layer-zero-pressure", "1", "--layer-clearance", "0.1"),
        layers.CalculixExponential(1.0, 0.1),
    ),
    (
        (
            *("asperities", "--layer-density", "9", "--layer-tip-radius", "1"),
            *("--layer-height-deviation", "0.5", "--layer-heights", "exponential"),
        ),
        layers.GreenwoodWilliamson(9.0, 1.0, 0.5, "exponential"),
    ),
]


@pytest.mark.parametrize(("options", "law"), LAWS, ids=[one[0][0] for one in LAWS])
def test_a_law_makes_a_scene(capsys, tmp_path, options, law):
    path = tmp_path / "solution.json"
    status, out, err = run(capsys, "solve", *BALL, "--layer", *options, "--output", str(path))
    assert (status, err) == (0, "")
    assert law.brief in out
    assert Solution.load(path).scene == Scene(
        0.3, layer=law, profile=profiles.Parabola(1.0), approach=0.2
    )


def test_a_table_is_a_file(capsys, tmp_path):
    (tmp_path / "law.csv").write_text("# w, p\n0, 0\n0.1, 0.2\n0.3, 1\n1, 9\n")
    path = tmp_path / "solution.json"
    table = ("--layer", "table", "--layer-table", str(tmp_path / "law.csv"))
    status, _, err = run(capsys, "solve", *BALL[:-1], "1e-2", *table, "--output", str(path))
    assert (status, err) == (0, "")
    expected = layers.Table((0.0, 0.1, 0.3, 1.0), (0.0, 0.2, 1.0, 9.0))
    assert Solution.load(path).scene.layer == expected


def test_a_separation_from_the_command_line(capsys, tmp_path):
    path = tmp_path / "solution.json"
    law = ("--layer", "calculix", "--layer-zero-pressure", "1", "--layer-clearance", "0.1")
    punch = ("--profile", "parabola", "--radius", "1", "--separation=-0.1")
    status, out, err = run(capsys, "solve", *punch, *law, "--rtol", "1e-4", "--output", str(path))
    assert (status, err) == (0, "")
    assert "separation = -0.1" in out
    assert Solution.load(path).scene.separation == -0.1
    status, _, err = run(capsys, "solve", *punch[:4], "--separation", "0.1")
    assert status == 2
    assert "only a layer law without a contact edge" in err


def test_si_units_and_a_flat_punch(capsys):
    pytest.importorskip("pint", reason="part of the extra: units")
    body = ("--youngs-modulus", "200 GPa", "--poisson-ratio", "0.3", "--rtol", "1e-4")
    punch = ("--profile", "flat", "--radius", "1 mm", "--load", "100 N")
    law = ("--layer", "exponential", "--layer-zero-pressure", "10 MPa", "--layer-clearance", "1 um")
    status, out, err = run(capsys, "solve", *body, *punch, *law)
    assert (status, err) == (0, "")
    assert "Exponential(zero_pressure=10000000.0, clearance=1e-06) in Pa and m" in out
    assert "N/m" in out


def test_a_sweep_over_load_and_law(capsys, tmp_path):
    table = tmp_path / "a.csv"
    law = (*POWER[:-1], "1.5,2")
    ball = ("--profile", "parabola", "--radius", "1", "--load", "0.1:1:3:log", "--rtol", "1e-3")
    status, out, err = run(capsys, "sweep", *ball, *law, "--output", str(table))
    assert (status, err) == (0, "")
    assert "6 scenes: 6 converged" in out
    assert table.read_text().startswith("load,layer_exponent,")


FAULTS = [
    ((*BALL, "--layer", "exponential", "--layer-clearance", "1"), "needs --layer-zero-pressure"),
    (
        (*BALL, *POWER, "--layer-clearance", "1"),
        "--layer power-law does not take --layer-clearance",
    ),
    ((*BALL, *POWER[2:]), "give --layer, one of power-law"),
    (POWER, "give --profile, one of parabola"),
    ((*BALL, *POWER[:-1], "0.5"), "--layer-exponent = 0.5: must be in [1, 10]"),
    ((*BALL, *POWER[:-1], "2 m"), "--layer-exponent 2 m: must be a number without a unit"),
    ((*BALL, *POWER, "--normal-compliance", "1"), "--normal-compliance = 1.0: must be 0 if layer"),
    ((*BALL, *POWER, "--friction", "0.1"), "superposition"),
    ((*BALL, "--layer", "table", "--layer-table", "nowhere.txt"), "nowhere.txt: no table of a"),
    ((*BALL, "--layer", "table", "--layer-table", __file__), "no table of a layer"),
    ((*BALL, "--layer", "power"), "invalid choice: 'power'"),
    (
        ("--profile", "flat", "--radius", "1", "--load", "1"),
        "must be None for a flat punch on a linear layer",
    ),
]


@pytest.mark.parametrize(("options", "message"), FAULTS, ids=[one[1] for one in FAULTS])
def test_what_does_not_fit_is_one_line(capsys, options, message):
    status, out, err = run(capsys, "solve", *options)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
