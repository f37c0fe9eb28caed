"""The fit of a force-indentation curve, through a linear layer or any other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from spectral_contact.calibration.indentation_curve import CurveProblem, IndentationFit
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.calibration.layered_fits import LawProblem
from spectral_contact.calibration.outcome import least_squares_fit
from spectral_contact.io.choices import names
from spectral_contact.scene import Scene
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

#: What ends the search, over the tolerance of the solves.
_SETTLED: Final = 1e-2


def fit_curve(
    scene: Scene,
    data: IndentationData,
    free: str | Sequence[str],
    rtol: float,
    most: int,
    progress: bool | None,
) -> IndentationFit:
    """Return the fit of a curve; arguments and errors are those of `fit`."""
    kind = CurveProblem if scene.layer is None else LawProblem
    free = names("free", [free] if isinstance(free, str) else free, kind.parameters(scene))
    problem = kind(scene, data, tuple(free), rtol)
    limits, end = problem.bounds(), max(1e-12, _SETTLED * rtol)
    with one_thread(), ProgressLine(progress) as tell:
        tell("the first curve")
        problem.look()
        found = least_squares_fit(
            lambda x: np.asarray(problem.at(tuple(x.tolist()))[0]),
            problem.start,
            most,
            tell,
            jac=lambda x: problem.at(tuple(x.tolist()))[1],
            bounds=limits,
            x_scale=problem.scale,
            **dict.fromkeys(("ftol", "xtol", "gtol"), end),
        )
    return problem.outcome(found)
