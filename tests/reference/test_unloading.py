"""The first unloading against numbers of other solvers, laws and limits (docs/cycles)."""

from math import inf

import numpy as np
import pytest

from spectral_contact import QUANTITIES, NotComputedError, Scene, solve
from tests.oracles import graded_elements, legendre_matrices, load_history

#: The scene of docs/cycles, which slips at the edge.
LOADED = Scene(0.1, 0.5, 0.5, 0.1)
KAPPA = LOADED.kappa
#: By graded elements: boundaries and ``Q/kappa`` at a load ratio of 0.8.
BOUNDARIES = 0.641410268894, 0.675082689664
SHEAR = 0.2974672161999


@pytest.fixture(scope="module")
def unloaded():
    asked = "approach", "pressure", "traction", "slip", "zones", "stick_radius", "total_shear"
    return solve(LOADED.replace(unloaded_to=0.8), 1e-10, asked)


def test_normal_contact_and_full_stick_in_closed_form_matrices():
    known = {(0.5, 0.5): 0.464971875312765, (0.5, 1.0): 0.267484815875045}
    for (alpha, beta), shear in known.items():
        found = legendre_matrices.full_stick(alpha, beta, 300)
        assert found.approach == pytest.approx(0.29295979691047814, rel=1e-14)
        assert found.total_shear == pytest.approx(shear, rel=2e-13)
        own = solve(Scene(0.1, alpha, beta, inf), 1e-12, ["approach", "total_shear"])
        assert abs(own.total_shear / KAPPA / found.total_shear - 1.0) <= 2e-13
        assert abs(own.approach / found.approach - 1.0) <= 1e-14


def test_zones_and_shear_are_those_of_another_solver(unloaded):
    assert unloaded.converged
    assert [(z.kind, z.sense, z.memory) for z in unloaded.zones] == [
        ("stick", 1, False),
        ("slip", 1, False),
        ("stick", 1, True),
    ]
    error = unloaded.error
    off = abs(unloaded.total_shear / KAPPA / SHEAR - 1.0)
    assert off <= error.total_shear + 1e-12
    for zone, boundary in zip(unloaded.zones, BOUNDARIES, strict=False):
        # twelve digits are known
        assert abs(zone.outer / boundary - 1.0) <= error.zones + 1e-12
    assert max(error.total_shear, error.traction, error.stick_radius, error.zones) < 1e-9
    assert unloaded.stick_radius == unloaded.zones[0].outer


def test_load_ratios_are_those_of_another_solver():
    unloaded = solve(LOADED.replace(unloaded_to=0.8), 1e-10, ["reverse_ratio", "turning_ratio"])
    error = unloaded.error
    assert abs(unloaded.reverse_ratio / 0.2221247691538 - 1.0) <= error.reverse_ratio + 1e-12
    # c2 as a function of the load has its maximum there
    assert abs(unloaded.turning_ratio / 0.2200152471 - 1.0) <= error.turning_ratio + 1e-9
    assert error.reverse_ratio < 1e-9
    assert error.turning_ratio < 1e-6


def test_the_friction_law_holds_everywhere(unloaded):
    distance = np.concatenate([np.geomspace(1e-12, 1e-2, 100), np.linspace(0.01, 1.0, 900)])
    q = unloaded.traction(from_edge=distance)
    bound = 0.1 * unloaded.pressure(from_edge=distance)
    assert (np.abs(q) <= bound * (1.0 + 1e-9)).all()
    forward, memory = unloaded.zones[1:]
    slips = (distance < forward.inner_from_edge) & (distance > forward.outer_from_edge)
    np.testing.assert_allclose(q[slips], bound[slips], rtol=1e-10)
    # slip goes on where the surface slips, and is kept where it sticks
    before = solve(LOADED, 1e-10, ["slip"]).slip(from_edge=distance)
    now = unloaded.slip(from_edge=distance)
    inside = distance < memory.inner_from_edge
    np.testing.assert_allclose(now[inside], before[inside], atol=1e-11 * np.abs(before).max())
    assert (now[slips] < before[slips]).all()
    assert (now[distance > forward.inner_from_edge] == 0.0).all()


def test_what_sticks_keeps_the_displacement_by_quadrature(unloaded):
    from spectral_contact.equations.residuals import tangential_displacement

    cuts = [zone.outer_from_edge for zone in unloaded.zones[:-1]]
    for place in (0.9, 0.4, 0.31, 0.1, 0.01):
        traction = lambda d: unloaded.traction(from_edge=d)  # noqa: E731
        pressure = lambda d: unloaded.pressure(from_edge=d)  # noqa: E731
        outward, inward = tangential_displacement(traction, pressure, KAPPA, place, cuts)
        moved = outward - inward + 0.5 * float(unloaded.traction(from_edge=place))
        assert moved == pytest.approx(float(unloaded.slip(from_edge=place)), abs=1e-12)


