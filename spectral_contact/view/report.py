"""Solutions as text: the report that the command line prints, and a table of the fields as csv."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.processes import VERSION
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.quantities import FIELDS, OUTPUTS
from spectral_contact.records import Zone
from spectral_contact.scene import PhysicalData, Scene
from spectral_contact.solution import Solution
from spectral_contact.view.error_sizes import ErrorSizes, error_of_unit
from spectral_contact.view.radii import graded_radii

if TYPE_CHECKING:
    from spectral_contact.equations.interior import Inside
    from spectral_contact.view.physical_solution import PhysicalSolution

#: Units of a table of fields, under a flat punch and with a profile.
_UNITS = "dimensionless: s = r/a, p and q in P/a^2, slip in 4 (1 - nu^2) P / (a E)"
_PROFILE_UNITS = "s = r/a, lengths in L, p in E' = E / (4 (1 - nu^2)), loads in E' L^2"
#: Remark on an adhesive contact.
_RETRACTED = (
    "the approach is negative: adhesion holds the contact while it is taken back; on the way in it "
    "begins at the approach 0"
)


def report(solution: Solution, remarks: Sequence[str] = ()) -> str:
    """Return the report of a solution; only the timings in it differ from run to run.

    Parameters
    ----------
    solution : Solution
    remarks : sequence of str
        Remarks on the scene, which come before those of the solution.
    """
    parts = [_scene_text(solution), table(quantity_cells(solution))]
    if solution.scene.physical is not None:
        parts.append(table(si_cells(solution)))
    remarks = [*remarks, *solution.remarks, *_on_adhesion(solution)]
    if remarks:
        parts.append("\n".join(["remarks", *map(_indented, remarks)]))
    if "zones" in solution.plan.quantities:
        without_zones = "zones\n  none: without friction there is neither stick nor slip"
        parts.append(table(zone_cells(solution)) if solution.zones else without_zones)
    parts += [f"plan\n{_indented(str(solution.plan))}", _work_table(solution)]
    if solution.less_certain:
        parts.append(_less_certain(solution))
    ending_text = solution.ending.value
    verdict = "yes" if solution.converged else f"no. {ending_text[:1].upper()}{ending_text[1:]}"
    parts.append(f"converged: {verdict}")
    return "\n\n".join(parts)


def _on_adhesion(solution: Solution) -> list[str]:
    """Return remarks on an adhesive contact: its stability, and a negative approach."""
    remarks = []
    stable = solution.values.get("stable_under")
    if stable is not None:
        controls = " and of the ".join(stable)
        remarks = [
            f"stable under control of the {controls}" if stable else "stable under no control"
        ]
    if solution.scene.work_of_adhesion is not None and solution.values.get("approach", 0.0) < 0.0:
        remarks.append(_RETRACTED)
    return remarks


def _less_certain(solution: Solution) -> str:
    """Return the quantities whose errors are above rtol, with the errors, and why."""
    lines = [f"less certain than rtol = {solution.rtol:.1e}"]
    for name, error in solution.less_certain.items():
        error_text = f"{error:.1e}" if error < 1.0 else "no digit is known"
        lines.append(f"  {name.replace('_', ' ')}: {error_text}")
    if solution.converged:
        lines.append("  zone boundaries and slip are as certain as their conditioning allows")
    return "\n".join(lines)


def report_inside(body: Inside) -> str:
    """Return the largest stresses in a body, and the energies."""
    cells: list[tuple[str, ...]] = [("", "largest", "at r", "at z", "error", "")]
    for name in ("von_mises", "max_shear", "surface_tension"):
        extreme = body.largest(name)
        value = "-" if extreme.value is None else f"{extreme.value:.12g}"
        error = "-" if extreme.error is None else f"{extreme.error:.1e}"
        cells.append((name, value, f"{extreme.r:.8g}", f"{extreme.z:.8g}", error, extreme.remark))
    try:
        energies = body.energies()
    except NotComputedError as missing:
        return f"{table(cells)}\n{missing}"
    names = ("external", "strain", "layer", "friction", "defect")
    rows = [("energy", "value"), *((name, f"{getattr(energies, name):.12g}") for name in names)]
    return f"{table(cells)}\n{table(rows)}"


def write_csv(solution: Solution, path: str | os.PathLike[str]) -> None:
    """Write the fields over graded radii; the scalars and the zones are comments."""
    path = path_text(path)
    columns = _csv_columns(solution)
    lines = [f"# {line}" for line in _csv_comments(solution)]
    lines.append(",".join(columns))
    for row in zip(*(column.tolist() for column in columns.values()), strict=True):
        lines.append(",".join(map(repr, row)))
    with reported(path, "cannot be written"):
        replace_file(path, ("\n".join(lines) + "\n").encode())


def _csv_columns(solution: Solution) -> dict[str, Any]:
    """Return radii, fields, and the estimates of their relative errors."""
    radii = graded_radii(solution)
    quantities = solution.plan.quantities
    columns: dict[str, Any] = {"s": radii.s, "one_minus_s": radii.from_edge}
    if not set(FIELDS).intersection(quantities):
        reason = dict(solution.plan.missing).get("pressure", "it was not asked for")
        raise NotComputedError(f"a field to write ({', '.join(FIELDS)})", reason)
    friction = solution.scene.friction
    if "pressure" in quantities:
        columns["p"] = radii.evaluate(solution.pressure)
    if "traction" in quantities:
        columns["q"] = radii.evaluate(solution.traction)
    if "pressure" in quantities and friction is not None and math.isfinite(friction):
        # not 0 * inf at the edge of a smooth surface
        columns["f_p"] = friction * columns["p"] if friction else np.zeros(len(radii.s))
    if "slip" in quantities:
        columns["slip"] = radii.evaluate(solution.slip)
    for name, column in zip(FIELDS, ("p", "q", "slip"), strict=True):
        error = getattr(solution.error, name)
        if name in quantities and error is not None:
            columns[f"{column}_error"] = np.full(len(radii.s), error)
    return columns


@dataclass(frozen=True, slots=True)
class _Row:
    """One scalar: its label, value, unit and error estimate, as `ErrorEstimates` has it."""

    label: str
    value: float | None
    unit: str
    error: float | None
    #: the scale of the error over the modulus of the value: 1 if the error is relative to that;
    #: None if it is not known
    scale: float | None = 1.0
    #: if the value is not known: the quantity that would have to be asked for
    missing_quantity: str = ""

    @property
    def relative_error(self) -> float | None:
        """The error relative to the value."""
        if self.scale is None:
            return None
        return self.error * self.scale if self.error else self.error


def _rows(solution: Solution) -> list[_Row]:
    """Return the dimensionless scalars."""
    rows = _scalars(solution, solution, {})
    if solution.values.get("opening") is not None:
        rows.append(_Row("contact would open within", solution.opening, "", None))
    if solution.error.violation is not None:
        rows.append(_Row("friction law, violation", solution.error.violation, "", None))
    return rows


def _si_rows(solution: Solution) -> list[_Row]:
    """Return the scalars that have a unit, in SI units."""
    data = solution.scene.physical
    if data is None:
        return []
    physical = solution.physical
    units = {one.name: one.si_unit for one in OUTPUTS}
    rows = _scalars(physical, solution, units)
    flat = solution.scene.profile is None
    if flat:
        load, missing_quantity = if_known(lambda: physical.load)
        rows.insert(0, _Row("load", load, "N", 0.0, missing_quantity=missing_quantity))
    if flat and data.approach is not None:
        rows = [replace(row, error=0.0) if row.label == "approach" else row for row in rows]
    return [_with_error_of_unit(row, solution) for row in rows if row.unit]


def _with_error_of_unit(row: _Row, solution: Solution) -> _Row:
    """Return a row in SI units with the error of its unit added to its own."""
    if row.error is None:
        return row
    return replace(row, error=row.error + _error_of_unit(row.label.replace(" ", "_"), solution))


def _error_of_unit(name: str, solution: Solution) -> float:
    return error_of_unit(solution.scene, name, lambda quantity: getattr(solution.error, quantity))


def _scalars(
    source: Solution | PhysicalSolution, solution: Solution, units: dict[str, str]
) -> list[_Row]:
    """Return fields at centre and edge, and scalars, of a solution or of its SI view."""
    rows = []
    for name in solution.plan.quantities:
        unit = units.get(name, "")
        error = getattr(solution.error, name)
        if name == "pressure":
            centre, missing_quantity = if_known(lambda: float(source.pressure(0.0)))
            scale = _error_scale_at(name, solution, 1.0)
            rows.append(_Row("pressure, centre", centre, unit, error, scale, missing_quantity))
        if name in FIELDS and _has_edge_value(name, solution.scene):
            edge, missing_quantity = if_known(partial(_edge_value, source, name))
            scale = _error_scale_at(name, solution, 0.0)
            rows.append(_Row(f"{name}, edge", edge, unit, error, scale, missing_quantity))
        elif name not in (*FIELDS, "zones"):
            value, missing_quantity = if_known(partial(getattr, source, name))
            scale = relative_to(name, solution)
            rows.append(_Row(name.replace("_", " "), value, unit, error, scale, missing_quantity))
    return rows


def _edge_value(source: Solution | PhysicalSolution, name: str) -> float:
    return float(getattr(source, name)(from_edge=0.0))


def _error_scale_at(name: str, solution: Solution, from_edge: float) -> float | None:
    """Return the scale that the error of a field is relative to, over the modulus of its value.

    It is 1 where the value is 0 or not finite, and None where it would take a field that was not
    asked for.
    """

    def field(name: str) -> Callable[[Array], Array]:
        return lambda places: np.asarray(getattr(solution, name)(from_edge=places))

    places = np.array([from_edge])
    try:
        value = field(name)(places)
        if not np.isfinite(value[0]) or value[0] == 0.0:
            return 1.0
        size = ErrorSizes(solution.scene, solution, field).at(name, value, places)
    except NotComputedError:
        return None
    return float(size[0] / abs(value[0]))


def if_known(read: Callable[[], float | None]) -> tuple[float | None, str]:
    """Return a value and "", or None and the quantity that it needs and that was not asked for."""
    try:
        return read(), ""
    except NotComputedError as missing:
        return None, missing.quantity


def _has_edge_value(name: str, scene: Scene) -> bool:
    """Return whether a field is shown at the edge; under most profiles the pressure is 0 there."""
    if scene.profile is None:
        return True
    has_edge_pressure = isinstance(scene.profile, Flat) or scene.work_of_adhesion is not None
    return name == "pressure" and has_edge_pressure


def relative_to(name: str, solution: Solution) -> float:
    """Return the scale that an error is relative to, over the modulus of the value.

    It is 1 if the scale is the value, as of all quantities that cannot vanish.
    """
    scale = solution.error_scales.get(name)
    value = solution.values.get(name)
    if scale is None or value is None or math.isinf(value):
        return 1.0
    return scale / abs(value) if value else math.inf


def scene_text(scene: Scene) -> str:
    """Return the dimensionless parameters of a scene on one line."""
    friction = f"f = {scene.friction!r}"
    if scene.friction is None:
        friction = "no friction"
    elif scene.friction == math.inf:
        friction = "full stick"
    return (
        f"{_material_text(scene)}alpha* = {scene.normal_compliance!r}, "
        f"beta* = {scene.tangential_compliance!r}, {friction}{', coupled' * scene.coupling}"
        f"{_load_text(scene)}{_shape_text(scene)}"
    )


def _load_text(scene: Scene) -> str:
    """Return the load ratio of a scene below its largest load as text."""
    return "" if scene.unloaded_to == 1.0 else f", unloaded to {scene.unloaded_to!r}"


def _material_text(scene: Scene) -> str:
    """Return kappa of two bodies, or Poisson's ratio, if known: the traction depends on it."""
    if scene.mismatch is not None:
        return f"kappa = {scene.mismatch!r}, "
    return "" if scene.poisson_ratio is None else f"nu = {scene.poisson_ratio!r}, "


