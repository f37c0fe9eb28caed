"""What the paper says that can be measured, and what comes out; every claim made a number.

The words are in paper.toml.
"""

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
from paper_tables import WORDS
from reporting import table
from scipy.integrate import quad

from spectral_contact.closed_forms import coupled_approach, smooth_approach, smooth_pressure
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


def _stated(key: str, value: float, error: float, holds: bool, **filled: object) -> Statement:
    """Return our number beside a statement of paper.toml, whose `measured` is filled in."""
    words = WORDS["statement"][key]
    measured = words["measured"].format(**filled)
    return Statement(words["where"], words["says"], measured, value, error, holds)


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
    for nu in (0.3, 0.0):
        change = coupled_approach(nu) / smooth_approach() - 1.0
        yield _stated("coupling", change, 4.0 * _EPS, abs(change) < 0.05, nu=nu)
    smooth, rough = solved(0.3, 0.0, 0.0, 0.0), solved(0.3, 0.5, 0.0, 0.0)
    exact = smooth_pressure(_S[:-1])
    difference = float(np.abs(smooth.pressure(_S[:-1]) / exact - 1.0).max())
    error = _estimate(smooth, "pressure") + 4.0 * _EPS
    yield _stated("smooth_pressure", difference, error, difference <= error)
    edge = float(smooth.pressure(1.0))
    yield _stated("smooth_edge_pressure", edge, 0.0, edge == inf)
    edge = float(rough.pressure(1.0))
    yield _stated("edge_pressure", edge, edge * _estimate(rough, "pressure"), edge < inf)


# --- Section 4 ------------------------------------------------------------------------------------


def _full_stick(solved: _Solver) -> Iterator[Statement]:
    stuck = {beta: solved(0.3, 0.5, beta, inf) for beta in (0.0, 0.1, 0.2, 0.5, 1.0)}
    edge = float(stuck[0.0].traction(1.0))
    yield _stated("smooth_edge_traction", edge, 0.0, edge == inf)
    edge = float(stuck[0.5].traction(1.0))
    yield _stated("edge_traction", edge, edge * _estimate(stuck[0.5], "traction"), edge < inf)
    for betas in ((1.0, 0.5, 0.2, 0.1), (0.1, 0.0)):
        ratio, error = _largest_ratio([stuck[beta] for beta in betas], "traction")
        shown = ", ".join(f"{beta:g}" for beta in betas)
        yield _stated("traction_by_compliance", ratio, error, ratio < 1.0, betas=shown)
    classical = solved(0.3, 0.0, 0.0, inf).edge_ratio
    yield _stated("smooth_edge_ratio", classical, 0.0, classical == inf)
    ratios = [solved(0.3, 0.5, beta, inf) for beta in (1.0, 0.5, 0.2)]
    for one in ratios:
        beta, ratio = one.scene.tangential_compliance, one.edge_ratio
        error = ratio * _estimate(one, "edge_ratio")
        yield _stated("edge_ratio", ratio, error, ratio < inf, beta=beta)
    for quantity in ("edge_ratio", "critical_friction"):
        ratio, error = _largest_ratio(ratios, quantity)
        name = quantity.replace("_", " ")
        yield _stated("ratio_by_compliance", ratio, error, ratio < 1.0, name=name)


def _example(solved: _Solver) -> Iterator[Statement]:
    """Measure the example of Section 4: f = 0.1, alpha* = 0.2, beta* = 0.5."""
    f = 0.1
    stuck = solved(0.3, 0.2, 0.5, inf)
    for name in ("edge_ratio", "critical_friction"):
        # the ratios are proportional to kappa
        k = f * stuck.scene.kappa / getattr(stuck, name)
        nu = (1.0 - 4.0 * k) / (2.0 - 4.0 * k)
        error = 4.0 * k / (2.0 - 4.0 * k) ** 2 * _estimate(stuck, name) + _EPS
        yield _stated(f"example_{name}", nu, error, abs(nu - 0.255) < 5e-4)
    critical = solved(0.25, 0.2, 0.5, f).critical_friction
    error = critical * _estimate(stuck, "critical_friction")
    yield _stated("example_slip", critical, error, critical > f)
    slipping = solved(0.246, 0.2, 0.5, f)
    slip = next(zone for zone in slipping.zones if zone.kind == "slip")
    width = slip.outer_from_edge
    yield _stated("example_edge", width, width * _estimate(slipping, "zones"), width == 0.0)


