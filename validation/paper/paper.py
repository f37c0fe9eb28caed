"""The paper, reproduced: its Figures 2 to 6, the figure that it lacks, and what it says in numbers.

Run as ``python validation/paper/paper.py``; writes for each figure a table, ``.csv``, and a
picture, ``.png``, and ``statements.md`` into validation/paper/results. Takes 15 s on one core.
``--output FOLDER`` writes to another place, ``--figures 2 4 onset`` makes some figures only,
``--rtol`` changes the tolerance, and ``--no-pictures`` does without matplotlib.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterable
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from paper_figures import FIGURES, figure_data, paper_figure
from paper_pictures import check, draw
from paper_statements import statements, statements_table
from paper_tables import write_csv

from spectral_contact import SpectralContactError
from spectral_contact.io import checks, choices
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.view import plotting

RESULTS = Path(__file__).parent / "results"


def reproduce(
    folder: str | os.PathLike[str],
    figures: Iterable[str] = FIGURES,
    *,
    rtol: float = 1e-9,
    pictures: bool = True,
    tell: Callable[[str], None] = lambda line: None,
) -> list[Path]:
    """Recompute figures of the paper, and what it says, into a folder; return the files.

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
    tell : callable
        Told of every file that is written, and what is in it.

    Raises
    ------
    SceneError
        For an argument out of its range.
    ConvergenceError
        If the tolerance cannot be met.
    SolutionFileError
        If the folder, or a file in it, cannot be written.
    MissingDependencyError
        If pictures are wanted and matplotlib is not installed.
    """
    names = dict.fromkeys(choices.names("figures", figures, FIGURES))
    rtol = checks.tolerance(rtol)
    if pictures:
        check()
    folder = Path(path_text(folder))
    with reported(str(folder), "cannot be written"):
        folder.mkdir(parents=True, exist_ok=True)
    files = []

    def written(path: Path, content: str) -> None:
        files.append(path)
        tell(f"{path}  {content}")

    for name in names:
        data, path = figure_data(name, rtol), folder / f"{paper_figure(name).stem}.csv"
        write_csv(path, data)
        first = data.figure.values[0]
        error = f"{first.replace('_', ' ')} {data.largest_error(first):.1e}"
        written(path, f"{len(data.table)} rows, estimated relative error of the {error} at most")
        if pictures:
            plotting.save(draw(data), str(path.with_suffix(".png")))
            written(path.with_suffix(".png"), data.figure.title)
    found, path = statements(rtol), folder / "statements.md"
    with reported(str(path), "cannot be written"):
        replace_file(str(path), statements_table(found).encode())
    holding = sum(one.holds for one in found)
    written(path, f"{holding} of {len(found)} statements of the paper hold")
    return files


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--output", metavar="FOLDER", default=RESULTS)
    parser.add_argument("--figures", nargs="+", choices=FIGURES, default=FIGURES, metavar="NAME")
    parser.add_argument("--rtol", type=float, default=1e-9)
    parser.add_argument("--no-pictures", action="store_true")
    asked = parser.parse_args()
    try:
        reproduce(
            asked.output,
            asked.figures,
            rtol=asked.rtol,
            pictures=not asked.no_pictures,
            tell=lambda line: print(line, flush=True),
        )
    except SpectralContactError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
