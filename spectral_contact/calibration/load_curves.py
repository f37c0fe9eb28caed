"""Loads of many approaches from few that are solved, with their derivatives.

Polynomials go through the solved ones, as in sweeps (`fields.curves`). Where they do not settle,
as next to a break of a profile or where a law bends, the curve is bisected. The approaches in a
piece are solved one by one if there are only a few of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from spectral_contact.errors import ConvergenceError
from spectral_contact.fields import Array
from spectral_contact.fields.curves import LEAST, Curves

#: Nodes of one piece of a curve; a piece that takes more is bisected.
_MOST_NODES = 28
#: Most bisections of a curve, one in another.
_DEEPEST = 12
#: Errors of the interpolated numbers over the tolerance: what a single solve may have.
_ALLOWED = 10.0


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """One solved contact of a curve.

    Attributes
    ----------
    abscissa : float
        A function of the approach, by which the approaches are given.
    functions : ndarray, shape (functions,)
        What is interpolated: the logarithm of the load first.
    errors : ndarray, shape (1 + functions,)
        Of the abscissa and of these, absolute.
    """

    abscissa: float
    functions: Array
    errors: Array


@dataclass(slots=True)
class LoadCurve:
    """Functions of the approach along a curve.

    Attributes
    ----------
    at_place : callable
        Solves the contact of a place: a variable in which the functions are smooth.
    single : callable
        Solves that of an abscissa.
    tolerance : float
        Bound on the relative errors of single solves. Interpolated values may be off by ten times
        that, and at smaller loads by so much more as the load is smaller than the largest one.
    """

    at_place: Callable[[float], CurvePoint]
    single: Callable[[float], CurvePoint]
    tolerance: float
    _solved: dict[float, CurvePoint] = field(default_factory=dict)
    _largest_log_load: float = 0.0

    def values(self, places: Sequence[float], wanted: Array) -> Array:
        """Return the functions, (abscissas, functions), at rising abscissas.

        Parameters
        ----------
        places : sequence of float
            Places of the first and the last abscissa, with those between them at which the
            functions are not smooth; they rise.
        wanted : ndarray, shape (abscissas,)

        Raises
        ------
        ConvergenceError
            If a single solve does not reach ten times the tolerance.
        """
        self._largest_log_load = float(self._point(places[-1]).functions[0])
        cuts = [int(np.searchsorted(wanted, self._point(one).abscissa)) for one in places[1:-1]]
        pieces = zip(pairwise(places), np.split(wanted, cuts), strict=True)
        return _joined([self._piece(*ends, some, _DEEPEST) for ends, some in pieces])

    def _point(self, place: float) -> CurvePoint:
        if place not in self._solved:
            self._solved[place] = self.at_place(place)
        return self._solved[place]

    def _allowed(self, log_load: Array) -> Array:
        """Return the tolerance times the largest load over the load at hand."""
        return self.tolerance * np.exp(np.maximum(self._largest_log_load - log_load, 0.0))

    def _piece(self, low: float, high: float, wanted: Array, depth: int) -> Array:
        if len(wanted) < LEAST or not low < high or not depth:
            return np.array([self._single(one) for one in wanted.tolist()])
        curves = Curves(low, high, 1 + len(self._point(low).functions))
        settled_to = float(self._allowed(self._point(high).functions[0]))
        most = min(_MOST_NODES, len(wanted))
        while len(curves.nodes) < most:
            if curves.settled(settled_to):
                found = curves.invert(wanted)
                errors = found.value_errors + found.slopes * found.place_errors[:, None]
                allowed = _ALLOWED * self._allowed(found.values[:, 0])
                if (errors.max(axis=1) <= allowed).all():
                    return found.values
            point = self._point(curves.next(np.array([*self._solved])))
            curves.add(np.array([point.abscissa, *point.functions]), point.errors)
        middle = 0.5 * (low + high)
        cut = int(np.searchsorted(wanted, self._point(middle).abscissa))
        parts = [
            self._piece(low, middle, wanted[:cut], depth - 1),
            self._piece(middle, high, wanted[cut:], depth - 1),
        ]
        return _joined(parts)

    def _single(self, abscissa: float) -> Array:
        found = self.single(abscissa)
        error = float(found.errors.max())
        if error > _ALLOWED * self._allowed(found.functions[0]):
            told = f"a load of the curve and its derivatives are known to {error:.1e}"
            raise ConvergenceError(told, "loosen rtol.")
        return found.functions


def _joined(parts: list[Array]) -> Array:
    return np.concatenate([part for part in parts if len(part)])
