"""Curves as instruments write them: formats, signs, parts, baseline, and what is remarked."""

from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, SolutionFileError, fit, profiles
from spectral_contact.calibration import IndentationData
from spectral_contact.calibration.force_curves import baseline, curve_parts, signs
from spectral_contact.calibration.indentation_curve import curve_load, curve_loads
from spectral_contact.calibration.layered_fits import layered_load, layered_loads
from spectral_contact.layers import Exponential, PowerLaw

CURVES = Path(__file__).parents[2] / "data" / "curves"
AFM = {"path": CURVES / "afm_extend_retract.txt", "columns": "load=1 [N], depth=2 [m]"}
GERMAN = {"path": CURVES / "nanoindenter_german.csv", "columns": "depth=2, load=3"}


def ball(radius, modulus):
    tip = profiles.Parabola(radius)
    return Scene.from_physical(reduced_modulus=modulus, profile=tip, load=1e-9)


def told(data, words):
    """Return the one remark with these words."""
    [found] = [one for one in data.remarks if words in one]
    return found


def test_an_afm_curve_with_two_segments_falling_depth_and_an_offset():
    """Made by Hertz' formula: E* = 4 kPa, touch at -1.5 um, 0.12 nN, 20 pN of noise."""
    data = IndentationData.from_file(**AFM)
    assert len(data.depth) == 240
    assert "sign of the depth is turned" in told(data, "sign")
    assert "approach, 240 points (lines 14 to 253); retraction has 240" in told(data, "part:")
    assert data.sigma[0] == pytest.approx(2e-11, rel=0.15)
    free = ("reduced_modulus", "zero_point", "load_offset")
    found = fit(ball(2.5e-6, 1e3), data, free)
    for name, truth in zip(free, (4e3, -1.5e-6, 1.2e-10), strict=True):
        assert abs(found[name] - truth) < 3.0 * found.error(name)
        assert 0.0 < found.error(name) < abs(0.05 * truth)
    assert found.chi_square == pytest.approx(237.0, abs=70.0)
    assert not [one for one in found.remarks if "chi square" in one]
    without = fit(ball(2.5e-6, 1e3), data, free[:2])
    assert told(without, "free load_offset").startswith("the baseline is at 1.2")
    assert told(without, "chi square is").endswith("do not cover it")


def test_a_text_export_of_jpk_is_read_by_its_labelled_comments(tmp_path):
    """Made by Hertz' formula: E* = 1.5 kPa, 5 um, touch at 9.2 um, -20 pN, 10 pN of noise."""
    path = CURVES / "jpk_export.txt"
    data = IndentationData.from_file(path)
    assert "depth from column 1 (Vertical Tip Position) in m, load from column 2" in data.remarks[0]
    assert "sign of the depth is turned" in told(data, "sign")
    assert "approach, 200 points (lines 39 to 238); retraction has 202" in told(data, "part:")
    free = ("reduced_modulus", "zero_point", "load_offset")
    found = fit(ball(5e-6, 1e3), data, free, rtol=1e-7)
    for name, truth in zip(free, (1500.0, -9.2e-6, -2e-11), strict=True):
        assert abs(found[name] - truth) < 3.0 * found.error(name)
    text, other = path.read_text(encoding="utf-8"), tmp_path / "other.txt"
    for old, new, message in (
        ("units: m N", "units: m V", "V is no unit of load, which is in N"),
        ("# units: m N", "# m N", "has no unit, and a deflection may be in N, V or m"),
        ('"Height" ', '"Tip-Sample Separation" ', "column 1 .* and column 4 .* are both depth"),
        ('"Vertical Tip Position"', '"Piezo"', "no column of depth: the headings are Piezo, "),
    ):
        changed = text.replace(old, new).replace("# columns: v", "# channels v")
        other.write_text(changed, encoding="utf-8")
        with pytest.raises(SolutionFileError, match=message):
            IndentationData.from_file(other)


