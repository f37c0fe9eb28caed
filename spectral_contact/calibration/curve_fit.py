"""The fit of a force-indentation curve, through a linear layer or any other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

import numpy as np

from spectral_contact.calibration.indentation import (
    INDENTATION_PARAMETERS,
    CurveProblem,
    IndentationData,
    IndentationFit,
)
from spectral_contact.calibration.layered import LawProblem
from spectral_contact.calibration.outcome import check_settled
from spectral_contact.fields import Array
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
    """Find modulus, layer and zero point that fit a force-indentation curve best.

    Minimises the sum of the squares of (theory - measurement)/sigma by
    `scipy.optimize.least_squares`, with exact derivatives; `fit` calls it.

    Parameters
    ----------
    scene : Scene
        From `Scene.from_physical`, with a profile and without friction: what is known, and modulus
        and compliance at which to start. Its load, radius or approach does not matter.
    data : IndentationData
    free : str or sequence of str
        Out of ``"reduced_modulus"``, ``"normal_compliance"`` and ``"zero_point"``; the zero point
        is 0 if it is not free. With a nonlinear layer the numbers of its law are in the place of
        the compliance, as ``"coefficient"`` and ``"exponent"``.
    rtol : float
        Tolerance of the solves, in [1e-12, 1e-4].
    max_evaluations : int
        How often the curve may be predicted.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    IndentationFit

    Raises
    ------
    SceneError
        For an argument out of its range, and for parameters that the data do not determine.
    ConvergenceError
        If a solve does not meet `rtol`, or `max_evaluations` are not enough.
    """
    from scipy.optimize import least_squares  # takes long to import

    kind = CurveProblem if scene.layer is None else LawProblem
    free = names("free", [free] if isinstance(free, str) else free, kind.parameters(scene))
    problem = kind(scene, data, tuple(free), rtol)
    limits, end = problem.bounds(), max(1e-12, _SETTLED * rtol)
    steps = count(1)
    with ProgressLine(progress) as tell:

        def residuals(x: Array) -> Array:
            tell(f"evaluation {next(steps)}")
            return np.asarray(problem.at(tuple(x.tolist()))[0])

        tell("the first curve")
        problem.look()
        found = least_squares(
            residuals,
            problem.start,
            jac=lambda x: problem.at(tuple(x.tolist()))[1],
            bounds=limits,
            x_scale=problem.scale,
            ftol=end,
            xtol=end,
            gtol=end,
            max_nfev=max_evaluations,
        )
    check_settled(found, max_evaluations)
    return problem.outcome(found)
