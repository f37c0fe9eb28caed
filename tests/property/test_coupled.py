"""What must hold for every full stick with elastic coupling: reciprocity, energies, monotony."""

import functools
import math
from dataclasses import replace

import numpy as np
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from oracles.disk_integral import integral, places
from oracles.property_settings import few
from scipy.linalg import cholesky, solve_triangular, svdvals

from spectral_contact import Scene, solve
from spectral_contact.equations.residuals import (
    normal_displacement,
    shear_lift,
    tangential_displacement,
)
from spectral_contact.spectral.contact_matrix import system_matrix
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.testing import check_solution
from spectral_contact.testing.strategies import (
    compliances,
    coupled_stick_scenes,
    poisson_ratios,
    powers_of_ten,
)

EPS = 2.0**-52
TIGHT = 1e-11
fewest = settings(few, max_examples=3)
moderate = powers_of_ten(-6, 2)


@functools.lru_cache(maxsize=256)
def stuck(nu, alpha, beta, rtol=TIGHT, quantities=None):
    return solve(Scene(nu, alpha, beta, math.inf, coupling=True), rtol, quantities)


def approach(nu, alpha, beta):
    return stuck(nu, alpha, beta, 1e-12, ("approach",)).approach


def product(one, other, name):
    """Return ``2 pi int a b s ds`` of the pressures, or of the tractions, of two solutions."""
    first, second = getattr(one, name), getattr(other, name)
    return 2 * math.pi * integral(lambda d: first(from_edge=d) * second(from_edge=d))


# -- reciprocity -----------------------------------------------------------------------------------


@few
@given(poisson_ratios(), compliances(), compliances(), moderate, moderate)
@example(0.0, 0.0, 0.0, 0.1, 0.01)
@example(-0.5, 0.0, 1e-6, 1e-4, 1.0)
def test_two_scenes_do_each_other_the_same_work(nu, alpha, beta, other_alpha, other_beta):
    """Betti: the forces of one scene work as much on the displacements of the other."""
    assume(not (0.0 < beta < 1e-9 and alpha < beta / 10.0))
    one, other = stuck(nu, alpha, beta), stuck(nu, other_alpha, other_beta)
    by_pressure = (alpha - other_alpha) * product(one, other, "pressure")
    by_traction = (beta - other_beta) * product(one, other, "traction")
    error = max(abs(by_pressure), abs(by_traction)) * sum(
        each.error.pressure + each.error.traction + 10 * EPS for each in (one, other)
    )
    error += one.error.approach * one.approach + other.error.approach * other.approach
    assert abs(one.approach - other.approach - by_pressure - by_traction) <= error


# -- energies --------------------------------------------------------------------------------------


def energies(p, q, kappa, depth, cuts):
    """Return the works of fields on what they displace: by N, by both couplings, by T."""
    d, weights = places(depth, 1.0, 8)
    lifts = np.array([shear_lift(q, kappa, at, cuts) for at in d.tolist()])
    sinks = np.array([normal_displacement(p, at, cuts) for at in d.tolist()])
    radial = np.array([tangential_displacement(q, p, kappa, at, cuts) for at in d.tolist()])
    outward, inward = radial.T
    parts = p(d) * sinks, -p(d) * lifts, -q(d) * inward, q(d) * outward
    return [2 * math.pi * float(weights @ part) for part in parts]


@fewest
@given(poisson_ratios(), powers_of_ten(-2, 1), powers_of_ten(-2, 1))
def test_the_load_works_on_body_and_asperities_and_nothing_is_lost(nu, alpha, beta):
    solution = stuck(nu, alpha, beta)
    cuts = [10.0**-k for k in (1, 2, 3, 4)]

    def pressure(d):
        return solution.pressure(from_edge=d)

    def traction(d):
        return solution.traction(from_edge=d)

    parts = energies(pressure, traction, solution.scene.kappa, 20.0, cuts)
    assert abs(parts[1] - parts[2]) <= 1e-7 * abs(parts[1])  # reciprocity, within one scene
    layers = alpha * product(solution, solution, "pressure")
    layers += beta * product(solution, solution, "traction")
    assert abs((sum(parts) + layers) / solution.approach - 1) <= 1e-7


