"""Feed generated bad inputs to the library and to its command line, and note what is not refused.

Run as ``python validation/input/bad_inputs.py [--cases N] [--seed N]``; writes
validation/results/bad_inputs.json and .md. A violation is a bad input that ends in anything but the
documented error with a one-line message that names the parameter: another exception, a warning, a
result, or no end in 10 s. On the command line it is any other end than status 2 and one line on
stderr. A damaged file may be read if what is read equals what was stored; such cases are counted as
accepted. Besides what is drawn at random, every public callable gets bad arguments by its
signature: see bad_input_callables.py.
"""

from __future__ import annotations

import io
import math
import re
import signal
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from time import perf_counter, process_time

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from bad_input_callables import cases, targets
from bad_input_cases import Bench, Case, Rng, range_case
from bad_input_files import bad_arguments, file_case, path_case
from reporting import options, table, write

from spectral_contact import Scene, SceneError, solve
from spectral_contact import __main__ as cli

SECONDS = 10.0
BY_SIGNATURE = "every public callable"
LONGEST_MESSAGE = 1000
PROGRAM = "spectral-contact: "

#: Every group with its share of the cases.
GROUPS: dict[str, tuple[Callable[[Rng, Bench], Case] | None, float]] = {
    "numbers out of range": (range_case, 0.5),
    "damaged or foreign files": (file_case, 0.25),
    "paths": (path_case, 0.05),
    "command line": (None, 0.2),
}
#: Cases of the command line that are processes of their own, which take long.
PROCESSES = 50


class Hang(BaseException):
    """A call took too long; no Exception, so that nobody swallows it."""


