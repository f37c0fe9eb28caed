r"""A convex profile through convex points: a polynomial slope on every piece.

With the secants :math:`s_i` of the points, an interpolant is convex only if its slope at each point
lies between the secants on either side. With the slopes :math:`s_i - a` and :math:`s_i + b` at its
ends, the cubic on an interval is convex if :math:`a \le 2b` and :math:`b \le 2a`. Where it is not,
two parabolas take its place, which meet with the slope :math:`s_i` at the fraction
:math:`b/(a + b)` of the interval: Schumaker's quadratic spline, *On shape preserving quadratic
spline interpolation*, SIAM J. Numer. Anal. 20 (1983) 854-864.
"""

from __future__ import annotations

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array

#: Largest ratio of a and b, in either sense, at which the cubic on an interval is convex.
_CUBIC_RATIO = 2.0
#: Largest ratio of a and b at which two parabolas are taken. At a larger one the points have a
#: corner that they do not resolve: there the ratio is lowered to this one, and the slope jumps at
#: the point. So neither parabola has less than 1/51 of the interval.
_LARGEST_RATIO = 50.0
#: Points of the finite difference that gives the slope at a point.
_STENCIL = 5
#: How far the slope at a point may be from that of the parabola through the point and its two
#: neighbours, over the distance of the latter from the nearer secant.
_BAND = 0.9
#: Errors of the heights, in units of their rounding, within which three points are on one line.
_ROUNDINGS = 4.0


def convex_pieces(
    radii: tuple[float, ...], heights: Array
) -> tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]:
    """Return the pieces of a convex profile through points.

    Parameters
    ----------
    radii : tuple of float, length n >= 3
        From 0, increasing.
    heights : ndarray, shape (n,)
        From 0.

    Returns
    -------
    edges : tuple of float
        Where the pieces begin and end: the radii, and the knots between them.
    slopes : tuple of tuple of float
        Chebyshev coefficients of the slope on each piece.

    Raises
    ------
    SceneError
        If the heights fall, or a point lies above the line through its neighbours.
    """
    r = np.array(radii)
    secants, straight = _checked_secants(r, heights)
    begin, end = _end_slopes(r, heights, secants, straight)
    edges = [radii[0]]
    rows: list[tuple[float, ...]] = []
    for i, secant in enumerate(secants.tolist()):
        below = secant - float(begin[i])
        above = float(end[i]) - secant
        if straight[i]:
            rows.append((secant,))
        elif max(below, above) <= _CUBIC_RATIO * min(below, above):
            rows.append(_cubic(secant, below, above))
        else:
            knot = radii[i] + (radii[i + 1] - radii[i]) * above / (below + above)
            edges.append(knot)
            rows.append((secant - below / 2.0, below / 2.0))
            rows.append((secant + above / 2.0, above / 2.0))
        edges.append(radii[i + 1])
    return tuple(edges), tuple(rows)


def _cubic(secant: float, below: float, above: float) -> tuple[float, ...]:
    """Return the slope of the cubic that has the slopes secant - below and secant + above."""
    bend = 3.0 / 8.0 * (above - below)
    return (secant + (above - below) / 2.0 - bend, (above + below) / 2.0, bend)


def _checked_secants(r: Array, heights: Array) -> tuple[Array, Array]:
    """Return the secants, which do not fall, and which intervals the points make straight."""
    steps = np.diff(r)
    secants = np.diff(heights) / steps
    if secants[0] < 0.0:
        told = f"at least 0: they fall from the centre to the radius {r[1]:.6g}"
        raise SceneError("heights", float(heights[1]), told)
    sizes = np.abs(heights)
    rounding = np.finfo(float).eps * (sizes[:-1] + sizes[1:]) / steps
    slack = _ROUNDINGS * (rounding[:-1] + rounding[1:])
    gaps = np.diff(secants)
    if (gaps < -slack).any():
        # the height of a point above the chord of its neighbours
        above = -gaps * steps[:-1] * steps[1:] / (steps[:-1] + steps[1:])
        worst = int(np.argmax(np.where(gaps < -slack, above, -np.inf))) + 1
        told = (
            f"convex: the point {worst}, counted from 0, at the radius {r[worst]:.6g} lies "
            f"{above[worst - 1]:.3g} above the line through its neighbours; of noisy points "
            "convex_hull=True takes the hull"
        )
        raise SceneError("heights", float(heights[worst]), told)
    on_a_line = gaps <= slack
    straight = np.zeros(len(secants), dtype=bool)
    straight[:-1] |= on_a_line
    straight[1:] |= on_a_line
    # a slope that is nowhere negative, and whose mean on the interval is 0, is 0 everywhere on it
    straight[0] |= secants[0] == 0.0
    return np.maximum.accumulate(secants), straight


