"""The history of a growing contact as it is told to users."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.history import ContactHistory
from spectral_contact.solving.growth import Growth
from spectral_contact.solving.growth_panel import Panel
from spectral_contact.solving.nodes import NODES, chebyshev_series, chebyshev_value, left_out
from spectral_contact.spectral.jacobi import gauss_rule

__all__ = ["history_of"]

Array = NDArray[np.float64]

#: Below the range of doubles.
_TINY = 1e-300
_ENDS: Array = np.array([-1.0, 1.0])
#: Points of a rule up to a node.
_POINTS = 20
#: What is known of flat punches, and by how much more their errors count in what adds up.
_OF_FLATS, _FLATS_COUNT = ("pressure", "approach", "total_shear", "stick_radius"), 3.0


def history_of(growth: Growth, known: float | None) -> ContactHistory:
    """Return load, approach, shear and stick radius over the contact radius.

    Parameters
    ----------
    growth : Growth
    known : float or None
        Estimate of the errors of load and approach of normal contact, at all radii; None if they
        come from the history.
    """
    panels = growth.panels
    rows = {
        "loads": [one.weights.loads for one in panels],
        "approaches": [one.weights.approaches for one in panels],
        "shears": _shears(panels),
        "sticks": [one.stick for one in panels],
    }
    ends = np.array([*(one.low for one in panels), growth.log_radius])
    series = {name: np.array(list(map(chebyshev_series, of))) for name, of in rows.items()}
    return ContactHistory(ends, **series, errors=_errors(panels, rows, known))


def _shears(panels: tuple[Panel, ...]) -> list[Array]:
    """Return ``Q/P`` at the nodes of the panels; before the first it is constant."""
    first, (g, w) = panels[0], gauss_rule(_POINTS)
    shear, ratios = first.flats[0].total_shear * float(first.load(_ENDS[:1])[0]), []
    for one in panels:
        extent = (1.0 + np.append(NODES, 1.0)) / 2.0
        t = (extent[:, None] * (1.0 + g) - 1.0).ravel()
        rates = (chebyshev_value(one.shears, t) * one.increment(t)).reshape(len(extent), -1)
        shears = shear + (one.high - one.low) / 2.0 * extent * (rates @ w)
        ratios.append(shears[:-1] / np.exp(one.weights.loads))
        shear = float(shears[-1])
    return ratios


def _errors(panels: tuple[Panel, ...], rows: dict[str, list[Array]], known: float | None) -> Array:
    """Return estimates of relative errors on the panels, in the order of `ContactHistory`."""
    own = {name: np.array([left_out(values) for values in of]) for name, of in rows.items()}
    own["shears"] /= np.array([max(np.abs(values).min(), _TINY) for values in rows["shears"]])
    # the last terms of one panel may be small by chance; between nodes under cones 1.1 times that
    around = {name: np.pad(values, 1, mode="edge") for name, values in own.items()}
    own = {name: 2.0 * np.max([v[:-2], v[1:-1], v[2:]], axis=0) for name, v in around.items()}
    if known is not None:
        known += max(one.weights.at_nodes for one in panels)
    flats = {name: np.array([_worst(one, name) for one in panels]) for name in _OF_FLATS}
    grown = {name: np.maximum.accumulate(values) for name, values in flats.items()}
    # on a smooth surface shear is in proportion to the load from the first touch on
    alike = all(one is panels[0].flats[0] for one in panels[0].flats)
    shear = own["shears"] + _carried(panels, rows["loads"], 0.0 if alike else 1.0)
    shear += _FLATS_COUNT * (grown["total_shear"] + grown["approach"])
    load, approach = np.full((2, len(panels)), known or 0.0)
    if known is None:
        history = _carried(panels, rows["approaches"], 1.0)
        history += _FLATS_COUNT * (grown["pressure"] + grown["approach"])
        load, approach = load + history, approach + history
    load, approach = load + own["loads"], approach + own["approaches"]
    return np.stack([load, approach, shear + load, own["sticks"] + flats["stick_radius"]], axis=1)


def _carried(panels: tuple[Panel, ...], logs: list[Array], begun: float) -> Array:
    """Return what panels before leave out, and a share of the beginning, over the value of each."""
    found = []
    lost = begun * float(np.exp(chebyshev_value(logs[0], _ENDS[:1])[0]))
    for one, values in zip(panels, logs, strict=True):
        low, high = np.exp(chebyshev_value(values, _ENDS))
        found.append(lost / low)
        lost += one.shear_error * high
    return np.array(found)


def _worst(panel: Panel, name: str) -> float:
    """Return the largest error of the flat punches of a panel."""
    return max(getattr(one.error, name) or 0.0 for one in panel.flats)
