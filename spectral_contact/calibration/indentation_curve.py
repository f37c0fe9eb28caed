"""Modulus, layer and zero point from a force-indentation curve under any profile.

With ``E' = E*/4`` a load is ``E' L(delta; alpha E')``, where L is the theory's in the units of the
profile. All derivatives are exact: by the approach it is the flat punch's stiffness, and by the
layer ``-int p p^ dA`` with ``p^ = dp/ddelta``, the flat punch's pressure: the work of an approach
is an extremum, ``dW/dalpha = -1/2 int p^2 dA``, and the load is its derivative (docs/indentation).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.contact.contact_radius import find_radius, indenter, value_of
from spectral_contact.equations.residuals import load as half_load
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, reals
from spectral_contact.io.choices import one_of
from spectral_contact.profiles import Profile
from spectral_contact.scene import Scene

#: What can be fitted: E* [Pa], alpha [m/Pa], and the depth at which the punch touches [m].
INDENTATION_PARAMETERS: Final = ("reduced_modulus", "normal_compliance", "zero_point")
#: Units of all that can be fitted, the numbers of a layer's law included.
_UNITS: Final = {
    **dict(zip(INDENTATION_PARAMETERS, ("Pa", "m/Pa", "m"), strict=True)),
    "compliance": "m/Pa",
    "coefficient": "Pa/m^exponent",
    "exponent": "",
    "zero_pressure": "Pa",
    "clearance": "m",
    "density": "1/m²",
    "tip_radius": "m",
    "height_deviation": "m",
}
_MOST_UNKNOWNS: Final = 20_000
#: Singular values of the scaled derivatives below which data do not tell parameters apart.
_APART: Final = 1e-7
#: Standard deviations of a logarithm beyond which a parameter is not determined.
_LARGEST_ERROR: Final = 10.0


#: Loads of more standard deviations are no noise; the start is this share of all depths above.
_NOISE: Final = 3.0
_ABOVE: Final = 0.01


@dataclass(frozen=True, slots=True)
class IndentationData:
    """A force-indentation curve of one punch under growing load.

    Parameters
    ----------
    depth : array_like
        As the instrument has them [m], from any zero; increasing is not needed.
    load : array_like
        P at each [N].
    sigma : array_like
        Standard deviations of the loads [N], > 0; one for all, or one each.

    Raises
    ------
    SceneError
        If they are not finite numbers, as many of each.
    """

    depth: tuple[float, ...]
    load: tuple[float, ...]
    sigma: tuple[float, ...]

    def __init__(self, depth: ArrayLike, load: ArrayLike, sigma: ArrayLike) -> None:
        depths = finite("depth", depth, unit="m")
        loads = finite("load", load, unit="N")
        if not depths.size:
            raise SceneError("depth", depth, "at least one number")
        if len(loads) != len(depths):
            raise SceneError("load", load, f"{len(depths)} numbers, one for each depth")
        sizes = np.ravel(reals("sigma", sigma, "finite and > 0", low=0.0, unit="N"))
        if len(sizes) not in (1, len(depths)) or not ((sizes > 0) & np.isfinite(sizes)).all():
            raise SceneError("sigma", sigma, f"finite and > 0, one number or {len(depths)}")
        for name, values in (
            ("depth", depths),
            ("load", loads),
            ("sigma", np.broadcast_to(sizes, depths.shape)),
        ):
            object.__setattr__(self, name, tuple(values.tolist()))  # into a frozen dataclass


@dataclass(frozen=True, slots=True)
class IndentationFit:
    """The outcome of a fit of a force-indentation curve.

    Attributes
    ----------
    scene : Scene
        With the modulus and layer that fit best.
    names : tuple of str
        The parameters, in the order in which they were asked for.
    values : tuple of float
        ``reduced_modulus`` is E* [Pa], ``normal_compliance`` alpha [m/Pa], ``zero_point`` the depth
        of first touch [m], that of zero approach under a nonlinear layer; numbers of its law as in
        SI units.
    errors : tuple of float
        Their standard deviations, in the same units; to first order.
    covariance : tuple of tuple of float
        ``(J^T J)^-1`` of the logarithms of all but the zero point, and of the zero point; it takes
        the standard deviations of the data for known.
    residuals : tuple of float
        Theory minus measurement over standard deviation.
    evaluations : int
        How often the curve was predicted.
    """

    scene: Scene
    names: tuple[str, ...]
    values: tuple[float, ...]
    errors: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    residuals: tuple[float, ...]
    evaluations: int

    def __getitem__(self, name: str) -> float:
        if name not in self.names:
            raise KeyError(name)
        return self.values[self.names.index(name)]

    def error(self, name: str) -> float:
        """Return the standard deviation of a parameter; `SceneError` if it was not fitted."""
        return self.errors[self.names.index(one_of("name", name, self.names))]

    @property
    def chi_square(self) -> float:
        """Sum of the squares of the residuals."""
        return math.fsum(one * one for one in self.residuals)

    @property
    def degrees_of_freedom(self) -> int:
        """Number of loads less that of the parameters."""
        return len(self.residuals) - len(self.names)

    def __str__(self) -> str:
        lines = [f"{'parameter':<20} {'value':>12}  standard deviation"]
        for name, value, error in zip(self.names, self.values, self.errors, strict=True):
            lines.append(f"{name:<20} {value:12.5g}  {error:.2g} {_UNITS[name]}".rstrip())
        freedom = self.degrees_of_freedom
        lines.append(f"chi square {self.chi_square:.4g} at {freedom} degrees of freedom")
        return "\n".join(lines)


class _CurveLoad(NamedTuple):
    """``L = P/E'`` and its derivatives."""

    value: float
    by_approach: float
    by_layer: float


