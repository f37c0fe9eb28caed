"""Derivatives of a solution by the parameters of its scene.

Without coupling the zones are solved for kappa = 1 and the friction ``f/kappa``. This module
converts the derivatives of that system to ones by the friction and Poisson's ratio of the scene.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy.special import ellipe, ellipkm1

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.little_friction import full_slip_problem
from spectral_contact.contact.normal import NormalContact, compliance_derivative, solve_normal
from spectral_contact.contact.refine import Refinement
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

#: Parameters of a scene by which a solution can be differentiated; `_COLUMNS` has their names in
#: the system.
PARAMETERS: Final = ("normal_compliance", "tangential_compliance", "friction", "poisson_ratio")
#: A further parameter, of scenes below their largest load: the load ratio.
LOAD_RATIO: Final = "unloaded_to"
_COLUMNS: Final = {
    **dict(zip(PARAMETERS, ("alpha", "beta", "friction", "kappa"), strict=True)),
    LOAD_RATIO: LOG_DISPLACEMENT,
}
#: Largest number of unknowns of the normal contact.
_MAX_UNKNOWNS: Final = 20_000
#: Largest relative error of the zones at which derivatives are returned; beyond it they are NaN.
_MAX_ZONE_ERROR: Final = 1e-3


def kappa_slope(scene: Scene) -> float:
    """Return the derivative of kappa by Poisson's ratio, or by itself where it is given."""
    if scene.poisson_ratio is None:
        return 1.0
    return -0.25 / (1.0 - scene.poisson_ratio) ** 2


def _state(solution: Solution, zone: Zone) -> int:
    """Return 0 for stick, and the sign of the traction in slip."""
    middle = (zone.inner_from_edge + zone.outer_from_edge) / 2.0
    return (
        0 if zone.kind == "stick" else int(math.copysign(1.0, solution.traction(from_edge=middle)))
    )


def _smooth_surface_derivative(quantity: str, stick_radius: Radius, solution: Solution) -> float:
    """Return the derivative by ``f/kappa`` on a smooth surface, in closed form.

    The quantity is the stick radius c or ``Q/kappa``; K' and E' are complete elliptic integrals of
    the parameter ``1 - c**2``:
    ``f/kappa = ln((1+c)/(1-c)) / (c K')`` and ``Q/kappa = (f/kappa) E' + ln(1-c**2)``.
    """
    c = stick_radius.value
    z = stick_radius.square
    y = stick_radius.rest
    ratio = (solution.scene.friction or 0.0) / solution.scene.kappa
    elliptic_k = float(ellipkm1(z))
    elliptic_e = float(ellipe(y))
    log = 2.0 * math.atanh(c) if c < 0.5 else math.log((1.0 + c) ** 2 / y)
    log_slope = 2.0 / (y * log) - 1.0 / c + (elliptic_e - z * elliptic_k) / (c * y * elliptic_k)
    by_ratio = 1.0 / (ratio * log_slope)
    if quantity == "stick_radius":
        return by_ratio
    return elliptic_e + c / y * (ratio * (elliptic_k - elliptic_e) - 2.0) * by_ratio


