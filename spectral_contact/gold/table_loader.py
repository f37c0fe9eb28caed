"""Reading gold tables, schema and numbers checked; knows no solver.

The schema is documented in docs/gold.md. The tables that ship with the library are the files in
``tables``, written by validation/gold/make_gold.py.
"""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any, Final

from spectral_contact.errors import shown
from spectral_contact.io.choices import instance, one_of
from spectral_contact.io.documents import Refused, check_keys, check_schema, read_file, reported
from spectral_contact.layers.scene_layer import layer_from
from spectral_contact.profiles.control import CONTROLS, profile_from
from spectral_contact.records import ErrorEstimates, Zone
from spectral_contact.scene import Scene, same_problem
from spectral_contact.view.output import notebook_gold, notebook_gold_table

_SCHEMA: Final = "spectral_contact.gold"
_VERSION: Final = 1
_TABLE_KEYS: Final = ("schema", "version", "table", "regime", "script", "scenes")
_PARAMETERS: Final = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")
_VALUES: Final = ("approach", "total_shear", "zones", "edge_ratio")
#: What else a table has of a scene with a profile.
_PRESSED: Final = ("contact_radius", "load", "stiffness", "indentation_work")
#: What else it has where the approach is proved (docs/proved): two decimals that enclose it.
_PROVED: Final = "approach_bounds"
_ENTRY_KEYS: Final = ("name", "scene", "library", "digits", *_VALUES, "points", "error")
#: What else a zone has below the largest load.
_HISTORY: Final = ("sense", "memory")
_SIDES: Final = ("inner", "outer", "inner_from_edge", "outer_from_edge")
_ERRORS: Final = (*_VALUES, "pressure", "traction")
_FEWEST_DIGITS, _MOST_DIGITS = 15, 60
_DECIMAL: Final = re.compile(r"-?(\d+)(?:\.(\d+))?(?:e[+-]?\d{1,4})?", re.ASCII)


@dataclass(frozen=True, slots=True)
class GoldPoint:
    """The fields at a point.

    Attributes
    ----------
    from_edge : float
        Its distance from the edge, exactly.
    pressure, traction : mpf
        ``p*`` and ``q*``; infinite at the edge where the theory has it so, of either sign with
        elastic coupling.
    """

    from_edge: float
    pressure: Any
    traction: Any


@dataclass(frozen=True, slots=True)
class GoldSolution:
    """A scene and its solution; everything is dimensionless, as in `Solution`.

    Attributes
    ----------
    name : str
        Unique in its table.
    scene : Scene
        Its parameters are exactly these doubles.
    library : str
        Version of the library that computed the numbers.
    digits : int
        What it was asked for; three more are stored.
    approach, total_shear : mpf
        ``delta*`` and ``Q*``.
    zones : tuple of Zone
        From the centre to the edge; empty without friction.
    edge_ratio : mpf or None
        q/p at the edge where everything sticks, which may be infinite; None elsewhere, and with
        elastic coupling where it has no limit or no meaning.
    opening : mpf or None
        Largest distance from the edge at which elastic coupling makes the pressure change sign.
    points : tuple of GoldPoint
        From the centre to the edge; without the edge where the fields have no limit there.
    contact_radius, load, stiffness, indentation_work : mpf or None
        Of a scene with a profile, in its units; approach and pressure are, too.
    approach_bounds : tuple of mpf or None
        Lower and upper bound of the approach that are proved (docs/proved); None where there are
        none.
    table : str
        Name of its table.
    error : ErrorEstimates
        Certified relative errors: `zones` that of every boundary, from the centre and from the
        edge, `pressure` and `traction` that at every point, in the sense of `Solution.error`: that
        of the traction is relative to ``f p`` in zones with memory. None where there is no value,
        and 0 of what is 0 by definition.
    """

    name: str
    scene: Scene
    library: str
    digits: int
    approach: Any
    total_shear: Any
    zones: tuple[Zone, ...]
    edge_ratio: Any
    opening: Any
    points: tuple[GoldPoint, ...]
    error: ErrorEstimates
    table: str = ""
    contact_radius: Any = None
    load: Any = None
    stiffness: Any = None
    indentation_work: Any = None
    approach_bounds: tuple[Any, Any] | None = None

    def __repr__(self) -> str:
        return f"<GoldSolution {self.name!r}, {self.digits} digits: approach={self.approach}>"

    def _repr_html_(self) -> str:
        return notebook_gold(self)

    @property
    def stick_radius(self) -> Any:
        """``c*``, an mpf; None without friction."""
        if not self.zones:
            return None
        first = self.zones[0]
        return first.outer if first.kind == "stick" else first.inner


