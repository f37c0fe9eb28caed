"""What was measured, and what the theory says it should be; with derivatives.

Units are those of the scene that is fitted, see `Setting`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.calibration.setting import PARAMETERS, Layer, Setting
from spectral_contact.equations.residuals import approach_slope, edge_layer_breaks
from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, positive
from spectral_contact.io.choices import instance, one_of


@dataclass(frozen=True, slots=True)
class ApproachData:
    """Approaches of one or more punches on the same material and layer.

    Parameters
    ----------
    approach : array_like
        δ as measured [m]; one or more.
    sigma : array_like
        Their standard deviations [m], > 0; one for all, or one each.
    radius : array_like, optional
        Radii a of the punches [m]; the default is the scene's.
    load : array_like, optional
        Loads P [N]; the default is the scene's.

    Raises
    ------
    SceneError
        For a value out of its range, or lists of different lengths.
    """

    approach: tuple[float, ...]
    sigma: tuple[float, ...]
    radius: tuple[float, ...] | None
    load: tuple[float, ...] | None

    depends_on: ClassVar[frozenset[str]] = frozenset(PARAMETERS[:1])

    def __init__(
        self,
        approach: ArrayLike,
        sigma: ArrayLike,
        *,
        radius: ArrayLike | None = None,
        load: ArrayLike | None = None,
    ) -> None:
        values = _finite("approach", approach, "m")
        _put(
            self,
            approach=values,
            sigma=_positive("sigma", sigma, len(values), "m"),
            radius=_optional("radius", radius, len(values), "m"),
            load=_optional("load", load, len(values), "N"),
        )

    @property
    def measured(self) -> tuple[float, ...]:
        """The approaches."""
        return self.approach

    def predict(self, setting: Setting, layer: Layer) -> Array:
        """Return δ = 4(1 − ν²)P/(aE)·δ*, equation (3.4)."""
        _check(setting, layer)
        setting.check_uncoupled("approaches")
        return self._scaled(
            setting, lambda a: setting.solve(a, layer, "approach").approach, lambda a: 1.0 / a
        )

    def slope(self, setting: Setting, layer: Layer, name: str) -> Array:
        """Return ∂δ/∂ln α, exactly, by reciprocity."""
        _check(setting, layer)
        setting.check_uncoupled("approaches")
        alpha = layer[one_of("name", name, self.depends_on)]
        assert alpha is not None

        def energy(a: float) -> float:
            pressure = setting.solve(a, layer, "pressure").pressure
            return approach_slope(lambda d: pressure(from_edge=d), edge_layer_breaks(a))

        unit = alpha * setting.stiffness
        return self._scaled(setting, energy, lambda a: unit / a**2)

    def _scaled(
        self, setting: Setting, star: Callable[[float], float], scale: Callable[[Array], Array]
    ) -> Array:
        count = len(self.approach)
        radii = setting.radii(self.radius, count)
        loads = setting.loads(self.load, count)
        return _each(star, radii) * scale(radii) * loads / setting.stiffness


@dataclass(frozen=True, slots=True)
class PressureData:
    """Pressures at radii under one punch.

    Parameters
    ----------
    r : array_like
        Where they were measured [m], in [0, a].
    pressure : array_like
        p as measured [Pa]; one or more.
    sigma : array_like
        Their standard deviations [Pa], > 0; one for all, or one each.
    radius : float, optional
        Radius a of the punch [m]; the default is the scene's.
    load : float, optional
        Load P [N]; the default is the scene's.

    Raises
    ------
    SceneError
        For a value out of its range, or lists of different lengths.
    """

    r: tuple[float, ...]
    pressure: tuple[float, ...]
    sigma: tuple[float, ...]
    radius: tuple[float, ...] | None
    load: tuple[float, ...] | None

    depends_on: ClassVar[frozenset[str]] = frozenset(PARAMETERS[:1])

    def __init__(
        self,
        r: ArrayLike,
        pressure: ArrayLike,
        sigma: ArrayLike,
        *,
        radius: float | None = None,
        load: float | None = None,
    ) -> None:
        values = _finite("pressure", pressure, "Pa")
        places = _finite("r", r, "m")
        if len(places) != len(values) or min(places) < 0.0:
            raise SceneError("r", r, f"{len(values)} radii >= 0, one for each pressure")
        _put(
            self,
            r=places,
            pressure=values,
            sigma=_positive("sigma", sigma, len(values), "Pa"),
            radius=_one("radius", radius, "m"),
            load=_one("load", load, "N"),
        )

    @property
    def measured(self) -> tuple[float, ...]:
        """The pressures."""
        return self.pressure

    def predict(self, setting: Setting, layer: Layer) -> Array:
        """Return p = P/a²·p*(r/a), equation (3.4).

        Raises
        ------
        SceneError
            If a place is outside the punch, or at the edge of a smooth surface.
        """
        _check(setting, layer)
        setting.check_uncoupled("pressures")
        [a] = setting.radii(self.radius, 1)
        [load] = setting.loads(self.load, 1)
        if max(self.r) > a:
            raise SceneError("r", max(self.r), f"in [0, {a:g}], the radius of the punch")
        star = setting.solve(float(a), layer, "pressure").pressure(np.array(self.r) / a)
        if not np.isfinite(star).all():
            raise SceneError(
                "r", max(self.r), f"below {a:g}: a smooth surface has no edge pressure"
            )
        return np.asarray(star * (load / a**2))

    def slope(self, setting: Setting, layer: Layer, name: str) -> Array:
        """Return ∂p/∂ln α."""
        _check(setting, layer)
        setting.check_uncoupled("pressures")
        one_of("name", name, self.depends_on)
        [a] = setting.radii(self.radius, 1)
        [load] = setting.loads(self.load, 1)
        slope = setting.pressure_slope(float(a), layer, np.array(self.r) / a)
        return np.asarray(slope * (load / a**2))


@dataclass(frozen=True, slots=True)
class StickRadiusData:
    """Radii of the central stick zone, of one or more punches on the same material and layer.

    Parameters
    ----------
    stick_radius : array_like
        c as measured [m]; one or more.
    sigma : array_like
        Their standard deviations [m], > 0; one for all, or one each.
    radius : array_like, optional
        Radii a of the punches [m]; the default is the scene's.
    friction : array_like, optional
        Known coefficients of friction; the default is the scene's, which may be fitted.

    Raises
    ------
    SceneError
        For a value out of its range, or lists of different lengths.
    """

    stick_radius: tuple[float, ...]
    sigma: tuple[float, ...]
    radius: tuple[float, ...] | None
    friction: tuple[float, ...] | None

    def __init__(
        self,
        stick_radius: ArrayLike,
        sigma: ArrayLike,
        *,
        radius: ArrayLike | None = None,
        friction: ArrayLike | None = None,
    ) -> None:
        values = _finite("stick_radius", stick_radius, "m")
        count = len(values)
        _put(
            self,
            stick_radius=values,
            sigma=_positive("sigma", sigma, count, "m"),
            radius=_optional("radius", radius, count, "m"),
            friction=_optional("friction", friction, count),
        )

    @property
    def measured(self) -> tuple[float, ...]:
        """The stick radii."""
        return self.stick_radius

    @property
    def depends_on(self) -> frozenset[str]:
        """All parameters, but friction where it is known."""
        return frozenset(PARAMETERS if self.friction is None else PARAMETERS[:2])

    def predict(self, setting: Setting, layer: Layer) -> Array:
        """Return c = a·c*, equation (5.7).

        Raises
        ------
        SceneError
            If neither the data nor the layer have friction.
        """
        _check(setting, layer)
        if self.friction is None and layer["friction"] is None:
            raise SceneError("friction", None, "given, in the data or in the scene")
        punches = self._punches(setting, layer)
        return np.array([a * setting.stick_radius(a, own) for a, own in punches])

    def slope(self, setting: Setting, layer: Layer, name: str) -> Array:
        """Return the derivative of c by the logarithm of a parameter, to six digits."""
        _check(setting, layer)
        one_of("name", name, self.depends_on)
        punches = self._punches(setting, layer)
        return np.array([a * setting.stick_slope(a, own, name) for a, own in punches])

    def _punches(self, setting: Setting, layer: Layer) -> list[tuple[float, Layer]]:
        """Return the radius of every punch, and the layer with its friction."""
        count = len(self.stick_radius)
        radii = setting.radii(self.radius, count).tolist()
        frictions = np.broadcast_to(np.array(self.friction or (layer["friction"],)), count)
        each = zip(radii, frictions.tolist(), strict=True)
        return [(a, {**layer, "friction": f}) for a, f in each]


#: Measured values with their standard deviations, and their theory.
Data = ApproachData | PressureData | StickRadiusData


def _check(setting: object, layer: object) -> None:
    """Check that a prediction is asked for a `Setting`, and for a mapping of all `PARAMETERS`."""
    instance("setting", setting, Setting)
    if not isinstance(layer, Mapping) or not set(PARAMETERS) <= set(layer):
        raise SceneError("layer", layer, f"a mapping of {', '.join(PARAMETERS)}")


def _each(star: Callable[[float], float], radii: Array) -> Array:
    """Return a quantity for every radius; `star` is called once for equal radii."""
    different, places = np.unique(radii, return_inverse=True)
    return np.array([star(float(a)) for a in different])[places]


def _put(data: object, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(data, name, value)  # the way into a frozen dataclass


def _finite(name: str, values: ArrayLike, unit: str) -> tuple[float, ...]:
    array = finite(name, values, one_will_do=True, unit=unit)
    if not array.size:
        raise SceneError(name, values, "at least one number")
    return tuple(array.tolist())


def _positive(name: str, values: ArrayLike, count: int, unit: str) -> tuple[float, ...]:
    listed = _finite(name, values, unit)
    if len(listed) not in (1, count):
        raise SceneError(name, values, f"one number, or {count} as the values measured are")
    return tuple(positive(name, value) for value in listed)


def _one(name: str, value: object, unit: str) -> tuple[float] | None:
    return None if value is None else (positive(name, value, unit),)


def _optional(
    name: str, values: ArrayLike | None, count: int, unit: str = ""
) -> tuple[float, ...] | None:
    return None if values is None else _positive(name, values, count, unit)
