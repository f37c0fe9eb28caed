"""Numbers out of range for the Python interface, drawn at random: bad_inputs.py runs them.

Parameters and ranges are those that scenes, profiles and laws declare.

What is no number, no list or no scene by its type is in the pool of bad_input_callables.py.
"""

from __future__ import annotations

import itertools
import math
import string
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import mpmath
import numpy as np

from spectral_contact import Scene, SceneError, Solution, closed_forms, profiles, solve
from spectral_contact.io import checks
from spectral_contact.io.parameters import SCENE, SI, parameters_of
from spectral_contact.view.cli.scene_options import LAWS, PROFILES

Rng = np.random.Generator


class Broken:
    """Not a number, and every hook of it fails."""

    def _fail(self, *_: object, **__: object) -> Any:
        raise RuntimeError("broken on purpose")

    __float__ = __int__ = __index__ = __repr__ = __str__ = __array__ = __fspath__ = _fail
    __len__ = __iter__ = __getitem__ = __eq__ = __bool__ = _fail
    __hash__ = object.__hash__


@dataclass(frozen=True)
class Case:
    """One bad input: the call, the errors that are documented for it, and what they must name."""

    label: str
    call: Callable[[], Any]
    errors: tuple[type[Exception], ...] = (SceneError,)
    names: str = ""
    accept: Callable[[Any], bool] | None = None


@dataclass(frozen=True)
class Bench:
    """What the generators need: solutions to evaluate and damage, and a directory for files."""

    solutions: tuple[Solution, ...]
    folder: Path


def pick(rng: Rng, items: Any) -> Any:
    """Return one of the items, as it is."""
    return items[int(rng.integers(len(items)))]


def text(rng: Rng) -> str:
    """Return characters, line breaks and others that terminals take amiss among them."""
    alphabet = string.printable + "äΩ\u2028\x00\x1b\U0001f600\ud800"
    return "".join(pick(rng, alphabet) for _ in range(rng.integers(1, 20)))


# --- values that are no number, or not in the interval --------------------------------------------


def junk(rng: Rng) -> Any:
    """Return what is no real number by type, or NaN."""
    x = float(rng.random())
    return pick(
        rng,
        [
            *(math.nan, complex(x, 0), True, np.float32("nan"), mpmath.mpf("nan"), Decimal(x)),
            *(str(x), "", "a\nb", text(rng), b"", bytearray(b"1"), memoryview(b"1"), np.str_(x)),
            *({}, {"s": x}, {x}, object(), object, Broken(), Broken, lambda: x, iter(()), math),
            *(np.datetime64("NaT", "s"), np.void(b"12"), np.ma.masked, np.array(None), slice(1)),
        ],
    )


def wrapped(rng: Rng, number: float) -> Any:
    """Return the number as one of the types of real numbers."""
    kinds: list[Callable[[float], Any]] = [float, np.float64, np.longdouble, mpmath.mpf]
    if math.isfinite(number):
        kinds.append(Fraction)
        if number == int(number):
            kinds.append(int)
    return pick(rng, kinds)(number)


def huge(rng: Rng) -> Any:
    """Return a number beyond the doubles."""
    sign, power = int(pick(rng, [-1, 1])), int(rng.integers(310, 5000))
    kinds = [int, Fraction, np.longdouble] if power < 4900 else [int, Fraction]
    kind = pick(rng, kinds)
    return kind(f"{sign}e{power}") if kind is np.longdouble else kind(sign * 10**power)


def positive(rng: Rng) -> float:
    """Return a positive number of any magnitude."""
    return float(10.0 ** rng.uniform(-300, 300))


def outside(rng: Rng, allowed: str) -> float:
    """Return a double that a parameter must not have, by the words of its range."""
    if allowed == COUNT:
        return float(pick(rng, [0, 0.5, 20.5, math.inf, -math.inf, math.nan]))
    ends = {"low": -math.inf, "high": math.inf, "low_open": False, "high_open": False}
    ends |= checks._bounds(allowed)
    low, high = ends["low"], ends["high"]
    small, size = float(10.0 ** rng.uniform(-12, 0)), positive(rng)
    values = [math.nan, -math.inf] + [math.inf] * (not ends["infinite_ok"])
    if low > -math.inf:
        values += [math.nextafter(low, -math.inf), low - size - small] + [low] * ends["low_open"]
        values += [low * small] * (low > 0.0)
    if high < math.inf:
        values += [math.nextafter(high, math.inf), high * (1.0 + small) + size]
        values += [high] * ends["high_open"]
    return float(pick(rng, values))


