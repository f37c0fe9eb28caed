"""Friction given as any kind of real number."""

from fractions import Fraction

import numpy as np
import pytest

from spectral_contact import closed_forms as cf

pint = pytest.importorskip("pint")
FRICTIONS = [
    (pint.UnitRegistry().Quantity(30, "percent"), 0.3),
    (Fraction(3, 10), 0.3),
    (np.float32(0.3), float(np.float32(0.3))),
]


@pytest.mark.parametrize(("friction", "plain"), FRICTIONS, ids=["percent", "fraction", "float32"])
def test_friction_of_another_kind_gives_the_numbers_of_a_float(friction, plain):
    shear = cf.partial_slip_shear(0.3, friction)
    assert isinstance(shear, float)
    assert shear == cf.partial_slip_shear(0.3, plain)
    s = [0.2, 0.9, 0.999]
    assert cf.partial_slip_traction(0.3, friction, s).tolist() == pytest.approx(
        cf.partial_slip_traction(0.3, plain, s).tolist(), rel=0.0
    )
