"""Random numbers and tables of the studies that hold true errors against estimates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from spectral_contact import Solution

__all__ = ["decade", "largest_share", "spread", "table"]


def decade(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose decimal logarithm is uniform between two."""
    return float(10.0 ** rng.uniform(low, high))


def spread(rng: np.random.Generator, highest: float, decades: float) -> np.ndarray:
    """Return some dozen numbers up to one: equidistant, in equal ratios or random."""
    count, kind = int(rng.integers(24, 160)), rng.integers(3)
    if kind == 0:
        return np.linspace(highest / count, highest, count)
    if kind == 1:
        return np.geomspace(highest * 10.0 ** -rng.uniform(0.3, decades), highest, count)
    return np.sort(rng.uniform(0.05 * highest, highest, count))


def largest_share(found: Mapping[str, Any], i: int, truth: Solution, names: Sequence[str]) -> float:
    """Return the largest error over its estimate in a scene of a sweep, against its solution."""
    shares = []
    for name in names:
        true, value = getattr(truth, name), float(found[name][i])
        allowed = float(found[f"{name}_error"][i]) + getattr(truth.error, name) + 1e-15
        shares.append(abs(value - true) / (abs(true) or 1.0) / allowed)
    return max(shares)


def table(
    title: str,
    about: str,
    found: Sequence[dict[str, float]],
    names: Iterable[str],
    notes: Iterable[str],
) -> str:
    """Return a page of Markdown.

    Parameters
    ----------
    title, about : str
        What it is, and a sentence on its scenes.
    found : sequence of dict
        Of every scene the true errors over their estimates, by quantity.
    names : iterable of str
        The quantities, in order.
    notes : iterable of str
        What is listed below.
    """
    lines = [f"# {title}", "", about, ""]
    lines += ["| quantity | largest | median | violations |", "|---|---|---|---|"]
    for name in names:
        values = np.array([one[name] for one in found if name in one])
        cells = name.replace("_", " "), f"{values.max():.2g}", f"{np.median(values):.2g}"
        lines.append("| " + " | ".join(cells) + f" | {(values > 1.0).sum()} |")
    return "\n".join([*lines, "", *(f"- {one}" for one in notes)]).rstrip()
