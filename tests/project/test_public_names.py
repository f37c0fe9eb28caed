"""The names at the top: all public ones and no others, loaded when they are used."""

import inspect
import pickle
import subprocess
import sys

import pytest

import spectral_contact as sc

MODULES = ["asperities", "benchmarks", "calibration", "closed_forms", "gold", "plotting"]
MODULES += ["precise", "studies", "testing"]
FUNCTIONS = ["adhesion_cycle", "compare", "explore", "fit", "plan", "pull_off", "reference"]
FUNCTIONS += ["solve", "sweep"]


def python(code):
    """Run code in a fresh interpreter, and return what it prints."""
    return subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout


def test_what_is_listed_is_what_is_public():
    code = "import spectral_contact as sc, spectral_contact.io.storage; print(*dir(sc))"
    assert set(python(code).split()) == {*sc.__all__, "__version__"}
    assert {*MODULES, *FUNCTIONS} <= set(sc.__all__)


def test_modules_are_loaded_when_they_are_used():
    code = (
        "import sys, spectral_contact as sc\n"
        "before = {n: m for n, m in sys.modules.items() if n.startswith('spectral_contact')}\n"
        f"for name in {MODULES}:\n"
        "    for loaded in [n for n in sys.modules if n.startswith('spectral_contact')]:\n"
        "        del sys.modules[loaded]\n"
        "    sys.modules.update(before)\n"
        "    vars(sc).pop(name, None)\n"
        "    found = getattr(sc, name).__name__\n"
        "    print(name, found in before, found in sys.modules)\n"
    )
    assert python(code).splitlines() == [f"{name} False True" for name in MODULES]


def test_functions_stay_functions_whatever_is_imported():
    code = (
        "import importlib, pkgutil, spectral_contact as sc\n"
        "for one in pkgutil.iter_modules(sc.__path__):\n"
        "    if one.name != '__main__':\n"
        "        importlib.import_module('spectral_contact.' + one.name)\n"
        f"for name in {FUNCTIONS}:\n"
        "    print(type(getattr(sc, name)).__name__, getattr(sc, name).__name__)\n"
    )
    assert python(code).splitlines() == [f"function {name}" for name in FUNCTIONS]


FLAT = sc.Scene(0.3, 0.5, 0.5, 0.1)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (
            lambda: sc.solve(FLAT, tol=1e-3),
            r"solve\(\) has no parameter 'tol'; did you mean rtol\?",
        ),
        (lambda: sc.plan(FLAT, quantites=["approach"]), r"did you mean quantities\?"),
        (
            lambda: sc.Scene(0.3, mu=0.1),
            r"Scene\(\) has no parameter 'mu'; did you mean friction\?",
        ),
        (lambda: sc.Scene(0.3, youngs_modulus=1e9), r"SI units go to Scene.from_physical"),
        (lambda: sc.Scene(0.3, radius=1.0), r"SI units go to Scene.from_physical"),
        (
            lambda: sc.Scene.from_physical(youngs_modulus=1e9, nu=0.3),
            r"Scene.from_physical\(\) has no parameter 'nu'; did you mean poisson_ratio\?",
        ),
        (lambda: sc.compare(FLAT, aproach=0.3), r"did you mean approach\?"),
        (lambda: sc.sweep(FLAT, alpha=[0.1]), r"did you mean normal_compliance\?"),
        (lambda: sc.fit(FLAT, [], [], tolerance=1e-3), r"did you mean rtol\?"),
        (lambda: sc.reference(FLAT, dps=30), r"did you mean digits\?"),
        (lambda: sc.Scene(0.3, colour="red"), r"no parameter 'colour'$"),
    ],
)
def test_an_unknown_keyword_is_a_type_error_that_says_what_was_meant(call, told):
    with pytest.raises(TypeError, match=told):
        call()


def test_an_unknown_attribute_gets_a_suggestion():
    solution = sc.solve(FLAT, 1e-3, ["approach"])
    with pytest.raises(AttributeError, match=r"'delta'; did you mean approach\?$"):
        solution.delta  # noqa: B018
    with pytest.raises(AttributeError, match=r"'nu'; did you mean poisson_ratio\?$"):
        FLAT.nu  # noqa: B018
    assert not hasattr(solution, "__array__")
    with pytest.raises(sc.NotComputedError):  # the error of a property is not replaced
        solution.total_shear  # noqa: B018


def test_what_is_wrapped_for_suggestions_can_be_pickled_and_inspected():
    for function in (sc.solve, sc.plan, sc.compare, sc.sweep, sc.fit, sc.reference):
        assert pickle.loads(pickle.dumps(function)) is function
    assert "poisson_ratio" in inspect.signature(sc.Scene).parameters
    assert "kwargs" not in str(inspect.signature(sc.solve))


def test_a_name_that_is_not_there_is_an_attribute_error():
    told = "'spectral_contact' has no attribute 'slove'"
    with pytest.raises(AttributeError, match=told) as refusal:
        sc.slove  # noqa: B018
    assert (refusal.value.name, refusal.value.obj) == ("slove", sc)  # tracebacks suggest by these
