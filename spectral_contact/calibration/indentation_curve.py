"""Modulus, layer and zero point from a force-indentation curve under any profile.

With ``E' = E*/4`` a load is ``E' L(delta; alpha E')``, where L is the theory's in the units of the
profile. All derivatives are exact: by the approach it is the flat punch's stiffness, and by the
layer ``-int p p^ dA`` with ``p^ = dp/ddelta``, the flat punch's pressure: the work of an approach
is an extremum, ``dW/dalpha = -1/2 int p^2 dA``, and the load is its derivative (docs/indentation).
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.calibration.force_curves import baseline, touch_depth
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.calibration.load_curves import CurvePoint, LoadCurve
from spectral_contact.contact.contact_radius import RadiusScale, find_radius, indenter, value_of
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.pinned import PinnedContact
from spectral_contact.equations.residuals import load as half_load
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields import Array
from spectral_contact.fields.curves import LEAST
from spectral_contact.io.choices import one_of
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.io.parameters import parameters_of
from spectral_contact.layers.scene_layer import KINDS as LAWS
from spectral_contact.profiles import Flat, Profile
from spectral_contact.scene import Scene

#: Of the instrument: the depth at which the punch touches [m], the load that is measured there
#: without contact [N], and by how much it grows with depth [N/m].
OF_INSTRUMENT: Final = ("zero_point", "load_offset", "tilt")
#: Parameters that can be fitted through a linear layer: E* [Pa], alpha [m/Pa], and those of the
#: instrument.
INDENTATION_PARAMETERS: Final = ("reduced_modulus", "normal_compliance", *OF_INSTRUMENT)
#: Units of all parameters that can be fitted, those of a layer's law included.
_UNITS: Final = {
    **dict(zip(INDENTATION_PARAMETERS, ("Pa", "m/Pa", "m", "N", "N/m"), strict=True)),
    "work_of_adhesion": "J/m²",
    **{
        name: one.unit.replace("^2", "²")
        for law in LAWS.values()
        for name, one in parameters_of(law).items()
    },
}
_MOST_UNKNOWNS: Final = 20_000
#: Tolerance of a curve that a fit starts from.
_START_TOLERANCE: Final = 1e-4
#: If a singular value of the scaled derivatives is below this, the data do not distinguish the
#: parameters.
_LEAST_SINGULAR_VALUE: Final = 1e-7
#: Standard deviations of a logarithm beyond which a parameter is not determined.
_LARGEST_ERROR: Final = 10.0


#: Loads of more standard deviations than this are no noise.
_NOISE_DEVIATIONS: Final = 3.0
#: The first touch is above the first row with such a load, by at least this fraction of the range
#: of all depths.
_TOUCH_MARGIN: Final = 0.01
#: Largest approach of a first guess over that at which the contact reaches the end of the profile.
_SHORT_OF_END: Final = 0.999
#: Load of the second row of a first guess over that of the deepest one.
_SECOND_LOAD: Final = 0.25
#: A remark says that the fitted curve is not the measured one if chi square over its degrees of
#: freedom is above this, and the probability of the next constant is small, too.
_LARGEST_REDUCED_CHI_SQUARE: Final = 2.0
#: Probability, below which chance does not explain that chi square is as large or larger.
_LEAST_CHANCE: Final = 1e-6
#: A baseline without load may differ from zero by this many standard deviations of its mean.
_BASELINE_DEVIATIONS: Final = 5.0


@dataclass(frozen=True, slots=True)
class IndentationFit:
    """The outcome of a fit of a force-indentation curve.

    Attributes
    ----------
    scene : Scene
        With the modulus and layer that fit best.
    names : tuple of str
        The parameters, in the order in which they were asked for.
    values : tuple of float
        ``reduced_modulus`` is E* [Pa], ``normal_compliance`` alpha [m/Pa], ``zero_point`` the depth
        of first touch [m], that of zero approach under a nonlinear layer; numbers of its law as in
        SI units. ``load_offset`` [N] and ``tilt`` [N/m] are a straight line that is added to the
        loads: its value at the zero point and its slope. ``work_of_adhesion`` is w [J/m²].
    errors : tuple of float
        Their standard deviations, in the same units; to first order. NaN where the fitted contact
        has come off at rows that count as contact: a remark says so.
    covariance : tuple of tuple of float
        ``(J^T J)^-1`` of zero point, offset and tilt, and of the logarithms of all others; it takes
        the standard deviations of the data for known.
    residuals : tuple of float
        Theory minus measurement over standard deviation.
    evaluations : int
        Number of predictions of the curve.
    data : IndentationData
    remarks : tuple of str
        Remarks on the data, and reasons to doubt the fit.
    """

    scene: Scene
    names: tuple[str, ...]
    values: tuple[float, ...]
    errors: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    residuals: tuple[float, ...]
    evaluations: int
    data: IndentationData
    remarks: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        if name not in self.names:
            raise KeyError(name)
        return self.values[self.names.index(name)]

    def error(self, name: str) -> float:
        """Return the standard deviation of a parameter; `SceneError` if it was not fitted."""
        return self.errors[self.names.index(one_of("name", name, self.names))]

    @property
    def loads(self) -> tuple[float, ...]:
        """The fitted loads at the depths of the data [N]."""
        rows = zip(self.data.load, self.residuals, self.data.sigma, strict=True)
        return tuple(load + residual * sigma for load, residual, sigma in rows)

    @property
    def chi_square(self) -> float:
        """Sum of the squares of the residuals."""
        return math.fsum(residual * residual for residual in self.residuals)

    @property
    def degrees_of_freedom(self) -> int:
        """Number of loads less that of the parameters."""
        return len(self.residuals) - len(self.names)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write measured and fitted loads at the depths, and the residuals.

        Raises
        ------
        SolutionFileError
            If the file cannot be written.
        """
        data = self.data
        columns = data.depth, data.load, data.sigma, self.loads, self.residuals
        lines = ["depth [m],load [N],sigma [N],fitted load [N],residual / sigma"]
        lines += [",".join(map(str, row)) for row in zip(*columns, strict=True)]
        path = path_text(path)
        with reported(path, "cannot be written"):
            replace_file(path, ("\n".join(lines) + "\n").encode())

    def __str__(self) -> str:
        lines = [f"{'parameter':<20} {'value':>12}  standard deviation"]
        for name, value, error in zip(self.names, self.values, self.errors, strict=True):
            lines.append(f"{name:<20} {value:12.5g}  {error:.2g} {_UNITS[name]}".rstrip())
        freedom = f"{self.degrees_of_freedom} degrees of freedom"
        lines.append(f"chi square {self.chi_square:.4g} at {freedom}")
        extremes = f"{min(self.residuals):.2f} to {max(self.residuals):.2f}"
        lines.append(f"residuals from {extremes} standard deviations")
        lines += self.remarks
        physical = self.scene.physical
        if physical is not None and physical.youngs_modulus is not None:
            at = f"at a Poisson's ratio of {self.scene.poisson_ratio:g}"
            modulus = f"{physical.youngs_modulus:.5g} Pa"
            lines.append(f"Young's modulus {modulus}, {self._modulus_text}{at}")
        return "\n".join(lines)

    @property
    def _modulus_text(self) -> str:
        """The standard deviation of Young's modulus, that of E* but for the share of the punch."""
        if "reduced_modulus" not in self.names:
            return ""
        physical = self.scene.physical
        nu = self.scene.poisson_ratio
        assert physical is not None
        relative = self.error("reduced_modulus") / self["reduced_modulus"]
        # of an elastic punch E* = E'1 E'2/(E'1 + E'2), of which E'2 is known
        error = relative / physical.compliance_share(nu) * float(physical.youngs_modulus or 0.0)
        return f"standard deviation {error:.2g}, "


