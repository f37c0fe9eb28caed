import argparse
import csv
import io
import re
import shlex
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import spectral_contact
from spectral_contact import ErrorEstimates, Scene, Solution, solve
from spectral_contact import __main__ as cli
from spectral_contact.__main__ import COMMANDS, _parser, main
from spectral_contact.io import units
from spectral_contact.processes import PROGRAM
from spectral_contact.view.cli import options, solve_command
from spectral_contact.view.cli.command import Documentation
from spectral_contact.view.cli.options import joined, number
from spectral_contact.view.cli.scene_options import SceneOptions

STEEL = ("--youngs-modulus", "2.1e11", "--poisson-ratio", "0.3", "--radius", "0.013")
SLIDING = (*STEEL, "--friction", "0.1")
STEEL_SCENE = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013}
QUICK = ("--rtol", "1e-4")
STUCK = ("--friction", "inf", *QUICK)


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact solve``."""
    status = main(["solve", *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def complaint(capsys, *options):
    """Return the one line that a failing command says."""
    status, out, err = run(capsys, *options)
    assert status == 2
    assert out == ""
    assert err.startswith("spectral-contact: ")
    assert err.count("\n") == 1
    return err


def value_of(out, label):
    """Return the value that the table of quantities shows."""
    line = next(line for line in out.splitlines() if line.startswith(f"  {label}  "))
    return re.split(r"\s{2,}", line.strip())[1]


@pytest.fixture
def solved(monkeypatch):
    """Record the arguments of every solve."""
    calls = []

    def spy(*arguments, **options):
        calls.append((arguments, options))
        return solve(*arguments, **options)

    monkeypatch.setattr(solve_command, "solve", spy)
    return calls


# --- scenes ---------------------------------------------------------------------------------------


def test_the_defaults_are_those_of_the_issue(capsys, solved):
    status, out, err = run(capsys)
    assert (status, err) == (0, "")
    (scene, rtol, quantities), options = solved[0]
    assert scene == Scene(0.1, 0.5, 0.5, 0.1)
    assert (rtol, quantities) == (1e-10, None)
    assert options == {"max_unknowns": 20_000, "strict": True}
    assert value_of(out, "stick radius").startswith("0.6475686430")
    assert value_of(out, "total shear").startswith("0.08678276969")


@pytest.mark.parametrize(
    ("friction", "expected"), [("none", None), ("NONE", None), ("inf", np.inf), ("0.25", 0.25)]
)
def test_every_scene_parameter_is_an_option(capsys, solved, friction, expected):
    options = ("--poisson-ratio", "-0.25", "--normal-compliance", "3", "--tangential-compliance")
    status, _, _ = run(capsys, *options, "1e-3", "--friction", friction, *QUICK)
    assert status == 0
    assert solved[0][0][0] == Scene(-0.25, 3.0, 1e-3, expected)


@pytest.mark.parametrize("text", ["0e-999", " 0.000 ", "+.0E7", "-0."])
def test_a_decimal_that_is_zero_is_one(text):
    assert number(text) == 0.0


@pytest.mark.parametrize("text", ["-1e-3", "-.5", "-5E-1"])
def test_negative_numbers_are_values_and_not_options(capsys, solved, text):
    status, _, _ = run(capsys, "--poisson-ratio", text, "--friction", "none", *QUICK)
    assert status == 0
    assert solved[0][0][0].poisson_ratio == float(text)


def test_the_request_is_passed_on(capsys, solved):
    options = ("--quantities", "approach, total_shear", "--max-unknowns", "500", "--no-strict")
    status, out, _ = run(capsys, *STUCK, *options)
    assert status == 0
    assert solved[0][0][1:] == (1e-4, ["approach", "total_shear"])
    assert solved[0][1] == {"max_unknowns": 500, "strict": False}
    assert "pressure, edge" not in out
    assert "zones" not in out


def test_si_input_makes_a_physical_scene(capsys, solved):
    compliances = ("--normal-compliance-si", "1e-14", "--tangential-compliance-si", "2e-14")
    status, out, _ = run(capsys, *STEEL, "--load", "1000", *compliances, *STUCK)
    scene = Scene.from_physical(
        **STEEL_SCENE,
        load=1000.0,
        normal_compliance=1e-14,
        tangential_compliance=2e-14,
        friction=np.inf,
    )
    assert status == 0
    assert solved[0][0][0] == scene
    table = out[out.index("\nSI ") :]
    physical = solve(scene, 1e-4).physical
    assert value_of(table, "load") == "1000 N"
    number, unit = value_of(table, "approach").split()
    assert unit == "m"
    assert float(number) == pytest.approx(physical.approach, rel=1e-4)
    number, unit = value_of(table, "pressure, edge").split()
    assert unit == "Pa"
    assert float(number) == pytest.approx(physical.pressure(from_edge=0.0), rel=1e-4)
    assert "to [m]" in table


def test_an_approach_yields_the_load(capsys, solved):
    options = ("--approach", "1e-6", "--friction", "0.1", "--quantities", "pressure", *QUICK)
    status, out, _ = run(capsys, *STEEL, *options)
    scene = Scene.from_physical(**STEEL_SCENE, approach=1e-6, friction=0.1)
    table = out[out.index("\nSI ") :]
    assert status == 0
    assert solved[0][0][0] == scene
    assert value_of(table, "approach") == "1e-06 m"
    load = float(value_of(table, "load").split()[0])
    assert load == pytest.approx(solve(scene, 1e-4, ["approach"]).physical.load, rel=1e-12)


def test_what_was_not_given_in_si_is_named(capsys):
    given = (*SLIDING, "--load", "1000", *QUICK)
    _, out, _ = run(capsys, *given, "--normal-compliance-si", "1e-14")
    assert "\nremarks\n  not given, and so left out: --tangential-compliance-si\n" in out
    both = ("--normal-compliance-si", "1e-14", "--tangential-compliance-si", "0")
    assert "remarks" not in run(capsys, *given, *both)[1]
    assert "remarks" not in run(capsys, *QUICK)[1]
    neither = run(capsys, *given)[1]
    assert "left out: --normal-compliance-si, --tangential-compliance-si\n" in neither
    frictionless = run(capsys, *STEEL, "--load", "1000", *both, *QUICK)[1]
    assert "left out: --friction\n" in frictionless
    assert "no friction; rtol" in frictionless


@pytest.mark.parametrize(
    ("alpha", "remark"),
    [
        ("5e-8", r"alpha\* = 2.22e+05 is > 1000: alpha = 5e-08 is in m/Pa (5e+07 nm/MPa)"),
        ("5e-24", r"alpha\* = 2.22e-11 is < 1e-09: alpha = 5e-24 is in m/Pa (5e-09 nm/MPa)"),
    ],
)
def test_a_compliance_in_another_unit_is_remarked(capsys, alpha, remark):
    options = ("--load", "1", "--friction", "none", "--normal-compliance-si", alpha, *QUICK)
    _, out, _ = run(capsys, *STEEL, *options, "--tangential-compliance-si", "0")
    assert remark.replace("\\", "") in out


def test_numbers_may_have_units(capsys, solved):
    pytest.importorskip("pint")
    options = ("--youngs-modulus", "210 GPa", "--radius", "13mm", "--load", "1 kN")
    compliance = ("--normal-compliance-si", "10 nm/MPa", "--friction", "none")
    status, _, err = run(capsys, *options, *compliance, "--poisson-ratio", "0.3", *QUICK)
    assert (status, err) == (0, "")
    assert solved[0][0][0] == Scene.from_physical(**STEEL_SCENE, load=1e3, normal_compliance=1e-14)


def test_a_unit_of_another_kind_is_one_line(capsys):
    pytest.importorskip("pint")
    line = complaint(capsys, *SLIDING, "--load", "1 mm")
    assert "--load = '1 mm': must be a number in N, or in a unit like it" in line


def test_a_missing_pint_is_one_line(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pint", None)
    units._registry.cache_clear()
    line = complaint(capsys, *SLIDING, "--load", "1 kN")
    assert line.startswith("spectral-contact: pint is not installed")
    assert line.endswith('pip install ".[units]" in your clone of spectral_contact\n')


# --- the report -----------------------------------------------------------------------------------


def test_the_report_has_values_estimates_zones_plan_and_work(capsys):
    status, out, _ = run(capsys, *STUCK)
    solution = solve(Scene(0.1, 0.5, 0.5, np.inf), 1e-4)
    assert status == 0
    assert "nu = 0.1, alpha* = 0.5, beta* = 0.5, full stick; rtol = 0.0001" in out
    for name in ("approach", "total_shear", "edge_ratio", "critical_friction"):
        shown = value_of(out, name.replace("_", " "))
        error = getattr(solution.error, name)
        assert float(shown) == pytest.approx(getattr(solution, name), rel=error)
        assert f"{error:.1e}" in out
    assert re.search(r"^  stick +0 +1 +0 +exact$", out, re.MULTILINE)
    for line in str(solution.plan).splitlines():
        assert line in out
    for step in solution.work.steps:
        assert re.search(rf"^  {step.name} +{step.unknowns} .* ms$", out, re.MULTILINE)
    assert out.endswith("converged: yes\n")
    assert out.isascii()


def test_only_timings_differ_from_run_to_run(capsys):
    def stripped(text):
        return re.sub(r"[0-9.]+ ms", "ms", text)

    first, second = run(capsys, *STUCK)[1], run(capsys, *STUCK)[1]
    assert stripped(first) == stripped(second)


def test_no_more_digits_are_shown_than_the_estimate_leaves(capsys):
    _, out, _ = run(capsys, *STUCK)
    solution = solve(Scene(0.1, 0.5, 0.5, np.inf), 1e-4)
    digits = len(value_of(out, "edge ratio").replace("0.", ""))
    assert digits <= 2 - np.log10(solution.error.edge_ratio)


def test_a_frictionless_report(capsys):
    status, out, _ = run(capsys, "--friction", "none", *QUICK)
    assert status == 0
    assert "no friction" in out
    assert "without friction there is neither stick nor slip" in out
    assert value_of(out, "stick radius") == "none"
    assert "edge ratio" not in out


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".json", ".npz"])
def test_solutions_are_stored_whole(capsys, tmp_path, suffix):
    path = tmp_path / f"solution{suffix}"
    status, out, _ = run(capsys, *STUCK, "--output", str(path))
    assert status == 0
    assert "converged" in out
    assert Solution.load(str(path)) == solve(Scene(0.1, 0.5, 0.5, np.inf), 1e-4)


def read_table(path):
    """Return the comment lines and the columns of a csv file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = csv.DictReader(io.StringIO("\n".join(lines[len(comments) :])))
    records = [{name: float(text) for name, text in row.items()} for row in rows]
    return comments, {name: np.array([row[name] for row in records]) for name in records[0]}


