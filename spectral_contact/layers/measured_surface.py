"""Greenwood and Williamson's numbers of a measured surface, from its spectral moments.

The mean squares of height, slope and curvature, ``m0``, ``m2`` and ``m4``, of an isotropic Gaussian
surface tell its summits (Nayak, *Random process model of rough surfaces*, J. Lubr. Technol. 93
(1971) 398-407; McCool, *Comparison of models for the contact of rough surfaces*, Wear 107 (1986)
37-60):

    eta = m4 / (6 pi sqrt(3) m2),    R = 3 sqrt(pi) / (8 sqrt(m4)),
    sigma = sqrt((1 - 0.8968 / alpha) m0),    alpha = m0 m4 / m2^2.

Differences are taken between points of the measurement, and nowhere across its edges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import positive, reals

#: McCool's number for the deviation of summits.
_MCCOOL_NUMBER: Final = 0.8968
#: Of the Gaussian filter of ISO 16610: its weight at the cut-off is one half.
_FILTER_CONSTANT: Final = math.sqrt(math.log(2.0) / math.pi)
#: Half width of the filter, in cut-offs.
_FILTER_HALF_WIDTH: Final = 1.5
#: Factor by which the cut-off is changed for the sensitivities.
_CUTOFF_FACTOR: Final = 1.25
#: Range of heights over the mean plane and of spacings [m]: their moments, and products of these,
#: stay in the range of doubles.
_LENGTH_RANGE: Final = 1e-30, 1e30
#: Heights over a mean plane that are rounding, over the largest height.
_LEVEL_ROUNDING: Final = 1e-13
#: Number of blocks along a side, from whose scatter errors are estimated.
_BLOCKS: Final = 4
#: Least number of points along a side.
_FEWEST_POINTS: Final = 16
#: A remark says that the numbers are doubtful if more than this fraction of the points is missing,
_DOUBTFUL_MISSING: Final = 0.05
#: if the bandwidth is smaller than this,
_LEAST_BANDWIDTH: Final = 1.5
#: or if a sensitivity is larger than this.
_DOUBTFUL_SENSITIVITY: Final = 0.5
_NAMES: Final = ("density", "tip_radius", "height_deviation")


@dataclass(frozen=True, slots=True)
class SurfaceStatistics:
    """What `from_height_map` and `from_profile` return.

    Attributes
    ----------
    density : float
        η, summits per area [1/m²].
    tip_radius : float
        R of their tips [m].
    height_deviation : float
        σ, standard deviation of their heights [m].
    rms_height, rms_slope, rms_curvature : float
        Of the surface, along a line [m, 1, 1/m].
    bandwidth : float
        Nayak's ``alpha = m0 m4 / m2^2``, at least 1.5 of an isotropic surface.
    error : dict of str to float
        Relative standard deviations of the first three, from the scatter over parts of the
        measurement; what the cut-off does is not in it.
    sensitivity : dict of str to float
        Derivatives of their logarithms by that of the cut-off; 0 would be no dependence.
    point_count, missing : int
        Number of points, and number of those without a height.
    """

    density: float
    tip_radius: float
    height_deviation: float
    rms_height: float
    rms_slope: float
    rms_curvature: float
    bandwidth: float
    error: dict[str, float]
    sensitivity: dict[str, float]
    point_count: int
    missing: int

    @property
    def asperities(self) -> dict[str, float]:
        """The three numbers by name, as `greenwood_williamson` takes them."""
        return {name: getattr(self, name) for name in _NAMES}

    @property
    def remarks(self) -> tuple[str, ...]:
        """Doubts about the numbers, one sentence each."""
        remarks = []
        if self.missing:
            sentence = f"{self.missing} of {self.point_count} points are missing and left out"
            many = self.missing > _DOUBTFUL_MISSING * self.point_count
            remarks.append(
                f"{sentence}: the rest may not be the same surface." if many else f"{sentence}."
            )
        if self.bandwidth < _LEAST_BANDWIDTH:
            remarks.append(
                f"The bandwidth {self.bandwidth:.3g} is below {_LEAST_BANDWIDTH:g}, which no "
                "isotropic Gaussian surface has: the summits are not those of the model."
            )
        for name, value in self.sensitivity.items():
            if abs(value) > _DOUBTFUL_SENSITIVITY:
                remarks.append(
                    f"{name} goes with the power {value:+.2f} of the cut-off: it is a number of "
                    "the measurement as much as of the surface."
                )
        return tuple(remarks)


class _SpectralMoments(NamedTuple):
    """Mean squares of height, slope and curvature."""

    height: float
    slope: float
    curvature: float

    @property
    def numbers(self) -> dict[str, float]:
        """Greenwood and Williamson's numbers."""
        bandwidth = self.height * self.curvature / self.slope**2
        summits = max(1.0 - _MCCOOL_NUMBER / bandwidth, 0.0)
        values = (
            self.curvature / (6.0 * math.pi * math.sqrt(3.0) * self.slope),
            3.0 * math.sqrt(math.pi) / (8.0 * math.sqrt(self.curvature)),
            math.sqrt(summits * self.height),
        )
        return dict(zip(_NAMES, values, strict=True))


