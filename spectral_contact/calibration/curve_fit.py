"""The fit of a force-indentation curve: through a linear layer, any other, or with adhesion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from spectral_contact.calibration.adhesive_fits import AdhesiveProblem
from spectral_contact.calibration.indentation_curve import CurveProblem, IndentationFit
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.calibration.layered_fits import LawProblem
from spectral_contact.calibration.outcome import least_squares_fit
from spectral_contact.fields import Array
from spectral_contact.io.choices import names
from spectral_contact.scene import Scene
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

#: Tolerance of the curves of a first search.
_ROUGH: Final = 1e-4


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
    if scene.work_of_adhesion is not None:
        kind = AdhesiveProblem
    free = names("free", [free] if isinstance(free, str) else free, kind.parameters(scene))
    problem = kind(scene, data, tuple(free), rtol)
    limits = np.array(problem.bounds())
    # for most of the way curves with a few digits are enough
    rough = max(rtol, _ROUGH)
    with one_thread(), ProgressLine(progress) as tell:
        tell("the first curve")
        problem.take_tolerance(rough)
        problem.improve_start()
        problem.look()
        # of y, what is searched: x in units of its scale, and 1 at the start
        bounds = 1.0 + (limits - problem.start) / problem.scale

        def search(y: Array, tolerance: float) -> Any:
            return least_squares_fit(
                problem.residuals,
                y,
                most,
                tell,
                jac=problem.jacobian,
                bounds=bounds,
                **dict.fromkeys(("ftol", "xtol", "gtol"), tolerance),
            )

        found = search(np.ones(len(free)), rough)
        while problem.revises_rows(found.x):
            found = search(found.x, rough)
        if rtol < rough:
            problem.take_tolerance(rtol)
            found = search(found.x, rtol)
        y = found.x
    return problem.outcome(y, found.active_mask)
