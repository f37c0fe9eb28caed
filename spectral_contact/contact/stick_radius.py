"""Roots and slopes of conditions: the radius of a stick disk, in ``logit(c**2)``."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, inf, log, log1p, pi

import numpy as np

from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parameters import Parameters

#: Stick radii are searched between 1e-54 and 1 - 1e-43: the fifth power of one is a double, too.
LEAST_LOGIT, LARGEST_LOGIT = -250.0, 100.0
#: The logit of the smallest stick disk that is looked for without a layer of p.
LEAST_PLAIN = -40.0
#: What rounding leaves of conditions and fields; 1e-15 and 1e-12 change no space of 91 scenes.
NOISE = 1e-13
#: What corrections leave of conditions whose differences are taken; what share of a zone's width
#: they span at most: 1e-5 takes 25 scenes 214 corrections, not 212; 0.03 and 0.5 change no digit.
SLOPING, _MOST_SHARE = 1e-8, 0.2
#: A change of the condition as small as its noise after a step as short as this is rounding by one
#: per cent, and no slope follows.
_SHORT = 1e-3
#: Half the step of a slope to two digits, where one of `_SHORT` shows rounding.
_BESIDE = 0.05
#: Steps of the secant, of which 4 are enough but next to onsets.
_SECANTS = 10
#: Longest step.
_LONGEST = 2.0


class NoStickDiskError(ArithmeticError):
    """No radius in the range searched makes the traction continuous.

    Attributes
    ----------
    at_centre : bool
        Whether the root lies below the range: the stick disk is smaller than 1e-54. Else the
        slip annulus is narrower than that, or slip is not one annulus at the edge.
    """

    def __init__(self, at_centre: bool) -> None:
        super().__init__("no stick disk in the range searched")
        self.at_centre = at_centre


def root_near(
    function: Callable[[float], float],
    start: float,
    slope: float,
    error: float = ROUNDING,
    *,
    least: float = LEAST_LOGIT,
) -> tuple[float, float]:
    """Return a root in logit(c**2) by secants, and the slope there; else one that is enclosed.

    The root is that of the parabola of x over the last three values; its error is estimated by the
    product of their distances from it.

    Parameters
    ----------
    function : callable
        Rises with c.
    start, slope : float
        A guess of the root, and of the slope.
    error : float
        Of the root, or relative beyond 1.
    least : float
        Below this logit no root is looked for.
    """
    x, value = start, function(start)
    if slope == 0.0:
        return _enclosed_root(function, x, value, error, least)
    last: tuple[float, float, float] | None = None  # x, value and secant at the point before
    step, product, inverse = -value / slope, inf, 1.0 / slope
    for _ in range(_SECANTS):
        step = max(min(step, _LONGEST), -_LONGEST)
        if abs(step) * product <= error * max(1.0, abs(x)):
            return x + step, 1.0 / inverse
        if not least < x + step < LARGEST_LOGIT:
            break
        fresh = function(x + step)
        rise, secant = fresh - value, inverse
        if abs(rise) > NOISE or abs(step) > _SHORT:
            if rise * step <= 0.0:
                break
            secant = step / rise
        product, inverse, following = abs(step), secant, -fresh * secant
        if last is not None and fresh != last[1]:
            bend = (secant - last[2]) / (fresh - last[1])
            tangent = secant - bend * (fresh + value)
            if tangent > 0.0:
                following += bend * fresh * value
                inverse, product = tangent, product * abs(x + step - last[0])
        last, x, value, step = (x, value, secant), x + step, fresh, following
    return _enclosed_root(function, x, value, error, least)


def least_logit(parameters: Parameters) -> float:
    """Return the logit of a stick disk that is not felt: p hardly changes in so much of a layer."""
    alpha = parameters.alpha
    return 2.0 * log(ROUNDING * min(alpha, 1.0)) if alpha > 0.0 else LEAST_PLAIN


def guessed_logit(parameters: Parameters) -> float:
    """Return a guess of the logit of the stick radius under a known pressure, from its limits.

    On a smooth surface ``1 - c`` falls like ``exp(-pi f/2)``, and c is ``4 exp(-2/f)`` as f
    vanishes (docs/theory), for ``kappa = 1``. With normal compliance the pressure does not rise any
    more closer to the edge than alpha; with tangential compliance c is ``2 beta f`` at first.
    """
    alpha, beta, _, friction = parameters
    at_centre = 2.0 * log(2.0) - log1p(friction) - 2.0 / friction
    logit = 0.5 * pi * friction + 2.0 * at_centre
    if alpha > 0.0:
        logit = min(logit, 2.0 - log(alpha))
    if beta > 0.0:
        logit = max(logit, 2.0 * (log(2.0 * beta) + log(friction)))
    return min(max(logit, LEAST_LOGIT), LARGEST_LOGIT)


def slope_at(function: Callable[[float], float], x: float) -> float:
    """Return the slope by a central difference, near by if that is no rounding: spaces may jump."""
    for step in (_SHORT, _BESIDE):
        rise = function(x + step) - function(x - step)
        if abs(rise) > NOISE / _SHORT:
            break
    return rise / (2.0 * step)


def differences(conditions_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the slopes by central differences, a share of the narrowest zone apart.

    Next to a narrow zone they fall with its width, and a small share would show rounding.
    """
    slopes, spacing = [], np.diff(logits)
    for i in range(len(logits)):
        near = min([1.0, *(abs(spacing[j]) for j in (i - 1, i) if 0 <= j < len(spacing))])
        share = min(float(np.cbrt(max(SLOPING, ROUNDING / near**2))), _MOST_SHARE)
        h = share * near
        step = h * np.eye(len(logits))[i]
        slopes.append((conditions_at(logits + step) - conditions_at(logits - step)) / (2.0 * h))
    return np.array(slopes).T


def _enclosed_root(
    function: Callable[[float], float],
    x: float,
    value: float,
    error: float,
    least: float,
) -> tuple[float, float]:
    """Return the root on that side of x where it must be, and the slope there.

    Next to the onset of slip the function is exponential in the logit, and secants crawl. If the
    root lies below the least logit the stick disk is at the centre.
    """
    from scipy.optimize import toms748

    step, other, fresh = 0.5, x, value
    while fresh * value > 0.0:
        x, value, step = other, fresh, 2.0 * step
        # the function rises with c
        other = min(max(x + copysign(step, -value), least), LARGEST_LOGIT)
        if other == x:
            raise NoStickDiskError(at_centre=value > 0.0)
        fresh = function(other)
    root = toms748(function, min(x, other), max(x, other), xtol=error) if x != other else x
    slope = slope_at(function, root)
    if slope <= 0.0:
        raise NoStickDiskError(at_centre=root < 0.0)
    return root, slope