def _end_slopes(r: Array, heights: Array, s: Array, straight: Array) -> tuple[Array, Array]:
    """Return the slopes at which every interval begins and ends.

    They are equal where two intervals meet, except at corners of the points.
    """
    at_points = _point_slopes(r, heights, s)
    begin = at_points[:-1].copy()
    end = at_points[1:].copy()
    begin[straight] = s[straight]
    end[straight] = s[straight]
    for i in range(1, len(s)):
        # a straight interval fixes the slope of the next one
        if straight[i - 1] and not straight[i]:
            begin[i] = s[i - 1]
        elif straight[i] and not straight[i - 1]:
            end[i - 1] = s[i]
    if not straight[0]:
        lowest = s[0] - _CUBIC_RATIO * (end[0] - s[0])
        highest = s[0] - (end[0] - s[0]) / _CUBIC_RATIO
        begin[0] = max(0.0, min(max(begin[0], lowest), highest))
    if not straight[-1]:
        lowest = s[-1] + (s[-1] - begin[-1]) / _CUBIC_RATIO
        highest = s[-1] + _CUBIC_RATIO * (s[-1] - begin[-1])
        end[-1] = min(max(end[-1], lowest), highest)
    below = s - begin
    above = end - s
    end = np.minimum(end, s + _LARGEST_RATIO * below)
    begin = np.maximum(begin, s - _LARGEST_RATIO * above)
    # Limiting the ratios may leave a jump of the slope at a point. There is none after all if one
    # of the two slopes there suits both intervals.
    for i in range(1, len(s)):
        for slope in (end[i - 1], begin[i]):
            if end[i - 1] < begin[i] and not straight[i - 1] and not straight[i]:
                before = s[i - 1] - begin[i - 1], slope - s[i - 1]
                after = s[i] - slope, end[i] - s[i]
                if all(max(pair) <= _LARGEST_RATIO * min(pair) for pair in (before, after)):
                    end[i - 1] = begin[i] = slope
    return begin, end


def _point_slopes(r: Array, heights: Array, s: Array) -> Array:
    """Return a slope at every point, between the secants where there are two."""
    steps = np.diff(r)
    fine = np.array([_derivative(r, heights, i) for i in range(len(r))])
    weights = steps[:-1] / (steps[:-1] + steps[1:])
    middle = s[:-1] + weights * np.diff(s)
    band = _BAND * np.minimum(middle - s[:-1], s[1:] - middle)
    fine[1:-1] = np.clip(fine[1:-1], middle - band, middle + band)
    return fine


def _derivative(r: Array, heights: Array, i: int) -> float:
    """Return the derivative at a point of the polynomial through the points next to it."""
    first = min(max(i - _STENCIL // 2, 0), max(len(r) - _STENCIL, 0))
    chosen = [j for j in range(first, min(first + _STENCIL, len(r))) if j != i]
    total = 0.0
    for j in chosen:
        # (heights[j] - heights[i]) times the derivative of Lagrange's polynomial of r[j] at r[i]
        others = [k for k in chosen if k != j]
        factors = [(r[i] - r[k]) / (r[j] - r[k]) for k in others]
        total += (heights[j] - heights[i]) / (r[j] - r[i]) * float(np.prod(factors))
    return float(total)
