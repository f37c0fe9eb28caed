"""Derivatives of a scene's quantities, against differences of solutions to 24 digits."""

import math

import mpmath
import pytest

from spectral_contact import NotComputedError, Scene, SceneError, solve

STUCK = Scene(0.3, 0.5, 0.5, math.inf)
SLIPPING = Scene(0.1, 0.5, 0.5, 0.1)

#: As validation/honesty/sensitivity.py has them.
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
}


def found(scene):
    return solve(scene, 1e-6, ["approach"]).sensitivity()


@pytest.mark.parametrize("scene", TRUE)
def test_derivatives_are_right_and_their_errors_honest(scene):
    own = found(scene)
    for pair, true in TRUE[scene].items():
        error = abs(own[pair].value / true - 1.0)
        assert error <= own[pair].error + 1e-12, pair  # the differences have 12 digits
        if pair != ("total_shear", "normal_compliance"):
            assert own[pair].error < 1e-10, pair


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
    # so close to where slip begins that no interval around it has the same zones
    scene = SLIPPING.replace(friction=critical * (1.0 - 1e-6))
    one = solve(scene, 1e-6).sensitivity(["friction"])["stick_radius", "friction"]
    assert one.note == "one-sided, downwards"
    assert one.value > 0.0


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
    with pytest.raises(NotComputedError, match="coupling"):
        solve(Scene(0.3, 0.5, 0.5, math.inf, coupling=True), 1e-3).sensitivity()
    with pytest.raises(SceneError, match="did you mean friction"):
        solve(Scene(0.3), 1e-3).sensitivity(["fricton"])


def test_it_is_a_table():
    own = found(STUCK)
    lines = str(own).splitlines()
    assert lines[0].split() == ["derivative", "of", "by", "value", "error", "estimate"]
    assert len(lines) == 13
    assert "<table>" in own._repr_html_()
