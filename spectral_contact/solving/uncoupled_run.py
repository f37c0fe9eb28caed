"""One solve without elastic coupling: partial slip under a known pressure."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from time import perf_counter
from typing import TYPE_CHECKING

from spectral_contact.errors import NotComputedError
from spectral_contact.fields.series import Radius
from spectral_contact.solution import (
    LOAD_RATIOS,
    PARTIAL_SLIP,
    UNLOADED_QUANTITIES,
    UNLOADING,
    ZONE_SEARCH,
)
from spectral_contact.solving.run import Run
from spectral_contact.solving.sharing import ZonePath, log_parameters

if TYPE_CHECKING:
    from spectral_contact.contact.normal import NormalContact
    from spectral_contact.contact.ratio import FullStick
    from spectral_contact.contact.unloading import Unloading
    from spectral_contact.contact.zone_search import UncoupledSearch


@dataclass(frozen=True, slots=True)
class RadiusFriction:
    """The friction at which a stick disk has a given radius, and the total shear there.

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

    def given_radius(self, logit: float) -> RadiusFriction | None:
        """Return the friction at which the contact sticks in a disk of a given radius alone.

        The friction of the scene only has to be positive. A sweep solves few radii, and
        interpolates at the frictions between: the friction law holds there, too, if it holds at
        both ends and the traction is positive (docs/internals).

        None is returned if there is no such friction, if the friction law does not hold there, if
        the tolerance is not met, or if the traction at an end of the stick disk is negative.

        Parameters
        ----------
        logit : float
            ``ln(c**2/(1 - c**2))`` of the stick radius c.
        """
        from spectral_contact.contact.slip_outcome import zones_outcome
        from spectral_contact.contact.stick_radius import NoStickDiskError
        from spectral_contact.contact.zone_problem import solve_given_radius

        contact = self._normal({step.name: step.state for step in self.plan.steps})
        radius = Radius.from_logit(logit)
        try:
            solved, friction = solve_given_radius(
                contact, self.parameters, radius, self.rtol, self.max_unknowns
            )
        except NoStickDiskError:
            return None
        disk = solved.best.value
        outcome = zones_outcome(disk, self.parameters._replace(friction=friction), contact)
        traction_positive = bool((disk.shears[0].at_ends() >= 0.0).all())
        if not (outcome.verified and traction_positive and disk.shear_error <= self.rtol):
            return None
        kappa = self.scene.kappa
        friction_error = float(disk.logit_errors[0])  # with a given radius the unknown is ln f
        return RadiusFriction(
            kappa * friction, friction_error, kappa * disk.total_shear, disk.shear_error
        )

    def run_partial_slip(self, contact: NormalContact, stick: FullStick) -> None:
        """Search for the zones, starting from those of earlier scenes, and store the outcome."""
        from spectral_contact.contact.zone_search import UncoupledSearch

        parameters = self.parameters
        path = self.cache.get(PARTIAL_SLIP, (), ZonePath)
        log_point = log_parameters(parameters)
        unloaded = self.scene.unloaded_to < 1.0
        search = UncoupledSearch(
            parameters,
            stick,
            self.pressure_tolerance if unloaded else self.rtol,
            self.max_unknowns,
            self.record,
            contact,
            warm_start=path.predict(log_point),
            pointwise=unloaded
            or not {"traction", "slip", "zones"}.isdisjoint(self.plan.quantities),
        )
        if unloaded:
            self._unload(search)
            return
        solved = search.outcome()
        path.add(log_point, solved.layout)
        self.store(solved, self.scene.kappa)

    def _unload(self, search: UncoupledSearch) -> None:
        """Store the state below the largest load.

        Parameters
        ----------
        search : UncoupledSearch
            That for the zones at the largest load, to a tighter tolerance than the state's: the
            slip that it finds is an input of the state.

        Raises
        ------
        NotComputedError
            If the zones at the largest load are not known, or the state depends on its history.
        """
        from spectral_contact.contact.unloading import HistoryError, Unloading
        from spectral_contact.contact.zone_search import NoZonesError

        load_ratio = self.scene.unloaded_to
        key = (*self.normal_key, search.parameters, search.tolerance)

        def solve_largest_load() -> Unloading | None:
            loaded = search.outcome()
            if loaded.layout is None or not loaded.verified:
                return None
            return Unloading(search, loaded, self.tangential_tolerance)

        unloading: Unloading | None = self.cache.get(UNLOADING, key, solve_largest_load)
        state_name = f"the state unloaded to {load_ratio!r}"
        if unloading is None:
            raise NotComputedError(
                state_name,
                "the zones at the largest load are too narrow to be resolved, or none are found",
            )
        path = self.cache.get(LOAD_RATIOS, key, ZonePath)
        log_point = (log(load_ratio),)
        try:
            solved = unloading.state(load_ratio, self.record, path.predict(log_point))
        except (HistoryError, NoZonesError) as error:
            raise NotComputedError(state_name, str(error)) from None
        path.add(log_point, solved.layout)
        self.store(solved, self.scene.kappa)
        self.skip("the step unloading has found the zones", ZONE_SEARCH)
        self.ran("; ".join(trial.text for trial in solved.trials), UNLOADING)
        if set(UNLOADED_QUANTITIES).isdisjoint(self.plan.quantities):
            return
        begin = perf_counter()
        for name in UNLOADED_QUANTITIES:
            try:
                ratio = getattr(unloading, name)
            except NoZonesError as error:
                self.unavailable[name] = str(error)
            else:
                self.values[name] = ratio.value
                self.errors[name] = ratio.error
        self.record(LOAD_RATIOS, None, begin)
        self.ran("where slip back begins, and a slip zone begins to shrink", LOAD_RATIOS)
