"""The solver on scenes that have closed forms: true errors against the errors reported.

Smooth surfaces: pressure, full stick, partial slip; and the rough normal problem where its
series are exact to rounding. That an error meets the tolerance and that it does not exceed its
estimate are asserted apart.
"""

import functools
import math

import numpy as np
import pytest

from spectral_contact import Scene, closed_forms, solve

NU = 0.0
KAPPA = 0.25
RATIOS = (0.05, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
RTOLS = (1e-2, 1e-4, 1e-8, 1e-12)
#: What double precision leaves of an exact value, and of its comparison with another.
EPS = 8 * 2.0**-52
DEPTHS = np.array([1e-300, 1e-100, 1e-30, 1e-16, 1e-8, 1e-3, 0.05, 0.3, 0.6, 0.9, 0.999])

every_scene = pytest.mark.parametrize("ratio", RATIOS)
every_tolerance = pytest.mark.parametrize("rtol", RTOLS)


@functools.cache
def sliding(ratio, rtol):
    """The partial slip solution at friction ``ratio * kappa``."""
    return solve(Scene(NU, friction=ratio * KAPPA), rtol)


@functools.cache
def stuck(rtol):
    return solve(Scene(NU, friction=math.inf), rtol)


def exact_radius(ratio):
    return closed_forms.stick_radius(NU, ratio * KAPPA)


def off(value, exact):
    """Largest relative error, with what rounding of the comparison adds taken off."""
    return float(np.max(np.abs(np.asarray(value) / exact - 1.0))) - EPS


def inside(ratio):
    """Radii in the stick disk, crowded to the centre and to the rim."""
    return exact_radius(ratio).radius * np.array([1e-6, 1e-3, 0.1, 0.4, 0.7, 0.9, 0.99, 0.999])


def outside(ratio):
    """Distances from the edge in the slip annulus, crowded to the edge and to the rim."""
    share = np.array([1e-200, 1e-30, 1e-8, 1e-3, 0.1, 0.4, 0.7, 0.9, 0.99, 0.999])
    return exact_radius(ratio).from_edge * share


def inside_from_edge(ratio):
    """Distances from the edge in the stick disk; empty where it is too small to reach so."""
    rim = exact_radius(ratio).from_edge
    depths = rim * np.array([1.001, 1.01, 1.1, 2.0, 10.0, 1e3, 1e6, 1e10])
    return depths[depths < 1.0] if rim < 0.9 else np.array([])


@every_tolerance
def test_approach(rtol):
    solution = solve(Scene(NU), rtol)
    assert solution.error.approach <= rtol
    assert off(solution.approach, closed_forms.smooth_approach()) <= solution.error.approach


@every_tolerance
def test_pressure(rtol):
    solution = solve(Scene(NU), rtol)
    s = np.linspace(0.0, 0.999, 50)
    by_radius = solution.pressure(s) / closed_forms.smooth_pressure(s)
    by_depth = solution.pressure(from_edge=DEPTHS)
    assert solution.error.pressure <= rtol
    assert off(by_radius, 1.0) <= solution.error.pressure
    assert off(by_depth, closed_forms.smooth_pressure(from_edge=DEPTHS)) <= solution.error.pressure


@every_tolerance
def test_full_stick_shear(rtol):
    solution = stuck(rtol)
    assert solution.error.total_shear <= rtol
    assert (
        off(solution.total_shear, closed_forms.full_stick_shear(NU)) <= solution.error.total_shear
    )


@every_tolerance
def test_full_stick_traction(rtol):
    solution = stuck(rtol)
    s = np.concatenate([[1e-200, 1e-12, 1e-5], np.linspace(0.02, 0.98, 50)])
    assert solution.error.traction <= rtol
    exact = closed_forms.full_stick_traction(NU, s)
    assert off(solution.traction(s), exact) <= solution.error.traction
    exact = closed_forms.full_stick_traction(NU, from_edge=DEPTHS)
    assert off(solution.traction(from_edge=DEPTHS), exact) <= solution.error.traction


@every_scene
@every_tolerance
def test_bounded_estimates_meet_the_tolerance(ratio, rtol):
    solution = sliding(ratio, rtol)
    assert solution.converged
    assert solution.error.approach <= rtol
    assert solution.error.pressure <= rtol
    assert solution.error.traction <= rtol
    assert solution.error.total_shear <= rtol


@every_scene
@every_tolerance
def test_stick_radius(ratio, rtol):
    solution = sliding(ratio, rtol)
    exact = exact_radius(ratio).radius
    # the closed form's own rounding: a few epsilon times its condition, 2 kappa / f
    rounding = EPS * max(1.0, 2.0 / ratio)
    assert off(solution.stick_radius, exact) <= solution.error.stick_radius + rounding


@every_scene
@every_tolerance
def test_zone_boundaries_from_both_ends(ratio, rtol):
    solution = sliding(ratio, rtol)
    exact = exact_radius(ratio)
    stick, slip = solution.zones
    rounding = EPS * max(2.0 / ratio, math.pi / 2 * ratio)
    assert (stick.kind, slip.kind) == ("stick", "slip")
    assert (stick.outer, stick.outer_from_edge) == (slip.inner, slip.inner_from_edge)
    assert off(stick.outer, exact.radius) <= solution.error.zones + rounding
    assert off(stick.outer_from_edge, exact.from_edge) <= solution.error.zones + rounding


@every_scene
@every_tolerance
def test_partial_slip_shear(ratio, rtol):
    solution = sliding(ratio, rtol)
    exact = closed_forms.partial_slip_shear(NU, ratio * KAPPA)
    assert off(solution.total_shear, exact) <= solution.error.total_shear


@every_scene
@every_tolerance
def test_traction_in_stick(ratio, rtol):
    solution = sliding(ratio, rtol)
    friction, s, depths = ratio * KAPPA, inside(ratio), inside_from_edge(ratio)
    # the rounding of the stick radius moves the traction by half of it over sqrt(1 - s/c)
    rounding = 16 * EPS * max(2.0 / ratio, math.pi / 2 * ratio)
    bound = solution.error.traction + rounding
    # 1 - s keeps no digits of a distance to a rim that is nearer to the edge than 1e-3
    s = s if exact_radius(ratio).from_edge > 1e-3 else s[:-2]
    exact = closed_forms.partial_slip_traction(NU, friction, s)
    assert off(solution.traction(s), exact) <= bound
    if depths.size:
        exact = closed_forms.partial_slip_traction(NU, friction, from_edge=depths)
        assert off(solution.traction(from_edge=depths), exact) <= bound


@every_scene
@every_tolerance
def test_traction_in_slip(ratio, rtol):
    solution = sliding(ratio, rtol)
    depths = outside(ratio)
    exact = closed_forms.partial_slip_traction(NU, ratio * KAPPA, from_edge=depths)
    assert off(solution.traction(from_edge=depths), exact) <= solution.error.traction


@every_scene
@every_tolerance
def test_slip_displacement(ratio, rtol):
    solution = sliding(ratio, rtol)
    s, depths = np.linspace(0.0, 1.0, 41), outside(ratio)
    friction = ratio * KAPPA
    exact = closed_forms.slip_displacement(NU, friction, from_edge=depths)
    largest = np.max(np.abs(exact))
    error = np.max(np.abs(solution.slip(from_edge=depths) - exact)) / largest
    assert error <= solution.error.slip
    error = np.max(np.abs(solution.slip(s) - closed_forms.slip_displacement(NU, friction, s)))
    assert error / largest <= solution.error.slip


@every_scene
def test_slip_estimate_is_of_use(ratio):
    # beyond f/kappa = 5 the largest slip is a tiny difference of the displacements it is made of
    assert sliding(ratio, 1e-12).error.slip <= (1e-8 if ratio <= 5.0 else 1e-2)


@every_scene
def test_slip_vanishes_in_stick_and_is_inward_in_slip(ratio):
    solution = sliding(ratio, 1e-8)
    assert np.all(solution.slip(inside(ratio)) == 0.0)
    assert np.all(solution.slip(from_edge=outside(ratio)) < 0.0)


@every_tolerance
def test_frictionless_slip(rtol):
    solution = solve(Scene(NU, friction=0.0), rtol)
    s = np.linspace(0.0, 1.0, 41)
    exact = closed_forms.slip_displacement(NU, 0.0, s)
    error = np.max(np.abs(solution.slip(s) - exact)) / np.max(np.abs(exact))
    assert error - EPS <= solution.error.slip
    assert solution.error.slip <= rtol


def test_tiny_friction():
    # c is about 4 exp(-2 kappa/f), 1e-43 here: of its logarithm all digits are known
    friction = 0.02 * KAPPA
    solution = solve(Scene(NU, friction=friction), 1e-12)
    exact = closed_forms.stick_radius(NU, friction).radius
    assert exact < 1e-42
    assert off(solution.stick_radius, exact) <= solution.error.stick_radius + 100 * EPS
    shear = closed_forms.partial_slip_shear(NU, friction)
    assert off(solution.total_shear, shear) <= solution.error.total_shear


@pytest.mark.parametrize("alpha", [1e6, 1e10, 1e14])
@every_tolerance
def test_very_rough(alpha, rtol):
    # from alpha = 1e6 on, the first neglected terms are below rounding
    solution = solve(Scene(NU, alpha), rtol)
    exact = closed_forms.approach_large_compliance(alpha)
    edge = closed_forms.edge_pressure_large_compliance(alpha)
    assert max(solution.error.approach, solution.error.pressure) <= rtol
    assert off(solution.approach, exact) <= solution.error.approach
    assert off(solution.pressure(1.0), edge) <= solution.error.pressure


@pytest.mark.parametrize("alpha", [1e-10, 1e-12, 1e-14])
@every_tolerance
def test_nearly_smooth(alpha, rtol):
    # of relative order (alpha ln alpha)^2 are the terms neglected
    solution = solve(Scene(NU, alpha), rtol)
    exact = closed_forms.approach_small_compliance(alpha)
    edge = closed_forms.edge_pressure_small_compliance(alpha)
    assert max(solution.error.approach, solution.error.pressure) <= rtol
    assert off(solution.approach, exact) <= solution.error.approach
    assert off(solution.pressure(1.0), edge) <= solution.error.pressure


@pytest.mark.parametrize("below", [0.0, 1e-15, 1e-10])
@pytest.mark.parametrize("nu", [0.1, 0.3])
def test_slip_about_to_start_with_great_compliances(nu, below):
    # p is flat, and so is the condition for the stick radius
    critical = solve(Scene(nu, 1e14, 1e14, math.inf), 1e-3).critical_friction
    solution = solve(Scene(nu, 1e14, 1e14, critical * (1.0 - below)), 1e-3)
    assert solution.stick_radius == pytest.approx(1.0, abs=1e-9)
