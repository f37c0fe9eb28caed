"""Elastic coupling: closed forms, the equations by the elliptic kernels, identities, honesty."""

import functools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.disk_integral import integral
from oracles.property_settings import bounded

from spectral_contact import NotComputedError, Scene, StepState, closed_forms, solve
from spectral_contact.testing import check_solution
from spectral_contact.testing.strategies import compliances, poisson_ratios

NUS = (-0.99, -0.5, 0.0, 0.3, 0.45, 0.49999)
EPS = 8 * 2.0**-52
#: Distances from the edge: past the panels, the twelve decades promised, the bulk.
DEPTHS = np.concatenate([[1e-300, 1e-60, 1e-20], np.geomspace(1e-12, 0.1, 60), [0.3, 0.6, 0.999]])
ROUGH = ((0.2, 0.5), (1e-4, 0.5), (0.5, 0.0), (0.0, 0.5), (1e-8, 1e-3), (1e-9, 1e-9), (1e-6, 0.0))
every_ratio = pytest.mark.parametrize("nu", NUS)


@functools.lru_cache(maxsize=256)
def stuck(nu, alpha=0.0, beta=0.0, rtol=1e-12, quantities=None):
    return solve(Scene(nu, alpha, beta, math.inf, coupling=True), rtol, quantities)


def sizes(solution):
    """Return what errors are relative to, of p and of q/s, where either changes sign."""
    p, u = solution.pressure(from_edge=DEPTHS), solution.traction(from_edge=DEPTHS) / (1 - DEPTHS)
    if (p > 0.0).all() and (u > 0.0).all():
        return p, u
    return np.hypot(p, u), np.hypot(u, solution.scene.kappa * p)


def field_errors(solution, pressure, traction):
    """Return the largest errors of p and of q/s in the sense of the estimates."""
    of_p, of_u = sizes(solution)
    missed = solution.traction(from_edge=DEPTHS) - traction
    return (
        np.max(np.abs(solution.pressure(from_edge=DEPTHS) - pressure) / of_p),
        np.max(np.abs(missed / (1 - DEPTHS)) / of_u),
    )


# --- the smooth punch of Mossakovskij and Spence --------------------------------------------------


@every_ratio
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
def test_smooth_approach_and_shear_are_exact_and_honest(nu, rtol):
    solution = stuck(nu, rtol=rtol)
    approach = abs(solution.approach / closed_forms.coupled_approach(nu) - 1.0)
    shear = abs(solution.total_shear / closed_forms.coupled_shear(nu) - 1.0)
    assert max(approach, shear) <= rtol
    assert approach <= solution.error.approach + EPS
    assert shear <= solution.error.total_shear + EPS


@every_ratio
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
def test_smooth_fields_are_exact_and_honest_down_to_the_last_double(nu, rtol):
    solution = stuck(nu, rtol=rtol)
    errors = field_errors(
        solution,
        closed_forms.coupled_pressure(nu, from_edge=DEPTHS),
        closed_forms.coupled_traction(nu, from_edge=DEPTHS),
    )
    assert solution.converged
    assert max(errors) <= rtol
    assert errors[0] <= solution.error.pressure
    assert errors[1] <= solution.error.traction


def test_smooth_fields_have_no_limit_at_the_edge():
    solution = stuck(0.3)
    assert np.isnan(solution.pressure(1.0))
    assert np.isnan(solution.traction([0.5, 1.0])).tolist() == [False, True]


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3])
def test_the_opening_is_the_first_zero_of_the_pressure(nu):
    opening = stuck(nu).opening
    around = closed_forms.coupled_pressure(nu, from_edge=[opening * 1.001, opening * 0.999])
    assert around[0] > 0.0 > around[1]
    farther = np.geomspace(opening * 1.001, 1.0, 2000)
    assert (closed_forms.coupled_pressure(nu, from_edge=farther) > 0.0).all()
    assert "would open" in str(stuck(nu).plan)
    assert "would open" in repr(stuck(nu))


def test_an_opening_below_the_least_double_is_none():
    assert stuck(0.4999999).opening is None


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_ratios_at_an_oscillating_edge_are_refused(nu):
    assert stuck(nu).critical_friction == math.inf
    with pytest.raises(NotComputedError, match="would open"):
        _ = stuck(nu).edge_ratio
    with pytest.raises(NotComputedError, match="oscillate at the edge"):
        _ = stuck(0.4999999).edge_ratio


# --- rough surfaces -------------------------------------------------------------------------------


