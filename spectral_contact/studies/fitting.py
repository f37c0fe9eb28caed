"""The rate at which errors fall with the number of unknowns, with its interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import real, reals, within
from spectral_contact.io.choices import listed

#: Errors this small are rounding.
_ROUNDING: Final = 10.0 * 2.0**-52
#: Points of a law, and of a plateau, at least.
_FEWEST: Final = 3
_FEWEST_ON_PLATEAU: Final = 2
#: More unknowns than any solver has, and few enough to take squares of.
_MOST: Final = 1e15
#: Scatter of ln(error) that is not taken for structure: 5 per cent.
_SCATTER: Final = 0.05
#: Models of ln(error) as a line, by what it is a line in.
_MODELS: Final[dict[str, Callable[[Array], Array]]] = {
    "algebraic": np.log,
    "geometric": np.positive,
    "root-geometric": np.sqrt,
}
#: A law that leaves less than twice the deviations of the best one is not told apart from it.
_APART: Final = 2.0


@dataclass(frozen=True, slots=True)
class Rate:
    """How an error falls with the number of unknowns N.

    Attributes
    ----------
    kind : str
        ``"algebraic"``, error ~ ``N**-value``; ``"geometric"``, error ~ ``value**-N``; or
        ``"root-geometric"``, error ~ ``value**-sqrt(N)``: the one of least residual.
    value : float
        The order, or the factor by which the error falls for each unknown or each of their root.
    interval : tuple of float
        In which the value lies with the given confidence, by Student's t, as if the deviations
        from the law were random and independent.
    confidence : float
    used : tuple of int
        The points that the law is fitted to. Not used are those that are missing, rounding, or
        below what the truth can tell, and the plateau at the end.
    residuals : dict
        Root mean square of the deviations of ln(error) on these points, for every kind.
    log_factor : float
        Logarithm of the factor of the law: error = factor * ``N**-value`` and so on.
    """

    kind: str
    value: float
    interval: tuple[float, float]
    confidence: float
    used: tuple[int, ...]
    residuals: dict[str, float]
    log_factor: float

    @property
    def rivals(self) -> tuple[str, ...]:
        """The other kinds that fit nearly as well, with less than twice the deviations."""
        least = _APART * max(self.residuals[self.kind], _SCATTER)
        return tuple(k for k, left in self.residuals.items() if k != self.kind and left < least)

    def at(self, unknowns: ArrayLike) -> Array:
        """Return the error that the law gives for numbers of unknowns.

        Raises
        ------
        SceneError
            If they are not real numbers above 0.
        """
        slope = self.value if self.kind == "algebraic" else math.log(self.value)
        with np.errstate(all="ignore"):  # errors may be beyond the doubles
            numbers = reals("unknowns", unknowns, "> 0").astype(np.float64)
            if not (numbers > 0.0).all():
                raise SceneError("unknowns", unknowns, "> 0")
            errors: Array = np.exp(self.log_factor - slope * _MODELS[self.kind](numbers))
        return errors

    def __str__(self) -> str:
        low, high = self.interval
        if self.kind == "algebraic":
            return f"order {self.value:.3f} [{low:.3f}, {high:.3f}]"
        each = "unknown" if self.kind == "geometric" else "root of the unknowns"
        return f"factor {self.value:.4g} [{low:.4g}, {high:.4g}] per {each}"


def fit_rate(
    unknowns: Sequence[float | None],
    errors: Sequence[float | None],
    floor: float = 0.0,
    confidence: float = 0.95,
) -> Rate | None:
    """Fit the rate at which errors fall, the plateau of rounding left out.

    Points whose error is not above ten roundings, nor above `floor`, are left out, and those after
    them that are not above ten times that. So is the plateau: the points at the end, two or more,
    that lie above the line that the others set, if a line and a constant fit all points better
    than a line does (by Bayes's information criterion).

    Parameters
    ----------
    unknowns : sequence of (float or None)
        N, in the order of the points; None and 0 are left out.
    errors : sequence of (float or None)
        Relative errors; None and infinite ones are left out.
    floor : float
        Errors below it say nothing: ten times the error of the truth, say.
    confidence : float
        Of the interval, in (0, 1).

    Returns
    -------
    Rate or None
        None if fewer than three points are left, or all have the same N.

    Raises
    ------
    SceneError
        If the lists have different lengths, or hold anything else than None and real numbers:
        unknowns below 1e15, and errors that are not negative; or if `floor` or `confidence` are
        out of range.

    Examples
    --------
    >>> rate = fit_rate([10, 20, 40, 80, 160], [1e-2, 2.6e-3, 6e-4, 1.6e-4, 3.9e-5])
    >>> print(rate)
    order 2.003 [1.952, 2.053]
    >>> print(fit_rate([4, 8, 12, 16, 20, 24], [1e-2, 1e-5, 1e-8, 1e-11, 3e-13, 4e-13]).used)
    (0, 1, 2, 3)
    """
    # scipy.special takes long to import, and errors without a rate need none of it
    from scipy.special import stdtrit

    share = within("confidence", confidence, "in (0, 1)")
    least = real("floor", floor, allowed=">= 0", low=0.0, infinite_ok=True)
    counts = _optional("unknowns", unknowns, _MOST)
    found = _optional("errors", errors, math.inf)
    if len(counts) != len(found):
        raise SceneError("unknowns, errors", (unknowns, errors), "lists of the same length")
    used = _above(counts, found, max(least, _ROUNDING))
    numbers = np.array([counts[i] for i in used], dtype=float)
    logs = np.log(np.array([found[i] for i in used], dtype=float))
    if len(used) < _FEWEST or np.ptp(numbers) == 0.0:
        return None
    count = _before_plateau(numbers, logs)
    numbers, logs = numbers[:count], logs[:count]
    lines = {kind: _line(scale(numbers), logs) for kind, scale in _MODELS.items()}
    kind = min(lines, key=lambda name: lines[name].squares)
    line, x = lines[kind], _MODELS[kind](numbers)
    variance = line.squares / (count - 2) / np.sum((x - x.mean()) ** 2)
    half = stdtrit(count - 2, 0.5 + share / 2.0) * math.sqrt(variance)
    with np.errstate(over="ignore"):
        law = np.positive if kind == "algebraic" else np.exp
        low, value, high = (float(law(-line.slope + step)) for step in (-half, 0.0, half))
    residuals = {name: math.sqrt(one.squares / count) for name, one in lines.items()}
    return Rate(kind, value, (low, high), share, used[:count], residuals, line.intercept)


def _optional(parameter: str, values: object, high: float) -> list[float | None]:
    """Return numbers of [0, high], and None where there is none."""
    allowed = ">= 0 or None" if high == math.inf else f"in [0, {high:g}] or None"
    limits: dict[str, Any] = {"low": 0.0, "high": high, "infinite_ok": True}
    given = listed(parameter, values, "numbers")
    return [
        None if one is None else real(parameter, one, allowed=allowed, **limits) for one in given
    ]


def _above(
    unknowns: Sequence[float | None], errors: Sequence[float | None], least: float
) -> tuple[int, ...]:
    """Return the points whose error says something."""
    kept, reached = [], False
    for i, (n, e) in enumerate(zip(unknowns, errors, strict=True)):
        if not n or e is None or e == math.inf:
            continue
        if e <= least:
            reached = True
        elif e > (10.0 * least if reached else least):  # rounding scatters once it is reached
            kept.append(i)
    return tuple(kept)


class _Line(NamedTuple):
    """The line of least squares through points, and the sum of the squares of what it misses."""

    slope: float
    intercept: float
    squares: float


def _line(x: Array, y: Array) -> _Line:
    centre = x.mean()  # else a narrow range of large x would cost digits
    slope, height = (float(one) for one in np.polyfit(x - centre, y, 1))
    squares = float(np.sum((y - height - slope * (x - centre)) ** 2))
    return _Line(slope, height - slope * centre, squares)


def _before_plateau(numbers: Array, logs: Array) -> int:
    """Return how many points come before the plateau at the end; all, if there is none."""
    total = len(logs)
    best, found = math.inf, total
    for count in (total, *range(total - _FEWEST_ON_PLATEAU, _FEWEST - 1, -1)):
        if np.ptp(numbers[:count]) == 0.0:
            continue
        rest = logs[count:]
        for scale in _MODELS.values():
            x = scale(numbers)
            slope, intercept, squares = _line(x[:count], logs[:count])
            parameters = 2.0
            if len(rest):
                if slope >= 0.0 or not (rest > intercept + slope * x[count:]).all():
                    continue
                squares += float(np.sum((rest - rest.mean()) ** 2))
                parameters = 4.0
            score = total * math.log(squares / total + _SCATTER**2) + parameters * math.log(total)
            if score < best:
                best, found = score, count
    return found
