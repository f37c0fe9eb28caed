"""Derivatives of a scene's quantities, against differences of solutions to 24 digits.

Those of coupled slip, of which there are no such solutions, and of slip inside are against
polynomials through solves.
"""

import math
from functools import cache

import mpmath
import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, pull_off, solve
from spectral_contact.studies.derivatives import PARAMETERS

STUCK = Scene(0.3, 0.5, 0.5, math.inf)
SLIPPING = Scene(0.1, 0.5, 0.5, 0.1)
THIN = Scene(0.3, 1e-3, 1e-3, 0.1)
RIGID = Scene(0.3, 0.1, 0.0, 0.05)
COUPLED_STUCK = Scene(0.2, 0.5, 0.5, math.inf, coupling=True)
COUPLED = COUPLED_STUCK.replace(friction=0.1)

#: Central differences of `reference` to 24 digits, with relative steps of 2**-24.
TRUE = {
    STUCK: {
        ("approach", "normal_compliance"): 0.3204650850035,
        ("total_shear", "normal_compliance"): 0.006227950184019,
        ("total_shear", "tangential_compliance"): -0.09815458636193,
    },
    SLIPPING: {
        ("total_shear", "normal_compliance"): -0.0001765529820296,
        ("stick_radius", "normal_compliance"): -0.06222036514647,
        ("total_shear", "tangential_compliance"): -0.04137496628317,
        ("stick_radius", "tangential_compliance"): 1.009630197142,
        ("total_shear", "friction"): 0.5718240986127,
        ("stick_radius", "friction"): 6.909246738154,
    },
    THIN: {
        ("approach", "normal_compliance"): 0.6013498512207641,
        ("total_shear", "normal_compliance"): 0.005506732822300222,
        ("stick_radius", "normal_compliance"): -1.3935239141807187,
        ("total_shear", "tangential_compliance"): -0.03548859466031909,
        ("stick_radius", "tangential_compliance"): 5.270358093390157,
        ("total_shear", "friction"): 0.9138049655374614,
        ("stick_radius", "friction"): 6.0874904854844685,
    },
    RIGID: {
        ("total_shear", "normal_compliance"): 3.05279054419458e-06,
        ("stick_radius", "normal_compliance"): -0.017348193183743265,
        ("total_shear", "friction"): 0.9996053522302261,
        ("stick_radius", "friction"): 1.0920645491793437,
        ("total_shear", "poisson_ratio"): -6.480226906201417e-05,
        ("stick_radius", "poisson_ratio"): 0.1950115266391743,
    },
    COUPLED_STUCK: {
        ("approach", "normal_compliance"): 0.3201806382622909,
        ("total_shear", "normal_compliance"): 0.007644400848950188,
        ("approach", "tangential_compliance"): 0.002905142797206832,
        ("total_shear", "tangential_compliance"): -0.1298316118403345,
        ("approach", "poisson_ratio"): 0.00801989072226056,
        ("total_shear", "poisson_ratio"): -0.18381666859703294,
    },
}

#: Polynomials of ten solves in the logarithm of a parameter, which have nine digits or more.
COUPLED_SLOPES = {
    ("approach", "normal_compliance"): 0.3203782472494611,
    ("total_shear", "normal_compliance"): 0.000640202336268185,
    ("stick_radius", "normal_compliance"): -0.08698901616539595,
    ("approach", "tangential_compliance"): 0.0009333181352509555,
    ("total_shear", "tangential_compliance"): -0.05755952189548408,
    ("stick_radius", "tangential_compliance"): 1.1470691042237058,
    ("approach", "friction"): -0.010686258401855013,
    ("total_shear", "friction"): 0.39850450876549687,
    ("stick_radius", "friction"): 7.650878387525525,
    ("approach", "poisson_ratio"): 0.004971511900753757,
    ("total_shear", "poisson_ratio"): -0.085623616871744,
    ("stick_radius", "poisson_ratio"): 1.6125263610720209,
}
SLIPPING_INSIDE = {
    ("total_shear", "normal_compliance"): 0.0245174975336,
    ("stick_radius", "normal_compliance"): -3.22073997615,
    ("total_shear", "tangential_compliance"): -0.102637528188,
    ("stick_radius", "tangential_compliance"): 5.25526117262,
    ("stick_radius", "friction"): 31.34657938,
    ("stick_radius", "poisson_ratio"): 8.18380171371,
}

