"""Coupled slip under little friction: everywhere but in a stick disk too small to be felt."""

from __future__ import annotations

import numpy as np

from spectral_contact.contact.layout import Layout, unmoved
from spectral_contact.contact.resolution import TINY
from spectral_contact.contact.stick_radius import min_logit
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters

#: A disk stands for smaller ones without a layer of p: from this many of its radii on p lacks
#: 0.1/n**3 of kappa f, measured. And the largest of them.
CLEAR, _MOST_STAND_IN = 128.0, 2.0**-11


def stand_in(parameters: Parameters) -> Radius:
    """Return the stick disk that stands for those too small to be felt.

    Without normal compliance p loses digits like 1/c next to it, and is a power of s far inside.
    """
    alpha, _, kappa, friction = parameters
    if alpha > 0.0:
        return Radius.from_logit(min_logit(parameters))
    c = min(2.0 * np.sqrt(ROUNDING) / np.cbrt(max(kappa * friction, TINY)), _MOST_STAND_IN)
    return Radius(float(c), float(1.0 - c))


def unfelt_disk(parameters: Parameters) -> tuple[Parameters, Layout]:
    """Return what is to be solved for slip everywhere but in a disk too small to be felt.

    Its radius is given, and what sticks carries nothing.
    """
    alpha, _, kappa, friction = parameters
    # with less friction the traction has no digits; what sticks would have one of its own, which
    # costs digits by as much as it exceeds friction: none with so much compliance
    felt = Parameters(alpha, 1.0 / ROUNDING, kappa, max(friction, ROUNDING))
    return felt, unmoved(stand_in(parameters).logit)
