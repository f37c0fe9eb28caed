"""``spectral-contact compare``: fields at the nodes of another code against a solution."""

from __future__ import annotations

import math
from typing import Any, Final

from spectral_contact import compare
from spectral_contact.io.checks import within
from spectral_contact.io.choices import one_of
from spectral_contact.io.columns import Expected, NumberTable
from spectral_contact.quantities import FIELDS, OUTPUTS
from spectral_contact.records import PROFILE_QUANTITIES
from spectral_contact.view.cli.files import Reading
from spectral_contact.view.cli.options import NamedNumbers, NotSolved, Number, UsageError
from spectral_contact.view.cli.scene_options import SceneOptions

#: Numbers that `--value` may give in every scene; with a profile there are more.
_NUMBERS: Final = ("approach", "stick_radius", "total_shear")
#: Fields of a file with their SI units.
_UNITS: Final = {one.name: one.si_unit for one in OUTPUTS if one.name in FIELDS} | {
    "displacement": "m"
}


def run(
    scene: SceneOptions,
    reading: Reading,
    file: str | None = None,
    *,
    value: NamedNumbers | None = None,
    at_most: Number | None = None,
) -> None:
    r"""Compare the nodes of another code with the solution.

    Print the errors of fields at the nodes of a finite or boundary element code, and of numbers, in
    the units of the scene (docs/start/check.md). Displacements are those of the half-space below
    the layer. Exit status: 0 done, 1 an error is larger than --at-most, 2 bad input or file,
    130 interrupted.

    Parameters
    ----------
    file : FILE
        Text file with a column r and some of pressure, traction, slip, displacement.
    value : NAME=X
        A number beside the fields (repeatable): approach, stick_radius, total_shear and, under a
        profile, contact_radius, load, stiffness, indentation_work.
    at_most : X
        Exit with 1 if an error is larger; by default exit with 0.

    Examples
    --------
    spectral-contact compare nodes.csv --poisson-ratio 0.3 --normal-compliance 0.05 \
        --friction none --columns r,pressure
    spectral-contact compare contact.rpt --youngs-modulus "210 GPa" --poisson-ratio 0.3 \
        --radius "5 mm" --load 1000 --friction 0.05 --columns "r=2 [mm],pressure=4 [MPa]" \
        --at-most 0.01
    """
    contact = scene.build().scene
    known = _NUMBERS if contact.profile is None else (*_NUMBERS, *PROFILE_QUANTITIES)
    given: dict[str, Any] = {one_of("value", name, known): x for name, x in value or ()}
    for name, x in given.items():
        if not math.isfinite(x):
            raise UsageError(f"--value {name}={x}: the number must be finite")
    if at_most is not None:
        within("at_most", at_most, ">= 0")
    told: list[Any] = []
    if file is not None:
        table, nodes = _nodes(file, reading, si=contact.physical is not None)
        told.append(table)
        given |= nodes
    elif not given:
        raise UsageError("give a FILE of nodes, or --value NAME=X")
    comparison = compare(contact, **given)
    print(*told, comparison, sep="\n")
    if at_most is not None and not comparison.error <= at_most:
        excess = f"the largest error is {comparison.error:.1e}, --at-most is {at_most:g}"
        raise NotSolved(excess)


def _nodes(file: str, reading: Reading, *, si: bool) -> tuple[NumberTable, dict[str, Any]]:
    """Return what was read from a file, and its radii and fields as `compare` takes them.

    Radii are passed as s if the heading of their column says that they are over the contact radius.
    """
    radius = Expected("r", "m" if si else "", at_least=0.0)
    units = _UNITS if si else dict.fromkeys(_UNITS, "")
    fields = [Expected(name, unit, required=False) for name, unit in units.items()]
    table = reading.read(file, [radius, *fields])
    if len(table.values) == 1:
        names = ", ".join(_UNITS)
        raise UsageError(f"{file}: no column of {names}; say which is which")
    radii = "s" if radius.is_ratio(table.sources["r"].heading) else "r"
    return table, {radii if name == "r" else name: one for name, one in table.values.items()}
