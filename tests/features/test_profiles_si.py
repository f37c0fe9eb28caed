"""Contacts under profiles in SI units: Hertz, and the same contact in other units."""

import json
import math

import pytest

from spectral_contact import (
    NotComputedError,
    Scene,
    SceneError,
    Solution,
    compare,
    profiles,
    solve,
)
from spectral_contact.__main__ import main
from spectral_contact.scene import PhysicalData
from spectral_contact.view.report import report

E, NU, R, P = 70e9, 0.2, 10e-6, 5e-3
REDUCED = E / (1.0 - NU**2)
BALL = profiles.Parabola(R)
STEEL = {"youngs_modulus": E, "poisson_ratio": NU}


def made(**given):
    return Scene.from_physical(**STEEL, **{"profile": BALL, "load": P, **given})


def test_a_smooth_ball_is_hertz():
    found = solve(made(), 1e-12).physical
    a = (0.75 * P * R / REDUCED) ** (1 / 3)
    assert found.contact_radius == pytest.approx(a, rel=1e-12)
    assert found.radius == found.contact_radius
    assert found.approach == pytest.approx(a**2 / R, rel=1e-12)
    assert found.load == P
    assert found.pressure(0.0) == pytest.approx(1.5 * P / (math.pi * a**2), rel=1e-12)
    assert found.pressure(a / 2) == pytest.approx(found.pressure(0.0) * 0.75**0.5, rel=1e-12)
    assert found.stiffness == pytest.approx(2.0 * REDUCED * a, rel=1e-12)
    assert found.indentation_work == pytest.approx(0.4 * P * a**2 / R, rel=1e-12)


UNIT, ALPHA = E / (4.0 * (1.0 - NU**2)), 2e-18


@pytest.fixture(scope="module")
def theirs():
    """Lengths in the radius of the ball, instead of metres."""
    layer = ALPHA * UNIT / R
    ball = profiles.Parabola(1.0)
    return solve(Scene(NU, layer, layer, 0.1, profile=ball, load=P / (UNIT * R**2)), 1e-4)


@pytest.mark.parametrize("known", ["load", "approach", "contact_radius"])
def test_a_layer_with_friction_is_the_same_in_other_units(theirs, known):
    unit, alpha = UNIT, ALPHA
    scales = {"load": unit * R**2, "approach": R, "contact_radius": R, "total_shear": unit * R**2}
    value = getattr(theirs, known) * scales[known]
    layer = {"normal_compliance": alpha, "tangential_compliance": alpha, "friction": 0.1}
    scene = made(**{"load": None, **layer, known: value})
    found = solve(scene, 1e-4).physical
    for name, scale in scales.items():
        assert getattr(found, name) == pytest.approx(getattr(theirs, name) * scale, rel=1e-4)
    s = 0.3
    r = s * found.contact_radius
    for name in ("pressure", "traction"):
        expected = getattr(theirs, name)(s) * unit
        assert getattr(found, name)(r) == pytest.approx(expected, rel=1e-3)
    slipping = (1.0 + theirs.stick_radius) / 2.0
    slip = theirs.slip(slipping)
    assert slip < 0.0
    assert found.slip(slipping * found.contact_radius) == pytest.approx(slip * R, rel=1e-2)
    assert found.stick_radius == pytest.approx(theirs.stick_radius * theirs.contact_radius * R)
    assert found.zones[-1].outer == found.contact_radius


def test_scenes_are_kept(tmp_path):
    scene = made(normal_compliance=2e-18)
    assert eval(repr(scene), {"Scene": Scene, "Parabola": profiles.Parabola}) == scene
    assert Scene.from_json(scene.to_json()) == scene
    solution = solve(scene)
    solution.save(tmp_path / "a.json")
    again = Solution.load(tmp_path / "a.json")
    assert again.scene == scene
    assert again.physical.approach == solution.physical.approach


def test_files_of_flat_punches_are_what_they_were():
    flat = Scene.from_physical(**STEEL, radius=R, load=P)
    physical = json.loads(flat.to_json())["physical"]
    assert list(physical) == [
        *("youngs_modulus", "radius", "load", "approach"),
        *("normal_compliance", "tangential_compliance"),
    ]
    assert Scene.from_json(flat.to_json()) == flat


def test_a_load_takes_the_place_of_an_approach():
    scene = made().replace(approach=1e-8)
    assert (scene.physical.load, scene.physical.approach, scene.approach) == (None, 1e-8, 1e-8)
    assert scene.replace(contact_radius=1e-7).contact_radius == 1e-7
    assert scene.replace(profile=profiles.Cone(1.2)).profile == profiles.Cone(1.2)
    alone = scene.replace(physical=None)
    assert alone.approach == 1e-8
    with pytest.raises(NotComputedError):
        _ = solve(alone).physical


def test_it_is_shown():
    solution = solve(made(normal_compliance=2e-18))
    text = report(solution)
    assert "P = 0.005 N, alpha = 2e-18 m/Pa" in text
    assert str(solution.physical.stiffness)[:9] in text
    assert "N/m" in text
    assert "is that what was meant" not in text
    assert "is that what was meant" in report(solve(made(normal_compliance=2e-9)))
    shown = made()._repr_html_()
    assert "0.005 N" in shown
    assert "2.74" not in shown  # E' m^2 is nobody's unit


