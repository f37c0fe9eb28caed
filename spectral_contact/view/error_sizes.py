"""The sizes that error estimates of fields are relative to, and errors of factors to SI units."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.io import checks
from spectral_contact.layers.scene_layer import endless
from spectral_contact.scene import Scene

#: A field as a function of distances from the edge.
Field = Callable[[Array], Array]

#: Number of rings of equal area on which the mean and the largest size of a field are taken.
_RINGS: Final = 64
#: Quantities from which the mean pressure under a profile is computed.
OF_MEAN_PRESSURE: Final = ("load", "contact_radius")


def unloaded(scene: Scene) -> bool:
    """Return whether the traction may change sign, as the load has been larger."""
    return scene.unloaded_to < 1.0 and scene.friction is not None and np.isfinite(scene.friction)


def error_of_unit(scene: Scene, name: str, estimate: Callable[[str], float | None]) -> float:
    """Return the relative error of the factor that converts a quantity to SI units.

    The load of a flat punch is the unit of force. Where the approach is given, the load is computed
    from it, and has the error of the dimensionless approach. Under a profile the unit of a stick
    radius is the contact radius.

    Parameters
    ----------
    scene : Scene
    name : str
        Of the quantity.
    estimate : callable
        Returns the estimated error of a dimensionless quantity, by its name, if there is one.
    """
    if scene.profile is not None:
        has_error = name == "stick_radius" and scene.contact_radius is None
        source = "contact_radius"
    else:
        by_approach = scene.physical is not None and scene.physical.approach is not None
        has_error = by_approach and name not in ("approach", "stick_radius")
        source = "approach"
    return (estimate(source) or 0.0) if has_error else 0.0


class ErrorSizes:
    """The sizes that errors of the fields of a solution are relative to.

    Parameters
    ----------
    scene : Scene
    solution : object
        With the numbers and the zones of a `Solution`.
    field : callable
        Returns a field of the solution, by its name.
    """

    def __init__(self, scene: Scene, solution: Any, field: Callable[[str], Field]) -> None:
        self._scene = scene
        self._solution = solution
        self._field = field

    def at(self, name: str, values: Array, places: Array) -> Array:
        """Return the size that errors of a field are relative to, at each place.

        Parameters
        ----------
        name : str
            Pressure, traction or slip.
        values : ndarray
            Of the field, dimensionless.
        places : ndarray
            Distances from the edge.
        """
        scene = self._scene
        # the largest value is that over the whole contact, wherever values are given
        field_sizes = np.append(self._on_rings(name), np.abs(values[np.isfinite(values)]))
        largest = np.max(field_sizes, initial=0.0) or 1.0
        if name == "slip":
            return np.full(len(values), largest)
        sizes = np.abs(values)
        if name == "traction" and unloaded(scene):
            limit = self._field("pressure")(places) * (scene.friction or 0.0)
            for zone in self._solution.zones:
                if zone.memory:
                    in_zone = (places <= zone.inner_from_edge) & (places >= zone.outer_from_edge)
                    sizes = np.where(in_zone, limit, sizes)
        if scene.profile is not None:
            if name == "traction":
                return np.full(len(values), largest)
            sizes = np.maximum(sizes, self._mean_pressure())
        if scene.couples:
            # p or q may change sign: the error of each is relative to the two together, as
            # q/s and kappa p act on each other (docs/coupling)
            s = 1.0 - places
            p, q = (self._field(field)(places) for field in ("pressure", "traction"))
            q_over_s = np.divide(q, s, out=np.zeros_like(q), where=s > 0.0)
            if name == "pressure":
                sizes = np.hypot(p, q_over_s)
            else:
                both_sizes = s * np.hypot(q_over_s, scene.kappa * p)
                # next to a smooth edge that sticks p is infinite, and the traction is not
                sizes = np.where(np.isfinite(both_sizes), both_sizes, sizes)
        return np.where(sizes == 0.0, largest, sizes)

    def mean(self, name: str) -> float:
        """Return the mean of a field's absolute value over the contact; 1 where it vanishes."""
        return float(np.mean(self._on_rings(name))) or 1.0

    def _on_rings(self, name: str) -> Array:
        """Return the absolute values of a field on rings of equal area, where they are finite."""
        rings = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
        sizes = np.abs(self._field(name)(1.0 - rings))
        return np.asarray(sizes[np.isfinite(sizes)])

    def _mean_pressure(self) -> float:
        """Return the mean pressure over the contact of a profile."""
        try:
            load, a = (
                checks.scalar(f"truth.{quantity}", getattr(self._solution, quantity))
                for quantity in OF_MEAN_PRESSURE
            )
        except NotComputedError:
            if endless(self._scene):  # there is no edge, within which a mean could be taken
                raise
            return self.mean("pressure")
        # with adhesion the load may be zero, and its error is relative to another size
        error_sizes: dict[str, float] = getattr(self._solution, "error_scales", {})
        return error_sizes.get("load", abs(load)) / (np.pi * a**2)
