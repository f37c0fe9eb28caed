"""The friction law, verified on samples: ``|q| <= f p`` in stick, and slip against the traction.

p and q are pressure and traction, f is friction; ``y = 1 - s**2`` at the radius s, which is `rest`
of a `Radius`, and `gap` is a difference of y. An `Annulus` has a half at each boundary, with panels
graded toward it, whose sampling points are at `y`. Slip is sampled
as the radial displacement times the sign of the traction, so that it is negative where the law
holds and positive where it has the wrong sense.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, sqrt
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from spectral_contact.contact.resolution import EPSILON_DEPTH, sample_depths
from spectral_contact.contact.tuning import SAMPLES, SLIP_ROUNDING, TRACTION_ROUNDING
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parts import gap

if TYPE_CHECKING:
    from spectral_contact.spectral.annulus import Annulus

Interval: TypeAlias = tuple[float, float]

#: Distance from a boundary, over the width of the zone, at which slip is as small as its rounding:
#: it grows like the distance to the power 3/2.
_BOUNDARY_DISTANCE = float(np.cbrt(SLIP_ROUNDING)) ** 2
#: A violation of the friction law by less is none, and slip that is about to start is known to this
#: part of the radius at best: an annulus opens like the root of ``1 - f/f_crit``, which has the
#: rounding of the traction.
UNRESOLVED_SLIP = sqrt(TRACTION_ROUNDING)
#: Distances from the boundaries of a zone, over its extent, at which stick is verified.
DISTANCES = np.exp(-sample_depths(EPSILON_DEPTH, 3 * SAMPLES))


def missing_stick(
    annulus: Annulus, sample: Array, largest: float, at_edge: float = 0.0, excused: float = 0.0
) -> tuple[Interval, ...]:
    """Return where a slip zone moves with its traction, so that stick is missing there.

    Left out is slip in the wrong sense that is adjacent to a boundary with a stick zone, which is
    an error of that boundary, and slip that is nowhere larger than its error. Next to the edge,
    where slip does not go to zero, neither is an excuse.

    Parameters
    ----------
    annulus : Annulus
        The slip zone.
    sample : ndarray
        The displacement times the sign of the traction, at the sampling points of the annulus.
    largest : float
        The largest displacement of all zones; 1e-10 of it is rounding.
    at_edge : float
        The same as the sample, at the edge, which is beyond all sampling points.
    excused : float
        Error of the displacement, relative to the largest.

    Returns
    -------
    tuple of (float, float)
        Intervals of y, outward; one that ends at 0 reaches the edge.
    """
    y = annulus.y
    reaches_edge = annulus.outer.from_edge == 0.0
    if reaches_edge:
        y = np.append(y, 0.0)
        sample = np.append(sample, at_edge)
    if not (sample > SLIP_ROUNDING * largest).any():
        return ()
    outward = np.argsort(-y)
    y = y[outward]
    sample = sample[outward]
    wrong = sample > SLIP_ROUNDING * largest
    starts = np.flatnonzero(wrong & ~np.concatenate([[False], wrong[:-1]]))
    ends = np.flatnonzero(wrong & ~np.concatenate([wrong[1:], [False]]))

    margin = _BOUNDARY_DISTANCE * gap(annulus.inner, annulus.outer)
    outermost_y = annulus.outer.rest + margin
    innermost_y = annulus.inner.rest - margin
    intervals: list[Interval] = []
    for start, end in zip(starts, ends, strict=True):
        adjacent_inside = y[start] >= innermost_y
        adjacent_outside = not reaches_edge and y[end] <= outermost_y
        at_the_edge = reaches_edge and end == len(y) - 1
        exceeds_error = sample[start : end + 1].max() > excused * largest
        if adjacent_inside or adjacent_outside or not (at_the_edge or exceeds_error):
            continue
        # an interval that is the edge alone begins at the last sampling point
        inner_y = float(y[start]) or float(y[start - 1])
        intervals.append((inner_y, float(y[end])))
    return tuple(intervals)


def obeys(excess: float, error: float, wrong: float, slip_error: float) -> bool:
    """Return whether the friction law holds within the errors.

    Parameters
    ----------
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0.
    error : float
        The larger of the relative errors of q and p.
    wrong : float
        The largest slip in the wrong sense, relative to the largest slip; rounding is excused.
    slip_error : float
        Error of the slip, relative to the largest.
    """
    return excess <= excused_excess(error) and wrong <= max(slip_error, SLIP_ROUNDING)


def excused_excess(error: float) -> float:
    """Return the largest ``|q|/(f p) - 1`` in stick that errors explain: the sum of those of q, p.

    On none of 58 solutions it comes to more than 0.07 of the larger.

    Parameters
    ----------
    error : float
        The larger of the relative errors of q and p.
    """
    return 2.0 * error


def edge_sense_unknown(slip_at_edge: float, excused: float) -> float:
    """Return 1 if stick at the edge may be missing because slip there is below its error, else 0.

    That is so next to the second threshold of friction. The error counts as a half at most: slip
    with hardly a digit belongs to a narrow zone, which is uncertain as a whole already.

    Parameters
    ----------
    slip_at_edge : float
        Relative to the largest slip.
    excused : float
        Error of the slip, relative to the largest.
    """
    return float(abs(slip_at_edge) <= max(min(excused, 0.5), SLIP_ROUNDING))


def inf_if_unresolved(error: float) -> float:
    """Return the relative error of a displacement, infinite if no digit of it is known."""
    return error if error <= 1.0 else inf


def slip_error_from_boundaries(shift: float) -> float:
    """Return the error of slip, relative to the largest, if boundaries of its zone are off.

    Slip over a narrow annulus is like ``(x (1 - x))**(3/2)``, with the distance x from a boundary
    over the width; that is ``2**3 x**(3/2)`` of its largest value next to the boundary.

    Parameters
    ----------
    shift : float
        The error of the boundaries over the width of the zone.
    """
    return 2.0**3 * shift * sqrt(shift)


def stick_violation(friction: float, fields_in_stick: Iterable[tuple[Array, Array]]) -> float:
    """Return the largest ``|q|/(f p) - 1`` in stick, or 0.

    Parameters
    ----------
    friction : float
    fields_in_stick : iterable of (ndarray, ndarray)
        q and p at the same radii. Next to a boundary the two differ by the square root of the
        distance from it, so that these distances have to be exact.
    """
    violation = 0.0
    for q, p in fields_in_stick:
        violation = max(violation, float((np.abs(q) / (friction * p)).max()) - 1.0)
    return violation
