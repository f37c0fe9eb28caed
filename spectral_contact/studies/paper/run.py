"""Everything into a folder: tables, pictures and statements; a stopped run goes on."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

from spectral_contact.io import checks, choices
from spectral_contact.io.documents import (
    Refused,
    path_text,
    read_file,
    remove_leftovers,
    replace_file,
    reported,
)
from spectral_contact.studies.paper.figures import FIGURES, paper_figure
from spectral_contact.studies.paper.pictures import check, draw
from spectral_contact.studies.paper.statements import Statement, statements, statements_table
from spectral_contact.studies.paper.tables import (
    FigureData,
    PaperFigure,
    complete_csv,
    whole_blocks,
)
from spectral_contact.view import plotting
from spectral_contact.view.progress import ProgressLine


@dataclass(frozen=True, slots=True, eq=False)
class Reproduced:
    """What a reproduction has made; as text, a line for each file.

    Attributes
    ----------
    figures : tuple of FigureData
    statements : tuple of Statement
    files : tuple of (Path, str)
        What was written, and what is in it.
    """

    figures: tuple[FigureData, ...]
    statements: tuple[Statement, ...]
    files: tuple[tuple[Path, str], ...]

    def __str__(self) -> str:
        width = max(len(str(path)) for path, _ in self.files)
        return "\n".join(f"{path!s:<{width}}  {content}" for path, content in self.files)


def reproduce(
    folder: str | os.PathLike[str],
    figures: Iterable[str] = FIGURES,
    *,
    rtol: float = 1e-9,
    pictures: bool = True,
    progress: Callable[[str, float], None] | bool | None = None,
) -> Reproduced:
    """Recompute figures of the paper and what it says into a folder.

    Writes for each figure a table, ``.csv``, and a picture, ``.png``, and ``statements.md``. Tables
    that are there, of the same version and tolerance, are kept, and unfinished ones are gone on
    with: a run that was stopped loses at most one scene.

    Parameters
    ----------
    folder : str or path
        Made if it does not exist.
    figures : iterable of str
        Out of ``FIGURES``; the default is all.
    rtol : float
        Relative tolerance of every solve, 1e-12 to 1e-2.
    pictures : bool
        Whether to draw, which needs matplotlib.
    progress : bool or callable, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks. A
        callable is told every step and the share in [0, 1] that is done.

    Returns
    -------
    Reproduced

    Raises
    ------
    SceneError
        For an argument out of its range.
    ConvergenceError
        If the tolerance cannot be met.
    SolutionFileError
        If the folder, or a file in it, cannot be read or written.
    MissingDependencyError
        If pictures are wanted and matplotlib is not installed.
    """
    names = dict.fromkeys(choices.names("figures", figures, FIGURES))
    wanted = [paper_figure(name) for name in names]
    rtol = checks.tolerance(rtol)
    if checks.flag("pictures", pictures):
        check()
    told = ProgressLine(None if callable(progress) else progress)
    folder = Path(path_text(folder))
    with reported(str(folder), "cannot be written"):
        folder.mkdir(parents=True, exist_ok=True)
    remove_leftovers(folder)
    with told:
        return _reproduced(folder, wanted, rtol, pictures, progress if callable(progress) else told)


def _reproduced(
    folder: Path,
    wanted: Sequence[PaperFigure],
    rtol: float,
    pictures: bool,
    progress: Callable[[str, float], None],
) -> Reproduced:
    total = 1 + sum(len(one.scenes) + 1 for one in wanted)
    done, made, files = count(), list[FigureData](), list[tuple[Path, str]]()

    def tell(step: str) -> None:
        progress(step, next(done) / total)

    for figure in wanted:
        path = folder / f"{figure.stem}.csv"
        label = figure.stem.replace("_", " ")
        data, kept = complete_csv(path, figure, rtol, partial(tell, label))
        tell(f"{label}, picture")
        made.append(data)
        files.append((path, _content(data, kept)))
        if pictures:
            picture = path.with_suffix(".png")
            plotting.save(draw(data), str(picture))
            files.append((picture, figure.title))
    tell("statements")
    found = statements(rtol)
    path = folder / "statements.md"
    with reported(str(path), "cannot be written"):
        replace_file(str(path), statements_table(found).encode())
    holding = sum(one.holds for one in found)
    files.append((path, f"{holding} of {len(found)} statements of the paper hold"))
    tell("")
    return Reproduced(tuple(made), found, tuple(files))


def read_csv(path: str | os.PathLike[str], name: str, rtol: float = 1e-9) -> FigureData:
    """Read the table of a figure that `reproduce` has written.

    Parameters
    ----------
    path : str or path
    name : str
        Of the figure, out of ``FIGURES``.
    rtol : float
        The tolerance it was computed with.

    Returns
    -------
    FigureData
        Every number is the one that was computed.

    Raises
    ------
    SceneError
        For a name out of ``FIGURES``.
    SolutionFileError
        If the file cannot be read, is not whole, or is of another figure, version or tolerance.
    """
    figure, rtol = paper_figure(name), checks.tolerance(rtol)
    source, content = read_file(path)
    with reported(source, "cannot be read"):
        blocks, _ = whole_blocks(content, figure, rtol)
        if len(blocks) < len(figure.scenes):
            raise Refused(f"is not the whole figure {name} of this version at rtol = {rtol!r}")
    return FigureData(figure, rtol, np.concatenate(blocks))


def _content(data: FigureData, kept: int) -> str:
    name = data.figure.values[0]
    error = f"relative error of the {name.replace('_', ' ')} {data.largest_error(name):.1e} at most"
    text = f"{len(data.table)} rows, estimated {error}"
    return f"{text} ({kept} of {len(data.figure.scenes)} scenes were there)" if kept else text
