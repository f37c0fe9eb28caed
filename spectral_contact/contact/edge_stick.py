r"""Stick at the edge of a smooth surface with tangential compliance, matched in closed form.

p is the pressure, q the traction, s the radius over that of the contact, and ``y = 1 - s**2``. With
``alpha = 0 < beta`` the edge sticks over a width ``w`` in y that may be far too small for panels:
``w = 1e-24`` at ``beta = 1e-12``. So the contact is first solved as if it slipped up to the edge;
its pressure is ``p -> C y**(theta - 1/2)`` there, with ``tan(pi theta) = 2 kappa f``. Away from the
stick at the edge this solution has a relative error of ``w**(1/2 + theta)``.

In the stick the displacement ``beta q`` of the compliance is opposite to that of the body, which
hardly varies over w. So q is constant to ``w/beta``, and next to the edge, with y' as variable,

    (1/pi) PV int_0^inf p(y') dy' / (y' - y) = 2 kappa q(y),
    q = f p in slip, y > w,    q = f p(w) in stick, y < w.

So ``y p'`` solves a homogeneous Riemann-Hilbert problem, and with ``eta = y/w``

    p = C w**(theta - 1/2) P(eta),
    P = (1/2 - theta) int_eta^inf x**(-3/2) (x - 1)**theta dx                        if eta > 1,
    P = P(1) + (1/2 - theta)/cos(pi theta) int_eta^1 x**(-3/2) (1 - x)**theta dx     if eta < 1.

The width w follows from the radial displacement ``u_r = 0`` at w, where that of the body cancels
that of the compliance, ``beta f p(w) = beta f C w**(theta - 1/2) P(1)``. Derivation and measured
errors are in docs/coupling.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, cos, exp, inf, log, pi
from typing import NamedTuple

import numpy as np
from scipy.special import beta as beta_function
from scipy.special import betainc

from spectral_contact.contact.friction_law import named_violation
from spectral_contact.contact.resolution import EPSILON_DEPTH
from spectral_contact.contact.slip_outcome import PartialSlip, zones_outcome
from spectral_contact.contact.stick_radius import MAX_LOGIT
from spectral_contact.contact.tuning import (
    EDGE_ERROR_INSIDE,
    EDGE_ERROR_OUTSIDE,
    PANEL_WIDTH,
    ROUNDING,
)
from spectral_contact.contact.zone_fields import estimated_edge_stick_width
from spectral_contact.contact.zone_solution import ZoneSolution
from spectral_contact.contact.zone_spaces import edge_exponent
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
from spectral_contact.spectral.parts import z_difference

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
        C of the pressure ``C y**(theta - 1/2)`` in slip, far from the stick.
    width : float
        w, the value of y at the inner boundary of the stick.
    """

    theta: float
    amplitude: float
    width: float

    @classmethod
    def matched(
        cls, theta: float, amplitude: float, displacement: float, slip_compliance: float
    ) -> EdgeStick:
        """Return the stick whose width makes the displacement at its boundary vanish.

        Parameters
        ----------
        theta, amplitude : float
            As the attributes.
        displacement : float
            Displacement of the edge by the body, without the compliance, against the traction:
            positive.
        slip_compliance : float
            ``beta f``: displacement by the compliance in slip, over the pressure.
        """
        stick = cls(theta, amplitude, 0.0)
        ratio = slip_compliance * amplitude * stick.pressure_factor_at_width / displacement
        return stick._replace(width=float(np.exp(log(ratio) / (0.5 - theta))))

    @property
    def pressure_factor_at_width(self) -> float:
        """``P(1)``."""
        exponent = 0.5 - self.theta
        return float(exponent * beta_function(exponent, 1.0 + self.theta))

    @property
    def outer_error(self) -> float:
        """Relative error of the fields away from the stick, and of approach and shear."""
        return float(EDGE_ERROR_OUTSIDE * self.width ** (0.5 + self.theta))

    def traction_error(self, beta: float) -> float:
        """Return the relative error of the traction in the stick, which is set constant."""
        return float(EDGE_ERROR_INSIDE * -log(self.width) * self.width / beta) + ROUNDING

    @property
    def pressure_at_width(self) -> float:
        """``p(w)``: the traction in the stick is f times this."""
        return float(
            self.amplitude * self.width ** (self.theta - 0.5) * self.pressure_factor_at_width
        )

    def slip_pressure_factor(self, eta: Array) -> Array:
        """Return ``P(eta) eta**(1/2 - theta)``, eta > 1: pressure in slip over its power law."""
        exponent = 0.5 - self.theta
        incomplete = betainc(exponent, 1.0 + self.theta, 1.0 / eta)
        return np.asarray(self.pressure_factor_at_width * incomplete * eta**exponent)

    def stick_pressure(self, eta: Array, rest: Array) -> Array:
        """Return the pressure in the stick, eta < 1; ``rest = 1 - eta`` without cancellation."""
        prefactor = (0.5 - self.theta) / cos(pi * self.theta)
        incomplete = beta_function(self.theta, 0.5) * betainc(self.theta, 0.5, rest)
        # the integral from eta to 1 of x**(-3/2) (1 - x)**theta, by parts
        integral = 2.0 * (rest**self.theta / np.sqrt(eta) - self.theta * incomplete)
        scale = self.amplitude * self.width ** (self.theta - 0.5)
        return np.asarray(scale * (self.pressure_factor_at_width + prefactor * integral))


