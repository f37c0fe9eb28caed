"""Show how narrow the proved intervals are, over the compliance and the number of polynomials.

Run as ``python validation/honesty/proof.py``.

Writes validation/results/proof.md. Each width is that of `proof.enclose_approach`, or of
`proof.enclose_edge_pressure`, held to that number of polynomials.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from reporting import table, write

from spectral_contact import ConvergenceError, Scene, proof
from spectral_contact.view.progress import ProgressLine

COMPLIANCES = (1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)
TERMS = (256, 2048, 16384, 65536)
#: The edge pressure takes twice as long.
EDGE_TERMS = (2048, 16384)
#: More digits than any of these numbers of polynomials proves: each goes to the end.
DIGITS = 30


def width(enclose: Callable[..., proof.Enclosure], compliance: float, terms: int) -> float:
    """Return the relative width with this number of polynomials."""
    proof._FEWEST_TERMS = proof._MOST_TERMS = terms
    try:
        return enclose(Scene(0.3, compliance), DIGITS).width
    except ConvergenceError as error:
        return float(error.solution.width)


def main() -> None:
    """Run and write the results."""
    columns = [(proof.enclose_approach, "δ*", terms) for terms in TERMS]
    columns += [(proof.enclose_edge_pressure, "p*(1)", terms) for terms in EDGE_TERMS]
    rows = []
    with ProgressLine(None) as tell:
        for count, compliance in enumerate(COMPLIANCES):
            tell(f"alpha = {compliance:g}", count / len(COMPLIANCES))
            widths = (width(enclose, compliance, terms) for enclose, _, terms in columns)
            rows.append((f"{compliance:g}", *(f"{value:.1e}" for value in widths)))
    about = f"{len(COMPLIANCES)} compliances: width of the proved interval over its upper end, by "
    heading = " | ".join(["α*", *(f"{symbol}, {terms}" for _, symbol, terms in columns)])
    write("proof", f"{about}the number of polynomials.\n\n{table(heading, rows)}")


if __name__ == "__main__":
    main()