def test_a_table_of_the_fields(capsys, tmp_path):
    path = tmp_path / "fields.csv"
    status, _, _ = run(capsys, *QUICK, "--output", str(path))
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1), 1e-4)
    comments, columns = read_table(path)
    assert status == 0
    errors = ["p_error", "q_error", "slip_error"]
    assert list(columns) == ["s", "one_minus_s", "p", "q", "f_p", "slip", *errors]
    d = columns["one_minus_s"]
    assert 150 < len(d) < 300
    assert (d[0], d[-1]) == (1.0, 0.0)
    assert (np.diff(d) < 0.0).all()
    assert d[d > 0.0].min() < 1e-5
    assert np.isclose(columns["s"], solution.stick_radius, rtol=1e-15).any()
    near = d <= 0.5
    assert np.array_equal(columns["p"][near], solution.pressure(from_edge=d[near]))
    assert np.array_equal(columns["q"][~near], solution.traction(columns["s"][~near]))
    assert np.array_equal(columns["f_p"], 0.1 * columns["p"])
    assert np.array_equal(columns["slip"][near], solution.slip(from_edge=d[near]))
    text = "\n".join(comments)
    assert f"# approach = {solution.approach!r} " in text
    assert f"# zone: stick from 0.0 to {solution.stick_radius!r}" in text


