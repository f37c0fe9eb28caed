"""Profiles: what the solver asks of them, what is refused, and scenes that have one."""

import dataclasses
import math
import pickle

import mpmath
import numpy as np
import pytest

from spectral_contact import (
    NotComputedError,
    Scene,
    SceneError,
    closed_forms,
    gold,
    plan,
    profiles,
    solve,
)
from spectral_contact.profiles import control
from spectral_contact.scene import same_problem
from spectral_contact.studies.study import truth_of
from spectral_contact.view.report import report

COT = 1.0 / math.tan(1.1)
#: Profiles with their slopes, for integrals of many digits.
SLOPES = {
    "parabola": (profiles.Parabola(1.3), lambda r: r / mpmath.mpf(1.3)),
    "sphere": (profiles.Sphere(1.3), lambda r: r / mpmath.sqrt(mpmath.mpf(1.3) ** 2 - r * r)),
    "cone": (profiles.Cone(1.1), lambda r: mpmath.cot(mpmath.mpf(1.1))),
    "power": (profiles.PowerLaw(0.7, 2.5), lambda r: mpmath.mpf(0.7) * 2.5 * r**1.5),
    "truncated cone": (
        profiles.TruncatedCone(0.4, 1.1),
        lambda r: mpmath.cot(mpmath.mpf(1.1)) if r > 0.4 else mpmath.mpf(0),
    ),
    "rounded flat": (
        profiles.RoundedFlat(0.4, 0.8),
        lambda r: (r - mpmath.mpf(0.4)) / mpmath.mpf(0.8) if r > 0.4 else mpmath.mpf(0),
    ),
    "sampled": (
        profiles.Sampled.from_functions(
            lambda r: np.where(r < 0.4, r, 0.4 + 3.0 * (r - 0.4)),
            lambda r: np.where(r < 0.4, 1.0, 3.0),
            reach=2.0,
            breaks=[0.4],
        ),
        lambda r: mpmath.mpf(1) if r < mpmath.mpf(0.4) else mpmath.mpf(3),
    ),
    "smooth sampled": (
        profiles.Sampled.from_functions(
            lambda r: np.cosh(r) - 1.0, np.sinh, reach=2.0, rounded=True
        ),
        mpmath.sinh,
    ),
}
A = 1.1


def transform(slope, t):
    """Return H by quadrature, cut at the break."""
    cut = [mpmath.asin(mpmath.mpf(0.4) / t)] if t > mpmath.mpf(0.4) else []
    ends = [0, *cut, mpmath.pi / 2]
    return 2 * t * mpmath.quad(lambda phi: slope(t * mpmath.sin(phi)), ends)


@pytest.mark.parametrize("name", SLOPES)
def test_transforms_and_their_differences_keep_their_digits(name):
    profile, slope = SLOPES[name]
    with mpmath.workdps(40):
        assert float(profile._transform(np.array(0.9)) / transform(slope, mpmath.mpf(0.9))) == (
            pytest.approx(1.0, rel=1e-14)
        )
        whole = transform(slope, mpmath.mpf(A))
        for y in (1e-12, 1e-6, 0.01, 0.3, 0.8, 0.9, 0.999):
            t = mpmath.sqrt(1 - mpmath.mpf(y))
            truth = whole - transform(slope, mpmath.mpf(A) * t)
            past = max(float((A * t) ** 2 - mpmath.mpf(0.4) ** 2), 0.0) if profile.breaks else 0.0
            found = profile._fall(A, np.array([float(t)]), np.array([y]), np.array([past]))
            assert float(found[0] / truth) == pytest.approx(1.0, rel=2e-14)


@pytest.mark.parametrize("name", SLOPES)
def test_rates_are_derivatives_and_heights_integrals(name):
    profile, slope = SLOPES[name]
    step = 1e-5
    for t in (0.3, 0.7, 1.0):
        past = t**2 - 0.16 if profile.breaks and t > 0.4 else 0.0
        rate = float(profile._rate(np.array([t]), np.array([past]))[0])
        high, low = profile._transform(np.array([t + step, t - step]))
        assert rate == pytest.approx((high - low) / (2.0 * step), rel=1e-8, abs=1e-14)
        height = mpmath.quad(slope, [0, min(t, 0.4), t])
        # 2e-14 is what slopes are sampled to
        assert float(profile.height(np.array(t))) == pytest.approx(float(height), rel=2e-14)
    assert profile.height(np.array(0.0)) == 0.0


