"""The fit of a force-indentation curve, through a linear layer or any other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spectral_contact.calibration.indentation import (
    INDENTATION_PARAMETERS,
    CurveProblem,
    IndentationData,
    IndentationFit,
)
from spectral_contact.calibration.layered import LawProblem
from spectral_contact.calibration.outcome import least_squares_fit
from spectral_contact.inputs.choices import names
from spectral_contact.scene import Scene
from spectral_contact.view.progress import ProgressLine

#: What ends the search, of the tolerance of the solves.
_SETTLED = 1e-2


def fit_indentation(
    scene: Scene,
    data: IndentationData,
    free: str | Sequence[str] = INDENTATION_PARAMETERS,
    *,
    rtol: float = 1e-10,
    max_evaluations: int = 100,
    progress: bool | None = None,
) -> IndentationFit:
    """Return the fit of a force-indentation curve; arguments and errors are those of `fit`."""
    kind = CurveProblem if scene.layer is None else LawProblem
    free = names("free", [free] if isinstance(free, str) else free, kind.parameters(scene))
    problem = kind(scene, data, tuple(free), rtol)
    limits, end = problem.bounds(), max(1e-12, _SETTLED * rtol)
    with ProgressLine(progress) as tell:
        tell("the first curve")
        problem.look()
        found = least_squares_fit(
            lambda x: np.asarray(problem.at(tuple(x.tolist()))[0]),
            problem.start,
            max_evaluations,
            tell,
            jac=lambda x: problem.at(tuple(x.tolist()))[1],
            bounds=limits,
            x_scale=problem.scale,
            **dict.fromkeys(("ftol", "xtol", "gtol"), end),
        )
    return problem.outcome(found)