def first_modulus(profile: Profile, data: IndentationData) -> float:
    """Return E* [Pa] of a smooth half-space that carries the largest load at the largest depth.

    A fit may start there.
    """
    depth, load, sigma = map(np.array, (data.depth, data.load, data.sigma))
    line = baseline(depth, load)
    loads_above = load - (0.0 if line is None else line.at(depth))
    deepest = int(np.argmax(depth))
    approach = float(depth[deepest]) - _first_touch(profile, depth, loads_above, sigma)
    if not (approach > 0.0 and loads_above[deepest] > 0.0):
        raise SceneError("load", float(loads_above[deepest]), "above 0 at the largest depth")
    return (
        4.0
        * float(loads_above[deepest])
        / curve_load(profile, approach, 0.0, _START_TOLERANCE).value
    )


def _first_touch(profile: Profile, depth: Array, load: Array, sigma: Array) -> float:
    """Return a guess of the depth of first touch [m].

    It is that of a smooth contact with the loads of two rows, the deepest one and one of a quarter
    of its load. If the first load that is no noise is at a smaller depth, the guess is a little
    above that depth, so that every load counts.
    """
    from scipy.optimize import brentq  # takes long to import

    touch = touch_depth(depth, load, _NOISE_DEVIATIONS * sigma) - _TOUCH_MARGIN * float(
        np.ptp(depth)
    )
    order = np.argsort(depth, kind="stable")
    deep = float(depth[order[-1]])
    largest_load = float(load[order[-1]])
    row = order[np.argmax(load[order] >= _SECOND_LOAD * largest_load)]
    middle = float(depth[row])
    middle_load = float(load[row])
    if not (touch < middle < deep and 0.0 < middle_load < largest_load):
        return touch

    def excess(start: float) -> float:
        loads = [
            curve_load(profile, d - start, 0.0, _START_TOLERANCE).value for d in (deep, middle)
        ]
        return math.log(loads[0] / loads[1] * middle_load / largest_load)

    ends = max(2.0 * touch - deep, deep - _most_approach(profile)), touch
    if not excess(ends[0]) < 0.0 < excess(ends[1]):
        return touch
    return float(brentq(excess, *ends, rtol=_START_TOLERANCE))


