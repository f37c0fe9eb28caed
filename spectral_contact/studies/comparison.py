"""`compare`: errors of fields and scalars of any origin against the solution of a scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields import Array
from spectral_contact.io import checks
from spectral_contact.io.choices import instance, suggesting
from spectral_contact.quantities import FIELDS, OUTPUTS
from spectral_contact.records import PROFILE_QUANTITIES
from spectral_contact.scene import Scene, same_problem
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve
from spectral_contact.studies.truth import PLACES, estimate_of
from spectral_contact.testing.solution_checks import by_distance, field_of
from spectral_contact.view.error_sizes import (
    OF_MEAN_PRESSURE,
    ErrorSizes,
    error_of_unit,
    unloaded,
)
from spectral_contact.view.html import table_html
from spectral_contact.view.radii import graded_radii
from spectral_contact.view.report import table

Numbers = Callable[..., Any] | ArrayLike

#: Tolerance of the reference solution.
_RTOL: Final = 1e-12
#: A radius is taken for the edge if it is outside by no more than this, over the contact radius: by
#: rounding of radii and their units.
_AT_EDGE: Final = 8.0 * float(np.finfo(np.float64).eps)
#: Name of the displacement of the surface, and the tolerance to which it is evaluated.
_SURFACE: Final = "displacement"
_SURFACE_RTOL: Final = 1e-9
#: A common factor of the values of a field is noted, to hint at a wrong unit or sign. These four
#: numbers are chosen. Only values count whose true ones are larger than this share of the largest.
_LARGE: Final = 1e-3
#: The factor is common if at least this share of these values has it.
_MOST: Final = 0.9
#: Two factors are the same up to this relative difference.
_ALIKE: Final = 0.02
#: A factor is noted if it differs from 1 by at least this.
_NOTED: Final = 0.1
#: Displacements are said to be those of the surface of the layer if their errors against these are
#: less than this share of their errors against those of the half-space.
_SAME: Final = 0.1
#: Scalars that can be compared.
_NUMBERS: Final = ("approach", "stick_radius", "total_shear", *PROFILE_QUANTITIES)


@dataclass(frozen=True, slots=True)
class Agreement:
    """The error of one quantity against the reference solution.

    Attributes
    ----------
    quantity : str
    error : float
        Relative error, the largest over the radii; infinite where a function returns NaN.
    known_to : float or None
        Estimated relative error of the reference solution itself. An ``error`` that is no larger
        than this cannot be told from zero.
    value, truth : float
        The number given and that of the reference solution, where the error is largest, in the
        units of the input.
    from_edge : float or None
        Where that is, as 1 - r/a; None for a scalar.
    median : float or None
        Median of the errors over the radii; None for a scalar.
    """

    quantity: str
    error: float
    known_to: float | None
    value: float
    truth: float
    from_edge: float | None = None
    median: float | None = None

    @property
    def told_apart(self) -> bool:
        """Whether the error is larger than that of the reference solution."""
        return not self.error <= (self.known_to or 0.0)


@dataclass(frozen=True, slots=True)
class Comparison:
    """Errors of your numbers against a reference solution; prints as a table.

    Attributes
    ----------
    scene : Scene
    source : str
        Where the reference solution comes from.
    agreements : tuple of Agreement
        One for each quantity.
    remarks : tuple of str
        What was done with radii at and beyond the edge.
    """

    scene: Scene
    source: str
    agreements: tuple[Agreement, ...]
    remarks: tuple[str, ...] = ()

    @property
    def error(self) -> float:
        """The largest error of all quantities."""
        return max(one.error for one in self.agreements)

    def __getitem__(self, quantity: str) -> Agreement:
        for one in self.agreements:
            if one.quantity == quantity:
                return one
        raise KeyError(quantity)

    def __str__(self) -> str:
        return "\n".join([table(self._cells()), f"truth: {self.source}", *self.remarks])

    def _repr_html_(self) -> str:
        remarks = "".join(f"<p>{escape(remark)}</p>" for remark in self.remarks)
        return table_html(self._cells()) + remarks

    def _cells(self) -> list[tuple[str, ...]]:
        headings = ("quantity", "error", "median", "worst at 1 - s", "value", "truth", "known to")
        cells: list[tuple[str, ...]] = [headings]
        for one in self.agreements:
            place, middle, known = (
                "" if number is None else f"{number:{form}}"
                for number, form in (
                    (one.from_edge, ".3g"),
                    (one.median, ".1e"),
                    (one.known_to, ".1e"),
                )
            )
            numbers = f"{one.value:.6g}", f"{one.truth:.6g}", known
            cells.append(
                (one.quantity.replace("_", " "), f"{one.error:.1e}", middle, place, *numbers)
            )
        return cells


@suggesting()
def compare(
    scene: Scene,
    *,
    approach: float | None = None,
    pressure: Callable[..., Any] | ArrayLike | None = None,
    traction: Callable[..., Any] | ArrayLike | None = None,
    slip: Callable[..., Any] | ArrayLike | None = None,
    stick_radius: float | None = None,
    total_shear: float | None = None,
    contact_radius: float | None = None,
    load: float | None = None,
    stiffness: float | None = None,
    indentation_work: float | None = None,
    s: ArrayLike | None = None,
    from_edge: ArrayLike | None = None,
    truth: Any = None,
    displacement: ArrayLike | None = None,
    r: ArrayLike | None = None,
) -> Comparison:
    """Compare your numbers with a reference solution, quantity by quantity.

    The table has the largest error of each quantity and the radius where it occurs.

    Parameters
    ----------
    scene : Scene
        The problem that your numbers solve. They are dimensionless as in `Solution`, or in SI
        units, radii in m, if the scene was made by `Scene.from_physical`.
    approach, stick_radius, total_shear : float, optional
    contact_radius, load, stiffness, indentation_work : float, optional
        For a scene with a profile.
    pressure, traction, slip : callable or array_like, optional
        A function of arrays of radii, or of distances if it takes ``from_edge``; or its values at
        `s` or `from_edge`.
    s, from_edge : array_like, optional
        Radii, or distances from the edge, at which fields are compared, in any order; needed for
        arrays. By default at radii that resolve the edge layer and every zone. Outside the contact
        (distances below 0) pressure and traction are 0; a radius outside by no more than rounding
        is the edge.
    truth : Solution or ReferenceSolution, optional
        The reference solution; by default `solve` with ``rtol=1e-12``, which takes a second.
    displacement : array_like, optional
        Displacement of the surface of the half-space into the body, at `r`, `s` or `from_edge`,
        inside and outside the contact. The compression of the rough layer is not part of it.
    r : array_like, optional
        In place of `s`: radii in the unit of length of the scene, which under a profile is not the
        contact radius but L.

    Returns
    -------
    Comparison
        Errors of pressure and traction are relative to the value at each radius (with elastic
        coupling to the two together, see docs/coupling), those of the slip to its largest value.
        Errors of the displacement are relative to its largest value, too.
        With a profile errors of pressures are relative to the mean pressure where the pressure is
        smaller, and those of tractions to the largest. Below the largest load, where the surface
        sticks with memory, tractions change their sign, and their errors are relative to friction
        times pressure.
        Outside the contact errors of pressure and traction are relative to the mean of their moduli
        over the contact, and slip is not compared. Radii where the reference is infinite, as at the
        edge of a smooth surface, are left out.

    Raises
    ------
    SceneError
        For an argument that is no number, or out of its range; for an array without its radii; if
        there is nothing to compare, such as a slip outside the contact alone.
    NotComputedError
        If the scene has no such quantity.

    Examples
    --------
    >>> import spectral_contact as sc
    >>> smooth = sc.Scene(0.3)
    >>> print(sc.compare(smooth, approach=0.126, pressure=[0.16, 0.18], s=[0.0, 0.5]))
    quantity     error     median    worst at 1 - s   value   truth      known to
      approach   8.0e-03                              0.126   0.125      0.0e+00
      pressure   2.1e-02   1.3e-02   0.5              0.18    0.183776   0.0e+00
    truth: solve, rtol = 1e-12
    """
    instance("scene", scene, Scene)
    numbers = {
        "approach": approach,
        "stick_radius": stick_radius,
        "total_shear": total_shear,
        "contact_radius": contact_radius,
        "load": load,
        "stiffness": stiffness,
        "indentation_work": indentation_work,
    }
    fields = {"pressure": pressure, "traction": traction, "slip": slip, _SURFACE: displacement}
    given = {name: one for name, one in {**numbers, **fields}.items() if one is not None}
    for name in (one for one in PROFILE_QUANTITIES if one in given and scene.profile is None):
        raise NotComputedError(name, "the punch is flat: its radius and load are the units")
    if not given:
        raise SceneError("approach, pressure, …", None, "given: at least one quantity")
    if r is not None and s is not None:
        raise SceneError("r, s", (r, s), "one of them, the other None")
    source = "given" if truth is not None else f"solve, rtol = {_RTOL:g}"
    problem = _ComparedScene(scene, _truth(scene, given) if truth is None else truth)
    places = problem.places(s, from_edge, r)
    agreements = [problem.agreement(name, one, places) for name, one in given.items()]
    remarks = problem.remarks(places, [name for name in given if name in fields])
    return Comparison(scene, source, tuple(agreements), (*remarks, *problem.factors))


__test__: Final = {"compare": compare}  # doctest passes over functions that are wrapped


def _truth(scene: Scene, given: dict[str, Any]) -> Solution:
    """Solve for what is given, and for what its units and the scales of its errors need."""
    # with coupling, or below the largest load, the errors of one field are relative to both
    of_both = scene.couples or unloaded(scene)
    needed = {*given, "approach"} | ({"pressure", "traction"} if of_both else set())
    if unloaded(scene):
        needed |= {"zones"}
    if _SURFACE in needed:
        needed = needed - {_SURFACE} | {"pressure", "traction"}
    needed |= {*OF_MEAN_PRESSURE} if scene.profile is not None else set()
    return solve(scene, _RTOL, tuple(needed), strict=False)


class _ComparedScene:
    """The truth about a scene, in the units in which numbers are given.

    Attributes
    ----------
    placed : bool
        Whether radii are given.
    rounded : int
        How many of them are taken for the edge, being outside by rounding.
    factors : list of str
        Remarks on factors by which numbers differ from the truth.
    length : float
        The contact radius in the unit of radii.
    scale : dict of str to float
        What each dimensionless quantity is multiplied by to be in the unit of the input.
    """

    def __init__(self, scene: Scene, truth: Any) -> None:
        own = getattr(truth, "scene", scene)
        if not isinstance(own, Scene) or not same_problem(own, scene):
            raise SceneError("truth", own, f"that of {scene}")
        self.scene, self.truth = scene, truth
        self.placed = False
        self.rounded = 0
        self.factors: list[str] = []
        self.length = 1.0
        self.scale = dict.fromkeys((*FIELDS, *_NUMBERS), 1.0)
        if scene.physical is not None:
            factor = scene.physical.si_factor
            kinds = {one.si_factor for one in OUTPUTS}
            factors = {kind: factor(kind, scene.poisson_ratio, truth) for kind in kinds}
            self.length = factors["radius"]
            self.scale = {one.name: factors[one.si_factor] for one in OUTPUTS}

    def agreement(self, name: str, given: Any, places: Array) -> Agreement:
        """Compare a number, or a field at distances from the edge."""
        if name == _SURFACE:
            return self._surface(given, places)
        return self._field(name, given, places) if name in FIELDS else self._number(name, given)

    def _known_to(self, name: str) -> float | None:
        """Return the estimated error of a quantity of the truth, in the units of the input."""
        known = estimate_of(self.truth, name)
        if known is None or self.scene.physical is None:
            return known
        return known + error_of_unit(self.scene, name, lambda one: estimate_of(self.truth, one))

    def _number(self, name: str, value: Any) -> Agreement:
        found = getattr(self.truth, name, None)
        if found is None:
            raise SceneError(name, value, f"None, as the truth about {self.scene} has none")
        given = checks.real(name, value, allowed="finite")
        true = checks.scalar(f"truth.{name}", found) * self.scale[name]
        # with adhesion a load or an approach may be zero, and its error has a scale of its own
        error_scale = getattr(self.truth, "error_scales", {}).get(name, 0.0) * self.scale[name]
        error = abs(given - true) / (error_scale or abs(true) or 1.0)
        self._note_factor(name, given / true if true else 1.0, every=False)
        return Agreement(name, error, self._known_to(name), given, true)

    def places(
        self, s: ArrayLike | None, from_edge: ArrayLike | None, r: ArrayLike | None
    ) -> Array:
        """Return the distances from the edge at which fields are compared, dimensionless.

        Those outside the contact are negative, those outside by rounding are 0.
        """
        self.placed = any(one is not None for one in (s, from_edge, r))
        if not self.placed:
            own = isinstance(self.truth, Solution)
            return graded_radii(self.truth).from_edge if own else PLACES
        radii = ("s", s) if r is None else ("r", r)
        checks.exactly_one(*radii, "from_edge", from_edge)
        name, given = radii if from_edge is None else ("from_edge", from_edge)
        unit = "m" if self.scene.physical is not None else ""
        in_unit = f" [{unit}]" if unit else ""
        length = self._length_of_r if name == "r" else self.length
        allowed = f"finite and >= 0{in_unit}"
        if name == "from_edge":
            high = f"{length:.16g}".removesuffix(".0")
            allowed = f"finite and <= {high}{in_unit}"
        lengths = np.ravel(checks.reals(name, given, allowed, unit=unit))
        if not lengths.size:
            raise SceneError(name, given, "at least one radius")
        distances = lengths if name == "from_edge" else length - lengths
        distances = np.asarray(distances / length, dtype=np.float64)
        outside_range = ~(np.isfinite(distances) & (distances <= 1.0))
        if outside_range.any():
            raise SceneError(name, lengths[outside_range][0].item(), allowed)
        at_edge = (distances < 0.0) & (distances >= -_AT_EDGE)
        self.rounded = int(np.sum(at_edge))
        return np.where(at_edge, 0.0, distances)

    @property
    def _length_of_r(self) -> float:
        """The contact radius in the unit of length of the scene."""
        if self.scene.physical is None and self.scene.profile is not None:
            radius = self.scene.contact_radius or getattr(self.truth, "contact_radius", None)
            return checks.scalar("truth.contact_radius", radius)
        return self.length

    def remarks(self, places: Array, fields: list[str]) -> tuple[str, ...]:
        """Return what was done with the radii at which fields were compared."""
        if not fields:
            return ()
        found = []
        if self.rounded:
            many = f"{self.rounded} of {len(places)} radii"
            found.append(f"{many} outside the contact by rounding: compared as the edge")
        beyond = places[places < 0.0]
        if beyond.size:
            many = f"{beyond.size} of {len(places)} radii outside the contact"
            where = f"the nearest at 1 - s = {beyond.max():.3g}"
            zero = " and ".join(name for name in fields if name not in ("slip", _SURFACE))
            told = [f"{zero} compared with 0"] if zero else []
            told += ["slip not compared"] if "slip" in fields else []
            told += [f"{_SURFACE} compared as inside"] if _SURFACE in fields else []
            found.append(f"{many}, {where}: {', '.join(told)}")
        return tuple(found)

    def _field(self, name: str, given: Numbers, places: Array) -> Agreement:
        """Compare a field, given as a function or by its values, at distances from the edge."""
        if callable(given):
            values = by_distance(name, given, self.length)(places * self.length)
        else:
            values = self._listed(name, given, places)
        inside = places >= 0.0
        true = np.zeros(len(places))
        sizes = np.ones(len(places))
        error_sizes = ErrorSizes(self.scene, self.truth, self._field_of_truth)
        if inside.any():
            true[inside] = self._field_of_truth(name)(places[inside])
            sizes[inside] = error_sizes.at(name, true[inside], places[inside])
        if not inside.all():
            sizes[~inside] = error_sizes.mean(name)
        compared = np.isfinite(true)
        if name == "slip":
            compared &= inside
        if not compared.any():
            told = "somewhere where the truth is finite"
            raise SceneError("s, from_edge", places, told if inside.any() else "inside the contact")
        scale = self.scale[name]
        with np.errstate(over="ignore", invalid="ignore"):  # huge values have an infinite error
            errors = np.abs(values / scale - true)[compared] / sizes[compared]
        errors = np.where(np.isnan(errors), np.inf, errors)
        worst = int(np.argmax(errors))
        self._note_common_factor(name, values[compared] / scale, true[compared])
        return Agreement(
            name,
            float(errors[worst]),
            self._known_to(name),
            float(values[compared][worst]),
            float(true[compared][worst]) * scale,
            float(places[compared][worst]),
            float(np.median(errors)),
        )

    def _field_of_truth(self, name: str) -> Callable[[Array], Array]:
        return field_of(self.truth, name, "truth")

    def _surface(self, given: Numbers, places: Array) -> Agreement:
        """Compare the displacement of the surface into the body."""
        if not isinstance(self.truth, Solution):
            raise SceneError("truth", self.truth, "a Solution, to compare displacements with")
        if callable(given):
            raise SceneError(_SURFACE, given, "an array, with its radii")
        values = self._listed(_SURFACE, given, places)
        body = self._inside
        surface = body.surface(from_edge=places * body.radius, rtol=_SURFACE_RTOL)
        true = np.asarray(surface.z)
        size = float(np.max(np.abs(true))) or 1.0
        with np.errstate(over="ignore", invalid="ignore"):
            errors = np.abs(values - true) / size
        worst = int(np.argmax(errors))
        self._note_common_factor(_SURFACE, values, true)
        # whether they are those of the top of the layer, with the compression that `gap` has inside
        inside = places >= 0.0
        compression = np.where(inside, np.asarray(surface.gap), 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            layered = float(np.max(np.abs(values - true - compression))) / size
        known = float(np.max(surface.error))
        if inside.any() and max(layered, known) < _SAME * errors[worst]:
            self.factors.append(
                "displacement: these seem to be of the top of the rough layer, with its "
                "compression; that is not part of the displacement of the half-space. With it "
                f"they agree to {layered:.1e}"
            )
        return Agreement(
            _SURFACE,
            float(errors[worst]),
            known,
            float(values[worst]),
            float(true[worst]),
            float(places[worst]),
            float(np.median(errors)),
        )

    @property
    def _inside(self) -> Any:
        """The half-space (`Inside`), which evaluates displacements, in the units of the input."""
        return (self.truth if self.scene.physical is None else self.truth.physical).inside

    def _note_common_factor(self, name: str, values: Array, true: Array) -> None:
        """Note a factor by which all values differ from the truth."""
        large = np.isfinite(true) & (np.abs(true) > 0.0)
        large &= np.abs(true) > _LARGE * np.max(np.abs(true), initial=0.0)
        if not large.any():
            return
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            ratios = values[large] / true[large]
            factor = float(np.median(ratios))
            spread = float(np.quantile(np.abs(ratios / factor - 1.0), _MOST))
        if spread < _ALIKE:  # false for NaN
            self._note_factor(name, factor, every=True)

    def _note_factor(self, name: str, factor: float, *, every: bool) -> None:
        """Note a factor between numbers and the truth.

        Any factor is noted if every value of a field has it. That of a single number is noted only
        if a sign, a unit or an angle explains it.
        """
        if factor == 0.0 or not np.isfinite(factor) or abs(factor - 1.0) < _NOTED:
            return
        size = abs(factor)
        if factor < 0.0 and abs(size - 1.0) < _ALIKE:
            self.factors.append(f"{name}: the sign is the other one")
            return
        question = _question(size)
        if question or every:
            values = "all values are" if every else "it is"
            ratio = f"large by {size:.4g}" if size > 1.0 else f"small by {1.0 / size:.4g}"
            sign = " and of the other sign" if factor < 0.0 else ""
            hint = f": {question}" if question else ""
            self.factors.append(f"{name}: {values} too {ratio}{sign}{hint}")

    def _listed(self, name: str, given: ArrayLike, places: Array) -> Array:
        """Return the values of a field that is given by them, one for each place."""
        if not self.placed:
            told = "an array with its radii (r=, s= or from_edge=)"
            raise SceneError(name, given, told if name == _SURFACE else f"a function, or {told}")
        numbers = np.ravel(checks.reals(name, given, "for each radius", anything=True))
        if np.isnan(numbers).any():
            raise SceneError(name, np.nan, "a number at each radius")
        return checks.values_at(name, lambda _: numbers, places)


def _question(size: float) -> str:
    """Return what may explain a factor: an angle, or a unit's prefix; empty if nothing does."""
    if any(abs(size / angle - 1.0) < _ALIKE for angle in (2.0 * np.pi, 0.5 / np.pi)):
        return "per radian, or of the whole?"
    thousands = round(float(np.log10(size)) / 3.0)
    alike = abs(np.log(size) - thousands * np.log(1000.0)) < _ALIKE
    return "units?" if thousands and alike else ""
