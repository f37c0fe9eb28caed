"""Strata: scenes are drawn and solved, and their true errors over estimates become a table."""

from __future__ import annotations

import json
import math
import multiprocessing
import signal
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from time import monotonic
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))  # oracles that strata compare with

import numpy as np
import reporting

from spectral_contact import ConvergenceError, NotComputedError, SceneError
from spectral_contact.view.progress import ProgressLine

RESULTS = reporting.RESULTS
REFUSALS = {
    one.__name__: one
    for one in (
        ArithmeticError,
        AssertionError,
        ConvergenceError,
        NotComputedError,
        SceneError,
        np.linalg.LinAlgError,
    )
}
#: Number of scenes that a process is given at once.
CHUNK = 10
#: Seconds between two writings of the table.
PAUSE = 30.0
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Outcome:
    """The comparison of one scene with its truth.

    Attributes
    ----------
    ratios : dict of str to float
        True errors over their estimates, by quantity.
    label : str
        The scene in words.
    converged : bool or None
        Whether the solution says that it met its tolerance; None where a scene takes many solves,
        and such a statement is not counted.
    """

    ratios: dict[str, float]
    label: str
    converged: bool | None = None


@dataclass(frozen=True)
class Stratum:
    """Scenes of one kind, a table of strata.toml.

    Attributes
    ----------
    name : str
        Of the table, and of the function that draws, solves and compares a scene.
    module : str
        Module with this function.
    title : str
        Of the page of results.
    scenes : int
        How many are drawn by default.
    key : list of int or None
        If it is a list, each scene has a generator of its own. The seed of this generator is made
        of the seed of the run, the number of the scene and these numbers. If it is None, one
        generator draws all scenes in turn.
    refusals : sequence of str
        Names of exceptions by which the library or the truth refuses a scene.
    refused : str
        Sentence of the page about refused scenes, with braces for their number.
    compared : str
        The meaning of the numbers of the table, for the page.
    """

    name: str
    module: str
    title: str
    scenes: int = 0
    key: list[int] | None = None
    refusals: Sequence[str] = ()
    refused: str = "{} were refused"
    compared: str = "true error over its estimate"

    def outcomes(self, seed: int, scenes: int, workers: int) -> Iterator[Outcome | None]:
        """Yield the outcome of each scene; None where the truth or the solver refuses it."""
        if self.key is not None:
            return in_order(partial(self.outcome, seed), range(scenes), workers)
        rng = np.random.default_rng(seed)
        return (self.outcome(rng, number) for number in range(scenes))

    def outcome(self, begin: int | np.random.Generator, number: int) -> Outcome | None:
        """Return the outcome of a scene, drawn by a seed or by the generator of all scenes."""
        measured = getattr(import_module(self.module), self.name)
        if isinstance(begin, int):
            begin = np.random.default_rng([begin, number, *(self.key or ())])
        try:
            return measured(begin, number)
        except tuple(REFUSALS[one] for one in self.refusals):
            return None


def strata() -> dict[str, Stratum]:
    """Return all strata by their names."""
    text = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
    return {name: Stratum(name, **given) for name, given in tomllib.loads(text).items()}


def command(stratum: Stratum, arguments: Sequence[str]) -> bool:
    """Run a stratum with the options of the command line.

    A stratum without `key`, whose scenes are drawn in turn, takes no notice of the workers.
    """
    defaults = {"scenes": stratum.scenes, "seed": 1, "workers": 1}
    options = reporting.options(stratum.title, arguments, **defaults)
    return run(stratum, options.scenes, options.seed, options.workers)


def in_order(work: Callable[[int], Any], numbers: Iterable[int], workers: int) -> Iterator[Any]:
    """Yield the results of a function at some numbers, in their order, from several processes."""
    if workers == 1:
        yield from map(work, numbers)
        return
    # if this process is ended from outside, the others end, too
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        yield from pool.map(work, numbers, chunksize=CHUNK)


def store_of(name: str) -> str:
    """Return the file that keeps the rows of a stratum, unless another one is asked for."""
    return str(Path(tempfile.gettempdir()) / f"spectral_contact_{name}.jsonl")


def kept_rows(
    work: Callable[[int], dict[str, Any]], count: int, workers: int, store: str, **made_with: Any
) -> list[dict[str, Any]]:
    """Return the rows of scenes, which `work` makes; a file keeps each row as a line of JSON.

    A run that was stopped goes on where it was. Each line also has the values of `made_with`, and
    as "sources" a digest of the library's source files. Lines in which any of these differ from
    those of this run are ignored.
    """
    made_with |= {"sources": reporting.sources()}
    rows = {
        row["number"]: row
        for row in reporting.json_lines(Path(store))
        if made_with.items() <= row.items() and row["number"] < count
    }
    missing = [number for number in range(count) if number not in rows]
    with open(store, "a", encoding="utf-8") as file, ProgressLine(None) as tell:
        for row in in_order(work, missing, workers):
            rows[row["number"]] = row | made_with
            file.write(json.dumps(rows[row["number"]]) + "\n")
            file.flush()
            tell(f"{len(rows)} of {count} scenes", len(rows) / count)
    return [rows[number] for number in range(count)]


