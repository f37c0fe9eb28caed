"""The figures: which scenes, what is measured of each, and the numbers; nothing is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import groupby
from math import inf

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SceneError
from spectral_contact.inputs import checks, choices
from spectral_contact.paper.onset import slip_onset
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve
from spectral_contact.view.radii import Radii

__all__ = ["FIGURES", "PARAMETERS", "FigureData", "PaperFigure", "figure_data", "paper_figure"]

Array = NDArray[np.float64]

#: The figures that can be made: the paper's by their numbers, and the one that it lacks.
FIGURES = ("2", "3", "4", "5", "6", "onset")
#: The columns that every table begins with; f is 0 without friction, and infinite in full stick.
PARAMETERS = ("nu", "alpha", "beta", "f")

_RADII = Radii(
    np.arange(50) / 100.0,
    np.concatenate(
        [np.arange(50, 10, -1) / 100.0, 10.0 ** (np.arange(-16, -97, -1) / 16.0), [0.0]]
    ),
)


@dataclass(frozen=True, slots=True, eq=False)
class PaperFigure:
    """What a figure shows, before anything is computed.

    Attributes
    ----------
    name : str
        Out of ``FIGURES``.
    title : str
    given : str
        Parameters that the paper's text prints.
    chosen : str
        Parameters that it does not print, and that are our choice.
    values : tuple of str
        Names of what is measured.
    scenes : tuple of Scene
        In order; every one is computed at one go.
    radial : bool
        Whether the values are functions of the radius.
    measure : callable
        From a scene and rtol to the values, each followed by the estimate of its relative error:
        an array of shape (rows, 2 * values).
    """

    name: str
    title: str
    given: str
    chosen: str
    values: tuple[str, ...]
    scenes: tuple[Scene, ...]
    radial: bool
    measure: Callable[[Scene, float], Array]

    @property
    def stem(self) -> str:
        """Name of its files without the suffix."""
        return f"figure_{self.name}" if self.name.isdigit() else self.name

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the columns that are known beforehand."""
        return (*PARAMETERS, "s", "one_minus_s") if self.radial else PARAMETERS

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        pairs = ((name, f"{name}_error") for name in self.values)
        return (*self.keys, *(name for pair in pairs for name in pair))

    def keys_of(self, scene: Scene) -> Array:
        """Return the known columns of the rows of a scene, shape (rows, len(keys))."""
        choices.instance("scene", scene, Scene)
        parameters = _parameters(scene)
        if not self.radial:
            return np.array([parameters])
        radii = np.column_stack([_RADII.s, _RADII.from_edge])
        return np.hstack([np.tile(parameters, (len(radii), 1)), radii])

    def rows_of(self, scene: Scene, rtol: float) -> Array:
        """Compute the rows of a scene, shape (rows, len(columns))."""
        return np.hstack([self.keys_of(scene), self.measure(scene, checks.tolerance(rtol))])


@dataclass(frozen=True, slots=True, eq=False)
class FigureData:
    """The numbers of a figure.

    Attributes
    ----------
    figure : PaperFigure
    rtol : float
        The tolerance of every solve.
    table : ndarray, shape (rows, len(figure.columns))
        Dimensionless, as in the paper; read-only.
    """

    figure: PaperFigure
    rtol: float
    table: Array

    def __post_init__(self) -> None:
        choices.instance("figure", self.figure, PaperFigure)
        checks.tolerance(self.rtol)
        numbers = checks.reals("table", choices.instance("table", self.table, np.ndarray), "or NaN")
        if numbers.shape[1:] != (len(self.figure.columns),):
            allowed = f"of {len(self.figure.columns)} columns, as the figure is"
            raise SceneError("table", self.table, allowed)
        self.table.flags.writeable = False

    def __getitem__(self, name: str) -> Array:
        """Return a column.

        Raises
        ------
        SceneError
            If there is no such column.
        """
        columns = self.figure.columns
        return self.table[:, columns.index(choices.one_of("column", name, columns))]

    def curves(self, *names: str) -> Iterator[tuple[tuple[float, ...], FigureData]]:
        """Yield the runs of rows that agree in some columns: their values there, and the rows.

        Raises
        ------
        SceneError
            If there is no such column.
        """
        known = [choices.one_of("names", name, self.figure.columns) for name in names]
        values = list(zip(*(self[name].tolist() for name in known), strict=True))
        for value, rows in groupby(range(len(values)), key=values.__getitem__):
            yield value, replace(self, table=self.table[list(rows)])

    def largest_error(self, name: str) -> float:
        """Return the largest estimate of the relative error of a value that is known at all.

        Raises
        ------
        SceneError
            If there is no such value.
        """
        errors = self[f"{choices.one_of('name', name, self.figure.values)}_error"]
        return float(errors[np.isfinite(errors)].max())


