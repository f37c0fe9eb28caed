"""The units of a scene, and solves of punches on a layer that is described in them.

They are SI if the scene was made by `Scene.from_physical`, else those of the theory, in which its
punch has radius 1, its load is 1 and E/(4(1 − ν²)) is 1. There a punch of radius 2 on the same
layer has half the dimensionless compliances, equations (3.4) and (4.4).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.layers.control import refuse_layer
from spectral_contact.profiles.control import refuse_profile
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve

__all__ = ["PARAMETERS", "Layer", "Setting"]

Array = NDArray[np.float64]
#: Values of the parameters in the units of the scene; friction may be absent, as in a scene.
Layer = Mapping[str, float | None]

#: What can be fitted: α, β and f.
PARAMETERS = ("normal_compliance", "tangential_compliance", "friction")


@dataclass(frozen=True, slots=True)
class Setting:
    """What all data of a fit share, in the units of its scene.

    Attributes
    ----------
    poisson_ratio : float
    stiffness : float
        E/(4(1 − ν²)) [Pa].
    radius : float
        a of the scene's punch [m].
    load : float or None
        P of the scene [N].
    rtol : float
        Tolerance of the solves.
    """

    poisson_ratio: float
    stiffness: float
    radius: float
    load: float | None
    rtol: float

    @classmethod
    def of(cls, scene: Scene, rtol: float) -> Setting:
        """Return the setting of a scene."""
        refuse_profile(scene, "fit")
        refuse_layer(scene, "fit")
        nu, data = scene.poisson_ratio, scene.physical
        if data is None:
            return cls(nu, 1.0, 1.0, 1.0, rtol)
        assert data.radius is not None  # a flat punch has one
        stiffness = data.youngs_modulus / (4.0 * (1.0 - nu) * (1.0 + nu))
        return cls(nu, stiffness, data.radius, data.load, rtol)

    def solve(self, radius: float, layer: Layer, *quantities: str) -> Solution:
        """Solve for a punch of this radius on a layer.

        Raises
        ------
        SceneError
            If the dimensionless compliances are out of the range that scenes have.
        ConvergenceError
            If the tolerance cannot be met; it names the scene.
        """
        alpha, beta = (layer[name] for name in PARAMETERS[:2])
        assert alpha is not None
        assert beta is not None
        unit = self.stiffness / radius
        scene = Scene(self.poisson_ratio, alpha * unit, beta * unit, layer["friction"])
        try:
            return solve(scene, self.rtol, quantities)
        except ConvergenceError as error:
            cause = f"{error.cause}, in a fit at {scene}"
            raise ConvergenceError(cause, error.remedy, error.solution) from error

    def radii(self, radius: tuple[float, ...] | None, count: int) -> Array:
        """Return the radii of `count` punches [m]; None is the scene's."""
        return np.broadcast_to(np.array(radius or (self.radius,)), count)

    def loads(self, load: tuple[float, ...] | None, count: int) -> Array:
        """Return `count` loads [N]; None is the scene's.

        Raises
        ------
        SceneError
            If neither the data nor the scene have one.
        """
        if load is None and self.load is None:
            raise SceneError("load", None, "given, in the data or in the scene")
        return np.broadcast_to(np.array(load or (self.load,), dtype=float), count)
