"""Whole solves, cold and warm: groups ``solve`` and ``coupled`` of bench.py.

*Cold* is the first solve in a fresh process after the import; *anew* the same scene once more with
emptied caches, when the code has run before. The net times these cases for other versions of the
library, too, which it imports itself.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from statistics import median

from timed import TABLE, VERSIONS, Case, fresh, goal, report, seconds, unit, warm

NU = 0.1
KAPPA = 0.8 / 3.6
ROUNDS, PROCESSES = 27, 5


@dataclass(frozen=True)
class Solve:
    """A case of bench.toml."""

    problem: str
    compliances: tuple[float, float]
    rtol: float
    ratio: float | None = None
    quantities: tuple[str, ...] | None = None
    cold_goal: float | None = None
    warm_goal: float | None = None

    @property
    def name(self) -> str:
        """The problem with its compliances."""
        return f"{self.problem}, {self.shown}"

    @property
    def shown(self) -> str:
        """Its compliances; one if both are the same."""
        return ", ".join(f"{one:g}" for one in dict.fromkeys(self.compliances))

    def scene(self, place: float):
        """Return its scene, varied by so many hundredths."""
        from spectral_contact import Scene

        alpha, beta = self.compliances
        shift = 1.0 + 0.01 * place
        if self.ratio is None:
            return Scene(NU, alpha * shift)
        friction = self.ratio * KAPPA * shift
        # a smooth surface has nothing else to vary
        nu = NU * shift if alpha == 0.0 else NU
        more = {"coupling": True} if "coupled" in self.problem else {}
        return Scene(nu, alpha * shift, beta * shift, friction, **more)

    def work(self, place: float) -> partial:
        """Return its solve at a place."""
        from spectral_contact import solve

        return partial(solve, self.scene(place), self.rtol, self.quantities)


#: By group: without coupling, with it, and what the net times beside.
SOLVES = {
    group: [Solve(**row | {"compliances": tuple(row["compliances"])}) for row in TABLE[group]]
    for group in ("solve", "coupled", "slip")
}


def cold(case: Solve) -> tuple[float, float]:
    """Return the first solve and the one with emptied caches, in U, of this fresh process."""
    from spectral_contact import clear_caches

    for module in ("scipy.linalg", "scipy.special"):  # no part of a solve
        import_module(module)

    first = seconds(case.work(0.0))
    clear_caches()
    anew = seconds(case.work(0.0))
    return first / unit(), anew / unit()


def import_time() -> tuple[float, float]:
    """Return import times in seconds: numpy alone, and this library over it."""
    code = (
        "from time import perf_counter as t; a=t(); import numpy; b=t(); "
        "import spectral_contact; print(b-a, t()-b)"
    )
    command = [sys.executable, "-c", code]
    texts = [subprocess.check_output(command, text=True) for _ in range(7)]
    runs = [[float(x) for x in text.split()] for text in texts]
    return median(r[0] for r in runs), median(r[1] for r in runs)


def measured(case: Solve) -> dict[str, object]:
    """Return the figures of a case."""
    time, ratio = warm(Case({}, case.work, 0.0, ROUNDS))
    runs = [fresh(cold, case) for _ in range(PROCESSES)]
    first, anew = (median(column) for column in zip(*runs, strict=True))
    return {
        **{"problem": case.problem, "compliances": case.shown, "rtol": case.rtol},
        "unknowns": case.work(0.5)().work.unknowns,
        **{"milliseconds": 1e3 * time, "warm": ratio, "warm_goal": goal(case.warm_goal)},
        **{"cold": first, "cold_goal": goal(case.cold_goal), "anew": anew},
    }


def main(group: str) -> None:
    """Measure and write."""
    imports = dict(zip(("numpy", "library"), import_time(), strict=True))
    report(group, map(measured, SOLVES[group]), versions=VERSIONS, **imports)
