"""What slip does to a stick disk, against mpmath quadrature of the pressure's endpoint weight."""

import mpmath as mp
import numpy as np
import pytest

from spectral_contact.contact.rim import SlipSource
from spectral_contact.fields.series import EdgeWeight, PressureField, Radius


def integral(radius, alpha, kernel):
    """Return ``int_c^1 kernel(s^2 - c^2) / sqrt(1 - s^2 + alpha) ds``."""
    square, rest = mp.mpf(radius.square), mp.mpf(radius.rest)

    def integrand(angle):
        inside, outside = rest * mp.sin(angle) ** 2, rest * mp.cos(angle) ** 2
        ds = rest * mp.sin(angle) * mp.cos(angle) / mp.sqrt(square + inside)
        return ds * kernel(inside) / mp.sqrt(outside + mp.mpf(alpha))

    near = [mp.mpf(10) ** -k for k in range(22)]
    return mp.quad(
        integrand, [0, *reversed(near), *(mp.pi / 2 - end for end in near[1:]), mp.pi / 2]
    )


@pytest.mark.parametrize(
    ("logit", "alpha"), [(0.0, 0.0), (0.8, 1e-6), (-18.0, 1e-2), (20.0, 1e-14)]
)
def test_half_integrals_of_the_endpoint_weight(logit, alpha):
    radius = Radius.from_logit(logit)
    weight = PressureField(EdgeWeight(1.0, alpha), None)
    source = SlipSource([weight], radius, alpha, 1e-14, 1e-16 * radius.square)
    with mp.workdps(25):
        wanted = integral(radius, alpha, lambda above: 1 / mp.sqrt(above))
        assert source.at_rim[0] == pytest.approx(float(wanted), rel=1e-14)
        for share in (1e-3, 1e-16):
            below = radius.square * share
            inside = np.array([below])
            wanted = integral(radius, alpha, lambda above, b=below: 1 / mp.sqrt(above + b))
            assert source.half_integral(inside)[0, 0] == pytest.approx(float(wanted), rel=1e-14)

            def fall(above, b=below):
                root, longer = mp.sqrt(above), mp.sqrt(above + b)
                return b / (root * longer * (root + longer))

            wanted = integral(radius, alpha, fall)
            assert source.fall(inside)[0, 0] == pytest.approx(float(wanted), rel=1e-14)
