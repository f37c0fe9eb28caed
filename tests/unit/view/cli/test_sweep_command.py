"""``spectral-contact sweep``: ranges, files, a plot, and what it says when it cannot."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, solve
from spectral_contact.__main__ import main
from spectral_contact.sweeps import plot_slice, sweep
from spectral_contact.sweeps.dataset import summary, unsolved
from spectral_contact.sweeps.slice_pictures import varying
from spectral_contact.view.cli.options import values

xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

APPROACH = ("--quantities", "approach", "--friction", "none")


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact sweep``."""
    status = main(["sweep", *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0:1:3", [0.0, 0.5, 1.0]),
        ("0:1:3:linear", [0.0, 0.5, 1.0]),
        ("1:4:3:log", [1.0, 2.0, 4.0]),
        ("-1:-2:2", [-1.0, -2.0]),
        ("1:4:3:log mN", ["1.0 mN", "2.0 mN", "4.0 mN"]),
    ],
)
def test_a_range_stands_for_its_values(text, expected):
    assert values(text) == expected


def test_ranges_lists_and_single_values(capsys, tmp_path):
    path = tmp_path / "map.nc"
    status, out, err = run(
        capsys,
        *("--normal-compliance", "1e-2:1:3:log", "--friction", "0.1:0.3:3"),
        *("--tangential-compliance", "0.5,1", "--poisson-ratio", "0.3"),
        *("--quantities", "edge_ratio", "--output", str(path)),
    )
    assert (status, err) == (0, "")
    assert out.startswith("18 scenes: 18 converged")
    found = xarray.load_dataset(path)
    assert found.edge_ratio.dims == ("normal_compliance", "tangential_compliance", "friction")
    assert np.allclose(found.normal_compliance, [0.01, 0.1, 1.0], rtol=1e-15)
    assert found.tangential_compliance.values.tolist() == [0.5, 1.0]
    assert np.allclose(found.friction, [0.1, 0.2, 0.3], rtol=1e-15)
    expected = solve(Scene(0.3, 1.0, 0.5, 0.1)).edge_ratio
    assert float(found.edge_ratio[2, 0, 0]) == pytest.approx(expected, rel=1e-8)


def test_a_table_has_a_row_for_each_scene(capsys, tmp_path):
    path = tmp_path / "map.csv"
    options = ("--normal-compliance", "0.1,0.5", "--output", str(path))
    assert run(capsys, *options, *APPROACH)[0] == 0
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert [float(row["normal_compliance"]) for row in rows] == [0.1, 0.5]
    assert [row["ending"] for row in rows] == ["converged"] * 2
    for row in rows:
        expected = solve(Scene(0.1, float(row["normal_compliance"])), 1e-8, ["approach"]).approach
        assert float(row["approach"]) == expected


def test_scenes_may_have_elastic_coupling(capsys, tmp_path):
    path = tmp_path / "map.csv"
    options = ("--friction", "inf", "--coupling", "--quantities", "approach")
    assert run(capsys, *options, "--output", str(path))[0] == 0
    [row] = csv.DictReader(path.read_text().splitlines())
    assert row["coupling"] == "True"
    scene = Scene(0.1, 0.5, 0.5, math.inf, coupling=True)
    assert float(row["approach"]) == solve(scene, 1e-8, ["approach"]).approach


def test_a_curve_over_the_load_has_a_profile(capsys, tmp_path):
    path = tmp_path / "curve.csv"
    tip = ("--profile", "parabola", "--radius", "2", "--load", "0.1:10:3:log")
    status, out, _ = run(capsys, *tip, "--output", str(path))
    assert status == 0
    assert out.startswith("3 scenes: 3 converged")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert [float(row["load"]) for row in rows] == pytest.approx([0.1, 1.0, 10.0], rel=1e-15)
    for row in rows:  # Hertz
        a = float(row["contact_radius"])
        assert float(row["load"]) == pytest.approx(16 / 3 * a**3 / 2.0, rel=1e-8)
    assert {row["friction"] for row in rows} == {""}


def test_one_scene_is_a_row_as_well(capsys, tmp_path):
    path = tmp_path / "one.csv"
    assert run(capsys, "--output", str(path), *APPROACH)[0] == 0
    assert len(path.read_text().splitlines()) == 2


