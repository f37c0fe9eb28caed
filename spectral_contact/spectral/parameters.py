"""The parameters of the equations of a flat punch of unit radius."""

from __future__ import annotations

from typing import NamedTuple


class Parameters(NamedTuple):
    """The parameters of the equations (docs/theory, symbols), dimensionless.

    Without elastic coupling q is proportional to kappa if f/kappa is kept. Such a contact is solved
    with kappa = 1 and the friction f/kappa, and its traction is multiplied by kappa afterwards.

    Attributes
    ----------
    alpha, beta : float
        Normal and tangential compliance of the layer, 0 or positive.
    kappa : float
        Coupling parameter, ``(1 - 2 nu)/(4 (1 - nu))`` of a half-space, positive: it multiplies the
        radial displacement that p causes and the normal displacement that q causes. The caller
        takes the opposite of a negative one, and of the traction that comes out. 1 without elastic
        coupling.
    friction : float
        Coulomb's coefficient f, the same at every radius. Without elastic coupling f/kappa.
    """

    alpha: float
    beta: float
    kappa: float
    friction: float