class SolutionSlopes:
    """The derivatives at a solution, in spaces for a tolerance.

    For a scene below its largest load in which slip has occurred, `largest` has the derivatives at
    the largest load.
    """

    def __init__(
        self, solution: Solution, tolerance: float, largest: SolutionSlopes | None = None
    ) -> None:
        self.solution = solution
        self.scene = solution.scene
        self.tolerance = tolerance
        self.largest = largest
        zones = solution.zones if self.scene.friction is not None and self.scene.kappa else ()
        self.inner = [Radius(zone.outer, zone.outer_from_edge) for zone in zones[:-1]]
        self.states = tuple(_state(solution, zone) for zone in zones)
        #: whether friction changes the pressure: there is elastic coupling, and there are zones
        self.couples = self.scene.coupling and bool(zones)
        #: whether everything slips, but for a stick disk that is too small to be solved for
        self.slips = any(self.states) and not self.inner
        self.active_parameters = [
            name for name in PARAMETERS[:2] if getattr(self.scene, name) > 0.0
        ]
        if any(self.states):
            self.active_parameters.append("friction")
        if self.couples:
            self.active_parameters.append("poisson_ratio")
        if self.scene.unloaded_to < 1.0 and any(self.states):
            self.active_parameters.append(LOAD_RATIO)
        compliances = self.scene.normal_compliance, self.scene.tangential_compliance
        #: whether there is one stick disk on a smooth surface, where derivatives have closed forms
        self.smooth = bool(self.inner) and not any(compliances) and not self.couples

    @cached_property
    def normal(self) -> tuple[NormalContact, NormalContact | None]:
        """The normal contact without coupling, and its derivative by the normal compliance.

        The derivative is None on a smooth surface.
        """
        # to a tenth of the tolerance, unless that is near the rounding of fields, 3 FIELD_ROUNDING
        solved = solve_normal(
            self.scene.normal_compliance, max(0.1 * self.tolerance, 1.2e-13), _MAX_UNKNOWNS
        )
        if isinstance(solved, Refinement):
            return solved.best.value, compliance_derivative(solved)
        return solved, None

    @cached_property
    def zones(self) -> ZoneDerivatives:
        """The derivatives by all parameters in `active_parameters`.

        Where everything slips they exist only with coupling.
        """
        return self._differentiated()

    def _differentiated(self, *, slip: bool = False) -> ZoneDerivatives:
        scene = self.scene
        known: list[NormalContact] = []
        friction = scene.friction if scene.friction is not None else math.inf
        compliances = scene.normal_compliance, scene.tangential_compliance
        parameters = Parameters(*compliances, scene.kappa, friction)
        layout = Layout(tuple(radius.logit for radius in self.inner), self.states)
        if self.slips:
            parameters, layout = full_slip_problem(parameters)
        elif not self.couples:
            known = [contact for contact in self.normal if contact is not None]
            parameters = Parameters(*compliances, 1.0, friction / scene.kappa)
        names = [_COLUMNS[name] for name in self.active_parameters]
        system = parameters, layout, names, self.tolerance, known
        if self.largest is None:
            return differentiated(*system, slip=slip)
        kept_slip = self.largest.solution.slip_field
        assert isinstance(kept_slip, ZonalField)
        fields = *self.largest._differentiated(slip=True).slip, kept_slip.times(1.0 / scene.kappa)
        factor = 1.0 / scene.unloaded_to
        displacements = [KnownDisplacement(field, factor, 0.0) for field in fields]
        displaced_by = dict(zip(names, displacements, strict=True))
        return differentiated(*system, displacements[-1], displaced_by)

    def scalar(self, quantity: str, name: str, boundary: int = 0) -> float:
        """Return the derivative of a scalar by a parameter.

        NaN if the error of the zones is too large. For the quantity ``stick_radius``, `boundary` is
        the number of the boundary, counted from the centre.
        """
        if self.inner and (self.solution.error.zones or 0.0) > _MAX_ZONE_ERROR:
            return math.nan
        scene = self.scene
        kappa = self.scene.kappa
        kappa_rate = kappa_slope(scene)
        if name == LOAD_RATIO:
            # In units of the load the displacement in slip, which the state keeps from the largest
            # load, is in proportion to one over the load. So the derivative by the logarithm of the
            # load ratio is minus that by LOG_DISPLACEMENT. The shear has the load as a factor, too:
            # `explicit_part` is the whole derivative by that logarithm here.
            by_zones = (
                self._system_derivative(quantity, name, boundary) if any(self.states) else 0.0
            )
            explicit_part = (
                self.solution.total_shear - kappa * by_zones
                if quantity == "total_shear"
                else -by_zones
            )
            return explicit_part / scene.unloaded_to
        if self.couples:
            column, factor = self._column(name)
            return factor * self._system_derivative(quantity, column, boundary)
        if name == "poisson_ratio":
            # Zones are functions of f/kappa, whose derivative by kappa is -(f/kappa)/kappa. The
            # shear is kappa times a function of f/kappa: `explicit_part`, the derivative by the
            # factor kappa, is the function itself.
            ratio = scene.friction / kappa if self.inner and scene.friction else 0.0
            by_zones = (
                ratio * self._system_derivative(quantity, "friction", boundary) if ratio else 0.0
            )
            explicit_part = self.solution.total_shear / kappa if quantity == "total_shear" else 0.0
            scale = 1.0 if quantity == "total_shear" else 1.0 / kappa
            return kappa_rate * (explicit_part - by_zones) * scale + 0.0
        factor = kappa if quantity == "total_shear" else 1.0
        derivative = self._system_derivative(quantity, name, boundary)
        return factor * derivative / (kappa if name == "friction" else 1.0)

    def _column(self, name: str) -> tuple[str, float]:
        """Return the column of the system with coupling, and the factor of its derivatives.

        Where everything slips kappa and f matter through ``kappa f`` alone. So derivatives by ln
        kappa are those by ln f, and the column of the friction serves for Poisson's ratio.
        """
        if name != "poisson_ratio":
            return name, 1.0
        kappa_rate = kappa_slope(self.scene)
        if self.slips:
            return "friction", kappa_rate * (self.scene.friction or 0.0) / self.scene.kappa
        return name, kappa_rate

    def _system_derivative(self, quantity: str, name: str, boundary: int) -> float:
        """Return the derivative of a scalar by a parameter of the system, as named in `_COLUMNS`.

        On a smooth surface it is that by ``f/kappa``, the only parameter there.
        """
        if self.smooth:
            return _smooth_surface_derivative(quantity, self.inner[0], self.solution)
        i = self.active_parameters.index(name)
        if quantity == "stick_radius":
            c = self.inner[boundary]
            return 0.5 * c.value * c.rest * float(self.zones.logits[boundary, i])
        if quantity == "approach":
            return float(self.zones.approach[i])
        return self.scene.unloaded_to * float(self.zones.shear[i])

    def noise(self, name: str, boundary: int) -> float:
        """Return the relative error by rounding of the derivative of a boundary."""
        column = "friction" if name == "poisson_ratio" and not self.couples else name
        i = self.active_parameters.index(column)
        size = abs(float(self.zones.logits[boundary, i]))
        return float(self.zones.noise[boundary, i]) / size if size else 0.0

    def field(self, quantity: str, name: str, s: Array, from_edge: Array) -> Array:
        """Return the derivative of a field at radii ``s``, given with their distances ``1 - s``."""
        if quantity == "traction":
            return self._traction(name, s, from_edge)
        return self._pressure(name, s, from_edge)

    def _pressure(self, name: str, s: Array, from_edge: Array) -> Array:
        if self.couples:
            column, factor = self._column(name)
            return factor * self.zones.pressure[self.active_parameters.index(column)](s, from_edge)
        load = self.scene.unloaded_to
        if name == LOAD_RATIO:
            return np.asarray(self.solution.pressure(from_edge=from_edge) / load)
        change = self.normal[1]
        if name != "normal_compliance" or change is None:
            return np.zeros(s.shape)
        return np.asarray(load * change.pressure(s, from_edge))

    def _traction_in_stick(self, name: str, s: Array, from_edge: Array) -> Array:
        """Return the derivative of the traction in stick, as the system has it; 0 in slip."""
        traction = self.zones.traction[self.active_parameters.index(name)]
        return np.asarray(self.scene.unloaded_to * traction(s, from_edge))

    def _traction(self, name: str, s: Array, from_edge: Array) -> Array:
        scene = self.scene
        kappa = self.scene.kappa
        solution = self.solution
        kappa_rate = kappa_slope(scene)
        if name == LOAD_RATIO:
            by_zones = self._traction_in_stick(name, s, from_edge) if self.inner else 0.0
            q = solution.traction(from_edge=from_edge)
            return np.asarray((q - kappa * by_zones) / scene.unloaded_to)
        beyond = [boundary.below(s, from_edge) < 0.0 for boundary in self.inner]
        sign = np.array(self.states)[np.sum(beyond, axis=0, dtype=int)]
        if name == "poisson_ratio" and not self.couples:
            q = solution.traction(from_edge=from_edge) / kappa
            if self.inner:
                by_ratio = self._traction_in_stick("friction", s, from_edge)
                q = q - (scene.friction or 0.0) / kappa * by_ratio
            return kappa_rate * np.where(sign == 0, q, 0.0)
        in_stick = np.zeros(s.shape)
        if not self.slips:
            in_stick = self._traction_in_stick(name, s, from_edge)
        if self.couples:
            in_stick = in_stick * (kappa_rate if name == "poisson_ratio" else 1.0)
        elif name != "friction":
            in_stick = in_stick * kappa
        if not any(self.states):
            return in_stick
        in_slip = (scene.friction or 0.0) * self._pressure(name, s, from_edge)
        if name == "friction":
            in_slip = in_slip + solution.pressure(from_edge=from_edge)
        # where it sticks the pressure may be infinite, as at a smooth edge
        return np.asarray(in_stick + sign * np.where(sign == 0, 0.0, in_slip))
