import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import (
    ErrorEstimates,
    MissingDependencyError,
    NotComputedError,
    Scene,
    SceneError,
    SolutionFileError,
    plan,
    profiles,
    solve,
)
from spectral_contact.view import plotting

matplotlib = pytest.importorskip("matplotlib")
from matplotlib.figure import Figure  # noqa: E402

STUCK = Scene(0.1, 0.5, 0.5, np.inf)
SLIPPING = Scene(0.1, 0.5, 0.5, 0.1)
FRICTIONLESS = Scene(0.1, 0.5)
SMOOTH = Scene(0.1, friction=np.inf)


@pytest.fixture(scope="module")
def slipping():
    return solve(SLIPPING, 1e-4)


def lines(axes):
    """Return the named curves of a panel."""
    return {
        line.get_label(): np.array(line.get_data())
        for line in axes.get_lines()
        if not line.get_label().startswith("_")
    }


# --- radii ----------------------------------------------------------------------------------------


def test_radii_go_from_the_centre_to_the_edge_through_every_boundary(slipping):
    radii = plotting.graded_radii(slipping)
    assert (radii.s[0], radii.from_edge[-1]) == (0.0, 0.0)
    assert (np.diff(radii.s) >= 0.0).all()
    assert (np.diff(radii.from_edge) < 0.0).all()
    assert radii.inner.max() < 0.5
    assert radii.outer.max() <= 0.5
    assert slipping.zones[0].outer_from_edge in radii.outer
    pressure = radii.evaluate(slipping.pressure)
    assert pressure.shape == radii.s.shape
    assert pressure[-1] == pytest.approx(slipping.pressure(from_edge=0.0), rel=1e-14)


def test_radii_reach_into_the_edge_layer():
    solution = solve(Scene(0.1, 1e-12), 1e-2)
    outer = plotting.graded_radii(solution).outer
    assert 0.0 < outer[outer > 0.0].min() <= 1e-14


# --- the figure of a solution ---------------------------------------------------------------------


def test_axes_have_symbols_and_units(slipping):
    figure = plotting.plot_solution(slipping)
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    radius, distance = "radius $s = r / a$", "distance from the edge $1 - s$"
    pressure, traction = "$p^* = a^2 p / P$", "$q^* = a^2 q / P$"
    slip = r"$u_r^* = a E u_r / (4 (1 - \nu^2) P)$"
    assert labels == [
        (radius, pressure),
        (distance, pressure),
        (radius, traction),
        (distance, traction),
        (radius, slip),
        (distance, slip),
        ("estimate of the relative error", ""),
    ]
    assert [axes.get_xscale() for axes in figure.axes] == ["linear", "log"] * 3 + ["log"]


def test_curves_are_the_values_of_the_solution(slipping):
    figure = plotting.plot_solution(slipping)
    over_radius, over_distance = lines(figure.axes[0]), lines(figure.axes[1])
    s, p = over_radius["$p^*$"]
    assert np.allclose(p, slipping.pressure(s), rtol=1e-12)
    d, p = over_distance["$p^*$"]
    assert np.allclose(p, slipping.pressure(from_edge=d), rtol=1e-12)
    tractions = lines(figure.axes[3])
    d, q = tractions["$q^*$"]
    assert np.allclose(q, slipping.traction(from_edge=d), rtol=1e-9)
    d, bound = tractions["$f p^*$"]
    assert np.allclose(bound, 0.1 * slipping.pressure(from_edge=d), rtol=1e-12)
    assert set(lines(figure.axes[2])) == {"$q^*$", "$f p^*$"}
    d, slip = lines(figure.axes[5])["slip $u_r^*$"]
    assert slip.min() < -0.01
    assert np.allclose(slip, slipping.slip(from_edge=d), rtol=1e-9, atol=1e-15)


def test_what_is_cut_off_at_the_edge_is_said(slipping):
    def notes(solution):
        return [text.get_text() for text in plotting.plot_solution(solution).axes[0].texts]

    assert notes(slipping) == []
    assert notes(solve(SMOOTH, 1e-4)) == ["cut off: infinite at the edge"]
    thin = solve(Scene(0.1, 1e-6), 1e-4)
    assert notes(thin) == [f"cut off: up to {thin.pressure(1.0):.3g} at the edge"]


def test_what_is_cut_off_below_is_said():
    solution = solve(Scene.from_kappa(-0.1, friction=np.inf), 1e-6)
    shear = solution.plot().axes[2]
    assert "q" in shear.get_ylabel()
    assert [one.get_text() for one in shear.texts] == ["cut off: infinite at the edge"]