#: Of shear and both boundaries below the largest load, by differences of solves to 1e-12.
UNLOADED = SLIPPING.replace(unloaded_to=0.8)
TRUE_UNLOADED = {
    "normal_compliance": (-0.00212235486616, -0.0634872471129, -0.0559760257521),
    "tangential_compliance": (-0.0107018809897, 1.04081133076, 0.85672469116),
    "friction": (0.572322262878, 7.05586041072, 6.19527061782),
    "poisson_ratio": (-0.0123216660195, 0.979980612599, 0.860454252483),
    "unloaded_to": (0.103410020275, 0.0378712039403, -0.000410389241039),
}

#: Of fields at these radii, by the same differences.
RADII = [0.25, 0.6, 0.7, 0.999]
TRUE_PRESSURE = [0.05323466613344, 0.02631986549594, 0.01107397036567, -0.1107720911622]
TRUE_FIELDS = {
    STUCK: {
        ("pressure", "normal_compliance"): TRUE_PRESSURE,
        ("traction", "normal_compliance"): [
            0.001456963477542,
            0.002773204317384,
            0.002766618305575,
            -0.0004017889578139,
        ],
        ("traction", "tangential_compliance"): [
            -0.008181367892435,
            -0.02320608360275,
            -0.02934212137073,
            -0.06537173116974,
        ],
    },
    SLIPPING: {
        ("traction", "friction"): [
            -0.0137897739709,
            -0.05098735785417,
            0.3131381835273,
            0.3789057819253,
        ],
        ("pressure", "normal_compliance"): TRUE_PRESSURE,
        ("traction", "normal_compliance"): [
            0.002485139121431,
            0.005089755786919,
            0.001107397036567,
            -0.01107720911622,
        ],
        ("traction", "tangential_compliance"): [-0.01579285463522, -0.04730430524921, 0.0, 0.0],
    },
    THIN: {
        ("pressure", "normal_compliance"): [
            1.4047280253192844,
            1.969762682344436,
            2.4318043459935934,
            -737.5916550887674,
        ],
        ("traction", "friction"): [
            0.1659888074957923,
            0.2012284960348233,
            0.22570201775892676,
            3.0478279158895436,
        ],
    },
    COUPLED_STUCK: {
        ("pressure", "tangential_compliance"): [
            -0.0034228889707866848,
            -0.0014839426393078998,
            -0.00046082182656533336,
            0.0054330956521265,
        ],
        ("traction", "poisson_ratio"): [
            -0.018460950882950158,
            -0.048009035232784866,
            -0.058273605266867236,
            -0.10439218925654484,
        ],
    },
}


@cache
def found(scene):
    return solve(scene, 1e-6, ["approach"]).sensitivity()


@pytest.mark.parametrize("scene", TRUE)
def test_derivatives_are_right_and_their_errors_honest(scene):
    own = found(scene)
    for pair, true in TRUE[scene].items():
        error = abs(own[pair].value / true - 1.0)
        assert error <= own[pair].error + 1e-12, pair  # the differences have 12 digits
        # where shear hardly changes, as nearly everything slips, its own rounding is felt
        assert own[pair].error < (1e-10 if abs(true) > 1e-4 else 1e-9), pair


def test_those_of_coupled_slip_are_right_and_their_errors_honest():
    own = found(COUPLED)
    for pair, true in COUPLED_SLOPES.items():
        assert own[pair].value == pytest.approx(true, rel=1e-9), pair
        assert own[pair].error < 1e-11, pair


