"""The figures of the paper, validation/paper: tables, where slip starts, statements, pictures."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import paper
import pytest
from paper_figures import FIGURES, figure_data, paper_figure
from paper_onset import slip_onset
from paper_statements import Statement, statements, statements_table
from paper_tables import PARAMETERS, read_csv, write_csv

from spectral_contact import Scene, solve
from spectral_contact.view import plotting

RTOL = 1e-4
RESULTS = Path(paper.__file__).parent / "results"


@pytest.fixture(scope="module", params=["2", "3", "5"])
def data(request):
    return figure_data(request.param, RTOL)


# --- data -----------------------------------------------------------------------------------------


def test_a_table_has_a_row_for_every_scene_and_radius(data):
    figure = data.figure
    assert data.table.shape == (len(figure.scenes) * 172, len(figure.columns))
    assert not np.isnan(data.table).any()
    assert figure.columns[: len(figure.keys)] == (*PARAMETERS, "s", "one_minus_s")
    for scene, rows in zip(figure.scenes, np.split(data.table, len(figure.scenes)), strict=True):
        assert (rows[:, 0] == scene.poisson_ratio).all()
        assert (rows[:, 3] == scene.friction).all()
    assert (data["s"][0], data["one_minus_s"][171]) == (0.0, 0.0)
    assert np.allclose(data["s"] + data["one_minus_s"], 1.0, rtol=0.0, atol=1e-15)


def test_estimates_are_within_the_tolerance(data):
    name = data.figure.values[0]
    # at a given radius the error of the stick radius comes on top
    assert 0.0 < data.largest_error(name) < 3.0 * RTOL


def test_values_are_those_of_a_solution(data):
    scene = data.figure.scenes[1]
    rows = np.split(data.table, len(data.figure.scenes))[1]
    name = data.figure.values[0]
    assert name == ("pressure" if data.figure.name == "2" else "traction")
    exact = solve(scene, 1e-10)
    assert rows[:, 6] == pytest.approx(
        getattr(exact, name)(from_edge=rows[:, 5]), rel=data.largest_error(name), abs=1e-15
    )


def test_data_cannot_be_changed(data):
    with pytest.raises(ValueError, match="read-only"):
        data.table[0, 0] = 1.0


def test_curves_are_runs_of_rows():
    data = figure_data("5", RTOL)
    curves = dict(data.curves("nu", "f"))
    assert len(curves) == 12
    assert (0.3, np.inf) in curves
    assert sum(len(curve.table) for curve in curves.values()) == len(data.table)
    assert len(list(data.curves("nu"))) == 2


@pytest.mark.parametrize("name", FIGURES)
def test_figures_say_which_parameters_are_the_papers(name):
    figure = paper_figure(name)
    assert figure.given
    assert figure.chosen
    assert len(set(figure.scenes)) == len(figure.scenes)
    row = figure.rows_of(figure.scenes[0], RTOL)
    assert row.shape[1] == len(figure.columns)


# --- where slip starts ----------------------------------------------------------------------------


@pytest.mark.parametrize(("rtol", "known"), [(1e-2, 0.1), (1e-6, 2e-3)])
@pytest.mark.parametrize(
    ("alpha", "beta"), [(0.2, 0.5), (0.05, 1.0), (0.0, 0.5), (1e-3, 1e-2), (1e-14, 3e-14)]
)
def test_slip_that_starts_inside(alpha, beta, rtol, known):
    scene = Scene(0.3, alpha, beta)
    found, truth = slip_onset(scene, rtol), slip_onset(scene, 1e-11)
    assert found.critical_friction > found.edge_ratio
    assert 0.0 < found.from_edge_error < known
    assert abs(found.from_edge / truth.from_edge - 1.0) <= found.from_edge_error
    full = solve(replace(scene, friction=np.inf), 1e-11)
    depths = truth.from_edge * (1.0 + np.linspace(-0.5, 0.5, 101))
    ratios = full.traction(from_edge=depths) / full.pressure(from_edge=depths)
    assert ratios.argmax() == 50
    assert ratios.max() == pytest.approx(truth.critical_friction, rel=1e-10, abs=0)


@pytest.mark.parametrize("beta", [1e-3, 0.2, 0.499, 0.5])
def test_slip_that_starts_at_the_edge(beta):
    found = slip_onset(Scene(0.1, 0.5, beta))
    assert (found.from_edge, found.from_edge_error) == (0.0, 0.0)
    assert found.critical_friction == found.edge_ratio


def test_slip_that_starts_too_near_the_edge_to_be_told_from_it():
    found = slip_onset(Scene(0.1, 5.0, 10.0))
    assert (found.from_edge, found.from_edge_error) == (0.0, np.inf)


def test_the_friction_of_the_scene_does_not_matter():
    one, other = (slip_onset(Scene(0.1, 0.2, 0.5, f)) for f in (None, 0.01))
    assert one == other


# --- tables ---------------------------------------------------------------------------------------


def test_a_table_comes_back_exactly(tmp_path):
    data, path = figure_data("3", RTOL), tmp_path / "figure_3.csv"
    write_csv(path, data)
    again = read_csv(path, data.figure, RTOL)
    assert np.array_equal(again.table, data.table)
    assert np.isinf(again["traction"]).any()  # at a smooth edge
    head = path.read_text(encoding="utf-8").splitlines()[:7]
    assert any("paper's text prints: α* = 0.5, ν = 0.3, β* = 0" in line for line in head)
    assert any("our choice: the other β*" in line for line in head)
    assert head[-1] == "nu,alpha,beta,f,s,one_minus_s,traction,traction_error"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"spectral_contact 0", b"spectral_contact 9"),  # of another version
        (b"# rtol = 0.0001", b"# rtol = 0.001"),
        (b"figure_2", b"figure_3"),
    ],
)
def test_what_is_not_the_table_is_refused(tmp_path, old, new):
    path = tmp_path / "figure_2.csv"
    write_csv(path, figure_data("2", RTOL))
    damaged = path.read_bytes().replace(old, new, 1)
    assert damaged != path.read_bytes()
    path.write_bytes(damaged)
    with pytest.raises(ValueError, match="is not figure 2 of this version"):
        read_csv(path, paper_figure("2"), RTOL)


# --- statements -----------------------------------------------------------------------------------


def test_statements_have_finite_errors_and_both_verdicts():
    found = statements(1e-6)
    assert len(found) > 30
    assert all(one.error >= 0.0 and np.isfinite(one.error) for one in found)
    assert {one.holds for one in found} == {True, False}
    table = statements_table(found).splitlines()
    assert len(table) == len(found) + 2
    assert {line.count("|") for line in table} == {6}


def test_verdicts_do_not_hang_on_the_tolerance():
    loose, tight = statements(1e-4), statements(1e-10)
    assert [one.holds for one in loose] == [one.holds for one in tight]
    for one, truth in zip(loose, tight, strict=True):
        assert one.says == truth.says
        if one.value != truth.value:
            assert abs(one.value - truth.value) <= one.error + truth.error


def test_no_more_digits_are_shown_than_are_known():
    shown = [
        statements_table([Statement("", "", "", value, error, True)]).split("|")[-3].strip()
        for value, error in ((0.123456789, 1e-4), (np.inf, 0.0), (1e-12, 1e-10), (-2.5, 1e-14))
    ]
    assert shown == ["0.1235 ± 1e-04", "∞", "1.0e-12 ± 1e-10", "-2.5 ± 1e-14"]


# --- all of it ------------------------------------------------------------------------------------


def test_the_command_writes_tables_pictures_and_statements(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    folder = tmp_path / "new" / "paper"
    options = ["--output", str(folder), "--figures", "3,2", "--rtol", str(RTOL)]
    monkeypatch.setattr(sys, "argv", ["paper.py", *options])
    paper.main()
    told = capsys.readouterr().out.splitlines()
    names = ["figure_3.csv", "figure_3.png", "figure_2.csv", "figure_2.png", "statements.md"]
    tables = [str(folder / name) for name in ("figure_3.csv", "figure_2.csv")]
    assert [line.partition("  ")[0] for line in told[:2]] == tables
    assert sorted(path.name for path in folder.iterdir()) == sorted(names)
    assert "statements of the paper hold" in told[-1]
    assert read_csv(folder / "figure_2.csv", paper_figure("2"), RTOL).rtol == RTOL


# --- pictures -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results():
    """The committed tables."""
    figures = [paper_figure(name) for name in FIGURES]
    return {one.name: read_csv(RESULTS / f"{one.stem}.csv", one) for one in figures}


@pytest.mark.parametrize(("name", "panels"), list(zip(FIGURES, (1, 1, 1, 2, 2, 3), strict=True)))
def test_pictures_have_labelled_axes_and_say_their_errors(results, name, panels, tmp_path):
    pytest.importorskip("matplotlib")
    from paper_pictures import draw

    figure = draw(results[name])
    assert len(figure.axes) == panels
    assert all(axes.get_xlabel() and axes.get_ylabel() for axes in figure.axes)
    note = figure.get_supxlabel()
    assert "Largest estimates of relative errors: " in note
    assert "Our choice: " in note
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.texts]
    boxes += [axes.get_tightbbox() for axes in figure.axes]
    for box in boxes:  # nothing is cut off
        assert min(box.x0, box.y0) >= 0.0
        assert box.x1 <= figure.bbox.width
        assert box.y1 <= figure.bbox.height
    plotting.save(figure, str(tmp_path / "figure.png"))


def test_curves_of_a_family_differ_in_grey(results):
    pytest.importorskip("matplotlib")
    from paper_pictures import draw

    [axes] = draw(results["2"]).axes
    lines = axes.get_lines()
    assert len(lines) == 6
    assert len({str(line._dash_pattern) for line in lines}) == 6
    grey = [np.dot(line.get_color()[:3], (0.299, 0.587, 0.114)) for line in lines]
    assert (np.diff(grey) > 0.03).all()
    assert max(grey) < 0.8
