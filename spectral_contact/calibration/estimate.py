"""The fit: weighted least squares in the logarithms of the parameters.

Fits of several layers are compared by an information criterion: which law do the data support?
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, overload

import numpy as np

from spectral_contact.calibration.curve_fit import fit_curve
from spectral_contact.calibration.indentation_curve import IndentationFit
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.calibration.measurements import Data
from spectral_contact.calibration.outcome import FittedParameter, RoughnessFit, least_squares_fit
from spectral_contact.calibration.setting import PARAMETERS, SLOPE_ERROR, Setting
from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import whole, within
from spectral_contact.io.choices import instance, names, suggesting
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve
from spectral_contact.view.progress import ProgressLine

#: The range that is searched, within that of scenes.
_COMPLIANCES = 1e-13, 1e13
_FRICTIONS = 1e-6, 1e6
#: A parameter whose logarithm has a larger standard deviation is not determined.
_LARGEST_ERROR = 10.0
#: A law is ruled out if its criterion is larger than the least one by more than this: the law with
#: the least one is twenty times as likely.
_RULED_OUT: Final = 6.0


@overload
def fit(
    scene: Scene,
    data: IndentationData,
    free: str | Sequence[str],
    *,
    rtol: float = 1e-10,
    max_evaluations: int = 200,
    progress: bool | None = None,
) -> IndentationFit: ...


@overload
def fit(
    scene: Scene,
    data: Data | Sequence[Data],
    free: str | Sequence[str],
    *,
    rtol: float = 1e-10,
    max_evaluations: int = 200,
    progress: bool | None = None,
) -> RoughnessFit: ...


@suggesting()
def fit(
    scene: Scene,
    data: Data | Sequence[Data] | IndentationData,
    free: str | Sequence[str],
    *,
    rtol: float = 1e-10,
    max_evaluations: int = 200,
    progress: bool | None = None,
) -> RoughnessFit | IndentationFit:
    """Find compliances and friction that fit measured data best.

    Minimises the sum of the squares of (theory − measurement)/σ over the logarithms of the free
    parameters, by `scipy.optimize.least_squares`.

    Parameters
    ----------
    scene : Scene
        Holds the known parameters and the starting values of the free ones, each above 0. If it
        was made by `Scene.from_physical`, the data are in SI units too.
    data : ApproachData, PressureData, StickRadiusData, or a sequence of them
        Measurements of one material, layer and friction, unless they state otherwise;
        `IndentationData` for a scene with a profile. With elastic coupling only stick radii.
    free : str or sequence of str
        The parameters to find, out of ``"normal_compliance"``, ``"tangential_compliance"`` and
        ``"friction"``. The others keep the values of the scene. With `IndentationData` out of
        ``"reduced_modulus"``, ``"normal_compliance"``, ``"zero_point"``, ``"load_offset"`` and
        ``"tilt"``, where the numbers of a nonlinear layer's law take the place of the compliance.
        If the scene has a work of adhesion, ``"work_of_adhesion"``, too.
    rtol : float
        Tolerance of the solves, in [1e-12, 1e-4].
    max_evaluations : int
        Largest number of predictions of the data, not counting derivatives.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    RoughnessFit or IndentationFit

    Raises
    ------
    SceneError
        For an argument out of its range, and for free parameters that the data do not determine;
        it names them.
    ConvergenceError
        If a solve does not meet `rtol`, in which case it names the scene, or if
        `max_evaluations` are not enough.

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> from spectral_contact.calibration import ApproachData, fit
    >>> data = ApproachData([0.294, 0.167], sigma=0.001, radius=[1.0, 1.0], load=[1.0, 0.57])
    >>> found = fit(Scene(0.3, normal_compliance=0.1), data, free="normal_compliance")
    >>> print(found)
    parameter                     value  95 % interval
    normal_compliance           0.50247  0.49718 to 0.50781
    chi square 0.2539 at 1 degrees of freedom, p = 0.61
    """
    instance("scene", scene, Scene)
    rtol = within("rtol", rtol, "in [1e-12, 1e-4]")
    most = whole("max_evaluations", max_evaluations, 1)
    if isinstance(data, IndentationData):
        return fit_curve(scene, data, free, rtol, most, progress)
    problem = _FitProblem(scene, _measurements(data), _names(free), rtol)
    with ProgressLine(progress) as tell:
        return problem.outcome(most, tell)


__test__: Final = {"fit": fit}  # doctest passes over functions that are wrapped


class _FitProblem:
    """The problem of a fit in the variables ``x = ln(parameter/start)``, one for each free one.

    It has residuals and their derivatives by x.
    """

    def __init__(
        self, scene: Scene, data: tuple[Data, ...], free: tuple[str, ...], rtol: float
    ) -> None:
        self.scene = scene
        self.data = data
        self.free = free
        self.setting = Setting.of(scene, rtol, solve)
        source = scene if scene.physical is None else scene.physical
        self.start: dict[str, float | None] = {
            name: getattr(source, name) for name in PARAMETERS[:2]
        }
        self.start["friction"] = scene.friction
        self.measured = np.concatenate([one.measured for one in data])
        self.sigma = np.concatenate([np.broadcast_to(one.sigma, len(one.measured)) for one in data])
        self._check()

    def _check(self) -> None:
        data_parameters = frozenset[str]().union(*(dataset.depends_on for dataset in self.data))
        for name in self.free:
            if name not in data_parameters:
                allowed = f"among {', '.join(sorted(data_parameters))}, on which the data depend"
                raise SceneError("free", name, allowed)
            value = self.start[name]
            if value is None or not 0.0 < value < math.inf:
                raise SceneError(
                    name, value, "finite and > 0 where it is free: the fit starts there"
                )
        if len(self.measured) < len(self.free):
            count = f"at most {len(self.measured)} parameters, the number of values measured"
            raise SceneError("free", self.free, count)

    def outcome(self, max_evaluations: int, tell: ProgressLine) -> RoughnessFit:
        options = {"jac": self.jacobian, "bounds": self._bounds(), "x_scale": 1.0}
        tolerances = {"ftol": 1e-10, "xtol": 1e-9, "gtol": 1e-10}
        start = np.zeros(len(self.free))
        result = least_squares_fit(
            self.residuals, start, max_evaluations, tell, **options, **tolerances
        )
        covariance = self._covariance(self.jacobian(result.x), result.x, result.active_mask)
        layer = self.layer(result.x)
        errors = np.sqrt(np.diag(covariance))
        sets = np.cumsum([len(one.measured) for one in self.data])[:-1]
        return RoughnessFit(
            self.scene.replace(**layer),
            tuple(
                FittedParameter(name, float(layer[name] or 0.0), float(error))
                for name, error in zip(self.free, errors, strict=True)
            ),
            tuple(tuple(row) for row in covariance.tolist()),
            tuple(tuple(part.tolist()) for part in np.split(result.fun, sets)),
            int(result.nfev),
        )

    def layer(self, x: Array) -> dict[str, float | None]:
        """Return the parameters at the logarithms of the free ones over their start."""
        fitted = {
            name: float(self.start[name] or 0.0) * math.exp(x_of_name)
            for name, x_of_name in zip(self.free, x.tolist(), strict=True)
        }
        return {**self.start, **fitted}

    def residuals(self, x: Array) -> Array:
        layer = self.layer(x)
        predicted = np.concatenate([one.predict(self.setting, layer) for one in self.data])
        return np.asarray((predicted - self.measured) / self.sigma)

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives of the residuals."""
        layer = self.layer(x)
        columns = [
            np.concatenate(
                [
                    one.slope(self.setting, layer, name)
                    if name in one.depends_on
                    else np.zeros(len(one.measured))
                    for one in self.data
                ]
            )
            for name in self.free
        ]
        return np.asarray(np.stack(columns, axis=1) / self.sigma[:, None])

    def _bounds(self) -> tuple[Array, Array]:
        """Return the ends of the logarithms, between which all scenes are in their range."""
        radii = [self.setting.radius, *(a for one in self.data for a in one.radius or ())]
        stiffness = self.setting.stiffness
        low, high = _COMPLIANCES
        compliances = low * max(radii) / stiffness, high * min(radii) / stiffness
        ends = []
        for name in self.free:
            lowest, highest = _FRICTIONS if name == "friction" else compliances
            start = float(self.start[name] or 0.0)
            if not lowest < start < highest:
                raise SceneError(name, start, f"in ({lowest:.4g}, {highest:.4g}), where it is free")
            ends.append((math.log(lowest / start), math.log(highest / start)))
        lows, highs = np.array(ends).T
        return lows, highs

    def _covariance(self, jacobian: Array, x: Array, active: Array) -> Array:
        """Return (JᵀJ)⁻¹, if the data determine all parameters.

        The columns are scaled to length one. Then a small singular value says that the data do not
        tell parameters apart, and not that they determine one inaccurately.
        """
        lengths = np.linalg.norm(jacobian, axis=0)
        flat_columns = (lengths < 1.0 / _LARGEST_ERROR) | (active != 0)
        if flat_columns.any():
            without_effect = [
                name for name, chosen in zip(self.free, flat_columns, strict=True) if chosen
            ]
            self._refuse(without_effect, "hardly change with", x)
        _, singular, right = np.linalg.svd(jacobian / lengths, full_matrices=False)
        noise = 4.0 * SLOPE_ERROR
        root = right.T / singular / lengths[:, None] if singular[-1] > noise else None
        if root is None or (np.linalg.norm(root, axis=1) > _LARGEST_ERROR).any():
            involved = np.abs(right[-1]) > 0.1
            not_distinguished = [
                name for name, chosen in zip(self.free, involved, strict=True) if chosen
            ]
            self._refuse(not_distinguished, "cannot distinguish", x)
        assert root is not None
        return np.asarray(root @ root.T)

    def _refuse(self, names: list[str], failure: str, x: Array) -> None:
        layer = self.layer(x)
        place = ", ".join(f"{name} = {layer[name]:.4g}" for name in self.free)
        listed = " and ".join(names)
        allowed = f"determined by the data, which {failure} {listed} at {place}"
        raise SceneError("free", self.free, allowed)


