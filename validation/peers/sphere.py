"""A sphere's tip with and without layer: tamaas' influence function in conjugate gradients.

Run as ``python validation/peers/sphere.py``; writes validation/results/peers_sphere.md. Loads are
given. Pixels bear constant pressures; Polonsky and Keer's conjugate gradients, with ``alpha p``
added to the displacement, find the contact. The truth is ours to 1e-11; without a layer it is
Hertz's closed form.
"""

from __future__ import annotations

import sys
from pathlib import Path
from time import process_time

sys.path.append(str(Path(__file__).parents[1]))

import numpy as np
import tamaas
from fft import half_space
from reporting import table, write

from spectral_contact import Scene, profiles, solve

LAYERS, COUNTS = (0.0, 0.1, 0.5), (32, 64, 128, 256)
LOAD, HALF_SIDE, STEPS, SETTLED = 1.0, 1.2, 400, 1e-10


def approach(count: int, alpha: float) -> tuple[float, float]:
    """Return the approach and the largest pressure of a parabola of radius 1."""
    width = 2.0 * HALF_SIDE / count
    x = (np.arange(count) - (count - 1) / 2.0) * width
    height = (x[:, None] ** 2 + x**2) / 2.0
    model = half_space(count, 2.0 * HALF_SIDE)

    def moved(p: np.ndarray) -> np.ndarray:
        out = np.zeros_like(p)
        model.operators["half-space"](np.ascontiguousarray(p), out)
        return out + alpha * p

    p = np.where(height < 0.5, 1.0, 0.0)
    p *= LOAD / (p.sum() * width**2)
    t, before, fresh = np.zeros_like(p), 1.0, 0.0
    for _ in range(STEPS):
        inside = p > 0.0
        gap = moved(p) + height
        gap -= gap[inside].mean()
        size = float((gap[inside] ** 2).sum())
        t = np.where(inside, gap + fresh * size / before * t, 0.0)
        r = moved(t)
        r -= r[inside].mean()
        last = p
        p = np.maximum(p - float((gap * t)[inside].sum() / (r * t)[inside].sum()) * t, 0.0)
        joining = (p == 0.0) & (gap < 0.0)
        p = np.where(joining, -gap * float((gap * t)[inside].sum() / (r * t)[inside].sum()), p)
        before, fresh = size, 0.0 if joining.any() else 1.0
        p *= LOAD / (p.sum() * width**2)
        if np.abs(p - last).sum() < SETTLED * p.sum():
            break
    return float((moved(p) + height)[p > 0.0].mean()), float(p.max())


def main() -> None:
    """Write the table."""
    rows = []
    for alpha in LAYERS:
        scene = Scene(0.3, alpha, profile=profiles.Parabola(1.0), load=LOAD)
        true = solve(scene, 1e-11)
        hertz = f"{true.approach / (3.0 * LOAD / 16.0) ** (2.0 / 3.0) - 1.0:.0e}"
        for count in COUNTS:
            begin = process_time()
            found, peak = approach(count, alpha)
            spent = process_time() - begin
            off = found / true.approach - 1.0, peak / true.pressure(0.0) - 1.0
            told = (f"{one:+.1e}" for one in off)
            rows.append((f"{alpha:g}", f"{count}²", *told, f"{spent:.1f}", hertz * (alpha == 0.0)))
            print(*rows[-1], flush=True)
    about = (
        "# A sphere, with and without layer, by tamaas\n\n"
        f"Parabola of radius 1, load {LOAD:g}, by validation/peers/sphere.py with tamaas "
        f"{tamaas.__version__}: relative errors against `solve` to 1e-11. The last column is by "
        "how much our approach differs from Hertz's closed form. Seconds on a shared machine."
    )
    heading = "alpha | pixels | approach | largest pressure | s | ours - Hertz"
    write("peers_sphere", f"{about}\n\n{table(heading, rows)}")


if __name__ == "__main__":
    main()
