r"""Where the law of a layer bends inside a contact, and what is wrong if parts do not end there.

A law bends at its knots, at overclosures ``w_k`` where a derivative of F jumps. Inside the contact
that is at radii with ``w(r) = w_k``, which the solution decides: none, one, or several for a knot.
At them pressure and overclosure are no polynomials, so parts end there. What is misplaced is known
by the overclosure: on every part w is to stay between two neighbouring knots, and where it goes
beyond one by ``e`` the pressure is that of a law whose slope is off by its jump, times ``e``.
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

#: Rounding of an overclosure, of the largest one.
_ROUNDING = 1e-14
#: Least distance in ``s**2`` of a bend to the centre, the edge, a break or another bend: closer
#: ones are left out, and what that makes is part of the estimate.
_LEAST_GAP = 1e-11
#: Largest error of a polynomial through values with a kink, over that of the values.
_INTERPOLATED = 3.0


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
    """Bounds of what overclosures beyond the knots of their parts make.

    Attributes
    ----------
    pressure : float
        Of the pressure anywhere, in E'.
    load : float
        Of the load, in E' L**2.
    stiffness : float
        Of the stiffness, in E' L.
    """

    pressure: float
    load: float
    stiffness: float


#: Of a law that bends nowhere.
NO_MISPLACEMENT = Misplacement(0.0, 0.0, 0.0)


class BendsChangedError(Exception):
    """Other knots lie in the contact than the parts of a space know of.

    Parameters
    ----------
    bends : tuple of Bend
        Those of the solution.
    last : tuple of (Form, LayeredFields)
        The space and the solution.
    """

    def __init__(self, bends: tuple[Bend, ...], last: tuple[Form, LayeredFields]) -> None:
        super().__init__("other knots of the law lie in the contact")
        self.bends, self.last = bends, last


def same_knots(first: Sequence[Bend], second: Sequence[Bend]) -> bool:
    """Return whether two sets of bends are of the same knots in the same order."""
    return [bend.knot for bend in first] == [bend.knot for bend in second]


class _Looks(NamedTuple):
    """Places from the centre outward at which an overclosure is looked at.

    They are the sampling points, the centre, and about where it is largest or least in between.

    Attributes
    ----------
    y : ndarray
        ``1 - s**2``.
    w : ndarray
        The overclosure, in lengths of the profile's unit.
    sample : ndarray
        The sampling point that is next to it.
    width : ndarray
        Extent in ``s**2`` of what it stands for: of the panel, or to its neighbours.
    drop, power : ndarray
        What w changes by over that from an extreme on, and the power of the share of this change
        with which the extent grows: 1 at the centre, where w is linear in ``s**2``, 1/2 elsewhere.
        0 at sampling points, where w is no extreme.
    """

    y: Array
    w: Array
    sample: NDArray[np.int_]
    width: Array
    drop: Array
    power: Array

    def among(self, chosen: NDArray[np.bool_] | NDArray[np.int_]) -> _Looks:
        """Return some of them."""
        return _Looks(
            self.y[chosen],
            self.w[chosen],
            self.sample[chosen],
            self.width[chosen],
            self.drop[chosen],
            self.power[chosen],
        )

    def widths_beyond(self, excess: Array) -> Array:
        """Return over what extents in ``s**2`` a knot is exceeded by as much."""
        share = np.minimum(excess / np.maximum(self.drop, np.finfo(float).tiny), 1.0)
        return np.asarray(self.width * share**self.power)


def _looks(setting: LayeredSetting, form: PanelForm, overclosure: Array) -> _Looks:
    field, parts = form.field(overclosure), form.part_samples()
    outward = [np.arange(part.samples.start, part.samples.stop)[:: -part.sign] for part in parts]
    widths = np.concatenate([part.widths for part in parts])
    sample = np.concatenate([outward[0][:1], *outward])
    y = np.append(1.0, form.y[sample[1:]])
    values = form.sampling.values(overclosure)
    w = np.append(field.evaluate(y[:1]), values[sample[1:]])
    width = np.append(1.0 - y[1], widths[sample[1:]])
    drop, power = np.zeros_like(w), np.zeros_like(w)
    drop[0], power[0] = abs(w[1] - w[0]), 1.0

    # the vertices of parabolas through three neighbours
    rise, step = np.diff(w), np.diff(y)
    turning = 1 + np.flatnonzero((rise[1:] * rise[:-1] < 0.0) & (step[1:] * step[:-1] > 0.0))
    slope = rise / np.where(step == 0.0, 1.0, step)
    before, after = slope[turning - 1], slope[turning]
    reach = (y[turning + 1] - y[turning - 1]) / 2.0
    vertex = (y[turning] + y[turning - 1]) / 2.0 - before * reach / (after - before)
    vertex = np.clip(vertex, y[turning + 1], y[turning - 1])

    extreme = field.evaluate(vertex)
    falls = np.minimum(np.abs(extreme - w[turning - 1]), np.abs(extreme - w[turning + 1]))
    order = np.argsort(-np.concatenate([y, vertex]), kind="stable")
    looks = _Looks(
        np.concatenate([y, vertex]),
        setting.origin + setting.radius * np.concatenate([w, extreme]),
        np.concatenate([sample, sample[turning]]),
        np.concatenate([width, 2.0 * np.abs(reach)]),
        setting.radius * np.concatenate([drop, falls]),
        np.concatenate([power, np.full(len(vertex), 0.5)]),
    )
    return looks.among(order)


def bends_of(
    setting: LayeredSetting, form: PanelForm, overclosure: Array, uncertain: Array
) -> tuple[Bend, ...]:
    """Return where an overclosure meets the knots of the law, from the centre outward.

    Parameters
    ----------
    setting : LayeredSetting
    form : PanelForm
    overclosure : ndarray
        Coefficients.
    uncertain : ndarray
        By how much it is not known at the sampling points: closer to a knot it does not count as
        being on either side.
    """
    a, origin, field = setting.radius, setting.origin, form.field(overclosure)
    looks = _looks(setting, form, overclosure)
    uncertain = np.maximum(uncertain, form.jumps(overclosure))
    margin = a * uncertain[looks.sample] + _ROUNDING * float(np.abs(looks.w).max())
    found = []
    for knot in setting.layer.knots:
        beyond = looks.w - knot
        decided = np.flatnonzero(np.abs(beyond) > margin)
        above = beyond[decided] > 0.0
        for change in np.flatnonzero(above[1:] != above[:-1]):
            first, last = decided[change], decided[change + 1]

            def excess(y: Array, knot: float = knot) -> Array:
                return origin + a * field.evaluate(y) - knot

            ends = float(looks.y[last]), float(looks.y[first])
            found.append((first_sign_change(excess, *ends), knot))
    return _apart(setting, sorted(found, reverse=True))


def _apart(setting: LayeredSetting, found: list[tuple[float, float]]) -> tuple[Bend, ...]:
    """Return the bends that are apart from each other, from breaks, the centre and the edge."""
    radii = [bend.radius for bend in setting.bends]
    fixed = [radius.rest for radius in setting.parts.breaks if radius not in radii]
    kept: list[Bend] = []
    taken = [1.0, 0.0, *fixed]
    for y, knot in found:
        if min(abs(y - other) for other in taken) > _LEAST_GAP:
            s = sqrt(1.0 - y)
            kept.append(Bend(Radius(s, y / (1.0 + s)), knot))
            taken.append(y)
    return tuple(kept)


def misplacement(setting: LayeredSetting, form: PanelForm, fields: LayeredFields) -> Misplacement:
    """Return what a solution has where its parts do not end at the bends of the law."""
    a, origin = setting.radius, setting.origin
    everywhere = _looks(setting, form, fields.overclosure)
    rate = np.abs(form.sampling.values(fields.rate))
    boundaries = form.at_boundaries(fields.overclosure)
    pressure = load = stiffness = 0.0
    for part, at_boundary in zip(form.part_samples(), boundaries, strict=True):
        inside = (everywhere.sample >= part.samples.start) & (everywhere.sample < part.samples.stop)
        looks, end = everywhere.among(inside), origin + a * at_boundary
        low, high = _piece(setting, looks.w)
        excess = np.maximum(np.maximum(low - looks.w, looks.w - high), 0.0)
        end_excess = max(low - end, end - high, 0.0)
        largest = max(float(excess.max()), end_excess)
        if largest == 0.0:
            continue
        below = max(low - float(looks.w.min()), low - end) == largest
        knot = low if below else high
        step = max(largest, float(np.spacing(abs(knot))))
        slopes = setting.layer._slope(np.array([knot - step, knot + step]))
        jump = abs(float(slopes[1] - slopes[0]))
        # panels with samples beyond a knot count as a whole, each once
        beyond = excess > 0.0
        width = _INTERPOLATED * float(np.unique(looks.widths_beyond(excess)[beyond]).sum())
        rates = rate[looks.sample[beyond]] if beyond.any() else rate[part.samples][-1:]
        if end_excess > 0.0:
            nearest = float(part.distances[-1])
            last = origin + a * float(form.sampling.values(fields.overclosure)[part.samples][-1])
            width += nearest * min(end_excess / max(abs(last - end), end_excess), 1.0)
        most = float(rates.max())
        pressure = max(pressure, _INTERPOLATED * jump * largest)
        load += pi * a**2 * width * jump * largest * most
        stiffness += pi * a**2 * width * jump * most**2
    return Misplacement(pressure, load, stiffness)


def _piece(setting: LayeredSetting, w: Array) -> tuple[float, float]:
    """Return the neighbouring knots between which overclosures are, but for the least excess."""
    knots = np.array([-inf, *setting.layer.knots, inf])
    first, last = np.searchsorted(knots, [w.min(), w.max()])
    pieces = [(float(knots[k - 1]), float(knots[k])) for k in range(first, last + 1)]
    return min(pieces, key=lambda piece: max(piece[0] - w.min(), w.max() - piece[1]))
