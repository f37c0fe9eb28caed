"""Profiles and nonlinear layers on the command line, and options that say what is declared."""

import inspect
import math
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from spectral_contact import Scene, SceneError, Solution, SolutionFileError, layers, profiles
from spectral_contact.__main__ import main
from spectral_contact.io.parameters import SCENE, SI, declared, parameters_of
from spectral_contact.layers import scene_layer
from spectral_contact.profiles import control
from spectral_contact.view.cli import scene_options
from spectral_contact.view.cli.command import Parser
from spectral_contact.view.cli.scene_options import SceneOptions, _law

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
    assert _law(given, si=False) == layers.Table(*POINTS)


def test_a_table_may_have_units(tmp_path):
    pytest.importorskip("pint", reason="part of the extra: units")
    path = tmp_path / "law.txt"
    path.write_bytes("w [µm];p [MPa]\n0;0\n0,1;0,2\n0,3;1\n1;9\n".encode("cp1252"))
    given = {"layer": "table", "layer_table": str(path)}
    expected = layers.Table((0.0, 1e-7, 3e-7, 1e-6), (0.0, 2e5, 1e6, 9e6))
    assert _law(given, si=True) == expected
    with pytest.raises(SolutionFileError, match="is in µm: the scene has no units"):
        _law(given, si=False)


def test_a_table_that_does_not_increase_is_refused_with_its_line(tmp_path):
    path = tmp_path / "law.txt"
    path.write_text("w,p\n0,0\n\n0.1,0.2\n0.2,0.2\n1,9\n")
    with pytest.raises(SolutionFileError, match="line 5: pressure does not increase from line 4"):
        _law({"layer": "table", "layer_table": str(path)}, si=False)


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
    (
        (*BALL, "--layer", "exponential", "--layer-clearance", "1"),
        "exponential takes --layer-zero-pressure --layer-clearance and no other",
    ),
    (
        (*BALL, *POWER, "--layer-clearance", "1"),
        "--layer power-law takes --layer-coefficient --layer-exponent and no other",
    ),
    ((*BALL, *POWER[2:]), "--layer-coefficient needs --layer, one of linear, power-law"),
    (POWER, "--layer needs --profile, one of parabola"),
    ((*BALL, *POWER[:-1], "0.5"), "--layer-exponent = 0.5: must be in [1, 10]"),
    ((*BALL, *POWER[:-1], "2 m"), "--layer-exponent = '2 m': must be a number without a unit"),
    ((*BALL, *POWER, "--normal-compliance", "1"), "--normal-compliance = 1.0: must be 0 if layer"),
    ((*BALL, *POWER, "--friction", "0.1"), "superposition"),
    ((*BALL, "--layer", "table", "--layer-table", "nowhere.txt"), "nowhere.txt: cannot be read"),
    ((*BALL, "--layer", "table", "--layer-table", __file__), "text that names no column"),
    ((*BALL, "--layer", "power"), "invalid choice: 'power'"),
    (
        ("--profile", "flat", "--radius", "1", "--load", "1", "--friction", "0.1"),
        "--profile = Flat(radius=1.0): must be left out for a flat punch on a linear layer",
    ),
]


@pytest.mark.parametrize(("options", "message"), FAULTS, ids=[one[1] for one in FAULTS])
def test_what_does_not_fit_is_one_line(capsys, options, message):
    status, out, err = run(capsys, "solve", *options)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


SHAPES = [
    (("parabola", "--radius", "1"), profiles.Parabola(1.0)),
    (("sphere", "--radius", "3"), profiles.Sphere(3.0)),
    (("cone", "--half-angle", "1.2"), profiles.Cone(1.2)),
    (("power-law", "--coefficient", "0.4", "--exponent", "4"), profiles.PowerLaw(0.4, 4.0)),
    (("rounded-flat", "--flat-radius", "0.5", "--radius", "1"), profiles.RoundedFlat(0.5, 1.0)),
    (
        ("truncated-cone", "--flat-radius", "0.5", "--half-angle", "1"),
        profiles.TruncatedCone(0.5, 1.0),
    ),
]


@pytest.mark.parametrize(("options", "profile"), SHAPES, ids=[one[0][0] for one in SHAPES])
def test_a_profile_and_a_load_make_a_scene(capsys, tmp_path, options, profile):
    path = tmp_path / "solution.json"
    more = ("--load", "2", "--normal-compliance", "0.5", "--rtol", "1e-4", "--output", str(path))
    status, out, err = run(capsys, "solve", "--profile", *options, *more)
    assert (status, err) == (0, "")
    assert "contact radius" in out
    assert Solution.load(path).scene == Scene(0.3, 0.5, profile=profile, load=2.0)


