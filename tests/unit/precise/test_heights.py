"""Profiles to many digits."""

from __future__ import annotations

import mpmath
import pytest

from spectral_contact import NotComputedError
from spectral_contact.precise.heights import heights
from spectral_contact.profiles.profile_base import Profile


class Pencil(Profile):
    """A profile that has no form to many digits."""


Pencil.__abstractmethods__ = frozenset()


def test_a_profile_of_another_kind_is_refused_by_its_name():
    with pytest.raises(NotComputedError, match="Pencil has no form"):
        heights(mpmath.mp, Pencil())
