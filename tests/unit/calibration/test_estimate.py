"""Fits: noise-free data give their parameters back, derivatives are right, errors are honest."""

import json
import math
import re

import numpy as np
import pytest

from spectral_contact import ConvergenceError, Scene, SceneError, SolutionFileError, solve
from spectral_contact.calibration import (
    PARAMETERS,
    ApproachData,
    PressureData,
    RoughnessFit,
    StickRadiusData,
    fit,
)
from spectral_contact.calibration.setting import Setting

LAYER = {"normal_compliance": 3e-15, "tangential_compliance": 4e-15, "friction": 0.05}
MATERIAL = {"youngs_modulus": 200e9, "poisson_ratio": 0.3}
RADII = (0.3e-3, 1e-3, 3e-3)
LOADS = (30.0, 500.0, 4e3)
PLACES = (0.0, 0.4e-3, 0.8e-3, 1e-3)


def scene(radius=1e-3, load=500.0, **changes):
    return Scene.from_physical(**MATERIAL, radius=radius, load=load, **{**LAYER, **changes})


def solved(radius, load, quantity, **changes):
    return solve(scene(radius, load, **changes), 1e-12, [quantity]).physical


def approaches(**changes):
    return np.array(
        [
            solved(a, load, "approach", **changes).approach
            for a, load in zip(RADII, LOADS, strict=True)
        ]
    )


def stick_radii(**changes):
    return np.array([solved(a, 500.0, "stick_radius", **changes).stick_radius for a in RADII])


def noise_free(share=0.01):
    """Return data that `Solution.physical` makes, which knows nothing of fits."""
    pressure = solved(1e-3, 500.0, "pressure").pressure(PLACES)
    approach = approaches()
    stick_radius = stick_radii()
    return (
        ApproachData(approach, share * approach, radius=RADII, load=LOADS),
        PressureData(PLACES, pressure, share * pressure),
        StickRadiusData(stick_radius, share * stick_radius, radius=RADII),
    )


@pytest.fixture(scope="module")
def found():
    start = scene(normal_compliance=1e-14, tangential_compliance=1e-14, friction=0.02)
    return fit(start, noise_free(), PARAMETERS)


def test_data_without_noise_give_the_parameters_back(found):
    for one in found.parameters:
        assert one.value == pytest.approx(LAYER[one.name], rel=1e-8, abs=0)
    assert found.chi_square < 1e-12
    assert found.degrees_of_freedom == 7
    assert found.scene == scene(**{one.name: one.value for one in found.parameters})
    assert found["friction"] is found.parameters[2]


def test_the_covariance_is_that_of_derivatives_by_differences(found):
    """The derivatives are taken anew here, of the physical solutions and at another step."""

    def weighted(name, step):
        changed = {name: LAYER[name] * math.exp(step)}
        parts = (
            approaches(**changed),
            solved(1e-3, 500.0, "pressure", **changed).pressure(PLACES),
            stick_radii(**changed),
        )
        return np.concatenate([part / 0.01 for part in parts])

    sigma = np.concatenate([one.measured for one in noise_free()])
    columns = [(weighted(name, 1e-4) - weighted(name, -1e-4)) / 2e-4 / sigma for name in PARAMETERS]
    jacobian = np.stack(columns, axis=1)
    expected = np.linalg.inv(jacobian.T @ jacobian)
    assert np.array(found.covariance) == pytest.approx(expected, rel=1e-4, abs=1e-9)
    errors = np.sqrt(np.diag(expected))
    assert [one.relative_error for one in found.parameters] == pytest.approx(errors, rel=1e-5)
    assert found.correlation == pytest.approx(expected / np.outer(errors, errors), abs=1e-4)