def _moduli_text(scene: Scene, data: PhysicalData) -> str:
    """Return the materials of SI data: of one body, of both, or what they are together."""
    if data.reduced_modulus is not None:
        return f"E* = {data.reduced_modulus!r} Pa"
    body = f"E = {data.youngs_modulus!r} Pa"
    if data.punch_youngs_modulus is None:
        return body
    punch = f"E = {data.punch_youngs_modulus!r} Pa, nu = {data.punch_poisson_ratio!r}"
    return f"{body}, nu = {scene.poisson_ratio!r}; punch: {punch}"


def _shape_text(scene: Scene) -> str:
    """Return the profile, the layer, and the given load, approach, radius or separation."""
    if scene.profile is None:
        return ""
    given = {name: getattr(scene, name) for name in ALL_CONTROLS}
    [control] = [f"{name} = {value!r}" for name, value in given.items() if value is not None]
    layer = "" if scene.layer is None else f", {scene.layer.brief}"
    if scene.work_of_adhesion is not None:
        layer += f", w = {scene.work_of_adhesion!r}"
        layer += f", branch {scene.branch}" * bool(scene.branch)
    return f", {scene.profile.brief}{layer}, {control.replace('_', ' ')}"


def _scene_text(solution: Solution) -> str:
    data = solution.scene.physical
    text = f"{scene_text(solution.scene)}; rtol = {solution.rtol!r}"
    if data is not None:
        lengths = {
            "a": data.radius or data.contact_radius,
            "delta": data.approach,
            "d": data.separation,
        }
        given = [f"{name} = {length!r} m" for name, length in lengths.items() if length is not None]
        given += [] if data.load is None else [f"P = {data.load!r} N"]
        layer = f"alpha = {data.normal_compliance!r} m/Pa"
        if data.layer is not None:
            layer = f"{data.layer.brief} in Pa and m"
        text += f"\n{_moduli_text(solution.scene, data)}, {', '.join(given)}, {layer}, "
        text += f"beta = {data.tangential_compliance!r} m/Pa"
        if data.work_of_adhesion is not None:
            text += f", w = {data.work_of_adhesion!r} J/m^2"
    return text


