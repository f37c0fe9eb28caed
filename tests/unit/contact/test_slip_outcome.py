"""What coupled solves refuse, bound and estimate: the friction law, unknowns, shear and onset."""

import functools
import math
from dataclasses import replace

import pytest

from spectral_contact import Ending, Scene, solve
from spectral_contact.contact import zone_fields, zone_search
from spectral_contact.contact.full_stick import full_stick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.refine import refine
from spectral_contact.contact.slip_outcome import zones_outcome
from spectral_contact.contact.zone_problem import (
    FreeBoundaryProblem,
    solve_coupled_zones,
    solve_stick,
)
from spectral_contact.spectral.parameters import Parameters

PARAMETERS = Parameters(0.3, 0.2, 0.25, 0.15)


@functools.cache
def disk():
    return zones(20_000, 1e-2).best.value


# --- the friction law -----------------------------------------------------------------------------


def test_a_disk_that_obeys_the_law_passes():
    outcome = zones_outcome(disk(), PARAMETERS)
    assert outcome.consistent
    assert outcome.violation_text == ""


def test_traction_in_stick_beyond_friction_is_refused():
    outcome = zones_outcome(disk(), PARAMETERS._replace(friction=0.9 * 0.15))
    assert outcome.violation_text == "the traction in stick exceeds friction"


def test_rounding_of_radii_next_to_a_boundary_is_no_traction_beyond_friction():
    """Next to the stick radius q and f p differ by a root of the distance, 1e-8 at 1e-16."""
    thin = Scene(0.21, 8.1e-5, 5.3e-6, 0.038, coupling=True)
    assert solve(thin, 1e-12).error.violation <= 1e-12


@pytest.mark.parametrize("part", [0, 1, 2])
def test_pressure_that_pulls_is_refused(part):
    pressures = list(disk().pressures)
    pressures[part] = pressures[part].times(-1.0)
    outcome = zones_outcome(replace(disk(), pressures=pressures), PARAMETERS)
    assert outcome.violation_text == "the pressure is not positive"
    assert not outcome.verified
    assert outcome.violation == math.inf


def test_a_pressure_that_is_never_positive_is_no_convergence(monkeypatch):
    """Slip obeys ``q = f p`` under a negative pressure, too: only its sign refutes it."""
    monkeypatch.setattr(zone_fields, "all_positive", lambda pressures: False)
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1, coupling=True), 1e-2, strict=False)
    assert solution.ending is Ending.ZONES
    assert "the pressure is not positive" in str(solution.plan)
    # full stick, which is stored in its place, has a positive pressure
    assert 0.1 < solution.error.violation < math.inf


def test_traction_that_exceeds_friction_within_its_error_refutes_nothing():
    error = disk().traction_error
    outcome = zones_outcome(disk(), PARAMETERS._replace(friction=0.15 / (1.0 + error)))
    assert 1e-6 < outcome.violation < 2.0 * error
    assert outcome.violation_text == ""
    assert outcome.consistent


def test_zones_without_width_are_no_zones(monkeypatch):
    original = zone_search.CoupledSearch._candidates

    def candidates(search):
        yield zone_search.Candidate(Layout((1.0, 1.0), (0, 1, 0)), "zones without width")
        yield from original(search)

    monkeypatch.setattr(zone_search.CoupledSearch, "_candidates", candidates)
    assert len(solve(Scene(0.3, 0.3, 0.2, 0.1, coupling=True), 1e-4).zones) == 2


def test_zones_that_break_the_law_by_more_than_their_errors_are_no_convergence(monkeypatch):
    own = zone_search.CoupledSearch.outcome
    monkeypatch.setattr(
        zone_search.CoupledSearch, "outcome", lambda run: replace(own(run), violation_text="wrong")
    )
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1, coupling=True), 1e-2, strict=False)
    assert not solution.converged
    assert solution.ending is Ending.ZONES


def test_where_slip_has_hardly_a_digit_the_stick_radius_has_the_error_of_its_zone():
    """At the onset of an annulus the Jacobian is rounding, and shifts by it look small."""
    parameters = Parameters(0.05, 1.0, 1.0, 0.23)
    contact = solve_normal(0.05, 1e-4, 20_000, goal="traction").best.value
    annulus = Layout((-0.35, 3.2), (0, 1, 0))
    problem = FreeBoundaryProblem(parameters, annulus, 1e-2, known=contact)
    solved = refine(problem, 1e-2, 20_000).best.value
    known = zones_outcome(solved, parameters, contact)
    assert known.radius_error < 1e-3
    outcome = zones_outcome(replace(solved, slip_width_error=0.06), parameters, contact)
    slip_zone = outcome.zones[1]
    width = slip_zone.outer - slip_zone.inner
    assert outcome.slip_error > 0.1
    assert outcome.radius_error >= outcome.slip_error * width / slip_zone.inner


# --- unknowns -------------------------------------------------------------------------------------


def stick(most):
    return full_stick(solve_stick(Parameters(0.3, 0.2, 0.25, math.inf), 1e-10, most))


@functools.cache
def zones(most, tolerance=1e-10):
    layout = FreeBoundaryProblem(PARAMETERS, Layout((0.5,), (0, 1)), 1e-3).current_layout()
    return solve_coupled_zones(PARAMETERS, layout, tolerance, most)


@pytest.mark.parametrize(("solved", "most"), [(stick, 300), (zones, 400)])
def test_most_unknowns_are_those_of_both_fields(solved, most):
    found = solved(most)
    # half as many for each field, but for some that tails have
    assert most / 2 < max(step.unknowns for step in found.history) <= 1.01 * most


def test_a_solve_that_needs_more_unknowns_says_so():
    found = zones(400)
    assert found.ending is Ending.UNKNOWNS
    assert found.best.error > 1e-10


# --- estimates ------------------------------------------------------------------------------------


def test_the_shear_of_full_stick_has_an_error_of_its_own():
    """The approach settles far sooner here."""
    scene = Scene(-0.3, 5.0, 0.01, math.inf, coupling=True)
    loose, tight = (solve(scene, rtol, ("approach", "total_shear")) for rtol in (1e-2, 1e-9))
    error = abs(loose.total_shear / tight.total_shear - 1.0)
    assert 100.0 * abs(loose.approach / tight.approach - 1.0) < error
    assert error <= loose.error.total_shear < 1e-2


def test_where_the_errors_decide_on_slip_it_is_not_ruled_out():
    full = Scene(0.3, 0.5, 0.2, 100.0, coupling=True)
    critical = solve(full, 1e-3).critical_friction
    at, above = (solve(replace(full, friction=f), 1e-3) for f in (critical, 1.1 * critical))
    for solution, error in ((at, 1.0), (above, 0.0)):
        assert [zone.kind for zone in solution.zones] == ["stick"]
        own = solution.error
        assert (own.zones, own.slip) == (error, error)
        assert (own.stick_radius > 0.0) == (error > 0.0)
