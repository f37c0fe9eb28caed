"""Partial slip with elastic coupling on any zones: their fields, and the friction law, checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf, pi
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_slip import (
    BROKEN,
    CHECKED,
    FINER,
    CoupledSlip,
    InY,
    NoCoupledDiskError,
    as_power,
)
from spectral_contact.contact.coupled_zones import CoupledZones, solve_coupled_zones
from spectral_contact.contact.friction_law import obeys, unknown_slip
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_displacement import Slipping, slip_displacement
from spectral_contact.contact.zones_spaces import leading_depth
from spectral_contact.fields import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    LogSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.solution import PARTIAL_SLIP, SLIP_FIELD, Zone
from spectral_contact.spectral.annulus import Annulus, Family, Points
from spectral_contact.spectral.parameters import Parameters

__all__ = ["solve_coupled_annuli"]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]


def solve_coupled_annuli(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    record: Record,
) -> CoupledSlip:
    """Solve coupled partial slip on zones like these.

    Parameters
    ----------
    parameters : Parameters
        With ``beta*`` > 0.
    layout : Layout
        The states of the zones, and a guess of their boundaries.
    tolerance : float
        Bound on the relative errors of both fields.
    max_unknowns : int
        Most unknowns of a space.
    record : callable
        Takes the name of a step, its outcome and its beginning, returns the value.

    Raises
    ------
    NoCoupledDiskError
        If the friction law is broken.
    """
    begin = perf_counter()
    refinement = solve_coupled_zones(parameters, layout, tolerance, max_unknowns)
    solved: CoupledZones = record(PARTIAL_SLIP, refinement, begin)
    begin = perf_counter()
    outcome: CoupledSlip = record(SLIP_FIELD, _Outcome(solved, parameters).checked(), begin)
    return outcome


@dataclass(slots=True)
class _Outcome:
    """Fields, displacement and checks of a solution on any zones."""

    solved: CoupledZones
    parameters: Parameters

    @property
    def _bounds(self) -> tuple[Radius, ...]:
        return CENTRE, *self.solved.zones.radii, EDGE

    def _series(self, k: int, one: LogSeries) -> LogSeries:
        """Return the pressure of a part; a singular one ends in its leading term."""
        part = self.solved.zones.parts[k]
        if one.power == 0.0:
            return one
        if part.state != 0:
            return as_power(one, part.state * self.parameters.kappa * self.parameters.friction)
        depth = leading_depth(self.parameters.alpha, self.parameters.beta, part.family.reach)
        count = min(ceil(depth / one.width), len(one.coefficients))
        tail = np.array([one.coefficients[count - 1].sum()])
        return replace(one, coefficients=one.coefficients[:count], tail=tail)

    def _pieces(self) -> tuple[ZonalField, ZonalField]:
        """Return pressure and traction."""
        solved, bounds = self.solved, self._bounds
        series = [self._series(k, one) for k, one in enumerate(solved.pressure)]
        rim, shear = bounds[1], solved.shear
        assert shear[0] is not None
        pressure = [ZonePiece(rim, DiskSeries(rim, series[0], power=0))]
        traction = [ZonePiece(rim, DiskSeries(rim, shear[0].times(rim.value)))]
        for zone, state in enumerate(solved.layout.states[1:], start=1):
            inner, outer, a, b = bounds[zone], bounds[zone + 1], 2 * zone - 1, 2 * zone
            own = AnnulusSeries(inner, outer, series[a], series[b], power=0)
            pressure.append(ZonePiece(outer, own))
            above, below = shear[a], shear[b]
            if above is None or below is None:
                traction.append(ZonePiece(outer, own, state * self.parameters.friction))
            else:
                traction.append(ZonePiece(outer, AnnulusSeries(inner, outer, above, below)))
        return ZonalField(tuple(pressure)), ZonalField(tuple(traction))

    def checked(self) -> CoupledSlip:
        """Return the solution if it obeys the friction law."""
        solved, (_, beta, _, friction) = self.solved, self.parameters
        pressure, traction = self._pieces()
        slipping, lost = self._slipping()
        fields, samples, largest, unresolved = slip_displacement(
            solved.stuck, slipping, InY(pressure), beta, friction
        )
        bounds, slips = self._bounds, iter(fields)
        states = solved.layout.states
        slip = ZonalField(
            tuple(
                ZonePiece(end, next(slips) if state else None)
                for state, end in zip(states, bounds[1:], strict=True)
            )
        )
        excess = self._excess()
        wrong = max(float(one.max()) for one in samples) / largest
        d = np.exp(-np.linspace(0.0, 60.0, 500))
        if not min(float(one(d).min()) for one in solved.pressure) > 0.0:
            raise NoCoupledDiskError("the pressure is not positive")
        if excess > BROKEN:
            raise NoCoupledDiskError("the traction in stick exceeds friction")
        # beta f p is part of the displacement, as large as the rest of it or less
        highest = max(
            float(np.abs(solved.pressure[k](d)).max())
            for k, part in enumerate(solved.zones.parts)
            if part.state
        )
        direct = beta * friction * highest * solved.pressure_error
        stray = solved.stray + lost + unresolved + direct + 20.0 * ROUNDING / (2.0 * pi)
        slip_error = stray / max(largest, 1e-300)
        if wrong > max(BROKEN, slip_error):
            raise NoCoupledDiskError("the surface slips with the traction")
        rim = solved.boundary_errors[0]
        return CoupledSlip(
            tuple(
                Zone.between("slip" if state else "stick", *ends)
                for state, ends in zip(states, pairwise(bounds), strict=True)
            ),
            pressure,
            traction,
            slip,
            solved.approach,
            solved.total_shear,
            solved.approach_error,
            solved.shear_error,
            solved.pressure_error,
            solved.traction_error,
            max(slip_error if slip_error <= 1.0 else inf, unknown_slip(solved.zones_error)),
            rim[0],
            max(rim[1], solved.zones_error),
            max(excess, wrong, 0.0),
            obeys(excess, solved.traction_error, wrong, slip_error),
        )

    def _excess(self) -> float:
        """Return the largest ``|q|/(f p) - 1`` in stick, or 0."""
        d, most = np.exp(-np.linspace(1e-3, CHECKED, 400)), 0.0
        for part, p, u in zip(
            self.solved.zones.parts, self.solved.pressure, self.solved.shear, strict=True
        ):
            if u is not None:
                s = np.sqrt(np.maximum(part.family.points(d).z, 0.0))
                most = max(
                    most, float((s * np.abs(u(d)) / (self.parameters.friction * p(d))).max())
                )
        return max(most - 1.0, 0.0)

    def _slipping(self) -> tuple[list[Slipping], float]:
        """Return E = kappa R - G at the sampling points of slip, and its largest change.

        The displacement changes by a quarter of that at most; E is seen at these points alone.
        """
        zones, slipping, lost = self.solved.zones, [], 0.0
        for zone, state in enumerate(zones.states):
            if state == 0:
                continue
            halves = [p.family.panels for p in zones.parts if p.zone == zone]
            plain = [replace(p, power=0.0, degree=p.degree + FINER) for p in halves]
            annulus = Annulus(self._bounds[zone], self._bounds[zone + 1], plain[0], plain[1])
            values = [self._misfit(family) for family in annulus.families]
            lost = max(lost, *(float(np.abs(one[:, 1]).max()) for one in values))
            first, second = (np.ascontiguousarray(one[:, 0]) for one in values)
            slipping.append(Slipping(annulus, state, (first, second)))
        return slipping, lost

    def _misfit(self, family: Family) -> Array:
        """Return E at the sampling points of a family, and its change."""
        points: Points = family.sampling()
        total = np.zeros((len(points.offset), 2))
        pairs = zip(self.solved.zones.parts, self.solved.driven, self.solved.sheared, strict=True)
        for part, p, u in pairs:
            # a part lies inside or outside of the points, unless it is their own
            inner = 2.0 * self.parameters.kappa / np.sqrt(points.z)[:, None]
            total += inner * (part.family.inner_integral(points) @ p)
            total -= part.shear.half_integral(points) @ u
        return total
