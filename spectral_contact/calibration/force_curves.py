"""What a measured curve of depths and loads is: signs, approach and retraction, baseline, noise."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import Array

Rows = NDArray[np.intp]

#: Parts of a curve that may be fitted.
PARTS: Final = ("approach", "retraction", "all")
#: A part spans at least this fraction of all depths.
_SPAN: Final = 0.05
#: Rows are in order of depth if the mean depths of so many blocks of them are. From one block to
#: the next the mean may go back by this fraction of the range of all depths.
_BLOCKS: Final = 20
_BACK: Final = 0.1
#: Slopes are taken over this fraction of the depths at either end. That of the contact is steeper
#: by this factor; if neither is, the deeper end is that of the contact.
_END: Final = 0.25
_STEEPER: Final = 1.5
#: Fraction of the points that a baseline begins with, the fewest points of it, and how many
#: standard deviations a mean of further points may lie off.
_FIRST: Final = 0.05
_FEWEST: Final = 10
_OFF: Final = 4.0
#: Largest rise of a baseline over all depths, as a fraction of the load above it at the deepest
#: point; and least ratio of that load to the standard deviation about the baseline.
_FLAT: Final = 0.1
_RISE: Final = 10.0
#: Correlation of neighbouring residuals beyond which they are curvature and no noise.
_SMOOTH: Final = 0.9


class Baseline(NamedTuple):
    """A straight line through the loads before the contact.

    Attributes
    ----------
    points : int
        Number of points.
    end : float
        The largest depth of them [m].
    level : float
        The load of the line at that depth [N].
    tilt : float
        Its slope [N/m].
    sigma : float
        Standard deviation of the loads about it [N].
    """

    points: int
    end: float
    level: float
    tilt: float
    sigma: float

    def at(self, depth: Array) -> Array:
        """Return the line at depths."""
        return self.level + self.tilt * (depth - self.end)


def baseline(depth: Array, load: Array) -> Baseline | None:
    """Return the baseline of a curve, None if it has none.

    The line begins with the shallowest points and goes on as long as further points lie on it.
    """
    order = np.argsort(depth, kind="stable")
    x = depth[order]
    y = load[order]
    block = max(_FEWEST, round(_FIRST * len(x)))
    if len(x) < 2 * _FEWEST or np.ptp(x[:block]) == 0.0:
        return None
    line = _line(x[:block], y[:block])
    while line.points < len(x):
        # where the contact has begun, the block after the next one is off the line, too
        if _is_off(line, x, y, block, 0) and _is_off(line, x, y, block, 1):
            break
        end = line.points + block
        line = _line(x[:end], y[:end])
    left = (y - line.at(x))[: line.points]
    rise = float(y[-1] - line.at(x[-1:])[0])
    is_flat = abs(line.tilt) * np.ptp(x) <= _FLAT * abs(rise)
    steps = np.diff(left)
    is_noise = steps @ steps >= (2.0 - 2.0 * _SMOOTH) * (left @ left)
    is_part = line.points < len(x)
    return line if is_part and is_flat and is_noise and 0.0 < line.sigma * _RISE < rise else None


def _is_off(line: Baseline, x: Array, y: Array, block: int, ahead: int) -> bool:
    """Return whether the mean of a block of points ahead is off the line, or there are none."""
    from scipy.special import ndtr, stdtrit  # takes long to import

    first = line.points + ahead * block
    further = slice(first, first + block)
    if first >= len(x):
        return True
    off = float(np.mean(y[further] - line.at(x[further])))
    # variances of the mean, and of a line that is extended to the middle of the block
    extended = (1.0 + 3.0 * (1.0 + (1 + 2 * ahead) * block / line.points) ** 2) / line.points
    # of few points the deviation is known less well, by Student's distribution
    most = stdtrit(line.points - 2, ndtr(_OFF))
    return bool(abs(off) > most * line.sigma * np.sqrt(1.0 / block + extended))


def _line(x: Array, y: Array) -> Baseline:
    """Return the straight line through some points, by rising depth."""
    width = float(np.ptp(x)) or 1.0
    terms = np.stack([np.ones(len(x)), (x - x[-1]) / width], axis=1)
    (level, tilt), *_ = np.linalg.lstsq(terms, y, rcond=None)
    left = y - terms @ [level, tilt]
    sigma = float(np.sqrt(left @ left / (len(x) - 2)))
    return Baseline(len(x), float(x[-1]), float(level), float(tilt) / width, sigma)


def touch_depth(depth: Array, load: Array, noise: Array) -> float:
    """Return the first depth beyond the last load that is noise; the smallest if none is."""
    order = np.argsort(depth, kind="stable")
    quiet = np.flatnonzero(load[order] <= noise[order])
    first = min(quiet[-1] + 1, len(order) - 1) if len(quiet) else 0
    return float(depth[order][first])


def signs(depth: Array, load: Array) -> tuple[float, float]:
    """Return the signs of depth and load with which loads grow with depth.

    A curve is steeper in contact than before it, and steeper the deeper it is.
    """
    low = depth.min()
    high = depth.max()
    if low == high:
        return 1.0, 1.0
    shallow = _slope(depth, load, depth <= low + _END * (high - low))
    deep = _slope(depth, load, depth >= high - _END * (high - low))
    if abs(shallow) > _STEEPER * abs(deep):
        return -1.0, -1.0 if shallow > 0.0 else 1.0
    if deep >= 0.0:
        return 1.0, 1.0
    if abs(deep) > _STEEPER * abs(shallow) or np.median(load) < 0.0:
        return 1.0, -1.0
    return -1.0, 1.0


def _slope(depth: Array, load: Array, chosen: NDArray[np.bool_]) -> float:
    """Return the slope of a line through the chosen points, of all of them if these are too few."""
    if np.ptp(depth[chosen]) == 0.0:
        chosen = np.ones(len(depth), dtype=bool)
    x = depth[chosen] - depth[chosen].mean()
    y = load[chosen]
    return float(x @ y / (x @ x))


def curve_parts(depth: Array) -> dict[str, Rows]:
    """Return the rows of approach and retraction, as far as there are such parts.

    The rows up to the deepest one are the approach. Of rows in no order there are no parts.
    """
    rows = np.arange(len(depth))
    deepest = int(np.argmax(depth))
    parts = {"approach": rows[: deepest + 1], "retraction": rows[deepest + 1 :]}
    extent = float(np.ptp(depth))
    there = {
        name: part
        for name, part in parts.items()
        if len(part) > 1 and float(np.ptp(depth[part])) >= _SPAN * extent > 0.0
    }
    if len(there) == 1:  # the few rows beyond the turning point are no part of their own
        there = dict.fromkeys(there, rows)
    for name, part in there.items():
        blocks = np.array_split(depth[part], min(_BLOCKS, len(part)))
        steps = np.diff([block.mean() for block in blocks])
        if (steps if name == "approach" else -steps).min() < -_BACK * extent:
            return {}
    return there


def loop_height(depth: Array, load: Array, parts: dict[str, Rows]) -> float:
    """Return the mean load of the approach over that of the retraction at the same depths."""
    first, second = (parts[name] for name in ("approach", "retraction"))
    order = second[np.argsort(depth[second], kind="stable")]
    inside = first[(depth[first] >= depth[order[0]]) & (depth[first] <= depth[order[-1]])]
    if not len(inside):
        return 0.0
    return float(np.mean(load[inside] - np.interp(depth[inside], depth[order], load[order])))
