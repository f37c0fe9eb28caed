"""The integrals at points of the body, by the cheapest quadrature that meets a tolerance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spectral_contact.equations.interior import ring_loads
from spectral_contact.equations.interior.integrals import Integrals, integrate
from spectral_contact.equations.interior.mesh import (
    AXIS,
    FAST,
    MEDIUM,
    TIGHT,
    BodyMesh,
    BodyPoints,
    Evaluator,
    Grading,
    Rule,
)
from spectral_contact.equations.interior.patches import Relative, interpolate, narrow_intervals
from spectral_contact.fields import Array

#: For tolerances down to each of these the rules of quadrature, and the number of a polynomial's
#: nodes in either direction (chosen; results are checked against the tolerance). For smaller
#: tolerances there are no polynomials.
_RULES_BY_TOLERANCE = ((1e-9, FAST, 12), (1e-11, MEDIUM, 14), (1e-12, TIGHT, 16))
#: At one in so many nodes of a polynomial both rules are used and compared, elsewhere one (chosen).
_COMPARED_EVERY = 5


def stresses(values: Array, nu: float) -> Array:
    """Return rr, tt, zz and rz from the integrals."""
    zz, rz, hoop, harmonic = values
    # the trace is -2 (1 + nu) times the harmonic sum, e of docs/stress
    return np.stack([-2.0 * harmonic - zz - hoop, hoop - 2.0 * nu * harmonic, zz, rz])


def stress_error(values: Array, errors: Array, nu: float) -> Array:
    """Return the relative error of stresses from absolute ones of the integrals."""
    errors_of_stress = errors[0] + errors[2] + 2.0 * errors[3] + errors[1]
    rr, tt, zz, rz = stresses(values, nu)
    return _relative(errors_of_stress, np.sqrt(rr**2 + tt**2 + zz**2 + 2.0 * rz**2))


def displacement_error(values: Array, errors: Array, r: Array) -> Array:
    """Return the relative error of displacements from absolute ones of the integrals."""
    return _relative(np.hypot(errors[0], r * errors[1]), np.hypot(values[0], r * values[1]))


def _relative(error: Array, size: Array) -> Array:
    """Return errors over sizes, 0 where the size is 0."""
    return np.asarray(np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), 0.0))


class Sampler:
    """Integrals of the loads at points, by the rule that a tolerance asks for.

    Parameters
    ----------
    ends : Grading
        Of the panels over the contact.
    pressure, traction : callable
        The loads at radii and distances from the edge.
    floors : tuple of float
        Least absolute values of pressure and traction that their errors are relative to.
    sheared : bool
        Whether there is traction at all.
    nu : float
        Poisson's ratio.
    """

    def __init__(
        self,
        ends: Grading,
        pressure: Evaluator,
        traction: Evaluator,
        floors: tuple[float, float],
        *,
        sheared: bool,
        nu: float,
    ) -> None:
        self._ends = ends
        self._floors = floors
        self._loads = pressure, traction
        self._sheared = sheared
        self._nu = nu
        self._meshes: dict[tuple[Rule, ...], BodyMesh] = {}

    def mesh(self, rules: tuple[Rule, ...]) -> BodyMesh:
        """Return the panels with some rules, which are made once and kept."""
        if rules not in self._meshes:
            self._meshes[rules] = BodyMesh(self._ends, *self._loads, rules)
        return self._meshes[rules]

    def stress(self, points: BodyPoints, rtol: float) -> Integrals:
        """Return zz, rz, ``2 G u_r / r`` and the harmonic sum; on the surface their limits."""
        kernels = (ring_loads.normal_stress, ring_loads.radial_stress)[: 1 + self._sheared]

        def direct(mesh: BodyMesh, chosen: BodyPoints) -> Integrals:
            return self._limits(chosen, integrate(mesh, chosen, kernels, self._nu, self._floors))

        def measure(_points: BodyPoints, values: Array, errors: Array) -> Array:
            return stress_error(values, errors, self._nu)

        sums = self._sampled(points, rtol, direct, measure)
        on_surface = points.on_surface
        pressure, traction = self._surface_loads(points[on_surface])
        sums.values[0, on_surface] = -pressure
        sums.values[1, on_surface] = -traction
        return sums

    def displacement(self, points: BodyPoints, rtol: float) -> Integrals:
        """Return the integrals ``2 G u_z`` and ``2 G u_r / r``; the other two rows are empty."""
        kernels = (ring_loads.normal_displacement, ring_loads.radial_displacement)[
            : 1 + self._sheared
        ]

        def direct(mesh: BodyMesh, chosen: BodyPoints) -> Integrals:
            return integrate(mesh, chosen, kernels, self._nu, self._floors)

        def measure(chosen: BodyPoints, values: Array, errors: Array) -> Array:
            return displacement_error(values, errors, chosen.r)

        return self._sampled(points, rtol, direct, measure)

    def _sampled(
        self,
        points: BodyPoints,
        rtol: float,
        direct: Callable[[BodyMesh, BodyPoints], Integrals],
        measure: Relative,
    ) -> Integrals:
        """Return the integrals: by polynomials, by the rules of the tolerance, or by the finest.

        Each is used at the points at which the one before does not meet the tolerance.
        """
        allowed = [(rules, order) for least, rules, order in _RULES_BY_TOLERANCE if rtol >= least]
        if not allowed:
            return direct(self.mesh(TIGHT), points)
        rules, order = allowed[0]

        def at_nodes(nodes: BodyPoints) -> Integrals:
            compared = np.arange(len(nodes.r)) % _COMPARED_EVERY == 0
            sums = Integrals.empty(len(nodes.r))
            sums.put(compared, direct(self.mesh(rules), nodes[compared]))
            sums.put(~compared, direct(self.mesh(rules[:1]), nodes[~compared]))
            return sums

        sums = Integrals.empty(len(points.r))
        narrow = narrow_intervals(self._ends.places)
        remaining = interpolate(points, rtol, order, at_nodes, measure, sums, narrow)
        sums.put(remaining, direct(self.mesh(rules), points[remaining]))
        above_rtol = ~(measure(points, sums.values, sums.quadrature) <= rtol)
        if above_rtol.any() and rules is not TIGHT:
            sums.put(above_rtol, direct(self.mesh(TIGHT), points[above_rtol]))
        return sums

    def _limits(self, points: BodyPoints, sums: Integrals) -> Integrals:
        """Turn principal values on the surface into limits from the body.

        The limit of the harmonic sum is larger than the principal value by the local pressure. The
        values of zz and rz are minus the local loads (`stress` sets them), so the sums that errors
        of the loads multiply, `of_pressure` and `of_traction`, get the local loads as well.
        """
        on_surface = points.on_surface
        pressure, traction = self._surface_loads(points[on_surface])
        sums.values[3, on_surface] += pressure
        sums.of_pressure[0, on_surface] += np.maximum(np.abs(pressure), self._floors[0])
        sums.of_traction[1, on_surface] += np.maximum(np.abs(traction), self._floors[1])
        return sums

    def _surface_loads(self, points: BodyPoints) -> tuple[Array, Array]:
        """Return pressure and traction at points of the surface, 0 outside the contact."""
        inside = points.from_edge >= 0.0
        d = np.where(inside, points.from_edge, 1.0)
        s = np.where(inside & (points.r > AXIS), points.r, 0.0)
        pressure, traction = (np.where(inside, load(s, d), 0.0) for load in self._loads)
        return pressure, traction
