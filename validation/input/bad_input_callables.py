"""Every public callable with one bad argument after another, drawn from its signature.

Public is what the modules of docs/api.md export: functions, constructors that check what they are
given, methods and ``__call__``. So a new one is in the study without being named. Left out are
errors, enumerations and plain records (dataclasses that only store what the library computed).

Every parameter gets every value of a pool. A value that its annotation does not admit must end in
an error of the library that names the parameter. One that it may admit, as -1 for a float, may end
in a result as well. Other exceptions, warnings and hangs are violations either way.
"""

from __future__ import annotations

import enum
import importlib
import inspect
import itertools
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, is_dataclass
from datetime import date
from decimal import Decimal
from fractions import Fraction
from functools import partial
from pathlib import Path
from types import FunctionType, SimpleNamespace
from typing import Any

import numpy as np
import pint
from bad_input_examples import Examples

from spectral_contact import Solution, SpectralContactError, records

API = Path(__file__).parents[2] / "docs" / "api.md"
#: Bare formulas, evaluated a million times in a quadrature: they take arrays of doubles as given.
UNCHECKED = ("spectral_contact.equations.kernels",)
#: The closed forms share no code with the library, not even its errors.
OWN_ERRORS = {"spectral_contact.closed_forms": ValueError}


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
    errors: tuple[type[Exception], ...]
    names: str
    may_pass: bool


# --- what is public -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Target:
    """A public callable.

    Attributes
    ----------
    name : str
        Qualified, without the name of the library.
    call : callable
        Of an instance, if it is one of its methods.
    owner : type or None
        The class whose instance the call takes first.
    """

    name: str
    call: Callable[..., Any]
    errors: tuple[type[Exception], ...]
    owner: type | None = None

    @property
    def parameters(self) -> list[inspect.Parameter]:
        """What it takes, without the instance."""
        found = list(inspect.signature(self.call).parameters.values())
        return found[1:] if self.owner is not None else found


def modules() -> list[str]:
    """Return the names of the public modules."""
    named = re.findall(r"automodule:: (\S+)", API.read_text(encoding="utf-8"))
    # the top last: what it lends from elsewhere goes by its home
    return [*(one for one in named if one not in UNCHECKED), "spectral_contact"]


#: Records whose ``__post_init__`` only turns NumPy's numbers into Python's.
ONLY_STORE = (records.ErrorEstimates, records.RefinementStep, records.Zone)


def is_record(cls: type) -> bool:
    """Whether the constructor of a class only stores what it is given."""
    own = cls.__init__.__code__.co_filename if isinstance(cls.__init__, FunctionType) else "<"
    checks = hasattr(cls, "__post_init__") and cls not in ONLY_STORE
    return is_dataclass(cls) and own.startswith("<") and not checks


def targets() -> list[Target]:
    """Return all public callables, in the order of the documentation."""
    found: list[Target] = []
    seen: list[Any] = []
    for name in modules():
        module = importlib.import_module(name)
        errors = (SpectralContactError, *filter(None, [OWN_ERRORS.get(name)]))
        for export in module.__all__:
            one = getattr(module, export)
            if any(one is other for other in seen):
                continue
            seen.append(one)
            label = f"{name}.{export}".removeprefix("spectral_contact.")
            if isinstance(one, type):
                found += of_class(label, one, errors)
            elif callable(one):
                found.append(Target(label, one, errors))
    return [target for target in found if target.parameters]


def of_class(label: str, cls: type, errors: tuple[type[Exception], ...]) -> Iterator[Target]:
    """Yield the constructor and the public methods of a class."""
    if issubclass(cls, (Exception, enum.Enum)):
        return
    if not is_record(cls):
        yield Target(label, cls, errors)
    for base in cls.__mro__[:-1]:
        for name, member in vars(base).items():
            if name.startswith("_") and name != "__call__":
                continue
            if isinstance(member, (classmethod, staticmethod)):
                yield Target(f"{label}.{name}", getattr(cls, name), errors)
            elif isinstance(member, FunctionType):
                yield Target(f"{label}.{name}", member, errors, cls)


# --- what a parameter may be ----------------------------------------------------------------------

KINDS = {
    **{"float": "real", "int": "whole", "bool": "flag", "str": "text", "None": "none"},
    **dict.fromkeys(("ArrayLike", "Array", "NDArray"), "array"),
    **dict.fromkeys(("Callable", "Field", "Solver"), "function"),
    **dict.fromkeys(("Sequence", "Iterable", "list", "tuple"), "list"),
    **dict.fromkeys(("Mapping", "dict", "Layer"), "mapping"),
    **{"PathLike": "path", "Any": "anything"},
}


