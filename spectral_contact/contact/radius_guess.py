"""The radius of a stick disk that a given pressure tells, before anything is solved."""

from __future__ import annotations

from math import log, log1p, pi, sqrt

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.resolution import ROUGH
from spectral_contact.contact.slip_source import SlipSource
from spectral_contact.contact.stick_radius import LARGEST_LOGIT, LEAST_LOGIT, root_near
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.parameters import Parameters


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
        Of the radius as a logit, without tangential compliance; else a fit adds about 0.005.
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
        start = max(start, 2.0 * (log(2.0 * beta) + log(friction)))
    start = min(max(start, LEAST_LOGIT), LARGEST_LOGIT)
    if beta > 0.0:  # what a disk of great compliance needs falls like 1/c
        radius = Radius.from_logit(start)
        at_rim = drive.pressure.value(radius.rest)
        slope += 2.0 * friction * at_rim * beta / radius.value * radius.rest
    return start, slope


def _by_pressure(drive: Drive, parameters: Parameters, logit: float, accuracy: float) -> float:
    """Return ``1 - ((f/kappa) P(c) + m) / R(c)`` with the m that a disk needs, roughly.

    Without tangential compliance that is 0. A disk of great compliance takes 4 times the jump
    of its displacement; what is added for less is fitted, to 0.03 of nine in ten of 233 logits.
    """
    alpha, beta, _, friction = parameters
    radius = Radius.from_logit(logit)
    source = SlipSource([drive.pressure], radius, EDGE, alpha, accuracy)
    slipping = float(source.at(radius)[0])
    if beta > 0.0:
        soft = beta / radius.value
        ratio = 2.0 * radius.rest / (soft * (0.5 + 12.0 * radius.rest))
        more = 2.0 / pi * log1p(ratio) / sqrt(radius.rest)
        slipping += drive.pressure.value(radius.rest) * soft * (4.0 + more)
    return 1.0 - friction * slipping / drive.value(radius.rest)
