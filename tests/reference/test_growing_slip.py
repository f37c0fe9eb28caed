"""Slip under a growing contact: the tangential law then and now, a march, scaling, estimates."""

import functools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.growing_rings import march

from spectral_contact import NotComputedError, Scene, Solution, plan, profiles, solve
from spectral_contact.equations import residuals
from spectral_contact.solving.growth import check_stick_radii

NU = 0.3
PARABOLA, CONE = profiles.Parabola(1.0), profiles.Cone(1.0)
PLACES = np.linspace(0.0, 1.0, 201)


@functools.cache
def solved(profile, alpha, beta, friction, rtol=1e-4, radius=1.0, coupling=False):
    scene = Scene(
        NU, alpha, beta, friction, profile=profile, contact_radius=radius, coupling=coupling
    )
    return solve(scene, rtol, strict=False)


def displacement(solution, from_edge):
    """Return ``a (T q - kappa g) + beta q``, by quadrature of the elliptic kernel."""
    scene = solution.scene
    outward, inward = residuals.tangential_displacement(
        lambda d: solution.traction(from_edge=d),
        lambda d: solution.pressure(from_edge=d),
        scene.kappa,
        from_edge,
        [1.0 - zone.outer for zone in solution.zones[:-1]],
    )
    layer = scene.tangential_compliance * float(solution.traction(from_edge=from_edge))
    return solution.contact_radius * (outward - inward) + layer


@pytest.mark.parametrize("r", [0.7, 0.4])
def test_slip_is_by_how_much_the_surface_has_moved_since_it_came_into_contact(r):
    """Where it slips, and where it has stuck after it slipped: two contacts, the equation (4.2)."""
    now, then = (solved(PARABOLA, 0.2, 0.1, 0.1, 1e-6, radius=a) for a in (1.0, r))
    moved = displacement(now, 1.0 - r) - displacement(then, 1e-12)
    largest = np.abs(now.slip(PLACES)).max()
    assert float(now.slip(r)) == pytest.approx(moved, abs=1e-7 * largest)
    assert abs(float(now.slip(r)) - moved) <= now.error.slip * largest
    assert now.error.slip < 1e-6
    assert (r < now.stick_radius) == (r == 0.4)


@pytest.mark.parametrize(
    ("profile", "power", "coupling"), [(PARABOLA, 2, False), (CONE, 1, False), (PARABOLA, 2, True)]
)
def test_on_a_smooth_surface_what_has_stuck_has_slipped_like_the_height(profile, power, coupling):
    """There ``c/a`` is constant, so that all radii have the same history but for its scale."""
    solution = solved(profile, 0.0, 0.0, 0.2, coupling=coupling)
    s = solution.stick_radius * np.array([0.01, 0.2, 0.7, 0.999])
    rates = solution.slip(s) / s**power
    assert rates == pytest.approx(rates[0], rel=1e-5)
    if coupling:
        then = solved(profile, 0.0, 0.0, 0.2, radius=0.7, coupling=True)
        moved = displacement(solution, 0.3) - displacement(then, 1e-12)
        assert float(solution.slip(0.7)) == pytest.approx(moved, rel=2e-5)
    else:
        small = solved(profile, 0.0, 0.0, 0.2, radius=0.1)
        assert small.slip(PLACES) * 10.0**power == pytest.approx(solution.slip(PLACES), abs=1e-9)


def test_a_march_in_increments_slips_as_far():
    """Rings that enter, stick where they are, and slip by the law; no superposition."""
    solution = solved(PARABOLA, 0.2, 0.1, 0.1)
    kappa, some = Scene(NU).kappa, np.arange(0.2, 0.9, 0.05)
    truth, found = solution.slip(some), []
    for count in (40, 80):
        rings = march(PARABOLA.height, 0.2, 0.1, kappa, 0.1, count)
        found.append(np.interp(some, rings.middles, rings.slip))
    largest = np.abs(truth).max()
    first, second = (np.abs(one - truth).max() / largest for one in found)
    assert first / second == pytest.approx(2.0, abs=0.2)
    assert np.abs(2.0 * found[1] - found[0] - truth).max() < 0.005 * largest


