"""A stratum of random scenes: it is run, and its errors over estimates become a table."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
import reporting

__all__ = ["Outcome", "Stratum", "command", "decade", "in_turn", "largest", "run", "table"]

RESULTS = reporting.RESULTS


@dataclass(frozen=True)
class Outcome:
    """True errors over their estimates by quantity, what the scene is, and whether it converged.

    The last is None where a scene is many solves.
    """

    ratios: dict[str, float]
    label: str
    converged: bool | None = None


@dataclass(frozen=True)
class Stratum:
    """Scenes of one kind.

    Attributes
    ----------
    title : str
        Of the page.
    scenes : int
        How many there are by default.
    outcomes : callable
        From a seed, a number of scenes and a number of processes to what becomes of each scene;
        None where the truth or the solver refuses it.
    refused : str
        What is said of those, with their number in braces.
    compared : str
        What the ratio is.
    every : int
        So many scenes from table to table.
    """

    title: str
    scenes: int
    outcomes: Callable[[int, int, int], Iterator[Outcome | None]]
    refused: str = "{} were refused"
    compared: str = "true error over its estimate"
    every: int = 50


def in_turn(
    measure: Callable[[np.random.Generator, int], Outcome],
    refusals: tuple[type[Exception], ...] = (),
) -> Callable[[int, int, int], Iterator[Outcome | None]]:
    """Return the outcomes of scenes that are drawn by one generator, one after another."""

    def outcomes(seed: int, scenes: int, _: int) -> Iterator[Outcome | None]:
        rng = np.random.default_rng(seed)
        for number in range(scenes):
            try:
                yield measure(rng, number)
            except refusals:
                yield None

    return outcomes


def run(name: str, stratum: Stratum, scenes: int, seed: int, workers: int) -> bool:
    """Run a stratum, write its table from time to time, and return whether an estimate failed."""
    found: list[dict[str, float]] = []
    violations: list[str] = []
    unmet: list[str] = []
    judged = False
    text, refused = "", 0
    for done, outcome in enumerate(stratum.outcomes(seed, scenes, workers), start=1):
        if outcome is None:
            refused += 1
        else:
            label = f"scene {done - 1}: {outcome.label}"
            found.append(outcome.ratios)
            judged |= outcome.converged is not None
            unmet += [label] if outcome.converged is False else []
            new = [f"{key} {one:.2f}, {label}" for key, one in outcome.ratios.items() if one > 1.0]
            print(*new, sep="\n", end="\n" * bool(new), flush=True)
            violations += new
        if found and (done % stratum.every == 0 or done == scenes):
            said = f"; {len(unmet)} scenes did not meet their tolerance and said so" * judged
            about = (
                f"{done} random scenes, seed {seed}, by validation/honesty/honesty.py {name}: "
                f"{stratum.compared}{said}; {stratum.refused.format(refused)}."
            )
            notes = [*violations, *(f"not met: {one}" for one in unmet)]
            text = table(stratum.title, about, found, notes)
            (RESULTS / f"honesty_{name}.md").write_text(f"{text}\n", encoding="utf-8")
    print(text)
    return bool(violations)


def command(module: ModuleType, name: str, arguments: Sequence[str]) -> bool:
    """Run a stratum of a module as the command line says; most need no other processes."""
    stratum = module.STRATA[name]
    more = {"scenes": stratum.scenes, "seed": 1, "workers": 1}
    asked = reporting.options(stratum.title, arguments, **more)
    return run(name, stratum, asked.scenes, asked.seed, asked.workers)


def decade(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose decimal logarithm is uniform between two."""
    return float(10.0 ** rng.uniform(low, high))


def largest(found: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return the largest ratio of every quantity."""
    names = dict.fromkeys(key for one in found for key in one)
    return {name: max(one[name] for one in found if name in one) for name in names}


def table(title: str, about: str, found: Sequence[dict[str, float]], notes: Iterable[str]) -> str:
    """Return a page of Markdown.

    Parameters
    ----------
    title, about : str
        What it is, and a sentence on its scenes.
    found : sequence of dict
        Of every scene the true errors over their estimates, by quantity.
    notes : iterable of str
        What is listed below.
    """
    rows = []
    for name in dict.fromkeys(key for one in found for key in one):
        values = np.array([one[name] for one in found if name in one])
        cells = f"{values.max():.2g}", f"{np.median(values):.2g}", (values > 1.0).sum()
        rows.append((name.replace("_", " "), *cells))
    ratios = reporting.table("quantity | largest | median | violations", rows)
    lines = [f"# {title}", "", about, "", ratios, "", *(f"- {one}" for one in notes)]
    return "\n".join(lines).rstrip()