def quantity_cells(solution: Solution) -> list[tuple[str, ...]]:
    """Return the table of the dimensionless scalars."""
    return _quantity_cells(_rows(solution), "quantity")


def si_cells(solution: Solution) -> list[tuple[str, ...]]:
    """Return the table of the scalars in SI units; only its heading if the scene has none."""
    return _quantity_cells(_si_rows(solution), "SI")


def _quantity_cells(rows: list[_Row], title: str) -> list[tuple[str, ...]]:
    cells: list[tuple[str, ...]] = [(title, "value", "error estimate")]
    for row in rows:
        unit = "" if row.value is None else row.unit
        value = f"{digits_text(row.value, row.relative_error)} {unit}".rstrip()
        if row.missing_quantity:
            value = f"not known without {row.missing_quantity}"
        cells.append(
            (row.label, value, "-" if row.value is None else estimate_text(row.relative_error))
        )
    return cells


def _zone_text(zone: Zone) -> str:
    """Return the kind of a zone: stick, stick with memory, slip or slip back."""
    if zone.kind == "stick":
        return "stick, memory" if zone.memory else "stick"
    return "slip" if zone.sense > 0 else "slip back"


def zone_cells(solution: Solution) -> list[tuple[str, ...]]:
    """Return the table of the zones; only its heading if there are none."""
    zones = solution.zones
    estimate = solution.error.zones
    cells: list[tuple[str, ...]] = [("zones", "from", "to", "1 - to", "error estimate")]
    for zone in zones:
        radii = (zone.inner, zone.outer, zone.outer_from_edge)
        cells.append(
            (_zone_text(zone), *(digits_text(r, estimate) for r in radii), estimate_text(estimate))
        )
    if solution.scene.physical is not None and not if_known(lambda: solution.physical.radius)[1]:
        metre_estimate = (
            None if estimate is None else estimate + _error_of_unit("stick_radius", solution)
        )
        metres = (digits_text(zone.outer, metre_estimate) for zone in solution.physical.zones)
        cells = [(*row, cell) for row, cell in zip(cells, ("to [m]", *metres), strict=True)]
    return cells


