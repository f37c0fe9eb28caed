"""The figures: which scenes, what is measured of each, and the numbers; nothing is drawn."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import inf

import numpy as np
from paper_onset import slip_onset
from paper_tables import RADII, WORDS, FigureData, PaperFigure

from spectral_contact.fields import Array
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve


def figure_data(name: str, rtol: float = 1e-9) -> FigureData:
    """Compute the numbers of a figure out of ``FIGURES``, every solve to this tolerance."""
    figure = paper_figure(name)
    return FigureData(
        figure, rtol, np.concatenate([figure.rows_of(s, rtol) for s in figure.scenes])
    )


# --- what is measured of a scene ------------------------------------------------------------------


def _pressure(scene: Scene, rtol: float) -> Array:
    solution = solve(scene, rtol, ("pressure",))
    values = RADII.evaluate(solution.pressure)
    return np.column_stack([values, np.full_like(values, solution.error.pressure)])


def _traction(scene: Scene, rtol: float) -> Array:
    """Return the traction and the stick radius.

    In a stick disk q is a function of s/c: at a given radius twice the error of c comes on top.
    """
    solution = solve(scene, rtol, ("traction", "zones", "stick_radius"))
    error = solution.error
    assert error.traction is not None
    assert error.zones is not None
    values = RADII.evaluate(solution.traction)
    rest = error.traction + 2.0 * error.zones, solution.stick_radius, error.stick_radius
    return np.column_stack([values, np.tile(np.array(rest, dtype=float), (len(values), 1))])


def _scalars(names: tuple[str, ...], scene: Scene, rtol: float) -> Array:
    solution = solve(scene, rtol, names)
    pairs = [(getattr(solution, name), getattr(solution.error, name)) for name in names]
    return np.array([pairs], dtype=float).reshape(1, -1)


def _onset(scene: Scene, rtol: float) -> Array:
    found = slip_onset(scene, rtol)
    critical = found.critical_friction, found.critical_error
    edge = found.edge_ratio, found.edge_error
    return np.array([[*critical, *edge, found.from_edge, found.from_edge_error]])


# --- the figures ----------------------------------------------------------------------------------


#: Compliances of Figure 4: those that the paper names, and two more.
_PAIRS = ((0.5, 0.2), (0.5, 0.5), (0.2, 0.5), (0.5, 1.0), (0.2, 0.2), (0.05, 1.0))
_FRICTIONS = (0.02, 0.04, 0.06, 0.08, 0.1, inf)
#: Both compliances of the figure of the onset.
_ROUGH = [10.0 ** (i / 10.0 - 3.0) for i in range(41)]
#: By figure: its scenes in order, and what is measured of each.
_MADE: dict[str, tuple[list[Scene], Callable[[Scene, float], Array]]] = {
    "2": ([Scene(0.3, alpha, 0.0, 0.0) for alpha in (0.0, 0.05, 0.1, 0.2, 0.5, 1.0)], _pressure),
    "3": (
        [Scene(0.3, 0.5, beta, inf) for beta in (0.0, 0.1, 0.2, 0.5, 1.0)],
        lambda scene, rtol: _traction(scene, rtol)[:, :2],
    ),
    "4": (
        [Scene(i / 100.0, *pair, inf) for pair in _PAIRS for i in range(51)],
        partial(_scalars, ("edge_ratio", "critical_friction")),
    ),
    "5": ([Scene(nu, 0.5, 0.5, f) for nu in (0.1, 0.3) for f in _FRICTIONS], _traction),
    "6": (
        [Scene(i / 10.0, 0.5, 0.5, j / 400.0) for i in range(5) for j in range(81)],
        partial(_scalars, ("stick_radius", "total_shear", "critical_friction")),
    ),
    "onset": ([Scene(0.3, alpha, beta, inf) for alpha in _ROUGH for beta in _ROUGH], _onset),
}


#: The figures that can be made: the paper's by their numbers, and the one that it lacks.
FIGURES = tuple(_MADE)


def paper_figure(name: str) -> PaperFigure:
    """Return what a figure out of ``FIGURES`` shows."""
    scenes, measure = _MADE[name]
    return PaperFigure(name, tuple(scenes), measure, **WORDS["figure"][name])