@dataclass(frozen=True, slots=True)
class GoldTable:
    """The solutions of one file.

    Attributes
    ----------
    name : str
        That of the file, without its suffix.
    regime : str
        What the scenes have in common.
    script : str
        What made it.
    solutions : tuple of GoldSolution
    """

    name: str
    regime: str
    script: str
    solutions: tuple[GoldSolution, ...]

    def __repr__(self) -> str:
        return f"<GoldTable {self.name!r}: {len(self.solutions)} scenes, {self.regime}>"

    def _repr_html_(self) -> str:
        return notebook_gold_table(self)


def names() -> tuple[str, ...]:
    """Return the names of the tables that ship with the library, sorted."""
    files = (file.name for file in _folder().iterdir())
    return tuple(sorted(name.removesuffix(".json") for name in files if name.endswith(".json")))


def table(name: str) -> GoldTable:
    """Return one of the tables that ship with the library.

    Parameters
    ----------
    name : str
        One of `names`.

    Raises
    ------
    SceneError
        If there is no such table.

    Examples
    --------
    >>> from spectral_contact import gold
    >>> gold.table("slip_unequal")
    <GoldTable 'slip_unequal': 8 scenes, slip outside a stick disk, alpha and beta > 0 and unequal>
    """
    one_of("name", name, names())
    return _parsed(f"{name}.json", (_folder() / f"{name}.json").read_bytes())


def tables() -> tuple[GoldTable, ...]:
    """Return the tables that ship with the library, in the order of their names.

    Examples
    --------
    >>> from spectral_contact import gold
    >>> first = gold.tables()[0]
    >>> print(first.name, first.solutions[0].scene.poisson_ratio, first.solutions[0].approach)
    adhesion 0.3 -0.253314137315500251207882642406
    """
    return tuple(map(table, names()))


def find(scene: Scene) -> GoldSolution | None:
    """Return the gold solution of a scene that ships with the library; None if there is none.

    Without friction the normal compliance alone decides, and a profile with what is given of the
    contact; SI data do not matter.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    SceneError
        If it is no Scene.

    Examples
    --------
    >>> from spectral_contact import Scene, gold
    >>> found = gold.find(Scene(0.246, 0.2, 0.5, 0.1))
    >>> print(found.table, found.stick_radius)
    slip_inside 0.980898526470417661586300817969
    """
    instance("scene", scene, Scene)
    several = (one for known in tables() for one in known.solutions)
    return next((one for one in several if same_problem(one.scene, scene)), None)


def _folder() -> Traversable:
    return resources.files("spectral_contact.gold") / "tables"


def load(path: str | os.PathLike[str]) -> GoldTable:
    """Return the table in a file.

    Parameters
    ----------
    path : str or os.PathLike

    Returns
    -------
    GoldTable

    Raises
    ------
    SolutionFileError
        For a file that is not there, no gold table, damaged, or of another version.
    """
    return _parsed(*read_file(path))


@lru_cache
def _parsed(source: str, content: bytes) -> GoldTable:
    with reported(source, "damaged, or not the JSON text of a gold table"):
        return _table(json.loads(content.decode()))


