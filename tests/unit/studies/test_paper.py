import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, SolutionFileError, solve
from spectral_contact.__main__ import main
from spectral_contact.studies.paper import (
    FIGURES,
    PARAMETERS,
    SlipOnset,
    figure_data,
    read_csv,
    reproduce,
    slip_onset,
    statements,
)
from spectral_contact.studies.paper import run as run_module
from spectral_contact.studies.paper.figures import paper_figure
from spectral_contact.studies.paper.statements import Statement, statements_table
from spectral_contact.studies.paper.tables import complete_csv
from spectral_contact.view import plotting

RTOL = 1e-4
SMALL = ("2", "3", "5")


class Stopped(BaseException):
    """What ends a run from outside."""


@pytest.fixture(scope="module", params=SMALL)
def data(request):
    return figure_data(request.param, RTOL)


def complete(folder, figure, rtol=RTOL):
    """Complete the table of a figure; return it with the scenes kept, and computed."""
    computed = []

    def measure(scene, rtol):
        computed.append(scene)
        return figure.measure(scene, rtol)

    path = folder / f"{figure.stem}.csv"
    data, kept = complete_csv(path, replace(figure, measure=measure), rtol, lambda: None)
    return data, kept, computed


def stopped_at(figure, count):
    """Return the figure, whose computation is stopped after some scenes."""
    left = [count]

    def measure(scene, rtol):
        if not left[0]:
            raise Stopped
        left[0] -= 1
        return figure.measure(scene, rtol)

    return replace(figure, measure=measure)


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
    with pytest.raises(SceneError, match=r"column = 'radius': must be one of nu, alpha"):
        data["radius"]


@pytest.mark.parametrize("name", FIGURES)
def test_figures_say_which_parameters_are_the_papers(name):
    figure = paper_figure(name)
    assert figure.given
    assert figure.chosen
    assert len(set(figure.scenes)) == len(figure.scenes)
    row = figure.rows_of(figure.scenes[0], RTOL)
    assert row.shape[1] == len(figure.columns)


@pytest.mark.parametrize("name", ["1", 2, None, ["2"]])
def test_unknown_figures_are_refused(name):
    with pytest.raises(SceneError, match=r"name = .*: must be one of 2, 3, 4, 5, 6, onset"):
        figure_data(name)


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
    assert isinstance(one, SlipOnset)
    assert one == other


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (Scene(0.5, 0.5, 0.5), "poisson_ratio = 0.5: must be below 0.5"),
        (Scene(0.3, 0.5), "tangential_compliance = 0.0: must be > 0"),
        (Scene(0.3), "tangential_compliance = 0.0: must be > 0"),
    ],
)
def test_scenes_without_an_onset_are_refused(scene, words):
    with pytest.raises(SceneError) as caught:
        slip_onset(scene)
    assert str(caught.value).startswith(words)


# --- tables ---------------------------------------------------------------------------------------


def test_a_table_comes_back_exactly(tmp_path):
    figure = paper_figure("3")
    data, kept, computed = complete(tmp_path, figure)
    assert (kept, len(computed)) == (0, 5)
    again = read_csv(tmp_path / "figure_3.csv", "3", RTOL)
    assert np.array_equal(again.table, data.table)
    assert np.isinf(again["traction"]).any()  # at a smooth edge
    head = (tmp_path / "figure_3.csv").read_text(encoding="utf-8").splitlines()[:7]
    assert any("paper's text prints: α* = 0.5, ν = 0.3, β* = 0" in line for line in head)
    assert any("our choice: the other β*" in line for line in head)
    assert head[-1] == "nu,alpha,beta,f,s,one_minus_s,traction,traction_error"


def test_a_finished_table_is_kept(tmp_path):
    figure = paper_figure("3")
    complete(tmp_path, figure)
    before = (tmp_path / "figure_3.csv").read_bytes()
    _, kept, computed = complete(tmp_path, figure)
    assert (kept, computed) == (5, [])
    assert (tmp_path / "figure_3.csv").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["figure_3.csv"]


