import dataclasses

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal

from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.tuning import TAIL_TERMS

mp = MPContext()
mp.dps = 30

MESHES = pytest.mark.parametrize(
    "panels",
    [LogPanels(6, 2.0, 12), LogPanels(1, 1.0, 4), LogPanels(30, 2.0, 8), LogPanels(3, 1.0, 20)],
    ids=str,
)


def test_sizes():
    panels = LogPanels(5, 2.0, 7)
    assert_allclose(panels.end, np.exp(-10.0), rtol=1e-15)
    assert panels.tail_terms == TAIL_TERMS
    assert panels.size == 5 * 8 + TAIL_TERMS
    rooted = LogPanels(5, 2.0, 7, root_tail=True)
    assert rooted.tail_terms == 3 * TAIL_TERMS
    assert rooted.size == 5 * 8 + 3 * TAIL_TERMS


def test_panels_are_keys():
    # the operators are cached by their panels
    assert LogPanels(5, 2.0, 7) == LogPanels(5, 2.0, 7, 0.0, False)
    assert hash(LogPanels(5, 2.0, 7)) == hash(LogPanels(5, 2.0, 7, 0.0, False))
    different = {LogPanels(5, 2.0, 7, power, root) for power in (0.0, -0.5) for root in (0, 1)}
    assert len(different) == 4
    with pytest.raises(dataclasses.FrozenInstanceError):
        LogPanels(5, 2.0, 7).width = 1.0


# --- sampling -------------------------------------------------------------------------------------


@MESHES
def test_sampling_points_lie_in_their_panels(panels):
    x = panels.sampling()
    assert x.shape == (panels.count, max(panels.degree + 5, 20))
    assert_array_equal(np.floor(x / panels.width), np.arange(panels.count)[:, None] + 0 * x)
    assert np.all(np.diff(x, axis=1) > 0)
    d = panels.tail_sampling()
    assert len(d) > panels.tail_terms
    assert np.all((d > 0) & (d < panels.end))


# --- Gram matrix of the polynomials ---------------------------------------------------------------


@MESHES
@pytest.mark.parametrize("weights", [(1.0, 0.0), (0.0, 1.0), (0.5, -0.25)])
def test_mass_of_the_first_panel(panels, weights):
    n = panels.degree
    gram = panels.mass((n,) * panels.count, *weights).blocks()[0]
    assert_allclose(gram, gram.T, atol=2e-16)
    h = mp.mpf(panels.width)
    for i, k in ((0, 0), (0, n), (1, n - 1), (n, n)):
        exact = mp.quad(
            lambda u, i=i, k=k: (
                mp.fdot(weights, [mp.exp(-h * u), mp.exp(-2 * h * u)])
                * (h * mp.legendre(i, 2 * u - 1) * mp.legendre(k, 2 * u - 1))
            ),
            [0, 1],
            method="gauss-legendre",
        )
        assert abs(gram[i, k] - float(exact)) < 4e-15 * np.sqrt(gram[i, i] * gram[k, k])