def test_fields_workers_and_a_store(capsys, tmp_path):
    options = ("--quantities", "pressure", "--from-edge", "0,1e-3", "--friction", "0.1:0.2:3")
    more = ("--workers", "2", "--store", str(tmp_path / "store"))
    status, out, _ = run(capsys, *options, *more)
    assert status == 0
    assert "pressure" in out
    assert (tmp_path / "store" / "000000.npz").exists()
    assert run(capsys, *options, "--store", str(tmp_path / "store"))[:2] == (0, out)


def test_a_slice_is_plotted(capsys, tmp_path):
    path = tmp_path / "map.png"
    options = ("--friction", "0.1:0.3:3", "--normal-compliance", "0.1,0.5", "--quantities")
    cut = ("--at", "friction=0.22", "--plot", str(path))
    status, _, err = run(capsys, *options, "edge_ratio", *cut)
    assert (status, err) == (0, "")
    assert path.read_bytes().startswith(b"\x89PNG")


def test_values_in_any_order_are_drawn_in_that_of_the_axis():
    order = [0.5, 0.1, 1.0]
    found = sweep(
        Scene(0.3), normal_compliance=order, friction=[0.1, 0.02], quantities=["total_shear"]
    )
    mesh = plot_slice(found, "total_shear").axes[0].collections[0]
    assert (np.diff(mesh.get_coordinates(), axis=0)[..., 1] > 0.0).all()
    known = found.total_shear.sel(normal_compliance=sorted(order), friction=[0.02, 0.1])
    assert np.array_equal(mesh.get_array(), known.values)
    [line] = plot_slice(found, "total_shear", {"friction": 0.1}).axes[0].get_lines()
    assert list(line.get_xdata()) == sorted(order)


def test_slices_are_curves_and_maps():
    friction = [0.1, 0.2, math.inf]
    found = sweep(
        Scene(0.3, 0.5, 0.5),
        normal_compliance=[1e-3, 1.0],
        friction=friction,
        quantities=["approach"],
    )
    figure = plot_slice(found, "approach", {"friction": math.inf})
    [axes] = figure.axes
    held = [r"$\nu$ = 0.3", r"$\beta^*$ = 0.5", r"$f$ = $\infty$"]
    assert sorted(axes.get_title().split(", ")) == sorted(held)
    assert axes.get_xscale() == "log"
    assert np.array_equal(axes.lines[0].get_ydata(), found.approach[:, 2])
    figure = plot_slice(found, "approach")  # what is infinite has no place on an axis
    assert figure.axes[0].get_xlabel() == "coefficient of friction $f$"
    assert figure.axes[0].get_ylabel() == "normal compliance $α^*$"
    values = figure.axes[0].collections[0].get_array()
    assert np.array_equal(values, found.approach[:, :2])
    corners = figure.axes[0].collections[0].get_coordinates()
    assert np.allclose(corners[:, 0, 1], 10.0 ** np.array([-4.5, -1.5, 1.5]), rtol=1e-12)


@pytest.mark.parametrize("more", [{}, {"tangential_compliance": [0.1, 0.5]}])
def test_one_finite_friction_is_no_dimension_of_a_picture(more):
    found = sweep(
        Scene(0.3, 0.5, 0.5),
        normal_compliance=[0.1, 0.5],
        friction=[0.1, math.inf],
        quantities=["approach"],
        **more,
    )
    [axes, *_] = plot_slice(found, "approach").axes
    assert "$f$ = 0.1" in axes.get_title()
    drawn = axes.collections[0].get_array() if more else axes.lines[0].get_ydata()
    assert np.array_equal(drawn.squeeze(), found.approach.sel(friction=0.1).values)


def test_a_quantity_that_varies_is_drawn():
    found = sweep(Scene(0.3, 0.5, 0.5), friction=[0.05, 0.08])
    assert varying(found) == "stick_radius"  # friction does not move the approach
    assert varying(found[["approach", "approach_error"]]) == "approach"
    both = sweep(Scene(0.3, 0.5, 0.5), normal_compliance=[0.1, 0.5], friction=[0.05, 0.08])
    assert varying(both) == "stick_radius"
    assert varying(both, {"friction": 0.05}) == "approach"
    assert varying(both, {"normal_compliance": 0.1}) == "stick_radius"
    none = sweep(Scene(0.3), normal_compliance=[0.1, 0.2], quantities=["approach"])
    assert plot_slice(none, "approach").axes[0].get_title().endswith("no friction")


