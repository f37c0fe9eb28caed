"""Other stick disks than the one that coupled partial slip is solved with."""

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact import coupled_radii
from spectral_contact.contact.coupled_radii import CandidateRadius, stick_radii
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters


def radii(scene, logits):
    compliances = scene.normal_compliance, scene.tangential_compliance
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    problem = FreeBoundaryProblem(parameters, Layout((0.0,), (0, 1)), 1e-3)
    return list(stick_radii(problem, logits))


def test_a_thick_layer_has_one_which_is_that_of_the_solution():
    scene = Scene(0.1, 0.5, 0.5, friction=0.1, coupling=True)
    [found] = radii(scene, np.linspace(-10.0, 20.0, 31))
    assert found.admissible
    c = solve(scene, 1e-6, ("stick_radius",)).stick_radius
    assert found.logit == pytest.approx(np.log(c**2 / (1.0 - c**2)), abs=0.03)


def test_where_the_edge_sticks_both_are_told_from_contacts():
    """Slip lies in an interior annulus, so at one of the radii stick is beyond friction."""
    _, second = radii(
        Scene(0.25, 0.0026, 0.111, 0.1012, coupling=True), np.linspace(-6.0, 14.0, 21)
    )
    assert 0.1 < second.excess < np.inf  # the pressure is positive
    assert not second.admissible


def test_on_a_smooth_surface_the_pressure_of_others_is_negative():
    scene = Scene(0.026, 0.0, 0.0, friction=0.2143, coupling=True)
    first, *others = radii(scene, np.linspace(-6.0, 30.0, 37))
    assert first.admissible
    assert others
    assert not any(one.excess < np.inf for one in others)


@pytest.mark.parametrize(
    ("scene", "looked"),
    [
        (Scene(0.1, 0.5, 0.5, friction=0.1, coupling=True), False),
        (Scene(0.026, 0.0, 0.0, friction=0.2143, coupling=True), True),
    ],
    ids=["edge that slips", "smooth"],
)
def test_others_are_looked_for_where_there_may_be_some_and_named(monkeypatch, scene, looked):
    plain = solve(scene, 1e-3).plan
    seen = []

    def all_admissible(problem, logits, *, positive_only):
        logits = list(logits)
        seen.append(logits[0])
        assert positive_only
        yield CandidateRadius(5.0, 0.0)
        yield CandidateRadius(6.0, 0.5)

    monkeypatch.setattr(coupled_radii, "stick_radii", all_admissible)
    solution = solve(scene, 1e-3)
    text = "; a larger stick radius may satisfy the friction law, too: 0.997"
    assert (text in str(solution.plan)) == looked == bool(seen)
    assert text not in str(plain)
    if looked:
        c = solution.stick_radius
        assert seen[0] > np.log(c**2 / (1.0 - c**2))


def test_no_more_is_looked_at_where_the_pressure_is_negative():
    scene = Scene(0.026, 0.0, 0.0, friction=0.2143, coupling=True)
    problem = FreeBoundaryProblem(
        Parameters(0.0, 0.0, scene.kappa, scene.friction), Layout((0.0,), (0, 1)), 1e-3
    )
    taken = []

    def logits():
        for one in np.linspace(0.0, 30.0, 31):
            taken.append(one)
            yield one

    assert list(stick_radii(problem, logits(), positive_only=True)) == []
    assert 3 < len(taken) < 20


def test_a_narrow_annulus_is_the_same_at_every_tolerance():
    scene = Scene(
        0.3216563614452209,
        3.902806546943033,
        4.804038693556474e-12,
        14252.653932202149,
        coupling=True,
    )
    finest = solve(scene, 1e-12, ("zones",))
    for rtol in (1e-3, 1e-6, 1e-9):
        found = solve(scene, rtol, ("zones",))
        width, truth = found.zones[-1].inner_from_edge, finest.zones[-1].inner_from_edge
        assert abs(width / truth - 1.0) <= found.error.zones + finest.error.zones


@pytest.mark.parametrize("lack", [1e-5, 1e-7, 1e-9])
def test_slip_that_begins_at_the_edge_is_found(lack):
    stick = Scene(0.15, 0.05, 0.004, np.inf, coupling=True)
    critical = solve(stick, 1e-12, ("critical_friction",)).critical_friction
    scene = stick.replace(friction=critical * (1.0 - lack))
    widths = []
    for rtol in (1e-6, 1e-9, 1e-11):
        found = solve(scene, rtol)
        if 3.0 * lack < rtol:  # full stick, with room for it
            continue
        assert found.error.zones < 0.1
        widths.append((found.zones[-1].inner_from_edge, found.error.zones))
    for width, error in widths[:-1]:
        assert abs(width / widths[-1][0] - 1.0) <= error + widths[-1][1]