def from_height_map(
    heights: ArrayLike, spacing: Any, *, cutoff: float | str | None = None
) -> SurfaceStatistics:
    """Return Greenwood and Williamson's numbers of a map of heights.

    The mean plane is taken off. The surface is taken for isotropic.

    Parameters
    ----------
    heights : array_like, shape (rows, columns)
        Heights [m], at least 16 along either side; NaN where there is none.
    spacing : float or tuple of float
        Distance of the points [m]; or that of the rows and that of the columns.
    cutoff : float, optional
        Shortest wavelength [m] that counts, by the Gaussian filter of ISO 16610. By default nothing
        is filtered, and `SurfaceStatistics.sensitivity` is that to a cut-off of five points.

    Raises
    ------
    SceneError
        If a number is not as said, or the surface has no slope.
    """
    array = _heights(heights, 2)
    steps = spacing if isinstance(spacing, tuple) else (spacing, spacing)
    if len(steps) != 2:
        raise SceneError("spacing", spacing, "a number, or two of them")
    return _statistics(array, [positive("spacing", one, "m") for one in steps], cutoff)


def from_profile(
    heights: ArrayLike, spacing: float | str, *, cutoff: float | str | None = None
) -> SurfaceStatistics:
    """Return Greenwood and Williamson's numbers of a profile, a line across a surface.

    The mean line is taken off. The surface is taken for isotropic.

    Parameters
    ----------
    heights : array_like, shape (n,)
        Heights [m] at equal distances, at least 16; NaN where there is none.
    spacing, cutoff : float
        As of `from_height_map`.

    Raises
    ------
    SceneError
        As `from_height_map`.
    """
    array = _heights(heights, 1)
    return _statistics(array, [positive("spacing", spacing, "m")], cutoff)


def _heights(values: ArrayLike, dimensions: int) -> Array:
    given = reals("heights", values, "a height, or NaN", anything=True, unit="m")
    with np.errstate(over="ignore"):  # a long double may be beyond the doubles
        array = np.asarray(given + 0.0, dtype=np.float64)
    if array.ndim != dimensions or min(array.shape, default=0) < _FEWEST_POINTS:
        allowed = "rows and columns" if dimensions == 2 else "a list"
        raise SceneError("heights", values, f"{allowed} of {_FEWEST_POINTS} heights or more")
    if np.isinf(array).any() or np.isnan(array).mean() > 0.5:
        raise SceneError("heights", values, "finite, and NaN at less than half of the points")
    return array


def _statistics(heights: Array, steps: list[float], cutoff: Any) -> SurfaceStatistics:
    level = _levelled(heights, steps)
    size = float(np.nanmax(np.abs(level)))
    if not size > _LEVEL_ROUNDING * float(np.nanmax(np.abs(heights))):
        raise SceneError("heights", size, "not all on one plane")
    low, high = _LENGTH_RANGE
    for name, lengths in (("heights", [size]), ("spacing", steps)):
        if not low <= min(lengths) <= max(lengths) <= high:
            raise SceneError(name, lengths, f"in [{low:g}, {high:g}] m, as their squares count")
    shortest = None
    if cutoff is not None:
        shortest = positive("cutoff", cutoff, "m")
        extent = min(step * count for step, count in zip(steps, level.shape, strict=True))
        if not 2.0 * max(steps) <= shortest <= extent / _BLOCKS:
            allowed = f"in [{2.0 * max(steps):.4g}, {extent / _BLOCKS:.4g}] m"
            if extent < 2.0 * _BLOCKS * max(steps):
                allowed = f"None: a side of {extent:.4g} m is too short for a filter of any points"
                allowed += f" that are {max(steps):.4g} m apart"
            raise SceneError("cutoff", cutoff, allowed)
    reference = 5.0 * max(steps) if shortest is None else shortest
    filtered = level if shortest is None else _filtered(level, steps, shortest)
    moments = _moments(filtered, steps)
    if not (moments.slope > 0.0 and moments.curvature > 0.0):
        allowed = "of a surface with slopes and curvatures, which take three heights in a row"
        raise SceneError("heights", heights, allowed)
    ends = [
        _moments(_filtered(level, steps, reference * factor), steps).numbers
        for factor in (1.0 / _CUTOFF_FACTOR, _CUTOFF_FACTOR)
    ]
    numbers = moments.numbers
    with np.errstate(all="ignore"):
        sensitivity = {
            name: float(np.log(np.divide(ends[1][name], ends[0][name])))
            / (2.0 * math.log(_CUTOFF_FACTOR))
            for name in _NAMES
        }
    return SurfaceStatistics(
        **numbers,
        rms_height=math.sqrt(moments.height),
        rms_slope=math.sqrt(moments.slope),
        rms_curvature=math.sqrt(moments.curvature),
        bandwidth=moments.height * moments.curvature / moments.slope**2,
        error=_scatter(filtered, steps, numbers),
        sensitivity=sensitivity,
        point_count=level.size,
        missing=int(np.isnan(heights).sum()),
    )


