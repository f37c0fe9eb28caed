"""What studies return: every point that was measured, and what follows from them."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Final, cast

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import flag, real
from spectral_contact.io.choices import instance, one_of
from spectral_contact.scene import Scene
from spectral_contact.studies.fitting import Rate, fit_rate
from spectral_contact.studies.timing import Times

#: Quantities of which a study measures the errors.
QUANTITIES: Final = (
    *("approach", "edge_pressure", "pressure", "traction", "total_shear", "stick_radius"),
)

#: Rates do not use errors up to this many times the error of the truth; chosen.
_ABOVE_TRUTH: Final = 10.0


@dataclass(frozen=True, slots=True)
class Point:
    """One solve of a study.

    Attributes
    ----------
    solver : str
        Name of the solver.
    scene : Scene
    resolution : int or float
        The resolution that the solver was called with.
    unknowns : int or None
        ``unknowns`` of the result, or its ``work.unknowns``; else the resolution if that is a
        whole number.
    errors : dict
        True relative errors, by quantity.
    estimates : dict
        The solver's own estimates of them, from ``error`` of the result.
    times : Times or None
        None if times were not measured.
    failure : str
        The exception of the solver as text; empty if there was none.
    """

    solver: str
    scene: Scene
    resolution: float
    unknowns: int | None
    errors: dict[str, float]
    estimates: dict[str, float]
    times: Times | None
    failure: str = ""


class _Result:
    """Base of both studies: files, pictures and text.

    The modules that make these import this one. So its methods import them when they are called.
    """

    __slots__ = ()

    @property
    def _study(self) -> Study:
        return cast("Study", self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Store the study: ``.json`` whole and exact, for `load`; ``.csv`` a row for each point.

        Raises
        ------
        SolutionFileError
            For another suffix, or a path that cannot be written.
        """
        from spectral_contact.studies.study_files import save

        save(self._study, path)

    def plot(self, path: str | os.PathLike[str] | None = None) -> Any:
        """Draw the errors over warm times, and over unknowns with their rates; write the figure.

        Full markers over the unknowns are points that a rate is fitted to.

        Parameters
        ----------
        path : path, optional
            Where to write it; nothing is written without.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        MissingDependencyError
            If matplotlib is not installed.
        SolutionFileError
            For a path that cannot be written, or whose suffix is not .png, .pdf or .svg.
        """
        from spectral_contact.studies.study_pictures import drawn

        return drawn(self._study, path)

    def __str__(self) -> str:
        from spectral_contact.studies.tables import text_of

        return text_of(self._study)


@dataclass(frozen=True, slots=True)
class Convergence(_Result):
    """Error against unknowns and time, of one solver on one scene; prints as a table.

    Attributes
    ----------
    solver : str
    scene : Scene
    truth : str
        Where the true values are from.
    truth_error : dict
        Their relative errors, by quantity.
    quantities : tuple of str
    points : tuple of Point
        In the order of the resolutions.
    machine : dict
        See `this_machine`.
    """

    solver: str
    scene: Scene
    truth: str
    truth_error: dict[str, float]
    quantities: tuple[str, ...]
    points: tuple[Point, ...]
    machine: dict[str, Any]

    def rate(self, quantity: str, confidence: float = 0.95) -> Rate | None:
        """Return the fitted rate of one error; None if too few points show it: see `fit_rate`.

        Raises
        ------
        SceneError
            If the quantity is not of the study, or the confidence not in (0, 1).
        """
        one_of("quantity", quantity, self.quantities)
        return fit_rate(
            [point.unknowns for point in self.points],
            [point.errors.get(quantity) for point in self.points],
            _ABOVE_TRUTH * self.truth_error.get(quantity, 0.0),
            confidence,
        )

    @property
    def rates(self) -> dict[str, Rate | None]:
        """The rates of all errors, by quantity."""
        return {quantity: self.rate(quantity) for quantity in self.quantities}


@dataclass(frozen=True, slots=True)
class WorkPrecision(_Result):
    """Error against time of several solvers on several scenes; prints as tables.

    Attributes
    ----------
    solvers : tuple of str
        The first is the one that the others are compared with.
    scenes : tuple of Scene
    truths : tuple of str
        Where the true values are from, scene by scene.
    accuracies : tuple of float
        Relative errors to be reached, falling.
    quantities : tuple of str
    points : tuple of Point
    machine : dict
        See `this_machine`.
    """

    solvers: tuple[str, ...]
    scenes: tuple[Scene, ...]
    truths: tuple[str, ...]
    accuracies: tuple[float, ...]
    quantities: tuple[str, ...]
    points: tuple[Point, ...]
    machine: dict[str, Any]

    def of(self, solver: str, scene: Scene) -> tuple[Point, ...]:
        """Return the points of one solver on one scene, in the order of the resolutions.

        Raises
        ------
        SceneError
            If the study has no such solver or scene.
        """
        one_of("solver", solver, self.solvers)
        if instance("scene", scene, Scene) not in self.scenes:
            raise SceneError("scene", scene, "a scene of the study")
        return tuple(p for p in self.points if p.solver == solver and p.scene == scene)

    def reached(
        self, solver: str, scene: Scene, quantity: str, accuracy: float, *, cold: bool = False
    ) -> float | None:
        """Return the least time [s] in which a solver reached an accuracy.

        Parameters
        ----------
        solver, scene, quantity
            Of this study.
        accuracy : float
            Relative error.
        cold : bool
            Take the cold times; the warm ones are taken otherwise.

        Returns
        -------
        float or None
            The least median; None if the accuracy was not reached, or there are no such times.

        Raises
        ------
        SceneError
            If the study has no such solver, scene or quantity, or the accuracy is no real number.
        """
        one_of("quantity", quantity, self.quantities)
        accuracy = real("accuracy", accuracy, allowed=">= 0", low=0.0, infinite_ok=True)
        flag("cold", cold)
        times = []
        for point in self.of(solver, scene):
            if point.times is not None and point.errors.get(quantity, math.inf) <= accuracy:
                taken = point.times.cold if cold else point.times.warm
                times += [] if taken is None else [taken.median]
        return min(times, default=None)


Study = Convergence | WorkPrecision
