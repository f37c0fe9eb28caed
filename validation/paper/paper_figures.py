"""The figures: which scenes, what is measured of each, and the numbers; nothing is drawn."""

from __future__ import annotations

from functools import cache, partial
from math import inf

import numpy as np
from paper_onset import slip_onset
from paper_tables import RADII, FigureData, PaperFigure

from spectral_contact.fields import Array
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve

#: The figures that can be made: the paper's by their numbers, and the one that it lacks.
FIGURES = ("2", "3", "4", "5", "6", "onset")


def figure_data(name: str, rtol: float = 1e-9) -> FigureData:
    """Compute the numbers of a figure out of ``FIGURES``, every solve to this tolerance."""
    figure = paper_figure(name)
    return FigureData(
        figure, rtol, np.concatenate([figure.rows_of(s, rtol) for s in figure.scenes])
    )


def paper_figure(name: str) -> PaperFigure:
    """Return what a figure out of ``FIGURES`` shows."""
    return _figures()[name]


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


@cache
def _figures() -> dict[str, PaperFigure]:
    named, more = ((0.5, 0.2), (0.5, 0.5), (0.2, 0.5), (0.5, 1.0)), ((0.2, 0.2), (0.05, 1.0))
    frictions = 0.02, 0.04, 0.06, 0.08, 0.1, inf
    ratios, scalars = (
        (0.0, 0.1, 0.2, 0.3, 0.4),
        ("stick_radius", "total_shear", "critical_friction"),
    )
    rough = [10.0 ** (i / 10.0 - 3.0) for i in range(41)]
    made = (
        PaperFigure(
            "2",
            "Pressure for several α*",
            "α* = 0",
            "the other α*",
            ("pressure",),
            tuple(Scene(0.3, alpha, 0.0, 0.0) for alpha in (0.0, 0.05, 0.1, 0.2, 0.5, 1.0)),
            True,
            _pressure,
        ),
        PaperFigure(
            "3",
            "Traction of full stick for several β*",
            "α* = 0.5, ν = 0.3, β* = 0",
            "the other β*",
            ("traction",),
            tuple(Scene(0.3, 0.5, beta, inf) for beta in (0.0, 0.1, 0.2, 0.5, 1.0)),
            True,
            lambda scene, rtol: _traction(scene, rtol)[:, :2],
        ),
        PaperFigure(
            "4",
            "Edge ratio of full stick against Poisson's ratio",
            f"(α*, β*) = {', '.join(map(str, named))}",
            f"{' and '.join(map(str, more))}",
            ("edge_ratio", "critical_friction"),
            tuple(
                Scene(i / 100.0, alpha, beta, inf)
                for alpha, beta in named + more
                for i in range(51)
            ),
            False,
            partial(_scalars, ("edge_ratio", "critical_friction")),
        ),
        PaperFigure(
            "5",
            "Traction for several f at two ν",
            "none",
            "all: α* = β* = 0.5, ν, f",
            ("traction", "stick_radius"),
            tuple(Scene(nu, 0.5, 0.5, f) for nu in (0.1, 0.3) for f in frictions),
            True,
            _traction,
        ),
        PaperFigure(
            "6",
            "Stick radius and total shear against friction for several ν",
            "none",
            "all: α* = β* = 0.5, ν, f",
            scalars,
            tuple(Scene(nu, 0.5, 0.5, i / 400.0) for nu in ratios for i in range(81)),
            False,
            partial(_scalars, scalars),
        ),
        PaperFigure(
            "onset",
            "Where slip starts, and the true critical friction",
            "nothing: the paper has no such figure",
            "all. Friction scales with κ = (1 − 2ν)/(4(1 − ν)), which is 1/7 here",
            ("critical_friction", "edge_ratio", "from_edge"),
            tuple(Scene(0.3, alpha, beta, inf) for alpha in rough for beta in rough),
            False,
            _onset,
        ),
    )
    return {figure.name: figure for figure in made}
