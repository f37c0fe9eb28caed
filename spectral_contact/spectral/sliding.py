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

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.fields import EDGE, Radius
from spectral_contact.spectral.abel import beyond, fall, far_fall
from spectral_contact.spectral.annulus import FAR_FIT, FAR_NODES, Family, Points, gap
from spectral_contact.spectral.around_rim import OverRadius, around, inside
from spectral_contact.spectral.coupled import moments
from spectral_contact.spectral.jacobi import chebyshev_values
from spectral_contact.spectral.panels import LogPanels

__all__ = ["SlidingDisk", "SlidingFactored"]

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
        self._weighted = weighted
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
        self._over = OverRadius(self.families, degrees[1:])
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
        start = 0
        both: list[NDArray[np.int_]] = []
        top: list[NDArray[np.int_]] = []
        for k in (0, 1, 2, 0):
            index, degrees = self._index[k], self.degrees[k]
            degree, panel = (
                index % (self.panels[k].degree + 1),
                index // (self.panels[k].degree + 1),
            )
            own = panel < len(degrees)
            highest = np.array([*degrees, 0])[np.minimum(panel, len(degrees))]
            for shed, least in ((both, highest - 2), (top, highest - 1)):
                found = own & (degree > np.maximum(least, 0))
                found[-1] = True
                shed.append(start + np.flatnonzero(found))
            start += len(index)
        return np.concatenate(both), np.concatenate(top)

    # transforms

    def _assemble_transforms(self) -> None:
        c, disk, annulus = self.radius.value, self._inside, self._around
        own, above, below = self.panels
        form = own.panels, own.width, own.degree
        nodes, scale = disk.nodes, np.sqrt(self.half)
        #: of the disk, and weights of ``dt / c`` there
        self.nodes, self.node_weights = nodes, disk.weights
        #: at samples on the disk: what is seen of the annulus, and how it falls from the rim
        e = self.radius.square / self.half * nodes.samples
        plain, falls = fall(e, *annulus.forms[0])
        far, split = self._far_fall(e), annulus.split
        self._falls = scale * np.hstack([falls, far])
        # what lies deeper than a node is far hardly seen there, which no difference can tell
        second = (
            annulus.at_rim[annulus.index[split:]]
            - far[:, annulus.within[split:] - annulus.over_split]
        )
        self._plain = scale * np.hstack([plain[:, annulus.within[:split]], second])
        self._at_rim = scale * annulus.at_rim
        #: above the rim: t, t - c, and by how much less is seen of the disk, at samples
        step = self.half * annulus.above.d
        t = np.sqrt(self.radius.square + step)
        falls = c * fall(self.half / self.radius.square * annulus.above.samples, *disk.form)[1]
        self._above = t, step / (t + c), falls
        above_weights = self.half * annulus.above.weights / (2.0 * np.pi * t)
        #: below the edge: t, and what is seen of the disk, as Chebyshev series
        t = np.sqrt(1.0 - self.half * annulus.below.d)
        depth = self.half / self.radius.square * (2.0 - (1.0 + FAR_NODES) / 2.0)
        self._below = t, c * FAR_FIT @ beyond(depth, *form)[:, disk.index]
        self._below_weights = self.half * annulus.below.weights / (2.0 * np.pi * t)
        self._weights = disk.weights * c / np.pi
        self._shear_weights = self._weights * self.radius.square * nodes.rest
        reach = min(self.radius.square, self.half)
        closer = np.maximum(reach / (self.radius.square * nodes.d), 1.0)
        if self._weighted[0]:
            self._weights = self._weights * closer
            above_weights *= np.maximum(reach / (self.half * annulus.above.d), 1.0)
        if self._weighted[1]:
            self._shear_weights = self._shear_weights * closer
        self._above_weights = above_weights
        extents = 0.5 * self.radius.square, 0.5 * self.half, 0.5 * self.half
        parts = [
            e * moments(p)[k] for e, p, k in zip(extents, self.panels, self._index, strict=True)
        ]
        #: ``int p s ds``, ``int q ds`` of the disk, and ``int p ds`` of the annulus
        self.load, self._pull = np.concatenate(parts), parts[0]
        around_moments = 0.5 * self.half * np.concatenate([moments(above), moments(below)])
        self._drag = self._over.after(around_moments[None, annulus.over])[0]
        self.shear_moments = 2.0 * np.pi * c**3 * (disk.weights * disk.root) @ disk.half

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

    # matrices

    @cached_property
    def _masses(self) -> tuple[list[Array], Array]:
        """Masses of the pressure's parts, and of the traction."""
        extents = 0.5 * self.radius.square, 0.5 * self.half, 0.5 * self.half
        masses = [
            e * p.mass(k, 1.0, 0.0) if p.power == 0.0 else np.zeros((len(k), len(k)))
            for e, p, k in zip(extents, self.panels, self._index, strict=True)
        ]
        return masses, self.radius.value**4 * self.panels[0].mass(self._index[0], 0.5, -0.5)

    def matrix(self, alpha: float, beta: float, kappa: float, friction: float) -> Array:
        """Return the matrix of both equations; parameters are those of `factor`.

        It is that of `residual` but for roundings.
        """
        n, c, scale = self.inside, self.radius.value, np.sqrt(self.half)
        disk, annulus = self._inside, self._around
        m = n + annulus.split
        matrix = np.zeros((self.unknowns, self.unknowns))
        around_half = self.nodes.spread(self._plain)
        fall_over = self.nodes.spread(self._falls)
        tests = (
            (np.hstack([c * disk.half, around_half]), self._weights, 0),
            (scale * annulus.half, self._above_weights, n),
            (scale * annulus.edge_half, self._below_weights, m),
        )
        tested = np.zeros(self.count)
        # t I(t) at all nodes: of the disk, and of what lies inside on the annulus
        t, _, falling = self._above
        t_below, seen = self._below
        of_disk = (
            c**2 * disk.root[:, None] * (disk.rise + disk.start),
            t[:, None] * (c * disk.start - annulus.above.spread(falling)),
            t_below[:, None] * (annulus.smooth_below @ seen),
        )
        of_slip = None, t[:, None] * annulus.inner, t_below[:, None] * annulus.edge_inner
        for (test, weights, start), stuck, slip in zip(tests, of_disk, of_slip, strict=True):
            root = test * np.sqrt(weights)[:, None]
            rows = slice(start, self.count)
            matrix[rows, rows] += root.T @ root
            weighted = (test * weights[:, None]).T
            matrix[rows, self.count :] += 2.0 * kappa * (weighted @ stuck)
            tested[rows] += weighted.sum(axis=1)
            if slip is not None:
                swept = self._over.after(weighted @ slip)
                matrix[rows, n : self.count] += 2.0 * kappa * friction * scale * swept
        pull = np.concatenate([friction * self._drag, self._pull])
        matrix[: self.count, n:] -= np.outer(2.0 * kappa * tested, pull)
        weighted = (disk.half * (c * self._shear_weights[:, None])).T
        root = disk.root[:, None]
        far = np.outer(self.nodes.d / (disk.root * (1.0 + disk.root)), disk.start)
        matrix[self.count :, :n] = -2.0 * kappa * (weighted @ (disk.rise / root + far))
        matrix[self.count :, n : self.count] = -friction * self._over.after(weighted @ fall_over)
        matrix[self.count :, self.count :] = weighted @ (c * disk.half)
        masses, shear_mass = self._masses
        begin = 0
        for mass in masses:
            rows = slice(begin, begin + len(mass))
            matrix[rows, rows] += alpha * mass
            begin = rows.stop
        matrix[self.count :, self.count :] += beta * shear_mass
        return matrix

    def balance(self, kappa: float, friction: float) -> Array:
        """Return ``kappa R(c) - f int_c^1 p ds / sqrt(s^2 - c^2)`` as a functional of vectors."""
        row = np.zeros(self.unknowns)
        row[: self.inside] = 2.0 * kappa * self._inside.start
        row[self.inside : self.count] = (
            -friction * self._over.after(self._at_rim[None, self._around.over])[0]
        )
        return row

    def from_disk(self, points: Points, own: Array) -> Array:
        """Return ``int_0^c s p ds / sqrt(t^2 - s^2)`` outside the disk, for columns."""
        panels = self.panels[0]
        depth = -points.before(self.radius) / self.radius.square
        values = beyond(depth, panels.panels, panels.width, panels.degree) @ own
        return np.asarray(self.radius.value * values)

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
        over = self._over.of(around[self._around.index])
        return inner, halves[:, self._around.over] @ over

    def factor(self, alpha: float, beta: float, kappa: float, friction: float) -> SlidingFactored:
        """Factor the system.

        Parameters
        ----------
        alpha, beta : float
            Compliances, at least 0.
        kappa : float
            The coupling.
        friction : float
            ``q/p`` on the annulus.
        """
        return SlidingFactored(self, alpha, beta, kappa, friction)

    def misfit(
        self, values: Array, kappa: float, friction: float, approach: Array, lift: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return W on the disk, above its rim and below the edge, and E on the disk, at the nodes.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
        kappa, friction : float
        approach, lift : ndarray, shape (k,)
            delta, and ``E(c)``.
        """
        n, c, disk, annulus = self.inside, self.radius.value, self._inside, self._around
        p, slipping, u = values[:n], values[n : self.count], values[self.count :]
        scale, over = np.sqrt(self.half), self._over.of(slipping)
        start_u, start_p = disk.start @ u, disk.start @ p
        pull = self._pull @ u + friction * (self._drag @ slipping)
        bearing = self._at_rim[annulus.index] @ slipping
        at_rim = 2.0 * approach + kappa * 2.0 * (pull - c**2 * start_u) - bearing
        d, root = self.nodes.d[:, None], disk.root[:, None]
        swept = root * (disk.rise @ u) - start_u * (d / (1.0 + root))
        within = at_rim - 2.0 * kappa * c**2 * swept - c * (disk.half @ p)
        falls = np.zeros((len(over), 2 * values.shape[1]))
        falls[annulus.within, : values.shape[1]] = slipping
        falls[:, values.shape[1] :] = over
        fall, fall_over = np.hsplit(self.nodes.spread(self._falls @ falls), 2)
        within += fall
        drive = (disk.rise @ p) / root + start_p * (d / (root * (1.0 + root)))
        lacking = lift + 2.0 * kappa * drive + friction * fall_over
        lacking -= c * (disk.half @ u)
        t, step, falling = self._above
        t, step = t[:, None], step[:, None]
        swept = friction * scale * (annulus.inner @ over[: annulus.over_split])
        swept -= annulus.above.spread(falling @ u)
        above = at_rim - 2.0 * kappa * (t * swept + step * (c * start_u))
        above -= scale * (annulus.rise @ slipping)
        t, seen = self._below
        swept = annulus.smooth_below @ (seen @ u) + friction * scale * (annulus.edge_inner @ over)
        below = at_rim - 2.0 * kappa * (t[:, None] * swept - c**2 * start_u) + bearing
        below -= scale * (annulus.edge_half @ slipping[annulus.split :])
        return within, above, below, lacking

    def residual(
        self,
        values: Array,
        alpha: float,
        beta: float,
        kappa: float,
        friction: float,
        approach: Array,
        lift: Array,
    ) -> Array:
        """Return what both equations miss, tested with all functions; see `misfit`."""
        n, scale = self.inside, np.sqrt(self.half)
        disk, annulus = self._inside, self._around
        m = n + annulus.split
        within, above, below, lacking = self.misfit(values, kappa, friction, approach, lift)
        missed = np.zeros_like(values)
        within *= self._weights[:, None]
        above *= scale * self._above_weights[:, None]
        below *= scale * self._below_weights[:, None]
        lacking *= self.radius.value * self._shear_weights[:, None]
        missed[:n] = self.radius.value * (disk.half.T @ within)
        missed[n : self.count] = (
            self._plain.T @ self.nodes.gathered(within) + annulus.half.T @ above
        )
        missed[m : self.count] += annulus.edge_half.T @ below
        missed[self.count :] = disk.half.T @ lacking
        masses, shear_mass = self._masses
        if alpha:
            start = 0
            for mass in masses:
                rows = slice(start, start + len(mass))
                missed[rows] -= alpha * (mass @ values[rows])
                start = rows.stop
        if beta:
            missed[self.count :] -= beta * (shear_mass @ values[self.count :])
        return missed


class SlidingFactored:
    """Partial slip with coupling in one space, factored."""

    def __init__(
        self, disk: SlidingDisk, alpha: float, beta: float, kappa: float, friction: float
    ) -> None:
        self.disk = disk
        self.parameters = alpha, beta, kappa, friction
        matrix = disk.matrix(alpha, beta, kappa, friction)
        self.scale = 1.0 / np.sqrt(np.abs(matrix.diagonal()))
        matrix *= self.scale
        matrix *= self.scale[:, None]
        self._factor = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def step(self, right: Array) -> Array:
        """Return the solution as factored, of right-hand sides as columns."""
        scale = self.scale[:, None]
        step = lu_solve(self._factor, right * scale, check_finite=False)
        return np.asarray(step * scale)

    def start(self) -> Array:
        """Return the solutions for unit approach and, with compliance, for a unit lift.

        They are columns, and not corrected.
        """
        columns = 2 if self.parameters[1] else 1
        return self.correction(np.zeros((self.disk.unknowns, columns)))

    def correction(self, values: Array, disk: SlidingDisk | None = None) -> Array:
        """Return by how much the solutions are off, from their misfits.

        Parameters
        ----------
        values : ndarray
            As `start` returns them.
        disk : SlidingDisk, optional
            Another disk, hardly larger or smaller, whose solutions they are.
        """
        disk = disk or self.disk
        columns = np.eye(2)[:, : values.shape[1]]
        return self.step(disk.residual(values, *self.parameters, columns[0], columns[1]))

    def change(self, values: Array, disk: SlidingDisk | None = None) -> list[Array]:
        """Return what the top two degrees of every panel, and the top one, contribute.

        They are the differences to the solutions without them, as columns.
        """
        disk = disk or self.disk
        both, top = disk.shed
        right = np.zeros((disk.unknowns, len(both)))
        right[both, np.arange(len(both))] = 1.0
        response = self.step(right)
        changes = []
        for shed in (both, top):
            columns = response[:, np.isin(both, shed)]
            own = columns[shed] / self.scale[shed, None] / self.scale[shed]
            forces = np.linalg.solve(own, values[shed] / self.scale[shed, None])
            forces /= self.scale[shed, None]
            change, nothing = columns @ forces, np.zeros(values.shape[1])
            missed = disk.residual(change, *self.parameters, nothing, nothing)
            missed[shed] += forces
            changes.append(change + self.step(missed))
        return changes
