"""Scenes of two elastic bodies: what they are made of, and everything that knows them."""

import itertools
import json
import math
import pickle

import numpy as np
import pytest

from spectral_contact import (
    NotComputedError,
    Scene,
    SceneError,
    Solution,
    compare,
    gold,
    layers,
    profiles,
    solve,
)
from spectral_contact.__main__ import main
from spectral_contact.calibration import ApproachData, IndentationData, StickRadiusData, fit
from spectral_contact.precise import reference
from spectral_contact.scene import same_problem
from spectral_contact.solving.solver import Continuation
from spectral_contact.studies import sensitivity
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.sweep_parameters import grid, listed
from spectral_contact.testing import check_solution
from spectral_contact.view.explorer.state import texts_of

BALL = profiles.Parabola(10e-3)
RUBBER = {"youngs_modulus": 1e7, "poisson_ratio": 0.4}
GLASS = {"youngs_modulus": 70e9, "poisson_ratio": 0.2}


def between(first, second, **given):
    punch = {f"punch_{name}": value for name, value in second.items()}
    return Scene.from_physical(**first, **punch, **{"profile": BALL, "load": 10.0, **given})


def quarter(body):
    return body["youngs_modulus"] / (4.0 * (1.0 - body["poisson_ratio"] ** 2))


def kappa_of(body):
    return (1.0 - 2.0 * body["poisson_ratio"]) / (4.0 * (1.0 - body["poisson_ratio"]))


# --- kappa with its sign --------------------------------------------------------------------------


@pytest.mark.parametrize("coupling", [False, True])
@pytest.mark.parametrize("friction", [0.0, 0.01, 0.03, math.inf])
def test_a_negative_kappa_turns_what_is_radial_and_nothing_else(friction, coupling):
    own = solve(Scene.from_kappa(0.05, 0.2, 0.5, friction, coupling=coupling))
    turned = solve(own.scene.replace(kappa=-0.05))
    s = np.linspace(0.0, 1.0, 9)
    assert np.array_equal(turned.traction(s), -own.traction(s))
    assert np.array_equal(turned.slip(s), -own.slip(s))
    assert np.array_equal(turned.pressure(s), own.pressure(s))
    assert turned.total_shear == -own.total_shear
    assert turned.total_shear < 0.0 or friction == 0.0
    for name in ("approach", "zones", "stick_radius", "edge_ratio", "critical_friction", "error"):
        assert getattr(turned, name) == getattr(own, name)
    assert turned.critical_friction >= turned.edge_ratio > 0.0
    assert turned.scene.kappa == -0.05
    assert check_solution(turned, turned.scene, 1e-8).passed


def test_a_check_sees_a_traction_of_the_wrong_sign():
    scene = Scene.from_kappa(-0.05, 0.2, 0.5, math.inf)
    with pytest.raises(AssertionError, match="no displacement in stick"):
        check_solution(solve(scene.replace(kappa=0.05)), scene, 1e-8)


@pytest.mark.parametrize("coupling", [False, True])
def test_kappa_is_that_of_a_poisson_ratio(coupling):
    one = Scene(0.3, 0.2, 0.5, 0.1, coupling=coupling)
    other = Scene.from_kappa(one.kappa, 0.2, 0.5, 0.1, coupling=coupling)
    assert other.poisson_ratio is None
    assert solve(one).values == solve(other).values


@pytest.mark.parametrize("friction", [0.1, math.inf])
def test_with_kappa_0_there_is_no_traction(friction):
    scene = Scene.from_kappa(0.0, 0.2, 0.5, friction, coupling=True)
    assert not scene.couples
    found = solve(scene)
    assert found.total_shear == found.critical_friction == 0.0
    assert not found.traction([0.5, 1.0]).any()
    assert any(step.reason.startswith("at kappa = 0") for step in found.plan.steps)


def test_a_growing_contact_turns_with_its_history():
    given = {"profile": profiles.Parabola(1.0), "contact_radius": 1.0}
    own = solve(Scene.from_kappa(0.05, 0.2, 0.2, 0.01, **given), 1e-6)
    turned = solve(own.scene.replace(kappa=-0.05), 1e-6)
    assert turned.total_shear == -own.total_shear < 0.0
    assert np.array_equal(turned.history.total_shear(), -own.history.total_shear())
    assert turned.history.total_shear()[-1] == pytest.approx(turned.total_shear, rel=1e-6)
    assert np.array_equal(turned.history.stick_radius(), own.history.stick_radius())
    assert check_solution(turned, turned.scene, 1e-5).passed


@pytest.mark.parametrize("kappa", [0.375, -0.375, math.nan, 1e-17, -1e-300, None, "0.1"])
def test_what_is_no_kappa(kappa):
    with pytest.raises(SceneError, match=r"^kappa = "):
        Scene.from_kappa(kappa)


