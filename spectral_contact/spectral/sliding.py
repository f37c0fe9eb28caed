r"""Elastic coupling with a stick disk and a slip annulus: one unsymmetric system for p and q.

The pressure is unknown everywhere, the traction on the disk, ``q = s u``; on the annulus it is
``f p``. The pressure has panels to the rim from both sides and to the edge. The equations are those
of `coupled`, the normal one on the whole contact and the tangential one on the disk alone:

    alpha p + N p - kappa int_s^1 q deta = delta,    beta q + T q - kappa g = 0,

with what the slipping traction adds to both. It enters as ``f p / s`` times s, so the factor 1/s is
expanded panel by panel. What the first-kind parts lose next to the rim is restored by corrections
with the residual in the half-integrals. With ``F``, ``G`` those of p and q and

    W(t) = 2 delta + 2 kappa (int_0^1 q ds - t I(t)) - F(t),    E(t) = kappa R(t) - G(t),
    I(t) = int_0^t q ds / sqrt(t^2 - s^2),    R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2),

both are taken as their value at the rim and a difference to it, in which nothing cancels. An error
of ``W(c)`` is one of delta. ``E(c)``, which is small or zero, is an unknown of its own, the `lift`:
it makes the traction continuous. That it is what p makes it is the condition of the radius.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.abel import fall, far_fall
from spectral_contact.spectral.annulus import FAR_FIT, FAR_NODES, Family, Points, gap
from spectral_contact.spectral.around_rim import Around, Inside, OverRadius, around, inside
from spectral_contact.spectral.jacobi import (
    chebyshev_values,
)
from spectral_contact.spectral.panels import LogPanels, top_functions
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.transforms import transforms
from spectral_contact.threads import cached_property

__all__ = ["SlidingDisk"]

Array = NDArray[np.float64]
Degrees = tuple[int, ...]


class SlidingDisk:
    """The operators of a disk that sticks and of the annulus around it, to the edge.

    Vectors hold the coefficients of the pressure on the disk, above its rim, and below the edge,
    then those of ``u = q/s`` on the disk.

    Parameters
    ----------
    radius : Radius
        Rim of the disk.
    panels : tuple of LogPanels
        Of both fields on the disk, and of the pressure above the rim and below the edge.
    degrees : tuple of tuple of int
        Highest degrees on the panels of each.
    weighted : tuple of bool
        Whether the normal and the tangential equation are without compliance: they are of the
        first kind then, with misfits that vanish, and count by the inverse distance from the rim.
        Else what is missed far away would spoil what is next to it.
    """

    def __init__(
        self,
        radius: Radius,
        panels: tuple[LogPanels, LogPanels, LogPanels],
        degrees: tuple[Degrees, Degrees, Degrees],
        weighted: tuple[bool, bool] = (False, False),
    ) -> None:
        self.radius, self.panels, self.degrees = radius, panels, degrees
        self.weighted = weighted
        self.half = gap(radius, EDGE) / 2.0
        own, above, below = panels
        self.families = (
            Family(radius, 1, self.half, above),
            Family(EDGE, -1, self.half, below),
        )
        self._inside = inside(own, degrees[0])
        self._around = around(above, below, degrees[1], degrees[2])
        split, used = self._around.split, self._around.index
        self._index = [self._inside.index, used[:split], used[split:] - above.size]
        self.inside = len(self._index[0])
        #: number of unknowns of the pressure
        self.count = self.inside + len(used)
        self.over = OverRadius(self.families, degrees[1:])
        self._assemble_transforms()

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.count + self.inside

    def split(self, values: Array) -> tuple[Array, Array, Array, Array]:
        """Return the coefficients in the whole bases of the parts of a vector."""
        n = self.inside
        bounds = np.cumsum([n, *map(len, self._index[1:])])
        parts = [*np.split(values[: self.count], bounds[:-1]), values[self.count :]]
        full = []
        for part, k in zip(parts, (0, 1, 2, 0), strict=True):
            whole = np.zeros((self.panels[k].size, *values.shape[1:]))
            whole[self._index[k]] = part
            full.append(whole)
        return full[0], full[1], full[2], full[3]

    @cached_property
    def shed(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Places in a vector of the top two degrees of every panel, and of the top one."""
        parts = [(self.panels[k], self.degrees[k]) for k in (0, 1, 2, 0)]
        return top_functions(parts, 2), top_functions(parts, 1)

    # transforms

    @property
    def transforms(self) -> tuple[Inside, Around]:
        """Transforms of the disk and of the annulus at their own nodes."""
        return self._inside, self._around

    def _assemble_transforms(self) -> None:
        c, disk, annulus = self.radius.value, self._inside, self._around
        nodes, scale = disk.nodes, np.sqrt(self.half)
        #: of the disk, and weights of ``dt / c`` there
        self.nodes, self.node_weights = nodes, disk.weights
        #: at samples on the disk: what is seen of the annulus, and how it falls from the rim
        e = self.radius.square / self.half * nodes.samples
        plain, falls = fall(e, *annulus.forms[0])
        far, split = self._far_fall(e), annulus.split
        self.falls = scale * np.hstack([falls, far])
        # what lies deeper than a node is far hardly seen there, which no difference can tell
        second = (
            annulus.at_rim[annulus.index[split:]]
            - far[:, annulus.within[split:] - annulus.over_split]
        )
        self.plain = scale * np.hstack([plain[:, annulus.within[:split]], second])
        self._at_rim = scale * annulus.at_rim
        #: above the rim: t, t - c, and by how much less is seen of the disk, at samples
        step = self.half * annulus.above.d
        t = np.sqrt(self.radius.square + step)
        falls = c * fall(self.half / self.radius.square * annulus.above.samples, *disk.form)[1]
        self.above = t, step / (t + c), falls
        #: below the edge: t, and what is seen of the disk, as Chebyshev series
        t = np.sqrt(1.0 - self.half * annulus.below.d)
        depth = self.half / self.radius.square * (2.0 - (1.0 + FAR_NODES) / 2.0)
        self.below = t, c * FAR_FIT @ fall(depth, *disk.form)[0]
        #: ``int p s ds``, ``int q ds`` of the disk, and ``int p ds`` of the annulus
        own_load, around_load = 0.5 * c**2 * disk.moments, 0.5 * self.half * annulus.moments
        self.load = np.concatenate([own_load, around_load[annulus.within]])
        self.pull, self.drag_over = own_load, around_load
        self.drag = self.over.after(self.drag_over[None])[0]
        self.shear_moments = 2.0 * np.pi * c**3 * (disk.weights * disk.root) @ disk.half

    @cached_property
    def weights(self) -> tuple[Array, Array, Array, Array]:
        """Of the normal equation on the disk, above its rim and below the edge; of the other."""
        disk, annulus, square = self._inside, self._around, self.radius.square
        on_disk = disk.weights * self.radius.value / np.pi
        above = self.half * annulus.above.weights / (2.0 * np.pi * self.above[0])
        below = self.half * annulus.below.weights / (2.0 * np.pi * self.below[0])
        shear = on_disk * square * self.nodes.rest
        reach = min(square, self.half)
        closer = np.maximum(reach / (square * self.nodes.d), 1.0)
        if self.weighted[0]:
            on_disk = on_disk * closer
            above *= np.maximum(reach / (self.half * annulus.above.d), 1.0)
        if self.weighted[1]:
            shear = shear * closer
        return on_disk, above, below, shear

    def _far_fall(self, e: Array) -> Array:
        """Return the `far_fall` of the outer half, interpolated where it is a polynomial over e."""
        form, near = self._around.forms[1], e <= 1.0
        nodes = (1.0 + FAR_NODES) / 2.0
        fit = FAR_FIT @ (far_fall(nodes, *form) / nodes[:, None])
        values = np.empty((len(e), fit.shape[1]))
        values[~near] = far_fall(e[~near], *form)
        table = chebyshev_values(2.0 * e[near] - 1.0, len(fit) - 1)
        values[near] = e[near, None] * (table @ fit)
        return values

    @cached_property
    def masses(self) -> tuple[Array, Array, Array, Array]:
        """Masses of the pressure's parts, and of the traction."""
        normal, tangential = self._inside.masses
        above, below = self._around.masses
        c, half = self.radius.value, 0.5 * self.half
        return 0.5 * c**2 * normal, half * above, half * below, c**4 * tangential

    def balance(self, parameters: Parameters) -> Array:
        """Return ``kappa R(c) - f int_c^1 p ds / sqrt(s^2 - c^2)`` as a functional of vectors."""
        row = np.zeros(self.unknowns)
        row[: self.inside] = 2.0 * parameters.kappa * self._inside.start
        row[self.inside : self.count] = (
            -parameters.friction * self.over.after(self._at_rim[None, self._around.over])[0]
        )
        return row

    def from_disk(self, own: Array, panels: tuple[LogPanels, LogPanels]) -> tuple[Array, Array]:
        """Return ``int_0^c s p ds / sqrt(t^2 - s^2)`` on the annulus, for columns.

        Above the rim and below the edge, at the sampling points of these panels.
        """
        disk, c = self._inside, self.radius.value
        values = own[disk.index]
        near = transforms(panels[0])
        e = self.half / self.radius.square * near.coarse
        above = near.interpolate(c * (fall(e, *disk.form)[0] @ values).T).T
        chebyshev = chebyshev_values(
            2.0 * transforms(panels[1]).distances - 1.0, len(FAR_NODES) - 1
        )
        return above, chebyshev @ (self.below[1] @ values)

    def from_annulus(self, points: Points, around: Array) -> tuple[Array, Array]:
        """Return what the pressure of the annulus contributes outside the disk.

        Parameters
        ----------
        points : Points
        around : ndarray
            Coefficients in the whole bases of its halves, columns.

        Returns
        -------
        inner, halves : ndarray
            ``int_c^t s p ds / sqrt(t^2 - s^2)`` and ``int_t^1 p ds / sqrt(s^2 - t^2)``.
        """
        inner = np.hstack([one.inner_integral(points) for one in self.families]) @ around
        halves = np.hstack([one.half_integral(points) for one in self.families])
        over = self.over.of(around[self._around.index])
        return inner, halves[:, self._around.over] @ over

    def misfit(
        self, values: Array, parameters: Parameters, approach: Array, lift: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return W on the disk, above its rim and below the edge, and E on the disk, at the nodes.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
        parameters : Parameters
        approach, lift : ndarray, shape (k,)
            delta, and ``E(c)``.
        """
        n, c, disk, annulus = self.inside, self.radius.value, self._inside, self._around
        _, _, kappa, friction = parameters
        p, slipping, u = values[:n], values[n : self.count], values[self.count :]
        scale, over = np.sqrt(self.half), self.over.of(slipping)
        start_u, start_p = disk.start @ u, disk.start @ p
        pull = self.pull @ u + friction * (self.drag @ slipping)
        bearing = self._at_rim[annulus.index] @ slipping
        at_rim = 2.0 * approach + kappa * 2.0 * (pull - c**2 * start_u) - bearing
        d, root = self.nodes.d[:, None], disk.root[:, None]
        swept = root * (disk.rise @ u) - start_u * (d / (1.0 + root))
        within = at_rim - 2.0 * kappa * c**2 * swept - c * (disk.half @ p)
        falls = np.zeros((len(over), 2 * values.shape[1]))
        falls[annulus.within, : values.shape[1]] = slipping
        falls[:, values.shape[1] :] = over
        fall, fall_over = np.hsplit(self.nodes.spread(self.falls @ falls), 2)
        within += fall
        drive = (disk.rise @ p) / root + start_p * (d / (root * (1.0 + root)))
        lacking = lift + 2.0 * kappa * drive + friction * fall_over
        lacking -= c * (disk.half @ u)
        t, step, falling = self.above
        t, step = t[:, None], step[:, None]
        swept = friction * scale * (annulus.inner @ over[: annulus.over_split])
        swept -= annulus.above.spread(falling @ u)
        above = at_rim - 2.0 * kappa * (t * swept + step * (c * start_u))
        above -= scale * (annulus.rise @ slipping)
        t, seen = self.below
        swept = annulus.smooth_below @ (seen @ u) + friction * scale * (annulus.edge_inner @ over)
        below = at_rim - 2.0 * kappa * (t[:, None] * swept - c**2 * start_u) + bearing
        below -= scale * (annulus.edge_half @ slipping[annulus.split :])
        return within, above, below, lacking

    def residual(
        self, values: Array, parameters: Parameters, approach: Array, lift: Array
    ) -> Array:
        """Return what both equations miss, tested with all functions; see `misfit`."""
        n, scale = self.inside, np.sqrt(self.half)
        disk, annulus = self._inside, self._around
        m = n + annulus.split
        within, above, below, lacking = self.misfit(values, parameters, approach, lift)
        missed = np.zeros_like(values)
        on_disk, on_above, on_below, shear = (one[:, None] for one in self.weights)
        within *= on_disk
        above *= scale * on_above
        below *= scale * on_below
        lacking *= self.radius.value * shear
        missed[:n] = self.radius.value * (disk.half.T @ within)
        missed[n : self.count] = self.plain.T @ self.nodes.gathered(within) + annulus.half.T @ above
        missed[m : self.count] += annulus.edge_half.T @ below
        missed[self.count :] = disk.half.T @ lacking
        start = 0
        alpha, beta, _, _ = parameters
        for mass, compliance in zip(self.masses, (alpha, alpha, alpha, beta), strict=True):
            rows = slice(start, start + len(mass))
            if compliance:
                missed[rows] -= compliance * (mass @ values[rows])
            start = rows.stop
        return missed
