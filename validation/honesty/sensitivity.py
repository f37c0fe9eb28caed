"""Derivatives of `Solution.sensitivity` against differences of solutions to 24 digits.

Run as ``python validation/honesty/sensitivity.py``. Takes some minutes a scene, and prints a line
for each derivative, of fields at some radii: the value, its true error, and what was estimated.
Exits with 1 if an error exceeds its estimate.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
import sys

import numpy as np

from spectral_contact import Scene, reference, solve
from spectral_contact.studies.derivatives import PARAMETERS, QUANTITIES, sensitivity

SCENES = (
    Scene(0.3, 0.5, 0.5, math.inf),
    Scene(0.2, 0.5, 0.5, math.inf, coupling=True),
    Scene(0.3, 1e-3, 1e-3, 0.1),
    Scene(0.3, 0.1, 0.0, 0.05),
    Scene(0.1, 0.5, 0.5, 0.1),
    Scene(0.45, 0.5, 0.1, 0.01),
    Scene(0.246, 0.2, 0.5, 0.1),  # slip in an interior annulus
)
DIGITS, STEP = 24, 2.0**-24
FIELDS, RADII = ("pressure", "traction"), (0.25, 0.6, 0.7, 0.999)


def differences(scene: Scene, name: str) -> dict[str, list[float]]:
    """Return central differences by one parameter, whose error is the square of the step."""
    value = getattr(scene, name)
    ends = [value * (1.0 - STEP), value * (1.0 + STEP)]
    low, high = (reference(scene.replace(**{name: end}), DIGITS, progress=False) for end in ends)
    between = ends[1] - ends[0]
    found = {q: [float((getattr(high, q) - getattr(low, q)) / between)] for q in QUANTITIES}
    for field in FIELDS:
        pairs = ([getattr(one, field)(s) for s in RADII] for one in (low, high))
        found[field] = [float((b - a) / between) for a, b in zip(*pairs, strict=True)]
    return found


def main() -> int:
    """Print the table, and return how the process ends."""
    dishonest = 0
    for scene in SCENES:
        found = sensitivity(solve(scene, 1e-6), s=RADII)
        print(scene)
        for name in PARAMETERS:
            if getattr(scene, name) in (0.0, math.inf):
                continue
            for quantity, truths in differences(scene, name).items():
                one = found.fields[quantity, name] if quantity in FIELDS else found[quantity, name]
                values, errors = np.atleast_1d(one.value), np.atleast_1d(one.error)
                if quantity not in FIELDS:  # its error is relative
                    errors = errors * np.abs(truths)
                for true, value, known in zip(truths, values, errors, strict=True):
                    error = abs(value - true)
                    dishonest += error > known + 100.0 * STEP**2 * max(1.0, abs(true))
                    print(f"  {quantity:12} {name:22} {true:20.13g} {error:9.1e} {known:9.1e}")
        sys.stdout.flush()
    return 1 if dishonest else 0


if __name__ == "__main__":
    sys.exit(main())