def figure_data(name: str, rtol: float = 1e-9) -> FigureData:
    """Compute the numbers of a figure.

    Parameters
    ----------
    name : str
        Out of ``FIGURES``.
    rtol : float
        Relative tolerance of every solve, 1e-12 to 1e-2.

    Returns
    -------
    FigureData

    Raises
    ------
    SceneError
        For an argument out of its range.
    ConvergenceError
        If the tolerance cannot be met.
    """
    figure, rtol = paper_figure(name), checks.tolerance(rtol)
    rows = [figure.rows_of(scene, rtol) for scene in figure.scenes]
    return FigureData(figure, rtol, np.concatenate(rows))


def paper_figure(name: str) -> PaperFigure:
    """Return what a figure shows.

    Raises
    ------
    SceneError
        For a name out of ``FIGURES``.
    """
    return _figures()[choices.one_of("name", name, FIGURES)]


# --- what is measured of a scene ------------------------------------------------------------------


def _parameters(scene: Scene) -> tuple[float, ...]:
    friction = 0.0 if scene.friction is None else scene.friction
    alpha, beta = scene.normal_compliance, scene.tangential_compliance
    return scene.poisson_ratio, alpha, beta, friction


def _pressure(scene: Scene, rtol: float) -> Array:
    solution = solve(scene, rtol, ("pressure",))
    values = _RADII.evaluate(solution.pressure)
    return np.column_stack([values, np.full_like(values, solution.error.pressure)])


def _traction(scene: Scene, rtol: float) -> Array:
    """Return the traction and the stick radius.

    In a stick disk q is a function of s/c: at a given radius twice the error of c comes on top.
    """
    solution = solve(scene, rtol, ("traction", "zones", "stick_radius"))
    error = solution.error
    assert error.traction is not None
    assert error.zones is not None
    values = _RADII.evaluate(solution.traction)
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
    made = (_figure_2(), _figure_3(), _figure_4(), _figure_5(), _figure_6(), _figure_onset())
    return {figure.name: figure for figure in made}


def _figure_2() -> PaperFigure:
    return PaperFigure(
        "2",
        "Pressure for several α*",
        "α* = 0",
        "the other α*",
        ("pressure",),
        tuple(Scene(0.3, alpha, 0.0, 0.0) for alpha in (0.0, 0.05, 0.1, 0.2, 0.5, 1.0)),
        True,
        _pressure,
    )


def _figure_3() -> PaperFigure:
    return PaperFigure(
        "3",
        "Traction of full stick for several β*",
        "α* = 0.5, ν = 0.3, β* = 0",
        "the other β*",
        ("traction",),
        tuple(Scene(0.3, 0.5, beta, inf) for beta in (0.0, 0.1, 0.2, 0.5, 1.0)),
        True,
        lambda scene, rtol: _traction(scene, rtol)[:, :2],
    )


def _figure_4() -> PaperFigure:
    named = (0.5, 0.2), (0.5, 0.5), (0.2, 0.5), (0.5, 1.0)
    more = (0.2, 0.2), (0.05, 1.0)
    return PaperFigure(
        "4",
        "Edge ratio of full stick against Poisson's ratio",
        f"(α*, β*) = {', '.join(map(str, named))}",
        f"{' and '.join(map(str, more))}",
        ("edge_ratio", "critical_friction"),
        tuple(
            Scene(i / 100.0, alpha, beta, inf) for alpha, beta in named + more for i in range(51)
        ),
        False,
        partial(_scalars, ("edge_ratio", "critical_friction")),
    )


def _figure_5() -> PaperFigure:
    frictions = 0.02, 0.04, 0.06, 0.08, 0.1, inf
    return PaperFigure(
        "5",
        "Traction for several f at two ν",
        "none",
        "all: α* = β* = 0.5, ν, f",
        ("traction", "stick_radius"),
        tuple(Scene(nu, 0.5, 0.5, f) for nu in (0.1, 0.3) for f in frictions),
        True,
        _traction,
    )


def _figure_6() -> PaperFigure:
    names = "stick_radius", "total_shear", "critical_friction"
    return PaperFigure(
        "6",
        "Stick radius and total shear against friction for several ν",
        "none",
        "all: α* = β* = 0.5, ν, f",
        names,
        tuple(
            Scene(nu, 0.5, 0.5, i / 400.0) for nu in (0.0, 0.1, 0.2, 0.3, 0.4) for i in range(81)
        ),
        False,
        partial(_scalars, names),
    )


def _figure_onset() -> PaperFigure:
    compliances = [10.0 ** (i / 10.0 - 3.0) for i in range(41)]
    return PaperFigure(
        "onset",
        "Where slip starts, and the true critical friction",
        "nothing: the paper has no such figure",
        "all. Friction scales with κ = (1 − 2ν)/(4(1 − ν)), which is 1/7 here",
        ("critical_friction", "edge_ratio", "from_edge"),
        tuple(Scene(0.3, alpha, beta, inf) for alpha in compliances for beta in compliances),
        False,
        _onset,
    )
