"""One solve in the paper's model: partial slip under a pressure that is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from spectral_contact.fields.series import Radius
from spectral_contact.solution import PARTIAL_SLIP
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import ZonePath, place_of

if TYPE_CHECKING:
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.resolution import NormalContact


@dataclass(frozen=True, slots=True)
class FrictionOf:
    """The friction that a stick disk has, and the shear that goes with it.

    Attributes
    ----------
    friction, total_shear : float
    friction_error, shear_error : float
        Estimates of relative errors.
    """

    friction: float
    friction_error: float
    total_shear: float
    shear_error: float


class UncoupledRun(Run):
    """The steps of a plan without elastic coupling; parameters are those of `Run`."""

    def given_radius(self, logit: float) -> FrictionOf | None:
        """Return the friction with which there is one stick disk of this radius.

        That of the scene does not count. None if there is none, or the friction law does not hold,
        or the tolerance is not met, or the traction is not positive: then alone the law holds
        between two frictions at which it does (docs/internals).
        """
        from spectral_contact.contact.slip_outcome import zones_outcome
        from spectral_contact.contact.stick_radius import NoStickDiskError
        from spectral_contact.contact.zone_problem import solve_given_radius

        contact = self._normal({step.name: step.state for step in self.plan.steps})
        radius = Radius.from_logit(logit)
        form = contact, self.parameters, radius, self.rtol, self.max_unknowns
        try:
            solved, friction = solve_given_radius(*form)
        except NoStickDiskError:
            return None
        disk = solved.best.value
        outcome = zones_outcome(disk, self.parameters._replace(friction=friction), contact)
        positive = bool((disk.shears[0].at_ends() >= 0.0).all())
        if not (outcome.settled and positive) or disk.shear_error > self.rtol:
            return None
        kappa, shift = self.scene.kappa, float(disk.logit_errors[0])
        return FrictionOf(kappa * friction, shift, kappa * disk.total_shear, disk.shear_error)

    def slipping(self, contact: NormalContact, stick: FullStick) -> None:
        """Find the zones."""
        from spectral_contact.contact.zone_search import UncoupledSearch

        parameters = self.parameters
        path, place = self.shared.get(PARTIAL_SLIP, (), ZonePath), place_of(parameters)
        solved = UncoupledSearch(
            parameters,
            stick,
            self.rtol,
            self.max_unknowns,
            self.record,
            contact,
            near=path.near(place),
            pointwise=not {"traction", "slip", "zones"}.isdisjoint(self.plan.quantities),
        ).outcome()
        path.add(place, solved.layout)
        self.take(solved, self.scene.kappa)
