"""What must hold for every scene: the equations, identities, the friction law, honesty, units."""

import functools
import math

import numpy as np
from hypothesis import assume, example, given
from hypothesis import strategies as st
from oracles.property_settings import bounded, few

from spectral_contact import Scene, solve
from spectral_contact.testing import check_solution
from spectral_contact.testing.strategies import (
    compliances,
    full_stick_scenes,
    partial_slip_scenes,
    poisson_ratios,
    powers_of_ten,
    scenes,
)

EPS = 2.0**-52
TIGHT = 1e-11


positive = powers_of_ten(-13.9, 13.9)
tolerances = st.sampled_from([1e-2, 1e-3, 1e-4, 1e-6, 1e-8])


@functools.lru_cache(maxsize=512)
def solved(scene, rtol=TIGHT):
    return solve(scene, rtol)


@functools.cache
def rule():
    """Nodes y = 1 - s**2 and weights of integrals over x = -ln y, by Gauss on panels."""
    x, weights = np.polynomial.legendre.leggauss(20)
    panels = np.arange(0.0, 150.0, 0.5)
    x = (panels[:, None] + 0.25 * (1 + x)).ravel()
    return np.exp(-x), np.tile(0.25 * weights, panels.size)


def from_edge(y):
    return y / (1 + np.sqrt(1 - y))


def pressure_integral(solution, weight):
    """Return ``int_0^1 p weight s ds``; the weight is a function of p and y."""
    y, weights = rule()
    p = solution.pressure(from_edge=from_edge(y))
    return 0.5 * float(np.sum(weights * y * p * weight(p, y)))


def depths():
    """Distances from the edge all over the contact, at every scale."""
    return np.concatenate(
        [[0.0], np.geomspace(1e-30, 0.1, 60), np.linspace(0.12, 0.999, 60), 1 - 1e-6 * np.arange(3)]
    )


def away_from_boundaries(solution, share):
    """Those depths that are not near a zone boundary, relative to its distance from the ends."""
    d = depths()
    for zone in solution.zones[1:]:
        room = min(zone.inner, zone.inner_from_edge)
        d = d[np.abs(d - zone.inner_from_edge) > share * room]
    return d


# -- the equations themselves --------------------------------------------------------------------


@few
@given(st.one_of(full_stick_scenes(), partial_slip_scenes()), tolerances)
def test_solutions_solve_their_scenes(scene, rtol):
    check_solution(solved(scene, rtol), scene, rtol)


# -- the normal problem --------------------------------------------------------------------------


@bounded
@given(compliances())
@example(0.0)
@example(1e-14)
@example(1e14)
def test_pressure_bears_the_load(alpha):
    solution = solved(Scene(0.3, alpha))
    load = 2 * math.pi * pressure_integral(solution, lambda p, y: 1.0)
    assert abs(load - 1) <= solution.error.pressure + 100 * EPS


@bounded
@given(positive)
@example(1e-14)
@example(0.5)
def test_energy_identity_at_the_edge(alpha):
    # 2 pi alpha p(1)^2 = delta + alpha d delta/d alpha, and d delta/d alpha = 2 pi int p^2 s ds
    solution = solved(Scene(0.3, alpha))
    slope = 2 * math.pi * pressure_integral(solution, lambda p, y: p)
    left = 2 * math.pi * alpha * solution.pressure(from_edge=0.0) ** 2
    right = solution.approach + alpha * slope
    assert abs(left / right - 1) <= 4 * solution.error.pressure + 100 * EPS


@bounded
@given(positive)
def test_approach_by_reciprocity_with_the_smooth_punch(alpha):
    # delta = 1/8 + 2 pi alpha int p0 p s ds, p0 = 1/(2 pi sqrt(y))
    solution = solved(Scene(0.3, alpha))
    excess = alpha * pressure_integral(solution, lambda p, y: 1 / np.sqrt(y))
    bound = solution.error.approach + solution.error.pressure + 100 * EPS
    assert abs(solution.approach / (0.125 + excess) - 1) <= bound