def curve_load(profile: Profile, approach: float, layer: float, rtol: float) -> _CurveLoad:
    """Return the load of an approach, over E', with its derivatives, all to the tolerance.

    Parameters
    ----------
    profile : Profile
    approach : float
        0 or less is no contact.
    layer : float
        ``alpha E'``, a length; if 0, the derivative by it is taken for 0.
    rtol : float
    """
    if approach <= 0.0:
        return _CurveLoad(0.0, 0.0, 0.0)
    solve = indenter(profile, layer, _MOST_UNKNOWNS)
    solved, _ = find_radius(
        profile, solve, rtol, load=None, approach=approach, pointwise=layer > 0.0
    )
    found = value_of(solved)
    error = max(found.load_error, found.stiffness_error)
    if error > 10.0 * rtol:
        told = f"load and stiffness of {profile.brief} at {approach:.6g} are known to {error:.1e}"
        raise ConvergenceError(told, "loosen rtol.")
    if layer == 0.0:
        return _CurveLoad(found.load, found.stiffness, 0.0)
    pressure, flat, a = found.pressure, found.flat, found.radius
    assert pressure is not None
    assert flat is not None

    def product(d: Array) -> Array:
        return np.asarray(pressure(1.0 - d, d) * flat(1.0 - d, d))

    integral = half_load(product, breaks=cuts(profile, a, layer / a))
    return _CurveLoad(found.load, found.stiffness, -2.0 * math.pi * a * integral)


def cuts(profile: Profile, radius: float, finest: float) -> list[float]:
    """Return distances from the edge between which the pressure is smooth.

    Layers at the edge, the centre of a tip and breaks are no thinner than the finest, over the
    radius.
    """
    steps = 10.0 ** -np.arange(1.0, 15.0)
    steps = np.append(steps[steps > finest / 30.0], 0.0)
    inside = [1.0 - b / radius for b in profile.breaks if b < radius]
    corners = [0.0, *([1.0] if profile.pointed else []), *inside]
    around = np.add.outer(corners, [-steps, steps]).ravel().tolist()
    return [d for d in around if 0.0 < d < 1.0]


