"""Fields of the flat punches of a panel, as one series in the place and in the contact radius."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from spectral_contact.solving.nodes import chebyshev_nodes, chebyshev_series

__all__ = ["FieldTable"]

Array = NDArray[np.float64]

#: Width of the panels and their terms: singularities are ``pi`` away, so that every term gains a
#: factor of 6.
_WIDTH, _TERMS = 2.0, 16


class FieldTable:
    """Chebyshev series in a logarithm on panels, and in the place of a radius on its stretch.

    Parameters
    ----------
    values : callable
        Of logarithms (n,): the fields of all stages there, (stages, n).
    low : float
        Where the panels begin; beyond them fields are what they are at their ends.
    panels : int
    """

    def __init__(self, values: Callable[[Array], Array], low: float, panels: int) -> None:
        self._low, self._panels = low, panels
        x = np.arange(panels)[:, None] + (1.0 + chebyshev_nodes(_TERMS)) / 2.0
        found = values(low + _WIDTH * x.ravel())
        #: (panels, stages, terms) of both series
        table = np.tensordot(_fit(len(found)), found.reshape(-1, panels, _TERMS), (1, 0))
        self._table = np.swapaxes(table @ _fit(_TERMS).T, 0, 1)
        #: What the series in the distance leave out, relative to the largest value.
        self.lost = float(np.abs(self._table[..., -2:]).max() / max(np.abs(found).max(), 1e-300))

    def __call__(self, t: Array, x: Array) -> Array:
        """Return the field at places of radii in [-1, 1] and logarithms, both (n,)."""
        x = np.clip((x - self._low) / _WIDTH, 0.0, self._panels)
        own = np.minimum(x.astype(np.intp), self._panels - 1)
        order = np.argsort(own, kind="stable")
        local = np.clip(2.0 * (x - own) - 1.0, -1.0, 1.0)
        ends = np.searchsorted(own[order], np.arange(self._panels + 1))
        sums = np.empty(len(x))
        for k in np.flatnonzero(np.diff(ends)):
            here = order[ends[k] : ends[k + 1]]
            terms = self._table[k] @ _rows(local[here], _TERMS)
            sums[here] = np.einsum("ij,ij->j", terms, _rows(t[here], self._table.shape[1]))
        return sums


def _fit(count: int) -> Array:
    """Return the matrix from values at Chebyshev points to coefficients."""
    return chebyshev_series(np.eye(count))


def _rows(t: Array, count: int) -> Array:
    """Return the first Chebyshev polynomials as rows."""
    rows, twice = np.empty((count, len(t))), 2.0 * t
    rows[0], rows[1:2] = 1.0, t
    for n in range(2, count):
        np.multiply(twice, rows[n - 1], out=rows[n])
        rows[n] -= rows[n - 2]
    return rows
