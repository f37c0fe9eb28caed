"""The names at the top: all public ones and no others, loaded when they are used."""

import subprocess
import sys

import pytest

import spectral_contact as sc

MODULES = ["asperities", "benchmarks", "calibration", "closed_forms", "gold", "paper", "plotting"]
MODULES += ["precise", "studies", "testing"]
FUNCTIONS = ["compare", "explore", "fit", "plan", "reference", "solve", "sweep"]


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


def test_a_name_that_is_not_there_is_an_attribute_error():
    told = "'spectral_contact' has no attribute 'slove'"
    with pytest.raises(AttributeError, match=told) as refusal:
        sc.slove  # noqa: B018
    assert (refusal.value.name, refusal.value.obj) == ("slove", sc)  # tracebacks suggest by these