def _table(document: Any) -> GoldTable:
    check_schema(document, "gold table", _SCHEMA, _VERSION)
    check_keys("the table", document, _TABLE_KEYS)
    name, regime, script = (
        _text("the table", document, key) for key in ("table", "regime", "script")
    )
    contexts: dict[int, Any] = {}
    solutions = []
    for i, entry in enumerate(_list("the table", document, "scenes")):
        where = f"scene {i + 1}"
        coupled = isinstance(entry, dict) and "opening" in entry
        pressed = isinstance(entry, dict) and _PRESSED[0] in entry
        proved = isinstance(entry, dict) and _PROVED in entry
        more = ("opening",) * coupled + _PRESSED * pressed + (_PROVED,) * proved
        check_keys(where, entry, (*_ENTRY_KEYS, *more))
        digits = entry["digits"]
        if type(digits) is not int or not _FEWEST_DIGITS <= digits <= _MOST_DIGITS:
            allowed = f"a whole number in [{_FEWEST_DIGITS}, {_MOST_DIGITS}]"
            raise Refused(f'{where}: "digits" is {shown(digits)}, and must be {allowed}')
        if digits not in contexts:
            from mpmath.ctx_mp import MPContext  # 40 ms, which the command line has no use for

            contexts[digits] = MPContext()
            contexts[digits].dps = digits + 3
        solutions.append(_GoldEntry(where, entry, contexts[digits]).solution(name))
    if len({solution.name for solution in solutions}) < len(solutions):
        raise Refused("two scenes have the same name")
    return GoldTable(name, regime, script, tuple(solutions))


