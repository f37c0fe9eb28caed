"""Fields give a number for a number and an array for an array; mypy checks this file, too."""

from typing import Any, assert_type

import numpy as np
import pytest
from numpy.typing import NDArray

from spectral_contact import Scene, solve

Array = NDArray[np.float64]


def test_dimensionless_fields() -> None:
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1), 1e-3)
    for field in (solution.pressure, solution.traction, solution.slip):
        number = assert_type(field(0.5), float)
        assert isinstance(number, float)
        assert assert_type(field(from_edge=0.5), float) == number
        array = assert_type(field([0.5, 0.25]), Array)
        assert array.shape == (2,)
        assert array[0] == pytest.approx(number)
        nested = assert_type(field(from_edge=np.array([[0.5]])), Array)
        assert nested.shape == (1, 1)


def test_fields_in_si_units() -> None:
    steel = Scene.from_physical(
        youngs_modulus=2e11, poisson_ratio=0.3, radius=2.0, load=1.0, normal_compliance=1e-12
    )
    pressure = solve(steel, 1e-3).physical.pressure
    number = assert_type(pressure(1.0), float)
    assert isinstance(number, float)
    assert assert_type(pressure(from_edge=1.0), float) == number
    assert assert_type(pressure(from_edge=[1.0]), Array).shape == (1,)
    assert assert_type(pressure(np.ones(3)), Array).shape == (3,)


def test_what_may_be_either_is_anything() -> None:
    either: Any = [0.5]
    assert solve(Scene(0.1, 0.5), 1e-3).pressure(either).shape == (1,)
