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

#: The functions of the contact radius that are interpolated.
CURVED: Final = ("load", "approach", "stiffness", "indentation_work")
#: Quantities of normal contact: without elastic coupling friction does not change them.
_NORMAL: Final = frozenset({*CURVED, "contact_radius"})
#: The same, and those that need no solve in scenes without friction.
_FRICTIONLESS: Final = _NORMAL | {"stick_radius", "total_shear"}
#: Rows of `Columns.values` in which the scenes of a curve may differ, by name.
_GIVEN: Final = {name: PARAMETERS.index(name) for name in ("load", "approach")}
_ADHESION: Final = PARAMETERS.index("work_of_adhesion")


def pressed_alone(columns: Columns, request: Request) -> Mask:
    """Return a mask of the scenes that may be on a curve, if numbers of normal contact are asked.

    These scenes have a profile that is not flat, no adhesion and no layer law.
    """
    asked = frozenset(request.quantities)
    # columns of flat punches have no rows of load and approach
    is_flat_punch = len(columns.values) <= max(_GIVEN.values())
    if columns.law or is_flat_punch or not asked <= _FRICTIONLESS:
        return np.zeros(len(columns), dtype=bool)
    curved = [one.layer is None and not isinstance(one.profile, Flat) for one in columns.forms]
    of_curves = np.broadcast_to(curved, len(columns)) & np.isnan(columns.values[_ADHESION])
    # stick radius and shear are known without friction only; the others do not depend on friction
    # unless there is elastic coupling
    known = np.isnan(columns.friction) if asked - _NORMAL else ~columns.coupled
    return np.asarray(of_curves & known)


def indentation_curves(columns: Columns, todo: Indices, request: Request) -> Iterator[Indices]:
    """Yield groups of the scenes to do that differ in load, or approach, alone.

    Each is an array of indices in the order of that load or approach.
    """
    candidates = todo[pressed_alone(columns[todo], request)]
    forms = columns.forms
    for k in _GIVEN.values() if len(candidates) else ():
        groups: dict[tuple[float, Profile | None], list[int]] = {}
        for i in candidates[~np.isnan(columns.values[k, candidates])].tolist():
            profile = forms[i if len(forms) > 1 else 0].profile
            groups.setdefault((float(columns.alpha[i]), profile), []).append(i)
        for group in groups.values():
            if len(group) >= LEAST:
                yield np.array(group)[np.argsort(columns.values[k, group], kind="stable")]


def along(columns: Columns, request: Request, solver: OnLine) -> Served:
    """Return what is known of the scenes of a curve from a few radii that are solved.

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
    given = next(name for name, k in _GIVEN.items() if not np.isnan(columns.values[k, 0]))
    ends = [solver.at_scene(i, ("contact_radius",)) for i in (0, size - 1)]
    interval = _ends(ends, size, request.rtol)
    if interval is not None:
        assert ends[0] is not None
        scale = RadiusScale(_profile(ends[0]))
        curve = _PressedCurve(given, scale, Curves(*interval, len(CURVED)))
        inner = columns.values[_GIVEN[given], 1 : size - 1]
        while len(curve.curves.nodes) < nodes_allowed(size):
            if curve.curves.settled(request.rtol):
                found = curve.served(inner, ends[0], request)
                if all((found.errors[one] <= request.rtol).all() for one in request.quantities):
                    mask[1 : size - 1] = True
                    return replace(found, mask=mask)
            if not curve.grow(solver):
                break
    return Served(mask, {}, {})


def _profile(one: Solution) -> Profile:
    assert one.scene.profile is not None
    return one.scene.profile


def _ends(solved: list[Solution | None], size: int, rtol: float) -> tuple[float, float] | None:
    """Return v of the first and of the last scene of a curve, both solved.

    None if a solve failed, if the profile has a break between the two radii, or if interpolation
    would take too many nodes.
    """
    known = [one for one in solved if one is not None]
    if len(known) < len(solved):
        return None
    profile = _profile(known[0])
    first, last = (one.contact_radius for one in known)
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
        one = solver.with_contact_radius(self.scale.radius(self.curves.next()), CURVED)
        if one is None:
            return False
        known = np.log([getattr(one, name) for name in self.names])
        self.curves.add(known, np.array([getattr(one.error, name) for name in self.names]))
        return True

    def served(self, given: Array, one: Solution, request: Request) -> Served:
        """Return values and errors of the quantities that are asked for.

        Parameters
        ----------
        given : ndarray, shape (scenes,)
            Load or approach of every scene.
        one : Solution
            Of any scene of the curve; has the quantities that are the same in all of them.
        request : Request
        """
        found = self.curves.where(np.log(given))
        radius = np.array([self.scale.radius(v) for v in found.places.tolist()])
        slope = np.array([self.scale.derivative(r) for r in radius.tolist()])  # da/dv
        # a radius is rounded, which is as much as an error of v
        moved = found.moved + ROUNDING * radius / slope
        lost = found.lost + found.slopes * moved[:, None] + ROUNDING
        values = {self.given: given, "contact_radius": radius}
        errors = {self.given: np.zeros(len(given)), "contact_radius": moved * slope / radius}
        for j, name in enumerate(self.names[1:]):
            values[name] = np.exp(found.values[:, j])
            errors[name] = lost[:, j]
        for name in frozenset(request.quantities) - frozenset(values):
            value = getattr(one, name)
            values[name] = np.full(len(given), np.nan if value is None else value)
            errors[name] = np.zeros(len(given))
        asked = request.quantities
        mask = np.ones(len(given), dtype=bool)
        return Served(mask, {k: values[k] for k in asked}, {k: errors[k] for k in asked})
