"""Coupled slip under little friction: the stick disk is too small to change the fields.

Such a disk is not solved for. It is replaced by a *regularising* disk of a given radius, larger
than the true one and small enough not to change the fields, which carries no traction of its own.
"""

from __future__ import annotations

import numpy as np

from spectral_contact.contact.layout import Layout, fixed_disk
from spectral_contact.contact.resolution import (
    TINY,
)
from spectral_contact.contact.stick_radius import (
    min_logit,
)
from spectral_contact.contact.tuning import CENTRAL_CLEARANCE, ROUNDING
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters


def regularising_radius(parameters: Parameters) -> Radius:
    """Return the radius of the stick disk that replaces a smaller one.

    With normal compliance it is the least radius that is solved for. Without, p is a power of s
    around the disk, and loses digits like 1/c next to a disk of radius c, so that the radius is
    ``2 sqrt(eps) (kappa f)**(-1/3)`` with the rounding error eps, and CENTRAL_CLEARANCE times it
    is small, too.
    """
    alpha, _, kappa, friction = parameters
    if alpha > 0.0:
        return Radius.from_logit(min_logit(parameters))
    c = 2.0 * np.sqrt(ROUNDING) / np.cbrt(max(kappa * friction, TINY))
    c = min(c, 1.0 / CENTRAL_CLEARANCE**2)
    return Radius(float(c), float(1.0 - c))


def full_slip_problem(parameters: Parameters) -> tuple[Parameters, Layout]:
    """Return parameters and zones to solve for slip everywhere but in the regularising disk.

    The radius of the disk is given. A huge tangential compliance makes the traction in it vanish: a
    traction that sticks would exceed f p, and cost as many digits. The friction is at least the
    rounding error, because a smaller one leaves the traction without a digit.
    """
    alpha, _, kappa, friction = parameters
    regularised = Parameters(alpha, 1.0 / ROUNDING, kappa, max(friction, ROUNDING))
    return regularised, fixed_disk(regularising_radius(parameters).logit)
