"""Smooth functions of one unknown, interpolated between few nodes, with estimates of their errors.

Sweeps and fits solve at the nodes alone, and interpolate all other scenes. The unknown x is the
logarithm or the logit of a radius. The functions are logarithms of results, so that absolute errors
of them are relative errors of the results. The interpolants are Newton's polynomials. The next node
is where the product of distances to all nodes is largest (Leja's points). By how much the
polynomials were off there, the *misfit*, is the error that they had without this node.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from spectral_contact.fields import Array

#: With fewer scenes than this, all are solved.
LEAST: Final = 24
#: Interpolation is given up if it takes more nodes than this share of the scenes, or than this
#: number: functions whose errors are above the tolerance never settle.
_WORTH, _MOST = 0.8, 200
#: Nodes that an interval takes at 1e-8, measured: this many, and this many for each unit of its
#: length. At other tolerances it takes more or less in proportion to the digits.
_FIRST, _MORE = 6.0, 2.4
#: The error of the polynomials is taken from the misfits at this many of the last nodes ...
_LAST: Final = 3
#: ... and is this times the largest of them.
_SAFETY: Final = 2.0
#: Places that nodes are chosen from.
_PLACES: Final = 400
#: Most steps of Newton's method, and the length of a step that ends it.
_STEPS, _STILL = 12, 1e-13


def nodes_needed(low: float, high: float, rtol: float) -> float:
    """Return about how many nodes an interval takes.

    The functions are smooth in the radius, of which x is the logarithm or the logit: so they are
    analytic for ``|Im x| < pi``, and nodes grow in proportion to the length and to the digits.
    """
    return float((_FIRST + _MORE * (high - low)) * np.log(rtol) / np.log(1e-8))


def nodes_allowed(scenes: int) -> int:
    """Return how many nodes interpolation may take in place of so many scenes."""
    return int(min(_WORTH * scenes, _MOST))


class Placed(NamedTuple):
    """Places at which the first function has given values, with the other functions there.

    Attributes
    ----------
    places, moved : ndarray, shape (values,)
        The places x, and estimates of their errors.
    values, lost, slopes : ndarray, shape (values, functions - 1)
        The other functions, estimates of their errors at exactly these places, and the moduli of
        their derivatives by x: an error e of the place adds ``slopes e`` to that of the value.
    """

    places: Array
    moved: Array
    values: Array
    lost: Array
    slopes: Array


class Curves:
    """Polynomials through the values of some functions at nodes.

    `next` returns a node, at which the functions are to be found, and `add` takes their values.

    Parameters
    ----------
    low, high : float
        Ends of the interval of x.
    functions : int
        Number of functions. The first one increases with x.

    Attributes
    ----------
    nodes : ndarray, shape (nodes,)
    """

    def __init__(self, low: float, high: float, functions: int) -> None:
        self._places = np.linspace(low, high, _PLACES)
        # distances are in units of the width: products of them underflow in a narrow interval
        self._width = high - low
        #: sums of the logarithms of the distances from the nodes; before there are any, what makes
        #: `low` the first node
        self._apart = -np.abs(self._places - low)
        self.nodes = np.empty(0)
        self._next = low
        #: coefficients of the polynomials, misfits at the nodes, and errors of the values there
        self._terms, self._misfits, self._errors = np.empty((3, 0, functions))

    def next(self, solved: Array | None = None) -> float:
        """Return the next node: where the product of distances from all nodes is largest.

        Of places that are solved already, which costs nothing, the best is taken instead if its
        product is at least half of that.
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
        """Add the node that `next` has returned.

        Parameters
        ----------
        known, errors : ndarray, shape (functions,)
            Values there, and estimates of their absolute errors.
        """
        steps = (self._next - self.nodes) / self._width
        misfit = known - self._polynomials(np.array([self._next]))[0][0]
        self.nodes = np.append(self.nodes, self._next)
        self._terms = np.vstack([self._terms, misfit / np.prod(steps)])
        self._misfits = np.vstack([self._misfits, np.abs(misfit)])
        self._errors = np.vstack([self._errors, errors])
        if len(self.nodes) == 1:
            self._apart[:] = 0.0
        with np.errstate(divide="ignore"):
            self._apart += np.log(np.abs(self._places - self._next))

    def settled(self, rtol: float) -> bool:
        """Return whether the misfits at the last nodes are at most a tolerance.

        Those at the first few nodes do not count: they are no estimates.
        """
        last = self._misfits[-_LAST:]
        return len(self._misfits) > 2 * _LAST and bool((last <= rtol).all())

    def where(self, wanted: Array) -> Placed:
        """Return where the first function has these values, and the others there."""
        places, unsettled = self._inverted(wanted)
        value, slope = self._polynomials(places)
        missing = _SAFETY * np.max(self._misfits[-_LAST:], axis=0)
        lost = missing + self._spread(places)[:, None] * self._errors.max(axis=0)
        with np.errstate(all="ignore"):
            moved = np.where(slope[:, 0] > 0.0, lost[:, 0] / slope[:, 0], np.inf) + unsettled
        return Placed(places, moved, value[:, 1:], lost[:, 1:], np.abs(slope[:, 1:]))

    def _inverted(self, wanted: Array) -> tuple[Array, Array]:
        """Return where the first function has these values, and the last steps to there.

        A step is large where the value lies outside of the interval.
        """
        ends = self._places[[0, -1]]
        known = self._polynomials(self._places)[0][:, 0]
        place = np.interp(wanted, known, self._places)
        step = np.full(len(place), np.inf)
        for _ in range(_STEPS):
            value, slope = self._polynomials(place)
            with np.errstate(all="ignore"):
                step = (wanted - value[:, 0]) / slope[:, 0]
            place = np.clip(place + step, *ends)
            if np.abs(step).max() < _STILL:
                break
        return place, np.abs(step)

    def _spread(self, x: Array) -> Array:
        """Return the Lebesgue function: the factor by which errors at the nodes may grow at x."""
        apart = (self.nodes[:, None] - self.nodes) / self._width
        np.fill_diagonal(apart, 1.0)
        ahead = (x[:, None] - self.nodes) / self._width
        # at a node the function is 1, and not 0/0
        ahead[ahead == 0.0] = np.finfo(float).eps ** 2
        parts = ahead.prod(axis=1)[:, None] / (ahead * apart.prod(axis=1))
        return np.asarray(np.abs(parts).sum(axis=1))

    def _polynomials(self, x: Array) -> tuple[Array, Array]:
        """Return the polynomials and their derivatives by x, (places, functions)."""
        value, slope = np.zeros((2, len(x), self._terms.shape[1]))
        for node, term in zip(self.nodes[::-1], self._terms[::-1], strict=True):
            ahead = (x - node)[:, None] / self._width
            slope = slope * ahead + value
            value = value * ahead + term
        return value, slope / self._width