@pytest.fixture(scope="module")
def swept():
    asked = {"quantities": ["approach"]}
    return sweep(Scene(0.3, 0.5, 0.5, 0.1), normal_compliance=[0.1, 1.0], friction=[0.1], **asked)


@pytest.mark.parametrize("value", [1, None, {}, "x"])
def test_a_slice_is_of_a_dataset(value):
    with pytest.raises(SceneError, match=r"^dataset = .*: must be a Dataset$"):
        plot_slice(value, "approach")


@pytest.mark.parametrize("value", [math.nan, True, 0.1 + 0j, "0.1", None, [0.1], np.array(0.1)])
def test_a_slice_is_cut_at_a_number(swept, value):
    with pytest.raises(SceneError, match=r"^at, friction = "):
        plot_slice(swept, "approach", {"friction": value})


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("aproach",), "quantity = 'aproach': must be one of approach, .*did you mean approach"),
        ((1,), "quantity = 1"),
        (("approach", {"fricton": 0.1}), "at = 'fricton': .*did you mean friction"),
        (("approach", 1), "at = 1: must be a mapping"),
        (("approach", {1: 1}), "at = 1"),
    ],
)
def test_a_slice_is_of_what_there_is(swept, arguments, said):
    with pytest.raises(SceneError, match=f"^{said}"):
        plot_slice(swept, *arguments)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--friction", "0.1:x:3"), "argument --friction: 'x' is not a number"),
        (("--friction", "0.1:0.3"), "argument --friction: '0.1:0.3' is not LOW:HIGH:COUNT[:log]"),
        (("--friction", "0.1:1e999:3"), "'1e999' is not within the range of a double"),
        (("--friction", "0.1:0.3:1_0"), "'1_0' is not a whole number"),
        (("--s", "0.5,\u0660"), "argument --s: '\u0660' is not a number"),
        (("--at", "friction=1e-400"), "'1e-400' is not within the range of a double"),
        (("--friction", "0.1:0.3:0"), "'0.1:0.3:0' is not LOW:HIGH:COUNT[:log]"),
        (("--friction", "0.1:inf:3"), "'0.1:inf:3' is not LOW:HIGH:COUNT[:log]"),
        (("--friction", "0.1:0.3:3:cubic"), "is not LOW:HIGH:COUNT[:log]"),
        (("--friction", "0:0.3:3:log"), "'0:0.3:3:log': equal ratios need positive ends"),
        (("--friction", "-1"), "--friction = -1.0: must be >= 0"),
        (("--friction", "0.1,-1"), "--friction = -1.0: must be >= 0"),
        (("--poisson-ratio", "0.7"), "--poisson-ratio = 0.7: must be in (-1, 0.5]"),
        (("--quantities", "colour"), "--quantities = 'colour': must be one of approach"),
        (
            ("--quantities", "slip"),
            "--quantities = 'slip': must be given with its radii (--s or --from-edge)",
        ),
        (("--workers", "0"), "--workers = 0: must be a whole number >= 1"),
        (("--output", "map.xls"), "map.xls: the suffix must be one of .nc, .csv"),
        (("--at", "friction=0.1"), "--at and --plot-quantity need --plot"),
        (("--friction", "0.1,,0.2"), "--friction: '' is not a number, in '0.1,,0.2'"),
        (("--friction", "0.1,none"), "--friction: 'none' is not a number, in '0.1,none'"),
        (
            ("--s", "0", "--from-edge", "1"),
            "one of --s, --from-edge: --s [0.0] and --from-edge [1.0]",
        ),
        (("--at", "friction"), "argument --at: 'friction' is not NAME=X"),
        (("--load", "1,2"), "--youngs-modulus, --poisson-ratio, --radius are missing: they must"),
        (
            ("--profile", "parabola", "--radius", "1 mm", "--load", "1"),
            "without a unit, without --youngs",
        ),
        (
            ("--youngs-modulus", "1e9", "--radius", "1 mm"),
            "--poisson-ratio is missing: it must",
        ),
        (
            ("--youngs-modulus", "1e9 mm", "--poisson-ratio", "0.3", "--radius", "1mm"),
            "--youngs-modulus = '1e9 mm': must be a number in Pa",
        ),
        (("--profile", "cone", "--load", "1,2"), "--profile cone takes --half-angle"),
        (("--profile", "cone", "--half-angle", "1", "--load", "1,0"), "--load = 0.0: must be"),
        (
            ("--profile", "cone", "--half-angle", "1"),
            "--contact-radius, --load, --app",
        ),
    ],
)
def test_bad_options_are_named(capsys, options, said):
    status, out, err = run(capsys, *options)
    assert (status, out) == (2, "")
    assert err.startswith("spectral-contact: ")
    assert said in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--at", "nu=0.3"), "--at = 'nu': must be one of the dimensions: normal_compliance"),
        (
            ("--at", "normal-compliance=0.1"),
            "such that one or two dimensions are left, not none",
        ),
        (("--plot-quantity", "ending"), "--plot-quantity = 'ending': must be one of approach"),
    ],
)
def test_what_is_no_slice_is_named(capsys, tmp_path, options, said):
    plot = ("--plot", str(tmp_path / "map.png"), "--normal-compliance", "0.1,0.5")
    status, out, err = run(capsys, *plot, *APPROACH, *options)
    assert status == 2
    assert "2 scenes: 2 converged" in out  # the work is not lost
    assert said in err


