"""A solution in SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.equations.interior import Inside, Material
from spectral_contact.equations.interior.grids import Units, si_units
from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields.evaluation import over_r
from spectral_contact.io import checks, choices
from spectral_contact.quantities import OUTPUTS
from spectral_contact.records import Zone
from spectral_contact.solution import Solution
from spectral_contact.view.html import table_html
from spectral_contact.view.report import si_cells, table

_FACTORS: Final = {one.name: one.si_factor for one in OUTPUTS}


@dataclass(frozen=True, slots=True, repr=False)
class PhysicalSolution(choices.Suggesting):
    """A solution in SI units; radii in m, pressures in Pa, displacements in m, forces in N.

    Printed, it is the table of its scalars with the estimates of their relative errors.
    """

    solution: Solution

    def __post_init__(self) -> None:
        if choices.instance("solution", self.solution, Solution).scene.physical is None:
            raise NotComputedError("physical", "the scene was not made by Scene.from_physical")

    def __str__(self) -> str:
        return table(si_cells(self.solution))

    def __repr__(self) -> str:
        rows = si_cells(self.solution)[1:]
        return f"<PhysicalSolution {', '.join(f'{label}: {value}' for label, value, _ in rows)}>"

    def _repr_html_(self) -> str:
        return table_html(si_cells(self.solution))

    @property
    def _nu(self) -> float | None:
        return self.solution.scene.poisson_ratio

    @property
    def _data(self) -> Any:
        return self.solution.scene.physical

    @property
    def _shaped(self) -> bool:
        return self.solution.scene.profile is not None

    def _factor(self, kind: str) -> float:
        """Return what a dimensionless quantity is multiplied by to be in SI units.

        The kind is the `si_factor` of the quantity in `OUTPUTS`.
        """
        return float(self._data.si_factor(kind, self._nu, self.solution))

    def _in_si(self, name: str) -> Any:
        value = getattr(self.solution, name)
        return None if value is None else value * self._factor(_FACTORS[name])

    @property
    def load(self) -> float:
        """Normal load P [N]."""
        ratio = self.solution.scene.unloaded_to
        if self._data.load is not None:
            return ratio * float(self._data.load)
        return float(self._in_si("load")) if self._shaped else ratio * self._factor("force")

    @property
    def approach(self) -> float:
        """Approach [m]."""
        if self._data.approach is not None:
            return self.solution.scene.unloaded_to * float(self._data.approach)
        return float(self._in_si("approach"))

    @property
    def units(self) -> Units:
        """Return the SI units of lengths, stresses and displacements of the fields of `Inside`.

        Its lengths are over the radius; under a profile its displacements are, too.
        """
        displacement = self._factor("radius" if self._shaped else "displacement")
        return si_units(self.radius, self._factor("stress"), displacement)

    @property
    def radius(self) -> float:
        """Radius at ``s = 1`` [m], that of the contact; under a flat punch it is the punch's.

        For a layer law without an edge it is `Solution.domain_radius`.
        """
        return self._factor("radius")

    @property
    def contact_radius(self) -> float:
        """Radius of the contact a [m]."""
        given = self._data.radius or self._data.contact_radius
        return float(self.solution.contact_radius if given is None else given)

    @property
    def stiffness(self) -> float:
        """Contact stiffness dP/dδ under a profile [N/m]."""
        return float(self._in_si("stiffness"))

    @property
    def reverse_ratio(self) -> float:
        """Load over the largest load at which slip back begins."""
        return self.solution.reverse_ratio

    @property
    def turning_ratio(self) -> float:
        """Load over the largest load below which the state depends on the loads in between."""
        return self.solution.turning_ratio

    @property
    def stiffness_on_branch(self) -> float:
        """With adhesion dP/dδ along the curve of states [N/m]."""
        return float(self._in_si("stiffness_on_branch"))

    @property
    def indentation_work(self) -> float:
        """Work ∫P dδ of pressing a profile in [J]."""
        return float(self._in_si("indentation_work"))

    @property
    def stick_radius(self) -> float | None:
        """Outer radius of the central stick zone [m]; None without friction."""
        value: float | None = self._in_si("stick_radius")
        return value

    @property
    def total_shear(self) -> float:
        """Total shear Q = 2π∫q r dr [N], no resultant force, as the traction is radial."""
        return float(self._in_si("total_shear"))

    @property
    def opening(self) -> float | None:
        """Distance from the edge within which the contact would open [m]; None if it would not."""
        value = self.solution.opening
        return None if value is None else value * self.radius

    @property
    def edge_ratio(self) -> float:
        """Ratio q/p of full stick at the edge, dimensionless."""
        return self.solution.edge_ratio

    @property
    def critical_friction(self) -> float:
        """Smallest friction coefficient without slip, dimensionless."""
        return self.solution.critical_friction

    @property
    def shakedown_ratio(self) -> float:
        """Lowest load over the largest one down to which cycles stop slipping, dimensionless."""
        return self.solution.shakedown_ratio

    @property
    def zones(self) -> tuple[Zone, ...]:
        """Stick and slip zones, radii in m."""
        a = self.radius
        return tuple(
            replace(
                zone,
                inner=zone.inner * a,
                outer=zone.outer * a,
                inner_from_edge=zone.inner_from_edge * a,
                outer_from_edge=zone.outer_from_edge * a,
            )
            for zone in self.solution.zones
        )

    def _scaled(self, name: str, r: ArrayLike | None, from_edge: ArrayLike | None) -> Any:
        checks.exactly_one("r", r, "from_edge", from_edge)
        evaluate = getattr(self.solution, name)
        factor = self._factor(_FACTORS[name])
        a = self.radius
        if from_edge is None:
            given = checks.lengths("r", r, a, "m")
            # next to the edge a - r is exact, and 1 - r/a is not
            outer = given > a / 2.0
            values = np.empty(given.shape)
            values[outer] = evaluate(from_edge=(a - given[outer]) / a)
            values[~outer] = evaluate(given[~outer] / a)
            return (values * factor)[()]
        return evaluate(from_edge=checks.lengths("from_edge", from_edge, a, "m") / a) * factor

    @property
    def inside(self) -> Inside:
        """Stress [Pa] and displacement [m] anywhere in the half-space; points in m.

        Raises
        ------
        SceneError
            If the reduced modulus alone is known, which does not tell the bodies apart.
        """
        return Inside(self.solution, self.units, self._half_space, self._punch)

    @property
    def punch_inside(self) -> Inside:
        """The same in an elastic punch, with depths below its surface, which bears p and −q.

        Raises
        ------
        NotComputedError
            If the punch is rigid.
        SceneError
            If the reduced modulus alone is known.
        """
        half_space, punch = self._half_space, self._punch
        if punch is None:
            raise NotComputedError("punch_inside", "the punch is rigid")
        return Inside(self.solution, self.units, punch, half_space)

    @property
    def _half_space(self) -> Material:
        """Poisson's ratio of the half-space, and its share in the compliance of both bodies."""
        nu = self._nu
        if nu is None:
            told = "given: stress inside takes E and ν of either body, not their reduced modulus"
            raise SceneError("poisson_ratio", None, told)
        return Material(nu, self._data.compliance_share(nu))

    @property
    def _punch(self) -> Material | None:
        """An elastic punch; None if it is rigid."""
        if self._data.punch_youngs_modulus is None:
            return None
        share = self._data.compliance_share(self._nu, punch=True)
        return Material(self._data.punch_poisson_ratio, share, -1.0)

    @over_r
    def pressure(self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate the pressure [Pa] at radii `r` [m], or at distances `from_edge` [m]."""
        return self._scaled("pressure", r, from_edge)

    @over_r
    def traction(self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate the traction [Pa] at radii `r` [m], or at distances `from_edge` [m]."""
        return self._scaled("traction", r, from_edge)

    @over_r
    def slip(self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Any:
        """Evaluate the slip u_r [m] at radii `r` [m], or at distances `from_edge` [m]."""
        return self._scaled("slip", r, from_edge)
