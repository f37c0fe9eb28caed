"""Nonlinear layers on the command line."""

import pytest

from spectral_contact import Scene, Solution, SolutionFileError, layers, profiles
from spectral_contact.__main__ import main
from spectral_contact.view.cli.layer_options import law

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


@pytest.mark.parametrize(("options", "expected"), LAWS, ids=[one[0][0] for one in LAWS])
def test_a_law_makes_a_scene(capsys, tmp_path, options, expected):
    path = tmp_path / "solution.json"
    status, out, err = run(capsys, "solve", *BALL, "--layer", *options, "--output", str(path))
    assert (status, err) == (0, "")
    assert expected.brief in out
    assert Solution.load(path).scene == Scene(
        0.3, layer=expected, profile=profiles.Parabola(1.0), approach=0.2
    )


def test_a_table_is_a_file(capsys, tmp_path):
    (tmp_path / "law.csv").write_text("# w, p\n0, 0\n0.1, 0.2\n0.3, 1\n1, 9\n")
    path = tmp_path / "solution.json"
    table = ("--layer", "table", "--layer-table", str(tmp_path / "law.csv"))
    status, _, err = run(capsys, "solve", *BALL[:-1], "1e-2", *table, "--output", str(path))
    assert (status, err) == (0, "")
    expected = layers.Table((0.0, 0.1, 0.3, 1.0), (0.0, 0.2, 1.0, 9.0))
    assert Solution.load(path).scene.layer == expected


POINTS = ((0.0, 0.1, 0.3, 1.0), (0.0, 0.2, 1.0, 9.0))
TABLES = {
    "pressures first": ("pressure;overclosure\n0;0\n0,2;0,1\n1;0,3\n9;1\n\n", ()),
    "Abaqus": (
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n 0., 0.\n 0.2, 0.1\n 1., 0.3\n 9., 1.\n",
        ("--layer-columns", "pressure,overclosure"),
    ),
    "three columns": ("n w p\n1 0 0\n2 0.1 0.2\n3 0.3 1\n4 1 9\n", ()),
}


@pytest.mark.parametrize(("content", "options"), TABLES.values(), ids=TABLES.keys())
def test_columns_of_a_table_are_those_named(tmp_path, content, options):
    path = tmp_path / "law.txt"
    path.write_text(content)
    given = {"layer": "table", "layer_table": str(path)}
    given |= dict(zip(["layer_columns"], options[1:], strict=False))
    assert law(given, si=False) == layers.Table(*POINTS)


def test_a_table_may_have_units(tmp_path):
    pytest.importorskip("pint", reason="part of the extra: units")
    path = tmp_path / "law.txt"
    path.write_bytes("w [µm];p [MPa]\n0;0\n0,1;0,2\n0,3;1\n1;9\n".encode("cp1252"))
    given = {"layer": "table", "layer_table": str(path)}
    expected = layers.Table((0.0, 1e-7, 3e-7, 1e-6), (0.0, 2e5, 1e6, 9e6))
    assert law(given, si=True) == expected
    with pytest.raises(SolutionFileError, match="is in µm: the scene has no units"):
        law(given, si=False)


def test_a_table_that_does_not_increase_is_refused_with_its_line(tmp_path):
    path = tmp_path / "law.txt"
    path.write_text("w,p\n0,0\n\n0.1,0.2\n0.2,0.2\n1,9\n")
    with pytest.raises(SolutionFileError, match="line 5: pressure does not increase from line 4"):
        law({"layer": "table", "layer_table": str(path)}, si=False)


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
    ((*BALL, "--layer", "table", "--layer-table", "nowhere.txt"), "nowhere.txt: cannot be read"),
    ((*BALL, "--layer", "table", "--layer-table", __file__), "text that names no column"),
    ((*BALL, "--layer", "power"), "invalid choice: 'power'"),
    (
        ("--profile", "flat", "--radius", "1", "--load", "1", "--friction", "0.1"),
        "must be None for a flat punch on a linear layer with friction",
    ),
]


@pytest.mark.parametrize(("options", "message"), FAULTS, ids=[one[1] for one in FAULTS])
def test_what_does_not_fit_is_one_line(capsys, options, message):
    status, out, err = run(capsys, "solve", *options)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
