"""The state of the explorer: its knobs, its link, its scene and Python lines. No browser here.

It is text by name, as in the query of a link. What is absent is not modelled, as in a `Scene`;
whatever the text says, `scene_of` makes a scene of it or says why not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final
from urllib.parse import parse_qsl, urlencode

from spectral_contact.errors import SceneError
from spectral_contact.io.choices import instance, one_of
from spectral_contact.io.physical_data import checked_poisson_ratio
from spectral_contact.layers.scene_layer import refuse_layer
from spectral_contact.profiles import Profile
from spectral_contact.profiles.control import CONTROLS, KINDS, SHAPES, refuse_unloaded
from spectral_contact.profiles.work_of_adhesion import refuse_adhesion
from spectral_contact.scene import Scene
from spectral_contact.solving.asked import checked_tolerance

Texts = Mapping[str, str]

#: The tolerance that nobody set.
RTOL: Final = "1e-8"
#: What is asked for, of which the pressure limits the tolerance.
_FIELDS: Final = ("pressure",)


#: The longest text of a parameter; the digits of a double are 17, and its shortest text has at most
#: 24 characters.
LONGEST_TEXT: Final = 100


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
        value = _parsed(text)
        if not isinstance(value, float) or math.isnan(value):
            value = self.low
        inside = min(max(value, self.low), self.high)
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


def texts_of(scene: Scene | None, rtol: float | None = None) -> dict[str, str]:
    """Return the state that shows a scene; None is the one to start with.

    Of a scene in SI units it is the dimensionless one. A layer is refused, and so is a profile that
    numbers do not describe.
    """
    told = {} if rtol is None else {"rtol": _text(checked_tolerance(rtol, _FIELDS))}
    if scene is None:
        return {name: KNOBS[name].start for name in FLAT} | told
    refuse_layer(instance("scene", scene, Scene), "explore")
    refuse_adhesion(scene, "explore")
    refuse_unloaded(scene, "explore")
    if scene.poisson_ratio is None or scene.mismatch is not None:
        allowed = "one with a Poisson's ratio and a rigid punch: explore has no kappa"
        raise SceneError("scene", scene, allowed)
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

    Names and choices have to be known. Numbers are not looked at: what is refused of them can be
    mended in the page.
    """
    told = dict(parse_qsl(query.removeprefix("?"), keep_blank_values=True))
    for name, text in told.items():
        check_length("the name of a parameter", name)
        one_of("the name of a parameter", name, _NAMES)
        check_length(name, text)
    for name, known in (("coupling", _YES_NO), ("profile", SHAPES)):
        if name in told:
            one_of(name, told[name], known)
    rtol_of(told)
    return {**texts_of(None), **told}


def query_of(texts: Texts) -> str:
    """Return the query of the link to a state."""
    return "?" + urlencode(texts)


def scene_of(texts: Texts) -> Scene:
    """Return the scene of a state; what is none, text that is no number too, is a `SceneError`."""
    values: dict[str, Any] = {name: _number(name, texts[name]) for name in FLAT if name in texts}
    if "poisson_ratio" in values:  # a scene may be without, the page has a slider for it
        values["poisson_ratio"] = checked_poisson_ratio(values["poisson_ratio"])
    if "coupling" in texts:
        values["coupling"] = _YES_NO[one_of("coupling", texts["coupling"], _YES_NO)]
    if "profile" in texts:
        kind = one_of("profile", texts["profile"], SHAPES)
        shape = {name: _number(name, texts.get(name, "")) for name in SHAPES[kind]}
        values["profile"] = KINDS[kind](**shape)
    values |= {name: _number(name, texts[name]) for name in CONTROLS if name in texts}
    return Scene(**values)


def code_of(texts: Texts) -> str:
    """Return Python lines that solve the scene of a state."""
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
    rtol = rtol_of(texts)
    return "\n".join(
        [*imports, "", "scene = Scene(", *given, ")", f"solution = solve(scene, rtol={rtol!r})"]
    )


def rtol_of(texts: Texts) -> float:
    """Return the tolerance of a state."""
    return checked_tolerance(_number("rtol", texts.get("rtol", RTOL)), _FIELDS)


def _text(value: float | None) -> str:
    return "none" if value is None else repr(value).removesuffix(".0")


def _number(name: str, text: str) -> float | str | None:
    """Return the number of a text; what is none stays text, for the library to refuse."""
    check_length(name, text)
    return _parsed(text)


def check_length(name: str, text: str) -> None:
    """Refuse a text that is longer than any number needs, before anything reads it."""
    if len(text) > LONGEST_TEXT:
        raise SceneError(name, text, f"at most {LONGEST_TEXT} characters long")


def _parsed(text: str) -> float | str | None:
    stripped = text.strip()
    if stripped.lower() == "none":
        return None
    try:
        return float(stripped)
    except ValueError:
        return text
