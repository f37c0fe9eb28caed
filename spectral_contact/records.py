"""Records of a solve: its plan, the zones, the error estimates and the work; plain data."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.fields.series import Radius
from spectral_contact.io.choices import instance, one_of
from spectral_contact.quantities import ADHESION_QUANTITIES, PROFILE_QUANTITIES, QUANTITIES
from spectral_contact.view.output import notebook_table

if TYPE_CHECKING:
    from spectral_contact.scene import Scene

__all__ = [
    "ADHESION_QUANTITIES",
    "COUPLING",
    "FULL_STICK",
    "GROWTH",
    "NORMAL",
    "PARTIAL_SLIP",
    "PROFILE_QUANTITIES",
    "QUANTITIES",
    "SLIP_FIELD",
    "ZONE_SEARCH",
    "AdhesionCycle",
    "CycleState",
    "Ending",
    "ErrorEstimates",
    "Plan",
    "PlannedStep",
    "RefinementStep",
    "StepState",
    "StepWork",
    "Work",
    "Zone",
]

#: Names of the steps, in plans and in records of work.
COUPLING = "elastic coupling"
NORMAL = "normal contact"
FULL_STICK = "full stick"
GROWTH = "growing contact"
PARTIAL_SLIP = "partial slip"
ZONE_SEARCH = "zone search"
SLIP_FIELD = "slip displacement"


def _make_plain(record: Any) -> None:
    """Turn NumPy's numbers in a new record into Python's, whatever has computed them.

    Both compare equal and print differently, which is no difference that a reader can explain.
    """
    for one in fields(record):
        value = getattr(record, one.name)
        if isinstance(value, np.generic):
            object.__setattr__(record, one.name, value.item())


class Ending(Enum):
    """How a refinement ended; the text, cause and remedy, is worded to follow a semicolon."""

    CONVERGED = "the error estimate met the tolerance."
    UNKNOWNS = "the next space would exceed max_unknowns. Raise max_unknowns, or loosen rtol."
    ROUNDING = "refinement no longer lowers the estimate: rounding is reached. Loosen rtol."
    ZONES = (
        "the slip zones found do not satisfy the friction law. Loosen rtol, or report the scene."
    )


class StepState(Enum):
    """Whether a step of a plan runs."""

    RUN = "run"
    CONDITIONAL = "if needed"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True)
class PlannedStep:
    """One step: its name, whether it runs, and why."""

    name: str
    state: StepState
    reason: str


@dataclass(frozen=True, slots=True)
class Plan:
    """The steps that a scene needs, and the reason for each quantity that is left out.

    Attributes
    ----------
    quantities : tuple of str
        Names of the quantities that will be computed.
    steps : tuple of PlannedStep
        In the order in which they run.
    missing : tuple of (str, str)
        Names of the quantities that will not be computed, each with the reason.
    """

    quantities: tuple[str, ...]
    steps: tuple[PlannedStep, ...]
    missing: tuple[tuple[str, str], ...] = ()

    def __repr__(self) -> str:
        parts = []
        for state in StepState:
            names = ", ".join(step.name for step in self.steps if step.state is state)
            parts += [f"{state.value}: {names}"] * bool(names)
        return f"<Plan {'; '.join(parts)}>"

    def _repr_html_(self) -> str:
        return notebook_table(self)

    def __str__(self) -> str:
        width = max(len(step.name) for step in self.steps)
        state = max(len(step.state.value) for step in self.steps)
        return "\n".join(
            f"{step.name:<{width}}  {step.state.value:<{state}}  {step.reason}"
            for step in self.steps
        )


@dataclass(frozen=True, slots=True)
class Zone:
    """An annulus in which the surfaces stick or slip, dimensionless.

    Attributes
    ----------
    kind : str
        ``"stick"`` or ``"slip"``.
    inner, outer : float
        Its radii; every one to relative accuracy.
    inner_from_edge, outer_from_edge : float
        One minus the radii, to relative accuracy. In solutions to many digits all four are
        mpmath's numbers.
    """

    kind: str
    inner: float
    outer: float
    inner_from_edge: float
    outer_from_edge: float

    def __post_init__(self) -> None:
        _make_plain(self)

    @classmethod
    def from_radii(cls, kind: str, inner: Radius, outer: Radius) -> Zone:
        """Return the zone between two radii.

        Raises
        ------
        SceneError
            If the kind is not stick or slip, or an end is no ``Radius``.
        """
        one_of("kind", kind, ("stick", "slip"))
        for name, end in (("inner", inner), ("outer", outer)):
            instance(name, end, Radius)
        return cls(kind, inner.value, outer.value, inner.from_edge, outer.from_edge)


@dataclass(frozen=True, slots=True)
class ErrorEstimates:
    """Estimates of relative errors; None where the quantity was not computed.

    - `pressure` is pointwise, the edge included.
    - `traction` is that of q/s, pointwise, at places fixed by the zone boundaries, whose errors
      are in `zones`. Where coupling makes p or q change sign, both are relative to the two together
      (docs/coupling).
    - `slip` is relative to its largest modulus.
    - `zones` bounds the relative error of every boundary, measured from the centre and from the
      edge. A stick zone too small to matter is left out; the error is then 1.
    - `violation` is the largest violation of the friction law: the excess of |q| over f p in
      stick, relative to f p, or slip in the direction of the traction, relative to the largest
      slip. In a converged solution the estimates of pressure, traction and slip explain it. Slip of
      which no digit is known has an infinite estimate and an unknown direction, and does not count.

    With a profile, `pressure` is relative to the larger of the pressure and its mean, and
    `traction` to its largest value. Where the pressure is infinite, at a tip or corner of a smooth
    surface, its estimate holds for distances above some 1e-17 of the square of the contact radius.

    With adhesion, load and approach are differences of what they are without it and of what it
    takes away, and may be 0: errors are relative to the sum of both, the work of indentation to the
    sum of elastic and surface energy (`Solution.error_scales`), `stiffness_on_branch` to the larger
    of itself and `stiffness`.
    """

    approach: float | None = None
    pressure: float | None = None
    traction: float | None = None
    slip: float | None = None
    zones: float | None = None
    stick_radius: float | None = None
    total_shear: float | None = None
    edge_ratio: float | None = None
    critical_friction: float | None = None
    violation: float | None = None
    contact_radius: float | None = None
    load: float | None = None
    stiffness: float | None = None
    indentation_work: float | None = None
    stiffness_on_branch: float | None = None

    def __post_init__(self) -> None:
        _make_plain(self)


@dataclass(frozen=True, slots=True)
class RefinementStep:
    """One step of the refinement: its unknowns, highest degree, error estimate and time [s]."""

    unknowns: int
    highest_degree: int
    error: float
    seconds: float = field(compare=False)

    def __post_init__(self) -> None:
        _make_plain(self)


@dataclass(frozen=True, slots=True)
class StepWork:
    """The work of one step of the plan.

    Attributes
    ----------
    name : str
    unknowns : int
        Unknowns of the final space; 0 where a closed form was used.
    degrees : tuple of int
        Degree on every panel of the final space.
    history : tuple of RefinementStep
    ending : Ending
    seconds : float
        Wall-clock time; not part of equality.
    """

    name: str
    unknowns: int
    degrees: tuple[int, ...]
    history: tuple[RefinementStep, ...]
    ending: Ending
    seconds: float = field(compare=False)


@dataclass(frozen=True, slots=True)
class Work:
    """All steps that ran."""

    steps: tuple[StepWork, ...]

    @property
    def unknowns(self) -> int:
        """Largest number of unknowns in one linear system."""
        return max((step.unknowns for step in self.steps), default=0)

    @property
    def refinements(self) -> int:
        """Number of spaces tried, in all steps together."""
        return sum(len(step.history) for step in self.steps)

    @property
    def seconds(self) -> float:
        """Wall-clock time of all steps."""
        return sum(step.seconds for step in self.steps)

    def __getitem__(self, name: str) -> StepWork:
        for step in self.steps:
            if step.name == name:
                return step
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class CycleState:
    """A state at an end of a jump.

    Attributes
    ----------
    contact_radius, approach, load : float
        The radius is 0 where there is no contact.
    """

    contact_radius: float
    approach: float
    load: float


@dataclass(frozen=True, slots=True, eq=False)
class AdhesionCycle:
    """Approach and retraction of an adhesive contact, as `adhesion_cycle` returns them.

    Lengths are in L, loads in E'L², energies in E'L³; `in_si` has them in SI units.

    Attributes
    ----------
    scene : Scene
    control : str
        ``"load"`` or ``"approach"``.
    machine_stiffness : float or None
        In E'L.
    contact_radius, approach, load : ndarray, shape (points,)
        The curve of states, from the largest contact to the smallest.
    stable : ndarray of bool, shape (points,)
        Whether a state is stable under the control.
    error : float
        Largest error of a load or an approach, relative as in `ErrorEstimates`.
    jump_in : tuple of two CycleState
        Before and after the jump into contact, which is at the approach 0.
    jump_out : tuple of CycleState
        Before pull-off and after it; under control of the load the punch goes away, and there is no
        state after it. Of states between them, to which it may jump first, there are two more each.
    dissipated : float or None
        Energy that the jumps dissipate, which is the area of the loop; None under control of the
        load, whose work is not bounded.
    dissipated_error : float or None
        Estimate of its absolute error.
    """

    scene: Scene
    control: str
    machine_stiffness: float | None
    contact_radius: Array
    approach: Array
    load: Array
    stable: Array
    error: float
    jump_in: tuple[CycleState, CycleState]
    jump_out: tuple[CycleState, ...]
    dissipated: float | None
    dissipated_error: float | None

    def in_si(self) -> AdhesionCycle:
        """Return the cycle in m, N, J and N/m.

        Raises
        ------
        NotComputedError
            If the scene was not made by `Scene.from_physical`.
        """
        data = self.scene.physical
        if data is None:
            raise NotComputedError("in_si", "the scene was not made by Scene.from_physical")

        modulus = data.quarter_modulus(self.scene.poisson_ratio)

        def scaled(value: float | None) -> float | None:
            return None if value is None else value * modulus

        def states(jump: tuple[CycleState, ...]) -> Any:
            return tuple(replace(one, load=one.load * modulus) for one in jump)

        return replace(
            self,
            machine_stiffness=scaled(self.machine_stiffness),
            load=self.load * modulus,
            jump_in=states(self.jump_in),
            jump_out=states(self.jump_out),
            dissipated=scaled(self.dissipated),
            dissipated_error=scaled(self.dissipated_error),
        )
