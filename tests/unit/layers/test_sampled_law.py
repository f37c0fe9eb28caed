"""Tables of a law against their cubics in 40 digits, and contacts that hardly press a table."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest

from spectral_contact import Scene, layers, profiles, solve

mp = mpmath.mp.clone()
mp.dps = 40


def exact_values(law, w):
    """Return pressure, slope and energy of Fritsch and Butland's cubics (1984), with 40 digits."""
    x, p = ([mp.mpf(one) for one in ones] for ones in (law.overclosures, law.pressures))
    h = [high - low for low, high in pairwise(x)]
    lines = [(high - low) / one for low, high, one in zip(p, p[1:], h, strict=False)]

    def at_end(near, far, line, next_line):
        slope = ((2 * near + far) * line - near * next_line) / (near + far)
        return slope if slope > 0 else mp.zero

    slopes = [at_end(h[0], h[1], lines[0], lines[1])]
    for k in range(1, len(h)):
        first, second = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
        slopes.append((first + second) / (first / lines[k - 1] + second / lines[k]))
    slopes.append(at_end(h[-1], h[-2], lines[-1], lines[-2]))
    energy = mp.zero
    for k, extent in enumerate(h):
        terms = [
            p[k],
            slopes[k],
            (3 * lines[k] - 2 * slopes[k] - slopes[k + 1]) / extent,
            (slopes[k] + slopes[k + 1] - 2 * lines[k]) / extent**2,
        ]
        u = min(mp.mpf(w) - x[k], extent)
        energy += sum(one * u ** (n + 1) / (n + 1) for n, one in enumerate(terms))
        if w <= law.overclosures[k + 1]:
            break
    pressure = sum(one * u**n for n, one in enumerate(terms))
    return pressure, sum(n * one * u ** (n - 1) for n, one in enumerate(terms) if n), energy


@pytest.mark.parametrize("size", [1e-95, 1.0, 1e95])
@pytest.mark.parametrize("seed", range(5))
def test_the_rounding_of_a_table_is_below_its_bounds(seed, size):
    rng = np.random.default_rng(seed)
    overclosures = size * (np.cumsum(10.0 ** rng.uniform(-3.0, 0.0, 8)) - 5.0 * (seed % 2))
    pressures = np.append(0.0, np.cumsum(10.0 ** rng.uniform(-3.0, 1.0, 7)))
    law = layers.Table(tuple(overclosures), tuple(pressures))
    for depth in 10.0 ** rng.uniform(-6.0, 0.0, 20):
        w = float(law.start + (law.limit - law.start) * depth)
        pressure, slope, energy = exact_values(law, w)
        errors = law._errors(w)
        at = np.array(w)
        assert abs(float(law._pressure(at) - pressure)) <= errors.pressure
        assert abs(float((law._slope(at) - slope) / slope)) <= errors.stiffness
        assert abs(float(law._energy(at) - energy)) <= errors.energy


@pytest.mark.parametrize("load", [1e-5, 1e-20])
def test_a_table_that_is_hardly_pressed_is_a_linear_layer(load):
    """Its pressure had the rounding of the whole piece: no digit, and a refusal after a minute."""
    table = layers.Table((0.0, 0.1, 0.2, 0.3), (0.0, 0.1, 0.2, 0.3))
    bent = layers.Table((0.0, 0.01, 0.03, 0.05), (0.0, 0.1, 0.8, 2.0))
    for law in (table, bent):
        found = solve(Scene(0.3, layer=law, profile=profiles.Flat(1.0), load=load), 1e-8)
        slope = float(exact_values(law, 0.0)[1])
        linear = layers.Linear(1.0 / slope)
        truth = solve(Scene(0.3, layer=linear, profile=profiles.Flat(1.0), load=load), 1e-10)
        # of the bent table, the curvature counts by the overclosure over its length
        curved = 0.0 if law is table else 1e2 * load
        assert found.error.approach < 1e-8
        assert abs(found.approach / truth.approach - 1.0) <= found.error.approach + 1e-10 + curved