def test_the_table_of_a_smooth_surface_is_accurate_near_its_singular_edge(capsys, tmp_path):
    path = tmp_path / "fields.csv"
    smooth = ("--normal-compliance", "0", "--tangential-compliance", "0", "--friction", "0")
    status, _, _ = run(capsys, *smooth, "--output", str(path), "--quantities", "pressure,traction")
    _, columns = read_table(path)
    assert status == 0
    assert list(columns) == ["s", "one_minus_s", "p", "q", "f_p", "p_error", "q_error"]
    assert columns["p"][-1] == np.inf
    d = columns["one_minus_s"][:-1]
    exact = 1.0 / (2.0 * np.pi * np.sqrt(d * (2.0 - d)))
    assert np.allclose(columns["p"][:-1], exact, rtol=1e-13, atol=0.0)
    assert not columns["f_p"].any()


def test_tables_are_the_same_from_run_to_run(capsys, tmp_path):
    texts = []
    for name in ("first.csv", "second.csv"):
        run(capsys, *STUCK, "--output", str(tmp_path / name))
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]


def test_the_table_has_si_values_when_the_input_has(capsys, tmp_path):
    path = tmp_path / "fields.csv"
    run(capsys, *STEEL, "--load", "1000", "--friction", "none", *QUICK, "--output", str(path))
    comments, columns = read_table(path)
    assert "f_p" not in columns
    assert any(re.fullmatch(r"# load = 1000\.0 N \(exact\)", line) for line in comments)
    assert any(line.startswith("# approach = ") and " m " in line for line in comments)


