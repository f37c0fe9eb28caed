"""The numbers of the theory notes, sections 6 and 7: every one that concerns the uncoupled problem.

A number is given as it was printed there, and held to one unit of its last digit or to 1e-12 of
itself, whichever is wider.
"""

import functools
import math

import numpy as np
import pytest

from spectral_contact import Scene, solve

RTOL = 1e-12
INTERIOR = (0.3, 0.05, 1.0)  # nu, alpha, beta of the interior slip annulus


def shown(digits):
    """Equality to the digits shown, or to 1e-12 where more are."""
    unit = 10.0 ** -len(digits.partition(".")[2])
    value = float(digits)
    return pytest.approx(value, rel=0, abs=max(unit, RTOL * abs(value)))


@functools.cache
def solved(nu, alpha, beta, friction):
    return solve(Scene(nu, alpha, beta, friction), RTOL)


def kappa(nu):
    return (1 - 2 * nu) / (4 * (1 - nu))


def poisson_ratio(k):
    """The inverse of kappa."""
    return (1 - 4 * k) / (2 - 4 * k)


@pytest.mark.parametrize(
    ("alpha", "approach", "edge_pressure"),
    [
        (0.01, "0.130089824705226", "1.463083969544"),
        (0.5, "0.29295979691047814", "0.37980995507974310"),
        (1.0, "0.452701390869753", "0.35044541816021"),
        (1e-12, "0.125000000002324", "141047.39588952"),
    ],
)
def test_approach_and_edge_pressure(alpha, approach, edge_pressure):
    solution = solved(0.3, alpha, 0.0, None)
    assert solution.converged
    assert solution.approach == shown(approach)
    assert solution.pressure(from_edge=0.0) == shown(edge_pressure)


@pytest.mark.parametrize(
    ("alpha", "beta", "edge_ratio", "shear"),
    [
        (0.5, 0.5, "0.70712820393025", "0.464971875312765"),
        (0.5, 1.0, "0.38201587521852", "0.267484815875045"),
    ],
)
def test_full_stick(alpha, beta, edge_ratio, shear):
    solution = solved(0.3, alpha, beta, math.inf)
    assert solution.converged
    assert solution.edge_ratio / kappa(0.3) == shown(edge_ratio)
    assert solution.total_shear / kappa(0.3) == shown(shear)


@pytest.mark.parametrize(
    ("alpha", "beta", "edge_ratio"),
    [(0.5, 0.5, "0.70712820393025"), (0.5, 1.0, "0.38201587521852")],
)
def test_edge_ratio_is_that_of_the_fields(alpha, beta, edge_ratio):
    solution = solved(0.3, alpha, beta, math.inf)
    ratio = solution.traction(1.0) / solution.pressure(1.0)
    assert ratio / kappa(0.3) == shown(edge_ratio)


def test_smooth_approach():
    assert solved(0.1, 0.0, 0.0, None).approach == pytest.approx(0.125, rel=RTOL, abs=0)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.4999])
def test_smooth_full_stick_shear(nu):
    expected = 2 * kappa(nu) * math.log(2.0)
    assert solved(nu, 0.0, 0.0, math.inf).total_shear == pytest.approx(expected, rel=RTOL, abs=0)


@pytest.mark.parametrize(
    ("ratio", "radius", "shear"),
    [
        (0.5, "0.0730344191397954571", "0.499330942093621617"),
        (2.0, "0.903753964279260882", "1.2953010511890055"),
    ],
)
def test_smooth_partial_slip(ratio, radius, shear):
    solution = solved(0.0, 0.0, 0.0, ratio * kappa(0.0))
    assert solution.converged
    assert solution.stick_radius == shown(radius)
    assert solution.total_shear / kappa(0.0) == shown(shear)


@pytest.mark.parametrize(
    ("alpha", "beta", "nu", "friction", "radius", "shear"),
    [
        # The notes print Q = 0.086782769694965; its last digits are not right: with c as below
        # the fields satisfy the equations in their elliptic form to 1e-15 (test_residuals.py).
        (0.5, 0.5, 0.1, 0.1, "0.6475686430034", "0.0867827696950"),
        (0.001, 0.001, 0.3, 0.2, "0.73486606977619", "0.163510583911422"),
    ],
)
def test_partial_slip(alpha, beta, nu, friction, radius, shear):
    solution = solved(nu, alpha, beta, friction)
    assert solution.converged
    assert [zone.kind for zone in solution.zones] == ["stick", "slip"]
    assert solution.stick_radius == shown(radius)
    assert solution.total_shear == shown(shear)


