"""The history of a growing contact as it is told to users.

Symbols are those of docs/theory, contacts that grow: ``u = ln b`` is the logarithm of a contact
radius, and ``v = ln(b - b_0)`` the coordinate of interpolation on a panel (`RadiusStretch`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spectral_contact.fields import Array
from spectral_contact.fields.history import ContactHistory
from spectral_contact.solving.growth import Growth
from spectral_contact.solving.growth_panel import TINY, Panel
from spectral_contact.solving.stretch import (
    RadiusStretch,
    chebyshev_series,
    chebyshev_value,
    left_out,
)
from spectral_contact.spectral.jacobi import gauss_rule

_ENDS: Array = np.array([-1.0, 1.0])
#: Chebyshev points of a piece, and points of the quadrature rule from its lower end to one of them.
_COUNT, _POINTS = 16, 20
#: Largest width of a piece, in ``v`` and in ``u``.
_WIDE, _WIDE_IN_LOG = 1.1, 1.6
#: Quantities of flat punches whose errors are read, and the factor of these errors in load,
#: approach and shear, which are integrals over the history (docs/theory, Errors).
_OF_FLATS, _FLATS_COUNT = ("pressure", "approach", "total_shear", "stick_radius"), 3.0


@dataclass(frozen=True)
class _HistoryPiece:
    """A piece of a panel, in the logarithm of the radius."""

    panel: Panel
    radii: RadiusStretch

    def places(self, u: Array) -> Array:
        """Return the places on the panel in [-1, 1]."""
        return self.panel.stretch.place_of(u)

    def rates(self, u: Array) -> Array:
        """Return ``dQ/du``."""
        t = self.places(u)
        dv_du = self.panel.stretch.dv_du_at(t)
        return chebyshev_value(self.panel.shears, t) * self.panel.increment(t) * dv_du


def history_of(growth: Growth, known: float | None) -> ContactHistory:
    """Return load, approach, shear and stick radius over the contact radius.

    Parameters
    ----------
    growth : Growth
    known : float or None
        Estimate of the errors of load and approach of normal contact, at all radii; None if they
        come from the history.
    """
    pieces = [
        _HistoryPiece(panel, radii)
        for panel in growth.panels
        for part in panel.stretch.cut(math.ceil(panel.stretch.extent / _WIDE))
        for radii in _in_logs(part)
    ]
    nodes = [(one.panel, one.places(one.radii.u_nodes)) for one in pieces]
    rows = {
        "loads": [panel.loads.at(t) for panel, t in nodes],
        "approaches": [panel.approaches.at(t) for panel, t in nodes],
        "shears": _shears(growth, pieces),
        "sticks": [panel.log_stick(t) for panel, t in nodes],
    }
    ends = np.array([*(one.radii.low for one in pieces), growth.log_radius])
    series = {name: np.array(list(map(chebyshev_series, of))) for name, of in rows.items()}
    return ContactHistory(ends, **series, errors=_errors(pieces, rows, known))


def _in_logs(part: RadiusStretch) -> list[RadiusStretch]:
    """Return parts of a stretch that are not too wide, in the logarithm of the radius."""
    whole = RadiusStretch(part.low, part.high, count=_COUNT)
    cut = whole.cut(math.ceil(whole.extent / _WIDE_IN_LOG))
    return [RadiusStretch(one.low, one.high, count=_COUNT) for one in cut]


def _shears(growth: Growth, pieces: list[_HistoryPiece]) -> list[Array]:
    """Return ``Q/P`` at the nodes of the pieces.

    Up to the first piece Q/P is taken for constant.
    """
    shear = growth.first_shear
    ratios = []
    g, w = gauss_rule(_POINTS)
    for one in pieces:
        low, logs = one.radii.low, one.radii.u_nodes
        extent = np.append(logs, one.radii.high) - low
        rates = one.rates((low + extent[:, None] * (1.0 + g) / 2.0).ravel())
        shears = shear + extent / 2.0 * (rates.reshape(len(extent), -1) @ w)
        ratios.append(shears[:-1] / one.panel.load(one.places(logs)))
        shear = float(shears[-1])
    return ratios


def _errors(
    pieces: list[_HistoryPiece], rows: dict[str, list[Array]], known: float | None
) -> Array:
    """Return estimates of relative errors on the pieces, in the order of `ContactHistory`."""
    panels, own = [one.panel for one in pieces], _left_out(pieces, rows)
    flats = {name: np.array([_worst(one, name) for one in panels]) for name in _OF_FLATS}
    grown = {name: np.maximum.accumulate(values) for name, values in flats.items()}
    # where all flat punches are alike, Q/P up to the first piece is exact and has no error
    shear = own["shears"] + _carried(pieces, rows["loads"], 0.0 if panels[0].alike else 1.0)
    shear += _FLATS_COUNT * (grown["total_shear"] + grown["approach"])
    if known is None:
        common = _carried(pieces, rows["approaches"], 1.0)
        common += _FLATS_COUNT * (grown["pressure"] + grown["approach"])
    else:
        known += max(one.node_loads.node_error for one in panels)
        common = np.full(len(panels), known)
    load, approach = common + own["loads"], common + own["approaches"]
    return np.stack([load, approach, shear + load, own["sticks"] + flats["stick_radius"]], axis=1)


def _left_out(pieces: list[_HistoryPiece], rows: dict[str, list[Array]]) -> dict[str, Array]:
    """Return what the series of the pieces and of their panels leave out."""
    panels = [one.panel for one in pieces]
    own = {name: np.array([left_out(values) for values in of]) for name, of in rows.items()}
    own["loads"] += [one.loads.interpolation_error for one in panels]
    own["approaches"] += [one.approaches.interpolation_error for one in panels]
    own["sticks"] += [left_out(one.stick) if one.slips else 0.0 for one in panels]
    own["shears"] += [one.shear_error * float(np.abs(one.shears).max()) for one in panels]
    own["shears"] /= np.array([max(np.abs(values).min(), TINY) for values in rows["shears"]])
    # The last terms of one piece may be small by chance, so those of its neighbours count, too.
    # Under cones errors between nodes are 1.1 times that at most, and at the end of a panel under a
    # parabola with a shallow cone 2.3 times, for which there is a factor of 3.
    around = {name: np.pad(values, 1, mode="edge") for name, values in own.items()}
    return {name: 3.0 * np.max([v[:-2], v[1:-1], v[2:]], axis=0) for name, v in around.items()}


def _carried(pieces: list[_HistoryPiece], logs: list[Array], begun: float) -> Array:
    """Return the errors that pieces take over from earlier ones, relative to their lower values.

    An integral over the history keeps what every earlier piece has left out.

    Parameters
    ----------
    pieces : list of _HistoryPiece
    logs : list of ndarray
        The logarithm of the load or approach at the nodes of every piece.
    begun : float
        Relative error of the value at which the first piece begins.
    """
    found = []
    lost = begun * float(np.exp(chebyshev_value(logs[0], _ENDS[:1])[0]))
    for one, values in zip(pieces, logs, strict=True):
        low, high = np.exp(chebyshev_value(values, _ENDS))
        found.append(lost / low)
        lost += one.panel.shear_error * (high - low)
    return np.array(found)


def _worst(panel: Panel, name: str) -> float:
    return max(getattr(one.error, name) or 0.0 for one in panel.flats)
