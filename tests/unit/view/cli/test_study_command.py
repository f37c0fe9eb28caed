"""``spectral-contact study``: what it asks of the studies, and what it says when it cannot."""

import subprocess
import sys

import peers
import pytest
import rings

from spectral_contact import Scene
from spectral_contact.__main__ import main
from spectral_contact.studies import OwnSolver, convergence, load, work_precision
from spectral_contact.view.cli import options as readers
from spectral_contact.view.cli import study_command

FRICTIONLESS = ("--friction", "none")


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact study``."""
    status = main(["study", *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.fixture
def asked(monkeypatch):
    """Record what is asked of the studies, which take their times quickly."""
    calls = []

    def spied(study):
        def spy(*arguments, **options):
            calls.append((arguments, dict(options)))
            return study(*arguments, **{"repeats": 1, **options})

        return spy

    monkeypatch.setattr(study_command, "convergence", spied(convergence))
    monkeypatch.setattr(study_command, "work_precision", spied(work_precision))
    return calls


def test_convergence_of_the_library_on_the_default_scene(capsys, asked):
    status, out, err = run(capsys, "convergence", "--no-times")
    assert (status, err) == (0, "")
    (solver, scene, resolutions), options = asked[0]
    assert (solver, scene) == (OwnSolver(None), Scene(0.1, 0.5, 0.5, 0.1))
    assert resolutions == tuple(10.0**-k for k in range(2, 13))
    assert options == {
        "name": None,
        "repeats": 0,
        "quantities": None,
    }
    assert "truth: gold table slip_equal, 27 digits" in out


def test_the_library_is_asked_for_what_is_studied_alone(capsys, asked):
    options = ("--quantity", "approach", "edge_pressure", "pressure", "--resolutions", "1e-3")
    status, out, _ = run(capsys, "convergence", *FRICTIONLESS, *options)
    assert status == 0
    assert asked[0][0][0] == OwnSolver(("approach", "edge_pressure", "pressure"))
    assert "repeats" not in asked[0][1]
    assert "cold [ms]" in out


def test_a_solver_of_the_user_and_its_files(capsys, asked, tmp_path):
    pytest.importorskip("matplotlib")
    files = {name: str(tmp_path / name) for name in ("x.json", "x.png")}
    options = ("--solver", "peers:Decaying", "--resolutions", "8", "16", "2.5e1")
    paths = ("--output", files["x.json"], "--plot", files["x.png"])
    status, out, err = run(capsys, "convergence", *FRICTIONLESS, *options, *paths)
    assert (status, err) == (0, "")
    (solver, scene, resolutions), _ = asked[0]
    assert (solver, scene) == (peers.Decaying, Scene(0.1, 0.5, 0.5))
    assert [type(n) for n in resolutions] == [int, int, float]
    study = load(files["x.json"])
    assert f"{study}\n" == out
    assert [point.unknowns for point in study.points] == [24, 48, None]
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")


def test_solvers_beside_the_library(capsys, asked, tmp_path):
    path = tmp_path / "x.csv"
    status, out, err = run(
        capsys,
        "work-precision",
        *FRICTIONLESS,
        *("--solver", "peers:Decaying=8,16", "--solver", "rings:graded=4"),
        *("--quantity", "approach", "--accuracies", "1e-1", "0.01", "--output", str(path)),
    )
    assert (status, err) == (0, "")
    (solvers, scene, accuracies), _ = asked[0]
    assert scene == Scene(0.1, 0.5, 0.5)
    assert list(accuracies) == [0.1, 0.01]
    assert solvers["peers:Decaying"] == (peers.Decaying, [8, 16])
    assert solvers["rings:graded"] == (rings.graded, [4])
    assert next(iter(solvers)) == "spectral_contact"
    assert "peers:Decaying [ms]" in out
    assert path.read_text(encoding="utf-8").count("rings:graded") == 1


def test_a_solver_without_resolutions_is_called_with_the_accuracies(capsys, asked):
    options = ("--solver", "peers:Decaying", "--quantity", "approach", "--accuracies", "0.5")
    assert run(capsys, "work-precision", *FRICTIONLESS, *options)[0] == 0
    assert asked[0][0][0]["peers:Decaying"] is peers.Decaying


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "give a kind: convergence, work-precision"),
        (["speed"], "speed"),
        (
            ["convergence", "--solver", "peers:Decaying"],
            "peers:Decaying needs --resolutions",
        ),
        (
            ["convergence", "--solver", "peers", "--resolutions", "1"],
            "--solver = 'peers': must be written module:",
        ),
        (["convergence", "--solver", "no.such:f", "--resolutions", "1"], "ModuleNotFoundError"),
        (["convergence", "--resolutions", "0"], "--resolutions = 0: must be finite and > 0"),
        (["convergence", "--resolutions", "many"], "'many' is not a number"),
        (["convergence", "--resolutions", "1_0"], "'1_0' is not a number"),
        (["convergence", "--resolutions", "1e400"], "not within the range of a double"),
        (["convergence", "--quantity", "wear"], "--quantities = 'wear': must be one of"),
        (["convergence", *FRICTIONLESS, "--quantity", "traction"], "--quantities = 'traction'"),
        (["convergence", "--output", "x.npz"], "x.npz: the suffix must be one of .json, .csv"),
        (["convergence", "--plot", "x.gif"], "x.gif: the suffix"),
        (["convergence", "--plot", "no/x.png"], "no/x.png: its directory does not exist"),
        (["convergence", "--poisson-ratio", "3"], "--poisson-ratio = 3.0"),
        (["convergence", "--friction", "some"], "'some' is not a number"),
        (["work-precision", "--accuracies", "2"], "--accuracies = 2: must be in (0, 1)"),
        (
            ["work-precision", "--solver", "peers:Decaying=8,x"],
            "argument --solver: 'x' is not a number, in 'peers:Decaying=8,x' (see",
        ),
        (["work-precision", "--no-times"], "--no-times"),
    ],
)
def test_bad_input_is_one_line(capsys, monkeypatch, options, words):
    monkeypatch.setattr(OwnSolver, "__call__", None)
    status, out, err = run(capsys, *options)
    assert (status, out) == (2, "")
    assert err.startswith("spectral-contact: ")
    assert err.count("\n") == 1
    assert words in err


def test_a_missing_matplotlib_is_found_before_the_work(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setattr(study_command, "convergence", None)
    status, _, err = run(capsys, "convergence", "--plot", "x.png")
    assert status == 2
    assert 'pip install ".[plot]"' in err


def test_the_table_is_printed_even_if_it_cannot_be_written(capsys, asked, monkeypatch, tmp_path):
    monkeypatch.setattr(readers, "checked_path", lambda path, _: path)
    options = ("--no-times", "--resolutions", "1e-3", "--output", str(tmp_path / "no" / "x.json"))
    status, out, err = run(capsys, "convergence", *FRICTIONLESS, *options)
    assert status == 2
    assert "truth: gold table frictionless" in out
    assert "x.json: its directory does not exist" in err


@pytest.mark.parametrize("kind", ["convergence", "work-precision"])
def test_help(capsys, kind):
    status, out, _ = run(capsys, kind, "--help")
    assert status == 0
    for option in ("--poisson-ratio", "--solver", "--quantity", "--output", "--plot"):
        assert f"{option} " in out


def test_a_solver_in_the_current_folder(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from types import SimpleNamespace\n"
        "def solve(scene, n):\n"
        "    return SimpleNamespace(approach=0.29295979691047814 * (1 + n**-3))\n",
        encoding="utf-8",
    )
    for resolutions, said in (
        (["4", "8", "16", "--no-times"], "order 3.000 [3.000, 3.000]"),
        (["4"], "times: medians and quartiles, one BLAS thread"),
    ):
        options = ["--friction", "none", "--solver", "mine:solve", "--resolutions", *resolutions]
        command = [sys.executable, "-P", "-m", "spectral_contact", "study", "convergence", *options]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert said in done.stdout


def test_a_study_in_which_every_solve_fails_says_why(capsys):
    options = ("--solver", "peers:fails", "--resolutions", "10", "20", "--no-times")
    status, out, err = run(capsys, "convergence", *FRICTIONLESS, *options)
    assert status == 1
    assert "it never converges" in out
    assert err.startswith("spectral-contact: none of 2 solves was done; the first one: peers:fail")
    assert err.count("\n") == 1