def test_interior_maximum_of_the_full_stick_ratio():
    solution = solved(*INTERIOR, math.inf)
    k = kappa(0.3)
    assert solution.converged
    assert solution.critical_friction / k == shown("0.2618982758102")
    assert solution.edge_ratio / k == shown("0.20346522911")


@pytest.mark.parametrize(
    ("nu", "alpha", "beta", "place", "ratio"),
    [
        (*INTERIOR, 0.854723, "0.2618982758102"),
        (0.3, 0.2, 0.5, 0.99159, "0.594873702"),
    ],
)
def test_place_of_the_interior_maximum(nu, alpha, beta, place, ratio):
    solution = solved(nu, alpha, beta, math.inf)

    unit = 10.0 ** -len(str(place).partition(".")[2])
    s = place + unit * np.linspace(-1.0, 1.0, 81)
    assert solution.critical_friction / kappa(nu) == shown(ratio)
    largest = np.max(solution.traction(s) / solution.pressure(s))
    # the nearest sample is within 1/80 of a unit of the place, which costs less than 1e-12
    assert largest == pytest.approx(solution.critical_friction, rel=RTOL, abs=0)


def test_interior_slip_annulus():
    # The notes print an inner boundary of 0.643143285307, 1e-11 off: the elliptic equations are
    # satisfied to 1e-15 with the one below (test_residuals.py).
    k = kappa(0.3)
    solution = solved(*INTERIOR, 0.23 * k)
    assert solution.converged
    assert [zone.kind for zone in solution.zones] == ["stick", "slip", "stick"]
    _, slip, edge = solution.zones
    assert slip.inner == shown("0.64314328531676")
    assert slip.outer == shown("0.980518130271")
    assert 1.0 - slip.inner_from_edge == shown("0.64314328531676")
    assert 1.0 - slip.outer_from_edge == shown("0.980518130271")
    assert (edge.outer, edge.outer_from_edge) == (1.0, 0.0)
    assert solution.stick_radius == slip.inner
    assert solution.total_shear / k == shown("0.20965605366551")
    assert solution.traction(1.0) / solution.pressure(1.0) / k == shown("0.204459078593")


def test_poisson_ratio_at_which_the_edge_ratio_reaches_the_friction():
    solution = solved(0.3, 0.2, 0.5, math.inf)
    assert poisson_ratio(0.1 * kappa(0.3) / solution.edge_ratio) == shown("0.24534731356661")
    at_onset = solved(0.24534731356661, 0.2, 0.5, math.inf)
    assert at_onset.edge_ratio == pytest.approx(0.1, rel=RTOL, abs=0)


def test_poisson_ratio_at_the_true_onset_of_slip():
    solution = solved(0.3, 0.2, 0.5, math.inf)
    onset = poisson_ratio(0.1 * kappa(0.3) / solution.critical_friction)
    assert onset == shown("0.24675447005")


def test_between_the_two_onsets_slip_is_interior():
    inside = solved(0.246, 0.2, 0.5, 0.1)
    assert inside.converged
    assert inside.edge_ratio < 0.1 < inside.critical_friction
    assert [zone.kind for zone in inside.zones] == ["stick", "slip", "stick"]


def test_no_slip_beyond_the_true_onset():
    beyond = solved(0.24675447006, 0.2, 0.5, 0.1)
    assert beyond.critical_friction < 0.1
    assert [zone.kind for zone in beyond.zones] == ["stick"]


@pytest.mark.parametrize(
    ("alpha", "beta", "threshold"), [(0.2, 0.5, 0.592738), (0.05, 1.0, 0.205874)]
)
def test_second_threshold_at_which_the_edge_slips_too(alpha, beta, threshold):
    k = kappa(0.3)
    above = solve(Scene(0.3, alpha, beta, (threshold + 3e-6) * k), 1e-8)
    below = solve(Scene(0.3, alpha, beta, (threshold - 3e-6) * k), 1e-8)
    assert [zone.kind for zone in above.zones] == ["stick", "slip", "stick"]
    assert [zone.kind for zone in below.zones] == ["stick", "slip"]
