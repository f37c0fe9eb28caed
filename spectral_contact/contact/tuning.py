"""The tuned numbers of the contact problems: what each means, and what it was measured against.

A number stands here if it was chosen by a measurement. What follows from a formula stands where the
formula is. The last column of a comment names the command that measures the number again.
"""

from __future__ import annotations

# Spaces, refinement, error estimates

# Zones, friction law, search
