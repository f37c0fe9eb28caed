"""Numbers out of range for the Python interface, drawn at random: bad_inputs.py runs them.

What is no number, no list or no scene by its type is in the pool of bad_input_callables.py.
"""

from __future__ import annotations

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

from spectral_contact import Scene, SceneError, Solution, closed_forms, solve

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


def outside(rng: Rng, name: str) -> Any:
    """Return a real number that a parameter must not have."""
    small, size = float(10.0 ** rng.uniform(-12, 0)), positive(rng)
    limits: dict[str, list[float]] = {
        "poisson_ratio": [-1.0, 0.5 + small, -1.0 - small, math.nextafter(0.5, 1.0), size + 1.0],
        "star": [1e-15 * small, 1e15 / small, math.nextafter(1e-14, 0.0), 5e-324, math.inf],
        "positive": [0.0, -0.0, math.inf, -small],
        "friction": [-small, -5e-324],
        "si": [math.inf, -small, 1e-308 * small, 1e200 / small],
        "s": [1.0 + small, math.nextafter(1.0, 2.0), -small, 2.0 + size, math.inf, -5e-324],
        "rtol": [0.0, 1e-14, 1e-13 * (1 - small), 1e-2 * (1 + small), 1.0 + size, math.inf],
        "max_unknowns": [0, 0.5, 20.5, math.inf],
    }
    negative = [] if name == "poisson_ratio" else [-size]
    if name not in ("max_unknowns", "friction") and rng.random() < 0.15:
        return huge(rng)
    return wrapped(rng, float(pick(rng, [*limits[name], *negative, -math.inf, math.nan])))


#: By the name of a parameter, its range: a key of `outside`.
SCENE_RANGES = {
    "poisson_ratio": "poisson_ratio",
    "normal_compliance": "star",
    "tangential_compliance": "star",
    "friction": "friction",
}
SI_RANGES = {
    "poisson_ratio": "poisson_ratio",
    **dict.fromkeys(("youngs_modulus", "radius", "load"), "positive"),
    **dict.fromkeys(("normal_compliance", "tangential_compliance"), "si"),
    "friction": "friction",
}
SOLVE_RANGES = {"rtol": "rtol", "max_unknowns": "max_unknowns"}
CLOSED_FORMS = (
    (closed_forms.full_stick_shear, "poisson_ratio", "poisson_ratio"),
    (closed_forms.coupled_approach, "poisson_ratio", "poisson_ratio"),
    (partial(closed_forms.stick_radius, 0.3), "friction", "friction"),
    (closed_forms.approach_large_compliance, "normal_compliance", "positive"),
    (closed_forms.edge_pressure_small_compliance, "normal_compliance", "positive"),
    (closed_forms.smooth_pressure, "s", "s"),
    (partial(closed_forms.partial_slip_traction, 0.3, 0.1), "from_edge", "s"),
    (partial(closed_forms.eigenfunction, 2, 0), "s", "s"),
)
GOOD = {"poisson_ratio": 0.3, "normal_compliance": 0.5, "tangential_compliance": 0.1}
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013, "load": 1e3}


def ranges(bench: Bench) -> list[tuple[Callable[..., Any], str, str]]:
    """Return callables with a parameter of each and its range."""
    scene = Scene(**GOOD)
    found = [(partial(Scene, **GOOD), *one) for one in SCENE_RANGES.items()]
    found += [(scene.replace, *one) for one in SCENE_RANGES.items()]
    found += [(partial(Scene.from_physical, **STEEL), *one) for one in SI_RANGES.items()]
    found += [(partial(solve, scene), *one) for one in SOLVE_RANGES.items()]
    for solution in bench.solutions:
        fields = [q for q in ("pressure", "traction", "slip") if q in solution.plan.quantities]
        found += [(getattr(solution, q), name, "s") for q in fields for name in ("s", "from_edge")]
    return [*found, *CLOSED_FORMS]


def range_case(rng: Rng, bench: Bench) -> Case:
    """Return a call with a number out of range; of radii it may be one of many."""
    function, name, kind = pick(rng, ranges(bench))
    value = outside(rng, kind)
    if kind == "s" and rng.random() < 0.5:
        several = rng.random(tuple(rng.integers(1, 4, int(rng.integers(1, 4)))))
        several.flat[int(rng.integers(several.size))] = pick(rng, [math.nan, -1e-9, 1.5, math.inf])
        value = pick(rng, [several, several.tolist(), several.astype(np.float32), several[::-1]])
    inner = function.func if isinstance(function, partial) else function
    # the closed forms share no code with the library, not even its errors
    errors = (ValueError,) if "closed_forms" in inner.__module__ else (SceneError,)
    return Case(f"{inner.__qualname__}, {name}", partial(function, **{name: value}), errors, name)
