"""Laws of rough layers: how the pressure grows with the overclosure.

The overclosure is how much the layer is compressed: the approach less the height of the punch and
less what the half-space gives; a clearance is a negative one. Overclosures are in the scene's unit
of length L, pressures in E' = E/(4(1−ν²)).
"""

from spectral_contact.layers.asperity_law import GreenwoodWilliamson
from spectral_contact.layers.laws import CalculixExponential, Exponential, Linear, PowerLaw
from spectral_contact.layers.layer_base import Layer
from spectral_contact.layers.sampled_law import Sampled, Table

__all__ = [
    "CalculixExponential",
    "Exponential",
    "GreenwoodWilliamson",
    "Layer",
    "Linear",
    "PowerLaw",
    "Sampled",
    "Table",
]
