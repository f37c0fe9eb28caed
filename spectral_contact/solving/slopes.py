"""How a solution changes with the parameters of its scene, as the system of its zones says.

Without coupling the system is that for kappa = 1, whose friction is ``f/kappa``; here that becomes
the scene's.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy.special import ellipe, ellipkm1

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.little_friction import full_slip_problem
from spectral_contact.contact.normal import compliance_derivative, solve_normal
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.contact.zone_derivatives import (
    LOG_DISPLACEMENT,
    ZoneDerivatives,
    differentiated,
)
from spectral_contact.fields import Array
from spectral_contact.fields.series import Radius, ZonalField
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution, Zone
from spectral_contact.spectral.contact_fields import KnownDisplacement
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.threads import cached_property

#: What can be differentiated by, and what the system calls it.
PARAMETERS: Final = ("normal_compliance", "tangential_compliance", "friction", "poisson_ratio")
#: What scenes below their largest load are differentiated by.
LOAD_RATIO: Final = "unloaded_to"
_COLUMNS: Final = {
    **dict(zip(PARAMETERS, ("alpha", "beta", "friction", "kappa"), strict=True)),
    LOAD_RATIO: LOG_DISPLACEMENT,
}
_MOST_UNKNOWNS: Final = 20_000
#: An error of the zones from which on nothing follows from them.
_HARDLY_KNOWN: Final = 1e-3


def kappa_slope(scene: Scene) -> float:
    """Return the derivative of kappa by Poisson's ratio, or by itself where it is given."""
    if scene.poisson_ratio is None:
        return 1.0
    return -0.25 / (1.0 - scene.poisson_ratio) ** 2


def _state(own: Solution, zone: Zone) -> int:
    """Return 0 for stick, and the sign of the traction in slip."""
    middle = (zone.inner_from_edge + zone.outer_from_edge) / 2.0
    return 0 if zone.kind == "stick" else int(math.copysign(1.0, own.traction(from_edge=middle)))


def _of_smooth_surface(quantity: str, rim: Radius, own: Solution) -> float:
    """Return the derivative of a number by ``f/kappa`` without compliances, in closed form.

    ``f/kappa = ln((1+c)/(1-c)) / (c K')`` and ``Q/kappa = (f/kappa) E' + ln(1-c**2)``.
    """
    c, z, y = rim.value, rim.square, rim.rest
    ratio = (own.scene.friction or 0.0) / own.scene.kappa
    first, second = float(ellipkm1(z)), float(ellipe(y))
    log = 2.0 * math.atanh(c) if c < 0.5 else math.log((1.0 + c) ** 2 / y)
    rise = 2.0 / (y * log) - 1.0 / c + (second - z * first) / (c * y * first)
    by_ratio = 1.0 / (ratio * rise)
    if quantity == "stick_radius":
        return by_ratio
    return second + c / y * (ratio * (first - second) - 2.0) * by_ratio


