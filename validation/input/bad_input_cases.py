"""Bad inputs for the Python interface, made at random: see bad_inputs.py, which runs them."""

from __future__ import annotations

import itertools
import math
import numbers
import string
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import date, datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import mpmath
import numpy as np

from spectral_contact import (
    QUANTITIES,
    NotComputedError,
    PhysicalData,
    Scene,
    SceneError,
    Solution,
    SolutionFileError,
    closed_forms,
    plan,
    solve,
)

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
    nan = math.nan
    return pick(
        rng,
        [
            *(nan, np.float64(nan), np.float32(nan), np.float16(nan), np.longdouble(nan)),
            *(
                mpmath.mpf("nan"),
                mpmath.mpc(x, 0),
                complex(x, 0),
                complex(nan, 1),
                np.complex128(x),
            ),
            *(str(x), "", "nan", "\n", "a\nb", text(rng), np.str_(x), b"", str(x).encode()),
            *(bytearray(b"1"), memoryview(b"1"), True, False, np.True_, np.False_),
            *(Decimal(x), Decimal("nan"), Decimal("sNaN"), Decimal("inf")),
            *(date(2020, 1, 1), datetime(2020, 1, 1), timedelta(seconds=x)),
            *(np.datetime64("2020-01-01"), np.timedelta64(1, "s"), np.datetime64("NaT", "s")),
            *({}, {"s": x}, {x}, frozenset(), object(), object, Broken(), Broken),
            *(lambda: x, iter(()), (x for _ in ()), Ellipsis, NotImplemented, math, slice(1)),
            *(np.void(b"12"), np.ma.masked, np.dtype(float), np.array("a"), np.array(None)),
            *(np.zeros(1, dtype=[("a", float)])[0], Exception("x")),
        ],
    )


def collection(rng: Rng) -> Any:
    """Return numbers that could be good ones, in what is not a number."""
    x = rng.random(int(rng.integers(5)))
    return pick(rng, [x, x.tolist(), tuple(x), np.array(x.sum()), np.float32(x), range(2), [[]]])


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
        "max_unknowns": [0, 0.5, 1.0, 20.5, math.inf],
    }
    negative = [] if name == "poisson_ratio" else [-size]
    if name not in ("max_unknowns", "friction") and rng.random() < 0.15:
        return huge(rng)
    return wrapped(rng, float(pick(rng, [*limits[name], *negative, -math.inf, math.nan])))


def bad(rng: Rng, name: str, none_is_bad: bool = True) -> Any:
    """Return anything that must be refused where a number of an interval belongs."""
    kind = rng.random()
    if kind < 0.45:
        return outside(rng, name)
    if kind < 0.9:
        return junk(rng)
    return None if none_is_bad and kind < 0.92 else collection(rng)


# --- groups ---------------------------------------------------------------------------------------


def good_scene(rng: Rng) -> dict[str, Any]:
    """Return arguments of a dimensionless scene."""
    alpha, beta = (float(10.0 ** rng.uniform(-13, 13)) for _ in range(2))
    friction = pick(rng, [None, 0.0, float(rng.random()), math.inf])
    return {
        "poisson_ratio": float(rng.uniform(-0.99, 0.5)),
        "normal_compliance": alpha * pick(rng, [0, 1, 1]),
        "tangential_compliance": beta * pick(rng, [0, 1, 1]),
        "friction": friction,
    }


STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013, "load": 1e3}
SCENE_RANGES = {
    "poisson_ratio": "poisson_ratio",
    "normal_compliance": "star",
    "tangential_compliance": "star",
    "friction": "friction",
}
SI_RANGES = {
    "poisson_ratio": "poisson_ratio",
    **dict.fromkeys(("youngs_modulus", "radius", "load", "approach"), "positive"),
    **dict.fromkeys(("normal_compliance", "tangential_compliance"), "si"),
    "friction": "friction",
}


