"""The root of continuity: the radius of a stick disk, in ``logit(c**2)``."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, inf, log, log1p, pi, sqrt

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.resolution import ROUGH, ROUNDING
from spectral_contact.contact.slip_source import SlipSource
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.parameters import Parameters

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
#: Longest step.
_LONGEST = 2.0


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
    error: float = ROUNDING,
    *,
    known: float = inf,
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
    known : float
        Relative error of the slope; infinite if that is a guess.
    least : float
        Below this logit no root is looked for.
    """
    x, value = start, function(start)
    if slope == 0.0:
        return _enclosed_root(function, x, value, error, least)
    last: tuple[float, float, float] | None = None  # x, value and secant at the point before
    step, product, inverse = -value / slope, known, 1.0 / slope
    for _ in range(_SECANTS):
        step = max(min(step, _LONGEST), -_LONGEST)
        if abs(step) * product <= error * max(1.0, abs(x)):
            return x + step, 1.0 / inverse
        if not least < x + step < LARGEST_LOGIT:
            break
        fresh = function(x + step)
        rise, secant = fresh - value, inverse
        if abs(rise) > NOISE or abs(step) > _SHORT or product == inf:
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


def guessed_radius(
    drive: Drive,
    parameters: Parameters,
    error: float,
    near: tuple[float, float] | None = None,
    *,
    accuracy: float = ROUGH,
) -> tuple[float, float]:
    """Return the radius of a stick disk that the given pressure tells, and the slope there.

    Parameters
    ----------
    drive : Drive
        Of the pressure.
    parameters : Parameters
        For kappa = 1.
    error : float
        Of the radius as a logit, without tangential compliance; else a fit adds about 0.1.
    near : tuple of float, optional
        A radius near by, and the slope there.
    accuracy : float
        Of the condition.
    """
    begin = near or _from_limits(drive, parameters)
    return root_near(lambda x: _by_pressure(drive, parameters, x, accuracy), *begin, error)


def _from_limits(drive: Drive, parameters: Parameters) -> tuple[float, float]:
    """Return a guess of the radius from limits, and of the slope there."""
    alpha, beta, _, friction = parameters
    # on a smooth surface 1 - c falls like exp(-pi f/2), and c ~ 4 exp(-2/f) as f -> 0
    at_centre = 2.0 * log(2.0) - log1p(friction) - 2.0 / friction
    start = 0.5 * pi * friction + 2.0 * at_centre
    slope = min(1.0, 0.5 * friction) / (2.0 * pi)
    if alpha > 0.0:  # closer to the edge than alpha the pressure does not grow any more
        start = min(start, 2.0 - log(alpha))
    if beta > 0.0:  # c grows like 2 beta f/kappa at first
        start = max(start, 2.0 * log(2.0 * beta * friction))
    start = min(max(start, LEAST_LOGIT), LARGEST_LOGIT)
    if beta > 0.0:  # what a disk of great compliance needs falls like 1/c
        radius = Radius.from_logit(start)
        at_rim = drive.pressure.value(radius.rest)
        slope += 2.0 * friction * at_rim * beta / radius.value * radius.rest
    return start, slope


def _by_pressure(drive: Drive, parameters: Parameters, logit: float, accuracy: float) -> float:
    """Return ``1 - ((f/kappa) P(c) + m) / R(c)`` with the m that a disk needs, roughly.

    Without tangential compliance that is 0. A disk of great compliance takes 4 times the jump
    of its displacement; what is added for less is fitted.
    """
    alpha, beta, _, friction = parameters
    radius = Radius.from_logit(logit)
    source = SlipSource([drive.pressure], radius, EDGE, alpha, accuracy)
    slipping = float(source.at(radius)[0])
    if beta > 0.0:
        soft = beta / radius.value
        more = 0.5 * log(1.0 + radius.rest / soft) / sqrt(radius.rest)
        slipping += drive.pressure.value(radius.rest) * soft * (4.0 + more)
    return 1.0 - friction * slipping / drive.value(radius.rest)


def slope_at(function: Callable[[float], float], x: float) -> float:
    """Return the slope by a central difference."""
    return (function(x + _BESIDE) - function(x - _BESIDE)) / (2.0 * _BESIDE)


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
    # nearer by than that the difference may be rounding
    slope = slope_at(function, root)
    if slope <= 0.0:
        raise NoStickDiskError(at_centre=root < 0.0)
    return root, slope