def _measurements(data: Data | Sequence[Data]) -> tuple[Data, ...]:
    listed = tuple(data) if isinstance(data, (list, tuple)) else (data,)
    for one in listed:
        if not isinstance(one, Data):
            raise SceneError("data", one, "ApproachData, PressureData or StickRadiusData")
    if not listed:
        raise SceneError("data", data, "at least one set of data")
    return listed


def _names(free: str | Sequence[str]) -> tuple[str, ...]:
    listed = names("free", [free] if isinstance(free, str) else free, PARAMETERS)
    if not listed or len(set(listed)) < len(listed):
        raise SceneError("free", free, f"one or more of {', '.join(PARAMETERS)}, each once")
    return listed


@dataclass(frozen=True, slots=True)
class LawComparison:
    """Fits of several laws to the same data.

    Attributes
    ----------
    names : tuple of str
        As they were given.
    fits : tuple of IndentationFit
        In their order.
    """

    names: tuple[str, ...]
    fits: tuple[IndentationFit, ...]

    def __getitem__(self, name: str) -> IndentationFit:
        if name not in self.names:
            raise KeyError(name)
        return self.fits[self.names.index(name)]

    @property
    def criterion(self) -> tuple[float, ...]:
        """Akaike's criterion of each, corrected for few data (AICc).

        With k parameters and n loads of known deviations ``chi² + 2 k + 2 k (k + 1)/(n - k - 1)``.
        """
        return tuple(_corrected(one) for one in self.fits)

    @property
    def weights(self) -> tuple[float, ...]:
        """How likely each is to be the best of them, by Akaike's weights; their sum is 1."""
        least = min(self.criterion)
        likelihoods = [math.exp(-0.5 * (value - least)) for value in self.criterion]
        return tuple(value / math.fsum(likelihoods) for value in likelihoods)

    @property
    def best(self) -> str:
        """The name of the law with the least criterion."""
        return self.names[self.criterion.index(min(self.criterion))]

    @property
    def alike(self) -> tuple[str, ...]:
        """Laws that the data do not rule out, which are those within 6 of the best criterion."""
        least = min(self.criterion)
        both = zip(self.names, self.criterion, strict=True)
        return tuple(name for name, one in both if one - least <= _RULED_OUT)

    def __str__(self) -> str:
        lines = [f"{'law':<24} {'chi square':>10} {'at':>4} {'AICc - least':>13} {'weight':>8}"]
        least = min(self.criterion)
        for name, one, value, weight in zip(
            self.names, self.fits, self.criterion, self.weights, strict=True
        ):
            cells = f"{one.chi_square:10.4g} {one.degrees_of_freedom:4d} {value - least:13.4g}"
            lines.append(f"{name:<24} {cells} {weight:8.2g}")
        verdict = f"the data support: {self.best}"
        if len(self.alike) > 1:
            verdict = f"the data cannot distinguish: {', '.join(self.alike)}"
        return "\n".join([*lines, verdict])


