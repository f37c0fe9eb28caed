"""The modulus that Oliver and Pharr read from an indentation curve, with and without a layer.

Run as ``python validation/physics/oliver_pharr.py``; writes docs/oliver_pharr.png.
"""

from __future__ import annotations

import numpy as np
from common import DOCS, picture

from spectral_contact import Scene, profiles, sweep

COMPLIANCES = (0.0, 1e-3, 1e-2, 1e-1)
#: E* in units of E'.
MODULUS = 4.0


def main() -> None:
    """Draw loads and moduli over the depth."""
    ball = profiles.Parabola(radius=1.0)
    depths = np.geomspace(1e-5, 0.3, 40)
    with picture(DOCS / "oliver_pharr.png", (8.0, 3.2), columns=2) as (left, right):
        for alpha in COMPLIANCES:
            scene = Scene(0.3, alpha, profile=ball, approach=1e-3)
            curve = sweep(scene, approach=depths, progress=False)
            named = "smooth" if alpha == 0.0 else rf"$\alpha^* = {alpha:g}\,R$"
            left.loglog(depths, curve["load"], label=named)
            right.semilogx(depths, curve.stiffness / (2.0 * curve.contact_radius) / MODULUS)
        left.set(xlabel=r"depth $\delta/R$", ylabel=r"load $P/(E' R^2)$")
        right.set(xlabel=r"depth $\delta/R$", ylabel="modulus by Oliver and Pharr / $E^*$")
        right.set_ylim(0.0, 1.05)
        left.legend()


if __name__ == "__main__":
    main()
