"""Show what simpler formulations lose: python validation/peers/naive.py.

Writes validation/results/naive.md.

- The kernels (2.4) as printed, against mpmath.
- The pressure as one polynomial in s**2 without a weight: Galerkin's equations, whose integrals are
  exact by Gauss's rule, so that nothing but the basis is to blame.
- The normal equations on the library's own panels without endpoint weight and without correction,
  with the correction, and with the weight. Truth: 2 pi alpha p(1)^2 = delta + alpha delta' with
  delta' = 2 pi int p^2 s ds, integrals that are right to some 1e-15.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

import mpmath
import numpy as np
from reporting import table, write
from scipy import special

from spectral_contact import Scene, solve
from spectral_contact.contact.resolution import graded_space
from spectral_contact.equations.kernels import normal_kernel, tangential_kernel
from spectral_contact.fields.series import EdgeWeight
from spectral_contact.spectral.jacobi import gauss_rule, legendre_values
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

GAPS = [10.0**-k for k in range(1, 16)]
FAR = [10.0**k for k in range(1, 9)]
DEGREES = [2, 4, 8, 16, 32, 64, 128, 256]
COMPLIANCES = [0.5, 1e-2, 1e-6]
EDGES = [10.0**-k for k in range(15)]


def printed(eta: float, s: float) -> tuple[float, float]:
    """Return K1 and K2 as (2.4) has them."""
    k = 2.0 * math.sqrt(eta * s) / (eta + s)
    first, second = special.ellipk(k**2), special.ellipe(k**2)
    share = eta / (eta + s)
    return share * first, share * ((2.0 / k**2 - 1.0) * first - 2.0 / k**2 * second)


def exact(eta: float, s: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Return them to 50 digits, with the radii taken as the doubles they are."""
    with mpmath.workdps(50):
        eta, s = mpmath.mpf(eta), mpmath.mpf(s)
        low, high = min(eta, s), max(eta, s)
        m = (low / high) ** 2
        return eta / high * mpmath.ellipk(m), eta / low * (mpmath.ellipk(m) - mpmath.ellipe(m))


def kernel_rows() -> list[dict[str, Any]]:
    """Return relative errors of both forms near the diagonal and far from it."""
    rows = []
    pairs = [("near", gap, 0.7 * (1.0 + gap), 0.7) for gap in GAPS]
    pairs += [("far", ratio, 0.7, 0.7 / ratio) for ratio in FAR]
    for kind, at, eta, s in pairs:
        truth = exact(eta, s)
        ours = float(normal_kernel(eta, s)), float(tangential_kernel(eta, s))
        row: dict[str, Any] = {"kind": kind, "at": at}
        for name, values in (("printed", printed(eta, s)), ("library", ours)):
            row[name] = [
                min(float(abs(mpmath.mpf(v) / t - 1)), 1e300) if math.isfinite(v) else None
                for v, t in zip(values, truth, strict=True)
            ]
        rows.append(row)
    return rows


def polynomial_solution(compliance: float, degree: int) -> tuple[float, float]:
    """Return the approach and the edge pressure with one polynomial in s**2.

    The half-integral of P(z), z = s**2 = t**2 + w**2, is int_0^sqrt(1 - t^2) P dw.
    """
    g, w = gauss_rule(2 * degree + 4)
    t, weights = (1.0 + g) / 2.0, w / 2.0
    reach = np.sqrt((1.0 - t) * (1.0 + t))
    inner, inner_weights = gauss_rule(degree + 2)
    z = t[:, None] ** 2 + (reach[:, None] * (1.0 + inner) / 2.0) ** 2
    values = legendre_values(2.0 * z - 1.0, degree)
    half = np.einsum("tqk,q->tk", values, inner_weights / 2.0) * reach[:, None]
    norm = np.sqrt(2.0 * np.arange(degree + 1) + 1.0)
    half *= norm  # int P^2 s ds = 1/2
    matrix = half.T @ (half * (weights / np.pi)[:, None])
    matrix[np.diag_indices(degree + 1)] += compliance / 2.0
    right = np.zeros(degree + 1)
    right[0] = 0.5
    unit = np.linalg.solve(matrix, right)
    load = np.pi * unit[0]
    return 1.0 / load, float(norm @ unit) / load