def _most_approach(profile: Profile) -> float:
    """Return the approach at which a smooth contact comes close to the end of a profile."""
    if isinstance(profile, Flat) or math.isinf(profile.reach):
        return math.inf
    with np.errstate(divide="ignore"):
        return _SHORT_OF_END * float(profile._transform(np.array(profile.reach))) / 2.0


def with_modulus(scene: Scene, data: IndentationData) -> Scene:
    """Return a scene in SI units with the modulus of the half-space from which a fit may start."""
    assert scene.profile is not None
    modulus = first_modulus(scene.profile, data)
    nu = scene.poisson_ratio
    if nu is None:
        return scene.replace(reduced_modulus=modulus)
    return scene.replace(youngs_modulus=modulus * (1.0 - nu * nu))


class _CurveLoad(NamedTuple):
    """``L = P/E'`` and its derivatives."""

    value: float
    by_approach: float
    by_layer: float


def curve_load(profile: Profile, approach: float, layer: float, rtol: float) -> _CurveLoad:
    """Return the load of an approach, over E', with its derivatives, all to the tolerance.

    Parameters
    ----------
    profile : Profile
    approach : float
        0 or less is no contact.
    layer : float
        ``alpha E'``, a length; if 0, the derivative by it is taken for 0.
    rtol : float
    """
    if approach <= 0.0:
        return _CurveLoad(0.0, 0.0, 0.0)
    contact = _contact_at(profile, approach, layer, rtol)
    error = max(contact.load_error, contact.stiffness_error)
    if error > 10.0 * rtol:
        cause = f"load and stiffness of {profile.brief} at {approach:.6g} are known to {error:.1e}"
        raise ConvergenceError(cause, "loosen rtol.")
    return _load_with_derivatives(profile, contact, layer)


def _contact_at(profile: Profile, approach: float, layer: float, rtol: float) -> Indentation:
    if isinstance(profile, Flat):
        punch = PinnedContact(
            profile.reach, layer, 0.0, rtol, _MOST_UNKNOWNS, pointwise=layer > 0.0
        )
        return value_of(punch.under(punch.load_of(approach), approach))
    solve = indenter(profile, layer, _MOST_UNKNOWNS)
    try:
        solved, _ = find_radius(
            profile, solve, rtol, load=None, approach=approach, pointwise=layer > 0.0
        )
    except SceneError as error:
        if error.parameter != "approach":
            raise
        raise beyond_profile(profile, approach) from error
    return value_of(solved)


