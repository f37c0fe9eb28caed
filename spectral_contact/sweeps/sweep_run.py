"""`sweep`: arguments are checked, scenes are solved in chunks, results become a dataset."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields.curves import LEAST
from spectral_contact.io import checks
from spectral_contact.io.choices import suggesting
from spectral_contact.layers.scene_layer import is_user_law
from spectral_contact.processes import VERSION
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps.chunk import outcomes
from spectral_contact.sweeps.dataset import Collected, assembled, needed
from spectral_contact.sweeps.indentation_curves import on_curves
from spectral_contact.sweeps.physical_scenes import (
    PhysicalScenes,
    grid_of,
    list_of,
    quantities_for,
    si_results,
    table_of,
    with_values,
)
from spectral_contact.sweeps.request import Request, requested
from spectral_contact.sweeps.shortcuts import eligible
from spectral_contact.sweeps.sweep_parameters import (
    KAPPA,
    PARAMETERS,
    Indices,
    SweepParameters,
    changed,
    grid,
    listed,
)
from spectral_contact.sweeps.sweep_store import Store
from spectral_contact.threads import one_thread
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    import xarray

#: Parameters that only scenes in SI units have, in the order of the arguments of `sweep`.
_SI_AXES: Final = (
    *("youngs_modulus", "radius", "reduced_modulus"),
    *("punch_youngs_modulus", "punch_poisson_ratio"),
)
#: Number of scenes of a chunk: some tenths of a second of work.
_CHUNK: Final = 64
#: Number of scenes of a chunk with profiles or coupling: some take a hundred times as long.
_SLOW_CHUNK: Final = 8
#: Number of scenes of a chunk if the spectra serve nearly all of them.
_QUICK_CHUNK: Final = 16384
#: Chunks may cut a line (`lines`) or an indentation curve of more scenes than this.
_LONGEST_LINE: Final = 1024
#: The most numbers that the results of a sweep have, 8 bytes each.
_MOST_VALUES: Final = 10**9
#: Fewest pairs of compliances for which the spectra are used: they take a second or two to build.
_PAIRS_FOR_SPECTRA: Final = 500
#: Number of scenes, spread over the sweep, by which the size of chunks is chosen.
_SAMPLE_SIZE: Final = 500


@suggesting()
def sweep(
    scenes: Scene | Iterable[Scene],
    *,
    poisson_ratio: ArrayLike | None = None,
    kappa: ArrayLike | None = None,
    normal_compliance: ArrayLike | None = None,
    tangential_compliance: ArrayLike | None = None,
    friction: ArrayLike | None = None,
    unloaded_to: ArrayLike | None = None,
    contact_radius: ArrayLike | None = None,
    load: ArrayLike | None = None,
    approach: ArrayLike | None = None,
    separation: ArrayLike | None = None,
    work_of_adhesion: ArrayLike | None = None,
    layer: Mapping[str, ArrayLike] | None = None,
    coupling: bool | None = None,
    youngs_modulus: ArrayLike | None = None,
    radius: ArrayLike | None = None,
    reduced_modulus: ArrayLike | None = None,
    punch_youngs_modulus: ArrayLike | None = None,
    punch_poisson_ratio: ArrayLike | None = None,
    table: Any = None,
    quantities: Iterable[str] | None = None,
    rtol: float = 1e-8,
    s: ArrayLike | None = None,
    from_edge: ArrayLike | None = None,
    max_unknowns: int = 20_000,
    executor: Executor | None = None,
    store: str | os.PathLike[str] | None = None,
    chunk: int | None = None,
    progress: bool | None = None,
) -> xarray.Dataset:
    """Solve a grid of scenes, a list or a table of them.

    Parameters
    ----------
    scenes : Scene or iterable of Scene
        The scene whose parameters vary, or a list.
    poisson_ratio, kappa, normal_compliance, tangential_compliance, friction, unloaded_to
        The values that a parameter takes, dimensionless as in `Scene`; of scenes of two elastic
        bodies it is kappa in place of Poisson's ratio. The grid has every combination, and a list
        of scenes takes none. A single number replaces that of all scenes and makes no dimension.
        Of a scene in SI units they are in SI units, and so is everything that follows.
    contact_radius, load, approach, separation : array_like, optional
        The values of one of these for scenes with a profile, or of load or approach in SI units;
        they replace that of the scene.
    work_of_adhesion : array_like, optional
        The values of the work of adhesion, for scenes with a profile. A load or an approach beyond
        pull-off ends as ``"failed"``.
    layer : mapping of str to array_like, optional
        The values that parameters of the layer's law take, by name, as in ``{"exponent": [2, 3]}``,
        in E' and L. Their dimensions are the last, ``layer_exponent`` and so on.
    coupling : bool, optional
        Turns elastic coupling on or off for all scenes; by default each scene's own setting.
    youngs_modulus, radius, reduced_modulus : array_like, optional
        The values of these for a scene in SI units. With a profile the radius is that of the
        profile, if it has one, such as a sphere.
    punch_youngs_modulus, punch_poisson_ratio : array_like, optional
        The values of these for a scene in SI units with an elastic punch.
    table : pandas.DataFrame, mapping or path, optional
        A scene for each row: a table of pandas or a text file (docs/files) with the names of
        parameters, and their units, as headings; or a mapping of names to arrays. The scene has
        the other parameters.
    quantities : iterable of str, optional
        What to compute, from `QUANTITIES` and, with a profile, from `PROFILE_QUANTITIES`; by
        default all scalars. Nothing else is computed.
    rtol : float
        As of `solve`.
    s, from_edge : array_like, optional
        Radii in [0, 1], or distances from the edge, at which pressure, traction and slip are
        evaluated; give one of the two. They become a dimension.
    max_unknowns : int
        As of `solve`.
    executor : concurrent.futures.Executor, optional
        Runs the chunks: threads, processes, or the executor of a cluster; by default they run in
        this process. It is not shut down.
    store : path, optional
        A folder that keeps every finished chunk, so that the same call resumes after it was
        stopped.
    chunk : int, optional
        Scenes that are solved and stored together.
    progress : bool, optional
        Whether to show rate and time left (extra: progress); by default on a terminal and in
        notebooks.

    Returns
    -------
    xarray.Dataset
        One dimension for each parameter that varies (in the order of above), or ``scene`` for a
        list or a table. Scenes in SI units have parameters and results in these, too, as
        ``load_si`` and so on. Of every quantity its values and, as ``<name>_error``, the estimates
        of its relative errors; NaN where there is none. ``ending`` is ``"converged"``, the name of
        another `Ending` in small letters, or ``"failed"``, and ``message`` explains what did not
        converge. Zones are ``zone_kind`` (1 stick, 2 slip, 3 stick with memory, 4 slip back, 0
        none) and ``zone_outer``.

    Raises
    ------
    SceneError
        For an argument out of its range, or a grid whose results have more than 1e9 numbers. A
        scene that cannot be solved raises nothing.
    SolutionFileError
        If the store cannot be written, is damaged, or belongs to another sweep or version.
    MissingDependencyError
        If xarray is not installed (extra: sweep).

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> from spectral_contact.sweeps import sweep
    >>> found = sweep(Scene(0.3, 0.5, 0.5), friction=[0.05, 0.1], quantities=["stick_radius"])
    >>> [f"{c:.8f}" for c in found.stick_radius.values]
    ['0.49141798', '0.99195671']
    """
    needed()
    scene_values = poisson_ratio, normal_compliance, tangential_compliance, friction, unloaded_to
    control_values = contact_radius, load, approach, separation, work_of_adhesion
    axes = dict(zip(PARAMETERS, (*scene_values, *control_values), strict=True))
    axes[KAPPA] = kappa
    si_given = (youngs_modulus, radius, reduced_modulus, punch_youngs_modulus, punch_poisson_ratio)
    si_axes = dict(zip(_SI_AXES, si_given, strict=True))
    if not isinstance(scenes, Scene):
        scenes = _several(scenes)
    _refuse_rivals(axes)
    physical = _physical_scenes(scenes, axes | si_axes, layer, coupling, table)
    if physical is None:
        for name, values in si_axes.items():
            if values is not None:
                raise SceneError(
                    name, values, "None but for a scene in SI units, of Scene.from_physical"
                )
        all_scenes = parameters = _parameters(scenes, axes, layer, coupling)
        problem_of_scene = None
    else:
        # `parameters` has one scene for each problem, `problem_of_scene` the number of the problem
        # of every scene
        all_scenes, parameters, problem_of_scene = physical.different()
        wanted = requested(quantities, rtol, max_unknowns, s, from_edge, **_kind(all_scenes))
        quantities = quantities_for(physical, wanted.quantities)
    request = requested(quantities, rtol, max_unknowns, s, from_edge, **_kind(parameters))
    _check_size(all_scenes, request)
    tell = ProgressLine(progress)
    if executor is not None and not isinstance(executor, Executor):
        raise SceneError("executor", executor, "a concurrent.futures.Executor, or None")
    slow = parameters.shaped or parameters.coupled
    request = replace(request, shared=parameters.pairs >= _PAIRS_FOR_SPECTRA and not slow)
    size = _chunk_size(parameters, request) if chunk is None else checks.whole("chunk", chunk, 1)
    opened_store = None
    if store is not None:
        if any(is_user_law(form.layer) for form in parameters.forms):
            allowed = (
                "None with a layer that is none of the library's: a store does not know its law"
            )
            raise SceneError("store", store, allowed)
        manifest = {"library": VERSION, "scenes": parameters.fingerprint()}
        opened_store = Store(store, {**manifest, **request.describe(), "chunk": size})
    with one_thread(), tell:
        collected = _collected(parameters, request, size, opened_store, executor, tell)
    if physical is None:
        return assembled(parameters, request, collected)
    assert problem_of_scene is not None
    collected = collected.taken(problem_of_scene)
    dataset = assembled(all_scenes, request, collected)
    if physical.physical:
        dataset = dataset.assign(si_results(physical.scenes, collected.values, request))
    return physical.shaped(dataset)


__test__: Final = {"sweep": sweep}  # doctest does not look into wrapped functions


def _physical_scenes(
    scenes: Any,
    axes: dict[str, Any],
    law: Mapping[str, Any] | None,
    coupling: bool | None,
    table: Any,
) -> PhysicalScenes | None:
    """Return the scenes of a table, or in SI units; None if they are of another kind."""
    given = {name: values for name, values in axes.items() if values is not None}
    if not isinstance(scenes, Scene):
        if table is not None:
            raise SceneError("table", table, "None with a list of scenes")
        return _physical_list(scenes, given, law, coupling)
    is_physical = scenes.physical is not None
    if table is None and not is_physical:
        return None
    if law is not None:
        raise SceneError("layer", law, "None in SI units and with a table")
    if is_physical:
        _refuse_kappa(given)
    # a text is one number with its unit
    single_numbers = {name: values for name, values in given.items() if np.ndim(values) == 0}
    base = with_values(
        scenes, single_numbers | ({} if coupling is None else {"coupling": coupling})
    )
    lists = {name: values for name, values in given.items() if name not in single_numbers}
    if table is None:
        return grid_of(base, lists)
    for name, values in lists.items():
        raise SceneError(name, values, "one number, or None, with a table")
    return table_of(base, table)


def _physical_list(
    scenes: tuple[Scene, ...],
    given: dict[str, Any],
    law: Mapping[str, Any] | None,
    coupling: bool | None,
) -> PhysicalScenes | None:
    """Return the scenes of a list, with one number in place of theirs; None if not all are SI."""
    if not all(one.physical is not None for one in scenes):
        return None
    for name, values in [*given.items(), ("layer", law)]:
        if values is not None and np.ndim(values) > 0:
            raise SceneError(name, values, "one number, or None, with a list of scenes")
    _refuse_kappa(given)
    changes = given | ({} if coupling is None else {"coupling": coupling})
    return list_of([with_values(one, changes) for one in scenes])


def _refuse_kappa(given: Mapping[str, Any]) -> None:
    """Refuse kappa of scenes in SI units."""
    if KAPPA in given:
        raise SceneError(KAPPA, given[KAPPA], "left out of scenes with SI data, which imply it")


def _kind(parameters: SweepParameters) -> dict[str, bool]:
    """Return the arguments of `requested` that say what kinds of scenes there are."""
    return {name: getattr(parameters, name) for name in ("shaped", "adhesive", "unloaded")}


def _check_size(parameters: SweepParameters, request: Request) -> None:
    """Refuse a sweep whose results would not fit into memory, before anything of it is made."""
    count = parameters.size * request.values_of_a_scene
    if count > _MOST_VALUES:
        lengths = " x ".join(map(str, parameters.shape))
        allowed = (
            f"at most {_MOST_VALUES // request.values_of_a_scene} with "
            f"{request.values_of_a_scene} values of each: sweep parts of it"
        )
        raise SceneError(f"number of scenes, {lengths}", parameters.size, allowed)


def _chunk_size(parameters: SweepParameters, request: Request) -> int:
    """Return the number of scenes of a chunk, which take some tenths of a second."""
    sample = np.unique(np.linspace(0, parameters.size - 1, _SAMPLE_SIZE).astype(np.intp))
    if parameters.shaped or parameters.coupled:
        curved = on_curves(parameters.columns(sample), request)
        return _whole_lines(parameters, ("load", "approach")) if curved.all() else _SLOW_CHUNK
    line_chunk = _whole_lines(parameters, ("friction", parameters.names[0]))
    if not request.shared:
        return line_chunk
    # the spectra have these two quantities only where nothing slips
    slip_quantities = frozenset(request.quantities) & {"stick_radius", "total_shear"}
    if slip_quantities and not (parameters.columns(sample).friction == np.inf).all():
        return line_chunk
    served = eligible(parameters.columns(sample), request)
    return _QUICK_CHUNK if served.mean() > 0.99 else line_chunk


def _whole_lines(parameters: SweepParameters, names: tuple[str, str]) -> int:
    """Return the number of scenes of a chunk that cuts no line: `_CHUNK`, or somewhat more.

    A line has all values of both parameters or, if these are too many, all those of the first one.
    """
    first, second = (int(np.size(parameters.axes.get(name, 0.0))) for name in names)
    for line in (first * second, first):
        if LEAST <= line <= _LONGEST_LINE:
            return line * -(-_CHUNK // line)
    return _CHUNK


def _parameters(
    scenes: Any, axes: dict[str, Any], law: Mapping[str, Any] | None, coupling: bool | None
) -> SweepParameters:
    """Return the scenes of a grid or of a list; single numbers are changes to all scenes."""
    changes: dict[str, Any] = {
        name: one for name, one in axes.items() if isinstance(one, numbers.Real)
    }
    axes = {name: one for name, one in axes.items() if name not in changes}
    if coupling is not None:
        changes["coupling"] = coupling
    if isinstance(scenes, Scene):
        return grid(changed(scenes, changes), axes, law)
    for name, values in [*axes.items(), ("layer", law)]:
        if values is not None:
            raise SceneError(name, values, "None with a list of scenes")
    return listed(scenes, changes)


def _refuse_rivals(axes: Mapping[str, Any]) -> None:
    """Refuse two parameters of which a scene has only one: one of them would be ignored."""
    if axes[KAPPA] is not None and axes[PARAMETERS[0]] is not None:
        raise SceneError(KAPPA, axes[KAPPA], f"None where {PARAMETERS[0]} is given")
    controls = [name for name in ALL_CONTROLS if axes[name] is not None]
    if len(controls) > 1:
        allowed = f"left out if {controls[1]} is given: vary one of load, approach, contact radius"
        raise SceneError(controls[0], axes[controls[0]], allowed)


def _several(scenes: Any) -> tuple[Scene, ...]:
    """Return the scenes of a list, at least one."""
    try:
        items = iter(scenes)
    except Exception:  # not a list, or a broken one
        raise SceneError("scenes", scenes, "a Scene or a list of them") from None
    checked_scenes: list[Scene] = []
    for scene in items:
        # at once, for an iterator of other things may have no end
        if not isinstance(scene, Scene):
            raise SceneError(f"scenes[{len(checked_scenes)}]", scene, "a Scene")
        checked_scenes.append(scene)
    if not checked_scenes:
        raise SceneError("scenes", [], "at least one Scene")
    return tuple(checked_scenes)


def _collected(
    parameters: SweepParameters,
    request: Request,
    size: int,
    store: Store | None,
    executor: Executor | None,
    tell: ProgressLine,
) -> Collected:
    """Solve the chunks that the store does not have, and return the results of all scenes."""
    collected = Collected(parameters.size)
    order = parameters.order()
    chunks = [order[i : i + size] for i in range(0, len(order), size)]
    left: dict[int, Indices] = {}
    for number, scenes in enumerate(chunks):
        if store is not None and store.has(number):
            collected.put(scenes, store.get(number))
        else:
            left[number] = scenes
    total = parameters.size
    todo = sum(map(len, left.values()))
    done = 0
    begin = perf_counter()
    tell("the first scenes", (total - todo) / total)
    with closing(outcomes(parameters, left, request, executor, Continuation)) as results:
        for number, outcome in results:
            if store is not None:
                store.put(number, outcome)
            collected.put(chunks[number], outcome)
            done += len(chunks[number])
            rate = done / max(perf_counter() - begin, 1e-9)
            step = f"{rate:.3g} scenes/s, {(todo - done) / rate:.0f} s left"
            tell(step, (total - todo + done) / total)
    return collected
