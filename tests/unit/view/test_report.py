"""Tables of a solution: errors of SI values, which follow from what the scene gives."""

import math
import re
from dataclasses import replace

import mpmath
import pytest

from spectral_contact import ErrorEstimates, NotComputedError, Scene, layers, profiles, solve
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


def test_a_load_that_adhesion_cancels_has_no_digit():
    # at this radius the load is 0 but for rounding, a difference of two parts of 0.2
    sphere = profiles.Sphere(1.0)
    radius = 0.4103546108046176
    scene = Scene(None, 0.05, profile=sphere, work_of_adhesion=0.01, contact_radius=radius)
    solution = solve(scene)
    [line] = [one for one in report(solution).splitlines() if one.startswith("  load ")]
    assert float(line.split()[-1]) == pytest.approx(
        solution.error.load * solution.error_scales["load"] / abs(solution.load), rel=0.1
    )
    assert float(line.split()[-1]) > 0.1


def test_csv_tells_errors_relative_to_the_value(tmp_path):
    sphere = profiles.Sphere(1.0)
    scene = Scene(None, 0.05, profile=sphere, work_of_adhesion=0.01, contact_radius=0.41035461)
    solution = solve(scene)
    solution.to_csv(tmp_path / "fields.csv")
    text = (tmp_path / "fields.csv").read_text()
    told = float(re.search(r"# load = \S+ \(relative error (\S+)\)", text)[1])
    own = solution.error.load * solution.error_scales["load"] / abs(solution.load)
    assert told == pytest.approx(own, rel=0.1)


def test_a_pressure_that_adhesion_cancels_has_no_digit(tmp_path):
    # at the centre, the pressure of the tip and the suction of adhesion differ by 1e-8 of either
    adhesive = {"profile": profiles.Parabola(1.0), "work_of_adhesion": 1.356586}
    scene = Scene(None, 0.05, **adhesive, contact_radius=1.0)
    solution = solve(scene, 1e-2)
    pressure = solution.pressure(0.0)
    true = solve(scene, 1e-12).pressure(0.0)
    off = abs(pressure - true) / abs(pressure)
    assert off > 100.0 * solution.error.pressure
    mean = solution.error_scales["load"] / math.pi
    own = solution.error.pressure * mean / abs(pressure)
    [line] = [one for one in report(solution).splitlines() if "pressure, centre" in one]
    assert float(line.split()[-1]) == pytest.approx(own, rel=0.1)
    assert own > off
    solution.to_csv(tmp_path / "fields.csv")
    text = (tmp_path / "fields.csv").read_text()
    told = float(re.search(r"# pressure, centre = \S+ \(relative error (\S+)\)", text)[1])
    assert told == pytest.approx(own, rel=0.1)


def test_a_traction_that_unloading_cancels_has_an_error_relative_to_the_friction_bound():
    scene = Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.3)
    solution = solve(scene, 1e-4)
    traction = solution.traction(1.0)
    size = scene.friction * solution.pressure(1.0) / abs(traction)
    [line] = [one for one in report(solution).splitlines() if "traction, edge" in one]
    assert solution.zones[-1].memory
    assert float(line.split()[-1]) == pytest.approx(solution.error.traction * size, rel=0.1)


def test_csv_calls_no_value_exact_whose_error_takes_a_field_that_was_not_asked_for(tmp_path):
    # with coupling the error of the pressure is relative to pressure and traction together
    solution = solve(Scene(0.2, 0.5, 0.5, math.inf, coupling=True), 1e-4, ["pressure"])
    assert solution.error.pressure > 0.0
    solution.to_csv(tmp_path / "fields.csv")
    lines = (tmp_path / "fields.csv").read_text().splitlines()
    assert f"# pressure, centre = {float(solution.pressure(0.0))!r}" in lines


