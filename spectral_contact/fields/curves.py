"""Smooth functions of one unknown through few nodes, and by how much they may be off.

Newton's polynomials go through what is solved. The next node is where they are least certain
(Leja's points), which measures how far off they were.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from spectral_contact.fields import Array

#: From so many scenes on some can be spared.
LEAST: Final = 24
#: Share of the scenes that the nodes may be.
WORTH: Final = 0.8
#: Nodes that a line takes at 1e-8, measured: so many, and more for each unit of the unknown. For
#: more digits it takes more in proportion.
_FIRST, _MORE = 6.0, 2.4
#: How many misfits, of the last nodes, tell what is missing: each is the error without its node.
_LAST: Final = 3
#: How many times the largest of them that is taken to be.
_SAFETY: Final = 2.0
#: Places that nodes are chosen from.
_PLACES: Final = 400
#: Steps to a place, and one that is no step any more.
_STEPS, _STILL = 12, 1e-13


def nodes_needed(low: float, high: float, rtol: float) -> float:
    """Return about how many nodes it takes; singularities are pi away from the real axis."""
    return float((_FIRST + _MORE * (high - low)) * np.log(rtol) / np.log(1e-8))


class Placed(NamedTuple):
    """Where the first function has some values, and the others there.

    Attributes
    ----------
    places, moved : ndarray, shape (values,)
        And how far off they may be.
    values, lost, slopes : ndarray, shape (values, functions - 1)
        What the others are, what they may lack at these places, and by how much they move with it.
    """

    places: Array
    moved: Array
    values: Array
    lost: Array
    slopes: Array


class Curves:
    """The polynomials through what is solved.

    Parameters
    ----------
    low, high : float
        Ends of the unknown.
    functions : int
        The first one increases.

    Attributes
    ----------
    nodes : ndarray, shape (nodes,)
        Where it is solved.
    """

    def __init__(self, low: float, high: float, functions: int) -> None:
        self._places = np.linspace(low, high, _PLACES)
        #: the sum of the logarithms of the distances from the nodes
        self._apart = -np.abs(self._places - low)
        self.nodes = np.empty(0)
        self._next = low
        #: terms of the polynomials, what they lacked before, and errors
        self._terms, self._misfits, self._errors = np.empty((3, 0, functions))

    def next(self, solved: Array | None = None) -> float:
        """Return where the polynomials are least certain.

        A place that is solved is taken instead if it is nearly as far from the nodes, by half of
        the product of all distances.
        """
        self._next = float(self._places[np.argmax(self._apart)])
        if solved is not None and len(self.nodes):
            low, high = self._places[[0, -1]]
            inside = solved[(solved >= low) & (solved <= high)]
            if len(inside):
                with np.errstate(divide="ignore"):
                    apart = np.log(np.abs(inside[:, None] - self.nodes)).sum(axis=1)
                if apart.max() >= self._apart.max() - np.log(2.0):
                    self._next = float(inside[np.argmax(apart)])
        return self._next

    def add(self, known: Array, errors: Array) -> None:
        """Take what is solved at the last place that was asked for."""
        steps = self._next - self.nodes
        misfit = known - _newton(self.nodes, self._terms, np.array([self._next]))[0][0]
        self.nodes = np.append(self.nodes, self._next)
        self._terms = np.vstack([self._terms, misfit / np.prod(steps)])
        self._misfits = np.vstack([self._misfits, np.abs(misfit)])
        self._errors = np.vstack([self._errors, errors])
        if len(self.nodes) == 1:
            self._apart[:] = 0.0
        with np.errstate(divide="ignore"):
            self._apart += np.log(np.abs(self._places - self._next))

    def settled(self, rtol: float) -> bool:
        """Return whether the last nodes were where the polynomials had them."""
        last = self._misfits[-_LAST:]
        return len(self._misfits) > 2 * _LAST and bool((last <= rtol).all())

    def where(self, wanted: Array) -> Placed:
        """Return where the first function has these values, and the others there."""
        places, unsettled = self._inverted(wanted)
        value, slope = _newton(self.nodes, self._terms, places)
        missing = _SAFETY * np.max(self._misfits[-_LAST:], axis=0)
        lost = missing + self._spread(places)[:, None] * self._errors.max(axis=0)
        with np.errstate(all="ignore"):
            moved = np.where(slope[:, 0] > 0.0, lost[:, 0] / slope[:, 0], np.inf) + unsettled
        return Placed(places, moved, value[:, 1:], lost[:, 1:], np.abs(slope[:, 1:]))

    def _inverted(self, wanted: Array) -> tuple[Array, Array]:
        """Return where the first function has these values, and how far that still moved."""
        ends = self._places[[0, -1]]
        known = _newton(self.nodes, self._terms, self._places)[0][:, 0]
        place = np.interp(wanted, known, self._places)
        step = np.full(len(place), np.inf)
        for _ in range(_STEPS):
            value, slope = _newton(self.nodes, self._terms, place)
            with np.errstate(all="ignore"):
                step = (wanted - value[:, 0]) / slope[:, 0]
            place = np.clip(place + step, *ends)
            if np.abs(step).max() < _STILL:
                break
        return place, np.abs(step)

    def _spread(self, x: Array) -> Array:
        """Return by how much polynomials make more of the largest error at the nodes."""
        width = float(np.ptp(self._places))  # products of differences of a narrow piece underflow
        apart = (self.nodes[:, None] - self.nodes) / width
        np.fill_diagonal(apart, 1.0)
        ahead = (x[:, None] - self.nodes) / width
        ahead[ahead == 0.0] = np.finfo(float).eps ** 2
        parts = ahead.prod(axis=1)[:, None] / (ahead * apart.prod(axis=1))
        return np.asarray(np.abs(parts).sum(axis=1))


def _newton(nodes: Array, terms: Array, x: Array) -> tuple[Array, Array]:
    """Return Newton's polynomials and their slopes, (places, polynomials)."""
    value, slope = np.zeros((2, len(x), terms.shape[1]))
    for node, term in zip(nodes[::-1], terms[::-1], strict=True):
        ahead = (x - node)[:, None]
        slope = slope * ahead + value
        value = value * ahead + term
    return value, slope