def test_kappa_and_poisson_ratio_take_the_place_of_each_other():
    scene = Scene.from_kappa(-0.1, 0.5, friction=0.2)
    assert scene.replace(poisson_ratio=0.3) == Scene(0.3, 0.5, friction=0.2)
    assert Scene(0.3, 0.5, friction=0.2).replace(kappa=-0.1) == scene
    assert repr(scene) == "Scene.from_kappa(kappa=-0.1, normal_compliance=0.5, friction=0.2)"
    with pytest.raises(SceneError, match="must be None where kappa is given"):
        Scene(0.3, mismatch=-0.1)
    with pytest.raises(TypeError, match=r"Scene\.from_kappa"):
        Scene(0.3, kappa=-0.1)


def test_without_friction_no_material_is_needed_and_with_friction_one_is():
    assert solve(Scene(None, 0.5)).approach == solve(Scene(0.3, 0.5)).approach
    with pytest.raises(SceneError, match=r"κ of this scene is not known"):
        _ = Scene(None, 0.5).kappa
    with pytest.raises(SceneError, match="poisson_ratio = None: must be a real number"):
        Scene(None, 0.5, friction=0.1)


@pytest.mark.parametrize("scene", [Scene.from_kappa(0.1, 0.5), Scene(None, 0.5)])
def test_stress_inside_takes_the_poisson_ratio_of_a_body(scene):
    with pytest.raises(SceneError, match="poisson_ratio = None"):
        _ = solve(scene).inside


# --- SI data --------------------------------------------------------------------------------------


def test_the_effective_scene_is_the_one_of_dundurs():
    scene = between(RUBBER, GLASS, friction=0.3, normal_compliance=1e-12)
    first, second = quarter(RUBBER), quarter(GLASS)
    modulus = first * second / (first + second)
    kappa = (kappa_of(RUBBER) * second - kappa_of(GLASS) * first) / (first + second)
    assert scene.kappa == pytest.approx(kappa, rel=1e-14)
    assert scene.load == pytest.approx(10.0 / modulus, rel=1e-14)
    assert scene.normal_compliance == pytest.approx(1e-12 * modulus, rel=1e-14)
    assert scene.physical.quarter_modulus(0.4) == pytest.approx(modulus, rel=1e-14)
    assert scene.poisson_ratio == 0.4


def test_two_parabolas_of_one_material_are_hertz():
    half = {"youngs_modulus": 20e9, "poisson_ratio": 0.3}
    shape = profiles.Parabola(50e-3)
    given = {"profile": shape, "punch_profile": shape, "load": None, "approach": 4e-3}
    found = solve(between(half, half, **given, friction=0.1), 1e-12)
    assert found.scene.profile == profiles.Parabola(25e-3)
    assert found.physical.pressure(0.0) / 1e6 == pytest.approx(2798.328670, abs=5e-7)
    assert found.physical.contact_radius == pytest.approx(10e-3, rel=1e-13)
    assert found.scene.kappa == 0.0
    assert found.total_shear == 0.0


def test_moduli_that_rounding_makes_unequal_are_equal():
    other = {**GLASS, "youngs_modulus": math.nextafter(70e9, 1e11)}
    assert between(GLASS, other).kappa == 0.0


def test_the_limit_of_a_stiff_punch_is_the_rigid_one():
    stiff = between(RUBBER, {"youngs_modulus": 1e24, "poisson_ratio": 0.2}, friction=0.1)
    rigid = Scene.from_physical(**RUBBER, profile=BALL, load=10.0, friction=0.1)
    found, expected = (solve(one, 1e-4).physical for one in (stiff, rigid))
    for name in ("contact_radius", "approach", "total_shear"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-10)


@pytest.mark.parametrize(("friction", "coupling"), [(0.03, False), (0.03, True), (math.inf, True)])
def test_exchange_of_the_bodies_turns_traction_and_sides_and_nothing_else(friction, coupling):
    given = {"friction": friction, "coupling": coupling, "normal_compliance": 1e-10}
    given |= {"tangential_compliance": 1e-10}
    one, other = between(RUBBER, GLASS, **given), between(GLASS, RUBBER, **given)
    assert other.kappa == -one.kappa < 0.0
    a, b = (solve(scene, 1e-2) for scene in (one, other))
    a, b = a.physical, b.physical
    r, z = np.array([0.0, 0.3, 0.9, 1.4]) * a.radius, np.array([0.5, 0.1, 0.01, 0.2]) * a.radius
    assert b.total_shear == -a.total_shear < 0.0
    assert (b.approach, b.contact_radius) == (a.approach, a.contact_radius)
    for left, right in ((a.inside, b.punch_inside), (a.punch_inside, b.inside)):
        for part in ("rr", "tt", "zz", "rz", "von_mises"):
            found = [getattr(body.stress(r, z), part) for body in (left, right)]
            assert np.array_equal(*found)
        moved = [body.displacement(r, z) for body in (left, right)]
        assert np.array_equal(moved[0].r, moved[1].r)
        assert np.array_equal(moved[0].z, moved[1].z)
    if not coupling:
        assert a.inside.largest("von_mises") == b.punch_inside.largest("von_mises")


