"""Tables of a solution: errors of SI values, which follow from what the scene gives."""

import re
from dataclasses import replace

import pytest

from spectral_contact import ErrorEstimates, Scene, profiles, solve
from spectral_contact.view.report import report

STEEL = {
    "youngs_modulus": 2e11,
    "poisson_ratio": 0.25,
    "radius": 0.01,
    "normal_compliance": 1e-14,
    "tangential_compliance": 3e-14,
    "friction": 0.1,
}


def estimates(solution):
    """Return the error estimate of every value in SI units, as the table has it."""
    lines = report(solution).split("\nSI ", 1)[1].split("\n\n", 1)[0].splitlines()[1:]
    rows = [re.split(r"\s{2,}", line.strip()) for line in lines]
    return {label: error for label, _, error in rows}


def test_from_an_approach_everything_scaled_by_the_load_inherits_its_error():
    loaded = solve(Scene.from_physical(**STEEL, load=1000.0), 1e-2)
    pressed = solve(Scene.from_physical(**STEEL, approach=loaded.physical.approach), 1e-2)
    error = ErrorEstimates(
        approach=1e-3, pressure=2e-3, traction=3e-3, slip=4e-3, stick_radius=5e-3, total_shear=6e-3
    )
    by_load, by_approach = (estimates(replace(one, error=error)) for one in (loaded, pressed))
    assert (by_load.pop("load"), by_approach.pop("load")) == ("exact", "1.0e-03")
    assert (by_load.pop("approach"), by_approach.pop("approach")) == ("1.0e-03", "exact")
    assert by_load.pop("stick radius") == by_approach.pop("stick radius") == "5.0e-03"
    assert len(by_load) == 5
    for label, own in by_load.items():
        assert float(by_approach[label]) == pytest.approx(float(own) + 1e-3)


def test_a_stick_radius_in_metres_has_the_error_of_the_contact_radius():
    under_tip = {name: value for name, value in STEEL.items() if name != "radius"}
    scene = Scene.from_physical(**under_tip, load=1000.0, profile=profiles.Parabola(0.01))
    pressed = solve(scene, 1e-2, ["stick_radius", "contact_radius"])
    error = ErrorEstimates(stick_radius=5e-3, contact_radius=1e-3)
    assert estimates(replace(pressed, error=error))["stick radius"] == "6.0e-03"


def test_the_opening_in_metres_is_a_share_of_the_radius():
    stuck = STEEL | {"poisson_ratio": 0.0, "normal_compliance": 0.0, "friction": float("inf")}
    stuck["tangential_compliance"] = 0.0
    solution = solve(Scene.from_physical(**stuck, load=1000.0, coupling=True), 1e-2)
    assert 0.0 < solution.opening < 1.0
    assert solution.physical.opening == 0.01 * solution.opening
    assert solve(Scene.from_physical(**STEEL, load=1000.0), 1e-2).physical.opening is None


def test_what_is_less_certain_than_asked_is_named():
    # the edge sticks in 2.7e-7 of the radius, whose width is known to fewer digits than all else
    solution = solve(Scene(0.3, 0.05, 1.0, 0.0294109), 1e-8)
    assert solution.converged
    assert set(solution.less_certain) == {"zones"}
    assert solution.less_certain["zones"] == solution.error.zones > 1e-8
    text = report(solution)
    assert "less certain than rtol = 1.0e-08\n  zones: " in text
    assert "conditioning" in text
    assert "but for zones to " in repr(solution)


def test_nothing_is_named_where_everything_is_as_certain_as_asked():
    solution = solve(Scene(0.3, 0.5, 0.5, 0.1), 1e-6)
    assert solution.less_certain == {}
    assert "less certain" not in report(solution)
    assert repr(solution).endswith("converged=True>")


def test_what_no_digit_is_known_of_is_said_to_be_so():
    solution = solve(Scene(0.3, 0.5, 0.5, 0.1), 1e-6)
    unsure = replace(solution, error=replace(solution.error, slip=float("inf")))
    text = unsure.summary()
    assert "slip: no digit is known" in text
    [row] = [line for line in text.splitlines() if line.startswith("  slip, edge ")]
    assert row.endswith("   inf: no digit is known")
    assert repr(unsure).endswith("but for slip, of which no digit is known>")
    assert "slip, of which no digit is known" in unsure._repr_html_()
