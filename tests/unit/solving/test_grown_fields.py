"""The quadrature over the history of a growing contact."""

import math

import numpy as np
import pytest
from scipy.special import beta, digamma

from spectral_contact.solving.grown_fields import tanh_rule


@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize(("low", "high"), [(-0.5, 0.5), (0.5, -0.5), (-0.25, 0.0), (0.0, 0.0)])
def test_what_is_singular_at_the_ends_is_integrated_to_the_digits_asked(low, high, error):
    """int x^low (1 - x)^high, a complete beta function; x at the upper end has 16 digits."""
    digits = -math.log(error)
    nodes, weights = tanh_rule(digits, depth=2.0 * digits)
    found = weights @ (nodes**low * (nodes[::-1]) ** high)
    assert found == pytest.approx(beta(low + 1.0, high + 1.0), rel=10.0 * error)


def test_a_root_with_a_logarithm_needs_nodes_a_little_nearer_to_the_end():
    """int ln(x)/sqrt(x) = -4: nodes from x on leave out -2 sqrt(x) ln(x)."""
    digits = -math.log(1e-10)
    truth = beta(0.5, 1.0) * (digamma(0.5) - digamma(1.5))
    assert truth == pytest.approx(-4.0)
    errors = []
    for depth in (2.0 * digits, 2.0 * (digits + math.log(4.0 * digits))):
        nodes, weights = tanh_rule(digits, depth)
        errors.append(abs(weights @ (np.log(nodes) / np.sqrt(nodes)) - truth))
    assert errors[0] > 1e-9
    assert errors[1] < 2e-10
