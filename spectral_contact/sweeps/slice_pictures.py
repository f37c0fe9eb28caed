"""A slice of a sweep as a figure: a curve over one parameter, or a map over two."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import real
from spectral_contact.io.choices import instance, one_of
from spectral_contact.sweeps.dataset import needed
from spectral_contact.view.figures import new_figure, style

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: The parameters in the symbols of all other figures.
_SYMBOLS: Final = {
    "poisson_ratio": r"$\nu$",
    "kappa": r"$\kappa$",
    "normal_compliance": r"$\alpha^*$",
    "tangential_compliance": r"$\beta^*$",
    "friction": "$f$",
    "s": "$s$",
    "from_edge": "$1 - s$",
}
#: An axis is logarithmic if its largest value over its least is more than this; chosen.
_SPAN: Final = 30.0


def plot_slice(
    dataset: xarray.Dataset, quantity: str, at: Mapping[str, float] | None = None
) -> Figure:
    """Draw one quantity of a sweep over the one or two dimensions that are left.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `sweep` returns it.
    quantity : str
        A variable of numbers.
    at : mapping of str to float, optional
        Values at which the other dimensions are held. The nearest values that were solved are
        taken, and the title names them.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is no dataset; for an unknown variable or dimension, or a value of `at` that is no
        real number; or unless one or two dimensions are left.
    MissingDependencyError
        If matplotlib is not installed (extra: plot).
    """
    instance("dataset", dataset, needed().Dataset)
    names = [str(name) for name, one in dataset.data_vars.items() if one.dtype.kind in "fi"]
    part = _sliced(dataset[one_of("quantity", quantity, names)], at)
    free = [str(name) for name in part.dims if part.sizes[name] > 1]
    # the infinite friction of full stick has no place on an axis; where a single friction is left,
    # it is no dimension of the picture
    part = part.isel({name: np.isfinite(part[name].values) for name in free}).squeeze()
    free = [name for name in free if name in part.dims] or free
    part = part.sortby(list(part.dims))
    if len(free) not in (1, 2):
        allowed = f"such that one or two dimensions are left, not {', '.join(free) or 'none'}"
        raise SceneError("at", dict(at or {}), allowed)
    with style():
        figure = new_figure(figsize=(5.6, 4.2), layout="constrained")
        axes = figure.add_subplot()
        (_curve if len(free) == 1 else _map)(axes, part, free)
        axes.set_title(_fixed_text(part), fontsize="medium")
    return figure


def varying(dataset: xarray.Dataset, at: Mapping[str, float] | None = None) -> str:
    """Return the quantity to draw: the first that varies along every dimension of a slice.

    A quantity varies along a dimension if it changes there by more than ten times its largest
    error. If none varies along all dimensions, it is the first one.
    """
    names = [str(name) for name in dataset.data_vars if f"{name}_error" in dataset]
    for name in names:
        part = _sliced(dataset[name], at)
        error = float((np.abs(part) * _sliced(dataset[f"{name}_error"], at)).max())
        free = [str(dim) for dim in part.dims if part.sizes[dim] > 1]
        if all(float((part.max(dim) - part.min(dim)).max()) > 10.0 * error for dim in free):
            return name
    return names[0]


def _sliced(part: xarray.DataArray, at: Any) -> xarray.DataArray:
    """Return the slice of a quantity at the places that were solved nearest to those asked for."""
    for name, value in _held_values(at, [str(name) for name in part.dims]).items():
        part = part.sel({name: _nearest(part[name].values, value)})
    return part


def _fixed_text(part: xarray.DataArray) -> str:
    """Return the parameters that are the same in the whole picture, with their values."""
    held = [name for name in part.coords if part[name].ndim == 0 and part[name].dtype.kind == "f"]
    numbers = {name: float(part[name]) for name in held}
    texts = [
        "no friction" if np.isnan(value) else f"{_SYMBOLS.get(str(name), name)} = {value:.4g}"
        for name, value in numbers.items()
    ]
    return ", ".join(texts).replace("= inf", r"= $\infty$")


def _held_values(at: Any, dims: list[str]) -> dict[str, float]:
    """Return the values at which dimensions are held."""
    if not isinstance(at, Mapping | None):
        raise SceneError("at", at, "a mapping of names to numbers")
    return {
        one_of("at", name, dims, f"one of the dimensions: {', '.join(dims) or 'none'}"): real(
            f"at, {name}", value, allowed="a number", infinite_ok=True
        )
        for name, value in (at or {}).items()
    }


def _nearest(values: NDArray[Any], wanted: float) -> Any:
    """Return the value that is nearest; an infinite one only if it is wanted."""
    same = values[values == wanted]
    return same[0] if same.size else values[np.argmin(np.abs(values - wanted))]


def _curve(axes: Axes, part: xarray.DataArray, free: list[str]) -> None:
    axes.plot(part[free[0]].values, part.values, color="#0072B2", marker=".")
    _scale(axes.set_xscale, part[free[0]].values)
    axes.set_xlabel(_label(part[free[0]]))
    axes.set_ylabel(_label(part))


def _map(axes: Axes, part: xarray.DataArray, free: list[str]) -> None:
    down, across = free
    for scale, name in ((axes.set_xscale, across), (axes.set_yscale, down)):
        _scale(scale, part[name].values)
    edges = _edges(part[across].values), _edges(part[down].values)
    mesh = axes.pcolormesh(*edges, part.transpose(down, across).values)
    axes.set_xlabel(_label(part[across]))
    axes.set_ylabel(_label(part[down]))
    assert axes.figure is not None
    axes.figure.colorbar(mesh, ax=axes, label=_label(part))


def _scale(setter: Any, values: NDArray[Any]) -> None:
    """Make an axis logarithmic if its values are spread like that."""
    if _logarithmic(values):
        setter("log")


def _logarithmic(values: NDArray[Any]) -> bool:
    """Whether values are positive and the largest is more than `_SPAN` times the least."""
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0.0 and finite.max() > _SPAN * finite.min())


def _edges(values: NDArray[Any]) -> NDArray[Any]:
    """Return the ends of cells around values, half-way between them on their axis."""
    logarithmic = _logarithmic(values)
    positions = np.log(values) if logarithmic else values
    midpoints = (positions[1:] + positions[:-1]) / 2.0
    first = 2.0 * positions[0] - midpoints[0]
    last = 2.0 * positions[-1] - midpoints[-1]
    edges = np.concatenate([[first], midpoints, [last]])
    return np.asarray(np.exp(edges) if logarithmic else edges)


def _label(array: xarray.DataArray) -> str:
    unit = array.attrs.get("units", "1")
    name = str(array.attrs.get("long_name", array.name)).split(" = ")[0]
    # symbols in the font of all formulas
    name = re.sub(r"\b(u_r|[αβδpqcQ])\*", r"$\1^*$", name)
    name = re.sub(r" ([νf])$", r" $\1$", name)
    return name if unit == "1" else f"{name} [{unit}]"
