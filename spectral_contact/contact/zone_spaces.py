"""First spaces of both fields on any zones.

Every part of the disk has a mesh that is graded to one of its ends (depth ``x = -ln d``, with the
distance d in units of the extent of the part). The first space of a part, see `graded_space`,
follows from the kind of that end. With l the depth of a layer, ``-ln`` of its width in units of the
extent, r the ratio of the extent to that of the part across the end, and
``tan(pi theta) = 2 kappa f`` with the elastic coupling kappa and the friction f; alpha and beta are
the normal and the tangential compliance:

========================  ===========================  ===========  ===========
kind of end               settles from depth           rate         power of d
========================  ===========================  ===========  ===========
edge, full stick          l of the thinner layer       1            0
... with one compliance   l                            1/2          0 or -1/2
edge, smooth, full stick  EPSILON_DEPTH                1            -1/2
edge, alpha > 0           l + LAYER_REACH              1            0
edge, alpha = 0 < beta    l                            1/2          -1/2
edge, alpha = beta = 0    0 or EPSILON_DEPTH           1            theta - 1/2
boundary                  l or l/2 + LAYER_REACH, the  1, 1/2, or   0
                          lesser; but ln r at least    1/2 - theta
rim, beta = 0             ln r                         0            0
========================  ===========================  ===========  ===========

A field settles like ``exp(-rate (x - depth))``. At a boundary the rate is 1 if alpha > 0 and the
zone slips or beta > 0, ``1/2 - theta`` on smooth surfaces, else 1/2. The rate 0 stands for square
roots, which end in a tail of powers of ``sqrt(d)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice, pairwise
from math import atan, atanh, ceil, log, pi

import numpy as np

from spectral_contact.contact.resolution import (
    CUBIC_TAIL_DEPTH,
    EPSILON_DEPTH,
    ROOT_TAIL_DEPTH,
    graded_space,
    slip_degree,
)
from spectral_contact.contact.tuning import COARSE_TOL, FIELD_ROUNDING, LAYER_REACH
from spectral_contact.fields.series import CENTRE, EDGE, LogSeries, Radius
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import z_difference

# depths, and what fields are deep down


def leading_depth(parameters: Parameters, extent: float) -> float:
    """Return the depth toward the edge past which a singular field is its leading term."""
    return EPSILON_DEPTH + layer_depth(parameters.alpha, parameters.beta, extent)


def layer_depth(alpha: float, beta: float, extent: float) -> float:
    """Return ``-ln(w/extent)`` with the width w of the thinnest layer in ``s**2``; at least 0."""
    return -log(min([1.0, *(c / extent for c in (alpha, beta) if c > 0.0)]))


def with_asymptotic_tail(
    pressure: LogSeries, shear: LogSeries, parameters: Parameters, extent: float
) -> list[LogSeries]:
    """Return p and q/s toward an edge that sticks, with leading terms in place of deep panels.

    A singular field is ``sqrt(y) p = a`` past `leading_depth`, and is evaluated so there. On smooth
    surfaces p and q are singular both and oscillate: ``sqrt(y) (p + i q)`` is a constant times
    ``exp(-i omega ln y)``, with ``omega = ln(3 - 4 nu)/(2 pi) = artanh(2 kappa)/pi``.
    """
    fields = [pressure, shear]
    count = ceil(leading_depth(parameters, extent) / pressure.width)
    if count > len(pressure.coefficients):
        return fields
    p_end, q_end = (float(field.coefficients[count - 1].sum()) for field in fields)
    tails: list[tuple[float, ...]]
    if parameters.alpha == 0.0 == parameters.beta:
        omega = atanh(2.0 * parameters.kappa) / pi
        tails = [(p_end, -q_end), (q_end, p_end)]
    else:
        omega = 0.0
        tails = [(p_end,), (q_end,)]
    return [
        replace(
            field,
            coefficients=field.coefficients[:count],
            tail=np.array(tail),
            oscillation=omega,
        )
        if field.power
        else field
        for field, tail in zip(fields, tails, strict=True)
    ]


def rounding_depth(end: Radius, extent: float) -> float:
    """Return ``-ln`` of the rounding of a boundary in units of an extent in ``s**2``."""
    return EPSILON_DEPTH - log(min(end.square, end.rest) / extent)


def without_rounding(space: DiscreteSpace, end: Radius, extent: float) -> DiscreteSpace:
    """Return a space toward a boundary without panels far deeper than the rounding of it.

    The tail begins where it is right to rounding at the rounding of the boundary.
    """
    most = ceil((CUBIC_TAIL_DEPTH + rounding_depth(end, extent)) / space.panels.width)
    degrees = space.degrees[:most]
    return DiscreteSpace(replace(space.panels, count=len(degrees)), degrees)


def edge_exponent(parameters: Parameters) -> float:
    """Return theta of ``p ~ y**(theta - 1/2)`` next to a smooth edge in slip with coupling.

    It is ``atan(2 kappa f)/pi`` (docs/coupling.md).
    """
    return atan(2.0 * parameters.kappa * parameters.friction) / pi


def edge_power(parameters: Parameters, states: tuple[int, ...]) -> float:
    """Return the power of ``y`` that the pressure is next to the edge, for the endpoint weight.

    Under a smooth edge that slips it is ``theta - 1/2`` with theta of `edge_exponent`. With the
    weight ``y**(-1/2)`` instead the series fall like ``y**theta``, while their rounding does not:
    at kappa f = 0.66 the pressure had six digits less at ``y = exp(-30)`` than at the boundary of
    slip.
    """
    if parameters.alpha > 0.0:
        return 0.0
    if states[-1] <= 0:
        return -0.5
    return edge_exponent(parameters) - 0.5


def split_spaces(space: DiscreteSpace, parts: Sequence[DiscreteSpace]) -> list[DiscreteSpace]:
    """Return the spaces of all parts, with the degrees of one that concatenates them.

    Parameters
    ----------
    space : DiscreteSpace
        What `concatenate_spaces` made of the parts, with other degrees.
    parts : sequence of DiscreteSpace
    """
    degrees = iter(space.degrees)
    return [
        DiscreteSpace(
            replace(part.panels, degree=space.panels.degree),
            tuple(islice(degrees, len(part.degrees))),
        )
        for part in parts
    ]


# the first spaces of all parts


def first_spaces(
    parameters: Parameters,
    radii: tuple[Radius, ...],
    states: tuple[int, ...],
    tolerance: float,
    power: float = -0.5,
) -> list[DiscreteSpace]:
    """Return the first spaces on the disk, and toward both ends of every zone around it.

    Parameters
    ----------
    parameters : Parameters
    radii : tuple of Radius
        Boundaries between zones, outward.
    states : tuple of int
        0 for stick; in slip the traction has no layer of its own.
    tolerance : float
        Relative accuracy that is wanted.
    power : float
        Endpoint weight of the pressure under a smooth edge with slip around the disk.
    """
    alpha = parameters.alpha
    beta = parameters.beta
    if not radii:
        # with one compliance only its field has a square root at the edge
        return [_full_stick_space(alpha, beta, (alpha == 0.0) != (beta == 0.0), tolerance)]
    bounds = CENTRE, *radii, EDGE
    extents = [z_difference(*pair) / 2.0 for pair in pairwise(bounds)]
    extents[0] *= 2.0  # the disk is one part, other zones are two
    spaces = []
    for k, (state, extent) in enumerate(zip(states, extents, strict=True)):
        layer_of_shear = 0.0 if state else beta
        # the disk has a mesh toward its rim only
        for bound in (k, k + 1) if k else (1,):
            if bounds[bound].from_edge == 0.0:
                spaces.append(_edge_space(alpha, layer_of_shear, extent, power, tolerance))
                continue
            extent_across = extents[k - 1] if bound == k else extents[k + 1]
            rate = 1.0 if alpha > 0.0 and (state or beta > 0.0) else 0.5
            if alpha == 0.0 == beta:
                rate = _smooth_boundary_rate(power, tolerance)
            layer = layer_depth(alpha, layer_of_shear, extent)
            # next to a boundary the fields settle at half the depth of the layer, or soon after it
            depth = max(min(layer, 0.5 * layer + LAYER_REACH), log(extent / extent_across))
            space = graded_space(
                depth, tolerance, rate, starts_near_singularity=True, min_settling=ROOT_TAIL_DEPTH
            )
            if alpha > 0.0 or len(radii) > 1:
                space = without_rounding(space, bounds[bound], extent)
            spaces.append(space)
    return spaces


def known_pressure_spaces(
    parameters: Parameters, radii: tuple[Radius, ...], states: tuple[int, ...], tolerance: float
) -> list[DiscreteSpace]:
    """Return first spaces under a known pressure, which has the same degree on all panels in slip.

    Parameters are those of `first_spaces`.
    """
    if not radii:
        alpha = parameters.alpha
        return [_full_stick_space(alpha, parameters.beta, alpha == 0.0, tolerance)]
    spaces = first_spaces(parameters, radii, states, tolerance)
    if parameters.beta == 0.0 and states == (0, 1):
        # the traction has a root at the rim, and bends where the annulus around it ends
        annulus = -log(min(radii[0].rest / radii[0].square, 1.0))
        spaces[0] = graded_space(annulus, tolerance, 0.0)
    # the pressure is expanded to its rounding, as it costs no unknowns: at rtol 2e-7 the slip of an
    # annulus of 4e-9 had an error of 0.14 without that. The coarse space, in which boundaries are
    # located, has a coarse pressure, too
    degree = slip_degree(FIELD_ROUNDING if tolerance < COARSE_TOL else tolerance)
    return [
        DiscreteSpace(replace(space.panels, degree=degree), (degree,) * space.panels.count)
        if states[(part + 1) // 2]
        else space
        for part, space in enumerate(spaces)
    ]


def _smooth_boundary_rate(power: float, tolerance: float) -> float:
    """Return the rate at which fields settle next to the boundary of slip on a smooth surface.

    They go like ``d**(1/2 - theta)``, with theta of `edge_exponent`. The rate is not so small that
    the mesh would be deeper than the rounding of the boundary.
    """
    deepest = CUBIC_TAIL_DEPTH + EPSILON_DEPTH
    return max(-power, min(0.5, (2.0 - log(tolerance)) / deepest))


def _full_stick_space(alpha: float, beta: float, has_root: bool, tolerance: float) -> DiscreteSpace:
    """Return the first space toward the edge of a disk that sticks.

    With one compliance the field of the other one is singular, and its own has a square root.
    """
    smooth = alpha == 0.0 == beta
    depth = EPSILON_DEPTH if smooth else layer_depth(alpha, beta, 1.0)
    return graded_space(
        depth, tolerance, 0.5 if has_root else 1.0, power=-0.5 if alpha == 0.0 else 0.0
    )


def _edge_space(
    alpha: float, beta: float, extent: float, power: float, tolerance: float
) -> DiscreteSpace:
    """Return the first space toward the edge of a zone around the disk; beta is 0 in slip."""
    layer = layer_depth(alpha, beta, extent)
    depth = layer
    rate = 0.5
    weight = -0.5
    if alpha > 0.0:
        depth = layer + LAYER_REACH
        rate = 1.0
        weight = 0.0
    elif beta == 0.0:
        # with the power of slip the pressure settles to its endpoint weight at once
        depth = EPSILON_DEPTH if power == -0.5 else 0.0
        rate = 1.0
        weight = power
    return graded_space(depth, tolerance, rate, power=weight, starts_near_singularity=True)
