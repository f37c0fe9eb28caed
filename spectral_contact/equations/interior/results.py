"""Displacement and stress at points of the body, and the shape of its surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from spectral_contact.fields import Array


@dataclass(frozen=True, slots=True, eq=False)
class Displacement:
    """Displacement of points of the body, in the units of the solution that was asked.

    Attributes
    ----------
    r, z : float or ndarray
        Components outward, and into the body, of the shape of the points.
    error : float or ndarray
        Estimated error of each component, relative to the length of the displacement.
    """

    r: Any
    z: Any
    error: Any

    @property
    def modulus(self) -> Any:
        """Length of the displacement."""
        return np.hypot(self.r, self.z)


@dataclass(frozen=True, slots=True, eq=False)
class Stress:
    """Stress at points of the body, tension positive, in the units of the solution.

    Attributes
    ----------
    rr, tt, zz, rz : float or ndarray
        Radial, hoop and axial stress, and the shear stress of the axes outward and into the body,
        of the shape of the points.
    error : float or ndarray
        Estimated error of each, relative to `norm`.
    """

    rr: Any
    tt: Any
    zz: Any
    rz: Any
    error: Any

    @property
    def norm(self) -> Any:
        """Root of the sum of the squares of the nine components."""
        return np.sqrt(self.rr**2 + self.tt**2 + self.zz**2 + 2.0 * self.rz**2)

    @property
    def mean(self) -> Any:
        """A third of the trace; minus this is the hydrostatic pressure."""
        return (self.rr + self.tt + self.zz) / 3.0

    @property
    def von_mises(self) -> Any:
        """Equivalent stress of von Mises."""
        squares = (self.rr - self.tt) ** 2 + (self.tt - self.zz) ** 2 + (self.zz - self.rr) ** 2
        return np.sqrt(squares / 2.0 + 3.0 * self.rz**2)

    @property
    def principal(self) -> Array:
        """Principal stresses, largest first, as an array with the shape (3, ...)."""
        middle = (self.rr + self.zz) / 2.0
        radius = np.hypot((self.rr - self.zz) / 2.0, self.rz)
        three = np.stack(np.broadcast_arrays(middle + radius, middle - radius, self.tt))
        return np.asarray(-np.sort(-three, axis=0))

    @property
    def max_shear(self) -> Any:
        """Largest shear stress in any plane, half the range of the principal stresses."""
        three = self.principal
        return (three[0] - three[2]) / 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Shape of the deformed surface, in the units of the solution that was asked.

    Attributes
    ----------
    r, z : float or ndarray
        Displacement of the surface outward and into the body, of the shape of the radii.
    gap : float or ndarray
        Under a flat punch the approach minus `z`: how far the body's surface is above the plane of
        the punch's face. Inside the contact this is the compression of the layer. Under a profile
        it is that compression, too, the approach minus `z` minus the height of the profile; outside
        the contact it has the opposite sign, the distance to the profile, and is NaN beyond the end
        of the profile.
    error : float or ndarray
        Estimated error of `r` and `z`, relative to the length of the displacement.
    """

    r: Any
    z: Any
    gap: Any
    error: Any


@dataclass(frozen=True, slots=True)
class Energies:
    """Balance of the energies of a solution, in its units.

    A dimensionless energy of a flat punch is over ``4 (1 - nu**2) P**2 / (a E)``, the load times
    the unit of the approach; one under a profile over E' L**3, in the units of the scene.

    Attributes
    ----------
    external : float
        Work of the load; half of load times approach under a flat punch.
    strain : float
        Elastic energy of the body: half the work of pressure and traction on its displacements.
    layer : float
        Energy stored in the layer of roughness, normal and tangential.
    friction : float
        Energy dissipated by slip.
    defect : float
        Energy that the model without coupling loses because it neglects the normal displacement by
        the traction q: ``kappa / 2 int q g dA``, with kappa = (1 - 2 nu)/(4 (1 - nu)) and
        ``g = (1/s) int_0^s p eta deta`` of the pressure p (docs/theory). Zero with coupling.
    error : float
        Estimated error of each energy, relative to `external`; with adhesion relative to the sum of
        the magnitudes of strain, layer and surface.
    surface : float
        With adhesion under a profile that is not flat, the energy of the surfaces that are in
        contact, which is negative; else 0.
    """

    external: float
    strain: float
    layer: float
    friction: float
    defect: float
    error: float
    surface: float = 0.0

    @property
    def balance(self) -> float:
        """The rest of `external` after all the others; zero except for errors."""
        stored = self.strain + self.layer + self.surface
        return self.external - stored - self.friction - self.defect


@dataclass(frozen=True, slots=True)
class Extreme:
    """The largest value of a stress, and where it is.

    Attributes
    ----------
    value : float or None
        None where it has no bound.
    r, z : float
        Where it is, or the place at which it is approached.
    error : float or None
        Estimated error of the value, relative to it.
    place_error : float or None
        Estimated error of the place, relative to its distance from the edge.
    attained : bool
        Whether the stress has this value at a point; else `value` is the supremum, or None.
    remark : str
        In words: that the value is attained, or why it is not.
    """

    value: float | None
    r: float
    z: float
    error: float | None
    place_error: float | None
    attained: bool
    remark: str