def _levelled(heights: Array, steps: list[float]) -> Array:
    """Return heights over their mean line or plane."""
    places = np.meshgrid(*(np.arange(n) * 1.0 for n in heights.shape), indexing="ij")
    terms = np.stack([np.ones(heights.shape), *places], axis=-1)
    present = ~np.isnan(heights)
    coefficients, *_ = np.linalg.lstsq(terms[present], heights[present], rcond=None)
    return np.asarray(heights - terms @ coefficients)


def _filtered(heights: Array, steps: list[float], cutoff: float) -> Array:
    """Return heights without wavelengths below the cut-off; no point counts beyond the edges."""
    present = ~np.isnan(heights)
    values = np.where(present, heights, 0.0)
    weights = present.astype(float)
    for axis, step in enumerate(steps):
        reach = max(math.ceil(_FILTER_HALF_WIDTH * cutoff / step), 1)
        reach = min(reach, (heights.shape[axis] - 1) // 2)
        scaled_distance = np.arange(-reach, reach + 1) * step / (_FILTER_CONSTANT * cutoff)
        kernel = np.exp(-math.pi * scaled_distance**2)

        def smooth(line: Array, kernel: Array = kernel) -> Array:
            return np.convolve(line, kernel, mode="same")

        values = np.apply_along_axis(smooth, axis, values)
        weights = np.apply_along_axis(smooth, axis, weights)
    return np.where(present, values / np.where(weights > 0.0, weights, 1.0), np.nan)


def _moments(heights: Array, steps: list[float]) -> _SpectralMoments:
    """Return the mean squares, those of slope and curvature over all directions measured."""
    slopes = []
    curvatures = []
    for axis, step in enumerate(steps):
        line = np.moveaxis(heights, axis, -1)
        slopes.append((line[..., 2:] - line[..., :-2]) / (2.0 * step))
        curvatures.append((line[..., 2:] - 2.0 * line[..., 1:-1] + line[..., :-2]) / step**2)
    height = float(np.nanmean(np.square(heights)))
    return _SpectralMoments(height, _mean_square(slopes), _mean_square(curvatures))


def _mean_square(along_axes: list[Array]) -> float:
    """Return the mean over the axes of the mean squares along them; NaN if there is none."""
    finite_values = [values[np.isfinite(values)] for values in along_axes]
    means = [float(np.mean(np.square(values))) for values in finite_values if values.size]
    return math.fsum(means) / len(means) if means else math.nan


def _scatter(heights: Array, steps: list[float], numbers: dict[str, float]) -> dict[str, float]:
    """Return the relative standard deviations of the mean over parts of the measurement."""
    cuts = [np.array_split(np.arange(n), _BLOCKS) for n in heights.shape]
    by_name: dict[str, list[float]] = {name: [] for name in numbers}
    for part in product(*cuts):
        block = heights[np.ix_(*part)]
        if np.isnan(block).mean() > 0.5:
            continue
        with np.errstate(all="ignore"):
            moments = _moments(block, steps)
        if moments.slope > 0.0 and moments.curvature > 0.0 and moments.height > 0.0:
            for name, value in moments.numbers.items():
                by_name[name].append(value)
    count = len(by_name[_NAMES[0]])
    if count < 2:
        return dict.fromkeys(numbers, math.inf)
    return {
        name: float(np.std(values, ddof=1)) / math.sqrt(count) / (numbers[name] or 1.0)
        for name, values in by_name.items()
    }
