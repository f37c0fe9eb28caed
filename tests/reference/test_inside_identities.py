"""Fields in the body: formulas in mpmath, rings of load, reciprocity, the bonded punch."""

import math

import mpmath as mp
import numpy as np
import pytest
from oracles.inside_oracle import _parts, assemble, bonded, over_rings, ring

from spectral_contact import Scene, closed_forms, solve
from spectral_contact.equations.interior import ring_loads


def sources(nu, r, z):
    """Return the fields, in mpmath, of a source of pressure and one of traction."""
    normal = _parts(r, z, mp.mpf("0.7"), 1, lambda value: -mp.im(value))
    shear = _parts(r, z, mp.mpf("0.4"), 0, lambda value: -mp.im(value))
    return assemble(nu, r, {key: (normal[key], shear[key]) for key in normal})


def test_the_formulas_are_in_equilibrium_compatible_and_obey_hooke():
    with mp.workdps(40):
        nu, r, z = mp.mpf("0.3"), mp.mpf("0.8"), mp.mpf("0.35")
        here = sources(nu, r, z)

        def slope(name, axis):
            along = (lambda x: sources(nu, x, z)) if axis == "r" else (lambda x: sources(nu, r, x))
            return mp.diff(lambda x: getattr(along(x), name), r if axis == "r" else z)

        radial = slope("rr", "r") + slope("rz", "z") + (here.rr - here.tt) / r
        axial = slope("rz", "r") + slope("zz", "z") + here.rz / r
        strain = [slope("out", "r"), here.out / r, slope("down", "z")]
        double = 4 * (1 - nu)  # twice the shear modulus
        found = [double * (one + nu / (1 - 2 * nu) * sum(strain)) for one in strain]
        found.append(double / 2 * (slope("out", "z") + slope("down", "r")))
        apart = [a - b for a, b in zip(found, (here.rr, here.tt, here.zz, here.rz), strict=True)]
        # Saint-Venant: the strains rr and tt of one displacement outward
        hoop = mp.diff(lambda x: sources(nu, x, z).out / x, r)
        compatible = r * hoop + here.out / r - strain[0]
        assert max(map(abs, (radial, axial, compatible, *apart))) < 1e-17


@pytest.mark.parametrize(
    ("r", "z", "ahead"),
    [(0.3, 0.4, -0.5), (0.8, 1e-9, 1e-7), (1e-3, 0.02, -0.6), (1.0, 1e-3, 1e-10)],
)
def test_a_ring_is_the_sum_of_its_point_forces(r, z, ahead):
    g = ring_loads.geometry(*(np.array([one]) for one in (r, z, r - ahead, ahead)))
    of = (
        (ring_loads.normal_stress, ring_loads.normal_displacement),
        (ring_loads.radial_stress, ring_loads.radial_displacement),
    )
    for (stress, displacement), expected in zip(of, ring(0.3, r, z, r - ahead, ahead), strict=True):
        got = np.array([*(one[0] for one in stress(g, 0.3)), displacement(g, 0.3)[0][0]])
        size = max(np.abs(expected).max(), 1.0 / math.hypot(ahead, z))
        assert np.abs(got - expected).max() < 1e-14 * size


@pytest.mark.parametrize("rtol", [None, 1e-8])
@pytest.mark.parametrize(("from_edge", "z"), [(1e-6, 1e-9), (-1e-3, 1e-3), (0.4, 1e-10)])
def test_another_quadrature_over_rings_agrees_at_any_depth(from_edge, z, rtol):
    solution = solve(Scene(0.2, 1e-3, 1e-3, 0.2, coupling=True), rtol=3e-12)
    expected, _ = over_rings(solution, from_edge, z)
    stress = solution.inside.stress(from_edge=from_edge, z=z, rtol=rtol)
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
    apart = np.abs(got - expected[:4]).max() / stress.norm
    assert apart <= stress.error < (1e-10 if rtol is None else 3e-8)


def test_the_bonded_punch_meets_its_closed_form_at_the_surface():
    nu, from_edge = 0.1, np.array([0.9, 0.5, 0.1, 1e-4])
    body = solve(Scene(nu, friction=math.inf, coupling=True)).inside
    surface, stress = body.surface(from_edge=from_edge), body.stress(from_edge=from_edge)
    np.testing.assert_allclose(surface.z, closed_forms.coupled_approach(nu), rtol=1e-11)
    assert np.all(np.abs(surface.r) < 1e-11 * surface.z)
    pressure = closed_forms.coupled_pressure(nu, from_edge=from_edge)
    np.testing.assert_allclose(stress.zz, -pressure, rtol=1e-10)
    traction = closed_forms.coupled_traction(nu, from_edge=from_edge)
    np.testing.assert_allclose(stress.rz, -traction, rtol=1e-10)


@pytest.mark.parametrize(("from_edge", "z"), [(-0.2, 0.0), (-2.0, 0.0), (0.3, 0.4), (1e-6, 1e-5)])
def test_the_bonded_punch_outside_the_contact_and_in_the_body(from_edge, z):
    nu = 0.1
    body, exact = (
        solve(Scene(nu, friction=math.inf, coupling=True)).inside,
        bonded(nu, None, z, from_edge),
    )
    stress = body.stress(from_edge=from_edge, z=z)
    moved = body.displacement(from_edge=from_edge, z=z)
    got = np.array([stress.rr, stress.tt, stress.zz, stress.rz])
    assert np.abs(got - exact[:4]).max() <= stress.error * stress.norm
    assert np.abs(np.array([moved.r, moved.z]) - exact[4:]).max() <= moved.error * moved.modulus
    assert max(stress.error, moved.error) < 1e-9


def test_the_work_of_one_load_on_the_displacement_of_another_is_mutual():
    one = solve(Scene(0.2, 0.3, 0.5, math.inf), rtol=1e-11)
    other = solve(Scene(0.2, 0.1, 0.1, 0.05), rtol=1e-11)
    inner = 1.0 - other.stick_radius
    steps = 0.25 ** np.arange(13.0)
    ends = np.concatenate([[0.0], inner * (1.0 - steps), inner + (1.0 - inner) * steps])
    ends = np.unique(np.concatenate([ends, inner * steps]))
    nodes, weights = np.polynomial.legendre.leggauss(9)
    low, size = ends[:-1, None], np.diff(ends)[:, None]
    d, weight = (low + size * (1.0 + nodes) / 2.0).ravel(), (size * weights / 2.0).ravel()

    def work(load, body):
        moved = body.inside.displacement(from_edge=d)
        terms = load.pressure(from_edge=d) * moved.z + load.traction(from_edge=d) * moved.r
        return terms @ (weight * (1.0 - d))

    assert work(one, other) == pytest.approx(work(other, one), rel=1e-9)
