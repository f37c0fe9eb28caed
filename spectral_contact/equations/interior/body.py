"""Stress and displacement of the body below the contact: what `Solution.inside` returns."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.equations.interior import places
from spectral_contact.equations.interior.energies import energies
from spectral_contact.equations.interior.extremes import MEASURES, largest
from spectral_contact.equations.interior.grids import (
    SUFFIXES,
    UnitNames,
    Units,
    as_csv,
    as_npz,
    checked_lengths,
    columns,
    dataset,
    own_units,
    scaled_lengths,
)
from spectral_contact.equations.interior.integrals import Integrals
from spectral_contact.equations.interior.mesh import AXIS, TIGHT, BodyPoints, Evaluator
from spectral_contact.equations.interior.results import (
    Displacement,
    Energies,
    Extreme,
    Stress,
    Surface,
)
from spectral_contact.equations.interior.sampling import (
    Sampler,
    displacement_error,
    stress_error,
    stresses,
)
from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields import Array
from spectral_contact.fields.series import Radius
from spectral_contact.io import checks, choices
from spectral_contact.io.documents import (
    checked_path,
    netcdf,
    path_text,
    replace_file,
    reported,
)
from spectral_contact.layers.scene_layer import refuse_layer
from spectral_contact.solution import Solution
from spectral_contact.threads import cached_property
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    import xarray

#: Number of radii at which the largest traction is looked for (chosen).
_TRACTION_RADII = 513
#: A point that is closer than this to the edge, or to the surface, counts as being there: fourth
#: powers of smaller distances underflow.
_LEAST_DISTANCE = 1e-60
#: The most points of one call, which takes some 1 kB of memory for each.
_MOST_POINTS = 10**8


@dataclass(frozen=True, slots=True)
class Material:
    """One of two bodies in contact.

    Attributes
    ----------
    poisson_ratio : float
        ν of the body.
    share : float
        E'/E'ᵢ, the displacement of this body over the sum of those of both.
    sense : float
        1 for the half-space, −1 for the punch, on which the traction acts the other way.
    """

    poisson_ratio: float
    share: float = 1.0
    sense: float = 1.0


class Inside:
    """Stress and displacement anywhere in the half-space; made by `Solution.inside`.

    Points are given by their distance from the axis, or from the edge, and their depth. Everything
    is in the units of the solution: `Solution.inside` is dimensionless, and
    `PhysicalSolution.inside` in SI units, as `PhysicalSolution.punch_inside` of an elastic punch,
    whose depth is counted into the punch. Under a profile places are in contact radii, as those of
    the pressure, displacements in the unit of length L of the profile and stresses in the modulus
    E' (docs/profiles).

    The fields are the response of an elastic half-space to the pressure and the traction of the
    solution. The model without coupling neglects the normal displacement by the traction; the
    displacement `z` of the body includes it.

    Parameters
    ----------
    solution : Solution
    units : Units, optional
    material : Material, optional
        Of the body; by default the half-space under a rigid punch.
    other : Material, optional
        Of the other body, if that is elastic.

    Raises
    ------
    SceneError
        If one of them is something else, or the scene does not have Poisson's ratio of the body.
    NotComputedError
        If the pressure or the traction was not asked for; under a profile also if the contact
        radius or the load was not.
    """

    def __init__(
        self,
        solution: Solution,
        units: Units | None = None,
        material: Material | None = None,
        other: Material | None = None,
    ) -> None:
        self._solution = choices.instance("solution", solution, Solution)
        refuse_layer(solution.scene, "inside")
        own = own_units(solution)
        self._units = own if units is None else choices.instance("units", units, Units)
        own_material = _only_body(solution) if material is None else material
        self._material = choices.instance("material", own_material, Material)
        self._other = other if other is None else choices.instance("other", other, Material)
        self._nu = self._material.poisson_ratio
        pressure = solution.pressure_field
        traction = solution.traction_field
        solution.pressure(0.5)  # refuses what was not computed
        solution.traction(0.5)
        self._sheared = traction is not None
        loads: list[Evaluator] = [
            _nothing if field is None else places.finite(field) for field in (pressure, traction)
        ]
        if self._sheared and self._material.sense < 0.0:
            loads[1] = _opposite(loads[1])
        #: the edge, tips and corners at which the stress is infinite or depends on the direction
        self._singular: list[Radius] = places.singular(solution)
        self._sampler = Sampler(
            places.grading(solution),
            loads[0],
            loads[1],
            self._floors(),
            sheared=self._sheared,
            nu=self._nu,
        )

    def _floors(self) -> tuple[float, float]:
        """Return the least absolute values of pressure and traction that errors are relative to.

        The errors of the loads of a flat punch are relative to the local values: these are 0. Under
        a profile the loads vanish at some places, and their errors there are relative to the mean
        pressure and to the largest traction.
        """
        solution = self._solution
        if solution.scene.profile is None:
            return 0.0, 0.0
        s = np.linspace(0.0, 1.0, _TRACTION_RADII)
        load = solution.error_scales.get("load", abs(solution.load))
        mean = load / (np.pi * solution.contact_radius**2)
        return mean, float(np.abs(solution.traction(s)).max())

    def _points(
        self, r: ArrayLike | None, z: ArrayLike, from_edge: ArrayLike | None
    ) -> tuple[BodyPoints, tuple[int, ...]]:
        depth = scaled_lengths("z", z, self._units)
        checks.exactly_one("r", r, "from_edge", from_edge)
        if from_edge is None:
            given = checked_lengths("r", r, self._units)
            length = self._units.length
            radius = np.asarray(given / length)
            # next to the edge this difference has no rounding; 1 minus the quotient would have it
            distance = np.asarray((length - given) / length)
        else:
            distance = scaled_lengths("from_edge", from_edge, self._units, high=1.0)
            radius = 1.0 - distance
        name = "r, z" if from_edge is None else "from_edge, z"
        try:
            shape = np.broadcast_shapes(radius.shape, depth.shape)
        except ValueError:
            shapes = f"{np.shape(radius)} and {np.shape(depth)}"
            raise SceneError(name, shapes, "of shapes that broadcast") from None
        count = math.prod(shape)
        if count > _MOST_POINTS:
            raise SceneError(f"number of points {name}", count, f"at most {_MOST_POINTS}")
        radius, distance, depth = np.broadcast_arrays(radius, distance, depth)
        radius, distance, depth = (np.ravel(one) for one in (radius, distance, depth))
        distance, depth = (np.where(np.abs(x) < _LEAST_DISTANCE, 0.0, x) for x in (distance, depth))
        return BodyPoints(np.maximum(radius, AXIS), distance, depth), shape

    def displacement(
        self,
        r: ArrayLike | None = None,
        z: ArrayLike = 0.0,
        *,
        from_edge: ArrayLike | None = None,
        rtol: float | None = None,
    ) -> Displacement:
        """Evaluate the displacement of points of the body.

        Parameters
        ----------
        r : array_like, optional
            Distances from the axis, at least 0.
        z : array_like
            Depths, at least 0; their shape broadcasts with that of `r` or `from_edge`. On the
            surface the values are the limits from the body.
        from_edge : array_like, optional
            Instead of `r`: distances from the edge, ``1 - r`` if dimensionless; negative outside
            the contact.
        rtol : float, optional
            Relative error that the integration may have, in [1e-13, 1e-2]; if not given, it is
            computed to all digits. With 1e-12 or more, a grid of many points is much faster. The
            estimates say what was reached: they contain the errors of the solution, too.

        Returns
        -------
        Displacement
            Of the shape to which the points broadcast; dimensionless it is
            ``u a E / (4 (1 - nu**2) P)``, as the approach is.

        Raises
        ------
        SceneError
            For both or neither of `r` and `from_edge`, a point above the surface or at no finite
            place, shapes that do not broadcast, or more than 1e8 points.
        """
        points, shape = self._points(r, z, from_edge)
        sums = self._sampler.displacement(points, _tolerance(rtol))
        radius = np.where(points.r > AXIS, points.r, 0.0)
        error = displacement_error(sums.values, self._errors(sums), radius)
        error = error + (self._solution.error.contact_radius or 0.0)
        # the integrals are 2 G u_z and 2 G u_r / r, with G = 2 (1 - nu) in the units of the paper
        unit = self._units.displacement * self._material.share / (4.0 * (1.0 - self._nu))
        outward = sums.values[1] * radius * unit + 0.0  # not -0.0 on the axis
        downward = sums.values[0] * unit
        return Displacement(*_shaped(shape, outward, downward, error))

    def stress(
        self,
        r: ArrayLike | None = None,
        z: ArrayLike = 0.0,
        *,
        from_edge: ArrayLike | None = None,
        rtol: float | None = None,
    ) -> Stress:
        """Evaluate the stress at points of the body, tension positive.

        On the surface it is the limit from the body: inside the contact ``zz = -p`` and
        ``rz = -q``, outside both vanish.

        Parameters
        ----------
        r, z, from_edge : array_like
            The points, as for `displacement`.
        rtol : float, optional
            As for `displacement`.

        Returns
        -------
        Stress
            Of the shape to which the points broadcast; dimensionless it is ``a**2 sigma / P``.

        Raises
        ------
        SceneError
            As `displacement`, and for a point (closer than 1e-16 of the radius) at the edge of a
            flat punch, or at a tip or corner on a smooth surface, where the stress is infinite or
            depends on the direction.
        """
        points, shape = self._points(r, z, from_edge)
        if np.any(places.within(points, self._singular)):
            raise SceneError(
                "r, z" if from_edge is None else "from_edge, z",
                (r if from_edge is None else from_edge, z),
                "at least 1e-16 of the radius away from the edge of a flat punch, and from where "
                "pressure is infinite: stresses have no limit there",
            )
        sums = self._sampler.stress(points, _tolerance(rtol))
        four = stresses(sums.values, self._nu)
        four[3] = np.where(points.r > AXIS, four[3], 0.0)  # no shear on the axis
        error = stress_error(sums.values, self._errors(sums), self._nu)
        error = error + places.error_near_boundaries(points, self._solution)
        if self._units.names.si_length and from_edge is None:
            error = error + self._error_by_radius(points)
        return Stress(*_shaped(shape, *(four * self._units.stress), error))

    def _error_by_radius(self, points: BodyPoints) -> Array:
        """Return the relative error of stress at places in metres by that of the contact radius.

        An error of the contact radius is one of the distance of a place from the edge, towards
        which stress grows like the power -1/2 of the distance at most.
        """
        radius_error = self._solution.error.contact_radius or 0.0
        if not radius_error:
            return np.zeros(len(points.r))
        ratio = np.hypot(points.r, points.z) / np.maximum(points.to_edge, radius_error)
        return np.asarray(np.minimum(radius_error * ratio, 1.0))

    def surface(
        self,
        r: ArrayLike | None = None,
        *,
        from_edge: ArrayLike | None = None,
        rtol: float | None = None,
    ) -> Surface:
        """Evaluate the displacement of the surface, and its gap to the plane of the punch's face.

        Between two elastic bodies the gap is that between their surfaces.

        Parameters
        ----------
        r, from_edge : array_like
            Radii inside or outside the contact, as for `displacement`.
        rtol : float, optional
            As for `displacement`.

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
        displacement = self.displacement(r, 0.0, from_edge=from_edge, rtol=rtol)
        gap = self._approach - displacement.z
        if self._other is not None:
            other_body = Inside(self._solution, self._units, self._other)
            gap = gap - other_body.displacement(r, 0.0, from_edge=from_edge, rtol=rtol).z
        profile = self._solution.scene.profile
        if profile is not None:
            points, shape = self._points(r, 0.0, from_edge)
            radius = points.r.reshape(shape) * self._solution.contact_radius
            # So far `gap` is the height of the body's surface above the face. Less the height of
            # the profile it is the compression of the layer inside, and minus the gap outside.
            outside = points.from_edge.reshape(shape) < 0.0
            under_profile = radius <= profile.reach
            height = profile.height(np.where(under_profile, radius, 0.0))
            gap = np.where(outside, height - gap, gap - height)
            gap = np.where(under_profile, gap, np.nan)[()]
        return Surface(displacement.r, displacement.z, gap, displacement.error)

    @property
    def _approach(self) -> float:
        """Approach in the units of the displacements."""
        return self._solution.approach * (self._units.displacement if self.flat else 1.0)

    @property
    def radius(self) -> float:
        """Radius of the contact in the units of the points."""
        return self._units.length

    @property
    def flat(self) -> bool:
        """Whether the punch is flat."""
        return self._solution.scene.profile is None

    @property
    def unit_names(self) -> UnitNames:
        """Units of points, displacements and stresses."""
        return self._units.names

    def is_singular(self, r: ArrayLike, z: ArrayLike = 0.0) -> NDArray[np.bool_]:
        """Return at which points there is no limit of the stress, so that `stress` refuses them.

        Parameters and errors are those of `displacement`.
        """
        points, shape = self._points(r, z, None)
        return places.within(points, self._singular).reshape(shape)

    def to_table(
        self, r: ArrayLike, z: ArrayLike, *, rtol: float | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Evaluate everything at points, such as the nodes of a mesh.

        Parameters
        ----------
        r, z, rtol
            As for `stress`; where it refuses, stresses are NaN.

        Returns
        -------
        dict of ndarray
            `r`, `z`, displacements, stresses, their invariants and the estimates, by name.

        Raises
        ------
        SceneError
            As `displacement`.
        """
        r, z = (checked_lengths(name, x, self._units) for name, x in (("r", r), ("z", z)))
        self._points(r, z, None)
        radius, depth = np.broadcast_arrays(r, z)
        return {"r": radius, "z": depth} | columns(self, radius, depth, rtol)

    def to_xarray(self, r: ArrayLike, z: ArrayLike, *, rtol: float | None = None) -> xarray.Dataset:
        """Evaluate everything on a grid.

        Parameters
        ----------
        r, z : array_like, one-dimensional
            Radii and depths of the grid.
        rtol : float, optional
            As for `stress`; where it refuses, stresses are NaN.

        Returns
        -------
        xarray.Dataset
            With dimensions `z` and `r`.

        Raises
        ------
        SceneError
            As `displacement`.
        MissingDependencyError
            If xarray is not installed.
        """
        radii = np.ravel(checked_lengths("r", r, self._units))
        depths = np.ravel(checked_lengths("z", z, self._units))
        self._points(radii, depths[:, None], None)
        return dataset(self, radii, depths, rtol)

    def save(
        self,
        path: str | os.PathLike[str],
        r: ArrayLike,
        z: ArrayLike,
        *,
        rtol: float | None = None,
    ) -> None:
        """Store everything at points, or on a grid.

        Parameters
        ----------
        path : path-like
            ``.csv`` and ``.npz`` hold what `to_table` returns, ``.nc`` what `to_xarray` returns.
        r, z, rtol
            As of these two.

        Raises
        ------
        SceneError
            As `displacement`.
        SolutionFileError
            For another suffix, or a path that cannot be written.
        MissingDependencyError
            If xarray is not installed, for a ``.nc`` file.
        """
        source = checked_path(path_text(path), SUFFIXES)
        suffix = source.lower().rpartition(".")[2]
        if suffix == "nc":
            content = netcdf(self.to_xarray(r, z, rtol=rtol))
        else:
            table = self.to_table(r, z, rtol=rtol)
            content = as_npz(table) if suffix == "npz" else as_csv(table, self.unit_names)
        with reported(source, "cannot be written"):
            replace_file(source, content)

    def largest(self, measure: str) -> Extreme:
        """Return the largest von Mises stress, shear stress or tension of the surface, and where.

        Where it has no bound, or is approached at the edge and not attained, the result says so.

        Parameters
        ----------
        measure : str
            ``"von_mises"``, ``"max_shear"``, or ``"surface_tension"``, which is the largest
            principal stress at the surface, in the contact and outside.

        Returns
        -------
        Extreme

        Raises
        ------
        SceneError
            For another measure.
        """
        choices.one_of("measure", measure, MEASURES)
        body = self._unscaled
        extreme = largest(
            measure,
            self._solution,
            self._nu,
            lambda points, rtol: body.stress(from_edge=points.from_edge, z=points.z, rtol=rtol),
        )
        value = None if extreme.value is None else extreme.value * self._units.stress
        length = self._units.length
        return replace(extreme, value=value, r=extreme.r * length, z=extreme.z * length)

    def energies(self, *, progress: bool | None = None) -> Energies:
        """Return the balance of energy: work of the load, elastic energy, friction and a defect.

        Takes some seconds.

        Parameters
        ----------
        progress : bool, optional
            Whether to show progress (extra: progress); by default on a terminal and in notebooks.

        Returns
        -------
        Energies

        Raises
        ------
        NotComputedError
            If the approach or the slip was not asked for. With friction under a profile, as the
            energy that it dissipates depends on how the contact grew. Below the largest load after
            slip. For one of two elastic bodies.
        """
        if self._solution.scene.mismatch is not None:
            raise NotComputedError("energies", "the load does work on both bodies together")
        body = self._unscaled
        units = self._units
        if self.flat:
            unit = units.stress * units.length**2 * units.displacement
        else:  # `energies` takes those over the square of the contact radius, in E' and L
            unit = units.stress * self._solution.contact_radius**2
        with ProgressLine(progress) as tell:
            return energies(
                self._solution,
                self._sampler.mesh(TIGHT[1:]),
                lambda points: body.displacement(from_edge=points.from_edge),
                unit,
                tell,
            )

    @cached_property
    def _unscaled(self) -> Inside:
        """The same body in the units of the solution."""
        same = self._units == own_units(self._solution)
        return self if same else Inside(self._solution, None, self._material)

    def _errors(self, sums: Integrals) -> Array:
        """Return absolute errors of the integrals."""
        error = self._solution.error
        pressure_error = error.pressure or 0.0
        traction_error = (error.traction or 0.0) + (error.zones or 0.0)
        if self._solution.scene.couples:  # both estimates are relative to the two fields together
            pressure_error = max(pressure_error, traction_error)
            traction_error = pressure_error
        loads = pressure_error * sums.of_pressure + traction_error * sums.of_traction
        # Twice: the errors of the loads jump between panels, and the quadrature, which does not
        # resolve them, may be wrong by as much again.
        return np.asarray(2.0 * loads + sums.quadrature)


def _only_body(solution: Solution) -> Material:
    """Return the half-space under a rigid punch."""
    scene = solution.scene
    if scene.poisson_ratio is None or scene.mismatch is not None:
        allowed = (
            "given, of a half-space under a rigid punch: of two elastic bodies with SI data "
            "solution.physical.inside and solution.physical.punch_inside have the stress"
        )
        raise SceneError("poisson_ratio", scene.poisson_ratio, allowed)
    return Material(scene.poisson_ratio)


def _opposite(load: Evaluator) -> Evaluator:
    """Return a load with the opposite sign."""
    return lambda s, from_edge: -load(s, from_edge)


def _nothing(s: Array, from_edge: Array) -> Array:
    """Evaluate no load."""
    return np.zeros(np.shape(s))


def _tolerance(rtol: float | None) -> float:
    """Return the tolerance of the integration, 0 for all digits."""
    return 0.0 if rtol is None else checks.tolerance(rtol)


def _shaped(shape: tuple[int, ...], *values: Array) -> Iterator[Any]:
    """Return arrays in a shape, numbers if it is empty."""
    return (value.reshape(shape)[()] for value in values)
