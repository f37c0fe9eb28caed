"""Contact under profiles against closed forms, published numbers, identities and quadrature.

No oracle shares code with the solver but the superposition, which is made of flat punches.
"""

import functools
import math
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.property_settings import few

from spectral_contact import Scene, layers, profiles, solve
from spectral_contact import closed_forms as exact
from spectral_contact.equations.residuals import load as integrated_load
from spectral_contact.equations.residuals import normal_displacement

RTOL = 1e-12
SHAPES = {
    "parabola": profiles.Parabola(1.0),
    "sphere": profiles.Sphere(1.2),
    "cone": profiles.Cone(0.8),
    "power": profiles.PowerLaw(0.7, 2.5),
    "rounded flat": profiles.RoundedFlat(0.5, 1.0),
    "truncated cone": profiles.TruncatedCone(0.5, 1.1),
    "sampled": profiles.Sampled.from_functions(
        lambda r: np.cosh(r) - 1.0, np.sinh, reach=2.0, rounded=True
    ),
}


@functools.cache
def solved(name, alpha, radius=1.0, rtol=RTOL):
    scene = Scene(0.3, alpha, profile=SHAPES[name], contact_radius=radius)
    return solve(scene, rtol, strict=False)


def shown(digits):
    """Equality to one unit of the last digit shown."""
    return pytest.approx(float(digits), rel=0, abs=10.0 ** -len(digits.partition(".")[2]))


def test_the_numbers_of_other_codes():
    solution = solved("parabola", 0.5)
    assert solution.converged
    assert solution.approach == shown("0.6063170022")
    assert solution.load == shown("1.1763284084")
    assert solution.stiffness == shown("3.4134376476")
    cone = solve(Scene(0.3, 0.5, profile=profiles.Cone(math.pi / 4), contact_radius=1.0), RTOL)
    assert cone.approach == shown("1.1372474947")
    assert cone.load == shown("1.5441735804")


SMOOTH = [
    (profiles.Parabola(1.3), 0.9, exact.parabola_contact(0.9, 1.3)),
    (profiles.Sphere(1.3), 0.9, exact.sphere_contact(0.9, 1.3)),
    (profiles.Cone(0.7), 0.9, exact.cone_contact(0.9, 0.7)),
    (profiles.PowerLaw(0.4, 3.7), 0.9, exact.power_law_contact(0.9, 0.4, 3.7)),
    (profiles.PowerLaw(0.4, 4.0), 0.9, exact.power_law_contact(0.9, 0.4, 4.0)),
    (profiles.TruncatedCone(0.5, 0.7), 0.9, exact.truncated_cone_contact(0.9, 0.5, 0.7)),
    (profiles.TruncatedCone(0.5, 0.7), 0.5001, exact.truncated_cone_contact(0.5001, 0.5, 0.7)),
    (profiles.RoundedFlat(0.5, 2.0), 0.9, exact.rounded_flat_contact(0.9, 0.5, 2.0)),
]
KINDS = [f"{type(one[0]).__name__} {one[1]}" for one in SMOOTH]


@pytest.mark.parametrize(("profile", "radius", "truth"), SMOOTH, ids=KINDS)
def test_smooth_contacts_are_the_closed_forms(profile, radius, truth):
    solution = solve(Scene(0.3, profile=profile, contact_radius=radius), RTOL)
    assert solution.converged
    # the closed form of the load cancels next to the rim of a flat part
    assert solution.approach == pytest.approx(truth.approach, rel=3e-14)
    assert solution.load == pytest.approx(truth.load, rel=1e-13)
    assert solution.stiffness == pytest.approx(8.0 * radius, rel=1e-14)


@pytest.mark.parametrize(("profile", "radius", "truth"), SMOOTH, ids=KINDS)
def test_a_load_and_an_approach_find_the_radius_that_has_them(profile, radius, truth):
    for given_one in ({"load": truth.load}, {"approach": truth.approach}):
        solution = solve(Scene(0.3, profile=profile, **given_one), RTOL)
        assert solution.converged
        assert solution.contact_radius == pytest.approx(radius, rel=1e-12)
        [(name, value)] = given_one.items()
        assert getattr(solution, name) == value
        assert getattr(solution.error, name) == 0.0


