"""Two annuli of slip, which no scene is known to have, under a pressure that is made up.

In full stick q/p of a scene has one maximum at most, as far as seen: there is one slip annulus.
Here the pressure dips twice. All of partial slip sees two annuli then, from the search for zones to
the displacement, and the elliptic kernels say whether it is right.
"""

import functools
from itertools import pairwise
from math import inf

import numpy as np
import pytest
from scipy.integrate import quad

from spectral_contact import Scene, solve
from spectral_contact.contact.full_stick import full_stick
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.zone_problem import solve_stick
from spectral_contact.contact.zone_search import UncoupledSearch
from spectral_contact.equations.residuals import tangential_displacement
from spectral_contact.fields.series import PressureField
from spectral_contact.spectral.jacobi import gauss_rule, legendre_expansion_matrix
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.transforms import series_of

BETA, FRICTION = 1.0, 0.47  # for kappa = 1
PANELS = LogPanels(20, 2.0, 24)
#: Distances from the edge that keep the dips apart from the rest.
CUTS = (0.3, 0.1, 0.02, 1e-3)


def dipped(x):
    """Return 1 but for two dips by half, at depths 1.2 and 4 in ``x = -ln(1 - s**2)``."""
    dips = np.exp(-(((x - 1.2) / 0.9) ** 2)) + np.exp(-(((x - 4.0) / 0.9) ** 2))
    return 1.0 - 0.5 * dips


#: Pressure where it does not dip, for unit load.
LEVEL = 1.0 / (np.pi * quad(lambda x: dipped(x) * np.exp(-x), 0.0, 50.0, epsabs=1e-14)[0])


def pressure(from_edge):
    """Return the pressure for unit load."""
    return LEVEL * dipped(-np.log(from_edge * (2.0 - from_edge)))


@functools.cache
def contact():
    """Return the pressure as normal contact hands it on."""
    points = PANELS.degree + 1
    g, _ = gauss_rule(points)
    y = np.exp(-PANELS.width * (np.arange(PANELS.count)[:, None] + (1.0 + g) / 2.0))
    table = pressure(y / (1.0 + np.sqrt(1.0 - y))) @ legendre_expansion_matrix(points, points - 1).T
    tail = np.zeros(PANELS.tail_terms)
    tail[0] = LEVEL
    coefficients = np.concatenate([table.ravel(), tail])
    field = PressureField(None, series_of(PANELS, coefficients))
    nothing = np.zeros(PANELS.size)
    zero = PressureField(None, series_of(PANELS, nothing))
    change = NormalContact(1.0, 0.0, zero, PANELS, nothing)
    return NormalContact(
        1.0, 1.0, field, PANELS, coefficients, 1e-15, 1e-15, changes=(change, change)
    )


@functools.cache
def slipping(rtol):
    known = contact()
    stuck = Parameters(known.compliance, BETA, 1.0, inf)
    stick = full_stick(solve_stick(stuck, rtol, 20_000, known=known), known).best.value

    def record(name, result, begin):
        return result.best.value if isinstance(result, Refinement) else result

    parameters = stuck._replace(friction=FRICTION)
    return UncoupledSearch(parameters, stick, rtol, 20_000, record, known).outcome()


def field(one):
    """Return a field as a function of the distance from the edge."""
    return lambda d: one(1.0 - d, np.asarray(d))


def inside(zone, shares):
    """Return distances from the edge in a zone."""
    return zone.outer_from_edge + (zone.inner_from_edge - zone.outer_from_edge) * np.array(shares)


@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-8])
@pytest.mark.parametrize(
    "scene", [Scene(0.3, 0.05, 1.0, 0.02941066), Scene(0.3, 0.2, 0.5, 0.592739 / 7)]
)
def test_stick_at_the_edge_about_to_vanish_is_found_at_any_tolerance(scene, rtol):
    solution = solve(scene, rtol)
    assert [zone.kind for zone in solution.zones] == ["stick", "slip", "stick"]
    assert solution.zones[1].outer_from_edge < 1e-6
    assert solution.error.zones < 0.1


def test_there_are_two():
    solution = slipping(1e-8)
    assert [zone.kind for zone in solution.zones] == ["stick", "slip", "stick", "slip", "stick"]
    assert solution.consistent
    assert max(solution.traction_error, solution.shear_error) <= 1e-8
    assert solution.zones_error <= 1e-6


def test_the_equation_of_the_elliptic_kernels_and_the_friction_law_hold():
    solution = slipping(1e-8)
    traction, slip = field(solution.traction), field(solution.slip)
    cuts = (*(zone.outer_from_edge for zone in solution.zones[:-1]), *CUTS)
    for zone in solution.zones:
        places = inside(zone, [0.1, 0.5, 0.9])
        share = traction(places) / (FRICTION * pressure(places))
        stuck = zone.kind == "stick"
        assert (share < 1.0).all() if stuck else share == pytest.approx(1.0, rel=1e-12)
        for d, own, moved in zip(places, traction(places), slip(places), strict=True):
            outward, inward = tangential_displacement(traction, pressure, 1.0, d, cuts)
            assert moved == 0.0 if stuck else moved < 0.0
            assert abs(outward + BETA * own - inward - moved) <= 1e-8 * inward


def test_estimates_bound_the_errors():
    loose, tight = slipping(1e-3), slipping(1e-8)
    shear = abs(loose.total_shear / tight.total_shear - 1.0)
    assert shear <= loose.shear_error + tight.shear_error
    for one, other in zip(loose.zones[:-1], tight.zones[:-1], strict=True):
        for side in ("outer", "outer_from_edge"):
            error = abs(getattr(one, side) / getattr(other, side) - 1.0)
            assert error <= loose.zones_error + tight.zones_error


def test_tractions_are_continuous_at_all_four_boundaries():
    solution = slipping(1e-8)
    traction = field(solution.traction)
    for inner, outer in pairwise(solution.zones):
        ends = np.array([inside(inner, [1e-12])[0], inside(outer, [1.0 - 1e-12])[0]])
        assert traction(ends) == pytest.approx(FRICTION * pressure(ends), rel=1e-7)