def test_a_plot(capsys, tmp_path):
    pytest.importorskip("matplotlib")
    path = tmp_path / "solution.png"
    status, _, _ = run(capsys, *STUCK, "--plot", str(path))
    assert status == 0
    assert path.read_bytes().startswith(b"\x89PNG")


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--poisson-ratio", "0.7"], "--poisson-ratio = 0.7: must be in (-1, 0.5]"),
        (["--poisson-ratio", "nan"], "--poisson-ratio = nan"),
        (["--poisson-ratio", "abc"], "--poisson-ratio: 'abc' is not a number"),
        (["--normal-compliance", "1e-20"], "--normal-compliance = 1e-20"),
        (["--tangential-compliance=-1"], "--tangential-compliance = -1.0"),
        (["--friction", "-0.1"], "--friction = -0.1: must be >= 0 (inf is full stick"),
        (["--friction", "nan"], "--friction = nan: must be >= 0 (inf"),
        (["--friction", "some"], "'some' is not a number"),
        (["--friction", "1e999"], "--friction: '1e999' is not within the range of a double"),
        (["--normal-compliance", "1e-400"], "'1e-400' is not within the range of a double"),
        (["--normal-compliance", "-1e-400"], "'-1e-400' is not within the range of a double"),
        (["--rtol", f"1e-{'9' * 30}"], "is not within the range of a double"),
        (["--rtol", "1_0e-4"], "--rtol: '1_0e-4' is not a number"),
        (["--rtol", "\u0661e-3"], "is not a number"),  # an Arabic digit
        (["--rtol", "\u20091e-3"], "is not a number"),
        (["--max-unknowns", "1_000"], "'1_000' is not a whole number"),
        (["--max-unknowns", "\u0661"], "is not a whole number"),
        (["--max-unknowns", "9" * 5000], "is not a whole number"),
        (["--rtol", "1"], "--rtol = 1.0"),
        (["--rtol", "1e-13"], "--rtol = 1e-13"),
        (["--rtol"], "--rtol"),
        (["--quantities", "wear"], "--quantities = 'wear'"),
        (["--quantities", ""], "--quantities = ''"),
        (["--max-unknowns", "0"], "--max-unknowns = 0"),
        (["--max-unknowns", "1.5"], "'1.5' is not a whole number"),
        (["--colour", "red"], "--colour"),
        (["--rto", "1e-3"], "unrecognized arguments: --rto 1e-3; did you mean --rtol? (see "),
        (["--nu", "0.3"], "unrecognized arguments: --nu 0.3; did you mean --poisson-ratio? (see "),
        (["--tol=1e-3"], "; did you mean --rtol? (see "),
        (["--quantites=approach"], "; did you mean --quantities? (see "),
        (["--quantities", "aproach"], "shakedown_ratio; did you mean approach?"),
        (["more"], "more"),
        (["--friction"], "--friction: expected one argument: coefficient of friction f, >= 0 ("),
        (["--friction", "mu"], "'mu' is not a number (which may have a unit, as '5 mm' or"),
        (["--friction", "-1"], "--friction = -1.0: must be >= 0 (inf is full stick, none no f"),
        (["--profile"], "--profile: expected one argument: one of parabola, sphere"),
        (
            ["--profile", "sphere", "-1"],
            "arguments: -1, after --profile sphere: quote a value",
        ),
        (["--kappa", "0", "--poisson-ratio", "0"], "give one of --kappa, --poisson-ratio: both"),
        (["--history", "h.csv"], "--history h.csv needs a contact that grows: --profile, --fric"),
        (
            ["--radius", "1"],
            "--poisson-ratio are missing: they must be given with SI data",
        ),
        (
            ["--load", "1"],
            "--poisson-ratio, --radius are missing: they must be given",
        ),
        ([*SLIDING], "give one of --load, --approach: none of them is given"),
        (
            [*SLIDING, "--load", "1", "--approach", "1"],
            "give one of --load, --approach: --load 1.0 and --app",
        ),
        ([*SLIDING, "--load", "-1"], "--load = -1.0"),
        ([*SLIDING, "--load", "1", "--normal-compliance-si", "1e5"], "--normal-compliance-si = 1"),
        (["--load", "1", "--friction", "0"], "--youngs-modulus, --poisson-ratio, --radius are"),
        ([*STEEL, "--load", "1", "--normal-compliance", "1"], "cannot be mixed"),
        ([*SLIDING, "--load", "1", "--normal-compliance-si", "none"], "-si = none: must be a real"),
        (["--normal-compliance-si", "1", "--tangential-compliance", "1"], "cannot be mixed"),
        (["--output", "solution.txt"], "solution.txt: the suffix must be one of .json, .csv, .npz"),
        (["--output", "solution"], "solution: the suffix"),
        (["--plot", "solution.gif"], "solution.gif: the suffix"),
        (["--plot", "x" * 300 + ".png"], "x.png: cannot be written: "),
        (["--output", "x/" * 3000 + "x.csv"], "x.csv: cannot be written: "),
        (["--output", "/no/such/place/x.json"], "/no/such/place/x.json"),
        (["--quantities", "approach", "--output", "x.csv"], "ask for one"),
    ],
)
def test_bad_input_is_one_line_before_any_work(capsys, monkeypatch, options, words):
    monkeypatch.setattr(spectral_contact.solving.solver, "_run", None)
    assert words in complaint(capsys, *options)