def test_the_retraction_and_a_loop():
    assert len(IndentationData.from_file(**AFM, part="retraction").depth) == 240
    loop = IndentationData.from_file(CURVES / "plastic.csv", part="all", sigma="4 uN")
    assert "are fitted as one curve: choose a part" in told(loop, "differ by")
    alone = IndentationData.from_file(CURVES / "plastic.csv", sigma="4 uN")
    assert len(alone.depth) == 100
    assert "no elastic contact: plastic flow" in told(alone, "differ by")


def test_a_german_export_with_units_below_the_headings():
    """E* = 73 GPa, 10 um, and nm and uN in a line of their own."""
    by_headings = IndentationData.from_file(GERMAN["path"], sigma=1.5e-6)
    assert by_headings.load == IndentationData.from_file(**GERMAN, sigma=1.5e-6).load
    with pytest.raises(SceneError, match=r"sigma = None: must be given: the curve has no"):
        IndentationData.from_file(**GERMAN)
    data = IndentationData.from_file(**GERMAN, sigma=1.5e-6)
    assert "(Prüfkraft) in µN" in data.remarks[0]
    found = fit(ball(1e-5, 1e10), data, ("reduced_modulus", "zero_point"))
    assert abs(found["reduced_modulus"] - 73e9) < 3.0 * found.error("reduced_modulus")
    assert found.error("reduced_modulus") < 1e8


def test_utf_16_with_gaps_and_a_turned_load():
    data = IndentationData.from_file(CURVES / "excel_unicode.txt")
    assert len(data.depth) == 177
    assert "3 rows left out: line 22" in data.remarks[0]
    assert told(data, "sign of the load is turned")
    assert max(data.load) > 1e-7
    with pytest.raises(SolutionFileError, match=r"line 22, column 2 \(load\): there is no value"):
        IndentationData.from_file(CURVES / "excel_unicode.txt", invalid="raise")
    found = fit(ball(5e-6, 1e4), data, ("reduced_modulus", "zero_point"))
    assert abs(found["reduced_modulus"] - 2e5) < 3.0 * found.error("reduced_modulus")


def test_deviations_of_a_column():
    data = IndentationData.from_file(CURVES / "table_with_errors.csv")
    assert data.depth[:2] == (50e-9, 100e-9)
    assert data.sigma[:2] == (1.1e-6, 1.4e-6)


def test_what_cannot_be_read_is_said_with_line_and_column(tmp_path):
    path = tmp_path / "curve.txt"
    path.write_text("depth [nm]\tload [uN]\n1,5\t2,5\n2,5\tover\n")
    with pytest.raises(SolutionFileError, match=r"line 3, column 2 \(load\): over is not a number"):
        IndentationData.from_file(path)


def test_points_that_go_back_are_counted_and_named(tmp_path):
    path = tmp_path / "curve.txt"
    rows = "".join(f"{h},{h}\n" for h in (1, 2, 4, 3, *range(5, 20)))
    path.write_text(f"depth [nm],load [uN]\n{rows}")
    data = IndentationData.from_file(path, sigma=1e-7)
    assert "goes back at 1 of 19 points, by 1e-09 m at most (lines 5)" in told(data, "goes back")
    path.write_text("depth [nm],load [uN]\n" + "".join(f"{h},{h}\n" for h in (1, 9, 2, 8, 3, 6)))
    assert "in no order" in told(IndentationData.from_file(path, sigma=1e-7), "order")
    with pytest.raises(SceneError, match="in no order of depth"):
        IndentationData.from_file(path, sigma=1e-7, part="approach")


def test_values_of_arrays_that_are_not_finite_are_counted():
    with pytest.raises(SceneError, match="finite, which 2 of 4 are not, the first at 1"):
        IndentationData([1.0, np.nan, 2.0, np.inf], [1.0] * 4, 1.0)


@pytest.mark.parametrize("of_depth", [1.0, -1.0])
@pytest.mark.parametrize("of_load", [1.0, -1.0])
@pytest.mark.parametrize("first", [-1.0, 0.0])
def test_signs_are_recognised_with_and_without_a_baseline(of_depth, of_load, first):
    depth = np.linspace(first, 1.0, 50)
    load = np.maximum(depth, 0.0) ** 1.5
    assert signs(of_depth * depth, of_load * load) == (of_depth, of_load)
    remarks = IndentationData(of_depth * depth, of_load * load, 1.0).remarks
    assert len(remarks) == (of_depth < 0.0) + (of_load < 0.0)


