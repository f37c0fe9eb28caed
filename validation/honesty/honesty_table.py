"""Random numbers and tables of the studies that hold true errors against estimates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

__all__ = ["decade", "table"]


def decade(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose decimal logarithm is uniform between two."""
    return float(10.0 ** rng.uniform(low, high))


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
