"""Show what simpler formulations lose: python validation/peers/naive.py.

Writes validation/results/naive.md.

- The kernels (2.4) as printed, against mpmath.
- The normal equations on the library's own panels without endpoint weight and without correction,
  with the correction, and with the weight. Truth: 2 pi alpha p(1)^2 = delta + alpha delta' with
  delta' = 2 pi int p^2 s ds, integrals that are right to some 1e-15.

What one polynomial over the whole radius loses is in compare.py (chebyshev.py).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
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
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

GAPS = [10.0**-k for k in (2, 4, 6, 8, 10, 12, 14, 15)]
FAR = [10.0**k for k in (2, 4, 6, 8)]
EDGES = [10.0**-k for k in range(0, 15, 2)]
WAYS = ("normal equations", "with correction", "with endpoint weight")


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


def kernel_cells() -> Iterator[tuple[str, ...]]:
    """Yield relative errors of both forms near the diagonal and far from it."""
    pairs = [(f"\\|η−s\\|/s = {gap:.0e}", 0.7 * (1.0 + gap), 0.7) for gap in GAPS]
    pairs += [(f"η/s = {ratio:.0e}", 0.7, 0.7 / ratio) for ratio in FAR]
    for name, eta, s in pairs:
        ours = float(normal_kernel(eta, s)), float(tangential_kernel(eta, s))
        cells = []
        for true, *values in zip(exact(eta, s), printed(eta, s), ours, strict=True):
            for value in values:
                known = math.isfinite(value)
                cells.append(off(mpmath.mpf(value), true) if known else "infinite")
        yield name, *cells


def off(value: Any, true: Any) -> str:
    """Return a relative error as a cell of a table."""
    return f"{float(abs(value / true - 1)):.0e}"


def edge_pressure(compliance: float) -> float:
    """Return the edge pressure, right to some 1e-15."""
    solution = solve(Scene(0.3, compliance), 1e-12, ("approach", "pressure"))
    depth = math.ceil(40.0 - math.log(compliance)) + 1
    g, w = gauss_rule(40)
    x = np.arange(depth)[:, None] + (1.0 + g) / 2.0
    y = np.exp(-x)
    field = solution.pressure_field
    assert field is not None
    squares = field.evaluate(y.ravel()).reshape(y.shape) ** 2
    slope = np.pi * float((squares * y @ (w / 2.0)).sum())
    return math.sqrt((solution.approach + compliance * slope) / (2.0 * np.pi * compliance))


def edge_cells() -> Iterator[tuple[object, ...]]:
    """Yield the errors of the edge pressure from normal equations."""
    for compliance in EDGES:
        space_of = graded_space(-math.log(compliance), 1e-14)
        space = unit_space(space_of.panels, space_of.degrees)
        factored = space.factor(compliance)
        weight = EdgeWeight(4.0 / np.pi, 4.0 / np.pi * compliance)
        load = load_vector(space_of.panels, lambda d, weight=weight: 0.5 * weight(d))
        edge = edge_pressure(compliance)
        root = math.sqrt(1.0 + weight.shift) + math.sqrt(weight.shift)
        # each with what its weight adds to the load and to the pressure at the edge
        ways = (
            (factored.solve(2.0, correct=False), 0.0, 0.0),
            (factored.solve(2.0), 0.0, 0.0),
            (
                factored.solve(weight.deficit(space.y), load, correct=False),
                weight.amplitude / root,
                float(weight(np.array(0.0))),
            ),
        )
        cells = []
        for unit, more_load, more_pressure in ways:
            moment = 2.0 * float(space.constant_moments @ unit[space.index]) + more_load
            limit = series_of(space_of.panels, unit).limit + more_pressure
            cells.append(off(limit / (2.0 * np.pi * moment), edge))
        yield f"{compliance:.0e}", *cells, space.unknowns


def main() -> None:
    """Run and write the results."""
    with np.errstate(divide="ignore", invalid="ignore"):
        kernels, edges = list(kernel_cells()), list(edge_cells())
    parts = [
        f"{len(kernels) + len(edges)} comparisons; relative errors.",
        table("kernels | K₁ as printed | K₁ here | K₂ as printed | K₂ here", kernels),
        table(f"p*(1), α* | {' | '.join(WAYS)} | unknowns", edges),
    ]
    write("naive", "\n\n".join(parts))


if __name__ == "__main__":
    main()