def test_an_approach_that_a_clearance_cancels_has_few_digits(tmp_path):
    # the pressure begins at a gap of 0.04: at this load the approach is 0 but for rounding
    layer, cone = layers.Exponential(3.0, 0.04), profiles.Cone(1.4)
    none = solve(Scene(None, profile=cone, layer=layer, approach=1e-9), 1e-11)
    solution = solve(Scene(None, profile=cone, layer=layer, load=none.load), 1e-4)
    own = solution.error.approach * solution.error_scales["approach"] / abs(solution.approach)
    assert abs(solution.approach - 1e-9) <= own * abs(solution.approach)
    [line] = [one for one in report(solution).splitlines() if one.startswith("  approach ")]
    assert float(line.split()[-1]) == pytest.approx(own, rel=0.1)
    solution.to_csv(tmp_path / "fields.csv")
    text = (tmp_path / "fields.csv").read_text()
    told = float(re.search(r"# approach = \S+ \(relative error (\S+)\)", text)[1])
    assert told == pytest.approx(own, rel=0.1)


SI_TIP = {name: value for name, value in STEEL.items() if name not in ("radius", "friction")}


@pytest.mark.parametrize(
    ("scene", "quantity", "takes"),
    [
        (
            Scene.from_physical(**SI_TIP, load=1000.0, profile=profiles.Parabola(0.01)),
            "pressure",
            "contact_radius",
        ),
        (Scene.from_physical(**STEEL, approach=1e-7), "traction", "approach"),
        (Scene.from_physical(**STEEL, approach=1e-7), "zones", "approach"),
    ],
)
def test_what_si_values_take_and_was_not_asked_for_is_named(scene, quantity, takes, tmp_path):
    solution = solve(scene, 1e-2, [quantity])
    told = f"not known without {takes}"
    assert told in solution.summary()
    assert told in str(solution.physical)
    assert told in solution._repr_html_()
    if quantity != "zones":
        solution.to_csv(tmp_path / "fields.csv")
        assert told in (tmp_path / "fields.csv").read_text()


def test_zones_in_metres_have_the_error_of_the_contact_radius():
    tip = Scene.from_physical(**SI_TIP, friction=0.1, load=1000.0, profile=profiles.Parabola(0.01))
    pressed = solve(tip, 1e-2, ["zones", "contact_radius"])
    error = ErrorEstimates(zones=1e-9, contact_radius=1e-3)
    text = report(replace(pressed, error=error)).split("\nzones ", 1)[1]
    *_, to, from_edge, _, metres = text.splitlines()[1].split()
    assert (to, from_edge) == ("1", "0")
    assert float(metres) == float(f"{pressed.contact_radius:.4g}")


def test_a_dataset_of_no_quantity_is_refused():
    solution = solve(Scene(0.3, 0.5), 1e-2, ["slip"])
    with pytest.raises(NotComputedError):
        solution.to_xarray()


def test_the_stiffness_next_to_pull_off_has_an_error_relative_to_itself():
    """Its error was relative to another stiffness, and lacked that of the contact radius."""
    # P = 16/3 x^2 - b x with x = a^(3/2) and b = sqrt(32 pi w) is the theory of Johnson et al.
    load = -0.471238898 * (1.0 - 1e-8)
    scene = Scene(0.3, profile=profiles.Parabola(1.0), load=load, work_of_adhesion=0.1)
    solution = solve(scene, 1e-8, ["stiffness_on_branch"])
    with mpmath.workdps(30):
        b = mpmath.sqrt(32 * mpmath.pi * mpmath.mpf(0.1))
        a = ((b + mpmath.sqrt(b**2 + 64 * mpmath.mpf(load) / 3)) * 3 / 32) ** (mpmath.mpf(2) / 3)
        rates = (16 * a**2 - 1.5 * b * mpmath.sqrt(a), 2 * a - b / mpmath.sqrt(a) / 16)
        off = float(abs(solution.stiffness_on_branch / (rates[0] / rates[1]) - 1))
    [line] = [one for one in report(solution).splitlines() if "on branch" in one]
    # A rounding of the load alone moves this stiffness by eps / (2e-8), about 1e-8, of itself.
    assert max(off, 1e-8) < float(line.split()[-1]) < 1e-5


def test_traction_where_a_smooth_edge_sticks_and_the_pressure_is_infinite():
    scene = Scene(0.3, 0.0, 0.5, 0.05, coupling=True)
    solution = solve(scene, 1e-4, ["traction", "pressure"])
    row = next(line for line in report(solution).splitlines() if "traction, edge" in line)
    assert float(row.split()[-1]) == pytest.approx(solution.error.traction, rel=0.1)
