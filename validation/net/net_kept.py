"""What the net keeps: scenes and their truths, in kept.json.gz, as numbers alone.

Random scenes (``honesty``) and scenes at thresholds of friction (``thresholds``) were solved by the
library of commit 1534185 on other panels or at 1e-12; two that begin to slip at the edge, by
`reference`. ``coupled thresholds`` are scenes that the library of commit c22aa78 solved with all
their zones, and ``hard`` has the truths of the hard cases. The scripts that made them,
``net_truths.py`` and ``net_coupled.py``, are in this folder at commit 1bb7399.
"""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

sys.path.append(str(Path(__file__).parents[1] / "honesty"))

import numpy as np
from honesty_errors import places

from spectral_contact import Scene

FILE = Path(__file__).parent / "kept.json.gz"
DISTANCES, WITHIN = 10.0 ** -np.linspace(1e-3, 30.0, 40), 8
#: Distances from the ends of a zone, in its width, at which coupled slip is compared.
NEAR = np.geomspace(1e-12, 0.45, 12)
FIELDS = ("pressure", "traction", "slip", "slopes")


def load() -> dict[str, Any]:
    """Return what is kept."""
    return dict(json.loads(gzip.decompress(FILE.read_bytes())))


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
        self._values = {n: np.array(row[n])[self._order] for n in FIELDS if n in row}

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
