"""Spectral moments of surfaces whose moments are known, and of what is missing of them."""

import math

import numpy as np
import pytest

from spectral_contact import SceneError
from spectral_contact.asperities import from_height_map, from_profile, greenwood_williamson

STEP = 0.5e-6


def waves(count=128, rows=256):
    """Return random plane waves in all directions, and their mean squares in closed form."""
    random, x = np.random.default_rng(0), np.arange(rows) * STEP
    grid, moments = np.meshgrid(x, x, indexing="ij"), np.zeros(3)
    z = np.zeros((rows, rows))
    for _ in range(count):
        k = 2 * np.pi / random.uniform(8e-6, 30e-6)
        angle, phase = random.uniform(0, 2 * np.pi, 2)
        z += 1e-8 * np.cos(k * (grid[0] * np.cos(angle) + grid[1] * np.sin(angle)) + phase)
        moments += 1e-16 / 2 * np.array([1.0, k**2 / 2, 3 * k**4 / 8])
    return z, moments


MAP, MOMENTS = waves()


def test_moments_are_those_of_the_waves():
    """Within what a finite map scatters, of 128 waves: 8 % of the heights, 5 % of the others."""
    found = from_height_map(MAP, "0.5 um")
    m2, m4 = MOMENTS[1:]
    assert found.rms_height == pytest.approx(math.sqrt(MOMENTS[0]), rel=0.08)
    assert found.rms_slope == pytest.approx(math.sqrt(m2), rel=0.05)
    assert found.rms_curvature == pytest.approx(math.sqrt(m4), rel=0.05)
    assert found.density == pytest.approx(m4 / (6 * math.pi * math.sqrt(3) * m2), rel=0.08)
    assert found.tip_radius == pytest.approx(3 * math.sqrt(math.pi) / 8 / math.sqrt(m4), rel=0.05)
    assert found.remarks == ()
    assert max(found.error.values()) < 0.1
    layer = greenwood_williamson(
        **found.asperities, youngs_modulus=2e11, poisson_ratio=0.3, pressure=1e5
    )
    assert layer.normal_compliance > 0.0


def test_summits_are_as_many_and_as_high_as_those_that_are_counted():
    found = from_height_map(MAP, STEP)
    n = len(MAP)
    around = [MAP[1 + i : n - 1 + i, 1 + j : n - 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    tops = np.all([around[4] > one for k, one in enumerate(around) if k != 4], axis=0)
    area = ((n - 2) * STEP) ** 2
    assert found.density == pytest.approx(tops.sum() / area, rel=0.15)
    assert found.height_deviation == pytest.approx(around[4][tops].std(), rel=0.2)


def test_a_tilted_surface_has_the_same_numbers_and_edges_are_not_joined():
    """A tilt would be a step where a map were wrapped."""
    tilt = 0.1 * STEP * np.add.outer(np.arange(256), np.zeros(256))
    plain, tilted = from_height_map(MAP, STEP), from_height_map(MAP + tilt, (STEP, STEP))
    for name, value in plain.asperities.items():
        assert tilted.asperities[name] == pytest.approx(value, rel=1e-9)
        assert tilted.sensitivity[name] == pytest.approx(plain.sensitivity[name], abs=1e-9)


def test_missing_points_are_counted_and_left_out():
    holes = MAP.copy()
    holes[10:14, 20:30] = np.nan
    found = from_height_map(holes, STEP)
    assert found.missing == 40
    assert found.remarks == ("40 of 65536 points are missing and left out.",)
    assert found.density == pytest.approx(from_height_map(MAP, STEP).density, rel=0.01)


def test_noise_of_single_points_makes_curvature_a_matter_of_the_cutoff():
    noisy = MAP + 1e-8 * np.random.default_rng(1).standard_normal(MAP.shape)
    raw = from_height_map(noisy, STEP)
    assert raw.density > 3.0 * from_height_map(MAP, STEP).density
    assert any("power" in one for one in raw.remarks)
    mild = from_height_map(noisy, STEP, cutoff="6 um")
    assert mild.tip_radius == pytest.approx(from_height_map(MAP, STEP).tip_radius, rel=0.3)


def test_a_profile_has_the_numbers_of_its_line():
    """Of one wave, cos kx: m0 = A²/2, m2 = m0 k², m4 = m2 k²."""
    k = 2 * np.pi / 40e-6
    found = from_profile(1e-8 * np.cos(k * STEP * np.arange(1600)), STEP)
    assert found.rms_height == pytest.approx(1e-8 / math.sqrt(2.0), rel=1e-3)
    assert found.rms_slope == pytest.approx(1e-8 * k / math.sqrt(2.0), rel=2e-3)
    assert found.rms_curvature == pytest.approx(1e-8 * k**2 / math.sqrt(2.0), rel=2e-3)
    assert "below 1.5" in found.remarks[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: from_profile(np.zeros(4), 1.0), "16 heights or more"),
        (lambda: from_height_map(np.zeros((20, 20)), 1.0), "not all on one plane"),
        (lambda: from_height_map(MAP[0], 1.0), "rows and columns"),
        (lambda: from_height_map(MAP, 0.0), "spacing"),
        (lambda: from_height_map(MAP, (1.0, 1.0, 1.0)), "spacing"),
        (lambda: from_height_map(MAP, STEP, cutoff=STEP), "cutoff"),
        (lambda: from_profile(np.full(99, np.nan), 1.0), "less than half"),
        (lambda: from_profile([math.inf] * 20, 1.0), "finite"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(SceneError, match=message):
        call()


def test_rounding_of_a_plane_is_no_surface():
    tilted = np.add.outer(3e-8 * np.arange(20.0), 1e-8 * np.arange(20.0))
    with pytest.raises(SceneError, match="not all on one plane"):
        from_height_map(tilted, 1e-6)


def test_a_map_that_lacks_every_third_line_has_the_moments_along_the_others():
    """Along the columns no three heights follow each other, and the map was refused."""
    x, y = np.meshgrid(np.arange(90.0), np.arange(90.0))
    waves = 1e-7 * (np.sin(0.3 * x) + np.sin(0.3 * y))
    lacking = waves.copy()
    lacking[::3] = np.nan
    whole, some = from_height_map(waves, 1e-6), from_height_map(lacking, 1e-6)
    assert some.rms_slope == pytest.approx(whole.rms_slope, rel=0.02)
    assert some.rms_curvature == pytest.approx(whole.rms_curvature, rel=0.02)


@pytest.mark.parametrize("size", [1e-90, 1e90])
def test_lengths_whose_squares_are_no_doubles_are_refused_by_name(size):
    heights = np.random.default_rng(0).normal(size=200)
    with pytest.raises(SceneError, match=r"heights = .*in \[1e-30, 1e\+30\] m"):
        from_profile(heights * size, 1.0)
    with pytest.raises(SceneError, match=r"spacing = .*in \[1e-30, 1e\+30\] m"):
        from_profile(heights, size)


def test_a_map_that_is_too_short_for_any_filter_says_so():
    heights = np.random.default_rng(0).normal(size=(16, 16))
    with pytest.raises(SceneError, match=r"cutoff = 3e-05: must be None: a side of 1\.6e-05 m"):
        from_height_map(heights, (1e-6, 1e-4), cutoff=3e-5)
