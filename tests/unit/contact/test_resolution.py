"""Where signs change, what the free boundaries begin with."""

import numpy as np
import pytest

from spectral_contact.contact.resolution import first_sign_change


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
