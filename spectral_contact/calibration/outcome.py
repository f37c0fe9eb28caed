"""What a fit returns: the parameters with their uncertainty, and how well they fit the data."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from itertools import count
from typing import Any, Final

import numpy as np

from spectral_contact.errors import ConvergenceError
from spectral_contact.fields import Array
from spectral_contact.io.checks import real, whole, within
from spectral_contact.io.documents import check_keys, check_schema, reported
from spectral_contact.scene import Scene
from spectral_contact.view.progress import ProgressLine

_SCHEMA: Final = "spectral_contact.fit"
_VERSION: Final = 1


@dataclass(frozen=True, slots=True)
class FittedParameter:
    """A parameter and its uncertainty.

    Attributes
    ----------
    name : str
        ``"normal_compliance"``, ``"tangential_compliance"`` or ``"friction"``.
    value : float
        In m/Pa or dimensionless, as the scene is.
    relative_error : float
        Standard deviation of its logarithm: of the parameter itself, relative, where it is small.
    """

    name: str
    value: float
    relative_error: float

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval in which the parameter lies with a confidence in (0, 1).

        It takes the logarithm for normally distributed, hence is not symmetric.
        """
        from scipy.special import ndtri  # takes long to import

        share = within("confidence", confidence, "in (0, 1)")
        factor = math.exp(float(ndtri(0.5 + 0.5 * share)) * self.relative_error)
        return self.value / factor, self.value * factor


@dataclass(frozen=True, slots=True)
class RoughnessFit:
    """The outcome of a fit; made by `fit`, immutable, comparable, stored by `to_json`.

    Attributes
    ----------
    scene : Scene
        The scene with the parameters that fit best.
    parameters : tuple of FittedParameter
        In the order in which they were asked for; ``fit["friction"]`` is one of them.
    covariance : tuple of tuple of float
        That of their logarithms, (JᵀJ)⁻¹ with the derivatives J of the weighted residuals. It
        takes the standard deviations of the data for known; it is not scaled by the misfit.
    residuals : tuple of tuple of float
        For every data set, theory minus measurement over standard deviation.
    evaluations : int
        How often the data were predicted, derivatives not counted.
    """

    scene: Scene
    parameters: tuple[FittedParameter, ...]
    covariance: tuple[tuple[float, ...], ...]
    residuals: tuple[tuple[float, ...], ...]
    evaluations: int

    def __getitem__(self, name: str) -> FittedParameter:
        for one in self.parameters:
            if one.name == name:
                return one
        raise KeyError(name)

    @property
    def chi_square(self) -> float:
        """Sum of the squares of all residuals."""
        return math.fsum(one * one for data in self.residuals for one in data)

    @property
    def degrees_of_freedom(self) -> int:
        """Number of values measured less that of the parameters."""
        return sum(map(len, self.residuals)) - len(self.parameters)

    @property
    def reduced_chi_square(self) -> float | None:
        """χ² per degree of freedom, near 1 for a good fit; None if there is none."""
        freedom = self.degrees_of_freedom
        return self.chi_square / freedom if freedom else None

    @property
    def p_value(self) -> float | None:
        """How likely χ² is this large or larger if theory and deviations hold; None as above."""
        from scipy.special import chdtrc  # takes long to import

        freedom = self.degrees_of_freedom
        return float(chdtrc(freedom, self.chi_square)) if freedom else None

    @property
    def correlation(self) -> Array:
        """Correlations of the logarithms, shape (parameters, parameters)."""
        covariance = np.array(self.covariance)
        errors = np.sqrt(np.diag(covariance))
        return np.asarray(covariance / np.outer(errors, errors))

    def __str__(self) -> str:
        unit = "" if self.scene.physical is None else " m/Pa"
        lines = [f"{'parameter':<22} {'value':>12}  95 % interval"]
        for one in self.parameters:
            low, high = one.interval()
            of = "" if one.name == "friction" else unit
            lines.append(f"{one.name:<22} {one.value:12.5g}  {low:.5g} to {high:.5g}{of}")
        correlation = self.correlation
        for j, second in enumerate(self.parameters):
            for i, first in enumerate(self.parameters[:j]):
                lines.append(f"correlation {correlation[i, j]:+.2f}  {first.name}, {second.name}")
        freedom = self.degrees_of_freedom
        p = self.p_value
        lines.append(f"chi square {self.chi_square:.4g} at {freedom} degrees of freedom")
        if p is not None:
            lines[-1] += f", p = {p:.2g}"
        return "\n".join(lines)

    def to_json(self) -> str:
        """Return the fit as one line of strict JSON; its numbers are exact."""
        document = {"schema": _SCHEMA, "version": _VERSION, **asdict(self)}
        return json.dumps({**document, "scene": self.scene.to_dict()}, allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> RoughnessFit:
        """Return the fit that `to_json` wrote, equal to it bit for bit.

        Raises
        ------
        SolutionFileError
            If the text is not JSON, not ours, damaged, or of another version.
        """
        with reported("fit", "not a fit"):
            document: dict[str, Any] = json.loads(text)
            check_schema(document, "fit", _SCHEMA, _VERSION)
            check_keys("", document, ("schema", "version", *(one.name for one in fields(cls))))
            return cls(
                Scene.from_dict(document["scene"]),
                tuple(
                    FittedParameter(one["name"], *_numbers([one["value"], one["relative_error"]]))
                    for one in document["parameters"]
                ),
                tuple(map(_numbers, document["covariance"])),
                tuple(map(_numbers, document["residuals"])),
                whole("evaluations", document["evaluations"], 1),
            )


def _numbers(values: list[object]) -> tuple[float, ...]:
    return tuple(real("number", value, allowed="finite") for value in values)


def least_squares_fit(
    residuals: Callable[[Array], Array], start: Any, most: int, tell: ProgressLine, **how: Any
) -> Any:
    """Return what SciPy's least squares find; every evaluation is told.

    Raises
    ------
    ConvergenceError
        If they ended for lack of evaluations.
    """
    from scipy.optimize import least_squares  # takes long to import

    steps = count(1)

    def told(x: Array) -> Array:
        tell(f"evaluation {next(steps)}")
        return residuals(x)

    found = least_squares(told, start, max_nfev=most, **how)
    if found.status == 0:
        raise ConvergenceError(
            f"the fit has not settled after {most} evaluations",
            "start nearer to the answer, free fewer parameters, or raise max_evaluations.",
        )
    return found
