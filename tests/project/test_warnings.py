"""Which warnings fail a test; the filters are in pyproject.toml."""

import warnings

import numpy as np
import pytest


@pytest.mark.parametrize(
    ("category", "module", "fails"),
    [
        (DeprecationWarning, "spectral_contact.scene", True),
        (UserWarning, "spectral_contact", True),
        (FutureWarning, "tests.unit.test_scene", True),
        (DeprecationWarning, "__main__", True),  # examples in the documentation
        (RuntimeWarning, "numpy.linalg._linalg", True),
        (RuntimeWarning, "scipy.special", True),
        (UserWarning, "scipy.integrate._quadpack_py", True),
        (ResourceWarning, "anybody", True),
        (pytest.PytestUnraisableExceptionWarning, "_pytest.unraisableexception", True),
        (DeprecationWarning, "matplotlib._mathtext", False),
        (DeprecationWarning, "scipy.sparse", False),
        (FutureWarning, "xarray.core.dataset", False),
        (UserWarning, "distributed.node", False),
    ],
)
def test_our_warnings_are_errors_and_those_of_others_are_not(category, module, fails):
    def warn():
        warnings.warn_explicit("text", category, "file.py", 1, module=module)

    if fails:
        with pytest.raises(category):
            warn()
    else:
        warn()


def test_arithmetic_that_leaves_the_doubles_fails():
    with pytest.raises(RuntimeWarning, match="divide by zero"):
        np.float64(1.0) / np.zeros(1)
    with pytest.raises(RuntimeWarning, match="overflow"):
        np.linalg.norm(np.array([[1e200, 1e200]]), axis=1)  # in NumPy's own lines


def test_what_a_function_says_to_its_caller_fails():
    def old():
        warnings.warn("use another", DeprecationWarning, stacklevel=2)

    with pytest.raises(DeprecationWarning, match="use another"):
        old()