@pytest.mark.parametrize("alpha", [3e-27, 3e-18, 3e-15, 3e-12])
def test_the_derivative_of_the_approach_is_exact(alpha):
    layer = {**LAYER, "normal_compliance": alpha}
    setting = Setting.of(scene(), 1e-12, solve)
    data = ApproachData([1.0] * 3, 1.0, radius=RADII, load=LOADS)
    exact = data.slope(setting, layer, "normal_compliance")
    h = 1e-3
    low, high, lower, higher = (
        data.predict(setting, {**layer, "normal_compliance": alpha * math.exp(step)})
        for step in (-h, h, -2 * h, 2 * h)
    )
    differences = (8 * (high - low) - (higher - lower)) / (12 * h)
    rounding = 1e-14 * data.predict(setting, layer).max() / h
    assert exact == pytest.approx(differences, rel=1e-9, abs=rounding)


@pytest.mark.parametrize("name", PARAMETERS)
def test_other_derivatives_are_accurate_enough(name):
    """Against differences of fourth order of solves a hundred times as accurate."""
    setting, sharper = Setting.of(scene(), 1e-10, solve), Setting.of(scene(), 1e-12, solve)
    h = 1e-3
    for data in (
        PressureData(PLACES, [1.0] * 4, 1.0),
        StickRadiusData([1.0] * 3, 1.0, radius=RADII),
    ):
        if name not in data.depends_on:
            assert name != "normal_compliance"
            continue
        low, high, lower, higher = (
            data.predict(sharper, {**LAYER, name: LAYER[name] * math.exp(step)})
            for step in (-h, h, -2 * h, 2 * h)
        )
        differences = (8 * (high - low) - (higher - lower)) / (12 * h)
        scale = abs(differences).max()
        assert data.slope(setting, LAYER, name) == pytest.approx(differences, abs=2e-6 * scale)


def pulls(seeds, make, start, free, true):
    """Return the squares of the deviations from the truth in the metric of the covariance."""
    squares, misfits, freedom = [], [], 0
    for seed in seeds:
        found = fit(start, make(np.random.default_rng(seed)), free)
        offset = np.log([one.value / true[one.name] for one in found.parameters])
        squares.append(offset @ np.linalg.solve(np.array(found.covariance), offset))
        misfits.append(found.chi_square)
        freedom += found.degrees_of_freedom
    return sum(squares), len(squares) * len(free), sum(misfits), freedom


def assert_is_chi_square(value, freedom):
    """Within the central 99.9 per cent."""
    from scipy.stats import chi2

    low, high = chi2.interval(0.999, freedom)
    assert low < value < high


def test_the_truth_of_one_parameter_is_within_the_errors_of_sixty_fits():
    exact = approaches()

    def make(random):
        noise = 1 + 0.01 * random.standard_normal(len(exact))
        return ApproachData(exact * noise, 0.01 * exact, radius=RADII, load=LOADS)

    square, count, misfit, freedom = pulls(range(60), make, scene(), PARAMETERS[:1], LAYER)
    assert_is_chi_square(square, count)
    assert_is_chi_square(misfit, freedom)
    # the test can fail: errors that are wrong by a factor of 1.5 are not accepted
    for wrong in (square * 2.25, square / 2.25):
        with pytest.raises(AssertionError):
            assert_is_chi_square(wrong, count)


def test_the_truth_of_three_parameters_is_within_the_errors_of_three_fits():
    exact = noise_free()

    def make(random):
        def noise(values):
            return np.array(values) * (1 + 0.01 * random.standard_normal(len(values)))

        first, second, third = exact
        return (
            ApproachData(noise(first.approach), first.sigma, radius=RADII, load=LOADS),
            PressureData(PLACES, noise(second.pressure), second.sigma),
            StickRadiusData(noise(third.stick_radius), third.sigma, radius=RADII),
        )

    square, count, misfit, freedom = pulls(range(3), make, scene(), PARAMETERS, LAYER)
    assert_is_chi_square(square, count)
    assert_is_chi_square(misfit, freedom)


