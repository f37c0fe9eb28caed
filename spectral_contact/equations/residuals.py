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

#: Step and reach of the tanh-sinh rule; the last points lie 1e-200 from the ends.
_T = np.arange(-5.6, 5.6001, 1.0 / 32.0)
_U = np.pi / 2.0 * np.sinh(_T)
_LEFT = 1.0 / (1.0 + np.exp(-2.0 * np.clip(_U, -340.0, 340.0)))
_RIGHT = 1.0 / (1.0 + np.exp(2.0 * np.clip(_U, -340.0, 340.0)))
_TINY = float(np.finfo(float).tiny)
_WEIGHT = np.pi * np.cosh(_T) * _LEFT * _RIGHT / 32.0


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
    """Return ``ddelta*/dalpha* = 2 pi int p**2 s ds``, by reciprocity of (3.5).

    The pressure, its breaks, and errors are as of `load`. On a thin layer `edge_layer_breaks` are
    needed.
    """
    return 2.0 * np.pi * load(lambda d: np.square(pressure(d)), breaks=breaks)


def edge_layer_breaks(compliance: float) -> list[float]:
    """Return distances from the edge between which a pressure on a layer is smooth enough.

    Towards the edge it changes like ``1/sqrt(d + c)``, where c is about the compliance. The rule
    resolves this if no interval is much more than a hundred times as long as ``d + c``.
    """
    largest = max(-np.log10(compliance), 0.0) / 2.0
    return [float(compliance * 100.0**k) for k in range(int(np.ceil(largest)))]


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
    place, breaks = within("from_edge", from_edge, "in (0, 1)"), _cuts(breaks)
    return _potential(_field("pressure", pressure), normal_kernel, place, breaks)


def outer_displacement(pressure: Field, beyond: float, breaks: Sequence[float] = ()) -> float:
    """Return ``N p`` so far beyond the edge, where the surface moves as (3.5) says.

    The pressure, its breaks, and errors are as of `load`.
    """
    field = _field("pressure", pressure)
    past = positive("beyond", beyond)
    outside = 1.0 + past

    nodes = _NodesBetween.between({0.0, 1.0, *(b for b in (past, *_cuts(breaks)) if 0.0 < b < 1.0)})
    complement = (past + nodes.d) / outside * ((outside + nodes.s) / outside)
    total = nodes.integral(lambda: field(nodes.d) * nodes.s * ellipkm1(complement))
    return total / (np.pi * outside)


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
        What the traction moves the surface outward by, and the pressure inward; the layer adds
        ``beta q``.

    Raises
    ------
    SceneError
        As of `load`.
    """
    place, breaks = within("from_edge", from_edge, "in (0, 1)"), _cuts(breaks)
    coupling = real("kappa", kappa, allowed="finite")
    outward = _potential(_field("traction", traction), tangential_kernel, place, breaks)
    inward = coupling * load(pressure, inside=place, breaks=breaks) / (1.0 - place)
    return outward, inward


def shear_lift(
    traction: Field, kappa: float, from_edge: float, breaks: Sequence[float] = ()
) -> float:
    """Return ``kappa int_s^1 q deta``, by how much less the surface gives way under a traction.

    The field point is in (0, 1]; else arguments are as of `tangential_displacement`.
    """
    field, coupling = _field("traction", traction), real("kappa", kappa, allowed="finite")
    place = within("from_edge", from_edge, "in (0, 1]")
    nodes = _NodesBetween.between({0.0, place, *(b for b in _cuts(breaks) if 0.0 < b < place)})
    return coupling * nodes.integral(lambda: field(nodes.d))


def _field(parameter: str, field: object) -> Field:
    """Return a field that is a real number everywhere."""
    return partial(values_at, parameter, function(parameter, field, "distances from the edge"))


def _cuts(breaks: object) -> list[float]:
    return [real("breaks", one, allowed="finite") for one in listed("breaks", breaks, "numbers")]


class _NodesBetween(NamedTuple):
    """Nodes of one integral, interval after interval, so that a field is evaluated once."""

    d: Array  # distances from the edge
    s: Array
    left: Array  # distances from the ends of the interval that a node is in
    right: Array
    cuts: Array

    @classmethod
    def between(cls, ends: set[float]) -> _NodesBetween:
        """Return the nodes between the least end and the largest."""
        cuts = np.array(sorted(ends))
        near, far = cuts[:-1, None], cuts[1:, None]
        left, right = (far - near) * _LEFT, (far - near) * _RIGHT
        d = np.where(left < right, near + left, far - right)
        # at the centre the distance cannot resolve s, what is left of the interval can
        s = np.where(far == 1.0, right, 1.0 - d)
        return cls(d.ravel(), s.ravel(), left.ravel(), right.ravel(), cuts)

    def from_cut(self, cut: float) -> Array:
        """Return the distances from a cut: next to it they are known better than differences."""
        apart, after = np.abs(self.d - cut), len(_T) * int(np.searchsorted(self.cuts, cut))
        before, behind = slice(after - len(_T), after), slice(after, after + len(_T))
        apart[before], apart[behind] = self.right[before], self.left[behind]
        return np.maximum(apart, _TINY)  # a kernel is infinite at no distance

    def integral(self, integrand: Callable[[], Array]) -> float:
        """Integrate what is there at the nodes."""
        with np.errstate(over="ignore", invalid="ignore"):  # a field may be anything
            return float(np.diff(self.cuts) @ (integrand().reshape(-1, len(_T)) @ _WEIGHT))


def _potential(
    field: Field, kernel: Callable[..., Array], from_edge: float, breaks: Sequence[float]
) -> float:
    """Return ``(1/pi) int_0^1 field K(eta, s) deta`` at ``s = 1 - from_edge``."""
    nodes = _NodesBetween.between({0.0, 1.0, from_edge, *(b for b in breaks if 0.0 < b < 1.0)})
    influence = kernel(nodes.s, 1.0 - from_edge, distance=nodes.from_cut(from_edge))
    return nodes.integral(lambda: field(nodes.d) * influence) / np.pi
