"""A growing frictional contact by increments: rings, the law ring by ring, no superposition.

Rings of equal width enter the contact one after another. The pressure of a step solves the normal
problem with the approach at which the last ring bears nothing. A ring that enters has the radial
displacement that the surface has there; what sticks keeps it, what slips has q = f p.
"""

from dataclasses import dataclass

import numpy as np

from spectral_contact.spectral.rings import ring_operators


@dataclass(frozen=True)
class Marched:
    """Load, shear and stick radius of the last step, and the traction on the rings."""

    load: float
    shear: float
    stick_radius: float
    middles: np.ndarray
    traction: np.ndarray


def march(height, alpha, beta, kappa, friction, rings):
    """March to a contact radius of 1; `height` is that of the profile at radii."""
    ends = np.arange(1, rings) / rings
    logits = np.concatenate([[-np.inf], np.log(ends**2 / (1.0 - ends**2)), [np.inf]])
    own = ring_operators(logits)
    mass = own.mass
    radii = np.concatenate([[0.0], ends, [1.0]])
    # the mean height of a ring, by Gauss's rule in r
    g, w = np.polynomial.legendre.leggauss(6)
    inside = radii[:-1, None] + (radii[1:] - radii[:-1])[:, None] * (1.0 + g) / 2.0
    heights = (height(inside) * inside) @ w / (inside @ w)
    normal = own.normal + alpha * np.diag(mass)
    tangential = own.tangential + beta * np.diag(mass)
    pressure, traction = np.zeros(rings), np.zeros(rings)
    frozen = np.zeros(rings)
    slips = np.zeros(rings, dtype=bool)
    for k in range(2, rings + 1):
        inner = slice(0, k)
        unit = np.linalg.solve(normal[inner, inner], mass[inner])
        bent = np.linalg.solve(normal[inner, inner], mass[inner] * heights[inner])
        approach = bent[-1] / unit[-1]
        # a ring that enters has what the surface has there
        entering = own.tangential[k - 1] @ traction - kappa * (own.carried @ pressure)[k - 1]
        frozen[k - 1] = entering
        pressure = np.zeros(rings)
        pressure[inner] = approach * unit - bent
        wanted = kappa * (own.carried @ pressure) + frozen
        limit = friction * pressure
        slips = np.zeros(rings, dtype=bool)
        while True:
            stuck = np.flatnonzero(~slips[:k])
            traction = np.zeros(rings)
            traction[slips] = limit[slips]
            right = wanted[stuck] - tangential[np.ix_(stuck, np.flatnonzero(slips))] @ limit[slips]
            traction[stuck] = np.linalg.solve(tangential[np.ix_(stuck, stuck)], right)
            more = (traction > limit * (1.0 + 1e-12) + 1e-300) & ~slips
            more[k:] = False
            if not more.any():
                break
            slips |= more
        moved = tangential @ traction - kappa * (own.carried @ pressure)
        frozen[:k] = moved[:k]  # of what sticks it is what it was
    middles = (radii[1:] + radii[:-1]) / 2.0
    stick = radii[np.flatnonzero(slips)[0]] if slips.any() else 1.0
    return Marched(
        2.0 * np.pi * float(mass @ pressure),
        2.0 * np.pi * float(mass @ traction),
        stick,
        middles,
        traction,
    )