@bounded
@given(powers_of_ten(-8, 8), powers_of_ten(-1, 1))
def test_slope_of_the_approach(alpha, spread):
    # the mean slope lies between those at the ends, as the approach is concave
    below, above = alpha, alpha * (1 + spread)
    low, high = solved(Scene(0.3, below)), solved(Scene(0.3, above))
    mean = (high.approach - low.approach) / (above - below)
    noise = (high.approach * high.error.approach + low.approach * low.error.approach) / (
        above - below
    )
    slope_low, slope_high = (
        2 * math.pi * pressure_integral(one, lambda p, y: p) for one in (low, high)
    )
    assert slope_high * (1 - 1e-10) - noise <= mean <= slope_low * (1 + 1e-10) + noise


@bounded
@given(positive, positive)
def test_approach_increases_and_is_concave(one, other):
    below, above = sorted((one, other))
    assume(above > below * 1.001)
    middle = math.sqrt(below * above)
    low, mid, high = (
        solve(Scene(0.3, alpha), 1e-12, ("approach",)).approach for alpha in (below, middle, above)
    )
    noise = 1e-13 * high
    assert low <= mid + noise
    assert mid <= high + noise
    share = (middle - below) / (above - below)
    assert mid >= low + share * (high - low) - noise


@bounded
@given(compliances())
def test_pressure_is_positive_and_rises_to_the_edge(alpha):
    solution = solved(Scene(0.3, alpha))
    p = solution.pressure(from_edge=np.sort(depths()))
    assert np.all(p > 0)
    assert np.all(p[1:] <= p[:-1] * (1 + 4 * solution.error.pressure))


# -- the friction law ----------------------------------------------------------------------------


def check_friction_law(scene):
    solution = solved(scene)
    f, d = scene.friction, depths()
    p, q, slip = (
        field(from_edge=d) for field in (solution.pressure, solution.traction, solution.slip)
    )
    finite = np.isfinite(p)
    assert np.all(np.abs(q[finite]) <= f * p[finite] * (1 + 1e-11))
    assert 0 <= solution.total_shear <= f * (1 + 1e-14)
    assert solution.error.violation <= 1e-9
    for zone in solution.zones:
        inside = finite & (d > zone.outer_from_edge) & (d < zone.inner_from_edge)
        if zone.kind == "stick":
            assert np.all(slip[inside] == 0)
        else:
            assert np.all(np.abs(np.abs(q[inside]) - f * p[inside]) <= 1e-13 * f * p[inside])
            assert np.all(slip[inside] * q[inside] <= 0)
    return solution


@few
@given(partial_slip_scenes())
@example(Scene(0.1, 1e3, 10.0, 1e-3))
@example(Scene(0.3, 0.05, 1.0, 0.23 * 0.4 / 2.8))
def test_friction_law(scene):
    solution = check_friction_law(scene)
    assert solution.converged
    assert solution.zones[0].kind == "stick"
    assert 0 < solution.stick_radius < 1
    assert "slip" in [zone.kind for zone in solution.zones]


@few
@given(scenes(powers_of_ten(-3, 2)))
def test_slip_if_and_only_if_friction_is_below_the_critical(scene):
    critical = solved(
        Scene(
            scene.poisson_ratio,
            scene.normal_compliance,
            scene.tangential_compliance,
            math.inf,
        ),
        1e-8,
    ).critical_friction
    assume(abs(scene.friction / critical - 1) > 1e-5)
    # beyond this the slip annulus is narrower than a double can tell from nothing
    assume(math.isfinite(critical) or scene.friction < 100 * scene.kappa)
    kinds = [zone.kind for zone in solved(scene, 1e-6).zones]
    assert ("slip" in kinds) == (scene.friction < critical)


@few
@given(partial_slip_scenes())
def test_friction_lowers_the_shear_of_full_stick(scene):
    stuck = Scene(
        scene.poisson_ratio, scene.normal_compliance, scene.tangential_compliance, math.inf
    )
    assert solved(scene, 1e-8).total_shear <= solved(stuck, 1e-8).total_shear * (1 + 1e-12)


# -- honesty -------------------------------------------------------------------------------------


def differs(loose, tight):
    """Largest relative difference; equal infinities do not differ."""
    loose, tight = np.broadcast_arrays(np.asarray(loose, float), np.asarray(tight, float))
    some = (loose != tight) & (tight != 0)
    return float(np.max(np.abs(loose[some] / tight[some] - 1), initial=0.0))


