"""Stress and displacement in the body: closed forms, Hankel integrals, identities, bad input."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.inside_oracle import hankel, over_rings, stuck

from spectral_contact import (
    ErrorEstimates,
    NotComputedError,
    Scene,
    SceneError,
    SolutionFileError,
    solve,
)
from spectral_contact.closed_forms import flat_punch_displacement, flat_punch_stress

SCENES = {
    "slip": Scene(0.1, 0.5, 0.5, 0.1),
    "interior slip": Scene(0.3, 0.05, 1.0, 0.23 / 7.0),
    "coupled slip": Scene(0.2, 1e-3, 1e-3, 0.2, coupling=True),
    "coupled stick": Scene(0.0, 0.2, 0.5, math.inf, coupling=True),
    "oscillating": Scene(0.0, friction=math.inf, coupling=True),
}


@pytest.fixture(scope="module")
def solutions():
    return {name: solve(scene, rtol=1e-11) for name, scene in SCENES.items()}


def deviations(body, expected, **points):
    """Return the true errors of stress and displacement, relative to their sizes."""
    stress, moved = body.stress(**points), body.displacement(**points)
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
    of_stress = np.abs(got - np.array(expected[:4])).max(axis=0) / np.maximum(stress.norm, 1e-300)
    of_moved = np.abs(np.array([moved.r, moved.z]) - np.array(expected[4:])).max(axis=0)
    return (of_stress, stress.error), (of_moved / moved.modulus, moved.error)


def scattered(count):
    """Return points at every distance from the edge, the axis and the surface."""
    rng = np.random.default_rng(7)
    size = 10.0 ** rng.uniform(-12.0, 0.0, (4, count))
    from_edge = np.concatenate([size[0], -10.0 * size[1], 1.0 - size[2]])
    z = 10.0 ** rng.uniform(-12.0, 1.5, 3 * count)
    z[::10] = 0.0
    from_edge[-1], z[-1] = 1.0, 0.0  # the centre of the surface
    z[1 : 2 * count : 3] = np.abs(from_edge[1 : 2 * count : 3]) * rng.uniform(0.1, 3.0, 1)
    return {"from_edge": from_edge, "z": z}


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_sneddons_punch_is_met_everywhere_and_estimates_are_honest(nu):
    points = scattered(40)
    expected = [
        *flat_punch_stress(nu, **points),
        *flat_punch_displacement(nu, **points),
    ]
    for true, estimate in deviations(solve(Scene(nu)).inside, expected, **points):
        assert np.all(true <= estimate)
        assert np.all(estimate < 1e-12)


def test_rules_for_a_loose_tolerance_know_what_they_miss_of_sneddons_punch():
    """It is more than what they round and what the pressure lacks."""
    points = scattered(40)
    expected = [*flat_punch_stress(0.3, **points), *flat_punch_displacement(0.3, **points)]
    for true, estimate in deviations(solve(Scene(0.3)).inside, expected, **points, rtol=1e-8):
        assert np.all(true <= estimate)
        assert 1e-13 < np.max(true) < 1e-8


def test_under_an_exact_pressure_the_rounding_of_integrals_is_left():
    """Two rules may agree to the last bit, and be wrong by more."""
    solution = solve(Scene(0.3))
    body = replace(solution, error=ErrorEstimates(pressure=0.0, approach=0.0)).inside
    rng = np.random.default_rng(2)
    size = 10.0 ** rng.uniform(-9.0, 0.0, (2, 60))
    points = {"from_edge": np.concatenate([size[0], -100.0 * size[1]])}
    points["z"] = 10.0 ** rng.uniform(-9.0, 2.0, 120)
    stress, exact = body.stress(**points), flat_punch_stress(0.3, **points)
    parts = zip((stress.rr, stress.tt, stress.zz, stress.rz), exact, strict=True)
    true = np.max([np.abs(found - value) for found, value in parts], axis=0) / stress.norm
    eps = 2.0**-52
    assert np.all(true <= stress.error + eps)  # of the closed form
    assert np.all(stress.error >= eps)


def test_closed_form_has_the_stress_on_the_axis():
    z = np.array([0.0, 0.3, 1.0, 20.0])
    stress = flat_punch_stress(0.3, 0.0, z)
    np.testing.assert_allclose(stress.zz, -(1 + 3 * z**2) / (2 * np.pi * (1 + z**2) ** 2), 1e-14)
    np.testing.assert_allclose(stress.rr, stress.tt, 1e-14)
    np.testing.assert_allclose(flat_punch_displacement(0.3, 0.7).z, 0.125, 1e-15)


@pytest.mark.parametrize("z", [1e-12, 0.3])
@pytest.mark.parametrize("from_edge", [0.5, 1e-10, -1e-6])
def test_smooth_contact_that_sticks_is_met_down_to_edge_and_surface(from_edge, z):
    body = solve(Scene(0.2, friction=math.inf)).inside
    expected = stuck(0.2, 1.0 - from_edge, z, from_edge)
    for true, estimate in deviations(body, expected, from_edge=from_edge, z=z):
        assert true <= estimate < 1e-12


#: With layers and with none, where the traction is a square root at the boundary of stick and slip,
#: and what estimates next to it are below: without layers the boundary's own error is part of it.
BOUNDED = {
    "layers": (Scene(0.1, 0.5, 0.5, 0.1), 5e-11),
    "no layers": (Scene(0.1, 0.0, 0.0, 0.2), 1e-7),
}


@pytest.mark.parametrize("name", BOUNDED)
def test_next_to_the_boundary_of_stick_and_slip_no_digits_are_lost(name):
    """There radii cannot be told apart, but distances from the boundary can."""
    scene, known_to = BOUNDED[name]
    solution = solve(scene, rtol=1e-12)
    boundary = solution.zones[0].outer_from_edge
    for away in (1e-8, -1e-8, 1e-10, -1e-12):
        for z in (0.1 * abs(away), 3.0 * abs(away)):
            points = {"from_edge": boundary + away, "z": z}
            exact, known = over_rings(solution, **points)
            assert np.max(known[:4]) < 1e-11 * np.max(np.abs(exact[:4]))
            for true, estimate in deviations(solution.inside, exact, **points):
                assert true <= min(estimate, 1e-11)
                assert estimate < known_to


def test_estimates_next_to_a_boundary_know_that_it_may_be_elsewhere():
    scene = Scene(0.1, 0.5, 0.0, 0.2)
    rough, fine = (solve(scene, rtol=rtol) for rtol in (1e-6, 1e-12))
    away = np.array([1e-12, -1e-12, 1e-10, 1e-8, -1e-6])
    points = {"from_edge": fine.zones[0].outer_from_edge + away, "z": 0.3 * np.abs(away)}
    stress, moved = fine.inside.stress(**points), fine.inside.displacement(**points)
    exact = [stress.rr, stress.tt, stress.zz, stress.rz, moved.r, moved.z]
    for true, estimate in deviations(rough.inside, exact, **points):
        assert np.all(true <= estimate)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("r", "z"), [(0.64, 0.12), (1.2, 0.2), (1e-6, 0.4)])
def test_hankel_integrals_of_any_solution_are_met(solutions, name, r, z):
    solution = solutions[name]
    for true, estimate in deviations(solution.inside, hankel(solution, r, z), r=r, z=z):
        assert true <= estimate < 1e-10


@pytest.mark.parametrize("name", SCENES)
def test_on_the_surface_tractions_are_the_fields(solutions, name):
    solution = solutions[name]
    from_edge = np.array([1.0, 0.4, 1e-3, 1e-12])
    stress = solution.inside.stress(from_edge=from_edge)
    np.testing.assert_array_equal(stress.zz, -solution.pressure(from_edge=from_edge))
    np.testing.assert_array_equal(stress.rz, -solution.traction(from_edge=from_edge))
    outside = solution.inside.stress([1.0 + 1e-12, 3.0])
    assert np.all(outside.zz == 0.0)
    assert np.all(outside.rz == 0.0)


@pytest.mark.parametrize("name", SCENES)
def test_the_surface_is_the_limit_from_below(solutions, name):
    body, radii = solutions[name].inside, np.array([0.3, 0.9, 1.1])
    above, below = body.stress(radii), body.stress(radii, 1e-13)
    for component in ("rr", "tt", "zz", "rz"):
        apart = np.abs(getattr(above, component) - getattr(below, component))
        assert np.all(apart < 1e-11 * above.norm)


@pytest.mark.parametrize("name", ["coupled slip", "coupled stick", "oscillating"])
def test_coupled_displacements_of_the_surface_meet_the_boundary_conditions(solutions, name):
    solution = solutions[name]
    from_edge = np.array([0.99, 0.6, 0.3, 1e-2, 1e-6, 1e-12])
    scene = solution.scene
    surface = solution.inside.surface(from_edge=from_edge)
    layer = scene.normal_compliance * solution.pressure(from_edge=from_edge)
    size = np.hypot(surface.r, surface.z)
    assert np.all(np.abs(surface.gap - layer) <= 1e-10 * size)
    sticks = 1.0 - from_edge < solution.stick_radius
    sheared = scene.tangential_compliance * solution.traction(from_edge=from_edge)
    assert sticks.sum() >= 2
    assert np.all(np.abs(surface.r + sheared)[sticks] <= 1e-10 * size[sticks])


def test_without_coupling_the_surface_also_moves_under_the_traction(solutions):
    solution, radii = solutions["slip"], np.array([0.2, 0.8])
    gap = solution.inside.surface(radii).gap - 0.5 * solution.pressure(radii)
    for radius, extra in zip(radii, gap, strict=True):
        s, ds = np.polynomial.legendre.leggauss(400)
        s, ds = radius + (1.0 - radius) * (1.0 + s) / 2.0, ds * (1.0 - radius) / 2.0
        assert extra == pytest.approx(solution.scene.kappa * solution.traction(s) @ ds, rel=1e-5)


def test_far_away_the_stress_is_that_of_a_point_force(solutions):
    stress, distance = solutions["slip"].inside.stress(3e4, 4e4), 5e4
    zz = -3.0 / (2.0 * np.pi) * 4e4**3 / distance**5
    assert stress.zz == pytest.approx(zz, rel=1e-8)
    assert stress.rz == pytest.approx(zz * 0.75, rel=1e-8)


@pytest.mark.parametrize("name", ["coupled slip", "interior slip"])
def test_fields_are_in_equilibrium_and_obey_hooke(solutions, name):
    body, nu = solutions[name].inside, SCENES[name].poisson_ratio
    r, z, h = 0.7, 0.2, 2e-3
    steps = np.array([-2.0, -1.0, 1.0, 2.0]) * h
    rule = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * h)
    across, down = body.stress(r + steps, z), body.stress(r, z + steps)
    here = body.stress(r, z)
    radial = rule @ across.rr + rule @ down.rz + (here.rr - here.tt) / r
    axial = rule @ across.rz + rule @ down.zz + here.rz / r
    moved, sunk = body.displacement(r + steps, z), body.displacement(r, z + steps)
    strain = np.array([rule @ moved.r, body.displacement(r, z).r / r, rule @ sunk.z])
    double = 4.0 * (1.0 - nu)  # twice the shear modulus
    hooke = double * (strain + nu / (1.0 - 2.0 * nu) * strain.sum())
    shear = double / 2.0 * (rule @ moved.z + rule @ sunk.r)
    assert max(abs(radial), abs(axial)) < 1e-6
    np.testing.assert_allclose([here.rr, here.tt, here.zz, here.rz], [*hooke, shear], atol=1e-7)


def test_invariants_are_those_of_the_tensor(solutions):
    stress = solutions["slip"].inside.stress([[0.3], [1.4]], [0.1, 0.5, 2.0])
    assert stress.rr.shape == (2, 3)
    tensor = np.zeros((2, 3, 3, 3))
    tensor[..., 0, 0], tensor[..., 1, 1], tensor[..., 2, 2] = stress.rr, stress.tt, stress.zz
    tensor[..., 0, 2] = tensor[..., 2, 0] = stress.rz
    values = np.moveaxis(np.linalg.eigvalsh(tensor)[..., ::-1], -1, 0)
    np.testing.assert_allclose(stress.principal, values, atol=1e-14)
    np.testing.assert_allclose(stress.max_shear, (values[0] - values[2]) / 2.0, atol=1e-14)
    deviator = values - stress.mean
    np.testing.assert_allclose(stress.von_mises, np.sqrt(1.5 * (deviator**2).sum(axis=0)), 1e-12)
    np.testing.assert_allclose(stress.norm, np.sqrt((values**2).sum(axis=0)), 1e-12)


def test_physical_units_are_those_of_the_solution():
    scene = Scene.from_physical(
        radius=0.01, youngs_modulus=2e11, poisson_ratio=0.3, load=1e3, friction=None
    )
    solution = solve(scene)
    body, same = solution.physical.inside, solution.inside
    stress = body.stress(0.004, 0.002)
    assert stress.zz == pytest.approx(same.stress(0.4, 0.2).zz * 1e3 / 1e-4, rel=1e-14)
    assert body.surface(0.004).z == pytest.approx(solution.physical.approach, rel=1e-12)
    assert body.displacement(from_edge=-0.01, z=0.0).z == pytest.approx(body.surface(0.02).z)


@pytest.mark.parametrize(
    ("points", "name"),
    [
        ({"r": -0.1, "z": 0.0}, "r"),
        ({"r": math.nan, "z": 0.0}, "r"),
        ({"r": 0.5, "z": -1e-3}, "z"),
        ({"r": 0.5, "z": [0.1, math.inf]}, "z"),
        ({"r": "half", "z": 0.0}, "r"),
        ({"from_edge": 1.5, "z": 0.0}, "from_edge"),
        ({"r": [0.1, 0.2], "z": [0.1, 0.2, 0.3]}, "r, z"),
        ({"r": 0.5, "from_edge": 0.5, "z": 0.1}, "r, from_edge"),
        ({"z": 0.1}, "r, from_edge"),
        ({"r": 1e308, "z": 0.1}, "r"),
        ({"from_edge": -1e60, "z": 0.1}, "from_edge"),
        ({"r": 1.0, "z": 0.0}, "r, z"),
    ],
)
def test_bad_points_are_refused_by_name(points, name):
    with pytest.raises(SceneError) as caught:
        solve(Scene(0.3)).inside.stress(**points)
    assert caught.value.parameter == name


def test_the_farthest_and_the_nearest_points_have_values():
    body = solve(Scene(0.3, 0.2, 0.2, 0.1)).inside
    assert body.stress(0.0, 1e30).zz == pytest.approx(-1.5 / math.pi * 1e-60, rel=1e-10)
    edge = body.displacement(1.0)
    for near in (1e-300, 1e-120, 1e-60):
        assert body.displacement(from_edge=near, z=near).z == pytest.approx(edge.z, rel=1e-12)


def test_at_the_edge_the_displacement_has_a_value():
    assert solve(Scene(0.3)).inside.displacement(1.0).z == pytest.approx(0.125, rel=1e-12)


def test_what_was_not_computed_is_refused():
    with pytest.raises(NotComputedError):
        _ = solve(Scene(0.3, 0.5), quantities=["approach"]).inside


@pytest.mark.parametrize("rtol", [None, 1e-9, 1e-3])
@pytest.mark.parametrize("shape", [(0,), (0, 3), (2, 0)])
def test_no_points_are_no_error(solutions, rtol, shape):
    none = np.zeros(shape)
    for solution in solutions.values():
        body = solution.inside
        for found in (
            body.stress(none, 0.1, rtol=rtol).rr,
            body.stress(none, 0.0, rtol=rtol).error,
            body.stress(from_edge=none, z=none, rtol=rtol).von_mises,
            body.stress(0.5, none, rtol=rtol).principal[0],
            body.displacement(none, 0.1, rtol=rtol).z,
            body.displacement(0.5, none, rtol=rtol).modulus,
            body.surface(none, rtol=rtol).gap,
            body.surface(from_edge=none, rtol=rtol).error,
            *body.to_table(none, 0.1, rtol=rtol).values(),
        ):
            assert found.shape == shape
        assert body.to_xarray(none, [0.1, 0.2], rtol=rtol).sigma_zz.shape == (2, 0)
        assert body.to_xarray([0.1], none, rtol=rtol).u_r.shape == (0, 1)


def test_points_are_stored_as_a_table(tmp_path):
    body = solve(Scene(0.3)).inside
    table = body.to_table([0.0, 0.5], [0.5, 0.0])
    body.save(tmp_path / "body.npz", [0.0, 0.5], [0.5, 0.0])
    stored = np.load(tmp_path / "body.npz")
    assert all(np.array_equal(stored[name], one) for name, one in table.items())
    body.save(tmp_path / "body.csv", [0.0, 0.5], [0.5, 0.0])
    rows = np.genfromtxt(tmp_path / "body.csv", delimiter=",", names=True, skip_header=1)
    assert np.array_equal(rows["sigma_rr"], table["sigma_rr"])
    with pytest.raises(SolutionFileError, match=r"the suffix must be one of .csv, .npz, .nc$"):
        body.save(tmp_path / "body.txt", 0.0, 0.5)


def test_points_beyond_memory_are_refused_before_they_are_made():
    body, axis = solve(Scene(0.3)).inside, np.linspace(0.0, 2.0, 10**6)
    for evaluate in (body.to_xarray, lambda r, z: body.to_table(r, z[:, None])):
        with pytest.raises(SceneError, match=r"number of points r, z = 1000000000000: must be"):
            evaluate(axis, axis)
    with pytest.raises(SceneError, match=r"number of points from_edge, z = 1000000000000"):
        body.stress(from_edge=axis / 2.0, z=axis[:, None])


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
@pytest.mark.parametrize("name", SCENES)
def test_many_points_meet_a_tolerance_and_their_estimates(solutions, name, rtol):
    body, rng = solutions[name].inside, np.random.default_rng(3)
    from_edge, z = rng.uniform(-1.0, 1.0, 2500), rng.uniform(0.0, 1.5, 2500)
    z[::50] = 0.0
    some = slice(None, None, 25)
    for method, parts in (("stress", ("rr", "tt", "zz", "rz")), ("displacement", ("r", "z"))):
        evaluate = getattr(body, method)
        many = evaluate(from_edge=from_edge, z=z, rtol=rtol)
        few = evaluate(from_edge=from_edge[some], z=z[some])
        size = few.norm if method == "stress" else few.modulus
        for part in parts:
            apart = np.abs(getattr(many, part)[some] - getattr(few, part))
            assert np.all(apart <= (many.error[some] + few.error) * size)
        assert many.error.max() < 2e-8
        # the rest of an estimate is the errors of the loads, on which both hang
        assert (many.error[some] - few.error).max() < 3.0 * rtol


def test_from_many_points_on_the_surface_tractions_are_the_fields(solutions):
    solution = solutions["slip"]
    from_edge = np.linspace(-1.0, 1.0, 2001)[1:]
    stress = solution.inside.stress(from_edge=from_edge[from_edge != 0.0], rtol=1e-8)
    under = from_edge[from_edge > 0.0]
    np.testing.assert_array_equal(stress.zz[-len(under) :], -solution.pressure(from_edge=under))
    assert np.all(stress.rz[: -len(under)] == 0.0)


def test_one_point_many_times_where_no_polynomial_serves(solutions):
    solution = solutions["slip"]
    from_edge = np.full(400, 1.0 - solution.stick_radius)
    many = solution.inside.stress(from_edge=from_edge, z=1e-12, rtol=1e-8)
    one = solution.inside.stress(from_edge=from_edge[0], z=1e-12)
    assert np.all(np.abs(many.rr - one.rr) <= 1e-8 * one.norm)


@pytest.mark.parametrize("rtol", [0.0, 1.0, math.nan, "tight"])
def test_bad_tolerances_are_refused_by_name(rtol):
    with pytest.raises(SceneError, match="rtol"):
        solve(Scene(0.3)).inside.stress(0.5, 0.5, rtol=rtol)


@pytest.mark.parametrize(
    "scene",
    [
        Scene(0.1, 0.5, 0.5, 0.1),
        Scene(0.2, 1e-3, 1e-3, 0.2, coupling=True),
        Scene(0.2, friction=math.inf),
    ],
)
def test_work_is_stored_dissipated_or_the_defect_of_the_model(scene):
    energies = solve(scene, rtol=1e-12).inside.energies()
    assert abs(energies.balance) <= 1e-13 * energies.external
    assert energies.error < 1e-11
    uncoupled = bool(scene.friction) and not scene.coupling
    assert (energies.defect > 1e-4 * energies.external) == uncoupled


def test_dissipation_is_not_known_better_than_the_slip():
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1), rtol=1e-6)
    assert solution.error.slip < 1e-5
    unsure = replace(solution, error=replace(solution.error, slip=1e-3))
    found = unsure.inside.energies()
    friction = found.friction / found.external
    assert friction > 1e-4
    assert 1e-3 * friction <= found.error < 1.1e-3 * friction


def test_energies_of_sneddons_punch_and_their_units():
    scene = Scene.from_physical(
        radius=0.01, youngs_modulus=2e11, poisson_ratio=0.3, load=1e3, friction=None
    )
    physical = solve(scene).physical
    energies = physical.inside.energies()
    assert energies.strain == pytest.approx(1e3 * physical.approach / 2.0, rel=1e-13)
    assert energies.layer == energies.friction == energies.defect == 0.0


def test_largest_stress_of_an_almost_uniform_pressure_is_on_the_axis():
    """Uniform pressure on a disk (Love 1929), but for terms in 1 / alpha."""
    found = solve(Scene(0.5, 1e10, friction=None), rtol=1e-12).inside.largest("von_mises")
    z = np.linspace(0.5, 1.0, 200001)  # on the axis of the uniform load
    root = z / np.sqrt(1.0 + z**2)
    expected = (1.5 * (root - root**3)) / np.pi
    assert found.attained
    assert found.value == pytest.approx(expected.max(), rel=1e-9)
    assert found.r == 0.0
    assert found.z == pytest.approx(z[expected.argmax()], abs=1e-5)


def test_nothing_exceeds_the_largest_stress():
    measure = "max_shear"
    body = solve(Scene(0.3, 0.2, friction=None), rtol=1e-11).inside
    found = body.largest(measure)
    angle, size = np.meshgrid(np.linspace(0.0, np.pi, 41), np.geomspace(1e-9, 1.0, 60))
    stress = body.stress(from_edge=size * np.cos(angle), z=size * np.sin(angle), rtol=1e-8)
    assert np.max(getattr(stress, measure)) <= found.value * (1.0 + 1e-8)
    assert getattr(body.stress(found.r, found.z), measure) == pytest.approx(found.value, rel=1e-9)


def test_stress_without_bound_and_a_supremum_at_the_edge_are_named():
    sneddon = solve(Scene(0.3)).inside
    assert sneddon.largest("von_mises").value is None
    assert "smooth" in sneddon.largest("max_shear").remark
    tension = sneddon.largest("surface_tension")
    assert tension.value == pytest.approx(0.4 / (2.0 * np.pi), rel=1e-7)
    assert not tension.attained
    rubbed = solve(Scene(0.1, 0.5, 0.5, 0.1)).inside
    assert "traction" in rubbed.largest("von_mises").remark
    inward = solve(Scene(0.0, friction=math.inf, coupling=True)).inside
    assert "change sign" in inward.largest("surface_tension").remark
    with pytest.raises(SceneError, match="measure"):
        sneddon.largest("tresca")


@pytest.mark.parametrize("field", [flat_punch_stress, flat_punch_displacement])
def test_the_closed_form_at_its_ends(field):
    """The edge and what is next to it raise no warning; what would overflow is refused."""
    for r, z in ((1.0, 0.0), (1.0, 1e-300), (1e100, 0.0), (0.0, 1e100)):
        field(0.3, r, z)
    with pytest.raises(ValueError, match=r"r = 1e\+101.*in \[0, 1e\+100\]"):
        field(0.3, 1e101)