def expected_error(parameters: Parameters) -> float:
    """Return the expected relative error of the closed form, from an estimate of the width.

    It is 1, which is no digit, if the stick is not narrow in comparison with the contact.
    """
    theta = edge_exponent(parameters)
    width = estimated_edge_stick_width(parameters, theta)
    if width >= exp(-1.0):
        return 1.0
    stick = EdgeStick(theta, 1.0, max(width, MIN_EDGE_WIDTH))
    return stick.outer_error + stick.traction_error(parameters.beta)


def with_edge_stick(
    solved: ZoneSolution, parameters: Parameters, *, point_disk: bool = False
) -> PartialSlip:
    """Add the stick at the edge to a solution that slips there, and verify the friction law.

    A stick narrower than MIN_EDGE_WIDTH is left out: it changes no digit of any field, and its
    boundary is not a double apart from the edge.

    Parameters
    ----------
    solved : ZoneSolution
        One stick disk on a smooth surface, with slip from there to the edge.
    parameters : Parameters
        With tangential compliance, and without normal compliance.
    point_disk : bool
        Whether the disk stands for a point, and its radius for 0, as in `zones_outcome`.

    Raises
    ------
    ArithmeticError
        If the displacement by the body is not against the traction at the edge, so that nothing
        sticks there, or the stick is not narrow in comparison with the slip.
    """
    # the displacement of the body alone, because that of the compliance is infinite at the edge
    outcome = zones_outcome(solved, parameters._replace(beta=0.0), point_disk=point_disk)
    body_displacement = outcome.slip.pieces[-1].field
    assert isinstance(body_displacement, AnnulusSeries)
    edge_displacement = body_displacement.toward_outer.limit
    edge_pressure = solved.pressures[-1]
    half_width = z_difference(*solved.system.bounds[-2:]) / 2.0
    # C, from the value of the tail at its end, where it is a series in y / half_width
    amplitude = legendre_sum(-1.0, edge_pressure.tail.tolist()) * half_width**-edge_pressure.power
    if not (edge_displacement < 0.0 < amplitude):
        raise ArithmeticError("the edge is not moved against its traction")
    stick = EdgeStick.matched(
        edge_exponent(parameters),
        amplitude,
        -edge_displacement,
        parameters.beta * parameters.friction,
    )
    if stick.width >= half_width:
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
    """Add the stick at the edge to an outcome that slips up to the edge.

    The zones are then the disk, slip from `inner` to `rim`, and stick from `rim` to the edge.

    Parameters
    ----------
    outcome : PartialSlip
        Slip up to the edge, without tangential compliance.
    body_displacement : AnnulusSeries
        Its displacement in slip.
    stick : EdgeStick
    solved : ZoneSolution
        The solution of which it is the outcome.
    parameters : Parameters
    """
    beta = parameters.beta
    friction = parameters.friction
    inner = solved.system.radii[0]
    width = stick.width
    rim_value = float(np.sqrt(1.0 - width))
    rim = Radius(rim_value, width / (1.0 + rim_value))
    half_width = z_difference(inner, EDGE) / 2.0
    half_slip_width = z_difference(inner, rim) / 2.0
    inner_pressure = solved.pressures[1]
    outer_pressure = solved.pressures[-1]
    assert isinstance(outcome.pressure, ZonalField)

    # Functions of the distance d in y from a boundary: 0 at the boundary, 1 in the middle of the
    # zone. Slip is the displacement times the sign of the traction, negative where the law holds.

    def slip_pressure_at_rim(d: Array) -> Array:
        y = width + half_slip_width * d
        unmatched = outer_pressure(np.minimum(y / half_width, 1.0))
        return np.asarray(unmatched * stick.slip_pressure_factor(y / width))

    def slip_at_rim(d: Array) -> Array:
        unmatched_d = np.minimum((width + half_slip_width * d) / half_width, 1.0)
        of_compliance = beta * friction * slip_pressure_at_rim(d)
        return np.asarray(body_displacement.toward_outer(unmatched_d) + of_compliance)

    def slip_at_disk(d: Array) -> Array:
        of_compliance = beta * friction * inner_pressure(d)
        return np.asarray(body_displacement.toward_inner(d) + of_compliance)

    def stick_pressure_at_rim(d: Array) -> Array:
        return stick.stick_pressure(1.0 - d / 2.0, d / 2.0)

    def regular_stick_pressure_at_edge(d: Array) -> Array:
        """Return the pressure times the square root of d."""
        return stick.stick_pressure(d / 2.0, 1.0 - d / 2.0) * np.sqrt(d)

    depth = log(half_slip_width / width) + EPSILON_DEPTH
    slip_series = (sampled(slip_at_disk, EPSILON_DEPTH), sampled(slip_at_rim, depth))
    slip = AnnulusSeries(inner, rim, *slip_series, power=0)
    # without the values at the boundaries, where slip vanishes and its sense is rounding
    values = np.concatenate([series.at_ends()[:-1] for series in slip_series])
    wrong_slip = max(float(values.max() / np.abs(values).max()), 0.0)
    slip_pressure = AnnulusSeries(
        inner, rim, inner_pressure, sampled(slip_pressure_at_rim, depth), power=0
    )
    edge_pressure = AnnulusSeries(
        rim,
        EDGE,
        sampled(stick_pressure_at_rim, EPSILON_DEPTH),
        sampled(regular_stick_pressure_at_edge, EPSILON_DEPTH, power=-0.5),
        power=0,
    )
    stick_traction = np.array([friction * stick.pressure_at_width])
    constant = LogSeries(stick_traction[None], stick_traction, PANEL_WIDTH)
    edge_traction = AnnulusSeries(rim, EDGE, constant, constant, power=0)

    field_error = stick.outer_error + stick.traction_error(beta)
    slip_error = outcome.slip_error + field_error
    # w is the power 1/(1/2 - theta) of the ratio of amplitude and displacement, which multiplies
    # relative errors
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
            (
                outcome.pressure.pieces[0],
                ZonePiece(rim, slip_pressure),
                ZonePiece(EDGE, edge_pressure),
            )
        ),
        traction=ZonalField(
            (
                outcome.traction.pieces[0],
                ZonePiece(rim, slip_pressure, friction),
                ZonePiece(EDGE, edge_traction),
            )
        ),
        slip=ZonalField((outcome.slip.pieces[0], ZonePiece(rim, slip), ZonePiece(EDGE, None))),
        approach_error=outcome.approach_error + stick.outer_error,
        shear_error=outcome.shear_error + stick.outer_error,
        pressure_error=outcome.pressure_error + field_error,
        traction_error=outcome.traction_error + field_error,
        radius_error=outcome.radius_error + stick.outer_error,
        zones_error=max(outcome.zones_error, width_error),
        slip_error=slip_error,
        violation=max(outcome.violation, wrong_slip),
        violation_text=outcome.violation_text or named_violation(0.0, 0.0, wrong_slip, slip_error),
        layout=None,
    )


def sampled(function: Callable[[Array], Array], depth: float, *, power: float = 0.0) -> LogSeries:
    """Return the series ``d**power`` times an interpolant of a function.

    Parameters
    ----------
    function : callable
        A function of the distance d from a boundary, without the factor ``d**power``.
    depth : float
        The panels reach down to ``d = exp(-depth)``.
    power : float
        The exponent of the factor.
    """
    panels = ceil(depth / PANEL_WIDTH)
    nodes, _ = gauss_rule(PANEL_SAMPLES)
    x = PANEL_WIDTH * (np.arange(panels)[:, None] + (1.0 + nodes) / 2.0)
    values = function(np.exp(-x.ravel())).reshape(x.shape)
    expansion = legendre_expansion_matrix(PANEL_SAMPLES, PANEL_SAMPLES - 1)
    coefficients = values @ expansion.T
    return LogSeries(coefficients, np.array([coefficients[-1].sum()]), PANEL_WIDTH, power)
