import copy
import pickle

import numpy as np
import pytest

from spectral_contact import errors
from spectral_contact.errors import (
    ConvergenceError,
    MissingDependencyError,
    NotComputedError,
    SceneError,
    SolutionFileError,
    SpectralContactError,
)

ONE_OF_EACH = [
    SpectralContactError("something"),
    SceneError("poisson_ratio", 0.7, "in (-1, 0.5]"),
    SceneError("load, approach", (1.0, 2.0), "one value and one None"),
    NotComputedError("zones", "the scene has no friction"),
    ConvergenceError("500 unknowns did not suffice", "raise max_unknowns", {"approach": 0.125}),
    SolutionFileError("a.npz", "not a solution"),
    MissingDependencyError("matplotlib", "plot"),
]


class Unpicklable:
    def __repr__(self):
        return "Unpicklable()"

    def __reduce__(self):
        raise RuntimeError("no")


class Unprintable:
    def __repr__(self):
        raise RuntimeError("no")


def through_pickle(error, protocol=pickle.HIGHEST_PROTOCOL):
    return pickle.loads(pickle.dumps(error, protocol))


@pytest.mark.parametrize(
    ("kind", "builtin"),
    [
        (SceneError, ValueError),
        (NotComputedError, Exception),
        (ConvergenceError, Exception),
        (SolutionFileError, ValueError),
        (MissingDependencyError, ImportError),
    ],
)
def test_tree(kind, builtin):
    assert issubclass(kind, SpectralContactError)
    assert issubclass(kind, builtin)


def test_all_is_complete():
    classes = {
        name
        for name, thing in vars(errors).items()
        if isinstance(thing, type) and thing.__module__ == errors.__name__
    }
    assert set(errors.__all__) == classes | {"optional", "shown"}


def test_every_class_is_drawn_in_the_tree():
    for name in set(errors.__all__) - {"shown"}:
        assert name in errors.__doc__


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("error", ONE_OF_EACH, ids=lambda error: type(error).__name__)
def test_pickle_keeps_everything(error, protocol):
    again = through_pickle(error, protocol)
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert again.args == error.args
    assert vars(again) == vars(error)


@pytest.mark.parametrize("error", ONE_OF_EACH, ids=lambda error: type(error).__name__)
def test_copies_keep_everything(error):
    for again in (copy.copy(error), copy.deepcopy(error)):
        assert str(again) == str(error)
        assert vars(again) == vars(error)


def test_notes_survive():
    error = SceneError("s", 2.0, "in [0, 1]")
    error.add_note("in scene 17")
    assert through_pickle(error).__notes__ == ["in scene 17"]


def test_keywords_work_too():
    error = SceneError(parameter="s", value=2.0, allowed="in [0, 1]")
    assert vars(through_pickle(error)) == {"parameter": "s", "value": 2.0, "allowed": "in [0, 1]"}


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.7, "0.7"),
        (np.float64(0.7), "0.7"),
        (np.int8(-3), "-3"),
        ("0.3", "'0.3'"),
        (None, "None"),
        (float("nan"), "nan"),
        (np.array([[1.0, 2.0], [3.0, 4.0]]), "array([[1., 2.], [3., 4.]])"),
        pytest.param(10**5000, "<int>", id="int beyond the digit limit"),
        pytest.param(Unprintable(), "<Unprintable>", id="Unprintable"),
    ],
)
def test_scene_error_message(value, shown):
    error = SceneError("poisson_ratio", value, "in (-1, 0.5]")
    assert str(error) == f"poisson_ratio = {shown}: must be in (-1, 0.5]"
    assert error.parameter == "poisson_ratio"
    assert error.value is value
    assert error.allowed == "in (-1, 0.5]"


def test_long_values_are_cut():
    assert len(str(SceneError("s", "x" * 10_000, "in [0, 1]"))) < 120


def test_names_of_files_may_have_line_breaks():
    error = SolutionFileError("a\nb.npz", "not a\r\nsolution")
    assert str(error) == "a b.npz: not a solution"
    assert error.source == "a\nb.npz"


def test_a_value_that_cannot_be_pickled_becomes_its_text():
    error = SceneError("friction", Unpicklable(), ">= 0")
    again = through_pickle(error)
    assert again.value == "Unpicklable()"
    assert str(again) == str(error) == "friction = Unpicklable(): must be >= 0"


def test_not_computed_error_gives_the_plans_reason():
    error = NotComputedError("zones", "the scene has no friction")
    assert str(error) == "zones not computed: the scene has no friction"


def test_convergence_error_carries_the_solution_and_says_what_to_do():
    solution = object()
    error = ConvergenceError("stagnated at 3e-12", "ask for rtol >= 1e-11", solution)
    assert error.solution is solution
    assert str(error) == "stagnated at 3e-12; ask for rtol >= 1e-11"
    assert ConvergenceError("a", "b").solution is None


def test_missing_dependency_error_names_the_extra():
    error = MissingDependencyError("matplotlib", "plot")
    assert 'pip install ".[plot]"' in str(error)
    assert error.name == through_pickle(error).name == "matplotlib"