def test_the_surfaces_of_both_bodies_follow_the_profile():
    """Coupled, so that the traction moves the surfaces down, too; both stick where they touch."""
    scene = between(
        RUBBER,
        {"youngs_modulus": 2e7, "poisson_ratio": 0.1},
        friction=math.inf,
        coupling=True,
        contact_radius=1e-3,
        load=None,
        normal_compliance=1e-11,
        tangential_compliance=1e-11,
    )
    found = solve(scene, 1e-6).physical
    r = np.linspace(0.1, 0.9, 5) * found.radius
    one, other = found.inside.surface(r), found.punch_inside.surface(r)
    indented = found.approach - r**2 / (2.0 * BALL.radius)
    layer = 1e-11 * found.pressure(r)
    assert one.z + other.z + layer == pytest.approx(indented, rel=1e-5)
    assert one.gap == pytest.approx(other.gap, rel=1e-9)
    stress = found.inside.stress(r, 0.0), found.punch_inside.stress(r, 0.0)
    assert stress[0].rz == pytest.approx(-found.traction(r), rel=1e-5)
    assert stress[1].rz == pytest.approx(found.traction(r), rel=1e-5)
    assert stress[0].zz == pytest.approx(stress[1].zz, rel=1e-9)


def test_the_gap_between_two_bodies_is_that_of_the_solution():
    found = solve(between(RUBBER, GLASS), 1e-10)
    r = np.array([1.1, 2.0]) * found.physical.radius
    gap = found.gap(r / found.physical.radius)
    assert found.physical.inside.surface(r).gap == pytest.approx(gap, rel=1e-9)
    assert found.physical.punch_inside.surface(r).gap == pytest.approx(gap, rel=1e-9)


def test_hertz_on_the_axis_of_either_body():
    """``sigma_z = -p0 / (1 + z^2/a^2)`` in both; the hoop stress has each body's own nu."""
    found = solve(between(RUBBER, GLASS), 1e-10).physical
    a, top = found.radius, found.pressure(0.0)
    z = np.array([0.2, 1.0, 3.0]) * a
    for body, nu in ((found.inside, 0.4), (found.punch_inside, 0.2)):
        stress, ratio = body.stress(0.0, z), z / a
        assert stress.zz == pytest.approx(-top / (1.0 + ratio**2), rel=1e-9)
        hoop = (1.0 + nu) * (1.0 - ratio * np.arctan(1.0 / ratio)) - 0.5 / (1.0 + ratio**2)
        assert stress.tt == pytest.approx(-top * hoop, rel=1e-9)


def test_a_flat_punch_with_a_corner_is_rigid():
    told = "no half-space outside the contact"
    with pytest.raises(SceneError, match=told):
        between(RUBBER, GLASS, profile=None, radius=1e-3)
    law = layers.Exponential(1e5, 1e-6)
    with pytest.raises(SceneError, match=told):
        between(RUBBER, GLASS, profile=profiles.Flat(1e-3), layer=law)


@pytest.mark.parametrize("missing", ["punch_youngs_modulus", "punch_poisson_ratio"])
def test_a_punch_has_both_or_neither(missing):
    with pytest.raises(SceneError, match=f"{missing} = None: must be given with punch_"):
        between(RUBBER, GLASS).replace(**{missing: None})


def test_what_the_punch_may_be_is_checked():
    for bad in ({"youngs_modulus": 0.0}, {"poisson_ratio": 0.6}, {"youngs_modulus": "steel"}):
        with pytest.raises(SceneError, match="punch_"):
            between(RUBBER, {**GLASS, **bad})


def test_units_of_the_punch_are_understood():
    pytest.importorskip("pint")
    scene = between(RUBBER, {"youngs_modulus": "70 GPa", "poisson_ratio": 0.2})
    assert scene == between(RUBBER, GLASS)


def test_a_punch_modulus_in_the_wrong_unit_is_asked_about():
    scene = between(RUBBER, {"youngs_modulus": 70.0, "poisson_ratio": 0.2})
    assert "E of the punch = 70 is in Pa: did you mean 70 GPa?" in scene.remarks


def test_a_reduced_modulus_is_enough_without_friction():
    modulus = 4.0 * between(RUBBER, GLASS).physical.quarter_modulus(0.4)
    scene = Scene.from_physical(reduced_modulus=modulus, profile=BALL, load=10.0)
    found, expected = (solve(one).physical for one in (scene, between(RUBBER, GLASS)))
    for name in ("contact_radius", "approach", "stiffness", "load"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-14)
    assert found.pressure(0.0) == pytest.approx(expected.pressure(0.0), rel=1e-14)
    with pytest.raises(SceneError, match="must be None with reduced_modulus: friction"):
        scene.replace(friction=0.1)
    with pytest.raises(SceneError, match=r"youngs_modulus = .*: must be None with reduced_modulus"):
        scene.replace(youngs_modulus=1e7)
    with pytest.raises(SceneError, match="poisson_ratio = None"):
        _ = found.inside
    flat = Scene.from_physical(reduced_modulus=modulus, radius=1e-3, load=10.0)
    assert solve(flat).physical.approach == pytest.approx(10.0 / (2.0 * modulus * 1e-3), rel=1e-12)


