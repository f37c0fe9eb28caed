"""The paper, reproduced: its Figures 2 to 6, the figure that it lacks, and what it says in numbers.

Run as ``python validation/paper/paper.py``; writes for each figure a table, ``.csv``, and a
picture, ``.png``, and ``statements.md`` into validation/paper/results. Takes 15 s on one core.
``--output FOLDER`` writes to another place, ``--figures 2,4,onset`` makes some figures only, and
``--rtol`` changes the tolerance.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from paper_figures import FIGURES, figure_data, paper_figure
from paper_pictures import draw
from paper_statements import statements, statements_table
from paper_tables import write_csv
from reporting import options

from spectral_contact.view.plotting import save

RESULTS = Path(__file__).parent / "results"


def main() -> None:
    """Recompute the figures and the statements, and say of every file what is in it."""
    asked = options(__doc__, output=str(RESULTS), figures=",".join(FIGURES), rtol=1e-9)
    folder = Path(asked.output)
    folder.mkdir(parents=True, exist_ok=True)
    for name in asked.figures.split(","):
        path = folder / f"{paper_figure(name).stem}.csv"
        data = figure_data(name, asked.rtol)
        write_csv(path, data)
        save(draw(data), str(path.with_suffix(".png")))
        first = data.figure.values[0]
        error = f"{first.replace('_', ' ')} {data.largest_error(first):.1e}"
        print(f"{path}  {len(data.table)} rows, relative error of the {error} at most", flush=True)
    found = statements(asked.rtol)
    (folder / "statements.md").write_text(statements_table(found), encoding="utf-8")
    print(f"{sum(one.holds for one in found)} of {len(found)} statements of the paper hold")


if __name__ == "__main__":
    main()
