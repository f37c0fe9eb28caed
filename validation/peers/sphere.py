"""A sphere's tip with and without layer: tamaas' influence function in conjugate gradients.

Run as ``python validation/peers/sphere.py``; writes validation/results/peers_sphere.md. Loads are
given. Pixels bear constant pressures; Polonsky and Keer's conjugate gradients, with ``alpha p``
added to the displacement, find the contact. The truth is ours to 1e-11; without a layer it is
Hertz's closed form.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from pathlib import Path
from time import perf_counter

import numpy as np
import tamaas

from spectral_contact import Scene, profiles, solve

RESULTS = Path(__file__).parents[1] / "results"
LAYERS, COUNTS = (0.0, 0.1, 0.5), (32, 64, 128, 256)
LOAD, HALF_SIDE, STEPS, SETTLED = 1.0, 1.2, 400, 1e-10

tamaas.set_log_level(tamaas.LogLevel.warning)


def approach(count: int, alpha: float) -> tuple[float, float]:
    """Return the approach and the largest pressure of a parabola of radius 1."""
    width = 2.0 * HALF_SIDE / count
    x = (np.arange(count) - (count - 1) / 2.0) * width
    height = (x[:, None] ** 2 + x**2) / 2.0
    sides, pixels = [2.0 * HALF_SIDE] * 2, [count] * 2
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, sides, pixels)
    model.nu, model.E = 0.0, 4.0  # E' is 1
    tamaas.ModelFactory.registerNonPeriodic(model, "half-space")

    def moved(p: np.ndarray) -> np.ndarray:
        out = np.zeros(pixels)
        model.operators["half-space"](np.ascontiguousarray(p), out)
        return out + alpha * p

    p = np.where(height < 0.5, 1.0, 0.0)
    p *= LOAD / (p.sum() * width**2)
    t, before, fresh = np.zeros(pixels), 1.0, 0.0
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
    lines = [
        "# A sphere, with and without layer, by tamaas",
        "",
        f"Parabola of radius 1, load {LOAD:g}, by validation/peers/sphere.py with tamaas "
        f"{tamaas.__version__}: relative errors against `solve` to 1e-11. The last column is by "
        "how much our approach differs from Hertz's closed form. Seconds on a shared machine.",
        "",
        "| alpha | pixels | approach | largest pressure | s | ours - Hertz |",
        "|---|---|---|---|---|---|",
    ]
    for alpha in LAYERS:
        scene = Scene(0.3, alpha, profile=profiles.Parabola(1.0), load=LOAD)
        true = solve(scene, 1e-11)
        hertz = f"{true.approach / (3.0 * LOAD / 16.0) ** (2.0 / 3.0) - 1.0:.0e}"
        for count in COUNTS:
            start = perf_counter()
            found, peak = approach(count, alpha)
            off = found / true.approach - 1.0, peak / true.pressure(0.0) - 1.0
            told = " | ".join(f"{one:+.1e}" for one in off)
            closed = hertz if alpha == 0.0 else ""
            seconds = perf_counter() - start
            lines.append(f"| {alpha:g} | {count}² | {told} | {seconds:.1f} | {closed} |")
            print(lines[-1], flush=True)
    (RESULTS / "peers_sphere.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
