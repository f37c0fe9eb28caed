"""tamaas, a boundary element method on a square grid by FFT, with the roughness layer added.

The operator is tamaas's own (L. Frerot et al., J. Open Source Softw. 5, 2121, 2020) of a half-space
that is not periodic; conjugate gradients on the pixels of the contact area solve alpha p + N p = 1.
Only the normal problem: its full stick is that of tangential loads.

Traps: the default operator is periodic, and a punch feels its images. The pixels make a staircase
of the edge: the grid is scaled so that their area is that of the disk, which gains a digit in the
approach with a thick layer. A layer thinner than a pixel is not seen at all. Pixels cut by the edge
with the share inside as a weight do better with a thick layer and far worse with a thin one.

Solver: ``fft:solver``; the resolution is the number of pixels across the disk.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from elements import Array
from scipy.sparse.linalg import LinearOperator, cg

from spectral_contact import MissingDependencyError, Scene

try:  # here, for its time is no part of a solve
    import tamaas
except ImportError:
    tamaas = None

#: Of the residual of conjugate gradients: the staircase costs far more.
TOLERANCE = 1e-5
#: Pixels on either side of a radius over which a line is fitted.
BAND = 2.0


class Pixels:
    """The pressure on the pixels whose middles are in the disk; a solution as studies take it."""

    def __init__(self, scene: Scene, count: int) -> None:
        steps = np.arange(count) - (count - 1) / 2.0
        distance = np.hypot(steps[:, None], steps)
        inside = distance < count / 2.0
        self.unknowns = int(inside.sum())
        self._width = np.sqrt(np.pi / self.unknowns)
        self._radii = distance[inside] * self._width
        model = half_space(count, count * self._width)
        load, displaced = np.zeros((count, count)), np.zeros((count, count))

        def compliance(pressure: Array) -> Array:
            load[inside] = pressure
            model.operators["half-space"](load, displaced)
            return scene.normal_compliance * pressure + displaced[inside]

        shape = self.unknowns, self.unknowns
        matrix = LinearOperator(shape, matvec=compliance, dtype=float)
        unit, failed = cg(matrix, np.ones(self.unknowns), rtol=TOLERANCE)
        if failed:
            raise ArithmeticError("conjugate gradients did not converge")
        self.approach = 1.0 / float(unit.sum() * self._width**2)
        self._pressures = unit * self.approach

    def pressure(self, s: Array) -> Array:
        """Return the pressure on lines through the pixels around each radius."""
        found = []
        for radius in s:
            near = np.abs(self._radii - radius) < BAND * self._width
            line = np.polynomial.Polynomial.fit(self._radii[near], self._pressures[near], 1)
            found.append(line(radius))
        return np.array(found)


def half_space(count: int, side: float) -> Any:
    """Return tamaas's model of a half-space with E = 4 (1 - nu^2); its operator has that name."""
    if tamaas is None:
        raise MissingDependencyError("tamaas", "peers")
    tamaas.set_log_level(tamaas.LogLevel.warning)
    model = tamaas.ModelFactory.createModel(
        tamaas.model_type.basic_2d, [side, side], [count, count]
    )
    model.nu = 0.0  # only E/(1 - nu^2) matters
    model.E = 4.0
    tamaas.ModelFactory.registerNonPeriodic(model, "half-space")
    return model


solver = Pixels
