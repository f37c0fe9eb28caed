"""Slip with elastic coupling under so little friction f that the stick disk changes no field.

Such a disk is not solved for. It is replaced by a *regularising disk* of a fixed radius, larger
than the true one and small enough to change no field, in which the traction is zero.

alpha and beta are the normal and the tangential compliance and kappa the coupling parameter of
docs/theory; radii are over the radius of the contact.
"""

from __future__ import annotations

import numpy as np

from spectral_contact.contact.layout import Layout, fixed_disk
from spectral_contact.contact.resolution import REGULARISING_COMPLIANCE, TINY
from spectral_contact.contact.stick_radius import min_logit
from spectral_contact.contact.tuning import CENTRAL_CLEARANCE, ROUNDING
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parameters import Parameters


def regularising_radius(parameters: Parameters) -> Radius:
    """Return the radius of the regularising disk.

    With normal compliance it is the least radius that is solved for. Without normal compliance p is
    like a power of s around the disk, and next to a disk of radius c its rounding error is like
    ``ROUNDING/c``. A radius of ``2 sqrt(ROUNDING) (kappa f)**(-1/3)`` keeps rounding and the error
    of the disk below the error estimates of the fields. The radius is at most
    ``1/(16 CENTRAL_CLEARANCE)``: within CENTRAL_CLEARANCE of its radii the disk disturbs the
    fields, and that part of the contact shall end at a sixteenth of the contact radius or before.
    """
    if parameters.alpha > 0.0:
        return Radius.from_logit(min_logit(parameters))
    c = 2.0 * np.sqrt(ROUNDING) / np.cbrt(max(parameters.kappa * parameters.friction, TINY))
    c = min(c, 1.0 / (4.0**2 * CENTRAL_CLEARANCE))
    return Radius(float(c), float(1.0 - c))


def full_slip_problem(parameters: Parameters) -> tuple[Parameters, Layout]:
    """Return the parameters and zones whose solution stands for slip everywhere.

    The regularising disk is a stick zone whose boundary is no unknown. In place of beta it has
    REGULARISING_COMPLIANCE, so that the traction in it vanishes: with beta it would exceed f p by
    far, and the fields around it would lose digits to it. No error of this traction counts. The
    friction is at least ROUNDING, because the traction of a smaller one is all rounding.
    """
    with_disk_compliance = parameters._replace(
        beta=REGULARISING_COMPLIANCE, friction=max(parameters.friction, ROUNDING)
    )
    return with_disk_compliance, fixed_disk(regularising_radius(parameters).logit)
