"""Profiles on the command line."""

import math

import pytest

from spectral_contact import Scene, Solution, profiles
from spectral_contact.__main__ import main


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact solve``."""
    status = main(["solve", *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


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
    status, out, err = run(capsys, "--profile", *options, *more)
    assert (status, err) == (0, "")
    assert "contact radius" in out
    assert Solution.load(path).scene == Scene(0.3, 0.5, profile=profile, load=2.0)


def test_friction_and_a_picture(capsys, tmp_path):
    picture, table = tmp_path / "a.svg", tmp_path / "a.csv"
    options = ("--profile", "parabola", "--radius", "1", "--contact-radius", "1")
    layer = ("--normal-compliance", "0.2", "--tangential-compliance", "0.2")
    quick = (*layer, "--friction", "inf", "--rtol", "1e-3")
    status, out, _ = run(capsys, *options, *quick, "--plot", str(picture), "--output", str(table))
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
    status, _, err = run(capsys, *ball, "50 um", "80 deg", *STEEL, *punch, *kept)
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
    assert run(capsys, *plain, "--load", "0.1", *kept)[0] == 0
    expected = profiles.Sum(profiles.Cone(1.2), profiles.Sphere(3.0))
    assert Solution.load(path).scene.profile == expected


FAULTS = [
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "flat"),
        "--punch-profile flat: must be one of parabola, sphere",
    ),
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "sphere"),
        "--punch-profile sphere needs radius; it has 0 numbers",
    ),
    (
        ("--profile", "parabola", "--radius", "1", "--load", "1", "--punch-profile", "sphere", "x"),
        "--punch-profile sphere: 'x'",
    ),
    (("--profile", "cone", "--load", "2"), "--profile cone needs --half-angle"),
    (("--load", "2", "--contact-radius", "1"), "give --profile"),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "2", "--radius", "1"),
        "not take --radius",
    ),
    (("--profile", "cone", "--half-angle", "1"), "one of --contact-radius, --load, --approach"),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "1", "--approach", "1"),
        "one of --contact-radius, --load, --approach",
    ),
    (("--profile", "cone", "--half-angle", "4", "--load", "2"), "--half-angle = 4.0: must be in"),
    (("--profile", "cone", "--half-angle", "1", "--load", "2 N"), "without a unit"),
    (
        ("--profile", "cone", "--half-angle", "1", "--load", "2", "--youngs-modulus", "1"),
        "SI input needs --poisson-ratio",
    ),
    (("--profile", "sphere", "--radius", "1", "--contact-radius", "2"), "--contact-radius = 2.0"),
    (("--profile", "wedge"), "invalid choice: 'wedge'"),
]


@pytest.mark.parametrize(("options", "message"), FAULTS, ids=[one[1] for one in FAULTS])
def test_what_does_not_fit_is_one_line(capsys, options, message):
    status, out, err = run(capsys, *options)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_without_a_profile_the_bare_command_is_as_ever(capsys):
    status, out, _ = run(capsys, "--friction", "none", "--rtol", "1e-4")
    assert status == 0
    assert "contact radius" not in out
    assert not math.isnan(float(out.split("approach")[1].split()[0]))


def test_a_profile_of_the_points_of_a_file(capsys):
    """A section with noise of a tip of 10 um: Hertz' depth, as far as the noise allows."""
    from pathlib import Path

    tip = Path(__file__).parents[3] / "data" / "profiles" / "tip_section.txt"
    command = ("solve", "--youngs-modulus", "70e9", "--poisson-ratio", "0.2", "--load", "5 mN")
    shape = ("--profile", "points", str(tip))
    assert main([*command, *shape]) == 2
    assert "of noisy points convex_hull=True takes the hull" in capsys.readouterr().err
    assert main([*command, *shape, "--convex-hull"]) == 0
    out = capsys.readouterr().out
    assert "25 rows, r from column 1 (r [um]) in um, height from column 2 (height [nm])" in out
    assert "the hull lies" in out
    rows = [line.split() for line in out.partition("\nSI ")[2].splitlines()]
    [depth] = [float(row[1]) for row in rows if row[:1] == ["approach"]]
    modulus = 70e9 / (1 - 0.2**2)
    assert depth == pytest.approx((0.75 * 5e-3 / modulus / 1e-5**0.5) ** (2 / 3), rel=0.1)
    assert main([*command, "--profile", "points"]) == 2
    assert "needs a FILE" in capsys.readouterr().err
    assert main([*command, "--profile", "cone", "--half-angle", "1", "--convex-hull"]) == 2
    assert "--convex-hull goes with --profile points" in capsys.readouterr().err