def test_friction_and_a_picture(capsys, tmp_path):
    picture, table = tmp_path / "a.svg", tmp_path / "a.csv"
    options = ("--profile", "parabola", "--radius", "1", "--contact-radius", "1")
    layer = ("--normal-compliance", "0.2", "--tangential-compliance", "0.2")
    quick = (*layer, "--friction", "inf", "--rtol", "1e-3")
    files = ("--plot", str(picture), "--output", str(table))
    status, out, _ = run(capsys, "solve", *options, *quick, *files)
    assert status == 0
    assert "growing contact" in out
    assert "loads in E' L^2" in table.read_text()
    assert picture.stat().st_size > 1000


STEEL = ("--youngs-modulus", "210 GPa", "--poisson-ratio", "0.3", "--load", "100 N")


def test_two_curved_bodies(capsys, tmp_path):
    path = tmp_path / "solution.json"
    punch = ("--punch-youngs-modulus", "70 GPa", "--punch-poisson-ratio", "0.33")
    ball = ("--profile", "parabola", "--radius", "10 mm", "--punch-profile", "truncated-cone")
    kept = ("--rtol", "1e-4", "--output", str(path))
    status, _, err = run(capsys, "solve", *ball, "50 um", "80 deg", *STEEL, *punch, *kept)
    assert (status, err) == (0, "")
    half_angle = math.radians(80.0)
    assert Solution.load(path).scene == Scene.from_physical(
        youngs_modulus=210e9,
        poisson_ratio=0.3,
        punch_youngs_modulus=70e9,
        punch_poisson_ratio=0.33,
        load=100.0,
        profile=profiles.Parabola(0.01),
        punch_profile=profiles.TruncatedCone(50e-6, half_angle),
    )
    plain = ("--profile", "cone", "--half-angle", "1.2", "--punch-profile", "sphere", "3")
    assert run(capsys, "solve", *plain, "--load", "0.1", *kept)[0] == 0
    expected = profiles.Sum(profiles.Cone(1.2), profiles.Sphere(3.0))
    assert Solution.load(path).scene.profile == expected


PROFILE_FAULTS = [
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "flat"),
        "--punch-profile = 'flat': must be one of parabola, sphere",
    ),
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "sphere"),
        "--punch-profile sphere: sphere takes radius",
    ),
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "sphere", "x"),
        "--punch-profile sphere x: 'x'",
    ),
    (
        ("--profile", "sphere", "--radius", "1", "--load", "1", "--punch-profile", "sphere", "-1"),
        "--punch-profile sphere -1: radius = -1.0: must be finite and > 0",
    ),
    (
        ("--profile", "sphere", "--radius", "1", "--load", "1", "--punch-profile", "sphere", "1m"),
        "--punch-profile sphere 1m: radius = '1m': must be a number without a unit",
    ),
    (("--punch-profile", "sphere", "1"), "--punch-profile needs --profile, one of parabola, sp"),
    (
        ("--profile", "cone", "--load", "2"),
        "--profile cone takes --half-angle and no other: --half-angle is missing",
    ),
    (("--load", "2", "--contact-radius", "1"), "--contact-radius needs --profile, one of"),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "2", "--radius", "1"),
        "--profile cone takes --half-angle and no other: --radius is none of them",
    ),
    (
        ("--profile", "cone", "--half-angle", "1"),
        "--contact-radius, --load, --approach, --separation: none of them is given",
    ),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "1", "--approach", "1"),
        "--approach, --separation: --load 1.0 and --approach 1.0 are given",
    ),
    (("--profile", "cone", "--half-angle", "4", "--load", "2"), "--half-angle = 4.0: must be in"),
    (("--profile", "cone", "--half-angle", "1", "--load", "2 N"), "without a unit"),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "2", "--youngs-modulus", "1"),
        "--poisson-ratio is missing: it must be given with SI data",
    ),
    (("--profile", "sphere", "--radius", "1", "--contact-radius", "2"), "--contact-radius = 2.0"),
    (
        (*STEEL, "--profile", "sphere", "--radius", "1", "--punch-youngs-modulus", "1e9"),
        "--punch-poisson-ratio is missing: it must be given with --punch-youngs-modulus: both",
    ),
    (
        ("--reduced-modulus", "1e9", "--youngs-modulus", "1e9", "--radius", "1", "--load", "1"),
        "--youngs-modulus = 1000000000.0: must be left out with --reduced-modulus",
    ),
    (("--profile", "wedge"), "invalid choice: 'wedge'"),
]


