"""A test that hangs fails, and the others are run."""

import subprocess
import sys
from pathlib import Path

import pytest

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"

#: Hypothesis catches exceptions of tests, and would run one again that a signal had interrupted.
HANGING = """
from time import sleep

from hypothesis import given, strategies


@given(strategies.integers())
def test_hangs(number):
    sleep(3600.0)


def test_passes():
    pass
"""


def test_every_test_has_a_limit(pytestconfig):
    assert 60.0 < float(pytestconfig.getini("timeout")) <= 3600.0


def test_a_test_that_hangs_fails_and_the_next_one_is_run(tmp_path):
    """With the settings of this repository, and less patience."""
    (tmp_path / "test_hanging.py").write_text(HANGING, encoding="utf-8")
    command = [
        *(sys.executable, "-m", "pytest", "-c", str(PYPROJECT), "--rootdir", str(tmp_path)),
        *("-p", "no:cacheprovider", "-n1", "--timeout=2", "-o", "faulthandler_timeout=1"),
        "test_hanging.py",
    ]
    try:
        done = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=500.0
        )
    except subprocess.TimeoutExpired:
        pytest.fail("the test that hangs was not ended")
    assert done.returncode == pytest.ExitCode.TESTS_FAILED, done.stdout + done.stderr
    assert "FAILED test_hanging.py::test_hangs" in done.stdout
    assert "1 failed, 1 passed" in done.stdout
    assert " in test_hangs" in done.stderr  # the stack
