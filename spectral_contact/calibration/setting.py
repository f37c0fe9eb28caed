"""The units of a scene, and solves of punches on a layer that is described in them.

They are SI if the scene was made by `Scene.from_physical`, else those of the theory, in which its
punch has radius 1, its load is 1 and E/(4(1 − ν²)) is 1. There a punch of radius 2 on the same
layer has half the dimensionless compliances, equations (3.4) and (4.4).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from spectral_contact.contact.normal import compliance_derivative, solve_normal
from spectral_contact.contact.refine import Refinement
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields import Array
from spectral_contact.layers.scene_layer import refuse_layer
from spectral_contact.profiles.control import refuse_profile, refuse_unloaded
from spectral_contact.profiles.work_of_adhesion import refuse_adhesion
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.slopes import SolutionSlopes
from spectral_contact.threads import one_thread

#: Values of the parameters in the units of the scene; friction may be absent, as in a scene.
Layer = Mapping[str, float | None]
_Solver: TypeAlias = Callable[..., Solution]

#: What can be fitted: α, β and f.
PARAMETERS = ("normal_compliance", "tangential_compliance", "friction")
#: What slopes may be off, relative: the tolerance of their spaces. And most unknowns of one.
SLOPE_ERROR = 1e-6
_MOST_UNKNOWNS = 20_000


@dataclass(frozen=True, slots=True)
class Setting:
    """What all data of a fit share, in the units of its scene.

    Attributes
    ----------
    material : tuple
        Poisson's ratio and the modulus of κ. Of two bodies the first is None, else the second.
    stiffness : float
        E/(4(1 − ν²)) [Pa].
    radius : float
        a of the scene's punch [m].
    load : float or None
        P of the scene [N].
    rtol : float
        Tolerance of the solves.
    solver : callable
        `solve`, or what takes its place.
    coupling : bool
        Whether the traction acts back on the pressure.
    """

    material: tuple[float | None, float | None]
    stiffness: float
    radius: float
    load: float | None
    rtol: float
    solver: _Solver
    coupling: bool = False

    @classmethod
    def of(cls, scene: Scene, rtol: float, solver: _Solver) -> Setting:
        """Return the setting of a scene."""
        refuse_profile(scene, "fit")
        refuse_layer(scene, "fit")
        refuse_adhesion(scene, "fit")
        refuse_unloaded(scene, "fit")
        data = scene.physical
        # of negative kappa the zones and the pressure are those of its mirror image
        kappa = None if scene.mismatch is None else abs(scene.mismatch)
        material = (scene.poisson_ratio if kappa is None else None), kappa
        if data is None:
            return cls(material, 1.0, 1.0, 1.0, rtol, solver, scene.coupling)
        assert data.radius is not None  # a flat punch has one
        stiffness = data.quarter_modulus(scene.poisson_ratio)
        return cls(material, stiffness, data.radius, data.load, rtol, solver, scene.coupling)

    def solve(self, radius: float, layer: Layer, *quantities: str) -> Solution:
        """Solve for a punch of this radius on a layer; what does not converge names the scene."""
        return _solved(self.solver, self._scene(radius, layer), self.rtol, quantities)

    def _scene(self, radius: float, layer: Layer) -> Scene:
        alpha, beta = (layer[name] for name in PARAMETERS[:2])
        assert alpha is not None
        assert beta is not None
        unit = self.stiffness / radius
        nu, kappa = self.material
        return Scene(
            nu,
            alpha * unit,
            beta * unit,
            layer["friction"],
            coupling=self.coupling,
            mismatch=kappa,
        )

    def check_uncoupled(self, measured: str) -> None:
        """Refuse elastic coupling, with which the pressure depends on friction, too."""
        if self.coupling:
            told = (
                f"False for a fit of {measured}: with elastic coupling only stick radii are fitted"
            )
            raise SceneError("coupling", True, told)

    def stick_radius(self, radius: float, layer: Layer) -> float:
        """Return ``c*`` of a punch."""
        return float(
            _with_zones(self.solver, self._scene(radius, layer), self.rtol).stick_radius or 0.0
        )

    def stick_slope(self, radius: float, layer: Layer, name: str) -> float:
        """Return the derivative of ``c*`` by the logarithm of a parameter, to six digits."""
        return _slopes(self.solver, self._scene(radius, layer), self.rtol)[PARAMETERS.index(name)]

    def pressure_slope(self, radius: float, layer: Layer, s: Array) -> Array:
        """Return the derivative of ``p*`` at radii by the logarithm of the normal compliance."""
        alpha = self._scene(radius, layer).normal_compliance
        solved = solve_normal(alpha, SLOPE_ERROR, _MOST_UNKNOWNS, goal="pressure")
        if not isinstance(solved, Refinement):
            return np.zeros(s.shape)
        return np.asarray(alpha * compliance_derivative(solved).pressure(s, 1.0 - s))

    def radii(self, radius: tuple[float, ...] | None, count: int) -> Array:
        """Return the radii of `count` punches [m]; None is the scene's."""
        return np.broadcast_to(np.array(radius or (self.radius,)), count)

    def loads(self, load: tuple[float, ...] | None, count: int) -> Array:
        """Return `count` loads [N]; None is that of the scene, which has to have one then."""
        if load is None and self.load is None:
            raise SceneError("load", None, "given, in the data or in the scene")
        return np.broadcast_to(np.array(load or (self.load,), dtype=float), count)


def _solved(solver: _Solver, scene: Scene, rtol: float, quantities: Sequence[str]) -> Solution:
    try:
        return solver(scene, rtol, quantities)
    except ConvergenceError as error:
        cause = f"{error.cause}, in a fit at {scene}"
        raise ConvergenceError(cause, error.remedy, error.solution) from error


@lru_cache(maxsize=128)
def _with_zones(solver: _Solver, scene: Scene, rtol: float) -> Solution:
    """Return the solution from which both the stick radius and its slopes are taken."""
    return _solved(solver, scene, rtol, ("stick_radius", "zones", "total_shear", "traction"))


@lru_cache(maxsize=4096)
@one_thread()
def _slopes(solver: _Solver, scene: Scene, rtol: float) -> tuple[float, ...]:
    """Return the derivatives of ``c*`` by the logarithms of the parameters."""
    solution = _with_zones(solver, scene, rtol)
    alpha, beta, friction = (getattr(scene, name) or 0.0 for name in PARAMETERS)
    if len(solution.zones) == 1:
        return (0.0, 0.0, 0.0)
    known = SolutionSlopes(solution, SLOPE_ERROR)
    each = zip(PARAMETERS, (alpha, beta, friction), strict=True)
    moved = [one and one * known.scalar("stick_radius", name) for name, one in each]
    return tuple(np.where(np.isfinite(moved), moved, 0.0).tolist())
