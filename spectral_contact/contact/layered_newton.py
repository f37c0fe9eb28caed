r"""Newton's method for contact through a nonlinear layer, in a given space."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.fields.series import central_value
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.cells import DiskCells
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.parts import DiskPartition
from spectral_contact.spectral.regularised import Change

if TYPE_CHECKING:
    from spectral_contact.contact.layered_bends import Bend
    from spectral_contact.contact.layered_spaces import Form

Array = NDArray[np.float64]

#: ``N`` of the pressure 1 on the unit disk, at its centre.
_OWN = 0.5
#: Most corrections; by how much of the largest pressure the law may bend over one that is taken as
#: it is; what ends the iteration: a correction, or what the next one would be after a small one.
_STEPS, _BEND, _DONE, _NEXT, _LAGGING = 80, 0.1, 1e-14, 1e-15, 1e-13
#: A correction that is smaller and does not fall any more is rounding.
_ROUNDED = 1e-9
#: Steps of the pointwise equation, and its tolerance.
_POINTWISE_STEPS, _POINTWISE = 200, 1e-10
#: Stiffness times `_OWN` beyond which a spring eases the beginning, by what it becomes stiffer,
#: corrections with each, and what is near enough.
_SOFT, _STIFFER, _EASED, _NEAR = 10.0, 0.2, 12, 0.02
#: Degrees in which that is done.
_LOW = 5
#: Where next to the edge the slope is taken, in units of the layer or of the distance to a pole.
_SLOPE = 1e-4
#: A rule that integrates any power there: its points, and how they crowd to the edge.
_EDGE_POINTS, _EDGE_GRADE = 24, 8


@dataclass(frozen=True, slots=True)
class LayeredSetting:
    """What is to be solved, in lengths of the profile's unit.

    Attributes
    ----------
    profile : Profile
    layer : Layer
    radius : float
        Of the disk: the contact's, or that beyond which there is no pressure to rounding.
    approach : float or None
        None where the overclosure begins at the edge.
    load : float or None
        Where the approach is to be such that it is carried; else it is as given.
    centre : float or None
        Where it is to be such that this is the overclosure at the centre.
    parts : DiskPartition
        How panels cut the disk, if there are no cells.
    drives : bool
        Whether the pressure, under a flat punch, has to drive a traction.
    cells : DiskCells or None
        Where the pressure is smooth throughout.
    depths : tuple of float
        ``x`` of the deepest feature at the end of every part.
    smooth : tuple of bool
        Whether the pressure is smooth in ``s**2`` at the end of every part.
    bends : tuple of Bend
        Where the law is taken to bend, from the centre outward: there parts end.
    """

    profile: Profile
    layer: Layer
    radius: float
    approach: float | None
    parts: DiskPartition
    depths: tuple[float, ...]
    smooth: tuple[bool, ...]
    load: float | None = None
    centre: float | None = None
    drives: bool = False
    cells: DiskCells | None = None
    bends: tuple[Bend, ...] = ()

    @property
    def origin(self) -> float:
        """The overclosure from which the unknown is counted."""
        return self.layer.start if self.layer.start > -inf else 0.0

    def pressure(self, w: Array) -> Array:
        """Return the pressure at overclosures beyond the origin, in units of the radius."""
        return self.layer._pressure(self.origin + self.radius * w)

    def slope(self, w: Array) -> Array:
        """Return its derivative."""
        return self.radius * self.layer._slope(self.origin + self.radius * w)

    def energy(self, w: Array) -> Array:
        """Return its integral, in lengths of the profile's unit."""
        return self.layer._energy(self.origin + self.radius * w)


@dataclass(frozen=True, slots=True)
class LayeredFields:
    """A solution, in coefficients.

    Attributes
    ----------
    overclosure, pressure : ndarray
    rate, flat : ndarray
        Their derivatives in the approach, both in units of the radius.
    shift : float
        ``eps``.
    left : float
        What the last correction leaves, of the largest pressure.
    """

    overclosure: Array
    pressure: Array
    rate: Array
    flat: Array
    shift: float
    left: float


@dataclass(frozen=True, slots=True)
class Totals:
    """Totals over a solution."""

    load: float
    stiffness: float
    work: float
    shift: float


@dataclass(frozen=True, slots=True)
class _Step:
    """Corrections of the overclosure and of ``eps``, and ``dw/ddelta``."""

    overclosure: Array
    shift: float
    rate: Array


