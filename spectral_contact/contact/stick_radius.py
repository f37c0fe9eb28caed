"""The radius c of one stick disk: its range, guesses of it, and the root of its residual.

The unknown is the logit ``ln(c**2/(1 - c**2))``, in which radii next to the centre and next to the
edge are as easy as others.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, log, log1p, pi, sqrt

from spectral_contact.contact.resolution import EPSILON_DEPTH, TINY
from spectral_contact.contact.tuning import MAX_STEPS, ROUNDING
from spectral_contact.spectral.parameters import Parameters

#: Range of logits of stick radii c. The matrix of a disk scales like ``c**5`` (docs/theory), which
#: keeps its digits as a double down to this logit; radii as close to the edge are represented, too.
MAX_LOGIT = 2.0 * (-log(TINY) - EPSILON_DEPTH) / 5.0
MIN_LOGIT = -MAX_LOGIT


class NoStickDiskError(ArithmeticError):
    """No radius in the range searched makes the traction continuous.

    Attributes
    ----------
    at_centre : bool
        Whether the root lies below the range: the stick disk is too small to be looked for, and all
        slips. Else the slip annulus is too narrow, or slip is not one annulus at the edge.
    """

    def __init__(self, at_centre: bool) -> None:
        super().__init__("no stick disk in the range searched")
        self.at_centre = at_centre


def secant_root(
    function: Callable[[float], float],
    guess: float,
    error: float,
    *,
    least: float = MIN_LOGIT,
) -> tuple[float, float]:
    """Return a root in the logit of c, and the slope there.

    It is found by the secant method. Every step goes to the side of the root, which the sign of the
    value tells, and none is longer than 1 and twice the last one.

    Parameters
    ----------
    function : callable
        Rises with c.
    guess : float
    error : float
        Error of the root.
    least : float
        No root below this logit is looked for.

    Raises
    ------
    NoStickDiskError
        If no root is found; `at_centre` is true if it lies below the least logit.
    """
    x = guess
    value = function(x)
    step = copysign(sqrt(error), -value)
    for _ in range(MAX_STEPS):
        other = min(max(x + step, least), MAX_LOGIT)
        if other == x:
            raise NoStickDiskError(at_centre=value > 0.0)
        other_value = function(other)
        slope = (other_value - value) / (other - x)
        x = other
        value = other_value
        # rounding may make the slope zero or negative, as at both ends of the range
        length = min(1.0 + 2.0 * abs(step), abs(value) / max(slope, TINY))
        step = copysign(length, -value)
        if length < error:
            return x + step, slope
    raise NoStickDiskError(at_centre=x < 0.0)


def min_logit(parameters: Parameters) -> float:
    """Return the least logit of a stick disk that is solved for.

    With a layer it is that of the radius ``ROUNDING * min(alpha, 1)``: within a radius c that is
    small beside alpha, p is constant up to a relative ``(c/alpha)**2``, and no smaller disk changes
    a result. On a smooth surface the square of the radius is rounding.
    """
    alpha = parameters.alpha
    return 2.0 * log(ROUNDING * min(alpha, 1.0)) if alpha > 0.0 else -EPSILON_DEPTH


def limiting_logit(parameters: Parameters) -> float:
    """Return a guess of the logit of the stick radius under a known pressure, from its limits.

    On a smooth surface ``1 - c`` falls like ``exp(-pi f/2)``, and c is ``4 exp(-2/f)`` as f
    vanishes (docs/theory), for ``kappa = 1``; divided by ``1 + f``, that limit does not exceed the
    other one. With normal compliance the pressure does not rise any
    more closer to the edge than alpha; with tangential compliance c is ``2 beta f`` at first.
    """
    alpha = parameters.alpha
    beta = parameters.beta
    friction = parameters.friction
    log_radius = 2.0 * log(2.0) - log1p(friction) - 2.0 / friction
    logit = 0.5 * pi * friction + 2.0 * log_radius
    if alpha > 0.0:
        logit = min(logit, 2.0 - log(alpha))
    if beta > 0.0:
        logit = max(logit, 2.0 * (log(2.0 * beta) + log(friction)))
    return min(max(logit, MIN_LOGIT), MAX_LOGIT)