def test_smooth_pressures_are_the_closed_forms():
    s = np.array([1e-12, 1e-6, 0.01, 0.3, 0.5, 0.7, 0.71, 0.9, 0.999])
    hertz = solve(Scene(0.3, profile=profiles.Parabola(1.3), contact_radius=0.9), RTOL)
    truth = exact.parabola_pressure(0.9, 1.3, 0.9 * s)
    assert hertz.error.pressure < RTOL
    assert np.abs(hertz.pressure(s) / truth - 1.0).max() <= hertz.error.pressure
    assert hertz.pressure(1.0) == 0.0
    assert hertz.pressure(from_edge=1e-200) == pytest.approx(
        8.0 / math.pi * 0.9 / 1.3 * math.sqrt(2e-200), rel=1e-12
    )
    cone = solve(Scene(0.3, profile=profiles.Cone(0.7), contact_radius=0.9), RTOL)
    truth = exact.cone_pressure(0.9, 0.7, 0.9 * s)
    assert np.abs(cone.pressure(s) / truth - 1.0).max() <= cone.error.pressure
    assert cone.pressure(0.0) == math.inf


@pytest.mark.parametrize("short", [0.01, 1e-4, 1e-9])
def test_the_pressure_of_a_smooth_sphere_next_to_its_equator(short):
    """By quadrature of ``(2/pi) int H'(t) dt/sqrt(t^2 - r^2)``: ``H'`` has a pole close by."""
    whole, a = 2.5, 2.5 * (1.0 - short)
    scene = Scene(0.3, profile=profiles.Sphere(whole), contact_radius=a)
    solution = solve(scene, 1e-10, strict=False)
    from_edge = [1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9]
    with mp.workdps(30):

        def rate(t):
            return 2 * mp.atanh(t / whole) + 2 * t * whole / ((whole - t) * (whole + t))

        def truth(y):
            r = mp.mpf(a) * (1 - mp.mpf(y))
            # t = r + v**2
            return (
                2
                / mp.pi
                * mp.quad(
                    lambda v: 2 * rate(r + v**2) / mp.sqrt(2 * r + v**2),
                    [0, mp.sqrt(a * mp.mpf(y)) / 2, mp.sqrt(a * mp.mpf(y))],
                )
            )

        exact_approach = float(a * mp.atanh(mp.mpf(a) / whole))
        expected = np.array([float(truth(y)) for y in from_edge])
    assert abs(solution.approach / exact_approach - 1.0) <= solution.error.approach
    mean = solution.load / (math.pi * a**2)
    errors = np.abs(solution.pressure(from_edge=from_edge) - expected) / np.maximum(expected, mean)
    assert errors.max() <= solution.error.pressure
    assert solution.error.pressure < 1e-5


@pytest.mark.parametrize("past", [1e-8, 0.0455, 0.3])
def test_the_approach_of_a_rounded_flat_has_all_digits_past_its_corner(past):
    b, a = 0.28, 0.28 * (1.0 + past)
    scene = Scene(0.3, profile=profiles.RoundedFlat(b, 0.2), contact_radius=a)
    solution = solve(scene, RTOL, ("approach",))
    with mp.workdps(40):
        root = mp.sqrt((mp.mpf(a) - b) * (mp.mpf(a) + b))
        truth = a * (root - b * mp.acos(b / mp.mpf(a))) / mp.mpf(0.2)
        error = float(abs(solution.approach / truth - 1))
    assert error <= solution.error.approach < 1e-14


#: Pressure at a tip or at a break, to which panels are graded, by `precise.reference` to 20 digits:
#: profile, compliance, work of adhesion, distance from the edge, pressure.
AT_TIPS_AND_BREAKS = [
    (profiles.PowerLaw(0.5, 3.0), 1e-7, None, 1.0, 2.2499957249518328302617),
    (profiles.PowerLaw(0.5, 1.5), 1e-5, None, 1.0, 3.4171906287071357499584),
    (profiles.PowerLaw(0.5, 1.5), 4.2e-5, 400.0, 1.0, -28.523028440570503356638),
    (profiles.RoundedFlat(0.05, 1.0), 1e-8, None, 0.95, 2.163768947430417649554),
]


