"""Show that the bracket of the approach closes with the degree.

Run as ``python validation/honesty/bounds.py``.

Writes validation/results/bounds.md. Degree p on every panel of a mesh that reaches
through the edge layer; no endpoint weight.
"""

from __future__ import annotations

import math
from pathlib import Path

from spectral_contact.equations.bounds import approach_bounds
from spectral_contact.fields.series import PressureField
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

RESULTS = Path(__file__).parents[1] / "results"
DEGREES = range(1, 11)
COMPLIANCES = (0.5, 1e-2, 1e-4)


def bracket(compliance: float, degree: int) -> tuple[float, float]:
    """Return both bounds from degree p."""
    panels = LogPanels(math.ceil((30.0 - math.log(compliance)) / 2.0), 2.0, max(DEGREES))
    space = unit_space(panels, (degree,) * panels.count)
    unit = space.factor(compliance).solve(2.0)
    moment = 2.0 * float(space.constant_moments @ unit[space.index])
    approach = 1.0 / (2.0 * math.pi * moment)
    pressure = PressureField(None, series_of(panels, unit * approach))
    return approach_bounds(compliance, approach, pressure)


def main() -> None:
    """Run and write the results."""
    lines = [
        f"{len(COMPLIANCES) * len(DEGREES)} brackets; width relative to the approach.",
        "",
        "| degree p | " + " | ".join(f"α* = {c:g}" for c in COMPLIANCES) + " |",
        "|---|" + "---|" * len(COMPLIANCES),
    ]
    for degree in DEGREES:
        brackets = (bracket(compliance, degree) for compliance in COMPLIANCES)
        widths = (f"{upper / lower - 1.0:.1e}" for lower, upper in brackets)
        lines.append(f"| {degree} | {' | '.join(widths)} |")
    (RESULTS / "bounds.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
