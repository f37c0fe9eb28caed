"""Figures as tables: what they show, their numbers, and both as CSV.

Numbers are exact, and a head says whose they are.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.processes import VERSION
from spectral_contact.scene import Scene
from spectral_contact.view.radii import Radii

#: Texts of statements and figures.
WORDS = tomllib.loads((Path(__file__).parent / "paper.toml").read_text(encoding="utf-8"))
#: The columns that every table begins with; f is 0 without friction, and infinite in full stick.
PARAMETERS = ("nu", "alpha", "beta", "f")

#: The radii of fields.
RADII = Radii(
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
    scenes : tuple of Scene
        In order; every one is computed at one go.
    measure : callable
        From a scene and rtol to the values, each followed by the estimate of its relative error:
        an array of shape (rows, 2 * values).
    title, given, chosen, values, radial, panels
        As in paper.toml.
    """

    name: str
    scenes: tuple[Scene, ...]
    measure: Callable[[Scene, float], Array]
    title: str
    given: str
    chosen: str
    values: Sequence[str]
    radial: bool
    panels: Sequence[dict[str, Any]]

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
        compliances = scene.normal_compliance, scene.tangential_compliance
        assert scene.poisson_ratio is not None  # the punch is rigid
        parameters = scene.poisson_ratio, *compliances, scene.friction or 0.0
        if not self.radial:
            return np.array([parameters])
        radii = np.column_stack([RADII.s, RADII.from_edge])
        return np.hstack([np.tile(parameters, (len(radii), 1)), radii])

    def rows_of(self, scene: Scene, rtol: float) -> Array:
        """Compute the rows of a scene, shape (rows, len(columns))."""
        return np.hstack([self.keys_of(scene), self.measure(scene, rtol)])


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
        self.table.flags.writeable = False

    def __getitem__(self, name: str) -> Array:
        """Return a column."""
        return self.table[:, self.figure.columns.index(name)]

    def curves(self, *names: str) -> Iterator[tuple[tuple[float, ...], FigureData]]:
        """Yield the runs of rows that agree in some columns: their values there, and the rows."""
        values = list(zip(*(self[name].tolist() for name in names), strict=True))
        for value, rows in groupby(range(len(values)), key=values.__getitem__):
            yield value, replace(self, table=self.table[list(rows)])

    def largest_error(self, name: str) -> float:
        """Return the largest estimate of the relative error of a value that is known at all."""
        errors = self[f"{name}_error"]
        return float(errors[np.isfinite(errors)].max())


def write_csv(path: Path, data: FigureData) -> None:
    """Write a table with its head."""
    rows = "".join(",".join(map(repr, row)) + "\n" for row in data.table.tolist())
    path.write_text(_head(data.figure, data.rtol) + rows, encoding="utf-8")


def read_csv(path: Path, figure: PaperFigure, rtol: float = 1e-9) -> FigureData:
    """Read a table that `write_csv` has written; every number is the one that was computed.

    A table of another figure, version or tolerance is a ValueError.
    """
    head, text = _head(figure, rtol), path.read_text(encoding="utf-8")
    if not text.startswith(head):
        raise ValueError(f"{path} is not figure {figure.name} of this version at rtol = {rtol}")
    rows = text.removeprefix(head).splitlines()
    return FigureData(figure, rtol, np.loadtxt(rows, delimiter=","))


def _head(figure: PaperFigure, rtol: float) -> str:
    """Return the lines above the rows; a table with another head is another table."""
    lines = [
        f"# spectral_contact {VERSION}, paper, {figure.stem}: {figure.title}",
        f"# rtol = {rtol!r}",
        f"# parameters that the paper's text prints: {figure.given}",
        f"# parameters that it does not print, and that are our choice: {figure.chosen}",
        "# dimensionless as in the paper: radii in a, pressure and traction in P/a^2, shear in P",
        "# *_error: estimates of relative errors; inf: no digit is known",
        ",".join(figure.columns),
    ]
    return "\n".join(lines) + "\n"
