"""Show that the bracket of the approach closes with the degree.

Run as ``python validation/honesty/bounds.py``.

Writes validation/results/bounds.json and .md. Degree p on every panel of a mesh that reaches
through the edge layer; no endpoint weight.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

from spectral_contact import __version__
from spectral_contact.equations.bounds import approach_bounds
from spectral_contact.fields.series import PressureField
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

RESULTS = Path(__file__).parents[1] / "results"
DEGREES = range(1, 11)
COMPLIANCES = (0.5, 1e-2, 1e-4)


def bracket(compliance: float, degree: int) -> tuple[float, float, int]:
    """Return both bounds from degree p, and the unknowns."""
    panels = LogPanels(math.ceil((30.0 - math.log(compliance)) / 2.0), 2.0, max(DEGREES))
    space = unit_space(panels, (degree,) * panels.panels)
    unit = space.factor(compliance).solve(2.0)
    moment = 2.0 * float(space.constant_moments @ unit[space.index])
    approach = 1.0 / (2.0 * math.pi * moment)
    pressure = PressureField(None, series_of(panels, unit * approach))
    return *approach_bounds(compliance, approach, pressure), space.unknowns


def main() -> None:
    """Run and write the results."""
    rows = []
    for compliance in COMPLIANCES:
        for degree in DEGREES:
            lower, upper, unknowns = bracket(compliance, degree)
            rows.append(
                {
                    "compliance": compliance,
                    "degree": degree,
                    "unknowns": unknowns,
                    "lower": lower,
                    "upper": upper,
                    "relative_width": upper / lower - 1.0,
                }
            )
    record = {
        "schema": "spectral_contact.validation.bounds",
        "version": 1,
        "library": __version__,
        "count": len(rows),
        "rows": rows,
    }
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps(record, indent=1)
    (RESULTS / "bounds.json").write_text(text + "\n", encoding="utf-8")
    widths = {(r["compliance"], r["degree"]): r["relative_width"] for r in rows}
    lines = [
        f"{len(rows)} brackets; width relative to the approach.",
        "",
        "| degree p | " + " | ".join(f"α* = {c:g}" for c in COMPLIANCES) + " |",
        "|---|" + "---|" * len(COMPLIANCES),
    ]
    lines += [
        f"| {p} | " + " | ".join(f"{widths[c, p]:.1e}" for c in COMPLIANCES) + " |" for p in DEGREES
    ]
    (RESULTS / "bounds.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
