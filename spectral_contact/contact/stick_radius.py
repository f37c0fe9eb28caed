"""The root of continuity: the radius of a stick disk, in ``logit(c**2)``."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign

from spectral_contact.contact.resolution import ROUNDING

#: Stick radii are searched between 1e-65 and 1 - 1e-43; beyond, rounding leaves nothing to find.
LEAST_LOGIT, LARGEST_LOGIT = -300.0, 100.0
#: What rounding leaves of conditions and fields; 1e-15 and 1e-12 change no space of 91 scenes.
NOISE = 1e-13
#: A change of the condition as small as its noise after a step as short as this is rounding by one
#: per cent, and no slope follows.
_SHORT = 1e-3
#: Half the step of a difference that is a slope to two digits.
_BESIDE = 0.05
#: Steps of the secant, of which 4 are enough but next to onsets.
_SECANTS = 10


class NoStickDiskError(ArithmeticError):
    """No radius in the range searched makes the traction continuous.

    Attributes
    ----------
    at_centre : bool
        Whether the root lies below the range: the stick disk is smaller than 1e-65. Else the
        slip annulus is narrower than that, or slip is not one annulus at the edge.
    """

    def __init__(self, at_centre: bool) -> None:
        super().__init__("no stick disk in the range searched")
        self.at_centre = at_centre


def root_near(
    function: Callable[[float], float],
    start: float,
    slope: float,
    error: float,
    longest: float = 0.5,
    least: float = LEAST_LOGIT,
) -> tuple[float, float]:
    """Return a rough root in logit(c**2), and the slope there; else that of a bracket.

    Below the least logit none is looked for. The root is that of the parabola of x over the last
    three values; its error is estimated by the product of their distances from it. The slope is a
    guess at first: no step is longer than `longest` then.
    """
    if slope == 0.0:
        return bracketed_root(function, least)
    x, value = start, function(start)
    last: tuple[float, float, float] | None = None  # x, value and secant at the point before
    step, product, inverse = -value / slope, 1.0, 1.0 / slope
    for _ in range(8):
        step = max(min(step, longest), -longest)
        if not least < x + step < LARGEST_LOGIT:
            break
        fresh = function(x + step)
        if fresh == value:
            break
        secant = step / (fresh - value)
        if secant <= 0.0:
            break
        product, inverse, following = abs(step), secant, -fresh * secant
        if last is not None and fresh != last[1]:
            bend = (secant - last[2]) / (fresh - last[1])
            tangent = secant - bend * (fresh + value)
            if tangent > 0.0:
                following += bend * fresh * value
                inverse, product = tangent, product * abs(x + step - last[0])
        last, x, value, longest, step = (x, value, secant), x + step, fresh, 2.0, following
        if abs(step) * product < error * max(1.0, abs(x)):
            return x + step, 1.0 / inverse
    return bracketed_root(function, least)


def bracketed_root(
    function: Callable[[float], float], least: float = LEAST_LOGIT
) -> tuple[float, float]:
    """Return a rough root in logit(c**2), and the slope there; the function rises with c.

    One below the least logit is none: the stick disk is at the centre.
    """
    low, high, step = -2.0, 2.0, 2.0
    at_low, at_high = function(low), function(high)
    while at_high < 0.0:
        low, at_low, high, step = high, at_high, min(high + step, LARGEST_LOGIT), 2.0 * step
        if low >= LARGEST_LOGIT:
            raise NoStickDiskError(at_centre=False)
        at_high = function(high)
    while at_low > 0.0:
        high, at_high, low, step = low, at_low, max(low - step, least), 2.0 * step
        if high <= least:
            raise NoStickDiskError(at_centre=True)
        at_low = function(low)
    if at_low == at_high:  # so flat that nothing is known of a root
        raise NoStickDiskError(at_centre=False)
    middle = 0.5 * (low + high)
    while high - low > _SHORT * max(1.0, abs(low)):
        # Illinois: false position that halves the value of an end it keeps
        middle = high - at_high * (high - low) / (at_high - at_low)
        value = function(middle)
        if value > 0.0:
            high, at_high, at_low = middle, value, 0.5 * at_low
        elif value < 0.0:
            low, at_low, at_high = middle, value, 0.5 * at_high
        else:
            break
    return middle, slope_at(function, middle)


def slope_at(function: Callable[[float], float], x: float) -> float:
    """Return the slope by a central difference."""
    return (function(x + _BESIDE) - function(x - _BESIDE)) / (2.0 * _BESIDE)


def polished_root(
    function: Callable[[float], float], guess: float, slope: float
) -> tuple[float, float]:
    """Secant from a good guess; return the root and the slope there."""
    x, value = guess, function(guess)
    if slope == 0.0:  # the annulus is so narrow that its width makes no difference any more
        raise NoStickDiskError(at_centre=x < 0.0)
    lag = _SHORT  # what is given of the slope is good to three digits
    for _ in range(_SECANTS):
        step = max(min(-value / slope, 2.0), -2.0)
        # a secant step errs by the product of itself and the one before
        if abs(step) * lag <= ROUNDING * max(1.0, abs(x)):
            return x + step, slope
        fresh = function(x + step)
        if fresh == value:
            return x + step, slope
        if abs(fresh - value) > NOISE or abs(step) > _SHORT:
            slope = (fresh - value) / step
        x, value, lag = x + step, fresh, abs(step)
        if not LEAST_LOGIT < x < LARGEST_LOGIT:
            raise NoStickDiskError(at_centre=x < 0.0)
    return _enclosed_root(function, x, value)


def _enclosed_root(
    function: Callable[[float], float], x: float, value: float
) -> tuple[float, float]:
    """Return the root on that side of x where it must be, and the slope there.

    Next to the onset of slip the function is exponential in the logit, and secants crawl.
    """
    from scipy.optimize import toms748

    step, other, fresh = 0.5, x, value
    while fresh * value > 0.0:
        x, value, step = other, fresh, 2.0 * step
        other = x + copysign(step, -value)  # the function rises with c
        if not LEAST_LOGIT < other < LARGEST_LOGIT:
            raise NoStickDiskError(at_centre=value > 0.0)
        fresh = function(other)
    root = toms748(function, min(x, other), max(x, other), xtol=ROUNDING) if x != other else x
    # nearer by than that the difference may be rounding
    slope = slope_at(function, root)
    if slope <= 0.0:
        raise NoStickDiskError(at_centre=root < 0.0)
    return root, slope
