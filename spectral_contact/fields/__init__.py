"""Series that fields are given by, with what evaluates them; internal."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array"]

#: An array of doubles, as nearly all arrays here are.
Array = NDArray[np.float64]
