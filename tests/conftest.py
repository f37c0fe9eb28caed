"""What every test shares: one thread for BLAS, no deadlines, and which tests only a release needs."""

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
    """Draw fewer examples where extended tests are left out; machines differ: no deadlines."""
    short = config.option.markexpr == "not extended"
    for name, count in (("short", 8), ("extended", 25)):
        settings.register_profile(name, deadline=None, max_examples=count)
    settings.load_profile("short" if short else "extended")


def stays(number, case, kept):
    """Whether the short run has a case: every n-th one, or those of some names."""
    if isinstance(kept, int):
        return number % kept == 0
    return any(fnmatchcase(case, pattern) for pattern in kept)


@pytest.hookimpl(tryfirst=True)  # before the marks select
def pytest_collection_modifyitems(config, items):
    """Mark what `extended.toml` lists; a line that is of no test is an error."""
    with EXTENDED.open("rb") as file:
        table = tomllib.load(file)
    cases = {}
    for item in items:
        file = item.path.relative_to(config.rootpath).as_posix()
        if file in table:
            name, _, case = item.name.partition("[")
            cases.setdefault(file, {}).setdefault(name, []).append((case[:-1], item))
    for file, tests in cases.items():
        for name, kept in table[file].items():
            found = tests.get(name, [])
            for number, (case, item) in enumerate(found):
                if not stays(number, case, kept):
                    item.add_marker(pytest.mark.extended)
            missing = (
                []
                if isinstance(kept, int)
                else [one for one in kept if not any(fnmatchcase(case, one) for case, _ in found)]
            )
            if (missing or not found) and not any("::" in one for one in config.args):
                raise pytest.UsageError(f"{EXTENDED.name}: {file}: {name}: no test {missing}")