def test_slip_zones_are_shaded_from_both_ends(slipping):
    figure = plotting.plot_solution(slipping)
    slip = slipping.zones[1]
    for axes, ends in ((figure.axes[0], (slip.inner, 1.0)), (figure.axes[3], (0.0, None))):
        (patch,) = axes.patches
        low, high = patch.get_extents().transformed(axes.transData.inverted()).intervalx
        if ends[1] is None:
            assert max(low, high) == pytest.approx(slip.inner_from_edge)
        else:
            assert (low, high) == pytest.approx(ends)
    legend = figure.axes[2].get_legend()
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts == ["$q^*$", "$f p^*$", "stick", "slip"]


def test_every_estimate_is_drawn(slipping):
    axes = plotting.plot_solution(slipping).axes[-1]
    names = [text.get_text() for text in axes.get_yticklabels()]
    points = [line.get_data() for line in axes.get_lines() if line.get_marker() == "o"]
    assert len(names) == len(points)
    for name in ("approach", "pressure", "traction", "stick radius"):
        (x,), _ = points[names.index(name)]
        assert x == max(getattr(slipping.error, name.replace(" ", "_")), 3e-17)
    dashed = [line for line in axes.get_lines() if line.get_linestyle() == "--"]
    assert dashed[0].get_xdata()[0] == slipping.rtol


def test_exact_quantities_are_said_to_be_exact():
    axes = plotting.plot_solution(solve(STUCK, 1e-4)).axes[-1]
    # slip, zones, stick radius, shakedown ratio
    assert [text.get_text() for text in axes.texts].count("exact") == 4


@pytest.mark.parametrize("error", [3.0, np.inf, np.nan])
def test_useless_estimates_are_drawn_at_one(slipping, tmp_path, error):
    bad = replace(slipping, error=ErrorEstimates(pressure=error))
    figure = plotting.plot_solution(bad)
    plotting.save(figure, str(tmp_path / "x.png"))
    assert figure.axes[-1].get_lines()[0].get_xdata() == [1.0]
    assert "no digit is known" in [text.get_text() for text in figure.axes[-1].texts]


def test_full_stick_has_no_friction_bound_and_no_shade():
    figure = plotting.plot_solution(solve(STUCK, 1e-4))
    assert set(lines(figure.axes[2])) == {"$q^*$"}
    assert not any(axes.patches for axes in figure.axes)


def test_the_frictionless_figure_has_the_pressure_alone():
    figure = plotting.plot_solution(solve(FRICTIONLESS, 1e-4))
    assert len(figure.axes) == 3
    assert set(lines(figure.axes[0])) == {"$p^*$"}


def test_what_was_not_asked_for_is_left_out():
    figure = plotting.plot_solution(solve(SLIPPING, 1e-4, ["traction"]))
    assert len(figure.axes) == 3
    assert set(lines(figure.axes[0])) == {"$q^*$"}


@pytest.mark.parametrize(
    "scene",
    [SMOOTH, Scene(0.1, 1e-14, 1e-3, np.inf), Scene(0.1, 1e-3, 0.0, np.inf)],
    ids=["smooth", "thin layer", "singular traction"],
)
def test_singular_edges_are_cut_off_on_the_left_and_shown_on_the_right(scene, tmp_path):
    solution = solve(scene, 1e-4)
    figure = plotting.plot_solution(solution)
    for left, right in (figure.axes[0:2], figure.axes[2:4]):
        assert np.isfinite(left.get_ylim()).all()
        assert left.get_ylim()[1] < 2.0
        assert right.get_yscale() == "log"
        assert right.get_ylim()[1] > left.get_ylim()[1]
    plotting.save(figure, str(tmp_path / "singular.png"))


@pytest.mark.parametrize("scene", [Scene(0.1, 0.5, 0.5, 0.0), Scene(0.5, 0.5, 0.5, 0.1)])
def test_a_traction_that_is_zero_is_drawn(scene, tmp_path):
    figure = plotting.plot_solution(solve(scene, 1e-4))
    axes = figure.axes[2]
    assert not lines(axes)["$q^*$"][1].any()
    assert axes.get_ylim()[0] < 0.0 < axes.get_ylim()[1]
    plotting.save(figure, str(tmp_path / "zero.png"))


def test_fields_must_have_been_asked_for():
    with pytest.raises(NotComputedError, match="not asked for"):
        plotting.plot_solution(solve(STUCK, 1e-4, ["approach"]))
    with pytest.raises(NotComputedError, match="pressure or traction"):
        plotting.check(plan(STUCK, ["approach"]))


# --- coefficients ---------------------------------------------------------------------------------


def panels(figure):
    """Return the axes that are no colour bars."""
    return [axes for axes in figure.axes if axes.get_title()]


