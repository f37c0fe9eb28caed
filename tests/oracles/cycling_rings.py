"""Cycles of the load under a flat punch by increments: rings, and a quadratic programme a step.

It shares nothing with the library: pressure and traction are constant on rings, the energies are
integrals of arcosh and of square roots, and every step of the load minimises the energy under
|q| <= f l p from where the last one left the surface. No superposition, no zones, no law of cycles.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

#: Gauss points between two ends of rings.
_POINTS = 12
#: How often the rings that slip are looked for in a step.
_ROUNDS = 200


@dataclass(frozen=True)
class CycledRings:
    """Rings with their pressure of unit load, and what moves them.

    `areas` are integrals of s ds, `stiffness` and `drive` have them as a factor.
    """

    ends: np.ndarray
    areas: np.ndarray
    pressure: np.ndarray
    approach: float
    stiffness: np.ndarray
    drive: np.ndarray


@dataclass(frozen=True)
class Steps:
    """What some steps of the load did: states after each, and what each dissipated.

    `traction` and `moved` are of shape (steps + 1, rings), the first row is before the first step.
    """

    loads: np.ndarray
    traction: np.ndarray
    moved: np.ndarray
    dissipated: np.ndarray


def rings(ends, alpha, beta, kappa):
    """Return rings between these radii, from 0 to 1."""
    ends = np.asarray(ends, dtype=float)
    low, high = ends[:-1], ends[1:]
    x, w = np.polynomial.legendre.leggauss(_POINTS)
    v = (x + 1.0) / 2.0
    t = (high[:, None] - (high - low)[:, None] * v**2).ravel()
    weights = ((high - low)[:, None] * v * w).ravel() / np.pi

    def root(end):
        return np.sqrt(np.maximum(end - t[:, None], 0.0) * (end + t[:, None]))

    def arcosh(end):
        return np.arccosh(np.maximum(end / t[:, None], 1.0))

    areas = (high**2 - low**2) / 2.0
    half_p, half_q = root(high) - root(low), arcosh(high) - arcosh(low)
    normal = half_p.T @ (weights[:, None] * half_p) + alpha * np.diag(areas)
    pressure = np.linalg.solve(normal, areas)
    approach = 1.0 / (2.0 * np.pi * areas @ pressure)
    pressure = pressure * approach
    inside = np.append(0.0, np.cumsum(areas * pressure))[:-1]
    own = (high**3 - low**3) / 6.0 - low**2 * (high - low) / 2.0
    drive = kappa * (inside * (high - low) + pressure * own)
    stiffness = half_q.T @ ((weights * t**2)[:, None] * half_q) + beta * np.diag(areas)
    return CycledRings(ends, areas, pressure, float(approach), stiffness, drive)


def step(own, friction, load, traction, before):
    """Return the traction after a step to a load, from a traction at the load before."""
    limit = friction * load * own.pressure
    target = own.stiffness @ traction + (load - before) * own.drive
    scale = np.diag(own.stiffness)
    state = np.zeros(len(limit), dtype=int)
    for _ in range(_ROUNDS):
        stuck = np.flatnonzero(state == 0)
        q = state * limit
        q[stuck] = np.linalg.solve(
            own.stiffness[np.ix_(stuck, stuck)],
            target[stuck] - own.stiffness[stuck] @ q,
        )
        pushed = q + (target - own.stiffness @ q) / scale
        wanted = (pushed > limit).astype(int) - (pushed < -limit)
        if (wanted == state).all():
            return q
        state = wanted
    raise RuntimeError("the rings that slip are not found")


def march(own, friction, loads, traction):
    """Return the steps through some loads, from a traction at the first of them."""
    states = [traction]
    moved = [own.stiffness @ traction - loads[0] * own.drive]
    for before, load in pairwise(loads):
        states.append(step(own, friction, load, states[-1], before))
        moved.append(own.stiffness @ states[-1] - load * own.drive)
    q, u = np.array(states), np.array(moved)
    lost = -np.pi * ((q[1:] + q[:-1]) * np.diff(u, axis=0)).sum(axis=1)
    return Steps(np.asarray(loads), q, u / own.areas, lost)


def cycle(own, friction, lowest, steps, rounds):
    """Return unloading and reloading of the last of some rounds between 1 and the lowest load."""
    traction = march(own, friction, [0.0, 1.0], np.zeros(len(own.areas))).traction[-1]
    down = np.linspace(1.0, lowest, steps + 1)
    for _ in range(rounds):
        unloading = march(own, friction, down, traction)
        reloading = march(own, friction, down[::-1], unloading.traction[-1])
        traction = reloading.traction[-1]
    return unloading, reloading


def monotonic(own, friction):
    """Return traction and slip of unit load under friction, from none."""
    q = march(own, friction, [0.0, 1.0], np.zeros(len(own.areas)))
    return q.traction[-1], q.moved[-1]
