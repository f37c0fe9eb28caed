"""The result of a solve, as immutable data; its plain records are in `records`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import NotComputedError
from spectral_contact.fields.evaluation import over_s
from spectral_contact.fields.history import ContactHistory
from spectral_contact.fields.series import DiskSeries, PressureField, ZonalField
from spectral_contact.io import checks
from spectral_contact.records import (
    ADHESION_QUANTITIES,
    COUPLING,
    FULL_STICK,
    GROWTH,
    LOAD_RATIOS,
    NORMAL,
    PARTIAL_SLIP,
    PROFILE_QUANTITIES,
    QUANTITIES,
    SLIP_FIELD,
    UNLOADED_QUANTITIES,
    UNLOADING,
    ZONE_SEARCH,
    Ending,
    ErrorEstimates,
    Plan,
    PlannedStep,
    RefinementStep,
    StepState,
    StepWork,
    Work,
    Zone,
)
from spectral_contact.view.output import Output, inside_of

if TYPE_CHECKING:
    from spectral_contact.equations.interior import Inside
    from spectral_contact.scene import Scene

__all__ = [
    "ADHESION_QUANTITIES",
    "COUPLING",
    "FULL_STICK",
    "GROWTH",
    "LOAD_RATIOS",
    "NORMAL",
    "PARTIAL_SLIP",
    "PROFILE_QUANTITIES",
    "QUANTITIES",
    "SLIP_FIELD",
    "UNLOADED_QUANTITIES",
    "UNLOADING",
    "ZONE_SEARCH",
    "Ending",
    "ErrorEstimates",
    "Plan",
    "PlannedStep",
    "RefinementStep",
    "Solution",
    "StepState",
    "StepWork",
    "TractionField",
    "Work",
    "Zone",
]

#: What a traction or a slip can be; None stands for zero.
TractionField = ZonalField | DiskSeries | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Solution(Output):
    """The solution of a scene, dimensionless; SI values are in `physical`.

    Built by `solve`. Immutable, comparable (wall-clock times do not count) and picklable; it is
    stored and loaded by `save` and `load`.

    Attributes
    ----------
    scene : Scene
    rtol : float
        The tolerance that was asked for.
    plan : Plan
        The steps that ran and those that were skipped, each with its reason.
    error : ErrorEstimates
    converged : bool
        Whether every estimate that `rtol` bounds is below it.
    ending : Ending
    work : Work
    values : dict
        Scalars and zones by name; use the properties.
    pressure_field, traction_field, slip_field
        Evaluators; use `pressure`, `traction` and `slip`.
    grown
        Use `history`.
    """

    scene: Scene
    rtol: float
    plan: Plan
    error: ErrorEstimates
    converged: bool
    ending: Ending
    work: Work
    values: dict[str, Any]
    pressure_field: PressureField | ZonalField | None = None
    traction_field: TractionField = None
    slip_field: TractionField = None
    grown: ContactHistory | None = None

    def _require(self, quantity: str) -> None:
        if quantity not in self.plan.quantities:
            reasons = dict(self.plan.missing)
            if quantity in PROFILE_QUANTITIES and self.scene.profile is None:
                reasons[quantity] = "the punch is flat: its radius and load are the units"
            if quantity in ADHESION_QUANTITIES and self.scene.work_of_adhesion is None:
                reasons[quantity] = "the scene has no adhesion"
            if quantity in UNLOADED_QUANTITIES and self.scene.unloaded_to == 1.0:
                reasons[quantity] = "the scene is at its largest load: unloaded_to is 1"
            raise NotComputedError(quantity, reasons.get(quantity, "it was not asked for"))

    def _value(self, quantity: str) -> Any:
        self._require(quantity)
        return self.values[quantity]

    @property
    def approach(self) -> float:
        """Approach ``delta* = a delta E / (4 (1 - nu^2) P)``, (3.4); with a profile in L."""
        return float(self._value("approach"))

    @property
    def contact_radius(self) -> float:
        """Contact radius under a profile, in its unit of length L."""
        return float(self._value("contact_radius"))

    @property
    def stiffness(self) -> float:
        """Contact stiffness dP/dδ under a profile, in E'L."""
        return float(self._value("stiffness"))

    @property
    def stiffness_on_branch(self) -> float:
        """What an instrument measures with adhesion, dP/dδ along the curve of states, in E'L.

        `stiffness` is dP/dδ at a constant contact radius, and another number. This one is negative
        on a stretch of the curve that is stable under control of the approach alone, and infinite
        where that ends.

        Raises
        ------
        NotComputedError
            Without adhesion, and where the contact is the flat part of a profile and no more.
        """
        return float(self._value("stiffness_on_branch"))

    @property
    def stable_under(self) -> tuple[str, ...]:
        """With adhesion what may be held constant without the contact running away.

        One, both or none of ``("load", "approach")``; none if the contact runs away whichever of
        them is held. The last stable state counts as stable.

        Raises
        ------
        NotComputedError
            Without adhesion, or if `stiffness_on_branch` was not asked for.
        """
        if "stable_under" not in self.values:
            self._require("stiffness_on_branch")
        return tuple(self.values["stable_under"])

    @property
    def error_scales(self) -> dict[str, float]:
        """What errors are relative to of quantities that may be 0 or negative.

        With adhesion load, approach, work and stiffness: of load and approach it is the sum of what
        they are without adhesion and of what adhesion takes away. Through a nonlinear layer the
        approach: it is the larger of its modulus and the displacement of the surface at the centre.
        Else empty.
        """
        names = ("load", "approach", "indentation_work", "stiffness_on_branch")
        return {k: self.values[f"{k}_scale"] for k in names if f"{k}_scale" in self.values}

    @property
    def indentation_work(self) -> float:
        """Work ∫P dδ of pressing a profile in, in E'L³.

        With adhesion it is along the curve of states from no contact to this one: elastic energy
        less that of the surfaces in contact.
        """
        return float(self._value("indentation_work"))

    @property
    def domain_radius(self) -> float:
        """Radius at s = 1 in L, of the contact under a profile, or where there is no edge.

        For a layer law without an edge it is a radius beyond which the pressure is less than
        1e-17 of its largest value.

        Raises
        ------
        NotComputedError
            If the scene has no profile.
        """
        if "domain_radius" in self.values:
            return float(self.values["domain_radius"])
        return self.contact_radius

    def gap(self, s: ArrayLike | None = None, *, beyond: ArrayLike | None = None) -> Any:
        """Evaluate the gap between punch and surface outside the contact of a profile, in L.

        Taken from the pressure by quadrature; its error is some 1e-14 of the approach and that of
        the pressure's estimate.

        Parameters
        ----------
        s : array_like, optional
            Radii r/a of at least 1, inside the reach of the profile.
        beyond : array_like, optional
            Instead of `s`: distances ``s - 1``.

        Returns
        -------
        float or ndarray
            Of the shape of the input.

        Raises
        ------
        SceneError
            For both or neither argument, or a radius that is inside or beyond the profile.
        NotComputedError
            If the punch is flat, or pressure, contact radius or approach was not asked for.
        """
        from spectral_contact.equations.gap import gap_outside

        return gap_outside(self, s, beyond)

    @property
    def approach_bounds(self) -> tuple[float, float]:
        """Bounds of ``delta*`` from below and above, rigorous up to rounding (docs/theory).

        Taken from the pressure by quadrature of the elliptic kernel when asked for, which takes
        0.1 s to some seconds.

        Raises
        ------
        NotComputedError
            If approach or pressure was not asked for; with elastic coupling where the surface
            slips, which dissipates, or a compliance is 0.
        """
        self._require("pressure")
        self._require("approach")
        if self.scene.profile is not None:
            raise NotComputedError("approach_bounds", "there are none with a profile")
        if self.scene.couples:
            return self._coupled_bounds()
        if self.scene.normal_compliance == 0.0:  # known exactly
            return self.approach, self.approach
        from spectral_contact.equations.bounds import approach_bounds

        field, load = self.pressure_field, self.scene.unloaded_to
        assert isinstance(field, PressureField)
        alpha, unit_approach = self.scene.normal_compliance, self.values["approach"] / load
        low, high = approach_bounds(alpha, unit_approach, field.times(1.0 / load))
        return load * low, load * high

    def _coupled_bounds(self) -> tuple[float, float]:
        from spectral_contact.equations.bounds import CoupledTraction, approach_bounds

        self._require("traction")
        scene, pressure, traction = self.scene, self.pressure_field, self.traction_field
        alpha, beta = scene.normal_compliance, scene.tangential_compliance
        if min(alpha, beta) == 0.0:
            reason = "with elastic coupling it takes normal and tangential compliance"
            raise NotComputedError("approach_bounds", reason)
        if not isinstance(pressure, PressureField) or not isinstance(traction, DiskSeries):
            raise NotComputedError("approach_bounds", "with elastic coupling it takes full stick")
        coupled = CoupledTraction(beta, scene.kappa, traction)
        return approach_bounds(alpha, self.values["approach"], pressure, coupled)

    @property
    def zones(self) -> tuple[Zone, ...]:
        """Stick and slip zones from the centre to the edge; empty without friction."""
        return tuple(self._value("zones"))

    @property
    def stick_radius(self) -> float | None:
        """Outer radius ``c*`` of the central stick zone, (5.7); None without friction."""
        value = self._value("stick_radius")
        return None if value is None else float(value)

    @property
    def total_shear(self) -> float:
        """Measure of shear ``Q* = 2 pi int q* s ds``, (4.3) and (5.8); of the sign of kappa."""
        return float(self._value("total_shear"))

    @property
    def opening(self) -> float | None:
        """Distance from the edge, dimensionless, within which the contact would open.

        With elastic coupling the shear may pull on the edge so much that the pressure of the
        equations is negative in places closer than this, and the surfaces would part there. The
        solution is that of the equations, in which they cannot. None where the pressure is positive
        all over, as it is without coupling.

        Raises
        ------
        NotComputedError
            If the pressure was not asked for.
        """
        self._require("pressure")
        value = self.values.get("opening")
        return None if value is None else float(value)

    @property
    def edge_ratio(self) -> float:
        """Ratio ``|q|/p`` of full stick at the edge."""
        return float(self._value("edge_ratio"))

    @property
    def critical_friction(self) -> float:
        """Smallest friction coefficient without slip, the largest ``|q|/p`` of full stick."""
        return float(self._value("critical_friction"))

    @property
    def shakedown_ratio(self) -> float:
        """Lowest load, over the largest one, down to which cycles of the load stop slipping.

        ``lambda* = (R - f)/(R + f)`` with the critical friction R (docs/cycles). If the load cycles
        between the largest one and one that is no less than this fraction of it, the contact shakes
        down: it stops slipping. Cycles that go lower slip and dissipate in every round. It is 0
        where nothing slips, and 1 without tangential compliance and at friction 0.

        Raises
        ------
        NotComputedError
            Without friction, under profiles, and with elastic coupling, where the law is only
            approximate.
        """
        return float(self._value("shakedown_ratio"))

    @property
    def reverse_ratio(self) -> float:
        """Load over the largest load at which slip back begins, in the first unloading.

        Raises
        ------
        NotComputedError
            At the largest load, and where nothing slips.
        """
        return float(self._value("reverse_ratio"))

    @property
    def turning_ratio(self) -> float:
        """Load over the largest load below which the state depends on its history.

        In the first unloading slip zones grow until the load is this one. Then one of them begins
        to shrink. Errors are those of `reverse_ratio`.
        """
        return float(self._value("turning_ratio"))

    def _field(
        self,
        evaluator: PressureField | TractionField,
        quantity: str,
        s: ArrayLike | None,
        from_edge: ArrayLike | None,
    ) -> Any:
        self._require(quantity)
        radius, distance = checks.radii(s, from_edge)
        if evaluator is None:
            return np.zeros(radius.shape)[()]
        return np.asarray(evaluator(radius, distance))[()]

    @over_s
    def pressure(self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate the pressure ``p* = a^2 p / P``; with a profile ``p / E'``.

        Parameters
        ----------
        s : array_like, optional
            Dimensionless radii in [0, 1], any shape.
        from_edge : array_like, optional
            Instead of `s`: distances ``1 - s``, accurate down to 1e-300.

        Returns
        -------
        float or ndarray
            Of the shape of the input; ``inf`` at the edge of a smooth surface, and NaN with
            coupling, where it oscillates without a limit.

        Raises
        ------
        SceneError
            For both or neither argument, or a radius outside [0, 1].
        NotComputedError
            If the pressure was not asked for.
        """
        return self._field(self.pressure_field, "pressure", s, from_edge)

    @over_s
    def traction(self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate the traction ``q* = a^2 q / P``, positive outward on the half-space.

        Parameters, return value and errors are those of `pressure`.
        """
        return self._field(self.traction_field, "traction", s, from_edge)

    @over_s
    def slip(self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate ``u_r* = u_r a E / (4 (1 - nu^2) P)``: zero in stick, inward (negative) in slip.

        Between two elastic bodies it is the half-space's displacement over the punch, outward
        (positive) where kappa is negative.

        With a profile it is in L, and counts from the moment a point came into contact; a point
        that sticks keeps its earlier slip.

        Parameters, return value and errors are those of `pressure`.
        """
        return self._field(self.slip_field, "slip", s, from_edge)

    @property
    def history(self) -> ContactHistory:
        """Load, approach, total shear and stick radius of a growing contact on its way here.

        Raises
        ------
        NotComputedError
            Unless the scene has a profile and friction, and a quantity was asked for that depends
            on the friction.
        """
        if self.grown is None:
            reasons = [one.reason for one in self.plan.steps if one.name == GROWTH]
            raise NotComputedError("history", *(reasons or ["the contact does not grow"]))
        return self.grown

    @property
    def inside(self) -> Inside:
        """Stress and displacement anywhere in the half-space; needs pressure and traction."""
        return inside_of(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Solution):
            return NotImplemented
        return bool(self._comparable == other._comparable)

    def __hash__(self) -> int:
        return hash((self.scene, self.rtol, self.plan.quantities))

    @property
    def less_certain(self) -> dict[str, float]:
        """Estimates above `rtol`, as those of zone boundaries and slip may be; by quantity."""
        estimates = {name: getattr(self.error, name) for name in self.plan.quantities}
        return {k: one for k, one in estimates.items() if one is not None and not one <= self.rtol}

    @property
    def remarks(self) -> tuple[str, ...]:
        """Questions about SI data that are likely to be in another unit, as `Scene.remarks`."""
        data = self.scene.physical
        if data is None:
            return ()
        return data.remarks(self.scene.poisson_ratio, self.values.get("contact_radius"))

    def __repr__(self) -> str:
        known = ", ".join(
            f"{name}={self.values[name]:.16g}"
            for name in ("contact_radius", "load", "approach", "total_shear", "stick_radius")
            if isinstance(self.values.get(name), float)
        )
        opening = self.values.get("opening")
        opens = "" if opening is None else f" would open within {opening:.3g} of the edge"
        unsure = ", ".join(
            f"{name} to {error:.1e}" if error < 1.0 else f"{name}, of which no digit is known"
            for name, error in self.less_certain.items()
        )
        less = f" but for {unsure}" if unsure else ""
        asked = "".join(f"; {remark}" for remark in self.remarks)
        return f"<Solution {known}{opens} converged={self.converged}{less}{asked}>"
