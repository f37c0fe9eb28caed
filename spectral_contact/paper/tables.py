"""Figures as CSV: exact numbers, a head that says whose they are, and going on where it stopped."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spectral_contact.inputs import checks
from spectral_contact.io.documents import Refused, append_file, read_file, reported
from spectral_contact.paper.figures import FigureData, PaperFigure, paper_figure
from spectral_contact.processes import VERSION

__all__ = ["complete_csv", "read_csv"]

Array = NDArray[np.float64]
_EPS = float(np.finfo(float).eps)


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
        blocks, _ = _whole_blocks(content, figure, rtol)
        if len(blocks) < len(figure.scenes):
            raise Refused(f"is not the whole figure {name} of this version at rtol = {rtol!r}")
    return FigureData(figure, rtol, np.concatenate(blocks))


def complete_csv(
    path: Path, figure: PaperFigure, rtol: float, tell: Callable[[], None]
) -> tuple[FigureData, int]:
    """Compute what a table lacks and write it; what is there already is kept.

    While it is incomplete the file has the suffix ``.partial``. It grows scene by scene, so
    whoever is stopped loses at most one.

    Parameters
    ----------
    path : Path
        Of the complete table.
    figure : PaperFigure
    rtol : float
    tell : callable
        Called before every scene, be it computed or kept.

    Returns
    -------
    data : FigureData
    kept : int
        How many scenes were there already.

    Raises
    ------
    SolutionFileError
        If a file cannot be read or written.
    """
    partial = path.with_name(f"{path.name}.partial")
    with reported(str(path), "cannot be read"):
        for source in (path, partial):
            content = source.read_bytes() if source.exists() else b""
            blocks, size = _whole_blocks(content, figure, rtol)
            if len(blocks) == len(figure.scenes):
                break
    for _ in blocks:
        tell()
    kept = len(blocks)
    if kept < len(figure.scenes):
        _append(partial, size, b"" if size else _head(figure, rtol))
    for scene in figure.scenes[kept:]:
        tell()
        blocks.append(figure.rows_of(scene, rtol))
        _append(partial, None, _lines(blocks[-1]))
    if source == partial:
        with reported(str(path), "cannot be written"):
            partial.replace(path)
    return FigureData(figure, rtol, np.concatenate(blocks)), kept


def _append(path: Path, size: int | None, content: bytes) -> None:
    with reported(str(path), "cannot be written"):
        append_file(str(path), content, size)


def _head(figure: PaperFigure, rtol: float) -> bytes:
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
    return ("\n".join(lines) + "\n").encode()


def _lines(rows: Array) -> bytes:
    return "".join(",".join(map(repr, row)) + "\n" for row in rows.tolist()).encode()


def _whole_blocks(content: bytes, figure: PaperFigure, rtol: float) -> tuple[list[Array], int]:
    """Return the rows of the scenes that a table has whole, from the first on, and their end."""
    head = _head(figure, rtol)
    if not content.startswith(head):
        return [], 0
    lines = content[len(head) :].splitlines(keepends=True)
    blocks: list[Array] = []
    size, start = len(head), 0
    for scene in figure.scenes:
        keys = figure.keys_of(scene)
        block = lines[start : start + len(keys)]
        rows = _parsed(block)
        if rows.shape != (len(keys), len(figure.columns)) or np.isnan(rows).any():
            break
        # Powers of ten differ in their last bits with NumPy and the processor; rows say their own.
        if not np.allclose(rows[:, : keys.shape[1]], keys, rtol=4.0 * _EPS, atol=0.0):
            break
        blocks.append(rows)
        size += sum(map(len, block))
        start += len(keys)
    return blocks, size


def _parsed(lines: list[bytes]) -> Array:
    """Return the numbers of whole lines; an empty array if anything is wrong with them."""
    nothing = np.empty((0, 0))
    if not lines or not lines[-1].endswith(b"\n"):
        return nothing
    try:
        return np.array([[float(cell) for cell in line.split(b",")] for line in lines])
    except ValueError:  # no number, or lines of different lengths
        return nothing