def test_slip_inside_has_all_boundaries_move():
    own = found(Scene(0.246, 0.2, 0.5, 0.1))
    for pair, true in SLIPPING_INSIDE.items():
        assert own[pair].value == pytest.approx(true, rel=5e-9), pair
        assert own[pair].error < 1e-9, pair
    pair = "stick_radius", "normal_compliance"  # of this one there is a difference to 24 digits
    assert abs(own[pair].value / -3.22073997623715 - 1.0) <= own[pair].error


def test_those_below_the_largest_load_are_right_and_their_errors_honest():
    own = solve(UNLOADED, 1e-6, ["approach"]).sensitivity(s=[0.3, 0.66, 0.9])
    for name, true in TRUE_UNLOADED.items():
        derivatives = own["total_shear", name], *own.boundaries[name]
        for one, other in zip(derivatives, true, strict=True):
            assert abs(one.value / other - 1.0) <= one.error + 1e-10, name
            assert one.error < 1e-8, name
        assert own.boundaries[name][0] == own["stick_radius", name]
    # the pressure of the load, and slip in the middle
    moved = own.fields["traction", "friction"]
    np.testing.assert_allclose(moved.value, [-0.01708683, 0.24708789, 0.34505056], atol=1e-8)
    assert own.fields["pressure", "friction"].value.max() == 0.0


def test_what_sticks_is_proportional_to_the_load():
    solution = solve(STUCK.replace(unloaded_to=0.3), 1e-12)
    own = solution.sensitivity(["unloaded_to"])
    for name in ("approach", "total_shear"):
        one = own[name, "unloaded_to"]
        assert abs(one.value / getattr(solution, name) * 0.3 - 1.0) <= one.error < 1e-11
    assert own.boundaries["unloaded_to"] == ()
    with pytest.raises(SceneError, match="unloaded_to"):
        solve(STUCK, 1e-6, ["approach"]).sensitivity(["unloaded_to"])


@pytest.mark.parametrize("ratio", [0.4, 1.2, 3.5])
def test_the_stick_radius_of_a_smooth_surface(ratio):
    scene = Scene(0.3)
    scene = scene.replace(friction=ratio * scene.kappa)
    one = solve(scene, 1e-6, ["approach"]).sensitivity(["friction"])["stick_radius", "friction"]
    with mpmath.workdps(40):
        # the root of 2 artanh(c)/c - (f/kappa) K(1 - c**2), in c
        factor = mpmath.mpf(scene.friction) / scene.kappa

        def mismatch(c):
            return 2 * mpmath.atanh(c) / c - factor * mpmath.ellipk(1 - c**2)

        near = mpmath.mpf(solve(scene, 1e-12).stick_radius)
        c = mpmath.findroot(mismatch, (near * (1 - mpmath.mpf(10) ** -9), near))
        slope = mpmath.ellipk(1 - c**2) / mpmath.diff(mismatch, c) / scene.kappa
    assert abs(one.value / float(slope) - 1.0) <= one.error < 1e-10


def test_poisson_ratio_enters_by_the_coupling_constant():
    own, scene = found(STUCK), STUCK
    true = solve(scene, 1e-12).total_shear * -0.25 / (1.0 - scene.poisson_ratio) ** 2 / scene.kappa
    one = own["total_shear", "poisson_ratio"]
    assert one.value == pytest.approx(true, rel=1e-13)
    assert own["approach", "poisson_ratio"].value == 0.0
    # by differences, too
    high, low = (
        solve(SLIPPING.replace(poisson_ratio=nu), 1e-12).stick_radius for nu in (0.1001, 0.0999)
    )
    slope = found(SLIPPING)["stick_radius", "poisson_ratio"].value
    assert slope == pytest.approx((high - low) / 2e-4, rel=1e-6)


def test_what_sticks_stays_stuck():
    own = found(STUCK)
    for name in ("normal_compliance", "tangential_compliance", "friction", "poisson_ratio"):
        assert own["stick_radius", name].value == 0.0
        assert own["stick_radius", name].error == 0.0
    assert own["total_shear", "friction"].value == 0.0
    assert "sticks" in str(own)


