import numpy as np
import pytest
from numpy.testing import assert_allclose

from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.abel import abel_left, abel_right
from spectral_contact.spectral.blocks import abel_integral_on
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, z_difference
from spectral_contact.spectral.transforms import transforms


@pytest.mark.parametrize("count", [1, 2, 7])
@pytest.mark.parametrize("width", [1.0, 2.0])
def test_transforms_are_the_matrices_at_the_sampling_points(count, width):
    panels = LogPanels(count, width, 6)
    coefficients = np.random.default_rng(3).standard_normal(panels.size)
    own = transforms(panels)
    mesh = count, width, 6
    for matrix, values in [
        (abel_right(panels.sampling_distances, *mesh), own.abel_right(coefficients)),
        (abel_left(panels.sampling_distances, *mesh), own.abel_left(coefficients)),
    ]:
        assert_allclose(values, matrix @ coefficients, rtol=0, atol=1e-14)


@pytest.mark.parametrize(("count", "other"), [(1, 1), (2, 5), (9, 3)])
@pytest.mark.parametrize("end", [EDGE, Radius(0.8, 0.2)])
def test_across_is_the_integral_past_the_first_panel(count, other, end):
    panels, points, start = LogPanels(count, 2.0, 8), LogPanels(other, 2.0, 10), Radius(0.6, 0.4)
    coefficients = np.random.default_rng(4).standard_normal(panels.size)
    half = z_difference(start, end) / 2.0
    outside, inside = GradedMesh(end, -1, half, panels), GradedMesh(start, 1, half, points)
    matrix = np.sqrt(half) * abel_right(2.0 - points.sampling_distances, count, 2.0, 8)
    values = abel_integral_on(inside, outside, coefficients, 1)
    assert_allclose(values, matrix @ coefficients, rtol=0, atol=2e-14)
    # and the other way round
    outside, inside = GradedMesh(end, -1, half, points), GradedMesh(start, 1, half, panels)
    values = abel_integral_on(outside, inside, coefficients, -1)
    assert_allclose(values, matrix @ coefficients, rtol=0, atol=2e-14)