def test_at_the_largest_load_it_is_the_loaded_scene():
    assert LOADED.replace(unloaded_to=1.0) == LOADED
    shear = solve(LOADED, 1e-10, ["total_shear"]).total_shear
    almost = solve(LOADED.replace(unloaded_to=1.0 - 1e-7), 1e-9, ["total_shear"])
    assert almost.total_shear == pytest.approx(shear, rel=2e-7)


@pytest.mark.parametrize(
    ("friction", "compliance"), [(None, 0.5), (0.0, 0.5), (0.5, 0.5), (inf, 0.5), (inf, 0.0)]
)
def test_without_partial_slip_all_is_proportional_to_the_load(friction, compliance):
    scene = LOADED.replace(friction=friction, tangential_compliance=compliance)
    loaded = solve(scene, 1e-10)
    unloaded = solve(scene.replace(unloaded_to=0.3), 1e-10, [*QUANTITIES, "reverse_ratio"])
    assert unloaded.converged
    assert unloaded.approach == pytest.approx(0.3 * loaded.approach, rel=1e-15)
    assert unloaded.total_shear == pytest.approx(0.3 * loaded.total_shear, rel=1e-15)
    s = np.linspace(0.0, 1.0, 7)
    np.testing.assert_allclose(unloaded.pressure(s), 0.3 * loaded.pressure(s), rtol=1e-14)
    np.testing.assert_allclose(unloaded.traction(s), 0.3 * loaded.traction(s), rtol=1e-14)
    with pytest.raises(NotComputedError, match=r"nothing|friction"):
        _ = unloaded.reverse_ratio


def shear_of_rings(loads, count, radii=()):
    """Return ``Q/kappa`` after loads one after another, on rings with ends at some radii."""
    rings = load_history.Rings(0.5, 0.5, 0.1 / KAPPA, load_history.even_ends(radii, count))
    for load in loads:
        rings.move_to(float(load))
    return rings.total_shear


@pytest.mark.parametrize("ratio", [0.8, 0.2205])
def test_it_is_the_limit_of_rings_whose_ends_are_those_of_the_zones(ratio):
    scenes = LOADED, LOADED.replace(unloaded_to=ratio)
    largest, unloaded = (solve(scene, 1e-10, ["zones", "total_shear"]) for scene in scenes)
    radii = [zone.outer for one in (largest, unloaded) for zone in one.zones[:-1]]
    coarse, fine = (shear_of_rings([1.0, ratio], count, radii) for count in (200, 400))
    known = unloaded.total_shear / KAPPA
    assert 1e-8 < abs(fine - known) < 1e-6
    # rings are of second order
    assert abs(fine + (fine - coarse) / 3.0 - known) <= 1e-8


def test_increments_approach_the_shear_below_the_turning_ratio_without_saying_so():
    one, few, more, many = (
        shear_of_rings(np.linspace(1.0, 0.1, steps + 1), 200) for steps in (1, 8, 32, 128)
    )
    assert [abs(found / many - 1.0) for found in (one, few, more)] == pytest.approx(
        [0.05, 0.009, 0.0005], rel=0.1
    )


def slip_back_begins(compliance, count):
    """Return the load ratio below which the outermost of some rings slips back, to 1e-4."""
    ends = 1.0 - np.linspace(1.0, 0.0, count + 1) ** 2
    below, above = 0.0, 1.0
    while above - below > 1e-4:
        middle = (below + above) / 2.0
        rings = load_history.Rings(0.5, compliance, 0.1 / KAPPA, ends)
        rings.move_to(1.0)
        rings.move_to(middle)
        if rings.traction[-1] <= -middle * rings.bound[-1] * (1.0 - 1e-9):
            below = middle
        else:
            above = middle
    return above


def test_without_tangential_compliance_slip_back_begins_at_once():
    assert slip_back_begins(0.5, 60) == pytest.approx(0.2221247691538, rel=0.02)
    # slip back is as wide as the square of the change of the load: here as the last ring
    for count in (30, 60):
        assert 1.0 - slip_back_begins(0.0, count) == pytest.approx(0.385 / count, rel=0.05)


def test_below_the_turning_ratio_it_is_refused_by_its_name():
    with pytest.raises(NotComputedError, match=r"below the turning ratio 0\.220015"):
        solve(LOADED.replace(unloaded_to=0.1), 1e-9, ["total_shear"])


