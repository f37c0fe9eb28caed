"""Rates: intervals as scipy has them, laws told apart, plateaus found."""

import math

import numpy as np
import pytest
from scipy import stats

from spectral_contact import SceneError
from spectral_contact.studies import fit_rate

COUNTS = [10, 20, 40, 80, 160, 320]


def test_the_interval_is_that_of_linregress():
    random = np.random.default_rng(1)
    errors = np.exp(-2.0 * np.log(COUNTS) + 0.1 * random.standard_normal(6))
    rate, expected = (
        fit_rate(COUNTS, errors, confidence=0.9),
        stats.linregress(np.log(COUNTS), np.log(errors)),
    )
    half = expected.stderr * stats.t.ppf(0.95, 4)
    assert rate.kind == "algebraic"
    assert rate.value == pytest.approx(-expected.slope, rel=1e-12)
    assert rate.log_factor == pytest.approx(expected.intercept, rel=1e-12)
    assert rate.interval == pytest.approx((rate.value - half, rate.value + half), rel=1e-10)
    deviations = np.log(errors) - expected.intercept - expected.slope * np.log(COUNTS)
    left = np.sqrt(np.mean(deviations**2))
    assert rate.residuals["algebraic"] == pytest.approx(left, rel=1e-10)


NO_NUMBERS = [True, 1 + 0j, "1", np.datetime64("NaT", "s"), math.nan, [1.0], object()]


@pytest.mark.parametrize("value", [*NO_NUMBERS, -1.0, 10**400])
def test_rates_are_of_numbers(value):
    with pytest.raises(SceneError, match=r"^unknowns = "):
        fit_rate([1, 2, 3, value], [1e-1, 1e-2, 1e-3, 1e-4])
    with pytest.raises(SceneError, match=r"^errors = "):
        fit_rate([1, 2, 3, 4], [1e-1, 1e-2, 1e-3, value])
    with pytest.raises(SceneError, match=r"^floor = "):
        fit_rate([1, 2, 3, 4], [1e-1, 1e-2, 1e-3, 1e-4], floor=value)


def test_a_law_whose_factor_is_beyond_the_doubles():
    numbers = np.array([10_000, 10_010, 10_020, 10_030])
    errors = [1e-1, 1e-4, 1e-7, 1e-10]
    rate = fit_rate(numbers, errors)
    assert rate.kind != "algebraic"
    assert rate.log_factor > 800.0
    assert rate.at(numbers) == pytest.approx(errors, rel=1e-2)
    with pytest.raises(SceneError, match="unknowns"):
        rate.at([0])


def test_a_factor_beyond_the_doubles_gives_no_errors():
    numbers = [1.0, 1.0001, 1.0002]
    for errors in ([1e-6, 1e-1, 1e4], [1e4, 1e-1, 1e-6]):
        rate = fit_rate(numbers, errors)
        assert rate.value in (0.0, math.inf)
        assert np.isnan(rate.at(numbers)).all()


def test_less_than_one_unknown_is_refused():
    with pytest.raises(SceneError, match=r"^unknowns = 0\.5: must be 0 or in \[1, 1e\+15\]"):
        fit_rate([0.5, 1.0, 2.0], [1e-1, 1e-2, 1e-3])


def test_numbers_whose_logarithms_are_equal():
    rate = fit_rate([1e15 - 2.0, 1e15 - 1.0, 1e15], [1e-1, 1e-2, 1e-3])
    assert rate.kind == "geometric"
    assert rate.value == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize("confidence", [0.0, 1.0, math.nan, True, "0.5"])
def test_confidence_is_a_share(confidence):
    with pytest.raises(SceneError, match="confidence"):
        fit_rate([1, 2, 3], [1, 2, 3], confidence=confidence)