@pytest.mark.parametrize("coupling", [False, True])
def test_next_to_the_end_of_a_flat_part_errors_of_stick_radii_are_no_fall(coupling):
    """It was refused: points that stuck would slip again."""
    punch = profiles.RoundedFlat(0.5, 1.0)
    scene = Scene(NU, 0.2, 0.2, 0.1, profile=punch, contact_radius=1.0, coupling=coupling)
    found = solve(scene, 1e-2, ("total_shear", "stick_radius"))
    marches = [
        march(punch.height, 0.2, 0.2, scene.kappa, 0.1, count, coupled=coupling)
        for count in (40, 80)
    ]
    shear = 2.0 * marches[1].shear - marches[0].shear
    assert found.total_shear == pytest.approx(shear, rel=found.error.total_shear + 5e-4)
    flat = solve(Scene(NU, 0.2, 0.2, 0.1, coupling=coupling), 1e-10)
    error = abs(found.stick_radius / flat.stick_radius - 1.0)
    assert error <= found.error.stick_radius < 1e-4


@pytest.mark.parametrize(("fall", "error"), [(2e-8, 0.0), (1e-5, 4e-6)])
def test_a_stick_radius_that_falls_by_more_than_its_errors_is_refused(fall, error):
    flat = SimpleNamespace(error=SimpleNamespace(stick_radius=error))
    panels = [SimpleNamespace(flats=(flat, flat))]
    rises, falls = [(0.5, 0.3), (0.6, 0.31)], [(0.5, 0.3), (0.6, 0.3 * (1.0 - fall))]
    check_stick_radii(SimpleNamespace(stick_radii=rises, panels=panels))
    with pytest.raises(NotComputedError, match=r"falls at the contact radius 0\.6"):
        check_stick_radii(SimpleNamespace(stick_radii=falls, panels=panels))


def test_slip_opposes_the_traction_and_is_zero_where_nothing_has_slipped():
    solution = solved(PARABOLA, 0.2, 0.1, 0.1)
    slip = solution.slip(PLACES)
    assert (slip <= 1e-12).all()
    assert slip[0] == 0.0 == pytest.approx(slip[-1], abs=1e-20)
    assert solution.slip(0.1) == 0.0
    c = solution.stick_radius
    assert solution.slip(c * (1.0 - 1e-9)) == pytest.approx(solution.slip(c * (1.0 + 1e-9)))
    # the rate at the edge: a point there slips as the flat punch's edge does
    assert float(solution.slip(from_edge=1e-7) / solution.slip(from_edge=1e-6)) == pytest.approx(
        0.1, rel=1e-4
    )


def test_true_errors_of_the_slip_are_within_their_estimates():
    best, rough = (solved(PARABOLA, 0.0, 0.0, 0.2, rtol) for rtol in (1e-8, 1e-2))
    truth = best.slip(PLACES)
    off = np.abs(rough.slip(PLACES) - truth).max() / np.abs(truth).max()
    assert off <= rough.error.slip
    assert best.error.slip < 1e-8
    assert rough.error.slip < 1e-3


def test_full_stick_slips_nowhere():
    solution = solved(PARABOLA, 0.2, 0.2, math.inf)
    assert (solution.slip(PLACES) == 0.0).all()
    assert solution.error.slip == 0.0


def test_slip_is_computed_only_if_it_is_asked_for():
    scene = Scene(NU, friction=0.2, profile=PARABOLA, contact_radius=1.0)
    without = solve(scene, 1e-4, ["traction", "load"])
    assert without.slip_field is without.error.slip is None
    with pytest.raises(NotComputedError, match="slip"):
        without.slip(0.5)
    alone = solve(scene, 1e-4, ["slip"])
    assert alone.plan.quantities == ("slip",)
    assert float(alone.slip(0.5)) == float(solved(PARABOLA, 0.0, 0.0, 0.2).slip(0.5))
    assert "slip" in plan(scene).quantities


def test_slip_is_stored_and_has_a_length_in_si_units(tmp_path):
    solution = solved(PARABOLA, 0.0, 0.0, 0.2)
    solution.save(tmp_path / "grown.npz")
    for found in (Solution.from_json(solution.to_json()), Solution.load(tmp_path / "grown.npz")):
        assert found == solution
        assert (found.slip(PLACES) == solution.slip(PLACES)).all()
    ball = Scene.from_physical(
        youngs_modulus=1e9,
        poisson_ratio=NU,
        friction=0.2,
        profile=profiles.Parabola(1e-2),
        contact_radius=1e-3,
    )
    physical = solve(ball, 1e-4).physical
    # the parabola's slip goes like a**2/R
    assert float(physical.slip(5e-4)) == pytest.approx(1e-4 * float(solution.slip(0.5)), rel=1e-9)
