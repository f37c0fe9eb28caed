"""Fits of force-indentation curves: exact data give their parameters back, errors are honest."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import (
    ConvergenceError,
    Scene,
    SceneError,
    closed_forms,
    layers,
    profiles,
    solve,
)
from spectral_contact.calibration import IndentationData, fit, indentation_curve, layered_fits
from spectral_contact.calibration.indentation_curve import curve_load, first_modulus
from spectral_contact.calibration.layered_fits import layered_load

FREE = ("reduced_modulus", "normal_compliance", "zero_point")
BALL = {"poisson_ratio": 0.2, "profile": profiles.Parabola(1e-5), "load": 5e-3}
TRUTH = {"youngs_modulus": 70e9, "normal_compliance": 2e-17}
START = Scene.from_physical(**BALL, youngs_modulus=40e9, normal_compliance=1e-17)
MODULUS = TRUTH["youngs_modulus"] / (1 - 0.2**2)
ZERO = 30e-9
DEPTHS = np.linspace(10e-9, 200e-9, 8)


def loads():
    """Of `Solution.physical`, which knows nothing of fits."""
    known = {name: one for name, one in BALL.items() if name != "load"}
    scenes = [Scene.from_physical(**known, **TRUTH, approach=float(d)) for d in DEPTHS]
    return np.array([solve(one, 1e-11, ("load",)).physical.load for one in scenes])


LOADS = loads()


def test_exact_data_give_their_parameters_back():
    data = IndentationData([0.0, *(DEPTHS + ZERO)], [0.0, *LOADS], 1e-6)
    found = fit(START, data, FREE)
    assert found["reduced_modulus"] == pytest.approx(MODULUS, rel=1e-7)
    assert found["normal_compliance"] == pytest.approx(2e-17, rel=1e-7)
    assert found["zero_point"] == pytest.approx(ZERO, rel=1e-7)
    assert found.scene.physical.youngs_modulus == pytest.approx(70e9, rel=1e-7)
    assert found.chi_square < 1e-6
    assert "reduced_modulus" in str(found)


@pytest.mark.parametrize(
    "profile", [profiles.Parabola(1.0), profiles.TruncatedCone(0.3, 1.3), profiles.Flat(0.8)]
)
def test_derivatives_are_exact(profile):
    """Against differences of fourth order: 10 digits, as their rounding allows."""
    at, layer = 0.2, 0.1
    here = curve_load(profile, at, layer, 1e-12)

    def difference(value, step):
        near, far = ((value(1 + h) - value(1 - h)) / (2 * h) for h in (step, 2 * step))
        return (4 * near - far) / 3

    def load(approach, layer):
        return curve_load(profile, approach, layer, 1e-12).value

    assert here.by_layer * layer == pytest.approx(
        difference(lambda x: load(at, layer * x), 1e-3), rel=1e-10
    )
    assert here.by_approach * at == pytest.approx(
        difference(lambda x: load(at * x, layer), 1e-3), rel=1e-10
    )


def test_without_a_layer_and_without_contact():
    flat = curve_load(profiles.Parabola(1.0), 0.25, 0.0, 1e-10)
    assert flat.value == pytest.approx(16 / 3 * 0.125)
    assert flat.by_approach == pytest.approx(4.0)
    assert curve_load(profiles.Parabola(1.0), -0.1, 0.0, 1e-10) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", ["load_error", "stiffness_error"])
@pytest.mark.parametrize(
    ("module", "load"),
    [
        (indentation_curve, lambda: curve_load(profiles.Parabola(1.0), 0.2, 0.1, 1e-6)),
        (
            layered_fits,
            lambda: layered_load(profiles.Flat(1.0), layers.PowerLaw(5.0, 2.0), 0.3, 1e-6),
        ),
    ],
    ids=["linear", "power law"],
)
def test_a_load_or_a_stiffness_that_is_not_known_well_enough_is_refused(
    monkeypatch, module, load, name
):
    """The stiffness is the derivative by the approach: a fit with a wrong one goes astray."""
    load()  # is known well enough
    original = module.value_of
    monkeypatch.setattr(module, "value_of", lambda one: replace(original(one), **{name: 1.1e-5}))
    with pytest.raises(ConvergenceError, match=r"are known to 1\.1e-05; loosen rtol"):
        load()


def test_the_error_bars_cover_what_they_say():
    """Four fits to noisy curves, twelve parameters: as far off as the error bars say."""
    sigma, random = 1e-5, np.random.default_rng(5)
    data = IndentationData(DEPTHS + ZERO, LOADS, sigma)
    exact = fit(START, data, FREE, rtol=1e-7)
    found = []
    for _ in range(4):
        noisy = LOADS + sigma * random.standard_normal(len(LOADS))
        one = fit(exact.scene, IndentationData(DEPTHS + ZERO, noisy, sigma), FREE, rtol=1e-7)
        shifts = [(one[n] - exact[n]) / exact.error(n) for n in FREE]
        found.append(shifts)
        assert one.chi_square < 25.0
    assert np.abs(found).max() < 4.0
    assert np.std(found) == pytest.approx(1.0, abs=0.7)


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda: IndentationData([], [], 1.0), "depth"),
        (lambda: IndentationData([1.0], [1.0, 2.0], 1.0), "load"),
        (lambda: IndentationData([1.0], [1.0], 0.0), "sigma"),
        (lambda: fit(Scene(0.3), IndentationData([1.0], [1.0], 1.0), "zero_point"), "profile"),
        (lambda: fit(START, IndentationData([1.0], [1.0], 1.0), FREE), "at most 1 parameters"),
        (lambda: fit(START, IndentationData([1.0], [1.0], 1.0), "modulus"), "free"),
        (
            lambda: fit(
                START.replace(normal_compliance=0.0), IndentationData(DEPTHS, LOADS, 1.0), FREE
            ),
            "normal_compliance",
        ),
    ],
)
def test_bad_input_is_refused(use, message):
    with pytest.raises(SceneError, match=message):
        use()


def test_too_few_evaluations_are_an_error():
    with pytest.raises(ConvergenceError, match="not settled"):
        fit(START, IndentationData(DEPTHS, LOADS, 1e-6), FREE, max_evaluations=1)


def test_a_smooth_surface_has_its_modulus():
    smooth = Scene.from_physical(**BALL, youngs_modulus=1e9)
    hertz = 4 / 3 * MODULUS * math.sqrt(1e-5) * DEPTHS**1.5
    found = fit(smooth, IndentationData(DEPTHS, hertz, 1e-6), "reduced_modulus")
    assert found["reduced_modulus"] == pytest.approx(MODULUS, rel=1e-9)


ANGLE, RIM, LARGEST = 1.2, 3e-7, 2e-6
RADII = np.geomspace(1.001 * RIM, LARGEST, 80)


@pytest.mark.parametrize(
    ("profile", "contact"),
    [
        (
            profiles.TruncatedCone(RIM, ANGLE),
            lambda a: closed_forms.truncated_cone_contact(a, RIM, ANGLE),
        ),
        (
            profiles.RoundedFlat(RIM, 5e-6),
            lambda a: closed_forms.rounded_flat_contact(a, RIM, 5e-6),
        ),
        (
            profiles.Sampled((0.0, RIM, 2.0 * LARGEST), ((0.0,), (1.0 / math.tan(ANGLE),))),
            lambda a: closed_forms.truncated_cone_contact(a, RIM, ANGLE),
        ),
    ],
    ids=["truncated", "rounded", "sampled"],
)
def test_flat_ended_punches_have_modulus_and_zero_of_their_closed_forms(profile, contact):
    contacts = [contact(float(a)) for a in RADII]
    depths = np.array([one.approach for one in contacts]) + ZERO
    forces = MODULUS / 4.0 * np.array([one.load for one in contacts])
    start = Scene.from_physical(reduced_modulus=0.3 * MODULUS, profile=profile, load=1e-3)
    sigma = 1e-3 * forces.max()
    found = fit(start, IndentationData(depths, forces, sigma), ("reduced_modulus", "zero_point"))
    assert found["reduced_modulus"] == pytest.approx(MODULUS, rel=1e-8)
    assert found["zero_point"] == pytest.approx(ZERO, rel=1e-8)
    noisy = forces + sigma * np.random.default_rng(3).standard_normal(len(forces))
    found = fit(start, IndentationData(depths, noisy, sigma), found.names, rtol=1e-6)
    assert abs(found["reduced_modulus"] - MODULUS) < 4.0 * found.error("reduced_modulus")
    assert abs(found["zero_point"] - ZERO) < 4.0 * found.error("zero_point")
    assert found.error("reduced_modulus") < 0.01 * MODULUS
    assert 40.0 < found.chi_square < 130.0


def test_a_flat_punch_has_the_modulus_of_a_straight_line():
    """``P = 2 a E* delta``; with a layer the line is the same but for its slope."""
    depths = np.linspace(-1e-7, 2e-7, 30)
    forces = 2.0 * RIM * MODULUS * np.maximum(depths - ZERO, 0.0)
    start = Scene.from_physical(
        reduced_modulus=0.3 * MODULUS, normal_compliance=1e-19, profile=profiles.Flat(RIM), load=1.0
    )
    data = IndentationData(depths, forces, 1e-3 * forces.max())
    found = fit(start.replace(normal_compliance=0.0), data, ("reduced_modulus", "zero_point"))
    assert found["reduced_modulus"] == pytest.approx(MODULUS, rel=1e-8)
    assert found["zero_point"] == pytest.approx(ZERO, rel=1e-8)
    with pytest.raises(SceneError, match="cannot distinguish"):
        fit(start, data, FREE)


def test_a_fit_may_start_near_the_end_of_a_profile():
    """The search for the first touch went beyond it, and fits were refused."""
    tip = profiles.Sampled.from_functions(
        lambda r: r**2 / 2.0, lambda r: r, reach=0.3, rounded=True
    )
    depth = np.linspace(-0.01, 0.08, 46)  # the tip ends at an approach of 0.09
    load = 4.0 / 3.0 * np.maximum(depth, 0.0) ** 1.5
    data = IndentationData(depth, load, 1e-5)
    assert first_modulus(tip, data) == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("layer", [None, layers.Linear(1e-16)])
def test_a_depth_beyond_the_end_of_a_profile_is_named(layer):
    """The error was of an approach, which the user of a fit does not give."""
    ball = profiles.Sphere(1e-7)
    scene = Scene.from_physical(reduced_modulus=2e6, profile=ball, load=1e-9, layer=layer)
    data = IndentationData([1e-7, 2e-6], [1e-9, 1e-7], 1e-9)
    with pytest.raises(SceneError, match=r"^depth = .* which ends at 1e-07: the approach"):
        fit(scene, data, "reduced_modulus")


def test_youngs_modulus_has_the_error_that_an_elastic_punch_leaves_it():
    """What is left of E* after a punch that gives way most is known far less well."""
    punch = {"punch_youngs_modulus": 2e9, "punch_poisson_ratio": 0.2}
    scene = Scene.from_physical(
        youngs_modulus=1e9,
        poisson_ratio=0.3,
        profile=profiles.Parabola(1e-5),
        approach=1e-6,
        **punch,
    )

    def youngs_modulus(load):
        found = fit(scene, IndentationData([1e-6], [load], 1e-5), "reduced_modulus")
        return found, found.scene.physical.youngs_modulus

    found, _ = youngs_modulus(8e-3)
    told = float(re.search(r"Young's modulus .* standard deviation (\S+),", str(found))[1])
    moved = youngs_modulus(8e-3 + 1e-7)[1] - youngs_modulus(8e-3 - 1e-7)[1]
    assert told == pytest.approx(moved / 2e-7 * 1e-5, rel=0.02)


def test_what_the_data_do_not_depend_on_is_named():
    scene = Scene.from_physical(
        youngs_modulus=1e9, poisson_ratio=0.3, profile=profiles.Parabola(1e-5), approach=1e-6
    )
    before = IndentationData([-2e-6, -1e-6], [1e-5, 2e-5], 1e-5)
    with pytest.raises(SceneError, match="which do not change with reduced_modulus"):
        fit(scene, before, "reduced_modulus")
