"""How figures of the library look, and how they are written; matplotlib is imported when drawing.

Figures are made through the object interface, never through pyplot: no window, no global state.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import SolutionFileError, optional
from spectral_contact.io.choices import instance
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Suffixes that `save` knows.
FORMATS = (".png", ".pdf", ".svg")

# Colours of Okabe and Ito, which the colour-blind tell apart; in grey the line styles differ.
BLUE, VERMILION, GREEN, BLACK = "#0072B2", "#D55E00", "#009E73", "#000000"
#: Backgrounds of stick and slip zones in every picture of the library: in figures, in the zones
#: that notebooks show, in the explorer and in README.md. They survive printing in grey.
STICK_WHITE, SLIP_GREY = "#FFFFFF", "#DDDDDD"
#: Outline of a zone where it is drawn as a box.
ZONE_EDGE = "#888888"
#: Dots per inch in a notebook.
_SCREEN = 110
_STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#CCCCCC",
    "grid.linewidth": 0.4,
    "legend.frameon": False,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.4,
    "svg.hashsalt": "spectral_contact",
}


def require() -> Any:
    """Return matplotlib. It is called before any work that would be in vain without it."""
    return optional("matplotlib", "plot")


def new_figure(**options: Any) -> Figure:
    """Return an empty figure that a notebook shows as a picture although pyplot is not used.

    Parameters
    ----------
    **options
        As of `matplotlib.figure.Figure`.
    """
    figure: Figure = _picture_class()(**options)
    return figure


@cache
def _picture_class() -> type[Any]:
    from matplotlib.figure import Figure

    class Picture(Figure):
        def _repr_png_(self) -> bytes:
            drawn = BytesIO()
            with style():
                self.savefig(drawn, format="png", dpi=_SCREEN)
            return drawn.getvalue()

    return Picture


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure; the suffix, one of ``FORMATS``, decides the format.

    Raises
    ------
    SceneError
        If it is no figure of matplotlib.
    SolutionFileError
        For another suffix, or a path that cannot be written.
    MissingDependencyError
        If matplotlib is not installed.
    """
    require()
    from matplotlib.figure import Figure

    instance("figure", figure, Figure)
    path = path_text(path)
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise SolutionFileError(path, f"the suffix must be one of {', '.join(FORMATS)}")
    # without the date, the same figure gives the same file
    date = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    drawn = BytesIO()
    with style():
        figure.savefig(drawn, format=suffix[1:], dpi=150, metadata=date.get(suffix))
    with reported(path, "cannot be written"):
        replace_file(path, drawn.getvalue())


@contextmanager
def style() -> Iterator[None]:
    """Draw in the style of all figures of the library while the context lasts.

    Raises
    ------
    MissingDependencyError
        If matplotlib is not installed.
    """
    with require().rc_context(_STYLE):
        yield


def scene_title(scene: Scene) -> str:
    """Return the parameters of a scene in the symbols of the theory, as a title of a figure."""
    instance("scene", scene, Scene)
    friction = rf"$f = {scene.friction:g}$" if scene.friction is not None else "no friction"
    if scene.friction == np.inf:
        friction = "full stick"
    material = []
    if scene.mismatch is not None:
        material = [rf"$\kappa = {scene.mismatch:g}$"]
    elif scene.poisson_ratio is not None:
        material = [rf"$\nu = {scene.poisson_ratio:g}$"]
    numbers = (
        *material,
        rf"$\alpha^* = {math_number(scene.normal_compliance)}$",
        rf"$\beta^* = {math_number(scene.tangential_compliance)}$",
    )
    # lambda is the load over the largest load
    unloaded = [rf"$\lambda = {scene.unloaded_to:g}$"] * (scene.unloaded_to < 1.0)
    return ",   ".join((*numbers, friction, *unloaded, *["coupled"] * scene.coupling))


def math_number(number: float) -> str:
    """Return a number in the way of mathematics: 2.5e-07 as 2.5 · 10^-7."""
    digits, _, exponent = f"{number:g}".partition("e")
    if not exponent:
        return digits
    factor = "" if digits == "1" else rf"{digits} \cdot "
    return f"{factor}10^{{{int(exponent)}}}"
