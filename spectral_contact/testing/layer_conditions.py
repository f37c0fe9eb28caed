"""The conditions that a contact through a nonlinear layer has to meet."""

from __future__ import annotations

from collections.abc import Callable
from math import isinf
from typing import Any, Final

import numpy as np
from scipy.optimize import brentq

from spectral_contact.fields import Array
from spectral_contact.layers import Layer
from spectral_contact.layers.scene_layer import endless
from spectral_contact.profiles import Flat
from spectral_contact.testing.attributes import computed

#: Cuts, as distances from the edge, for layer laws without an edge: wherever a steep law turns from
#: contact to gap, the interval around is short (chosen).
_CUTS: Final = tuple(k / 30.0 for k in range(1, 30))
#: Distances from the edge at which a pressure is compared with the pressure at a knot (chosen).
_DISTANCES: Final = np.concatenate([np.geomspace(1e-15, 0.1, 200), np.linspace(0.1, 1.0, 201)[1:]])
#: A pressure up to this counts as none.
_TINY: Final = float(np.finfo(float).tiny)


class LayerConditions:
    """The conditions of a scene with a layer.

    Parameters
    ----------
    scene : Scene
        With a layer and a profile.
    """

    def __init__(self, scene: Any) -> None:
        self.scene = scene
        self.law = scene.layer
        assert isinstance(self.law, Layer)

    @property
    def flat(self) -> bool:
        """Whether the punch is flat, so that all of its face is in contact."""
        return isinstance(self.scene.profile, Flat)

    def radius(self, solution: Any) -> Any:
        """Return the radius at s = 1, in L; None if neither solution nor scene has it.

        It is that of a flat punch, that of the domain for a layer law without an edge, or that of
        the contact.
        """
        if self.flat:
            return self.scene.profile.radius
        if endless(self.scene):
            return computed(solution, "domain_radius")
        return computed(solution, "contact_radius") or self.scene.contact_radius

    def cuts(self, largest: float, radius: float) -> list[float]:
        """Return distances from the edge between which the pressure is smooth.

        Parameters
        ----------
        largest : float
            The largest pressure, at which the layer has its smallest compliance.
        radius : float
            What `radius` returns.
        """
        inner = list(_CUTS) if endless(self.scene) else []
        if not 0.0 < largest < np.inf:
            return inner
        # the edge layer is as wide as the compliance, 1/slope, over the radius
        slope = float(self.law._slope(np.array(self.law._overclosure(largest))))
        finest = 1.0 / max(slope * radius, 1.0)
        return [*inner, *(10.0**-k for k in range(1, 15) if 10.0**-k > finest / 30.0)]

    def bends(self, pressure: Callable[[Array], Array]) -> list[float]:
        """Return distances from the edge at which a pressure passes a knot of the law.

        It is not smooth there.
        """
        sampled = pressure(_DISTANCES)
        found = []
        for knot in self.law._pressure(np.array(self.law.knots)).tolist():

            def excess(d: float, knot: float = knot) -> float:
                return float(pressure(np.array([d]))[0]) - knot

            step = np.diff(np.sign(sampled - knot))
            for k in np.flatnonzero(np.isfinite(step) & (step != 0.0)):
                found.append(float(brentq(excess, *_DISTANCES[k : k + 2], xtol=1e-16)))
        return found

    def overclosures(self, p: Array) -> Array:
        """Return the overclosure of every pressure.

        Where there is no pressure it is that at which the law begins, or for a law without a
        beginning that of the least normal double.
        """
        least = self.law.start if not isinf(self.law.start) else self.law._overclosure(_TINY)
        return np.array([self.law._overclosure(p_i) if p_i > _TINY else least for p_i in p])

    def misfits(self, p: Array, w: Array, residual: Array, size: float) -> Array:
        """Return the distance between surface and punch, relative.

        It is relative to the sum of two lengths: a displacement, and the larger of the pressure and
        the mean pressure over the local stiffness of the layer. For where the layer is soft, a
        small error of the pressure makes a large one of the overclosure.

        Parameters
        ----------
        p, w : ndarray
            Pressures, and the overclosures by the law.
        residual : ndarray
            The distance.
        size : float
            The displacement: the largest of approach, displacements and overclosures, in L.
        """
        with np.errstate(over="ignore"):
            stiffness = np.maximum(self.law._slope(w), _TINY)
            scale = size + np.maximum(p, np.mean(np.abs(p))) / stiffness
        return np.asarray(np.abs(residual) / scale)

    def outside(self, w: Array, size: float, mean: float) -> Array:
        """Return how far the surface outside the contact is where the law has a pressure.

        Parameters
        ----------
        w : ndarray
            Overclosures outside the contact.
        size, mean : float
            A displacement and the mean pressure. The result is an overclosure over the first; for a
            law without a beginning it is the pressure over the second.
        """
        if isinf(self.law.start):
            return np.asarray(self.law._pressure(w) / mean)
        return np.asarray(np.maximum(w - self.law.start, 0.0) / size)