def beyond_profile(profile: Profile, approach: float) -> SceneError:
    """Return the error of a depth at which the contact would grow to the end of a profile."""
    allowed = (
        f"such that the contact stays inside the profile, which ends at {profile.reach:.6g}: the "
        "approach, from the first touch on, is too large"
    )
    return SceneError("depth", approach, allowed)


def _load_with_derivatives(profile: Profile, contact: Indentation, layer: float) -> _CurveLoad:
    """Return the load of a contact with its derivatives."""
    if layer == 0.0:
        return _CurveLoad(contact.load, contact.stiffness, 0.0)
    pressure = contact.pressure
    flat = contact.flat
    a = contact.radius
    assert pressure is not None

    def product(d: Array) -> Array:
        p = pressure(1.0 - d, d)
        return np.asarray(p * (a * p / contact.approach if flat is None else flat(1.0 - d, d)))

    integral = half_load(product, breaks=cuts(profile, a, layer / a))
    return _CurveLoad(contact.load, contact.stiffness, -2.0 * math.pi * a * integral)


def curve_loads(profile: Profile, approaches: Array, layer: float, rtol: float) -> Array:
    """Return loads of many approaches with their derivatives, each as of `curve_load`.

    Few contact radii are solved, and polynomials go through them. Those of a flat punch are
    proportional to the approach.

    Parameters
    ----------
    profile : Profile
    approaches : ndarray, shape (approaches,)
    layer, rtol : float
        As of `curve_load`.

    Returns
    -------
    ndarray, shape (approaches, 3)
    """
    result = np.zeros((len(approaches), 3))
    in_contact, positions = np.unique(approaches[approaches > 0.0], return_inverse=True)
    if isinstance(profile, Flat) and len(in_contact):
        deepest = curve_load(profile, float(in_contact[-1]), layer, rtol)
        fractions = (in_contact / in_contact[-1]).tolist()
        rows = [
            _CurveLoad(fraction * deepest.value, deepest.by_approach, fraction * deepest.by_layer)
            for fraction in fractions
        ]
    elif len(in_contact) < LEAST:
        rows = [curve_load(profile, approach, layer, rtol) for approach in in_contact.tolist()]
    else:
        rows = list(map(_CurveLoad._make, _interpolated(profile, in_contact, layer, rtol).tolist()))
    if rows:
        result[approaches > 0.0] = np.array(rows)[positions]
    return result


def _interpolated(profile: Profile, approaches: Array, layer: float, rtol: float) -> Array:
    """Return the rows of rising approaches from those of few radii."""
    scale = RadiusScale(profile)
    solve = indenter(profile, layer, _MOST_UNKNOWNS)

    def curve_point(contact: Indentation) -> CurvePoint:
        load = _load_with_derivatives(profile, contact, layer)
        logarithms = np.log([contact.approach, load.value, load.by_approach])
        functions = np.array([*logarithms[1:], layer * load.by_layer / load.value])
        error = contact.load_error
        errors = np.array([contact.approach_error, error, contact.stiffness_error, error])
        return CurvePoint(float(logarithms[0]), functions, errors)

    def at_place(place: float) -> CurvePoint:
        return curve_point(value_of(solve(scale.radius(place), rtol, layer > 0.0)))

    def point_of_approach(logarithm: float) -> CurvePoint:
        return curve_point(_contact_at(profile, math.exp(logarithm), layer, rtol))

    ends = [_contact_at(profile, one, layer, rtol) for one in approaches[[0, -1]].tolist()]
    first, last = (one.radius for one in ends)
    breaks = [one for one in profile.breaks if first < one < last]
    places = [scale.place(radius) for radius in (first, *breaks, last)]
    load, stiffness, by_layer = (
        LoadCurve(at_place, point_of_approach, rtol).values(places, np.log(approaches)).T
    )
    value = np.exp(load)
    # without a layer the derivative by it is 0
    return np.stack([value, np.exp(stiffness), value * by_layer / (layer or 1.0)], axis=1)


