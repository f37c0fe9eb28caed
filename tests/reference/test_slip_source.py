"""What slip does to what is inside of it, against mpmath quadrature of an endpoint weight."""

import mpmath as mp
import numpy as np
import pytest
from spectral_contact.contact.slip_source import SlipSource

from spectral_contact.fields.series import EDGE, EdgeWeight, PressureField, Radius
from spectral_contact.spectral.graded import graded_nodes
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import OffsetRadii, gap

PANELS = LogPanels(18, 2.0, 6)
NODES = graded_nodes(PANELS, (6,) * 18)


def integral(inner, outer, alpha, kernel):
    """Return ``int kernel(s^2 - inner^2) / sqrt(1 - s^2 + alpha) ds`` from inner to outer."""
    square, width = mp.mpf(inner.square), mp.mpf(gap(inner, outer))

    def integrand(angle):
        inside, outside = width * mp.sin(angle) ** 2, width * mp.cos(angle) ** 2
        ds = width * mp.sin(angle) * mp.cos(angle) / mp.sqrt(square + inside)
        return ds * kernel(inside) / mp.sqrt(outside + mp.mpf(outer.rest) + mp.mpf(alpha))

    near = [mp.mpf(10) ** -k for k in range(0, 22, 3)]
    return mp.quad(
        integrand, [0, *reversed(near), *(mp.pi / 2 - end for end in near[1:]), mp.pi / 2]
    )


@pytest.mark.parametrize(
    ("logit", "end", "alpha"),
    [
        (0.0, None, 0.0),
        (0.8, None, 1e-6),
        (-18.0, None, 1e-2),
        (20.0, None, 1e-14),
        (0.8, 9.0, 1e-6),
        (0.8, 0.8001, 0.3),
    ],
)
def test_half_integrals_of_the_endpoint_weight(logit, end, alpha):
    inner, outer = Radius.from_logit(logit), EDGE if end is None else Radius.from_logit(end)
    weight = PressureField(EdgeWeight(1.0, alpha), None)
    source = SlipSource([weight], inner, outer, alpha, 1e-14, NODES, inner.square)
    alone = SlipSource([weight], inner, outer, alpha, 1e-14)
    below = inner.square * NODES.samples
    falls = source.fall(inner, below)[:, 0]
    farther = Radius.from_logit(logit - 1.0)
    apart = gap(farther, inner)
    with mp.workdps(25):
        at_rim = float(integral(inner, outer, alpha, lambda above: 1 / mp.sqrt(above)))
        assert source.at(inner)[0] == pytest.approx(at_rim, rel=1e-14)
        assert alone.at(inner)[0] == pytest.approx(at_rim, rel=1e-14)
        wanted = integral(inner, outer, alpha, lambda above: 1 / mp.sqrt(above + apart))
        assert source.at(farther)[0] == pytest.approx(float(wanted), rel=1e-14)
        for i in (3, len(below) // 2, len(below) - 1):
            b = mp.mpf(below[i])
            wanted = integral(inner, outer, alpha, lambda above, b=b: 1 / mp.sqrt(above + b))
            points = OffsetRadii(inner, -below[i : i + 1])
            assert source.half_integral(points)[0, 0] == pytest.approx(float(wanted), rel=1e-14)

            def fall(above, b=b):
                root, longer = mp.sqrt(above), mp.sqrt(above + b)
                return b / (root * longer * (root + longer))

            wanted = integral(inner, outer, alpha, fall)
            assert falls[i] == pytest.approx(float(wanted), rel=2e-14)
            wanted = integral(inner, outer, alpha, lambda above, b=b: fall(above + apart, b))
            found = source.fall(farther, np.array([below[i]]))[0, 0]
            assert found == pytest.approx(float(wanted), rel=2e-14)