class LayeredNewton:
    """Newton's method in a space.

    Parameters
    ----------
    setting : LayeredSetting
    form : Form
        The space.
    """

    def __init__(self, setting: LayeredSetting, form: Form) -> None:
        self.setting, self.form, space = setting, form, form.space
        self.functions = space
        self.sampling = form.sampling
        self._rows = np.zeros((len(self.functions.index), self.sampling.size))
        self._rows[:, self.functions.index] = self.functions.gram
        self._scale = 1.0 / np.sqrt(self.functions.mass.diagonal())
        #: of a pressure's load, in units of the radius
        self._load = 4 * pi * setting.radius**2 * self.functions.constant_moments
        self._bracket = setting.profile._bracket(setting.radius, space.t, space.y, space.past)
        a = setting.radius
        half = float(setting.profile._transform(np.asarray(a))) / 2.0
        self._fixed = setting.approach is not None
        given = setting.approach if setting.approach is not None else setting.origin + half
        self._shift = (given - setting.origin - half) / a

    def local(self) -> tuple[Array, float]:
        """Return what every point would do by itself: the first overclosure, and ``eps``."""
        setting, a = self.setting, self.setting.radius
        height = setting.profile._height(a * np.minimum(np.sqrt(self.form.z), 1.0)) / a
        if setting.approach is None:
            top = float(setting.profile._height(np.array(a))) / a
            room = 2.0 * (top - height)
        else:
            room = (setting.approach - setting.origin) / a - height
        w = self.sampling.coefficients(balanced(setting, room, np.minimum(room, 0.0)))
        return (self._eased(room, w) if self._fixed else w), self._shift

    def _eased(self, room: Array, w: Array) -> Array:
        """Return where to begin on a stiff layer: solutions with a spring that becomes stiffer.

        The unknown is the room of spring and layer together, in which the pressure never bends
        faster than the spring has it.
        """
        setting, sampling, spring = self.setting, self.sampling, _OWN
        stiff = float(setting.slope(sampling.values(w)).max())
        if stiff * spring < _SOFT:
            return w
        chosen = np.flatnonzero(sampling.low(_LOW)[self.functions.index])
        both, own = sampling.coefficients(room), np.minimum(room, 0.0)
        while True:
            for _ in range(_EASED):
                at = sampling.values(both)
                own = balanced(setting, at, own, spring)
                pressure, slope = setting.pressure(own), setting.slope(own)
                slope = slope / (1.0 + spring * slope)
                force = sampling.coefficients(pressure)
                step = self._solved(both, force, slope, self._shift, chosen).overclosure
                both = both + step
                moved = np.abs(slope * sampling.values(step)).max()
                if moved < _NEAR * pressure.max():
                    break
            own = balanced(setting, sampling.values(both), own, spring)
            pressure = setting.pressure(own)
            if spring * float(setting.slope(own).max()) < 1.0:
                return sampling.coefficients(own)
            spring *= _STIFFER
            both = sampling.coefficients(own + spring * pressure)

    def solved(self, w: Array, shift: float) -> LayeredFields:
        """Correct until rounding is left."""
        setting, sampling = self.setting, self.sampling
        begin, before, size, left = w, inf, inf, inf
        rate = np.zeros(sampling.size)
        for _ in range(_STEPS):
            at = sampling.values(w)
            with np.errstate(over="ignore", invalid="ignore"):
                step = self._correction(w, at, shift)
                if not np.isfinite(step.overclosure).all():
                    w, left = begin, inf
                    break
                rate = step.rate
                here, slope, by = (
                    setting.pressure(at),
                    setting.slope(at),
                    sampling.values(step.overclosure),
                )
                there = setting.pressure(at + by)
                most = max(float(here.max()), float(there.max()))
                bend = float(np.abs(there - here - slope * by).max()) / most
                before, size = size, float(np.abs(there - here).max()) / most
            if not bend <= _BEND:
                room = at + by + _OWN * (here + slope * by)
                w, size = sampling.coefficients(balanced(setting, room, at)), inf
            else:
                w = w + step.overclosure
            shift += step.shift
            left = size * min(size / before, 1.0) if before < inf else size
            # the derivative is that of the solution before
            if size < _DONE or (size < _LAGGING and left < _NEXT):
                break
            if size < _ROUNDED and size > 0.5 * before:
                break
        at = sampling.values(w)
        pressure = sampling.coefficients(setting.pressure(at))
        flat = sampling.coefficients(setting.slope(at) * sampling.values(rate))
        return LayeredFields(
            w, pressure, rate, flat, shift, left if left == inf else min(size, left)
        )

    def _correction(self, w: Array, at: Array, shift: float) -> _Step:
        """Return a correction."""
        pressure = self.sampling.coefficients(self.setting.pressure(at))
        slope = self.setting.slope(at)
        step = self._solved(w, pressure, slope, shift, np.arange(len(self.functions.index)))
        if self.setting.load is not None:
            missing = self.setting.load - float(self._load @ pressure[self.functions.index])
            missing -= self._carried(slope, step.overclosure)
            moved = missing / self._carried(slope, step.rate)
        elif self.setting.centre is not None:
            known = (self.setting.centre - self.setting.origin) / self.setting.radius
            missing = known - central_value(self.form.field(w + step.overclosure))
            moved = missing / central_value(self.form.field(step.rate))
        elif self.setting.approach is not None:
            return step
        else:
            moved = self._to_edge(w, step)
        return _Step(step.overclosure + moved * step.rate, moved, step.rate)

    def _to_edge(self, w: Array, step: _Step) -> float:
        """Return what ``eps`` has to change for the overclosure to vanish at the edge."""
        at_edge = self.form.at_edge(w) + self.form.at_edge(step.overclosure)
        return -at_edge / self.form.at_edge(step.rate)

    def _carried(self, slope: Array, by: Array) -> float:
        """Return by how much the load changes with the overclosure."""
        more = self.sampling.coefficients(slope * self.sampling.values(by))
        return float(self._load @ more[self.functions.index])

    def _solved(
        self, w: Array, pressure: Array, slope: Array, shift: float, chosen: NDArray[np.int_]
    ) -> _Step:
        """Return a correction by some of the functions that leaves ``eps`` as it is."""
        own, scale = self.functions, self._scale[chosen]
        misfit = self._bracket + 2.0 * shift - own.half_integral(pressure)
        residual = own.moments(misfit) - own.mass @ w[own.index]
        both = np.column_stack([residual, 2.0 * own.constant_moments])[chosen]
        matrix = self.sampling.times(self._rows[chosen], slope)[:, own.index[chosen]]
        # with the mass scaled to a diagonal of 1
        matrix += own.mass[np.ix_(chosen, chosen)]
        matrix *= scale[:, None]
        matrix *= scale
        factors = lu_factor(matrix, overwrite_a=True, check_finite=False)
        solved = lu_solve(factors, both * scale[:, None], check_finite=False) * scale[:, None]
        step, rate = np.zeros((2, self.sampling.size))
        step[own.index[chosen]], rate[own.index[chosen]] = solved.T
        return _Step(step, 0.0, rate)

    def coarser(self, fields: LayeredFields) -> LayeredFields:
        """Return the solution with two degrees less on every panel, by one correction.

        Under a load it is that of the same approach.
        """
        setting, sampling, own = self.setting, self.sampling, self.functions

        def cut(coefficients: Array) -> Array:
            return coefficients - self.last_degrees(coefficients)

        slope = setting.slope(sampling.values(fields.overclosure))
        w = cut(fields.overclosure)
        pressure = cut(sampling.coefficients(setting.pressure(sampling.values(w))))
        step = self._solved(w, pressure, slope, fields.shift, np.arange(own.coarsest_unknowns))
        moved = 0.0
        if setting.approach is None:
            moved = self._to_edge(w, step)
        w, rate = w + step.overclosure + moved * step.rate, step.rate
        at = sampling.values(w)
        pressure = cut(sampling.coefficients(setting.pressure(at)))
        flat = cut(sampling.coefficients(setting.slope(at) * sampling.values(rate)))
        return LayeredFields(w, pressure, rate, flat, fields.shift + moved, fields.left)

    def last_degrees(self, coefficients: Array) -> Array:
        """Return what the last two degrees of every panel have of a function."""
        lost = self.functions.index[self.functions.coarsest_unknowns :]
        last = np.zeros_like(coefficients)
        last[lost] = coefficients[lost]
        return last

    def integrals(self, fields: LayeredFields) -> Totals:
        """Return load, stiffness and work."""
        a, weights, own = self.setting.radius, self.form.space.weights, self.functions
        half = own.half_integral(fields.pressure)
        energy = self.sampling.coefficients(
            self.setting.energy(self.sampling.values(fields.overclosure))
        )
        stored = 4 * a**2 * float(weights @ own.half_integral(energy))
        return Totals(
            4 * a**2 * float(weights @ half),
            4 * a * float(weights @ own.half_integral(fields.flat)),
            stored + a**3 * float(weights @ half**2),
            fields.shift,
        )

    def missed(self, fields: LayeredFields) -> float:
        """Return what the stiffness lacks where the overclosure vanishes.

        Next to the edge the slope of a law falls as some power of the overclosure, small or not,
        which three sampling points do not integrate.
        """
        if self._fixed:
            return 0.0
        g, weights = gauss_rule(_EDGE_POINTS)
        grade = ((1.0 + g) / 2.0) ** (_EDGE_GRADE - 1)
        u = grade * (1.0 + g) / 2.0
        values = self.form.in_tail(np.array([fields.overclosure, fields.rate, fields.flat]), u)
        lacks = self.setting.slope(np.maximum(values[0], 0.0)) * values[1] - values[2]
        whole = float(weights * _EDGE_GRADE / 2.0 * grade @ lacks)
        return pi * self.setting.radius * self.form.tail_extent * abs(whole)

    def carried(self, flat: Array) -> Array:
        """Return what every panel adds to the stiffness."""
        own = self.functions
        each = 4 * self.setting.radius * own.constant_moments * flat[own.index]
        return np.asarray(np.bincount(own.panel, each, own.panels + 1)[:-1], dtype=float)

    def change(self, p: Array, p_less: Array, w: Array, w_less: Array) -> Change:
        """Return the difference of two pressures, and its energy with that of overclosures."""
        own = self.functions
        dp, dw = np.abs(p - p_less)[own.index], np.abs(w - w_less)[own.index]
        each = dp * (dw * own.mass.diagonal() + dp * own.gram.diagonal())
        energies = np.bincount(own.panel, each, own.panels + 1)
        return Change(p - p_less, np.asarray(energies, dtype=float))

    def deepest(self, fields: LayeredFields) -> float:
        """Return the largest overclosure."""
        setting = self.setting
        return setting.origin + setting.radius * float(
            self.sampling.values(fields.overclosure).max()
        )

    def thinnest(self, fields: LayeredFields) -> float:
        """Return the least compliance, in units of the radius."""
        slope = self.setting.slope(self.sampling.values(fields.overclosure))
        return 1.0 / float(slope.max())

    def sharpest(self, fields: LayeredFields, mean: float) -> float:
        """Return by how much of itself, or of its mean, the pressure moves with the data."""
        at = self.sampling.values(fields.overclosure)
        p, slope = self.setting.pressure(at), self.setting.slope(at)
        moved = slope / (1.0 + _OWN * slope) / self.setting.radius
        return float((moved / np.maximum(p, mean)).max())

    def growth(self, fields: LayeredFields) -> float:
        """Return ``ddelta/da``, from how the overclosure falls to the edge."""
        if self._fixed:
            return 0.0
        slope = float(self.setting.slope(self.sampling.values(fields.overclosure)).max())
        setting = self.setting
        near = min(1.0 / max(slope, 1.0), setting.profile._to_pole(setting.radius))
        y = min(_SLOPE * near, 0.5 * setting.parts.ends[-1][2])
        falls = 2.0 * self.form.next_to_edge(fields.overclosure, y) / y
        return falls / self.form.at_edge(fields.rate)


def balanced(setting: LayeredSetting, room: Array, start: Array, spring: float = _OWN) -> Array:
    """Return w with ``w + spring F(w) = room`` at every point by itself."""
    w = start.copy()
    low, high, before = np.full(w.shape, -inf), np.full(w.shape, inf), np.full(w.shape, inf)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_POINTWISE_STEPS):
            off = w + spring * setting.pressure(w) - room
            low, high = np.where(off < 0.0, w, low), np.where(off < 0.0, high, w)
            step = w - off / (1.0 + spring * setting.slope(w))
            middle = np.where(np.isfinite(low + high), 0.5 * (low + high), np.minimum(w, room))
            # far up an exponential law Newton's steps are an e-fold each
            slow = (np.abs(off) > 0.1 * before) & np.isfinite(low + high)
            new = np.where((step > low) & (step < high) & ~slow, step, middle)
            before = np.abs(off)
            done = np.abs(new - w) <= _POINTWISE * (np.abs(new) + np.abs(room))
            w = new
            if done.all():
                break
    return w
