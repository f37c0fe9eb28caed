"""Solvers of nobody in particular, for studies: importable by fresh processes."""

import os

import numpy as np


class Decaying:
    """Errors of order 2 in the approach and of order 1 in the fields, by construction."""

    def __init__(self, scene, count):
        self.approach = 0.25 * (1.0 + float(count) ** -2)
        self.factor = 1.0 + 1.0 / count
        self.unknowns = 3 * count

    def pressure(self, s):
        return self.factor * (1.0 + np.asarray(s) ** 2)


def environment(scene, count):
    """Refuse to solve unless BLAS has one thread, and print, as users' codes do."""
    print("solving")
    if os.environ["OPENBLAS_NUM_THREADS"] != "1":
        raise RuntimeError("more than one thread")
    return Decaying(scene, count)


def only_here(scene, count):
    """Solve in the process that imported this with the mark, and nowhere else."""
    if "SPECTRAL_CONTACT_TEST_HOME" in os.environ:
        raise RuntimeError("away from home")
    return Decaying(scene, count)


def imports_late(scene, count):
    """Solve with a module that is imported here, where the test puts it."""
    import imported_late

    return imported_late.solver(scene, count)


def fails(scene, count):
    """A solver that solves nothing."""
    raise RuntimeError("it never converges")
