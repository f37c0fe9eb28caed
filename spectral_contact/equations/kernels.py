"""The elliptic kernels K1 and K2 of the half-space, free of cancellation.

The paper (docs/theory) prints them as (2.4). These forms lose every digit where the two radii meet,
and K2 also where one radius is much larger than the other. Here both are written in the
complementary parameter
``m1 = 1 - rho**2 = |eta - s| (eta + s) / hi**2`` with ``rho = lo/hi``, which is exact to rounding
everywhere. The kernels depend on the ratio of the two radii alone, so that their unit does not
matter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

__all__ = ["normal_kernel", "tangential_kernel"]


class _RadiusPair(NamedTuple):
    """The source radius, the smaller and the larger radius, and ``m1``: broadcast arrays."""

    eta: NDArray[np.float64]
    lo: NDArray[np.float64]
    hi: NDArray[np.float64]
    m1: NDArray[np.float64]


def _ordered(eta: ArrayLike, s: ArrayLike, distance: ArrayLike | None) -> _RadiusPair:
    eta, s = np.broadcast_arrays(np.asarray(eta, dtype=float), np.asarray(s, dtype=float))
    lo = np.minimum(eta, s)
    hi = np.maximum(eta, s)
    gap = hi - lo if distance is None else np.asarray(distance, dtype=float)
    return _RadiusPair(eta, lo, hi, (gap / hi) * ((hi + lo) / hi))


def normal_kernel(
    eta: ArrayLike, s: ArrayLike, *, distance: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Evaluate K1, the normal displacement at `s` of a ring load at `eta`.

    Parameters
    ----------
    eta, s : array_like
        Source and field radius (dimensionless, positive); they broadcast.
    distance : array_like, optional
        ``|eta - s|`` where it is known better than the difference of the two.

    Returns
    -------
    ndarray
        K1 = (eta/hi) K(rho), dimensionless; ``inf`` on the diagonal.

    Notes
    -----
    Equations (2.4) and (3.4) of the paper, which prints them after Landen's transformation.
    """
    eta, _, hi, m1 = _ordered(eta, s, distance)
    with np.errstate(divide="ignore"):
        return np.asarray(eta / hi * special.ellipkm1(m1))


def tangential_kernel(
    eta: ArrayLike, s: ArrayLike, *, distance: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Evaluate K2, the radial displacement at `s` of a ring of radial traction at `eta`.

    Parameters
    ----------
    eta, s : array_like
        Source and field radius (dimensionless, positive); they broadcast.
    distance : array_like, optional
        ``|eta - s|`` where it is known better than the difference of the two.

    Returns
    -------
    ndarray
        K2 = (eta/lo) [K(rho) - E(rho)] = eta lo / (3 hi^2) R_D(0, m1, 1), dimensionless;
        ``inf`` on the diagonal.

    Notes
    -----
    Equations (2.4) and (4.4) of the paper; Carlson's R_D takes the difference K - E exactly.
    """
    eta, lo, hi, m1 = _ordered(eta, s, distance)
    return np.asarray((eta / hi) * (lo / hi) / 3.0 * special.elliprd(0.0, m1, 1.0))
