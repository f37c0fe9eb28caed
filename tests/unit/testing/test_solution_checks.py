"""The checks for any solver: they pass what is right, and fail each wrong thing by itself."""

import math
import re

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, SceneError, profiles, solve
from spectral_contact.testing import (
    Check,
    CheckReport,
    check_solution,
    load,
    normal_displacement,
    tangential_displacement,
)

RTOL = 1e-8
PARTIAL = Scene(0.1, 0.5, 0.5, 0.1)


class Fields:
    """A solution of some solver: the fields alone, each changed by a factor that depends on s."""

    def __init__(self, scene, pressure=None, traction=None, **values):
        self.solution = solve(scene, 1e-11)
        self.factors = pressure or np.ones_like, traction or np.ones_like
        self.zones = self.solution.zones
        for name, value in values.items():
            setattr(self, name, value)

    def pressure(self, *, from_edge):
        return self.solution.pressure(from_edge=from_edge) * self.factors[0](from_edge)

    def traction(self, *, from_edge):
        return self.solution.traction(from_edge=from_edge) * self.factors[1](from_edge)


def failed(fields, scene):
    report = check_solution(fields, scene, RTOL, strict=False)
    return [check.name for check in report.checks if not check.passed]


SCENES = [
    Scene(0.3),
    Scene(0.3, 1e-6),
    Scene(0.3, friction=0.1),
    PARTIAL,
    Scene(0.3, 0.05, 1.0, 0.23 / 7),
    Scene(0.0, 0.0, 0.5, 0.05),
    Scene(0.0, 0.5, 0.0, 0.1),
    Scene(-0.5, 0.1, 0.02, math.inf),
    Scene(0.2, 0.3, 0.1, 0.0),
    Scene(0.5, 0.3, 0.1, 0.2),
]


@pytest.mark.parametrize("scene", SCENES, ids=str)
def test_a_solution_passes(scene):
    report = check_solution(solve(scene, 1e-11), scene, 1e-11)
    assert report.passed
    assert all(check.error <= 1e-12 for check in report.checks)


def test_only_the_fields_are_needed():
    assert failed(Fields(PARTIAL), PARTIAL) == []


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"pressure": lambda d: np.full_like(d, 1 + 1e-6)}, "pressure bears the load"),
        ({"pressure": lambda d: 1 + 1e-5 * (d - 0.3)}, "normal equation (3.5)"),
        ({"pressure": lambda d: np.where(d > 0.99, -1.0, 1.0)}, "pressure is not negative"),
        ({"pressure": lambda d: np.where(d < 2e-8, np.nan, 1.0)}, "normal equation (3.5)"),
        ({"approach": 0.2929}, "approach, by reciprocity"),
        ({"traction": lambda d: np.full_like(d, 1 + 1e-6)}, "traction within friction"),
        ({"traction": lambda d: np.full_like(d, 1 - 1e-6)}, "no displacement in stick (4.2)"),
        ({"traction": lambda d: -np.ones_like(d)}, "slip opposes the traction"),
        ({"total_shear": 0.0867}, "total shear is that of the traction"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_wrong_fails(change, expected):
    assert expected in failed(Fields(PARTIAL, **change), PARTIAL)


def test_the_friction_law_is_checked_where_quadrature_is_cut():
    """Cuts by decades resolve layers; conditions hold there as elsewhere."""
    off = Fields(PARTIAL, traction=lambda d: np.where(np.isclose(d, 0.1, 1e-14, 0.0), 1.01, 1.0))
    assert failed(off, PARTIAL) == ["traction within friction"]


def test_a_traction_that_is_no_number_fails_in_full_stick():
    scene = Scene(0.3, 0.5, 0.5, math.inf)
    nowhere = Fields(scene, traction=lambda d: np.full_like(d, np.nan))
    assert failed(nowhere, scene) == ["no displacement in stick (4.2)"]


def test_shear_without_traction_fails():
    scene = Scene(0.3, 0.5, 0.5, 0.0)
    told = ["total shear is that of the traction"]
    assert failed(Fields(scene, total_shear=5.0), scene) == told


@pytest.mark.parametrize("field", ["pressure", "traction"])
def test_what_is_wrong_by_ten_times_the_least_tolerance_fails(field):
    """Twelve digits can be checked: quadrature and rounding leave no more than the last of them."""
    for share in (0.0, 1e-11, -1e-11):
        off = Fields(PARTIAL, **{field: lambda d, share=share: np.full_like(d, 1.0 + share)})
        off.solution = solve(PARTIAL, 1e-12)
        assert check_solution(off, PARTIAL, 1e-12, strict=False).passed == (share == 0.0)


@pytest.mark.parametrize(
    "other",
    [
        Scene(0.11, 0.5, 0.5, 0.1),
        Scene(0.1, 0.51, 0.5, 0.1),
        Scene(0.1, 0.5, 0.51, 0.1),
        Scene(0.1, 0.5, 0.5, 0.101),
        Scene(0.1, 0.5, 0.5, math.inf),
        Scene(0.1, 0.5, 0.5, 0.0),
        Scene(0.5, 0.5, 0.5, 0.1),
    ],
    ids=str,
)
def test_the_solution_of_another_scene_fails(other):
    assert failed(solve(PARTIAL, 1e-11), other)


@pytest.mark.parametrize(
    ("scene", "quantities"),
    [
        (Scene(0.3, 0.5, friction=None), ["pressure"]),
        (PARTIAL.replace(friction=math.inf), ["pressure", "traction"]),
        (
            Scene(0.3, profile=profiles.Parabola(1.0), contact_radius=1.0, friction=None),
            ["pressure"],
        ),
    ],
)
def test_a_solution_needs_no_more_than_its_fields(scene, quantities):
    report = check_solution(solve(scene, 1e-11, quantities), scene, RTOL)
    assert report.passed
    assert report.remarks == ()


def test_a_solution_without_its_zones_is_told_what_it_lacks():
    solution = solve(PARTIAL, 1e-11, ["pressure", "traction"])
    report = check_solution(solution, PARTIAL, 1e-4)
    assert report.passed
    assert "zones are not known" in report.remarks[0]
    assert str(report).endswith("give that place with breaks")
    zones = solve(PARTIAL, 1e-11).zones
    cuts = [zone.outer_from_edge for zone in zones if zone.outer < 1.0]
    assert check_solution(solution, PARTIAL, RTOL, breaks=cuts).remarks == ()
    with pytest.raises(NotComputedError, match="traction"):
        check_solution(solve(PARTIAL, 1e-11, ["pressure"]), PARTIAL, RTOL)


def test_fields_of_s_alone_will_do():
    class Plain:
        def pressure(self, s):
            return solve(Scene(0.3, 0.5), 1e-6).pressure(np.maximum(s, 0.0))

    assert check_solution(Plain(), Scene(0.3, 0.5), 1e-6).passed


def test_a_failure_raises_with_the_report():
    with pytest.raises(AssertionError, match="FAIL pressure bears the load") as raised:
        check_solution(Fields(PARTIAL, pressure=lambda d: 1.001 + 0 * d), PARTIAL, RTOL)
    assert "Scene(poisson_ratio=0.1" in str(raised.value)


def test_nan_is_no_pass():
    assert not Check("any", math.nan, 1.0).passed
    assert not CheckReport((Check("good", 0.0, 0.0), Check("bad", 2.0, 1.0))).passed


@pytest.mark.parametrize("rtol", [0.0, 0.6, math.nan, "1e-3"])
def test_impossible_tolerances(rtol):
    with pytest.raises(SceneError, match=r"rtol = .*: must be .*in \(0, 0.5\]"):
        check_solution(solve(PARTIAL, 1e-3), PARTIAL, rtol)


@pytest.mark.parametrize("place", [0.0, 1.0, math.nan])
def test_impossible_breaks(place):
    with pytest.raises(SceneError, match=r"breaks = .*: must be .*in \(0, 1\)"):
        check_solution(solve(PARTIAL, 1e-3), PARTIAL, 1e-3, breaks=[place])


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"scene": 1}, "scene = 1: must be a Scene"),
        ({"breaks": 1}, "breaks = 1: must be a list of numbers"),
        ({"strict": 1}, "strict = 1"),
        ({"pressure": lambda d: "0.5"}, "solution.pressure = '0.5'"),
        ({"pressure": lambda d: np.ones(3)}, "solution.pressure = array"),
        ({"traction": lambda d: 1j * d}, "solution.traction"),
        ({"approach": True}, "solution.approach = True"),
        ({"zones": 1}, "solution.zones = 1"),
    ],
)
def test_bad_input_is_named(change, named):
    [[name, value]] = change.items()
    asked = {"scene": PARTIAL, "rtol": 1e-3}
    found = Fields(PARTIAL)
    if name in ("scene", "breaks", "strict"):
        asked[name] = value
    else:  # without from_edge, fields are functions of s
        setattr(found, name, value)
    with pytest.raises(SceneError, match=f"^{re.escape(named)}"):
        check_solution(found, **asked)