@pytest.mark.parametrize("rtol", [1e-11, 3e-12, 1e-12])
@pytest.mark.parametrize(("profile", "alpha", "adhesion", "from_edge", "truth"), AT_TIPS_AND_BREAKS)
def test_rounding_of_the_pressure_at_a_tip_and_at_a_break(
    profile, alpha, adhesion, from_edge, truth, rtol
):
    """Under ``r**3`` it was 1.4 times its estimate, and under a pull it knew of no pull."""
    scene = Scene(None, alpha, profile=profile, contact_radius=1.0, work_of_adhesion=adhesion)
    found = solve(scene, rtol, strict=False)
    size = max(abs(truth), found.error_scales.get("load", found.load) / math.pi)
    error = abs(float(found.pressure(from_edge=from_edge)) - truth) / size
    assert error <= found.error.pressure < 1e-8


#: Layer, and load and approach of a unit sphere, by `precise.reference` on meshes of its own. The
#: half-integral has its pole as close as the equator; the second one is pulled.
LAYER = {"normal_compliance": 0.1}
PULLED = {"normal_compliance": 10.0, "work_of_adhesion": 0.1}
LAW = {"layer": layers.PowerLaw(0.1, 2.0)}
NEXT_TO_EQUATOR = {
    "1e-15": (LAYER, 1e-15, 9.20260082790005795, 1.89329404932305394),
    "adhesion": (PULLED, 1e-12, -0.233241729112977984, -0.439443237925986208),
    "law": (LAW, 1e-9, 0.152869207833101377, 1.01373513343558437),
}


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("name", NEXT_TO_EQUATOR)
def test_a_layer_next_to_the_equator_of_a_sphere(name, rtol):
    """Spaces that were not graded to the pole lacked up to 2e-6, above their estimates."""
    given, short, load, approach = NEXT_TO_EQUATOR[name]
    scene = Scene(0.3, profile=profiles.Sphere(1.0), contact_radius=1.0 - short, **given)
    found = solve(scene, rtol, strict=False)
    sizes = {"load": load, "approach": approach, **found.error_scales}
    assert found.converged
    assert abs(found.load - load) <= found.error.load * sizes["load"]
    assert abs(found.approach - approach) <= found.error.approach * sizes["approach"]


@pytest.mark.parametrize("name", ["1e-15", "law"])
@pytest.mark.parametrize("known", ["load", "approach"])
def test_what_a_radius_next_to_the_equator_adds_has_room(name, known):
    """The slope of the pressure at the edge, which tells how far off the radius is, was too low."""
    given, short, load, approach = NEXT_TO_EQUATOR[name]
    values = {"load": load, "approach": approach}
    scene = Scene(0.3, profile=profiles.Sphere(1.0), **{known: values[known]}, **given)
    found = solve(scene, 1e-8, strict=False)
    assert abs(found.contact_radius - (1.0 - short)) <= found.error.contact_radius + 1e-16
    for one, value in values.items():
        assert abs(getattr(found, one) / value - 1.0) <= getattr(found.error, one) + 1e-15, one


@pytest.mark.parametrize("reach", [1.0, 6.0, 40.0])
def test_a_function_that_is_sampled_far_beyond_the_contact_has_room_for_it(reach):
    bowl = profiles.Sampled.from_functions(
        lambda r: r**2 / 2.0 + r**4 / 8.0, lambda r: r + r**3 / 2.0, reach=reach, rounded=True
    )
    solution = solve(Scene(0.3, profile=bowl, contact_radius=0.5), 1e-10, strict=False)
    parts = exact.parabola_contact(0.5, 1.0), exact.power_law_contact(0.5, 0.125, 4.0)
    assert solution.converged == (reach < 40.0)
    for name in ("load", "approach"):
        truth = sum(getattr(part, name) for part in parts)
        error = abs(getattr(solution, name) / truth - 1.0)
        assert error <= getattr(solution.error, name)
    assert solution.error.contact_radius == 0.0


