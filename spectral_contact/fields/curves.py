"""Smooth functions of one unknown, interpolated between few nodes, with estimates of their errors.

Sweeps and fits solve at the nodes alone, and interpolate all other scenes. The unknown x is the
logarithm or the logit of a radius. The functions are logarithms of results, so that absolute errors
of them are relative errors of the results. The interpolants are polynomials in Newton's form, and
each next node is where the product of the distances from all nodes is largest (Leja's points).
The *misfit* of a node is the error there of the polynomials through the nodes before it. The
misfits of the last nodes give the estimate of the error.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from spectral_contact.fields import Array

#: With fewer scenes than this, all are solved (chosen).
LEAST: Final = 24
#: Interpolation is given up if it takes more nodes than this fraction of the scenes.
_MOST_NODES_OF_SCENES: Final = 0.8
#: It is given up if it takes more nodes than this, too: functions whose errors are above the
#: tolerance never settle.
_MOST_NODES: Final = 200
#: Number of nodes that a short interval takes at 1e-8, measured. At other tolerances the number is
#: in proportion to the digits.
_NODES_AT_LEAST: Final = 6.0
#: Number of further nodes for each unit of the length of the interval, at 1e-8.
_NODES_PER_UNIT: Final = 2.4
#: Number of the last nodes from whose misfits the error of the polynomials is estimated.
_LAST_MISFITS: Final = 3
#: Factor of the largest of these misfits in the estimate.
_MISFIT_FACTOR: Final = 2.0
#: Number of equidistant places that nodes are chosen from.
_PLACES: Final = 400
#: Most steps of Newton's method.
_MOST_STEPS: Final = 12
#: Newton's method ends when no step is longer than this.
_LAST_STEP: Final = 1e-13


def nodes_needed(low: float, high: float, rtol: float) -> float:
    """Return about how many nodes an interval takes.

    The functions are smooth in the radius, of which x is the logarithm or the logit: so they are
    analytic for ``|Im x| < pi``, and nodes grow in proportion to the length and to the digits.
    """
    at_eight_digits = _NODES_AT_LEAST + _NODES_PER_UNIT * (high - low)
    return float(at_eight_digits * np.log(rtol) / np.log(1e-8))


def nodes_allowed(scenes: int) -> int:
    """Return the most nodes that an interpolation of a number of scenes may take."""
    return int(min(_MOST_NODES_OF_SCENES * scenes, _MOST_NODES))


class InvertedCurves(NamedTuple):
    """Places at which the first function has given values, and the other functions there.

    Attributes
    ----------
    places, place_errors : ndarray, shape (values,)
        The places x, and estimates of their errors.
    values, value_errors, slopes : ndarray, shape (values, functions - 1)
        The other functions, estimates of their errors at exactly these places, and the moduli of
        their derivatives by x: an error e of the place adds ``slopes e`` to that of the value.
    """

    places: Array
    place_errors: Array
    values: Array
    value_errors: Array
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
        # the unit of distances in the products of `add` and `_polynomials`, which would underflow
        # in a narrow interval
        self._width = high - low
        # logarithm of the product of the distances from all nodes; before there are nodes any
        # function that is largest at `low`, so that `low` becomes the first node
        self._log_product = -np.abs(self._places - low)
        self.nodes = np.empty(0)
        self._next = low
        # of Newton's polynomials, a row for each node
        self._coefficients = np.empty((0, functions))
        self._misfits = np.empty((0, functions))
        # absolute errors of the values at the nodes
        self._errors = np.empty((0, functions))

    def next(self, solved: Array | None = None) -> float:
        """Return the next node: where the product of distances from all nodes is largest.

        A place that is solved already costs nothing: the best of those is taken instead if its
        product is at least half of the largest.

        Parameters
        ----------
        solved : ndarray, optional
            Places at which the functions are known.
        """
        self._next = float(self._places[np.argmax(self._log_product)])
        if solved is not None and len(self.nodes):
            low, high = self._places[[0, -1]]
            inside = solved[(solved >= low) & (solved <= high)]
            if len(inside):
                with np.errstate(divide="ignore"):
                    log_product = np.log(np.abs(inside[:, None] - self.nodes)).sum(axis=1)
                if log_product.max() >= self._log_product.max() - np.log(2.0):
                    self._next = float(inside[np.argmax(log_product)])
        return self._next

    def add(self, values: Array, errors: Array) -> None:
        """Add the node that `next` has returned.

        Parameters
        ----------
        values, errors : ndarray, shape (functions,)
            Values of the functions there, and estimates of their absolute errors.
        """
        distances = (self._next - self.nodes) / self._width
        misfit = values - self._polynomials(np.array([self._next]))[0][0]
        self.nodes = np.append(self.nodes, self._next)
        self._coefficients = np.vstack([self._coefficients, misfit / np.prod(distances)])
        self._misfits = np.vstack([self._misfits, np.abs(misfit)])
        self._errors = np.vstack([self._errors, errors])
        if len(self.nodes) == 1:
            self._log_product[:] = 0.0
        with np.errstate(divide="ignore"):  # a node is at no distance from itself
            self._log_product += np.log(np.abs(self._places - self._next))

    def settled(self, rtol: float) -> bool:
        """Return whether the misfits at the last nodes are at most a tolerance.

        It is false with few nodes, as the misfits at the first nodes are no estimates.
        """
        last = self._misfits[-_LAST_MISFITS:]
        return len(self._misfits) > 2 * _LAST_MISFITS and bool((last <= rtol).all())

    def invert(self, wanted: Array) -> InvertedCurves:
        """Return the places at which the first function has the values `wanted`."""
        places, last_step = self._inverted(wanted)
        value, slope = self._polynomials(places)
        interpolation_errors = _MISFIT_FACTOR * np.max(self._misfits[-_LAST_MISFITS:], axis=0)
        node_errors = self._lebesgue_function(places)[:, None] * self._errors.max(axis=0)
        error = interpolation_errors + node_errors
        with np.errstate(all="ignore"):
            place_errors = (
                np.where(slope[:, 0] > 0.0, error[:, 0] / slope[:, 0], np.inf) + last_step
            )
        return InvertedCurves(
            places, place_errors, value[:, 1:], error[:, 1:], np.abs(slope[:, 1:])
        )

    def _inverted(self, wanted: Array) -> tuple[Array, Array]:
        """Return the places at which the first function has some values, by Newton's method.

        Places are kept in the interval. The second array is the length of the last step: where
        it is large, the function does not have that value in the interval.
        """
        ends = self._places[[0, -1]]
        first_function = self._polynomials(self._places)[0][:, 0]
        place = np.interp(wanted, first_function, self._places)
        step = np.full(len(place), np.inf)
        for _ in range(_MOST_STEPS):
            value, slope = self._polynomials(place)
            with np.errstate(all="ignore"):
                step = (wanted - value[:, 0]) / slope[:, 0]
            place = np.clip(place + step, *ends)
            if np.abs(step).max() < _LAST_STEP:
                break
        return place, np.abs(step)

    def _lebesgue_function(self, x: Array) -> Array:
        """Return the sum of the moduli of Lagrange's polynomials at x.

        It is the factor by which errors of the values at the nodes may grow there.
        """
        between_nodes = (self.nodes[:, None] - self.nodes) / self._width
        np.fill_diagonal(between_nodes, 1.0)
        from_nodes = (x[:, None] - self.nodes) / self._width
        # at a node the quotient below would be 0/0; with this distance from it the sum is 1
        from_nodes[from_nodes == 0.0] = np.finfo(float).eps ** 2
        lagrange = from_nodes.prod(axis=1)[:, None] / (from_nodes * between_nodes.prod(axis=1))
        return np.asarray(np.abs(lagrange).sum(axis=1))

    def _polynomials(self, x: Array) -> tuple[Array, Array]:
        """Return the polynomials and their derivatives by x, each (places, functions).

        By Horner's rule in Newton's form, from the last node to the first.
        """
        value, slope = np.zeros((2, len(x), self._coefficients.shape[1]))
        for node, coefficient in zip(self.nodes[::-1], self._coefficients[::-1], strict=True):
            distance = (x - node)[:, None] / self._width
            slope = slope * distance + value
            value = value * distance + coefficient
        return value, slope / self._width