def scene_case(rng: Rng, bench: Bench) -> Case:
    """Return a scene with one bad parameter, made, changed or read."""
    good = good_scene(rng)
    name = pick(rng, [*SCENE_RANGES, "physical"])
    if name == "physical":
        value = pick(rng, [junk(rng), STEEL, PhysicalData, good["poisson_ratio"]])
        if rng.random() < 0.3:  # right by type, and of another scene
            value = PhysicalData(
                youngs_modulus=1e9, radius=0.1, load=1.0, normal_compliance=float(rng.random())
            )
            return Case("physical of another scene", lambda: Scene(0.3, 0.25, physical=value))
    else:
        value = bad(rng, SCENE_RANGES[name], none_is_bad=name != "friction")
    arguments = {**good, name: value}
    way = pick(rng, ["Scene", "replace", "from_dict"])
    if way == "Scene":
        call = partial(Scene, **arguments)
    elif way == "replace":
        call = partial(replace, Scene(**good), **{name: value})
    else:
        call = partial(Scene.from_dict, {**Scene(**good).to_dict(), name: value})
    errors = (SceneError, SolutionFileError) if way == "from_dict" else (SceneError,)
    return Case(f"{way}, {name}", call, errors, name)


def physical_case(rng: Rng, bench: Bench) -> Case:
    """Return SI data with one bad parameter."""
    arguments: dict[str, Any] = {**STEEL, "normal_compliance": 1e-13, "friction": 0.1}
    if rng.random() < 0.5:
        arguments["approach"] = arguments.pop("load") * 1e-9
    name = pick(rng, [*SI_RANGES, "both", "neither"])
    given = "load" if "load" in arguments else "approach"
    if name == "both":
        arguments.update(load=pick(rng, [1.0, junk(rng)]), approach=pick(rng, [1.0, junk(rng)]))
    elif name == "neither":
        del arguments[given]
    else:
        name = given if name in ("load", "approach") else name
        none_is_bad = name != "friction"
        arguments[name] = bad(rng, SI_RANGES[name], none_is_bad)
    names = "load, approach" if name in ("both", "neither") else name
    if names == given and arguments[given] is None:
        names = "load, approach"
    make: Any = Scene.from_physical
    if rng.random() < 0.3 and name not in ("poisson_ratio", "friction", "normal_compliance"):
        make = PhysicalData
        for key in ("poisson_ratio", "friction", "tangential_compliance"):
            arguments.pop(key, None)
        if name == "tangential_compliance":
            arguments[name] = bad(rng, "friction")
    return Case(f"{make.__name__}, {name}", partial(make, **arguments), names=names)


def bad_quantities(rng: Rng) -> Any:
    """Return what is no list of quantities."""
    names = [*QUANTITIES[: int(rng.integers(4))], pick(rng, [text(rng), "Approach", junk(rng), 1])]
    return pick(
        rng,
        [
            *("approach", b"approach", 1, 2.5, True, object(), math.nan, {1: 2}),
            *(names, tuple(names), iter(names), [["approach"]], [None]),
            *(
                itertools.count(),
                itertools.cycle(("approach", "zone")),
                np.array([1.0, 2.0]),
                np.array(1),
            ),
        ],
    )


def request_case(rng: Rng, bench: Bench) -> Case:
    """Return a solve or a plan with one bad argument."""
    scene = pick(rng, [one.scene for one in bench.solutions])
    name = pick(rng, ["scene", "rtol", "quantities", "max_unknowns", "strict", "tight rtol"])
    arguments: dict[str, Any] = {"scene": scene}
    if name == "scene":
        arguments["scene"] = pick(rng, [junk(rng), None, Scene, scene.to_dict(), scene.to_json()])
    elif name == "rtol":
        arguments["rtol"] = bad(rng, "rtol")
    elif name == "tight rtol":  # only integral quantities may be had at this
        name, arguments["rtol"] = "rtol", float(rng.uniform(1e-13, 9.9e-13))
        arguments["quantities"] = pick(rng, [None, ["pressure"], ["approach", "zones"]])
    elif name == "quantities":
        arguments["quantities"] = bad_quantities(rng)
    elif name == "max_unknowns":
        value = bad(rng, "max_unknowns")
        # a whole number of at least 1 is a good one
        good = isinstance(value, numbers.Integral) and type(value) is int and value > 0
        arguments[name] = 0 if good else value
    else:
        value = pick(rng, [junk(rng), collection(rng), None, 0, 1, 1.0])
        arguments[name] = "no" if isinstance(value, (bool, np.bool_)) else value
    planned = name in ("scene", "quantities") and rng.random() < 0.5
    call = partial(plan if planned else solve, **arguments)
    return Case(f"{'plan' if planned else 'solve'}, {name}", call, names=name)


