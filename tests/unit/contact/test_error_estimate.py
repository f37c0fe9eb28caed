"""How far boundaries may be off, and which zones are certain."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.error_estimate import largest_boundary_error
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import PressureField, Radius
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_zone_narrower_than_the_errors_of_its_ends_may_not_be_there(share):
    inner = Radius.from_logit(0.5)
    outer = Radius.from_logit(0.5 + 1e-4)
    width = outer.value**2 - inner.value**2
    expected = 1.0 if share < 0.5 else np.inf
    # d(s^2) is 2 s^2 times the relative error from the centre
    errors = [share * width / (2.0 * radius.value**2) for radius in (inner, outer)]
    assert largest_boundary_error((inner, outer), ((errors[0], 1.0), (errors[1], 1.0))) == expected
    # and 2 s (1 - s) times that from the edge
    errors = [share * width / (2.0 * radius.value * radius.from_edge) for radius in (inner, outer)]
    assert largest_boundary_error((inner, outer), ((1.0, errors[0]), (1.0, errors[1]))) == expected


@pytest.mark.parametrize("rtol", [6.7e-4, 1e-3])
def test_boundaries_of_a_narrow_slip_zone_are_within_their_estimates(rtol):
    # the Jacobian changes within the width of the zone
    scene = Scene(0.0984060925, 0.00142439397751, 0.0164693960596, 0.4559430148132268)
    loose = solve(scene, rtol)
    tight = solve(scene, 1e-12)
    assert [zone.kind for zone in loose.zones] == ["stick", "slip", "stick"]
    error = abs(loose.stick_radius / tight.stick_radius - 1.0)
    assert error <= loose.error.stick_radius + tight.error.stick_radius


def test_the_shear_of_nearly_full_slip_knows_how_far_the_load_is_off():
    """The expansion of a known pressure in slip has a load that is not quite 1."""
    scene = Scene(-0.97742, 9.7334e-06, 390.7784, friction=1.35953e-06)
    loose = solve(scene, 4.95e-4)
    tight = solve(scene, 1e-12)
    error = abs(loose.total_shear / tight.total_shear - 1.0)
    assert error > 10.0 * tight.error.total_shear
    assert error <= loose.error.total_shear


@pytest.mark.parametrize(("logits", "states"), [((0.3,), (0, 1)), ((0.0, 1.5), (0, 1, 0))])
def test_a_known_pressure_lacks_its_top_degrees_in_the_coarser_space(logits, states):
    """The solution less the coarse difference is that of coarser spaces of both fields."""
    tolerance = 1e-5
    refinement = solve_normal(0.5, tolerance, 4000)
    known = refinement.best.value
    panels, degrees = refinement.space
    lower = DiscreteSpace(panels, tuple(n - 2 for n in degrees))
    coefficients = known.approach * unit_space(*lower).factor(0.5).solve(2.0)
    coarse_pressure = PressureField(None, series_of(panels, coefficients))
    coarse_known = replace(known, pressure=coarse_pressure, changes=())

    parameters = Parameters(alpha=0.5, beta=0.5, kappa=1.0, friction=1.1)
    layout = Layout(logits, states)
    problem = FreeBoundaryProblem(parameters, layout, tolerance, known=known)
    coarse_problem = FreeBoundaryProblem(parameters, layout, tolerance, known=coarse_known)
    spaces = problem.spaces(tolerance, np.array(logits))
    lower_spaces = [space._replace(degrees=tuple(n - 2 for n in space.degrees)) for space in spaces]
    fine = problem.system(spaces, np.array(logits), with_contributions=True)
    coarse = coarse_problem.system(lower_spaces, np.array(logits))
    factors = factored(fine)
    values = factors.unit_solutions[:, 0]
    coarse_values = factored(coarse).unit_solutions[:, 0]
    difference = factors.coarse_differences(values, fine)[0]
    # one unit of the contributions of the top two degrees to the known pressure
    assert difference[: fine.pressure_terms].tolist() == [0.0, 1.0, 0.0]
    for field, coarse_field in zip(fine.fields, coarse.fields, strict=True):
        expected = values[field.place].copy()
        expected -= coarse_field.coefficients(coarse_values)[field.functions]
        # the coarser space also expands the known pressure to two degrees less
        error = np.linalg.norm(difference[field.place] - expected)
        assert error < 2e-2 * np.linalg.norm(expected)
