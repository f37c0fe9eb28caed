"""What digits cost: group ``reference`` of bench.py. One process, one BLAS thread."""

from __future__ import annotations

from time import process_time

from mpmath import libmp
from timed import TABLE, report

from spectral_contact import Scene
from spectral_contact.precise import reference

SCENES = {
    name: Scene(*numbers, coupling=kind == "coupled")
    for kind, rows in TABLE["reference"].items()
    for name, numbers in rows.items()
}
DIGITS = (20, 30)
#: More, for the first scene alone.
MANY = 50


def main(group: str) -> None:
    """Run and write the results."""
    rows = []
    for name, scene in SCENES.items():
        for digits in DIGITS if rows else (*DIGITS, MANY):
            begin = process_time()
            solution = reference(scene, digits)
            known = {"seconds": process_time() - begin, "unknowns": solution.unknowns}
            errors = (getattr(solution.error, one) for one in ("pressure", "traction", "zones"))
            known |= {"bits": solution.bits, "error": max(e for e in errors if e is not None)}
            rows.append({"scene": name, "digits": digits, **known})
    integers = libmp.BACKEND
    report(group, rows, {"integers": integers, "rows": rows}, integers=integers)
