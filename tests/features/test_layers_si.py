"""Layers in SI units: the same contact in other units, kept as given, and laws of asperities."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

from spectral_contact import NotComputedError, Scene, SceneError, Solution, layers, profiles, solve
from spectral_contact.asperities import greenwood_williamson
from spectral_contact.view.report import report

E, NU, R = 70e9, 0.2, 10e-6
UNIT = E / (4.0 * (1.0 - NU**2))
BODY = {"youngs_modulus": E, "poisson_ratio": NU}
BALL = profiles.Parabola(R)
#: In Pa and m, and the same in E' and radii of the ball.
LAWS = {
    "linear": (layers.Linear(2e-18), layers.Linear(2e-18 * UNIT / R)),
    "power": (layers.PowerLaw(1e20, 2.0), layers.PowerLaw(1e20 / UNIT * R**2, 2.0)),
    "abaqus": (layers.Exponential(1e8, 1e-7), layers.Exponential(1e8 / UNIT, 1e-7 / R)),
    "calculix": (
        layers.CalculixExponential(1e8, 1e-7),
        layers.CalculixExponential(1e8 / UNIT, 1e-7 / R),
    ),
    "asperities": (
        layers.GreenwoodWilliamson(1e12, 1e-6, 1e-7),
        layers.GreenwoodWilliamson(1e12 * R**2, 1e-6 / R, 1e-7 / R),
    ),
}
TABLE = layers.Table((0.0, 1e-8, 2e-8, 1e-7), (0.0, 1e7, 3e7, 1e9))
CUBIC = layers.Sampled.from_functions(
    lambda w: 1e28 * w**3, lambda w: 3e28 * w**2, start=0.0, limit=1e-6
)


def made(layer, **given):
    return Scene.from_physical(**BODY, profile=BALL, layer=layer, **(given or {"approach": 2e-7}))


@pytest.mark.parametrize("name", LAWS)
def test_a_contact_is_the_same_in_other_units(name):
    law, own = LAWS[name]
    found = solve(made(law), 1e-7).physical
    there = solve(Scene(NU, profile=profiles.Parabola(1.0), layer=own, approach=2e-7 / R), 1e-7)
    for quantity, scale in (
        ("load", UNIT * R**2),
        ("stiffness", UNIT * R),
        ("indentation_work", UNIT * R**3),
    ):
        expected = getattr(there, quantity) * scale
        assert getattr(found, quantity) == pytest.approx(expected, rel=2e-7)
    assert found.approach == 2e-7
    assert found.pressure(0.0) == pytest.approx(there.pressure(0.0) * UNIT, rel=2e-7)
    if name == "asperities":
        separated = solve(made(law, separation=5e-8), 1e-7)
        again = solve(made(law, approach=separated.physical.approach), 1e-7)
        assert again.physical.load == pytest.approx(separated.physical.load, rel=1e-6)
        assert "d = 5e-08 m" in report(separated)
        assert found.radius == pytest.approx(there.domain_radius * R, rel=2e-3)
        with pytest.raises(NotComputedError, match="no contact edge"):
            _ = found.contact_radius


@pytest.mark.parametrize("law", [*(one for one, _ in LAWS.values()), TABLE, CUBIC])
def test_scenes_are_kept_as_they_were_given(law):
    scene = made(law, load=1e-3)
    assert Scene.from_json(scene.to_json()) == scene
    assert scene.physical.layer == law
    assert law.brief in repr(scene)
    again = scene.replace(youngs_modulus=2.0 * E)
    assert again.physical.layer == law
    w = 3e-8
    half = 1.0 if isinstance(law, layers.GreenwoodWilliamson) else 0.5
    assert again.layer.pressure(w) == pytest.approx(half * scene.layer.pressure(w), rel=1e-13)
    assert scene.replace(physical=None).layer == scene.layer


def test_a_solution_is_kept_and_shown(tmp_path):
    law = LAWS["abaqus"][0]
    solution = solve(made(law, approach=-2e-8), 1e-6)  # above the first touch of the punch itself
    for suffix in (".json", ".npz"):
        solution.save(tmp_path / f"a{suffix}")
        assert Solution.load(tmp_path / f"a{suffix}").scene == solution.scene
    text = report(solution)
    assert "Exponential(zero_pressure=100000000.0, clearance=1e-07) in Pa and m" in text
    assert "N/m" in text
    assert law.brief in solution._repr_html_()


def test_a_law_that_overflows_far_from_the_contact_is_solved():
    """At the radius of the ball Abaqus' law with this clearance has no finite pressure."""
    law = layers.Exponential(1e7, 1e-8)
    pressed = solve(made(law, load=5e-4), 1e-6).physical
    back = solve(made(law, approach=pressed.approach), 1e-6).physical
    assert back.load == pytest.approx(5e-4, rel=3e-6)