def test_a_rigid_punch_has_no_inside():
    found = solve(Scene.from_physical(**RUBBER, profile=BALL, load=10.0))
    with pytest.raises(NotComputedError, match="the punch is rigid"):
        _ = found.physical.punch_inside


def test_of_two_bodies_stress_is_in_si_and_energy_is_not_split():
    found = solve(between(RUBBER, GLASS))
    with pytest.raises(SceneError, match=r"solution\.physical\.punch_inside"):
        _ = found.inside
    with pytest.raises(NotComputedError, match="both bodies together"):
        found.physical.inside.energies()


def test_si_data_of_another_kappa_are_refused():
    scene = between(RUBBER, GLASS)
    with pytest.raises(SceneError, match="mismatch = "):
        Scene(0.4, physical=scene.physical, profile=BALL, load=scene.load)


# --- sums of profiles -----------------------------------------------------------------------------

SUMS = {
    "smooth": (profiles.Sphere(2.0), profiles.Parabola(3.0)),
    "pointed": (profiles.Cone(1.3), profiles.Sphere(4.0)),
    "powers": (profiles.PowerLaw(0.2, 3.0), profiles.PowerLaw(0.1, 1.5)),
    "breaks": (profiles.TruncatedCone(0.3, 1.3), profiles.RoundedFlat(0.5, 2.0)),
    "a break under a tip": (profiles.RoundedFlat(0.4, 2.0), profiles.Parabola(3.0)),
}


@pytest.mark.parametrize("name", SUMS)
def test_heights_and_transforms_add_up(name):
    first, second = SUMS[name]
    gap = profiles.Sum(first, second)
    t = np.linspace(0.01, 1.5, 40)
    assert np.array_equal(gap.height(t), first.height(t) + second.height(t))
    assert np.array_equal(gap._transform(t), first._transform(t) + second._transform(t))

    def past(one):
        below = [max((b for b in one.breaks if b < x), default=None) for x in t]
        return np.array([0.0 if b is None else x**2 - b**2 for x, b in zip(t, below, strict=True)])

    expected = first._rate(t, past(first)) + second._rate(t, past(second))
    assert gap._rate(t, past(gap)) == pytest.approx(expected, rel=1e-12)
    share = t / 1.6
    args = 1.6, share, 1.0 - share**2
    expected = first._fall(*args, past(first)) + second._fall(*args, past(second))
    assert gap._fall(*args, past(gap)) == pytest.approx(expected, rel=1e-12)


def test_next_to_a_break_it_is_known_which_one_is_below():
    gap = profiles.Sum(profiles.TruncatedCone(0.3, 1.3), profiles.RoundedFlat(0.5, 2.0))
    tiny = 1e-30  # t**2 - 0.25 where t rounds to the break
    cone = profiles.TruncatedCone(0.3, 1.3)._rate(np.array([0.5]), np.array([0.25 - 0.09]))
    found = gap._rate(np.array([0.5]), np.array([tiny]))
    assert found == pytest.approx(cone, rel=1e-12)


@pytest.mark.parametrize("alpha", [0.0, 0.1])
@pytest.mark.parametrize("name", SUMS)
def test_a_contact_under_a_sum(name, alpha):
    gap = profiles.Sum(*SUMS[name])
    scene = Scene(0.3, alpha, profile=gap, contact_radius=1.0)
    found = solve(scene, 1e-8)
    assert check_solution(found, scene, 1e-7).passed


@pytest.mark.parametrize("name", ["smooth", "pointed", "breaks"])
def test_a_sum_to_many_digits(name):
    scene = Scene(0.3, 0.1, profile=profiles.Sum(*SUMS[name]), contact_radius=1.0)
    precise, found = reference(scene, 15), solve(scene, 1e-11)
    for quantity in ("load", "approach", "stiffness"):
        assert float(getattr(precise, quantity)) == pytest.approx(
            getattr(found, quantity), rel=1e-10
        )


def test_powers_that_do_not_go_together_have_no_reference():
    scene = Scene(0.3, 0.1, profile=profiles.Sum(*SUMS["powers"]), contact_radius=1.0)
    with pytest.raises(NotComputedError, match="powers of the radius"):
        reference(scene, 15)


def test_a_sum_is_linear_on_a_smooth_surface():
    """At one contact radius loads and approaches add up."""
    first, second = SUMS["breaks"]
    parts = [solve(Scene(0.3, profile=one, contact_radius=1.0), 1e-10) for one in (first, second)]
    whole = solve(Scene(0.3, profile=profiles.Sum(first, second), contact_radius=1.0), 1e-10)
    for quantity in ("load", "approach"):
        total = sum(getattr(one, quantity) for one in parts)
        assert getattr(whole, quantity) == pytest.approx(total, rel=1e-10)


