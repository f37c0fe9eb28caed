"""By what factor coefficients fall, what the error estimates rest on; and where signs change."""

import numpy as np
import pytest

from spectral_contact.contact.resolution import first_sign_change, table_rates


def rate(*coefficients):
    """The rate of one panel, whose last coefficient is that of its degree."""
    table = np.zeros((1, 20))
    table[0, : len(coefficients)] = coefficients
    return table_rates((len(coefficients) - 1,), table)[0]


def test_a_geometric_series_shows_its_factor():
    assert rate(*0.2 ** np.arange(8.0)) == pytest.approx(0.2)


def test_parity_does_not_deceive():
    coefficients = 0.2 ** np.arange(8.0)
    coefficients[1::2] = 0.0
    assert rate(*coefficients) == pytest.approx(0.2)


def test_a_longer_period_does_not_deceive():
    coefficients = 0.2 ** np.arange(9.0)
    coefficients[[6, 7]] = 0.0  # as if a sign changed: the larger ones are three degrees apart
    assert rate(*coefficients[:9]) == pytest.approx(0.2)


def test_too_fast_a_fall_is_an_accident():
    assert rate(0.5, 0.4, 0.1, 1e-2, -3e-5, 2e-7) == 0.3
    # exp(-x) does fall like that
    assert rate(1.0, 1.0, 0.36, 0.07, 1e-2, 1.1e-3, 9.8e-5, 7.7e-6) == pytest.approx(
        0.099, rel=0.01
    )


@pytest.mark.parametrize(("coefficients", "kept"), [((1.0, 0.5, 0.1), 0.3), ((1e-16,) * 9, 0.6)])
def test_what_shows_nothing_has_a_default(coefficients, kept):
    assert rate(*coefficients) == kept


@pytest.mark.parametrize("root", [1e-3, 0.7, 35.999])
def test_a_change_of_sign_is_found_to_rounding(root):
    for sign in (1.0, -1.0):
        assert first_sign_change(
            lambda x, sign=sign: sign * (x - root), 0.0, 36.0
        ) == pytest.approx(root, rel=4e-16)


def test_the_first_of_several_changes_of_sign_is_found():
    assert first_sign_change(np.sin, 0.5, 9.0) == pytest.approx(np.pi, rel=4e-16)


def test_without_a_change_of_sign_it_is_the_farther_end():
    assert first_sign_change(np.exp, 0.5, 9.0) == 9.0
