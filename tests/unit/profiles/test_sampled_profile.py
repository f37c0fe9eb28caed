"""Profiles through points: what is convex is taken, and stays convex; what is not is named."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from oracles.property_settings import bounded
from scipy.special import modstruve

from spectral_contact import Scene, SceneError, profiles, solve

from_points = profiles.Sampled.from_points


@st.composite
def convex_tables(draw):
    """Return radii and heights whose secants do not fall: equal ones, jumps and tiny ones, too."""
    count = draw(st.integers(2, 12))
    steps = draw(st.lists(st.floats(0.01, 1.0), min_size=count, max_size=count))
    rises = st.one_of(
        st.just(0.0), st.floats(1e-3, 1.0), st.floats(-12.0, 0.0).map(lambda e: 10**e)
    )
    secants = np.cumsum(draw(st.lists(rises, min_size=count, max_size=count)))
    secants[-1] += 1e-3
    radii = np.concatenate([[0.0], np.cumsum(steps)])
    heights = np.concatenate([[0.0], np.cumsum(secants * np.diff(radii))])
    return radii, heights


def slopes_of_pieces(table):
    """Return the slopes at many radii of every piece, its ends included, as the pieces follow."""
    x = np.linspace(-1.0, 1.0, 33)
    return np.array([np.polynomial.chebyshev.chebval(x, row) for row in table.slopes])


@settings(bounded, max_examples=60)
@given(convex_tables())
@example((np.arange(4.0), np.array([0.0, 0.1, 1.0, 2.0])))
def test_convex_tables_are_accepted_and_stay_convex(points):
    radii, heights = points
    table = from_points(radii, heights)
    scale = heights.max()
    assert np.abs(table.height(radii) - heights).max() <= 1e-14 * scale
    slopes = slopes_of_pieces(table).ravel()
    slack = 1e-13 * slopes.max()
    assert slopes.min() >= -slack
    assert np.diff(slopes).min() >= -slack
    # no piece is much shorter than the interval that it is made of
    assert np.diff(table.edges).min() > np.diff(radii).min() / 60.0


@bounded
@given(convex_tables(), st.integers(-30, 30), st.integers(-30, 30))
def test_units_of_radii_and_heights_do_not_matter(points, length, height):
    radii, heights = points
    table = from_points(radii, heights)
    wide, high = 2.0**length, 2.0**height
    scaled = from_points(wide * radii, high * heights)
    assert np.array_equal(scaled.height(wide * radii) / high, table.height(radii))


def test_two_hundred_random_tables():
    rng = np.random.default_rng(39)
    for _ in range(200):
        radii = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 1.0, 8))])
        secants = np.sort(rng.uniform(0.0, 1.0, 8))
        from_points(radii, np.concatenate([[0.0], np.cumsum(secants * np.diff(radii))]))


def test_the_slope_is_continuous_where_the_points_are_no_corner():
    rng = np.random.default_rng(4)
    for _ in range(50):
        radii = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 1.0, 8))])
        secants = np.cumsum(rng.uniform(0.5, 1.0, 8))
        table = from_points(radii, np.concatenate([[0.0], np.cumsum(secants * np.diff(radii))]))
        slopes = slopes_of_pieces(table)
        assert np.abs(slopes[1:, 0] - slopes[:-1, -1]).max() < 1e-13 * slopes.max()


@pytest.mark.parametrize(
    ("height", "told"),
    [
        (lambda r: r**2 / 2.0, 1e-15),
        (lambda r: 3.0 * r, 1e-15),
        (lambda r: np.where(r < 0.75, 0.0, 2.0 * (r - 0.75)), 1e-15),
        (lambda r: r**2 + r, 1e-15),
    ],
    ids=["parabola", "cone", "truncated cone", "parabola with a tip"],
)
def test_parabolas_and_lines_are_reproduced(height, told):
    radii = np.array([0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0])
    table = from_points(radii, height(radii))
    r = np.linspace(0.0, 2.0, 333)
    assert np.abs(table.height(r) - height(r)).max() < told * height(2.0)
    assert len(table.slopes) == len(radii) - 1


@pytest.mark.parametrize(
    "height",
    [
        lambda r: np.cosh(2.0 * r) - 1.0,
        lambda r: 1.0 - np.sqrt(1.0 - 0.5 * r**2),
        lambda r: np.sqrt(0.1 + r**2) - np.sqrt(0.1),
    ],
    ids=["cosh", "sphere", "hyperbola"],
)
def test_smooth_data_are_reproduced_to_the_fourth_order(height):
    r = np.linspace(0.0, 1.0, 2001)
    errors = []
    for count in (17, 33, 65):
        radii = np.linspace(0.0, 1.0, count)
        table = from_points(radii, height(radii))
        assert len(table.slopes) == count - 1
        errors.append(np.abs(table.height(r) - height(r)).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 3.5


def test_a_corner_that_points_do_not_resolve_stays_a_corner():
    table = from_points([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 0.0, 1.0, 2.0])
    assert table.slopes == ((0.0,), (0.0,), (1.0,), (1.0,))
    nearly = from_points([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 1e-9, 1.0, 2.0 + 1e-9])
    assert len(nearly.slopes) < 8
    assert nearly.height(2.5) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(
    ("radii", "heights", "told"),
    [
        ([0, 1, 2, 3], [0, 2, 3, 3.5], r"heights = 2.0: must be convex: the point 1, .* 0.5 above"),
        ([0, 1, 2, 3], [0, 1, 2, 2.9], r"heights = 2.0: .* the point 2, .* radius 2 .* 0.05 above"),
        ([0, 1, 2], [0, -1, 2], r"heights = -1.0: must be at least 0: they fall .* radius 1"),
        ([0, 1, 2], [0, 0, 0], "slope = 0.0: must be positive where the profile ends"),
    ],
)
def test_where_points_are_not_convex_is_named(radii, heights, told):
    with pytest.raises(SceneError, match=told):
        from_points(radii, heights)


def test_a_table_of_a_sphere_bears_what_the_sphere_bears():
    radii = np.linspace(0.0, 0.6, 13)
    table = from_points(radii, 1.0 - np.sqrt(1.0 - radii**2))
    given = solve(Scene(0.3, 0.1, profile=table, contact_radius=0.43), 1e-8, ["load"])
    exact = solve(
        Scene(0.3, 0.1, profile=profiles.Sphere(1.0), contact_radius=0.43), 1e-8, ["load"]
    )
    assert given.load == pytest.approx(exact.load, rel=1e-5)


def test_the_hull_of_noisy_points_is_convex_and_says_how_far_it_lies():
    radii = np.linspace(0.0, 1.0, 41)
    noise = 1e-3 * np.random.default_rng(2).standard_normal(41)
    heights = radii**2 + np.where(radii > 0.0, noise, 0.0)
    with pytest.raises(SceneError, match="convex_hull=True"):
        from_points(radii, heights)
    hull = profiles.hull_of_points(radii, heights)
    profile = from_points(radii, heights, convex_hull=True)
    on_hull = np.interp(radii, hull.radii, hull.heights)
    above = np.maximum(heights, 0.0) - on_hull
    assert above.min() > -1e-15  # from below
    assert np.abs(heights - on_hull).max() == pytest.approx(hull.largest)
    assert 1e-3 < hull.largest < 6e-3
    assert hull.rms < hull.largest
    assert np.asarray(profile.height(np.array(hull.radii))) == pytest.approx(hull.heights)
    secants = np.diff(hull.heights) / np.diff(hull.radii)
    assert (np.diff(secants) > 0.0).all()


def test_the_hull_of_convex_points_is_these_points():
    radii = [0.0, 1.0, 2.0, 3.0]
    hull = profiles.hull_of_points(radii, [0.0, 0.1, 1.0, 2.5])
    assert (hull.radii, hull.largest) == (tuple(radii), 0.0)
    line = profiles.hull_of_points(radii, [0.0, 1.5, 2.5, 3.0])
    assert line.heights[1] == pytest.approx(line.radii[1])
    with pytest.raises(SceneError, match="above 0 where the profile ends"):
        profiles.hull_of_points([0.0, 1.0, 2.0], [0.0, -1.0, -2.0])


def steep_sample():
    """Return a profile whose slope at the reach is 1e12 times that next to the centre."""
    return profiles.Sampled.from_functions(
        lambda r: (np.cosh(30.0 * r) - 1.0) / 30.0,
        lambda r: np.sinh(30.0 * r),
        reach=1.0,
        rounded=True,
    )


def test_no_digit_is_known_where_the_slope_is_below_its_error():
    """The error of the series of the slope is relative to its largest value."""
    found = solve(Scene(0.3, profile=steep_sample(), contact_radius=1e-4), 1e-6, strict=False)
    assert not found.converged
    assert found.error.pressure == np.inf


def test_with_coupling_the_error_of_a_sampled_profile_is_part_of_the_estimates():
    scene = Scene(0.3, 0.01, 0.01, np.inf, profile=steep_sample(), contact_radius=0.3)
    uncoupled = solve(scene, 1e-3, ["load"])
    coupled = solve(scene.replace(coupling=True), 1e-3, ["load"])
    by_profile = steep_sample()._relative_error(0.3)
    assert by_profile > 1e-6
    assert uncoupled.error.load >= by_profile
    assert coupled.error.load >= by_profile


def catenary():
    return profiles.Sampled.from_functions(
        lambda r: np.cosh(r) - 1.0, np.sinh, reach=1.0, rounded=True
    )


def test_heights_next_to_the_centre_and_to_a_break_have_digits():
    """A difference of integrals has none there."""
    smooth = catenary()
    for radius in (1e-8, 1e-4, 0.5):
        expected = 2.0 * np.sinh(radius / 2.0) ** 2
        assert smooth.height(radius) == pytest.approx(expected, rel=1e-15 / radius + 1e-15)


def test_a_contact_grows_from_the_centre_of_a_sampled_profile():
    """Without digits of the heights there it was refused."""
    coupled = Scene(0.2, friction=0.3, coupling=True, profile=catenary(), contact_radius=0.1)
    found = solve(coupled, 1e-5, ["load"])
    parabola = solve(coupled.replace(profile=profiles.Parabola(1.0)), 1e-5, ["load"])
    assert found.load == pytest.approx(parabola.load, rel=0.1**2)


def test_a_piece_before_a_steep_one_has_its_own_digits():
    """It was fitted to a part of the largest slope of all, and came out flat, with error 0."""
    steep = profiles.Sampled.from_functions(
        lambda r: (np.cosh(5.0 * r) - 1.0) / 5.0,
        lambda r: np.sinh(5.0 * r),
        reach=10.0,
        breaks=(1.0,),
    )
    assert steep.flat_part == 0.0
    radius = 0.3
    expected = np.pi * radius * modstruve(0, 5.0 * radius)
    found = float(steep._transform(np.array([radius]))[0])
    assert abs(found / expected - 1.0) < steep._relative_error(radius) < 1e-11


def test_rounding_next_to_a_flat_part_is_no_reason_to_refuse():
    def slope(r):
        return np.maximum((r**2 - 1.0) / 4.0, 0.0)

    flat_ended = profiles.Sampled.from_functions(
        lambda r: np.where(r > 1.0, (r**3 - 3.0 * r + 2.0) / 12.0, 0.0),
        lambda r: slope(r) + 1e-16 * np.sin(1e5 * r),
        reach=2.0,
        breaks=(1.0, 1.0001),
    )
    assert 1e-16 < flat_ended._slope_error(1.0) < 1e-14


@pytest.mark.parametrize("c", [0.3, 0.15, 0.05])
def test_a_round_tip_that_is_small_beside_the_contact_has_its_load(c):
    """Without panels to the centre the last was off by 5e-9, with an estimate of 1e-13."""
    tip = profiles.Sampled.from_functions(
        lambda r: r**2 / (np.hypot(r, c) + c), lambda r: r / np.hypot(r, c), reach=1.5, rounded=True
    )
    # H = 2 t arctan(t/c), and the load is 4 int H(1) - H(t) dt
    exact = 4.0 * ((1.0 - c**2) * np.arctan(1.0 / c) + c)
    found = solve(Scene(0.3, profile=tip, contact_radius=1.0), 1e-12, ["load"])
    assert abs(found.load / exact - 1.0) <= found.error.load < 1e-12