# --- Section 5 ------------------------------------------------------------------------------------


def _slip_conditions(solved: _Solver) -> Iterator[Statement]:
    """Measure the conditions of partial slip in one scene, alpha* = beta* = 0.5, nu = f = 0.1."""
    f = 0.1
    one = solved(0.1, 0.5, 0.5, f)
    assert one.stick_radius is not None
    c, shear = one.stick_radius, one.total_shear
    field_error = _estimate(one, "traction") + _estimate(one, "pressure")

    def corrective(s: float) -> float:
        return float(one.traction(s) - f * one.pressure(s))

    largest = float(one.slip(np.linspace(1.0, c, 50, endpoint=False)).max())
    yield _stated("slip_sense", largest, abs(largest) * _estimate(one, "slip"), largest > 0.0)
    inside = 0.99 * c * _S
    relative = float((one.traction(inside) / (f * one.pressure(inside)) - 1.0).max())
    yield _stated("corrective_sense", relative, field_error, relative < 0.0)
    rim = c * (1.0 - 1e-13)  # c itself counts as slip
    jump = abs(corrective(rim)) / (f * float(one.pressure(rim)))
    yield _stated("corrective_at_rim", jump, field_error, jump <= field_error)
    integral, quadrature = quad(lambda s: corrective(s) * s, 0.0, c, epsabs=1e-12, limit=200)
    difference = abs(f + 2.0 * pi * integral - shear)
    error = 2.0 * pi * quadrature + shear * _estimate(one, "total_shear") + f * field_error
    yield _stated("shear_integral", difference, error, difference <= error)


def _slip_trends(solved: _Solver) -> Iterator[Statement]:
    """Measure how traction, stick zone and shear change with friction and Poisson's ratio."""
    rows = {nu: [solved(nu, 0.5, 0.5, f) for f in _FRICTIONS] for nu in (0.1, 0.3)}
    for name in ("traction", "total_shear", "stick_radius"):
        for nu, row in rows.items():
            value, error = _largest_ratio(row, name)
            yield _stated(name, value, error, value < 1.0, nu=nu)
    pairs = zip(*rows.values(), strict=True)
    value, error = max(_largest_ratio(pair, "stick_radius") for pair in pairs)
    yield _stated("by_poisson_ratio", value, error, value < 1.0)
    for nu, row in rows.items():
        yield _approach_to_stick(row, solved(nu, 0.5, 0.5, inf))


def _approach_to_stick(row: Sequence[Solution], stuck: Solution) -> Statement:
    """Measure whether the traction of full stick is approached as the friction grows."""
    limit = stuck.traction(_S)
    away = [float(np.abs(one.traction(_S) - limit).max() / limit.max()) for one in row]
    value, nearer, farther = max((b / a, b, a) for a, b in pairwise(away))
    error = _estimate(row[0], "traction") + _estimate(stuck, "traction")
    error *= value * (1.0 / nearer + 1.0 / farther)
    nu = stuck.scene.poisson_ratio
    return _stated("approach_to_stick", value, error, value < 1.0, nu=nu)


def _stick_everywhere(solved: _Solver) -> Iterator[Statement]:
    for nu in (0.0, 0.1, 0.2, 0.3, 0.4):
        stuck = solved(nu, 0.5, 0.5, inf)
        critical = stuck.critical_friction
        error = critical * _estimate(stuck, "critical_friction")
        yield _stated("full_stick", critical, error, critical < inf, nu=nu)
    smooth = solved(0.3, 0.0, 0.0, 1.0)
    width = abs(smooth.zones[-1].outer_from_edge - smooth.zones[-1].inner_from_edge)
    yield _stated("classical_contact", width, width * _estimate(smooth, "zones"), width != 0.0)
