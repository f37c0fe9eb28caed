"""A growing frictional contact by increments: rings, the law ring by ring, no superposition.

It shares nothing with the library: midpoint collocation on rings of equal width by quadrature of
the elliptic kernels, first order. Rings enter the contact one after another. In every step pressure
and traction of all rings solve the equations of the whole contact with the approach at which the
last ring bears nothing. A ring that enters has the radial displacement that the surface has there;
what sticks keeps it, what slips has q = f p and must move against it.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.special import ellipe, ellipkm1

#: Gauss points on a ring; towards the middle of a ring panels with a ratio of lengths.
_POINTS, _RATIO, _PANELS = 8, 0.15, 14
#: How often the rings that slip are looked for in a step.
_ROUNDS = 60


@dataclass(frozen=True)
class Marched:
    """Load, shear, approach and stick radius of the last step, and the fields on the rings.

    `slip` is by how far rings have moved since they entered.
    """

    load: float
    shear: float
    approach: float
    stick_radius: float
    middles: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray
    slip: np.ndarray


@dataclass(frozen=True)
class Rings:
    """The operators of rings of equal width on the unit disk.

    `normal` and `tangential` are N and T at the middles, `pull` is ``int_s^1 q`` and `carried`
    ``(1/s) int_0^s p eta``.
    """

    middles: np.ndarray
    normal: np.ndarray
    tangential: np.ndarray
    pull: np.ndarray
    carried: np.ndarray


def _kernels(eta, s):
    low, high = np.minimum(eta, s), np.maximum(eta, s)
    rest = (high - low) * (high + low) / high**2
    first, second = ellipkm1(rest), ellipe(1.0 - rest)
    return np.array([eta / high * first, eta / low * (first - second)]) / np.pi


def rings(count):
    """Return the operators of so many rings."""
    width = 1.0 / count
    inner = np.arange(count) * width
    middles = inner + width / 2.0
    own = np.diag_indices(count)
    both = np.zeros((2, count, count))
    for x, w in zip(*np.polynomial.legendre.leggauss(_POINTS), strict=True):
        both += width / 2.0 * w * _kernels(middles + width / 2.0 * x, middles[:, None])
        ends = width / 2.0 * np.append(_RATIO ** np.arange(_PANELS), 0.0)
        near = ends[1:] - np.diff(ends) * (x + 1.0) / 2.0
        weights = -np.diff(ends) * w / 2.0
        around = 0.0
        for side in (-1.0, 1.0):
            around = around + _kernels(middles[:, None] + side * near, middles[:, None]) @ weights
        both[:, own[0], own[1]] += around - width / 2.0 * w * _kernels(
            middles + width / 2.0 * x, middles
        )
    whole = np.tril(np.ones((count, count)), -1)
    pull = width * (whole.T + np.eye(count) / 2.0)
    carried = whole * width * middles + np.diag((middles**2 - inner**2) / 2.0)
    return Rings(middles, both[0], both[1], pull, carried / middles[:, None])


def march(height, alpha, beta, kappa, friction, count, *, coupled=False):
    """March to a contact radius of 1; `height` is that of the profile at radii."""
    own = rings(count)
    normal = own.normal + alpha * np.eye(count)
    tangential = own.tangential + beta * np.eye(count)
    back, heights = (kappa if coupled else 0.0), height(own.middles)
    pressure, traction, kept = np.zeros(count), np.zeros(count), np.zeros(count)
    slips, entered = np.zeros(count, dtype=bool), np.zeros(count)
    for k in range(2, count + 1):
        # a ring that enters has what the surface has there
        kept[k - 1] = own.tangential[k - 1] @ traction - kappa * (own.carried[k - 1] @ pressure)
        entered[k - 1] = kept[k - 1]
        for _ in range(_ROUNDS):
            stuck, slid = np.flatnonzero(~slips[:k]), np.flatnonzero(slips[:k])
            matrix, right = np.zeros((2 * k + 1, 2 * k + 1)), np.zeros(2 * k + 1)
            matrix[:k, :k], matrix[:k, k : 2 * k] = normal[:k, :k], -back * own.pull[:k, :k]
            matrix[:k, -1], right[:k] = -1.0, -heights[:k]
            matrix[k + stuck, k : 2 * k] = tangential[stuck, :k]
            matrix[k + stuck, :k] = -kappa * own.carried[stuck, :k]
            right[k + stuck] = kept[stuck]
            if len(slid):
                matrix[k + slid, k + slid], matrix[k + slid, slid] = 1.0, -friction
            matrix[-1, k - 1] = 1.0
            found = np.linalg.solve(matrix, right)
            p, q = found[:k], found[k : 2 * k]
            place = tangential[:k, :k] @ q - kappa * (own.carried[:k, :k] @ p)
            if friction == inf:
                break
            beyond = np.abs(q) > friction * np.abs(p) * (1.0 + 1e-12) + 1e-300
            against = q * (place - kept[:k]) <= 0.0
            wanted = np.where(slips[:k], against, beyond)
            if (wanted == slips[:k]).all():
                break
            slips[:k] = wanted
        pressure[:k], traction[:k], kept[:k] = p, q, place
    ends = np.flatnonzero(slips)
    area = 2.0 * np.pi * own.middles / count
    return Marched(
        float(area @ pressure),
        float(area @ traction),
        float(found[-1]),
        float(ends[0]) / count if len(ends) else 1.0,
        own.middles,
        pressure,
        traction,
        kept - entered,
    )
