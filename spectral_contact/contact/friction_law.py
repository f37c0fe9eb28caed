"""The friction law, verified on samples: ``|q| <= f p`` in stick, and slip against the traction.

p, q and f are pressure, traction and friction. s is the radius over that of the contact, and ``y =
1 - s**2``, the attribute `rest` of a `Radius`. Slip is sampled as the radial displacement times the
sign of the traction: it is negative where the law holds, and positive, or of the wrong sense, where
the displacement has the direction of the traction. It is sampled at the points `y` of an `Annulus`.

That ``q = +-f p`` in slip is not checked here: it is built into the fields and rows of
`spectral.contact_fields`. docs/contributing, another friction law, lists all places that take part.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, sqrt
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from spectral_contact.contact.resolution import EPSILON_DEPTH, sample_depths
from spectral_contact.contact.tuning import SAMPLES, SLIP_ROUNDING, TRACTION_ROUNDING
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parts import z_difference

if TYPE_CHECKING:
    from spectral_contact.spectral.annulus import Annulus

Interval: TypeAlias = tuple[float, float]

#: Distance from a boundary, over the width of the zone, at which slip is as small as its rounding,
#: because it grows like the distance to the power 3/2.
_BOUNDARY_DISTANCE = float(np.cbrt(SLIP_ROUNDING)) ** 2
#: A violation of the friction law by full stick that is smaller counts as none. The stick radius
#: where slip is about to start has at least this relative error: an annulus opens like the root of
#: ``1 - f/f_crit``, which has the rounding of the traction.
UNRESOLVED_SLIP = sqrt(TRACTION_ROUNDING)
#: Distances in y from the boundary of a part, over the extent of the part, at which stick is
#: verified.
DISTANCES = np.exp(-sample_depths(EPSILON_DEPTH, 3 * SAMPLES))


def missing_stick(
    annulus: Annulus, sample: Array, largest: float, at_edge: float = 0.0, excused: float = 0.0
) -> tuple[Interval, ...]:
    """Return where slip has the wrong sense, so that stick is missing there.

    Left out are intervals that are adjacent to a boundary with a stick zone, because there the
    error of the boundary may explain them, and intervals on which slip is nowhere larger than its
    error. The edge is no such boundary, and slip does not vanish there. So an interval that reaches
    the edge is kept however small slip is, unless it begins at the inner boundary: then the whole
    zone has the wrong sense, and is itself wrong.

    Parameters
    ----------
    annulus : Annulus
        The slip zone.
    sample : ndarray
        The slip at the sampling points of the annulus.
    largest : float
        The largest modulus of the slip in all zones; SLIP_ROUNDING of it is rounding.
    at_edge : float
        The slip at the edge, which is beyond all sampling points.
    excused : float
        Error of the slip, relative to the largest.

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
    outward = np.argsort(-y)
    y = y[outward]
    sample = sample[outward]
    wrong = sample > SLIP_ROUNDING * largest
    starts = np.flatnonzero(wrong & ~np.concatenate([[False], wrong[:-1]]))
    ends = np.flatnonzero(wrong & ~np.concatenate([wrong[1:], [False]]))

    margin = _BOUNDARY_DISTANCE * z_difference(annulus.inner, annulus.outer)
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
        # an interval of the edge alone is extended to the last sampling point
        first = start if y[start] > 0.0 else start - 1
        intervals.append((float(y[first]), float(y[end])))
    return tuple(intervals)


def named_violation(excess: float, error: float, wrong: float, slip_error: float) -> str:
    """Return the name of a violation of the friction law beyond the errors; empty without one.

    Parameters
    ----------
    excess : float
        The largest ``|q|/(f p) - 1`` in stick, or 0.
    error : float
        The larger of the relative errors of q and p.
    wrong : float
        The largest slip of the wrong sense, relative to the largest slip.
    slip_error : float
        Error of the slip, relative to the largest; infinite if no digit of it is known.
    """
    if not excess <= excused_excess(error):
        return "the traction in stick exceeds friction"
    if not wrong <= max(slip_error, SLIP_ROUNDING):
        return "the surface slips with the traction"
    return ""


def excused_excess(error: float) -> float:
    """Return the largest ``|q|/(f p) - 1`` in stick that the errors of q and p explain together.

    The excess of none of 58 solutions is more than 0.07 of the larger error.

    Parameters
    ----------
    error : float
        The larger of the relative errors of q and p.
    """
    return 2.0 * error


def edge_sense_unknown(slip_at_edge: float, excused: float) -> float:
    """Return 1 if stick at the edge may be missing because slip there is below its error, else 0.

    It is taken as a relative error of the zones; 1 is no digit. Next to the second threshold of
    friction the slip at the edge is that small. The error counts as 1/2 at most: slip with hardly a
    digit belongs to a narrow zone, all of which is uncertain for another reason.

    Parameters
    ----------
    slip_at_edge : float
        The slip at the edge, relative to the largest.
    excused : float
        Error of the slip, relative to the largest.
    """
    return float(abs(slip_at_edge) <= max(min(excused, 0.5), SLIP_ROUNDING))


def inf_if_unresolved(error: float) -> float:
    """Return a relative error, or infinity if it is above 1, so that no digit is known."""
    return error if error <= 1.0 else inf


def slip_error_from_boundaries(shift: float) -> float:
    """Return the error of slip, relative to the largest, by an error of its zone's boundaries.

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
        q and p at the same radii. Next to a boundary the difference of ``|q|`` and f p goes like
        the square root of the distance from it, so that both have to be evaluated at the same
        distance to the last digit.
    """
    violation = 0.0
    for q, p in fields_in_stick:
        violation = max(violation, float((np.abs(q) / (friction * p)).max()) - 1.0)
    return violation
