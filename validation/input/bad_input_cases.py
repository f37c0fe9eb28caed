"""Numbers out of range for the Python interface: bad_inputs.py runs them.

Parameters and ranges are those that scenes, profiles and laws declare. What is no number, no list
or no scene by its type is in the pool of bad_input_callables.py.
"""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
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

#: Good arguments.
GOOD = tomllib.loads(Path(__file__).with_name("good_arguments.toml").read_text(encoding="utf-8"))


class Broken:
    """Not a number, and every hook of it fails."""

    def _fail(self, *_: object, **__: object) -> Any:
        raise RuntimeError("broken on purpose")

    __float__ = __int__ = __index__ = __repr__ = __str__ = __array__ = __fspath__ = _fail
    __len__ = __iter__ = __getitem__ = __eq__ = __bool__ = _fail
    __hash__ = object.__hash__


@dataclass(frozen=True)
class Case:
    """One bad input.

    Attributes
    ----------
    label : str
        The callable, and in parentheses the parameter with the value.
    call : callable
    errors : tuple of type
        The errors that are documented for it.
    names : str
        The parameter that the error must name; none if empty.
    may_pass : bool
        Whether a result is right, too.
    """

    label: str
    call: Callable[[], Any]
    errors: tuple[type[Exception], ...] = (SceneError,)
    names: str = ""
    may_pass: bool = False


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
#: Numbers beyond the doubles.
HUGE = (10**310, -(10**4000), Fraction(10**400, 3), np.longdouble("1e4000"))


def outside(allowed: str) -> list[float]:
    """Return doubles that a parameter must not have, by the words of its range."""
    if allowed == COUNT:
        return [0.0, -1.0, 0.5, 20.5, math.inf, -math.inf, math.nan]
    ends = {"low": -math.inf, "high": math.inf, "low_open": False, "high_open": False}
    ends |= checks._bounds(allowed)
    low, high = ends["low"], ends["high"]
    found = [math.nan, -math.inf]
    if not ends["infinite_ok"]:
        found.append(math.inf)
    if low > -math.inf:
        found += [math.nextafter(low, -math.inf), low - 1e-9, low - 1.0, low - 1e300]
    if low > 0.0:
        found += [low / 2.0, low * 1e-12]
    if high < math.inf:
        found += [math.nextafter(high, math.inf), high * (1.0 + 1e-9), 2.0 * high + 1.0, 1e300]
    found += [low] * ends["low_open"] + [high] * ends["high_open"]
    return found


def as_every_type(number: float) -> list[Any]:
    """Return the number as each of the types of real numbers that can hold it."""
    found = [number, np.float64(number), np.longdouble(number), mpmath.mpf(number)]
    if math.isfinite(number):
        found.append(Fraction(number))
        if number == int(number):
            found.append(int(number))
    return found


def among_good_ones(number: float) -> list[Any]:
    """Return arrays and lists of radii of which one is bad."""
    several = np.array([[0.25, 0.5], [0.75, number]])
    return [several, several.tolist(), several[::-1, 1]]


def ranges(solutions: tuple[Solution, ...]) -> list[tuple[Callable[..., Any], str, str]]:
    """Return callables with a parameter of each, and its range in words."""
    flat = partial(Scene, **GOOD["flat"])
    scene = flat()
    ball = partial(Scene, poisson_ratio=0.3, profile=profiles.Parabola(1.0))
    physical = partial(Scene.from_physical, **GOOD["steel"])
    compliances = ("normal_compliance", "tangential_compliance")
    found: list[tuple[Callable[..., Any], str, str]] = []
    for function, names in (
        (flat, (*GOOD["flat"], "friction")),
        (scene.replace, (*GOOD["flat"], "friction")),
        (partial(flat, friction=0.1), ("unloaded_to",)),
        (Scene.from_kappa, ("kappa",)),
        (ball, ("contact_radius", "load", "approach")),
        (partial(ball, load=0.0), ("work_of_adhesion",)),
        (physical, (*GOOD["steel"], *compliances, "friction")),
    ):
        declared = SCENE | SI if function is physical else SCENE
        found += [(function, name, declared[name].allowed) for name in names]
    for kind in (*PROFILES.values(), *LAWS.values()):
        allowed = {name: one.allowed for name, one in parameters_of(kind).items() if one.allowed}
        good = partial(kind, **{name: GOOD["kinds"][name] for name in allowed})
        found += [(good, *one) for one in allowed.items()]
    solved = partial(solve, scene)
    found += [(solved, "rtol", TOLERANCE), (solved, "max_unknowns", COUNT)]
    for solution in solutions:
        fields = [q for q in ("pressure", "traction", "slip") if q in solution.plan.quantities]
        places = itertools.product(fields, ("s", "from_edge"))
        found += [(getattr(solution, field), name, RADII) for field, name in places]
    return [*found, *CLOSED_FORMS]


def range_cases(solutions: tuple[Solution, ...]) -> Iterator[Case]:
    """Yield a call for every number out of every range, in every type; of radii one of several."""
    for function, name, allowed in ranges(solutions):
        inner = function.func if isinstance(function, partial) else function
        # the closed forms share no code with the library, not even its errors
        errors = (ValueError,) if "closed_forms" in inner.__module__ else (SceneError,)
        values = [one for number in outside(allowed) for one in as_every_type(number)]
        if allowed == RADII:
            values += [one for number in outside(allowed) for one in among_good_ones(number)]
        if allowed != COUNT and not checks._bounds(allowed)["infinite_ok"]:
            values += HUGE
        for value in values:
            label = f"{inner.__qualname__}({name} = {value!r})"
            yield Case(label, partial(function, **{name: value}), errors, name)
