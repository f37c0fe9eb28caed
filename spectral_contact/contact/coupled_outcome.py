"""What coupled partial slip ends in, whatever its zones: fields that obey the friction law."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan, ceil, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.coupled_parts import LEADING, ended
from spectral_contact.contact.friction_law import (
    known_share,
    loose_slip,
    missing_stick,
    obeys,
)
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_displacement import Slipping, Stuck, slip_displacement
from spectral_contact.fields.series import (
    CENTRE,
    EDGE,
    AnnulusSeries,
    DiskSeries,
    LogSeries,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.records import Zone
from spectral_contact.spectral.annulus import Annulus, gap
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix, legendre_values
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parameters import Parameters

__all__ = [
    "DISTANCES",
    "CoupledSlip",
    "NoCoupledSlipError",
    "Solved",
    "checked",
    "slip_annulus",
    "stick_series",
    "with_misfits",
]

Array = NDArray[np.float64]

#: Degrees that the panels of the displacement have beyond those of the pressure: the far end of an
#: annulus is a singularity ln 2 before the first panel.
_FINER = 8
#: Distances from a boundary at which the traction is compared with friction.
DISTANCES = np.exp(-np.linspace(1e-3, 36.0, 400))
#: A violation of the friction law that other zones are to blame for, not rounding.
_BROKEN = 1e-6


class NoCoupledSlipError(ArithmeticError):
    """Zones do not obey the friction law; the text says what is amiss.

    Attributes
    ----------
    further : Layout or None
        Zones that may do so: one disk, and stick where slip around it has the wrong sense.
    """

    def __init__(self, text: str, further: Layout | None = None) -> None:
        super().__init__(text)
        self.further = further


@dataclass(frozen=True, slots=True)
class Solved:
    """The solution on given zones for unit load, before the friction law is checked.

    Attributes
    ----------
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick, +1 or -1 for slip with this sign of the traction.
    approach, total_shear : float
        ``delta*`` and ``Q*``.
    pressure, shear : list of LogSeries
        p on the disk and toward both ends of every zone around it, and q/s where they stick (None
        elsewhere).
    stuck : list of Stuck
        Quadrature of ``t^2 E dt`` over the stick zones, for the displacement outside them.
    approach_error, shear_error, pressure_error, traction_error : float
        Estimates of relative errors; those of the fields, p and q/s, are pointwise.
    radius_error, zones_error : float
        Of ``c``, and the largest one of all boundaries, from the centre and from the edge;
        infinite if a zone may not be there.
    stray : float
        Estimate of the largest error of E.
    """

    radii: tuple[Radius, ...]
    states: tuple[int, ...]
    approach: float
    total_shear: float
    pressure: list[LogSeries]
    shear: list[LogSeries | None]
    stuck: list[Stuck]
    approach_error: float
    shear_error: float
    pressure_error: float
    traction_error: float
    radius_error: float
    zones_error: float
    stray: float

    @property
    def bounds(self) -> tuple[Radius, ...]:
        """Ends of the zones, from the centre to the edge."""
        return CENTRE, *self.radii, EDGE

    @property
    def depth(self) -> float:
        """``-ln`` of the smallest scaled distance from the rim that was resolved."""
        assert self.shear[0] is not None
        return len(self.shear[0].coefficients) * self.shear[0].width

    @property
    def layout(self) -> Layout:
        """The zones."""
        return Layout(tuple(one.logit for one in self.radii), self.states)


@dataclass(frozen=True, slots=True)
class CoupledSlip:
    """Coupled partial slip for unit load.

    Attributes
    ----------
    solved : Solved
    zones : tuple of Zone
    pressure, traction, slip : ZonalField
    slip_error : float
        Relative to the largest slip.
    violation : float
        By how much the friction law is broken, see `ErrorEstimates`.
    consistent : bool
        Whether the violation is within the errors.
    """

    solved: Solved
    zones: tuple[Zone, ...]
    pressure: ZonalField
    traction: ZonalField
    slip: ZonalField
    slip_error: float
    violation: float
    consistent: bool


def slip_annulus(inner: Radius, outer: Radius, panels: Sequence[LogPanels]) -> Annulus:
    """Return the annulus of a displacement, of the pressure's panels with some degrees more."""
    first, second = (replace(p, power=0.0, degree=p.degree + _FINER) for p in panels)
    return Annulus(inner, outer, first, second)


