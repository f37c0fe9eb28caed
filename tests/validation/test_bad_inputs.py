"""A sample of the study of bad inputs, and that the study sees what it should."""

import sys
from pathlib import Path

import pytest

import spectral_contact.studies
from spectral_contact import SceneError
from spectral_contact.io.checks import real

pytest.importorskip("matplotlib")
pytest.importorskip("pint")
pytest.importorskip("xarray")

VALIDATION = Path(__file__).parents[2] / "validation" / "input"


@pytest.fixture(scope="module")
def study():
    """Return the module of the study."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(VALIDATION))
        import bad_inputs

        yield bad_inputs
    for name in ("bad_inputs", "bad_input_callables", "bad_input_examples"):
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def callables(study):
    return sys.modules["bad_input_callables"]


def test_a_sample_of_bad_inputs_is_refused_by_name(study):
    record = study.study(every=101)
    assert record["cases"] > 200
    assert record["violations"] == []


def test_every_public_callable_is_in_the_study(callables):
    names = {target.name for target in callables.targets()}
    some = {"solve", "Scene", "Scene.from_physical", "Solution.pressure", "studies.fit_rate"}
    some |= {
        "sweeps.plot_slice",
        "view.plotting.save",
        "testing.load",
        "studies.OwnSolver.__call__",
    }
    assert some <= names
    assert len(names) > 100


def lax(confidence: float) -> float:
    """Take everything."""
    return confidence


def misnaming(confidence: float) -> float:
    """Refuse everything under another name."""
    raise SceneError("count", confidence, "something else")


def good(confidence: float) -> float:
    """Check."""
    return real("confidence", confidence, allowed="finite")


@pytest.mark.parametrize(("new", "passes"), [(lax, False), (misnaming, False), (good, True)])
def test_a_new_callable_is_in_without_being_named(study, callables, monkeypatch, new, passes):
    monkeypatch.setattr(spectral_contact.studies, "new", new, raising=False)
    monkeypatch.setattr(spectral_contact.studies, "__all__", ["new"])
    monkeypatch.setattr(callables, "modules", lambda: ["spectral_contact.studies"])
    monkeypatch.setattr(callables, "Examples", Nothing)
    found = {case.label: study.tried(case)[1] for case in callables.cases(None)}
    for value in ("nan", "True", "(1+0j)", "'x'", "a broken one", "things without end"):
        assert (found[f"studies.new(confidence = {value})"] == []) == passes
    assert found["studies.new(confidence = -1.0)"] == []  # a float may be negative, or refused


class Nothing:
    """No examples."""

    def __init__(self, solutions):
        pass

    def arguments(self, name, parameters):
        return {}

    def company(self, name, parameter):
        return {}
