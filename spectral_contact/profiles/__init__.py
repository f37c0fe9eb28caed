"""Profiles of punches: how far each stands above its lowest point, at every radius.

Lengths are in a reference length of the user's choice. Every profile is convex and touches at its
centre first. What the solver asks of one is in `Profile`; shapes of everyday use have it in closed
form, and `Sampled` makes one of functions or of points.
"""

from spectral_contact.profiles.hull import PointHull, hull_of_points
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.sampled_profile import Sampled
from spectral_contact.profiles.shapes import (
    Cone,
    Flat,
    Parabola,
    PowerLaw,
    RoundedFlat,
    Sphere,
    TruncatedCone,
)
from spectral_contact.profiles.sums import Sum

__all__ = [
    "Cone",
    "Flat",
    "Parabola",
    "PointHull",
    "PowerLaw",
    "Profile",
    "RoundedFlat",
    "Sampled",
    "Sphere",
    "Sum",
    "TruncatedCone",
    "hull_of_points",
]
