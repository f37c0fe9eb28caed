"""Fitted rates: the interval holds the true value as often as it says, for every law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_contact.studies import fit_rate

NUMBERS = np.array([8.0, 12.0, 18.0, 27.0, 40.0, 60.0, 90.0])
LAWS = {
    "algebraic": lambda n, k: n**-k,
    "geometric": lambda n, k: np.exp(-n * k / 20.0),
    "root-geometric": lambda n, k: np.exp(-np.sqrt(n) * k / 2.0),
}


@given(st.sampled_from(list(LAWS)), st.floats(1.0, 3.0), st.floats(-3.0, 3.0))
def test_every_exact_law_is_recovered(kind, strength, level):
    errors = np.exp(level) * LAWS[kind](NUMBERS, strength)
    rate = fit_rate(NUMBERS, errors)
    assert rate.kind == kind
    assert rate.used == tuple(range(len(NUMBERS)))
    assert np.allclose(rate.at(NUMBERS), errors, rtol=1e-8)


@pytest.mark.parametrize("confidence", [0.5, 0.95])
def test_intervals_hold_the_order_as_often_as_they_say(confidence):
    random = np.random.default_rng(7)
    trials, held = 400, 0
    for _ in range(trials):
        errors = NUMBERS**-6.0 * np.exp(0.2 * random.standard_normal(len(NUMBERS)))
        rate = fit_rate(NUMBERS, errors, confidence=confidence)
        assert rate.kind == "algebraic"
        held += rate.interval[0] <= 6.0 <= rate.interval[1]
    spread = np.sqrt(confidence * (1.0 - confidence) / trials)
    assert abs(held / trials - confidence) < 4.0 * spread


def test_intervals_of_noisy_orders_hold_them():
    """The plateau and the law are chosen, too, which costs the interval little of its promise."""
    random = np.random.default_rng(11)
    trials, held = 500, 0
    for _ in range(trials):
        errors = NUMBERS**-2.0 * np.exp(0.1 * random.standard_normal(len(NUMBERS)))
        rate = fit_rate(NUMBERS, errors)
        held += rate.kind == "algebraic" and rate.interval[0] <= 2.0 <= rate.interval[1]
    assert held / trials > 0.9


def test_a_plateau_does_not_bend_the_rate():
    """Noise may slope for a while, so no rule is always right: here one draw in 20,000 bends it."""
    random = np.random.default_rng(3)
    numbers = np.arange(1, 16) * 6.0
    trials, bent = 300, 0
    for level in 10.0 ** random.uniform(-11.0, -6.0, trials):
        noise = np.exp(0.3 * random.standard_normal(len(numbers)))
        rate = fit_rate(numbers, 10.0 ** (-numbers / 6.0) + level * noise)
        if rate.kind == "geometric":
            right = abs(np.log10(rate.value) * 6.0 - 1.0) < 0.15
        else:  # of eight points, the last two on the plateau, the law may not be told
            right = "geometric" in rate.rivals and len(rate.used) <= 8
        bent += not (right and len(rate.used) <= -np.log10(level) + 2)
    assert bent <= 1
