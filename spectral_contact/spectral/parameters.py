"""What the coupled equations depend on besides the zones."""

from __future__ import annotations

from typing import NamedTuple


class Parameters(NamedTuple):
    """The numbers in the equations of a contact of unit radius (docs/theory).

    Attributes
    ----------
    alpha, beta : float
        Normal and tangential compliance of the layer, dimensionless, 0 or positive.
    kappa : float
        What multiplies the displacement of one direction by the load of the other:
        ``(1 - 2 nu)/(4 (1 - nu))`` of a half-space, and 1 where the traction is computed per unit
        of it. A negative one is mirrored before it comes here.
    friction : float
        Coulomb's coefficient, over the same factor where the traction is.
    """

    alpha: float
    beta: float
    kappa: float
    friction: float