@few
@given(st.integers(2, 14), st.integers(3, 12), st.sampled_from([0.0, -0.5]))
def test_any_tractions_strain_the_body(panels, degree, power):
    """The couplings are 2 kappa of the rest at most, which is below 3/4, and come close to it."""
    own = LogPanels(panels, 2.0, degree, power)
    none = 1e-300 if power == 0.0 else 0.0  # a compliance, which decides on the endpoint weight
    parameters = Parameters(none, none, 1.0, math.inf)
    system = ContactSystem((), (0,), [DiscreteSpace(own, (degree,) * panels)], parameters)
    matrix = system_matrix(system)
    n = system.pressure_terms
    roots = [cholesky(matrix[place, place], lower=True) for place in (slice(n), slice(n, None))]
    half = solve_triangular(roots[0], -matrix[:n, n:], lower=True)
    shares = svdvals(solve_triangular(roots[1], half.T, lower=True))
    assert 1.99 <= shares.max() <= 2 + 1e-9


@few
@given(poisson_ratios(), powers_of_ten(-8, 4), powers_of_ten(-8, 4), st.floats(0.1, 10))
def test_slopes_of_the_approach_are_the_energies_of_the_layers(nu, alpha, beta, spread):
    """The mean slope lies between those at the ends, as the approach is concave."""
    low = stuck(nu, alpha, beta)
    for name, high in (
        ("pressure", stuck(nu, alpha * (1 + spread), beta)),
        ("traction", stuck(nu, alpha, beta * (1 + spread))),
    ):
        step = spread * (alpha if name == "pressure" else beta)
        noise = sum(one.approach * one.error.approach for one in (low, high)) / step
        mean = (high.approach - low.approach) / step
        bounds = [product(one, one, name) for one in (high, low)]
        share = 4 * max(getattr(one.error, name) for one in (low, high)) + 100 * EPS
        assert bounds[0] * (1 - share) - noise <= mean <= bounds[1] * (1 + share) + noise


# -- monotony --------------------------------------------------------------------------------------


@few
@given(poisson_ratios(), poisson_ratios(), compliances(), compliances())
def test_coupling_lowers_the_approach_the_more_the_stronger_it_is(nu, other, alpha, beta):
    assume(not (0.0 < beta < 1e-9 and alpha < beta / 10.0))
    weak, strong = max(nu, other), min(nu, other)
    plain = solve(Scene(weak, alpha, beta, math.inf), 1e-12, ("approach",)).approach
    noise = 4e-15 * plain
    assert approach(strong, alpha, beta) <= approach(weak, alpha, beta) + noise <= plain + 2 * noise


@few
@given(poisson_ratios(), moderate, moderate, st.floats(0.01, 10))
def test_compliance_raises_the_approach(nu, alpha, beta, spread):
    noise = 4e-15 * approach(nu, alpha, beta)
    more = 1 + spread
    assert approach(nu, alpha * more, beta) >= approach(nu, alpha, beta) - noise
    assert approach(nu, alpha, beta * more) >= approach(nu, alpha, beta) - noise


# -- no coupling -----------------------------------------------------------------------------------


@few
@given(powers_of_ten(-8, 0), powers_of_ten(-8, 0))
@example(0.0, 0.0)
def test_the_effect_of_weak_coupling_is_that_of_its_square(alpha, beta):
    changes = []
    for kappa in (0.02, 0.01):
        scene = Scene((1 - 4 * kappa) / (2 - 4 * kappa), alpha, beta, math.inf)
        plain = solve(scene, 1e-12, ("approach", "total_shear"))
        coupled = solve(replace(scene, coupling=True), 1e-12, ("approach", "total_shear"))
        names = "approach", "total_shear"
        changes.append([getattr(coupled, n) / getattr(plain, n) - 1 for n in names])
    for strong, weak in zip(*changes, strict=True):
        # the next term is one of the fourth power; what rounding leaves is relative to the change
        assert abs(strong / weak - 4) <= 0.02 + 2e-14 / abs(weak)


# -- the equations ---------------------------------------------------------------------------------


@fewest
@given(coupled_stick_scenes(), st.sampled_from([1e-3, 1e-6, 1e-9]))
def test_solutions_solve_their_scenes(scene, rtol):
    check_solution(solve(scene, rtol), scene, rtol)