def checked(
    solved: Solved,
    parameters: Parameters,
    misfits: list[tuple[Annulus, list[Array]]],
    sticking: Iterable[tuple[Array, LogSeries, LogSeries]],
) -> CoupledSlip:
    """Return fields and displacement, if they obey the friction law.

    Parameters
    ----------
    solved : Solved
    parameters : Parameters
    misfits : list of (Annulus, list of ndarray)
        The slip zones, outward, and ``E = kappa R - G`` at the sampling points of their halves,
        with its change as a second column. The displacement changes by a quarter of that at most;
        E is seen at these points alone.
    sticking : iterable of (ndarray, LogSeries, LogSeries)
        The radii at `DISTANCES` from every end of a stick zone, and p and q/s there.

    Raises
    ------
    NoCoupledSlipError
        If the law is broken.
    """
    beta, friction = parameters.beta, parameters.friction
    pressure, traction = _fields(solved, parameters)
    slipping, lost = with_misfits(solved, misfits)
    fields, samples, largest, unresolved = slip_displacement(
        solved.stuck, slipping, pressure, beta, friction
    )
    d = np.exp(-np.linspace(0.0, 60.0, 500))
    values = [one(d) for one in solved.pressure]
    if not np.min(values) > 0.0:
        raise NoCoupledSlipError("the pressure is not positive")
    excess = max(_excess(sticking, friction), 0.0)
    if excess > _BROKEN:
        raise NoCoupledSlipError("the traction in stick exceeds friction")
    # beta f p is part of the displacement, as large as the rest of it or less
    highest = max(float(p.max()) for i, p in enumerate(values) if solved.states[(i + 1) // 2])
    direct = beta * friction * highest * solved.pressure_error
    stray = solved.stray + lost + unresolved + direct + 20.0 * ROUNDING / (2.0 * pi)
    slip_error = stray / max(largest, 1e-300)
    wrong = max(float(one.max()) for one in samples) / largest
    missing = tuple(
        interval
        for zone, field, sample in zip(slipping, fields, samples, strict=True)
        for interval in missing_stick(
            zone.annulus, sample, largest, zone.sign * field.toward_outer.limit
        )
    )
    if wrong > max(_BROKEN, slip_error):  # where no digit of the slip is known its sense is not
        raise NoCoupledSlipError(
            "the surface slips with the traction", solved.layout.mended(missing)
        )
    slips = iter(fields)
    zones, pieces = [], []
    for state, (inner, outer) in zip(solved.states, pairwise(solved.bounds), strict=True):
        zones.append(Zone.between("slip" if state else "stick", inner, outer))
        pieces.append(ZonePiece(outer, next(slips) if state else None))
    return CoupledSlip(
        solved,
        tuple(zones),
        pressure,
        traction,
        ZonalField(tuple(pieces)),
        known_share(slip_error + loose_slip(solved.zones_error)),
        max(excess, wrong, 0.0),
        obeys(excess, solved.traction_error, wrong, slip_error),
    )


def with_misfits(
    solved: Solved, misfits: list[tuple[Annulus, list[Array]]]
) -> tuple[list[Slipping], float]:
    """Return the slip zones with E, and the largest change of E."""
    slipping, lost = [], 0.0
    for state, (annulus, misfit) in zip(filter(None, solved.states), misfits, strict=True):
        first, second = (np.ascontiguousarray(one[:, 0]) for one in misfit)
        slipping.append(Slipping(annulus, state, (first, second)))
        lost = max(lost, *(float(np.abs(one[:, 1]).max()) for one in misfit))
    return slipping, lost


def _excess(sticking: Iterable[tuple[Array, LogSeries, LogSeries]], friction: float) -> float:
    """Return by how much the traction exceeds friction in stick, relative to it."""
    ratios = (s * np.abs(u(DISTANCES)) / (friction * p(DISTANCES)) for s, p, u in sticking)
    return max((float(one.max()) - 1.0 for one in ratios), default=0.0)


def stick_series(solved: Solved) -> Iterator[tuple[int, DiskSeries | AnnulusSeries]]:
    """Yield the stick zones with their tractions."""
    shear, bounds = solved.shear, solved.bounds
    for zone, state in enumerate(solved.states):
        first, last = shear[max(2 * zone - 1, 0)], shear[2 * zone]
        if state == 0 and first is not None and last is not None:
            if zone:
                yield zone, AnnulusSeries(bounds[zone], bounds[zone + 1], first, last)
            else:
                yield zone, DiskSeries(bounds[1], first.times(bounds[1].value))


def _fields(solved: Solved, parameters: Parameters) -> tuple[ZonalField, ZonalField]:
    """Return pressure and traction."""
    rim, sticks = solved.radii[0], dict(stick_series(solved))
    series = [*solved.pressure[:-1], _to_the_edge(solved, parameters)]
    pressure = [ZonePiece(rim, DiskSeries(rim, series[0], power=0))]
    traction = [ZonePiece(rim, sticks[0])]
    for zone, (inner, outer) in enumerate(pairwise(solved.bounds[1:]), start=1):
        own = AnnulusSeries(inner, outer, series[2 * zone - 1], series[2 * zone], power=0)
        pressure.append(ZonePiece(outer, own))
        slip = ZonePiece(outer, own, solved.states[zone] * parameters.friction)
        traction.append(ZonePiece(outer, sticks[zone]) if zone in sticks else slip)
    return ZonalField(tuple(pressure)), ZonalField(tuple(traction))


def _to_the_edge(solved: Solved, parameters: Parameters) -> LogSeries:
    """Return the pressure next to the edge; where it is singular it ends in its leading term."""
    series, state = solved.pressure[-1], solved.states[-1]
    if series.power == 0.0:
        return series
    if state:
        return _as_power(series, state * parameters.kappa * parameters.friction)
    shear = solved.shear[-1]
    assert shear is not None
    return ended(series, shear, parameters, gap(*solved.bounds[-2:]) / 2.0)[0]


def _as_power(series: LogSeries, coupling: float) -> LogSeries:
    """Return a pressure under a smooth punch as the power of y that it is next to the edge.

    ``p ~ y**(theta - 1/2)`` with ``tan(pi theta) = 2 kappa f``: far below the edge's panels the
    series ends in this law instead of a polynomial.
    """
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
