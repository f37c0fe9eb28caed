"""What the explorer shows of a scene: its fields, tables, link and Python lines. No browser here.

The state of the explorer is text by name, as in the query of a link. What is absent is not
modelled, as in a `Scene`; whatever the text says, `scene_of` makes a scene of it or says why not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from time import perf_counter
from typing import Any, Final
from urllib.parse import parse_qsl, urlencode

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SpectralContactError
from spectral_contact.inputs.choices import instance, one_of
from spectral_contact.layers.control import refuse_layer
from spectral_contact.profiles import Profile
from spectral_contact.profiles.control import CONTROLS, KINDS, SHAPES
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.planning import checked_tolerance
from spectral_contact.solving.solver import solve
from spectral_contact.view.html import table_html, zones_svg
from spectral_contact.view.radii import bulk_limits, graded_radii, known_zones, layer_depth
from spectral_contact.view.report import quantity_cells

__all__ = [
    "FLAT",
    "KNOBS",
    "RTOL",
    "Knob",
    "Look",
    "code_of",
    "look_at",
    "query_of",
    "scene_of",
    "texts_from",
    "texts_of",
]

Array = NDArray[np.float64]
Texts = Mapping[str, str]

#: The tolerance that nobody set.
RTOL: Final = "1e-8"
_RADII: Final = 240
#: What is asked for, of which the pressure limits the tolerance.
_FIELDS: Final = ("pressure",)


@dataclass(frozen=True, slots=True)
class Knob:
    """A number that can be moved.

    Attributes
    ----------
    name : str
        As in `Scene`, or in a profile.
    label : str
    low, high : float
        The ends of its slider; other values can be typed.
    logarithmic : bool
        Whether equal steps of the slider are equal ratios.
    start : str
        What it is before anybody moved it.
    """

    name: str
    label: str
    low: float
    high: float
    logarithmic: bool
    start: str

    def text(self, place: float) -> str:
        """Return the value at a place of the slider, to four digits."""
        return f"{10.0**place if self.logarithmic else place:.4g}"

    def place(self, text: str) -> float:
        """Return the place of a value: an end of the slider for what is beyond, or no number."""
        value = _number(text)
        inside = min(max(value if isinstance(value, float) else self.low, self.low), self.high)
        return math.log10(inside) if self.logarithmic else inside


KNOBS: Final = {
    one.name: one
    for one in (
        Knob("poisson_ratio", "Poisson's ratio ν", 0.0, 0.5, False, "0.1"),
        Knob("normal_compliance", "normal compliance α*", 1e-4, 1e2, True, "0.5"),
        Knob("tangential_compliance", "tangential compliance β*", 1e-4, 1e2, True, "0.5"),
        Knob("friction", "friction f", 1e-3, 1.0, True, "0.1"),
        Knob("radius", "radius of curvature R", 0.1, 10.0, True, "1"),
        Knob("half_angle", "half-angle θ [rad]", 0.1, 1.5, False, "1.2"),
        Knob("coefficient", "coefficient C", 0.1, 10.0, True, "1"),
        Knob("exponent", "exponent n", 1.0, 10.0, False, "2"),
        Knob("flat_radius", "radius of the flat part b", 0.1, 10.0, True, "0.5"),
        Knob("load", "load", 0.01, 100.0, True, "1"),
        Knob("contact_radius", "contact radius", 0.1, 10.0, True, "0.8"),
        Knob("approach", "approach", 0.01, 10.0, True, "0.5"),
    )
}
_NAMES: Final = (*KNOBS, "coupling", "profile", "rtol")
#: What a scene has without a profile.
FLAT: Final = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")
_YES_NO: Final = {"true": True, "false": False}


# --- state ----------------------------------------------------------------------------------------


def texts_of(scene: Scene | None, rtol: float | None = None) -> dict[str, str]:
    """Return the state that shows a scene; None is the one to start with.

    Of a scene in SI units it is the dimensionless one.

    Raises
    ------
    SceneError
        If it is no scene, has a layer, or its profile is one that numbers do not describe; for a
        tolerance out of range.
    """
    told = {} if rtol is None else {"rtol": _text(checked_tolerance(rtol, _FIELDS))}
    if scene is None:
        return {name: KNOBS[name].start for name in FLAT} | told
    refuse_layer(instance("scene", scene, Scene), "explore")
    texts = {name: _text(getattr(scene, name)) for name in FLAT}
    if scene.coupling:
        texts["coupling"] = "true"
    if scene.profile is not None:
        kind = type(scene.profile).__name__
        texts["profile"] = one_of("the profile to explore", kind, SHAPES)
        texts |= {name: _text(getattr(scene.profile, name)) for name in SHAPES[kind]}
        given = {name: getattr(scene, name) for name in CONTROLS}
        texts |= {name: _text(value) for name, value in given.items() if value is not None}
    return texts | told


def texts_from(query: str) -> dict[str, str]:
    """Return the state that a link describes; what it leaves out is as at the start.

    Numbers are not looked at: what is refused of them can be mended in the page.

    Raises
    ------
    SceneError
        For a name that is not known, and for a choice that there is not.
    """
    told = dict(parse_qsl(query.removeprefix("?"), keep_blank_values=True))
    for name in told:
        one_of("the name of a parameter", name, _NAMES)
    for name, known in (("coupling", _YES_NO), ("profile", SHAPES)):
        if name in told:
            one_of(name, told[name], known)
    _rtol(told)
    return {**texts_of(None), **told}


def query_of(texts: Texts) -> str:
    """Return the query of the link to a state."""
    return "?" + urlencode(texts)


def scene_of(texts: Texts) -> Scene:
    """Return the scene of a state.

    Raises
    ------
    SceneError
        As `Scene` does, and the profile; for text that is no number, too.
    """
    values: dict[str, Any] = {name: _number(texts[name]) for name in FLAT if name in texts}
    if "coupling" in texts:
        values["coupling"] = _YES_NO[one_of("coupling", texts["coupling"], _YES_NO)]
    if "profile" in texts:
        kind = one_of("profile", texts["profile"], SHAPES)
        shape = {name: _number(texts.get(name, "")) for name in SHAPES[kind]}
        values["profile"] = KINDS[kind](**shape)
    values |= {name: _number(texts[name]) for name in CONTROLS if name in texts}
    return Scene(**values)


def code_of(texts: Texts) -> str:
    """Return Python lines that solve the scene of a state.

    Raises
    ------
    SceneError
        If there is none.
    """
    scene = scene_of(texts)
    given = [
        f"    {one.name}={getattr(scene, one.name)!r},"
        for one in fields(scene)
        if one.name == "poisson_ratio" or getattr(scene, one.name) != one.default
    ]
    imports = ["from math import inf"] * (scene.friction == math.inf)
    imports.append("from spectral_contact import Scene, solve")
    if isinstance(scene.profile, Profile):
        imports.append(f"from spectral_contact.profiles import {type(scene.profile).__name__}")
    rtol = _rtol(texts)
    return "\n".join(
        [*imports, "", "scene = Scene(", *given, ")", f"solution = solve(scene, rtol={rtol!r})"]
    )


def _rtol(texts: Texts) -> float:
    return checked_tolerance(_number(texts.get("rtol", RTOL)), _FIELDS)


def _text(value: float | None) -> str:
    return "none" if value is None else repr(value).removesuffix(".0")


def _number(text: str) -> float | str | None:
    """Return the number of a text; what is none stays text, for the library to refuse."""
    stripped = text.strip()
    if stripped.lower() == "none":
        return None
    try:
        return float(stripped)
    except ValueError:
        return text


# --- what is shown --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A state as it is shown; one that is refused has its complaint and nothing else.

    Attributes
    ----------
    complaint : str
        Why the scene is refused, in the words of the library.
    solution : Solution or None
    columns : dict of ndarray
        Over the radii ``s``: ``d`` = 1 − s, ``p``, ``q``, ``fp``, ``slip``; NaN where infinite.
    limits : dict
        Of the axes: ``d``, and each of ``p``, ``q`` and ``slip`` over s and, as ``log p`` and so
        on, over d.
    cost : str
    code : str
    """

    complaint: str = ""
    solution: Solution | None = None
    columns: Mapping[str, Array] | None = None
    limits: Mapping[str, tuple[float, float]] | None = None
    cost: str = ""
    code: str = ""

    @property
    def zones(self) -> tuple[tuple[float, float], ...]:
        """Inner and outer radius of each zone that slips."""
        zones = () if self.solution is None else known_zones(self.solution)
        return tuple((one.inner, one.outer) for one in zones if one.kind == "slip")

    @property
    def tables(self) -> str:
        """Quantities with the estimates of their errors, zones and plan, in HTML."""
        if self.solution is None:
            return ""
        zones = known_zones(self.solution)
        steps = self.solution.plan.steps
        plan = [("plan", "", ""), *((one.name, one.state.value, one.reason) for one in steps)]
        parts = [zones_svg(zones)] if zones else []
        if not self.solution.converged:
            parts.append(table_html([("not converged",), (self.solution.ending.value,)]))
        return "".join([*parts, table_html(quantity_cells(self.solution)), table_html(plan)])


def look_at(texts: Texts) -> Look:
    """Solve the scene of a state and return what is to be shown of it."""
    try:
        scene = scene_of(texts)
        rtol = _rtol(texts)
        start = perf_counter()
        solution = solve(scene, rtol, strict=False, progress=False)
        seconds = perf_counter() - start
    except SpectralContactError as error:
        return Look(complaint=str(error))
    unknowns = sum(step.unknowns for step in solution.work.steps)
    columns, limits = _drawn(solution)
    cost = f"solved in {1e3 * seconds:.3g} ms, {unknowns:,} unknowns, rtol = {rtol:g}"
    return Look("", solution, columns, limits, cost, code_of(texts))


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
