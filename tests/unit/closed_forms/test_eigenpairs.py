"""Degrees that are large, and those that are too large."""

import pytest

from spectral_contact import closed_forms as cf


@pytest.mark.parametrize("power", [12, 40, 100])
def test_eigenvalues_of_large_degrees(power):
    degree = 10**power
    assert cf.eigenvalue(degree, 0) == pytest.approx(1.0 / (2.0 * degree + 1.0), rel=1e-15)


def test_degrees_that_take_too_long_are_refused_by_name():
    for function in (cf.eigenfunction, cf.eigenfunction_image):
        with pytest.raises(ValueError, match=r"degree = .*at most 1e"):
            function(10**7, 0, 0.3)
    with pytest.raises(ValueError, match=r"degree = .*at most 1e"):
        cf.eigenvalue(10**101, 0)
