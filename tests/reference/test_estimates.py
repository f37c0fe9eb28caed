"""Terms of the estimates, each with a scene whose true error exceeds what the other terms make.

Found by leaving a term out and solving random scenes at random tolerances. Only `solve` is used, so
that the tests outlive the solver.
"""

import functools

import pytest

from spectral_contact import Scene, gold, solve


@functools.cache
def solved(scene, rtol):
    return solve(scene, rtol)


@pytest.mark.parametrize("most", [1, 50, 20_000])
def test_the_error_of_the_approach_is_what_panels_make_not_the_tail_beyond_them(most):
    """In 2,600 solves the tail added less than 3 % to the estimate, which does not have it."""
    for true in gold.table("frictionless").solutions:
        for rtol in (1e-2, 1e-5, 1e-8):
            found = solve(true.scene, rtol, ("approach",), max_unknowns=most, strict=False)
            error = abs(float(found.approach / true.approach - 1))
            assert error <= found.error.approach + float(true.error.approach)


#: What the pressure lacks, which drives the traction, and of which boundaries and shear follow.
OF_THE_PRESSURE = [
    (Scene(-0.89, 0.026, 0.0644, 0.0912), 6.5e-4),
    (Scene(-0.64, 0.0791, 0.1924, 0.1912), 8.6e-4),
    (Scene(0.2, 0.01426, 0.01763, 0.05436), 2.5e-3),
]


@pytest.mark.parametrize(("scene", "rtol"), OF_THE_PRESSURE)
def test_shear_and_stick_radius_have_the_error_of_the_pressure(scene, rtol):
    loose, tight = solved(scene, rtol), solved(scene, 1e-12)
    for name in ("total_shear", "stick_radius"):
        error = abs(getattr(loose, name) / getattr(tight, name) - 1.0)
        assert error <= getattr(loose.error, name) + getattr(tight.error, name)


def test_the_shear_of_coupled_slip_has_the_square_of_the_error_and_its_rounding():
    """It superconverges: what it changes by from degree to degree may vanish by accident."""
    material = {"friction": 0.023979473356554246, "coupling": True}
    scene = Scene(0.048551337677664175, 3.7939152790607316, 0.1239253683046046, **material)
    loose, tight = solved(scene, 9.05e-8), solved(scene, 1e-12)
    error = abs(loose.total_shear / tight.total_shear - 1.0)
    assert error <= loose.error.total_shear + tight.error.total_shear
    assert loose.error.total_shear >= 1e-15
