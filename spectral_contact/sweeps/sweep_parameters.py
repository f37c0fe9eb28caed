"""The scenes of a sweep as columns of numbers: a grid or a list, of a million scenes if need be."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import reals
from spectral_contact.io.choices import one_of
from spectral_contact.io.kinds import kind_tree
from spectral_contact.layers import Layer
from spectral_contact.profiles import Profile
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.scene import Scene

#: Numbers of scenes in a sweep, or places of scenes in a chunk, counted from 0.
Indices = NDArray[np.intp]

#: The parameters of a scene, in the order of the rows of `Columns.values` and of the dimensions of
#: a grid. Scenes of a flat punch have the first five alone.
PARAMETERS: Final = (
    "poisson_ratio",
    "normal_compliance",
    "tangential_compliance",
    "friction",
    "unloaded_to",
    *ALL_CONTROLS,
    "work_of_adhesion",
)
#: Number of parameters of a flat punch.
_FLAT_COUNT: Final = 5
#: The parameter that takes the place of Poisson's ratio, the first one, in scenes of two bodies: it
#: is their `Scene.mismatch`.
KAPPA: Final = "kappa"
#: Prefix of the parameters of a layer's law, which follow `PARAMETERS`.
_LAW_PREFIX: Final = "layer_"
_ALPHA: Final = PARAMETERS.index("normal_compliance")
_BETA: Final = PARAMETERS.index("tangential_compliance")
_FRICTION: Final = PARAMETERS.index("friction")
_UNLOADED: Final = PARAMETERS.index("unloaded_to")
#: Parameters in the order in which scenes are sorted to be solved. The first varies slowest: scenes
#: of the same alpha share the pressure, those of the same alpha and beta the full-stick traction.
_SLOWEST: Final = tuple(
    PARAMETERS.index(name)
    for name in (
        *("normal_compliance", "work_of_adhesion", "tangential_compliance", "poisson_ratio"),
        *("friction", "unloaded_to", *ALL_CONTROLS),
    )
)


class SceneForm(NamedTuple):
    """The fields of a scene that are no column of numbers."""

    profile: Profile | None = None
    layer: Layer | None = None
    coupling: bool = False
    #: whether the first parameter is kappa
    by_kappa: bool = False
    #: which of several states with adhesion that have the same load or approach: `Scene.branch`
    branch: int = 0

    @classmethod
    def of(cls, scene: Scene) -> SceneForm:
        """Return the form of a scene."""
        by_kappa = scene.mismatch is not None
        return cls(scene.profile, scene.layer, scene.coupling, by_kappa, scene.branch)


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """The parameters of some scenes.

    Attributes
    ----------
    values : ndarray, shape (5, scenes) or (10 and more, scenes)
        A row for each parameter, in the order of `PARAMETERS`, then of `law`. NaN stands for None:
        no friction, or a parameter that is not given. The first row is kappa where `by_kappa` of
        the form says so.
    forms : tuple of SceneForm
        One for each scene, or a single one of all scenes.
    law : tuple of str
        Names of the parameters of the layer's law that vary.
    """

    values: Array
    forms: tuple[SceneForm, ...] = (SceneForm(),)
    law: tuple[str, ...] = ()

    def __len__(self) -> int:
        return int(self.values.shape[1])

    @property
    def kappa(self) -> Array:
        """``kappa`` of every scene (docs/theory, Symbols)."""
        nu = self.values[0]
        by_kappa = np.broadcast_to([one.by_kappa for one in self.forms], len(self))
        return np.asarray(np.where(by_kappa, nu, (1.0 - 2.0 * nu) / (4.0 * (1.0 - nu))))

    @property
    def alpha(self) -> Array:
        """Normal compliance of every scene."""
        return np.asarray(self.values[_ALPHA])

    @property
    def beta(self) -> Array:
        """Tangential compliance of every scene."""
        return np.asarray(self.values[_BETA])

    @property
    def friction(self) -> Array:
        """Friction of every scene: infinite for full stick, NaN without friction."""
        return np.asarray(self.values[_FRICTION])

    def scene(self, index: int) -> Scene:
        """Return one of the scenes."""
        # a flat punch has fewer rows than there are parameters, a varying law has more
        numbers = zip(PARAMETERS, self.values[:, index].tolist(), strict=False)
        given: dict[str, Any] = {name: number for name, number in numbers if not math.isnan(number)}
        form = self.forms[index if len(self.forms) > 1 else 0]
        if self.law:
            law_values = dict(
                zip(self.law, self.values[len(PARAMETERS) :, index].tolist(), strict=True)
            )
            form = form._replace(layer=replace(form.layer, **law_values))  # type: ignore[type-var]
        kinds = form._asdict()
        if kinds.pop("by_kappa"):
            given["mismatch"] = given.pop("poisson_ratio")
        return Scene(**{"poisson_ratio": None, **given, **kinds})

    @property
    def at_largest_load(self) -> NDArray[np.bool_]:
        """Which scenes are not unloaded, (scenes,)."""
        return np.asarray(self.values[_UNLOADED] == 1.0)

    @property
    def coupled(self) -> NDArray[np.bool_]:
        """Which scenes have elastic coupling, (scenes,)."""
        return np.broadcast_to([one.coupling for one in self.forms], len(self))

    def __getitem__(self, chosen: slice | Indices | NDArray[np.bool_]) -> Columns:
        return Columns(self.values[:, chosen], _chosen(self.forms, chosen), self.law)


@dataclass(frozen=True, slots=True, eq=False)
class SweepParameters:
    """All scenes of a sweep.

    Attributes
    ----------
    fixed : tuple of float
        The value of every parameter that does not vary, in the order of `names`.
    axes : dict of str to ndarray
        The values of every parameter that varies, in the order of the dimensions of a grid; empty
        for a list.
    table : ndarray or None, shape (5, scenes) or (10, scenes)
        The parameters of a list, as `Columns.values`; None for a grid.
    forms : tuple of SceneForm
        One for each scene, or a single one of all scenes.
    law : tuple of str
        Names of the parameters of the layer's law that vary; their axes are called
        ``layer_<name>``.
    """

    fixed: tuple[float, ...]
    axes: dict[str, Array]
    table: Array | None = None
    forms: tuple[SceneForm, ...] = (SceneForm(),)
    law: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters; the first is kappa if some scene is given by its kappa."""
        first = KAPPA if any(one.by_kappa for one in self.forms) else PARAMETERS[0]
        return (first, *PARAMETERS[1 : len(self.fixed)], *(_LAW_PREFIX + name for name in self.law))

    @property
    def shaped(self) -> bool:
        """Whether the punches have profiles: those of a list all have one, or none has."""
        return self.forms[0].profile is not None

    @property
    def adhesive(self) -> bool:
        """Whether some scenes have adhesion."""
        if not self.shaped:
            return False
        last = len(PARAMETERS) - 1
        values = self.fixed[last] if self.table is None else self.table[last]
        return PARAMETERS[last] in self.axes or not bool(np.isnan(values).all())

    @property
    def unloaded(self) -> bool:
        """Whether some scenes are below their largest load."""
        values = self.fixed[_UNLOADED] if self.table is None else self.table[_UNLOADED]
        return bool((np.asarray(self.axes.get("unloaded_to", values)) < 1.0).any())

    @property
    def coupled(self) -> bool:
        """Whether some scenes have elastic coupling."""
        return any(one.coupling for one in self.forms)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(self.axes) if self.table is None else ("scene",)

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of every dimension."""
        if self.table is not None:
            return (self.table.shape[1],)
        return tuple(len(axis) for axis in self.axes.values())

    @property
    def size(self) -> int:
        """Number of scenes."""
        return math.prod(self.shape)

    @property
    def pairs(self) -> int:
        """Number of different pairs of compliances."""
        if self.table is not None:
            return int(np.unique(self.table[[_ALPHA, _BETA]], axis=1).shape[1])
        return math.prod(np.size(self.axes.get(PARAMETERS[k], 0.0)) for k in (_ALPHA, _BETA))

    def order(self) -> Indices:
        """Return the numbers of the scenes in the order in which they are solved."""
        if self.table is not None:
            keys = [k for k in _SLOWEST if k < len(self.table)]
            return np.lexsort(self.table[keys[::-1]])  # the slowest is the last key
        dimensions = {name: i for i, name in enumerate(self.axes)}
        slowest = [
            *(_LAW_PREFIX + name for name in self.law),
            *(self._parameter(k) for k in _SLOWEST),
        ]
        transposed = [dimensions[name] for name in slowest if name in dimensions]
        return np.arange(self.size).reshape(self.shape).transpose(transposed).ravel()

    def _parameter(self, k: int) -> str:
        return self.names[0] if k == 0 else PARAMETERS[k]

    def columns(self, indices: Indices) -> Columns:
        """Return some of the scenes; in the numbers of a grid the last dimension varies fastest."""
        if self.table is not None:
            return Columns(self.table[:, indices], _chosen(self.forms, indices))
        values = np.empty((len(self.fixed), len(indices)))
        values.T[:] = self.fixed
        where = np.unravel_index(indices, self.shape) if self.shape else ()
        for (name, axis), place in zip(self.axes.items(), where, strict=True):
            values[self.names.index(name)] = axis[place]
        return Columns(values, self.forms, self.law)

    def fingerprint(self) -> str:
        """Return a digest that differs for other scenes, or the same ones in another order.

        Load ratio, coupling, branch and whether a scene is given by its kappa count only if one of
        them is not the default in some scene.
        """
        fixed = self.fixed
        table = self.table
        if not self.unloaded and "unloaded_to" not in self.axes:
            fixed = (*fixed[:_UNLOADED], *fixed[_UNLOADED + 1 :])
            table = None if table is None else np.delete(table, _UNLOADED, axis=0)
        digest = hashlib.sha256(repr((fixed, list(self.axes))).encode())
        for values in self.axes.values() if table is None else [table]:
            digest.update(repr(values.shape).encode() + values.astype("<f8").tobytes())
        for one in self.forms:
            kinds = [kind_tree(part) for part in one[:2] if part is not None]
            digest.update("".join(map(repr, kinds)).encode())
        if self.coupled:
            digest.update(repr([one.coupling for one in self.forms]).encode())
        if any(one.branch for one in self.forms):
            digest.update(repr([one.branch for one in self.forms]).encode())
        if any(one.by_kappa for one in self.forms):
            digest.update(repr([one.by_kappa for one in self.forms]).encode())
        return digest.hexdigest()


def grid(
    base: Scene, axes: Mapping[str, Any], law: Mapping[str, Any] | None = None
) -> SweepParameters:
    """Return the scenes in which every given parameter takes every one of its values.

    Parameters
    ----------
    base : Scene
        Has the parameters that are not given.
    axes : mapping of str to array_like
        Values of parameters, by names out of `PARAMETERS` or kappa; None for what does not vary.
    law : mapping of str to array_like, optional
        Values of parameters of the layer's law, by name.
    """
    material = [name for name in (KAPPA, PARAMETERS[0]) if axes.get(name) is not None]
    if len(material) > 1:
        raise SceneError(KAPPA, axes[KAPPA], "None where poisson_ratio is given")
    axis_values = {
        name: _axis(base, name, axes[name])
        for name in (KAPPA, *PARAMETERS)
        if axes.get(name) is not None
    }
    if material:
        base = changed(base, {material[0]: float(axis_values[material[0]][0])})
    controls = [name for name in axis_values if name in ALL_CONTROLS]
    if len(controls) > 1:
        allowed = f"left out if {controls[1]} is given: vary one of load, approach, contact radius"
        raise SceneError(controls[0], axes[controls[0]], allowed)
    if controls:
        base = changed(base, {controls[0]: float(axis_values[controls[0]][0])})
    axes_of_law = _axes_of_law(base, {} if law is None else law)
    without_axes = alone(base)
    fixed = without_axes.fixed + tuple(float(axis[0]) for axis in axes_of_law.values())
    axis_values |= {_LAW_PREFIX + name: axis for name, axis in axes_of_law.items()}
    return replace(without_axes, fixed=fixed, axes=axis_values, law=tuple(axes_of_law))


def listed(scenes: Iterable[Scene], changes: Mapping[str, Any] | None = None) -> SweepParameters:
    """Return the scenes of a list, at least one, with the same changes made to each."""
    rows: list[tuple[float, ...]] = []
    forms: list[SceneForm] = []
    for number, scene in enumerate(scenes):
        changed_scene = changed(scene, changes or {})
        if rows and (changed_scene.profile is None) != (forms[0].profile is None):
            first = forms[0].profile
            allowed = "with a profile, as the first" if first else "without one, as the first"
            raise SceneError(f"scenes[{number}]", scene, allowed)
        rows.append(_row(changed_scene))
        forms.append(SceneForm.of(changed_scene))
    shaped = forms[0].profile is not None
    count = len(PARAMETERS) if shaped else _FLAT_COUNT
    table = np.array(rows).T[:count].copy()
    same_form = not shaped and len(set(forms)) == 1
    common = tuple(forms[:1] if same_form else forms)
    return SweepParameters((math.nan,) * count, {}, table, common)


def changed(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Return a changed scene; a given load, approach, radius or separation replaces the scene's."""
    given = any(changes.get(name) is not None for name in ALL_CONTROLS)
    changes = {**dict.fromkeys(ALL_CONTROLS if given else ()), **changes}
    if scene.physical is None:
        return scene.replace(**changes)
    if KAPPA in changes:
        raise SceneError(KAPPA, changes[KAPPA], "left out of scenes with SI data, which imply it")
    return replace(scene, **changes)


