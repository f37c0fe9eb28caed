"""The committed figures of the paper: against gold, closed forms, today's library and its text."""

import math
from pathlib import Path

import numpy as np
import pytest
from paper_figures import FIGURES, paper_figure
from paper_statements import statements, statements_table
from paper_tables import read_csv

from spectral_contact import closed_forms, gold

RESULTS = Path(__file__).parents[2] / "validation" / "paper" / "results"
GOLD = {
    one.scene: one for table in gold.tables() for one in table.solutions if not one.scene.coupling
}
EPS = 2.0**-52


@pytest.fixture(scope="module")
def tables():
    figures = [(name, paper_figure(name)) for name in FIGURES]
    return {name: read_csv(RESULTS / f"{one.stem}.csv", one) for name, one in figures}


@pytest.fixture(scope="module")
def found():
    return statements()


def measured(found, words):
    [one] = [one for one in found if words in f"{one.says}; {one.measured}"]
    return one


def rows_of(data, nu, alpha, beta, f):
    [rows] = [
        t for key, t in data.curves("nu", "alpha", "beta", "f") if key == (nu, alpha, beta, f)
    ]
    return rows


# --- today's library ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FIGURES)
def test_tables_hold_today(tables, name):
    data = tables[name]
    figure = data.figure
    scenes = figure.scenes if figure.radial else figure.scenes[:: len(figure.scenes) // 20]
    columns = [figure.columns.index(value) for value in figure.values]
    for scene in scenes:
        today = figure.rows_of(scene, data.rtol)
        then = rows_of(data, *today[0, :4]).table
        for i in columns:
            kept, value, error = then[:, i], today[:, i], today[:, i + 1] + then[:, i + 1]
            differs = kept != value  # at a smooth edge both are infinite
            difference = np.abs(kept[differs] - value[differs])
            assert (difference <= error[differs] * np.abs(value[differs])).all()


def test_statements_hold_today(found):
    kept = (RESULTS / "statements.md").read_text(encoding="utf-8")
    verdicts = [line.rsplit("|", 2)[1] for line in kept.splitlines()]
    assert verdicts == [line.rsplit("|", 2)[1] for line in statements_table(found).splitlines()]


# --- against numbers from elsewhere ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "field", "scene"),
    [
        ("2", "pressure", (0.3, 0.1, 0.0, 0.0)),
        ("2", "pressure", (0.1, 0.5, 0.0, 0.0)),
        ("2", "pressure", (0.45, 1.0, 0.0, 0.0)),
        ("5", "traction", (0.1, 0.5, 0.5, 0.1)),
        ("5", "traction", (0.1, 0.5, 0.5, math.inf)),
    ],
)
def test_curves_agree_with_gold(tables, name, field, scene):
    """The pressure does not depend on Poisson's ratio, which is 0.3 in Figure 2."""
    rows = rows_of(tables[name], *((0.3, *scene[1:]) if name == "2" else scene))
    [truth] = [
        one
        for key, one in GOLD.items()
        if (key.poisson_ratio, key.normal_compliance) == scene[:2]
        and key.profile is None
        and key.unloaded_to == 1.0
        and (name == "2") == (key.friction is None)
        and (name == "2" or (key.tangential_compliance, key.friction) == scene[2:])
    ]
    exact = {float(point.from_edge): float(getattr(point, field)) for point in truth.points}
    compared = 0
    for depth, value, error in zip(
        rows["one_minus_s"], rows[field], rows[f"{field}_error"], strict=True
    ):
        if depth in exact:
            assert abs(value - exact[depth]) <= (error + EPS) * abs(exact[depth])
            compared += 1
    assert compared >= 8
    if name == "5":
        c = float(truth.zones[0].outer)
        assert abs(rows["stick_radius"][0] - c) <= rows["stick_radius_error"][0] * c


def test_scalars_agree_with_gold(tables):
    truth = next(one for key, one in GOLD.items() if key.friction == 0.1 and one.total_shear > 0.08)
    row = rows_of(tables["6"], 0.1, 0.5, 0.5, 0.1)
    for name, value in (
        ("stick_radius", float(truth.zones[0].outer)),
        ("total_shear", float(truth.total_shear)),
    ):
        assert abs(row[name][0] / value - 1.0) <= row[f"{name}_error"][0]
    truth = next(
        one
        for key, one in GOLD.items()
        if (key.normal_compliance, key.tangential_compliance) == (0.05, 1.0)
        and key.friction == math.inf
    )
    row = rows_of(tables["4"], 0.3, 0.05, 1.0, math.inf)
    assert abs(row["edge_ratio"][0] / float(truth.edge_ratio) - 1.0) <= row["edge_ratio_error"][0]


