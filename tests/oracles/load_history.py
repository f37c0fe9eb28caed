"""Any history of the load under a flat punch by increments, on rings; nothing of the library.

On a ring q/s is constant. In every increment the traction minimises the energy of its change, as
``|q| <= f p`` allows: a ring sticks, and keeps its displacement, or slips, and ends at the bound.
The first order of the rings is all that limits it. Everything tangential is for ``kappa = 1``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tests.oracles.graded_elements import Elements

Array = NDArray[np.float64]
_ROUNDS = 200
_ROUNDING = 1e-13


class Rings:
    """Rings under one pressure for unit load.

    Parameters
    ----------
    alpha, beta, friction : float
    ends : ndarray
        Of the rings in ``s^2``, from 0 to 1.
    """

    def __init__(self, alpha: float, beta: float, friction: float, ends: Array) -> None:
        rings = Elements(ends, 0)
        self.ends = ends
        self._rings = rings
        unit = rings.width / 2.0
        pressure = np.linalg.solve(alpha * rings.mass(0) + rings.gram(0), unit)
        self.pressure: Array = pressure / (2.0 * np.pi * float(unit @ pressure))
        # means over each ring: p/s, and the drive g
        self.bound = friction * self.pressure * rings.tested(1.0 / np.sqrt(rings.z)) / unit
        self.stiffness = beta * rings.mass(2) + rings.gram(2)
        self.drive = rings.tested(rings.load_inside(self.pressure))
        self.traction = np.zeros(len(unit))
        self.load = 0.0

    def move_to(self, load: float) -> float:
        """Change the load; return the work of friction, of the last traction over the slip."""
        right = self.stiffness @ self.traction + (load - self.load) * self.drive
        bound = load * self.bound
        state = np.zeros(len(bound), dtype=int)
        diagonal = self.stiffness.diagonal()
        for _ in range(_ROUNDS):
            q = state * bound
            sticks = state == 0
            inner = self.stiffness[np.ix_(sticks, sticks)]
            q[sticks] = np.linalg.solve(inner, (right - self.stiffness @ q)[sticks])
            slip = self.stiffness @ q - right
            holding = q - slip / diagonal
            # rounding does not decide on slip that has no length
            slips = np.abs(holding) > bound + _ROUNDING * bound.max()
            wanted = np.where(slips, np.sign(holding).astype(int), 0)
            if (wanted == state).all():
                break
            state = wanted
        else:
            raise ArithmeticError("the active set does not settle")
        self.traction = q
        self.load = load
        # slip is tested with s on every ring already
        return float(-2.0 * np.pi * (q @ slip))

    @property
    def total_shear(self) -> float:
        """Return ``2 pi int q s ds``."""
        half = self._rings.half @ self.traction
        return 2.0 * np.pi**2 * float((self._rings.t_weight * self._rings.t) @ half)


def even_ends(radii: Sequence[float], rings: int) -> Array:
    """Return ends of rings that the radii are among, some `rings` in all."""
    marks = np.array([0.0, *sorted(radii), 1.0])
    counts = np.maximum(np.round(rings * np.diff(marks)).astype(int), 1)
    parts = [
        np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(marks[:-1], marks[1:], counts, strict=True)
    ]
    return np.square(np.append(np.concatenate(parts), 1.0))