def _work_table(solution: Solution) -> str:
    cells = [("work", "unknowns", "degree", "spaces", "time")]
    for step in solution.work.steps:
        degree = str(max(step.degrees)) if step.degrees else "-"
        spaces = str(len(step.history)) if step.history else "-"
        time = f"{1e3 * step.seconds:.1f} ms"
        cells.append((step.name, str(step.unknowns), degree, spaces, time))
    work = solution.work
    cells.append(("total", "", "", "", f"{1e3 * work.seconds:.1f} ms"))
    return table(cells)


def table(cells: Sequence[tuple[str, ...]]) -> str:
    """Return cells as text, columns aligned to the left; the first line is a heading."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    widths[0] += 2
    lines = []
    for i, row in enumerate(cells):
        row = (row[0] if i == 0 else f"  {row[0]}", *row[1:])
        padded = (f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True))
        lines.append("   ".join(padded).rstrip())
    return "\n".join(lines)


def _indented(text: str) -> str:
    return "\n".join(f"  {line}" for line in text.splitlines())


def digits_text(value: float | None, error: float | None) -> str:
    """Return a value with the digits that are right by its error, and one more."""
    if value is None:
        return "none"
    if error is None:
        return f"{value:.1e}" if value else "0"
    if error == 0.0:
        return repr(value).removesuffix(".0")
    # an estimate of NaN or infinity vouches for no digit
    digits = math.ceil(-math.log10(error)) + 1 if error < 0.1 else 2
    return f"{value:.{min(digits, 17)}g}"


def estimate_text(error: float | None) -> str:
    """Return the estimate of an error; "-" if there is none."""
    if error is None:
        return "-"
    if error == 0.0:
        return "exact"
    return f"{error:.1e}" if error < math.inf else f"{error}: no digit is known"


def _csv_comments(solution: Solution) -> list[str]:
    lines = [
        f"spectral_contact {VERSION}",
        *_scene_text(solution).splitlines(),
        f"converged: {'yes' if solution.converged else 'no'}",
        _UNITS if solution.scene.profile is None else _PROFILE_UNITS,
        "p_error, q_error, slip_error: estimates of errors, relative to what docs/choosing says",
    ]
    for row in (*_rows(solution), *_si_rows(solution)):
        unit = f" {row.unit}" if row.unit and row.value is not None else ""
        value = "none" if row.value is None else repr(row.value)
        if row.missing_quantity:
            value = f"not known without {row.missing_quantity}"
        # an error may be known without the scale that it is relative to
        has_error = row.value is not None and row.relative_error is not None
        error = f"relative error {row.relative_error:.1e}" if row.relative_error else "exact"
        estimate = f" ({error})" if has_error else ""
        lines.append(f"{row.label} = {value}{unit}{estimate}")
    if "zones" in solution.plan.quantities:
        for zone in solution.zones:
            lines.append(
                f"zone: {_zone_text(zone)} from {zone.inner!r} to {zone.outer!r}, "
                f"1 - s from {zone.inner_from_edge!r} to {zone.outer_from_edge!r}"
            )
    return lines
