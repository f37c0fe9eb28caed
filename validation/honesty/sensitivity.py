"""Derivatives of `Solution.sensitivity` against differences of solutions to 24 digits.

Run as ``python validation/honesty/sensitivity.py``. Takes some minutes a scene, and prints a line
for each derivative: the value, its true error relative to it, and what was estimated. Exits with 1
if an error exceeds its estimate.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
import sys

from spectral_contact import Scene, reference, solve
from spectral_contact.studies.derivatives import PARAMETERS, QUANTITIES, sensitivity

SCENES = (
    Scene(0.3, 0.5, 0.5, math.inf),
    Scene(0.1, 0.5, 0.5, 0.1),
    Scene(0.45, 0.5, 0.1, 0.01),
    Scene(0.246, 0.2, 0.5, 0.1),  # slip in an interior annulus
)
DIGITS, STEP = 24, 2.0**-24


def differences(scene: Scene, name: str) -> dict[str, float]:
    """Return central differences by one parameter, whose error is the square of the step."""
    value = getattr(scene, name)
    ends = [value * (1.0 - STEP), value * (1.0 + STEP)]
    low, high = (reference(scene.replace(**{name: end}), DIGITS, progress=False) for end in ends)
    between = ends[1] - ends[0]
    return {q: float((getattr(high, q) - getattr(low, q)) / between) for q in QUANTITIES}


def main() -> int:
    """Print the table, and return how the process ends."""
    dishonest = 0
    for scene in SCENES:
        found = sensitivity(solve(scene, 1e-6))
        print(scene)
        for name in PARAMETERS:
            if getattr(scene, name) == math.inf:
                continue
            for quantity, true in differences(scene, name).items():
                one = found[quantity, name]
                error = abs(one.value - true) / abs(true) if true else abs(one.value)
                dishonest += error > one.error + 30.0 * STEP**2
                print(f"  {quantity:12} {name:22} {true:20.13g} {error:9.1e} {one.error:9.1e}")
        sys.stdout.flush()
    return 1 if dishonest else 0


if __name__ == "__main__":
    sys.exit(main())
