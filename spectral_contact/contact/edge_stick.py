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

The width w follows from ``u = 0`` at w: the displacement of the edge by the body cancels that of
the compliance, ``beta f p(w) = beta f C w**(theta - 1/2) P(1)``. Derivation and measured errors are
in docs/coupling.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, cos, exp, inf, log, pi
from typing import NamedTuple

import numpy as np
from scipy.special import beta as beta_function
from scipy.special import betainc

from spectral_contact.contact.error_estimate import ZoneSolution
from spectral_contact.contact.resolution import (
    EPSILON_DEPTH,
)
from spectral_contact.contact.slip_outcome import PartialSlip, zones_outcome
from spectral_contact.contact.stick_radius import MAX_LOGIT
from spectral_contact.contact.tuning import (
    EDGE_ERROR_INSIDE,
    EDGE_ERROR_OUTSIDE,
    PANEL_WIDTH,
    ROUNDING,
    SLIP_ROUNDING,
)
from spectral_contact.contact.zone_fields import edge_exponent, edge_stick_width
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
from spectral_contact.spectral.jacobi import PANEL_SAMPLES, gauss_rule, legendre_expansion_matrix
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import gap

#: Least width of the stick at the edge in ``y``; a narrower one is left out. The logit of its
#: boundary is the largest that a stick radius may have.
MIN_EDGE_WIDTH = exp(-MAX_LOGIT)


class EdgeStick(NamedTuple):
    """The stick at the edge and the pressure next to it.

    Attributes
    ----------
    theta : float
        ``atan(2 kappa f)/pi``.
    amplitude : float
        C of the pressure ``C y**(theta - 1/2)`` beyond the stick.
    width : float
        w, the value of y at the boundary of the stick.
    """

    theta: float
    amplitude: float
    width: float

    @classmethod
    def matched(
        cls, theta: float, amplitude: float, displacement: float, resistance: float
    ) -> EdgeStick:
        """Return the stick whose width makes the displacement at its boundary vanish.

        Parameters
        ----------
        theta, amplitude : float
            As the attributes.
        displacement : float
            By how much the body alone moves the edge against the traction, positive.
        resistance : float
            ``beta f``: what a pressure of 1 adds to the displacement through the compliance.
        """
        stick = cls(theta, amplitude, 0.0)
        ratio = resistance * amplitude * stick.pressure_factor_at_width / displacement
        return stick._replace(width=float(np.exp(log(ratio) / (0.5 - theta))))

    @property
    def pressure_factor_at_width(self) -> float:
        """``P(1)``."""
        exponent = 0.5 - self.theta
        return float(exponent * beta_function(exponent, 1.0 + self.theta))

    @property
    def error(self) -> float:
        """Relative error of the fields outside the stick, and of approach and shear."""
        return float(EDGE_ERROR_OUTSIDE * self.width ** (0.5 + self.theta))

    def traction_error(self, beta: float) -> float:
        """Return the relative error of the traction in the stick: it is taken to be constant."""
        return float(EDGE_ERROR_INSIDE * -log(self.width) * self.width / beta) + ROUNDING

    @property
    def traction(self) -> float:
        """The traction in the stick, over the friction: ``p(w)``."""
        return float(
            self.amplitude * self.width ** (self.theta - 0.5) * self.pressure_factor_at_width
        )

    def exterior_factor(self, eta: Array) -> Array:
        """Return ``P(eta) eta**(1/2 - theta)`` at eta above 1: the pressure over its power law."""
        exponent = 0.5 - self.theta
        incomplete = betainc(exponent, 1.0 + self.theta, 1.0 / eta)
        return np.asarray(self.pressure_factor_at_width * incomplete * eta**exponent)

    def pressure_within(self, eta: Array, rest: Array) -> Array:
        """Return the pressure at eta below 1, in the stick; ``rest = 1 - eta``, exact."""
        prefactor = (0.5 - self.theta) / cos(pi * self.theta)
        incomplete = beta_function(self.theta, 0.5) * betainc(self.theta, 0.5, rest)
        # the integral from eta to 1 of x**(-3/2) (1 - x)**theta, by parts
        integral = 2.0 * (rest**self.theta / np.sqrt(eta) - self.theta * incomplete)
        scale = self.amplitude * self.width ** (self.theta - 0.5)
        return np.asarray(scale * (self.pressure_factor_at_width + prefactor * integral))


