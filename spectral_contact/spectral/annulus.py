"""Functions on an annulus: two families of logarithmic panels, one to each end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.blocks import across
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, gap
from spectral_contact.spectral.transforms import transforms
from spectral_contact.threads import cached_property


@dataclass(frozen=True)
class Annulus:
    """An annulus with a family of panels to each end.

    Attributes
    ----------
    inner, outer : Radius
    toward_inner, toward_outer : LogPanels
        Panels of the two halves.
    """

    inner: Radius
    outer: Radius
    toward_inner: LogPanels
    toward_outer: LogPanels

    @cached_property
    def families(self) -> tuple[GradedMesh, GradedMesh]:
        """The two halves: above the inner end, below the outer end."""
        half = gap(self.inner, self.outer) / 2.0
        return (
            GradedMesh(self.inner, 1, half, self.toward_inner),
            GradedMesh(self.outer, -1, half, self.toward_outer),
        )

    @cached_property
    def y(self) -> Array:
        """``1 - s**2`` at the sampling points of both halves."""
        return np.concatenate([one.sampling().y for one in self.families])

    def halves(self, values: Array) -> list[Array]:
        """Return values (..., points) at the sampling points of either half."""
        inner = len(self.toward_inner.distances)
        return [values[..., :inner], values[..., inner:]]

    def integrals(self, values: Sequence[Array], side: int) -> list[Array]:
        """Return integrals of functions at their own sampling points, on either half.

        The half-integral, over what lies outside of the points (+1), or the inner integral (-1), of
        values (..., points). In scaled distances the transforms depend on the panels alone.
        """
        each, found = [f.expand(v) for f, v in zip(self.families, values, strict=True)], []
        for k, family in enumerate(self.families):
            own, away = transforms(family.panels), (k == 0) == (side > 0)
            seen = own.abel_left(each[k]) if away else own.abel_right(each[k])
            found.append(np.sqrt(family.reach) * seen)
            if away:  # one half sees the other, too
                found[k] += across(each[1 - k], self.families[1 - k], family, side)
        return found