NO_NUMBERS = ("abc", "", " ", "1,5", "0x10", "1e", "--1", "1 2", "0.1.2", "½", "1j", "1\n2", "１")


@pytest.mark.parametrize("text", NO_NUMBERS)
@pytest.mark.parametrize("option", ["--friction", "--rtol", "--max-unknowns", "--youngs-modulus"])
def test_a_text_that_is_no_number_is_told_with_its_option(capsys, option, text):
    assert option in complaint(capsys, f"{option}={text}")


@pytest.mark.parametrize("word", ["~a\nb", "~\x1b[2J", "~\u2028", "'", "--\n", "-x", "="])
def test_a_stray_word_is_one_line(capsys, word):
    assert len(complaint(capsys, word).splitlines()) == 1
    assert len(complaint(capsys, "--no-strict", word).splitlines()) == 1


@pytest.mark.parametrize("options", [["--no-strict=1"], ["--output"], ["--plot", "--rtol=1e-3"]])
def test_a_flag_has_no_value_and_an_option_has_one(capsys, options):
    assert options[0].partition("=")[0] in complaint(capsys, *options)


def test_a_directory_is_no_output(capsys, tmp_path):
    path = tmp_path / "directory.csv"
    path.mkdir()
    assert "is a directory" in complaint(capsys, "--output", str(path))


