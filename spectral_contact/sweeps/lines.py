"""Scenes that differ in ``f/kappa`` alone: few of these are solved, and all scenes lie between.

Poisson's ratio enters by kappa: with the same ``f/kappa`` zones are the same, and tractions are as
kappa. With one stick disk ``ln f`` and ``ln(Q/f)`` are smooth in the logit of its radius: whatever
the compliances, singularities are pi away from the real axis. Newton's polynomials go through
solved frictions there, and are inverted for those of the scenes. The next friction to be solved is
where the polynomials are least certain (Leja's points), which measures how far off they were.

No law has to be checked between two frictions at which one disk is right (docs/maps).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.solution import Solution
from spectral_contact.sweeps.parameters import Columns, Indices
from spectral_contact.sweeps.request import SCALARS, Request
from spectral_contact.sweeps.shortcuts import Served

if TYPE_CHECKING:
    from spectral_contact.solving.run import FrictionOf

__all__ = ["LEAST", "Solver", "between", "lines"]

Array = NDArray[np.float64]

#: From so many frictions on some can be spared.
LEAST: Final = 24
#: Nodes that a line takes at 1e-8, measured: so many, and more for each unit of the logit. For
#: more digits it takes more in proportion.
_FIRST, _MORE = 6.0, 2.4
#: What is proportional to kappa at the same ``f/kappa``.
_AS_KAPPA: Final = frozenset({"edge_ratio", "critical_friction"})
#: Share of the scenes that the nodes may be.
_WORTH: Final = 0.8
#: How many misfits, of the last nodes, tell what is missing: each is the error without its node.
_LAST: Final = 3
#: How many times the largest of them that is taken to be.
_SAFETY: Final = 2.0
#: Places that nodes are chosen from.
_PLACES: Final = 400
#: Steps to a logit, and one that is no step any more.
_STEPS, _STILL = 12, 1e-13


def lines(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield scenes, of those to do, that differ in ``f/kappa`` alone, as it rises; none coupled."""
    if not frozenset(request.quantities) <= frozenset(SCALARS):
        return
    nu, _, _, friction = columns.values[:4, todo]
    slips = (friction > 0.0) & (friction < np.inf) & (nu < 0.5)
    own = todo[slips & ~columns.coupled[todo]]
    ratio = columns.values[3, own] / columns.kappa[own]
    own = own[np.lexsort([ratio, *columns.values[[2, 1]][:, own]])]
    turns = np.diff(columns.values[1:3, own], axis=1) != 0.0
    for line in np.split(own, np.flatnonzero(turns.any(axis=0)) + 1):
        if len(line) >= LEAST:
            yield line


class Solver(Protocol):
    """What solves the scenes of a line."""

    def at_scene(self, i: int) -> Solution | None:
        """Return the solution of a scene of the line, with its zones, if it converged."""

    def at_radius(self, logit: float) -> FrictionOf | None:
        """Return the friction with which the first scene has one disk of this radius, if any."""


def between(columns: Columns, request: Request, solver: Solver) -> Served:
    """Return what is known of the scenes of a line from a few that are solved.

    Parameters
    ----------
    columns : Columns
        The scenes, by rising ``f/kappa``.
    request : Request
        For numbers alone.
    solver : Solver
    """
    kappa, friction = columns.kappa, columns.values[3]
    ratio = friction / kappa
    mask = np.zeros(len(columns), dtype=bool)
    nothing = Served(mask, {}, {})
    ends = _ends(len(ratio), solver)
    if ends is None:
        return nothing
    size, one = ends.size, ends.solution
    inner, most = slice(1, size - 1), _WORTH * size
    low, high = ends.logits
    if (_FIRST + _MORE * (high - low)) * np.log(request.rtol) / np.log(1e-8) > most:
        return nothing
    curves = _Curves(low, high, float(kappa[0]))
    while curves.nodes.size < most:
        if curves.settled(request.rtol):
            values, errors = curves.values(ratio[inner])
            values["total_shear"] *= friction[inner]
            for name in frozenset(request.quantities) - frozenset(values):  # at any friction
                scale = kappa[inner] / one.scene.kappa if name in _AS_KAPPA else 1.0
                values[name] = np.full(size - 2, float(getattr(one, name))) * scale
                errors[name] = np.full(size - 2, float(getattr(one.error, name)))
            asked = request.quantities
            if all((errors[name] <= request.rtol).all() for name in asked):
                mask[inner] = True
                return Served(mask, {k: values[k] for k in asked}, {k: errors[k] for k in asked})
        found = solver.at_radius(curves.next())
        if found is None:
            break
        curves.add(found)
    return nothing


@dataclass(frozen=True, slots=True)
class _Ends:
    """How many scenes have one stick disk, the logits of the first and the last, a solution."""

    size: int
    logits: tuple[float, float]
    solution: Solution


