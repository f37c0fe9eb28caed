"""A line of progress: where somebody watches, and nowhere else."""

import math
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest

from spectral_contact import (
    MissingDependencyError,
    Scene,
    SceneError,
    fit,
    profiles,
    reference,
    solve,
)
from spectral_contact.calibration import ApproachData, IndentationData
from spectral_contact.view.progress import ProgressLine

pytest.importorskip("tqdm")


def on_a_terminal(monkeypatch):
    """Make stderr one; not as a fixture, before whose test pytest puts another in its place."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)


def worked(wanted):
    with ProgressLine(wanted) as tell:
        tell("begun", 0.25)
        tell("more of it")
        tell("", 1.0)


def test_silent_where_nobody_watches(capsys):
    worked(None)
    worked(False)
    assert capsys.readouterr() == ("", "")


def test_shown_on_a_terminal_and_gone_afterwards(monkeypatch, capsys):
    on_a_terminal(monkeypatch)
    worked(False)
    assert capsys.readouterr().err == ""
    worked(None)
    out, err = capsys.readouterr()
    assert out == ""
    assert " 25 %|" in err
    assert "more of it" in err
    assert "100 %" in err
    assert err.rpartition("\r")[2].strip() == ""


def test_shown_anywhere_if_asked_for(capsys):
    worked(True)
    assert "begun" in capsys.readouterr().err


def test_without_a_share_there_is_no_bar(capsys):
    with ProgressLine(True) as tell:
        tell("evaluation 1")
        tell("evaluation 2")
    err = capsys.readouterr().err
    assert "evaluation 2" in err
    assert "%" not in err


def test_silent_in_a_process_that_works_for_another(monkeypatch, capsys):
    on_a_terminal(monkeypatch)
    monkeypatch.setattr("multiprocessing.parent_process", lambda: SimpleNamespace(pid=1))
    worked(None)
    assert capsys.readouterr().err == ""


def test_shown_in_a_notebook(monkeypatch, capsys):
    shell = SimpleNamespace(config={"IPKernelApp": {}})
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    # as tqdm.auto has it where there are no widgets
    monkeypatch.setitem(sys.modules, "tqdm.auto", sys.modules["tqdm.std"])
    worked(None)
    assert "100 %" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    worked(None)
    assert capsys.readouterr().err == ""


def test_without_tqdm_nothing_is_shown_unless_it_is_asked_for(monkeypatch, capsys):
    on_a_terminal(monkeypatch)
    monkeypatch.setitem(sys.modules, "tqdm.std", None)
    worked(None)
    assert capsys.readouterr().err == ""
    with pytest.raises(MissingDependencyError, match=r"\.\[progress\]"):
        worked(True)


def test_no_thread_is_left_behind():
    before = threading.active_count()
    with ProgressLine(True) as tell:
        tell("begun", 0.0)
        assert threading.active_count() == before


def test_tqdm_is_not_imported_before_it_is_needed():
    code = (
        "import sys, spectral_contact as sc\n"
        "sc.sweep, sc.fit, sc.reference, sc.studies\n"
        "print('tqdm' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_something_else_is_refused():
    with pytest.raises(SceneError, match="progress = 'yes'"):
        ProgressLine("yes")


def test_fits_references_and_energies_show_their_steps(capsys):
    data = ApproachData([0.3], sigma=0.1)
    fit(Scene(0.3, 0.5), data, "normal_compliance", progress=True)
    assert "evaluation 2" in capsys.readouterr().err
    reference(Scene(0.3, 0.5), 15, progress=True)
    err = capsys.readouterr().err
    assert "mesh 1 of 2: operators of a disk" in err
    assert "mesh 2 of 2: normal contact" in err
    solve(Scene(0.3)).inside.energies(progress=True)
    assert "energies" in capsys.readouterr().err


def test_fits_of_curves_and_smooth_coupled_slip_show_their_steps(capsys):
    known = {"poisson_ratio": 0.3, "profile": profiles.Parabola(1.0), "load": 1.0}
    ball = Scene.from_physical(**known, youngs_modulus=1e9)
    curve = IndentationData([1e-6, 2e-6], [1.5, 4.1], 1.0)
    fit(ball, curve, "reduced_modulus", rtol=1e-4, progress=True)
    assert "evaluation 1" in capsys.readouterr().err
    solve(Scene(0.3, 0.5, 0.0, 0.05, coupling=True), 1e-3, progress=True)
    assert "zones of stick and slip" in capsys.readouterr().err


def test_friction_under_a_profile_shows_how_the_contact_grew(monkeypatch, capsys):
    ball = Scene(0.3, 0.5, 0.5, math.inf, profile=profiles.Parabola(1.0), load=1.0)
    on_a_terminal(monkeypatch)
    for wanted, shown in ((None, True), (False, False)):
        solve(ball, 1e-3, ["total_shear"], progress=wanted)
        assert ("as the contact grew: radius" in capsys.readouterr().err) == shown
    solve(Scene(0.3, 0.5, 0.5, 0.1), 1e-3, progress=True)  # it takes no time
    assert capsys.readouterr().err == ""
    with pytest.raises(SceneError, match="progress = 1"):
        solve(ball, 1e-3, progress=1)
