"""Scenes, solutions, plans and gold tables as a notebook shows them: as tables and drawn zones."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Final

from spectral_contact.io.parameters import SCENE, SI
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.records import Plan, Zone
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.view.figures import SLIP_GREY, STICK_WHITE, ZONE_EDGE
from spectral_contact.view.report import quantity_cells, si_cells, zone_cells

if TYPE_CHECKING:
    from spectral_contact.gold.table_loader import GoldSolution, GoldTable

#: The parameters of a scene, in the order of its table.
_SHOWN: Final = (
    *("poisson_ratio", "normal_compliance", "tangential_compliance", "friction", "mismatch"),
    *("youngs_modulus", "punch_youngs_modulus", "punch_poisson_ratio", "reduced_modulus", "radius"),
    *("load", "approach", "contact_radius", "separation", "work_of_adhesion"),
)
_WIDTH, _HEIGHT = 360.0, 26.0
#: A zone is drawn no narrower, so that it is seen.
_LEAST = 1.5
_COLOURS: Final = {"stick": STICK_WHITE, "slip": SLIP_GREY}


def html_of(shown: Scene | Plan | Solution) -> str:
    """Return what notebooks show of a record."""
    match shown:
        case Scene():
            return of_scene(shown)
        case Plan():
            return of_plan(shown)
    return of_solution(shown)


def of_scene(scene: Scene) -> str:
    """Return the parameters of a scene."""
    rows: list[tuple[str, ...]] = [("scene", "", "")]
    physical = scene.physical
    for name in _SHOWN:
        about = SI[name] if name in SI else SCENE["kappa" if name == "mismatch" else name]
        words, symbol, unit = about.meaning, about.symbol, about.unit.replace("^2", "²")
        # a number that would have a unit has a star where it is dimensionless, but for loads and
        # lengths, which are in E'L² and L
        star = "*" if unit and name not in ALL_CONTROLS else ""
        value = getattr(scene, name, None)
        if name == "friction":
            rows.append((words, symbol, _friction(scene.friction)))
        # with SI data loads and lengths are shown in SI units alone
        elif value is not None and (physical is None or name not in ALL_CONTROLS):
            rows.append((words, symbol + star, f"{value:.6g}"))
        si = getattr(physical, name, None)
        if si is not None:
            rows.append((words, symbol, f"{si:.6g} {unit}".rstrip()))
    if scene.profile is not None:
        rows.append(("profile", "", scene.profile.brief))
    if scene.layer is not None:
        law = scene.layer if physical is None else physical.layer
        rows.append(("layer", "", law.brief))
    if scene.branch:
        rows.append(("branch", "", str(scene.branch)))
    if scene.unloaded_to < 1.0:
        rows.append(("load over the largest load", "λ", f"{scene.unloaded_to:.6g}"))
    if scene.coupling:
        rows.append(("elastic coupling", "", "yes"))
    return table_html(rows)


def of_solution(solution: Solution) -> str:
    """Return quantities with their errors, and the zones of a solution."""
    parts = [table_html(quantity_cells(solution))]
    if solution.scene.physical is not None:
        parts.append(table_html(si_cells(solution)))
    if "zones" in solution.plan.quantities and solution.zones:
        parts += [zones_svg(solution.zones), table_html(zone_cells(solution))]
    if not solution.converged:
        parts.append(f"<p><b>not converged</b>: {escape(solution.ending.value)}</p>")
    unsure = (
        f"{name} to {error:.1e}" if error < 1.0 else f"{name}, of which no digit is known"
        for name, error in solution.less_certain.items()
    )
    if solution.less_certain:
        parts.append(f"<p>less certain than rtol: {escape(', '.join(unsure))}</p>")
    parts += [f"<p>{escape(remark)}</p>" for remark in solution.remarks]
    return _block([of_scene(solution.scene), *parts])


def of_plan(plan: Plan) -> str:
    """Return the steps of a plan, and why what is missing is missing."""
    rows = [("step", "", "why"), *((one.name, one.state.value, one.reason) for one in plan.steps)]
    missing = [("not computed", "why"), *plan.missing]
    return _block([table_html(rows), table_html(missing) if plan.missing else ""])


def of_gold_table(table: GoldTable) -> str:
    """Return the scenes of a gold table, with approach and stick radius."""
    rows: list[tuple[str, ...]] = [("scene", "zones", "approach δ*", "stick radius c*")]
    for one in table.solutions:
        kinds = ", ".join(zone.kind for zone in one.zones)
        radius = "" if one.stick_radius is None else f"{float(one.stick_radius):.12g}"
        rows.append((one.name, kinds, f"{float(one.approach):.12g}", radius))
    return _block([f"<p><b>{escape(table.name)}</b>: {escape(table.regime)}</p>", table_html(rows)])


def of_gold(one: GoldSolution) -> str:
    """Return the numbers of a solution of a gold table (docs/gold) with all their digits."""
    rows: list[tuple[str, ...]] = [("quantity", f"to {one.digits} digits", "relative error")]
    for name in ("approach", "total_shear", "stick_radius", "edge_ratio"):
        value, error = getattr(one, name), getattr(one.error, name)
        if value is not None and error is not None:
            rows.append((name.replace("_", " "), str(value), f"{error:.1e}"))
    if one.approach_bounds is not None:
        lower, upper = one.approach_bounds
        rows.append(("approach, proved", f"in [{lower}, {upper}]", ""))
    return _block(
        [of_scene(one.scene), table_html(rows), zones_svg(one.zones) if one.zones else ""]
    )


def table_html(cells: Sequence[Sequence[str]]) -> str:
    """Return cells as a table; the first line is a heading."""
    lines = []
    for i, row in enumerate(cells):
        kind = "td" if i else "th"
        style = ' style="text-align:left"'
        lines.append("".join(f"<{kind}{style}>{escape(cell)}</{kind}>" for cell in row))
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    # a table that is wider than the page, as on a phone, scrolls: no column is cut off
    return f'<div style="overflow-x:auto"><table>{body}</table></div>'


def zones_svg(zones: Sequence[Zone]) -> str:
    """Return a drawing of the zones from the centre (left) to the edge: slip is grey."""
    parts, said = [], []
    for zone in zones:
        inner, outer = float(zone.inner), float(zone.outer)
        said.append(f"{zone.kind} from {inner:.6g} to {outer:.6g}")
        left = 1.0 + inner * _WIDTH
        width = max((outer - inner) * _WIDTH, _LEAST)
        left = min(left, 1.0 + _WIDTH - width)
        parts.append(
            f'<rect x="{left:.2f}" y="1" width="{width:.2f}" height="{_HEIGHT:g}"'
            f' fill="{_COLOURS[zone.kind]}" stroke="{ZONE_EDGE}" stroke-width="0.8"/>'
        )
        if width > 40.0:
            place = f'x="{left + width / 2.0:.2f}" y="{_HEIGHT / 2.0 + 5.0:g}"'
            parts.append(
                f'<text {place} text-anchor="middle" fill="black">{escape(zone.kind)}</text>'
            )
    for x, anchor, text in ((1.0, "start", "centre"), (1.0 + _WIDTH, "end", "edge")):
        place = f'x="{x:g}" y="{_HEIGHT + 15.0:g}"'
        parts.append(f'<text {place} text-anchor="{anchor}">{text}</text>')
    size = f'width="{_WIDTH + 2.0:g}" height="{_HEIGHT + 20.0:g}"'
    style = 'style="font:12px sans-serif;color:inherit" fill="currentColor"'
    title = f"<title>{escape('; '.join(said))}</title>"
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {style}>{title}{"".join(parts)}</svg>'


def _friction(value: float | None) -> str:
    if value is None:
        return "none"
    return "full stick" if value == math.inf else f"{value:.6g}"


def _block(parts: Iterable[str]) -> str:
    return f"<div>{''.join(parts)}</div>"
