"""What every test shares: one thread for BLAS, no deadlines, and the list of extended tests."""

import gc
import os
import tomllib
from fnmatch import fnmatchcase
from pathlib import Path

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # before numpy is imported

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

EXTENDED = Path(__file__).parent / "extended.toml"


def pytest_configure(config):
    """Draw the same examples in each run, or others with --hypothesis-seed; fewer in the short one.

    Machines differ: there are no deadlines.
    """
    settings.register_profile(
        "suite",
        deadline=None,
        derandomize=config.getoption("hypothesis_seed") is None,
        max_examples=4 if config.option.markexpr == "not extended" else 25,
    )
    settings.load_profile("suite")


def stays(number, case, kept):
    """Whether the short run has a case: one of every `kept`, or one that a pattern names."""
    if isinstance(kept, int):
        return number % kept == 0
    return any(fnmatchcase(case, pattern) for pattern in kept)


def pytest_collection_finish():
    """What is collected stays to the end: the garbage collector need not look at it each time."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(tryfirst=True)  # before marks select
def pytest_collection_modifyitems(config, items):
    """Mark what `extended.toml` lists; in a run of everything each line must be of a test."""
    table = tomllib.loads(EXTENDED.read_text(encoding="utf-8"))
    cases = {}
    files = set()
    for item in items:
        file = item.path.relative_to(config.rootpath).as_posix()
        files.add(file)
        name, _, case = item.name.partition("[")
        if name in table.get(file, ()):
            cases.setdefault((file, name), []).append((case[:-1], item))
    for (file, name), found in cases.items():
        for number, (case, item) in enumerate(found):
            if not stays(number, case, table[file][name]):
                item.add_marker(pytest.mark.extended)
    if config.args == config.getini("testpaths") and not config.getoption("lf", False):
        for file in files.intersection(table):  # a file is skipped where its packages lack
            for name, kept in table[file].items():
                ids = [case for case, _ in cases.get((file, name), ())]
                patterns = [] if isinstance(kept, int) else kept
                if not ids or not all(any(fnmatchcase(i, p) for i in ids) for p in patterns):
                    raise pytest.UsageError(f"{EXTENDED.name}: {file}: {name}: no such test")


@pytest.fixture
def corrections(monkeypatch):
    """Return a list that takes the size of every linear system, of which there are few."""
    from spectral_contact.contact.layered_newton import LayeredNewton

    sizes = []
    linear_step = LayeredNewton._linear_step

    def counted(self, *arguments):
        sizes.append(len(arguments[-1]))
        assert len(sizes) < 1000
        return linear_step(self, *arguments)

    monkeypatch.setattr(LayeredNewton, "_linear_step", counted)
    return sizes