class SolutionSlopes:
    """The derivatives at a solution, in spaces for a tolerance.

    Without coupling the system is that for kappa = 1 and the friction ``f/kappa``. Below the
    largest load and with slip, `largest` has the derivatives there.
    """

    def __init__(
        self, own: Solution, tolerance: float, largest: SolutionSlopes | None = None
    ) -> None:
        self.own, self.scene, self.tolerance = own, own.scene, tolerance
        self.largest = largest
        zones = own.zones if self.scene.friction is not None and self.scene.kappa else ()
        self.inner = [Radius(zone.outer, zone.outer_from_edge) for zone in zones[:-1]]
        self.states = tuple(_state(own, zone) for zone in zones)
        #: with coupling friction acts on the pressure, from none on
        self.couples = self.scene.coupling and bool(zones)
        #: whether all slips, around a stick disk that is too small to be solved for
        self.slips = any(self.states) and not self.inner
        self.moving = [name for name in PARAMETERS[:2] if getattr(self.scene, name) > 0.0]
        if any(self.states):
            self.moving.append("friction")
        if self.couples:
            self.moving.append("poisson_ratio")
        if self.scene.unloaded_to < 1.0 and any(self.states):
            self.moving.append(LOAD_RATIO)
        compliances = self.scene.normal_compliance, self.scene.tangential_compliance
        self.smooth = bool(self.inner) and not any(compliances) and not self.couples

    @cached_property
    def normal(self) -> tuple[NormalContact, NormalContact | None]:
        """The pressure as it is without coupling, and its derivative by the compliance."""
        solved = solve_normal(
            self.scene.normal_compliance, max(0.1 * self.tolerance, 1.2e-13), _MOST_UNKNOWNS
        )
        if isinstance(solved, Refinement):
            return solved.best.value, compliance_derivative(solved)
        return solved, None

    @cached_property
    def zones(self) -> ZoneDerivatives:
        """The derivatives by what moves; where all slips that is with coupling."""
        return self._differentiated()

    def _differentiated(self, *, slip: bool = False) -> ZoneDerivatives:
        scene = self.scene
        known: list[NormalContact] = []
        friction = scene.friction if scene.friction is not None else math.inf
        own = scene.normal_compliance, scene.tangential_compliance
        parameters = Parameters(*own, scene.kappa, friction)
        layout = Layout(tuple(one.logit for one in self.inner), self.states)
        if self.slips:
            parameters, layout = full_slip_problem(parameters)
        elif not self.couples:
            known = [one for one in self.normal if one is not None]
            parameters = Parameters(*own, 1.0, friction / scene.kappa)
        names = [_COLUMNS[name] for name in self.moving]
        given = parameters, layout, names, self.tolerance, known
        if self.largest is None:
            return differentiated(*given, slip=slip)
        kept = self.largest.own.slip_field
        assert isinstance(kept, ZonalField)
        fields = *self.largest._differentiated(slip=True).slip, kept.times(1.0 / scene.kappa)
        factor = 1.0 / scene.unloaded_to
        displacements = [KnownDisplacement(one, factor, 0.0) for one in fields]
        displaced_by = dict(zip(names, displacements, strict=True))
        return differentiated(*given, displacements[-1], displaced_by)

    def scalar(self, quantity: str, name: str, boundary: int = 0) -> float:
        """Return the derivative of a number; NaN where zones are hardly known.

        In place of the stick radius any other boundary may be chosen by its number.
        """
        if self.inner and (self.own.error.zones or 0.0) > _HARDLY_KNOWN:
            return math.nan
        scene, kappa = self.scene, self.scene.kappa
        rise = kappa_slope(scene)
        if name == LOAD_RATIO:  # the displacement over the load goes like one over the load
            moved = self._of_system(quantity, name, boundary) if any(self.states) else 0.0
            whole = self.own.total_shear - kappa * moved if quantity == "total_shear" else -moved
            return whole / scene.unloaded_to
        if self.couples:
            column, factor = self._column(name)
            return factor * self._of_system(quantity, column, boundary)
        if name == "poisson_ratio":  # kappa enters shear as a factor, and friction as f/kappa
            ratio = scene.friction / kappa if self.inner and scene.friction else 0.0
            moved = ratio * self._of_system(quantity, "friction", boundary) if ratio else 0.0
            whole = self.own.total_shear / kappa if quantity == "total_shear" else 0.0
            scale = 1.0 if quantity == "total_shear" else 1.0 / kappa
            return rise * (whole - moved) * scale + 0.0
        factor = kappa if quantity == "total_shear" else 1.0
        of_system = self._of_system(quantity, name, boundary)
        return factor * of_system / (kappa if name == "friction" else 1.0)

    def _column(self, name: str) -> tuple[str, float]:
        """Return the parameter of the system, with coupling, and what multiplies its derivatives.

        Where all slips the pressure depends on the product of kappa and the friction.
        """
        if name != "poisson_ratio":
            return name, 1.0
        rise = kappa_slope(self.scene)
        if self.slips:
            return "friction", rise * (self.scene.friction or 0.0) / self.scene.kappa
        return name, rise

    def _of_system(self, quantity: str, name: str, boundary: int) -> float:
        """Return the derivative of a number by a parameter of the system."""
        if self.smooth:
            return _of_smooth_surface(quantity, self.inner[0], self.own)
        i = self.moving.index(name)
        if quantity == "stick_radius":
            c = self.inner[boundary]
            return 0.5 * c.value * c.rest * float(self.zones.logits[boundary, i])
        if quantity == "approach":
            return float(self.zones.approach[i])
        return self.scene.unloaded_to * float(self.zones.shear[i])

    def noise(self, name: str, boundary: int) -> float:
        """Return what rounding makes of the derivative of a boundary, relative to that."""
        column = "friction" if name == "poisson_ratio" and not self.couples else name
        i = self.moving.index(column)
        size = abs(float(self.zones.logits[boundary, i]))
        return float(self.zones.noise[boundary, i]) / size if size else 0.0

    def field(self, quantity: str, name: str, s: Array, from_edge: Array) -> Array:
        """Return the derivative of a field at some places."""
        if quantity == "traction":
            return self._traction(name, s, from_edge)
        return self._pressure(name, s, from_edge)

    def _pressure(self, name: str, s: Array, from_edge: Array) -> Array:
        if self.couples:
            column, factor = self._column(name)
            return factor * self.zones.pressure[self.moving.index(column)](s, from_edge)
        load = self.scene.unloaded_to
        if name == LOAD_RATIO:
            return np.asarray(self.own.pressure(from_edge=from_edge) / load)
        change = self.normal[1]
        if name != "normal_compliance" or change is None:
            return np.zeros(s.shape)
        return np.asarray(load * change.pressure(s, from_edge))

    def _traction_in_stick(self, name: str, s: Array, from_edge: Array) -> Array:
        """Return the derivative of the traction in stick, as the system has it; 0 in slip."""
        traction = self.zones.traction[self.moving.index(name)]
        return np.asarray(self.scene.unloaded_to * traction(s, from_edge))

    def _traction(self, name: str, s: Array, from_edge: Array) -> Array:
        scene, kappa, own = self.scene, self.scene.kappa, self.own
        rise = kappa_slope(scene)
        if name == LOAD_RATIO:
            moved = self._traction_in_stick(name, s, from_edge) if self.inner else 0.0
            q = own.traction(from_edge=from_edge)
            return np.asarray((q - kappa * moved) / scene.unloaded_to)
        beyond = [one.below(s, from_edge) < 0.0 for one in self.inner]
        sign = np.array(self.states)[np.sum(beyond, axis=0, dtype=int)]
        if name == "poisson_ratio" and not self.couples:
            q = own.traction(from_edge=from_edge) / kappa
            if self.inner:
                by_ratio = self._traction_in_stick("friction", s, from_edge)
                q = q - (scene.friction or 0.0) / kappa * by_ratio
            return rise * np.where(sign == 0, q, 0.0)
        value = np.zeros(s.shape)
        if not self.slips:
            value = self._traction_in_stick(name, s, from_edge)
        if self.couples:
            value = value * (rise if name == "poisson_ratio" else 1.0)
        elif name != "friction":
            value = value * kappa
        if not any(self.states):
            return value
        slipping = (scene.friction or 0.0) * self._pressure(name, s, from_edge)
        if name == "friction":
            slipping = slipping + own.pressure(from_edge=from_edge)
        return np.asarray(value + sign * slipping)