def test_the_first_friction():
    scene = Scene(0.3, 0.5, 0.5, 0.0)
    own = solve(scene, 1e-3).sensitivity(["friction"])
    assert own["total_shear", "friction"].value == 1.0
    little = solve(scene.replace(friction=1e-6), 1e-10)
    slope = own["stick_radius", "friction"]
    assert slope.note == "one-sided"
    assert little.stick_radius / 1e-6 == pytest.approx(slope.value, rel=1e-4)


def test_the_first_friction_below_the_largest_load_depends_on_the_history():
    scene = Scene(0.3, 0.5, 0.5, 0.0, unloaded_to=0.9)
    own = solve(scene, 1e-3).sensitivity(["friction"], s=0.5)
    for name in ("total_shear", "stick_radius"):
        assert math.isnan(own[name, "friction"].value)
        assert "below the largest load" in own[name, "friction"].note
    assert math.isnan(own.fields["traction", "friction"].value)


def test_an_approach_that_hardly_changes_has_its_rounding_in_the_estimate():
    nu = 0.4999999
    one = solve(Scene(nu, friction=math.inf, coupling=True), 1e-8).sensitivity(["poisson_ratio"])

    def approach(x):
        return (1 - 2 * x) / (8 * (1 - x) * mpmath.log(3 - 4 * x))

    with mpmath.workdps(30):
        true = float(mpmath.diff(approach, mpmath.mpf(nu)))
    slope = one["approach", "poisson_ratio"]
    assert abs(slope.value / true - 1.0) <= slope.error < 1e-7


def test_the_approach_by_the_compliance_of_a_thin_layer():
    """It is ``(gamma - ln alpha)/(4 pi)``, but for terms like ``alpha ln(alpha)**2``."""
    alpha = 1e-14
    slope = solve(Scene(0.3, alpha), 1e-6).sensitivity()["approach", "normal_compliance"]
    assert slope.value == pytest.approx((np.euler_gamma - math.log(alpha)) / (4.0 * math.pi), 1e-12)
    assert slope.error < 1e-12


def test_rounding_of_narrow_zones_is_in_the_estimate_of_the_shear():
    stuck = solve(Scene(0.3, 0.2, 0.5, math.inf), 1e-12, ["critical_friction"])
    near = stuck.scene.replace(friction=stuck.critical_friction * (1.0 - 4e-10))
    own = solve(near, 1e-6, ["stick_radius"]).sensitivity(["friction"], s=0.5)
    # off by 4.6e-6, as the square of the derivative is not linear in the distance from there
    assert 4.6e-6 < own["total_shear", "friction"].error < 1e-4
    one = own.fields["traction", "friction"]
    assert one.error > 4.6e-6 * abs(one.value)


#: Of the approach by the friction where all slips with coupling, by polynomials through solves.
WHERE_ALL_SLIPS = {(0.1, 0.0, 1e-3): -0.0140601005465, (0.1, 0.1, 0.0): -0.014061724347}


@pytest.mark.parametrize("scene", WHERE_ALL_SLIPS)
def test_friction_moves_the_approach_where_all_slips_with_coupling(scene):
    """Without friction it was said to be 0, exactly, and where all slips there was an error."""
    true = WHERE_ALL_SLIPS[scene]
    scene = Scene(0.3, *scene, coupling=True)
    one = solve(scene, 1e-6, ["approach"]).sensitivity(["friction", "poisson_ratio"])
    slope = one["approach", "friction"]
    assert abs(slope.value / true - 1.0) <= slope.error + 2e-10  # the polynomials have ten digits
    assert slope.error < 1e-11
    # the product of kappa and friction is what counts
    share = -0.25 / (1.0 - scene.poisson_ratio) ** 2 * scene.friction / scene.kappa
    assert one["approach", "poisson_ratio"].value == pytest.approx(share * slope.value, rel=1e-12)
    assert one["total_shear", "friction"].value == 1.0