def parts(annotation: str) -> list[str]:
    """Return the members of a union."""
    depth, found = 0, [""]
    for character in annotation:
        depth += (character == "[") - (character == "]")
        if character == "|" and depth == 0:
            found.append("")
        else:
            found[-1] += character
    return [one.strip().strip("'\"") for one in found]


def kinds_of(annotation: Any) -> set[str]:
    """Return what values an annotation admits; classes of the library admit nothing of the pool."""
    if annotation is inspect.Parameter.empty:
        return {"anything"}
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    if "_SupportsArray" in text:  # ArrayLike, evaluated
        return {"array", "none"} if "NoneType" in text or "None" in text else {"array"}
    found = set()
    for part in parts(text):
        outer, _, inner = part.partition("[")
        kind = KINDS.get(outer.rpartition(".")[2], "object")
        if kind == "list":
            found |= {
                f"list of {one}" for one in kinds_of(inner.rpartition("]")[0].removesuffix(", ..."))
            } | {"list"}
        else:
            found.add(kind)
    return found | ({"text"} if "path" in found else set())


# --- the pool -------------------------------------------------------------------------------------


def constant(value: Any) -> Callable[..., Any]:
    """Return a function that takes anything and always returns the same thing."""
    return lambda *_, **__: value


def quack(value: Any) -> SimpleNamespace:
    """Return what has every attribute that a solution may have, all of them the same thing."""
    names = ("approach", "total_shear", "stick_radius", "opening", "value")
    return SimpleNamespace(
        **dict.fromkeys(names, value),
        **dict.fromkeys(("pressure", "traction"), constant(value)),
        zones=(value,),
        error=SimpleNamespace(approach=value, pressure=value),
    )


class Astropys(np.ndarray[Any, Any]):
    """An array with a unit as astropy has them: NumPy takes its numbers and drops the unit."""

    unit = "K"

    def __iter__(self) -> Iterator[Any]:
        """Return the elements with their unit."""
        return (np.array(number).view(Astropys) for number in np.asarray(self))

    @property
    def value(self) -> Any:
        """The numbers."""
        return np.asarray(self)

    def to(self, unit: str) -> Any:
        """Refuse every unit but its own."""
        if unit != self.unit:
            raise ValueError(f"K is not {unit}")
        return self


#: No parameter of the library is a temperature.
KELVIN = pint.UnitRegistry().kelvin
NO_NUMBERS = (
    *(True, "0.5", None, 0.5 + 0j, math.nan, object(), Broken()),
    *(np.datetime64("NaT", "s"), Decimal("0.5"), [[0.5], [0.5, 0.5]], np.ma.masked),
)
NUMBER, WHOLE, ARRAY = {"real", "array"}, {"real", "whole", "array"}, {"array", "list of real"}


def endless() -> list[Any]:
    """Return a list that holds itself."""
    found: list[Any] = []
    found.append(found)
    return found


def unplaced(label: str) -> str:
    """Return a label without the address of an object, which differs from run to run."""
    return re.sub(r" at 0x[0-9a-f]+|'/.*", "", label)


