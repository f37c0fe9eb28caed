"""Half-integrals of the functions on half an annulus anywhere, by the plain rules of `abel`."""

import numpy as np

from spectral_contact.spectral.abel import abel_left, abel_right, exterior_with_decrement
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values, tail_values


def exterior(e, p):
    """Return the integrals of all functions at distances past the boundary."""
    return exterior_with_decrement(e, p.width, (p.degree,) * p.count)[0]


def half_integral(mesh, points):
    """Return ``1/2 int_{z > t^2} psi dz / sqrt(z - t^2)``, shape (points, size)."""
    p, e = mesh.panels, points.before(mesh.boundary) / mesh.extent
    matrix = np.zeros((len(e), p.size))
    if mesh.sign < 0:
        rows = e > 0.0
        matrix[rows] = abel_right(e[rows], p.count, p.width, p.degree, p.power)
    else:
        rows = e >= 0.0
        matrix[rows] = exterior(e[rows], p)
        rows = (e < 0.0) & (e >= -1.0)
        matrix[rows] = abel_left(-e[rows], p.count, p.width, p.degree)
    return matrix * np.sqrt(mesh.extent)


def inner_integral(mesh, points):
    """Return ``1/2 int_{z < s^2} psi dz / sqrt(s^2 - z)``, shape (points, size)."""
    p, e = mesh.panels, points.before(mesh.boundary) / mesh.extent
    matrix = np.zeros((len(e), p.size))
    if mesh.sign < 0:
        rows = e <= 0.0
        matrix[rows] = exterior(-e[rows], p)
        rows = (e > 0.0) & (e <= 1.0)
        matrix[rows] = abel_left(e[rows], p.count, p.width, p.degree, p.power)
    else:
        rows = e < 0.0
        matrix[rows] = abel_right(-e[rows], p.count, p.width, p.degree)
    return matrix * np.sqrt(mesh.extent)


def sources(mesh):
    """Return plain quadrature: points, and ``1/2 w psi`` as a matrix (points, size)."""
    p, (g, w) = mesh.panels, gauss_rule(mesh.panels.degree + 12)
    d, share = np.exp(-p.sampling(len(g))), (1.0 + g) / 2.0
    matrix = np.zeros((d.size + len(g), p.size))
    for j, own in enumerate(d):
        rows, columns = (slice(j * n, (j + 1) * n) for n in (len(g), p.degree + 1))
        matrix[rows, columns] = (0.5 * p.width * w * own)[:, None] * legendre_values(g, p.degree)
    tail = tail_values(p.end * share, p.end, p.tail_terms, p.root_tail)
    matrix[d.size :, -p.tail_terms :] = (0.5 * p.end * w)[:, None] * tail
    points = mesh.points(np.concatenate([d.ravel(), p.end * share]))
    return points, 0.5 * mesh.extent * matrix
