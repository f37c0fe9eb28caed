"""Load against approach over a cycle of adhesive contact, as `adhesion_cycle` returns it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array

if TYPE_CHECKING:
    from spectral_contact.scene import Scene

__all__ = ["AdhesionCycle", "CycleState"]


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

    Lengths are in L, loads in E'L², energies in E'L³; `in_si` has them in SI units. In a scene with
    SI data L is 1 m.

    Attributes
    ----------
    scene : Scene
    control : str
        ``"load"`` or ``"approach"``.
    machine_stiffness : float or None
        Stiffness of a machine between the punch and what is moved, in E'L; None if there is none.
    contact_radius, approach, load : ndarray, shape (n,)
        The curve of states, from the largest contact to the smallest.
    stable : ndarray of bool, shape (n,)
        Whether a state is stable under the control.
    error : float
        Largest estimate of the errors of load and approach of all states. As in `ErrorEstimates`
        they are relative to the sum of the value without adhesion and of what adhesion takes away.
    jump_in : tuple of two CycleState
        Before and after the jump into contact, which is at the approach 0.
    jump_out : tuple of CycleState
        The states before and after each jump while the punch is pulled off, one pair after
        another. Mostly there is one jump, to a punch without contact. With some profiles the
        contact jumps to a smaller radius before, and that jump has a pair of its own. Under control
        of the load the last jump has no state after it, as the punch goes away.
    dissipated : float or None
        Energy that the jumps dissipate, which is the area of the loop. None under control of the
        load: after the last jump the load goes on doing work without bound.
    dissipated_error : float or None
        Estimate of its absolute error.
    si_units : bool
        Whether all of this is in SI units, as `in_si` returns it.
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
    si_units: bool = False

    def in_si(self) -> AdhesionCycle:
        """Return the cycle in m, N, J and N/m; itself if it is in these units.

        Raises
        ------
        NotComputedError
            If the scene was not made by `Scene.from_physical`.
        """
        if self.si_units:
            return self
        data = self.scene.physical
        if data is None:
            raise NotComputedError("in_si", "the scene was not made by Scene.from_physical")

        # lengths are in m already; E' in Pa is a quarter of the reduced modulus
        modulus = data.quarter_modulus(self.scene.poisson_ratio)

        def scaled(value: float | None) -> float | None:
            return None if value is None else value * modulus

        def states(jump: tuple[CycleState, ...]) -> Any:
            return tuple(replace(state, load=state.load * modulus) for state in jump)

        return replace(
            self,
            machine_stiffness=scaled(self.machine_stiffness),
            load=self.load * modulus,
            jump_in=states(self.jump_in),
            jump_out=states(self.jump_out),
            dissipated=scaled(self.dissipated),
            dissipated_error=scaled(self.dissipated_error),
            si_units=True,
        )
