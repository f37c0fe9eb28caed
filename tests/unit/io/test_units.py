"""Values with units: what is converted, exactly, and what is refused by name."""

import sys
import time
from fractions import Fraction

import pytest

from spectral_contact import MissingDependencyError, Scene, SceneError
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
    with pytest.raises(MissingDependencyError, match=r"spectral_contact\[units\]"):
        Scene.from_physical(**STEEL, load="1 kN")
    with pytest.raises(SceneError, match=r"^load = 'much'"):
        Scene.from_physical(**STEEL, load="much")
    assert Scene.from_physical(**STEEL, load=1e3).physical.load == 1e3


def test_plain_numbers_have_no_unit():
    assert not has_unit("1e3")
    assert not has_unit(1e3)
    assert in_si("x", "1e3", "m") == "1e3"
