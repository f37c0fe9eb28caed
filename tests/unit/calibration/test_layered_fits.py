"""Fits of nonlinear layers: exact data give their laws back, and laws are told apart, or not."""

from dataclasses import fields, replace

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, layers, profiles, solve
from spectral_contact.calibration import IndentationData, compare_laws, fit
from spectral_contact.calibration.layered_fits import layered_load

BODY = {"poisson_ratio": 0.2, "profile": profiles.Flat(1e-6), "youngs_modulus": 70e9}
POWER, GUESS = layers.PowerLaw(1e20, 2.0), layers.PowerLaw(3e21, 2.3)
ABAQUS = layers.Exponential(2e4, 4e-8)
DEPTHS = np.linspace(1e-8, 1e-7, 6)
POWER_FREE = ("coefficient", "exponent")


def made(law, **given):
    return Scene.from_physical(**BODY, layer=law, **(given or {"load": 1e-4}))


def loads(law):
    """Of `Solution.physical`, which knows nothing of fits."""
    scenes = [made(law, approach=float(depth)) for depth in DEPTHS]
    return np.array([solve(one, 1e-9, ("load",)).physical.load for one in scenes])


LOADS = loads(POWER)


@pytest.mark.parametrize(
    ("law", "profile", "approach"),
    [
        (layers.PowerLaw(5.0, 2.0), profiles.Parabola(1.0), 0.3),
        (layers.Exponential(0.3, 0.1), profiles.Flat(1.0), -0.02),
        (layers.CalculixExponential(0.3, 0.1), profiles.Flat(1.0), 0.1),
        (layers.GreenwoodWilliamson(9.0, 1.0, 0.1), profiles.Parabola(1.0), 0.2),
    ],
    ids=lambda one: type(one).__name__,
)
def test_derivatives_are_exact(law, profile, approach):
    """Against differences of fourth order of solves."""
    here = layered_load(profile, law, approach, 1e-8)

    def difference(value, step=1e-3):
        near, far = ((value(h) - value(-h)) / (2.0 * h) for h in (step, 2.0 * step))
        return (4.0 * near - far) / 3.0

    [name] = [fields(law)[-1].name] if not hasattr(law, "heights") else ["height_deviation"]
    size = getattr(law, name)

    def moved(h):
        other = replace(law, **{name: size * (1.0 + h)})
        return layered_load(profile, other, approach, 1e-10).value

    assert here.by[name] == pytest.approx(difference(moved), rel=1e-7)


def test_a_power_law_is_found_with_its_errors():
    found = fit(made(GUESS), IndentationData(DEPTHS, LOADS, 1e-3 * LOADS), POWER_FREE, rtol=1e-7)
    assert found["exponent"] == pytest.approx(2.0, rel=1e-6)
    assert found["coefficient"] == pytest.approx(1e20, rel=1e-4)
    assert found.scene.physical.layer == layers.PowerLaw(found["coefficient"], found["exponent"])
    assert "Pa/m^exponent" in str(found)
    noise = np.array([1.0, -1.0, 1.0, 1.0, -1.0, -1.0])
    noisy = IndentationData(DEPTHS, LOADS * (1.0 + 1e-3 * noise), 1e-3 * LOADS)
    other = fit(made(POWER), noisy, POWER_FREE, rtol=1e-7)
    for name in POWER_FREE:
        off = abs(other[name] - found[name])
        assert 0.01 * found.error(name) < off < 4.0 * found.error(name)


def test_what_data_cannot_tell_is_refused_at_the_start():
    rough = layers.GreenwoodWilliamson(1e13, 1e-6, 2e-8)
    data = IndentationData(DEPTHS, LOADS, 1e-3 * LOADS)
    with pytest.raises(SceneError, match="cannot distinguish them"):
        fit(made(rough), data, ("density", "tip_radius"), rtol=1e-4)


def test_laws_are_told_apart_where_the_data_allow_it():
    """Over a decade of depths they differ; over a narrow range, and with noise, they do not."""
    free = ("zero_pressure", "clearance")
    candidates = {"power law": (made(POWER), POWER_FREE), "abaqus": (made(ABAQUS), free)}
    found = compare_laws(candidates, IndentationData(DEPTHS, LOADS, 1e-2 * LOADS), rtol=1e-5)
    assert found.best == "power law"
    assert found.alike == ("power law",)
    assert found["power law"]["exponent"] == pytest.approx(2.0, rel=1e-3)
    assert found.weights[0] > 0.999
    assert "the data support: power law" in str(found)
    depths = np.linspace(7e-8, 1e-7, 4)
    narrow = np.interp(depths, DEPTHS, LOADS)
    blunt = compare_laws(candidates, IndentationData(depths, narrow, 0.05 * narrow), rtol=1e-5)
    assert blunt.alike == ("power law", "abaqus")
    assert "cannot distinguish" in str(blunt)
    # AICc of two parameters and four loads: chi^2 + 4 + 12/1
    assert blunt.criterion[0] == pytest.approx(blunt.fits[0].chi_square + 16.0)


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda data: fit(made(POWER), data, "clearance"), "free"),
        (lambda data: fit(made(POWER), data, "normal_compliance"), "free"),
        (lambda data: compare_laws({"a": (made(POWER), POWER_FREE)}, data), "two names or more"),
        (lambda data: compare_laws([made(POWER)], data), "candidates"),
        (lambda data: compare_laws({"a": made(POWER), "b": 1}, data), "candidates"),
        (
            lambda data: compare_laws(dict.fromkeys("ab", (made(POWER), POWER_FREE)), data),
            "data = .* at least 4 loads",
        ),
        (
            lambda data: compare_laws(dict.fromkeys("ab", (made(POWER), "clearance")), data),
            r"candidate 'a'",
        ),
        (lambda data: compare_laws(dict.fromkeys("ab", (made(POWER), "exponent")), 3), "data"),
    ],
)
def test_bad_input_is_named(use, message):
    data = IndentationData(DEPTHS[:3], LOADS[:3], 1e-5)
    with pytest.raises(SceneError, match=message):
        use(data)


def test_an_exponent_at_the_end_of_its_range_is_named():
    """It was said that the data could not distinguish it from the coefficient."""
    punch = profiles.Flat(1e-6)
    start = Scene.from_physical(
        reduced_modulus=2e6, profile=punch, load=1e-9, layer=layers.PowerLaw(1e12, 1.2)
    )
    depth = np.linspace(1e-7, 1e-6, 5)
    # loads that grow less than in proportion ask for an exponent below 1
    data = IndentationData(depth, 1.4e-6 * (depth / 1e-6) ** 0.9, 1e-8)
    with pytest.raises(SceneError, match="without exponent, which comes to 1, an end of its range"):
        fit(start, data, ("coefficient", "exponent"), rtol=1e-6)
