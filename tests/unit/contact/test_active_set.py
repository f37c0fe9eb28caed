"""Zones on rings: those of the solver, closed forms, and the friction law on every ring."""

from math import inf, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import dblquad

from spectral_contact import Scene, solve
from spectral_contact.closed_forms import coupled_approach, coupled_shear, stick_radius
from spectral_contact.contact import active_set
from spectral_contact.contact.active_set import ring_layout
from spectral_contact.equations.kernels import normal_kernel, tangential_kernel
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.rings import graded_rings, ring_operators


def shear(found):
    return 2.0 * pi * float(found.ring_state.traction @ found.ring_state.system.rings.mass)


def boundaries(found):
    return [Radius.from_logit(logit) for logit in found.zones.logits]


def layout(scene, **options):
    compliances = scene.normal_compliance, scene.tangential_compliance
    parameters = Parameters(*compliances, scene.kappa, scene.friction)
    return ring_layout(parameters, coupled=scene.coupling, **options)


def test_matrices_are_integrals_of_the_kernels():
    rings = ring_operators(graded_rings(12, 3.0, 2.0, -6.0, 8.0))
    s = np.exp(-np.logaddexp(0.0, -rings.logits) / 2.0)
    for i, j in ((0, 4), (3, 1), (6, 9), (12, 4)):
        normal, _ = dblquad(
            lambda x, y: x * normal_kernel(y, x) / pi, s[i], s[i + 1], s[j], s[j + 1]
        )
        shear, _ = dblquad(
            lambda x, y: x * tangential_kernel(y, x) / pi, s[i], s[i + 1], s[j], s[j + 1]
        )
        assert rings.normal[i, j] == pytest.approx(normal, rel=1e-8)
        assert rings.tangential[i, j] == pytest.approx(shear, rel=1e-8)


def test_what_pressure_carries_is_exact():
    """Of p = 1 it is g = s/2, so that int g s ds = 1/6."""
    rings = ring_operators(graded_rings(20, 4.0, 1.5, -24.0, 36.0))
    assert rings.mass.sum() == pytest.approx(0.5, rel=1e-14)
    assert rings.coupling.sum() == pytest.approx(1.0 / 6.0, rel=1e-14)


def test_full_stick_of_smooth_surfaces_and_its_rate():
    errors = []
    for rings in (30, 60):
        found = ring_layout(
            Parameters(0.0, 0.0, 1.0, inf), coupled=False, first_rings=rings, splits=0
        )
        assert found.zones.states == (0,)
        assert shear(found) == pytest.approx(2.0 * np.log(2.0), rel=1e-4)
        errors.append(found.ring_state.approach - 0.125)
    assert 0.0 < errors[1] < 0.4 * errors[0] < 1e-5  # from above, as the energy demands


@pytest.mark.parametrize("nu", [-0.9, 0.0, 0.3])
def test_coupled_full_stick_of_smooth_surfaces(nu):
    kappa = Scene(nu).kappa
    found = ring_layout(Parameters(0.0, 0.0, kappa, inf), coupled=True, splits=0)
    assert found.ring_state.approach == pytest.approx(coupled_approach(nu), rel=1e-5)
    assert shear(found) == pytest.approx(coupled_shear(nu), rel=1e-3)


@pytest.mark.parametrize("ratio", [0.3, 0.5, 2.0, 10.0])
def test_partial_slip_of_smooth_surfaces(ratio):
    scene = Scene(0.1, friction=ratio * Scene(0.1).kappa)
    found = layout(scene)
    exact = stick_radius(scene.poisson_ratio, scene.friction)
    assert found.zones.states == (0, 1)
    [boundary] = boundaries(found)
    assert boundary.value == pytest.approx(exact.radius, rel=0.05)
    assert boundary.from_edge == pytest.approx(exact.from_edge, rel=0.05)


def test_coupled_partial_slip_of_smooth_surfaces():
    found = layout(Scene(0.0, friction=0.298714616, coupling=True))
    assert boundaries(found)[0].value == pytest.approx(0.5, rel=5e-3)
    assert found.ring_state.approach == pytest.approx(0.1187973528, rel=1e-5)
    assert shear(found) == pytest.approx(0.2710896535, rel=1e-4)


SLIP = [
    Scene(0.1, 0.5, 0.5, 0.1),
    Scene(0.3, 1e-6, 0.0, 0.1),
    Scene(0.3, 0.05, 1.0, 0.23 / 7.0),
    Scene(0.3, 0.0, 1e-4, 0.01),  # the edge sticks in 2e-11
]


@pytest.mark.parametrize("scene", SLIP)
@pytest.mark.parametrize("coupled", [False, True], ids=["uncoupled", "coupled"])
def test_zones_are_those_of_the_solver(scene, coupled):
    scene = Scene(*astuple(scene), coupling=coupled)
    found, solution = layout(scene), solve(scene, 1e-4)
    assert found.converged
    assert found.ring_state.pressure_is_positive
    assert ["slip" if state else "stick" for state in found.zones.states] == [
        zone.kind for zone in solution.zones
    ]
    assert found.ring_state.approach == pytest.approx(solution.approach, rel=1e-4)
    for boundary, zone in zip(boundaries(found), solution.zones[:-1], strict=True):
        assert boundary.logit == pytest.approx(
            Radius(zone.outer, zone.outer_from_edge).logit, abs=0.1
        )


def astuple(scene):
    return (
        scene.poisson_ratio,
        scene.normal_compliance,
        scene.tangential_compliance,
        scene.friction,
    )


