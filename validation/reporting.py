"""What studies share: one BLAS thread, options, tables, results, pictures, stores, unit of time.

A study puts the folder of this module on `sys.path`. As soon as it is imported, BLAS has one thread
in this process, and in those that it starts.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

# the first for libraries that are not loaded yet
THREADS = os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", THREADS)
threadpool_limits(int(THREADS))

RESULTS = Path(__file__).parent / "results"
DOCS = Path(__file__).parents[1] / "docs"
_DENSE = np.random.default_rng(0).standard_normal((1000, 1000))


def options(
    doc: str | None, arguments: Sequence[str] | None = None, **defaults: Any
) -> argparse.Namespace:
    """Return the options of a command line; each is of the type of its default, False a flag."""
    parser = argparse.ArgumentParser(description=(doc or "").partition("\n")[0])
    for name, default in defaults.items():
        kind = {"action": "store_true"} if default is False else {"type": type(default)}
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(flag, default=default, help=f"default: {default}", **kind)
    return parser.parse_args(arguments)


def table(heading: str, rows: Iterable[Iterable[object]]) -> str:
    """Return a table of Markdown; a vertical bar separates the headings."""
    columns = heading.split(" | ")
    lines = [f"| {heading} |", "|---" * len(columns) + "|"]
    return "\n".join([*lines, *(f"| {' | '.join(map(str, cells))} |" for cells in rows)])


def write(name: str, text: str, record: dict[str, Any] | None = None, version: int = 1) -> None:
    """Print and write results/NAME.md, and the record to NAME.json under a schema of its name."""
    import spectral_contact  # here, as the net times other versions

    print(text)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.md").write_text(text.rstrip("\n") + "\n", encoding="utf-8")
    if record is not None:
        known = {"schema": f"spectral_contact.validation.{name}", "version": version}
        whole = {**known, "library": spectral_contact.__version__, **record}
        (RESULTS / f"{name}.json").write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")


@contextmanager
def picture(
    path: Path, size: tuple[float, float], rows: int = 1, columns: int = 1, **shared: Any
) -> Iterator[Any]:
    """Yield the axes of a picture in the style of the library, which is written at the end."""
    from spectral_contact.view.figures import new_figure, save, style  # here, as in `write`

    with style():
        figure = new_figure(figsize=size, layout="constrained")
        yield figure.subplots(rows, columns, **shared)
        save(figure, path)


def stored(name: str) -> dict[str, Any]:
    """Return the record in results/NAME.json; it is empty where there is none."""
    path = RESULTS / f"{name}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def sources() -> str:
    """Return a digest of the library's sources, to tell whose results a store holds."""
    import spectral_contact  # here, as in `write`

    digest = sha256()
    for path in sorted(Path(spectral_contact.__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def json_lines(path: Path) -> list[Any]:
    """Return what the lines of a file hold, each of them JSON; one that was cut short is lost."""
    found = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        with suppress(ValueError):
            found.append(json.loads(line))
    return found


def resumed(path: Path, tasks: Mapping[str, Callable[[], Any]]) -> dict[str, Any]:
    """Return the outcomes of tasks, of which a file keeps those that are done: a line for each.

    A run that was stopped goes on where it was. A line of progress says what is worked at.
    """
    from spectral_contact.view.progress import ProgressLine  # here, as in `write`

    done = dict(json_lines(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file, ProgressLine(None) as tell:
        file.write("\n")  # after a line that is not whole
        for number, (key, task) in enumerate(tasks.items()):
            tell(key, number / len(tasks))
            if key not in done:
                done[key] = task()
                file.write(json.dumps([key, done[key]]) + "\n")
                file.flush()
    return {key: done[key] for key in tasks}


def seconds(work: Callable[[], object]) -> float:
    """Return the processor's time for some work."""
    begin = process_time()
    work()
    return process_time() - begin


def unit() -> float:
    """Return U, the seconds of one dense solve of 1000 unknowns: the median of three."""
    return median(seconds(lambda: np.linalg.solve(_DENSE, _DENSE[0])) for _ in range(3))
