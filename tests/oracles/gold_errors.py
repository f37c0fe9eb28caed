"""True errors of a solution in doubles, against a gold solution of the same scene."""

import math

import numpy as np
from mpmath import hypot, isinf

TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
#: What the tolerance bounds; zone boundaries are as good as their conditioning allows.
BOUNDED = ("approach", "pressure", "traction", "total_shear", "load", "indentation_work")
#: What else there is of a scene with a profile.
PRESSED = ("contact_radius", "load", "stiffness", "indentation_work")
SIDES = ("inner", "outer", "inner_from_edge", "outer_from_edge")


def relative(value, truth):
    """Return the relative error of a double as a double."""
    value = float(value)
    if value == truth:
        return 0.0
    return float(abs(value / truth - 1)) if truth and not isinf(truth) else math.inf


def errors(double, true):
    """Return the largest true error of every quantity."""
    depths = [point.from_edge for point in true.points]
    found = {"approach": relative(double.approach, true.approach)}
    fields = ["pressure"]
    if true.scene.friction is not None:
        fields.append("traction")
        found["total_shear"] = relative(double.total_shear, true.total_shear)
        found["stick_radius"] = relative(double.stick_radius, true.stick_radius)
        found["zones"] = 1.0  # one is missing, and the estimate is to leave room for it
        if len(double.zones) == len(true.zones):
            found["zones"] = max(
                relative(getattr(mine, side), getattr(its, side))
                for mine, its in zip(double.zones, true.zones, strict=True)
                for side in SIDES
            )
    for name in PRESSED if true.scene.profile is not None else ():
        found[name] = relative(getattr(double, name), getattr(true, name))
    for name, scale in double.error_scales.items():  # with adhesion a load may be zero
        if name == "stiffness_on_branch":  # which gold solutions have not
            continue
        found[name] = float(abs(getattr(double, name) - getattr(true, name))) / scale
    if true.edge_ratio is not None:
        found["edge_ratio"] = relative(double.edge_ratio, true.edge_ratio)
    for name in fields:
        values = getattr(double, name)(from_edge=depths)
        if "load" in double.error_scales:
            mean = double.error_scales["load"] / (math.pi * double.contact_radius**2)
            pairs = zip(values, true.points, strict=True)
            found[name] = worst(against_size(value, point, mean) for value, point in pairs)
            continue
        if name == "traction" and true.scene.unloaded_to < 1.0:
            friction = true.scene.friction
            found[name] = worst(
                float(abs(value - point.traction)) / float(size(point, true, friction))
                for value, point in zip(values, true.points, strict=True)
                if point.traction
            )
            continue
        if any(min(point.pressure, point.traction) < 0 for point in true.points):
            found[name] = worst(map(against_both(name, true.scene), values, true.points))
            continue
        pairs = zip(values, true.points, strict=True)
        if true.scene.profile is not None:  # of the pressure or its mean, whichever is larger
            found[name] = worst(against_mean(value, point, true) for value, point in pairs)
            continue
        found[name] = worst(relative(value, getattr(point, name)) for value, point in pairs)
    return found


def exceeded(double, true):
    """Return the true errors that are above their estimates, with these."""
    # at a given radius the traction, one of s/c in stick, moves with the boundaries
    moved = {"traction": 2.0 * double.error.zones} if true.scene.friction is not None else {}
    pairs = {
        name: (error, getattr(double.error, name)) for name, error in errors(double, true).items()
    }
    own = {name: getattr(true.error, name) or 0.0 for name in pairs}  # of the gold solution
    return {
        n: (e, most) for n, (e, most) in pairs.items() if not e <= most + moved.get(n, 0.0) + own[n]
    }


def unmet(double, true, rtol):
    """Return the estimates that do not meet the tolerance although it bounds them."""
    found = {name: getattr(double.error, name) for name in errors(double, true) if name in BOUNDED}
    return {name: estimate for name, estimate in found.items() if not estimate <= rtol}


def worst(several):
    """Return the largest; what is no number is larger than all."""
    return float(np.max(list(several)))


def size(point, true, friction):
    """Return what the error of q is relative to: q, or f p where the surface sticks with memory."""
    [zone] = [
        one for one in true.zones if one.outer_from_edge <= point.from_edge < one.inner_from_edge
    ]
    return friction * point.pressure if zone.memory else abs(point.traction)


def against_size(value, point, mean):
    """Return the error of p relative to its size or a mean, whichever is larger."""
    if isinf(point.pressure):
        return relative(value, point.pressure)
    return float(abs(float(value) - point.pressure) / max(abs(point.pressure), mean))


def against_mean(value, point, true):
    """Return the error of p relative to it or its mean, whichever is larger."""
    if isinf(point.pressure):
        return relative(value, point.pressure)
    mean = true.load / (math.pi * true.contact_radius**2)
    return float(abs(value - point.pressure) / max(point.pressure, mean))


def against_both(name, scene):
    """Return what gives the error of p, or of q/s, at a point where it may change sign."""

    def error(value, point):
        true = getattr(point, name)
        if point.from_edge == 1.0 or isinf(true):  # p is positive at the centre, and q is 0
            return relative(value, true)
        s = 1.0 - point.from_edge
        p, u = point.pressure, point.traction / s
        if name == "pressure":
            return float(abs(float(value) - p) / hypot(p, u))
        return float(abs(float(value) / s - u) / hypot(u, scene.kappa * p))

    return error
