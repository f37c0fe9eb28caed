"""What `Solution.inside` is: stress and displacement of the body below the contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.errors import SceneError
from spectral_contact.fields.series import CENTRE, EDGE, Radius, ZonalField
from spectral_contact.inputs import checks, choices
from spectral_contact.interior import rings
from spectral_contact.interior.integrals import Integrals, integrate
from spectral_contact.interior.mesh import Evaluator, Mesh, Points, graded
from spectral_contact.interior.results import Displacement, Stress, Surface
from spectral_contact.solution import Solution

__all__ = ["Inside", "Units"]

Array = NDArray[np.float64]

#: Nodes of a panel: of the rule that is used, and of the one that it is compared with.
_ORDERS = 16, 12
#: E-folds of the panels towards the edge, where the loads are bounded and where they are not.
_BOUNDED_FOLDS, _SINGULAR_FOLDS = 60, 115
#: How close to the edge stresses are given: closer, the panels do not reach.
_CLOSEST = 1e-16
#: What stands for the axis, where ``u_r / r`` is the limit.
_AXIS = 1e-30


@dataclass(frozen=True, slots=True)
class Units:
    """What a length, a stress and a displacement are multiplied by; 1 for dimensionless ones."""

    length: float = 1.0
    stress: float = 1.0
    displacement: float = 1.0


class Inside:
    """Stress and displacement anywhere in the half-space: what `Solution.inside` is.

    Points are given by their distance from the axis, or from the edge, and their depth. Everything
    is in the units of the solution: `Solution.inside` is dimensionless as the paper is, and
    `PhysicalSolution.inside` in SI units.

    The loads are the pressure and the traction of the solution, and what is shown is the
    response of an elastic half-space to both. In a scene without coupling the model leaves
    out that the traction moves the surface normally; the body's own displacement `z` has it.

    Parameters
    ----------
    solution : Solution
    units : Units, optional

    Raises
    ------
    SceneError
        If one of them is something else.
    NotComputedError
        If the pressure or the traction was not asked for.
    """

    def __init__(self, solution: Solution, units: Units | None = None) -> None:
        self._solution = choices.instance("solution", solution, Solution)
        self._units = Units() if units is None else choices.instance("units", units, Units)
        self._nu = solution.scene.poisson_ratio
        pressure, traction = solution.pressure_field, solution.traction_field
        solution.pressure(0.5)  # refuses what was not computed
        solution.traction(0.5)
        self._sheared = traction is not None
        loads: list[Evaluator] = [
            _nothing if field is None else field for field in (pressure, traction)
        ]
        ends = graded(_boundaries(pressure, traction), self._folds())
        self._loads = loads[0], loads[1]
        self._meshes = Mesh(ends, *self._loads, _ORDERS[0]), Mesh(ends, *self._loads, _ORDERS[1])

    def _folds(self) -> int:
        scene = self._solution.scene
        smooth = scene.normal_compliance == 0.0
        smooth |= self._sheared and scene.tangential_compliance == 0.0
        return _SINGULAR_FOLDS if smooth else _BOUNDED_FOLDS

    def _points(
        self, r: ArrayLike | None, z: ArrayLike, from_edge: ArrayLike | None
    ) -> tuple[Points, tuple[int, ...]]:
        length = self._units.length
        depth = _length("z", z, length)
        checks.exactly_one("r", r, "from_edge", from_edge)
        if from_edge is None:
            radius = _length("r", r, length)
            distance = 1.0 - radius
        else:
            distance = _length("from_edge", from_edge, length, high=1.0)
            radius = 1.0 - distance
        try:
            radius, distance, depth = np.broadcast_arrays(radius, distance, depth)
        except ValueError:
            shapes = f"{np.shape(radius)} and {np.shape(depth)}"
            name = "r, z" if from_edge is None else "from_edge, z"
            raise SceneError(name, shapes, "of shapes that broadcast") from None
        shape = radius.shape
        radius, distance, depth = (np.ravel(one) for one in (radius, distance, depth))
        return Points(np.maximum(radius, _AXIS), distance, depth), shape

    def displacement(
        self,
        r: ArrayLike | None = None,
        z: ArrayLike = 0.0,
        *,
        from_edge: ArrayLike | None = None,
    ) -> Displacement:
        """Evaluate the displacement of points of the body.

        Parameters
        ----------
        r : array_like, optional
            Distances from the axis, at least 0.
        z : array_like
            Depths, at least 0; of a shape that broadcasts with that of the other. On the surface
            the values are the limits from the body.
        from_edge : array_like, optional
            Instead of `r`: distances from the edge, ``1 - r`` if dimensionless; negative outside
            the contact.

        Returns
        -------
        Displacement
            Of the shape to which the points broadcast; dimensionless it is
            ``u a E / (4 (1 - nu**2) P)``, as the approach is.

        Raises
        ------
        SceneError
            For both or neither of `r` and `from_edge`, a point above the surface or at no finite
            place, or shapes that do not broadcast.
        """
        points, shape = self._points(r, z, from_edge)
        kernels = rings.normal_displacement, rings.radial_displacement
        sums = integrate(self._meshes, points, _without(kernels, self._sheared), self._nu)
        scale = np.array([[1.0], [1.0]]) / (4.0 * (1.0 - self._nu))
        arm = np.where(points.r > _AXIS, points.r, 0.0)
        factors = np.stack([np.ones_like(arm), arm]) * scale
        down, out = sums.values[:2] * factors
        errors = self._errors(sums)[:2] * factors
        error = _relative(np.hypot(*errors), np.hypot(down, out))
        unit = self._units.displacement
        return Displacement(*_shaped(shape, out * unit, down * unit, error))

    def stress(
        self,
        r: ArrayLike | None = None,
        z: ArrayLike = 0.0,
        *,
        from_edge: ArrayLike | None = None,
    ) -> Stress:
        """Evaluate the stress at points of the body, tension positive.

        On the surface it is the limit from the body: inside the contact ``zz = -p`` and
        ``rz = -q``, outside both vanish.

        Parameters
        ----------
        r, z, from_edge : array_like
            The points, as for `displacement`.

        Returns
        -------
        Stress
            Of the shape to which the points broadcast; dimensionless it is ``a**2 sigma / P``.

        Raises
        ------
        SceneError
            As `displacement`, and for a point at the edge itself (closer than 1e-16 of the
            radius), where the stress is infinite or depends on the direction.
        """
        points, shape = self._points(r, z, from_edge)
        if np.any(points.to_edge < _CLOSEST):
            raise SceneError(
                "r, z" if from_edge is None else "from_edge, z",
                (r if from_edge is None else from_edge, z),
                "at least 1e-16 of the radius away from the edge, where stresses have no limit",
            )
        kernels = rings.normal_stress, rings.radial_stress
        sums = integrate(self._meshes, points, _without(kernels, self._sheared), self._nu)
        self._to_surface(points, sums)
        zz, rz, hoop, harmonic = sums.values
        rz = np.where(points.r > _AXIS, rz, 0.0)
        tt = hoop - 2.0 * self._nu * harmonic
        # the divergence of u less its axial part is -2 (1 - nu) e - zz, over 2 G
        rr = -2.0 * harmonic - zz - hoop
        four = np.stack([rr, tt, zz, rz])
        norm = np.sqrt(rr**2 + tt**2 + zz**2 + 2.0 * rz**2)
        errors = self._errors(sums)
        worst = errors[0] + errors[2] + 2.0 * errors[3] + errors[1]
        error = _relative(worst, norm)
        return Stress(*_shaped(shape, *(four * self._units.stress), error))

    def surface(self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None) -> Surface:
        """Evaluate the displacement of the surface, and its gap to the plane of the punch's face.

        Parameters
        ----------
        r, from_edge : array_like
            Radii inside or outside the contact, as for `displacement`.

        Returns
        -------
        Surface

        Raises
        ------
        SceneError
            As `displacement`.
        NotComputedError
            If the approach was not asked for.
        """
        moved = self.displacement(r, 0.0, from_edge=from_edge)
        approach = self._solution.approach * self._units.displacement
        return Surface(moved.r, moved.z, approach - moved.z, moved.error)

    def _to_surface(self, points: Points, sums: Integrals) -> None:
        """Replace what is known exactly on the surface by the loads there."""
        on = points.on_surface
        if not on.any():
            return
        distance = points.from_edge[on]
        under = distance >= 0.0
        d = np.where(under, distance, 1.0)
        s = np.where(under & (points.r[on] > _AXIS), points.r[on], 0.0)
        pressure, traction = (np.where(under, load(s, d), 0.0) for load in self._loads)
        sums.values[0, on], sums.values[1, on] = -pressure, -traction
        sums.values[3, on] += pressure
        sums.of_pressure[0, on] += pressure
        sums.of_traction[1, on] += np.abs(traction)

    def _errors(self, sums: Integrals) -> Array:
        """Return absolute errors of the integrals."""
        error, couples = self._solution.error, self._solution.scene.couples
        of_pressure = error.pressure or 0.0
        of_traction = (error.traction or 0.0) + (error.zones or 0.0)
        if couples:  # then the estimates of both fields are relative to the two together
            of_pressure = of_traction = max(of_pressure, of_traction)
        loads = of_pressure * sums.of_pressure + of_traction * sums.of_traction
        return np.asarray(loads + sums.quadrature)


def _without(kernels: tuple[Any, Any], sheared: bool) -> tuple[Any, Any]:
    return kernels if sheared else (kernels[0], None)


def _nothing(s: Array, from_edge: Array) -> Array:
    return np.zeros(np.shape(s))


def _boundaries(*fields: object) -> list[Radius]:
    """Return the ends of all zones of the fields, with the centre and the edge."""
    inner = {
        piece.outer.value: piece.outer
        for field in fields
        if isinstance(field, ZonalField)
        for piece in field.pieces
        if piece.outer.from_edge > 0.0
    }
    return [CENTRE, *(inner[value] for value in sorted(inner)), EDGE]


def _length(name: str, values: Any, unit: float, high: float = np.inf) -> Array:
    """Return lengths over the radius of the punch; from below, only `from_edge` has no bound."""
    low = -np.inf if name == "from_edge" else 0.0
    allowed = "finite and at least 0" if low == 0.0 else f"finite and at most {high * unit:.17g}"
    given = np.asarray(checks.reals(name, values, allowed), dtype=np.float64)
    bad = ~(np.isfinite(given) & (given >= low) & (given <= high * unit))
    if bad.any():
        raise SceneError(name, given[bad].flat[0], allowed)
    return np.asarray(given / unit + 0.0)


def _relative(error: Array, size: Array) -> Array:
    return np.asarray(np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), 0.0))


def _shaped(shape: tuple[int, ...], *values: Array) -> Iterator[Any]:
    return (value.reshape(shape)[()] for value in values)