def pool() -> list[tuple[str, Callable[[], Any], set[str]]]:
    """Return label, maker and the kinds that may admit it, of every bad value."""
    own: list[tuple[str, Any, set[str]]] = [
        *((repr(x), x, NUMBER) for x in (0.5, -1.0, math.inf, 1e308, -1e308, 5e-324, 2.5)),
        *((f"{type(x).__name__} {x!s:.9}", x, WHOLE) for x in (0, -1, 2, 10**9, 10**400)),
        ("float32", np.float32(0.5), NUMBER),
        ("Fraction of 1e-400", Fraction(1, 10**400), NUMBER),
        ("long double of 1e4000", np.longdouble("1e4000"), NUMBER),
        *((repr(x), x, {"flag"}) for x in (True, False, np.True_)),
        ("None", None, {"none"}),
        *((repr(x), x, {"text"}) for x in ("", "x", "a\nb", "aproach", "x" * 300, "\x00.json")),
        *((repr(x), x, {"path"}) for x in (b"x", Path("none/x.json"))),
        *((repr(x), x, set()) for x in (math.nan, np.float32("nan"), 1 + 0j, np.complex128(1))),
        *(
            (repr(x), x, set())
            for x in (np.datetime64("NaT", "s"), np.timedelta64(1, "s"), Decimal(1))
        ),
        *((repr(x)[:30], x, set()) for x in (Ellipsis, slice(1), math, object(), date(2020, 1, 1))),
        *((repr(x), x, set()) for x in (np.array("a"), np.array(None), np.ma.masked, 1j)),
        ("memoryview", memoryview(b"1"), {"list", *ARRAY}),
        ("a set", {1}, {"list", "list of real"}),
        ("0-d array", np.array(0.5), {"array"}),
        *((repr(x), x, {"list", *ARRAY}) for x in ([], (), np.zeros(0))),
        *((repr(x), x, ARRAY) for x in ([0.5, 1.5], (0.25, -0.5), [1e308, -1e308, 1e308])),
        ("an array", np.array([0.5, 0.75, math.inf]), ARRAY),
        ("a matrix", np.eye(2), {"array", "list of anything"}),
        ("ragged", [[0.5], [0.5, 0.75]], {"list of list"}),
        ("a list that holds itself", endless(), {"list of anything"}),
        ("masked", np.ma.masked_array([0.5, 0.75], mask=[True, False]), {"list of anything"}),
        *((repr(x), x, set()) for x in ([True, False], np.array([True]), [math.nan], [0.5, 1j])),
        *((repr(x), x, set()) for x in ([np.datetime64("NaT", "s")], np.array(["2020"], "M8[D]"))),
        ("[None]", [None, None], {"list of none"}),
        *((repr(x), x, {"list of text"}) for x in (["x"], ("aproach",), np.array(["x"]))),
        *((repr(x), x, {"mapping"}) for x in ({"x": 1}, {1: 2}, {"a": constant(1)})),
        ("an empty mapping", {}, {"mapping", "list"}),
        ("lists in a list", [[0.5], [1.5]], {"array", "list of list"}),
        ("a broken one", Broken(), set()),
        ("a list of broken ones", [Broken()], set()),
        ("a temperature", 0.5 * KELVIN, set()),
        ("temperatures", np.array([0.5, 0.75]) * KELVIN, set()),
        ("a list of temperatures", [0.5 * KELVIN, 0.75 * KELVIN], {"list of anything"}),
        ("temperatures of astropy", np.array([0.5, 0.75]).view(Astropys), set()),
        ("a class", Broken, {"own"}),
        ("an error", Exception("x"), set()),
    ]
    values = [(unplaced(label), constant(value), kinds) for label, value, kinds in own]
    values += [
        ("an iterator", lambda: iter(()), {"list", "list of real", "list of text"}),
        ("numbers without end", lambda: itertools.count(1), {"list of real"}),
        ("things without end", lambda: itertools.repeat(object()), set()),
    ]
    for value in NO_NUMBERS:
        label = "a broken one" if isinstance(value, Broken) else unplaced(repr(value))
        values.append((f"function that returns {label}", constant(constant(value)), {"function"}))
        values.append((f"object full of {label}", partial(quack, value), {"quack"}))
    return values


def verdict(kinds: set[str], admitted: set[str]) -> bool | None:
    """Return whether a value must be refused; None if it is none of this parameter's business."""
    if "anything" in kinds:
        return False if "own" not in admitted else None
    if "function" in kinds and "own" in admitted:
        return None  # a class can be called, and raises what it will
    if "list of anything" in kinds and any(one.startswith("list") for one in admitted):
        return False
    return not kinds & admitted


# --- cases ----------------------------------------------------------------------------------------


def cases(solutions: tuple[Solution, ...]) -> Iterator[Case]:
    """Yield every parameter of every target with every value that is bad for it, or may be."""
    examples, values = Examples(solutions), pool()
    for target in targets():
        good = examples.arguments(target.name, target.parameters)
        call: Callable[..., Any] = target.call
        if target.owner is not None:
            call = partial(call, examples.instance(target.owner))
        for parameter in target.parameters:
            arguments = {**good, **examples.company(target.name, parameter.name)}
            for label, make, admitted in values:
                must = verdict(kinds_of(parameter.annotation), admitted)
                if must is None or (not must and admitted in ({"flag"}, {"none"})):
                    continue  # not this parameter's business, or a good value and long work
                yield Case(
                    f"{target.name}({parameter.name} = {label})",
                    partial(called, call, parameter, {**arguments, parameter.name: make}),
                    target.errors,
                    parameter.name if must and is_named(parameter) else "",
                    not must,
                )


def is_named(parameter: inspect.Parameter) -> bool:
    """Whether errors name a parameter: of files and texts they show the value, as their source."""
    is_text = parameter.name in ("text", "data")
    return not is_text and "path" not in kinds_of(parameter.annotation)


def called(call: Callable[..., Any], bad: inspect.Parameter, arguments: dict[str, Any]) -> Any:
    """Call with arguments of which one is made anew; what is yielded late is drawn."""
    given = {**arguments, bad.name: arguments[bad.name]()}
    late = [given.pop(bad.name)] if bad.kind is inspect.Parameter.VAR_POSITIONAL else []
    result = call(*late, **given)
    return list(itertools.islice(result, 3)) if inspect.isgenerator(result) else result