def test_the_summary_counts_endings():
    found = sweep(Scene(0.3, 0.5, 0.5, 0.1), rtol=1e-10, max_unknowns=10, quantities=["approach"])
    assert summary(found).startswith("1 scenes: 1 unknowns")


def test_a_sweep_of_which_nothing_is_solved_fails_and_says_why(capsys, tmp_path):
    # loads next to the ends of the range of a double
    path = tmp_path / "none.csv"
    options = ("--profile", "power-law", "--coefficient", "1", "--exponent", "3")
    status, out, err = run(capsys, *options, "--load", "1e-300,1e300", "--output", str(path))
    assert status == 1
    assert out.startswith("2 scenes: ")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert err.startswith("spectral-contact: none of 2 scenes was solved; the first that was not: ")
    assert rows[0]["message"] in err
    assert err.count("\n") == 1


def test_a_scene_that_did_not_converge_fails_the_sweep_and_its_reason_is_named():
    found = sweep(Scene(0.3, 0.5), normal_compliance=[0.1, 0.5], quantities=["approach"])
    assert unsolved(found) == ""
    found.ending.values[1] = "rounding"
    found.message.values[1] = "why"
    told = "1 of 2 scenes were solved; the first that was not: rounding, why"
    assert unsolved(found) == told


def test_scenes_in_si_units_with_units_in_ranges(capsys, tmp_path):
    path = tmp_path / "curve.csv"
    body = ("--youngs-modulus", "70 GPa", "--poisson-ratio", "0.2", "--output", str(path))
    tip = ("--profile", "parabola", "--radius", "10 um", "--load", "1:4:2:log mN")
    status, out, _ = run(capsys, *body, *tip, "--normal-compliance-si", "0")
    assert status == 0
    assert "approach_si" in out
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert [float(row["load_si"]) for row in rows] == [1e-3, 4e-3]
    modulus = 70e9 / (1 - 0.2**2)
    for row in rows:  # Hertz
        expected = (0.75 * float(row["load_si"]) / modulus / math.sqrt(1e-5)) ** (2 / 3)
        assert float(row["approach_si"]) == pytest.approx(expected, rel=1e-8)


def test_a_table_of_scenes_in_si_units(capsys, tmp_path):
    table = Path(__file__).parents[3] / "data" / "tables" / "scenes_german.csv"
    body = ("--youngs-modulus", "1e9", "--poisson-ratio", "0.2", "--table", str(table))
    status, out, _ = run(capsys, *body, "--quantities", "approach")
    assert status == 0
    assert "3 rows, youngs_modulus from column 4 (E [GPa]) in GPa" in out
    assert "3 scenes: 3 converged" in out


@pytest.mark.parametrize("count", ["1000000000000", "10000001"])
def test_a_range_of_too_many_values_is_refused(capsys, count):
    status, out, err = run(capsys, "--friction", f"0.1:1:{count}")
    assert (status, out) == (2, "")
    assert "COUNT must be at most 10000000" in err


