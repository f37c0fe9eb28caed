"""What a solve returns, all of it immutable data; plain records are those of `records`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import NotComputedError
from spectral_contact.fields.evaluation import over_s
from spectral_contact.fields.series import DiskSeries, PressureField, ZonalField
from spectral_contact.inputs import checks
from spectral_contact.records import (
    COUPLING,
    FULL_STICK,
    NORMAL,
    PARTIAL_SLIP,
    QUANTITIES,
    SLIP_FIELD,
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
from spectral_contact.scene import Scene

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from spectral_contact.interior import Inside
    from spectral_contact.studies.derivatives import Sensitivity
    from spectral_contact.view.physical import PhysicalSolution

__all__ = [
    "COUPLING",
    "FULL_STICK",
    "NORMAL",
    "PARTIAL_SLIP",
    "QUANTITIES",
    "SLIP_FIELD",
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
class Solution:
    """The solution of a scene, dimensionless; SI values are in `physical`.

    Built by `solve`. Immutable, comparable (wall-clock times do not count) and picklable; it is
    stored and loaded by `save` and `load`.

    Attributes
    ----------
    scene : Scene
    rtol : float
        The tolerance asked.
    plan : Plan
        What ran and what was skipped, each with its reason.
    error : ErrorEstimates
    converged : bool
        Whether every estimate that `rtol` bounds is below it.
    ending : Ending
    work : Work
    values : dict
        Scalars and zones by name; use the properties.
    pressure_field, traction_field, slip_field
        Evaluators; use `pressure`, `traction` and `slip`.
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

    def _require(self, quantity: str) -> None:
        if quantity not in self.plan.quantities:
            reasons = dict(self.plan.missing)
            raise NotComputedError(quantity, reasons.get(quantity, "it was not asked for"))

    def _value(self, quantity: str) -> Any:
        self._require(quantity)
        return self.values[quantity]

    @property
    def approach(self) -> float:
        """Approach ``delta* = a delta E / (4 (1 - nu^2) P)``, equation (3.4)."""
        return float(self._value("approach"))

    @property
    def approach_bounds(self) -> tuple[float, float]:
        """Bounds of ``delta*`` from below and above, rigorous up to rounding (docs/theory).

        Taken from the pressure by quadrature of the elliptic kernel when asked for, which takes
        0.1 s to some seconds.

        Raises
        ------
        NotComputedError
            If the pressure was not asked for; with elastic coupling where the surface slips, which
            dissipates, or a compliance is 0.
        """
        self._require("pressure")
        if self.scene.couples:
            return self._coupled_bounds()
        if self.scene.normal_compliance == 0.0:  # known exactly
            return self.approach, self.approach
        from spectral_contact.equations.bounds import approach_bounds

        field = self.pressure_field
        assert isinstance(field, PressureField)
        return approach_bounds(self.scene.normal_compliance, self.values["approach"], field)

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
        """Measure of shear ``Q* = 2 pi int q* s ds``, (4.3) and (5.8)."""
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
        """Ratio ``q/p`` of full stick at the edge."""
        return float(self._value("edge_ratio"))

    @property
    def critical_friction(self) -> float:
        """Smallest friction coefficient without slip, the largest ``|q|/p`` of full stick."""
        return float(self._value("critical_friction"))

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
        """Evaluate the pressure ``p* = a^2 p / P``.

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

        Parameters, return value and errors are those of `pressure`.
        """
        return self._field(self.slip_field, "slip", s, from_edge)

    @property
    def inside(self) -> Inside:
        """Stress and displacement anywhere in the half-space; needs pressure and traction."""
        from spectral_contact.interior import Inside

        return Inside(self)

    @property
    def physical(self) -> PhysicalSolution:
        """The same quantities in Pa, m and N.

        Raises
        ------
        NotComputedError
            If the scene was not made by `Scene.from_physical`.
        """
        found: PhysicalSolution = _above("view.physical").PhysicalSolution(self)
        return found

    def summary(self) -> str:
        """Return what the command line prints: quantities with errors, zones, plan and work."""
        return str(_above("view.report").report(self))

    def plot(self) -> Figure:
        """Draw the fields, the zones and the errors; see `plotting.plot_solution`.

        Raises
        ------
        NotComputedError
            If neither pressure nor traction was asked for.
        MissingDependencyError
            If matplotlib is not installed (extra: plot).
        """
        figure: Figure = _above("view.plotting").plot_solution(self)
        return figure

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a table of the fields with estimates of their errors; the rest is in its comments.

        The radii resolve the edge layer and every zone.

        Raises
        ------
        NotComputedError
            If no field was asked for.
        SolutionFileError
            If the path cannot be written.
        """
        _above("view.report").write_csv(self, path)

    def to_xarray(
        self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> xarray.Dataset:
        """Return everything as a dataset with names, units and estimates of errors.

        Parameters
        ----------
        s, from_edge : array_like, optional
            Where the fields are taken: radii in [0, 1], or distances from the edge. By default at
            radii that resolve the edge layer and every zone.

        Returns
        -------
        xarray.Dataset
            As that of `sweep`, for one scene.

        Raises
        ------
        SceneError
            For both arguments, or a radius outside [0, 1].
        MissingDependencyError
            If xarray is not installed (extra: sweep).
        """
        dataset: xarray.Dataset = _above("sweeps.dataset").of_solution(self, s, from_edge)
        return dataset

    def sensitivity(
        self, parameters: Iterable[str] | None = None, *, progress: bool | None = None
    ) -> Sensitivity:
        """Return derivatives of approach, total shear and stick radius by the parameters.

        By closed forms where there are any, else by polynomials through ten to thirty solves a
        parameter, which takes seconds. Where one is not finite, or one-sided, its note says so.

        Parameters
        ----------
        parameters : iterable of str, optional
            Out of ``"normal_compliance"``, ``"tangential_compliance"``, ``"friction"`` and
            ``"poisson_ratio"``, dimensionless; by default all.
        progress : bool, optional
            Whether to show progress (extra: progress); by default on a terminal and in notebooks.

        Returns
        -------
        Sensitivity
            ``found["stick_radius", "friction"]`` has value, estimated relative error, and a note.

        Raises
        ------
        SceneError
            For another parameter.
        NotComputedError
            With elastic coupling.
        """
        study = _above("studies.derivatives")
        found: Sensitivity = study.sensitivity(self, parameters, progress=progress)
        return found

    def _repr_html_(self) -> str:
        return str(_above("view.html").of_solution(self))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Store the solution in one ``.npz`` or ``.json`` file, every value exactly.

        Raises
        ------
        SolutionFileError
            For another suffix, or a path that cannot be written.
        """
        from spectral_contact.io import storage

        storage.save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Solution:
        """Load what `save` stored.

        Raises
        ------
        SolutionFileError
            For a file that is not there, not ours, damaged, or of another version.
        """
        from spectral_contact.io import storage

        return storage.load(path)

    def to_json(self) -> str:
        """Return the solution as one line of strict JSON; its numbers are exact.

        Raises
        ------
        SolutionFileError
            If it holds NaN.
        """
        from spectral_contact.io import storage

        return storage.to_json(self)

    @classmethod
    def from_json(cls, text: str) -> Solution:
        """Return the solution that `to_json` wrote, equal to it bit for bit.

        Raises
        ------
        SolutionFileError
            If the text is not JSON, not ours, damaged, or of another version.
        """
        from spectral_contact.io import storage

        return storage.from_json(text)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Solution):
            return NotImplemented
        from spectral_contact.io import storage

        return storage.comparable(self) == storage.comparable(other)

    def __hash__(self) -> int:
        return hash((self.scene, self.rtol, self.plan.quantities))

    @property
    def less_certain(self) -> dict[str, float]:
        """Estimates above `rtol`, as those of zone boundaries and slip may be; by quantity."""
        estimates = {name: getattr(self.error, name) for name in self.plan.quantities}
        return {k: one for k, one in estimates.items() if one is not None and not one <= self.rtol}

    def __repr__(self) -> str:
        known = ", ".join(
            f"{name}={self.values[name]:.16g}"
            for name in ("approach", "total_shear", "stick_radius")
            if isinstance(self.values.get(name), float)
        )
        opening, unsure = self.values.get("opening"), self.less_certain.items()
        opens = "" if opening is None else f" would open within {opening:.3g} of the edge"
        less = " but for" * bool(unsure) + ",".join(f" {k} to {error:.1e}" for k, error in unsure)
        return f"<Solution {known}{opens} converged={self.converged}{less}>"


def _above(module: str) -> Any:
    """Return a module that knows solutions, by name: an import would go up the layers."""
    return import_module(f"spectral_contact.{module}")
