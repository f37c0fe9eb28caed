"""The radius c of one stick disk: its range, guesses of it, and the root of its residual.

The unknown is the logit ``ln(c**2/(1 - c**2))``, in which radii next to the centre and next to the
edge are as easy as others.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import copysign, log, log1p, pi

from spectral_contact.contact.resolution import EPSILON_DEPTH, TINY
from spectral_contact.contact.tuning import JACOBIAN_RANGE, MIN_STICK_RADIUS, ROUNDING
from spectral_contact.spectral.parameters import Parameters

#: Logits of stick radii c are at most this, and at least minus this. The matrix of a disk scales
#: like ``c**5`` (docs/theory): at the least logit, where c is close to 0, doubles still represent
#: this number with all digits. At the largest one they still represent ``1 - c**2``.
MAX_LOGIT = 2.0 * (-log(TINY) - EPSILON_DEPTH) / 5.0
MIN_LOGIT = -MAX_LOGIT


class NoStickDiskError(ArithmeticError):
    """No radius in the range searched makes the traction continuous.

    Attributes
    ----------
    at_centre : bool
        True if the root lies below the range: the stick disk is too small to be looked for, and the
        whole contact is taken to slip. False if the slip annulus is too narrow to be found, or if
        slip is not one annulus at the edge.
    """

    def __init__(self, at_centre: bool) -> None:
        super().__init__("no stick disk in the range searched")
        self.at_centre = at_centre


def enclosed_root(
    function: Callable[[float], float],
    guess: float,
    error: float,
    *,
    least: float = MIN_LOGIT,
) -> tuple[float, float]:
    """Return a root in the logit of c, and the slope there.

    From the guess on, steps that double enclose the root by a change of sign; a bracketing method
    finds it.

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
        If there is no root; `at_centre` is true if it lies below the least logit.
    """
    from scipy.optimize import toms748

    function = cache(function)  # the bracketing method begins with values at ends that are known
    x = other = guess
    value = other_value = function(guess)
    step = 0.5
    # from x to the other end the function has not changed its sign yet
    while other_value * value > 0.0:
        x = other
        value = other_value
        step *= 2.0
        # the root lies below x where the value is positive
        other = min(max(x + copysign(step, -value), least), MAX_LOGIT)
        if other == x:
            raise NoStickDiskError(at_centre=value > 0.0)
        other_value = function(other)
    root = toms748(function, min(x, other), max(x, other), xtol=error) if x != other else x
    difference = function(root + JACOBIAN_RANGE) - function(root - JACOBIAN_RANGE)
    if difference <= 0.0:  # a change of sign by noise, as at both ends of the range
        raise NoStickDiskError(at_centre=root < 0.0)
    return root, difference / (2.0 * JACOBIAN_RANGE)


def min_logit(parameters: Parameters) -> float:
    """Return the least logit of a stick disk whose fields are right to rounding around it.

    With a layer it is that of the radius ``ROUNDING * min(alpha, 1)``: within a radius c that is
    small beside alpha, p is constant up to a relative ``(c/alpha)**2``, and no smaller disk changes
    a result. On a smooth surface the square of the radius is rounding.
    """
    alpha = parameters.alpha
    return 2.0 * log(ROUNDING * min(alpha, 1.0)) if alpha > 0.0 else -EPSILON_DEPTH


def min_search_logit(parameters: Parameters) -> float:
    """Return the least logit of a stick disk that is looked for with elastic coupling.

    It is that of `min_logit`, but on a smooth surface with tangential compliance, where smaller
    disks can be solved for, that of MIN_STICK_RADIUS.
    """
    if parameters.alpha == 0.0 < parameters.beta:
        return 2.0 * log(MIN_STICK_RADIUS)
    return min_logit(parameters)


def limiting_logit(parameters: Parameters) -> float:
    """Return a guess of the logit of the stick radius under a known pressure, from its limits.

    They are those for ``kappa = 1`` (docs/theory). On a smooth surface the logit grows like
    ``pi f/2`` as f grows, and the radius c is ``4 exp(-2/f)`` as f vanishes. The guess is the sum
    of the first logit and that of the second radius. This radius is divided by ``1 + f``, which is
    1 as f vanishes, so that it is below 1 under any friction: the guess is below the first logit,
    as f grows by ``2 ln(f/4)``, which is little beside that logit. With normal compliance
    the pressure is constant closer to the edge than alpha, which limits the logit from above. With
    tangential compliance c is ``2 beta f`` as f vanishes, which limits it from below.
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
