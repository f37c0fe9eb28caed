"""Half-integrals of the functions on half an annulus anywhere, by the plain rules of `abel`."""

import numpy as np

from spectral_contact.spectral.abel import beyond, deeper, outer


def half_integral(family, points):
    """Return ``1/2 int_{z > t^2} psi dz / sqrt(z - t^2)``, shape (points, size)."""
    p, e = family.panels, points.before(family.boundary) / family.reach
    matrix = np.zeros((len(e), p.size))
    if family.sign < 0:
        rows = e > 0.0
        matrix[rows] = deeper(e[rows], p.panels, p.width, p.degree, p.power)
    else:
        rows = e >= 0.0
        matrix[rows] = beyond(e[rows], p.panels, p.width, p.degree)
        rows = (e < 0.0) & (e >= -1.0)
        matrix[rows] = outer(-e[rows], p.panels, p.width, p.degree)
    return matrix * np.sqrt(family.reach)


def inner_integral(family, points):
    """Return ``1/2 int_{z < s^2} psi dz / sqrt(s^2 - z)``, shape (points, size)."""
    p, e = family.panels, points.before(family.boundary) / family.reach
    matrix = np.zeros((len(e), p.size))
    if family.sign < 0:
        rows = e <= 0.0
        matrix[rows] = beyond(-e[rows], p.panels, p.width, p.degree)
        rows = (e > 0.0) & (e <= 1.0)
        matrix[rows] = outer(e[rows], p.panels, p.width, p.degree, p.power)
    else:
        rows = e < 0.0
        matrix[rows] = deeper(-e[rows], p.panels, p.width, p.degree)
    return matrix * np.sqrt(family.reach)
