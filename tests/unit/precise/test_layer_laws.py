"""Laws of layers to many digits."""

from __future__ import annotations

import mpmath
import pytest

from spectral_contact import NotComputedError
from spectral_contact.layers import Layer
from spectral_contact.layers.scene_layer import KINDS
from spectral_contact.precise.layer_laws import law_of


class Foam(Layer):
    """A law that has no form to many digits."""


Foam.__abstractmethods__ = frozenset()


def test_a_law_of_another_kind_is_refused_by_its_name(monkeypatch):
    monkeypatch.setitem(KINDS, "foam", Foam)
    with pytest.raises(NotComputedError, match="Foam has no form"):
        law_of(mpmath.mp, Foam())
