"""The history of a growing contact as users get it: a `ContactHistory`.

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
    interpolation_error,
)
from spectral_contact.spectral.jacobi import gauss_rule

#: The places of the two ends of a piece or panel.
_ENDS: Array = np.array([-1.0, 1.0])
#: Number of Chebyshev points of a piece.
_COUNT = 16
#: Number of points of the quadrature rule from the lower end of a piece to one of these points.
_POINTS = 20
#: Largest extent of a piece in ``v``.
_LARGEST_EXTENT_IN_V = 1.1
#: Largest extent of a piece in ``u``.
_LARGEST_EXTENT_IN_U = 1.6
#: Quantities of flat punches whose errors are read.
_FLAT_QUANTITIES = ("pressure", "approach", "total_shear", "stick_radius")
#: Factor of these errors in load, approach and shear, which are integrals over the history
#: (docs/theory, Errors).
_FLAT_ERROR_FACTOR = 3.0
#: Factor of the errors of the series of a piece and its neighbours. Under cones the errors between
#: nodes are 1.1 times these at most, at the end of a panel under a parabola with a shallow cone 2.3
#: times.
_SERIES_ERROR_FACTOR = 3.0


@dataclass(frozen=True)
class _HistoryPiece:
    """A piece of a panel, on which each quantity of the history is one series in ``u``.

    Attributes
    ----------
    panel : Panel
    interval : RadiusStretch
        The radii of the piece. Its ``b_0`` is 0, so that ``v`` on it is ``u``.
    """

    panel: Panel
    interval: RadiusStretch

    def places(self, u: Array) -> Array:
        """Return the places on the panel, in [-1, 1], of radii given by ``u``."""
        return self.panel.stretch.place_of(u)

    def rates(self, u: Array) -> Array:
        """Return the derivative ``dQ/du`` of the total shear."""
        t = self.places(u)
        dv_du = self.panel.stretch.dv_du_at(t)
        return chebyshev_value(self.panel.shears, t) * self.panel.dload_dv(t) * dv_du


def history_of(growth: Growth, normal_error: float | None) -> ContactHistory:
    """Return load, approach, shear and stick radius as functions of the contact radius.

    Parameters
    ----------
    growth : Growth
    normal_error : float or None
        Estimate of the relative errors of load and approach of normal contact, at all radii; None
        with coupling, where load and approach come from the history.
    """
    # stretches of panels are cut in v, and what results is cut in u
    pieces = [
        _HistoryPiece(panel, interval)
        for panel in growth.panels
        for stretch in panel.stretch.cut(math.ceil(panel.stretch.extent / _LARGEST_EXTENT_IN_V))
        for interval in _intervals_in_u(stretch)
    ]
    nodes = [(piece.panel, piece.places(piece.interval.u_nodes)) for piece in pieces]
    # ln P, ln delta, Q/P and ln(c/b) at the nodes of every piece
    at_nodes = {
        "loads": [panel.loads.at(t) for panel, t in nodes],
        "approaches": [panel.approaches.at(t) for panel, t in nodes],
        "shears": _shears(growth, pieces),
        "sticks": [panel.log_stick(t) for panel, t in nodes],
    }
    ends = np.array([*(piece.interval.low for piece in pieces), growth.log_radius])
    series = {
        name: np.array(list(map(chebyshev_series, arrays))) for name, arrays in at_nodes.items()
    }
    return ContactHistory(ends, **series, errors=_errors(pieces, at_nodes, normal_error))


def _intervals_in_u(stretch: RadiusStretch) -> list[RadiusStretch]:
    """Return intervals into which a stretch is cut, of equal and not too large lengths in ``u``."""
    interval = RadiusStretch(stretch.low, stretch.high, count=_COUNT)
    intervals = interval.cut(math.ceil(interval.extent / _LARGEST_EXTENT_IN_U))
    return [RadiusStretch(piece.low, piece.high, count=_COUNT) for piece in intervals]


def _shears(growth: Growth, pieces: list[_HistoryPiece]) -> list[Array]:
    """Return ``Q/P`` at the nodes of the pieces.

    Up to the first piece Q/P is taken for constant.
    """
    shear = growth.first_shear
    ratios = []
    g, w = gauss_rule(_POINTS)
    for piece in pieces:
        low = piece.interval.low
        nodes = piece.interval.u_nodes
        # from the lower end to every node and to the upper end
        extent = np.append(nodes, piece.interval.high) - low
        rates = piece.rates((low + extent[:, None] * (1.0 + g) / 2.0).ravel())
        shears = shear + extent / 2.0 * (rates.reshape(len(extent), -1) @ w)
        ratios.append(shears[:-1] / piece.panel.load(piece.places(nodes)))
        shear = float(shears[-1])
    return ratios


def _errors(
    pieces: list[_HistoryPiece], at_nodes: dict[str, list[Array]], normal_error: float | None
) -> Array:
    """Return estimates of relative errors on the pieces, in the order of `ContactHistory`."""
    panels = [piece.panel for piece in pieces]
    series_errors = _series_errors(pieces, at_nodes)
    # errors of the flat punches of the panel of every piece, and the largest up to this piece
    flats = {name: np.array([_worst(panel, name) for panel in panels]) for name in _FLAT_QUANTITIES}
    largest_so_far = {name: np.maximum.accumulate(values) for name, values in flats.items()}
    # where all flat punches are alike, Q/P up to the first piece is exact and has no error
    shear_error = series_errors["shears"] + _errors_of_earlier_pieces(
        pieces, at_nodes["loads"], 0.0 if panels[0].punches_alike else 1.0
    )
    shear_error += _FLAT_ERROR_FACTOR * (largest_so_far["total_shear"] + largest_so_far["approach"])
    # the error that load and approach have in common
    if normal_error is None:
        common_error = _errors_of_earlier_pieces(pieces, at_nodes["approaches"], 1.0)
        common_error += _FLAT_ERROR_FACTOR * (
            largest_so_far["pressure"] + largest_so_far["approach"]
        )
    else:
        normal_error += max(panel.node_loads.node_error for panel in panels)
        common_error = np.full(len(panels), normal_error)
    load_error = common_error + series_errors["loads"]
    approach_error = common_error + series_errors["approaches"]
    return np.column_stack(
        [
            load_error,
            approach_error,
            shear_error + load_error,
            series_errors["sticks"] + flats["stick_radius"],
        ]
    )


def _series_errors(
    pieces: list[_HistoryPiece], at_nodes: dict[str, list[Array]]
) -> dict[str, Array]:
    """Return the relative errors of the series of the pieces and of their panels, by name."""
    panels = [piece.panel for piece in pieces]
    errors = {
        name: np.array([interpolation_error(values) for values in arrays])
        for name, arrays in at_nodes.items()
    }
    errors["loads"] += [panel.loads.interpolation_error for panel in panels]
    errors["approaches"] += [panel.approaches.interpolation_error for panel in panels]
    errors["sticks"] += [
        interpolation_error(panel.stick) if panel.slips else 0.0 for panel in panels
    ]
    errors["shears"] += [panel.shear_error * float(np.abs(panel.shears).max()) for panel in panels]
    errors["shears"] /= np.array([max(np.abs(values).min(), TINY) for values in at_nodes["shears"]])
    # the last terms of one piece may be small by chance, so those of its neighbours count, too
    padded = {name: np.pad(values, 1, mode="edge") for name, values in errors.items()}
    return {
        name: _SERIES_ERROR_FACTOR * np.max([v[:-2], v[1:-1], v[2:]], axis=0)
        for name, v in padded.items()
    }


def _errors_of_earlier_pieces(
    pieces: list[_HistoryPiece], logs: list[Array], first_error: float
) -> Array:
    """Return the relative error of the load or approach at the lower end of every piece.

    Load and approach are integrals over the history: their error there is the sum of those that the
    earlier pieces make.

    Parameters
    ----------
    pieces : list of _HistoryPiece
    logs : list of ndarray
        The logarithm of the load or approach at the nodes of every piece.
    first_error : float
        Relative error of the value at which the first piece begins.
    """
    errors = []
    # the error so far, in the unit of the load or approach
    error_so_far = first_error * float(np.exp(chebyshev_value(logs[0], _ENDS[:1])[0]))
    for piece, values in zip(pieces, logs, strict=True):
        at_low, at_high = np.exp(chebyshev_value(values, _ENDS))
        errors.append(error_so_far / at_low)
        error_so_far += piece.panel.shear_error * (at_high - at_low)
    return np.array(errors)


def _worst(panel: Panel, name: str) -> float:
    """Return the largest error of a quantity of the flat punches of a panel; 0 if it is exact."""
    return max(getattr(flat.error, name) or 0.0 for flat in panel.flats)