def test_numbers_of_another_code():
    solution = stuck(0.3, 0.2, 0.5)
    assert solution.approach == pytest.approx(0.195145967641307, rel=1e-14)
    assert solution.pressure(1.0) == pytest.approx(0.451824060086190, rel=1e-13)
    assert solution.traction(1.0) == pytest.approx(0.038611821239626, rel=1e-13)
    assert solution.total_shear == pytest.approx(0.06300569793078, rel=1e-12)
    assert solution.opening is None


@pytest.mark.parametrize(("nu", "layer"), [(0.0, 1.909e-4), (0.3, 8.68e-8)])
def test_the_layer_below_which_the_contact_would_open(nu, layer):
    # p(1) is so small beside q/s that 1e-11 of it is rounding
    below, above = (stuck(nu, s * layer, s * layer, 1e-10) for s in (0.999, 1.001))
    assert below.pressure(1.0) < 0.0 < above.pressure(1.0)
    assert below.opening > 0.0
    assert above.opening is None


@pytest.mark.parametrize(("alpha", "beta"), ROUGH)
@pytest.mark.parametrize("nu", [-0.9, 0.0, 0.3])
def test_fields_satisfy_the_equations_of_the_elliptic_kernels(nu, alpha, beta):
    solution = stuck(nu, alpha, beta)
    report = check_solution(solution, solution.scene, 1e-12)
    names = {check.name for check in report.checks}
    assert {"normal equation (3.5)", "no displacement in stick (4.2)"} <= names


def test_checks_see_a_missing_coupling():
    scene = Scene(0.3, 0.2, 0.5, math.inf)
    coupled = stuck(0.3, 0.2, 0.5).scene
    for fields, claim in ((solve(scene), coupled), (stuck(0.3, 0.2, 0.5), scene)):
        report = check_solution(fields, claim, 1e-6, strict=False)
        failed = {check.name for check in report.checks if not check.passed}
        assert {"normal equation (3.5)", "approach, by reciprocity"} <= failed


@pytest.mark.parametrize(("alpha", "beta"), ROUGH)
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_estimates_bound_the_errors(alpha, beta, rtol):
    for nu in (-0.9, 0.3):
        solution, truth = stuck(nu, alpha, beta, rtol), stuck(nu, alpha, beta)
        errors = field_errors(
            solution, truth.pressure(from_edge=DEPTHS), truth.traction(from_edge=DEPTHS)
        )
        assert errors[0] <= solution.error.pressure <= rtol
        assert errors[1] <= solution.error.traction <= rtol
        for name in ("approach", "total_shear", "critical_friction"):
            value, exact = getattr(solution, name), getattr(truth, name)
            if math.isfinite(exact):
                assert abs(value / exact - 1.0) <= getattr(solution.error, name) + EPS


@bounded
@given(poisson_ratios(), compliances(), compliances(), st.sampled_from([1e-3, 1e-6, 1e-9]))
def test_honest_on_any_scene(nu, alpha, beta, rtol):
    solution, truth = stuck(nu, alpha, beta, rtol), stuck(nu, alpha, beta, 1e-11)
    errors = field_errors(
        solution, truth.pressure(from_edge=DEPTHS), truth.traction(from_edge=DEPTHS)
    )
    assert errors[0] <= solution.error.pressure + truth.error.pressure
    assert errors[1] <= solution.error.traction + truth.error.traction
    assert abs(solution.approach / truth.approach - 1.0) <= solution.error.approach + EPS
    shear = abs(solution.total_shear / truth.total_shear - 1.0)
    assert shear <= solution.error.total_shear + truth.error.total_shear


def test_the_traction_keeps_its_digits_next_to_the_centre():
    # by precise's CoupledRun; q/s is determined by little there, and the corrections restore it
    solution = stuck(-0.7627693285705106, 0.004976214358342445, 0.01253254173312297)
    error = abs(solution.traction(2.0**-12) / 0.0000201148346003648102671 - 1.0)
    assert error <= 2e-13 <= solution.error.traction


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 3e-8, 1e-9])
def test_the_estimate_sees_the_root_at_an_edge_where_the_pressure_nearly_vanishes(rtol):
    scene = Scene(0.01802424808123293, 0.0004214407368490267, 0.0, math.inf, coupling=True)
    solution, truth = solve(scene, rtol, strict=False), solve(scene, 1e-12, strict=False)
    error = abs(solution.pressure(1.0) / truth.pressure(1.0) - 1.0)
    assert error <= solution.error.pressure + truth.error.pressure


