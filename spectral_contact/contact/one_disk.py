r"""Partial slip with one central stick disk, equation (5.8) for the total traction.

On the stick disk of radius c, with ``s = c sigma``, homogeneity gives the unit-disk equation with
compliance ``beta / c`` and, in the half-integral, the target

    R(c tau) - (f/kappa) int_c^1 p ds / sqrt(s^2 - c^2 tau^2).

The total traction is the unknown, not the corrective one of (5.4), which is not smooth at the
centre. Everything is for kappa = 1, so friction is ``f / kappa``.

The radius makes the traction continuous, (5.9). Near the rim the target is small against its two
parts, so it is split into its value at the rim, ``m``, and a rise that is computed without the
subtraction. For a given radius the equation is linear in ``m``: continuity gives the ``m`` that
the disk needs, and the radius is the root of ``R(c) - (f/kappa) P(c) - m``, which is as well
conditioned as the smooth limit, where ``m = 0``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, log, pi

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from spectral_contact.adaptive import Attempt, Refinement, Resolution, refine
from spectral_contact.contact.drive import EDGE, Drive
from spectral_contact.contact.resolution import (
    ROUNDING,
    SAFETY,
    decay_rates,
    expected_error,
    series_of,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields import DiskSeries, PressureField, Radius
from spectral_contact.spectral.annulus import Points, gap
from spectral_contact.spectral.galerkin import Factored, disk_operators
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import LogPanels

__all__ = [
    "NoStickDiskError",
    "OneDisk",
    "SlipSource",
    "disk_resolution",
    "interpolate",
    "rim_target",
    "solve_one_disk",
]

Array = NDArray[np.float64]

#: Stick radii are searched between 1e-65 and 1 - 1e-43; beyond, rounding leaves no traction to find.
_LEAST_LOGIT, _LARGEST_LOGIT = -300.0, 100.0


@dataclass(frozen=True, slots=True)
class OneDisk:
    """Partial slip with one stick disk, for kappa = 1.

    Attributes
    ----------
    radius : Radius
        ``c*``.
    traction : DiskSeries
        ``q*/kappa`` on the stick disk.
    total_shear : float
        ``Q*/kappa`` of the whole contact.
    traction_error, shear_error : float
        Estimates of relative errors.
    radius_error, edge_error : float
        Estimates of the relative errors of ``c`` and of ``1 - c``.
    parts : tuple
        Quadrature of ``t^2 E dt`` over the disk, for the displacement outside it.
    depth : float
        ``-ln`` of the smallest scaled distance from the rim that was resolved.
    stray : float
        Estimate of the largest error of E.
    """

    radius: Radius
    traction: DiskSeries
    total_shear: float
    traction_error: float
    shear_error: float
    radius_error: float
    edge_error: float
    parts: tuple[tuple[Points, Array], ...]
    depth: float
    stray: float


class NoStickDiskError(ArithmeticError):
    """No radius in the range searched makes the traction continuous.

    Attributes
    ----------
    at_centre : bool
        Whether the root lies below the range: the stick disk is smaller than 1e-65. Else the
        slip annulus is narrower than that, or slip is not one annulus at the edge.
    """

    def __init__(self, at_centre: bool) -> None:
        super().__init__("no stick disk in the range searched")
        self.at_centre = at_centre


class SlipSource:
    """Quadrature of a pressure over an annulus, graded to both ends.

    Parameters
    ----------
    pressure : PressureField
        ``p*``.
    inner, outer : Radius
        Ends of the annulus.
    alpha : float
        ``alpha*``, the width of the layer at the edge.
    tolerance : float
        Relative accuracy of the integrals.
    rim : Radius, optional
        Rim of the stick disk; by default the inner end.
    """

    def __init__(
        self,
        pressure: PressureField,
        inner: Radius,
        outer: Radius,
        alpha: float,
        tolerance: float,
        rim: Radius | None = None,
    ) -> None:
        width = gap(inner, outer)
        half = width / 2.0
        # square roots at the inner end; at the outer end a singular pressure is one, too
        points = 3 + ceil(-0.35 * log(tolerance))
        finest = max(1e-3 * tolerance, 1e-17) ** 2 * half
        offsets, weights = _graded(half, min(half, inner.square) / half * finest, points)
        depth, outer_weights = _graded(
            half, min(half, alpha) * max(1e-3 * tolerance, 1e-17) if alpha else finest, points
        )
        #: distance of the nodes from the rim in s**2
        self.above = np.concatenate([offsets, width - depth])
        if rim is not None:
            self.above += gap(rim, inner)
        y = np.concatenate([inner.rest - offsets, outer.rest + depth])
        z = np.concatenate([inner.square + offsets, outer.square - depth])
        #: weights of ``p ds``; with s ds = dz/2
        self._root = np.sqrt(self.above)
        self.values = np.concatenate([weights, outer_weights]) * pressure.at(y) / (2.0 * np.sqrt(z))

    @property
    def at_rim(self) -> float:
        """``int p ds / sqrt(s^2 - inner^2)``."""
        return float((1.0 / self._root) @ self.values)

    def half_integral(self, below: Array) -> Array:
        """Return ``int p ds / sqrt(s^2 - t^2)`` where ``rim**2 - t**2 = below``."""
        root = below[:, None] + self.above
        np.sqrt(root, out=root)
        np.reciprocal(root, out=root)
        return np.asarray(root @ self.values)

    def fall(self, below: Array) -> Array:
        """Return by how much the half-integral at ``inner**2 - below`` is less than at the rim."""
        root = below[:, None] + self.above
        np.sqrt(root, out=root)
        kernel = root + self._root
        kernel *= root
        np.reciprocal(kernel, out=kernel)
        return below * (kernel @ (self.values / self._root))


def _graded(reach: float, finest: float, points: int) -> tuple[Array, Array]:
    """Return nodes and weights on (0, reach), graded to 0 down to `finest`."""
    # the far end of the annulus is a singularity ln 2 before the first panel: make that one short
    panels = int(np.ceil((log(reach / finest) - 1.0) / 3.0))
    start = np.concatenate([[0.0], 1.0 + 3.0 * np.arange(panels)])
    width = np.concatenate([[1.0], np.full(panels, 3.0)])
    g, w = gauss_rule(points)
    nodes = reach * np.exp(-start[:, None] - width[:, None] * (1.0 + g) / 2.0)
    return nodes.ravel(), (nodes * (w * width[:, None] / 2.0)).ravel()


@dataclass(frozen=True, slots=True)
class _Trial:
    """The disk solved at one radius."""

    radius: Radius
    mismatch: float
    coefficients: Array
    factored: Factored
    target: Array
    unit: float


class _OneDiskProblem:
    """Spaces for the stick disk; the radius is found anew in each of them."""

    def __init__(
        self,
        drive: Drive,
        beta: float,
        friction: float,
        tolerance: float,
        guess: float | None = None,
    ) -> None:
        self.drive = drive
        self.beta = beta
        self.friction = friction
        self.tolerance = tolerance
        self.alpha = drive.contact.compliance
        if guess is not None:  # in a space that sees a narrow annulus
            space = self._resolution(guess, tolerance)
            ends = [self._trial(space, guess + h, 0.01 * tolerance).mismatch for h in (-0.05, 0.05)]
            self.logit, self.slope = guess, (ends[1] - ends[0]) / 0.1
            return
        # the radius roughly: of the smooth surface, then in small spaces
        smooth, slope = _bracketed_root(self._smooth_mismatch)
        self.logit, self.slope = smooth, slope
        if beta > 0.0:
            # with compliance c grows like 2 beta f/kappa at first
            rough = 2.0 * beta * friction / (1.0 + 2.0 * beta * friction)
            start = max(smooth, 2.0 * log(rough) - log(1.0 - rough**2))
            self.logit, self.slope = self._rough_root(start)

    def _smooth_mismatch(self, logit: float) -> float:
        """Return ``R(c) - (f/kappa) P(c)``, zero without tangential compliance."""
        radius = Radius.from_logit(logit)
        source = SlipSource(self.drive.pressure, radius, EDGE, self.alpha, 1e-3)
        return float(self.drive.target(np.array(radius.rest))) - self.friction * source.at_rim

    def _rough_root(self, start: float) -> tuple[float, float]:
        """Return the radius with compliance, roughly, and the slope there."""

        def mismatch(logit: float) -> float:
            return self._trial(self._resolution(logit, 1e-3), logit, 1e-3).mismatch

        x, value = start, mismatch(start)
        slope = (mismatch(start + 0.3) - value) / 0.3
        for _ in range(8):  # the secant mostly settles; else bracket
            step = max(min(-value / slope, 3.0), -3.0)
            if not _LEAST_LOGIT < x + step < _LARGEST_LOGIT:
                break
            fresh = mismatch(x + step)
            if fresh != value:
                slope = (fresh - value) / step
            x, value = x + step, fresh
            if slope <= 0.0:
                break
            if abs(step) < 1e-3 * max(1.0, abs(x)):
                return x, slope
        return _bracketed_root(mismatch)

    def _resolution(self, logit: float, tolerance: float) -> Resolution:
        """Return the first space for a disk of this radius."""
        return disk_resolution(Radius.from_logit(logit), self.alpha, self.beta, tolerance)

    def start(self) -> Resolution:
        return self._resolution(self.logit, self.tolerance)

    def _factored(self, resolution: Resolution, radius: Radius) -> Factored:
        disk = disk_operators(resolution.panels)
        return disk.tangential.space(resolution.degrees).factor(self.beta / radius.value)

    def _trial(self, resolution: Resolution, logit: float, tolerance: float) -> _Trial:
        """Solve the disk of the given radius; the mismatch of the rim value decides."""
        radius = Radius.from_logit(logit)
        factored = self._factored(resolution, radius)
        return self._at(self.drive, resolution, radius, factored, tolerance)

    def _at(
        self,
        drive: Drive,
        resolution: Resolution,
        radius: Radius,
        factored: Factored,
        tolerance: float,
    ) -> _Trial:
        """Solve for a drive, which may be the change of one: all is linear in the pressure."""
        panels = resolution.panels
        source = SlipSource(drive.pressure, radius, EDGE, self.alpha, tolerance)
        at_rim = np.array(radius.rest)
        balance, target = rim_target(drive, radius, [(self.friction, source)], keep=self.beta > 0.0)
        values = interpolate(panels, target)
        rim, unit = -balance, 0.0
        if self.beta == 0.0:
            coefficients = factored.solve(values)
        else:
            targets = np.column_stack([values, np.ones_like(values)])
            both = factored.solve(targets)
            coefficients, response = both[:, 0], both[:, 1]
            unit = series_of(panels, response).limit
            slipping = self.friction * float(drive.pressure.at(at_rim))
            rim = (slipping - series_of(panels, coefficients).limit) / unit
            coefficients = coefficients + rim * response
            values = values + rim
        return _Trial(radius, -rim, coefficients, factored, values, unit)

    def attempt(self, resolution: Resolution) -> Attempt[OneDisk]:
        quadrature = 0.01 * self.tolerance

        def mismatch(logit: float) -> float:
            return self._trial(resolution, logit, quadrature).mismatch

        self.logit, self.slope = _polished_root(mismatch, self.logit, self.slope)
        radius = Radius.from_logit(self.logit)
        factored = self._factored(resolution, radius)
        trial = self._at(self.drive, resolution, radius, factored, quadrature)
        return self._assess(resolution, trial)

    def _assess(self, resolution: Resolution, trial: _Trial) -> Attempt[OneDisk]:
        """Turn the final trial into a solution with its errors."""
        panels, radius, coefficients = resolution.panels, trial.radius, trial.coefficients
        disk, normal = disk_operators(panels), self.drive.contact
        series = series_of(panels, coefficients)
        rates = decay_rates(resolution, coefficients)
        change = trial.factored.change(coefficients).coefficients
        indicators = expected_error(share_of_change(panels, change, series), rates)
        own, propagated = float(rates[np.argmax(indicators)]), SAFETY * normal.rate**2
        error = float(indicators.max()) + 20.0 * ROUNDING
        outside = 2.0 * pi * self.friction * float(self.drive.load_outside(np.array(radius.rest)))
        shear = radius.square * float(disk.shear_moments @ coefficients) + outside
        lost = SAFETY * own * radius.square * abs(float(disk.shear_moments @ change))
        # what moves the rim value moves the radius: first the disk's own change, then the pressure's
        shift = stray = 0.0
        if trial.unit > 0.0:
            shift = SAFETY * own * abs(series_of(panels, change).limit / trial.unit)
        if self.drive.change is not None:
            moved = self._at(self.drive.change, resolution, radius, trial.factored, 1e-3)
            share = float(share_of_change(panels, moved.coefficients, series).max())
            error += propagated * share
            shift += propagated * abs(moved.mismatch)
            outside = float(self.drive.change.load_outside(np.array(radius.rest)))
            part = radius.square * float(disk.shear_moments @ moved.coefficients)
            lost += propagated * abs(part + 2.0 * pi * self.friction * outside)
            strays = moved.target - disk.half_integral @ moved.coefficients
            stray = propagated * float(np.abs(strays).max())
        # rounding, and what the source quadrature leaves out
        noise = 8.0 * ROUNDING + 1e-5 * self.tolerance
        shift += noise * float(self.drive.target(np.array(radius.rest)))
        shift /= abs(self.slope)
        misfit = trial.target - disk.half_integral @ coefficients
        stray = SAFETY * own * float(np.abs(disk.half_integral @ change).max()) + stray
        weights = radius.value**3 * disk.nodes.weights * disk.nodes.rest
        value = OneDisk(
            radius,
            DiskSeries(radius, series),
            shear,
            error,
            lost / shear + 2.0 * shift**2 * radius.rest + 16.0 * ROUNDING,
            shift * radius.rest / 2.0 + ROUNDING,
            shift * radius.square + ROUNDING,
            ((Points(radius, -radius.square * disk.nodes.d), weights * misfit),),
            panels.panels * panels.width,
            stray,
        )
        unknowns = disk.tangential.space(resolution.degrees).unknowns
        return Attempt(value, error, indicators, rates, unknowns)


def rim_target(
    drive: Drive, radius: Radius, sources: list[tuple[float, SlipSource]], *, keep: bool
) -> tuple[float, Callable[[Array], Array]]:
    """Return the target of a stick disk at its rim, and on the disk.

    Parameters
    ----------
    drive : Drive
    radius : Radius
        The rim.
    sources : list of (float, SlipSource)
        Slip zones outside, each with its sign times ``f / kappa``.
    keep : bool
        Whether the function includes the balance. It does not where the target must vanish at
        the rim, at zero compliance.

    Returns
    -------
    balance : float
        ``R(c) - (f/kappa) P(c)``.
    function : callable
        The target as a function of ``d = 1 - s**2/c**2``. Near the rim it is built from differences
        that do not cancel; beyond, from the parts, whose noise falls with their size.
    """
    at_rim = float(drive.target(np.array(radius.rest)))
    balance = at_rim - sum(factor * source.at_rim for factor, source in sources)
    reach, rise = drive.rise(radius)
    at_start, at_end = (balance, 0.0) if keep else (0.0, balance)

    def function(d: Array) -> Array:
        near = d <= reach
        value = np.empty_like(d)
        below = radius.square * d
        value[near] = rise(d[near]) + at_start
        value[~near] = drive.target(radius.rest + below[~near]) - at_end
        for factor, source in sources:
            value[near] += factor * source.fall(below[near])
            value[~near] -= factor * source.half_integral(below[~near])
        return value

    return balance, function


def disk_resolution(radius: Radius, alpha: float, beta: float, tolerance: float) -> Resolution:
    """Return the first space for a stick disk: its layers are those of alpha, beta and the rim."""
    rim = max(alpha, radius.rest) / radius.square
    # without compliance the traction beyond the slip annulus is singular down to its width
    scales = [1.0, rim, (beta / radius.value) or radius.rest / radius.square]
    return starting_resolution(
        -log(min(scales)), tolerance, root_tail=beta == 0.0, bends=(1.0 - log(min(rim, 1.0)),)
    )


def interpolate(panels: LogPanels, function: Callable[[Array], Array]) -> Array:
    """Return a function of ``d`` at the Galerkin nodes, sampled where it is cheap.

    On every panel it is analytic in ``x``: a Legendre expansion from few samples serves the many
    nodes. The tail is sampled at the nodes themselves.
    """
    start, count = panels.node_counts
    x = panels.sampling()
    points = x.shape[1]
    nodes = disk_operators(panels).nodes.d
    tail = nodes[start + (panels.panels - 1) * count :]
    values = function(np.concatenate([np.exp(-x).ravel(), tail]))
    expand = legendre_expansion_matrix(points, points - 1)
    # any trailing axis of the values (several functions at once) is carried along
    samples = values[: x.size].reshape(*x.shape, *values.shape[1:])
    coefficients = np.einsum("kp,jp...->jk...", expand, samples)
    own = -np.log(nodes[: start + count]) / panels.width
    own[start:] -= 1.0
    basis = legendre_values(2.0 * own - 1.0, points - 1)
    first = np.tensordot(basis[:start], coefficients[0], axes=1)
    others = np.einsum("qk,jk...->jq...", basis[start:], coefficients[1:])
    flat = others.reshape(-1, *values.shape[1:])
    return np.concatenate([first, flat, values[x.size :]])


def _bracketed_root(function: Callable[[float], float]) -> tuple[float, float]:
    """Return a rough root in logit(c**2), and the slope there; the function rises with c."""
    low, high, step = -2.0, 2.0, 2.0
    at_low, at_high = function(low), function(high)
    while at_high < 0.0:
        low, at_low, high, step = high, at_high, min(high + step, _LARGEST_LOGIT), 2.0 * step
        if low >= _LARGEST_LOGIT:
            raise NoStickDiskError(at_centre=False)
        at_high = function(high)
    while at_low > 0.0:
        high, at_high, low, step = low, at_low, max(low - step, _LEAST_LOGIT), 2.0 * step
        if high <= _LEAST_LOGIT:
            raise NoStickDiskError(at_centre=True)
        at_low = function(low)
    root = float(optimize.brentq(function, low, high, xtol=1e-3, rtol=1e-5))
    return root, (function(root + 0.05) - function(root - 0.05)) / 0.1


def _polished_root(
    function: Callable[[float], float], guess: float, slope: float
) -> tuple[float, float]:
    """Secant from a good guess; return the root and the slope there."""
    x, value = guess, function(guess)
    for _ in range(20):
        step = max(min(-value / slope, 2.0), -2.0)
        # the next secant step would be the square of this one: below rounding
        if abs(step) <= 1e-9 * max(1.0, abs(x)):
            return x + step, slope
        fresh = function(x + step)
        if fresh == value:
            return x + step, slope
        slope = (fresh - value) / step
        x, value = x + step, fresh
        if not _LEAST_LOGIT < x < _LARGEST_LOGIT:
            raise NoStickDiskError(at_centre=x < 0.0)
    return x, slope  # as near as its conditioning lets it; the error estimate shows it


def solve_one_disk(
    drive: Drive,
    beta: float,
    friction: float,
    tolerance: float,
    max_unknowns: int,
    *,
    guess: float | None = None,
) -> Refinement[OneDisk]:
    """Solve partial slip under the assumption of one central stick disk, for kappa = 1.

    Parameters
    ----------
    drive : Drive
        Right-hand side, from the normal problem.
    beta : float
        ``beta*``, 0 or positive.
    friction : float
        ``f / kappa``, positive and below the critical value.
    tolerance : float
        Bound on the relative error of q/s, pointwise.
    max_unknowns : int
        Most unknowns of a space.
    guess : float, optional
        First guess of ``ln(c**2/(1 - c**2))``; by default it is searched for.

    Returns
    -------
    Refinement
        Whether the assumption holds is for the caller to check.
    """
    if beta == 0.0 and friction > _LARGEST_LOGIT:  # 1 - c falls like exp(-pi f/(2 kappa))
        raise NoStickDiskError(at_centre=False)
    problem = _OneDiskProblem(drive, beta, friction, tolerance, guess)
    return refine(problem, tolerance, max_unknowns)
