r"""The radii at which the law of a layer bends inside a contact, and bounds of their errors.

The law is ``p = F(w)``, with the pressure p and the overclosure w. It bends at its knots, the
overclosures ``w_k`` at which a derivative of F jumps. Inside the contact these are met at the radii
with ``w(r) = w_k``, the *bends*: a knot has none, one or several. Pressure and overclosure are not
smooth at a bend, so parts of the disk end there. A part ends at the right radius if w on it stays
between two neighbouring knots. If w exceeds one of them by ``e``, the error of the pressure is
about e times the jump of F'.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.resolution import first_sign_change
from spectral_contact.fields.radius import Radius

if TYPE_CHECKING:
    from spectral_contact.contact.layered_newton import LayeredFields, LayeredSetting
    from spectral_contact.contact.layered_spaces import Form, PanelForm

Array = NDArray[np.float64]

#: Rounding of an overclosure, relative to the largest one.
_ROUNDING = 1e-14
#: Least distance in ``s**2`` of a bend from the centre, the edge, a break of the profile or another
#: bend. A bend that is closer is left out, and `misplacement` bounds the error.
_LEAST_GAP = 1e-11
#: Values beyond a kink deviate from the smooth function on the other side of it. The error of a
#: polynomial through all values is at most this times the largest of these deviations.
_KINK_FACTOR = 3.0


class Bend(NamedTuple):
    """A radius at which the law bends.

    Attributes
    ----------
    radius : Radius
    knot : float
        The overclosure there.
    """

    radius: Radius
    knot: float


class Misplacement(NamedTuple):
    """Bounds of the errors where the overclosure on a part goes beyond a knot that bounds the part.

    Attributes
    ----------
    pressure : float
        Bound of the error of the pressure at any radius, in E'.
    load : float
        Bound of the error of the load, in E' L**2.
    stiffness : float
        Bound of the error of the stiffness, in E' L.
    """

    pressure: float
    load: float
    stiffness: float


#: The bounds for a law without knots.
NO_MISPLACEMENT = Misplacement(0.0, 0.0, 0.0)


class BendsChangedError(Exception):
    """The solution has bends at other knots than those at which the parts of its space end.

    Parameters
    ----------
    bends : tuple of Bend
        The bends of the solution.
    last : tuple of (Form, LayeredFields)
        The space and the solution.
    """

    def __init__(self, bends: tuple[Bend, ...], last: tuple[Form, LayeredFields]) -> None:
        super().__init__("the solution meets other knots of the law than its parts were made for")
        self.bends = bends
        self.last = last


def same_knots(first: Sequence[Bend], second: Sequence[Bend]) -> bool:
    """Return whether two sequences of bends have the same knots in the same order."""
    return [bend.knot for bend in first] == [bend.knot for bend in second]


class _Samples(NamedTuple):
    """The overclosure at sampling points, the centre and estimated extrema, outward.

    Attributes
    ----------
    y : ndarray
        ``1 - s**2``.
    w : ndarray
        The overclosure, in the unit of length of the profile.
    sample : ndarray
        Index of the sampling point itself, or of the one nearest to the centre or extremum.
    width : ndarray
        Extent in ``s**2`` for which the value stands: at a sampling point that of its whole panel,
        the same for all points of the panel; at an extremum from one neighbour to the other.
    drop, power : ndarray
        Next to an extremum w changes by ``drop * x**(1/power)`` over the fraction x of `width`:
        `power` is 1 at the centre, where w is linear in ``s**2``, and 1/2 elsewhere. At sampling
        points both are 0, and the whole width counts.
    """

    y: Array
    w: Array
    sample: NDArray[np.int_]
    width: Array
    drop: Array
    power: Array

    def select(self, chosen: NDArray[np.bool_] | NDArray[np.int_]) -> _Samples:
        """Return some of them, by a mask or by numbers."""
        return _Samples(
            self.y[chosen],
            self.w[chosen],
            self.sample[chosen],
            self.width[chosen],
            self.drop[chosen],
            self.power[chosen],
        )

    def widths_beyond(self, excess: Array) -> Array:
        """Return the extents in ``s**2`` on which w is beyond a knot, for excesses there."""
        fraction = np.ones_like(excess)
        np.divide(excess, self.drop, out=fraction, where=excess < self.drop)
        return np.asarray(self.width * fraction**self.power)


def _samples(setting: LayeredSetting, form: PanelForm, overclosure: Array) -> _Samples:
    """Return the samples of an overclosure, given by its coefficients."""
    field = form.field(overclosure)
    parts = form.part_samples()
    outward = [np.arange(part.samples.start, part.samples.stop)[:: -part.sign] for part in parts]
    widths = np.concatenate([part.widths for part in parts])
    sample = np.concatenate([outward[0][:1], *outward])
    y = np.append(1.0, form.y[sample[1:]])
    values = form.sampling.values(overclosure)
    w = np.append(field.evaluate(y[:1]), values[sample[1:]])
    width = np.append(1.0 - y[1], widths[sample[1:]])
    drop = np.zeros_like(w)
    drop[0] = abs(w[1] - w[0])
    power = np.zeros_like(w)
    power[0] = 1.0

    # the vertices of parabolas through three neighbours
    w_step = np.diff(w)
    y_step = np.diff(y)
    turning = 1 + np.flatnonzero(
        (w_step[1:] * w_step[:-1] < 0.0) & (y_step[1:] * y_step[:-1] > 0.0)
    )
    slope = w_step / np.where(y_step == 0.0, 1.0, y_step)
    slope_before = slope[turning - 1]
    slope_after = slope[turning]
    half_width = (y[turning + 1] - y[turning - 1]) / 2.0
    vertex = (y[turning] + y[turning - 1]) / 2.0
    vertex = vertex - slope_before * half_width / (slope_after - slope_before)
    vertex = np.clip(vertex, y[turning + 1], y[turning - 1])

    extremum = field.evaluate(vertex)
    drops = np.minimum(np.abs(extremum - w[turning - 1]), np.abs(extremum - w[turning + 1]))
    order = np.argsort(-np.concatenate([y, vertex]), kind="stable")
    samples = _Samples(
        np.concatenate([y, vertex]),
        setting.origin + setting.radius * np.concatenate([w, extremum]),
        np.concatenate([sample, sample[turning]]),
        np.concatenate([width, 2.0 * np.abs(half_width)]),
        setting.radius * np.concatenate([drop, drops]),
        np.concatenate([power, np.full(len(vertex), 0.5)]),
    )
    return samples.select(order)


def bends_of(
    setting: LayeredSetting, form: PanelForm, overclosure: Array, errors: Array
) -> tuple[Bend, ...]:
    """Return the radii at which an overclosure meets the knots of the law, outward.

    Parameters
    ----------
    setting : LayeredSetting
    form : PanelForm
    overclosure : ndarray
        Its coefficients.
    errors : ndarray
        Its errors at the sampling points. A value that is closer to a knot than its error counts
        as on neither side of it.
    """
    a = setting.radius
    origin = setting.origin
    field = form.field(overclosure)
    samples = _samples(setting, form, overclosure)
    errors = np.maximum(errors, form.jumps(overclosure))
    margin = a * errors[samples.sample] + _ROUNDING * float(np.abs(samples.w).max())
    crossings = []
    for knot in setting.layer.knots:
        difference = samples.w - knot
        decided = np.flatnonzero(np.abs(difference) > margin)
        above = difference[decided] > 0.0
        for change in np.flatnonzero(above[1:] != above[:-1]):
            inner_y = float(samples.y[decided[change]])
            outer_y = float(samples.y[decided[change + 1]])

            def excess(y: Array, knot: float = knot) -> Array:
                return origin + a * field.evaluate(y) - knot

            crossings.append((first_sign_change(excess, outer_y, inner_y), knot))
    return _separate_bends(setting, sorted(crossings, reverse=True))


def _separate_bends(
    setting: LayeredSetting, crossings: list[tuple[float, float]]
) -> tuple[Bend, ...]:
    """Return the bends at these crossings (y, knot).

    Bends closer than `_LEAST_GAP` to the centre, the edge, a break of the profile or a bend before
    are left out.
    """
    radii = [bend.radius for bend in setting.bends]
    bends: list[Bend] = []
    ends = [1.0, 0.0]
    ends += [radius.rest for radius in setting.parts.breaks if radius not in radii]
    for y, knot in crossings:
        if min(abs(y - end) for end in ends) > _LEAST_GAP:
            s = sqrt(1.0 - y)
            bends.append(Bend(Radius(s, y / (1.0 + s)), knot))
            ends.append(y)
    return tuple(bends)


def misplacement(setting: LayeredSetting, form: PanelForm, fields: LayeredFields) -> Misplacement:
    """Return bounds of the errors of a solution whose parts do not end exactly at its bends.

    On every part w is compared with the two knots between which it should lie.
    """
    a = setting.radius
    origin = setting.origin
    all_samples = _samples(setting, form, fields.overclosure)
    sampled_w = origin + a * form.sampling.values(fields.overclosure)
    rate = np.abs(form.sampling.values(fields.rate))
    boundaries = form.at_boundaries(fields.overclosure)
    pressure = load = stiffness = 0.0
    for part, at_boundary in zip(form.part_samples(), boundaries, strict=True):
        numbers = all_samples.sample
        samples = all_samples.select(
            (numbers >= part.samples.start) & (numbers < part.samples.stop)
        )
        end = origin + a * at_boundary
        low, high = _neighbouring_knots(setting, samples.w)
        # beyond the lower knot w is too small, beyond the upper one too large
        for knot, sense in ((low, -1.0), (high, 1.0)):
            excess = np.maximum(sense * (samples.w - knot), 0.0)
            end_excess = max(sense * (end - knot), 0.0)
            largest = max(float(excess.max()), end_excess)
            if largest == 0.0:
                continue
            step = max(largest, float(np.spacing(abs(knot))))
            slopes = setting.layer._slope(np.array([knot - step, knot + step]))
            jump = abs(float(slopes[1] - slopes[0]))
            # A panel with samples beyond a knot counts with its whole extent, and once: all of its
            # samples have the same width, and no two panels of a part have (`unique`).
            beyond = excess > 0.0
            width = float(np.unique(samples.widths_beyond(excess)[beyond]).sum())
            max_rate = float(rate[samples.sample[beyond]].max(initial=0.0))
            if end_excess > 0.0:
                last_w = float(sampled_w[part.samples][-1])
                fraction = end_excess / max(abs(last_w - end), end_excess)
                width += float(part.distances[-1]) * fraction
                max_rate = max(max_rate, float(rate[part.samples][-1]))
            area = pi * a**2 * _KINK_FACTOR * width
            pressure = max(pressure, _KINK_FACTOR * jump * largest)
            load += area * jump * largest * max_rate
            stiffness += area * jump * max_rate**2
    return Misplacement(pressure, load, stiffness)


def _neighbouring_knots(setting: LayeredSetting, w: Array) -> tuple[float, float]:
    """Return the two neighbouring knots between which overclosures lie, or nearly lie.

    Of all pairs it is the one beyond which the overclosures go least. Below the first knot and
    above the last one they are infinite.
    """
    knots = np.array([-inf, *setting.layer.knots, inf])
    first, last = np.searchsorted(knots, [w.min(), w.max()])
    pieces = [(float(knots[k - 1]), float(knots[k])) for k in range(first, last + 1)]
    return min(pieces, key=lambda piece: max(piece[0] - w.min(), w.max() - piece[1]))
