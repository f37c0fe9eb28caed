"""The solution on given zones, before the friction law is checked.

s is the radius over that of the contact. Pressure p, traction q, friction f, approach delta, total
shear ``Q = 2 pi int q s ds`` and coupling kappa are those of docs/theory; E is the residual of the
tangential equation before the compliance is subtracted (`spectral.contact_system`). The logit of a
boundary b is ``ln(b**2/(1 - b**2))``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.slip_displacement import SlipZone, StickZone
from spectral_contact.fields.series import Array, LogSeries
from spectral_contact.spectral.contact_system import ContactSystem


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScalarResults:
    """Scalars and error estimates of a solution on zones, for unit load.

    Without elastic coupling those of the traction are for kappa = 1.

    Attributes
    ----------
    approach, total_shear : float
        delta and Q, dimensionless. Q is no resultant force, as the traction is radial.
    approach_error, shear_error : float
        Estimates of their relative errors.
    pressure_error, traction_error : float
        Estimates of the relative errors of p and of q/s at every radius.
    radius_error : float
        Estimate of the relative error of the radius of the central stick disk.
    zones_error : float
        The largest estimate of the error of a boundary, relative to its distance from the centre or
        to that from the edge, whichever makes it larger; infinite if a zone may not exist.
    """

    approach: float
    total_shear: float
    approach_error: float
    shear_error: float
    pressure_error: float
    traction_error: float
    radius_error: float
    zones_error: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ZoneSolution(ScalarResults):
    """The solution on any zones, before the friction law is checked.

    Under a known pressure its approach is 1, and the errors of approach and pressure are those of
    the contributions to that pressure alone; `slip_outcome.zones_outcome` puts approach and errors
    of the normal contact in their place.

    Attributes
    ----------
    stick_zones : list of StickZone
        Quadrature of ``t^2 E dt`` over every stick zone, the source of the displacement in the slip
        zones around it.
    slip_width_error : float
        Largest relative error of ``b^2 - a^2`` for a slip zone between a and b; it bounds the error
        of slip next to the ends (`friction_law.slip_error_from_boundaries`).
    residual_error : float
        Estimate of the largest error of E in the zones that stick and that slip: E drives the
        displacement in slip.
    jacobian : ndarray
        Derivatives of the boundary residual by the logits.
    pressures, shears : list of LogSeries, dict of LogSeries
        For unit load, p on every part of the mesh, outward: on the disk, then on the two halves of
        every zone around it; and q/s on those that stick, by the number of the part.
    system : ContactSystem
    solution : ndarray, shape (unknowns, 3)
        As columns: the vector of the system, whose series are `pressures` and `shears`; and the
        contributions to it of the top two degrees of every panel, and of the top one.
    logit_errors : ndarray, shape (boundaries,)
        Estimates of the errors of the logits of the boundaries.
    """

    stick_zones: list[StickZone]
    slip_width_error: float
    residual_error: float
    jacobian: Array
    pressures: list[LogSeries]
    shears: dict[int, LogSeries]
    system: ContactSystem
    solution: Array
    logit_errors: Array

    @property
    def layout(self) -> Layout:
        """The zones with their Jacobian, from which nearly the same contact can start."""
        logits = tuple(radius.logit for radius in self.system.radii)
        return Layout(logits, self.system.states, self.jacobian)

    @property
    def slip_samples(self) -> tuple[list[SlipZone], float]:
        """The slip zones with E at their sampling points, and the largest change of E there.

        The displacement is ``(1/(pi s)) int t^2 E dt / sqrt(s^2 - t^2)`` from these points; as the
        integral of 1 is ``s/4``, it changes by a quarter of that change at most.
        """
        zones = []
        largest_change = 0.0
        for zone, state in enumerate(self.system.states):
            if state:
                annulus = self.system.slip_annulus(zone)
                # on both halves of the annulus; as columns E and its change
                residuals = self.system.residual_on_annulus(self.solution[:, :2], annulus)
                zones.append(SlipZone(annulus, state, [residual[:, 0] for residual in residuals]))
                changes = (float(np.abs(residual[:, 1]).max()) for residual in residuals)
                largest_change = max(largest_change, *changes)
        return zones, largest_change
