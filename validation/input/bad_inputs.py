"""Feed bad arguments to every public callable, and note what is not refused.

Run as ``python validation/input/bad_inputs.py [--every N]``, with N for every Nth argument; writes
validation/results/bad_inputs.json and .md. For every parameter of every public callable these are
all that its annotation does not admit (bad_input_callables.py).

A violation is a bad input that ends in anything but the documented error with a one-line message
that names the parameter: another exception, a warning, a result, or no end in 10 s. Numbers at the
ends of every range, bad files and bad command lines are tests: tests/unit/io/test_parameters.py,
test_checks.py and test_storage.py, tests/unit/test_main.py.
"""

from __future__ import annotations

import math
import re
import signal
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from itertools import islice
from pathlib import Path
from time import perf_counter, process_time

sys.path.append(str(Path(__file__).parents[1]))

import bad_input_callables
from bad_input_callables import Case
from reporting import options, table, write

from spectral_contact import Scene, SceneError, Solution, solve

SECONDS = 10.0
LONGEST_MESSAGE = 1000


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
        accepted = case.may_pass
        if not accepted:
            found.append(f"no error, but a {type(result).__name__}")
    except case.errors as error:
        found += filter(None, [unclear(str(error))])
        # "at, friction", "scenes[3]" and "solution.pressure" name the parameter as well
        named = str(error)
        if isinstance(error, SceneError):
            named = re.split(r"[^\w]+", error.parameter)
        if case.names and case.names not in named:
            found.append(f"{error!s:.200} does not name {case.names}")
    except (Exception, Hang) as error:  # whatever it is, it is a violation
        found.append(f"{type(error).__name__}: {error!s:.200}")
    return accepted, found


def solutions() -> tuple[Solution, ...]:
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
    return (*(solve(scene, 1e-3) for scene in scenes), partly)


def study(every: int = 1) -> dict:
    """Run the study and return its record.

    Parameters
    ----------
    every : int
        1 for all cases, 2 for every second.
    """
    begin, outcomes, violations = perf_counter(), [], []
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        for case in islice(bad_input_callables.cases(solutions()), 0, None, every):
            accepted, found = tried(case)
            outcomes.append((case.label.partition("(")[0], accepted, bool(found)))
            violations += [{"input": case.label[:300], "violation": one} for one in found]
    callables, accepted, violated = zip(*outcomes, strict=True)
    return {
        "cases": len(outcomes),
        "callables": len(set(callables)),
        "accepted": sum(accepted),
        "violated": sum(violated),
        "seconds": perf_counter() - begin,
        "violations": violations,
    }


def main() -> None:
    """Run, and write the results."""
    record = study(options(__doc__, every=1).every)
    about = (
        f"{record['cases']} bad inputs. Accepted are values that a signature admits, such as −1 "
        "for a float."
    )
    cells = [record[name] for name in ("callables", "cases", "accepted", "violated")]
    heading = "callables | bad inputs | accepted | violations"
    write("bad_inputs", f"{about}\n\n{table(heading, [cells])}", record)
    print(*record["violations"], sep="\n")


if __name__ == "__main__":
    main()