def run(stratum: Stratum, scenes: int, seed: int, workers: int = 1) -> bool:
    """Run a stratum, and write its table from time to time.

    Returns whether an estimate failed, or no scene was compared.
    """
    compared_scenes: list[Outcome] = []
    violations: list[str] = []
    unmet: list[str] = []
    refused = 0
    written = monotonic()
    text = ""
    for done, outcome in enumerate(stratum.outcomes(seed, scenes, workers), start=1):
        if outcome is None:
            refused += 1
        else:
            label = f"scene {done - 1}: {outcome.label}"
            compared_scenes.append(outcome)
            unmet += [f"not met: {label}"] if outcome.converged is False else []
            new_violations = [
                f"{key} {r:.2f}, {label}" for key, r in outcome.ratios.items() if violates(r)
            ]
            print(*new_violations, sep="\n", end="\n" * bool(new_violations), flush=True)
            violations += new_violations
        if done == scenes or monotonic() > written + PAUSE:
            some_judged = any(outcome.converged is not None for outcome in compared_scenes)
            unmet_text = (
                f"; {len(unmet)} scenes did not meet their tolerance and said so" * some_judged
            )
            subtitle = (
                f"{done} random scenes, seed {seed}, by validation/honesty/honesty.py "
                f"{stratum.name}: {stratum.compared}{unmet_text}; "
                f"{stratum.refused.format(refused)}."
            )
            notes = "\n".join(f"- {note}" for note in (*violations, *unmet))
            text = (
                f"# {stratum.title}\n\n{subtitle}\n\n{table(compared_scenes)}\n\n{notes}".rstrip()
            )
            (RESULTS / f"honesty_{stratum.name}.md").write_text(f"{text}\n", encoding="utf-8")
            written = monotonic()
    print(text)
    return bool(violations) or not compared_scenes


def violates(ratio: float) -> bool:
    """Return whether a true error is above its estimate; what is no number violates, too."""
    return not ratio <= 1.0


def table(compared_scenes: Iterable[Outcome]) -> str:
    """Return a table with a row for each quantity."""
    ratios: dict[str, list[float]] = {}
    for outcome in compared_scenes:
        for name, ratio in outcome.ratios.items():
            ratios.setdefault(name, []).append(ratio)
    rows = []
    for name, values in ratios.items():
        cells = f"{np.max(values):.2g}", f"{np.median(values):.2g}", sum(map(violates, values))
        rows.append((name.replace("_", " "), *cells))
    return reporting.table("quantity | largest | median | violations", rows)


# --- for the modules of strata --------------------------------------------------------------------


def decade(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose decimal logarithm is uniform between two."""
    return float(10.0 ** rng.uniform(low, high))


def largest(found: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return the largest ratio of every quantity."""
    names = dict.fromkeys(key for one in found for key in one)
    return {name: max(one[name] for one in found if name in one) for name in names}


def over_estimates(
    found: Any,
    truth: Any,
    names: Iterable[str],
    rounding: float = 1e-15,
    sizes: Mapping[str, float] | None = None,
) -> dict[str, float]:
    """Return the errors of scalars over their estimates, those of the truth included.

    Parameters
    ----------
    found, truth : object
        What has the numbers of a `Solution`, and estimates as `error`; an estimate may be None.
    names : iterable of str
    rounding : float
        Error that no estimate has.
    sizes : mapping, optional
        The numbers that errors are relative to, where these are not the true values.
    """
    ratios = {}
    for name in names:
        true = getattr(truth, name)
        size = max(abs(true), TINY) if name not in (sizes or {}) else sizes[name]
        error = float(abs(getattr(found, name) - true) / size)
        ratios[name] = error / _allowed_error(found, truth, name, rounding)
    return ratios


def fields_over_estimates(
    found: Any,
    truth: Any,
    names: Iterable[str],
    from_edge: np.ndarray,
    rounding: float = 1e-15,
    load: float | None = None,
) -> dict[str, float]:
    """Return the largest errors of the fields that were asked for over their estimates.

    They are relative to the largest value; those of a pressure to its value there or its mean,
    whichever is larger. `load` is that of the mean, where it is not the true load.
    """
    ratios = {}
    for name in names:
        if getattr(found.error, name) is None:
            continue
        values, true_values = (
            np.asarray(getattr(one, name)(from_edge=from_edge)).astype(float)
            for one in (found, truth)
        )
        size = max(np.abs(true_values).max(), TINY)
        if name == "pressure":
            mean = float(load or truth.load) / (math.pi * float(truth.contact_radius) ** 2)
            size = np.maximum(np.abs(true_values), mean)
        error = float((np.abs(values - true_values) / size).max())
        ratios[name] = error / _allowed_error(found, truth, name, rounding)
    return ratios


def _allowed_error(found: Any, truth: Any, name: str, rounding: float) -> float:
    """Return the sum of the estimates of a solution and of its truth, and of the rounding."""
    estimates = (getattr(one.error, name) or 0.0 for one in (found, truth))
    return max(rounding + sum(estimates), TINY)  # what is given has no error
