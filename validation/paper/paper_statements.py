"""What the paper says that can be measured, and what comes out; every claim made a number."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import ceil, inf, log10, pi
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
from reporting import table

from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve

#: From nu, alpha*, beta* and f to a solution.
_Solver = Callable[[float, float, float, float], Solution]

_EPS = 2.0**-52
#: Where fields are compared: without the centre, where every traction is zero.
_S = np.arange(1, 101) / 100.0
#: Frictions of Figure 5, all below the critical.
_FRICTIONS = (0.02, 0.04, 0.06, 0.08, 0.1)


@dataclass(frozen=True, slots=True)
class Statement:
    """A statement of the paper beside our number.

    Attributes
    ----------
    where : str
        Section, equation or figure.
    says : str
        What the paper says.
    measured : str
        What the number is.
    value : float
        Dimensionless.
    error : float
        Estimate of its absolute error.
    holds : bool
        Whether the number bears the paper out.
    """

    where: str
    says: str
    measured: str
    value: float
    error: float
    holds: bool


def statements(rtol: float = 1e-9) -> tuple[Statement, ...]:
    """Measure what the paper says, in its order; every solve has this tolerance."""

    @cache
    def solved(nu: float, alpha: float, beta: float, f: float) -> Solution:
        return solve(Scene(nu, alpha, beta, f), rtol)

    parts = (_pressure, _full_stick, _example, _slip_conditions, _slip_trends, _stick_everywhere)
    return tuple(one for part in parts for one in part(solved))


def statements_table(found: Sequence[Statement]) -> str:
    """Return statements as a Markdown table."""
    cells = (
        (s.where, s.says, s.measured, _shown(s.value, s.error), "yes" if s.holds else "**no**")
        for s in found
    )
    return table("where | the paper | measured | ours | holds", cells) + "\n"


def _shown(value: float, error: float) -> str:
    """Return a value with the digits that its error leaves it, and the error."""
    if value == inf:
        return "∞"
    if error == 0.0 or abs(value) <= error:
        return f"{value:.1e} ± {error:.0e}" if error else f"{value:g}"
    digits = max(ceil(log10(abs(value) / error)), 1)
    return f"{value:.{min(digits, 10)}g} ± {error:.0e}"


def _estimate(solution: Solution, name: str) -> float:
    """Return the estimate of a relative error; for q at a given radius, too (docs/gold)."""
    error = getattr(solution.error, name)
    assert error is not None
    if name == "traction":
        error += 2.0 * _estimate(solution, "zones")
    return float(error)


def _largest_ratio(solutions: Sequence[Solution], name: str) -> tuple[float, float]:
    """Return the largest ratio of a quantity to that of the next solution, and its error."""
    ratios = []
    for one, other in pairwise(solutions):
        values = [
            getattr(a, name)(_S) if callable(getattr(a, name)) else getattr(a, name)
            for a in (one, other)
        ]
        error = _estimate(one, name) + _estimate(other, name)
        ratio = float(np.max(values[0] / values[1]))
        ratios.append((ratio, ratio * error))
    return max(ratios)


# --- Sections 2 and 3 -----------------------------------------------------------------------------


def _pressure(solved: _Solver) -> Iterator[Statement]:
    from spectral_contact.closed_forms import coupled_approach, smooth_approach, smooth_pressure

    for nu in (0.3, 0.0):
        change = coupled_approach(nu) / smooth_approach() - 1.0
        yield Statement(
            "Section 3",
            "the effect of the frictional traction on the normal displacements is generally small",
            f"what it changes δ* by, smooth full stick, ν = {nu:g} (small: below 5 %)",
            change,
            4.0 * _EPS,
            abs(change) < 0.05,
        )
    smooth, rough = solved(0.3, 0.0, 0.0, 0.0), solved(0.3, 0.5, 0.0, 0.0)
    exact = smooth_pressure(_S[:-1])
    difference = float(np.abs(smooth.pressure(_S[:-1]) / exact - 1.0).max())
    error = _estimate(smooth, "pressure") + 4.0 * _EPS
    yield Statement(
        "(3.6)",
        "α* = 0: p* = 1/(2π√(1 − s²))",
        "largest relative difference",
        difference,
        error,
        difference <= error,
    )
    edge = float(smooth.pressure(1.0))
    says = "α* = 0: unbounded for s → 1"
    yield Statement("Section 3", says, "p*(1)", edge, 0.0, edge == inf)
    edge = float(rough.pressure(1.0))
    yield Statement(
        "Section 3, Fig. 2",
        "the contact pressure is bounded at the punch edge",
        "p*(1), α* = 0.5",
        edge,
        edge * _estimate(rough, "pressure"),
        edge < inf,
    )


# --- Section 4 ------------------------------------------------------------------------------------


def _full_stick(solved: _Solver) -> Iterator[Statement]:
    stuck = {beta: solved(0.3, 0.5, beta, inf) for beta in (0.0, 0.1, 0.2, 0.5, 1.0)}
    edge = float(stuck[0.0].traction(1.0))
    says = "α* = 0.5, β* = 0: the friction forces are not bounded at the edge"
    yield Statement("Section 4, Fig. 3", says, "q*(1)", edge, 0.0, edge == inf)
    edge = float(stuck[0.5].traction(1.0))
    yield Statement(
        "Section 4, Fig. 3",
        "α* = 0.5, β* > 0, ν = 0.3: they are bounded",
        "q*(1), β* = 0.5",
        edge,
        edge * _estimate(stuck[0.5], "traction"),
        edge < inf,
    )
    for betas in ((1.0, 0.5, 0.2, 0.1), (0.1, 0.0)):
        ratio, error = _largest_ratio([stuck[beta] for beta in betas], "traction")
        yield Statement(
            "Section 4, Fig. 3",
            "upon the increasing parameter β* these forces decrease",
            "largest ratio of q* at one β* to that at the next smaller one, β* = "
            + ", ".join(f"{beta:g}" for beta in betas),
            ratio,
            error,
            ratio < 1.0,
        )
    classical = solved(0.3, 0.0, 0.0, inf).edge_ratio
    says = "the ratio q/p of the classical case is unbounded at the edge"
    yield Statement("Section 4", says, "q/p at the edge", classical, 0.0, classical == inf)
    ratios = [solved(0.3, 0.5, beta, inf) for beta in (1.0, 0.5, 0.2)]
    for one in ratios:
        beta = one.scene.tangential_compliance
        ratio = one.edge_ratio
        yield Statement(
            "Section 4, Fig. 4",
            "it is bounded for rough surfaces",
            f"q/p at the edge, α* = 0.5, β* = {beta}, ν = 0.3",
            ratio,
            ratio * _estimate(one, "edge_ratio"),
            ratio < inf,
        )
    for name, label in (("edge_ratio", "edge ratio"), ("critical_friction", "critical friction")):
        ratio, error = _largest_ratio(ratios, name)
        yield Statement(
            "Section 4, Fig. 4",
            "slip is more likely for smaller β* when α* is fixed",
            f"largest ratio of the {label} at one of these β* to that at the next smaller one",
            ratio,
            error,
            ratio < 1.0,
        )


def _example(solved: _Solver) -> Iterator[Statement]:
    """Measure the example of Section 4: f = 0.1, alpha* = 0.2, beta* = 0.5."""
    where, f = "Section 4, Fig. 4", 0.1
    example = "f = 0.1, α* = 0.2, β* = 0.5"
    stuck = solved(0.3, 0.2, 0.5, inf)
    kappa = stuck.scene.kappa
    for says, measured, name in (
        (
            f"{example}: the edge ratio exceeds f for ν < 0.255",
            "ν at which the edge ratio is f",
            "edge_ratio",
        ),
        (
            f"{example}: everything sticks for 0.255 < ν < 0.5",
            "ν from which on everything sticks",
            "critical_friction",
        ),
    ):
        # the ratios are proportional to kappa
        k = f * kappa / getattr(stuck, name)
        nu = (1.0 - 4.0 * k) / (2.0 - 4.0 * k)
        error = 4.0 * k / (2.0 - 4.0 * k) ** 2 * _estimate(stuck, name) + _EPS
        yield Statement(where, says, measured, nu, error, abs(nu - 0.255) < 5e-4)
    critical = solved(0.25, 0.2, 0.5, f).critical_friction
    yield Statement(
        where,
        f"{example}: slip must occur for 0 < ν < 0.255",
        "critical friction at ν = 0.25",
        critical,
        critical * _estimate(stuck, "critical_friction"),
        critical > f,
    )
    slipping = solved(0.246, 0.2, 0.5, f)
    slip = next(zone for zone in slipping.zones if zone.kind == "slip")
    yield Statement(
        where,
        f"{example}: slip occurs near the edge, where the stick condition is disturbed at r = a",
        "width of the annulus next to the edge that sticks, ν = 0.246",
        slip.outer_from_edge,
        slip.outer_from_edge * _estimate(slipping, "zones"),
        slip.outer_from_edge == 0.0,
    )


# --- Section 5 ------------------------------------------------------------------------------------


def _slip_conditions(solved: _Solver) -> Iterator[Statement]:
    """Measure the conditions of partial slip in one scene, alpha* = beta* = 0.5, nu = f = 0.1."""
    from scipy.integrate import quad

    f, scene = 0.1, "α* = β* = 0.5, ν = f = 0.1"
    one = solved(0.1, 0.5, 0.5, f)
    assert one.stick_radius is not None
    c, shear = one.stick_radius, one.total_shear
    field_error = _estimate(one, "traction") + _estimate(one, "pressure")

    def corrective(s: float) -> float:
        return float(one.traction(s) - f * one.pressure(s))

    outside = np.linspace(1.0, c, 50, endpoint=False)
    largest = float(one.slip(outside).max())
    yield Statement(
        "(5.2)",
        "the displacement u_r > 0 in slip",
        f"largest u_r* in the outer 98 % of the slip zone, {scene}",
        largest,
        abs(largest) * _estimate(one, "slip"),
        largest > 0.0,
    )
    inside = 0.99 * c * _S
    relative = (one.traction(inside) / (f * one.pressure(inside)) - 1.0).max()
    yield Statement(
        "(5.4)",
        "q₀ < 0 in stick",
        f"largest q₀*/(f p*) to 0.99 c*, {scene}",
        float(relative),
        field_error,
        bool(relative < 0.0),
    )
    rim = c * (1.0 - 1e-13)  # c itself counts as slip
    jump = abs(corrective(rim)) / (f * float(one.pressure(rim)))
    yield Statement(
        "(5.9)",
        "q₀*(c*) = 0",
        f"modulus of q₀*/(f p*) just inside c*, {scene}",
        jump,
        field_error,
        jump <= field_error,
    )
    integral, quadrature = quad(lambda s: corrective(s) * s, 0.0, c, epsabs=1e-12, limit=200)
    difference = abs(f + 2.0 * pi * integral - shear)
    error = 2.0 * pi * quadrature + shear * _estimate(one, "total_shear") + f * field_error
    yield Statement(
        "(5.8)₂",
        "Q* = f + 2π∫q₀* s ds over the stick disk",
        f"difference of the two sides, {scene}",
        difference,
        error,
        difference <= error,
    )


def _slip_trends(solved: _Solver) -> Iterator[Statement]:
    """Measure how traction, stick zone and shear change with friction and Poisson's ratio."""
    rows = {nu: [solved(nu, 0.5, 0.5, f) for f in _FRICTIONS] for nu in (0.1, 0.3)}
    of = "at one f to that at the next larger one, f = 0.02, 0.04, …, 0.1"
    for name, symbol, where, says in (
        ("traction", "q*(s)", "Fig. 5", "the traction decreases upon a decrease in f"),
        ("total_shear", "Q*", "Figs. 5, 6", "the same of the total; Q* increases with f"),
        ("stick_radius", "c*", "Figs. 5, 6", "the stick zone shrinks; c* increases with f"),
    ):
        for nu, row in rows.items():
            value, error = _largest_ratio(row, name)
            measured = f"largest ratio of {symbol} {of}, α* = β* = 0.5, ν = {nu}"
            yield Statement(f"Section 5, {where}", says, measured, value, error, value < 1.0)
    value, error = max(
        _largest_ratio(pair, "stick_radius") for pair in zip(*rows.values(), strict=True)
    )
    yield Statement(
        "Section 5, Fig. 5",
        "these phenomena are more evident for lower Poisson's ratios",
        "largest ratio of c* at ν = 0.1 to that at ν = 0.3, same f",
        value,
        error,
        value < 1.0,
    )
    for nu, row in rows.items():
        yield _approach_to_stick(row, solved(nu, 0.5, 0.5, inf))