def test_every_kind_of_profile_is_tried():
    tried = {type(profile) for profile, _ in SLOPES.values()}
    assert tried == {*control.KINDS.values()} - {profiles.Flat, profiles.Sum}


def test_profiles_are_values():
    for profile, _ in SLOPES.values():
        again = pickle.loads(pickle.dumps(profile))
        assert again == profile
        assert hash(again) == hash(profile)
        assert len({profile, again}) == 1
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(profile, dataclasses.fields(profile)[0].name, 1)


def test_functions_are_sampled_once():
    calls = []

    def slope(r):
        calls.append(1)
        return 2.0 * r

    profile = profiles.Sampled.from_functions(lambda r: r**2, slope, reach=3.0, rounded=True)
    made = len(calls)
    found = solve(Scene(0.3, 0.5, profile=profile, contact_radius=1.0), 1e-11)
    assert len(calls) == made
    same = solve(Scene(0.3, 0.5, profile=profiles.Parabola(0.5), contact_radius=1.0), 1e-11)
    assert found.load == pytest.approx(same.load, rel=1e-12)
    assert found.pressure(0.3) == pytest.approx(same.pressure(0.3), rel=1e-10)


def test_points_are_interpolated_in_their_shape():
    radii = np.linspace(0.0, 2.0, 9)
    table = profiles.Sampled.from_points(radii, radii**2 / 2.0)
    assert np.abs(table.height(radii) - radii**2 / 2.0).max() < 1e-14
    found = solve(Scene(0.3, 0.5, profile=table, contact_radius=1.1), 1e-8)
    near = solve(Scene(0.3, 0.5, profile=profiles.Parabola(1.0), contact_radius=1.1), 1e-8)
    assert found.load == pytest.approx(near.load, rel=0.02)


PI2 = math.pi / 2
FAULTS = [
    (lambda: profiles.Parabola(-1.0), "radius = -1.0: must be finite and > 0"),
    (lambda: profiles.Parabola(math.inf), "radius"),
    (lambda: profiles.Sphere(0.0), "radius"),
    (lambda: profiles.Cone(PI2), "half_angle = 1.57"),
    (lambda: profiles.Cone(0.0), "half_angle"),
    (lambda: profiles.TruncatedCone(0.0, 1.0), "flat_radius"),
    (lambda: profiles.TruncatedCone(1.0, 2.0), "half_angle"),
    (lambda: profiles.RoundedFlat(1.0, -2.0), "radius"),
    (lambda: profiles.PowerLaw(1.0, 0.5), "exponent = 0.5: must be in .* not convex"),
    (lambda: profiles.PowerLaw(True, 2.0), "coefficient"),
    (
        lambda: profiles.Sampled.from_functions(lambda r: r - r**2, lambda r: 1 - 2 * r, reach=0.4),
        "convex: the slope may not fall",
    ),
    (
        lambda: profiles.Sampled.from_functions(lambda r: r**2 + 1, lambda r: 2 * r, reach=1.0),
        "height = 1.0: must be 0 at the centre",
    ),
    (
        lambda: profiles.Sampled.from_functions(lambda r: r**3, lambda r: 2 * r, reach=1.0),
        "the integral of the slope",
    ),
    (
        lambda: profiles.Sampled.from_functions(
            lambda r: np.maximum(r - 0.3, 0), lambda r: 1.0 * (r > 0.3), reach=1.0
        ),
        "have its breaks named",
    ),
    (
        lambda: profiles.Sampled.from_functions(
            lambda r: r**2, lambda r: 2 * r, reach=1.0, breaks=[1.5]
        ),
        "breaks",
    ),
    (lambda: profiles.Sampled.from_functions(1, lambda r: r, reach=1.0), "height"),
    (lambda: profiles.Sampled.from_points([0, 1, 2], [0, 1]), "heights"),
    (lambda: profiles.Sampled.from_points([0, 2, 1], [0, 1, 2]), "radii that increase"),
    (lambda: profiles.Sampled.from_points([0, 1, 2, 3], [0, 2, 3, 3.5]), "convex"),
    (lambda: profiles.Sampled((0.0, 1.0), ((-1.0,),)), "slope"),
    (lambda: profiles.Sampled((0.0, 1.0), ()), "slopes"),
    (lambda: profiles.Sampled((0.5, 1.0), ((1.0,),)), "edges"),
    (lambda: Scene(0.3, load=1.0), "load = 1.0: must be None without a profile"),
    (
        lambda: Scene(0.3, profile=profiles.Parabola(1.0)),
        "contact_radius, load, approach, separation",
    ),
    (
        lambda: Scene(0.3, profile=profiles.Parabola(1.0), load=1.0, approach=1.0),
        "contact_radius, load, approach, separation",
    ),
    (lambda: Scene(0.3, profile=profiles.Parabola(1.0), approach=-1.0), "approach = -1.0"),
    (lambda: Scene(0.3, profile=profiles.Parabola(1.0), load=0.0), "load"),
    (lambda: Scene(0.3, profile=profiles.Sphere(1.0), contact_radius=1.0), "in .0, 1."),
    (
        lambda: Scene(0.3, profile=profiles.RoundedFlat(1.0, 1.0), contact_radius=0.9),
        "in .1, inf., the range of the profile",
    ),
    (
        lambda: Scene(0.3, 1e-10, profile=profiles.Parabola(1.0), contact_radius=1e6),
        "normal_compliance / contact_radius",
    ),
    (lambda: Scene(0.3, profile="sphere", load=1.0), "profile = 'sphere': must be None or one of"),
    (
        lambda: Scene.from_dict({**Scene(0.3).to_dict(), "profile": {"Wedge": {}}, "load": 1.0}),
        "profile",
    ),
]


