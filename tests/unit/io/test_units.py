"""Values with units: what is converted, exactly, and what is refused by name."""

import math
import sys
import time
from fractions import Fraction

import numpy as np
import pytest

from spectral_contact import (
    MissingDependencyError,
    Scene,
    SceneError,
    calibration,
    closed_forms,
    layers,
    plotting,
    profiles,
    reference,
    solve,
    sweep,
)
from spectral_contact.asperities import greenwood_williamson
from spectral_contact.io import units
from spectral_contact.io.units import has_unit, in_si

STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "radius": 5e-3}


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("210 GPa", "Pa", 210e9),
        ("0.1 mm", "m", 1e-4),
        ("50 nm/MPa", "m/Pa", 5e-14),
        ("5e-2 µm·MPa**-1", "m/Pa", 5e-14),
        ("1e3mN", "N", 1.0),
        ("-.5 kN", "N", -500.0),
        ("1 m^3/N", "m/Pa", 1.0),
        ("210 N/mm²", "Pa", 210e6),
        ("5 Å", "m", 5e-10),
        ("5 \u212b", "m", 5e-10),
        ("50 µm³/N", "m/Pa", 5e-17),
        ("1e4 mm⁻²", "m**-2", 1e10),
        ("70.3 deg", "rad", math.radians(70.3)),
        ("70.3°", "rad", math.radians(70.3)),
    ],
)
def test_text_is_converted_exactly(text, unit, value):
    pytest.importorskip("pint")
    exact = in_si("x", text, unit)
    assert isinstance(exact, Fraction)
    assert float(exact) == value


def test_a_scene_takes_text_and_quantities():
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    scene = Scene.from_physical(**STEEL, load=1e3, normal_compliance=5e-14)
    text = {"youngs_modulus": "210 GPa", "radius": "5 mm", "load": "1 kN"}
    assert scene == Scene.from_physical(poisson_ratio=0.3, **text, normal_compliance="50 nm/MPa")
    quantities = {"youngs_modulus": 210 * unit.GPa, "radius": 5 * unit.mm, "load": 1 * unit.kN}
    measured = Scene.from_physical(poisson_ratio=0.3, **quantities)
    assert measured.physical.youngs_modulus == pytest.approx(210e9, rel=1e-15)
    assert measured.physical.radius == pytest.approx(5e-3, rel=1e-15)
    assert Scene.from_json(measured.to_json()) == measured


@pytest.mark.parametrize(
    "text",
    [
        *(
            "1 m",
            "1 GPaa",
            "1 x",
            "nan N",
            "N",
            "1 N m",
            "1e999 kN",
            "1e9999999999 kN",
            "1e-999 kN",
        ),
        *("1 N**99", "1 (km/m)**9 N", "1 N**9**9**9", "1 m" * 100, "0 N", "", "1"),
    ],
)
def test_what_is_no_force_is_refused_by_name(text):
    pytest.importorskip("pint")
    start = time.perf_counter()
    with pytest.raises(SceneError, match=r"^load = "):
        Scene.from_physical(**STEEL, load=text)
    assert time.perf_counter() - start < 5.0


def test_a_quantity_of_another_kind_is_refused_by_name():
    pint = pytest.importorskip("pint")
    with pytest.raises(SceneError, match=r"^load = .*: must be a number in N, or in a unit like"):
        Scene.from_physical(**STEEL, load=pint.UnitRegistry().Quantity(1.0, "m"))


def test_without_pint_a_unit_is_answered_by_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pint", None)
    units._registry.cache_clear()
    with pytest.raises(MissingDependencyError, match=r'pip install "\.\[units\]"'):
        Scene.from_physical(**STEEL, load="1 kN")
    with pytest.raises(SceneError, match=r"^load = 'much'"):
        Scene.from_physical(**STEEL, load="much")
    assert Scene.from_physical(**STEEL, load=1e3).physical.load == 1e3


def test_plain_numbers_have_no_unit():
    assert not has_unit("1e3")
    assert not has_unit(1e3)
    assert in_si("x", "1e3", "m") == "1e3"


@pytest.mark.parametrize("text", ["5 ??", "20 N/(m s)", "much", "N", "5 m/"])
def test_text_that_is_no_number_and_unit_is_told_what_is(text):
    with pytest.raises(SceneError, match="a number in m, or text of a number and a unit, as '1 m'"):
        in_si("x", text, "m")


