import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal

from spectral_contact.equations.kernels import normal_kernel, tangential_kernel

mp = MPContext()
mp.dps = 60  # K - E cancels in the reference, down to rho = 1e-20

KERNELS = pytest.mark.parametrize("kernel", [normal_kernel, tangential_kernel])


def exact(kernel, eta, s):
    """Return (2.4) with Landen's transformation undone, by mpmath's elliptic integrals."""
    eta, s = mp.mpf(eta), mp.mpf(s)
    lo, hi = min(eta, s), max(eta, s)
    m = (lo / hi) ** 2
    if kernel is normal_kernel:
        return eta / hi * mp.ellipk(m)
    return eta / lo * (mp.ellipk(m) - mp.ellipe(m))


def printed(kernel, eta, s):
    """Return (2.4) as the paper prints it: moduli 2 sqrt(eta s)/(eta + s)."""
    eta, s = mp.mpf(eta), mp.mpf(s)
    m = 4 * eta * s / (eta + s) ** 2
    if kernel is normal_kernel:
        return 2 * eta / (eta + s) * mp.ellipk(m) / 2
    return ((eta**2 + s**2) / (eta + s) * mp.ellipk(m) - (eta + s) * mp.ellipe(m)) / (2 * s)


def relative(value, reference):
    return abs(float((mp.mpf(float(value)) - reference) / reference))


radius = st.floats(1e-20, 1.0)


@KERNELS
@given(eta=radius, s=radius)
def test_kernels_are_right_to_rounding(kernel, eta, s):
    assume(eta != s)
    assert relative(kernel(eta, s), exact(kernel, eta, s)) < 1e-15


@KERNELS
@given(s=st.floats(1e-6, 1.0), exponent=st.floats(-15.0, -1.0), sign=st.sampled_from([-1, 1]))
def test_kernels_keep_their_digits_near_the_diagonal(kernel, s, exponent, sign):
    eta = s * (1.0 + sign * 10.0**exponent)
    assume(eta != s)
    assert relative(kernel(eta, s), exact(kernel, eta, s)) < 1e-15


@KERNELS
@pytest.mark.parametrize("distance", [1e-10, 1e-14, 1e-17, 1e-100, 1e-300])
def test_the_distance_counts_where_it_is_given(kernel, distance):
    # below the spacing of doubles for most of these
    with mp.workdps(330):
        reference = exact(kernel, 0.75, mp.mpf(0.75) + mp.mpf(distance))
    assert relative(kernel(0.75, 0.75 + distance, distance=distance), reference) < 1e-15


@KERNELS
@pytest.mark.parametrize(("eta", "s"), [(0.3, 0.7), (0.7, 0.3), (1.0, 0.01), (0.01, 1.0)])
def test_kernels_are_those_of_the_paper(kernel, eta, s):
    assert relative(kernel(eta, s), printed(kernel, eta, s)) < 1e-15


@KERNELS
@given(eta=radius, s=radius, scale=st.sampled_from([2.0**-40, 0.5, 8.0, 2.0**100]))
def test_kernels_are_homogeneous_of_degree_zero(kernel, eta, s, scale):
    assert kernel(scale * eta, scale * s) == kernel(eta, s)


@KERNELS
@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-600, 2.0**600])
def test_no_radius_is_too_small_or_too_large(kernel, scale):
    assert kernel(0.3 * scale, 0.7 * scale) == kernel(0.3, 0.7)


@KERNELS
@given(eta=radius, s=radius)
def test_reciprocity(kernel, eta, s):
    # s K(eta, s) is symmetric: the operators are, in the measure s ds
    assert_allclose(s * kernel(eta, s), eta * kernel(s, eta), rtol=1e-15)


@given(eta=radius, s=radius)
def test_kernels_are_positive_and_the_tangential_is_the_smaller(eta, s):
    assume(eta != s)
    assert 0.0 < tangential_kernel(eta, s) < normal_kernel(eta, s)


@KERNELS
@pytest.mark.parametrize("place", [1e-20, 0.3, 1.0])
def test_the_diagonal_is_infinite(kernel, place):
    assert kernel(place, place) == np.inf
    assert kernel(place, place, distance=0.0) == np.inf


def test_limits():
    # rho -> 0: K -> pi/2, K - E -> pi rho^2 / 4
    tiny = 1e-12
    assert_allclose(normal_kernel(1.0, tiny), np.pi / 2, rtol=1e-15)
    assert_allclose(normal_kernel(tiny, 1.0), tiny * np.pi / 2, rtol=1e-15)
    assert_allclose(tangential_kernel(1.0, tiny), tiny * np.pi / 4, rtol=1e-15)
    assert_allclose(tangential_kernel(tiny, 1.0), tiny**2 * np.pi / 4, rtol=1e-15)
    assert normal_kernel(0.5, 0.0) == np.pi / 2
    assert tangential_kernel(0.5, 0.0) == 0.0


@KERNELS
def test_arguments_broadcast(kernel):
    eta, s = np.array([0.1, 0.4, 0.9]), np.array([[0.2], [0.4]])
    values = kernel(eta, s)
    assert values.shape == (2, 3)
    assert_array_equal(values, [[kernel(a, b[0]) for a in eta] for b in s])
    assert values[1, 1] == np.inf
    assert kernel(0.1, 0.2, distance=[0.1, 0.1]).shape == (2,)