def test_friction_under_a_sum_of_sampled_halves_is_that_of_the_whole():
    def half(r):
        return r**2 / 4.0, r / 2.0

    part = profiles.Sampled.from_functions(
        lambda r: half(r)[0], lambda r: half(r)[1], reach=3.0, rounded=True
    )
    whole = Scene(0.3, 0.2, 0.2, 0.05, profile=profiles.Parabola(1.0), contact_radius=1.0)
    halves = whole.replace(profile=profiles.Sum(part, part))
    found, expected = solve(halves, 1e-6), solve(whole, 1e-6)
    for quantity in ("load", "approach", "total_shear", "stick_radius"):
        assert getattr(found, quantity) == pytest.approx(getattr(expected, quantity), rel=1e-6)


def test_what_a_sum_is_of():
    cone, ball = profiles.Cone(1.0), profiles.Sphere(2.0)
    gap = profiles.Sum(cone, ball)
    assert gap.reach == gap._pole == 2.0
    assert gap.pointed
    assert gap.brief == "Sum(Cone(half_angle=1.0), Sphere(radius=2.0))"
    for other in (profiles.Flat(1.0), gap, 2.0):
        with pytest.raises(SceneError, match="second"):
            profiles.Sum(cone, other)
    short = profiles.Sampled((0.0, 0.3, 0.6), ((0.0,), (1.0,)))
    gap = profiles.Sum(profiles.RoundedFlat(1.0, 1.0), short)
    assert (gap.flat_part, gap.reach, gap.breaks) == (0.3, 0.6, (0.3,))


def test_in_a_scene_sums_have_one_form():
    cone, ball = profiles.Cone(1.0), profiles.Sphere(2.0)
    one, other = (
        Scene(0.3, profile=profiles.Sum(*pair), load=0.1) for pair in ((cone, ball), (ball, cone))
    )
    assert one == other
    assert same_problem(one, other)
    two = profiles.Sum(profiles.Parabola(3.0), profiles.Parabola(6.0))
    assert Scene(0.3, profile=two, load=0.1).profile == profiles.Parabola(2.0)


def test_a_profile_of_the_punch_takes_one_of_the_body():
    scene = Scene.from_physical(**RUBBER, profile=BALL, punch_profile=profiles.Cone(1.5), load=1.0)
    assert scene.profile == profiles.Sum(profiles.Cone(1.5), BALL)
    assert scene.kappa == Scene(0.4).kappa
    cones = scene.replace(profile=profiles.Cone(1.5), punch_profile=profiles.Cone(1.4))
    assert cones.profile == profiles.Sum(profiles.Cone(1.4), profiles.Cone(1.5))
    with pytest.raises(SceneError, match="given with profile"):
        scene.replace(punch_profile=profiles.Cone(1.5))
    with pytest.raises(SceneError, match="punch_profile"):
        Scene.from_physical(**RUBBER, radius=1e-3, punch_profile=BALL, load=1.0)


# --- everything that keeps or compares scenes -----------------------------------------------------

SCENES = {
    "kappa": Scene.from_kappa(-0.1, 0.2, 0.5, 0.03, coupling=True),
    "kappa 0": Scene.from_kappa(0.0, 0.2, 0.5, 0.03),
    "two bodies": between(GLASS, RUBBER, friction=0.1),
    "reduced modulus": Scene.from_physical(reduced_modulus=1e7, profile=BALL, load=1.0),
    "unknown": Scene(None, 0.5),
    "sum": Scene(0.3, profile=profiles.Sum(profiles.Cone(1.0), profiles.Sphere(2.0)), load=0.1),
}


@pytest.mark.parametrize("name", SCENES)
def test_scenes_and_solutions_round_trip(name, tmp_path):
    scene = SCENES[name]
    assert Scene.from_json(scene.to_json()) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert hash(Scene.from_dict(scene.to_dict())) == hash(scene)
    assert scene.replace() == scene
    found = solve(scene, 1e-6)
    for suffix in ("json", "npz"):
        found.save(tmp_path / f"a.{suffix}")
        assert Solution.load(tmp_path / f"a.{suffix}") == found
    assert eval(repr(scene), {"Scene": Scene, **vars(profiles)}) == scene
    assert "kappa" in str(found.summary()) or scene.mismatch is None
    assert "None" not in found.summary()
    assert found.scene._repr_html_()


@pytest.mark.parametrize("name", ["kappa", "two bodies"])
def test_documents_of_one_body_do_not_know_of_two(name):
    one = Scene.from_physical(**RUBBER, profile=BALL, load=10.0) if name != "kappa" else Scene(0.3)
    new = {"mismatch", "punch_youngs_modulus", "punch_poisson_ratio", "reduced_modulus"}
    old, both = one.to_dict(), SCENES[name].to_dict()
    assert not new & {*old, *(old["physical"] or {})}
    assert new & {*both, *(both["physical"] or {})}


def test_without_si_data_kappa_is_left():
    scene = SCENES["two bodies"]
    bare = scene.replace(physical=None)
    assert (bare.kappa, bare.poisson_ratio) == (scene.kappa, None)
    assert same_problem(scene, bare)
    assert not same_problem(scene, bare.replace(kappa=-bare.kappa))