class CurveProblem:
    """Residuals and derivatives by ln E*, ln alpha and the zero point."""

    @staticmethod
    def parameters(scene: Scene) -> tuple[str, ...]:
        """Return what can be free."""
        return INDENTATION_PARAMETERS

    def __init__(
        self, scene: Scene, data: IndentationData, free: tuple[str, ...], rtol: float
    ) -> None:
        physical, profile = scene.physical, scene.profile
        if profile is None or physical is None or scene.friction:
            told = "one of Scene.from_physical with a profile and without friction"
            raise SceneError("scene", scene, told)
        if not free or len(set(free)) < len(free):
            told = f"one or more of {', '.join(self.parameters(scene))}, each once"
            raise SceneError("free", free, told)
        if len(data.load) < len(free):
            told = f"at most {len(data.load)} parameters, the number of loads measured"
            raise SceneError("free", free, told)
        self.known = {
            "reduced_modulus": 4.0 * physical.quarter_modulus(scene.poisson_ratio),
            "zero_point": 0.0,
            **self._of_layer(scene),
        }
        if "normal_compliance" in free and not self.known["normal_compliance"] > 0.0:
            told = "> 0 where it is free: the fit starts there"
            raise SceneError("normal_compliance", physical.normal_compliance, told)
        self.scene, self.profile, self.free, self.rtol = scene, profile, free, rtol
        self.depth, self.load, self.sigma = map(np.array, (data.depth, data.load, data.sigma))
        extent = float(np.ptp(self.depth)) or 1.0
        # a little above the first load that is no noise, so that every load that is one counts
        loaded = self.depth[self.load > _NOISE * self.sigma]
        touch = float((loaded if len(loaded) else self.depth).min()) - _ABOVE * extent
        self.start = [0.0 if self._log(name) else touch for name in free]
        self.scale = [1.0 if self._log(name) else extent for name in free]
        self.at = partial(self._at, {})
        self.evaluations = 0

    @staticmethod
    def _of_layer(scene: Scene) -> dict[str, float]:
        assert scene.physical is not None
        return {"normal_compliance": scene.physical.normal_compliance}

    def bounds(self) -> tuple[list[float], list[float]]:
        """Return between which values is searched."""
        return [-math.inf] * len(self.free), [math.inf] * len(self.free)

    @staticmethod
    def _log(name: str) -> bool:
        return name != "zero_point"

    def values(self, x: Sequence[float]) -> dict[str, float]:
        """Return the parameters: logarithms are over their start."""
        moved = {
            name: self.known[name] * math.exp(one) if self._log(name) else one
            for name, one in zip(self.free, x, strict=True)
        }
        return self.known | moved

    def _at(self, kept: dict[Any, tuple[Array, Array]], x: tuple[float, ...]) -> Any:
        """Return residuals and their derivatives; the last are kept."""
        if x not in kept:
            kept.clear()
            self.evaluations += 1
            values = self.values(x)
            value, columns = self.curve(values, (self.depth - values["zero_point"]).tolist())
            jacobian = np.stack([columns[name] for name in self.free], axis=1)
            jacobian = self.turned(jacobian, x, 1.0)
            kept[x] = (value - self.load) / self.sigma, jacobian / self.sigma[:, None]
        return kept[x]

    def curve(self, values: dict[str, float], depths: list[float]) -> tuple[Array, Any]:
        """Return the loads of all depths, and their derivatives by name."""
        quarter = values["reduced_modulus"] / 4.0
        layer = values["normal_compliance"] * quarter
        rows = [curve_load(self.profile, d, layer, self.rtol) for d in depths]
        value, by_approach, by_layer = quarter * np.array(rows).T
        return value, {
            "reduced_modulus": value + layer * by_layer,
            "normal_compliance": layer * by_layer,
            "zero_point": -by_approach,
        }

    def turned(self, jacobian: Array, x: Sequence[float], sense: float) -> Array:
        """Return derivatives by logarithms of the parameters as those by what is searched.

        With the sense -1 it is the other way round.
        """
        return jacobian

    def best(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the layer that fits best, as a scene takes it."""
        return {"normal_compliance": values["normal_compliance"]}

    def _material(self, reduced: float) -> dict[str, float]:
        """Return what a scene takes for a reduced modulus: an elastic punch is as it was given."""
        nu, data = self.scene.poisson_ratio, self.scene.physical
        assert data is not None
        if nu is None:
            return {"reduced_modulus": reduced}
        if data.punch_youngs_modulus is None or data.punch_poisson_ratio is None:
            return {"youngs_modulus": reduced * (1.0 - nu) * (1.0 + nu)}
        of_punch = data.punch_poisson_ratio
        share = reduced * (1.0 - of_punch) * (1.0 + of_punch) / data.punch_youngs_modulus
        if not share < 1.0:
            told = "such that the punch alone does not give way more than both do"
            raise SceneError("punch_youngs_modulus", data.punch_youngs_modulus, told)
        return {"youngs_modulus": reduced * (1.0 - nu) * (1.0 + nu) / (1.0 - share)}

    def outcome(self, found: Any) -> IndentationFit:
        """Return the record, if the data determine all parameters."""
        x = tuple(found.x.tolist())
        residuals, jacobian = self.at(x)
        searched = np.sqrt(np.diag(self.covariance(jacobian)))
        for name, size in zip(self.free, searched, strict=True):
            if self._log(name) and size > _LARGEST_ERROR:
                raise SceneError("free", self.free, f"determined by the data, as {name} is not")
        if np.any(found.active_mask):
            raise self._alike
        covariance = self.covariance(self.turned(jacobian, x, -1.0))
        values = self.values(x)
        errors = [
            float(size) * (values[name] if self._log(name) else 1.0)
            for name, size in zip(self.free, np.sqrt(np.diag(covariance)), strict=True)
        ]
        material = self._material(values["reduced_modulus"])
        scene = self.scene.replace(**material, **self.best(values))
        return IndentationFit(
            scene,
            self.free,
            tuple(values[name] for name in self.free),
            tuple(errors),
            tuple(tuple(row) for row in covariance.tolist()),
            tuple(residuals.tolist()),
            self.evaluations,
        )

    @property
    def _alike(self) -> SceneError:
        told = "determined by the data, which cannot distinguish them"
        return SceneError("free", self.free, told)

    def covariance(self, jacobian: Array) -> Array:
        """Return ``(J^T J)^-1``; `SceneError` if the data do not tell the parameters apart."""
        lengths = np.linalg.norm(jacobian, axis=0)
        if not (lengths > 0.0).all():
            raise self._alike
        _, singular, right = np.linalg.svd(jacobian / lengths, full_matrices=False)
        if singular[-1] < _APART:
            raise self._alike
        root = right.T / singular / lengths[:, None]
        return np.asarray(root @ root.T)

    def look(self) -> None:
        """Look at the start before the search."""