def test_numbers_are_compared_in_si():
    solution = solve(made())
    own = solution.physical
    found = compare(made(), pressure=own.pressure, approach=1.01 * own.approach, truth=solution)
    errors = {one.quantity: one.error for one in found.agreements}
    assert errors["pressure"] < 1e-14
    assert errors["approach"] == pytest.approx(0.01, rel=1e-10)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"radius": 1e-6}, "radius = 1e-06: must be given for a flat punch and None with"),
        ({"load": None}, "contact_radius, load, approach, separation = "),
        ({"approach": 1e-9}, "contact_radius, load, approach, separation = "),
        ({"load": -1.0}, "load = -1.0"),
        ({"load": 1e-300}, "a normal double"),
        ({"profile": None}, "radius = None: must be given"),
        ({"normal_compliance": 1e10}, "normal_compliance = 10000000000.0: must be 0 or have"),
    ],
)
def test_bad_input_is_named(given, message):
    with pytest.raises(SceneError, match=message):
        made(**given)


def test_data_and_scene_fit_together():
    with pytest.raises(SceneError, match="must be None with a radius"):
        PhysicalData(youngs_modulus=E, radius=R, load=P, contact_radius=1.0)
    data = made().physical
    with pytest.raises(SceneError, match="as the SI data imply"):
        Scene(NU, profile=BALL, load=1.0, physical=data)


def test_the_command_line_takes_si(capsys):
    tip = ("--profile", "parabola", "--radius", "10e-6", "--load", "5e-3")
    body = ("--youngs-modulus", "70e9", "--poisson-ratio", "0.2")
    assert main(["solve", *tip, *body, "--normal-compliance-si", "2e-18"]) == 0
    assert "8.868" in capsys.readouterr().out
    for options, said in (
        ((*tip, *body[:2]), "--poisson-ratio is missing: it must be given with SI data"),
        ((*tip, *body, "--normal-compliance", "1"), "use --normal-compliance-si, in m/Pa"),
    ):
        assert main(["solve", *options]) == 2
        assert said in capsys.readouterr().err


def test_inside_the_body_it_is_huber_on_the_axis():
    found = solve(made(), 1e-12).physical
    a, z = found.contact_radius, 0.5 * found.contact_radius
    largest = found.pressure(0.0)
    stress = found.inside.stress(0.0, z)
    assert stress.zz == pytest.approx(-largest / (1.0 + (z / a) ** 2), rel=1e-10)
    moved = found.inside.displacement(0.0, 0.0)
    assert moved.z == pytest.approx(found.approach, rel=1e-10)


def test_the_energy_in_the_body_is_that_of_hertz():
    found = solve(made(), 1e-10).physical
    energies = found.inside.energies()
    assert energies.strain == pytest.approx(0.4 * P * found.approach, rel=1e-9)
    assert energies.external == pytest.approx(0.4 * P * found.approach, rel=1e-9)


def test_the_gap_at_the_surface_is_zero_in_the_contact_and_that_of_the_solution_outside():
    solution = solve(made(), 1e-10)
    body, a = solution.physical.inside, solution.contact_radius
    inside, outside = [0.0, 0.3 * a, 0.9 * a], [1.1 * a, 1.7 * a]
    for found in (body.surface(inside), body.surface(from_edge=[a - r for r in inside])):
        assert abs(found.gap).max() < 1e-8 * solution.approach
    expected = solution.gap([1.1, 1.7])
    for found in (body.surface(outside), body.surface(from_edge=[a - r for r in outside])):
        assert found.gap == pytest.approx(expected, rel=1e-6)


def test_the_command_line_takes_units_of_a_profile(capsys):
    pytest.importorskip("pint")
    flat = ("--profile", "rounded-flat", "--flat-radius", "1 mm", "--radius", "1 m")
    body = ("--youngs-modulus", "70 kN/mm²", "--poisson-ratio", "0.2", "--rtol", "1e-3")
    assert main(["solve", *flat, *body, "--contact-radius", "2000 µm"]) == 0
    printed = capsys.readouterr().out
    assert "RoundedFlat(flat_radius=0.001, radius=1.0), contact radius = 0.002" in printed
    assert "E = 70000000000.0 Pa" in printed
    cone = ("--profile", "cone", "--half-angle", "70.3 deg", "--rtol", "1e-3")
    assert main(["solve", *cone, "--load", "1"]) == 0
    assert "Cone(half_angle=1.22696646415" in capsys.readouterr().out
    for options, said in (
        ((*cone, "--contact-radius", "1 mm"), "must be a number without a unit"),
        ((*cone, "--load", "5 ??"), "is not a number (which may have a unit, as '5 mm'"),
        ((*cone[:2], "--half-angle", "70.3 N", "--load", "1"), "a number in rad"),
        (
            (*flat, *body, "--contact-radius", "2 N"),
            "--contact-radius = '2 N': must be a number in m",
        ),
    ):
        assert main(["solve", *options]) == 2
        assert said in capsys.readouterr().err