@pytest.mark.parametrize(
    "scene",
    [
        Scene(0.3, 0.1, 0.1, 1e-18, coupling=True),
        Scene(0.3, 0.1, 0.0, 1e-18),
        Scene(0.3, 0.0, 0.0, 1e-18),
    ],
    ids=["coupled", "rough", "smooth"],
)
def test_how_a_disk_too_small_to_be_solved_for_moves_is_not_known(scene):
    solution = solve(scene)
    one = solution.sensitivity(["friction", "normal_compliance"], s=[0.5, 1.0])
    assert [zone.kind for zone in solution.zones] == ["slip"]
    assert math.isnan(one["stick_radius", "friction"].value)
    assert one["stick_radius", "friction"].error == math.inf
    assert one["total_shear", "friction"].value == 1.0
    if scene.normal_compliance:
        assert one["total_shear", "normal_compliance"].value == 0.0
        traction = one.fields["traction", "friction"]
        assert (np.abs(traction.value - solution.pressure([0.5, 1.0])) <= traction.error).all()


def test_what_is_not_finite_is_said():
    smooth = solve(Scene(0.3, 0.0, 0.5, 0.05), 1e-3).sensitivity(["normal_compliance"])
    for quantity in ("approach", "stick_radius"):
        one = smooth[quantity, "normal_compliance"]
        assert math.isnan(one.value)
        assert one.error == math.inf
        assert "not finite" in one.note
    rigid = solve(Scene(0.3, 0.5, 0.0, 0.05), 1e-3).sensitivity(["tangential_compliance"])
    assert "not finite" in rigid["stick_radius", "tangential_compliance"].note
    assert math.isnan(rigid["total_shear", "tangential_compliance"].value)


def test_at_an_onset_it_is_one_sided():
    critical = solve(SLIPPING, 1e-12).critical_friction
    at = solve(SLIPPING.replace(friction=critical), 1e-6).sensitivity(["friction", "poisson_ratio"])
    for pair in (("stick_radius", "friction"), ("total_shear", "poisson_ratio")):
        assert "one-sided" in at[pair].note
    # slip, of equal compliances, begins linearly: there is a slope, to what is known of the zones
    values = []
    for lack in (1e-4, 1e-6):
        near = solve(SLIPPING.replace(friction=critical * (1.0 - lack)), 1e-6)
        one = near.sensitivity(["friction"])["stick_radius", "friction"]
        assert one.note == ""
        assert one.error < 1e-6
        values.append(one.value)
    assert values[1] == pytest.approx(values[0], rel=1e-3)


def test_without_friction_there_is_the_approach_alone():
    own = found(Scene(0.3, 0.5))
    assert {quantity for quantity, _ in own.derivatives} == {"approach"}
    assert own["approach", "normal_compliance"].value == pytest.approx(0.3204650850035, rel=1e-12)


def test_si_scenes_are_taken_dimensionless():
    data = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 5e-3, "load": 1e3}
    steel = Scene.from_physical(**data, normal_compliance=5e-14)
    own = found(steel)["approach", "normal_compliance"]
    assert own == found(steel.replace(physical=None))["approach", "normal_compliance"]


def test_what_cannot_be_is_refused():
    with pytest.raises(SceneError, match="did you mean friction"):
        solve(Scene(0.3), 1e-3).sensitivity(["fricton"])


def test_it_is_a_table():
    own = found(STUCK)
    lines = str(own).splitlines()
    assert lines[0].split() == ["derivative", "of", "by", "value", "error", "estimate"]
    assert len(lines) == 13
    assert "<table>" in own._repr_html_()


