"""Roots of the boundary residual of one stick radius c, and Jacobians by central differences.

The unknown is the logit ``ln(c**2/(1 - c**2))``, in which radii next to the centre and next to the
edge are as easy as others.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, inf, log, log1p, pi

import numpy as np

from spectral_contact.contact.tuning import (
    JACOBIAN_FIELD_TOL,
    MAX_DIFFERENCE_STEP,
    MAX_LOGIT,
    MAX_LOGIT_STEP,
    MAX_SECANT_STEPS,
    MIN_LOGIT,
    MIN_SMOOTH_LOGIT,
    RESIDUAL_NOISE,
    ROUNDING,
    SHORT_LOGIT_STEP,
    WIDE_LOGIT_STEP,
)
from spectral_contact.fields.series import Array
from spectral_contact.spectral.parameters import Parameters


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


def secant_root(
    function: Callable[[float], float],
    start: float,
    slope: float,
    error: float = ROUNDING,
    *,
    least: float = MIN_LOGIT,
) -> tuple[float, float]:
    """Return a root in the logit of c by secant steps, and the slope there.

    With three values the next step is to the root of the parabola of x, as a function of the value,
    through them. The error after a step is estimated by its length times the distances of the last
    points (`distances`). Where the steps do not converge the root is enclosed by signs.

    Parameters
    ----------
    function : callable
        Rises with c.
    start, slope : float
        A guess of the root, and of the slope; with a slope of 0 the root is enclosed by signs.
    error : float
        Error of the root, absolute up to a logit of 1, relative beyond.
    least : float
        No root below this logit is looked for.
    """
    x = start
    value = function(start)
    if slope == 0.0:
        return _enclosed_root(function, x, value, error, least)
    before: tuple[float, float, float] | None = None  # x, value, inverse slope of the last secant
    inverse_slope = 1.0 / slope
    step = -value / slope
    distances = inf
    for _ in range(MAX_SECANT_STEPS):
        step = max(min(step, MAX_LOGIT_STEP), -MAX_LOGIT_STEP)
        if abs(step) * distances <= error * max(1.0, abs(x)):
            return x + step, 1.0 / inverse_slope
        if not least < x + step < MAX_LOGIT:
            break
        next_value = function(x + step)
        difference = next_value - value
        secant = inverse_slope
        if abs(difference) > RESIDUAL_NOISE or abs(step) > SHORT_LOGIT_STEP:
            if difference * step <= 0.0:
                break
            secant = step / difference
        distances = abs(step)
        inverse_slope = secant
        next_step = -next_value * secant
        if before is not None and next_value != before[1]:
            curvature = (secant - before[2]) / (next_value - before[1])
            tangent = secant - curvature * (next_value + value)
            if tangent > 0.0:
                next_step += curvature * next_value * value
                inverse_slope = tangent
                distances *= abs(x + step - before[0])
        before = (x, value, secant)
        x = x + step
        value = next_value
        step = next_step
    return _enclosed_root(function, x, value, error, least)


def min_logit(parameters: Parameters) -> float:
    """Return the least logit of a stick disk that changes a result.

    Under a layer p is constant up to a relative ``(c/alpha)**2`` within c: as a radius it is
    ``ROUNDING * min(alpha, 1)``.
    """
    alpha = parameters.alpha
    return 2.0 * log(ROUNDING * min(alpha, 1.0)) if alpha > 0.0 else MIN_SMOOTH_LOGIT


def limiting_logit(parameters: Parameters) -> float:
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
    return min(max(logit, MIN_LOGIT), MAX_LOGIT)


def central_slope(function: Callable[[float], float], x: float) -> float:
    """Return the slope by a central difference, over a wider step where the short one is rounding.

    As spaces depend on x, the function may have steps of the size of its error.
    """
    for half_step in (SHORT_LOGIT_STEP, WIDE_LOGIT_STEP):
        difference = function(x + half_step) - function(x - half_step)
        if abs(difference) > RESIDUAL_NOISE / SHORT_LOGIT_STEP:
            break
    return difference / (2.0 * half_step)


def fd_jacobian(residual_at: Callable[[Array], Array], logits: Array) -> Array:
    """Return the derivatives of a residual by the logits, by central differences.

    With w the width of the narrower zone at the boundary, over which the residual varies, the half
    step h balances the noise of the residual and its third derivative:
    ``h/w = max(JACOBIAN_FIELD_TOL, ROUNDING / w**2)**(1/3)``, at most MAX_DIFFERENCE_STEP.
    """
    columns = []
    widths = np.diff(logits)
    for i in range(len(logits)):
        width = min([1.0, *(abs(widths[j]) for j in (i - 1, i) if 0 <= j < len(widths))])
        relative_step = float(np.cbrt(max(JACOBIAN_FIELD_TOL, ROUNDING / width**2)))
        half_step = min(relative_step, MAX_DIFFERENCE_STEP) * width
        step = half_step * np.eye(len(logits))[i]
        difference = residual_at(logits + step) - residual_at(logits - step)
        columns.append(difference / (2.0 * half_step))
    return np.array(columns).T


def _enclosed_root(
    function: Callable[[float], float],
    x: float,
    value: float,
    error: float,
    least: float,
) -> tuple[float, float]:
    """Return the root on the side of x where the sign of the value says it is, and the slope there.

    Next to the onset of slip the function is exponential in the logit, and secant steps are far too
    short. If the root lies below the least logit the stick disk is at the centre.
    """
    from scipy.optimize import toms748

    step = 0.5
    other = x
    other_value = value
    while other_value * value > 0.0:
        x = other
        value = other_value
        step *= 2.0
        # the function rises with c, so that the root lies below x where the value is positive
        other = min(max(x + copysign(step, -value), least), MAX_LOGIT)
        if other == x:
            raise NoStickDiskError(at_centre=value > 0.0)
        other_value = function(other)
    root = toms748(function, min(x, other), max(x, other), xtol=error) if x != other else x
    slope = central_slope(function, root)
    if slope <= 0.0:
        raise NoStickDiskError(at_centre=root < 0.0)
    return root, slope