def test_a_flat_punch_has_its_radius():
    scene = Scene.from_physical(
        **BODY, profile=profiles.Flat(1e-6), layer=LAWS["power"][0], load=1e-5
    )
    found = solve(scene, 1e-6).physical
    assert found.contact_radius == 1e-6
    s = np.linspace(0.0, 1.0, 400)
    mean = trapezoid(2.0 * s * found.pressure(s * 1e-6), s)
    assert mean * math.pi * 1e-12 == pytest.approx(1e-5, rel=1e-4)


def test_full_stick_under_a_flat_punch_is_the_same_in_other_units():
    law, own = LAWS["power"]
    stuck = {"friction": math.inf, "tangential_compliance": 2e-18, "approach": 2e-7}
    scene = Scene.from_physical(**BODY, profile=profiles.Flat(R), layer=law, **stuck)
    solution = solve(scene, 1e-7)
    there = Scene(
        *(NU, 0.0, 2e-18 * UNIT / R, math.inf),
        profile=profiles.Flat(1.0),
        layer=own,
        approach=2e-7 / R,
    )
    expected = solve(there, 1e-7).total_shear * UNIT * R**2
    assert solution.physical.total_shear == pytest.approx(expected, rel=3e-7)
    assert "in Pa and m, beta = 2e-18 m/Pa" in report(solution)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"layer": "linear"}, "layer = 'linear': must be None, one of layers"),
        ({"layer": layers.Linear(1e10)}, r"layer = .* compliance .* in \[1e-14, 1e\+14\]"),
        ({"layer": layers.PowerLaw(1e-95, 2.0)}, "layer = .* coefficient over E'"),
        ({"normal_compliance": 1e-18}, "normal_compliance = .* 0 if layer is given"),
        ({"friction": 0.1}, "superposition"),
        ({"profile": None, "radius": 1e-6}, "profile = None: must be given with a layer"),
        ({"load": None, "approach": -1e-9}, "approach = -1e-09: must be finite and > 0"),
        ({"load": None, "approach": math.inf}, "approach = inf: must be finite"),
        ({"load": -1.0}, "load = -1.0"),
    ],
)
def test_bad_input_is_named(given, message):
    right = {"profile": BALL, "layer": LAWS["power"][0], "load": 1e-3}
    with pytest.raises(SceneError, match=message):
        Scene.from_physical(**BODY, **{**right, **given})


def test_scene_and_data_fit_together():
    scene = made(LAWS["power"][0], load=1e-3)
    with pytest.raises(SceneError, match="as the SI data imply"):
        Scene(
            NU,
            profile=BALL,
            load=scene.load,
            layer=layers.PowerLaw(1.0, 2.0),
            physical=scene.physical,
        )


# --- laws of asperities ---------------------------------------------------------------------------

SURFACE = greenwood_williamson(
    density=1e10, tip_radius=5e-6, height_deviation=0.4e-6, pressure=1e7, **BODY
)


def over(law):
    """The law in E' that a scene has."""
    return Scene.from_physical(**BODY, profile=BALL, layer=law, load=1e-3).layer


def carried(density, w, low, high):
    """Pressure in E' of spheres with heights of a density, pressed in by w from its zero."""
    found, _ = quad(lambda z: (z + w) ** 1.5 * density(z), max(low, -w), high, epsabs=0.0)
    return 16.0 / 3.0 * SURFACE.density * math.sqrt(SURFACE.tip_radius) * found


@pytest.mark.parametrize("kind", ["gaussian", "tangent exponential"])
def test_the_law_has_pressure_and_compliance_of_the_surface(kind):
    law, w = over(SURFACE.law(kind)), -SURFACE.separation
    assert law.pressure(w) * UNIT == pytest.approx(1e7, rel=1e-11)
    assert law.stiffness(w) * UNIT * SURFACE.normal_compliance == pytest.approx(1.0, rel=1e-11)


def test_uniform_heights_are_a_power_law():
    law, span = over(SURFACE.law("uniform heights")), 2.0 * math.sqrt(3.0) * 0.4e-6
    for w in (0.1 * span, 0.9 * span):  # from the highest asperity on
        expected = carried(lambda z: 1.0 / span, w, -span, 0.0)
        assert law.pressure(w) == pytest.approx(expected, rel=1e-9)


def test_exponential_heights_are_nearly_exponential():
    law, sigma = over(SURFACE.law("exponential heights")), 0.4e-6
    expected = carried(lambda z: math.exp(-z / sigma) / sigma, -sigma, 0.0, 40.0 * sigma)
    assert law.pressure(-sigma) == pytest.approx(expected, rel=1e-7)
    assert law.pressure(-3.0 * sigma) == pytest.approx(expected * math.exp(-2.0), rel=1e-7)


def test_another_kind_is_refused():
    with pytest.raises(SceneError, match="gaussian"):
        SURFACE.law("gausian")
