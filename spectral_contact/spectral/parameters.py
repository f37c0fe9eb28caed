"""What the coupled equations depend on besides the zones."""

from __future__ import annotations

from typing import NamedTuple


class Parameters(NamedTuple):
    """Of partial slip with elastic coupling.

    Attributes
    ----------
    alpha, beta : float
        ``alpha*`` and ``beta*``, 0 or positive.
    kappa, friction : float
        The coupling, positive, and Coulomb's coefficient.
    """

    alpha: float
    beta: float
    kappa: float
    friction: float
