"""What integrals of several parts, side by side, and their products are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["OwnColumns", "PartProduct", "SideBySide"]

Array = NDArray[np.float64]


class PartProduct(NamedTuple):
    """The product of the integrals of two parts."""

    row: int
    column: int
    values: Array


class OwnColumns(NamedTuple):
    """Which columns are those of a part, and whether they are at the samples."""

    part: int
    columns: slice
    sampled: bool


class SideBySide(NamedTuple):
    """Integrals of several parts: whose the columns are, and those at nodes and at samples."""

    places: list[OwnColumns]
    direct: Array
    sampled: Array