@pytest.mark.parametrize(("places", "kept"), [(1, 5), (10**4, 0)])
def test_places_of_another_numpy_differ_in_their_last_bit(tmp_path, places, kept):
    figure = paper_figure("3")
    complete(tmp_path, figure)
    path = tmp_path / "figure_3.csv"
    place = figure.keys_of(figure.scenes[0])[-2, 5]
    old = b",%s," % repr(float(place)).encode()
    new = b",%s," % repr(float(place + places * np.spacing(place))).encode()
    assert old in path.read_bytes()
    path.write_bytes(path.read_bytes().replace(old, new))
    assert complete(tmp_path, figure)[1] == kept
    assert (new in path.read_bytes()) == (kept == 5)  # a row keeps the place that it is of


@pytest.mark.parametrize(("cut", "lost"), [(0, 0), (5, 1), (20_000, 2)])
def test_a_stopped_run_goes_on(tmp_path, cut, lost):
    figure = paper_figure("2")
    whole, _, _ = complete(tmp_path, figure)
    expected = (tmp_path / "figure_2.csv").read_bytes()
    (tmp_path / "figure_2.csv").unlink()
    with pytest.raises(Stopped):
        complete(tmp_path, stopped_at(figure, 4))
    partial = tmp_path / "figure_2.csv.partial"
    partial.write_bytes(partial.read_bytes()[: -cut or None])
    data, kept, computed = complete(tmp_path, figure)
    assert kept == 4 - lost
    assert computed == list(figure.scenes[kept:])
    assert np.array_equal(data.table, whole.table)
    assert (tmp_path / "figure_2.csv").read_bytes() == expected
    assert not partial.exists()


@pytest.mark.parametrize(
    ("old", "new", "kept"),
    [
        (b"spectral_contact 0", b"spectral_contact 9", 0),  # of another version
        (b"# rtol = 0.0001", b"# rtol = 0.001", 0),
        (b"0.3,0.05,0.0,", b"0.3,0.06,0.0,", 1),  # another scene
        (b"\n0.3,0.05,", b"\nnan,0.05,", 1),
        (b"\n0.3,0.05,0.0,", b"\n0.3,0.05,", 1),  # a cell too few
        (b"\n0.3,0.05,", b"\nrubbish,0.05,", 1),
    ],
)
def test_what_is_not_ours_is_computed_anew(tmp_path, old, new, kept):
    figure = paper_figure("2")
    complete(tmp_path, figure)
    path = tmp_path / "figure_2.csv"
    expected = path.read_bytes()
    damaged = expected.replace(old, new, 1)
    assert damaged != expected
    path.write_bytes(damaged)
    with pytest.raises(SolutionFileError, match="is not the whole figure 2 of this version"):
        read_csv(path, "2", RTOL)
    path.rename(tmp_path / "figure_2.csv.partial")
    assert complete(tmp_path, figure)[1] == kept
    assert path.read_bytes() == expected


def test_a_killed_command_loses_at_most_one_scene(tmp_path):
    command = [sys.executable, "-m", "spectral_contact", "paper", "--figures", "4"]
    options = ["--output", str(tmp_path), "--no-pictures", "--rtol", str(RTOL)]
    partial = tmp_path / "figure_4.csv.partial"
    with subprocess.Popen([*command, *options], stdout=subprocess.DEVNULL) as process:
        patience = monotonic() + 60.0
        while not (partial.exists() and partial.read_bytes().count(b"\n") > 20):
            assert process.poll() is None
            assert monotonic() < patience
            sleep(0.002)
        process.kill()
    there = partial.read_bytes().count(b"\n") - 7
    figure = paper_figure("4")
    _, kept, computed = complete(tmp_path, figure)
    assert 10 < there < len(figure.scenes)
    assert kept == there
    assert computed == list(figure.scenes[kept:])


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


def test_a_folder_with_tables_pictures_and_statements(tmp_path):
    pytest.importorskip("matplotlib")
    steps = []
    folder = tmp_path / "new" / "paper"
    made = reproduce(
        folder, ["3", "2", "3"], rtol=RTOL, progress=lambda step, share: steps.append((step, share))
    )
    names = ["figure_3.csv", "figure_3.png", "figure_2.csv", "figure_2.png", "statements.md"]
    assert [path.name for path, _ in made.files] == names
    assert sorted(path.name for path in folder.iterdir()) == sorted(names)
    assert [data.figure.name for data in made.figures] == ["3", "2"]
    assert str(made).count("\n") == 4
    shares = [share for _, share in steps]
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert len(steps) == 5 + 1 + 6 + 1 + 2
    again = reproduce(folder, ["3"], rtol=RTOL)
    assert "(5 of 5 scenes were there)" in str(again)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"figures": "23"}, "figures = '23': must be a list of names, not one string"),
        ({"figures": 2}, "figures = 2: must be a list of names"),
        ({"figures": ["2", "7"]}, "figures = '7': must be one of 2, 3, 4, 5, 6, onset"),
        ({"rtol": 0.5}, "rtol = 0.5: must be in [1e-13, 1e-2]"),
    ],
)
def test_bad_requests_are_refused_before_anything_is_made(tmp_path, options, words):
    with pytest.raises(SceneError) as caught:
        reproduce(tmp_path / "paper", **options)
    assert str(caught.value) == words
    assert list(tmp_path.iterdir()) == []


