"""True values of a scene, and the errors of any solution against them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import scalar
from spectral_contact.io.choices import names
from spectral_contact.scene import Scene, same_problem
from spectral_contact.studies.study_results import QUANTITIES
from spectral_contact.testing.attributes import computed
from spectral_contact.testing.solution_checks import field_of

_SCALARS = ("approach", "total_shear", "stick_radius")
_FIELDS = ("pressure", "traction")
#: Distances from the edge at which fields are compared: those of the gold tables.
PLACES = np.array(
    [1.0, *(k / 8.0 for k in range(7, 0, -1)), *(10.0**-k for k in range(1, 13)), 0.0]
)


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Values of a scene that are taken for true; dimensionless as in `Solution`.

    Attributes
    ----------
    scene : Scene
    source : str
        Where they are from.
    scalars : dict
        By name: approach, edge pressure, total shear, stick radius; those that are finite and not
        0. The stick radius of full stick is 1 by definition and not among them.
    from_edge : ndarray
        Distances from the edge, of the points at which fields are compared.
    fields : dict
        By name: pressure and traction there; infinite at the edge where the theory has it so.
    error : dict
        Relative errors of all these, by name.
    """

    scene: Scene
    source: str
    scalars: dict[str, float]
    from_edge: Array
    fields: dict[str, Array]
    error: dict[str, float]

    @property
    def quantities(self) -> tuple[str, ...]:
        """What can be compared, in the order of `QUANTITIES`."""
        return tuple(name for name in QUANTITIES if name in self.scalars or name in self.fields)

    def errors(self, solution: Any, wanted: Iterable[str]) -> dict[str, float]:
        """Return the relative errors of a solution.

        That of a field is the largest over the points, each relative to the true value there; where
        that is zero, as the traction is at the centre, the error is absolute.

        Parameters
        ----------
        solution : object
            With some of ``approach``, ``total_shear``, ``stick_radius``, ``pressure(s)``,
            ``traction(s)``.
        wanted : iterable of str
            Out of `quantities`.

        Returns
        -------
        dict
            By quantity; what the solution lacks is missing, NaN is infinite.

        Raises
        ------
        SceneError
            For a quantity that is not known, or a value of the solution that is no real number.
        """
        found = {}
        for name in names("wanted", wanted, self.quantities):
            with suppress(NotComputedError):
                if getattr(solution, attribute_of(name), None) is not None:
                    error = self._error(solution, name)
                    found[name] = error if error >= 0.0 else math.inf  # of NaN
        return found

    def _error(self, solution: Any, name: str) -> float:
        """Return the error of a quantity that the solution has."""
        if name in self.scalars:
            if name in _SCALARS:
                value = scalar(f"solution.{name}", getattr(solution, name))
            else:
                value = float(field_of(solution, attribute_of(name))(np.zeros(1))[0])
            return abs(value - self.scalars[name]) / abs(self.scalars[name])
        finite = np.isfinite(self.fields[name])
        true = self.fields[name][finite]
        values = field_of(solution, name)(self.from_edge[finite])
        return float(np.max(np.abs(values - true) / np.where(true == 0.0, 1.0, np.abs(true))))


def given_truth(name: str, scene: Scene, truth: Any, source: str = "") -> Truth:
    """Return the values of an object as the truth about a scene.

    Parameters
    ----------
    name : str
        The argument that it was given as, which an error names.
    scene : Scene
    truth : object
        A `Truth`, or an object with some of the attributes of a solution.
    source : str
        Where it is from; by default its class.
    """
    own = getattr(truth, "scene", scene)
    if isinstance(own, Scene) and not same_problem(own, scene):
        raise SceneError(name, own, f"that of {scene}")
    if isinstance(truth, Truth):
        return replace(truth, scene=scene)
    points, fields = _fields(truth, name)
    scalars = {}
    for quantity in _SCALARS:
        if quantity != "stick_radius" or scene.friction != math.inf:  # else it is 1 by definition
            value = scalar(f"{name}.{quantity}", computed(truth, quantity, 0.0))
            if math.isfinite(value) and value != 0.0:
                scalars[quantity] = value
    # under a profile the pressure at the edge is zero in theory, and no scale of an error
    if "pressure" in fields and points[-1] == 0.0 and scene.profile is None:
        edge = float(fields["pressure"][-1])
        if math.isfinite(edge):
            scalars["edge_pressure"] = edge
    error = {quantity: estimate_of(truth, quantity) or 0.0 for quantity in (*scalars, *fields)}
    if not error:
        raise SceneError(name, truth, f"an object with one of {', '.join(QUANTITIES)}")
    source = source or f"{type(truth).__name__}, given"
    return Truth(scene, source, scalars, points, fields, error)


def estimate_of(solution: Any, name: str) -> float | None:
    """Return a solution's own estimate of the relative error of a quantity; None without one.

    An estimate of NaN, which has failed, is taken as infinite: no digit is known.

    Raises
    ------
    SceneError
        For an estimate that is no real number, or below 0.
    """
    estimate = getattr(getattr(solution, "error", None), attribute_of(name), None)
    if estimate is None:
        return None
    known = scalar(f"error.{attribute_of(name)}", estimate)
    if known < 0.0:
        raise SceneError(f"error.{attribute_of(name)}", estimate, "at least 0")
    return math.inf if math.isnan(known) else known


def chosen(quantities: Sequence[str] | None, truths: Sequence[Truth]) -> tuple[str, ...]:
    """Return a study's quantities: those asked for, or all that are known of some scene."""
    known = [q for q in QUANTITIES if any(q in truth.quantities for truth in truths)]
    if quantities is None:
        return tuple(known)
    given = [quantities] if isinstance(quantities, str) else quantities
    asked = names("quantities", given, QUANTITIES)
    if not asked:
        raise SceneError("quantities", quantities, f"some of {', '.join(QUANTITIES)}")
    for truth in truths:
        for name in set(asked).difference(truth.quantities):
            known_here = ", ".join(truth.quantities)
            raise SceneError("quantities", name, f"among what the truth has here: {known_here}")
    return tuple(name for name in known if name in asked)


def attribute_of(name: str) -> str:
    """Return the attribute of a solution that has a quantity of a study."""
    return "pressure" if name == "edge_pressure" else name


def _fields(truth: Any, owner: str) -> tuple[Array, dict[str, Array]]:
    """Return distances from the edge, and the fields there.

    The distances are those of the points of a gold solution, or `PLACES`.
    """
    listed = getattr(truth, "points", None) or []
    points = np.array([point.from_edge for point in listed]) if listed else PLACES
    fields = {}
    for name in _FIELDS:
        with suppress(NotComputedError):
            if listed:
                fields[name] = np.array([float(getattr(point, name)) for point in listed])
            elif hasattr(truth, name):
                fields[name] = field_of(truth, name, owner)(points)
    return points, {name: values for name, values in fields.items() if values.any()}
