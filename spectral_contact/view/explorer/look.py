"""Solve a scene, and make of it what the explorer shows. No browser here."""

from __future__ import annotations

import math
from collections.abc import Callable
from time import perf_counter

import numpy as np

from spectral_contact.errors import SpectralContactError
from spectral_contact.fields import Array
from spectral_contact.solution import Solution
from spectral_contact.view.explorer.shown import Look
from spectral_contact.view.explorer.state import Texts, code_of, rtol_of, scene_of
from spectral_contact.view.html import table_html, zones_svg
from spectral_contact.view.radii import bulk_limits, graded_radii, known_zones, layer_depth
from spectral_contact.view.report import quantity_cells

_RADII = 240


def look_at(texts: Texts, solve: Callable[..., Solution]) -> Look:
    """Solve the scene of a state, by what is given, and return what is to be shown of it."""
    try:
        scene = scene_of(texts)
        rtol = rtol_of(texts)
        start = perf_counter()
        solution = solve(scene, rtol, strict=False, progress=False)
        seconds = perf_counter() - start
    except SpectralContactError as error:
        return Look(complaint=str(error))
    unknowns = sum(step.unknowns for step in solution.work.steps)
    columns, limits = _drawn(solution)
    cost = f"solved in {1e3 * seconds:.3g} ms, {unknowns:,} unknowns, rtol = {rtol:g}"
    zones = tuple((one.inner, one.outer) for one in known_zones(solution) if one.kind == "slip")
    return Look("", solution, columns, limits, zones, tables_of(solution), cost, code_of(texts))


def tables_of(solution: Solution) -> str:
    """Return quantities with the estimates of their errors, zones and plan, in HTML."""
    zones = known_zones(solution)
    steps = solution.plan.steps
    plan = [("plan", "", ""), *((one.name, one.state.value, one.reason) for one in steps)]
    parts = [zones_svg(zones)] if zones else []
    if not solution.converged:
        parts.append(table_html([("not converged",), (solution.ending.value,)]))
    return "".join([*parts, table_html(quantity_cells(solution)), table_html(plan)])


def _drawn(solution: Solution) -> tuple[dict[str, Array], dict[str, tuple[float, float]]]:
    """Return the fields over the radius, and the limits of their axes."""
    radii, present = graded_radii(solution, _RADII), solution.plan.quantities
    nothing = np.full(len(radii.s), math.nan)
    columns = {"s": radii.s, "d": radii.from_edge}
    for symbol, name in (("p", "pressure"), ("q", "traction"), ("slip", "slip")):
        there = name in present and (name == "pressure" or solution.scene.friction is not None)
        values = radii.evaluate(getattr(solution, name)) if there else nothing
        columns[symbol] = np.where(np.isfinite(values), values, math.nan)
    friction = solution.scene.friction
    limited = friction is not None and math.isfinite(friction)
    columns["fp"] = float(friction or 0.0) * columns["p"] if limited else nothing
    limits = {"d": (1.0, layer_depth(solution))}
    for symbol, names in (("p", ("p",)), ("q", ("q", "fp")), ("slip", ("slip",))):
        curves = [columns[name] for name in names]
        limits[symbol] = bulk_limits(radii, curves)
        limits[f"log {symbol}"] = _logarithmic(np.concatenate(curves))
    return columns, limits


def _logarithmic(values: Array) -> tuple[float, float]:
    """Return limits of a logarithmic axis: six decades at most, of what is above zero."""
    high = max(np.nanmax(values, initial=0.0), 1e-300) * 2.0
    low = np.nanmin(values, where=values > 0.5e-6 * high, initial=high) / 2.0
    return float(low), float(high)