def test_a_stiffness_where_a_compliance_is_asked_for_is_told_its_inverse():
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    for stiffness in ("20 MPa/um", 20 * unit.MPa / unit.um, "2e13 Pa/m"):
        with pytest.raises(
            SceneError, match=r"^normal_compliance = .*; give its inverse: 5e-14 m/Pa"
        ):
            Scene.from_physical(**STEEL, load=1e3, normal_compliance=stiffness)
    for other in ("20 MPa", "0 MPa/um"):
        with pytest.raises(SceneError, match=r"or in a unit like it$"):
            Scene.from_physical(**STEEL, load=1e3, normal_compliance=other)


# -- arrays ----------------------------------------------------------------------------------------


class Length(np.ndarray):
    """An array of lengths as astropy has them: NumPy takes its numbers and drops the unit."""

    unit = "mm"

    def __iter__(self):
        return (np.array(number).view(Length) for number in np.asarray(self))

    def to(self, unit):
        """Return the lengths in m, the only unit that they know."""
        if unit != "m":
            raise ValueError(f"mm is not {unit}")
        return Length(self.shape, buffer=np.ascontiguousarray(np.asarray(self) / 1000.0))

    @property
    def value(self):
        """The numbers."""
        return np.asarray(self)


class Wrapped:
    """An array whose data have a unit, as those of xarray may."""

    def __init__(self, data):
        self._data = data

    @property
    def data(self):
        """The quantity."""
        return self._data

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self._data.magnitude, dtype)


@pytest.fixture(scope="module")
def unit():
    return pytest.importorskip("pint").UnitRegistry()


@pytest.fixture(scope="module")
def solution():
    return solve(
        Scene.from_physical(**STEEL, load=1e3, normal_compliance=5e-14, friction=0.05), 1e-6
    )


def millimetres(unit, numbers):
    """Return the numbers in mm in every way in which they may be said to be."""
    array = np.array(numbers)
    return [
        array * unit.mm,
        [number * unit.mm for number in numbers],
        np.array([number * unit.mm for number in numbers], dtype=object),
        array.view(Length),
        [f"{number} mm" for number in numbers],
        np.array([f"{number} mm" for number in numbers]),
        Wrapped(array * unit.mm),
    ]


def test_measured_data_with_units_are_in_si(unit):
    for depths in millimetres(unit, [1.0, 2.0, 3.0]):
        data = calibration.IndentationData(depths, [1, 2, 3] * unit.mN, "1 uN")
        assert data.depth == pytest.approx((1e-3, 2e-3, 3e-3), rel=1e-15)
        assert data.load == pytest.approx((1e-3, 2e-3, 3e-3), rel=1e-15)
        assert data.sigma == pytest.approx((1e-6,) * 3, rel=1e-15)
    for values in millimetres(unit, [1.0, 2.0]):
        data = calibration.ApproachData(values, 1 * unit.um, radius=values, load=[1, 2] * unit.kN)
        assert data.approach == data.radius == pytest.approx((1e-3, 2e-3))
        assert data.sigma == pytest.approx((1e-6,))
        assert data.load == pytest.approx((1e3, 2e3))
        data = calibration.PressureData(values, [1, 2] * unit.MPa, "1 kPa", radius=4 * unit.mm)
        assert data.r == pytest.approx((1e-3, 2e-3))
        assert data.pressure == pytest.approx((1e6, 2e6))
        assert data.sigma + data.radius == pytest.approx((1e3, 4e-3))
        data = calibration.StickRadiusData(values, "1 um", friction=[5, 10] * unit.percent)
        assert data.stick_radius == pytest.approx((1e-3, 2e-3))
        assert data.friction == pytest.approx((0.05, 0.1))


def test_fields_in_si_take_radii_with_units(unit, solution):
    punch = solution.physical
    for field in (punch.pressure, punch.traction, punch.slip):
        for radii in millimetres(unit, [1.0, 4.0]):
            assert field(radii) == pytest.approx(field([1e-3, 4e-3]), rel=1e-12)
            assert field(from_edge=radii) == pytest.approx(field(from_edge=[1e-3, 4e-3]), rel=1e-12)


def test_the_body_in_si_takes_points_with_units(unit, solution):
    body = solution.physical.inside
    expected = body.stress([1e-3, 6e-3], 1e-3).zz
    for radii in millimetres(unit, [1.0, 6.0]):
        assert body.stress(radii, "1 mm").zz == pytest.approx(expected, rel=1e-12)
        table = body.to_table(radii, 1 * unit.mm)
        assert table["r"] == pytest.approx([1e-3, 6e-3])
        assert table["sigma_zz"] == pytest.approx(expected, rel=1e-12)
        grid = body.to_xarray(radii, [1] * unit.mm)
        assert grid["r"].values == pytest.approx([1e-3, 6e-3])
    with pytest.raises(SceneError, match=r"^z = .* without a unit"):
        solution.inside.stress(0.5, 1 * unit.um)