def test_a_rigid_punch_is_made_of_an_elastic_one():
    scene = SCENES["two bodies"].replace(punch_youngs_modulus=None, punch_poisson_ratio=None)
    assert scene == Scene.from_physical(**GLASS, profile=BALL, load=10.0, friction=0.1)


def test_numbers_of_two_bodies_are_compared_in_si():
    scene = between(GLASS, RUBBER)
    modulus = 4.0 * scene.physical.quarter_modulus(0.2)
    radius = (0.75 * 10.0 * BALL.radius / modulus) ** (1.0 / 3.0)
    report = compare(scene, contact_radius=radius, approach=radius**2 / BALL.radius)
    assert report.error < 1e-12
    with pytest.raises(SceneError, match="truth"):
        compare(SCENES["kappa"], truth=solve(SCENES["kappa"].replace(kappa=0.1)), total_shear=0.1)


def test_a_sweep_over_kappa(tmp_path):
    pytest.importorskip("xarray")
    frictions, kappas = np.linspace(0.002, 0.02, 24), [-0.05, 0.1]
    base = Scene.from_kappa(0.01, 0.5, 0.5, 0.05)
    found = sweep(base, friction=frictions, kappa=kappas, store=tmp_path / "kept")
    assert found.total_shear.dims == ("kappa", "friction")
    for (i, kappa), j in itertools.product(enumerate(kappas), (0, 11, 23)):
        one = solve(base.replace(kappa=kappa, friction=float(frictions[j])))
        for name in ("total_shear", "stick_radius", "edge_ratio", "critical_friction"):
            value = float(found[name][i, j])
            assert value == pytest.approx(getattr(one, name), rel=1e-8)
    again = sweep(base, friction=frictions, kappa=kappas, store=tmp_path / "kept")
    assert np.array_equal(again.total_shear, found.total_shear)
    with pytest.raises(SceneError, match=r"kappa = .*: must be None where poisson_ratio is given"):
        sweep(base, kappa=kappas, poisson_ratio=[0.1, 0.2])
    with pytest.raises(SceneError, match=r"kappa = .*: must be left out of scenes with SI data"):
        sweep(SCENES["two bodies"], kappa=kappas)


def test_sweeps_by_spectra_and_lists_know_the_sign():
    pytest.importorskip("xarray")
    base = Scene.from_kappa(-0.05, 0.5, 0.5, math.inf)
    values = np.geomspace(0.1, 10.0, 25)
    found = sweep(base, normal_compliance=values, tangential_compliance=values)
    one = solve(base.replace(normal_compliance=values[3], tangential_compliance=values[20]))
    assert float(found.total_shear[3, 20]) == pytest.approx(one.total_shear, rel=1e-8)
    assert float(found.edge_ratio[3, 20]) == pytest.approx(one.edge_ratio, rel=1e-8)
    several = [base, Scene(0.3, 0.5, 0.5, 0.05), SCENES["two bodies"].replace(physical=None)][:2]
    listed = sweep([*several, SCENES["unknown"]]).total_shear.values
    expected = [solve(scene).total_shear for scene in several]
    assert listed == pytest.approx([*expected, 0.0], rel=1e-7)


def test_two_bodies_in_si_are_swept_over_friction():
    pytest.importorskip("xarray")
    scene = between(GLASS, RUBBER, friction=0.1)
    found = sweep(scene, friction=[0.05, 0.2], rtol=1e-6, quantities=["total_shear"])
    one = solve(scene.replace(friction=0.2), 1e-8)
    assert float(found.total_shear[1]) == pytest.approx(one.total_shear, rel=1e-5)
    assert one.total_shear < 0.0


def test_derivatives_by_kappa_are_differences():
    scene, step = Scene.from_kappa(-0.05, 0.5, 0.3, 0.02), 1e-5
    found = sensitivity(solve(scene), s=[0.2, 0.97])
    for name in ("kappa", "tangential_compliance"):
        ends = [
            solve(scene.replace(**{name: getattr(scene, name) + h}), 1e-12) for h in (step, -step)
        ]
        for quantity in ("total_shear", "stick_radius"):
            high, low = (getattr(one, quantity) for one in ends)
            value = found[quantity, name].value
            assert value == pytest.approx((high - low) / (2.0 * step), rel=1e-4), (quantity, name)
        high, low = (one.traction([0.2, 0.97]) for one in ends)
        value = found.fields["traction", name].value
        assert value == pytest.approx((high - low) / (2.0 * step), rel=1e-4)
    with pytest.raises(SceneError, match="poisson_ratio"):
        sensitivity(solve(scene), ["poisson_ratio"])


@pytest.mark.parametrize("coupling", [False, True])
def test_many_digits_of_a_negative_kappa(coupling):
    scene = Scene.from_kappa(-0.05, 0.5, 0.5, math.inf, coupling=coupling)
    found, precise = solve(scene, 1e-12), reference(scene, 20)
    assert float(precise.total_shear) == pytest.approx(found.total_shear, rel=1e-11)
    assert float(precise.traction(0.5)) == pytest.approx(found.traction(0.5), rel=1e-11)
    assert precise.scene is scene
    assert precise.edge_ratio > 0