def test_the_smooth_pressure_of_figure_2_is_exact(tables):
    rows = rows_of(tables["2"], 0.3, 0.0, 0.0, 0.0)
    exact = closed_forms.smooth_pressure(from_edge=rows["one_minus_s"])
    assert rows["pressure"] == pytest.approx(exact, rel=4 * EPS, abs=0)


def test_edge_ratios_are_proportional_to_kappa(tables):
    data = tables["4"]
    nu = data["nu"]
    kappa = (1.0 - 2.0 * nu) / (4.0 * (1.0 - nu))
    for _, rows in data.curves("alpha", "beta"):
        ratio = rows["edge_ratio"][:-1] / kappa[:50]
        assert ratio == pytest.approx(ratio[0], rel=1e-12, abs=0)
        assert rows["edge_ratio"][-1] == 0.0  # nu = 1/2
    [(_, equal)] = [one for one in data.curves("alpha", "beta") if one[0] == (0.5, 0.5)]
    assert equal["edge_ratio"][0] * 4.0 == pytest.approx(0.70712820393025, rel=1e-13, abs=0)


# --- where slip starts ----------------------------------------------------------------------------


def test_slip_starts_inside_if_and_only_if_beta_is_larger(tables):
    data = tables["onset"]
    inside = data["from_edge"] > 0.0
    larger = data["beta"] > data["alpha"]
    hidden = np.isinf(data["from_edge_error"])
    assert not (inside & ~larger).any()
    assert ((inside | hidden) == larger).all()
    assert 700 < inside.sum() < larger.sum()
    excess = data["critical_friction"] / data["edge_ratio"] - 1.0
    assert excess[hidden].max() < 1e-9 < excess[inside].max()
    noise = data["critical_friction_error"] + data["edge_ratio_error"]
    assert (excess[~larger] <= noise[~larger]).all()


def test_critical_friction_falls_with_the_tangential_compliance(tables):
    critical = tables["onset"]["critical_friction"].reshape(41, 41)
    assert (np.diff(critical, axis=1) < 0.0).all()


def test_the_place_follows_the_expansion_at_the_edge(tables):
    """For beta near alpha: ln y = c D**-1 - 1, D = (1/alpha - 1/beta)/(4 pi); excess = y D."""
    data = tables["onset"]
    near = (data["from_edge"] > 0.0) & (data["from_edge"] < 1e-5)
    y = 2.0 * data["from_edge"][near]
    slope = (1.0 / data["alpha"][near] - 1.0 / data["beta"][near]) / (4.0 * np.pi)
    excess = data["critical_friction"][near] / data["edge_ratio"][near] - 1.0
    assert near.sum() >= 10
    assert excess == pytest.approx(y * slope, rel=2e-2, abs=0)


# --- what the paper says --------------------------------------------------------------------------


def test_the_digits_that_the_paper_prints_are_not_those_of_its_equations(found):
    """0.255, to the three digits printed: neither the edge criterion nor the true onset."""
    for words, nu in (
        ("ν at which the edge ratio is f", 0.24534731356661),
        ("ν from which on everything sticks", 0.24675447005),
    ):
        one = measured(found, words)
        assert one.value == pytest.approx(nu, rel=0, abs=1e-11)
        assert one.error < 1e-12
        assert round(one.value, 3) != 0.255
        assert not one.holds


@pytest.mark.parametrize(
    ("words", "value"),
    [
        ("p*(1), α* = 0.5", 0.37980995507974310),
        ("q/p at the edge, α* = 0.5, β* = 0.5", 0.70712820393025 / 7.0),
        ("q/p at the edge, α* = 0.5, β* = 1.0", 0.38201587521852 / 7.0),
        ("the least such f, α* = β* = 0.5, ν = 0.0", 0.70712820393025 / 4.0),
        ("smooth full stick, ν = 0 ", 8.0 * 0.1137799033283546742 - 1.0),
        ("smooth full stick, ν = 0.3", 8.0 * 0.12152125200129548574 - 1.0),
    ],
)
def test_numbers_known_from_elsewhere(found, words, value):
    one = measured(found, words)
    assert abs(one.value - value) <= max(one.error, 1e-13 * abs(value))


@pytest.mark.parametrize(
    "words",
    [
        "slip must occur for 0 < ν < 0.255",
        "the displacement u_r > 0 in slip",
        "β* = 0.1, 0",
        "largest ratio of q*(s) at one f to that at the next larger one, f = 0.02, 0.04, …, 0.1, "
        "α* = β* = 0.5, ν = 0.1",
        "annulus next to the edge that sticks",
    ],
)
def test_what_the_paper_says_and_its_equations_do_not(found, words):
    assert not measured(found, words).holds
