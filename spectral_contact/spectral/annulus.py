"""Functions on an annulus, as the displacement in a slip zone: two halves with a mesh each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.blocks import abel_integral_on
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, z_difference
from spectral_contact.spectral.transforms import transforms
from spectral_contact.threads import cached_property


@dataclass(frozen=True)
class Annulus:
    """An annulus with panels graded to either end; its halves meet at the middle in ``s**2``.

    Attributes
    ----------
    inner, outer : Radius
        The ends of the annulus.
    toward_inner, toward_outer : LogPanels
        Panels of the two halves, graded to the inner and to the outer end; without endpoint weight
        or root tail.
    """

    inner: Radius
    outer: Radius
    toward_inner: LogPanels
    toward_outer: LogPanels

    @cached_property
    def meshes(self) -> tuple[GradedMesh, GradedMesh]:
        """The meshes of the two halves: outside the inner end, inside the outer end."""
        half = z_difference(self.inner, self.outer) / 2.0
        return (
            GradedMesh(self.inner, 1, half, self.toward_inner),
            GradedMesh(self.outer, -1, half, self.toward_outer),
        )

    @cached_property
    def y(self) -> Array:
        """``1 - s**2`` at the sampling points of both halves."""
        return np.concatenate([mesh.sampling().y for mesh in self.meshes])

    def split(self, values: Array) -> list[Array]:
        """Return values (..., points) at the sampling points of the inner and the outer half."""
        count = len(self.toward_inner.sampling_distances)
        return [values[..., :count], values[..., count:]]

    def integrals(self, values: Sequence[Array], side: int) -> list[Array]:
        """Return Abel integrals of a function f on the annulus at its sampling points t.

        They are ``1/2 int f dz / sqrt(|z - t**2|)`` with ``z = s**2``, over radii s of the annulus
        on one side of t.

        Parameters
        ----------
        values : sequence of ndarray, shape (..., points)
            Values of the function at the sampling points of either half.
        side : int
            +1 for radii outside of t, -1 for radii inside of t.

        Returns
        -------
        list of ndarray, shape (..., points)
            On either half.
        """
        coefficients = [mesh.expand(half) for mesh, half in zip(self.meshes, values, strict=True)]
        integrals = []
        for k, mesh in enumerate(self.meshes):
            of_panels = transforms(mesh.panels)
            # whether the radii on this side include the other half
            away = (k == 0) == (side > 0)
            if away:
                unit = of_panels.abel_left(coefficients[k])
            else:
                unit = of_panels.abel_right(coefficients[k])
            # in distances scaled by the extent an integral depends on the panels alone
            integral = np.sqrt(mesh.extent) * unit
            if away:
                other = 1 - k
                integral += abel_integral_on(mesh, self.meshes[other], coefficients[other], side)
            integrals.append(integral)
        return integrals