def _ends(count: int, solver: Solver) -> _Ends | None:
    """Return between which scenes there is one stick disk, if it is at the first and many more."""
    alone: dict[int, Solution] = {}

    def is_alone(i: int) -> bool:
        found = solver.at_scene(i)
        if found is None or tuple(zone.kind for zone in found.zones) != ("stick", "slip"):
            return False
        alone[i] = found
        return True

    low, high = 0, count - 1
    if not is_alone(low):
        return None
    # where one disk is right at two frictions, it is between
    if is_alone(high):
        low = high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if is_alone(middle) else (low, middle)
    if low + 1 < LEAST:
        return None
    disks = [alone[i].zones[0] for i in (0, low)]
    z, y = np.array([(one.outer**2, one.outer_from_edge * (1.0 + one.outer)) for one in disks]).T
    if not (np.minimum(z, y) > 0.0).all():
        return None
    first, last = np.log(z / y).tolist()
    return _Ends(low + 1, (first, last), alone[0]) if first < last else None


class _Curves:
    """The polynomials through what is solved.

    Parameters
    ----------
    low, high : float
        Logits of the least and the largest disk.
    kappa : float
        Of the scene whose frictions are solved.

    Attributes
    ----------
    nodes : ndarray, shape (nodes,)
        Logits at which it is solved.
    """

    def __init__(self, low: float, high: float, kappa: float) -> None:
        self._kappa = kappa
        self._places = np.linspace(low, high, _PLACES)
        #: the sum of the logarithms of the distances from the nodes
        self._apart = -np.abs(self._places - low)
        self.nodes = np.empty(0)
        self._next = low
        #: of ln(f/kappa) and ln(Q/f): terms of the polynomials, what they lacked before, and errors
        self._terms, self._misfits, self._errors = np.empty((3, 0, 2))

    def next(self) -> float:
        """Return the logit where the polynomials are least certain."""
        self._next = float(self._places[np.argmax(self._apart)])
        return self._next

    def add(self, found: FrictionOf) -> None:
        """Take what is solved at the last place that was asked for."""
        known = np.log([found.friction / self._kappa, found.total_shear / found.friction])
        steps = self._next - self.nodes
        misfit = known - _newton(self.nodes, self._terms, np.array([self._next]))[0][0]
        self.nodes = np.append(self.nodes, self._next)
        self._terms = np.vstack([self._terms, misfit / np.prod(steps)])
        self._misfits = np.vstack([self._misfits, np.abs(misfit)])
        self._errors = np.vstack([self._errors, [found.friction_error, found.shear_error]])
        if len(self.nodes) == 1:
            self._apart[:] = 0.0
        with np.errstate(divide="ignore"):
            self._apart += np.log(np.abs(self._places - self._next))

    def settled(self, rtol: float) -> bool:
        """Return whether the last nodes were where the polynomials had them."""
        last = self._misfits[-_LAST:]
        return len(self._misfits) > 2 * _LAST and bool((last <= rtol).all())

    def values(self, ratio: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return stick radii and ``Q/f`` at some ``f/kappa``, and the estimates of their errors."""
        logit, unsettled = self._inverted(np.log(ratio))
        value, slope = _newton(self.nodes, self._terms, logit)
        missing = _SAFETY * np.max(self._misfits[-_LAST:], axis=0)
        lost = missing + self._spread(logit)[:, None] * self._errors.max(axis=0)
        with np.errstate(all="ignore"):
            moved = np.where(slope[:, 0] > 0.0, lost[:, 0] / slope[:, 0], np.inf) + unsettled
        z, y = 1.0 / (1.0 + np.exp(-logit)), 1.0 / (1.0 + np.exp(logit))
        values = {"stick_radius": np.sqrt(z), "total_shear": np.exp(value[:, 1])}
        errors = {
            "stick_radius": 0.5 * y * moved + ROUNDING,
            "total_shear": lost[:, 1] + np.abs(slope[:, 1]) * moved + ROUNDING,
        }
        return values, errors

    def _inverted(self, wanted: Array) -> tuple[Array, Array]:
        """Return logits of the logarithms of ``f/kappa``, and how far they still moved."""
        places = self._places[[0, -1]]
        known = _newton(self.nodes, self._terms, self._places)[0][:, 0]
        logit = np.interp(wanted, known, self._places)
        step = np.full(len(logit), np.inf)
        for _ in range(_STEPS):
            value, slope = _newton(self.nodes, self._terms, logit)
            with np.errstate(all="ignore"):
                step = (wanted - value[:, 0]) / slope[:, 0]
            logit = np.clip(logit + step, *places)
            if np.abs(step).max() < _STILL:
                break
        return logit, np.abs(step)

    def _spread(self, x: Array) -> Array:
        """Return by how much polynomials make more of the largest error at the nodes."""
        apart = self.nodes[:, None] - self.nodes
        np.fill_diagonal(apart, 1.0)
        ahead = x[:, None] - self.nodes
        ahead[ahead == 0.0] = np.finfo(float).tiny
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