def check_honest(scene, rtol):
    loose, tight = solved(scene, rtol), solved(scene)
    names = ("approach", "total_shear", "stick_radius", "edge_ratio", "critical_friction")
    for name in names:
        bound = getattr(loose.error, name) + getattr(tight.error, name) + 4 * EPS
        assert differs(getattr(loose, name), getattr(tight, name)) <= bound, name
    bound = loose.error.pressure + tight.error.pressure + 4 * EPS
    assert differs(loose.pressure(from_edge=depths()), tight.pressure(from_edge=depths())) <= bound
    kinds = [zone.kind for zone in tight.zones]
    assert [zone.kind for zone in loose.zones] == kinds
    for one, other in zip(loose.zones, tight.zones, strict=True):
        bound = loose.error.zones + tight.error.zones + 4 * EPS
        assert differs(one.inner, other.inner) <= bound
        assert differs(one.inner_from_edge, other.inner_from_edge) <= bound
    d = away_from_boundaries(tight, 0.02 + 100 * loose.error.zones)
    bound = loose.error.traction + tight.error.traction + 4 * EPS
    assert differs(loose.traction(from_edge=d), tight.traction(from_edge=d)) <= bound
    largest = np.max(np.abs(tight.slip(from_edge=depths())))
    error = np.max(np.abs(loose.slip(from_edge=d) - tight.slip(from_edge=d)))
    assert error <= (loose.error.slip + tight.error.slip + 4 * EPS) * largest
    return loose


def check_converged(solution):
    error = solution.error
    assert solution.converged
    for estimate in (error.approach, error.pressure, error.traction, error.total_shear):
        assert estimate <= solution.rtol


@bounded
@given(full_stick_scenes(), tolerances)
def test_full_stick_is_honest(scene, rtol):
    check_honest(scene, rtol)
    check_converged(solved(scene, rtol))


@few
@given(partial_slip_scenes(), tolerances)
def test_partial_slip_is_honest(scene, rtol):
    check_honest(scene, rtol)
    check_converged(solved(scene, rtol))


@bounded
@given(scenes(st.just(0.0)), tolerances)
def test_slip_everywhere_is_honest(scene, rtol):
    check_honest(scene, rtol)
    check_converged(solved(scene, rtol))


# -- symmetries ----------------------------------------------------------------------------------


@few
@given(partial_slip_scenes(), poisson_ratios())
def test_only_friction_over_kappa_matters(scene, nu):
    other = Scene(nu, scene.normal_compliance, scene.tangential_compliance, 1.0)
    ratio = other.kappa / scene.kappa
    other = Scene(nu, scene.normal_compliance, scene.tangential_compliance, scene.friction * ratio)
    first, second = solved(scene, 1e-8), solved(other, 1e-8)
    # f/kappa of the two differ by rounding, and so do their solutions
    bound = first.error.total_shear + second.error.total_shear + 100 * EPS
    assert differs(second.total_shear, first.total_shear * ratio) <= bound
    bound = first.error.stick_radius + second.error.stick_radius
    assert differs(second.stick_radius, first.stick_radius) <= bound


exponents = st.integers(-20, 20).map(lambda k: 2.0**k)
moderate = powers_of_ten(-6, 3)


@bounded
@given(
    exponents,
    exponents,
    exponents,
    powers_of_ten(-6, 3),
    powers_of_ten(-6, 3),
    st.floats(0.02, 0.3),
)
def test_units_do_not_matter(length, stiffness, force, alpha, beta, friction):
    # powers of two scale without rounding, so the dimensionless scene has the same bits
    def scene(a, e, p):
        unit = 4.0 * (1 - 0.25**2) * a / e
        return Scene.from_physical(
            youngs_modulus=e,
            poisson_ratio=0.25,
            radius=a,
            load=p,
            normal_compliance=alpha * unit,
            tangential_compliance=beta * unit,
            friction=friction,
        )

    assume(not (beta < 1e-9 and alpha < beta / 10))
    one = solved(scene(1.0, 1.0, 1.0), 1e-4)
    other = solved(scene(length, length**-2 * stiffness, force), 1e-4)
    assert (other.approach, other.total_shear) == (one.approach, one.total_shear)
    assert other.zones == one.zones
    assert other.physical.total_shear == one.physical.total_shear * force
    unit = force / (length * (length**-2 * stiffness))
    assert other.physical.approach == one.physical.approach * unit
    r = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    scaled = other.physical.pressure(r * length) * length**2 / force
    assert np.array_equal(scaled, one.physical.pressure(r))
