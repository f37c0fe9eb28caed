"""The same problems to any number of digits.

`reference` solves a scene in fixed-point arithmetic, to 15 to 60 digits, and certifies them by a
second solution on another mesh.
"""

from spectral_contact.precise.reference import reference
from spectral_contact.precise.reference_solution import ReferenceSolution

__all__ = ["ReferenceSolution", "reference"]
