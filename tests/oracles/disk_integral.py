"""Integrals over the disk of what varies on every scale towards its edge."""

import numpy as np

__all__ = ["integral", "places"]


def places(depth=80.0, width=0.5, points=24):
    """Return distances from the edge down to ``exp(-depth)``, and weights of ``s ds``."""
    g, w = np.polynomial.legendre.leggauss(points)
    x = (np.arange(0.0, depth, width)[:, None] + 0.5 * width * (1.0 + g)).ravel()
    y = np.exp(-x)
    weights = np.tile(0.5 * width * w, len(x) // points) * y / 2.0
    return y / (1.0 + np.sqrt(1.0 - y)), weights


def integral(function):
    """Return ``int_0^1 f s ds`` of a function of the distance from the edge."""
    d, weights = places()
    return float(weights @ function(d))
