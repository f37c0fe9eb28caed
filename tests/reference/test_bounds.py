"""The bracket of the approach holds the truth, for good and for bad pressures."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, solve
from spectral_contact.bounds import approach_bounds

#: Digits of `precise.reference`.
TRUE = {
    0.5: 0.292959796910478141398839,
    1e-12: 0.125000000002324317631376,
    1.0: 0.4527013908697527953262,
    1e-3: 0.1256784699526635521037,
}
every_roughness = pytest.mark.parametrize("alpha", TRUE)


@every_roughness
@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-6])
def test_the_bracket_holds_the_truth(alpha, rtol):
    lower, upper = solve(Scene(0.3, alpha), rtol).approach_bounds
    assert lower <= TRUE[alpha] <= upper
    assert upper - lower <= 1e-13 * upper


@pytest.mark.parametrize("alpha", [1e-3, 0.5])
def test_bad_pressures_widen_it_by_the_square_of_their_error(alpha):
    solution = solve(Scene(0.3, alpha), 1e-3)
    field, widths = solution.pressure_field, []
    rng = np.random.default_rng(3)
    for size in (1e-2, 1e-4):
        noise = 1.0 + size * rng.uniform(-1.0, 1.0, field.series.coefficients.shape)
        series = replace(field.series, coefficients=field.series.coefficients * noise)
        lower, upper = approach_bounds(alpha, solution.approach, replace(field, series=series))
        assert lower <= TRUE[alpha] <= upper
        widths.append(upper / lower - 1.0)
    assert widths[0] >= 1e-7
    assert 1e3 <= widths[0] / widths[1] <= 1e5


def test_a_wrong_scale_does_not_matter():
    solution = solve(Scene(0.3, 0.5), 1e-3)
    right = approach_bounds(0.5, solution.approach, solution.pressure_field)
    lower, upper = approach_bounds(0.5, 1.001 * solution.approach, solution.pressure_field)
    assert lower <= right[0] <= right[1] <= upper


def test_smooth_surfaces_are_known_exactly():
    assert solve(Scene(0.3)).approach_bounds == (0.125, 0.125)


def test_the_pressure_must_have_been_asked_for():
    solution = solve(Scene(0.3, 0.5), quantities=["approach"])
    with pytest.raises(NotComputedError, match="pressure"):
        _ = solution.approach_bounds
