"""Where signs change, and what the error of a boundary's logit is worth."""

import numpy as np
import pytest

from spectral_contact.contact.resolution import first_sign_change, radius_errors
from spectral_contact.fields.series import Radius


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


@pytest.mark.parametrize("logit", [-8.0, -0.6, 0.0, 0.6, 8.0])
def test_errors_of_a_radius_and_of_its_distance_from_the_edge(logit):
    step = 1e-6
    radius, moved = Radius.from_logit(logit), Radius.from_logit(logit + step)
    of_radius, of_distance = radius_errors(step, radius)
    assert of_radius == pytest.approx(moved.value / radius.value - 1.0, rel=1e-4)
    assert of_distance == pytest.approx(1.0 - moved.from_edge / radius.from_edge, rel=1e-4)


def test_a_logit_of_which_nothing_is_known_says_nothing_of_the_radius():
    assert radius_errors(0.6, Radius.from_logit(0.0)) == (np.inf, np.inf)