def test_without_si_data_units_are_those_of_the_theory():
    """A punch of twice the radius halves the dimensionless compliances."""
    wide = solve(Scene(0.3, 0.25, 0.25, 0.05), 1e-12)
    data = [
        ApproachData(3.0 / 2.0 * wide.approach, 1e-3, radius=2.0, load=3.0),
        PressureData(1.0, 3.0 / 4.0 * wide.pressure(0.5), 1e-3, radius=2.0, load=3.0),
        StickRadiusData(2.0 * wide.stick_radius, 1e-3, radius=2.0, friction=0.05),
    ]
    found = fit(Scene(0.3, 0.1, 0.3), data, PARAMETERS[:2])
    assert found["normal_compliance"].value == pytest.approx(0.5, rel=1e-7)
    assert found["tangential_compliance"].value == pytest.approx(0.5, rel=1e-7)
    assert found.scene == Scene(0.3, *(one.value for one in found.parameters))


def test_known_friction_of_each_value_is_used():
    exact = [solved(1e-3, 1.0, "stick_radius", friction=f).stick_radius for f in (0.02, 0.08)]
    start = scene(friction=None, tangential_compliance=1e-15)
    data = StickRadiusData(exact, 1e-6, friction=[0.02, 0.08])
    found = fit(start, data, "tangential_compliance")
    assert found["tangential_compliance"].value == pytest.approx(4e-15, rel=1e-7, abs=0)


def test_an_interval_is_that_of_the_logarithm(found):
    one = found["normal_compliance"]
    low, high = one.interval(0.6826894921370859)
    assert math.log(high / one.value) == pytest.approx(one.relative_error, rel=1e-12)
    assert math.log(one.value / low) == pytest.approx(one.relative_error, rel=1e-12)
    with pytest.raises(SceneError, match="confidence"):
        one.interval(1.0)


def test_goodness_of_fit():
    data = ApproachData([0.294, 0.304], 0.002)
    found = fit(Scene(0.3, 0.1), data, "normal_compliance")
    # the best approach is the mean of the two, half of 0.01 from either
    assert found.chi_square == pytest.approx(12.5, rel=1e-8)
    assert found.reduced_chi_square == pytest.approx(12.5, rel=1e-8)
    assert found.p_value == pytest.approx(math.erfc(math.sqrt(12.5 / 2)), rel=1e-7, abs=0)
    assert solve(found.scene).approach == pytest.approx(0.299, rel=1e-9)
    assert "chi square 12.5 at 1 degrees of freedom, p = 0.00041" in str(found)
    exact = fit(Scene(0.3, 0.1), ApproachData(0.3, 0.001), ("normal_compliance",))
    assert exact.reduced_chi_square is exact.p_value is None
    assert str(exact).endswith("at 0 degrees of freedom")


def test_fits_print_and_are_stored(found):
    text = str(found)
    assert re.search(r"tangential_compliance +4e-15  3\.[0-9]+e-15 to 4\.[0-9]+e-15 m/Pa", text)
    assert "correlation -0.9" in text
    assert RoughnessFit.from_json(found.to_json()) == found


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"schema": "spectral_contact.scene"}, "not a fit"),
        ({"version": 2}, "version 2"),
        ({"more": 1}, "unknown 'more'"),
        ({"covariance": [["1.0"]]}, "real number"),
        ({"parameters": [{"name": "friction"}]}, "no 'value'"),
    ],
)
def test_damaged_fits_are_refused(found, change, reason):
    with pytest.raises(SolutionFileError, match=reason):
        RoughnessFit.from_json(json.dumps(json.loads(found.to_json()) | change))


ALPHA = "normal_compliance"
APPROACH = ApproachData(0.3, 0.01)