@pytest.mark.parametrize("suffix", [".csv", ".json", ".npz", ".png"])
def test_the_result_is_printed_even_if_it_cannot_be_written(capsys, monkeypatch, tmp_path, suffix):
    if suffix == ".png":
        pytest.importorskip("matplotlib")
    monkeypatch.setattr(options, "checked_path", lambda path, _: path)
    path = tmp_path / "missing" / f"x{suffix}"
    option = "--plot" if suffix == ".png" else "--output"
    status, out, err = run(capsys, *STUCK, option, str(path))
    assert status == 2
    assert "converged: yes" in out
    assert err.startswith(f"spectral-contact: {path}: cannot be written")
    assert err.count("\n") == 1


def test_a_missing_matplotlib_is_one_line_before_any_work(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setattr(solve_command, "solve", None)
    line = complaint(capsys, "--plot", "x.png")
    assert line.startswith("spectral-contact: matplotlib is not installed")
    assert line.endswith('pip install ".[plot]" in your clone of spectral_contact\n')


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        ([], "give a command: solve, inside, cycle"),
        (["dissolve"], "invalid choice: 'dissolve'"),
        (["benchmark"], "give a kind: list, show, export (see spectral-contact benchmark --help)"),
        (["benchmark", "show", "smooth"], "argument NAME: invalid choice: 'smooth' (choose from"),
    ],
)
def test_a_command_is_needed(capsys, argv, words):
    assert main(argv) == 2
    err = capsys.readouterr().err
    assert err.startswith("spectral-contact: ")
    assert words in err
    assert err.count("\n") == 1


# --- endings --------------------------------------------------------------------------------------

LAYERS = ("--normal-compliance", "1e-6", "--tangential-compliance", "1e-3", "--friction", "inf")
TOO_FEW = (*LAYERS, "--max-unknowns", "1", "--rtol", "1e-12")


def test_a_tolerance_not_met_is_status_1(capsys):
    status, out, err = run(capsys, *TOO_FEW)
    assert (status, out) == (1, "")
    assert err.startswith("spectral-contact: ")
    assert "; the next space would exceed --max-unknowns. Raise --max-unknowns" in err
    assert "--no-strict" in err
    assert err.count("\n") == 1


def test_what_was_reached_is_printed_on_request(capsys):
    status, out, err = run(capsys, *TOO_FEW, "--no-strict")
    assert (status, err) == (0, "")
    assert "converged: no. The next space would exceed max_unknowns." in out
    assert "approach" in out


@pytest.mark.parametrize("error", [0.5, 3.0, np.inf, np.nan])
def test_useless_estimates_are_shown_as_they_are(capsys, monkeypatch, error):
    solution = solve(Scene(0.1, 0.5), 1e-2, ["approach"])
    bad = replace(solution, error=ErrorEstimates(approach=error), converged=False)
    monkeypatch.setattr(solve_command, "solve", lambda *_, **__: bad)
    status, out, _ = run(capsys)
    assert status == 0
    assert value_of(out, "approach") == "0.29"
    assert f"{error:.1e}" in out


