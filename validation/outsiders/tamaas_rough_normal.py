"""The benchmark rough_normal with tamaas, from its page alone.

Pixels whose middles are in the disk bear constant pressures; the grid is scaled so that their area
is that of the disk. Conjugate gradients solve alpha p + N p = 1 on them.
"""

import time

import numpy as np
import tamaas
from scipy.sparse.linalg import LinearOperator, cg

ALPHA, CHECK = 0.5, 0.29295979691047814  # of the page
tamaas.set_log_level(tamaas.LogLevel.warning)


def approach(count):
    """Return the approach of a punch with so many pixels across, under the load 1."""
    steps = np.arange(count) - (count - 1) / 2
    inside = np.hypot(steps[:, None], steps) < count / 2
    width = np.sqrt(np.pi / inside.sum())
    sides, pixels = [count * width] * 2, [count] * 2
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, sides, pixels)
    model.nu, model.E = 0.0, 4.0  # only E/(1 - nu^2) matters without friction
    tamaas.ModelFactory.registerNonPeriodic(model, "half-space")
    pressure, displacement = np.zeros(pixels), np.zeros(pixels)

    def compliance(values):
        pressure[inside] = values
        model.operators["half-space"](pressure, displacement)
        return ALPHA * values + displacement[inside]

    ones = np.ones(inside.sum())
    matrix = LinearOperator((len(ones), len(ones)), matvec=compliance, dtype=float)
    unit, failed = cg(matrix, ones, rtol=1e-10)
    assert not failed
    return 1.0 / (unit.sum() * width**2)


for count in (16, 32, 64, 128, 256):
    start = time.perf_counter()
    found = approach(count)
    seconds = time.perf_counter() - start
    print(f"{count:4d} pixels: {found:.8f}, error {abs(found / CHECK - 1):.1e}, {seconds:.1f} s")