class _GoldEntry:
    """One scene of a document, whose keys are checked."""

    def __init__(self, where: str, body: dict[str, Any], mp: Any) -> None:
        self.where, self.body, self.mp = where, body, mp
        self.digits: int = body["digits"]
        self.pressed = _PRESSED[0] in body
        self.unloaded = isinstance(body["scene"], dict) and "unloaded_to" in body["scene"]

    def solution(self, table: str) -> GoldSolution:
        """Return the record."""
        body, where = self.body, self.where
        error = self._error()
        ratio, opening = (
            None if body.get(name) is None else self._number(where, body, name)
            for name in ("edge_ratio", "opening")
        )
        return GoldSolution(
            _text(where, body, "name"),
            self._scene(),
            _text(where, body, "library"),
            self.digits,
            self._number(where, body, "approach"),
            self._number(where, body, "total_shear"),
            self._zones(),
            ratio,
            opening,
            self._points(),
            error,
            table,
            **{name: self._number(where, body, name) for name in _PRESSED * self.pressed},
            approach_bounds=self._bounds() if _PROVED in body else None,
        )

    def _scene(self) -> Scene:
        where, body = f"{self.where}, scene", self.body["scene"]
        coupled = "opening" in self.body
        layered = isinstance(body, dict) and "layer" in body
        more = ("coupling",) * coupled + ("profile", *CONTROLS) * self.pressed
        more += ("layer",) * layered
        adhesive = isinstance(body, dict) and "work_of_adhesion" in body
        more += ("work_of_adhesion", "branch") * adhesive
        check_keys(where, body, (*_PARAMETERS, *more, *("unloaded_to",) * self.unloaded))
        numbers = (*_PARAMETERS, *CONTROLS * self.pressed, *("work_of_adhesion",) * adhesive)
        numbers += ("unloaded_to",) * self.unloaded
        values: dict[str, Any] = {
            name: None
            if body[name] is None and name in ("friction", *CONTROLS)
            else _double(f"{where}, {name}", body[name])
            for name in numbers
        }
        if adhesive:
            values["branch"] = body["branch"]
        if coupled:
            values["coupling"] = body["coupling"]
        try:
            if self.pressed:
                values["profile"] = profile_from(body["profile"])
            if layered:
                values["layer"] = layer_from(body["layer"])
            return Scene(**values)
        except ValueError as error:
            raise Refused(f"{where}: {error}") from error

    def _bounds(self) -> tuple[Any, Any]:
        """Return the bounds of the approach, between which it must be."""
        texts = _list(self.where, self.body, _PROVED)
        if len(texts) == 2 and all(isinstance(e, str) and _DECIMAL.fullmatch(e) for e in texts):
            lower, upper = map(self.mp.mpf, texts)
            if lower <= self._number(self.where, self.body, "approach") <= upper:
                return lower, upper
        told = "two decimal numbers as text, with the approach between them"
        raise Refused(f'{self.where}: "{_PROVED}" is {shown(texts)}, and must be {told}')

    def _zones(self) -> tuple[Zone, ...]:
        zones = []
        before = "0", "1"
        for i, zone in enumerate(_list(self.where, self.body, "zones")):
            where = f"{self.where}, zone {i + 1}"
            check_keys(where, zone, ("kind", *_SIDES, *_HISTORY * self.unloaded))
            if zone["kind"] not in ("stick", "slip"):
                raise Refused(f'{where}: "kind" is {shown(zone["kind"])}, not stick or slip')
            numbers = [self._number(where, zone, side) for side in _SIDES]
            start = [self.mp.mpf(text) for text in before]
            if [numbers[0], numbers[2]] != start:
                raise Refused(f"{where}: it does not begin where the zone before it ends")
            before = zone["outer"], zone["outer_from_edge"]
            history = {name: zone[name] for name in _HISTORY * self.unloaded}
            if history and (history["sense"] not in (1, -1) or type(history["memory"]) is not bool):
                raise Refused(f'{where}: "sense" is 1 or -1, and "memory" true or false')
            zones.append(Zone(zone["kind"], *numbers, **history))
        if zones and (zones[-1].outer != 1 or zones[-1].outer_from_edge != 0):
            raise Refused(f"{self.where}: its zones do not end at the edge")
        return tuple(zones)

    def _points(self) -> tuple[GoldPoint, ...]:
        points: list[GoldPoint] = []
        for i, point in enumerate(_list(self.where, self.body, "points")):
            where = f"{self.where}, point {i + 1}"
            check_keys(where, point, ("from_edge", "pressure", "traction"))
            from_edge = _double(f"{where}, from_edge", point["from_edge"])
            if not 0.0 <= from_edge < (points[-1].from_edge if points else 1.5) or from_edge > 1.0:
                raise Refused(f'{where}: "from_edge" must fall from point to point, in [0, 1]')
            fields = [self._number(where, point, name) for name in ("pressure", "traction")]
            points.append(GoldPoint(from_edge, *fields))
        return tuple(points)

    def _error(self) -> ErrorEstimates:
        where, body = f"{self.where}, error", self.body["error"]
        check_keys(where, body, (*_ERRORS, *_PRESSED * self.pressed))
        for name, error in body.items():
            if name == "edge_ratio" and self.body[name] is None:
                if error is not None:
                    raise Refused(f'{where}: "{name}" is {shown(error)}, and there is no value')
            elif type(error) not in (int, float) or not 0.0 <= error < 1.0:
                raise Refused(f'{where}: "{name}" is {shown(error)}, and must be in [0, 1)')
        return ErrorEstimates(**body, stick_radius=body["zones"])

    def _number(self, where: str, body: dict[str, Any], name: str) -> Any:
        """Return a number that has all its digits."""
        text = body[name]
        if text in ("inf", "-inf"):
            if name in ("pressure", "traction", "edge_ratio"):
                return self.mp.mpf(text)
        elif isinstance(text, str) and (match := _DECIMAL.fullmatch(text)):
            value = self.mp.mpf(text)
            figures = "".join(part or "" for part in match.groups()).lstrip("0")
            if value == 0 or value == 1 or len(figures) >= self.digits:
                return value
            raise Refused(f'{where}: "{name}" has {len(figures)} digits of {self.digits}: rounded')
        raise Refused(f'{where}: "{name}" is {shown(text)}, and must be a decimal number as text')


def _double(where: str, body: Any) -> float:
    """Return an input, whose hexadecimal and decimal forms must be of the same double."""
    check_keys(where, body, ("hex", "decimal"))
    try:
        value = float.fromhex(body["hex"])
        same = float(body["decimal"]) == value
    except (TypeError, ValueError, OverflowError):
        same = False
    if not same or math.isnan(value):
        raise Refused(f'{where}: "hex" and "decimal" must be texts of the same double')
    return value


def _text(where: str, body: dict[str, Any], key: str) -> str:
    if not isinstance(body[key], str) or not body[key]:
        raise Refused(f'{where}: "{key}" is {shown(body[key])}, and must be a text')
    return str(body[key])


def _list(where: str, body: dict[str, Any], key: str) -> list[Any]:
    if not isinstance(body[key], list):
        raise Refused(f'{where}: "{key}" is {shown(body[key])}, and must be a list')
    return list(body[key])