def _approach_to_stick(row: Sequence[Solution], stuck: Solution) -> Statement:
    """Measure whether the traction of full stick is approached as the friction grows."""
    limit = stuck.traction(_S)
    away = [float(np.abs(one.traction(_S) - limit).max() / limit.max()) for one in row]
    value, nearer, farther = max((b / a, b, a) for a, b in pairwise(away))
    error = _estimate(row[0], "traction") + _estimate(stuck, "traction")
    return Statement(
        "Section 5, Fig. 5",
        "if f increases, the distributions tend to those of full stick",
        "largest ratio of the difference in q* at one f to that at the next smaller one, "
        f"ν = {stuck.scene.poisson_ratio}",
        value,
        value * error * (1.0 / nearer + 1.0 / farther),
        value < 1.0,
    )


def _stick_everywhere(solved: _Solver) -> Iterator[Statement]:
    for nu in (0.0, 0.1, 0.2, 0.3, 0.4):
        stuck = solved(nu, 0.5, 0.5, inf)
        critical = stuck.critical_friction
        yield Statement(
            "Sections 5 and 6, Fig. 6",
            "at some values of f, c* = 1; full stick is physically possible",
            f"the least such f, α* = β* = 0.5, ν = {nu}",
            critical,
            critical * _estimate(stuck, "critical_friction"),
            critical < inf,
        )
    smooth = solved(0.3, 0.0, 0.0, 1.0)
    left = smooth.zones[-1].outer_from_edge - smooth.zones[-1].inner_from_edge
    yield Statement(
        "Sections 4 and 6",
        "in the classical contact it is not",
        "width 1 − c* of the slip zone, f = 1, ν = 0.3, smooth",
        abs(left),
        abs(left) * _estimate(smooth, "zones"),
        left != 0.0,
    )
