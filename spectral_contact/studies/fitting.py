"""Straight lines through measured points, and the rate at which errors fall, with intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, real, reals, within
from spectral_contact.io.choices import listed

#: Errors this small are rounding, whatever they are.
_ROUNDING = 10.0 * 2.0**-52
_FEWEST, _FEWEST_ON_PLATEAU = 3, 2
#: More unknowns than any solver has, and few enough to take squares of.
_MOST: Final = 1e15
#: Scatter of ln(error) that is not taken for structure: 5 per cent.
_SCATTER = 0.05
#: Models of ln(error) as a line, by what it is a line in.
_MODELS: Final[dict[str, Callable[[Array], Array]]] = {
    "algebraic": np.log,
    "geometric": np.positive,
    "root-geometric": np.sqrt,
}
#: A law that leaves less than twice the deviations of the best one is not told apart from it.
_APART: Final = 2.0


@dataclass(frozen=True, slots=True)
class Line:
    """The line of least squares through points.

    Attributes
    ----------
    slope, intercept : float
    interval : tuple of float
        In which the slope lies with the given confidence, by Student's t, as if the deviations
        from the line were random and independent.
    confidence : float
    residual : float
        Root mean square of the deviations.
    count : int
        Number of points.
    """

    slope: float
    intercept: float
    interval: tuple[float, float]
    confidence: float
    residual: float
    count: int


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
        In which the value lies with the given confidence; see `Line`.
    confidence : float
    used : tuple of int
        The points that the line goes through. Not used are those that are missing, rounding, or
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
    def factor(self) -> float:
        """The factor of the law; infinite beyond the doubles."""
        return _exp(self.log_factor)

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
        given = reals("unknowns", unknowns, "> 0")
        with np.errstate(over="ignore"):  # a long double may be beyond the doubles
            numbers = given.astype(np.float64)
        if not (numbers > 0.0).all():
            raise SceneError("unknowns", unknowns, "> 0")
        with np.errstate(all="ignore"):  # errors may be beyond the doubles
            errors: Array = np.exp(self.log_factor - slope * _MODELS[self.kind](numbers))
        return errors

    def __str__(self) -> str:
        low, high = self.interval
        if self.kind == "algebraic":
            return f"order {self.value:.3f} [{low:.3f}, {high:.3f}]"
        each = "unknown" if self.kind == "geometric" else "root of the unknowns"
        return f"factor {self.value:.4g} [{low:.4g}, {high:.4g}] per {each}"


def fit_line(x: ArrayLike, y: ArrayLike, confidence: float = 0.95) -> Line:
    """Fit a line by least squares.

    A growth is fitted with it as well: that of a power law is the slope over logarithms.

    Parameters
    ----------
    x, y : array_like
        At least three points of two different x.
    confidence : float
        Of the interval, in (0, 1).

    Returns
    -------
    Line

    Raises
    ------
    SceneError
        For fewer points, values that are not finite real numbers, or a line that is beyond the
        doubles.

    Examples
    --------
    >>> line = fit_line([0, 1, 2, 3], [1.0, 3.1, 4.9, 7.0])
    >>> print(f"{line.slope:.2f} in [{line.interval[0]:.2f}, {line.interval[1]:.2f}]")
    1.98 in [1.80, 2.16]
    """
    # scipy.special takes long to import, and errors without a rate need none of it
    from scipy.special import stdtrit

    share = within("confidence", confidence, "in (0, 1)")
    abscissae, values = finite("x", x), finite("y", y)
    if len(abscissae) != len(values) or len(values) < _FEWEST:
        raise SceneError("x, y", (x, y), f"two lists of the same length, at least {_FEWEST}")
    if len(set(abscissae.tolist())) < 2:
        raise SceneError("x", x, "of at least two different values")
    # powers of two off: no square is beyond the doubles, and no bit is another
    scaled_x, power_x = _scaled(abscissae)
    scaled_y, power_y = _scaled(values)
    slope, intercept, squares = _least_squares(scaled_x, scaled_y)
    freedom = len(values) - 2
    spread = np.sum((scaled_x - scaled_x.mean()) ** 2)
    half = float(stdtrit(freedom, 0.5 + share / 2.0)) * math.sqrt(squares / freedom / spread)
    turn = power_y - power_x
    try:
        return Line(
            math.ldexp(slope, turn),
            math.ldexp(intercept, power_y),
            (math.ldexp(slope - half, turn), math.ldexp(slope + half, turn)),
            share,
            math.ldexp(math.sqrt(squares / len(values)), power_y),
            len(values),
        )
    except OverflowError as error:
        raise SceneError("x, y", (x, y), "of a slope within the range of a double") from error


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
    share = within("confidence", confidence, "in (0, 1)")
    least = real("floor", floor, allowed=">= 0", low=0.0, infinite_ok=True)
    counts = _optional("unknowns", unknowns, _MOST)
    found = _optional("errors", errors, math.inf)
    if len(counts) != len(found):
        raise SceneError("unknowns, errors", (unknowns, errors), "lists of the same length")
    kept = _above(counts, found, max(least, _ROUNDING))
    if len(kept) < _FEWEST or len({n for _, n, _ in kept}) < 2:
        return None
    numbers = np.array([n for _, n, _ in kept], dtype=float)
    logs = np.log([e for _, _, e in kept])
    count = _before_plateau(numbers, logs)
    numbers, logs = numbers[:count], logs[:count]
    lines = {kind: fit_line(scale(numbers), logs, share) for kind, scale in _MODELS.items()}
    kind = min(lines, key=lambda name: lines[name].residual)
    line = lines[kind]
    values = tuple(-slope for slope in (line.slope, *reversed(line.interval)))
    if kind != "algebraic":
        values = tuple(map(_exp, values))
    value, low, high = values
    return Rate(
        kind,
        value,
        (low, high),
        share,
        tuple(i for i, _, _ in kept[:count]),
        {name: one.residual for name, one in lines.items()},
        line.intercept,
    )


def _optional(parameter: str, values: object, high: float) -> list[float | None]:
    """Return numbers of [0, high], and None where there is none."""
    allowed = ">= 0 or None" if high == math.inf else f"in [0, {high:g}] or None"
    return [
        None
        if value is None
        else real(parameter, value, allowed=allowed, low=0.0, high=high, infinite_ok=True)
        for value in listed(parameter, values, "numbers")
    ]


def _exp(value: float) -> float:
    try:
        return math.exp(value)
    except OverflowError:
        return math.inf


def _scaled(values: Array) -> tuple[Array, int]:
    """Return values of at most 1, and the power of two by which they are smaller."""
    power = int(np.frexp(values)[1].max(initial=-1074, where=values != 0.0))
    return np.ldexp(values, -power), power


class _Kept(NamedTuple):
    """A point: its number, its unknowns and its error."""

    number: int
    unknowns: float
    error: float


def _above(
    unknowns: Sequence[float | None], errors: Sequence[float | None], least: float
) -> list[_Kept]:
    """Return the points whose error says something."""
    kept, reached = [], False
    for i, (n, e) in enumerate(zip(unknowns, errors, strict=True)):
        if n is None or n <= 0 or e is None or not e < math.inf:
            continue
        if e <= least:
            reached = True
        elif e > (10.0 * least if reached else least):  # rounding scatters once it is reached
            kept.append(_Kept(i, n, e))
    return kept


class _LeastSquares(NamedTuple):
    """A line through points, and the sum of the squares of what it misses."""

    slope: float
    intercept: float
    squares: float


def _least_squares(x: Array, y: Array) -> _LeastSquares:
    """Return slope, intercept and the sum of the squares that remain."""
    centred = x - x.mean()
    slope = float(centred @ (y - y.mean()) / (centred @ centred))
    intercept = float(y.mean() - slope * x.mean())
    return _LeastSquares(slope, intercept, float(np.sum((y - intercept - slope * x) ** 2)))


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
            slope, intercept, squares = _least_squares(x[:count], logs[:count])
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
