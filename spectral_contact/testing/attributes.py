"""Attributes of any object that stands for a solution: some may be missing, or not computed."""

from __future__ import annotations

from typing import Any

from spectral_contact.errors import NotComputedError


def computed(solution: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of a solution; the default if it is missing, None or not computed.

    Parameters
    ----------
    solution : object
        This library's or that of another solver.
    name : str
    default : object
    """
    try:
        value = getattr(solution, name, None)
    except NotComputedError:
        return default
    return default if value is None else value
