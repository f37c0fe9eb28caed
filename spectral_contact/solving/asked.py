"""What `solve` is asked for: the names of quantities and the tolerance, checked for any scene."""

from __future__ import annotations

from collections.abc import Iterable

from spectral_contact.errors import SceneError
from spectral_contact.io import checks
from spectral_contact.io.choices import names
from spectral_contact.records import (
    ADHESION_QUANTITIES,
    PROFILE_QUANTITIES,
    QUANTITIES,
    UNLOADED_QUANTITIES,
)

#: Integral quantities, which may be asked for at 1e-13.
_INTEGRAL_QUANTITIES = frozenset(
    {"approach", "total_shear", "stick_radius", *PROFILE_QUANTITIES, *ADHESION_QUANTITIES}
)
#: The tightest tolerance of fields.
_TIGHTEST = 1e-12
#: Tolerance of a repeated solve over that of the first, which has left something unresolved.
_RETRY_FRACTION = 1e-3
#: The tightest tolerance that is followed by a tighter one: below it little would be gained.
_TIGHTEST_RETRIED = 1e-11


def asked_quantities(
    quantities: Iterable[str] | None,
    *,
    has_profile: bool = False,
    adhesive: bool = False,
    unloaded: bool = False,
) -> frozenset[str]:
    """Return the names of the quantities that are asked for.

    The default is everything but the thresholds of the load, which cost more than all the rest. A
    name that no scene of this kind has raises `SceneError`.
    """
    # a tuple times False is empty
    default_names = (
        *PROFILE_QUANTITIES * has_profile,
        *ADHESION_QUANTITIES * adhesive,
        *QUANTITIES,
    )
    if quantities is None:
        return frozenset(default_names)
    return frozenset(
        names("quantities", quantities, default_names + UNLOADED_QUANTITIES * unloaded)
    )


def checked_tolerance(rtol: object, quantities: Iterable[str]) -> float:
    """Return the tolerance; `SceneError` if these quantities cannot be solved to it."""
    value = checks.tolerance(rtol)
    if value < _TIGHTEST and not _INTEGRAL_QUANTITIES.issuperset(quantities):
        raise SceneError(
            "rtol", rtol, "at least 1e-12 unless only approach, total_shear, stick_radius are asked"
        )
    return value


def closer_tolerance(rtol: float) -> float:
    """Return the tolerance of a repeated solve; the same one if it is too tight already.

    A solve is repeated if it has not found the zones, the sense of slip, or whether anything slips.
    """
    return max(_RETRY_FRACTION * rtol, _TIGHTEST) if rtol >= _TIGHTEST_RETRIED else rtol
