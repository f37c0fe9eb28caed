"""What digits cost: group ``reference`` of bench.py. One process, one BLAS thread."""

from __future__ import annotations

from time import process_time

from mpmath import libmp
from timed import TABLE, table, write

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


def main(name: str) -> None:
    """Run and write the results."""
    rows = []
    for scene_name, scene in SCENES.items():
        for digits in (*DIGITS, MANY) if scene_name == next(iter(SCENES)) else DIGITS:
            begin = process_time()
            solution = reference(scene, digits)
            known = {"seconds": process_time() - begin, "unknowns": solution.unknowns}
            errors = (getattr(solution.error, one) for one in ("pressure", "traction", "zones"))
            known |= {"bits": solution.bits, "error": max(e for e in errors if e is not None)}
            rows.append({"scene": scene_name, "digits": digits, **known})
    about = f"Integers of {libmp.BACKEND}; seconds of one processor for both solutions and the "
    cells = (
        row | {"seconds": f"{row['seconds']:.0f}", "error": f"{row['error']:.0e}"} for row in rows
    )
    heading = "scene | digits | seconds | unknowns | bits | error estimate"
    record = {"integers": libmp.BACKEND, "rows": rows}
    write(name, f"{about}estimate.\n\n{table(heading, (one.values() for one in cells))}", record)