def cuts(profile: Profile, radius: float, finest: float) -> list[float]:
    """Return distances from the edge, over the radius, between which the pressure is smooth.

    They are graded toward the edge, breaks of the profile and the centre of a tip, where the
    pressure changes over no smaller distance than `finest`, over the radius.
    """
    steps = 10.0 ** -np.arange(1.0, 15.0)
    steps = np.append(steps[steps > finest / 30.0], 0.0)
    inside = [1.0 - b / radius for b in profile.breaks if b < radius]
    corners = [0.0, *([1.0] if profile.pointed else []), *inside]
    around = np.add.outer(corners, [-steps, steps]).ravel().tolist()
    return [d for d in around if 0.0 < d < 1.0]


class CurveProblem:
    """Residuals and derivatives by ln E*, ln alpha and the zero point."""

    @staticmethod
    def parameters(scene: Scene) -> tuple[str, ...]:
        """Return the names of the parameters that can be free."""
        return INDENTATION_PARAMETERS

    def __init__(
        self, scene: Scene, data: IndentationData, free: tuple[str, ...], rtol: float
    ) -> None:
        physical = scene.physical
        profile = scene.profile
        if profile is None or physical is None or scene.friction:
            allowed = "one of Scene.from_physical with a profile and without friction"
            raise SceneError("scene", scene, allowed)
        if not free or len(set(free)) < len(free):
            allowed = f"one or more of {', '.join(self.parameters(scene))}, each once"
            raise SceneError("free", free, allowed)
        if len(data.load) < len(free):
            allowed = f"at most {len(data.load)} parameters, the number of loads measured"
            raise SceneError("free", free, allowed)
        self.known = {
            "reduced_modulus": 4.0 * physical.quarter_modulus(scene.poisson_ratio),
            **dict.fromkeys(OF_INSTRUMENT, 0.0),
            **self._layer_values(scene),
        }
        if "normal_compliance" in free and not self.known["normal_compliance"] > 0.0:
            allowed = "> 0 where it is free: the fit starts there"
            raise SceneError("normal_compliance", physical.normal_compliance, allowed)
        self.scene = scene
        self.profile = profile
        self.free = free
        self.data = data
        self.depth, self.load, self.sigma = map(np.array, (data.depth, data.load, data.sigma))
        self.line = baseline(self.depth, self.load)
        extent = float(np.ptp(self.depth)) or 1.0
        force = float(np.ptp(self.load)) or 1.0
        start = {**dict.fromkeys(free, 0.0), **self._line_start()}
        if "zero_point" in free:
            touch = _first_touch(profile, self.depth, self._loads_above_baseline(), self.sigma)
            start["zero_point"] = touch
        scale = {"zero_point": extent, "load_offset": force, "tilt": force / extent}
        self.start = [start[name] for name in free]
        self.scale = [scale.get(name, 1.0) for name in free]
        self.take_tolerance(rtol)
        self.evaluations = 0

    def improve_start(self) -> None:
        """Start from the modulus that gives the deepest row the load measured."""
        if "reduced_modulus" in self.free:
            self.start[self.free.index("reduced_modulus")] = self._first_modulus()

    def take_tolerance(self, rtol: float) -> None:
        """Solve with another tolerance from now on."""
        self.rtol = rtol
        self.at = partial(self._kept_residuals, {})

    @staticmethod
    def _layer_values(scene: Scene) -> dict[str, float]:
        assert scene.physical is not None
        return {"normal_compliance": scene.physical.normal_compliance}

    def _line_start(self) -> dict[str, float]:
        """Return the values of offset and tilt from which a search starts, if they are free."""
        if self.line is None:
            return {}
        first = float(self.line.at(self.depth.min()))
        level = first if "tilt" in self.free else self.line.level
        start_values = {"load_offset": level, "tilt": self.line.tilt}
        return {name: value for name, value in start_values.items() if name in self.free}

    def _loads_above_baseline(self) -> Array:
        """Return the loads above the baseline."""
        return self.load - (0.0 if self.line is None else self.line.at(self.depth))

    def _first_modulus(self) -> float:
        """Return the start of ln E* with which the deepest row has the load measured."""
        values = self.values(self.start)
        start = self.start[self.free.index("reduced_modulus")]
        deepest = int(np.argmax(self.depth))
        [load] = self._loads(values, self.depth[[deepest]] - values["zero_point"])
        ratio = float(self._loads_above_baseline()[deepest]) / load if load else 0.0
        return start + math.log(ratio) if ratio > 0.0 else start

    def _loads(self, values: dict[str, float], approach: Array) -> Array:
        """Return the loads of approaches in contact."""
        return self.curve(values, approach)[0]

    def bounds(self) -> tuple[list[float], list[float]]:
        """Return lower and upper bounds of x in the search."""
        return [-math.inf] * len(self.free), [math.inf] * len(self.free)

    def _searched(self, y: Array) -> tuple[Array, Array]:
        """Return x and its derivatives by the variables y of a search.

        x is the logarithm of a parameter over its start, or a number of the instrument itself. y is
        1 at the start and grows like x in units of its scale. But for a compliance above its start
        y is the compliance over its start, not the logarithm, since loads are nearly linear in it.
        """
        compliances = np.array([name == "normal_compliance" for name in self.free])
        grown = np.where(compliances, np.maximum(y, 1.0), 1.0)
        scale = np.array(self.scale)
        return self.start + scale * (y - grown + np.log(grown)), scale / grown

    def residuals(self, y: Array) -> Array:
        """Return theory minus measurement over standard deviation."""
        return np.asarray(self.at(tuple(self._searched(y)[0].tolist()))[0])

    def jacobian(self, y: Array) -> Array:
        """Return the derivatives of the residuals by y."""
        x, rates = self._searched(y)
        return np.asarray(self.at(tuple(x.tolist()))[1] * rates)

    @staticmethod
    def _is_log(name: str) -> bool:
        return name not in OF_INSTRUMENT

    def values(self, x: Sequence[float]) -> dict[str, float]:
        """Return the parameters: logarithms are over their start."""
        fitted = {
            name: self.known[name] * math.exp(number) if self._is_log(name) else number
            for name, number in zip(self.free, x, strict=True)
        }
        return self.known | fitted

    def _kept_residuals(self, cache: dict[Any, tuple[Array, Array]], x: tuple[float, ...]) -> Any:
        """Return residuals and their derivatives; the last are kept."""
        if x not in cache:
            cache.clear()
            self.evaluations += 1
            values = self.values(x)
            approach = self.depth - values["zero_point"]
            value, columns = self.curve(values, approach)
            value = value + values["load_offset"] + values["tilt"] * approach
            columns["zero_point"] = columns["zero_point"] - values["tilt"]
            columns["load_offset"] = np.ones(len(approach))
            columns["tilt"] = approach
            jacobian = np.stack([columns[name] for name in self.free], axis=1)
            jacobian = self.turned(jacobian, x, 1.0)
            cache[x] = (value - self.load) / self.sigma, jacobian / self.sigma[:, None]
        return cache[x]

    def curve(self, values: dict[str, float], approach: Array) -> tuple[Array, Any]:
        """Return the loads of all approaches, and their derivatives by name."""
        quarter = values["reduced_modulus"] / 4.0
        layer = values["normal_compliance"] * quarter
        rows = curve_loads(self.profile, approach, layer, self.rtol)
        value, by_approach, by_layer = quarter * rows.T
        return value, {
            "reduced_modulus": value + layer * by_layer,
            "normal_compliance": layer * by_layer,
            "zero_point": -by_approach,
        }

    def turned(self, jacobian: Array, x: Sequence[float], sense: float) -> Array:
        """Return a Jacobian by the logarithms of the parameters as one by x.

        With the sense -1 the one by x is given, and the other returned. Here both are the same; a
        subclass may search for something else than these logarithms.
        """
        return jacobian

    def best(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the layer that fits best, as a scene takes it."""
        return {"normal_compliance": values["normal_compliance"]}

    def _material(self, reduced: float) -> dict[str, float]:
        """Return the arguments of a scene for a reduced modulus; a punch stays as it was given."""
        nu = self.scene.poisson_ratio
        data = self.scene.physical
        assert data is not None
        if nu is None:
            return {"reduced_modulus": reduced}
        if data.punch_youngs_modulus is None or data.punch_poisson_ratio is None:
            return {"youngs_modulus": reduced * (1.0 - nu) * (1.0 + nu)}
        punch_nu = data.punch_poisson_ratio
        punch_share = reduced * (1.0 - punch_nu) * (1.0 + punch_nu) / data.punch_youngs_modulus
        if not punch_share < 1.0:
            allowed = "such that the punch alone does not give way more than both do"
            raise SceneError("punch_youngs_modulus", data.punch_youngs_modulus, allowed)
        return {"youngs_modulus": reduced * (1.0 - nu) * (1.0 + nu) / (1.0 - punch_share)}

    def outcome(self, y: Array, at_bounds: NDArray[np.int_]) -> IndentationFit:
        """Return the record, if the data determine all parameters."""
        x = tuple(self._searched(y)[0].tolist())
        residuals, jacobian = self.at(x)
        deviations = np.sqrt(np.diag(self.covariance(jacobian)))
        for name, size in zip(self.free, deviations, strict=True):
            if self._is_log(name) and size > _LARGEST_ERROR:
                raise SceneError("free", self.free, f"determined by the data, as {name} is not")
        for name, side in zip(self.free, at_bounds, strict=True):
            if side:
                end = f"{self.values(x)[name]:.4g}"
                allowed = f"without {name}, which comes to {end}, an end of its range: fix it there"
                raise SceneError("free", self.free, allowed)
        covariance = self.covariance(self.turned(jacobian, x, -1.0))
        values = self.values(x)
        errors = [
            float(size) * (values[name] if self._is_log(name) else 1.0)
            for name, size in zip(self.free, np.sqrt(np.diag(covariance)), strict=True)
        ]
        material = self._material(values["reduced_modulus"])
        scene = self.scene.replace(**material, **self.best(values))
        return IndentationFit(
            scene,
            self.free,
            tuple(values[name] for name in self.free),
            tuple(errors),
            tuple(tuple(row) for row in covariance.tolist()),
            tuple(residuals.tolist()),
            self.evaluations,
            self.data,
            (*self.data.remarks, *self._remarks_on_fit(residuals)),
        )

    def _remarks_on_fit(self, residuals: Array) -> list[str]:
        """Return reasons to doubt the fit."""
        from scipy.special import chdtrc  # takes long to import

        remarks = []
        chi_square = float(residuals @ residuals)
        freedom = len(residuals) - len(self.free)
        by_chance = float(chdtrc(freedom, chi_square)) if freedom else 1.0
        if by_chance < _LEAST_CHANCE and chi_square > _LARGEST_REDUCED_CHI_SQUARE * freedom:
            remarks.append(
                f"chi square is {chi_square / freedom:.3g} a degree of freedom: the loads are not "
                "those of elastic contact of this punch within their standard deviations, which "
                "plastic flow, another shape of the tip, adhesion or an offset can cause; the "
                "deviations of the parameters do not cover it"
            )
        if self.line is not None and "load_offset" not in self.free:
            deviation = self.line.sigma / math.sqrt(self.line.points)
            if abs(self.line.level) > _BASELINE_DEVIATIONS * deviation:
                remarks.append(f"the baseline is at {self.line.level:.3g} N: free load_offset")
        return remarks

    def covariance(self, jacobian: Array) -> Array:
        """Return ``(J^T J)^-1``; `SceneError` if the data do not tell the parameters apart."""
        lengths = np.linalg.norm(jacobian, axis=0)
        if not (lengths > 0.0).all():
            ineffective = [
                name for name, one in zip(self.free, lengths, strict=True) if not one > 0.0
            ]
            listed = " and ".join(ineffective)
            allowed = f"determined by the data, which do not change with {listed}"
            raise SceneError("free", self.free, allowed)
        _, singular, right = np.linalg.svd(jacobian / lengths, full_matrices=False)
        if singular[-1] < _LEAST_SINGULAR_VALUE:
            allowed = "determined by the data, which cannot distinguish them"
            raise SceneError("free", self.free, allowed)
        root = right.T / singular / lengths[:, None]
        return np.asarray(root @ root.T)

    def look(self) -> None:
        """Look at the start before the search."""

    def revises_rows(self, y: Array) -> bool:
        """Return whether other rows than before are in contact, after a search that ended at y."""
        return False
