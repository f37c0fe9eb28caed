"""Records of a solve: its plan, the zones, the error estimates and the work; plain data."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from enum import Enum
from typing import Any

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.fields.series import Radius
from spectral_contact.io.choices import instance, one_of
from spectral_contact.quantities import (
    ADHESION_QUANTITIES,
    PROFILE_QUANTITIES,
    QUANTITIES,
    UNLOADED_QUANTITIES,
)
from spectral_contact.view.output import notebook_table

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
UNLOADING = "unloading"
LOAD_RATIOS = "load ratios"


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
    ROUNDING = (
        "refinement no longer lowers the estimate: rounding, or the highest degree, is reached. "
        "Loosen rtol."
    )
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
    sense : int
        In slip +1 if the traction has the sense it has under growing load, -1 if the other.
    memory : bool
        Whether the zone sticks where it has slipped before, and keeps that slip.
    """

    kind: str
    inner: float
    outer: float
    inner_from_edge: float
    outer_from_edge: float
    sense: int = 1
    memory: bool = False

    def __post_init__(self) -> None:
        _make_plain(self)

    @classmethod
    def from_radii(
        cls, kind: str, inner: Radius, outer: Radius, *, sense: int = 1, memory: bool = False
    ) -> Zone:
        """Return the zone between two radii.

        Raises
        ------
        SceneError
            If the kind is not stick or slip, an end is no ``Radius``, the sense is not 1 or -1, or
            the memory no bool.
        """
        one_of("kind", kind, ("stick", "slip"))
        for name, end in (("inner", inner), ("outer", outer)):
            instance(name, end, Radius)
        if isinstance(sense, bool) or not isinstance(sense, int) or abs(sense) != 1:
            raise SceneError("sense", sense, "1 or -1")
        instance("memory", memory, bool)
        ends = inner.value, outer.value, inner.from_edge, outer.from_edge
        return cls(kind, *ends, sense=sense, memory=memory)


@dataclass(frozen=True, slots=True)
class ErrorEstimates:
    """Estimates of relative errors; None where the quantity was not computed.

    - `pressure` is pointwise, the edge included.
    - `traction` is that of q/s, pointwise, at places fixed by the zone boundaries, whose errors
      are in `zones`. Where coupling makes p or q change sign, both are relative to the two together
      (docs/coupling).
    - `slip` is relative to its largest modulus.
    - `zones` bounds the relative error of every boundary, measured from the centre and from the
      edge. It is 1 where the solution leaves out a stick zone that is too small to matter.
    - `violation` is the largest violation of the friction law: the excess of |q| over f p in
      stick, relative to f p, or slip in the direction of the traction, relative to the largest
      slip. In a converged solution the estimates of pressure, traction and slip explain it. Slip
      with an infinite estimate, of which no digit is known, does not count: its direction is not
      known either.

    With a profile, `pressure` is relative to the larger of the pressure and its mean, and
    `traction` to its largest value. The pressure on a smooth surface is infinite at a tip or corner
    of the profile. Its estimate holds at radii r for which ``|r**2 - b**2|`` is more than some
    1e-17 of the squared contact radius, with the radius b of the corner, 0 at a tip. Over a contact
    radius that is not given, a corner is only known to the error of that radius.

    Below the largest load the traction changes sign where the surface sticks with memory; its error
    there is relative to ``f p``.

    Through a nonlinear layer the approach may be 0 or negative: its error is relative to the larger
    of its modulus and the displacement of the surface at the centre (`Solution.error_scales`).

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
    shakedown_ratio: float | None = None
    reverse_ratio: float | None = None
    turning_ratio: float | None = None

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