@pytest.mark.parametrize(
    ("start", "data", "free", "message"),
    [
        ("scene", APPROACH, ALPHA, "scene = 'scene'"),
        (Scene(0.3, 0.1), [], ALPHA, "data = "),
        (Scene(0.3, 0.1), 0.3, ALPHA, "data = 0.3: must be ApproachData"),
        (Scene(0.3, 0.1), APPROACH, (), "free = "),
        (Scene(0.3, 0.1), APPROACH, "alpha", "free = 'alpha'"),
        (Scene(0.3, 0.1), APPROACH, [ALPHA, ALPHA], "each once"),
        (Scene(0.3, 0.1, 0.1), APPROACH, PARAMETERS[1], "on which the data depend"),
        (Scene(0.3), APPROACH, ALPHA, "normal_compliance = 0.0: must be finite and > 0"),
        (Scene(0.3, 0.1, 0.1), StickRadiusData(0.5, 0.1), "friction", "friction = None"),
        (Scene(0.3, 0.1, 0.1, math.inf), StickRadiusData(0.5, 0.1), "friction", "friction = inf"),
        (Scene(0.3, 0.1, 0.1), StickRadiusData(0.5, 0.1), PARAMETERS[1], "in the data or in"),
        (Scene(0.3, 1e-14), APPROACH, ALPHA, "normal_compliance = 1e-14: must be in"),
        (Scene(0.3, 0.1), PressureData([0.1, 1.1], [0.3, 0.3], 0.1), ALPHA, "r = 1.1"),
        (Scene(0.3, 0.0, 0.1, 0.1), PressureData(1.0, 0.3, 0.1), "friction", "free = 'friction'"),
        (
            Scene(0.3, 0.0, 0.1, 0.1),
            [PressureData(1.0, 0.3, 0.1), StickRadiusData(0.5, 0.1)],
            "friction",
            "no edge pressure",
        ),
    ],
)
def test_bad_input_is_refused(start, data, free, message):
    with pytest.raises(SceneError) as caught:
        fit(start, data, free)
    assert message in str(caught.value)


def test_scenes_that_give_the_approach_need_loads_in_the_data():
    start = Scene.from_physical(**MATERIAL, radius=1e-3, approach=1e-6, normal_compliance=3e-15)
    with pytest.raises(SceneError, match="load = None"):
        fit(start, ApproachData(1e-6, 1e-8), ALPHA)
    found = fit(start, ApproachData(approaches()[1], 1e-8, load=500.0), ALPHA)
    assert found[ALPHA].value == pytest.approx(3e-15, rel=1e-8, abs=0)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: ApproachData([], 0.1), "approach"),
        (lambda: ApproachData("0.3", 0.1), "approach"),
        (lambda: ApproachData([[0.3]], 0.1), "approach"),
        (lambda: ApproachData([0.3, math.nan], 0.1), "approach"),
        (lambda: ApproachData([[0.3], [0.3, 0.4]], 0.1), "approach"),
        (lambda: ApproachData([0.3, True], 0.1), "approach"),
        (lambda: ApproachData(np.array([0.3 + 0j]), 0.1), "approach"),
        (lambda: PressureData([[0.1], []], 0.3, 0.1), "r"),
        (lambda: PressureData(0.1, 0.3, [[0.1], [0.1, 0.2]]), "sigma"),
        (lambda: PressureData(0.1, 0.3, 0.1, load=[1.0]), "load"),
        (lambda: StickRadiusData(0.5, 0.1, radius=[[1.0], 2.0]), "radius"),
        (lambda: StickRadiusData(0.5, 0.1, friction=np.datetime64("NaT", "s")), "friction"),
        (lambda: ApproachData(np.ma.masked_array([0.3, 0.4], [0, 1]), 0.1), "approach"),
        (lambda: ApproachData(0.3, 0.0), "sigma"),
        (lambda: ApproachData([0.3, 0.3, 0.3], [0.1, 0.1]), "sigma"),
        (lambda: ApproachData(0.3, 0.1, radius=[1.0, 2.0]), "radius"),
        (lambda: ApproachData(0.3, 0.1, load=-1.0), "load"),
        (lambda: PressureData([0.1, 0.2], 0.3, 0.1), "r"),
        (lambda: PressureData(-0.1, 0.3, 0.1), "r"),
        (lambda: StickRadiusData(0.5, 0.1, friction=math.inf), "friction"),
    ],
)
def test_bad_data_are_refused(make, name):
    with pytest.raises(SceneError) as caught:
        make()
    assert caught.value.parameter == name