def test_an_interrupt_is_status_130(capsys, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(solve_command, "solve", interrupt)
    status, out, err = run(capsys)
    assert (status, out, err) == (130, "", "spectral-contact: interrupted\n")


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"spectral-contact {spectral_contact.__version__}\n"


@pytest.mark.parametrize("argv", [["--help"], ["solve", "--help"]])
def test_help(capsys, argv):
    assert main(argv) == 0
    assert "solve" in capsys.readouterr().out


def test_help_names_every_scene_parameter(capsys):
    main(["solve", "--help"])
    out = capsys.readouterr().out
    for name in ("poisson-ratio", "normal-compliance", "tangential-compliance", "friction"):
        assert f"--{name} " in out


# --- as a process ---------------------------------------------------------------------------------


def process(*arguments, **options):
    command = [sys.executable, "-m", "spectral_contact", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_python_dash_m():
    done = process("solve", *STUCK)
    assert (done.returncode, done.stderr) == (0, "")
    assert value_of(done.stdout, "approach").startswith("0.29295979")


def test_python_dash_m_of_bad_input_has_the_status_of_one():
    failed = process("solve", "--poisson-ratio", "2")
    assert failed.returncode == 2
    assert failed.stderr == "spectral-contact: --poisson-ratio = 2.0: must be in (-1, 0.5]\n"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /dev/full")
def test_a_full_disk_behind_stdout_is_one_line():
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "spectral_contact", "solve", *STUCK]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "spectral-contact: standard output: No space left on device\n"


def test_coupling_is_an_option(capsys, solved):
    assert run(capsys, *STUCK, "--coupling")[0] == 0
    assert solved[0][0][0] == Scene(0.1, 0.5, 0.5, np.inf, coupling=True)


def test_the_report_says_where_the_contact_would_open(capsys, tmp_path):
    smooth = ("--normal-compliance", "0", "--tangential-compliance", "0", "--poisson-ratio", "0")
    status, out, _ = run(
        capsys, *STUCK, *smooth, "--coupling", "--plot", str(tmp_path / "coupled.png")
    )
    assert status == 0
    assert out.splitlines()[0].startswith(
        "nu = 0.0, alpha* = 0.0, beta* = 0.0, full stick, coupled"
    )
    assert value_of(out, "contact would open within") == "6.7e-05"
    assert "would open within 6.71e-05 of the edge" in out
    assert (tmp_path / "coupled.png").stat().st_size > 10_000


def parsers(parser, name):
    """Yield every command, and every kind of a command, with its name."""
    yield name, parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command, below in action.choices.items():
                yield from parsers(below, f"{name} {command}")


PARSERS = dict(parsers(cli._parser(), "spectral-contact"))


@pytest.mark.parametrize("name", PARSERS)
def test_help_speaks_of_options_that_the_command_has(name):
    parser = PARSERS[name]
    known = {option for action in parser._actions for option in action.option_strings}
    assert set(re.findall(r"--[a-z][a-z-]*[a-z]", parser.format_help())) <= known


def test_the_command_line_names_what_no_digit_is_known_of(capsys, monkeypatch):
    def unsure(*arguments, **options):
        solution = solve(*arguments, **options)
        return replace(solution, error=replace(solution.error, slip=float("inf")))

    monkeypatch.setattr(solve_command, "solve", unsure)
    layers = "--normal-compliance", "0.5", "--tangential-compliance", "0.5"
    status, out, _ = run(capsys, "--poisson-ratio", "0.3", *layers, "--friction", "0.1", *QUICK)
    assert status == 0
    [row] = [line for line in out.splitlines() if line.startswith("  slip, edge ")]
    assert row.endswith("   inf: no digit is known")
    assert "  slip: no digit is known\n" in out


@pytest.mark.parametrize("command", [name for name in COMMANDS if " " not in name])
def test_help_begins_with_examples_that_run(command, capsys):
    assert main([command, "--help"]) == 0
    told = capsys.readouterr().out
    assert told.index("examples:") < told.index("-h, --help")
    text = Documentation.of(COMMANDS[command]).examples
    assert text in told
    for example in text.replace("\\\n", "").partition("examples:")[2].strip().splitlines():
        program, *options = shlex.split(example)
        assert program == PROGRAM
        arguments = _parser().parse_args(joined(options))
        if command not in ("sweep", "fit"):  # which have scenes of their own
            assert isinstance(SceneOptions(vars(arguments)).build().scene, Scene)


def test_a_command_that_is_misspelt_gets_a_suggestion(capsys):
    assert main(["slove"]) == 2
    assert "; did you mean solve? (see " in capsys.readouterr().err
