r"""Stick at the edge of a smooth surface with tangential compliance, matched in closed form.

With ``alpha = 0 < beta`` the edge sticks over a width ``w`` in ``y = 1 - s**2`` that may be far
below what panels reach: ``w = 1e-24`` at ``beta = 1e-12``. Outside it the contact is, but for
``w**(1/2 + theta)``, the one that slips up to the edge, with ``p -> C y**(theta - 1/2)`` and
``tan(pi theta) = 2 kappa f``. Inside, the compliance alone moves the surface by as much as the body
does, so q is constant but for ``w/beta``, and next to the edge

    (1/pi) PV int_0^inf p(x) dx / (x - y) = 2 kappa q(y),    q = f p beyond w,    q = f p(w) within.

So ``y p'`` solves a homogeneous Riemann-Hilbert problem, and with ``eta = y/w``

    p = C w**(theta - 1/2) P(eta),
    P = (1/2 - theta) int_eta^inf x**(-3/2) (x - 1)**theta dx                        beyond 1,
    P = P(1) + (1/2 - theta)/cos(pi theta) int_eta^1 x**(-3/2) (1 - x)**theta dx     within.

The width follows from ``u = 0`` at w: ``beta f C w**(theta - 1/2) P(1)`` is by how much the body
moves the edge. Derivation and measured errors are in docs/coupling.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, cos, inf, log, pi
from typing import NamedTuple

import numpy as np
from scipy.special import beta as beta_function
from scipy.special import betainc

from spectral_contact.contact.error_estimate import ZoneSolution
from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.slip_outcome import PartialSlip, zones_outcome
from spectral_contact.contact.tuning import PANEL_WIDTH, ROUNDING
from spectral_contact.fields.legendre import legendre_sum
from spectral_contact.fields.series import (
    EDGE,
    AnnulusSeries,
    Array,
    LogSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.records import Zone
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import gap

#: Relative error of the fields over ``w**(1/2 + theta)`` outside the stick, and of the traction in
#: it over ``w ln(1/w)/beta``: 1.1 and 0.08 at most, measured against panels by
#: `python validation/physics/edge_stick.py`.
_OUTSIDE, _INSIDE = 2.5, 0.2
#: The width is about ``(30 beta f)**(1/(1/2 - theta))``: factors from 11 to 64 occur there.
_WIDTH = 30.0
#: The least width: a radius keeps its distance from the edge down to the smallest doubles.
_LEAST_WIDTH = 1e-290
#: Slip in the wrong sense that rounding makes, relative to the largest.
_NEGLIGIBLE = 1e-10
#: Degree of the panels on which fields are sampled: the inner solution is then right to rounding.
_DEGREE = 24
#: How far below the width panels toward the edge and toward the boundary reach, in ``-ln``.
_BELOW = EPSILON_DEPTH + 4.0


class EdgeStick(NamedTuple):
    """The stick at the edge and the pressure next to it.

    Attributes
    ----------
    theta : float
        ``atan(2 kappa f)/pi``.
    amplitude : float
        C of the pressure.
    width : float
        ``w``, in ``y``.
    """

    theta: float
    amplitude: float
    width: float

    @classmethod
    def matched(cls, theta: float, amplitude: float, moved: float, resistance: float) -> EdgeStick:
        """Return the stick where the body moves the edge, which resists with ``beta f``."""
        stick = cls(theta, amplitude, 0.0)
        ratio = resistance * amplitude * stick.at_width / moved
        return stick._replace(width=float(np.exp(log(ratio) / (0.5 - theta))))

    @property
    def at_width(self) -> float:
        """``P(1)``."""
        lower = 0.5 - self.theta
        return float(lower * beta_function(lower, 1.0 + self.theta))

    @property
    def error(self) -> float:
        """Relative error of the fields outside the stick, and of approach and shear."""
        return float(_OUTSIDE * self.width ** (0.5 + self.theta))

    def error_within(self, beta: float) -> float:
        """Return the relative error of the traction that sticks: its change over the width."""
        return float(_INSIDE * -log(self.width) * self.width / beta) + ROUNDING

    @property
    def traction(self) -> float:
        """``p(w)``, and over friction the traction that sticks."""
        return float(self.amplitude * self.width ** (self.theta - 0.5) * self.at_width)

    def factor(self, eta: Array) -> Array:
        """Return ``P(eta) eta**(1/2 - theta)`` beyond 1: the pressure over its power law."""
        lower = 0.5 - self.theta
        return np.asarray(self.at_width * betainc(lower, 1.0 + self.theta, 1.0 / eta) * eta**lower)

    def within(self, eta: Array, rest: Array) -> Array:
        """Return the pressure at ``eta = 1 - rest`` below 1."""
        slope = (0.5 - self.theta) / cos(pi * self.theta)
        inner = beta_function(self.theta, 0.5) * betainc(self.theta, 0.5, rest)
        risen = 2.0 * (rest**self.theta / np.sqrt(eta) - self.theta * inner)
        scale = self.amplitude * self.width ** (self.theta - 0.5)
        return np.asarray(scale * (self.at_width + slope * risen))


def expected_error(parameters: Parameters) -> float:
    """Return about what the matching errs by, before anything is solved."""
    _, beta, kappa, friction = parameters
    theta = float(np.arctan(2.0 * kappa * friction) / pi)
    logarithm = log(_WIDTH * beta * friction) / (0.5 - theta)
    if logarithm >= -1.0:
        return 1.0
    stick = EdgeStick(theta, 1.0, float(np.exp(max(logarithm, log(_LEAST_WIDTH)))))
    return stick.error + stick.error_within(beta)


def with_edge_stick(solved: ZoneSolution, parameters: Parameters) -> PartialSlip:
    """Return slip up to the edge with the stick that is there, held against the friction law.

    Parameters
    ----------
    solved : ZoneSolution
        One stick disk on a smooth surface, with slip to the edge.
    parameters : Parameters
        With tangential compliance.

    Raises
    ------
    ArithmeticError
        If the body does not move the edge against its traction, so that nothing sticks there.
    """
    _, beta, kappa, friction = parameters
    # the displacement of the body alone: what the compliance adds is infinite at the edge
    outcome = zones_outcome(solved, parameters._replace(beta=0.0))
    moved = outcome.slip.pieces[-1].field
    assert isinstance(moved, AnnulusSeries)
    at_edge = moved.toward_outer.limit
    toward_edge, extent = solved.pressures[-1], gap(*solved.system.bounds[-2:]) / 2.0
    amplitude = legendre_sum(-1.0, toward_edge.tail.tolist()) * extent**-toward_edge.power
    if not (at_edge < 0.0 < amplitude):
        raise ArithmeticError("the edge is not moved against its traction")
    stick = EdgeStick.matched(
        float(np.arctan(2.0 * kappa * friction) / pi), amplitude, -at_edge, beta * friction
    )
    if stick.width >= 0.1 * extent:
        raise ArithmeticError("the stick at the edge is no narrower than the slip")
    if stick.width < _LEAST_WIDTH:
        return outcome
    return _composed(outcome, moved, stick, solved, parameters)


def _composed(
    outcome: PartialSlip,
    moved: AnnulusSeries,
    stick: EdgeStick,
    solved: ZoneSolution,
    parameters: Parameters,
) -> PartialSlip:
    """Return an outcome without stick at the edge with it."""
    _, beta, _, friction = parameters
    inner, width = solved.system.radii[0], stick.width
    rim = Radius(float(np.sqrt(1.0 - width)), width / (1.0 + float(np.sqrt(1.0 - width))))
    extent, half = gap(inner, EDGE) / 2.0, gap(inner, rim) / 2.0
    series = solved.pressures[-1]

    def pressure(d: Array) -> Array:
        """Return the pressure at distances from the rim of the edge's stick."""
        y = width + half * d
        return np.asarray(series(np.minimum(y / extent, 1.0)) * stick.factor(y / width))

    def displacement(d: Array) -> Array:
        y = np.minimum((width + half * d) / extent, 1.0)
        return np.asarray(moved.toward_outer(y) + beta * friction * pressure(d))

    def from_inside(d: Array) -> Array:
        own = solved.pressures[1](d)
        return np.asarray(moved.toward_inner(d) + beta * friction * own)

    depth = log(half / width) + _BELOW
    displacements = sampled(from_inside, _BELOW), sampled(displacement, depth)
    values = np.concatenate([one.at_ends()[:-1] for one in displacements])
    wrong = max(float(values.max() / np.abs(values).max()), 0.0)
    slipping = sampled(pressure, depth)
    toward_rim = sampled(lambda d: stick.within(1.0 - d / 2.0, d / 2.0), _BELOW)
    toward_edge = sampled(
        lambda d: stick.within(d / 2.0, 1.0 - d / 2.0) * np.sqrt(d), _BELOW, power=-0.5
    )
    sticks = np.array([friction * stick.traction])
    constant = LogSeries(sticks[None], sticks, PANEL_WIDTH)
    pieces = outcome.pressure.pieces[:1] if isinstance(outcome.pressure, ZonalField) else ()
    slip_pressure = AnnulusSeries(inner, rim, solved.pressures[1], slipping, power=0)
    slip = AnnulusSeries(inner, rim, *displacements, power=0)
    edge_pressure = AnnulusSeries(rim, EDGE, toward_rim, toward_edge, power=0)
    edge_traction = AnnulusSeries(rim, EDGE, constant, constant, power=0)
    fields = stick.error + stick.error_within(beta)
    sticking = outcome.slip.pieces[0]
    # w is a power 1/(1/2 - theta) of what it follows from
    steep = 1.0 / (0.5 - stick.theta)
    known = outcome.pressure_error + fields + min(outcome.slip_error, 1.0)
    return replace(
        outcome,
        zones=(outcome.zones[0], *_zones(inner, rim)),
        pressure=ZonalField(
            (*pieces, ZonePiece(rim, slip_pressure), ZonePiece(EDGE, edge_pressure))
        ),
        traction=ZonalField(
            (
                outcome.traction.pieces[0],
                ZonePiece(rim, slip_pressure, friction),
                ZonePiece(EDGE, edge_traction),
            )
        ),
        slip=ZonalField((sticking, ZonePiece(rim, slip), ZonePiece(EDGE, None))),
        approach_error=outcome.approach_error + stick.error,
        shear_error=outcome.shear_error + stick.error,
        pressure_error=outcome.pressure_error + fields,
        traction_error=outcome.traction_error + fields,
        radius_error=outcome.radius_error + stick.error,
        zones_error=max(outcome.zones_error, steep * known) if known < 1.0 else inf,
        slip_error=outcome.slip_error + fields,
        violation=max(outcome.violation, wrong),
        consistent=outcome.consistent and wrong <= max(outcome.slip_error + fields, _NEGLIGIBLE),
        layout=None,
    )


def _zones(inner: Radius, rim: Radius) -> tuple[Zone, Zone]:
    return Zone.between("slip", inner, rim), Zone.between("stick", rim, EDGE)


def sampled(function: Callable[[Array], Array], depth: float, *, power: float = 0.0) -> LogSeries:
    """Return a series through values of a function of the distance, times ``d**power``."""
    panels, (g, _) = ceil(depth / PANEL_WIDTH), gauss_rule(_DEGREE + 1)
    x = PANEL_WIDTH * (np.arange(panels)[:, None] + (1.0 + g) / 2.0)
    values = function(np.exp(-x.ravel())).reshape(x.shape)
    table = values @ legendre_expansion_matrix(_DEGREE + 1, _DEGREE).T
    return LogSeries(table, np.array([table[-1].sum()]), PANEL_WIDTH, power)
