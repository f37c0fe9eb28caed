r"""What the pressure demands of the traction: the right-hand side of the tangential equations.

Without friction the surface would move inward by ``kappa g``, ``g(s) = (1/s) int_0^s eta p deta``.
In the half-integral ``G(t) = int_t^1 q ds / sqrt(s^2 - t^2)`` the stick condition asks for
``G = kappa R``, with ``R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2)``. Both are taken here for
kappa = 1, as functions of ``y = 1 - s**2`` or ``1 - t**2``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spectral_contact.fields.legendre import chebyshev_sums
from spectral_contact.fields.series import Array, LogSeries, Radius
from spectral_contact.spectral.jacobi import chebyshev_interpolation, gauss_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.transforms import sampled_series, transforms
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.contact.resolution import NormalContact

_NODES, _FIT = chebyshev_interpolation(14)
_J, _K = np.ogrid[:13, :14]
#: From a Chebyshev series f to that of ``(f(x) - f(-1)) / (x + 1)``.
_QUOTIENT = (1.0 - 2.0 * ((_K - _J - 1) % 2)) * (2.0 - (_J == 0)) * np.maximum(_K - _J, 0)
#: Up to this share of the distance to the edge, where R is singular, they are right to 17.9**-14.
_REGULAR = 0.2


class Targets(NamedTuple):
    """R at a boundary, and next to it.

    Attributes
    ----------
    at : ndarray, shape (k,)
    far : ndarray, shape (k, m)
        Values at the first of some distances.
    near : ndarray, shape (k, n - m)
        Values at the others less those at the boundary, without the subtraction: the Chebyshev
        interpolant of R, from which the factor ``d`` is split off.
    """

    at: Array
    far: Array
    near: Array


class Drive:
    """The functions R and g of a pressure, and the load outside a radius.

    Parameters
    ----------
    contact : NormalContact
        The solved normal problem.
    outer : LogSeries, optional
        What the series of the pressure demands, if known.
    """

    def __init__(self, contact: NormalContact, outer: LogSeries | None = None) -> None:
        self.contact = contact
        self.pressure = contact.pressure
        if outer is None and contact.panels is not None:
            [outer] = _demanded(contact.panels, [contact])
        self._outer = outer

    @cached_property
    def changes(self) -> list[Drive]:
        """The drives of the pressure's last change and of what its top degree contributes.

        They show how its error propagates: an integral of either may be small by accident, hardly
        of both.
        """
        contact, panels = self.contact, self.contact.panels
        if panels is None or not contact.changes:
            return []
        demanded = _demanded(panels, contact.changes)
        return [Drive(*pair) for pair in zip(contact.changes, demanded, strict=True)]

    def value(self, y: float) -> float:
        """Return R at one place."""
        own = 0.0 if self._outer is None else self._outer.value(y)
        return own + float(self._of_weight(np.array(y)))

    def _of_weight(self, y: Array) -> Array | float:
        """Return the part of R that the endpoint weight of the pressure demands."""
        weight = self.pressure.weight
        if weight is None:
            return 0.0
        # (A/t) ln((b + t)/(b - t)) with b^2 = 1 + shift and b - t = (y + shift)/(b + t)
        t = np.sqrt(np.maximum(1.0 - y, 0.0))
        b = sqrt(1.0 + weight.shift)
        small = t < 0.5
        safe = np.where(small, 1.0, t)
        with np.errstate(divide="ignore"):
            value = np.log((b + t) ** 2 / (y + weight.shift)) / safe
        if small.any():
            ratio = np.where(small, t / b, 0.5)
            slope = np.arctanh(ratio) / np.where(ratio > 0.0, ratio, 1.0)
            value = np.where(small, 2.0 / b * np.where(ratio > 0.0, slope, 1.0), value)
        return np.asarray(weight.amplitude * value)

    @staticmethod
    def targets(drives: Sequence[Drive], y: Array) -> Array:
        """Return R of a pressure or of several of its changes at ``y``, (n,), as rows."""
        values = LogSeries.several([one._outer for one in drives], y)
        for row, one in zip(values, drives, strict=True):
            row += one._of_weight(y)
        return values

    @staticmethod
    def targets_from(drives: Sequence[Drive], boundary: Radius, reach: float, d: Array) -> Targets:
        """Return R at a boundary, and next to it.

        Parameters
        ----------
        drives : sequence of Drive
            That of a pressure, or of several of its changes: k.
        boundary : Radius
            Short of the edge.
        reach : float
            Unit of the distances in ``s**2``: negative inward.
        d : ndarray, shape (n,)
            Distances, falling but for those where R is smooth.
        """
        analytic = min(_REGULAR * boundary.rest / abs(reach), 1.0)
        split = int(np.count_nonzero(d > analytic))
        places = np.concatenate([[0.0], analytic * (1.0 + _NODES) / 2.0, d[:split]])
        values = Drive.targets(drives, boundary.rest - reach * places)
        at = values[:, 0]
        # a flat stretch must come out flat: its rounding would be amplified by the division
        fit = _FIT @ (values[:, 1 : 1 + len(_NODES)] - at[:, None]).T
        fit[np.abs(fit) < 2.0 * np.finfo(float).eps * np.abs(at)] = 0.0
        # x + 1 would lose the digits of small distances
        rise = 2.0 * d[split:] / analytic
        x = rise - 1.0
        near = chebyshev_sums(x, (_QUOTIENT @ fit)[:, :, None])
        return Targets(at, values[:, 1 + len(_NODES) :], rise * near)

    def mean_inside(self, y: Array) -> Array:
        """Return the mean of the pressure over the disk ``s**2 <= 1 - y``, for ``y >= 1/2``."""
        g, w = gauss_rule(40)
        points = 1.0 - (1.0 - y)[..., None] * (1.0 + g) / 2.0
        return np.asarray(self.pressure.at(points) @ (w / 2.0))

    @staticmethod
    def loads_outside(drives: Sequence[Drive], y: Array) -> Array:
        """Return ``1/2 int_0^y p dy`` of a pressure or of several of its changes, as rows.

        It is 1/(2 pi) of the load between a radius and the edge.
        """
        values = 0.5 * _integrals([one.pressure.series for one in drives], y)
        for row, weight in zip(values, (one.pressure.weight for one in drives), strict=True):
            if weight is not None:
                root = np.sqrt(y + weight.shift) + sqrt(weight.shift)
                row += weight.amplitude * y / np.where(root > 0.0, root, 1.0)
        return np.asarray(values)


def _demanded(panels: LogPanels, contacts: Sequence[NormalContact]) -> list[LogSeries]:
    """Return what the series of pressures on the same panels demand of the traction."""
    own = transforms(panels)
    values = own.outer(np.array([one.coefficients for one in contacts]))
    values *= 2.0 / np.sqrt(1.0 - panels.distances)
    return [sampled_series(panels, row) for row in values]


def _integrals(series: Sequence[LogSeries | None], y: Array) -> Array:
    """Return the integrals of series on the same panels from 0 to distances, (n,), as rows."""
    first = next((one for one in series if one is not None), None)
    if first is None:
        return np.zeros((len(series), len(y)))
    (count, terms), h, x = first.coefficients.shape, first.width, -np.log(y)
    # what is left of a panel, of all of them first, and the tail, which is no function of x
    own = np.concatenate([np.arange(count + 1), np.clip(x / h, 0.0, count).astype(int)])
    start, d = np.concatenate([h * np.arange(count + 1), x]), np.concatenate([first.ends, y])
    g, w = gauss_rule(terms)
    left, share = (own + 1) * h - start, (1.0 + g) / 2.0
    points = np.exp(-start[:, None] - left[:, None] * share)
    weights = left[:, None] * points
    tail = own == count
    points[tail], weights[tail] = d[tail, None] * share, d[tail, None]
    values = LogSeries.several(series, points.ravel()).reshape(len(series), *points.shape)
    parts = (values * weights) @ (w / 2.0)
    beyond = np.zeros((len(series), count + 1))
    np.cumsum(parts[:, count:0:-1], axis=1, out=beyond[:, -2::-1])
    return np.asarray(parts[:, count + 1 :] + beyond[:, own[count + 1 :]])