def test_slip_back_at_the_edge_by_graded_elements():
    scene = LOADED.replace(unloaded_to=0.2205)
    found = solve(scene, 1e-7, ["total_shear", "zones", "traction", "pressure"])
    assert [(z.kind, z.sense, z.memory) for z in found.zones][2:] == [
        ("stick", 1, True),
        ("slip", -1, False),
    ]
    edge = float(found.traction(from_edge=0.0)) / float(found.pressure(from_edge=0.0))
    assert edge == pytest.approx(-0.1, rel=1e-12)
    before = graded_elements.loaded(0.5, 0.5, 0.1 / KAPPA, [0.6475686430034], (0, 1))
    guess = [zone.outer for zone in found.zones[:-1]]
    truth = graded_elements.unloaded(
        0.5, 0.5, 0.1 / KAPPA, 0.2205, guess, (0, 1, 0, -1), before, (0, 1)
    )
    off = abs(found.total_shear / KAPPA / truth.total_shear - 1.0)
    assert off <= found.error.total_shear
    for zone, boundary in zip(found.zones, truth.boundaries, strict=False):
        assert abs(zone.outer / boundary - 1.0) <= found.error.zones


def test_slip_inside_has_five_zones():
    scene = Scene.from_kappa(1.0 / 7.0, 0.05, 1.0, 0.23 / 7.0, unloaded_to=0.7)
    loaded = solve(scene.replace(unloaded_to=1.0), 1e-6, ["zones"])
    assert [zone.kind for zone in loaded.zones] == ["stick", "slip", "stick"]
    found = solve(scene, 1e-6, ["zones", "total_shear"])
    assert found.converged
    assert [(z.kind, z.memory) for z in found.zones] == [
        ("stick", False),
        ("slip", False),
        ("stick", True),
        ("slip", False),
        ("stick", False),
    ]
    inner, outer = (zone.outer for zone in loaded.zones[:2])
    assert found.zones[0].outer < inner < found.zones[1].outer
    assert found.zones[2].outer < outer < found.zones[3].outer


def test_a_slip_zone_that_shrank_to_no_width_is_not_the_answer():
    """Unconverged, its total shear was off by 1.4e-8, with an estimate of 3.2e-9.

    At a tolerance of 1e-9 it was off by as much, with an estimate of 1.1e-10.

    The truth is that of `graded_elements`, ``loaded(0.05, 1.0, 0.23, ...)`` and ``unloaded`` to
    0.999, which takes 25 s.
    """
    scene = Scene(0.3, 0.05, 1.0, 0.23 / 7, unloaded_to=0.999)
    found = solve(scene, 1e-7, ["zones", "total_shear"])
    assert abs(found.total_shear / 0.029919100765705 - 1.0) <= found.error.total_shear < 1e-9
    outer_slip = found.zones[3]
    assert outer_slip.inner == pytest.approx(0.97882760, rel=1e-7)
    assert outer_slip.outer == pytest.approx(0.9805197471, rel=1e-9)


def test_slip_back_in_a_narrow_annulus_is_seen():
    """It lay between two samples: zones without it counted as converged, and below turning, too.

    So close below the reverse ratio, 0.06265252072, the surface slips back in 1e-4 of the radius.
    """
    scene = Scene(0.3, 0.05, 1.0, 0.033, unloaded_to=0.062652506)
    found = solve(scene, 1e-8, ["zones", "pressure", "traction"])
    assert [zone.sense for zone in found.zones] == [1, 1, 1, -1, 1, 1, 1]
    from_edge = np.geomspace(1e-4, 0.9, 50_001)
    bound = scene.friction * found.pressure(from_edge=from_edge)
    assert np.abs(found.traction(from_edge=from_edge) / bound).max() <= 1.0 + 1e-8


def test_errors_of_boundaries_next_to_a_narrow_zone():
    """A step of the boundaries is small beside the radius, and not beside the zone's width.

    The traction was off by 2.3 times its estimate.
    """
    nu, alpha, beta, friction = -0.727, 258.0026, 10.8508778, 0.015161157790015
    scene = Scene(nu, alpha, beta, friction, unloaded_to=0.03949945306)
    asked = "traction", "pressure", "zones"
    found, exact = solve(scene, 4.9e-5, asked), solve(scene, 1e-9, asked)
    assert found.converged
    stick, exact_stick = found.zones[2], exact.zones[2]
    assert exact_stick.memory
    assert exact.zones[1].outer - exact.zones[1].inner < 3e-3
    # at places that the boundary fixes; the error is relative to f p
    places = np.linspace(0.02, 0.98, 20)
    radii, exact_radii = (
        zone.inner + places * (zone.outer - zone.inner) for zone in (stick, exact_stick)
    )
    off = np.abs(found.traction(radii) - exact.traction(exact_radii))
    bound = scene.friction * exact.pressure(exact_radii)
    assert (off / bound).max() <= found.error.traction + exact.error.traction