@pytest.mark.parametrize(("make", "message"), FAULTS, ids=[one[1] for one in FAULTS])
def test_what_is_no_profile_is_refused_by_name(make, message):
    with pytest.raises(SceneError, match=message):
        make()


SCENE = Scene(0.3, 0.5, profile=profiles.Parabola(1.0), contact_radius=1.0)


def test_what_knows_flat_punches_only_says_so():
    with pytest.raises(SceneError, match="supports flat punches only"):
        solve(SCENE).sensitivity()


def test_the_truth_about_a_gold_scene_is_its_gold_solution():
    truth = truth_of(SCENE)
    assert truth.source.startswith("gold table profiles")
    errors = truth.errors(solve(SCENE, 1e-10), ["approach"])
    assert errors["approach"] < 1e-10


def test_the_gold_solution_of_a_flat_punch_is_none_of_a_profile():
    """Without friction the compliance decides, but not alone."""
    flat = Scene(0.3, 0.5)
    assert gold.find(flat) is not None
    shaped = [flat.replace(profile=profiles.Parabola(1.0), load=load) for load in (1.0, 2.0)]
    assert gold.find(shaped[1]) is None
    assert gold.find(SCENE).scene == SCENE
    assert not same_problem(*shaped)
    assert same_problem(shaped[0], shaped[0].replace(poisson_ratio=0.1))


def test_a_notebook_shows_the_profile():
    text = SCENE._repr_html_()
    assert SCENE.profile.brief in text
    assert "contact radius" in text


def test_flat_punches_have_no_contact_radius():
    solution = solve(Scene(0.3, 0.5))
    for name in ("contact_radius", "load", "stiffness", "indentation_work"):
        with pytest.raises(NotComputedError, match="the punch is flat"):
            getattr(solution, name)
    with pytest.raises(NotComputedError, match="the punch is flat"):
        solution.gap(2.0)
    with pytest.raises(SceneError, match="quantities"):
        solve(Scene(0.3, 0.5), quantities=["stiffness"])


def test_gaps_are_outside():
    solution = solve(SCENE, 1e-8)
    with pytest.raises(SceneError, match=r"s = 0\.5: must be finite and at least 1"):
        solution.gap(0.5)
    with pytest.raises(SceneError, match="beyond"):
        solution.gap(beyond=-1.0)
    sphere = solve(Scene(0.3, profile=profiles.Sphere(1.0), contact_radius=0.5), 1e-8)
    with pytest.raises(SceneError, match="s = 3"):
        sphere.gap([1.0, 3.0])


def test_plans_and_reports_show_what_there_is():
    todo = plan(SCENE, ["stiffness"])
    assert todo.quantities == ("stiffness",)
    solution = solve(SCENE, 1e-8, ["load"])
    with pytest.raises(NotComputedError, match="it was not asked for"):
        solution.pressure(0.5)
    assert solution.load == pytest.approx(1.1763284084, rel=1e-8)
    full = solve(SCENE, 1e-8)
    text = report(full)
    for words in ("contact radius", "stiffness", "Parabola(radius=1.0), contact radius = 1.0"):
        assert words in text
    assert "contact_radius=1, load=1.176" in repr(full)