@pytest.mark.parametrize("scene", TRUE_FIELDS)
def test_those_of_fields_are_right_and_their_errors_honest(scene):
    fields = solve(scene, 1e-6, ["approach"]).sensitivity(s=RADII).fields
    assert {name for _, name in fields} == {*PARAMETERS}
    for pair, true in TRUE_FIELDS[scene].items():
        one, size = fields[pair], np.max(np.abs(true))
        off = np.abs(one.value - true)
        assert (off <= one.error + 1e-13).all(), pair
        assert (off < 1e-11 * size).all(), pair
        assert (one.error < 5e-10 * size).all(), pair
    if scene.coupling:
        return
    for name in PARAMETERS:
        if name != "normal_compliance":
            assert (fields["pressure", name].value == 0.0).all()
    # kappa alone, and friction as f/kappa
    by, kappa = fields["traction", "poisson_ratio"].value, scene.kappa
    f = scene.friction if math.isfinite(scene.friction) else 0.0
    rest = solve(scene, 1e-12).traction(RADII) - f * fields["traction", "friction"].value
    np.testing.assert_allclose(by, -0.25 / (1 - scene.poisson_ratio) ** 2 * rest / kappa, 1e-9)


def test_where_those_of_fields_are_not_known_they_say_so():
    c = solve(SLIPPING, 1e-12).stick_radius
    own = solve(SLIPPING, 1e-3).sensitivity(["friction", "normal_compliance"], s=[0.0, c, 1.0])
    one = own.fields["traction", "friction"]
    assert np.isnan(one.value).tolist() == [False, True, False]
    assert np.isinf(one.error).tolist() == [False, True, False]
    assert np.isfinite(own.fields["pressure", "normal_compliance"].error).all()
    smooth = solve(Scene(0.3, friction=0.05), 1e-3).sensitivity(["normal_compliance"], s=0.5)
    for quantity in ("pressure", "traction"):
        one = smooth.fields[quantity, "normal_compliance"]
        assert one.value.shape == ()
        assert (math.isnan(one.value), one.error, one.note) == (True, math.inf, "not computed at 0")
    # the traction is singular where a stick boundary moves, and moves the pressure with coupling
    rigid = Scene(0.0, 0.3, 0.0, 0.4, coupling=True)
    own = solve(rigid, 1e-3).sensitivity(["friction", "normal_compliance"], s=[0.05, 0.9])
    for one in own.fields.values():
        assert np.isnan(one.value).all()
        assert "where zones move" in one.note
    slides = solve(Scene(0.3, 0.5, 0.5, 0.0), 1e-3).sensitivity(["friction"], from_edge=[0.5, 0.1])
    one = slides.fields["traction", "friction"]
    np.testing.assert_allclose(one.value, solve(Scene(0.3, 0.5), 1e-12).pressure([0.5, 0.9]), 1e-12)
    assert one.note == "one-sided"
    assert found(SLIPPING).fields == {}
    with pytest.raises(SceneError, match=r"s = 1\.5"):
        solve(SLIPPING, 1e-3).sensitivity(s=1.5)


#: Smooth contact of h = r**2/2 and h = r cot(theta) at a radius: approach and load, and their
#: derivatives by the radius.
SMOOTH = {
    "parabola": (
        profiles.Parabola(1.0),
        lambda a: (a**2, 16.0 / 3.0 * a**3, 2.0 * a, 16.0 * a**2),
    ),
    "cone": (
        profiles.Cone(1.2),
        lambda a: tuple(
            one / math.tan(1.2)
            for one in (math.pi * a / 2.0, 2.0 * math.pi * a**2, math.pi / 2.0, 4.0 * math.pi * a)
        ),
    ),
}


