"""The traction basis on stick annuli: two families of panels on each, degrees chosen per panel."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import interpolate
from spectral_contact.fields import Radius
from spectral_contact.spectral.annulus import Annulus, Family, Points
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

__all__ = ["StickAnnuli"]

Array = NDArray[np.float64]


class StickAnnuli:
    """Functions ``q = s psi`` on a list of annuli.

    Parameters
    ----------
    annuli : list of Annulus
        Ordered outward.
    degrees : list of list of tuple of int
        For each annulus and each of its two families, the degree on every panel.

    Attributes
    ----------
    columns : ndarray of int
        The functions in use, among those of the full bases of all annuli.
    """

    def __init__(self, annuli: list[Annulus], degrees: list[list[tuple[int, ...]]]) -> None:
        self.annuli = annuli
        self.total = sum(a.size for a in annuli)
        used: list[NDArray[np.int_]] = []
        flat = [d for pair in degrees for d in pair]
        for (family, part), chosen in zip(self.parts(), flat, strict=True):
            terms = family.panels.degree + 1
            starts = part.start + terms * np.arange(family.panels.panels)
            used += [np.arange(i, i + n + 1) for i, n in zip(starts, chosen, strict=True)]
            used.append(np.arange(part.start + terms * family.panels.panels, part.stop))
        self.columns = np.concatenate(used) if used else np.zeros(0, dtype=int)

    def parts(self) -> Iterator[tuple[Family, slice]]:
        """Yield every family with its place in the full basis."""
        start = 0
        for annulus in self.annuli:
            for family in annulus.families:
                yield family, slice(start, start + family.panels.size)
                start += family.panels.size

    def full(self, values: Array) -> Array:
        """Return coefficients of the full bases from those of the functions in use."""
        full = np.zeros(self.total)
        full[self.columns] = values
        return full

    def half_integral(self, points: Points, own: tuple[Annulus, int] | None = None) -> Array:
        """Return the half-integrals of the functions in use, shape (points, columns).

        The points may be nodes of an annulus of these, `own`: of its inner half (0) or outer (1).
        """
        blocks = [
            a.half_integral_at_nodes(own[1]) if own and a is own[0] else a.half_integral(points)
            for a in self.annuli
        ]
        return np.hstack(blocks)[:, self.columns]

    def mass(self) -> Array:
        """Return the mass matrix of the functions in use."""
        matrix = np.zeros((len(self.columns), len(self.columns)))
        for family, part in self.parts():
            used = slice(*np.searchsorted(self.columns, [part.start, part.stop]))
            matrix[used, used] = family.mass(self.columns[used] - part.start)
        return matrix

    def falls(self, panels: LogPanels, rim: Radius) -> tuple[Array, Array]:
        """Return by how much the half-integrals fall from the rim of the disk inward.

        Returns
        -------
        falls : ndarray, shape (nodes, columns)
            At the Galerkin nodes of the disk.
        at_rim : ndarray, shape (columns,)
            The half-integrals at the rim.
        """
        if not self.annuli:
            return np.zeros((len(disk_operators(panels).nodes.d), 0)), np.zeros(0)
        sources = [family.sources() for family, _ in self.parts()]
        above = [-points.before(rim) for points, _ in sources]

        def function(d: Array) -> Array:
            below = rim.square * d[:, None]
            blocks = []
            for (_, matrix), a in zip(sources, above, strict=True):
                root = np.sqrt(below + a)
                kernel = below / (root * (root + np.sqrt(a)))
                blocks.append(kernel @ (matrix / np.sqrt(a)[:, None]))
            return np.hstack(blocks)[:, self.columns]

        at_rim = [(1.0 / np.sqrt(a)) @ m for (_, m), a in zip(sources, above, strict=True)]
        values, _ = interpolate(panels, function)
        return values, np.concatenate(at_rim)[self.columns]
