"""The equations evaluated with the elliptic kernels, for fields of any origin.

No Abel factorisation, no basis, nothing of the solver: tanh-sinh quadrature between the places
where a field is not smooth. Fields are functions of the distance from the edge, ``1 - s``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipkm1

from spectral_contact.equations.kernels import normal_kernel, tangential_kernel
from spectral_contact.io.checks import positive, real, values_at, within
from spectral_contact.io.choices import function, listed

Array = NDArray[np.float64]
Field = Callable[[Array], Array]

#: The tanh-sinh rule on [0, 1], whose nodes are ``(1 + tanh u)/2`` with ``u = (pi/2) sinh t``: the
#: equidistant t, from -5.6 to 5.5875. The first node is 3e-185 from 0, the last 6e-183 from 1.
_T = np.arange(-5.6, 5.6001, 1.0 / 32.0)
_U = np.pi / 2.0 * np.sinh(_T)
#: Distances of the nodes from 0 and from 1, and the weights.
_LEFT = 1.0 / (1.0 + np.exp(-2.0 * _U))
_RIGHT = 1.0 / (1.0 + np.exp(2.0 * _U))
_WEIGHT = np.pi * np.cosh(_T) * _LEFT * _RIGHT / 32.0
_TINY = float(np.finfo(float).tiny)


def load(pressure: Field, *, inside: float = 0.0, breaks: Sequence[float] = ()) -> float:
    """Return ``int p s ds`` over the disk of radius ``1 - inside``, 1/(2 pi) of its load.

    Parameters
    ----------
    pressure : callable
        ``p*`` as a function of an array of distances from the edge.
    inside : float
        Distance of the disk's rim from the edge.
    breaks : sequence of float
        Distances from the edge at which the field is not smooth.

    Raises
    ------
    SceneError
        For an argument that is not as said, or values of the field that are no real numbers.
    """
    field = _field("pressure", pressure)
    inside = within("inside", inside, "in [0, 1)")
    nodes = _NodesBetween.between({inside, 1.0, *(b for b in _cuts(breaks) if inside < b < 1.0)})
    return nodes.integral(lambda: field(nodes.d) * nodes.s)


def approach_slope(pressure: Field, breaks: Sequence[float] = ()) -> float:
    """Return ``ddelta*/dalpha* = 2 pi int p**2 s ds``, as the operator N of (3.5) is symmetric.

    The pressure, its breaks, and errors are as of `load`. On a thin layer `edge_layer_breaks` are
    needed.
    """
    return 2.0 * np.pi * load(lambda d: np.square(pressure(d)), breaks=breaks)


def edge_layer_breaks(compliance: float) -> list[float]:
    """Return breaks at the edge between which the quadrature resolves a pressure on a layer.

    Towards the edge it changes like ``1/sqrt(d + c)`` at the distance d, where c is about the
    compliance. The rule resolves this if no interval is much more than a hundred times as long as
    ``d + c`` at its end next to the edge.
    """
    hundredfolds = max(-np.log10(compliance), 0.0) / 2.0
    return [float(compliance * 100.0**k) for k in range(int(np.ceil(hundredfolds)))]


def normal_displacement(pressure: Field, from_edge: float, breaks: Sequence[float] = ()) -> float:
    """Return ``N p = (1/pi) int_0^1 p K1 deta``, the deflection under the pressure, (3.5).

    Parameters
    ----------
    pressure : callable
        ``p*`` as a function of an array of distances from the edge.
    from_edge : float
        The field point, in (0, 1).
    breaks : sequence of float
        Distances from the edge at which the field is not smooth.

    Raises
    ------
    SceneError
        As of `load`.
    """
    place = within("from_edge", from_edge, "in (0, 1)")
    breaks = _cuts(breaks)
    return _potential(_field("pressure", pressure), normal_kernel, place, breaks)


def outer_displacement(pressure: Field, beyond: float, breaks: Sequence[float] = ()) -> float:
    """Return ``N p`` outside the contact, at a distance `beyond` the edge.

    The free surface moves down by it: the same integral as within the contact. The pressure, its
    breaks, and errors are as of `load`.
    """
    field = _field("pressure", pressure)
    past_edge = positive("beyond", beyond)
    radius = 1.0 + past_edge
    # the kernel changes over the distance of the point from the edge: a break at that distance
    inner_cuts = [b for b in (past_edge, *_cuts(breaks)) if 0.0 < b < 1.0]
    nodes = _NodesBetween.between({0.0, 1.0, *inner_cuts})
    complement = (past_edge + nodes.d) / radius * ((radius + nodes.s) / radius)
    total = nodes.integral(lambda: field(nodes.d) * nodes.s * ellipkm1(complement))
    return total / (np.pi * radius)


def tangential_displacement(
    traction: Field, pressure: Field, kappa: float, from_edge: float, breaks: Sequence[float] = ()
) -> tuple[float, float]:
    """Return the two parts ``T q`` and ``kappa g`` of the radial displacement, (4.2).

    Parameters
    ----------
    traction, pressure : callable
        ``q*`` and ``p*`` as functions of an array of distances from the edge.
    kappa : float
        ``(1 - 2 nu)/(4 (1 - nu))``.
    from_edge : float
        The field point, in (0, 1).
    breaks : sequence of float
        Distances from the edge at which the fields are not smooth.

    Returns
    -------
    outward, inward : float
        The displacement outward by the traction, and that inward by the pressure. The left side of
        (4.2) is ``beta q + outward - inward``.

    Raises
    ------
    SceneError
        As of `load`.
    """
    place = within("from_edge", from_edge, "in (0, 1)")
    breaks = _cuts(breaks)
    coupling = real("kappa", kappa, allowed="finite")
    outward = _potential(_field("traction", traction), tangential_kernel, place, breaks)
    inward = coupling * load(pressure, inside=place, breaks=breaks) / (1.0 - place)
    return outward, inward


def shear_lift(
    traction: Field, kappa: float, from_edge: float, breaks: Sequence[float] = ()
) -> float:
    """Return ``kappa int_s^1 q deta``, by which the traction lifts the surface.

    With elastic coupling the normal displacement is less than `normal_displacement` by this. The
    field point is in (0, 1]; the other arguments are as for `tangential_displacement`.
    """
    field = _field("traction", traction)
    coupling = real("kappa", kappa, allowed="finite")
    place = within("from_edge", from_edge, "in (0, 1]")
    nodes = _NodesBetween.between({0.0, place, *(b for b in _cuts(breaks) if 0.0 < b < place)})
    return coupling * nodes.integral(lambda: field(nodes.d))


def _field(parameter: str, field: object) -> Field:
    """Return the field with a check that its values are real numbers."""
    return partial(values_at, parameter, function(parameter, field, "distances from the edge"))


def _cuts(breaks: object) -> list[float]:
    """Return breaks as numbers, which they are checked to be."""
    return [real("breaks", one, allowed="finite") for one in listed("breaks", breaks, "numbers")]


class _NodesBetween(NamedTuple):
    """Nodes of one integral over several intervals, so that a field is evaluated once for all.

    Attributes
    ----------
    d, s : ndarray, shape (intervals times nodes,)
        Distances from the edge, interval after interval, and radii.
    left, right : ndarray, of the same shape
        Distances of every node from the two ends of its interval.
    cuts : ndarray, shape (intervals + 1,)
        Ends of all intervals, as distances from the edge in rising order.
    """

    d: Array
    s: Array
    left: Array
    right: Array
    cuts: Array

    @classmethod
    def between(cls, ends: set[float]) -> _NodesBetween:
        """Return the nodes of the rule on each interval between neighbouring ends."""
        cuts = np.array(sorted(ends))
        near = cuts[:-1, None]
        far = cuts[1:, None]
        left = (far - near) * _LEFT
        right = (far - near) * _RIGHT
        d = np.where(left < right, near + left, far - right)
        # in the interval that ends at the centre s is `right`, which 1 - d would round
        s = np.where(far == 1.0, right, 1.0 - d)
        return cls(d.ravel(), s.ravel(), left.ravel(), right.ravel(), cuts)

    def from_cut(self, cut: float) -> Array:
        """Return the distances of all nodes from a cut that is none of the two ends.

        In the intervals next to it these are `right` and `left`, which are not rounded as
        differences are.
        """
        distance = np.abs(self.d - cut)
        start = len(_T) * int(np.searchsorted(self.cuts, cut))  # of the interval behind the cut
        before = slice(start - len(_T), start)
        behind = slice(start, start + len(_T))
        distance[before] = self.right[before]
        distance[behind] = self.left[behind]
        return np.maximum(distance, _TINY)  # kernels are infinite at the distance 0

    def integral(self, integrand: Callable[[], Array]) -> float:
        """Integrate a function whose values at the nodes `integrand` returns."""
        # a field that is singular, or that a user wrote wrongly, may overflow or be NaN; weights
        # next to the ends of intervals underflow
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            by_interval = integrand().reshape(-1, len(_T)) @ _WEIGHT
            return float(np.diff(self.cuts) @ by_interval)


def _potential(
    field: Field, kernel: Callable[..., Array], from_edge: float, breaks: Sequence[float]
) -> float:
    """Return ``(1/pi) int_0^1 field K(eta, s) deta`` at ``s = 1 - from_edge``."""
    nodes = _NodesBetween.between({0.0, 1.0, from_edge, *(b for b in breaks if 0.0 < b < 1.0)})
    influence = kernel(nodes.s, 1.0 - from_edge, distance=nodes.from_cut(from_edge))
    return nodes.integral(lambda: field(nodes.d) * influence) / np.pi
