"""Stress and displacement under profiles: Huber's sphere, flat punches added up, identities."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from oracles.inside_oracle import over_rings

from spectral_contact import NotComputedError, Scene, SceneError, profiles, solve
from spectral_contact.closed_forms import flat_punch_displacement, flat_punch_stress

A = 0.9
SPHERE = profiles.Parabola(1.3)
HERTZ = 8.0 / math.pi * A / 1.3  # the pressure at the centre
#: profile, its flat part, and the derivative of the load over that of the approach: dP = 8 b ddelta
SMOOTH = {
    "parabola": (SPHERE, 0.0, lambda b, _past: 2.0 * b / 1.3),
    "cone": (profiles.Cone(0.8), 0.0, lambda _b, _past: math.pi / 2.0 / math.tan(0.8)),
    "truncated cone": (
        profiles.TruncatedCone(0.5, 1.1),
        0.5,
        lambda b, past: (np.arctan2(np.sqrt(past), 0.5) + 0.5 / np.sqrt(past)) / math.tan(1.1),
    ),
    "rounded flat": (
        profiles.RoundedFlat(0.5, 1.0),
        0.5,
        lambda b, past: 2.0 * np.sqrt(past) - 0.5 * np.arctan2(np.sqrt(past), 0.5),
    ),
}


def smooth(profile, nu=0.3, rtol=1e-12, **options):
    return solve(Scene(nu, profile=profile, contact_radius=A, **options), rtol=rtol)


def huber(nu, from_edge, z):
    """Return rr, tt, zz, rz under a sphere, over the pressure at its centre (Huber 1904)."""
    with mp.workdps(80):
        nu, r, z = mp.mpf(nu), 1 - mp.mpf(from_edge), mp.mpf(z)
        rest = r**2 + z**2 - 1
        u = (rest + mp.sqrt(rest**2 + 4 * z**2)) / 2
        root = mp.sqrt(u)
        slant = z / root
        axial = slant**3 * u / (u**2 + z**2)
        low = (1 - 2 * nu) / 3 / r**2 * (1 - slant**3)
        share, angle = (1 - nu) * u / (1 + u), (1 + nu) * root * mp.atan(1 / root)
        rr = low + axial + slant * (share + angle - 2)
        tt = -low - slant * (2 * nu + share - angle)
        rz = -r * z**2 / (u**2 + z**2) * root / (1 + u)
        return np.array([float(one) for one in (rr, tt, -axial, rz)])


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.5])
def test_hubers_sphere_is_met_everywhere_and_estimates_are_honest(nu):
    rng = np.random.default_rng(5)
    size = 10.0 ** rng.uniform(-12.0, 0.0, (3, 25))
    from_edge = np.concatenate([size[0], -10.0 * size[1], 1.0 - size[2]])
    z = 10.0 ** rng.uniform(-12.0, 1.5, 75)
    stress = smooth(SPHERE, nu).inside.stress(from_edge=from_edge, z=z)
    pairs = zip(from_edge, z, strict=True)
    exact = HERTZ * np.array([huber(nu, d, h) for d, h in pairs]).T
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
    true = np.abs(got - exact).max(axis=0) / stress.norm
    assert np.all(true <= stress.error)
    assert stress.error.max() < (1e-11 if nu < 0.5 else 1e-5)  # it goes to zero at the edge then


def added(profile, from_edge, z, nu=0.3):
    """Return the fields of flat punches of all radii b, added up with the load of each."""
    _, first, rate = SMOOTH[profile]
    first /= A
    steps = 0.5 ** np.arange(60.0)
    ends = [c + s * steps for c in (first, 1.0, 1.0 - from_edge) for s in (-1.0, 1.0)]
    ends = np.unique(np.concatenate([*ends, [first, 1.0]]))
    ends = np.sqrt(ends[(ends >= first) & (ends <= 1.0)] - first)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    low, half = ends[:-1, None], np.diff(ends)[:, None] / 2.0
    x, weight = (low + half * (1.0 + nodes)).ravel(), (half * weights).ravel()
    b = first + x**2
    inside = np.minimum((from_edge - (1.0 - first - x**2)) / b, 1.0)
    places = {"from_edge": inside, "z": z / b}
    load = 8.0 * A * b * rate(A * b, A**2 * x**2 * (b + first)) * A * 2.0 * x * weight
    stress, moved = flat_punch_stress(nu, **places), flat_punch_displacement(nu, **places)
    return np.array(
        [*(part @ (load / (A * b) ** 2) for part in stress), *(u @ (load / (A * b)) for u in moved)]
    )


@pytest.mark.parametrize("name", SMOOTH)
def test_a_smooth_contact_is_flat_punches_of_all_radii(name):
    """As they add up under every profile, in the body as well (docs: profiles)."""
    profile, flat, _ = SMOOTH[name]
    body, corner = smooth(profile).inside, 1.0 - flat / A
    places = [(0.4, 0.2), (1.0, 1e-3), (1.0 - 1e-4, 1e-3), (-1e-5, 1e-7), (-3.0, 2.0)]
    places += [(corner - 1e-3, 1e-5)] if flat else []
    for from_edge, z in places:
        exact = added(name, from_edge, z)
        stress, moved = (
            body.stress(from_edge=from_edge, z=z),
            body.displacement(None, z, from_edge=from_edge),
        )
        got = np.array([stress.rr, stress.tt, stress.zz, stress.rz, moved.r, moved.z])
        assert np.abs(got - exact)[:4].max() <= stress.error * stress.norm
        assert np.abs(got - exact)[4:].max() <= moved.error * moved.modulus
        assert max(stress.error, moved.error) < 3e-12


ROUGH = {
    "cone": Scene(0.2, 0.01, profile=profiles.Cone(0.8), contact_radius=A),
    "truncated cone": Scene(0.2, 0.3, profile=profiles.TruncatedCone(0.5, 1.1), contact_radius=A),
    "thin layer": Scene(0.2, 1e-6, profile=profiles.RoundedFlat(0.5, 1.0), load=0.3),
    "points": Scene(
        0.2,
        0.2,
        profile=profiles.Sampled.from_points([0.0, 0.4, 0.8, 1.2], [0.0, 0.1, 0.4, 0.9]),
        contact_radius=A,
    ),
}


@pytest.fixture(scope="module")
def rough():
    return {name: solve(scene, rtol=1e-11, strict=False) for name, scene in ROUGH.items()}


@pytest.mark.parametrize("name", ROUGH)
@pytest.mark.parametrize("rtol", [None, 1e-8])
def test_layers_and_kinks_agree_with_another_quadrature(rough, name, rtol):
    solution = rough[name]
    a = solution.contact_radius
    place = next((1.0 - b / a for b in solution.scene.profile.breaks if b < a), 1.0)
    for from_edge, z in ((0.3, 0.1), (place - 1e-4, 1e-5), (1e-6, 1e-7), (-0.2, 0.01)):
        exact, known = over_rings(solution, from_edge, z)
        stress = solution.inside.stress(from_edge=from_edge, z=z, rtol=rtol)
        moved = solution.inside.displacement(from_edge=from_edge, z=z, rtol=rtol)
        got = np.array([stress.rr, stress.tt, stress.zz, stress.rz, moved.r, moved.z])
        apart = np.maximum(np.abs(got - np.array(exact)) - np.array(known), 0.0)
        assert apart[:4].max() <= stress.error * stress.norm
        assert apart[4:].max() <= moved.error * moved.modulus
        assert max(stress.error, moved.error) < (
            1e-7 if name == "thin layer" else 1e-9 + (rtol or 0)
        )


@pytest.mark.parametrize("name", ROUGH)
def test_the_surface_follows_the_punch(rough, name):
    solution = rough[name]
    body, s = solution.inside, np.array([0.0, 0.3, 0.7, 0.99])
    layer = solution.scene.normal_compliance * solution.pressure(s)
    within = 2.0 * body.surface(s).error.max() * solution.approach
    np.testing.assert_allclose(body.surface(s).gap, layer, rtol=0.0, atol=within)
    outside = body.surface([1.0, 1.1, 1e4])
    np.testing.assert_allclose(outside.gap[:2], solution.gap([1.0, 1.1]), rtol=0.0, atol=within)
    assert np.isnan(outside.gap[2]) == (name == "points")  # the profile has ended


@pytest.mark.parametrize("name", ["cone", "thin layer"])
def test_work_is_stored_in_body_and_layer(rough, name):
    energies = rough[name].inside.energies()
    assert energies.external == pytest.approx(rough[name].indentation_work, rel=1e-15)
    assert abs(energies.balance) <= energies.error * energies.external
    assert energies.error < 1e-8
    assert energies.friction == energies.defect == 0.0


def test_all_work_of_hertz_is_in_the_body():
    energies = smooth(SPHERE).inside.energies()
    work = 32.0 * A**5 / (15.0 * 1.3**2)  # int P ddelta, P = 16 a^3/(3 R), delta = a^2/R
    assert energies.strain == pytest.approx(work, rel=1e-13)
    assert energies.external == pytest.approx(work, rel=1e-13)


def test_the_largest_stresses_of_hertz():
    """Below the surface on the axis, and tension at the edge (Johnson 1985, section 3.4)."""
    body = smooth(SPHERE).inside
    z = np.linspace(0.4, 0.6, 200001)
    axial = -1.0 / (1.0 + z**2)
    radial = -1.3 * (1.0 - z * np.arctan(1.0 / z)) - axial / 2.0
    found = body.largest("von_mises")
    assert found.value == pytest.approx(HERTZ * np.max(radial - axial), rel=1e-10)
    assert found.r == 0.0
    assert found.z == pytest.approx(z[np.argmax(radial - axial)], abs=2e-6)
    tension = body.largest("surface_tension")
    assert tension.attained
    assert tension.r == 1.0
    assert tension.value == pytest.approx(0.4 / 3.0 * HERTZ, rel=1e-12)


def test_the_stress_at_a_smooth_tip_has_no_bound_but_for_incompressible_bodies():
    cone = smooth(profiles.Cone(0.8)).inside
    assert "tip" in cone.largest("max_shear").remark
    assert cone.largest("max_shear").value is None
    with pytest.raises(SceneError, match="pressure is infinite"):
        cone.stress(0.0, 0.0)
    assert np.isfinite(cone.displacement(0.0).z)
    assert list(np.isnan(cone.to_table([0.0, 0.5], [0.0, 0.0])["sigma_zz"])) == [True, False]
    # three halves of the slope of p = 2 cot(theta) arcosh(1/s) in the logarithm, on the axis
    soft = smooth(profiles.Cone(0.8), nu=0.5).inside.largest("von_mises")
    assert not soft.attained
    assert soft.value == pytest.approx(3.0 / math.tan(0.8), rel=1e-8)


def test_the_largest_stress_below_a_corner_is_found_however_small_its_neighbourhood_is():
    """Next to a corner in a thin layer stress varies within the width of the layer."""
    scene = Scene(0.3, 1e-4, profile=profiles.TruncatedCone(0.5, 1.1), contact_radius=A)
    body = solve(scene, rtol=1e-10).inside
    found = body.largest("max_shear")
    assert math.hypot(found.r - 0.5 / A, found.z) < 0.01
    angle, size = np.meshgrid(np.linspace(0.0, np.pi, 41), np.geomspace(1e-7, 0.4, 60))
    r, z = 0.5 / A + size * np.cos(angle), np.abs(size * np.sin(angle))
    assert body.stress(r, z, rtol=1e-7).max_shear.max() <= found.value * (1.0 + 1e-6)


def test_friction_under_a_profile():
    solution = smooth(
        SPHERE, rtol=1e-3, normal_compliance=0.2, tangential_compliance=0.2, friction=0.05
    )
    body, s = solution.inside, np.array([0.05, 0.3, 0.9])
    np.testing.assert_array_equal(body.stress(s).rz, -solution.traction(s))
    for from_edge, z in ((0.6, 0.1), (1.0 - solution.stick_radius, 1e-3), (1e-5, 1e-6)):
        exact, known = over_rings(solution, from_edge, z)
        stress = body.stress(from_edge=from_edge, z=z)
        got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
        apart = np.abs(got - np.array(exact[:4])) - np.array(known[:4])
        assert apart.max() <= 1e-8 * stress.norm
        assert 1e-8 < stress.error < 0.05  # of the traction
    with pytest.raises(NotComputedError, match="depends on its history"):
        body.energies()


def test_friction_under_a_corner_whose_radius_rounds_differently_in_both_loads():
    """The breaks of pressure and traction at 0.5/1.3 are one ulp apart."""
    scene = Scene(0.1, 0.1, 0.1, 0.2, profile=profiles.RoundedFlat(0.5, 1.0), contact_radius=1.3)
    solution = solve(scene, rtol=1e-3)
    for from_edge, z in ((0.5, 0.3), (1.0 - 0.5 / 1.3, 1e-3)):
        exact, known = over_rings(solution, from_edge, z)
        stress = solution.inside.stress(from_edge=from_edge, z=z)
        got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
        apart = np.abs(got - np.array(exact[:4])) - np.array(known[:4])
        assert apart.max() <= 1e-8 * stress.norm
        assert stress.error < 0.05


def test_displacements_over_the_contact_radius_have_its_error():
    """At s = r/a they are a times an integral of p(s): of the pressure alone if a is exact."""
    exact, off = smooth(SPHERE), 1e-6
    wrong = replace(
        exact,
        values=exact.values | {"contact_radius": A * (1.0 + off)},
        error=replace(exact.error, contact_radius=off),
    )
    r, z = np.array([0.0, 0.4, 1.0, 3.0]), np.array([0.0, 0.2, 0.0, 1.0])
    true, found = exact.inside.displacement(r, z), wrong.inside.displacement(r, z)
    apart = np.hypot(found.r - true.r, found.z - true.z)
    assert np.all(apart > 0.99 * off * true.modulus)
    assert np.all(apart <= found.error * found.modulus)
    assert np.all(found.error < 1.1 * off)


def test_units_of_a_table_under_a_profile():
    body = smooth(SPHERE).inside
    assert body.unit_names == ("a", "L", "E'")
    data = body.to_xarray([0.0, 1.0], [0.0, 0.5])
    assert data["u_z"].attrs["units"] == "L"
    assert data["sigma_zz"].attrs["units"] == "E'"
    assert float(data["u_z"][0, 0]) == pytest.approx(A**2 / 1.3, rel=1e-12)
