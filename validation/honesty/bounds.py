"""Show that the bracket of the approach closes with the degree.

Run as ``python validation/honesty/bounds.py``.

Writes validation/results/bounds.md. Degree p on every panel of a mesh that reaches
through the edge layer; no endpoint weight.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from reporting import table, write

from spectral_contact.equations.bounds import approach_bounds
from spectral_contact.fields.series import PressureField
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

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
    rows = []
    for degree in DEGREES:
        brackets = (bracket(compliance, degree) for compliance in COMPLIANCES)
        rows.append((degree, *(f"{upper / lower - 1.0:.1e}" for lower, upper in brackets)))
    about = f"{len(rows) * len(COMPLIANCES)} brackets; width relative to the approach."
    heading = " | ".join(["degree p", *(f"α* = {c:g}" for c in COMPLIANCES)])
    write("bounds", f"{about}\n\n{table(heading, rows)}")


if __name__ == "__main__":
    main()
