"""What a check asks of a contact through a nonlinear layer."""

from __future__ import annotations

from math import isinf
from typing import Any, Final

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.layers import Layer
from spectral_contact.layers.scene_layer import endless
from spectral_contact.profiles import Flat
from spectral_contact.testing.attributes import computed

#: Where between the edge and the centre a steep law may turn from contact to gap.
_CUTS: Final = tuple(k / 30.0 for k in range(1, 30))
_TINY: Final = float(np.finfo(float).tiny)


class LayerConditions:
    """The conditions of a scene with a layer.

    Parameters
    ----------
    scene : Scene
        With a layer and a profile.
    """

    def __init__(self, scene: Any) -> None:
        self.scene, self.law = scene, scene.layer
        assert isinstance(self.law, Layer)

    @property
    def flat(self) -> bool:
        """Whether the contact is all of a flat punch."""
        return isinstance(self.scene.profile, Flat)

    def radius(self, solution: Any) -> Any:
        """Return the radius at s = 1, None if it is not known."""
        if self.flat:
            return self.scene.profile.radius
        if endless(self.scene):
            return computed(solution, "domain_radius")
        return computed(solution, "contact_radius") or self.scene.contact_radius

    def cuts(self, largest: float, radius: float) -> list[float]:
        """Return distances from the edge between which the pressure is smooth."""
        inner = list(_CUTS) if endless(self.scene) else []
        if not 0.0 < largest < np.inf:
            return inner
        slope = float(self.law._slope(np.array(self.law._overclosure(largest))))
        finest = 1.0 / max(slope * radius, 1.0)
        return [*inner, *(10.0**-k for k in range(1, 15) if 10.0**-k > finest / 30.0)]

    def overclosures(self, p: Array) -> Array:
        """Return the overclosure of every pressure; where the law begins at none."""
        least = self.law.start if not isinf(self.law.start) else self.law._overclosure(_TINY)
        return np.array([self.law._overclosure(one) if one > _TINY else least for one in p])

    def misfits(self, p: Array, w: Array, off: Array, size: float) -> Array:
        """Return by how much the surface misses the punch, relative.

        Relative to a displacement, or to how far the layer is compressed by its pressure or their
        mean: at small pressures a law may turn an error of the one into a large one of the other.
        """
        with np.errstate(over="ignore"):
            slope = np.maximum(self.law._slope(w), _TINY)
            room = size + np.maximum(p, np.mean(np.abs(p))) / slope
        return np.asarray(np.abs(off) / room)

    def beyond(self, w: Array, size: float, mean: float) -> Array:
        """Return how far the surface is in the law's reach where there should be no pressure."""
        if isinf(self.law.start):
            return np.asarray(self.law._pressure(w) / mean)
        return np.asarray(np.maximum(w - self.law.start, 0.0) / size)