def test_coefficients_of_every_panel(slipping):
    figure = plotting.plot_coefficients(slipping)
    series = slipping.pressure_field.series
    pressure, traction = panels(figure)
    assert pressure.get_title() == "$p^*$, $d = 1 - s^2$"
    assert traction.get_title().startswith("$q^*$ in stick")
    assert pressure.get_yscale() == "log"
    assert (pressure.get_xlabel(), pressure.get_ylabel()) == (
        "degree $k$",
        "Legendre coefficient $|c_k|$",
    )
    curves = pressure.get_lines()
    assert len(curves) == len(series.coefficients) + 1
    for curve, coefficients in zip(curves, [*series.coefficients, series.tail], strict=True):
        degree, modulus = curve.get_data()
        assert np.array_equal(modulus, np.abs(coefficients[degree]))
        assert np.count_nonzero(coefficients) == len(degree)


def test_coefficients_of_every_zone():
    scene = Scene(0.3, 0.05, 1.0, 0.23 / 7.0)  # slips in an interior annulus
    solution = solve(scene, 1e-3, strict=False)
    assert [zone.kind for zone in solution.zones] == ["stick", "slip", "stick"]
    titles = [axes.get_title() for axes in panels(plotting.plot_coefficients(solution))]
    assert len(titles) == 4
    assert titles[2].startswith("$q^*$ in a stick annulus, toward $s = 0.98")
    assert titles[3].endswith("toward $s = 1$")


def test_coefficients_of_a_coupled_solution_with_slip():
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1, coupling=True), 1e-3)
    titles = [axes.get_title() for axes in panels(plotting.plot_coefficients(solution))]
    starts = ("$p^*$ in stick", "$p^*$ in slip", "$p^*$ in slip", "$q^*$ in stick")
    assert all(title.startswith(start) for title, start in zip(titles, starts, strict=True))


def test_coefficients_between_bends_of_a_profile_belong_to_no_zone():
    punch = profiles.RoundedFlat(0.5, 1.0)
    solution = solve(Scene(0.3, 0.05, profile=punch, load=0.3), 1e-3)
    first, *others = [axes.get_title() for axes in panels(plotting.plot_coefficients(solution))]
    assert first.startswith("$p^*$, $d = 1 - s^2/c^2$")
    assert [title.split(" $s")[0] for title in others] == ["$p^*$, toward"] * 2


def test_a_frictionless_solution_has_one_series():
    figure = plotting.plot_coefficients(solve(FRICTIONLESS, 1e-4))
    assert [axes.get_title() for axes in panels(figure)] == ["$p^*$, $d = 1 - s^2$"]


@pytest.mark.parametrize(
    ("scene", "quantities", "reason"),
    [
        (SMOOTH, None, "smooth"),
        (STUCK, ["approach"], "not asked for"),
        (FRICTIONLESS, ["traction"], "zero"),
    ],
)
def test_a_solution_without_a_series_says_why(scene, quantities, reason):
    with pytest.raises(NotComputedError, match=reason):
        plotting.plot_coefficients(solve(scene, 1e-4, quantities))


# --- files and imports ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("suffix", "magic"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")]
)
def test_figures_are_written_the_same_each_time(slipping, tmp_path, suffix, magic):
    contents = []
    for name in ("first", "second"):
        path = tmp_path / (name + suffix)
        plotting.save(plotting.plot_coefficients(slipping), str(path))
        contents.append(path.read_bytes())
    assert contents[0].startswith(magic)
    assert contents[0] == contents[1]


def test_unwritable_files_and_unknown_suffixes(tmp_path):
    figure = Figure()
    with pytest.raises(SolutionFileError, match="suffix"):
        plotting.save(figure, str(tmp_path / "x.bmp"))
    with pytest.raises(SolutionFileError, match="cannot be written"):
        plotting.save(figure, str(tmp_path / "missing" / "x.png"))


@pytest.mark.parametrize("value", [1, None, "x", object()])
def test_what_is_no_figure_or_path_is_named(tmp_path, value):
    with pytest.raises(SceneError, match=r"^figure = .*: must be a Figure$"):
        plotting.save(value, str(tmp_path / "x.png"))
    figure = Figure()
    with pytest.raises(SolutionFileError, match="suffix" if value == "x" else "not a path"):
        plotting.save(figure, value)
    with pytest.raises(SolutionFileError, match="cannot be written"):
        plotting.save(figure, "\x00.png")
    for call in (plotting.graded_radii, plotting.plot_solution, plotting.plot_coefficients):
        with pytest.raises(SceneError, match=r"^solution = .*: must be a Solution$"):
            call(value)
    with pytest.raises(SceneError, match=r"^scene = .*: must be a Scene$"):
        plotting.scene_title(value)
    with pytest.raises(SceneError, match=r"^plan = .*: must be a Plan$"):
        plotting.check(value)


