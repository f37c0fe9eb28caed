"""Figures of studies: what is drawn is what was measured, labelled and apart in grey."""

import math
import sys
from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import MissingDependencyError, Scene, SolutionFileError
from spectral_contact.studies import (
    Convergence,
    Point,
    Times,
    Timing,
    WorkPrecision,
    this_machine,
)

pytest.importorskip("matplotlib")

SCENE, OTHER = Scene(0.1, 0.5), Scene(0.2, 1e-4)
COUNTS = (10, 20, 40, 80)


def times(median, cold=True):
    warm = Timing(median, 0.9 * median, 1.2 * median, 5)
    return Times(warm, Timing(3 * median, 2 * median, 4 * median, 3) if cold else None)


def point(solver, scene, count, *, cold=True):
    errors = {"approach": count**-2.0, "pressure": 1.0 / count}
    return Point(solver, scene, count, count, errors, {}, times(1e-4 * count, cold))


def convergence(**change):
    points = tuple(point("mine", SCENE, count) for count in COUNTS)
    one = Convergence("mine", SCENE, "gold", {}, ("approach", "pressure"), points, this_machine())
    return replace(one, **change)


def comparison():
    points = tuple(
        point(name, scene, count, cold=name == "ours")
        for name in ("ours", "theirs")
        for scene in (SCENE, OTHER)
        for count in COUNTS
    )
    return WorkPrecision(
        ("ours", "theirs"),
        (SCENE, OTHER),
        ("gold", "gold"),
        (1e-2, 1e-3),
        ("approach", "pressure"),
        points,
        this_machine(),
    )


def texts(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_study_without_unknowns_is_drawn(tmp_path):
    unknown = tuple(replace(one, unknowns=None) for one in convergence().points)
    failed = tuple(replace(one, errors={}, times=None, failure="E") for one in unknown)
    for k, points in enumerate((unknown, failed)):
        convergence(points=points).plot(tmp_path / f"{k}.png")
        assert (tmp_path / f"{k}.png").stat().st_size > 1000


def test_errors_over_unknowns_and_times():
    figure = convergence().plot()
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert labels == ["unknowns $N$", "time [ms]"]
    assert figure.axes[0].get_ylabel() == "true relative error"
    assert {axes.get_yscale() for axes in figure.axes} == {"log"}
    drawn = {
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]))
        for line in figure.axes[0].get_lines()
        if len(line.get_xdata()) == 1
    }
    assert drawn == {(n, n**-2.0) for n in COUNTS} | {(n, 1.0 / n) for n in COUNTS}
    warm = figure.axes[1].containers[0].lines[0]
    assert np.allclose(warm.get_xdata(orig=False), [0.1 * n for n in COUNTS])
    assert np.allclose(warm.get_ydata(orig=False), [n**-2.0 for n in COUNTS])


def test_the_laws_are_in_the_legend():
    approach, pressure = texts(convergence().plot())
    assert approach.startswith(r"approach $\delta^*$: order 2.000 [2.000, 2.000]")
    assert pressure.startswith("pressure $p^*$, worst point: ")


def test_points_without_a_part_in_the_rate_are_open():
    points = [point("mine", SCENE, count) for count in (*COUNTS, 160)]
    points[-1] = replace(points[-1], errors={"approach": 1e-17, "pressure": 0.0})
    figure = convergence(points=tuple(points)).plot()
    faces = [
        (line.get_xdata()[0], line.get_markerfacecolor())
        for line in figure.axes[0].get_lines()
        if len(line.get_xdata()) == 1
    ]
    assert {x for x, face in faces if face == "white"} == {160}
    drawn = [y for line in figure.axes[0].get_lines() for y in line.get_ydata()]
    assert min(drawn) == 1e-16  # doubles know no smaller error; the picture says so
    assert figure.axes[0].get_ylabel().endswith("$10^{-16}$ where it is less")


def test_without_times_there_is_one_panel():
    points = tuple(replace(p, times=None) for p in convergence().points)
    assert len(convergence(points=points).plot().axes) == 1


def test_failures_and_infinite_errors_are_left_out(tmp_path):
    points = list(convergence().points)
    points[1] = replace(points[1], errors={"approach": math.inf})
    points[2] = replace(points[2], errors={}, times=None, failure="ValueError")
    figure = convergence(points=tuple(points)).plot(tmp_path / "x.png")
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")
    assert {
        line.get_xdata()[0] for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 1
    } == {10, 80}


def test_a_row_for_each_scene_and_a_panel_for_each_quantity():
    figure = comparison().plot()
    assert [axes.get_title() for axes in figure.axes] == 2 * [
        r"approach $\delta^*$",
        "pressure $p^*$, worst point",
    ]
    assert {axes.get_xlabel() for axes in figure.axes} == {"time [ms]"}
    assert texts(figure) == ["ours", "theirs"]


def test_nine_solvers_look_different():
    names = tuple(f"solver {i}" for i in range(9))
    points = tuple(point(name, SCENE, count) for name in names for count in COUNTS)
    figure = replace(comparison(), solvers=names, scenes=(SCENE,), points=points).plot()
    curves = [bars.lines[0] for bars in figure.axes[0].containers]
    assert len({(curve.get_marker(), curve.get_color()) for curve in curves}) == 9


@pytest.mark.parametrize("make", [convergence, comparison])
def test_no_text_lies_on_another(make):
    """Tick labels, axis labels, titles and the legend, in one figure, must not overlap."""
    figure = make().plot()
    figure.draw_without_rendering()
    boxes = [legend.get_window_extent() for legend in figure.legends]
    for axes in figure.axes:
        left, right = axes.get_window_extent().intervalx
        boxes += [
            part.get_window_extent()
            for part in (axes.xaxis.label, axes.yaxis.label, axes.title)
            if part.get_text()
        ]
        ticks = [
            text.get_window_extent()
            for text in axes.get_xticklabels(which="both")
            if text.get_text()
        ]
        # there are labels for ticks beyond the ends, too, which are not drawn
        boxes += [box for box in ticks if left - 1 <= np.mean(box.intervalx) <= right + 1]
    for i, one in enumerate(boxes):
        assert one.x0 >= 0.0
        assert one.x1 <= figure.bbox.x1
        assert not [other for other in boxes[i + 1 :] if one.overlaps(other)]


def test_files_and_missing_matplotlib(tmp_path, monkeypatch):
    with pytest.raises(SolutionFileError, match="suffix"):
        convergence().plot(tmp_path / "x.bmp")
    with pytest.raises(SolutionFileError, match="not a path"):
        convergence().plot(3)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingDependencyError, match="plot"):
        convergence().plot()