def test_a_percentage_is_a_plain_number(unit, solution):
    half = 50 * unit.percent
    assert Scene(0.3, 0.1, 0.1, 5 * unit.percent).friction == pytest.approx(0.05)
    assert solution.pressure([10, 50] * unit.percent)[1] == pytest.approx(solution.pressure(0.5))
    assert closed_forms.smooth_pressure(half) == closed_forms.smooth_pressure(0.5)
    found = sweep(Scene(0.3, 0.1, 0.1), friction=[5, 10] * unit.percent, quantities=["approach"])
    assert found["friction"].values == pytest.approx([0.05, 0.1])
    # a ratio of lengths is dimensionless and has a factor
    assert solution.pressure(2500 * unit.um / (5 * unit.mm)) == pytest.approx(
        solution.pressure(0.5)
    )


LENGTHS = {
    "layers.Table": lambda x: layers.Table(x, [0, 1, 4, 9]),
    "pressures of layers.Table": lambda x: layers.Table([0, 1, 2, 3], x),
    "Sampled.from_points": lambda x: profiles.Sampled.from_points(x, [0, 1, 4, 9]),
    "heights": lambda x: profiles.Sampled.from_points([0, 1, 2, 3], x),
    "Profile.height": lambda x: profiles.Parabola(1.0).height(x),
    "Layer.pressure": lambda x: layers.PowerLaw(1.0, 2.0).pressure(x),
    "breaks": lambda x: profiles.Sampled.from_functions(
        np.square, lambda r: 2 * r, reach=9, breaks=x
    ),
    "closed_forms": lambda x: closed_forms.parabola_pressure(1.0, 4.0, x),
    "sweep": lambda x: sweep(Scene(0.3, 0.1), normal_compliance=x, quantities=["approach"]),
    "solve": lambda x: solve(Scene(0.3, 0.1), 1e-3).pressure(x),
}


@pytest.mark.parametrize("call", LENGTHS.values(), ids=LENGTHS)
def test_where_there_is_no_unit_lengths_are_refused(unit, call):
    numbers = np.array([0.0, 0.2, 0.5, 1.0])
    for lengths in (numbers * unit.mm, [x * unit.mm for x in numbers], numbers.view(Length)):
        with pytest.raises(ValueError, match="must be without a unit"):
            call(lengths)


def test_numbers_of_asperities_and_angles_have_units(unit):
    given = {"density": 1e4 * unit.mm**-2, "tip_radius": "5 µm", "height_deviation": "400 nm"}
    moduli = {"youngs_modulus": "200 GPa", "poisson_ratio": 0.3, "pressure": 10 * unit.MPa}
    layer = greenwood_williamson(**given, **moduli)
    si = {"density": 1e10, "tip_radius": 5e-6, "height_deviation": 4e-7}
    same = greenwood_williamson(**si, youngs_modulus=200e9, poisson_ratio=0.3, pressure=10e6)
    assert layer.normal_compliance == pytest.approx(same.normal_compliance, rel=1e-12)
    angle = math.radians(70.3)
    for cone in (profiles.Cone(70.3 * unit.deg), profiles.Cone("70.3 deg")):
        assert cone.half_angle == pytest.approx(angle, rel=1e-15)
    assert profiles.TruncatedCone(1.0, "70.3°").half_angle == pytest.approx(angle, rel=1e-15)


def test_a_picture_of_the_body_has_a_width_with_a_unit(unit, solution):
    pytest.importorskip("matplotlib")
    with pytest.raises(SceneError, match=r"^r_max = .* finite and > 0 \[m\]"):
        plotting.plot_inside(solution.physical.inside, r_max=0 * unit.mm)
    with pytest.raises(SceneError, match=r"^r_max = .* without a unit"):
        plotting.plot_inside(solution.inside, r_max=12 * unit.mm)


def test_a_reference_takes_what_a_solution_takes(unit):
    exact = reference(Scene(0.3), digits=15)
    assert exact.pressure(50 * unit.percent) == exact.pressure(0.5)
    with pytest.raises(SceneError, match=r"^s = .* without a unit"):
        exact.pressure([0.1, 0.2] * unit.mm)
