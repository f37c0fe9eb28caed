"""Partial slip with elastic coupling: one stick disk, its fields, and the friction law, checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan, ceil, pi
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_disk import CoupledDisk, solve_coupled_disk
from spectral_contact.contact.coupled_spaces import LEADING
from spectral_contact.contact.friction_law import obeys, unknown_slip
from spectral_contact.contact.resolution import ROUNDING, series_of
from spectral_contact.contact.slip_displacement import Slipping, slip_displacement
from spectral_contact.fields import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    LogSeries,
    ZonalField,
    ZonePiece,
)
from spectral_contact.solution import PARTIAL_SLIP, SLIP_FIELD, Zone
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.sliding import SlidingDisk

__all__ = [
    "BROKEN",
    "CHECKED",
    "FINER",
    "FINEST",
    "CoupledSlip",
    "InY",
    "NoCoupledDiskError",
    "as_power",
    "solve_coupled_slip",
]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]

#: A violation of the friction law that other zones are to blame for, not rounding.
BROKEN = 1e-6
#: Stick at the edge of a smooth surface with tangential compliance that is wider than this counts.
FINEST = 1e-80
#: Depth in ``-ln d`` down to which the traction is compared with friction.
CHECKED = 36.0
#: Degrees that the panels of the displacement have beyond those of the pressure.
FINER = 8


class NoCoupledDiskError(ArithmeticError):
    """One stick disk does not obey the friction law; the text says what is amiss."""


@dataclass(frozen=True, slots=True)
class CoupledSlip:
    """Coupled partial slip for unit load.

    Attributes
    ----------
    zones : tuple of Zone
    pressure, traction, slip : ZonalField
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    approach_error, shear_error : float
        Estimates of relative errors.
    pressure_error, traction_error : float
        The same of p and of q/s, pointwise.
    slip_error : float
        Relative to the largest slip.
    radius_error, edge_error : float
        Of ``c`` and of ``1 - c``.
    violation : float
        By how much the friction law is broken, see `ErrorEstimates`.
    consistent : bool
        Whether the violation is within the errors.
    """

    zones: tuple[Zone, ...]
    pressure: ZonalField
    traction: ZonalField
    slip: ZonalField
    approach: float
    total_shear: float
    approach_error: float
    shear_error: float
    pressure_error: float
    traction_error: float
    slip_error: float
    radius_error: float
    edge_error: float
    violation: float
    consistent: bool


@dataclass(frozen=True, slots=True)
class InY:
    """A field as a function of ``y = 1 - s**2``."""

    field: ZonalField

    def at(self, y: Array) -> Array:
        """Evaluate."""
        s = np.sqrt(np.maximum(1.0 - y, 0.0))
        return self.field(s, y / (1.0 + s))


def solve_coupled_slip(
    parameters: Parameters,
    guess: float,
    tolerance: float,
    max_unknowns: int,
    *,
    record: Record,
) -> CoupledSlip:
    """Solve coupled partial slip with one stick disk.

    Parameters
    ----------
    parameters : Parameters
    guess : float
        Stick radius to begin with, as ``ln(c**2/(1 - c**2))``.
    tolerance : float
        Bound on the relative errors of both fields.
    max_unknowns : int
        Most unknowns of a space.
    record : callable
        Takes the name of a step, its outcome and its beginning, returns the value.

    Raises
    ------
    NoStickDiskError
        If no radius makes the traction continuous.
    NoCoupledDiskError
        If the friction law is broken at the one that does: there are other zones.
    """
    if parameters.alpha == 0.0 and (parameters.friction * parameters.beta) ** 2 > FINEST:
        raise NoCoupledDiskError("the edge sticks, as the pressure is infinite there and q is not")
    begin = perf_counter()
    refinement = solve_coupled_disk(parameters, tolerance, max_unknowns, guess)
    solved: CoupledDisk = record(PARTIAL_SLIP, refinement, begin)
    begin = perf_counter()
    outcome: CoupledSlip = record(SLIP_FIELD, _outcome(solved, parameters), begin)
    return outcome


def _outcome(solved: CoupledDisk, parameters: Parameters) -> CoupledSlip:
    """Add fields, displacement and checks to the solution on the disk."""
    _, beta, kappa, friction = parameters
    rim, (own, above, below, shear) = solved.radius, solved.series
    around = AnnulusSeries(rim, EDGE, above, as_power(below, kappa * friction), power=0)
    inside = DiskSeries(rim, own, power=0)
    pressure = ZonalField((ZonePiece(rim, inside), ZonePiece(EDGE, around)))
    stuck = DiskSeries(rim, shear.times(rim.value))
    traction = ZonalField((ZonePiece(rim, stuck), ZonePiece(EDGE, around, friction)))
    annulus, misfit, lost = _misfit(solved, kappa, friction)
    at = InY(pressure)
    fields, samples, largest, unresolved = slip_displacement(
        [solved.stuck], [Slipping(annulus, 1, misfit)], at, beta, friction
    )
    slip = ZonalField((ZonePiece(rim, None), ZonePiece(EDGE, fields[0])))
    excess = _excess(solved, friction)
    wrong = float(samples[0].max()) / largest
    lowest = min(float(f(np.exp(-np.linspace(0.0, 60.0, 500))).min()) for f in (own, above, below))
    if not lowest > 0.0:
        raise NoCoupledDiskError("the pressure is not positive")
    if excess > BROKEN:
        raise NoCoupledDiskError("the traction in stick exceeds friction")
    # beta f p is part of the displacement, as large as the rest of it or less
    direct = beta * friction * float(np.abs(above(np.array([0.0]))[0])) * solved.pressure_error
    stray = solved.stray + lost + unresolved + direct + 20.0 * ROUNDING / (2.0 * pi)
    slip_error = stray / max(largest, 1e-300)
    if wrong > max(BROKEN, slip_error):  # where no digit of the slip is known its sense is not
        raise NoCoupledDiskError("the surface slips with the traction")
    return CoupledSlip(
        (Zone.between("stick", CENTRE, rim), Zone.between("slip", rim, EDGE)),
        pressure,
        traction,
        slip,
        solved.approach,
        solved.total_shear,
        solved.approach_error,
        solved.shear_error,
        solved.pressure_error,
        solved.traction_error,
        max(slip_error if slip_error <= 1.0 else np.inf, unknown_slip(solved.edge_error)),
        solved.radius_error,
        solved.edge_error,
        max(excess, wrong, 0.0),
        obeys(excess, solved.traction_error, wrong, slip_error),
    )


def _excess(solved: CoupledDisk, friction: float) -> float:
    """Return the largest ``|q|/(f p) - 1`` on the disk, or 0."""
    own, _, _, shear = solved.series
    d = np.exp(-np.linspace(1e-3, CHECKED, 400))
    ratio = solved.radius.value * np.sqrt(1.0 - d) * np.abs(shear(d)) / (friction * own(d))
    return max(float(ratio.max()) - 1.0, 0.0)


def _misfit(
    solved: CoupledDisk, kappa: float, friction: float
) -> tuple[Annulus, tuple[Array, Array], float]:
    """Return E = kappa R - G at the sampling points of the annulus, and its largest change.

    The displacement changes by a quarter of that at most; E is seen at these points alone.
    """
    disk = solved.disk
    own, *around, _ = (
        np.column_stack(pair) for pair in zip(solved.parts, solved.change, strict=True)
    )
    # the far end of the annulus is a singularity ln 2 before the first panels
    plain = [replace(p, power=0.0, degree=p.degree + FINER) for p in disk.panels[1:]]
    annulus = Annulus(solved.radius, EDGE, plain[0], plain[1])
    values, lost = [], 0.0
    integrals = _integrals(disk, annulus, around)
    inside = disk.from_disk(own, (plain[0], plain[1]))
    for family, (inner, halves), seen in zip(annulus.families, integrals, inside, strict=True):
        driven = (seen + inner) / np.sqrt(family.sampling().z)[:, None]
        missed = 2.0 * kappa * driven - friction * halves
        values.append(np.ascontiguousarray(missed[:, 0]))
        lost = max(lost, float(np.abs(missed[:, 1]).max()))
    return annulus, (values[0], values[1]), lost


def _integrals(
    disk: SlidingDisk, annulus: Annulus, around: list[Array]
) -> list[tuple[Array, Array]]:
    """Return both integrals of the annulus's pressure, see `SlidingDisk.from_annulus`.

    They are taken at the sampling points of its halves, of pressures as columns.
    """
    if disk.panels[2].power != 0.0:  # for which there are matrices alone
        whole = np.concatenate(around)
        return [disk.from_annulus(one.sampling(), whole) for one in annulus.families]
    inner, halves = [], []
    for pressure in zip(*(np.ascontiguousarray(one.T) for one in around), strict=True):
        values, over = [], []
        for family, panels, own in zip(annulus.families, disk.panels[1:], pressure, strict=True):
            sampled = family.panels.sampling(), family.panels.tail_sampling()
            d = np.concatenate([np.exp(-sampled[0]).ravel(), sampled[1]])
            values.append(series_of(panels, own)(d))
            over.append(values[-1] / np.sqrt(family.sampling().z))
        inner.append(annulus.own_inner_integral(annulus.expand(values)))
        halves.append(annulus.own_half_integral(annulus.expand(over)))
    split = [annulus.sampling_split]
    pairs = (np.split(np.column_stack(one), split) for one in (inner, halves))
    return list(zip(*pairs, strict=True))


def as_power(series: LogSeries, coupling: float) -> LogSeries:
    """Return a pressure under a smooth punch as the power of y that it is next to the edge.

    ``p ~ y**(theta - 1/2)`` with ``tan(pi theta) = 2 kappa f``: far below the edge's panels the
    series ends in this law instead of a polynomial.
    """
    if series.power == 0.0:
        return series
    theta, width = atan(2.0 * coupling) / pi, series.width
    count = min(ceil(LEADING / width), len(series.coefficients))
    terms = series.coefficients.shape[1]
    g, _ = gauss_rule(terms + 8)
    x = width * (np.arange(count)[:, None] + (1.0 + g) / 2.0)
    values = series.coefficients[:count] @ legendre_values(g, terms - 1).T * np.exp(theta * x)
    table = values @ legendre_expansion_matrix(terms + 8, terms + 7).T
    return replace(
        series, coefficients=table, tail=np.array([table[-1].sum()]), power=series.power + theta
    )
