import math

import numpy as np

from spectral_contact import Scene, solve


def test_rounding_counts_where_the_pressure_nearly_vanishes_at_an_edge_that_sticks():
    # there the pressure is a thousandth of q/s; alpha varies by a rounding
    compliances = 0.009188187565860335 * (1.0 + 3e-16 * np.arange(4))
    from_edge = 10.0 ** -np.linspace(3.0, 14.0, 400)
    solutions = [
        solve(
            Scene(-0.9251586329788987, alpha, 0.0036503752707239224, math.inf, coupling=True),
            1e-12,
            strict=False,
        )
        for alpha in compliances
    ]
    pressures = np.array([solution.pressure(from_edge=from_edge) for solution in solutions])
    spread = np.ptp(pressures, axis=0) / pressures.min(axis=0)
    assert 2e-13 < spread.max() <= solutions[0].error.pressure < 3e-12