def truth(compliance: float) -> tuple[float, float]:
    """Return the approach and the edge pressure, right to some 1e-15."""
    solution = solve(Scene(0.3, compliance), 1e-12, ("approach", "pressure"))
    depth = math.ceil(40.0 - math.log(compliance)) + 1
    g, w = gauss_rule(40)
    x = np.arange(depth)[:, None] + (1.0 + g) / 2.0
    y = np.exp(-x)
    field = solution.pressure_field
    assert field is not None
    squares = field.evaluate(y.ravel()).reshape(y.shape) ** 2
    slope = np.pi * float((squares * y @ (w / 2.0)).sum())
    delta = solution.approach
    return delta, math.sqrt((delta + compliance * slope) / (2.0 * np.pi * compliance))


def polynomial_rows() -> list[dict[str, Any]]:
    """Return the errors of one polynomial."""
    rows = []
    for compliance in COMPLIANCES:
        delta, edge = truth(compliance)
        for degree in DEGREES:
            found = polynomial_solution(compliance, degree)
            rows.append(
                {
                    "compliance": compliance,
                    "degree": degree,
                    "approach": abs(found[0] / delta - 1.0),
                    "edge": abs(found[1] / edge - 1.0),
                }
            )
    return rows


def edge_rows() -> list[dict[str, Any]]:
    """Return the errors of the edge pressure from normal equations."""
    rows = []
    for compliance in EDGES:
        space_of = graded_space(-math.log(compliance), 1e-14)
        space = unit_space(space_of.panels, space_of.degrees)
        factored = space.factor(compliance)
        weight = EdgeWeight(4.0 / np.pi, 4.0 / np.pi * compliance)
        load = load_vector(space_of.panels, lambda d, weight=weight: 0.5 * weight(d))
        _, edge = truth(compliance)
        row: dict[str, Any] = {"compliance": compliance, "unknowns": space.unknowns}
        ways: dict[str, Any] = {
            "plain": factored.solve(2.0, correct=False),
            "corrected": factored.solve(2.0),
            "weight": factored.solve(weight.deficit(space.y), load, correct=False),
        }
        for name, unit in ways.items():
            lift = name == "weight"
            moment = 2.0 * float(space.constant_moments @ unit[space.index])
            limit = series_of(space_of.panels, unit).limit
            if lift:
                moment += weight.amplitude / (
                    math.sqrt(1.0 + weight.shift) + math.sqrt(weight.shift)
                )
                limit += float(weight(np.array(0.0)))
            row[name] = abs(limit / (2.0 * np.pi * moment) / edge - 1.0)
        rows.append(row)
    return rows


def cell(value: float | None) -> str:
    """Return a number of a table."""
    return "infinite" if value is None else f"{value:.0e}"


def page(record: dict[str, Any]) -> str:
    """Return the results as Markdown: of decades every second one."""
    places = {"near": "\\|η−s\\|/s", "far": "η/s"}
    kernels = (
        (
            f"{places[row['kind']]} = {row['at']:.0e}",
            *(cell(row[form][k]) for k in (0, 1) for form in ("printed", "library")),
        )
        for row in record["kernels"]
        if round(math.log10(row["at"])) % 2 == 0 or row["at"] == GAPS[-1]
    )
    polynomials = []
    for degree in DEGREES:
        own = [r for r in record["polynomials"] if r["degree"] == degree]
        polynomials.append((degree, *(cell(r[key]) for r in own for key in ("approach", "edge"))))
    edges = (
        (
            f"{r['compliance']:.0e}",
            *(cell(r[way]) for way in ("plain", "corrected", "weight")),
            r["unknowns"],
        )
        for r in record["edges"]
        if round(math.log10(r["compliance"])) % 2 == 0
    )
    heads = (f"{what}, α* = {c:g}" for c in COMPLIANCES for what in ("δ*", "p*(1)"))
    normal = "p*(1), α* | normal equations | with correction | with endpoint weight | unknowns"
    parts = [
        f"{record['count']} comparisons; relative errors.",
        table("kernels | K₁ as printed | K₁ here | K₂ as printed | K₂ here", kernels),
        table(" | ".join(["one polynomial, degree", *heads]), polynomials),
        table(normal, edges),
    ]
    return "\n\n".join(parts)


def main() -> None:
    """Run and write the results."""
    with np.errstate(divide="ignore", invalid="ignore"):
        kernels, polynomials, edges = kernel_rows(), polynomial_rows(), edge_rows()
    record = {
        "count": len(kernels) + len(polynomials) + len(edges),
        "kernels": kernels,
        "polynomials": polynomials,
        "edges": edges,
    }
    write("naive", page(record))


if __name__ == "__main__":
    main()
