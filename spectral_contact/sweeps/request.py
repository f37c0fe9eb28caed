"""What is asked of every scene of a sweep, checked once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SceneError
from spectral_contact.inputs import checks
from spectral_contact.solution import PROFILE_QUANTITIES, QUANTITIES
from spectral_contact.solving.planning import asked_quantities, checked_tolerance

__all__ = ["ENDINGS", "FIELDS", "SCALARS", "Request", "requested"]

Array = NDArray[np.float64]

#: Quantities that are a number for each scene: what a sweep asks for by default.
SCALARS: Final = ("approach", "stick_radius", "total_shear", "edge_ratio", "critical_friction")
#: The same with a profile.
_PROFILE_SCALARS: Final = (*PROFILE_QUANTITIES, *SCALARS[:3])
#: Quantities that are a function of the radius.
FIELDS: Final = ("pressure", "traction", "slip")
#: How a scene can end, by code: the endings of `solve` in small letters, and failure.
ENDINGS: Final = ("converged", "unknowns", "rounding", "zones", "failed")


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is asked of every scene.

    Attributes
    ----------
    quantities : tuple of str
        In the order of `QUANTITIES`.
    rtol : float
    max_unknowns : int
    places : str
        The dimension of the fields: ``"s"`` or ``"from_edge"``; empty without fields.
    s, from_edge : ndarray, shape (places,)
        Where the fields are taken.
    shared : bool
        Whether there are so many compliances that decompositions which serve all of them pay.
    """

    quantities: tuple[str, ...]
    rtol: float
    max_unknowns: int
    places: str
    s: Array
    from_edge: Array
    shared: bool = False

    @property
    def at_edge_alone(self) -> bool:
        """Whether fields are wanted at the edge and nowhere else."""
        return bool((self.from_edge == 0.0).all())

    def describe(self) -> dict[str, Any]:
        """Return the request as an object of JSON, exact."""
        return {
            "quantities": list(self.quantities),
            "rtol": self.rtol.hex(),
            "max_unknowns": self.max_unknowns,
            "places": self.places,
            "s": [one.hex() for one in self.s.tolist()],
            "from_edge": [one.hex() for one in self.from_edge.tolist()],
            "shared": self.shared,
        }


def requested(
    quantities: Iterable[str] | None,
    rtol: float,
    max_unknowns: int,
    s: Any,
    from_edge: Any,
    *,
    shaped: bool = False,
) -> Request:
    """Check what is asked, of scenes with a profile if they are shaped.

    Raises
    ------
    SceneError
        For a quantity that there is not, a field without places or places without a field, or
        a value out of its range.
    """
    if quantities is None:
        asked = frozenset(_PROFILE_SCALARS if shaped else SCALARS)
    else:
        asked = asked_quantities(quantities, shaped=shaped)
    if not asked:
        raise SceneError("quantities", [], "at least one name")
    chosen = tuple(name for name in (*PROFILE_QUANTITIES, *QUANTITIES) if name in asked)
    places = "s" if from_edge is None else "from_edge"
    return Request(
        chosen,
        checked_tolerance(rtol, chosen),
        checks.whole("max_unknowns", max_unknowns, 1),
        "" if s is None and from_edge is None else places,
        *_radii(places, [name for name in chosen if name in FIELDS], s, from_edge),
    )


def _radii(places: str, fields: list[str], s: Any, from_edge: Any) -> tuple[Array, Array]:
    """Return where the fields are taken: radii and distances from the edge."""
    if s is None and from_edge is None:
        if fields:
            raise SceneError("s, from_edge", (s, from_edge), f"given for the {fields[0]}: either")
        return np.empty(0), np.empty(0)
    radii, distances = checks.radii(s, from_edge)
    given = s if from_edge is None else from_edge
    if not fields:
        raise SceneError(places, given, "None without a field")
    if radii.ndim != 1 or radii.size == 0:
        raise SceneError(places, given, "a list of radii")
    return radii, distances