def alone(scene: Scene) -> SweepParameters:
    """Return one scene as a grid without dimensions."""
    count = _FLAT_COUNT if scene.profile is None else len(PARAMETERS)
    return SweepParameters(_row(scene)[:count], {}, forms=(SceneForm.of(scene),))


def _row(scene: Scene) -> tuple[float, ...]:
    """Return the parameters of a scene in the order of `PARAMETERS`; NaN for None."""
    given = [getattr(scene, name) for name in PARAMETERS]
    if scene.mismatch is not None:
        given[0] = scene.mismatch
    return tuple(math.nan if one is None else one for one in given)


def _chosen(
    forms: tuple[SceneForm, ...], chosen: slice | Indices | NDArray[np.bool_]
) -> tuple[SceneForm, ...]:
    """Return the forms of some of the scenes; a single form is that of all."""
    if len(forms) == 1:
        return forms
    return tuple(forms[k] for k in np.arange(len(forms))[chosen].tolist())


def _axes_of_law(base: Scene, law: Any) -> dict[str, Array]:
    """Return the values of every parameter of the layer's law that varies, in the law's order."""
    if not isinstance(law, Mapping):
        raise SceneError("layer", law, "a mapping of parameters of the law to their values")
    if not law:
        return {}
    if base.layer is None:
        raise SceneError("layer", law, "None for a scene without a layer")
    kind: Any = base.layer
    numbers = [one.name for one in fields(kind) if isinstance(getattr(kind, one.name), float)]
    for name in law:
        one_of("layer", name, numbers, f"a number of the law: {', '.join(numbers) or 'none'}")
    axes = {}
    for name in (one for one in numbers if one in law):
        axes[name] = _numbers(_LAW_PREFIX + name, law[name])
        for value in {axes[name].min(), axes[name].max()}:  # the allowed values are an interval
            changed(base, {"layer": replace(kind, **{name: float(value)})})
    return axes


def _axis(base: Scene, name: str, values: Any) -> Array:
    """Return the values of one parameter; `Scene` says what is wrong with them."""
    array = _numbers(name, values)
    # allowed are 0 and an interval: the least, the largest and the smallest other than 0 decide
    size = np.abs(array)
    suspects = [array.min(), array.max(), array[np.argmin(np.where(size > 0.0, size, np.inf))]]
    for suspect in suspects:  # each of which is NaN if any value is
        changed(base, {name: float(suspect)})
    return array


def _numbers(name: str, values: Any) -> Array:
    array = np.asarray(reals(name, values, "a list of real numbers") + 0.0, dtype=np.float64)
    if array.ndim != 1 or array.size == 0:
        raise SceneError(name, values, "a list of at least one number")
    return array