def test_a_fit_of_stick_radii_of_two_bodies():
    scene = Scene.from_kappa(-0.05, 0.5, 0.5, 0.015)
    radii = [solve(scene.replace(friction=f)).stick_radius for f in (0.01, 0.015)]
    found = fit(scene.replace(friction=0.02), StickRadiusData(radii[1:], sigma=1e-3), "friction")
    assert found["friction"].value == pytest.approx(0.015, rel=1e-6)
    assert found.scene.kappa == -0.05


def test_a_fit_leaves_an_elastic_punch_as_it_is():
    """Oliver and Pharr's correction for the diamond: E of the body, not E* of both."""
    diamond = {"youngs_modulus": 1141e9, "poisson_ratio": 0.07}
    truth = between({"youngs_modulus": 400e9, "poisson_ratio": 0.25}, diamond)
    depth = np.linspace(1e-6, 5e-6, 8)
    loads = [solve(truth.replace(approach=d)).physical.load for d in depth]
    guess = truth.replace(youngs_modulus=300e9)
    found = fit(guess, IndentationData(depth, loads, sigma=1e-3), "reduced_modulus")
    assert found.scene.physical.youngs_modulus == pytest.approx(400e9, rel=1e-6)
    assert found.scene.physical.punch_youngs_modulus == 1141e9
    assert found["reduced_modulus"] == pytest.approx(
        4.0 * truth.physical.quarter_modulus(0.25), rel=1e-6
    )
    alone = Scene.from_physical(reduced_modulus=3e11, profile=BALL, load=1.0)
    again = fit(alone, IndentationData(depth, loads, sigma=1e-3), "reduced_modulus")
    assert again.scene.physical.reduced_modulus == pytest.approx(found["reduced_modulus"], rel=1e-6)


def test_a_scene_file_without_a_poisson_ratio_has_a_kappa():
    tree = json.loads(Scene(0.3, friction=0.1).to_json()) | {"poisson_ratio": None}
    with pytest.raises(SceneError, match="poisson_ratio = None"):
        Scene.from_dict(tree)
    assert Scene.from_dict(tree | {"mismatch": -0.1}).kappa == -0.1


def test_it_does_not_matter_which_of_kappa_and_poisson_ratio_is_given():
    one = Scene(0.3, 0.5, 0.5, 0.1)
    other = one.replace(kappa=one.kappa)
    assert one != other
    assert same_problem(one, other)
    assert same_problem(other, one)
    assert not same_problem(one, one.replace(kappa=-one.kappa))
    assert not same_problem(one, Scene(None, 0.5, 0.5))
    assert compare(one, truth=solve(other), total_shear=solve(one).total_shear).error == 0.0


def test_gold_tables_know_kappa():
    first = next(table for table in gold.tables() if table.solutions[0].scene.friction)
    expected = first.solutions[0]
    found = gold.find(expected.scene.replace(kappa=expected.scene.kappa))
    assert found is not None
    assert found.scene == expected.scene
    assert gold.find(expected.scene.replace(kappa=-expected.scene.kappa)) is None


def test_a_store_of_kappas_is_none_of_poisson_ratios():
    nu = grid(Scene(0.3, 0.5, 0.5, 0.1), {"poisson_ratio": [0.1, 0.2]})
    kappa = grid(Scene.from_kappa(0.3, 0.5, 0.5, 0.1), {"kappa": [0.1, 0.2]})
    assert np.array_equal(nu.axes["poisson_ratio"], kappa.axes["kappa"])
    assert nu.fingerprint() != kappa.fingerprint()
    several = [listed([one]) for one in (Scene(0.3, 0.5), Scene.from_kappa(0.3, 0.5))]
    assert several[0].fingerprint() != several[1].fingerprint()


def test_one_continuation_for_kappas_of_either_sign():
    """What scenes hand on is that of the mirror image."""
    path = Continuation(1e-10, ("total_shear", "stick_radius"), 20_000)
    for kappa in (0.05, -0.05, 0.1, -0.06):
        scene = Scene.from_kappa(kappa, 0.5, 0.5, 0.015)
        found, alone = path.solve(scene), solve(scene)
        assert found.scene == scene
        assert found.total_shear == pytest.approx(alone.total_shear, rel=1e-10)
        assert found.stick_radius == pytest.approx(alone.stick_radius, rel=1e-9)


def test_bounds_of_the_approach_with_coupling():
    found = solve(Scene.from_kappa(-0.1, 0.5, 0.5, math.inf, coupling=True))
    low, high = found.approach_bounds
    assert low <= found.approach <= high
    assert high / low - 1.0 < 1e-9


def test_explore_has_no_kappa():
    for name in ("kappa", "two bodies", "unknown"):
        with pytest.raises(SceneError, match="no kappa"):
            texts_of(SCENES[name])


BALL_OPTIONS = ["--profile", "parabola", "--radius", "0.01", "--load", "10"]
OF_RUBBER = ["--youngs-modulus", "1e7", "--poisson-ratio", "0.4"]
OF_GLASS = ["--punch-youngs-modulus", "70e9", "--punch-poisson-ratio", "0.2"]


