"""What the explorer shows of a scene: its fields, tables and what it cost; plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spectral_contact.fields import Array

if TYPE_CHECKING:
    from spectral_contact.solution import Solution


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A state as it is shown; one that is refused has its complaint, and perhaps its code.

    Attributes
    ----------
    complaint : str
        Why the scene is refused, in the words of the library.
    solution : Solution or None
    columns : dict of ndarray
        Over the radii ``s``: ``d`` = 1 − s, ``p``, ``q``, ``fp``, ``slip``; NaN where infinite.
    limits : dict
        Of the axes: ``d``, and each of ``p``, ``q`` and ``slip`` over s and, as ``log p`` and so
        on, over d.
    zones : tuple of (float, float)
        Inner and outer radius of each zone that slips.
    tables : str
        Quantities with the estimates of their errors, zones and plan, in HTML.
    cost : str
    code : str
        Python lines that solve the scene; of a refused one if they would work elsewhere.
    """

    complaint: str = ""
    solution: Solution | None = None
    columns: Mapping[str, Array] | None = None
    limits: Mapping[str, tuple[float, float]] | None = None
    zones: tuple[tuple[float, float], ...] = ()
    tables: str = ""
    cost: str = ""
    code: str = ""
