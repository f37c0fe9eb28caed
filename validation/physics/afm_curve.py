"""Make the force curve of a colloidal probe on a sticky gel, as an atomic force microscope has it.

Run as ``python validation/physics/afm_curve.py``.

Writes tests/data/curves/afm_adhesion.txt, which docs/afm.md fits, and the pictures
docs/afm_curve.png and docs/afm_fit.png of that page. The loads are those of Johnson, Kendall and
Roberts on a smooth surface, by their formulas: nothing of the library makes them. The probe hangs
on a cantilever, whose far end moves in equal steps, down and up again; contact is made at an
approach of 0, and lost where no equilibrium is left.
"""

from __future__ import annotations

import numpy as np
from common import DOCS, picture

from spectral_contact import Scene, fit, profiles
from spectral_contact.calibration import IndentationData, IndentationFit
from spectral_contact.view.figures import BLUE, VERMILION
from spectral_contact.view.plotting import plot_fit, save

CURVE = DOCS.parent / "tests" / "data" / "curves" / "afm_adhesion.txt"
RADIUS, MODULUS, ADHESION = 5e-6, 2e4, 2e-4
#: Of the cantilever [N/m]; noise of the force [N]; what a force of 0 reads [N]; where the tip reads
#: 0 when it touches [m].
STIFFNESS, NOISE, OFFSET, ZERO = 0.02, 5e-11, 3e-10, 2.5e-7
#: Positions of the far end of the cantilever [m]: first, last, number.
FAR_END = np.linspace(-1.5e-6, 3.5e-6, 500)
FREE = ("reduced_modulus", "work_of_adhesion", "zero_point", "load_offset")


def branch() -> tuple[np.ndarray, np.ndarray]:
    """Return approaches and loads by rising approach plus deflection, from the last equilibrium."""
    a = np.geomspace(1e-8, 1e-5, 200_001)
    load = 4.0 / 3.0 * MODULUS * a**3 / RADIUS - np.sqrt(8.0 * np.pi * ADHESION * MODULUS * a**3)
    approach = a**2 / RADIUS - np.sqrt(2.0 * np.pi * ADHESION * a / MODULUS)
    last = int(np.argmin(approach + load / STIFFNESS))
    return approach[last:], load[last:]


def rows() -> tuple[np.ndarray, np.ndarray]:
    """Return depths and forces of approach and retraction, with noise."""
    approach, load = branch()
    held = approach + load / STIFFNESS
    found = []
    for far_end, first in ((FAR_END, 0.0), (FAR_END[::-1], held[0])):
        touching = far_end >= first
        on_branch = np.interp(far_end, held, load)
        found.append(np.where(touching, on_branch, 0.0))
    force = np.concatenate(found)
    depth = np.concatenate([FAR_END, FAR_END[::-1]]) - force / STIFFNESS
    noise = NOISE * np.random.default_rng(7).standard_normal(len(force))
    return depth + ZERO, force + OFFSET + noise


def write(depth: np.ndarray, force: np.ndarray) -> None:
    """Write the file."""
    head = "# colloidal probe on a gel, synthetic: python validation/physics/afm_curve.py\n"
    head += "tip position [nm]\tforce [nN]"
    columns = np.column_stack([depth, force]) * 1e9
    np.savetxt(CURVE, columns, ["%.3f", "%.4f"], "\t", header=head, comments="")


def fitted() -> IndentationFit:
    """Return the fit of the page."""
    columns = "depth=1 [nm], load=2 [nN]"
    data = IndentationData.from_file(CURVE, columns=columns, part="retraction")
    start = Scene.from_physical(
        reduced_modulus=1e4, profile=profiles.Parabola(RADIUS), work_of_adhesion=1e-4, load=0.0
    )
    return fit(start, data, FREE, progress=False)


def main() -> None:
    """Write file and pictures."""
    depth, force = rows()
    write(depth, force)
    half = len(FAR_END)
    with picture(DOCS / "afm_curve.png", (5.5, 3.5)) as axes:
        axes.plot(depth[:half] * 1e9, force[:half] * 1e9, color=BLUE, label="approach")
        axes.plot(depth[half:] * 1e9, force[half:] * 1e9, color=VERMILION, label="retraction")
        axes.set(xlabel="tip position / nm", ylabel="force / nN")
        axes.legend()
    save(plot_fit(fitted()), DOCS / "afm_fit.png")


if __name__ == "__main__":
    main()
