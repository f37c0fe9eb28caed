"""Values of options: what the text of the command line stands for."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

__all__ = ["friction", "joined", "number", "whole"]


def number(text: str) -> float:
    """Return a number."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None


def whole(text: str) -> int:
    """Return a whole number."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number") from None


def friction(text: str) -> float | None:
    """Return a coefficient of friction, None for ``none``."""
    if text.strip().lower() == "none":
        return None
    value = number(text)
    if not value >= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} must be >= 0, or inf (full stick), or none")
    return value


def joined(argv: Sequence[str]) -> list[str]:
    """Write ``--option -1e-3`` as ``--option=-1e-3``; argparse takes the former for two options."""
    found: list[str] = []
    for text in argv:
        if found and found[-1].startswith("--") and "=" not in found[-1] and _negative(text):
            found[-1] = f"{found[-1]}={text}"
        else:
            found.append(text)
    return found


def _negative(text: str) -> bool:
    try:
        return text.startswith("-") and not math.isnan(float(text))
    except ValueError:
        return False
