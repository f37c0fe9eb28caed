r"""Normal contact under a flat punch of any radius a, in the units of a scene with a profile.

The contact is the whole face of the punch at every load P, so that approach and pressure are linear
in P: they are those of `normal` for unit load and radius, scaled. With adhesion, load and approach
may be negative, down to the *pull-off*, where the energy release rate at the edge reaches the work
of adhesion w. With a layer of compliance alpha the pressure at the edge is ``-sqrt(2 w / alpha)``
then, and on a smooth surface ``P = -4 a**(3/2) sqrt(2 pi w)`` (docs/theory, adhesion; Kendall,
1971).
"""

from __future__ import annotations

from math import inf, pi, sqrt

from spectral_contact.contact.normal import NormalContact, solve_normal
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement, SpaceSolution
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields.series import PressureField


class PinnedContact:
    """The contact of a flat punch, solved for unit load and scaled to any other.

    Parameters
    ----------
    radius : float
        Radius of the punch.
    compliance : float
        alpha, in the unit of length of the radius.
    adhesion : float
        Work of adhesion, 0 without.
    tolerance : float
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted. With adhesion it is solved for in any case, as the pull-off
        needs it at the edge.
    """

    def __init__(
        self,
        radius: float,
        compliance: float,
        adhesion: float,
        tolerance: float,
        max_unknowns: int,
        *,
        pointwise: bool,
    ) -> None:
        self.radius = radius
        self._pointwise = pointwise
        goal = "pressure" if pointwise or adhesion else "approach"
        self._solved = solve_normal(compliance / radius, tolerance, max_unknowns, goal=goal)
        normal = self._normal
        #: approach over load
        self._flexibility = normal.approach / radius
        #: the most negative load (minus infinity without adhesion), and its relative error
        self.pull_off_load = -inf
        self.pull_off_error = 0.0
        if adhesion and compliance:
            edge_suction = sqrt(2.0 * adhesion / compliance)
            self.pull_off_load = -(radius**2) * edge_suction / normal.pressure.value(0.0)
            self.pull_off_error = normal.pressure_error
        elif adhesion:
            self.pull_off_load = -4.0 * radius * sqrt(2.0 * pi * radius * adhesion)
            self.pull_off_error = ROUNDING

    @property
    def _normal(self) -> NormalContact:
        """The contact for unit load on a punch of unit radius."""
        solved = self._solved
        return solved.best.value if isinstance(solved, Refinement) else solved

    @property
    def pull_off_approach(self) -> float:
        """The most negative approach."""
        return self.pull_off_load * self._flexibility

    def load_of(self, approach: float) -> float:
        """Return the load at an approach."""
        return approach / self._flexibility

    def under(
        self, load: float, approach: float | None = None
    ) -> Indentation | Refinement[Indentation]:
        """Return the contact under a load.

        If the approach is given as well, `load` has to be its `load_of`. Then the approach counts
        as exact, and what is wrong with the ratio of the two is an error of the load.
        """
        normal = self._normal
        a = self.radius
        error = normal.approach_error
        field = normal.pressure
        factor = load / a**2
        weight = None if field.weight is None else field.weight.times(factor)
        series = None if field.series is None else field.series.times(factor)
        contact = Indentation(
            a,
            load * self._flexibility if approach is None else approach,
            load,
            load**2 * self._flexibility / 2.0,
            1.0 / self._flexibility,
            inf,  # growth: the radius stays whatever the approach is
            PressureField(weight, series) if self._pointwise else None,
            None,
            approach_error=error if approach is None else 0.0,
            load_error=0.0 if approach is None else error + ROUNDING,
            work_error=error + ROUNDING,
            stiffness_error=error + ROUNDING,
            pressure_error=normal.pressure_error + (0.0 if approach is None else error),
        )
        solved = self._solved
        if not isinstance(solved, Refinement):
            return contact
        best = solved.best
        scaled = SpaceSolution(contact, best.error, best.indicators, best.unknowns)
        return Refinement(scaled, solved.space, solved.ending, solved.history)