@pytest.mark.parametrize(("options", "message"), PROFILE_FAULTS)
def test_what_does_not_fit_a_profile_is_one_line(capsys, options, message):
    status, out, err = run(capsys, "solve", *options)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_without_a_profile_the_bare_command_is_as_ever(capsys):
    status, out, _ = run(capsys, "solve", "--friction", "none", "--rtol", "1e-4")
    assert status == 0
    assert "contact radius" not in out
    assert not math.isnan(float(out.split("approach")[1].split()[0]))


def test_a_profile_of_the_points_of_a_file(capsys):
    """A section with noise of a tip of 10 um: Hertz' depth, as far as the noise allows."""
    tip = Path(__file__).parents[3] / "data" / "profiles" / "tip_section.txt"
    command = ("solve", "--youngs-modulus", "70e9", "--poisson-ratio", "0.2", "--load", "5 mN")
    shape = ("--profile", "points", str(tip))
    assert main([*command, *shape]) == 2
    assert "of noisy points --convex-hull takes the hull" in capsys.readouterr().err
    assert main([*command, *shape, "--convex-hull"]) == 0
    out = capsys.readouterr().out
    assert "25 rows, r from column 1 (r [um]) in um, height from column 2 (height [nm])" in out
    assert "the hull lies" in out
    rows = [line.split() for line in out.partition("\nSI ")[2].splitlines()]
    [depth] = [float(row[1]) for row in rows if row[:1] == ["approach"]]
    modulus = 70e9 / (1 - 0.2**2)
    assert depth == pytest.approx((0.75 * 5e-3 / modulus / 1e-5**0.5) ** (2 / 3), rel=0.1)
    assert main([*command, "--profile", "points"]) == 2
    assert (
        "--profile points takes --profile-file [--profile-columns] [--convex-hull]"
        in capsys.readouterr().err
    )
    assert main([*command, "--profile", "cone", "--half-angle", "1", "--convex-hull"]) == 2
    assert "--profile cone takes --half-angle and no other" in capsys.readouterr().err


# --- options say what is declared -----------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NewLaw(layers.Layer):
    """A law that nothing of the command line knows."""

    yield_pressure: float = field(metadata=declared("pressure at yield", "in [1, 2]", "Pa"))

    def _over(self, unit):
        raise NotImplementedError

    _size = _pressure = _slope = _energy = _over


def test_every_parameter_has_an_option_whose_help_is_the_declared_text():
    parser = Parser()
    SceneOptions.add_options(parser)
    helps = {action.dest: action.help for action in parser._actions}
    assert str(SCENE["friction"]) in helps["friction"]
    told = {name: str(one) for name, one in SCENE.items()}
    told |= {f"{name}_si" if name.endswith("compliance") else name: str(SI[name]) for name in SI}
    told["work_of_adhesion"] = str(SCENE["work_of_adhesion"])
    for name, text in told.items():
        assert text in helps[name], name
    for kinds, prefix in ((control.KINDS, ""), (scene_layer.KINDS, "layer_")):
        for kind in kinds.values():
            for name, one in parameters_of(kind).items():
                assert str(one) in helps[prefix + name]


def test_every_constructor_parameter_of_a_scene_has_an_option():
    parser = Parser()
    SceneOptions.add_options(parser)
    options = {action.dest.removesuffix("_si") for action in parser._actions}
    for make in (Scene, Scene.from_kappa, Scene.from_physical):
        # the two that others stand for
        assert set(inspect.signature(make).parameters) - {"physical", "mismatch"} <= options


def test_a_new_law_needs_no_edit_of_the_command_line(monkeypatch):
    named = scene_options._named([NewLaw])
    assert list(named) == ["new-law"]
    merged = scene_options._merged(named, "layer_")
    assert list(merged) == ["layer_yield_pressure"]
    monkeypatch.setattr(scene_options, "LAWS", named)
    options = {"layer": "new-law", "layer_yield_pressure": 1.5}
    assert _law(options, si=False) == NewLaw(1.5)
    with pytest.raises(SceneError, match=r"^layer_yield_pressure = 3.0: must be in \[1, 2\]"):
        _law({**options, "layer_yield_pressure": 3.0}, si=False)
