r"""Normal contact under a flat punch of some radius, in the units of a scene with a profile.

The contact is the punch's face whatever the load is, so everything is linear in it: the solution
`normal` has for unit load and radius is scaled. With adhesion load and approach may be negative,
until the energy release rate at the edge is the work of adhesion w: with a layer until the pressure
there is ``-sqrt(2 w / alpha)``, and on a smooth surface until ``P = -4 a**(3/2) sqrt(2 pi w)``
(docs/theory, adhesion; Kendall, 1971).
"""

from __future__ import annotations

from math import inf, pi, sqrt

from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement, SpaceSolution
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields.series import PressureField


class PinnedContact:
    """The contact of a flat punch for unit load.

    Parameters
    ----------
    radius : float
        Of the punch.
    compliance : float
        ``alpha*`` in the unit of length of the radius.
    adhesion : float
        Work of adhesion, 0 without.
    tolerance : float
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted; with adhesion it is solved for in any case.
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
        self.radius, self._pointwise = radius, pointwise
        goal = "pressure" if pointwise or adhesion else "approach"
        self._solved = solve_normal(compliance / radius, tolerance, max_unknowns, goal=goal)
        normal = self._normal
        self._approach = normal.approach / radius
        #: the most negative load, and the relative error of it
        self.pull_off_load, self.pull_off_error = -inf, 0.0
        if adhesion and compliance:
            suction, edge = sqrt(2.0 * adhesion / compliance), normal.pressure.value(0.0)
            self.pull_off_load = -(radius**2) * suction / edge
            self.pull_off_error = normal.pressure_error
        elif adhesion:
            self.pull_off_load = -4.0 * radius * sqrt(2.0 * pi * radius * adhesion)
            self.pull_off_error = ROUNDING

    @property
    def _normal(self) -> NormalContact:
        solved = self._solved
        return solved.best.value if isinstance(solved, Refinement) else solved

    @property
    def pull_off_approach(self) -> float:
        """The most negative approach."""
        return self.pull_off_load * self._approach

    def load_of(self, approach: float) -> float:
        """Return the load of an approach."""
        return approach / self._approach

    def under(
        self, load: float, approach: float | None = None
    ) -> Indentation | Refinement[Indentation]:
        """Return the contact under a load, or under the load of an approach that is given."""
        normal, a = self._normal, self.radius
        error = normal.approach_error
        field = normal.pressure
        factor = load / a**2
        weight = None if field.weight is None else field.weight.times(factor)
        series = None if field.series is None else field.series.times(factor)
        one = Indentation(
            a,
            load * self._approach if approach is None else approach,
            load,
            load**2 * self._approach / 2.0,
            1.0 / self._approach,
            inf,
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
            return one
        best = solved.best
        own = SpaceSolution(one, best.error, best.indicators, best.unknowns)
        return Refinement(own, solved.resolution, solved.ending, solved.history)
