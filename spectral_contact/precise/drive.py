"""The pressure in fixed point, and the half-integral R that full stick demands for it."""

from __future__ import annotations

from typing import Any

import numpy as np

from spectral_contact.precise.disk import Disk, FarField, PreciseSeries
from spectral_contact.precise.fixed import Fixed, Ints
from spectral_contact.scene import Scene
from spectral_contact.spectral.tuning import TAIL_TERMS
from spectral_contact.threads import cached_property


def coupling_constant(scene: Scene, fixed: Fixed) -> Any:
    """Return kappa to all digits from the Poisson's ratio, or as a scene of two bodies has it."""
    if scene.mismatch is not None:
        return fixed.mp.mpf(scene.mismatch)
    nu = fixed.mp.mpf(scene.poisson_ratio)
    return (1 - 2 * nu) / (4 * (1 - nu))


class PreciseDrive:
    """The pressure for unit load, and the integrals of it that the tangential problem needs.

    One of these is R, the value that the half-integral of the traction has in full stick for
    ``kappa = 1`` (docs/theory).
    """

    fixed: Fixed
    approach: Any
    #: whether p is infinite at the edge
    singular = False

    def pressure(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return p at ``y = 1 - s**2``."""
        raise NotImplementedError

    def target(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return R at ``y = 1 - t**2``."""
        raise NotImplementedError

    def outside(self, top: Any) -> tuple[Ints, Ints]:
        """Return points ``y < top`` and weights of ``1/2 int_0^top p f dy`` for functions f."""
        raise NotImplementedError

    def load_inside(self, y: Ints) -> Ints:
        """Return ``int_0^s p s ds`` at ``y = 1 - s**2``."""
        raise NotImplementedError

    def release(self) -> None:
        """Let go of the operators; p and R stay."""


class SmoothDrive(PreciseDrive):
    """The pressure ``1/(2 pi sqrt(y))`` of a surface that is smooth in normal contact."""

    singular = True

    def __init__(self, fixed: Fixed, digits: int) -> None:
        self.fixed = fixed
        self.approach = fixed.one // 8
        self._points = 2 * digits + 12
        self._tau = 2 * fixed.of(fixed.mp.pi)

    def pressure(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return p at ``y = 1 - s**2``."""
        f = self.fixed
        return np.asarray(f.over(f.over(f.one, self._tau), f.sqrt(y)))

    def target(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return ``ln((1 + t)^2/y) / (2 pi t)``."""
        f = self.fixed
        t = f.sqrt(f.one - y)
        return np.asarray(f.over(2 * f.map(f.mp.atanh, t), f.times(self._tau, t)))

    def outside(self, top: Any) -> tuple[Ints, Ints]:
        """Return points ``y < top`` and weights of ``1/2 int_0^top p f dy`` for functions f."""
        f = self.fixed
        g, w = f.gauss(self._points)
        root = f.sqrt(top)
        v = f.times(root, f.one + g) // 2
        return f.times(v, v), f.over(f.times(root, w) // 2, self._tau)

    def load_inside(self, y: Ints) -> Ints:
        """Return ``int_0^s p s ds`` at ``y = 1 - s**2``."""
        f = self.fixed
        return np.asarray(f.over(f.one - f.sqrt(y), self._tau))


class RoughDrive(PreciseDrive):
    """The pressure of a rough surface.

    Parameters
    ----------
    disk : Disk
    compliance : int
        ``alpha*`` in fixed point, positive.
    """

    def __init__(self, disk: Disk, compliance: Any) -> None:
        self.fixed = disk.fixed
        self._disk = disk
        f = self.fixed
        unit = disk.solve(compliance, 2 * f.one, tangential=False)
        # the load is 2 pi int p s ds = 4 int F dt
        load = 4 * f.dot(disk.weights, disk.half_integral(unit))
        self.approach = f.over(f.one, load)
        self._coefficients = f.times(unit, self.approach)
        self.series = disk.series(self._coefficients)
        self._target = self._transformed()

    def pressure(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return p at ``y = 1 - s**2``."""
        return self.series.at(y, x)

    def target(self, y: Ints, x: Ints | None = None) -> Ints:
        """Return R at ``y = 1 - t**2``."""
        return self._target.at(y, x)

    def outside(self, top: Any) -> tuple[Ints, Ints]:
        """Return points ``y < top`` and weights of ``1/2 int_0^top p f dy`` for functions f."""
        f = self.fixed
        (table, tail) = self._disk.split(self._coefficients)
        h = f.of(self.series.width)
        shallowest = -f.map(f.mp.log, top)
        first = int(shallowest // h)
        g, w = f.gauss(self._disk.rule_points)
        y = []
        weights = []
        for j in range(first, len(table)):
            low = max(shallowest, j * h)
            high = (j + 1) * h
            x = low + f.times(high - low, f.one + g) // 2
            local = 2 * f.over(x - j * h, h) - f.one
            p = f.series(local, table[j])
            y.append(f.exp(-x))
            weights.append(f.times(w, high - low, y[-1], p) // 4)
        g, w = f.gauss(TAIL_TERMS + 2)
        end = min(f.exp(-len(table) * h), top)
        y.append(f.times(end, f.one + g) // 2)
        local = 2 * f.over(y[-1], f.exp(-len(table) * h)) - f.one
        weights.append(f.times(w, end, f.series(local, tail)) // 4)
        return np.concatenate(y), np.concatenate(weights)

    def load_inside(self, y: Ints) -> Ints:
        """Return ``int_0^s p s ds`` at ``y = 1 - s**2``."""
        f = self.fixed
        return np.asarray(f.over(f.one, 2 * f.of(f.mp.pi)) - f.times(y, self._mean.at(y)) // 2)

    @cached_property
    def _mean(self) -> PreciseSeries:
        """``(1/y) int_0^y p dy``, the mean of the pressure on the annulus outside a radius."""
        f = self.fixed
        series = self.series
        h = f.of(series.width)
        (count, terms) = series.table.shape
        # in the tail p is a polynomial, and so is its mean
        points = len(series.tail)
        g, w = f.gauss(points)
        v = (f.one + g) // 2
        tail = f.moments(w // 2, 2 * f.times(v[:, None], v) - f.one, points - 1)
        whole = f.dot(w // 2, f.legendre(g, points - 1))
        mean = f.dot(whole, series.tail)
        tail = f.dot(f.expansion(points), f.dot(tail, series.tail))
        # on a panel: the integral from its start and from each of the samples to its deep end
        samples = terms + 12
        g, w = f.gauss(samples)
        start = f.times(h, f.one + f.gauss(samples)[0]) // 2
        lower = np.concatenate([[0 * h], start])[:, None]
        x = lower + f.times(h - lower, f.one + g) // 2
        weights = f.times(w, h - lower, f.exp(lower - x)) // 2
        matrix = f.moments(weights, 2 * f.over(x, h) - f.one, terms - 1)
        fall = f.exp(lower[:, 0] - h)
        table = np.empty((count, samples), dtype=object)
        for j in reversed(range(count)):
            values = f.dot(matrix, series.table[j]) + f.times(fall, mean)
            mean = values[0]
            table[j] = values[1:]
        return PreciseSeries(f, series.width, f.dot(table, f.expansion(samples).T), tail)

    def release(self) -> None:
        """Let go of the operators; p and R stay."""
        del self._disk

    # the transform R

    def _transformed(self) -> PreciseSeries:
        """Return ``R = (2/t) int_0^t s p ds / sqrt(t^2 - s^2)`` as a series."""
        f = self.fixed
        panels = self._disk.panels
        h = f.of(panels.width)
        count = panels.count
        points = self._disk.rule_points
        start = f.times(h, f.one + f.gauss(points)[0]) // 2
        end = f.exp(-count * h)
        d = f.times(end, f.one + f.gauss(TAIL_TERMS + 1)[0]) // 2
        beyond = -f.map(f.mp.log, d) - (count - 1) * h
        # here sources are shallower than the points, and the offsets of points are counted from the
        # starts of their panels
        far_field = FarField(self._disk, f.exp(-start // 2), f.exp(start - h), 0, [start, beyond])
        near = self._outer(start)
        near_tail = self._outer(beyond)
        table, tail = self._disk.split(self._coefficients)
        # the integral scales with the root of the distance at the shallow end of the source
        scaled = [f.times(f.exp(-j * h // 2), table[j]) for j in range(count)]
        far = far_field.zero_sums
        values = np.zeros((count, points), dtype=object)
        for i in range(count):
            if i >= 2:
                far = far_field.at_next_panel(far, scaled[i - 2])
            total = far_field.points[0] @ far
            for block, source in zip(near, scaled[i::-1], strict=False):
                total = total + block @ source
            values[i] = total >> f.bits
        sums = far_field.points[1] @ far
        for block, source in zip(near_tail, scaled[::-1], strict=False):
            sums = sums + block @ source
        x = h * np.arange(count, dtype=object)[:, None] + start
        rest = -f.map(f.mp.expm1, -x)
        values = f.over(2 * values, f.sqrt(rest))
        sums = (sums >> f.bits) + self._outer_tail(d, end, tail)
        sums = f.over(2 * sums, f.sqrt(f.one - d))
        expand = f.expansion(points)
        return PreciseSeries(
            f, panels.width, f.dot(values, expand.T), f.dot(f.expansion(TAIL_TERMS + 1), sums)
        )

    def _outer(self, from_start: Ints) -> list[Ints]:
        """Return ``1/2 int_{d' > d} psi dd'/sqrt(d' - d)`` over a panel itself and the one before.

        This is for a source panel that begins at ``x = 0``. For one that begins at ``x_j`` it is
        ``exp(-x_j/2)`` times as large.
        """
        f = self.fixed
        h = f.of(self._disk.panels.width)
        lower = np.maximum(from_start - h, 0)
        upper = from_start
        blocks = []
        for k in range(2):
            u, weights, _ = self._disk.root_rule(lower, upper)
            offset = from_start[:, None] + k * h - u
            values = f.times(f.exp(-offset // 2), weights)
            local = 2 * f.over(offset, h) - f.one
            blocks.append(f.moments(values, local, self._disk.panels.degree))
            lower = upper
            upper = upper + h
        return blocks

    def _outer_tail(self, d: Ints, end: Any, tail: Ints) -> Ints:
        """Return the integral over the part of the tail with ``d' > d``.

        In ``w``, where ``w^2 = d' - d``, the integrand is a polynomial.
        """
        f = self.fixed
        g, w = f.gauss(TAIL_TERMS + 1)
        span = f.sqrt(end - d)[:, None]
        source = f.times(span, f.one + g) // 2
        source = d[:, None] + f.times(source, source)
        values = f.series(2 * f.over(source, end) - f.one, tail)
        return np.asarray(f.times(values, f.times(span, w) // 2).sum(axis=1))
