"""Partial slip outside one stick disk, in fixed point, for ``kappa = 1``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import ConvergenceError
from spectral_contact.precise.fixed import Fixed, Ints
from spectral_contact.threads import cached_property
from spectral_contact.view.progress import silent

if TYPE_CHECKING:
    from spectral_contact.precise.disk import Disk, PreciseSeries
    from spectral_contact.precise.drive import PreciseDrive


_MOST_TRIALS = 8


@dataclass(frozen=True)
class PreciseOneDisk:
    """A stick disk and its traction.

    Attributes
    ----------
    logit : mpf
        ``ln(c^2 / (1 - c^2))``.
    traction : PreciseSeries
        ``q / (s/c)`` as a function of ``1 - s^2/c^2``.
    total_shear : int
    slope : mpf
        Derivative of the mismatch by the logit. The mismatch is zero at the right radius.
    """

    logit: Any
    traction: PreciseSeries
    total_shear: Any
    slope: Any


class _PreciseSlipSource:
    """The half-integral ``int_c^1 p ds/sqrt(s^2 - t^2)`` at points of the stick disk.

    A point is given by ``e = c^2 - t^2``. The slip zone is cut in two. In three quarters of it in
    ``s^2``, next to the rim of the stick disk, p is taken for a polynomial. The integrals of powers
    obey recurrences, each step of which loses some bits: `_wide` has 7 more bits for every term of
    the polynomial. In the quarter next to the edge the kernel is a power series.
    """

    def __init__(self, drive: PreciseDrive, square: Any, rest: Any, digits: int) -> None:
        f = self.fixed = drive.fixed
        self._square = square
        self._rest = rest
        terms = ceil(2.2 * digits) + 12
        self._wide = Fixed(f.bits + 7 * terms)
        self._extra = 7 * terms
        # ds is dz/(2 s): unless the centre, where 1/s has a pole, is near, 1/s is part of the
        # polynomial
        self._folded = 2 * square >= f.one
        w = self._wide
        fit = self._fit(terms)
        self._length = 3 * rest // 4
        y = rest - f.times(self._length, self._samples(terms, f))
        values = drive.pressure(y)
        if self._folded:
            values = f.over(values, f.sqrt(f.one - y))
        self._powers = w.dot(fit, values << self._extra)
        count = ceil(1.7 * digits) + 10
        self._far = self._sums(drive, rest // 4, count)
        # of the whole slip zone, for points far inside a large stick disk
        self._all = self._sums(drive, rest, ceil(2.2 * digits) + 10) if self._folded else None

    @staticmethod
    def _samples(terms: int, f: Fixed) -> Ints:
        """Return the Chebyshev points of [0, 1]."""
        angles = [f.mp.pi * (2 * i + 1) / (2 * terms) for i in range(terms)]
        return np.array([f.of((1 + f.mp.cos(a)) / 2) for a in angles], dtype=object)

    def _fit(self, terms: int) -> Ints:
        """Return the matrix from values at the Chebyshev points to coefficients of powers."""
        w = self._wide
        cosines = [w.of(w.mp.cos(w.mp.pi * i / (2 * terms))) for i in range(4 * terms)]
        k = np.arange(terms)[:, None]
        i = np.arange(terms)[None, :]
        matrix = 2 * np.array(cosines, dtype=object)[(k * (2 * i + 1)) % (4 * terms)] // terms
        matrix[0] //= 2
        powers = np.zeros((terms, terms), dtype=object)  # of the shifted polynomials, exact
        powers[0, 0] = 1
        powers[1, :2] = -1, 2
        for n in range(2, terms):
            powers[n] = -2 * powers[n - 1] - powers[n - 2]
            powers[n, 1:] += 4 * powers[n - 1, :-1]
        return np.asarray(powers.T @ matrix)

    def _sums(self, drive: PreciseDrive, top: Any, count: int) -> Ints:
        """Return the coefficients of `_power_series` for the sources ``y < top``."""
        f = self.fixed
        y, weights = drive.outside(top)
        weights = f.over(weights, f.sqrt(f.one - y))
        ratio = f.over(y, top)
        sums = []
        binomial = f.one
        for j in range(count):
            sums.append(f.times(binomial, weights.sum()))
            weights = f.times(weights, ratio)
            binomial = binomial * (2 * j + 1) // (2 * j + 2)
        return np.array(sums, dtype=object)

    def __call__(self, e: Ints) -> Ints:
        """Return the half-integral at points `e`, an array with one axis."""
        values = np.empty(len(e), dtype=object)
        near = e <= 2 * self._rest
        if near.any():
            series = self._power_series(self._far, self._rest // 4, e[near])
            values[near] = series + self._near(e[near])
        if not near.all():
            assert self._all is not None
            values[~near] = self._power_series(self._all, self._rest, e[~near])
        return values

    def _power_series(self, sums: Ints, top: Any, e: Ints) -> Ints:
        """Return the half-integral over ``y < top``, from its `_sums`."""
        f = self.fixed
        y = self._rest + e
        ratio = f.over(top, y)
        value = 0 * y
        for c in sums[::-1]:
            value = f.times(value, ratio) + c
        return np.asarray(f.over(value, f.sqrt(y)))

    def _near(self, e: Ints) -> Ints:
        """Return the half-integral over three quarters of the slip zone, by recurrences."""
        w = self._wide
        x = self._extra
        length = self._length << x
        eps = w.over(e << x, length)
        inner = w.sqrt(eps)
        outer = w.sqrt(w.one + eps)
        powers = self._powers
        if self._folded:
            last = 2 * (outer - inner)
            total = w.times(powers[0], last)
            for k in range(1, len(powers)):
                last = (2 * outer - 2 * k * w.times(eps, last)) // (2 * k + 1)
                total = total + w.times(powers[k], last)
            total = w.times(total, w.sqrt(length))
        else:
            gamma = w.over(self._square << x, length)
            root = w.sqrt(gamma)
            reach = w.sqrt(w.one + gamma)
            both = w.times(outer, reach)
            product = w.times(gamma, eps)
            sum_ = gamma + eps
            quotient = w.over(outer + reach, inner + root)
            before = 2 * w.map(w.mp.log, quotient)
            last = both - w.times(inner, root) - w.times(sum_, before) // 2
            total = w.times(powers[0], before) + w.times(powers[1], last)
            for k in range(1, len(powers) - 1):
                rise = both - (2 * k + 1) * w.times(sum_, last) // 2 - k * w.times(product, before)
                before = last
                last = rise // (k + 1)
                total = total + w.times(powers[k + 1], last)
        return np.asarray((total >> x) // 2)


def solve_one_disk(
    drive: PreciseDrive,
    disk: Disk,
    beta: Any,
    friction: Any,
    logit: Any,
    tell: Callable[[str], None] = silent,
    slope: Any = None,
) -> PreciseOneDisk:
    """Solve partial slip with one stick disk.

    Parameters
    ----------
    drive : PreciseDrive
    disk : Disk
    beta, friction : int
        ``beta*`` and ``f / kappa`` in fixed point.
    logit : mpf
        A good guess of ``ln(c^2 / (1 - c^2))``.
    tell : callable
        Is told every trial.
    slope : mpf, optional
        As of `PreciseOneDisk`, from another mesh.

    Raises
    ------
    ConvergenceError
        If the radius does not settle.
    """
    mp = drive.fixed.mp
    # Without compliance the traction ends in a root at the rim. An error of the radius adds an
    # inverse root, which is larger than the root at distances that are smaller than the error: the
    # radius needs twice the digits.
    goal = mp.mpf(10) ** -((disk.mesh.digits + 2) if beta else 2 * disk.mesh.digits)
    before = None
    step = mp.mpf(10) ** -13
    for number in range(1, _MOST_TRIALS + 2):
        tell(f"stick radius, trial {number}")
        trial = _PreciseTrial(drive, disk, beta, friction, mp.mpf(logit))
        if before is not None and trial.mismatch != before:
            slope = (trial.mismatch - before) / step
        if slope is not None:
            step = -trial.mismatch / mp.mpf(slope)
            if abs(step) <= goal and abs(trial.mismatch) <= 10 * goal * trial.scale:
                return trial.outcome(slope)
        before = trial.mismatch
        logit = trial.logit + step
    raise ConvergenceError("the stick radius does not settle", "ask for fewer digits")


class _PreciseTrial:
    """The problem at one radius."""

    def __init__(
        self, drive: PreciseDrive, disk: Disk, beta: Any, friction: Any, logit: Any
    ) -> None:
        f = drive.fixed
        mp = drive.fixed.mp
        self._drive = drive
        self._disk = disk
        self._friction = friction
        self.logit = logit
        self.square = f.of(1 / (1 + mp.exp(-logit)))
        self.rest = f.of(1 / (1 + mp.exp(logit)))
        self._compliance = f.over(beta, f.sqrt(self.square))
        self._source = _PreciseSlipSource(drive, self.square, self.rest, disk.mesh.digits)
        edge = np.array([self.rest], dtype=object)
        #: size that the mismatch has to be small against; infinite without compliance, where the
        #: step alone decides
        self.scale = mp.inf
        if beta:  # the traction is continuous at the rim: its jump is zero
            bound = f.times(friction, drive.pressure(edge)[0])
            mismatch = disk.series(self._coefficients).limit - bound
            self.scale = f.numbers(bound)
        else:  # it has no inverse root there: its half-integral is zero
            mismatch = drive.target(edge)[0] - f.times(friction, self._source(0 * edge)[0])
        #: what is zero at the right radius
        self.mismatch = f.numbers(mismatch)

    @cached_property
    def _coefficients(self) -> Ints:
        """Coefficients of the traction on the stick disk."""
        f = self._drive.fixed
        disk = self._disk
        e = f.times(self.square, disk.d)
        target = self._drive.target(self.rest + e) - f.times(self._friction, self._source(e))
        return disk.solve(self._compliance, target, tangential=True)

    def outcome(self, slope: Any) -> PreciseOneDisk:
        """Return the solution at this radius."""
        f = self._drive.fixed
        disk = self._disk
        outside = f.times(self._friction, self._drive.outside(self.rest)[1].sum())
        shear = f.times(self.square, disk.shear(self._coefficients))
        shear += f.times(2 * f.of(f.mp.pi), outside)
        traction = disk.series(self._coefficients)
        return PreciseOneDisk(self.logit, traction, shear, slope)
