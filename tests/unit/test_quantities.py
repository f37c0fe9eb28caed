"""The table of output quantities: what it lists is there, and what reads it knows all of it."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import (
    QUANTITIES,
    ErrorEstimates,
    PhysicalSolution,
    Scene,
    Solution,
    solve,
)
from spectral_contact.profiles import Parabola
from spectral_contact.quantities import (
    ADHESION_QUANTITIES,
    FIELDS,
    NUMBERS,
    OUTPUTS,
    PROFILE_QUANTITIES,
    UNLOADED_QUANTITIES,
)
from spectral_contact.solving.planning import plan
from spectral_contact.sweeps.physical_scenes import _RESULTS

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("quantity", OUTPUTS, ids=lambda one: one.name)
def test_a_quantity_has_an_estimate_and_is_in_both_units(quantity):
    assert quantity.name in {one.name for one in fields(ErrorEstimates)}
    for owner in (Solution, PhysicalSolution):
        assert getattr(owner, quantity.name).__doc__


@pytest.mark.parametrize("quantity", OUTPUTS, ids=lambda one: one.name)
def test_a_quantity_is_in_the_file_format_and_has_known_kinds(quantity):
    named = f"`{quantity.name}`" in (DOCS / "file_format.md").read_text(encoding="utf-8")
    assert named, "docs/file_format.md does not have it"
    assert quantity.si_factor in ("", "radius", "displacement", "stress", "force")
    assert quantity.kind in ("number", "field", "zones")
    assert quantity.contact in ("normal", "tangential")
    assert quantity.scenes in ("all", "profile", "adhesion", "flat", "unloaded")
    assert bool(quantity.si_unit) >= bool(quantity.si_factor)


PARABOLA = {"profile": Parabola(1.0), "contact_radius": 1.0}
SCENES = {
    "flat": Scene(0.1, 0.5, 0.5, 0.1),
    "frictionless": Scene(0.1, 0.5),
    "full stick": Scene(0.1, 0.5, 0.5, np.inf),
    "profile": Scene(0.3, 0.5, **PARABOLA),
    "growing": Scene(0.3, 0.5, 0.5, np.inf, **PARABOLA),
    "adhesion": Scene(0.3, 0.5, work_of_adhesion=0.01, **PARABOLA),
}


@pytest.mark.parametrize("name", SCENES)
def test_what_a_plan_lists_has_a_value_and_an_estimate(name):
    """Asked for alone as well, where steps are left out."""
    scene = SCENES[name]
    together = solve(scene, 1e-5)
    known = {
        one.name for one in fields(together.error) if getattr(together.error, one.name) is not None
    }
    assert set(together.plan.quantities) - {*together.values, *FIELDS} == set()
    assert set(together.plan.quantities) - known == set()
    for quantity in together.plan.quantities:
        alone = solve(scene, 1e-5, [quantity])
        for one in (together, alone):
            assert isinstance(getattr(one.error, quantity), float)
        values = [getattr(one, quantity) for one in (together, alone)]
        if quantity in FIELDS:
            values = [value([0.3, 0.9]) for value in values]
        if quantity == "zones":
            values = [[zone.outer for zone in zones] for zones in values]
        if values[0] is not None:
            assert values[0] == pytest.approx(values[1], rel=1e-5, abs=1e-9)


def test_quantities_in_si_units_are_in_datasets_of_sweeps():
    assert {name: unit for name, (_, unit) in _RESULTS.items()} == {
        one.name: one.si_unit for one in OUTPUTS if one.si_unit
    }


def test_names_are_in_the_order_of_a_report():
    assert QUANTITIES[:3] == ("approach", *FIELDS[:2])
    others = *PROFILE_QUANTITIES, *ADHESION_QUANTITIES, *UNLOADED_QUANTITIES
    assert {*NUMBERS, *FIELDS, "zones"} == {*QUANTITIES, *others}


def test_a_plan_lists_all_that_a_scene_may_have():
    flat = plan(Scene(0.1, 0.5, 0.5, np.inf))
    assert {*flat.quantities, *dict(flat.missing)} == set(QUANTITIES)


def test_a_plan_lists_all_that_a_scene_below_its_largest_load_may_have():
    scene = plan(Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.8))
    assert set(scene.quantities) == set(QUANTITIES)
    assert set(UNLOADED_QUANTITIES) <= set(dict(scene.missing))
    assert [(one.name, one.state.value) for one in scene.steps][-2:] == [
        ("unloading", "if needed"),
        ("load ratios", "skipped"),
    ]
    ratios = plan(Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.8), UNLOADED_QUANTITIES)
    assert ratios.steps[-1].state.value == "if needed"
    assert dict(plan(Scene(0.1, unloaded_to=0.8)).missing)["turning_ratio"]


def test_a_radius_in_metres_takes_no_load():
    steel = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "radius": 0.01, "approach": 1e-6}
    scene = Scene.from_physical(**steel, tangential_compliance=1e-14, friction=0.1)
    found = solve(scene, 1e-6, ["stick_radius"])
    assert found.physical.stick_radius == found.stick_radius * 0.01