@pytest.mark.parametrize(
    ("start", "data", "free", "message"),
    [
        # two values, but of the same punch: one number, two unknowns
        (
            Scene(0.3, 0.2, 0.1, 0.02),
            StickRadiusData([0.5, 0.51], 0.01),
            ("tangential_compliance", "friction"),
            "cannot distinguish tangential_compliance and friction",
        ),
        # less than the approach on a smooth surface
        (Scene(0.3, 0.2), ApproachData([0.1, 0.1], 0.01), ALPHA, "hardly change with normal_comp"),
        # the fit starts above the critical friction
        (
            Scene(0.3, 0.2, 0.1, 5.0),
            StickRadiusData(0.5, 0.01),
            "friction",
            "hardly change with friction at friction = 5",
        ),
        (
            Scene(0.5, 0.2, 0.1, 0.1),
            [ApproachData(0.2, 0.01), StickRadiusData([0.5, 0.5], 0.01)],
            PARAMETERS,
            "hardly change with tangential_compliance and friction",
        ),
    ],
)
def test_what_data_do_not_determine_is_named(start, data, free, message):
    with pytest.raises(SceneError) as caught:
        fit(start, data, free)
    assert caught.value.parameter == "free"
    assert message in str(caught.value)


@pytest.mark.parametrize(("friction", "told"), [(2e-6, False), (2e-3, True)])
def test_noise_of_the_derivatives_tells_no_parameters_apart(friction, told):
    """Small stick disks know the product of the two: the smaller, the better slopes would be."""
    start, radii = Scene(0.3, 0.2, 0.1, friction), np.array([1.0, 2.0])
    measured = [a * solve(Scene(0.3, 0.2 / a, 0.1 / a, friction)).stick_radius for a in radii]
    data = StickRadiusData(measured, 1e-9 * np.array(measured), radius=radii)
    free = ("tangential_compliance", "friction")
    if told:
        assert fit(start, data, free)["friction"].relative_error < 0.01
    else:
        with pytest.raises(SceneError, match="cannot distinguish tangential_compliance and fric"):
            fit(start, data, free)


def test_more_parameters_than_values_are_refused():
    with pytest.raises(SceneError, match="at most 1 parameters"):
        fit(Scene(0.3, 0.2, 0.1, 0.1), StickRadiusData(0.5, 0.1), PARAMETERS)


def test_a_fit_that_does_not_settle_says_so():
    with pytest.raises(ConvergenceError, match="not settled after 1 evaluations"):
        fit(Scene(0.3, 0.1), APPROACH, ALPHA, max_evaluations=1)


def test_failures_of_the_solver_name_the_scene(monkeypatch):
    from spectral_contact.calibration import estimate

    def tight(*arguments):
        return solve(*arguments, max_unknowns=20)

    monkeypatch.setattr(estimate, "solve", tight)
    with pytest.raises(ConvergenceError) as caught:
        fit(Scene(0.3, 0.1), APPROACH, ALPHA)
    assert "in a fit at Scene(poisson_ratio=0.3, normal_compliance=0.1" in caught.value.cause
    assert caught.value.solution is not None


def test_stick_radii_are_fitted_with_elastic_coupling():
    """It was left out: at nu = 0.1 this friction came out as 0.289 instead of 0.3."""
    coupled = Scene(0.1, 0.2, 0.1, 0.3, coupling=True)
    expected = solve(coupled, 1e-4, ["stick_radius"]).stick_radius
    setting = Setting.of(coupled, 1e-4, solve)
    layer = {name: getattr(coupled, name) for name in PARAMETERS}
    [found] = StickRadiusData([0.8], [1e-3]).predict(setting, layer)
    assert found == pytest.approx(expected, rel=1e-4)
    with pytest.raises(
        SceneError, match=r"^coupling = True: must be False for a fit of approaches"
    ):
        fit(coupled, ApproachData([0.3], [0.001]), "normal_compliance")
    with pytest.raises(SceneError, match=r"^coupling = True: must be False for a fit of pressures"):
        fit(coupled, PressureData([0.0], [0.3], [0.001]), "normal_compliance")