@pytest.mark.parametrize("shape", SMOOTH)
@pytest.mark.parametrize("given", ["contact_radius", "load", "approach"])
def test_by_the_work_of_adhesion(shape, given):
    """Johnson, Kendall and Roberts: delta = delta_0 - d, P = P_0 - 8 a d, d**2 = pi a w/2."""
    profile, unpulled = SMOOTH[shape]
    a, w = 1.2, 0.05
    d = math.sqrt(math.pi * a * w / 2.0)
    approach, load, approach_rate, load_rate = unpulled(a)
    # derivatives by radius and by w of approach and load with adhesion
    by_radius = approach_rate - d / (2.0 * a), load_rate - 12.0 * d
    by_w = -d / (2.0 * w), -4.0 * a * d / w
    exact = {"approach": by_w[0], "load": by_w[1]}
    if given != "contact_radius":
        held = ("approach", "load").index(given)
        moved = -by_w[held] / by_radius[held]
        other = 1 - held
        exact = {
            ("approach", "load")[other]: by_w[other] + by_radius[other] * moved,
            "contact_radius": moved,
        }
    values = {"contact_radius": a, "approach": approach - d, "load": load - 8.0 * a * d}
    scene = Scene(0.3, profile=profile, work_of_adhesion=w, **{given: values[given]})
    found = solve(scene, 1e-11).sensitivity()
    assert set(found.derivatives) == {(name, "work_of_adhesion") for name in exact}
    for name, value in exact.items():
        one = found[name, "work_of_adhesion"]
        assert one.error < 1e-9
        assert abs(one.value / value - 1.0) <= one.error + 4e-15


@pytest.mark.parametrize("given", [{"load": -0.3, "branch": 1}, {"approach": 0.1}])
def test_by_the_work_of_adhesion_on_a_layer(given):
    scene = Scene(0.3, 0.5, profile=profiles.Parabola(1.0), work_of_adhesion=0.2, **given)
    found = solve(scene, 1e-11).sensitivity(["work_of_adhesion"])
    step = 2e-3
    for (name, _), one in found.derivatives.items():

        def difference(step, name=name):
            ends = (
                getattr(solve(scene.replace(work_of_adhesion=0.2 * math.exp(h)), 1e-12), name)
                for h in (step, -step)
            )
            return (next(ends) - next(ends)) / (2.0 * step) / 0.2

        true = (4.0 * difference(step) - difference(2.0 * step)) / 3.0
        assert one.value == pytest.approx(true, rel=1e-9)
        assert one.error < 1e-8


def test_with_adhesion_there_are_no_others():
    scene = Scene(0.3, profile=profiles.Parabola(1.0), work_of_adhesion=0.2, load=0.0)
    solution = solve(scene)
    with pytest.raises(SceneError, match="work_of_adhesion"):
        solution.sensitivity(["normal_compliance"])
    with pytest.raises(SceneError, match="scalars alone"):
        solution.sensitivity(s=0.5)


def test_next_to_pull_off_it_has_fewer_digits():
    scene = Scene(0.3, profile=profiles.Parabola(1.0), work_of_adhesion=0.2, load=0.0)
    last = pull_off(scene, "approach")
    at_fold = solve(scene.replace(load=None, approach=last.approach * (1.0 - 1e-6)), 1e-8)
    far = solve(scene, 1e-8).sensitivity()["contact_radius", "work_of_adhesion"]
    near = at_fold.sensitivity()["contact_radius", "work_of_adhesion"]
    assert near.value > 10.0 * far.value
    assert near.error > 10.0 * far.error


def test_a_flat_punch_is_the_same_with_any_work_of_adhesion():
    flat = Scene(0.3, 0.5, profile=profiles.Flat(1.0), work_of_adhesion=0.2, load=0.1)
    assert solve(flat).sensitivity()["approach", "work_of_adhesion"].value == 0.0


def test_where_a_smooth_edge_sticks_its_traction_has_a_derivative():
    """The pressure is infinite there, but no part of the traction."""
    scene = Scene(0.1, 0.0, 0.5, 0.05)
    slopes = solve(scene, 1e-3).sensitivity(["friction"], s=[1.0])
    found = slopes.fields["traction", "friction"]
    less, more = (solve(scene.replace(friction=f), 1e-12).traction(1.0) for f in (0.04999, 0.05001))
    assert found.value[0] == pytest.approx((more - less) / 2e-5, rel=1e-6)
    assert found.error[0] < 1e-11
