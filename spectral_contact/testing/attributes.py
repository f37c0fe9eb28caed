"""What any solution has, and what it lacks or has not computed."""

from __future__ import annotations

from typing import Any

from spectral_contact.errors import NotComputedError


def computed(solution: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of a solution; the default if it is missing, None or not computed.

    Parameters
    ----------
    solution : object
    name : str
    default : object
    """
    try:
        value = getattr(solution, name, None)
    except NotComputedError:
        return default
    return default if value is None else value
