"""The rate at which errors fall with the number of unknowns, with its interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import real, reals, within
from spectral_contact.io.choices import listed

#: Errors up to this are taken for rounding.
_ROUNDING: Final = 10.0 * 2.0**-52
#: Fewest points that a law is fitted to, and fewest points of a plateau.
_FEWEST: Final = 3
_FEWEST_ON_PLATEAU: Final = 2
#: Largest number of unknowns that is accepted, more than any solver has.
_MOST_UNKNOWNS: Final = 1e15
#: Deviations of ln(error) up to this, 5 per cent, do not speak against a law; chosen.
_SCATTER: Final = 0.05
#: The functions of N in which ln(error) is a line, by the kind of the law.
_MODELS: Final[dict[str, Callable[[Array], Array]]] = {
    "algebraic": np.log,
    "geometric": np.positive,
    "root-geometric": np.sqrt,
}
#: A law whose deviations are less than this many times those of the best law may be the right one.
_APART: Final = 2.0


@dataclass(frozen=True, slots=True)
class Rate:
    """How an error falls with the number of unknowns N.

    Attributes
    ----------
    kind : str
        ``"algebraic"``, error ~ ``N**-value``; ``"geometric"``, error ~ ``value**-N``; or
        ``"root-geometric"``, error ~ ``value**-sqrt(N)``: the one that fits best, by Bayes's
        information criterion. If no plateau is left out that is the one of least residual.
    value : float
        The order, or the factor by which the error falls for each further unknown, or for each
        increase of their root by one.
    interval : tuple of float
        Ends of the interval in which the value lies with the given confidence, by Student's t, as
        if the deviations from the law were random and independent.
    confidence : float
    used : tuple of int
        Numbers, from 0, of the points that the law is fitted to. Points that are missing, rounding,
        or not above the floor are not used, nor is the plateau at the end.
    residuals : dict
        Root mean square of the deviations of ln(error) on these points, by kind.
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
        """The other kinds that fit nearly as well, with less than twice the residual.

        Residuals up to 5 per cent count as good.
        """
        limit = _APART * max(self.residuals[self.kind], _SCATTER)
        others = {kind: one for kind, one in self.residuals.items() if kind != self.kind}
        return tuple(kind for kind, residual in others.items() if residual < limit)

    def at(self, unknowns: ArrayLike) -> Array:
        """Return the error that the law gives for numbers of unknowns.

        It is NaN where the factor of the law is 0 or infinite, which is beyond the doubles.

        Raises
        ------
        SceneError
            If they are not real numbers above 0.
        """
        slope = self.value
        if self.kind != "algebraic":
            known = 0.0 < self.value < math.inf
            slope = math.log(self.value) if known else math.nan
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

    Errors that are no larger than `floor`, or than ten roundings if that is more, are left out;
    after the first of them errors up to ten times as large are left out, too. So is the plateau:
    the points at the end, two or more, that lie above the line that the others set, if a line and a
    constant fit all points better than a line does (by Bayes's information criterion).

    Parameters
    ----------
    unknowns : sequence of (float or None)
        N, in the order of the points; None and 0 are left out.
    errors : sequence of (float or None)
        Relative errors; None and infinite ones are left out.
    floor : float
        Errors up to this are left out: give ten times the error of the truth, say.
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
        unknowns that are 0 or in [1, 1e15], and errors that are not negative; or if `floor` or
        `confidence` are out of range.

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

    confidence = within("confidence", confidence, "in (0, 1)")
    floor = max(real("floor", floor, allowed=">= 0", low=0.0, infinite_ok=True), _ROUNDING)
    counts = _optional("unknowns", unknowns, f"0 or in [1, {_MOST_UNKNOWNS:g}], or None")
    known = _optional("errors", errors, ">= 0 (or inf), or None")
    if len(counts) != len(known):
        raise SceneError("unknowns, errors", (unknowns, errors), "lists of the same length")
    present = np.flatnonzero((counts > 0.0) & (known < math.inf))
    # after the first error that is rounding, others above the floor may be rounding, too
    reached = np.logical_or.accumulate(known[present] <= floor)
    used = present[known[present] > np.where(reached, 10.0 * floor, floor)]
    laws = _laws(counts[used], np.log(known[used]))
    if not laws:
        return None
    best = min(laws, key=lambda law: law.score)
    same_points = [law for law in laws if law.points == best.points]
    half_width = stdtrit(best.points - 2, 0.5 + confidence / 2.0) * best.slope_error
    with np.errstate(over="ignore"):
        value_of = np.positive if best.kind == "algebraic" else np.exp
        # the slope is negative for errors that fall
        low, value, high = (
            float(value_of(-best.slope + step)) for step in (-half_width, 0.0, half_width)
        )
    residuals = {law.kind: math.sqrt(law.squares / law.points) for law in same_points}
    points = tuple(map(int, used[: best.points]))
    return Rate(best.kind, value, (low, high), confidence, points, residuals, best.intercept)


def _optional(parameter: str, values: object, allowed: str) -> Array:
    """Return numbers of a range in words, as `within` reads it, NaN where there is none."""
    return np.array(
        [
            math.nan if one is None else within(parameter, one, allowed)
            for one in listed(parameter, values, "numbers")
        ]
    )


class _FittedLaw(NamedTuple):
    """A law that is fitted to the first points, the others being a plateau.

    Attributes
    ----------
    kind : str
    points : int
        Number of points that it is fitted to.
    slope, slope_error, intercept : float
        Of the line in ln(error), and the standard deviation of the slope.
    squares : float
        Sum of the squared deviations of ln(error) at these points.
    score : float
        Bayes's information criterion of the law and the plateau, for all points.
    """

    kind: str
    points: int
    slope: float
    slope_error: float
    intercept: float
    squares: float
    score: float


def _laws(numbers: Array, logs: Array) -> list[_FittedLaw]:
    """Return every law that the points allow, through all of them or those before a plateau."""
    total = len(logs)
    found = []
    for count in (total, *range(total - _FEWEST_ON_PLATEAU, _FEWEST - 1, -1)):
        if count < _FEWEST or np.ptp(numbers[:count]) == 0.0:
            continue
        plateau = logs[count:]
        for kind, scale in _MODELS.items():
            centre = scale(numbers[:count]).mean()  # else a narrow range would cost digits
            x = scale(numbers) - centre
            if np.ptp(x[:count]) == 0.0:  # numbers so large that their logarithms are equal
                continue
            (slope, height), covariance = np.polyfit(x[:count], logs[:count], 1, cov=True)
            deviations = logs - height - slope * x
            # a plateau lies above the line that falls
            if len(plateau) and (slope >= 0.0 or deviations[count:].min() <= 0.0):
                continue
            squares = float(np.sum(deviations[:count] ** 2))
            around = float(np.sum((plateau - plateau.mean()) ** 2)) if len(plateau) else 0.0
            scatter = (squares + around) / total + _SCATTER**2
            # slope and intercept; with a plateau its height and where it begins, too
            parameters = 4.0 if len(plateau) else 2.0
            score = total * math.log(scatter) + parameters * math.log(total)
            error = math.sqrt(covariance[0, 0])
            intercept = float(height - slope * centre)
            found.append(_FittedLaw(kind, count, float(slope), error, intercept, squares, score))
    return found