@pytest.mark.parametrize("count", [0, True, 2.0, "3", 10**9])
def test_a_count_of_radii_is_a_whole_number(slipping, count):
    with pytest.raises(SceneError, match=r"^count = "):
        plotting.graded_radii(slipping, count)


def test_without_matplotlib_the_error_names_the_extra(slipping, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for plot in (plotting.plot_solution, plotting.plot_coefficients):
        with pytest.raises(MissingDependencyError, match=r"\.\[plot\]"):
            plot(slipping)


def test_importing_imports_no_matplotlib_and_plotting_no_pyplot(tmp_path):
    code = (
        "import sys, spectral_contact.__main__\n"
        "from spectral_contact import Scene, plotting, solve\n"
        "assert not [name for name in sys.modules if name.startswith('matplotlib')]\n"
        "solution = solve(Scene(0.1, 0.5), 1e-2)\n"
        f"plotting.save(plotting.plot_solution(solution), {str(tmp_path / 'x.png')!r})\n"
        "plotting.plot_coefficients(solution)\n"
        "assert 'matplotlib' in sys.modules\n"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_plotting_leaves_the_users_settings_alone(slipping):
    before = dict(matplotlib.rcParams)
    plotting.plot_solution(slipping)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize("plot", [plotting.plot_solution, plotting.plot_coefficients])
@pytest.mark.parametrize("value", [None, Scene(0.3), 1.0])
def test_only_solutions_are_plotted(plot, value):
    with pytest.raises(SceneError, match=r"solution = .* must be a Solution"):
        plot(value)


# --- SI -------------------------------------------------------------------------------------------

STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "radius": 5e-3}
LAYERS = {"normal_compliance": 5e-14, "tangential_compliance": 5e-14, "friction": 0.05}


def labels(figure):
    return {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())}


def test_a_scene_in_si_has_axes_in_si():
    solution = solve(Scene.from_physical(**STEEL, **LAYERS, load=1e3), 1e-6)
    figure = plotting.plot_solution(solution)
    expected = {"radius $r$ [mm]", "distance from the edge $a - r$ [mm]", "$p$ [MPa]", "$q$ [MPa]"}
    assert expected <= labels(figure)
    assert not any("^*" in one for one in labels(figure))
    left, right = figure.axes[:2]
    radius, pressure = left.get_lines()[0].get_data()
    assert (radius[0], radius[-1]) == (0.0, 5.0)
    inside = radius < 4.9
    si = solution.physical.pressure(1e-3 * radius[inside])
    assert np.allclose(1e6 * pressure[inside], si, rtol=1e-12)
    assert left.get_xlim() == (0.0, 5.0)
    assert right.get_xlim()[0] == 5.0
    stuck = 1e3 * solution.physical.stick_radius
    assert any(np.isclose(patch.get_x(), stuck) for patch in left.patches)
    assert r"$P = 1000$ N" in figure.get_suptitle()


def test_an_approach_in_si_is_drawn_dimensionless_if_it_leaves_the_load_open():
    scene = Scene.from_physical(**STEEL, **LAYERS, approach=1e-6)
    assert r"radius $s = r / a$" in labels(plotting.plot_solution(solve(scene, 1e-4, ["pressure"])))
    whole = solve(scene, 1e-4, ["approach", "pressure"])
    assert "$p$ [MPa]" in labels(plotting.plot_solution(whole))


@pytest.mark.parametrize("given", [{"load": 0.1}, {"contact_radius": 0.1}])
def test_under_a_profile_the_pressure_alone_can_be_drawn(given):
    tip = profiles.Sphere(1.0)
    figure = solve(Scene(0.3, profile=tip, **given), 1e-2, ["pressure"]).plot()
    assert figure.axes[0].get_xlabel() == "radius $s = r / a$"
    assert ("a =" in figure.get_suptitle()) == ("contact_radius" in given)
    in_si = Scene.from_physical(youngs_modulus=1e9, poisson_ratio=0.3, profile=tip, **given)
    figure = solve(in_si, 1e-2, ["pressure"]).plot()
    assert ("[" in figure.axes[0].get_xlabel()) == ("contact_radius" in given)


def test_a_notebook_shows_a_figure_without_pyplot():
    picture = plotting.plot_solution(solve(Scene(0.3, 0.5), 1e-3))._repr_png_()
    assert picture.startswith(b"\x89PNG")
    assert len(picture) > 10_000