def bad_radii(rng: Rng, high: float) -> Any:
    """Return what are no radii of [0, high]."""
    kind = rng.random()
    if kind < 0.25:
        return outside(rng, "s")
    if kind < 0.5:
        return junk(rng)
    shape = tuple(rng.integers(1, 4, int(rng.integers(1, 4))))
    good = high * rng.random(shape)
    if kind < 0.65:  # one of many is outside
        good.flat[int(rng.integers(good.size))] = pick(rng, [math.nan, -1e-9, 1.5, math.inf, -1e30])
        return pick(rng, [good, good.tolist(), good.astype(np.float32), good[::-1], [good]])
    if kind < 0.8:  # one of many is no number
        mixed = good.astype(object)
        mixed.flat[int(rng.integers(good.size))] = pick(rng, [None, True, "0.5", 0.5j, junk(rng)])
        return pick(rng, [mixed, mixed.tolist()])
    endless: list[Any] = []
    endless.append(endless)
    masked = np.ma.masked_array(good, mask=True)
    complex_, strings = good.astype(complex), good.astype(str)
    ragged = [[0.0], [0.0, 0.0]]
    return pick(rng, [masked, complex_, strings, ragged, [0.0, ragged], endless, good > high / 2])


def evaluation_case(rng: Rng, bench: Bench) -> Case:
    """Return an evaluation of a field at bad radii, dimensionless or SI."""
    solution = pick(rng, bench.solutions)
    field = pick(
        rng, [q for q in ("pressure", "traction", "slip") if q in solution.plan.quantities]
    )
    subject, inside, high = solution, "s", 1.0
    if solution.scene.physical is not None and rng.random() < 0.7:
        subject, inside, high = solution.physical, "r", solution.scene.physical.radius
    kind, missing = rng.random(), [q for q in QUANTITIES if q not in solution.plan.quantities]
    if kind < 0.03 and missing:
        name = pick(rng, missing)
        if name in ("pressure", "traction", "slip"):
            return Case(
                f"missing {name}", partial(getattr(subject, name), 0.0), (NotComputedError,)
            )
        return Case(f"missing {name}", lambda: getattr(subject, name), (NotComputedError,))
    evaluate = partial(getattr(subject, field))
    if kind < 0.1:
        both = {inside: pick(rng, [0.0, junk(rng)]), "from_edge": pick(rng, [0.0, junk(rng)])}
        given = pick(rng, [{}, both, {inside: None, "from_edge": None}])
        return Case("both or neither radius", partial(evaluate, **given), names=inside)
    name = pick(rng, [inside, "from_edge"])
    value = bad_radii(rng, high)
    return Case(f"{field}, {name}", partial(evaluate, **{name: value}), names=name)


CLOSED_FORMS = {
    "poisson_ratio": (
        closed_forms.full_stick_shear,
        closed_forms.coupled_approach,
        partial(closed_forms.coupled_pressure, s=0.5),
        partial(closed_forms.stick_radius, friction=0.1),
    ),
    "friction": (
        partial(closed_forms.stick_radius, 0.3),
        partial(closed_forms.slip_displacement, 0.3, s=0.5),
    ),
    "normal_compliance": (
        closed_forms.approach_large_compliance,
        closed_forms.edge_pressure_small_compliance,
    ),
    "degree": (partial(closed_forms.eigenvalue, order=1),),
    "s": (
        closed_forms.smooth_pressure,
        partial(closed_forms.partial_slip_traction, 0.3, 0.1),
        partial(closed_forms.coupled_traction, 0.3),
        partial(closed_forms.eigenfunction, 2, 0),
    ),
}
CLOSED_RANGES = {"normal_compliance": "positive", "degree": "max_unknowns"}


def closed_form_case(rng: Rng, bench: Bench) -> Case:
    """Return an evaluation of an exact solution with one bad argument."""
    name = pick(rng, [*CLOSED_FORMS])
    function = pick(rng, CLOSED_FORMS[name])
    if name == "s":
        name = pick(rng, ["s", "from_edge"])
        value = bad_radii(rng, 1.0)
    else:
        value = bad(rng, CLOSED_RANGES.get(name, name))
        value = 2 if name == "degree" and type(value) is int else value  # odd ones are good
    call = partial(function, **{name: value})
    return Case(f"closed form, {name}", call, (ValueError,), name)
