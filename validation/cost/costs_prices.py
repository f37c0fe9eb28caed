"""The price list: what is timed for each item."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np

from spectral_contact import Scene, Solution, clear_caches, solve
from spectral_contact.studies import OwnSolver, Timing

RTOL = 1e-10
ONE_DISK = Scene(0.1, 0.5, 0.5, 0.1)
#: Slip in an interior annulus, between two zones of stick.
ANNULUS = Scene(0.3, 0.05, 1.0, 0.23 / 7.0)
#: What bench.py reference calls the first scene.
MANY_DIGITS = "partial slip, α* = β* = 0.5, f = 0.1"
RADII = 1000


@dataclass(frozen=True, slots=True)
class Price:
    """An item: what it is called, and a task ``task(scene, rtol)`` to be timed."""

    item: str
    scene: Scene
    task: Callable[[Scene, float], Any]


@dataclass(frozen=True, slots=True)
class Evaluate:
    """The evaluation of a field of a solution that is there already."""

    solution: Solution
    field: str
    clear_caches: ClassVar[Callable[[], None]] = staticmethod(clear_caches)

    def __call__(self, _scene: Scene, _rtol: float) -> Any:
        """Evaluate the field over the radius."""
        return getattr(self.solution, self.field)(np.linspace(0.0, 1.0, RADII))


@dataclass(frozen=True, slots=True)
class Bound:
    """The rigorous bounds of the approach of a solution that is there already."""

    solution: Solution
    clear_caches: ClassVar[Callable[[], None]] = staticmethod(clear_caches)

    def __call__(self, _scene: Scene, _rtol: float) -> Any:
        """Bound the approach."""
        return self.solution.approach_bounds


def prices() -> tuple[Price, ...]:
    """Return the items, from the cheapest solve to what is asked of its solution."""
    solution = solve(ONE_DISK, RTOL)
    return (
        Price("approach alone", ONE_DISK, OwnSolver(("approach",))),
        Price("pressure", ONE_DISK, OwnSolver(("pressure",))),
        Price("does it slip? (full stick)", ONE_DISK, OwnSolver(("critical_friction",))),
        Price("everything, one stick disk", ONE_DISK, OwnSolver()),
        Price("everything, slip in an annulus", ANNULUS, OwnSolver()),
        *(
            Price(f"{field} at {RADII} radii", ONE_DISK, Evaluate(solution, field))
            for field in ("pressure", "traction", "slip")
        ),
        Price("rigorous bounds of the approach", ONE_DISK, Bound(solution)),
    )


def step_seconds(repeats: int) -> list[dict[str, Any]]:
    """Return what the steps of the two complete solves take, warm."""
    rows = []
    for name, scene in (("one stick disk", ONE_DISK), ("slip in an annulus", ANNULUS)):
        solve(scene, RTOL)
        taken: dict[str, list[float]] = defaultdict(list)
        for _ in range(4 * repeats):
            for step in solve(scene, RTOL).work.steps:
                taken[step.name].append(step.seconds)
        for step, seconds in taken.items():
            rows.append({"solve": name, "step": step} | asdict(Timing.of(seconds)))
    return rows