@pytest.mark.parametrize(
    ("scene", "states"),
    [
        # a stick zone at the edge about to vanish
        (Scene(0.3, 0.05, 1.0, 0.02941066), (0, 1, 0)),
        (Scene(0.3, 0.2, 0.5, 0.592739 / 7.0), (0, 1, 0)),
        (Scene(0.3, 0.2, 0.5, 0.592 / 7.0), (0, 1)),
        (Scene(0.3, 0.2, 0.5, 0.08546448375462859, coupling=True), (0, 1, 0)),
        # where friction and coupling are strong, the first states are far from the last
        (Scene(0.0, friction=20.0, coupling=True), (0, 1)),
        (Scene(-0.5, 1e-9, 0.0, 2.0, coupling=True), (0, 1)),
        (Scene(0.3, 3.9, 4.8e-12, 14252.65, coupling=True), (0, 1)),
    ],
)
def test_zones_at_thresholds(scene, states):
    found = layout(scene)
    assert found.converged
    assert found.zones.states == states


@pytest.mark.parametrize("coupled", [False, True])
def test_a_stick_disk_smaller_than_any_ring_is_said_to_be_unseen(coupled):
    found = layout(Scene(0.3, 0.1, 0.1, 1e-80, coupling=coupled))
    assert found.converged
    assert found.zones.states == (1,)
    assert found.centre_unresolved
    seen = layout(Scene(0.3, 0.1, 0.1, 1e-5, coupling=coupled))  # below the first grid
    assert not seen.centre_unresolved
    assert boundaries(seen)[0].value == pytest.approx(0.2 * 1e-5 / Scene(0.3).kappa, rel=0.2)


def test_no_friction_and_no_tendency_to_slip():
    without = ring_layout(Parameters(0.5, 0.5, 0.2, 0.0), coupled=True)
    assert without.zones.states == (1,)
    assert (without.ring_state.traction == 0.0).all()
    assert (without.ring_state.displacement < 0.0).all()
    still = ring_layout(Parameters(0.5, 0.5, 0.0, 0.1), coupled=True)
    assert still.zones.states == (0,)
    assert (still.ring_state.traction == 0.0).all()


def test_layers_so_thin_that_full_stick_would_open_are_told():
    """The pressure at the edge is 0 at alpha = beta = 1.909e-4."""
    assert ring_layout(
        Parameters(2.1e-4, 2.1e-4, 0.25, inf), coupled=True
    ).ring_state.pressure_is_positive
    thin = ring_layout(Parameters(1.7e-4, 1.7e-4, 0.25, inf), coupled=True)
    assert thin.converged
    assert not thin.ring_state.pressure_is_positive


compliance = st.one_of(st.just(0.0), st.floats(-8.0, 3.0).map(lambda x: 10.0**x))


@given(compliance, compliance, st.floats(-3.0, 1.0), st.floats(-0.9, 0.49), st.booleans())
def test_the_law_holds_on_every_ring(alpha, beta, exponent, nu, coupled):
    scene = Scene(nu, alpha, beta, 10.0**exponent, coupling=coupled)
    found = layout(scene, first_rings=20, splits=1)
    assert found.converged
    assert (
        2.0 * pi * found.ring_state.pressure @ found.ring_state.system.rings.mass
        == pytest.approx(1.0)
    )
    if found.ring_state.pressure_is_positive:
        limit = scene.friction * found.ring_state.pressure
        assert (np.abs(found.ring_state.traction) <= limit * (1.0 + 1e-12)).all()
        assert (found.ring_state.displacement * found.ring_state.traction <= 0.0).all()
        slips = found.ring_state.states != 0
        assert ((found.ring_state.margin >= 0.0) != slips).all()
        assert found.ring_state.traction[slips] == pytest.approx(
            (found.ring_state.states * limit)[slips]
        )


def test_one_change_at_a_time_comes_to_the_same(monkeypatch):
    solved, original = [], active_set.RingSystem.solve

    def counted(law, states):
        solved.append(1)
        return original(law, states)

    monkeypatch.setattr(active_set.RingSystem, "solve", counted)
    scene = Scene(0.3, 0.05, 1.0, 0.23 / 7.0)
    found = layout(scene, first_rings=12, splits=0)
    systems = len(solved)
    monkeypatch.setattr(active_set, "RING_PATIENCE", 0)
    monkeypatch.setattr(
        active_set.RingState, "states_by_law", one_more_wrong(active_set.RingState.states_by_law)
    )
    slow = layout(scene, first_rings=12, splits=0)
    assert len(solved) - systems > systems
    assert (slow.ring_state.states == found.ring_state.states).all()


def one_more_wrong(wanted):
    """Return states that twice are wrong as often as before."""
    calls = []

    def changed(state):
        calls.append(state)
        return 1 - np.abs(state.states) if len(calls) < 3 else wanted(state)

    return changed


def test_states_that_do_not_settle_are_told(monkeypatch):
    monkeypatch.setattr(active_set, "MAX_STEPS", 1)
    found = layout(Scene(0.1, 0.5, 0.5, 0.1))
    assert not found.converged


def test_rings_that_err_next_to_narrow_ones_are_no_zones():
    """The edge sticks; next to it one ring amid slip does so on rings, though not in truth."""
    scene = Scene(-0.05799046105400951, 0.0, 0.026476370544551774, 0.4844998860969028)
    found = layout(scene, splits=3)
    assert np.count_nonzero(np.diff(found.ring_state.states)) == 4
    assert found.zones.states == (0, 1, 0)
    solution = solve(scene, 1e-6)
    assert [zone.kind for zone in solution.zones] == ["stick", "slip", "stick"]
    assert solution.error.zones < 1e-6