#: Ranges that no parameter declares: of radii, tolerances and counts.
RADII, TOLERANCE, COUNT = "in [0, 1]", "in [1e-13, 1e-2]", "a whole number > 0"
CLOSED_FORMS = (
    (closed_forms.full_stick_shear, "poisson_ratio", "in (-1, 0.5]"),
    (closed_forms.coupled_approach, "poisson_ratio", "in (-1, 0.5]"),
    (partial(closed_forms.stick_radius, 0.3), "friction", SCENE["friction"].allowed),
    (closed_forms.approach_large_compliance, "normal_compliance", "finite and > 0"),
    (closed_forms.edge_pressure_small_compliance, "normal_compliance", "finite and > 0"),
    (closed_forms.smooth_pressure, "s", RADII),
    (partial(closed_forms.partial_slip_traction, 0.3, 0.1), "from_edge", RADII),
    (partial(closed_forms.eigenfunction, 2, 0), "s", RADII),
)
#: Good scenes: of a flat punch, in SI units, and of a ball with and without adhesion.
GOOD = {"poisson_ratio": 0.3, "normal_compliance": 0.5, "tangential_compliance": 0.1}
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013, "load": 1e3}
BALL = {"poisson_ratio": 0.3, "profile": profiles.Parabola(1.0)}
#: Which of their parameters are looked at.
FLAT = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")
IN_SI = SCENE | SI
PHYSICAL = (*STEEL, "normal_compliance", "tangential_compliance", "friction")
#: Good numbers of profiles and laws.
NUMBERS = {
    **{"radius": 1.0, "half_angle": 0.8, "flat_radius": 0.5, "coefficient": 0.4, "exponent": 2.0},
    **{"compliance": 0.5, "zero_pressure": 1.0, "clearance": 0.1},
    **{"density": 10.0, "tip_radius": 1.0, "height_deviation": 0.5},
}


def ranges(bench: Bench) -> list[tuple[Callable[..., Any], str, str]]:
    """Return callables with a parameter of each, and its range in words."""
    scene = Scene(**GOOD)
    found: list[tuple[Callable[..., Any], str, str]] = []
    for function, names in (
        (partial(Scene, **GOOD), FLAT),
        (scene.replace, FLAT),
        (partial(Scene, **GOOD, friction=0.1), ("unloaded_to",)),
        (Scene.from_kappa, ("kappa",)),
        (partial(Scene, **BALL), ("contact_radius", "load", "approach")),
        (partial(Scene, **BALL, load=0.0), ("work_of_adhesion",)),
    ):
        found += [(function, name, SCENE[name].allowed) for name in names]
    physical = partial(Scene.from_physical, **STEEL)
    found += [(physical, name, IN_SI[name].allowed) for name in PHYSICAL]
    for kind in (*PROFILES.values(), *LAWS.values()):
        declared = {name: one.allowed for name, one in parameters_of(kind).items() if one.allowed}
        good = partial(kind, **{name: NUMBERS[name] for name in declared})
        found += [(good, *one) for one in declared.items()]
    solved = partial(solve, scene)
    found += [(solved, "rtol", TOLERANCE), (solved, "max_unknowns", COUNT)]
    for solution in bench.solutions:
        fields = [q for q in ("pressure", "traction", "slip") if q in solution.plan.quantities]
        places = itertools.product(fields, ("s", "from_edge"))
        found += [(getattr(solution, field), name, RADII) for field, name in places]
    return [*found, *CLOSED_FORMS]


def range_case(rng: Rng, bench: Bench) -> Case:
    """Return a call with a number out of range; of radii it may be one of many."""
    function, name, allowed = pick(rng, ranges(bench))
    value = wrapped(rng, outside(rng, allowed))
    if allowed != COUNT and not checks._bounds(allowed)["infinite_ok"] and rng.random() < 0.15:
        value = huge(rng)
    if allowed == RADII and rng.random() < 0.5:
        several = rng.random(tuple(rng.integers(1, 4, int(rng.integers(1, 4)))))
        several.flat[int(rng.integers(several.size))] = pick(rng, [math.nan, -1e-9, 1.5, math.inf])
        value = pick(rng, [several, several.tolist(), several.astype(np.float32), several[::-1]])
    inner = function.func if isinstance(function, partial) else function
    # the closed forms share no code with the library, not even its errors
    errors = (ValueError,) if "closed_forms" in inner.__module__ else (SceneError,)
    return Case(f"{inner.__qualname__}, {name}", partial(function, **{name: value}), errors, name)