def test_a_thin_layer_tends_to_hertz_as_its_series_says():
    """The shift of the approach is of the order of alpha ln(1/alpha), and so is all else."""
    shifts = []
    for alpha in (1e-12, 1e-10, 1e-8):
        solution = solved("parabola", alpha)
        assert solution.converged
        shifts.append((1.0 - solution.approach) / alpha)
        assert solution.load == pytest.approx(16.0 / 3.0, rel=100.0 * alpha + 1e-13)
    # linear in the logarithm: equal steps; what rounding leaves of 1e-12 is four digits
    assert shifts[0] - shifts[1] == pytest.approx(shifts[1] - shifts[2], rel=1e-3)
    assert shifts[0] - shifts[1] > 1.0


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0])
def test_a_soft_layer_tends_to_winkler(exponent):
    alpha, profile = 1e6, profiles.PowerLaw(0.4, exponent)
    solution = solve(Scene(0.3, alpha, profile=profile, contact_radius=0.9), RTOL)
    truth = exact.winkler_contact(0.9, 0.4, exponent, alpha)
    assert solution.converged
    assert solution.approach == pytest.approx(truth.approach, rel=2e-6)
    assert solution.load == pytest.approx(truth.load, rel=2e-6)
    assert solution.approach > truth.approach


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("alpha", [1e-3, 0.5, 30.0])
def test_the_pressure_solves_the_equation_by_quadrature(name, alpha):
    """(alpha/a) p + N p = (delta - h)/a with the elliptic kernel, and it bears the load."""
    profile, a = SHAPES[name], 1.1
    solution = solved(name, alpha, a)
    assert solution.error.pressure < 1e-11

    def pressure(from_edge):
        return solution.pressure(from_edge=from_edge)

    breaks = [1.0 - b / a for b in profile.breaks]
    depths = [10.0**-k for k in range(1, 6) if 10.0**-k > alpha / 30.0]
    for from_edge in (1e-3, 0.2, 0.52, 0.93):
        moved = normal_displacement(pressure, from_edge, [*breaks, *depths])
        height = float(profile.height(np.array(a * (1.0 - from_edge))))
        layer = alpha / a * solution.pressure(from_edge=from_edge)
        assert a * (layer + moved) == pytest.approx(solution.approach - height, abs=3e-11)
    whole = 2.0 * math.pi * a**2 * integrated_load(pressure, breaks=[*breaks, *depths])
    assert solution.load == pytest.approx(whole, rel=1e-11)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("alpha", [0.0, 1e-3, 0.5])