def test_a_baseline_ends_where_the_contact_begins():
    depth, random = np.linspace(-2.0, 1.0, 900), np.random.default_rng(3)
    load = np.maximum(depth, 0.0) ** 1.5 + 0.3 + 0.02 * depth + 0.01 * random.normal(size=900)
    line = baseline(depth, load)
    assert -0.1 < line.end < 0.15
    assert line.sigma == pytest.approx(0.01, rel=0.1)
    assert line.tilt == pytest.approx(0.02, abs=0.003)
    assert baseline(depth[600:], load[600:]) is None
    assert baseline(depth, np.zeros(900)) is None
    cone = np.linspace(0.0, 1.0, 900)
    assert baseline(cone, cone**2) is None  # flat at first, but no noise


@pytest.mark.parametrize("seed", [81, 685, 928, 1187, 3787])
def test_points_that_are_off_by_chance_do_not_end_a_baseline(seed):
    """Of 6000 seeds these are some with a block that is off by four standard deviations."""
    depth, random = np.linspace(-2.0, 1.0, 300), np.random.default_rng(seed)
    load = np.maximum(depth, 0.0) ** 1.5 + 0.01 * random.normal(size=300)
    assert 180 <= baseline(depth, load).points <= 225


def test_parts_are_those_before_and_after_the_deepest_row():
    there = np.array([0.0, 1.0, 2.0, 3.0])
    both = curve_parts(np.concatenate([there, there[::-1]]))
    assert {name: len(rows) for name, rows in both.items()} == {"approach": 4, "retraction": 4}
    assert list(curve_parts(there)) == ["approach"]
    assert list(curve_parts(there[::-1])) == ["retraction"]


@pytest.mark.parametrize(
    "profile",
    [
        profiles.Sphere(1.0),
        profiles.TruncatedCone(0.05, 1.3),
        profiles.Sampled.from_points([0.0, 0.2, 0.5], [0.0, 0.02, 0.13]),
    ],
    ids=lambda one: type(one).__name__,
)
def test_interpolated_loads_are_those_of_single_solves(profile):
    """In and beside contact, at a break, and twice at one depth."""
    depth = np.concatenate([np.linspace(-0.01, 0.05, 60), [0.03, 0.03]])
    found = curve_loads(profile, depth, 0.01, 1e-6)
    assert (found[depth <= 0.0] == 0.0).all()
    for k in (11, 40, 60, 61):
        truth = np.array(curve_load(profile, float(depth[k]), 0.01, 1e-9))
        assert np.abs(found[k] / truth - 1.0).max() < 1e-5


@pytest.mark.parametrize(
    ("law", "depth"),
    [(PowerLaw(5.0, 2.0), (-0.01, 0.1)), (Exponential(0.3, 0.02), (-0.1, 0.1))],
    ids=lambda one: type(one).__name__,
)
def test_the_same_through_nonlinear_layers(law, depth):
    profile = profiles.Flat(1.0)
    depths = np.linspace(*depth, 50)
    found = layered_loads(profile, law, depths, 1e-7)
    for k in (10, 30, 49):
        truth = layered_load(profile, law, float(depths[k]), 1e-9)
        assert found.value[k] == pytest.approx(truth.value, rel=1e-6)
        assert found.by_approach[k] == pytest.approx(truth.by_approach, rel=1e-6)
        for name, value in truth.by.items():
            assert found.by[name][k] == pytest.approx(value, rel=1e-6, abs=1e-6 * truth.value)


def test_deviations_of_noisy_curves_cover_the_truth():
    """Twelve curves of 400 points by Hertz' formula, sigma from the baseline, five parameters."""
    random, depth = np.random.default_rng(11), np.linspace(-1e-6, 5e-7, 400)
    truth = {"reduced_modulus": 4e3, "zero_point": 3e-8, "load_offset": 1e-10, "tilt": 2e-5}
    approach = depth - truth["zero_point"]
    exact = 4 / 3 * 4e3 * np.sqrt(2.5e-6) * np.maximum(approach, 0.0) ** 1.5
    exact += truth["load_offset"] + truth["tilt"] * approach
    pulls = []
    for _ in range(12):
        data = IndentationData(depth, exact + 2e-11 * random.normal(size=400))
        found = fit(ball(2.5e-6, 1e3), data, tuple(truth), rtol=1e-8)
        pulls.append([(found[name] - value) / found.error(name) for name, value in truth.items()])
    assert np.sqrt(np.mean(np.square(pulls))) == pytest.approx(1.0, abs=0.25)
    assert np.abs(pulls).max() < 4.0


