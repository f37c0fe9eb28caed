"""Solvers of nobody in particular, for studies."""

import numpy as np


class Decaying:
    """Errors of order 2 in the approach and of order 1 in the fields, by construction."""

    def __init__(self, scene, count):
        self.approach = 0.25 * (1.0 + float(count) ** -2)
        self.factor = 1.0 + 1.0 / count
        self.unknowns = 3 * count

    def pressure(self, s):
        return self.factor * (1.0 + np.asarray(s) ** 2)


def fails(scene, count):
    """A solver that solves nothing."""
    raise RuntimeError("it never converges")