def test_the_gap_opens_at_the_edge(name, alpha):
    """It is zero at the edge, which takes pressure, approach and profile together, and grows."""
    solution = solved(name, alpha, 1.1)
    beyond = np.array([0.0, 1e-9, 1e-6, 1e-3, 0.05])
    gap = solution.gap(beyond=beyond)
    assert abs(gap[0]) <= 1e-13 * solution.approach
    assert (np.diff(gap) > 0.0).all()
    assert solution.gap(1.05) == pytest.approx(gap[-1], rel=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_the_stiffness_is_that_of_a_flat_punch_of_the_radius(name):
    """The theorem dP/ddelta = a/delta*_flat(alpha/a), by the flat punch and by differences."""
    alpha, a, step = 0.2, 1.1, 1e-4
    solution = solved(name, alpha, a)
    flat = solve(Scene(0.3, alpha / a), RTOL).approach
    assert solution.stiffness == pytest.approx(a / flat, rel=1e-12)
    below, above = (solved(name, alpha, a + sign * step) for sign in (-1, 1))
    slope = (above.load - below.load) / (above.approach - below.approach)
    assert solution.stiffness == pytest.approx(slope, rel=1e-6)


def test_the_pressure_is_a_superposition_of_flat_punches():
    """p(r) = int p*(r/b; alpha/b) dP/b^2 over the radii b from r to a."""
    alpha, a, r = 0.3, 1.0, 0.6
    nodes = np.polynomial.chebyshev.chebpts1(16)
    loads = [solved("parabola", alpha, r + (a - r) * (1.0 + x) / 2.0).load for x in nodes]
    series = np.polynomial.Chebyshev.fit(nodes, loads, 15)
    slope = series.deriv()
    g, w = np.polynomial.legendre.leggauss(12)
    total = 0.0
    ends = [0.0, *(0.2 ** np.arange(9, -1, -1.0))]
    for low, high in pairwise(ends):  # to b = r, where p* has a y ln y
        for x, weight in zip(g, w, strict=True):
            share = low + (high - low) * (1.0 + x) / 2.0
            b = r + (a - r) * share
            flat = solve(Scene(0.3, alpha / b), 1e-12, ["pressure"])
            rate = slope(2.0 * share - 1.0) * 2.0
            value = flat.pressure(from_edge=(a - r) * share / b) * rate / b**2
            total += weight * (high - low) / 2.0 * value
    assert solved("parabola", alpha).pressure(r) == pytest.approx(total, rel=1e-11)


def test_the_work_is_the_integral_of_the_load():
    """W = int P ddelta, with Gauss's rule in the radius and dP, ddelta by interpolation."""
    for name in ("parabola", "cone"):
        solution, alpha = solved(name, 0.3), 0.3
        nodes = np.polynomial.chebyshev.chebpts1(20)
        start = 0.3
        radii = start + (1.0 - start) * (1.0 + nodes) / 2.0
        found = [solved(name, alpha, radius) for radius in radii]
        load = np.polynomial.Chebyshev.fit(nodes, [one.load for one in found], 19)
        approach = np.polynomial.Chebyshev.fit(nodes, [one.approach for one in found], 19)
        rise = (load * approach.deriv()).integ()
        done = solution.indentation_work - solved(name, alpha, start).indentation_work
        assert done == pytest.approx(rise(1.0) - rise(-1.0), rel=1e-11)


def test_a_punch_is_never_pinned_at_a_corner():
    """However small the load, the contact goes past the flat part; then it is flat punch's."""
    for profile in (SHAPES["rounded flat"], SHAPES["truncated cone"]):
        loads = [
            # a millionth past it, roundings count half a million times
            solve(Scene(0.3, 0.5, profile=profile, contact_radius=0.5 + step), 1e-8).load
            for step in (1e-2, 1e-4, 1e-6)
        ]
        assert loads[0] > 10.0 * loads[1] > 100.0 * loads[2] > 0.0


def test_an_exact_sphere_is_pinned_at_its_equator():
    sphere = profiles.Sphere(1.0)
    near = solve(Scene(0.3, 0.5, profile=sphere, load=3.25), 1e-10)
    assert near.contact_radius < 1.0
    with pytest.raises(Exception, match=r"load = 3\.27: must be that of a contact radius"):
        solve(Scene(0.3, 0.5, profile=sphere, load=3.27), 1e-10)


@given(
    st.sampled_from(sorted(SHAPES)),
    st.floats(-6.0, 3.0),
    st.floats(0.55, 1.15),
    st.floats(-10.0, -3.0),
)
@few
def test_true_errors_are_within_their_estimates(name, exponent, radius, digits):
    """Against the same method at its best; what it converges to is tested above."""
    alpha, rtol = 10.0**exponent, 10.0**digits
    best = solved(name, alpha, radius)
    scene = Scene(0.3, alpha, profile=SHAPES[name], contact_radius=radius)
    rough = solve(scene, rtol, strict=False)
    for quantity in ("approach", "load", "stiffness", "indentation_work"):
        truth, error = best.values[quantity], getattr(rough.error, quantity)
        margin = getattr(best.error, quantity)
        assert abs(rough.values[quantity] / truth - 1.0) <= error + margin
    from_edge = np.concatenate([10.0 ** -np.linspace(0.5, 12.0, 12), np.linspace(0.0, 1.0, 40)])
    truth = best.pressure(from_edge=from_edge)
    size = np.maximum(np.abs(truth), best.load / (math.pi * radius**2))
    off = np.abs(rough.pressure(from_edge=from_edge) - truth) / size
    assert off.max() <= rough.error.pressure + best.error.pressure


@pytest.mark.parametrize("known", ["load", "approach"])
@pytest.mark.parametrize("alpha", [1e-4, 4.0])
def test_what_grows_steeply_with_the_radius_has_room_for_its_error(alpha, known):
    # indentation work grows like the radius to the power of 17 here
    punch = profiles.PowerLaw(1.0, 8.0)
    truth, s = solve(Scene(0.3, alpha, profile=punch, contact_radius=1.1), RTOL), [0.1, 0.6, 0.99]
    found = solve(Scene(0.3, alpha, profile=punch, **{known: getattr(truth, known)}), 1e-3)
    assert found.converged
    assert found.error.contact_radius > 1e-9  # or there is nothing to have room for
    for name in ("contact_radius", "load", "approach", "stiffness", "indentation_work"):
        off = abs(getattr(found, name) / getattr(truth, name) - 1.0)
        assert off <= getattr(found.error, name) + 1e-12, name
    off = np.abs(found.pressure(s) / truth.pressure(s) - 1.0).max()
    assert off <= found.error.pressure


@pytest.mark.parametrize("known", ["load", "approach"])
def test_the_pressure_next_to_a_corner_has_room_for_that_of_the_radius(known):
    # at a given s the corner moves with the radius
    punch, alpha, radius = profiles.TruncatedCone(0.15, 0.21), 8e-8, 0.1976
    truth = solve(Scene(0.3, alpha, profile=punch, contact_radius=radius), RTOL, strict=False)
    scene = Scene(0.3, alpha, profile=punch, **{known: getattr(truth, known)})
    found = solve(scene, 1e-6)
    shift = np.geomspace(1e-8, 1e-2, 40)
    from_edge = 1.0 - 0.15 / radius + np.concatenate([-shift, shift])
    exact, mean = truth.pressure(from_edge=from_edge), truth.load / (math.pi * radius**2)
    off = np.abs(found.pressure(from_edge=from_edge) - exact) / np.maximum(exact, mean)
    assert found.converged
    assert off.max() <= found.error.pressure + truth.error.pressure


@pytest.mark.parametrize("exponent", [1.01, 1.1, 1.5, 1.9])
def test_the_pressure_at_the_tip_of_a_power_law_is_finite(exponent):
    scene = Scene(0.3, 0.0, profile=profiles.PowerLaw(1.0, exponent), contact_radius=1.0)
    found = solve(scene, 1e-10)
    # (2/pi) int_0^1 H'(t)/t dt, with H = 2 t int_0^t h' ds/sqrt(t^2 - s^2)
    beta = math.gamma(exponent / 2.0) / math.gamma((exponent + 1.0) / 2.0)
    truth = 2.0 * exponent**2 * beta / (math.sqrt(math.pi) * (exponent - 1.0))
    assert found.error.pressure <= 1e-10
    assert abs(found.pressure(0.0) / truth - 1.0) <= found.error.pressure


def test_a_load_next_to_a_corner_is_found_to_a_rounding_of_the_radius():
    """Where the load cannot be met more closely than the radius is rounded."""
    profile = profiles.TruncatedCone(0.7440563722025276, 0.68251499361468)
    scene = Scene(0.3, 1.911831906041158e-06, profile=profile, load=0.0015082260865139849)
    found = solve(scene, 1e-12, ["contact_radius", "load"], strict=False)
    assert found.contact_radius == pytest.approx(0.7440567719769855, rel=1e-15)


@pytest.mark.parametrize("alpha", [1e-12, 1e-10])
def test_a_thin_layer_converges_at_loose_tolerances_too(alpha):
    # what the panels above leave is felt in the layer, where alone the error shows
    scene = Scene(0.3, alpha, profile=profiles.Parabola(1.0), contact_radius=1.0)
    true, y = solve(scene, 1e-11), np.concatenate([[0.0], np.logspace(-15, -0.1, 80)])
    for rtol in (1e-2, 5.62e-3, 3.16e-3, 1.78e-3, 1.78e-4):
        solution = solve(scene, rtol)  # raises if it does not converge
        off = np.abs(solution.pressure(from_edge=y) - true.pressure(from_edge=y))
        scale = np.maximum(true.pressure(from_edge=y), true.load / math.pi)
        assert (off / scale).max() <= solution.error.pressure + true.error.pressure


@pytest.mark.parametrize(
    "given", [{"approach": 0.3}, {"load": 1.0}], ids=lambda one: next(iter(one))
)
@pytest.mark.parametrize("unit", [2.0**-30, 2.0**30])
def test_the_radius_under_a_high_power_is_found_in_any_unit_of_length(unit, given):
    # at a radius of 1 the height of the profile is 1e171, or 1e-171
    def radius(unit):
        profile = profiles.PowerLaw(unit**-19.0, 20.0)
        power = {"approach": 1, "load": 2}
        pressed = {name: value * unit ** power[name] for name, value in given.items()}
        return solve(Scene(0.3, 0.1 * unit, profile=profile, **pressed), 1e-10).contact_radius

    assert radius(unit) / unit == pytest.approx(radius(1.0), rel=1e-11)