def test_without_matplotlib_there_are_tables(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"matplotlib is not installed: run  pip install"):
        reproduce(tmp_path / "paper", ["2"], rtol=RTOL)
    assert list(tmp_path.iterdir()) == []
    made = reproduce(tmp_path / "paper", ["2"], rtol=RTOL, pictures=False)
    assert [path.name for path, _ in made.files] == ["figure_2.csv", "statements.md"]


# --- command line ---------------------------------------------------------------------------------


def complaint(capsys, *options):
    status = main(["paper", *options])
    out, err = capsys.readouterr()
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("spectral-contact: ")
    return err


def test_the_command_says_what_it_has_written(capsys, tmp_path):
    options = ("--output", str(tmp_path), "--figures", "2", "--rtol", "1e-3", "--no-pictures")
    assert main(["paper", *options]) == 0
    out, err = capsys.readouterr()
    assert err == ""  # no terminal, no progress
    assert out.startswith(str(tmp_path / "figure_2.csv"))
    assert "statements of the paper hold" in out
    assert read_csv(tmp_path / "figure_2.csv", "2", 1e-3).figure is paper_figure("2")


def test_progress_is_shown_on_a_terminal(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    options = ("--output", str(tmp_path), "--figures", "2", "--rtol", "1e-3", "--no-pictures")
    assert main(["paper", *options]) == 0
    err = capsys.readouterr().err
    assert "100 %" in err
    assert "figure 2" in err
    assert err.rpartition("\r")[2].strip() == ""  # the line is gone


def test_an_interrupt_clears_the_line_of_progress(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(run_module, "statements", interrupted)
    options = ("--output", str(tmp_path), "--figures", "2", "--rtol", "1e-3", "--no-pictures")
    assert main(["paper", *options]) == 130
    assert capsys.readouterr().err.endswith("\rspectral-contact: interrupted\n")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "--output"),
        (("--output", "x", "--figures", "7"), "--figures: invalid choice: '7'"),
        (("--output", "x", "--figures"), "--figures: expected at least one argument"),
        (("--output", "x", "--rtol", "1"), "--rtol = 1.0: must be in"),
        (("--output", "x", "--rtol", "tight"), "--rtol: 'tight' is not a number"),
        (("--output", __file__), "test_paper.py: cannot be written"),
    ],
)
def test_bad_input_is_one_line(capsys, tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    assert words in complaint(capsys, *options)
    assert list(tmp_path.iterdir()) == []


def test_a_table_that_cannot_be_written(capsys, tmp_path):
    (tmp_path / "figure_2.csv.partial").mkdir()
    err = complaint(capsys, "--output", str(tmp_path), "--figures", "2", "--no-pictures")
    assert "figure_2.csv" in err


# --- pictures -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results():
    """The committed tables."""
    folder = Path(__file__).parents[3] / "validation" / "results" / "paper"
    return {name: read_csv(folder / f"{paper_figure(name).stem}.csv", name) for name in FIGURES}


@pytest.mark.parametrize(("name", "panels"), list(zip(FIGURES, (1, 1, 1, 2, 2, 3), strict=True)))
def test_pictures_have_labelled_axes_and_say_their_errors(results, name, panels, tmp_path):
    pytest.importorskip("matplotlib")
    from spectral_contact.studies.paper.pictures import draw

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
    from spectral_contact.studies.paper.pictures import draw

    [axes] = draw(results["2"]).axes
    lines = axes.get_lines()
    assert len(lines) == 6
    assert len({str(line._dash_pattern) for line in lines}) == 6
    grey = [np.dot(line.get_color()[:3], (0.299, 0.587, 0.114)) for line in lines]
    assert (np.diff(grey) > 0.03).all()
    assert max(grey) < 0.8
