"""The friction law, checked: |q| <= f p in stick, and slip against the traction."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, sqrt
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from spectral_contact.contact.resolution import EPSILON_DEPTH, sample_depths
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parts import gap

if TYPE_CHECKING:
    from spectral_contact.spectral.annulus import Annulus

Interval: TypeAlias = tuple[float, float]

#: Slip in the wrong sense that rounding makes, relative to the largest.
_NEGLIGIBLE = 1e-10
#: Distance from an end, of the width, at which slip, which grows like its power 3/2, is its error.
_TOUCHING = float(np.cbrt(_NEGLIGIBLE)) ** 2
#: Slip over a narrow annulus is like ``(x (1 - x))**(3/2)``: 8 x**(3/2) of its largest at an end.
_LOOSE = 10.0
#: Distances from the ends of zones, of their extent, at which the law is looked at.
DISTANCES = np.exp(-sample_depths(EPSILON_DEPTH, 400))


def missing_stick(
    annulus: Annulus, sample: Array, largest: float, at_edge: float = 0.0, known: float = 0.0
) -> tuple[Interval, ...]:
    """Return where a slip zone moves with its traction, so that stick is missing there.

    What touches an end at which there is stick is the error of that end, and no zone; so is inside
    what errors make. At the edge, where slip is not small by itself, they do not excuse it.

    Parameters
    ----------
    annulus : Annulus
        The slip zone.
    sample : ndarray
        The displacement times the sign of the traction, at its sampling points.
    largest : float
        The largest displacement of all zones; less than 1e-10 of it is rounding.
    at_edge : float
        The same as the sample at the edge, past all sampling points.
    known : float
        What of the largest errors make.

    Returns
    -------
    tuple of (float, float)
        Intervals of ``y = 1 - s**2``, outward; one that ends at 0 reaches the edge.
    """
    y, to_edge = annulus.y, annulus.outer.from_edge == 0.0
    if to_edge:
        y, sample = np.append(y, 0.0), np.append(sample, at_edge)
    if not (sample > _NEGLIGIBLE * largest).any():
        return ()
    order = np.argsort(-y)
    y, sample = y[order], sample[order]
    wrong = sample > _NEGLIGIBLE * largest
    starts = np.flatnonzero(wrong & ~np.concatenate([[False], wrong[:-1]]))
    ends = np.flatnonzero(wrong & ~np.concatenate([wrong[1:], [False]]))
    last = len(y) - 1
    touching = _TOUCHING * gap(annulus.inner, annulus.outer)
    near, far = annulus.outer.rest + touching, annulus.inner.rest - touching
    return tuple(
        (float(y[a]) or float(y[a - 1]), float(y[b]))
        for a, b in zip(starts, ends, strict=True)
        if y[a] < far
        and (
            (to_edge and b == last)
            or ((to_edge or y[b] > near) and sample[a : b + 1].max() > known * largest)
        )
    )


def obeys(excess: float, error: float, wrong: float, slip_error: float) -> bool:
    """Return whether the friction law holds to the errors: that of q and that of p.

    Of 58 solutions of the net none has an excess above 0.07 errors. Slip may be wrong by rounding.
    """
    return excess <= 2.0 * error and wrong <= max(slip_error, _NEGLIGIBLE)


def hidden_stick(share: float, known: float) -> float:
    """Return 1 if stick at the edge may be missing, whose slip is this share of the largest.

    Next to the second threshold the sense of that slip is not known. Where slip has hardly a digit
    it is all as narrow as its zone.
    """
    return float(abs(share) <= max(min(known, 0.5), _NEGLIGIBLE))


def known_share(error: float) -> float:
    """Return the error of a displacement relative to its largest, infinite if no digit is known."""
    return error if error <= 1.0 else inf


def loose_slip(share: float) -> float:
    """Return what of the largest slip is wrong where ends are off by a share of its zone.

    Next to an end slip goes like the distance to the power 3/2.
    """
    return _LOOSE * share * sqrt(share)


def stick_excess(friction: float, sticking: Iterable[tuple[Array, Array]]) -> float:
    """Return the largest ``|q|/(f p) - 1`` in stick, or 0, from pairs of q and p in sample_depths.

    Next to a boundary they differ by a root of the distance: both are to be of the same distances,
    which are small but exact.
    """
    ratios = (np.abs(q) / (friction * p) for q, p in sticking)
    return max([0.0, *(float(one.max()) - 1.0 for one in ratios)])
