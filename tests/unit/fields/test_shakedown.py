"""The shakedown ratio: its law, its limits, and what the error of the critical friction makes."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from spectral_contact import NotComputedError, Scene, solve
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.profiles import Parabola

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
ROUNDING = Fraction(1, 2**50)  # of the five operations of the law


def test_the_ratio_is_that_of_the_law():
    solution = solve(SCENE, 1e-12)
    assert solution.shakedown_ratio == pytest.approx(0.2222123728874, rel=3e-13, abs=0)
    assert solution.error.shakedown_ratio < 1e-12
    largest = solution.critical_friction
    assert solution.shakedown_ratio == pytest.approx((largest - 0.1) / (largest + 0.1), rel=1e-15)


def test_a_rough_one_is_within_its_error():
    loose, tight = (solve(SCENE, rtol, ("shakedown_ratio",)) for rtol in (1e-4, 1e-12))
    off = abs(loose.shakedown_ratio / tight.shakedown_ratio - 1.0)
    assert off <= loose.error.shakedown_ratio + tight.error.shakedown_ratio


@pytest.mark.parametrize(
    ("scene", "ratio"),
    [
        (SCENE.replace(friction=0.2), 0.0),  # nothing slips
        (SCENE.replace(friction=math.inf), 0.0),
        (SCENE.replace(poisson_ratio=0.5), 0.0),
        (SCENE.replace(tangential_compliance=0.0), 1.0),  # the edge always slips
        (SCENE.replace(friction=0.0), 1.0),
        (Scene(0.1, friction=0.1), 1.0),
    ],
)
def test_limits_are_exact(scene, ratio):
    for asked in (None, ("shakedown_ratio",)):
        solution = solve(scene, 1e-8, asked)
        assert solution.shakedown_ratio == ratio
        assert solution.error.shakedown_ratio == 0.0


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (SCENE.replace(coupling=True), "with elastic coupling its law is only approximate"),
        (SCENE.replace(friction=None), "the scene has no friction coefficient"),
        (
            Scene(0.1, friction=0.1, profile=Parabola(1.0), load=0.1),
            "it is not computed for growing contacts",
        ),
    ],
)
def test_where_the_law_does_not_hold_the_reason_is_said(scene, reason):
    with pytest.raises(NotComputedError, match=reason):
        _ = solve(scene, 1e-4, ("shakedown_ratio",)).shakedown_ratio


@example(1.0, 1.8908485888147197e-15, 0.9999885559082031, 1.0)  # next to R only roundings are left
@given(st.floats(1e-3, 1e3), st.floats(1e-15, 0.5), st.floats(0.0, 2.0), st.floats(-1.0, 1.0))
def test_the_error_covers_what_the_critical_friction_may_be(largest, lost, share, moved):
    friction = largest * share
    found = shakedown(largest, lost, friction)
    true_largest = Fraction(largest) / (1 + Fraction(lost) * Fraction(moved))
    f = Fraction(friction)
    truth = max((true_largest - f) / (true_largest + f), Fraction(0))
    if found.error < math.inf:
        assert abs(Fraction(found.ratio) - truth) <= (Fraction(found.error) + ROUNDING) * truth
    assert 0.0 <= found.ratio <= 1.0


def test_just_below_the_critical_friction_no_digit_may_be_known():
    found = shakedown([1.0, 1.0, 1.0], 1e-6, [1.0 - 1e-9, 1.0 + 1e-9, 1.1])
    assert found.ratio[0] > 0.0 == found.ratio[1]
    assert np.array_equal(found.error, [math.inf, 1.0, 0.0])
