"""What the search for boundaries needs, on equations whose roots and slopes are known."""

import numpy as np
import pytest
from spectral_contact.contact.zone_assessment import zones_error
from spectral_contact.contact.zone_newton import ZonesNewton, ZoneState, longest, through_secants

from spectral_contact import Scene, solve
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.stick_radius import fd_jacobian
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.parameters import Parameters

ROOT = np.array([-0.3, 1.1])


def values(x):
    """Return two conditions with their root, and something that follows them."""
    a, b = x - ROOT
    return np.array([np.sinh(a) + 0.2 * b, np.expm1(0.5 * b) - 0.3 * a * b, 2.0 + a - 3.0 * b])


SLOPES = np.array([[1.0, 0.2], [0.0, 0.5], [1.0, -3.0]])


def test_differences_are_the_slopes():
    assert np.allclose(fd_jacobian(values, ROOT), SLOPES, rtol=0, atol=1e-6)


def test_slopes_are_learnt_from_steps():
    wrong = SLOPES + 0.1 * np.array([[1.0, -1.0], [0.5, 1.0], [1.0, 1.0]])
    steps = [1e-4 * np.array(way) for way in ([1.0, 0.0], [1.0, 1.0])]
    secants = [(step, values(ROOT + step) - values(ROOT)) for step in steps]
    found = through_secants(wrong, secants)
    assert np.abs(found - SLOPES).max() < 1e-3
    # of one step they are learnt in its direction alone
    found = through_secants(wrong, secants[:1])
    assert np.abs((found - SLOPES)[:, 0]).max() < 1e-3
    assert np.array_equal(found[:, 1], wrong[:, 1])


def test_boundaries_stay_in_order():
    step = np.array([2.0, -1.0])
    factor = longest(ROOT, step)
    assert 0.0 < factor < 1.0
    assert np.diff(ROOT + factor * step)[0] > 0.0


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_zone_narrower_than_the_errors_of_its_ends_may_not_be_there(share):
    inner, outer = Radius.from_logit(0.5), Radius.from_logit(0.5 + 1e-4)
    width = outer.value**2 - inner.value**2
    # d(s^2) is 2 s^2 times the relative error from the centre
    own = [share * width / (2.0 * one.value**2) for one in (inner, outer)]
    found = zones_error((inner, outer), ((own[0], 1.0), (own[1], 1.0)))
    assert found == (1.0 if share < 0.5 else np.inf)
    # from the edge it is y times that
    own = [share * width / one.rest for one in (inner, outer)]
    found = zones_error((inner, outer), ((1.0, own[0]), (1.0, own[1])))
    assert found == (1.0 if share < 0.5 else np.inf)


@pytest.mark.parametrize(("kappa", "friction"), [(0.2222, 0.0511), (0.2222, 0.0467)])
def test_slopes_of_the_fields_are_those_of_differences(kappa, friction):
    parameters = Parameters(0.05, 1.0, kappa, friction)
    problem = FreeBoundaryProblem(parameters, Layout((-0.4, 3.5), (0, 1, 0)), 1e-8)
    assert problem.layout.slopes is not None
    spaces = problem.spaces(1e-8)
    factors = factored(problem.system(spaces, problem.logits))
    state = ZonesNewton(problem, spaces, 1e-10, factors).run(1e-10)

    def conditions(logits):
        system = problem.system(spaces, logits)
        return problem.settled(ZoneState.begin(factored(system)), 1e-12).mismatch

    truth = fd_jacobian(conditions, problem.logits)
    told = state.slopes([], 1e-4)
    assert np.abs(np.linalg.solve(told, truth) - np.eye(2)).max() < 1e-3


@pytest.mark.parametrize("rtol", [6.7e-4, 1e-3])
def test_boundaries_of_a_narrow_slip_zone_have_room_for_their_error(rtol):
    # slopes of their conditions are those next to them, in units of the zone
    found, true = (
        solve(Scene(0.0984060925, 0.00142439397751, 0.0164693960596, 0.4559430148132268), one)
        for one in (rtol, 1e-12)
    )
    assert [zone.kind for zone in found.zones] == ["stick", "slip", "stick"]
    error = abs(found.stick_radius / true.stick_radius - 1.0)
    assert error <= found.error.stick_radius + true.error.stick_radius
