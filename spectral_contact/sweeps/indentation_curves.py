"""Indentation curves: scenes of one punch on one layer that differ in load, or approach, alone.

A few contact radii a are solved, and all scenes are interpolated between them (`fields.curves`):
the logarithms of load, approach, stiffness and work are smooth functions of a variable v in place
of the radius (`contact.contact_radius.RadiusScale`). It is ``ln(a - b)``, with the radius b of the
flat part of the profile, or ``ln((a - b)/(r - a))`` if the profile ends at r. The singularities of
the functions that are nearest to the real axis of v are at the distance pi from it, where
``a - b`` is negative, whatever the compliance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.contact_radius import RadiusScale
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields import Array
from spectral_contact.fields.curves import LEAST, Curves, nodes_allowed, nodes_needed
from spectral_contact.profiles import Flat, Profile
from spectral_contact.solution import Solution
from spectral_contact.sweeps.request import Request, Served
from spectral_contact.sweeps.sweep_parameters import PARAMETERS, Columns, Indices

Mask = NDArray[np.bool_]

if TYPE_CHECKING:
    from spectral_contact.sweeps.chunk import OnLine

#: Names of the functions of the contact radius that are interpolated.
CURVED: Final = ("load", "approach", "stiffness", "indentation_work")
#: Quantities of normal contact: without elastic coupling friction does not change them.
_NORMAL: Final = frozenset({*CURVED, "contact_radius"})
#: The same, and those that need no solve in scenes without friction.
_FRICTIONLESS: Final = _NORMAL | {"stick_radius", "total_shear"}
#: Rows of `Columns.values` in which the scenes of a curve may differ, by name.
_CONTROL_ROWS: Final = {name: PARAMETERS.index(name) for name in ("load", "approach")}
_ADHESION: Final = PARAMETERS.index("work_of_adhesion")


def on_curves(columns: Columns, request: Request) -> Mask:
    """Return a mask of the scenes that may be on a curve, if numbers of normal contact are asked.

    These scenes have a profile that is not flat, no adhesion and no layer law.
    """
    names = frozenset(request.quantities)
    # columns of flat punches have no rows of load and approach
    is_flat_punch = len(columns.values) <= max(_CONTROL_ROWS.values())
    if columns.law or is_flat_punch or not names <= _FRICTIONLESS:
        return np.zeros(len(columns), dtype=bool)
    curved = [one.layer is None and not isinstance(one.profile, Flat) for one in columns.forms]
    may_be_on_curve = np.broadcast_to(curved, len(columns)) & np.isnan(columns.values[_ADHESION])
    # Stick radius and shear are known without friction only. The other quantities do not depend on
    # friction unless there is elastic coupling.
    independent_of_friction = np.isnan(columns.friction) if names - _NORMAL else ~columns.coupled
    return np.asarray(may_be_on_curve & independent_of_friction)


def indentation_curves(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield groups of the scenes to do that differ in load, or approach, alone.

    Each is an array of indices in the order of that load or approach.
    """
    candidates = todo[on_curves(columns[todo], request)]
    forms = columns.forms
    for k in _CONTROL_ROWS.values() if len(candidates) else ():
        groups: dict[tuple[float, Profile | None], list[int]] = {}
        for i in candidates[~np.isnan(columns.values[k, candidates])].tolist():
            profile = forms[i if len(forms) > 1 else 0].profile
            groups.setdefault((float(columns.alpha[i]), profile), []).append(i)
        for group in groups.values():
            if len(group) >= LEAST:
                yield np.array(group)[np.argsort(columns.values[k, group], kind="stable")]


