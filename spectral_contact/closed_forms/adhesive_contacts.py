"""Adhesive contact on a smooth surface, and on one so rough that the layer is all.

In the units of `indentation`: lengths in any unit L, tractions in E' = E/(4(1 − ν²)), a quarter of
E*, loads in E'L², and works of adhesion w in E'L.
"""

import math
from dataclasses import dataclass
from typing import TypeAlias

from ._inputs import refusal
from .indentation import SmoothContact, _exponent, _moderate, power_law_contact

Checked: TypeAlias = tuple[SmoothContact, float, float]

#: Logarithm of the largest contact radius, and of one over the smallest.
_LARGEST_LOG = math.log(1e30)


@dataclass(frozen=True)
class PullOff:
    """The last stable state of an adhesive contact.

    Attributes
    ----------
    contact_radius, approach : float
        a and δ, in L.
    load : float
        P, in E'L².
    """

    contact_radius: float
    approach: float
    load: float


def _checked(contact: object, contact_radius: float, adhesion: float) -> Checked:
    """Return a contact, its radius and the work of adhesion, if they are in range."""
    if not isinstance(contact, SmoothContact):
        raise refusal("contact", contact, "a SmoothContact")
    radius = _moderate("contact_radius", contact_radius)
    return contact, radius, _moderate("work_of_adhesion", adhesion)


def adhesive_contact(
    contact: SmoothContact, contact_radius: float, work_of_adhesion: float
) -> SmoothContact:
    """Return a contact on a smooth surface with adhesion.

    From the contact of the same radius without it a flat punch is taken away, with the approach
    √(πaw/2) and the load 4a√(2πaw): at its edge the energy release rate is w.

    Parameters
    ----------
    contact : SmoothContact
        Without adhesion, of any profile.
    contact_radius : float
        a, > 0.
    work_of_adhesion : float
        w, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Johnson, Kendall and Roberts (1971); Maugis and Barquins (1978).
    """
    contact, a, w = _checked(contact, contact_radius, work_of_adhesion)
    pull = math.sqrt(math.pi * a * w / 2.0)
    return SmoothContact(contact.approach - pull, contact.load - 8.0 * a * pull)


def adhesive_winkler_contact(
    contact: SmoothContact, contact_radius: float, work_of_adhesion: float, normal_compliance: float
) -> SmoothContact:
    """Return a contact with adhesion on a layer so soft that the half-space is rigid.

    From the one without adhesion, `winkler_contact`, a uniform suction √(2w/α) is taken away.

    Parameters
    ----------
    contact : SmoothContact
    contact_radius, work_of_adhesion, normal_compliance : float
        a, w and α, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    contact, a, w = _checked(contact, contact_radius, work_of_adhesion)
    alpha = _moderate("normal_compliance", normal_compliance)
    suction = math.sqrt(2.0 * w / alpha)
    return SmoothContact(
        contact.approach - alpha * suction, contact.load - math.pi * a**2 * suction
    )


def power_law_pull_off(
    coefficient: float, exponent: float, work_of_adhesion: float, *, by_approach: bool = False
) -> PullOff:
    """Return where the profile C rⁿ comes off a smooth surface.

    The parabola r²/(2R) does at P = −(3/2)πwR, the cone r cot θ at P = −27w²/(2π cot³θ).

    Parameters
    ----------
    coefficient, exponent : float
        C > 0 and n > 1/2: below, the contact has no pull-off.
    work_of_adhesion : float
        w, > 0.
    by_approach : bool
        Whether the approach is held, else the load.

    Raises
    ------
    ValueError
        If a parameter, or the contact radius that follows, is out of range.

    References
    ----------
    Johnson, Kendall and Roberts (1971); Maugis and Barquins (1981).
    """
    if not isinstance(by_approach, bool):
        raise refusal("by_approach", by_approach, "True or False")
    w = _moderate("work_of_adhesion", work_of_adhesion)
    n = _exponent(exponent, 1.0)
    if n <= 0.5:
        raise refusal("exponent", exponent, "> 1/2")
    unit = power_law_contact(1.0, coefficient, exponent).approach
    # It comes off where δ' = 0 or, if the load is held, P' = 0. With δ = B aⁿ − √(πaw/2) either
    # determines a^(n − 1/2), the second with a factor of 3.
    ratio = math.sqrt(math.pi * w / 2.0) * (1.0 if by_approach else 3.0) / (2.0 * unit * n)
    log_radius = math.log(ratio) / (n - 0.5)
    if abs(log_radius) > _LARGEST_LOG:
        told = "such that the contact comes off at a radius in [1e-30, 1e30]"
        given = coefficient, exponent, work_of_adhesion
        raise refusal("coefficient, exponent, work_of_adhesion", given, told)
    a = ratio ** (1.0 / (n - 0.5))
    found = adhesive_contact(power_law_contact(a, coefficient, exponent), a, w)
    return PullOff(a, found.approach, found.load)


def flat_pull_off(radius: float, work_of_adhesion: float) -> PullOff:
    """Return where a flat punch comes off a smooth surface: P = −4a√(2πaw).

    Parameters
    ----------
    radius, work_of_adhesion : float
        a and w, > 0.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    References
    ----------
    Kendall (1971).
    """
    radius = _moderate("radius", radius)
    found = adhesive_contact(SmoothContact(0.0, 0.0), radius, work_of_adhesion)
    return PullOff(radius, found.approach, found.load)