@contextmanager
def limited(found: list[str]) -> Iterator[None]:
    """Note warnings, also those that someone swallows, and end what takes too long."""
    begin, worked = perf_counter(), process_time()

    def stop(*_: object) -> None:
        # on a busy machine a call may wait longer than it works
        if process_time() - worked > SECONDS / 2.0 or perf_counter() - begin > 20.0 * SECONDS:
            raise Hang(f"no end in {SECONDS:.0f} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, SECONDS, SECONDS)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    found.extend(f"warning: {one.message}" for one in caught)


def unclear(message: str) -> str | None:
    """Return what is wrong with a message."""
    if len(message.splitlines()) != 1:
        return f"the message is not one line: {message!r:.300}"
    if len(message) > LONGEST_MESSAGE:
        return f"the message has {len(message)} characters"
    return None


def tried(case: Case) -> tuple[bool, list[str]]:
    """Return whether the input was accepted, and what is wrong with how it ended."""
    found: list[str] = []
    accepted = False
    try:
        with limited(found):
            result = case.call()
        accepted = case.accept is not None and case.accept(result)
        if not accepted:
            found.append(f"no error, but a {type(result).__name__}")
    except case.errors as error:
        found += filter(None, [unclear(str(error))])
        # "at, friction", "scenes[3]" and "solution.pressure" name the parameter as well
        named = str(error)
        if isinstance(error, SceneError):
            named = re.split(r"[^\w]+", error.parameter)
        if not all(name in named for name in filter(None, case.names.split(", "))):
            found.append(f"{error!s:.200} does not name {case.names}")
    except (Exception, Hang) as error:  # whatever it is, it is a violation
        found.append(f"{type(error).__name__}: {error!s:.200}")
    return accepted, found


def complaint(status: int, out: str, err: str) -> list[str]:
    """Return what is wrong with the end of a command."""
    found = [] if status == 2 else [f"status {status}"]
    if out:
        found.append(f"stdout: {out:.80}")
    if not err.startswith(PROGRAM) or not err.endswith("\n") or len(err) <= len(PROGRAM) + 1:
        found.append(f"stderr: {err!r:.200}")
    elif len(err.splitlines()) != 1:
        found.append(f"not one line on stderr: {err!r:.300}")
    return found


def called(argv: list[str]) -> list[str]:
    """Run a command in this process, and return what is wrong with how it ended."""
    found: list[str] = []
    out, err, status = io.StringIO(), io.StringIO(), 0
    try:
        with limited(found), redirect_stdout(out), redirect_stderr(err):
            status = cli.main(argv)
    except (Exception, SystemExit, Hang) as error:
        return [f"{type(error).__name__}: {error!s:.200}"]
    return found + complaint(status, out.getvalue(), err.getvalue())


def spawned(argv: list[str]) -> list[str]:
    """Run a command as a process of its own, and return what is wrong with how it ended."""
    command = [sys.executable, "-W", "error", "-m", "spectral_contact", *argv]
    try:
        done = subprocess.run(command, capture_output=True, timeout=20 * SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return ["no end"]
    return complaint(done.returncode, done.stdout.decode(), done.stderr.decode())


def bench(folder: Path) -> Bench:
    """Solve scenes of every kind, so roughly that it takes no time."""
    steel = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013}
    scenes = (
        Scene(0.1, 0.5, 0.5, 0.1),
        Scene(0.1, 0.5),
        Scene(0.5, 0.0, 0.5, 0.1),
        Scene.from_physical(**steel, load=1e3, normal_compliance=1e-13, friction=math.inf),
        Scene.from_physical(**steel, approach=1e-6, friction=0.05),
    )
    partly = solve(scenes[0], 1e-3, ("approach", "pressure", "zones"))
    return Bench((*(solve(scene, 1e-3) for scene in scenes), partly), folder)


def noted(group: str, number: int, label: str, found: list[str]) -> list[dict]:
    """Return violations as they are stored."""
    return [
        {"group": group, "number": number, "input": label[:300], "violation": one} for one in found
    ]


def called_by_signature(shared: Bench, every: int) -> tuple[dict, list[dict]]:
    """Call every public callable with bad arguments; return the summary and the violations."""
    violations, passed, wrong, total = [], 0, 0, 0
    with chdir(shared.folder):
        for number, case in enumerate(cases(shared)):
            if number % every:
                continue
            accepted, found = tried(case)
            total += 1
            passed += accepted
            wrong += bool(found)
            violations += noted(BY_SIGNATURE, number, case.label, found)
    kinds = len(targets())
    return {"cases": total, "kinds": kinds, "accepted": passed, "violations": wrong}, violations


def study(count: int, seed: int, processes: int = PROCESSES, every: int = 1) -> dict:
    """Run the study and return its record.

    Parameters
    ----------
    count : int
        Of the cases that are drawn at random.
    seed : int
    processes : int
        How many of the command lines run as processes of their own.
    every : int
        Of the cases of public callables, which are not random: 1 for all, 2 for every second.
    """
    begin, violations, summary = perf_counter(), [], {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shared = bench(folder)
        for order, (group, (make, share)) in enumerate(GROUPS.items()):
            rng = np.random.default_rng([seed, order])
            kinds: Counter[str] = Counter()
            total, passed, wrong = round(share * count), 0, 0
            for done in range(total):
                if make is None:
                    kind, argv = bad_arguments(rng, folder)
                    accepted, found = False, (spawned if done < processes else called)(argv)
                    # the folder has another name in every run
                    shown = repr(argv).replace(name, "")
                else:
                    case = make(rng, shared)
                    accepted, found = tried(case)
                    kind = shown = case.label
                kinds[kind] += 1
                passed += accepted
                wrong += bool(found)
                violations += noted(group, done, shown, found)
                if sys.stderr.isatty():
                    spent = perf_counter() - begin
                    print(f"\r{group}: {done + 1}/{total}, {spent:.0f} s ", end="", file=sys.stderr)
            summary[group] = {
                "cases": total,
                "kinds": len(kinds),
                "accepted": passed,
                "violations": wrong,
            }
        summary[BY_SIGNATURE], more = called_by_signature(shared, every)
        violations += more
    return {
        "cases": sum(one["cases"] for one in summary.values()),
        "seed": seed,
        "processes": processes,
        "seconds": perf_counter() - begin,
        "summary": summary,
        "violations": violations,
    }


def main() -> None:
    """Run with the counts of the command line."""
    asked = options(__doc__, cases=7_000, seed=1)
    record = study(asked.cases, asked.seed)
    about = (
        f"{record['cases']} bad inputs, seed {record['seed']}; {record['processes']} of the "
        "command lines as processes of their own. Accepted are damaged files and texts that still "
        "hold what was stored, or, of scenes, which have no checksum, another valid scene; and, of "
        "public callables (whose kinds are the callables), values that a signature admits."
    )
    counts = ("cases", "kinds", "accepted", "violations")
    cells = ((group, *(one[key] for key in counts)) for group, one in record["summary"].items())
    heading = "group | bad inputs | kinds | accepted | violations"
    write("bad_inputs", f"{about}\n\n{table(heading, cells)}", record)
    print(*record["violations"], sep="\n")


if __name__ == "__main__":
    main()