@pytest.mark.parametrize(
    ("kind", "value", "law"),
    [
        ("algebraic", 2.5, lambda n: 0.3 * n**-2.5),
        ("geometric", 1.2, lambda n: 7.0 * 1.2**-n),
        ("root-geometric", 8.0, lambda n: 2.0 * 8.0 ** -np.sqrt(n)),
    ],
)
def test_exact_laws_are_found(kind, value, law):
    numbers = np.array([10.0, 20.0, 30.0, 50.0, 80.0, 110.0])
    errors = law(numbers)
    rate = fit_rate(numbers, errors)
    assert rate.kind == kind
    assert rate.value == pytest.approx(value, rel=1e-10)
    assert rate.interval == pytest.approx((value, value), rel=1e-6)
    assert rate.rivals == ()
    assert min(rate.residuals, key=rate.residuals.get) == kind
    used = [i for i in range(6) if errors[i] > 2.3e-15]
    assert rate.used == tuple(used)
    assert rate.at(numbers[:3]) == pytest.approx(errors[:3], rel=1e-9)


def test_a_law_that_cannot_be_told_apart_is_said():
    rate = fit_rate([10, 11, 12], [1.00e-3, 0.90e-3, 0.82e-3])
    assert len(rate.rivals) == 2


def test_the_plateau_of_a_solver_is_left_out():
    numbers = np.arange(4, 40, 4)
    errors = np.maximum(10.0 ** (-numbers / 2.0), 3e-9 * np.array([1, 1.5, 0.7] * 3))
    rate = fit_rate(numbers, errors)
    assert rate.kind == "geometric"
    assert rate.used == (0, 1, 2, 3)
    assert rate.value == pytest.approx(10.0**0.5, rel=1e-9)


def test_two_points_are_enough_of_a_plateau():
    numbers, errors = [2, 4, 6, 8, 10], [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
    assert fit_rate([*numbers, 12, 14], [*errors, 9e-7, 1.1e-6]).used == (0, 1, 2, 3, 4)
    assert fit_rate([*numbers, 12], [*errors[:-1], 1.1e-6, 9e-7]).used == (0, 1, 2, 3)
    assert fit_rate([*numbers, 12], [*errors, 1.2e-7]).used == (0, 1, 2, 3, 4, 5)


def test_slow_convergence_is_no_plateau():
    numbers = [10, 11, 12, 13, 14, 15]
    assert fit_rate(numbers, [1.0 / n for n in numbers]).used == tuple(range(6))


def test_what_rounding_or_the_truth_hides_is_left_out():
    errors = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-16]
    assert fit_rate(COUNTS, errors).used == (0, 1, 2, 3, 4)
    assert fit_rate(COUNTS, errors, floor=1e-7).used == (0, 1, 2)
    # once rounding is reached its scatter is no error
    scattered = [1e-3, 1e-7, 1e-11, 3e-16, 5e-15, 4e-16]
    assert fit_rate(COUNTS, scattered).used == (0, 1, 2)


def test_missing_points_are_left_out():
    numbers = [10, None, 40, 80, 0, 160]
    errors = [1e-2, 1e-3, None, 1e-4, 1e-5, 2.5e-5]
    assert fit_rate(numbers, errors).used == (0, 3, 5)
    assert fit_rate([10, 20, 40, 80], [math.inf, 1e-2, 1e-3, 1e-4]).used == (1, 2, 3)


@pytest.mark.parametrize(
    ("numbers", "errors"),
    [([], []), ([10, 20], [1e-2, 1e-3]), ([5, 5, 5], [1e-2, 1e-3, 1e-4]), (COUNTS, [1e-16] * 6)],
)
def test_too_few_points_have_no_rate(numbers, errors):
    assert fit_rate(numbers, errors) is None


def test_lists_must_match():
    with pytest.raises(SceneError, match="unknowns, errors"):
        fit_rate([1, 2, 3], [1e-1])


def test_rates_as_text():
    assert str(fit_rate(COUNTS, [n**-2.0 for n in COUNTS])) == "order 2.000 [2.000, 2.000]"
    assert str(fit_rate([2, 4, 6], [2.0**-n for n in (2, 4, 6)])).endswith("per unknown")
    roots = [2.0**-n for n in (2, 4, 6)]
    assert str(fit_rate([4, 16, 36], roots)) == "factor 2 [2, 2] per root of the unknowns"