@pytest.mark.parametrize("values", ["-0.25:0.25:3", "-0.25,0,0.25"])
def test_lists_and_ranges_may_begin_with_a_negative_number(capsys, tmp_path, values):
    path = tmp_path / "line.csv"
    options = ["--friction", "none", "--quantities", "approach", "--output", str(path)]
    assert run(capsys, "--poisson-ratio", values, *options)[0] == 0
    lines = [one for one in path.read_text(encoding="utf-8").splitlines() if one[0] != "#"]
    assert [float(row["poisson_ratio"]) for row in csv.DictReader(lines)] == [-0.25, 0.0, 0.25]


BEADS = "E [GPa];radius [um];load [mN]\n70;10;1,5\n70;12,5;{}\n"


def test_a_table_may_have_the_modulus_and_the_radius_of_a_profile(capsys, tmp_path):
    table, output = tmp_path / "beads.csv", tmp_path / "results.csv"
    table.write_text(BEADS.format("2,5"), encoding="utf-8-sig")
    options = ("--poisson-ratio", "0.2", "--profile", "parabola", "--table", str(table))
    assert main(["sweep", *options, "--output", str(output)]) == 0
    assert "2 scenes: 2 converged" in capsys.readouterr().out
    rows = list(csv.DictReader(output.read_text().splitlines()))
    for row, load, radius in zip(rows, (1.5e-3, 2.5e-3), (10e-6, 12.5e-6), strict=True):
        truth = (3 * load * 0.96 / (4 * 70e9 * radius**0.5)) ** (2 / 3)
        assert float(row["approach_si"]) == pytest.approx(truth, rel=1e-7)
        assert (float(row["load_si"]), float(row["radius"])) == pytest.approx((load, radius))


def test_the_first_scene_that_fails_is_named_and_the_status_is_1(capsys, tmp_path):
    table = tmp_path / "beads.csv"
    table.write_text(BEADS.format("1e9"))
    options = ("--poisson-ratio", "0.2", "--profile", "sphere", "--table", str(table))
    assert main(["sweep", *options, "--quantities", "approach"]) == 1
    captured = capsys.readouterr()
    assert "1 converged, 1 failed" in captured.out
    assert "1 of 2 scenes were solved" in captured.err
    assert "the range of the profile" in captured.err


def test_the_radius_of_a_profile_may_be_several(capsys):
    options = ("--profile", "sphere", "--radius", "10,20 um", "--load", "1:2:2 mN")
    body = ("--youngs-modulus", "7e10", "--poisson-ratio", "0.2", "--quantities", "approach")
    assert main(["sweep", *body, *options]) == 0
    assert "4 scenes: 4 converged" in capsys.readouterr().out
    assert main(["sweep", *options[:2], "--radius", "1,2", "--load", "1"]) == 2
    assert "--radius = [1.0, 2.0]: must be one number" in capsys.readouterr().err
    assert main(["sweep", "--profile", "cone", "--half-angle", "1,1.2", "--load", "1"]) == 2
    err = capsys.readouterr().err
    assert "--half-angle = [1.0, 1.2]: must be one number: of a profile" in err


def test_a_sweep_may_have_two_curved_bodies_and_names_parted_by_commas(capsys, tmp_path):
    path = tmp_path / "curve.csv"
    bodies = ("--profile", "parabola", "--radius", "1", "--punch-profile", "parabola", "1")
    names = ("--quantities", "approach,contact-radius", "--output", str(path))
    assert main(["sweep", *bodies, "--load", "0.1, 0.2", *names]) == 0
    for row in csv.DictReader(path.read_text().splitlines()):  # Hertz, of a radius of 1/2
        a = float(row["contact_radius"])
        assert float(row["load"]) == pytest.approx(16 / 3 * a**3 / 0.5, rel=1e-8)
        assert float(row["approach"]) == pytest.approx(a**2 / 0.5, rel=1e-8)


def test_a_table_without_a_load_is_refused(capsys, tmp_path):
    table = tmp_path / "radii.csv"
    table.write_text("radius [um]\n10\n")
    body = ("--youngs-modulus", "7e10", "--poisson-ratio", "0.2", "--table", str(table))
    assert main(["sweep", *body, "--quantities", "approach"]) == 2
    assert "--load" in capsys.readouterr().err
