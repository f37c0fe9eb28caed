"""Reading the benchmarks that ship with the library, and copying them elsewhere."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SolutionFileError
from spectral_contact.io.choices import names as known_names
from spectral_contact.io.choices import one_of
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.scene import Scene

#: Version of the problems and their numbers, which is to be cited with the name of one.
VERSION: Final = "1.0"

_SUMS: Final = "SHA256SUMS"


@dataclass(frozen=True, slots=True)
class CheckNumber:
    """A number to compare with.

    Attributes
    ----------
    quantity : str
        As this library names it; ``stiffness_ratio`` is 1/(8 δ*), the stiffness over that of the
        smooth punch without friction.
    symbol : str
        As the pages write it.
    text : str
        The dimensionless value, all of whose digits are right but the last one.
    where : str
        How it was computed.
    """

    quantity: str
    symbol: str
    text: str
    where: str

    @property
    def value(self) -> float:
        """The nearest double."""
        return float(self.text)


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Normal stiffness of a smooth coupled punch, over that of one without friction.

    Attributes
    ----------
    poisson_ratio : float
    friction : float
        Infinite for a bonded punch.
    text : str
        k/k₀, all of whose digits are right but the last one.
    """

    poisson_ratio: float
    friction: float
    text: str

    @property
    def value(self) -> float:
        """The nearest double."""
        return float(self.text)


@dataclass(frozen=True, slots=True)
class Recipe:
    """How to run a benchmark in another code.

    Attributes
    ----------
    code : str
    tried : bool
        Whether its authors did; else the recipe is from the manual of the code.
    text : str
        Markdown.
    """

    code: str
    tried: bool
    text: str


@dataclass(frozen=True, slots=True)
class Benchmark:
    """A problem, and numbers to compare with; everything is dimensionless, as in `Solution`.

    Attributes
    ----------
    name, title, version : str
    scene : Scene
        Its parameters are exactly these doubles.
    about, source : str
        What it tests, and whose it is.
    check : CheckNumber
        The one number to compare first.
    tolerance : float
        Relative difference from `check` that a correct code keeps below.
    tolerance_of : str
        With what resolution it does.
    values : tuple of CheckNumber
        Further numbers.
    stiffness : tuple of Stiffness
        k(f, ν)/k₀ of the smooth coupled punch; of other problems empty.
    recipes : tuple of Recipe
    """

    name: str
    title: str
    version: str
    scene: Scene
    about: str
    source: str
    check: CheckNumber
    tolerance: float
    tolerance_of: str
    values: tuple[CheckNumber, ...]
    stiffness: tuple[Stiffness, ...]
    recipes: tuple[Recipe, ...]

    def fields(self) -> dict[str, NDArray[np.float64]]:
        """Return the columns of the table of fields, from the centre to the edge.

        Returns
        -------
        dict of str to array
            ``s`` = r/a and ``one_minus_s``, its distance from the edge; ``p`` and, with friction,
            ``q`` in P/a²; ``slip`` in 4(1−ν²)P/(aE), inward negative. At the edge of a smooth
            surface they may be infinite, or left out where there is no limit.
        """
        rows = [line for line in _read(f"{self.name}.csv").decode().splitlines() if line[0] != "#"]
        columns = np.array([[float(one) for one in row.split(",")] for row in rows[1:]]).T
        return dict(zip(rows[0].split(","), columns, strict=True))

    def page(self) -> str:
        """Return the page of the benchmark, as Markdown."""
        from spectral_contact.gold.benchmarks.benchmark_page import page

        return page(self)


@cache
def names() -> tuple[str, ...]:
    """Return the names of all benchmarks, from the simplest problem on."""
    return tuple(json.loads(_read("index.json"))["names"])


def load(name: str) -> Benchmark:
    """Return a benchmark.

    Parameters
    ----------
    name : str
        One of `names`.

    Raises
    ------
    SceneError
        If there is none of that name.
    SolutionFileError
        If its files were altered since they were published.
    """
    one_of("name", name, names())
    body = json.loads(_read(f"{name}.json"))
    given: dict[str, Any] = {one.name: body[one.name] for one in fields(Benchmark)}
    infinite = {"friction": math.inf} if body["scene"]["friction"] == "inf" else {}
    parts = {
        "scene": Scene(**{**body["scene"], **infinite}),
        "check": CheckNumber(**body["check"]),
        "values": tuple(CheckNumber(**one) for one in body["values"]),
        "stiffness": tuple(
            Stiffness(**{**one, "friction": float(one["friction"])}) for one in body["stiffness"]
        ),
        "recipes": tuple(Recipe(**one) for one in body["recipes"]),
    }
    return Benchmark(**given | parts)


def export(folder: str | os.PathLike[str], which: Iterable[str] | None = None) -> tuple[str, ...]:
    """Copy benchmarks to a folder: for each its page, its numbers and its fields.

    Parameters
    ----------
    folder : path
        Made if need be. Files of the same names are replaced.
    which : iterable of str, optional
        Names of benchmarks; all by default.

    Returns
    -------
    tuple of str
        Names of the files: ``NAME.md``, ``NAME.json`` and ``NAME.csv`` of each, and
        ``SHA256SUMS`` of them for ``sha256sum --check``.

    Raises
    ------
    SceneError
        If a name is not known.
    SolutionFileError
        If the folder is no path or cannot be written, or a file was altered since its publication.
    """
    chosen = names() if which is None else known_names("which", which, names())
    path = Path(path_text(folder))
    files: dict[str, bytes] = {}
    for name in dict.fromkeys(chosen):
        files[f"{name}.md"] = load(name).page().encode()
        files |= {f"{name}{end}": _read(f"{name}{end}") for end in (".json", ".csv")}
    sums = [f"{hashlib.sha256(content).hexdigest()}  {one}" for one, content in files.items()]
    files[_SUMS] = ("\n".join(sums) + "\n").encode()
    with reported(str(path), "cannot be written"):
        path.mkdir(parents=True, exist_ok=True)
        for one, content in files.items():
            replace_file(str(path / one), content)
    return tuple(files)


def _read(name: str) -> bytes:
    """Return a file of the package, if it is the one that was published."""
    content: bytes = (_folder() / name).read_bytes()
    if hashlib.sha256(content).hexdigest() != _sums()[name]:
        raise SolutionFileError(name, f"altered: its SHA-256 is not that in {_SUMS}")
    return content


def _sums() -> dict[str, str]:
    lines = (_folder() / _SUMS).read_text(encoding="ascii").splitlines()
    return {name: digest for digest, name in (line.split("  ") for line in lines)}


def _folder() -> Any:
    return resources.files("spectral_contact.gold.benchmarks") / "data"