def expected_error(parameters: Parameters) -> float:
    """Return the expected relative error of the closed form, from an estimate of the width.

    It is 1, no digit, where the stick is too wide to be narrow.
    """
    theta = edge_exponent(parameters)
    width = edge_stick_width(parameters, theta)
    if width >= exp(-1.0):
        return 1.0
    stick = EdgeStick(theta, 1.0, max(width, MIN_EDGE_WIDTH))
    return stick.error + stick.traction_error(parameters.beta)


def with_edge_stick(
    solved: ZoneSolution, parameters: Parameters, *, point_disk: bool = False
) -> PartialSlip:
    """Return slip up to the edge with the stick there, verified against the friction law.

    Parameters
    ----------
    solved : ZoneSolution
        One stick disk on a smooth surface, with slip to the edge.
    parameters : Parameters
        With tangential compliance, and without normal compliance.
    point_disk : bool
        As of `zones_outcome`.

    Raises
    ------
    ArithmeticError
        If the body does not move the edge against its traction, so that nothing sticks there, or
        the stick is not narrow.
    """
    _, beta, _, friction = parameters
    # the displacement of the body alone, because that of the compliance is infinite at the edge
    outcome = zones_outcome(solved, parameters._replace(beta=0.0), point_disk=point_disk)
    body_displacement = outcome.slip.pieces[-1].field
    assert isinstance(body_displacement, AnnulusSeries)
    at_edge = body_displacement.toward_outer.limit
    edge_pressure = solved.pressures[-1]
    extent = gap(*solved.system.bounds[-2:]) / 2.0
    amplitude = legendre_sum(-1.0, edge_pressure.tail.tolist()) * extent**-edge_pressure.power
    if not (at_edge < 0.0 < amplitude):
        raise ArithmeticError("the edge is not moved against its traction")
    stick = EdgeStick.matched(edge_exponent(parameters), amplitude, -at_edge, beta * friction)
    if stick.width >= extent:
        raise ArithmeticError("the stick at the edge is no narrower than the slip")
    if stick.width < MIN_EDGE_WIDTH:
        return outcome
    return _with_fields_of_stick(outcome, body_displacement, stick, solved, parameters)


