"""Spaces of all functions on some panels, and their matrices in the order of the coefficients."""

import numpy as np

from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import Space, unit_space


def whole_space(panels: LogPanels, kind: str = "normal") -> Space:
    """Return the space of K1 ("normal") or K2 ("tangential") with every degree."""
    return unit_space(panels, (panels.degree,) * panels.count, shear=kind == "tangential")


def ordered(space: Space, matrix: np.ndarray) -> np.ndarray:
    """Return a matrix of a space with its functions in the order of the coefficients."""
    order = np.argsort(space.index)
    return matrix[np.ix_(order, order)]


def half_integrals(space: Space) -> np.ndarray:
    """Return the half-integrals of all coefficients at the nodes, (nodes, size)."""
    return np.column_stack([space.half_integral(one) for one in np.eye(space.size)])
