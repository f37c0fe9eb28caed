"""Damping maps: the energy that steady loops dissipate, over the lowest load and the friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.io import checks
from spectral_contact.io.choices import instance, suggesting
from spectral_contact.scene import Scene
from spectral_contact.sweeps.cycle_result import SteadyCycle
from spectral_contact.sweeps.dataset import needed
from spectral_contact.sweeps.steady_cycle import CycleFamily, checked_cycle
from spectral_contact.threads import one_thread

if TYPE_CHECKING:
    import xarray

_TOLERANCES: Final = "in [1e-10, 1e-2]"
#: Tolerance of the solves over that of the dissipation, a number that was chosen.
_SOLVE_FRACTION: Final = 1e-2
_ENERGY: Final = "4(1−ν²)P²/(aE)"
#: Name, meaning and unit of each variable of a map.
_NUMBERS: Final = (
    ("dissipation", "energy dissipated in a cycle", _ENERGY),
    ("unloading_dissipation", "energy dissipated while the load falls", _ENERGY),
    ("reloading_dissipation", "energy dissipated while the load rises", _ENERGY),
    ("stick_radius", "stick radius of the loop", "a"),
    ("shakedown_ratio", "shakedown ratio λ*", "1"),
)


@suggesting()
def damping_map(
    scene: Scene,
    lowest: ArrayLike,
    friction: ArrayLike | None = None,
    *,
    rtol: float = 1e-6,
    max_unknowns: int = 20_000,
) -> xarray.Dataset:
    """Return what steady loops dissipate, over the lowest load and the friction.

    The dissipation of a loop is an integral of the mean slip over the friction (docs/cycles). The
    mean slip is the same function for all loops: it is computed once, and then each point of the
    map takes one solve more.

    Parameters
    ----------
    scene : Scene
        As of `steady_cycle`; its friction does not matter if `friction` is given.
    lowest : array_like, shape (m,)
        Lowest loads over the largest one, in (0, 1).
    friction : array_like, shape (n,), optional
        Coefficients of friction, positive and finite; by default that of the scene.
    rtol : float
        Relative tolerance of what is dissipated, in [1e-10, 1e-2].
    max_unknowns : int
        As of `solve`.

    Returns
    -------
    xarray.Dataset
        With the dimensions ``friction`` and ``lowest`` and the variables ``dissipation``, its parts
        ``unloading_dissipation`` and ``reloading_dissipation``, ``stick_radius``,
        ``shakedown_ratio`` and ``converged``. Estimates of relative errors are
        ``dissipation_error`` and so on. NaN stands where `SteadyCycle` has None.
        `sweeps.plot_slice` draws it.

    Raises
    ------
    SceneError
        As `steady_cycle`, or for lists that are empty or not one-dimensional.
    MissingDependencyError
        If xarray is not installed (extra: sweep).
    """
    dataset = needed().Dataset
    instance("scene", scene, Scene)
    loads = _axis("lowest", lowest)
    given = scene.friction if friction is None else friction
    if given is None:
        raise SceneError("friction", None, "a coefficient of friction, or a list of them")
    frictions = _axis("friction", given)
    for value in frictions[~((frictions > 0.0) & np.isfinite(frictions))]:
        raise SceneError("friction", float(value), "positive and finite")
    for load in loads.tolist():
        # allowed are all frictions of an interval: the smallest and the largest decide
        for end in (frictions.min(), frictions.max()):
            checked_cycle(scene.replace(friction=float(end)), load)
    rtol = checks.within("rtol", rtol, _TOLERANCES)
    max_unknowns = checks.whole("max_unknowns", max_unknowns, 1)
    with one_thread():
        family = CycleFamily(
            scene, frictions.tolist(), loads.tolist(), rtol, _SOLVE_FRACTION * rtol, max_unknowns
        )
        cycles = [
            [family.cycle(scene.replace(friction=f), load) for load in loads.tolist()]
            for f in frictions.tolist()
        ]
    return _dataset(dataset, cycles, loads, frictions)


def _axis(name: str, values: Any) -> Any:
    """Return the values of an axis: one number or a list of them, as an array."""
    axis = np.atleast_1d(np.asarray(checks.reals(name, values, "a list of numbers"), dtype=float))
    if axis.ndim != 1 or axis.size == 0:
        raise SceneError(name, values, "a list of numbers")
    return axis


def _dataset(
    dataset: Any, cycles: list[list[SteadyCycle]], loads: Any, frictions: Any
) -> xarray.Dataset:
    """Return the numbers of cycles, row by row of one friction, as a dataset."""
    dims = ("friction", "lowest")

    def table(read: Any) -> Any:
        rows = [[read(one) for one in row] for row in cycles]
        return np.array([[np.nan if one is None else one for one in row] for row in rows])

    variables: dict[str, Any] = {}
    for name, meaning, unit in _NUMBERS:
        attributes = {"long_name": meaning, "units": unit}
        variables[name] = (dims, table(lambda one, name=name: getattr(one, name)), attributes)
        errors = table(lambda one, name=name: getattr(one.error, name))
        variables[f"{name}_error"] = (dims, errors, {"long_name": f"relative error of {meaning}"})
    variables["converged"] = (dims, table(lambda one: one.converged))
    axes = {
        "friction": ("friction", frictions, {"long_name": "coefficient of friction f"}),
        "lowest": ("lowest", loads, {"long_name": "lowest load over the largest"}),
    }
    found: xarray.Dataset = dataset(variables, axes)
    return found