def _with_fields_of_stick(
    outcome: PartialSlip,
    body_displacement: AnnulusSeries,
    stick: EdgeStick,
    solved: ZoneSolution,
    parameters: Parameters,
) -> PartialSlip:
    """Return an outcome that slips up to the edge, with the stick at the edge added.

    Its zones are the disk, slip from `inner` to `rim`, and stick from `rim` to the edge.

    Parameters
    ----------
    outcome : PartialSlip
        Slip up to the edge, without tangential compliance.
    body_displacement : AnnulusSeries
        Its displacement in slip.
    stick : EdgeStick
    solved : ZoneSolution
        From which the outcome was made.
    parameters : Parameters
    """
    _, beta, _, friction = parameters
    inner = solved.system.radii[0]
    width = stick.width
    rim_value = float(np.sqrt(1.0 - width))
    rim = Radius(rim_value, width / (1.0 + rim_value))
    extent = gap(inner, EDGE) / 2.0
    extent_to_rim = gap(inner, rim) / 2.0
    inner_pressure = solved.pressures[1]
    outer_pressure = solved.pressures[-1]

    # functions of the distance d of y from a boundary, 1 in the middle of the zone

    def pressure_outside_rim(d: Array) -> Array:
        y = width + extent_to_rim * d
        unmatched = outer_pressure(np.minimum(y / extent, 1.0))
        return np.asarray(unmatched * stick.exterior_factor(y / width))

    def slip_outside_rim(d: Array) -> Array:
        distance = np.minimum((width + extent_to_rim * d) / extent, 1.0)
        layer = beta * friction * pressure_outside_rim(d)
        return np.asarray(body_displacement.toward_outer(distance) + layer)

    def slip_outside_disk(d: Array) -> Array:
        layer = beta * friction * inner_pressure(d)
        return np.asarray(body_displacement.toward_inner(d) + layer)

    def pressure_inside_rim(d: Array) -> Array:
        return stick.pressure_within(1.0 - d / 2.0, d / 2.0)

    def pressure_inside_edge(d: Array) -> Array:
        """Return the pressure times the square root of the distance, which is regular."""
        return stick.pressure_within(d / 2.0, 1.0 - d / 2.0) * np.sqrt(d)

    depth = log(extent_to_rim / width) + EPSILON_DEPTH
    slip_series = (
        sampled(slip_outside_disk, EPSILON_DEPTH),
        sampled(slip_outside_rim, depth),
    )
    slip = AnnulusSeries(inner, rim, *slip_series, power=0)
    # without the values next to the boundaries, where slip vanishes and its sense is rounding
    values = np.concatenate([series.at_ends()[:-1] for series in slip_series])
    wrong = max(float(values.max() / np.abs(values).max()), 0.0)
    slip_pressure = AnnulusSeries(
        inner, rim, inner_pressure, sampled(pressure_outside_rim, depth), power=0
    )
    edge_pressure = AnnulusSeries(
        rim,
        EDGE,
        sampled(pressure_inside_rim, EPSILON_DEPTH),
        sampled(pressure_inside_edge, EPSILON_DEPTH, power=-0.5),
        power=0,
    )
    stick_traction = np.array([friction * stick.traction])
    constant = LogSeries(stick_traction[None], stick_traction, PANEL_WIDTH)
    edge_traction = AnnulusSeries(rim, EDGE, constant, constant, power=0)
    disk_pressure = outcome.pressure.pieces[:1] if isinstance(outcome.pressure, ZonalField) else ()

    field_error = stick.error + stick.traction_error(beta)
    slip_error = outcome.slip_error + field_error
    # w is a power 1/(1/2 - theta) of amplitude and displacement, and its error so many times theirs
    data_error = outcome.pressure_error + field_error + min(outcome.slip_error, 1.0)
    amplification = 1.0 / (0.5 - stick.theta)
    width_error = amplification * data_error if data_error < 1.0 else inf
    return replace(
        outcome,
        zones=(
            outcome.zones[0],
            Zone.from_radii("slip", inner, rim),
            Zone.from_radii("stick", rim, EDGE),
        ),
        pressure=ZonalField(
            (*disk_pressure, ZonePiece(rim, slip_pressure), ZonePiece(EDGE, edge_pressure))
        ),
        traction=ZonalField(
            (
                outcome.traction.pieces[0],
                ZonePiece(rim, slip_pressure, friction),
                ZonePiece(EDGE, edge_traction),
            )
        ),
        slip=ZonalField((outcome.slip.pieces[0], ZonePiece(rim, slip), ZonePiece(EDGE, None))),
        approach_error=outcome.approach_error + stick.error,
        shear_error=outcome.shear_error + stick.error,
        pressure_error=outcome.pressure_error + field_error,
        traction_error=outcome.traction_error + field_error,
        radius_error=outcome.radius_error + stick.error,
        zones_error=max(outcome.zones_error, width_error),
        slip_error=slip_error,
        violation=max(outcome.violation, wrong),
        consistent=outcome.consistent and wrong <= max(slip_error, SLIP_ROUNDING),
        layout=None,
    )


def sampled(function: Callable[[Array], Array], depth: float, *, power: float = 0.0) -> LogSeries:
    """Return a series that interpolates ``function(d)``, times ``d**power``.

    Parameters
    ----------
    function : callable
        Of the distance d from a boundary.
    depth : float
        The panels reach down to ``d = exp(-depth)``.
    power : float
        Of the factor that is not sampled.
    """
    panels = ceil(depth / PANEL_WIDTH)
    nodes, _ = gauss_rule(PANEL_SAMPLES)
    x = PANEL_WIDTH * (np.arange(panels)[:, None] + (1.0 + nodes) / 2.0)
    values = function(np.exp(-x.ravel())).reshape(x.shape)
    expansion = legendre_expansion_matrix(PANEL_SAMPLES, PANEL_SAMPLES - 1)
    coefficients = values @ expansion.T
    return LogSeries(coefficients, np.array([coefficients[-1].sum()]), PANEL_WIDTH, power)
