"""Break the library in one place at a time, and see whether the tests notice.

Run as ``python validation/mutants/mutants.py [--jobs N] [words ...]``; words choose the mutants
whose file or fault has one of them. Their rows in validation/results/mutants.json and .md are
written anew; the others stay, as long as mutants.toml has the same faults in the same texts. Each
mutant, an entry of mutants.toml, is one text of one file replaced by another, in a copy of the
tree, and the tests that are to fail then; a test whose fixture fails counts as one that fails.
Before, the same tests must pass without any mutant. A text that is not there exactly once, tests
that cannot be run and a mutant that lives end the script with status 1.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from time import perf_counter
from typing import Any, NamedTuple

sys.path.append(str(Path(__file__).parents[1]))

from reporting import stored, table, write

REPOSITORY = Path(__file__).parents[2]
TABLE = Path(__file__).parent / "mutants.toml"
LEFT_OUT = shutil.ignore_patterns(".*", "*.egg-info", "__pycache__", "results", "build", "_build")
SECONDS = 300.0
_LIVES = "lives"
#: What pytest returns if tests failed, and not if they could not be run.
FAILED = 1
#: The first test in what pytest prints that fails, or whose fixture does; a module that cannot be
#: imported, after ERROR too, has no name of a test.
FIRST = re.compile(r"^(?:FAILED|ERROR) (\S+::\S+)", re.MULTILINE)
#: Sources are compiled anew if their text is another, whatever the clock says.
COMPILE = ("-m", "compileall", "-q", "--invalidation-mode", "checked-hash", "spectral_contact")
TEST = ("-m", "pytest", "-x", "-q", "-n0", "-p", "no:cacheprovider")


class Mutant(NamedTuple):
    """One fault, as mutants.toml has it."""

    fault: str
    file: str
    old: str
    new: str
    tests: str


class Outcome(NamedTuple):
    """What became of a mutant: the test that fails, or why there is none."""

    killer: str
    complaint: str
    seconds: float


def chosen(words: Sequence[str]) -> list[Mutant]:
    """Return the mutants whose file or fault has one of the words; all without words."""
    mutants = [Mutant(**entry) for entry in tomllib.loads(TABLE.read_text("utf-8"))["mutant"]]
    return [
        one
        for one in mutants
        if not words or any(word in f"{one.file} {one.fault}" for word in words)
    ]


def mutated(mutant: Mutant) -> str:
    """Return the text of the file with the fault.

    Raises
    ------
    LookupError
        If what is to be replaced is not there exactly once.
    """
    path = REPOSITORY / mutant.file
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    count = text.count(mutant.old)
    if count != 1:
        raise LookupError(f"{mutant.file}: {count} times, not once: {mutant.old!r}")
    return text.replace(mutant.old, mutant.new)


def run(copy: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python in a copy of the tree."""
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=copy,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=SECONDS,
    )


def copied(folder: Path) -> Path:
    """Return a copy of the tree, compiled, and make sure that it is what Python imports there."""
    shutil.copytree(REPOSITORY, folder, ignore=LEFT_OUT)
    run(folder, *COMPILE)
    found = run(folder, "-c", "import spectral_contact; print(spectral_contact.__file__)").stdout
    if not Path(found.strip()).is_relative_to(folder):
        raise SystemExit(f"the copy in {folder} is not imported, but {found}")
    return folder


def tried(mutant: Mutant, copy: Path) -> Outcome:
    """Return what the tests of a mutant say of it."""
    target = copy / mutant.file
    whole = target.read_text(encoding="utf-8")
    begin = perf_counter()
    try:
        target.write_text(mutated(mutant), encoding="utf-8")
        done = run(copy, *TEST, *mutant.tests.split())
    except subprocess.TimeoutExpired:
        return Outcome("", f"no end in {SECONDS:.0f} s", perf_counter() - begin)
    finally:
        target.write_text(whole, encoding="utf-8")
    seconds, first = perf_counter() - begin, FIRST.search(done.stdout)
    if done.returncode == FAILED and first:
        return Outcome(first[1].removeprefix("tests/").split("[")[0], "", seconds)
    said = done.stdout.strip().splitlines()
    complaint = _LIVES if done.returncode == 0 else f"tests cannot be run: {said[-1:]}"
    return Outcome("", complaint, seconds)


def report(mutants: Sequence[Mutant], outcomes: Sequence[Outcome]) -> None:
    """Write the rows of these mutants, among those of the others that there are."""
    rows_known: dict[Mutant, dict[str, Any]] = {}
    for row in stored("mutants")["rows"]:
        rows_known[Mutant(**{name: row[name] for name in Mutant._fields})] = row
    for mutant, outcome in zip(mutants, outcomes, strict=True):
        rows_known[mutant] = {**mutant._asdict(), "killer": outcome.killer}
    rows = [rows_known[one] for one in chosen([]) if one in rows_known]
    survivors = [row["fault"] for row in rows if not row["killer"]]
    cells = [
        (
            row["fault"],
            f"`{row['file'].removeprefix('spectral_contact/')}`",
            f"`{row['killer']}`".replace("|", "\\|") if row["killer"] else "nothing",
        )
        for row in rows
    ]
    about = f"{len(rows)} mutants, of which {len(rows) - len(survivors)} are killed: "
    about += "`python validation/mutants/mutants.py`.\n\n"
    record = {"mutants": len(rows), "survivors": survivors, "rows": rows}
    write("mutants", about + table("fault | where | found by", cells), record)


def main(arguments: Sequence[str]) -> int:
    """Try the mutants."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=1, help="mutants at once (default: 1)")
    parser.add_argument("words", nargs="*", help="of file or fault; all mutants without")
    options = parser.parse_args(arguments)
    mutants = chosen(options.words)
    for mutant in mutants:
        mutated(mutant)  # raises where the table is out of date
    begin = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        copies: SimpleQueue[Path] = SimpleQueue()
        for i in range(options.jobs):
            copies.put(copied(Path(folder).resolve() / str(i)))

        def work(mutant: Mutant) -> Outcome:
            copy = copies.get()
            try:
                return tried(mutant, copy)
            finally:
                copies.put(copy)

        selections = sorted({mutant.tests for mutant in mutants})
        sound = [mutant._replace(new=mutant.old) for mutant in mutants[:1]]
        controls = [one._replace(tests=tests) for one in sound for tests in selections]
        with ThreadPoolExecutor(options.jobs) as pool:
            for control, outcome in zip(controls, pool.map(work, controls), strict=True):
                if outcome.complaint != _LIVES:
                    end = outcome.killer or outcome.complaint
                    print(f"without a mutant: {control.tests}: {end}")
                    return 1
            print(f"{len(controls)} selections of tests pass without a mutant", flush=True)
            outcomes = []
            for mutant, outcome in zip(mutants, pool.map(work, mutants), strict=True):
                outcomes.append(outcome)
                end = outcome.killer or f"NOT KILLED: {outcome.complaint}"
                print(f"{outcome.seconds:6.1f} s  {mutant.fault}: {end}", flush=True)
    alive = sum(not outcome.killer for outcome in outcomes)
    print(f"{len(mutants) - alive} of {len(mutants)} killed in {perf_counter() - begin:.0f} s")
    report(mutants, outcomes)
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