def test_a_scene_is_changed_by_replace():
    other = dataclasses.replace(SCENE, contact_radius=None, load=2.0)
    assert solve(other, 1e-8).load == 2.0
    flat = dataclasses.replace(SCENE, contact_radius=None, profile=None)
    assert flat == Scene(0.3, 0.5)


@pytest.mark.parametrize("compliance", [0.0, 0.01])
def test_breaks_of_a_sum_that_rounding_parts_are_one(compliance):
    """Panels between 0.3 and 0.1 + 0.2 made a load wrong by 7 %, with an error of 4e-15."""
    loads = []
    for flat_radius in (0.3, 0.1 + 0.2):
        cone = profiles.TruncatedCone(0.3, 1.2)
        gap = profiles.Sum(cone, profiles.RoundedFlat(flat_radius, 2.0))
        assert gap.breaks == (flat_radius,)
        scene = Scene(0.3, compliance, profile=gap, contact_radius=0.9)
        loads.append(solve(scene, 1e-9, ["load"]).load)
    assert loads[1] == pytest.approx(loads[0], rel=1e-13)


def test_radii_that_rounding_alone_parts_are_refused():
    with pytest.raises(SceneError, match=r"must be radii that increase, by more than 1e-14"):
        profiles.Sampled.from_points([0.0, 0.3, 0.1 + 0.2, 1.0], [0.0, 0.1, 0.1 + 1e-16, 1.0])


@pytest.mark.parametrize("compliance", [0.0, 0.1])
@pytest.mark.parametrize("radius", [1.3e-6, 1.7e-8, 1.7e-12])
def test_a_small_contact_of_a_sphere_is_that_of_the_paraboloid(radius, compliance):
    """The fall of H cancelled: the load was off by 4e-11, 3e-10 and 1e-5, with errors of 4e-15."""
    sphere, parabola = (
        solve(Scene(0.3, compliance * radius, profile=one, contact_radius=radius))
        for one in (profiles.Sphere(1.0), profiles.Parabola(1.0))
    )
    for name in ("load", "approach"):
        expected = getattr(parabola, name)
        assert getattr(sphere, name) == pytest.approx(expected, rel=radius**2 + 1e-13)


@pytest.mark.parametrize("radius", [1e-9, 1e-4, 0.499, 0.501, 0.999])
def test_the_closed_form_of_a_sphere_has_its_digits(radius):
    """Its load cancelled: at a ten thousandth of the sphere eight digits were lost."""
    with mpmath.workdps(60):
        a = mpmath.mpf(radius)
        load = 4 * ((1 + a**2) * mpmath.atanh(a) - a)
        approach = a * mpmath.atanh(a)
    found = closed_forms.sphere_contact(radius, 1.0)
    assert found.load == pytest.approx(float(load), rel=2e-15)
    assert found.approach == pytest.approx(float(approach), rel=2e-15)


def test_a_high_power_in_a_small_unit_of_length_has_a_load():
    """The product of its coefficient and gamma functions is not a double."""
    loads = [
        solve(Scene(0.3, profile=profiles.PowerLaw(unit**-49, 50.0), contact_radius=unit)).load
        / unit**2
        for unit in (1.0, 1e-6)
    ]
    assert loads[1] == pytest.approx(loads[0], rel=1e-12)


def test_the_smooth_pressure_of_a_power_law_grows_like_the_derivative_of_its_half_integral():
    """Next to the edge the rounding of radii makes the rate larger."""
    for exponent in (1.0, 2.0, 7.5, 100.0):
        rate = profiles.PowerLaw(1.0, exponent)._smooth_pressure_rate(0.3)
        assert exponent - 1.0 <= rate * (1.0 + 1e-6) <= 1.3 * (exponent - 1.0)


def test_the_smooth_pressure_next_to_an_equator_grows_like_the_inverse_of_the_distance():
    """``H'`` is ``atanh(t/R) + t R/(R**2 - t**2)`` of a sphere, and infinite at its equator."""
    for distance in (1e-2, 1e-5, 1e-8):
        rate = profiles.Sphere(1.0)._smooth_pressure_rate(1.0 - distance)
        assert rate == pytest.approx(1.0 / distance, rel=0.15)
