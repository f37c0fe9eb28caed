"""Make the gold tables.

Run as ``python validation/gold/make_gold.py [--workers N] [--digits N] [table ...]``.

Writes one JSON file a table to validation/gold/tables, which is a link to
spectral_contact/gold/tables; docs/gold.md describes them. A table is written anew after every
scene, and scenes that are there, of this library's version and with as many digits, are kept: a run
that was stopped goes on. One scene takes half a minute to some minutes.

``--output FOLDER`` makes them again, in another folder, and says for every scene how its numbers
differ from those in the tables.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import math
import sys
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from time import perf_counter
from typing import Any

from mpmath import mp

from spectral_contact import ConvergenceError, Scene, __version__, layers, profiles
from spectral_contact.io.documents import replace_file
from spectral_contact.io.kinds import kind_tree
from spectral_contact.precise import reference
from spectral_contact.profiles import Profile
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.records import PROFILE_QUANTITIES
from spectral_contact.view.progress import ProgressLine

sys.path.insert(0, str(Path(__file__).parent))

import precise_unloading

TABLES = Path(__file__).parents[2] / "spectral_contact" / "gold" / "tables"
SCHEMA, VERSION, SCRIPT = "spectral_contact.gold", 1, "validation/gold/make_gold.py"
DIGITS = 27
LARGEST_ERROR = 1e-25
#: The first unloading takes two to five times as long, and fewer digits are asked for.
UNLOADED_DIGITS = 18
INF = math.inf


def sticking(*rows: tuple[float, ...], coupling: bool = False) -> list[Scene]:
    """Return scenes of ``(nu, alpha, beta)``, and of f where it is given, that stick throughout."""
    return [Scene(*(*row, INF)[:4], coupling=coupling) for row in rows]


def sliding(*rows: tuple[float, float, float, float]) -> list[Scene]:
    """Return scenes of ``(nu, alpha, beta, f / kappa)``."""
    return [Scene(nu, a, b, ratio * Scene(nu).kappa) for nu, a, b, ratio in rows]


def unloaded(*rows: tuple[float, float, float, float, float]) -> list[Scene]:
    """Return scenes of ``(nu, alpha, beta, f / kappa)`` and the load ratio."""
    scenes = sliding(*(row[:4] for row in rows))
    return [one.replace(unloaded_to=row[4]) for one, row in zip(scenes, rows, strict=True)]


def layered(*rows: tuple[layers.Layer, Profile, dict[str, float]]) -> list[Scene]:
    """Return scenes of a nonlinear layer, a profile and what is given of the contact."""
    return [Scene(0.3, layer=law, profile=shape, **given) for law, shape, given in rows]


def pressed(*rows: tuple[float, Profile, dict[str, float]]) -> list[Scene]:
    """Return scenes of a compliance, a profile and what is given of the contact."""
    return [Scene(0.3, alpha, profile=shape, **given) for alpha, shape, given in rows]


def sticky(*rows: tuple[float, float, Profile, dict[str, Any]]) -> list[Scene]:
    """Return scenes of a compliance, a work of adhesion, a profile and what is given."""
    return [
        Scene(0.3, alpha, profile=shape, work_of_adhesion=adhesion, **given)
        for alpha, adhesion, shape, given in rows
    ]


#: Slopes of polynomials: ``h = r**2 / 2 + r**4 / 8``; and a parabola that a steeper cone continues.
BALL = profiles.Parabola(1.0)
BOWL = profiles.Sampled((0.0, 2.0), ((2.25, 2.875, 0.75, 0.125),), rounded=True)
KINKED = profiles.Sampled((0.0, 0.5, 2.0), ((0.25, 0.25), (1.5,)), rounded=True)

#: The scenes by regime: what each table is about, and its scenes.
REGIMES: dict[str, tuple[str, list[Scene]]] = {
    "frictionless": (
        "no friction: normal contact alone",
        [
            Scene(0.3, 0.0),
            Scene(0.3, 1e-12),
            Scene(-0.5, 1e-9),
            Scene(0.0, 1e-6),
            Scene(0.2, 1e-4),
            Scene(-0.9, 0.01),
            Scene(0.3, 0.1),
            Scene(0.1, 0.5),
            Scene(0.45, 1.0),
            Scene(0.5, 10.0),
            Scene(0.3, 1e3),
            Scene(0.3, 1e6),
        ],
    ),
    "stick_equal": (
        "full stick, alpha = beta",
        sticking(
            (0.3, 0.0, 0.0),
            (-0.9, 1e-12, 1e-12),
            (0.3, 1e-6, 1e-6),
            (0.1, 1e-3, 1e-3),
            (0.1, 0.5, 0.5),
            (-0.5, 1.0, 1.0, 0.2),  # friction above the critical
            (0.45, 1e3, 1e3),
            (0.3, 1e6, 1e6),
        ),
    ),
    "stick_unequal": (
        "full stick, alpha and beta > 0 and unequal; finite friction is above the critical",
        sticking(
            (0.3, 1e-12, 1e6),
            (0.3, 1e6, 1e-12),
            (-0.5, 1e-6, 1.0),
            (0.0, 1.0, 1e-6),
            (-0.9, 1e-9, 1e-3),
            (0.2, 1e-3, 1e-9),
            (0.3, 0.2, 0.5, 0.085),
            (0.3, 0.05, 1.0),
        ),
    ),
    "stick_smooth_normal": (
        "full stick, alpha = 0 < beta; finite friction is above the critical",
        sticking(
            (0.3, 0.0, 1e-12),
            (-0.9, 0.0, 1e-6, 3.04),
            (0.1, 0.0, 0.01),
            (0.3, 0.0, 0.5),
            (0.2, 0.0, 1.0, 0.0475),
            (0.45, 0.0, 1e6),
        ),
    ),
    "stick_smooth_tangential": (
        "full stick, beta = 0 < alpha",
        sticking((0.3, 1e-12, 0.0), (-0.5, 1e-6, 0.0), (0.1, 0.5, 0.0), (0.3, 1e6, 0.0)),
    ),
    "slip_equal": (
        "slip outside a stick disk, alpha = beta",
        sliding(
            (0.3, 0.0, 0.0, 0.5),
            (-0.9, 0.0, 0.0, 2.0),
            (0.3, 1e-12, 1e-12, 1.0),
            (0.1, 1e-6, 1e-6, 0.5),
            (-0.5, 1e-3, 1e-3, 1.5),
            (0.3, 0.5, 0.5, 0.01),
            (0.1, 0.5, 0.5, 0.45),
            (-0.9, 1.0, 1.0, 0.3),
            (0.45, 1e3, 1e3, 2e-4),
            (0.3, 1e6, 1e6, 1e-7),
        ),
    ),
    "slip_unequal": (
        "slip outside a stick disk, alpha and beta > 0 and unequal",
        sliding(
            (0.3, 1e6, 1e-12, 0.1),
            (0.1, 1.0, 1e-6, 0.3),
            (-0.5, 1e-3, 1e-9, 0.5),
            (0.3, 1e-6, 1e-12, 1.0),
            (0.45, 0.5, 0.1, 0.5),
            (0.3, 0.2, 0.5, 0.3),
            (-0.9, 0.05, 1.0, 0.05),
            (0.1, 1e-3, 1.0, 0.01),
        ),
    ),
    "slip_smooth_tangential": (
        "slip outside a stick disk, beta = 0 < alpha",
        sliding(
            (0.3, 1e-12, 0.0, 1.0),
            (-0.5, 1e-6, 0.0, 0.3),
            (0.1, 1e-3, 0.0, 0.1),
            (-0.9, 0.5, 0.0, 0.03),
            (0.3, 0.5, 0.0, 1.0),
            (0.2, 1.0, 0.0, 3.0),
            (0.45, 1e3, 0.0, 0.5),
            (0.3, 1e6, 0.0, 0.2),
        ),
    ),
    "slip_begins": (
        "friction just below the critical: a narrow slip zone at the edge",
        [
            Scene(0.3, 0.5, 0.5, 0.101),
            Scene(0.3, 0.5, 0.5, 0.10101831),
            Scene(0.1, 1e-6, 1e-6, 2.036),
            Scene(-0.9, 1e3, 1e3, 0.000184171),
            Scene(0.45, 0.5, 0.1, 0.11057),
            Scene(0.0, 1.0, 1e-6, 263.7),
            Scene(0.3, 0.2, 0.5, 0.084),
        ],
    ),
    "slip_inside": (
        "slip in an interior annulus, alpha < beta: the edge sticks",
        [
            Scene(0.246, 0.2, 0.5, 0.1),  # the paper's example
            *sliding(
                (0.3, 0.05, 1.0, 0.23),
                (0.3, 0.05, 1.0, 0.2059),  # just before the edge slips
                (0.2, 1e-3, 1.0, 0.15),
                (-0.5, 1e-6, 0.01, 1.0),
                (-0.9, 0.0, 1e-3, 1.0),
                (0.1, 0.0, 0.5, 0.4),
                (0.45, 0.0, 10.0, 0.01),
            ),
        ],
    ),
    "coupled_equal": (
        "full stick with elastic coupling, alpha = beta; in thin layers the contact would open",
        sticking(
            (0.3, 1e-12, 1e-12),
            (0.0, 1e-9, 1e-9),
            (-0.5, 1e-6, 1e-6),
            (0.3, 1e-6, 1e-6),
            (0.0, 1e-3, 1e-3),
            (0.4999, 0.01, 0.01),
            (0.1, 0.5, 0.5),
            (0.3, 0.5, 0.5, 0.2),  # friction above the critical
            (-0.5, 1.0, 1.0),
            (0.45, 1e3, 1e3),
            coupling=True,
        ),
    ),
    "coupled_unequal": (
        "full stick with elastic coupling, alpha and beta > 0 and unequal",
        sticking(
            (0.0, 1e-12, 1e3),
            (-0.5, 1e3, 1e-12),
            (0.3, 1e-12, 1e-9),
            (0.1, 1e-9, 1e-3),
            (0.4999, 1e-3, 1e-9),
            (0.3, 1e-6, 1.0),
            (0.0, 1.0, 1e-6),
            (-0.5, 0.05, 1.0),
            (0.3, 0.2, 0.5),
            (0.45, 0.5, 0.1),
            coupling=True,
        ),
    ),
    "coupled_smooth": (
        "full stick with elastic coupling, alpha = 0 or beta = 0 or both",
        sticking(
            (0.3, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (-0.5, 0.0, 0.0),
            (0.4999, 0.0, 0.0),
            (0.3, 0.0, 1e-12),
            (-0.5, 0.0, 1e-6),
            (0.0, 0.0, 0.5),
            (0.45, 0.0, 1e3),
            (0.3, 1e-12, 0.0),
            (0.0, 1e-6, 0.0),
            (0.1, 0.5, 0.0),
            (-0.5, 1e3, 0.0),
            coupling=True,
        ),
    ),
    "profiles_smooth": (
        "normal contact under a profile on a smooth surface, by radius, load or approach",
        pressed(
            (0.0, profiles.Parabola(1.0), {"load": 2.0}),
            (0.0, profiles.Sphere(1.5), {"contact_radius": 1.0}),
            (0.0, profiles.Sphere(1.0), {"approach": 2.0}),
            (0.0, profiles.Cone(1.2), {"load": 1.0}),
            (0.0, profiles.PowerLaw(1.0, 1.1), {"contact_radius": 0.5}),
            (0.0, profiles.PowerLaw(0.3, 4.0), {"approach": 0.5}),
            (0.0, profiles.RoundedFlat(0.7, 1.0), {"load": 2.0}),
            (0.0, profiles.TruncatedCone(0.7, 1.0), {"contact_radius": 1.0}),
            (0.0, BOWL, {"load": 3.0}),
        ),
    ),
    "profiles_layer": (
        "normal contact under a profile on a layer, by radius, load or approach",
        pressed(
            (0.5, profiles.Parabola(1.0), {"contact_radius": 1.0}),
            (1e-12, profiles.Parabola(1.0), {"contact_radius": 1.0}),
            (1e-6, profiles.Parabola(2.0), {"load": 1.0}),
            (0.01, profiles.Parabola(1.0), {"approach": 1e-3}),
            (1e6, profiles.Parabola(1.0), {"load": 1e-3}),
            (0.1, profiles.Sphere(1.0), {"load": 3.0}),
            (1e-3, profiles.Sphere(1.5), {"approach": 0.8}),
            (0.5, profiles.Cone(math.pi / 4), {"contact_radius": 1.0}),
            (1e-4, profiles.Cone(1.2), {"load": 1.0}),
            (10.0, profiles.Cone(1.4), {"approach": 0.2}),
            (1e-3, profiles.PowerLaw(1.0, 1.5), {"contact_radius": 1.0}),
            (0.2, profiles.PowerLaw(0.3, 4.0), {"contact_radius": 1.0}),
            (0.01, BOWL, {"load": 3.0}),
        ),
    ),
    "profiles_corner": (
        "normal contact under a flat part with a corner or a rounded edge, on a layer",
        pressed(
            (0.1, profiles.RoundedFlat(0.9, 3.0), {"contact_radius": 1.0}),
            (1e-4, profiles.RoundedFlat(0.5, 1.0), {"contact_radius": 1.0}),
            (100.0, profiles.RoundedFlat(0.5, 1.0), {"contact_radius": 1.0}),
            (0.1, profiles.TruncatedCone(0.5, 1.0), {"contact_radius": 1.0}),
            (0.01, KINKED, {"contact_radius": 1.0}),
        ),
    ),
    "adhesion": (
        "contact with adhesion, on smooth surfaces and on layers, by radius, load or approach",
        sticky(
            (0.0, 1.0, BALL, {"contact_radius": 1.0}),
            (0.0, 0.1, BALL, {"load": 0.0}),
            (0.0, 0.1, BALL, {"load": -0.4, "branch": 1}),
            (0.0, 0.1, BALL, {"approach": -0.1}),
            (0.0, 0.1, profiles.Cone(1.2), {"load": -0.1}),
            (0.0, 0.1, profiles.PowerLaw(0.3, 4.0), {"approach": 0.1}),
            (0.0, 0.1, profiles.RoundedFlat(0.5, 2.0), {"contact_radius": 1.0}),
            (1.0, 1.0, BALL, {"contact_radius": 1.0}),
            (0.01, 0.1, BALL, {"contact_radius": 1.0}),
            (1e-6, 0.1, BALL, {"contact_radius": 1.0}),
            (1.0, 1.0, BALL, {"load": -3.0}),
            (0.1, 0.1, profiles.PowerLaw(0.3, 4.0), {"contact_radius": 1.0}),
        ),
    ),
    "layers_edge": (
        "normal contact through a nonlinear layer that begins at an overclosure",
        layered(
            (layers.PowerLaw(5.0, 2.0), BALL, {"contact_radius": 1.0}),
            (layers.PowerLaw(5.0, 2.0), BALL, {"load": 1.0}),
            (layers.PowerLaw(1e4, 1.5), BALL, {"approach": 0.5}),
            (layers.PowerLaw(0.1, 5.0), BALL, {"load": 0.1}),
            (layers.PowerLaw(2.0, 3.0), profiles.Sphere(1.5), {"contact_radius": 1.0}),
            (layers.Exponential(0.1, 0.2), BALL, {"load": 1.0}),
            (layers.Exponential(0.1, 0.2), BALL, {"approach": -0.1}),
            (layers.Exponential(1.0, 1e-3), profiles.PowerLaw(0.3, 4.0), {"contact_radius": 1.0}),
            (layers.Linear(0.5), BALL, {"load": 1.0}),
        ),
    ),
    "layers_flat": (
        "normal contact of a flat punch through a nonlinear layer",
        layered(
            (layers.PowerLaw(5.0, 2.0), profiles.Flat(1.0), {"load": 1.0}),
            (layers.PowerLaw(5.0, 2.0), profiles.Flat(2.0), {"approach": 0.5}),
            (layers.PowerLaw(1e5, 2.0), profiles.Flat(1.0), {"load": 3.0}),
            (layers.Exponential(0.1, 0.2), profiles.Flat(1.0), {"load": 0.05}),
            (layers.CalculixExponential(0.1, 0.2), profiles.Flat(1.5), {"load": 1.0}),
            (layers.CalculixExponential(0.1, 0.2), profiles.Flat(1.0), {"approach": -0.3}),
            (
                layers.GreenwoodWilliamson(9.0, 1.0, 0.5, "exponential"),
                profiles.Flat(1.0),
                {"approach": 1.0},
            ),
        ),
    ),
    "unloading": (
        "the first unloading: forward slip goes on, memory, slip back",
        unloaded(
            (0.1, 0.5, 0.5, 0.45, 0.8),
            (0.1, 0.5, 0.5, 0.45, 0.2205),  # the edge slips back
            (0.3, 0.2, 0.5, 0.3, 0.6),
            (0.3, 0.05, 1.0, 0.23, 0.7),  # two rings of forward slip
            (0.45, 0.5, 0.1, 0.5, 0.8),
            (-0.5, 1e-3, 1e-3, 1.5, 0.7),
            (0.1, 0.0, 0.5, 0.4, 0.5),
            (0.1, 1e-3, 1.0, 0.15, 0.6),
            (-0.9, 1.0, 1.0, 0.3, 0.999),  # just below the largest load
            (0.3, 0.2, 0.5, 0.6, 0.3),  # full stick
        ),
    ),
    "no_shear": (
        "friction 0, and an incompressible half-space: no traction",
        [Scene(0.3, 0.5, 0.5, 0.0), Scene(0.5, 1e-3, 0.5, 0.1)],
    ),
}


def named(scene: Scene) -> str:
    """Return the parameters as a name."""
    text = f"nu={scene.poisson_ratio:g} alpha={scene.normal_compliance:g}"
    if scene.profile is not None:
        given = {name: getattr(scene, name) for name in CONTROLS}
        told = " ".join(f"{name}={value:g}" for name, value in given.items() if value is not None)
        law = "" if scene.layer is None else f"{scene.layer.brief} "
        if scene.work_of_adhesion is not None:
            law = f"w={scene.work_of_adhesion:g} branch={scene.branch} "
        return f"{text} {law}{scene.profile.brief} {told}"
    if scene.friction is None:
        return text
    text += f" beta={scene.tangential_compliance:g} f={scene.friction:.9g}"
    if scene.unloaded_to < 1.0:
        text += f" unloaded_to={scene.unloaded_to:g}"
    return f"{text} coupled" if scene.coupling else text


def depths(solution: Any) -> list[float]:
    """Return distances to the edge: decades, eighths, the edge, and around zone boundaries."""
    found = {0.0, *(k / 8 for k in range(1, 9)), *(float(f"1e-{k}") for k in range(1, 13))}
    for zone in solution.zones[:-1]:
        odds = zone.outer_from_edge / zone.outer
        found |= {float(odds * k / (1 + odds * k)) for k in (0.5, 0.9, 1.1, 2)}
    if solution.scene.couples and mp.isnan(solution.pressure(from_edge=0.0)):
        found.remove(0.0)  # where the fields have no limit
    return sorted(found, reverse=True)


def double(value: float | None) -> Any:
    """Return an input: hexadecimal for exactness, decimal for reading."""
    return None if value is None else {"hex": value.hex(), "decimal": repr(value)}


def inputs(scene: Scene) -> dict[str, Any]:
    """Return what a scene is made of; coupling only where it is."""
    names = "poisson_ratio", "normal_compliance", "tangential_compliance", "friction"
    values = {name: double(getattr(scene, name)) for name in names}
    if scene.profile is not None:
        given = {name: double(getattr(scene, name)) for name in CONTROLS}
        law: dict[str, Any] = {} if scene.layer is None else {"layer": kind_tree(scene.layer)}
        if scene.work_of_adhesion is not None:
            law = {"work_of_adhesion": double(scene.work_of_adhesion), "branch": scene.branch}
        return {**values, "profile": kind_tree(scene.profile), **law, **given}
    if scene.unloaded_to < 1.0:
        values["unloaded_to"] = double(scene.unloaded_to)
    return {**values, "coupling": True} if scene.coupling else values


def digits_of(scene: Scene, digits: int) -> int:
    """Return how many of the digits asked for are computed."""
    return min(digits, UNLOADED_DIGITS) if scene.unloaded_to < 1.0 else digits


def solved(scene: Scene, digits: int) -> dict[str, Any]:
    """Return the entry of a scene; of the first unloading with `UNLOADED_DIGITS` at most."""
    unloaded_below = scene.unloaded_to < 1.0
    digits = digits_of(scene, digits)
    try:
        solution = (precise_unloading.reference if unloaded_below else reference)(scene, digits)
    except ConvergenceError as error:  # some digits less may do
        solution = error.solution
        if solution is None:
            raise

    def text(value: Any) -> str | None:
        if value is None or mp.isinf(value):
            return None if value is None else str(float(value))
        return mp.nstr(value, digits + 3, strip_zeros=False) if value else "0"

    at = depths(solution)
    pressure, traction = solution.pressure(from_edge=at), solution.traction(from_edge=at)
    error = solution.error
    errors = {
        name: getattr(error, name)
        for name in ("approach", "total_shear", "zones", "edge_ratio", "pressure", "traction")
    }
    pressed = PROFILE_QUANTITIES if scene.profile is not None else ()
    errors |= {name: getattr(error, name) for name in pressed}
    if scene.friction is None:  # zeros by definition, and no zones
        errors |= {"total_shear": 0.0, "zones": 0.0, "traction": 0.0}
    worst = max(e for e in errors.values() if e is not None)
    if not worst <= (10.0**-digits if unloaded_below else LARGEST_ERROR):
        raise ConvergenceError(f"the error is {worst:.1e}", "leave the scene out")
    sides = "inner", "outer", "inner_from_edge", "outer_from_edge"
    coupled = {"opening": text(solution.opening)} if scene.coupling else {}
    return {
        "name": named(scene),
        "scene": inputs(scene),
        "library": __version__,
        "digits": digits,
        "approach": text(solution.approach),
        "total_shear": text(solution.total_shear),
        "zones": [
            {"kind": zone.kind}
            | {side: text(getattr(zone, side)) for side in sides}
            | ({"sense": zone.sense, "memory": zone.memory} if unloaded_below else {})
            for zone in solution.zones
        ],
        "edge_ratio": text(solution.edge_ratio),
        **coupled,
        **{name: text(getattr(solution, name)) for name in pressed},
        "points": [
            {"from_edge": double(e), "pressure": text(p), "traction": text(q)}
            for e, p, q in zip(at, pressure, traction, strict=True)
        ],
        "error": errors,
    }


def layout(value: Any, indent: str = "") -> str:
    """Return JSON text in which what fits a line is one."""
    text = json.dumps(value, allow_nan=False)
    if not isinstance(value, (dict, list)) or len(text) <= 240:
        return text
    more = indent + " "
    if isinstance(value, dict):
        lines = [f"{more}{json.dumps(key)}: {layout(item, more)}" for key, item in value.items()]
    else:
        lines = [more + layout(item, more) for item in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{opening}\n" + ",\n".join(lines) + f"\n{indent}{closing}"


def numbers(entry: dict[str, Any]) -> list[tuple[float, Any]]:
    """Return the numbers of an entry with the relative error of their kind."""
    error, sides = entry["error"], ("inner", "outer", "inner_from_edge", "outer_from_edge")
    found = [(error[name], entry[name]) for name in ("approach", "total_shear", "edge_ratio")]
    found += [(error[name], entry[name]) for name in PROFILE_QUANTITIES if name in entry]
    found += [(error["zones"], zone[side]) for zone in entry["zones"] for side in sides]
    for point in entry["points"]:
        found += [(error[name], point[name]) for name in ("pressure", "traction")]
    return [(size, value) for size, value in found if value is not None]


def difference(entry: dict[str, Any], other: dict[str, Any] | None) -> str:
    """Return in words how two entries of a scene differ."""
    if other is None:
        return "new"
    kinds = [[zone["kind"] for zone in one["zones"]] for one in (entry, other)]
    mine, its = numbers(entry), numbers(other)
    places = [[point["from_edge"]["hex"] for point in one["points"]] for one in (entry, other)]
    if kinds[0] != kinds[1] or places[0] != places[1] or len(mine) != len(its):
        return "OTHER ZONES OR PLACES"
    worst, limit = mp.zero, mp.zero
    with mp.workdps(60):
        for (size, a), (other_size, b) in zip(mine, its, strict=True):
            if a != b:
                shift = abs(mp.mpf(a) / mp.mpf(b) - 1) if mp.mpf(b) else mp.inf
                worst, limit = max(worst, shift), max(limit, shift / (size + other_size))
    return f"off by {float(worst):.0e}, {float(limit):.1g} of the errors"


class Table:
    """One file."""

    def __init__(self, name: str, folder: Path = TABLES) -> None:
        self.path = folder / f"{name}.json"
        self.regime, self.scenes = REGIMES[name]
        self.entries: dict[str, dict[str, Any]] = {}
        if self.path.exists():
            document = json.loads(self.path.read_text(encoding="utf-8"))
            if document["version"] == VERSION:
                self.entries = {entry["name"]: entry for entry in document["scenes"]}

    def missing(self, digits: int) -> list[Scene]:
        """Return the scenes that have to be solved."""

        def there(scene: Scene) -> bool:
            entry = self.entries.get(named(scene))
            return (
                entry is not None
                and entry["library"] == __version__
                and entry["digits"] >= digits_of(scene, digits)
                and entry["scene"] == inputs(scene)
            )

        return [scene for scene in self.scenes if not there(scene)]

    def write(self, entry: dict[str, Any]) -> None:
        """Add an entry; the file is complete or as it was before."""
        self.entries[entry["name"]] = entry
        names = [named(scene) for scene in self.scenes]
        document = {
            "schema": SCHEMA,
            "version": VERSION,
            "table": self.path.stem,
            "regime": self.regime,
            "script": SCRIPT,
            "scenes": [self.entries[name] for name in names if name in self.entries],
        }
        replace_file(str(self.path), (layout(document) + "\n").encode())


def ready(running: dict[Future[Any], tuple[Table, Scene]], count: int) -> set[Future[Any]]:
    """Wait for a scene, and return those that are solved; a line says what is worked at."""
    with ProgressLine(None) as tell:
        while not (found := wait(running, 1.0, FIRST_COMPLETED).done):
            now = [named(scene) for one, (_, scene) in running.items() if one.running()]
            tell("; ".join(now), 1.0 - len(running) / count)
    return found


def results(todo: list[tuple[Table, Scene]], digits: int, workers: int) -> Iterator[Any]:
    """Yield tables and scenes with their entries, or with what was raised, as they are ready."""
    pool = ProcessPoolExecutor(workers)
    try:
        running = {pool.submit(solved, scene, digits): (table, scene) for table, scene in todo}
        while running:
            for future in ready(running, len(todo)):
                yield *running.pop(future), future.exception() or future.result()
    finally:  # of an interrupt, too
        pool.shutdown(cancel_futures=True)


def main() -> int:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description="Make the gold tables.")
    parser.add_argument("tables", nargs="*", help=f"of {', '.join(REGIMES)}; default: all")
    parser.add_argument("--digits", type=int, default=DIGITS, help="asked for, 26 and more")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--output", type=Path, default=TABLES, help="folder; default: the tables")
    options = parser.parse_args()
    if unknown := set(options.tables) - set(REGIMES):
        parser.error(f"no such table: {', '.join(sorted(unknown))}")
    options.output.mkdir(parents=True, exist_ok=True)
    tables = [Table(name, options.output) for name in options.tables or REGIMES]
    todo = [(table, scene) for table in tables for scene in table.missing(options.digits)]
    count = sum(len(table.scenes) for table in tables)
    done, failed, begin = count - len(todo), 0, perf_counter()
    print(f"{done} of {count} scenes are there", file=sys.stderr)
    for table, scene, outcome in results(todo, options.digits, options.workers):
        done += 1
        if isinstance(outcome, dict):
            before = Table(table.path.stem).entries.get(outcome["name"])
            told = f"{max(e for e in outcome['error'].values() if e is not None):.0e}, "
            told += difference(outcome, before)
            table.write(outcome)
        else:
            failed += 1
            told = f"LEFT OUT, {type(outcome).__name__}: {outcome}"
        line = f"{done}/{count} {perf_counter() - begin:6.0f} s  {table.path.stem}: {named(scene)}"
        print(f"{line}  {told}", file=sys.stderr, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