def test_a_solution_needs_its_fields():
    with pytest.raises(SceneError, match=r"an object with a method pressure\(s\)"):
        check_solution(object(), PARTIAL, 1e-3)


# -- the equations on fields known exactly ---------------------------------------------------------


def smooth(d):
    return 1 / (2 * np.pi * np.sqrt(d * (2 - d)))


@pytest.mark.parametrize("from_edge", [1e-12, 1e-3, 0.5, 0.999])
def test_the_smooth_punch(from_edge):
    assert normal_displacement(smooth, from_edge) == pytest.approx(0.125, rel=1e-13)
    # q = s / sqrt(y) is an eigenfunction of T, of pi/8
    outward, inward = tangential_displacement(
        lambda d: (1 - d) / np.sqrt(d * (2 - d)), smooth, 0.25, from_edge
    )
    s = 1 - from_edge
    assert outward == pytest.approx(np.pi / 8 * s, rel=1e-12)
    # int_0^s p s ds = (1 - sqrt y)/(2 pi)
    y = from_edge * (2 - from_edge)
    assert inward == pytest.approx(0.25 * s / (2 * np.pi * (1 + np.sqrt(y))), rel=1e-12)


def test_load_inside_a_radius():
    assert load(smooth) == pytest.approx(1 / (2 * np.pi), rel=1e-14)
    y = 0.3 * 1.7
    assert load(smooth, inside=0.3) == pytest.approx((1 - np.sqrt(y)) / (2 * np.pi), rel=1e-13)


def test_slip_everywhere_does_not_hide_between_the_nodes_of_a_mesh():
    pressure = solve(PARTIAL, 1e-10).pressure

    class AllSlip:
        def pressure(self, *, from_edge):
            return pressure(from_edge=from_edge)

        def traction(self, *, from_edge):
            return PARTIAL.friction * pressure(from_edge=from_edge)

    nodes = np.arange(1, 40) / 40
    report = check_solution(AllSlip(), PARTIAL, 1e-2, breaks=nodes, strict=False)
    assert not report.passed


def test_a_total_shear_without_traction_fails():
    scene = Scene(0.5, 0.5, 0.5, 0.1)
    assert failed(Fields(scene, total_shear=5.0), scene) == ["total shear is that of the traction"]


def test_an_approach_of_zero_fails_without_a_warning():
    assert "normal equation (3.5)" in failed(Fields(PARTIAL, approach=0.0), PARTIAL)