@pytest.mark.parametrize(("alpha", "beta"), [(0.2, 0.5), (1e-8, 1e-3), (0.0, 0.0)])
def test_approach_and_shear_alone_need_fewer_unknowns(alpha, beta):
    whole = stuck(0.3, alpha, beta)
    alone = stuck(0.3, alpha, beta, 1e-12, ("approach", "total_shear"))
    assert alone.work.unknowns < 0.7 * whole.work.unknowns
    assert alone.approach == pytest.approx(whole.approach, rel=1e-12)
    assert alone.total_shear == pytest.approx(whole.total_shear, rel=1e-12)


# --- identities -----------------------------------------------------------------------------------


def slope(approach, at):
    """Return the derivative of the approach by differences of high order."""
    h = 0.02 * at
    first, second, third = (
        (approach(at + k * h) - approach(at - k * h)) / (2.0 * k * h) for k in (1, 2, 3)
    )
    return (15.0 * first - 6.0 * second + third) / 10.0


@pytest.mark.parametrize(("alpha", "beta"), [(0.2, 0.5), (1e-3, 0.02), (3.0, 0.1)])
def test_energies_are_the_derivatives_of_the_approach(alpha, beta):
    """With compliances the approach changes by the energy in their layers."""
    solution = stuck(0.1, alpha, beta)
    asperities = {
        "normal": 2.0 * math.pi * integral(lambda d: solution.pressure(from_edge=d) ** 2),
        "tangential": 2.0 * math.pi * integral(lambda d: solution.traction(from_edge=d) ** 2),
    }
    by_alpha = slope(lambda a: stuck(0.1, a, beta, 1e-13, ("approach",)).approach, alpha)
    by_beta = slope(lambda b: stuck(0.1, alpha, b, 1e-13, ("approach",)).approach, beta)
    assert asperities["normal"] == pytest.approx(by_alpha, rel=2e-9)
    assert asperities["tangential"] == pytest.approx(by_beta, rel=2e-8)


@pytest.mark.parametrize(("alpha", "beta"), [(0.2, 0.5), (0.0, 0.0), (1e-6, 0.3)])
def test_the_effect_of_coupling_falls_like_the_square_of_kappa(alpha, beta):
    # kappa halves from one to the next
    nus = [(1.0 - 4.0 * k) / (2.0 - 4.0 * k) for k in (4e-3, 2e-3, 1e-3)]
    plain = [solve(Scene(nu, alpha, beta, math.inf), 1e-12) for nu in nus]
    coupled = [stuck(nu, alpha, beta) for nu in nus]
    for name in ("approach", "total_shear"):
        change = [
            getattr(one, name) / getattr(other, name) - 1.0
            for one, other in zip(coupled, plain, strict=True)
        ]
        assert change[0] < 0.0 or name == "total_shear"
        assert change[0] / change[1] == pytest.approx(4.0, rel=1e-3)
        assert change[1] / change[2] == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_hardly_any_compliance_is_a_smooth_surface(nu):
    thin = stuck(nu, 1e-13, 1e-13)
    assert thin.approach == pytest.approx(closed_forms.coupled_approach(nu), rel=1e-11)
    assert thin.total_shear == pytest.approx(closed_forms.coupled_shear(nu), rel=1e-10)
    assert thin.opening == pytest.approx(stuck(nu).opening, rel=1e-3)


# --- what runs, and what does not -----------------------------------------------------------------


@pytest.mark.parametrize("scene", [Scene(0.5, 0.2, 0.5, math.inf), Scene(0.3, 0.2), Scene(0.5)])
def test_idle_coupling_is_skipped_and_changes_no_bit(scene):
    asked = solve(
        Scene(
            scene.poisson_ratio,
            scene.normal_compliance,
            scene.tangential_compliance,
            scene.friction,
            coupling=True,
        )
    )
    plain = solve(scene)
    assert asked.plan.steps[0].state is StepState.SKIPPED
    assert asked.plan.steps[1:] == plain.plan.steps
    assert asked.values == plain.values
    assert asked.error == plain.error


def test_at_friction_zero_only_the_ratios_are_coupled():
    plain, stick = solve(Scene(0.3, 0.2, 0.5, 0.0)), stuck(0.3, 0.2, 0.5, 1e-10)
    idle = solve(Scene(0.3, 0.2, 0.5, 0.0, coupling=True))
    assert idle.approach == plain.approach
    assert idle.slip(0.7) == plain.slip(0.7)
    assert idle.critical_friction == stick.critical_friction != plain.critical_friction


def test_friction_above_critical_is_full_stick_to_the_bit():
    held, stick = solve(Scene(0.3, 0.2, 0.5, 1.0, coupling=True), 1e-12), stuck(0.3, 0.2, 0.5)
    assert (held.approach, held.total_shear) == (stick.approach, stick.total_shear)
    assert [zone.kind for zone in held.zones] == ["stick"]
