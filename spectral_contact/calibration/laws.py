"""Which law do the data speak for? Fits of several layers, compared by an information criterion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from spectral_contact.calibration.estimate import fit
from spectral_contact.calibration.indentation import IndentationData, IndentationFit
from spectral_contact.errors import SceneError
from spectral_contact.inputs.choices import instance
from spectral_contact.scene import Scene
from spectral_contact.view.progress import ProgressLine

__all__ = ["LawComparison", "compare_laws"]

#: A law whose criterion is larger by more is ruled out: the other is twenty times as likely.
_RULED_OUT: Final = 6.0


@dataclass(frozen=True, slots=True)
class LawComparison:
    """Fits of several laws to the same data.

    Attributes
    ----------
    names : tuple of str
        As they were given.
    fits : tuple of IndentationFit
        In their order.
    """

    names: tuple[str, ...]
    fits: tuple[IndentationFit, ...]

    def __getitem__(self, name: str) -> IndentationFit:
        if name not in self.names:
            raise KeyError(name)
        return self.fits[self.names.index(name)]

    @property
    def criterion(self) -> tuple[float, ...]:
        """Akaike's criterion of each, corrected for few data (AICc).

        With k parameters and n loads of known deviations ``chi² + 2 k + 2 k (k + 1)/(n - k - 1)``.
        """
        return tuple(_corrected(one) for one in self.fits)

    @property
    def weights(self) -> tuple[float, ...]:
        """How likely each is to be the best of them, by Akaike's weights; their sum is 1."""
        least = min(self.criterion)
        shares = [math.exp(-0.5 * (one - least)) for one in self.criterion]
        return tuple(one / math.fsum(shares) for one in shares)

    @property
    def best(self) -> str:
        """The name of the law with the least criterion."""
        return self.names[self.criterion.index(min(self.criterion))]

    @property
    def alike(self) -> tuple[str, ...]:
        """Laws that the data do not rule out, which are those within 6 of the best criterion."""
        least = min(self.criterion)
        both = zip(self.names, self.criterion, strict=True)
        return tuple(name for name, one in both if one - least <= _RULED_OUT)

    def __str__(self) -> str:
        lines = [f"{'law':<24} {'chi square':>10} {'at':>4} {'AICc - least':>13} {'weight':>8}"]
        least = min(self.criterion)
        for name, one, value, weight in zip(
            self.names, self.fits, self.criterion, self.weights, strict=True
        ):
            cells = f"{one.chi_square:10.4g} {one.degrees_of_freedom:4d} {value - least:13.4g}"
            lines.append(f"{name:<24} {cells} {weight:8.2g}")
        verdict = f"the data speak for: {self.best}"
        if len(self.alike) > 1:
            verdict = f"the data do not tell apart: {', '.join(self.alike)}"
        return "\n".join([*lines, verdict])


def compare_laws(
    candidates: Mapping[str, tuple[Scene, str | Sequence[str]]],
    data: IndentationData,
    *,
    rtol: float = 1e-8,
    max_evaluations: int = 200,
    progress: bool | None = None,
) -> LawComparison:
    """Fit several laws to the same data, and say which they speak for, or that they do not tell.

    Parameters
    ----------
    candidates : mapping of str to (Scene, str or sequence of str)
        For each law, by any name, where its fit starts and which parameters are free, as in `fit`.
    data : IndentationData
        With at least two loads more than a law has free parameters.
    rtol : float
        Tolerance of the solves, in [1e-12, 1e-4].
    max_evaluations : int
        How often a curve may be predicted.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    LawComparison

    Raises
    ------
    SceneError
        For an argument out of its range, and for parameters that the data do not determine.
    ConvergenceError
        If a solve does not meet `rtol`, or `max_evaluations` are not enough.
    """
    told = "a mapping of two names or more to a scene and its free parameters each"
    if not isinstance(candidates, Mapping) or len(candidates) < 2:
        raise SceneError("candidates", candidates, told)
    instance("data", data, IndentationData)
    ProgressLine(progress)  # refuses what it cannot be
    fits = []
    for name, given in candidates.items():
        if not (isinstance(name, str) and isinstance(given, tuple) and len(given) == 2):
            raise SceneError("candidates", candidates, told)
        scene, free = given
        count = 1 if isinstance(free, str) else len(free) if isinstance(free, Sequence) else 0
        if len(data.load) < count + 2:
            told = f"of at least {count + 2} loads, for {count} free parameters of {name}"
            raise SceneError("data", data, told)
        fits.append(_fitted(name, scene, data, free, rtol, max_evaluations, progress))
    return LawComparison(tuple(candidates), tuple(fits))


def _fitted(name: str, scene: Any, data: IndentationData, free: Any, *how: Any) -> IndentationFit:
    """Return the fit of a candidate; an error says of which."""
    rtol, most, progress = how
    try:
        return fit(scene, data, free, rtol=rtol, max_evaluations=most, progress=progress)
    except SceneError as error:
        if error.parameter in ("rtol", "max_evaluations"):
            raise
        told = f"{error.allowed} (the candidate {name!r})"
        raise SceneError(error.parameter, error.value, told) from error


def _corrected(one: IndentationFit) -> float:
    k, left = len(one.names), one.degrees_of_freedom - 1
    return one.chi_square + 2.0 * k + 2.0 * k * (k + 1) / left