SIDES = {
    "NanoScope": "Defl_V_Ex\tDefl_V_Rt\tDefl_pN_Ex\tDefl_pN_Rt\tSep_nm_Ex\tSep_nm_Rt",
    "unit before": "V_Ex\tV_Rt\tForce(pN)_Ex\tForce(pN)_Rt\tSeparation(nm)_Ex\tSeparation(nm)_Rt",
    "unit behind": "V_Ex\tV_Rt\tForce_Ex(pN)\tForce_Rt(pN)\tSeparation_Ex(nm)\tSeparation_Rt(nm)",
}


@pytest.mark.parametrize("headings", SIDES.values(), ids=SIDES)
def test_both_directions_side_by_side_are_two_parts(tmp_path, headings):
    """By Hertz' formula: E* = 16 kPa, 5 um, 5 pN of noise; the retraction is shorter."""
    pytest.importorskip("pint", reason="part of the extra: units")
    noise = np.random.default_rng(3).normal(0.0, 5.0, (2, 128))
    depth = np.linspace(-600.0, 400.0, 128)
    loads = 4 / 3 * 16e3 * np.sqrt(5e-6) * (np.clip(depth, 0.0, None) * 1e-9) ** 1.5 * 1e12
    lines = [headings]
    if "Defl" in headings:
        lines = [r"\*Force file list", r"\*File list end", headings]
    first = len(lines) + 1
    for k in range(128):
        out, back = loads[k] + noise[0, k], loads[-1 - k] + noise[1, k]
        cells = [out / 1e3, back / 1e3, out, back, -depth[k], -depth[-1 - k]]
        texts = [f"{one:.5f}" for one in cells]
        if k >= 121:
            texts[1::2] = ["", "", ""]
        lines.append("\t".join(texts))
    path = tmp_path / "curve.txt"
    path.write_bytes("\r\n".join(lines).encode())
    data = IndentationData.from_file(path)
    told(data, f"part: approach, 128 points (lines {first} to {first + 127}); retraction has 121")
    back = IndentationData.from_file(path, part="retraction", sigma=5e-12)
    assert len(back.depth) == 121
    for curve in (data, back):
        found = fit(ball(5e-6, 1e3), curve, ("reduced_modulus", "zero_point"))
        assert abs(found["reduced_modulus"] - 16e3) < 4.0 * found.error("reduced_modulus")
        assert abs(found["zero_point"]) < 4.0 * found.error("zero_point")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_a_spreadsheet_of_a_german_windows(tmp_path, encoding):
    """By Hertz' formula: E* = 16 kPa, 5 um, touch at 80 nm."""
    pytest.importorskip("pint", reason="part of the extra: units")
    lines = ["Eindringtiefe [µm];Kraft [nN];Bemerkung"]
    for depth in np.linspace(-0.5, 0.4, 40):
        load = 4 / 3 * 16e3 * np.sqrt(5e-6) * (max(depth, 0.0) * 1e-6) ** 1.5 * 1e9
        lines.append(f"{depth + 0.08:.6f};{load:.6f};".replace(".", ","))
    path = tmp_path / "Kurve.csv"
    path.write_bytes("\r\n".join([*lines, ";;", ""]).encode(encoding))
    data = IndentationData.from_file(path, sigma=1e-12)
    told(data, "1 rows left out: line 42, column 1 (depth): there is no value")
    found = fit(ball(5e-6, 1e3), data, ("reduced_modulus", "zero_point"))
    assert found["reduced_modulus"] == pytest.approx(16e3, rel=1e-4)
    assert found["zero_point"] == pytest.approx(8e-8, rel=1e-4)
