"""Newton's method for the boundaries between zones, and what is handed from step to step."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_contact.contact.free_boundary import (
    FieldSolution,
    Iterate,
    _broyden,
    correct_to,
    fd_jacobian,
    find_boundaries,
)
from spectral_contact.contact.layout import Layout, NoBoundariesError
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.parameters import Parameters

TOLERANCE = 1e-7
SLIP_INSIDE = Layout((-0.4, 3.5), (0, 1, 0))
ONE_DISK = Layout((0.3,), (0, 1))


def slip_inside(*, known):
    """Return a problem with slip inside: coupled, or the same with a known pressure."""
    kappa, friction = 0.2222, 0.0511
    if not known:
        return FreeBoundaryProblem(Parameters(0.05, 1.0, kappa, friction), SLIP_INSIDE, TOLERANCE)
    contact = solve_normal(0.05, TOLERANCE, 3000).best.value
    parameters = Parameters(0.05, 1.0, 1.0, friction / kappa)
    return FreeBoundaryProblem(parameters, SLIP_INSIDE, TOLERANCE, known=contact)


def one_disk(*, known):
    """Return a problem with one stick disk."""
    if not known:
        return FreeBoundaryProblem(Parameters(0.5, 0.5, 0.3, 0.03), ONE_DISK, TOLERANCE)
    contact = solve_normal(0.5, TOLERANCE, 3000).best.value
    return FreeBoundaryProblem(Parameters(0.5, 0.5, 1.0, 0.1), ONE_DISK, TOLERANCE, known=contact)


CASES = [
    pytest.param(make, known, id=f"{make.__name__}-{'known' if known else 'unknown'}")
    for make in (one_disk, slip_inside)
    for known in (True, False)
]


def system_near(problem, logits):
    """Return the system as a function of the boundaries, in the first space of a problem."""
    spaces = problem.spaces(TOLERANCE, logits)
    return lambda at: problem.system(spaces, at)


def residual_at(problem, logits):
    """Return the boundary residual as a function of the boundaries, in the same space."""
    spaces = problem.spaces(TOLERANCE, logits)

    def residual(at):
        fields = FieldSolution.first(factored(problem.system(spaces, at)))
        return correct_to(fields, 1e-12).fields.boundary_residual

    return residual


@pytest.mark.parametrize(("make", "known"), CASES)
def test_boundaries_are_found_from_a_guess_that_is_off_by_a_third(make, known):
    problem = make(known=known)
    located = problem.current_layout()
    logits = np.array(located.logits)
    system_at = system_near(problem, logits)
    found = []
    for way in (0.3, -0.3):
        guess = logits + way * np.array([1.0, -0.5])[: len(logits)]
        start = Iterate.first(guess, located.jacobian, system_at(guess))
        iterate = find_boundaries(system_at, start, 1e-9, 1e-11)
        assert iterate.converged
        assert iterate.remaining <= 1e-11
        assert np.abs(iterate.newton_step).max() < 1e-9
        found.append(iterate.logits)
    assert np.abs(found[0] - found[1]).max() < 1e-7
    # at the boundaries the equations hold without defects
    residual = residual_at(problem, logits)(found[0])
    assert np.abs(residual).max() < 1e-8


@pytest.mark.parametrize(("make", "known"), CASES)
def test_what_it_begins_with_stays_as_it_is(make, known):
    problem = make(known=known)
    located = problem.current_layout()
    logits = np.array(located.logits) + 0.1
    jacobian = np.array(located.jacobian)
    system_at = system_near(problem, logits)
    start = Iterate.first(logits.copy(), jacobian.copy(), system_at(logits))
    values = start.fields.values.copy()
    defects = start.fields.defects.copy()
    end = find_boundaries(system_at, start, 1e-8, 1e-10)
    assert end is not start
    assert not np.array_equal(end.logits, start.logits)
    assert np.array_equal(start.logits, logits)
    assert np.array_equal(start.jacobian, jacobian)
    assert np.array_equal(start.fields.values, values)
    assert np.array_equal(start.fields.defects, defects)
    assert not start.converged
    # and the same start has the same end
    again = find_boundaries(system_at, start, 1e-8, 1e-10)
    assert np.array_equal(again.logits, end.logits)
    assert np.array_equal(again.fields.values, end.fields.values)


def test_a_jacobian_is_learnt_from_the_steps():
    problem = slip_inside(known=False)
    located = problem.current_layout()
    logits = np.array(located.logits)
    spread = np.array([[1.0, 0.3], [-0.2, 1.0]])
    system_at = system_near(problem, logits)
    guess = logits + np.array([0.1, -0.1])
    start = Iterate.first(guess, 1.3 * located.jacobian @ spread, system_at(guess))
    iterate = find_boundaries(system_at, start, 1e-9, 1e-11)
    assert iterate.converged
    true = fd_jacobian(residual_at(problem, logits), iterate.logits)
    off_first = np.abs(np.linalg.solve(true, start.jacobian) - np.eye(2)).max()
    off_last = np.abs(np.linalg.solve(true, iterate.jacobian) - np.eye(2)).max()
    assert off_last < 0.2 * off_first


def test_the_jacobian_by_differences_is_that_of_the_residual():
    root = np.array([-0.3, 1.1])

    def values(x):
        a, b = x - root
        return np.array([np.sinh(a) + 0.2 * b, np.expm1(0.5 * b) - 0.3 * a * b])

    assert np.allclose(fd_jacobian(values, root), [[1.0, 0.2], [0.0, 0.5]], rtol=0, atol=1e-6)


def test_boundaries_stay_in_order():
    """However long a step is asked for, the next systems have zones of a width."""
    problem = slip_inside(known=False)
    logits = np.array(SLIP_INSIDE.logits)
    seen = []
    spaces = problem.spaces(TOLERANCE, logits)

    def system_at(at):
        seen.append(at)
        return problem.system(spaces, at)

    jacobian = np.diag([1e-3, -1e-3])  # steps of a hundred, to each other
    find_boundaries(system_at, Iterate.first(logits, jacobian, system_at(logits)), 1e-8, 1e-8)
    assert len(seen) > 2
    assert min(np.diff(at)[0] for at in seen) > 0.0
    assert max(np.abs(np.diff(seen, axis=0)).max(axis=1)) <= 2.0 + 1e-12


@pytest.mark.parametrize("known", [True, False], ids=["known", "unknown"])
def test_boundaries_that_are_not_near_by_are_given_up(known):
    problem = slip_inside(known=known)
    located = problem.current_layout()
    # with so much friction nothing slips, and no zones have such boundaries
    more = problem.parameters._replace(friction=100.0 * problem.parameters.friction)
    problem.parameters = more
    logits = np.array(located.logits)
    system_at = system_near(problem, logits)
    start = Iterate.first(logits, located.jacobian, system_at(logits))
    with pytest.raises(NoBoundariesError), np.errstate(all="ignore"):
        find_boundaries(system_at, start, 1e-8, 1e-8, warm_start=True)
    with pytest.raises(NoBoundariesError), np.errstate(all="ignore"):
        problem.current_layout()


def test_a_zone_that_vanishes_at_the_edge_is_none():
    problem = slip_inside(known=False)
    logits = np.array([0.0, 40.0])
    with pytest.raises(NoBoundariesError, match="the last zone vanishes"):
        problem.system(problem.spaces(TOLERANCE, logits), logits)


@pytest.mark.parametrize(("make", "known"), CASES)
def test_fields_are_corrected_with_the_factors_of_other_boundaries(make, known):
    problem = make(known=known)
    logits = np.array(problem.current_layout().logits)
    spaces = problem.spaces(TOLERANCE, logits)
    system = problem.system(spaces, logits)
    own = FieldSolution.first(factored(system))
    other = FieldSolution.first(factored(problem.system(spaces, logits + 0.02)))
    exact = correct_to(own, 1e-12)
    found = correct_to(replace(other, system=system), 1e-9)
    assert found.remaining < 1e-9
    change = found.fields.values - exact.fields.values
    assert exact.fields.relative_size(change) < 1e-9
    assert found.fields.boundary_residual == pytest.approx(
        exact.fields.boundary_residual, rel=1e-7, abs=1e-9
    )


def test_rounding_of_the_residual_is_no_slope():
    """Slip of a width of 2e-12 had a Jacobian of 1e-8, and an estimate too small by 3000."""
    jacobian = np.array([[2e-12]])
    step = np.array([1e-7])
    assert _broyden(jacobian, [(step, jacobian @ step + 1e-15)]) == jacobian


def test_the_last_steps_give_the_jacobian_of_a_linear_residual():
    exact = np.array([[1.0, 2.0], [-0.5, 3.0]])
    steps = (np.array([0.1, 0.02]), np.array([-0.003, 0.04]))
    secants = [(step, exact @ step) for step in steps]
    assert _broyden(np.eye(2), secants) == pytest.approx(exact, rel=1e-12)
