"""What is asked of a solve, and to what tolerance: checked, whatever the scene."""

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
_INTEGRAL = frozenset(
    {"approach", "total_shear", "stick_radius", *PROFILE_QUANTITIES, *ADHESION_QUANTITIES}
)
#: The tightest tolerance of fields.
_TIGHTEST = 1e-12
#: Zones that are not known are looked for at so much of the tolerance, where there is something to
#: gain.
_CLOSER, _LOOSE = 1e-3, 1e-11


def asked_quantities(
    quantities: Iterable[str] | None,
    *,
    has_profile: bool = False,
    adhesive: bool = False,
    unloaded: bool = False,
) -> frozenset[str]:
    """Return what is asked for, known names.

    The default is everything but the thresholds of the load, which cost more than all of that.
    """
    known = (*PROFILE_QUANTITIES * has_profile, *ADHESION_QUANTITIES * adhesive, *QUANTITIES)
    if quantities is None:
        return frozenset(known)
    return frozenset(names("quantities", quantities, known + UNLOADED_QUANTITIES * unloaded))


def checked_tolerance(rtol: object, quantities: Iterable[str]) -> float:
    """Return the tolerance; `SceneError` if these quantities cannot be solved to it."""
    value = checks.tolerance(rtol)
    if value < _TIGHTEST and not _INTEGRAL.issuperset(quantities):
        raise SceneError(
            "rtol", rtol, "at least 1e-12 unless only approach, total_shear, stick_radius are asked"
        )
    return value


def closer_tolerance(rtol: float) -> float:
    """Return a tolerance at which zones may be known, or be found, that are not at this one."""
    return max(_CLOSER * rtol, _TIGHTEST) if rtol >= _LOOSE else rtol
