"""What the net keeps: scenes and their truths.

All of it is numbers, so that no redesign has to be able to read it.
"""

from __future__ import annotations

import gzip
import json
import sys
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
from honesty_errors import SCALARS, places

from spectral_contact import NotComputedError, Scene, Solution

FILE = Path(__file__).parents[1] / "net" / "kept.json.gz"
DISTANCES, WITHIN = 10.0 ** -np.linspace(1e-3, 30.0, 40), 8
#: Distances from the ends of a zone, in its width, at which coupled slip is compared.
NEAR = np.geomspace(1e-12, 0.45, 12)
#: Relative step for the slope of the traction.
STEP = 1e-4
DIGITS = 15
FIELDS = ("pressure", "traction", "slip")


def save(kept: dict[str, Any]) -> None:
    """Store what is kept; equal content is an equal file."""
    FILE.parent.mkdir(exist_ok=True)
    text = json.dumps(kept, separators=(",", ":"), default=float)
    FILE.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def load() -> dict[str, Any]:
    """Return what is kept."""
    return dict(json.loads(gzip.decompress(FILE.read_bytes())))


def row_of(scene: Scene) -> list[Any]:
    """Return a scene as numbers."""
    compliances = scene.normal_compliance, scene.tangential_compliance
    return [scene.poisson_ratio, *compliances, scene.friction, scene.coupling]


def scene_of(row: list[Any]) -> Scene:
    """Return the scene that is kept."""
    return Scene(*row[:4], coupling=row[4])


class KeptZone(NamedTuple):
    """A zone of a kept solution."""

    kind: str
    inner: float
    outer: float
    inner_from_edge: float
    outer_from_edge: float


def zones_row(solution: Solution) -> list[list[Any]]:
    """Return the zones of a solution as numbers."""
    return [[getattr(zone, name) for name in KeptZone._fields] for zone in solution.zones]


class Kept(SimpleNamespace):
    """A true solution as far as `honesty_errors.compare` looks at it, known at `at` alone.

    Elsewhere, as a boundary's error may move a place, the traction goes on by its slope.
    """

    def __init__(self, row: dict[str, Any]) -> None:
        super().__init__(**row["scalars"])
        self.zones = tuple(KeptZone(*zone) for zone in row["zones"])
        self.error = SimpleNamespace(**row["errors"])
        self.at = places(self, DISTANCES, WITHIN)
        self._order = np.argsort(self.at)
        self._known = np.log(self.at[self._order])
        self._values = {n: np.array(row[n])[self._order] for n in (*FIELDS, "slopes") if n in row}

    def pressure(self, *, from_edge: np.ndarray) -> np.ndarray:
        """Return the pressure at places of `at`."""
        return self._values["pressure"][self._nearest(from_edge)]

    def traction(self, s: Any = None, *, from_edge: Any = None) -> np.ndarray:
        """Return the traction at or beside places of `at`."""
        d = 1.0 - np.asarray(s) if from_edge is None else np.asarray(from_edge)
        nearest = self._nearest(d)
        beside = d / np.exp(self._known[nearest]) - 1.0
        beside[np.abs(beside) < 1e-14] = 0.0
        return self._values["traction"][nearest] * (1.0 + self._values["slopes"][nearest] * beside)

    def slip(self, *, from_edge: np.ndarray) -> np.ndarray:
        """Return the slip at places of `at`; zero where there is none."""
        if "slip" not in self._values:
            return np.zeros(len(from_edge))
        return self._values["slip"][self._nearest(from_edge)]

    def _nearest(self, from_edge: np.ndarray) -> np.ndarray:
        sought = np.log(np.maximum(from_edge, 1e-300))
        right = np.clip(np.searchsorted(self._known, sought), 1, len(self._known) - 1)
        closer_left = sought - self._known[right - 1] < self._known[right] - sought
        return right - closer_left


def kept_row(truth: Solution) -> dict[str, Any]:
    """Return a true solution as numbers."""
    scalars = {name: getattr(truth, name) for name in SCALARS if _known(truth, name) is not None}
    errors = {name: _known(truth.error, name) for name in (*SCALARS, *FIELDS, "zones")}
    at = places(truth, DISTANCES, WITHIN)
    row = {"scalars": scalars, "errors": errors, "zones": zones_row(truth)}
    row["pressure"] = rounded(truth.pressure(from_edge=at))
    row["traction"] = rounded(truth.traction(from_edge=at))
    row["slopes"] = rounded(_slopes(truth, at), 4)
    slip = truth.slip(from_edge=at)
    if np.any(slip):
        row["slip"] = rounded(slip)
    return row


def _slopes(truth: Solution, at: np.ndarray) -> np.ndarray:
    """Return ``d log q / d log(1 - s)``; where q is zero there is none."""
    central = at > 0.5
    near, s = at[~central], 1.0 - at[central]
    ends = np.empty((3, len(at)))
    for values, step in zip(ends, (-STEP, 0.0, STEP), strict=True):
        values[~central] = truth.traction(from_edge=near * (1.0 + step))
        values[central] = truth.traction(s * (1.0 - step))
    width = np.where(central, 2.0 * STEP * (1.0 - at) / at, 2.0 * STEP)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = (ends[2] - ends[0]) / (ends[1] * width)
    return np.where(np.isfinite(slopes), slopes, 0.0)


def _known(owner: Any, name: str) -> Any:
    """Return a value, or None where there is none."""
    try:
        return getattr(owner, name)
    except (AttributeError, NotComputedError):
        return None


def rounded(values: Iterable[float], digits: int = DIGITS) -> list[float]:
    """Return values as short as can be stored."""
    return [float(f"{value:.{digits}g}") for value in values]