def said(capsys, *arguments):
    status = main(arguments)
    written = capsys.readouterr()
    return status, written.out + written.err


def test_the_command_line_solves_two_bodies(capsys):
    status, text = said(capsys, "solve", *BALL_OPTIONS, *OF_RUBBER, *OF_GLASS, "--friction", "0.3")
    assert status == 0
    assert f"kappa = {between(RUBBER, GLASS).kappa!r}" in text
    assert "E = 10000000.0 Pa, nu = 0.4; punch: E = 70000000000.0 Pa, nu = 0.2" in text
    status, text = said(capsys, "solve", "--kappa", "-0.05", "--friction", "0.01")
    assert status == 0
    assert repr(solve(Scene.from_kappa(-0.05, 0.5, 0.5, 0.01)).total_shear)[:11] in text
    status, text = said(capsys, "solve", *BALL_OPTIONS, "--reduced-modulus", "1e7")
    assert status == 0
    assert "E* = 10000000.0 Pa" in text


def test_the_command_line_looks_into_the_punch(capsys):
    options = [*BALL_OPTIONS, *OF_RUBBER, *OF_GLASS]
    status, text = said(capsys, "inside", "--punch", *options)
    assert status == 0
    expected = solve(between(RUBBER, GLASS)).physical.punch_inside.largest("von_mises")
    assert f"{expected.value:.8g}"[:8] in text
    status, text = said(capsys, "inside", "--punch", *BALL_OPTIONS, *OF_RUBBER)
    assert status == 2
    assert "the punch is rigid" in text


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (
            ["--kappa", "0.1", "--poisson-ratio", "0.3"],
            "give one of --kappa, --poisson-ratio: both are given",
        ),
        ([*BALL_OPTIONS, *OF_RUBBER, "--kappa", "0.1"], "--kappa is dimensionless"),
        ([*BALL_OPTIONS, *OF_RUBBER, *OF_GLASS[:2]], "--punch-poisson-ratio is missing"),
        ([*BALL_OPTIONS, "--reduced-modulus", "1e7", "--friction", "1"], "--friction = 1.0"),
        (
            [*BALL_OPTIONS, *OF_GLASS],
            "--youngs-modulus, --poisson-ratio are missing: they must be given with SI data",
        ),
    ],
)
def test_what_the_command_line_refuses(capsys, options, told):
    status, text = said(capsys, "solve", *options)
    assert status == 2
    assert told in text


def test_the_command_line_sweeps_kappa(capsys, tmp_path):
    pytest.importorskip("xarray")
    output = tmp_path / "a.csv"
    options = ["--kappa=-0.1,0.1", "--friction", "0.05", "--output", str(output)]
    status, _ = said(capsys, "sweep", *options)
    assert status == 0
    first, second = (line for line in output.read_text().splitlines() if line[:3] in ("-0.", "0.1"))
    assert first.split(",")[0] == "-0.1"
    assert second.split(",")[0] == "0.1"


def test_a_fit_of_approaches_takes_a_reduced_modulus():
    scene = Scene.from_physical(
        reduced_modulus=1e10, radius=1e-3, load=10.0, normal_compliance=1e-13
    )
    loads = [10.0, 20.0]
    depths = [solve(scene.replace(load=load)).physical.approach for load in loads]
    guess = scene.replace(normal_compliance=3e-13)
    found = fit(guess, ApproachData(depths, sigma=1e-12, load=loads), "normal_compliance")
    assert found["normal_compliance"].value == pytest.approx(1e-13, rel=1e-6)
    assert found.scene == scene.replace(normal_compliance=found["normal_compliance"].value)


def test_a_picture_has_the_bound_of_the_sign_of_the_traction():
    pytest.importorskip("matplotlib")
    for kappa, bound in ((0.05, "$f p^*$"), (-0.05, "$-f p^*$")):
        figure = solve(Scene.from_kappa(kappa, 0.2, 0.5, 0.01)).plot()
        curves = {line.get_label(): line for axes in figure.axes for line in axes.get_lines()}
        traction, limit = (np.abs(curves[name].get_ydata()) for name in ("$q^*$", bound))
        assert (traction <= limit * (1.0 + 1e-9)).all()
        assert np.sign(curves[bound].get_ydata()[-1]) == np.sign(kappa)


def test_a_nonlinear_layer_between_two_bodies_is_that_on_one_of_their_modulus():
    law = layers.Exponential(1e5, 2e-5)
    both = between(RUBBER, GLASS, layer=law)
    modulus = 4.0 * both.physical.quarter_modulus(0.4)
    one = both.replace(
        youngs_modulus=modulus * (1.0 - 0.3**2),
        poisson_ratio=0.3,
        punch_youngs_modulus=None,
        punch_poisson_ratio=None,
    )
    found, expected = (solve(scene, 1e-8).physical for scene in (both, one))
    for name in ("contact_radius", "approach", "stiffness"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-12)