def interpolate_curve(columns: Columns, request: Request, solver: OnLine) -> Served:
    """Return results of the scenes of a curve, interpolated between a few solved radii.

    Parameters
    ----------
    columns : Columns
        The scenes, by rising load or approach.
    request : Request
        Of quantities that are a number for each scene.
    solver : OnLine
        Solves scenes of the curve, and others with a given contact radius; returns None where that
        fails.

    Returns
    -------
    Served
        Without scenes if too many radii would have to be solved. The first and the last scene are
        not among them: the solver has solved them and kept the solutions.
    """
    size = len(columns)
    mask = np.zeros(size, dtype=bool)
    given = next(name for name, k in _CONTROL_ROWS.items() if not np.isnan(columns.values[k, 0]))
    ends = [solver.at_scene(i, ("contact_radius",)) for i in (0, size - 1)]
    interval = _ends(ends, size, request.rtol)
    if interval is not None:
        assert ends[0] is not None
        scale = RadiusScale(_profile(ends[0]))
        curve = _PressedCurve(given, scale, Curves(*interval, len(CURVED)))
        inside = columns.values[_CONTROL_ROWS[given], 1 : size - 1]
        while len(curve.curves.nodes) < nodes_allowed(size):
            if curve.curves.settled(request.rtol):
                served = curve.served(inside, ends[0], request)
                if all((served.errors[name] <= request.rtol).all() for name in request.quantities):
                    mask[1 : size - 1] = True
                    return replace(served, mask=mask)
            if not curve.grow(solver):
                break
    return Served(mask, {}, {})


def _profile(solution: Solution) -> Profile:
    assert solution.scene.profile is not None
    return solution.scene.profile


def _ends(solved: list[Solution | None], size: int, rtol: float) -> tuple[float, float] | None:
    """Return v of the first and of the last scene of a curve, both solved.

    None if a solve failed, if the profile has a break between the two radii, or if interpolation
    would take too many nodes.
    """
    solutions = [solution for solution in solved if solution is not None]
    if len(solutions) < len(solved):
        return None
    profile = _profile(solutions[0])
    first, last = (solution.contact_radius for solution in solutions)
    if not first < last or any(first <= b < last for b in profile.breaks):
        return None
    low, high = map(RadiusScale(profile).place, (first, last))
    return (low, high) if nodes_needed(low, high, rtol) <= nodes_allowed(size) else None


@dataclass(frozen=True, slots=True)
class _PressedCurve:
    """The functions of an indentation curve at the radii that are solved so far.

    Attributes
    ----------
    given : str
        What the scenes differ in: load or approach.
    scale : RadiusScale
        Changes contact radii into v and back.
    curves : Curves
        The logarithms of the functions `names` over v.
    """

    given: str
    scale: RadiusScale
    curves: Curves

    @property
    def names(self) -> tuple[str, ...]:
        """The functions that are interpolated; the first is the given one, which is inverted."""
        return self.given, *(one for one in CURVED if one != self.given)

    def grow(self, solver: OnLine) -> bool:
        """Add a node: solve at one radius more; return whether that solve converged."""
        solution = solver.with_contact_radius(self.scale.radius(self.curves.next()), CURVED)
        if solution is None:
            return False
        log_values = np.log([getattr(solution, name) for name in self.names])
        self.curves.add(
            log_values, np.array([getattr(solution.error, name) for name in self.names])
        )
        return True

    def served(self, control_values: Array, solution: Solution, request: Request) -> Served:
        """Return values and errors of the quantities that are asked for.

        Parameters
        ----------
        given : ndarray, shape (scenes,)
            Load or approach of every scene.
        one : Solution
            Of any scene of the curve; has the quantities that are the same in all of them.
        request : Request
        """
        inverted = self.curves.invert(np.log(control_values))
        radius = np.array([self.scale.radius(v) for v in inverted.places.tolist()])
        slope = np.array([self.scale.derivative(r) for r in radius.tolist()])  # da/dv
        # a radius is rounded, which is as much as an error of v
        place_errors = inverted.place_errors + ROUNDING * radius / slope
        value_errors = inverted.value_errors + inverted.slopes * place_errors[:, None] + ROUNDING
        values = {self.given: control_values, "contact_radius": radius}
        errors = {
            self.given: np.zeros(len(control_values)),
            "contact_radius": place_errors * slope / radius,
        }
        for j, name in enumerate(self.names[1:]):
            values[name] = np.exp(inverted.values[:, j])
            errors[name] = value_errors[:, j]
        for name in frozenset(request.quantities) - frozenset(values):
            value = getattr(solution, name)
            values[name] = np.full(len(control_values), np.nan if value is None else value)
            errors[name] = np.zeros(len(control_values))
        names = request.quantities
        mask = np.ones(len(control_values), dtype=bool)
        return Served(mask, {k: values[k] for k in names}, {k: errors[k] for k in names})
