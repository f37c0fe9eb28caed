"""What solutions, scenes, plans and gold show of themselves when they are asked."""

import csv
import math
from xml.etree import ElementTree

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, SceneError, gold, plan, solve
from spectral_contact.view.html import zones_svg
from spectral_contact.view.report import report

ANNULUS = Scene(0.3, 0.05, 1.0, 0.23 / 7)
STEEL = Scene.from_physical(
    youngs_modulus=210e9,
    poisson_ratio=0.3,
    radius=5e-3,
    load=1000.0,
    normal_compliance=5e-14,
    tangential_compliance=5e-14,
    friction=0.05,
)


@pytest.fixture(scope="module")
def solution():
    return solve(ANNULUS, 1e-8)


def text_of(html):
    """Return the texts of a fragment, which must be well-formed."""
    return " ".join(" ".join(ElementTree.fromstring(html).itertext()).split())


def test_the_summary_is_what_the_command_line_prints(solution):
    assert solution.summary() == report(solution)
    assert "zones" in solution.summary()


def test_the_plot_is_that_of_the_solution(solution):
    pytest.importorskip("matplotlib")
    assert len(solution.plot().axes) == 7
    with pytest.raises(NotComputedError, match="to plot"):
        solve(ANNULUS, 1e-3, ["approach"]).plot()


def test_a_table_has_the_errors(solution, tmp_path):
    path = tmp_path / "fields.csv"
    solution.to_csv(path)
    lines = [one for one in path.read_text("utf-8").splitlines() if not one.startswith("#")]
    rows = list(csv.DictReader(lines))
    for name, column in (("pressure", "p"), ("traction", "q"), ("slip", "slip")):
        field, error = getattr(solution, name), getattr(solution.error, name)
        assert {float(row[f"{column}_error"]) for row in rows} == {error}
        for row in rows[::20]:
            d = float(row["one_minus_s"])
            if d <= 0.5:
                assert float(row[column]) == pytest.approx(field(from_edge=d), rel=1e-14)
    with pytest.raises(NotComputedError, match="a field to write"):
        solve(ANNULUS, 1e-3, ["approach"]).to_csv(path)


def test_a_dataset_has_everything(solution):
    pytest.importorskip("xarray")
    found = solution.to_xarray()
    assert found.approach.item() == solution.approach
    assert found.approach_error.item() == solution.error.approach
    assert found.zone_kind.values.tolist() == [1, 2, 1]
    assert found.zone_outer.values[0] == solution.stick_radius
    near = found.from_edge.values <= 0.5
    d, s = found.from_edge.values[near], found.s.values[~near]
    assert np.array_equal(found.traction.values[near], solution.traction(from_edge=d))
    assert np.array_equal(found.traction.values[~near], solution.traction(s))
    assert found.slip.attrs["units"] == "4(1−ν²)P/(aE)"
    own = solution.to_xarray([0.25, 0.5])
    assert np.array_equal(own.pressure.values, solution.pressure([0.25, 0.5]))
    with pytest.raises(SceneError, match="s = 2"):
        solution.to_xarray([2.0])


def test_a_dataset_without_fields_friction_or_with_coupling():
    pytest.importorskip("xarray")
    bare = solve(Scene(0.3, 0.5), 1e-3, ["approach", "zones"]).to_xarray()
    assert "s" not in bare.dims
    assert math.isnan(bare.friction.item())
    coupled = solve(Scene(0.3, 0.5, 0.5, math.inf, coupling=True), 1e-3).to_xarray()
    assert bool(coupled.coupling)
    assert coupled.ending.item() == "converged"


def test_a_plan_is_short_to_look_at():
    assert repr(plan(ANNULUS)) == (
        "<Plan run: normal contact, full stick; "
        "if needed: partial slip, zone search, slip displacement>"
    )
    assert "why" in text_of(plan(ANNULUS)._repr_html_())
    assert "not computed why" in text_of(plan(Scene(0.3))._repr_html_())


def test_a_scene_as_a_table():
    assert "friction f none" in text_of(Scene(0.3)._repr_html_())
    assert "full stick" in text_of(Scene(0.3, friction=math.inf)._repr_html_())
    steel = text_of(STEEL._repr_html_())
    assert "α* 0.576923" in steel
    assert "α 5e-14 m/Pa" in steel
    assert "P 1000 N" in steel


def test_a_solution_as_tables_and_a_drawing(solution):
    shown = text_of(solution._repr_html_())
    assert "stick radius 0.643143" in shown
    assert "slip from 0.643143 to 0.980518" in shown
    assert "not converged" not in shown
    assert " N " in text_of(solve(STEEL, 1e-3)._repr_html_())
    capped = solve(Scene(0.1, 1e-6), max_unknowns=80, strict=False)
    assert "not converged" in text_of(capped._repr_html_())


def test_gold_as_tables():
    table = gold.table("slip_inside")
    assert "stick, slip, stick" in text_of(table._repr_html_())
    assert str(table.solutions[0].approach) in text_of(table.solutions[0]._repr_html_())


def test_a_solution_in_si_units_prints_as_a_table():
    physical = solve(STEEL, 1e-6).physical
    lines = str(physical).splitlines()
    assert lines[0].split() == ["SI", "value", "error", "estimate"]
    assert lines[1].split() == ["load", "1000", "N", "exact"]
    name, value, unit, _ = lines[2].split()
    assert (name, float(value), unit) == ("approach", pytest.approx(physical.approach, 1e-6), "m")
    assert repr(physical).startswith("<PhysicalSolution load: 1000 N, approach: 1.1")
    assert "1000 N" in text_of(physical._repr_html_())


def test_zones_have_the_same_colours_in_a_notebook_and_in_a_plot(solution):
    pytest.importorskip("matplotlib")
    from matplotlib.colors import to_hex

    drawn = ElementTree.fromstring(zones_svg(solution.zones))
    boxes = drawn.iter("{http://www.w3.org/2000/svg}rect")
    kinds = [zone.kind for zone in solution.zones]
    of_svg = {kind: box.get("fill").lower() for kind, box in zip(kinds, boxes, strict=True)}
    legend = solution.plot().axes[0].get_legend()
    texts = [one.get_text() for one in legend.get_texts()]
    handles = zip(texts, legend.legend_handles, strict=True)
    of_plot = {kind: to_hex(one.get_facecolor()) for kind, one in handles if kind in kinds}
    assert of_svg == of_plot
    assert of_svg["stick"] != of_svg["slip"]


def test_zones_are_drawn_to_scale_and_none_vanishes():
    narrow = gold.table("slip_begins").solutions[1].zones
    drawn = ElementTree.fromstring(zones_svg(narrow)).iter("{http://www.w3.org/2000/svg}rect")
    boxes = [(float(one.get("x")), float(one.get("width"))) for one in drawn]
    assert len(boxes) == len(narrow) == 2
    assert narrow[1].inner_from_edge < 1e-3
    assert boxes[1][1] == 1.5
    assert sum(boxes[1]) == pytest.approx(361.0)
    assert boxes[0][1] == pytest.approx(360.0 * float(narrow[0].outer), abs=0.01)
