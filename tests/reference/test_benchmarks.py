"""The benchmarks to cite: whole, and right by the solver, closed forms and gold tables."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, benchmarks, closed_forms, gold, solve

BENCHMARKS = {name: benchmarks.load(name) for name in benchmarks.names()}
READERS = {
    "stiffness_ratio": lambda found: 0.125 / found.approach,
    "edge_pressure": lambda found: found.pressure(from_edge=0.0),
    "slip_from": lambda found: found.zones[1].inner,
    "slip_to": lambda found: found.zones[1].outer,
}


@pytest.fixture(scope="module")
def solutions():
    """Return the solutions that were asked for so far, by name."""
    found = {}

    def solution(name):
        if name not in found:
            found[name] = solve(BENCHMARKS[name].scene, 1e-10)
        return found[name]

    return solution


def read(quantity, found):
    return READERS.get(quantity, lambda one: getattr(one, quantity))(found)


def test_there_are_ten():
    assert len(BENCHMARKS) == 10


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_numbers_are_those_of_the_solver(name, solutions):
    one = BENCHMARKS[name]
    for number in (one.check, *one.values):
        assert read(number.quantity, solutions(name)) == pytest.approx(number.value, rel=1e-10)
        assert len(number.text.replace(".", "").lstrip("0")) >= 12 or number.where == "closed form"


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_fields_are_those_of_the_solver(name, solutions):
    fields, solution = BENCHMARKS[name].fields(), solutions(name)
    d = fields["one_minus_s"]
    assert np.allclose(fields["s"], 1.0 - d, rtol=0.0, atol=1e-12)
    assert (np.diff(d) < 0.0).all()
    d, s = d[d > 0.0], fields["s"][d > 0.0]
    fields = {name: column[: len(d)] for name, column in fields.items()}
    size = np.hypot(fields["p"], fields.get("q", 0.0))
    for column, evaluate in (("p", solution.pressure), ("q", solution.traction)):
        if column in fields:
            here = np.where(d <= 0.5, evaluate(from_edge=d), evaluate(s))
            scale = size if solution.scene.coupling else np.abs(here)
            assert (np.abs(fields[column] - here) <= 1e-10 * scale).all()
    if "slip" in fields:
        here = np.where(d <= 0.5, solution.slip(from_edge=d), solution.slip(s))
        assert np.allclose(fields["slip"], here, rtol=0.0, atol=1e-10 * np.abs(here).max())


def test_the_smooth_punches_have_closed_forms():
    assert BENCHMARKS["smooth_normal"].check.value == closed_forms.smooth_approach() == 0.125
    shear = closed_forms.full_stick_shear(0.3)
    assert BENCHMARKS["smooth_stick"].check.value == pytest.approx(shear, rel=1e-15)
    scene = BENCHMARKS["smooth_partial_slip"].scene
    radius = closed_forms.stick_radius(0.3, scene.friction).radius
    assert BENCHMARKS["smooth_partial_slip"].check.value == pytest.approx(radius, rel=1e-15)


def test_the_rough_punches_are_gold():
    by_scene = {one.scene: one for table in gold.tables() for one in table.solutions}
    both = 0
    for one in BENCHMARKS.values():
        entry = by_scene.get(one.scene)
        for number in (one.check, *one.values):
            if entry is not None and number.quantity in ("approach", "total_shear", "stick_radius"):
                truth = float(getattr(entry, number.quantity))
                assert number.value == pytest.approx(truth, rel=1e-15)
                both += 1
    assert both >= 5


def test_the_stiffness_of_coupled_punches():
    table = {
        (one.poisson_ratio, one.friction): one.value
        for one in BENCHMARKS["partial_slip_coupled"].stiffness
    }
    assert len(table) == 25
    published = {0.1: 1.01609466, 0.3: 1.04560025, math.inf: 1.07495038}
    for friction, ratio in published.items():
        assert table[0.1, friction] == pytest.approx(ratio, abs=5.1e-9)
    for (nu, friction), ratio in table.items():
        if friction == math.inf:
            exact = 0.125 / closed_forms.coupled_approach(nu)
            assert ratio == pytest.approx(exact, rel=1e-14)
        assert 1.0 < ratio <= table[nu, math.inf]
    found = solve(Scene(0.4, friction=0.2, coupling=True), 1e-8, ["approach"])
    assert 0.125 / found.approach == pytest.approx(table[0.4, 0.2], rel=1e-8)