def compare_laws(
    candidates: Mapping[str, tuple[Scene, str | Sequence[str]]],
    data: IndentationData,
    *,
    rtol: float = 1e-8,
    max_evaluations: int = 200,
    progress: bool | None = None,
) -> LawComparison:
    """Fit several laws to the same data, and say which law they support, if they decide.

    Parameters
    ----------
    candidates : mapping of str to (Scene, str or sequence of str)
        For each law, by any name, where its fit starts and which parameters are free, as in `fit`.
    data : IndentationData
        With at least two loads more than a law has free parameters.
    rtol : float
        Tolerance of the solves, in [1e-12, 1e-4].
    max_evaluations : int
        Largest number of predictions of a curve.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    LawComparison

    Raises
    ------
    SceneError
        For an argument out of its range, and for parameters that the data do not determine.
    ConvergenceError
        If a solve does not meet `rtol`, or `max_evaluations` are not enough.
    """
    allowed = "a mapping of two names or more to a scene and its free parameters each"
    if not isinstance(candidates, Mapping) or len(candidates) < 2:
        raise SceneError("candidates", candidates, allowed)
    instance("data", data, IndentationData)
    ProgressLine(progress)  # refuses what it cannot be
    options: dict[str, Any] = {
        "rtol": rtol,
        "max_evaluations": max_evaluations,
        "progress": progress,
    }
    fits = []
    for name, scene_and_free in candidates.items():
        if not (
            isinstance(name, str) and isinstance(scene_and_free, tuple) and len(scene_and_free) == 2
        ):
            raise SceneError("candidates", candidates, allowed)
        scene, free = scene_and_free
        count = 1 if isinstance(free, str) else len(free) if isinstance(free, Sequence) else 0
        if len(data.load) < count + 2:
            allowed = f"of at least {count + 2} loads, for {count} free parameters of {name}"
            raise SceneError("data", data, allowed)
        try:
            fits.append(fit(scene, data, free, **options))
        except SceneError as error:  # says of which candidate
            if error.parameter in options:
                raise
            allowed = f"{error.allowed} (the candidate {name!r})"
            raise SceneError(error.parameter, error.value, allowed) from error
    return LawComparison(tuple(candidates), tuple(fits))


def _corrected(fit: IndentationFit) -> float:
    k = len(fit.names)
    denominator = fit.degrees_of_freedom - 1
    return fit.chi_square + 2.0 * k + 2.0 * k * (k + 1) / denominator
