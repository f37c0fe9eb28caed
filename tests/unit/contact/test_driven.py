"""The tangential equation under a known pressure: what is evaluated is what would be assembled."""

import math

import numpy as np
import pytest
from oracles.family_integrals import half_integral
from spectral_contact.contact.drive import Drive

from spectral_contact import Scene, solve
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.spectral.parameters import Parameters

STATES = [(0, 1), (0, 1, 0), (0, 1, 0, -1)]


def zones(states, alpha=0.3):
    """Return zones under the pressure and its two changes."""
    drive = Drive(solve_normal(alpha, 1e-8, 3000).best.value)
    layout = Layout(tuple(np.linspace(-0.5, 2.0, len(states) - 1)), states)
    problem = FreeBoundaryProblem(Parameters(alpha, 0.4, 1.0, 0.3), layout, 1e-8, drive=drive)
    problem.drives = [drive, *drive.changes]
    return problem.system(problem.spaces(1e-8), problem.logits)


def vector(system):
    """Return a random vector, as large as its functions are small, under the pressure alone."""
    values = np.random.default_rng(1).standard_normal(system.unknowns)
    values[system.count :] /= np.sqrt(np.abs(system.matrix().diagonal()[system.count :]))
    values[: system.count] = 1.0, 0.0, 0.0
    return values


@pytest.mark.parametrize("states", STATES)
def test_the_matrix_is_that_of_the_residual(states):
    system = zones(states)
    values = vector(system)
    values[: system.count] = 0.0
    nothing = np.zeros(1), np.zeros((len(system.radii), 1))
    missed = system.residual(values[:, None], *nothing)[:, 0]
    matrix = system.matrix()
    scale = np.abs(matrix) @ np.abs(values)
    assert (np.abs(missed + matrix @ values) <= 1e-10 * scale).all()


@pytest.mark.parametrize("states", STATES)
def test_the_misfit_is_that_of_the_families(states):
    system = zones(states)
    values = vector(system)
    shear = {one.part: one.of(values) for one in system.fields}
    drive, friction = system.drives[0], system.parameters.friction
    nothing = np.zeros((len(system.radii), 1))
    misfit = system.misfit(values[:, None], np.ones(1), nothing).tangential
    assert len(misfit) == system.stick[-1] + 1
    for i, missed in enumerate(misfit):
        points = system.parts[i].family.points(system.nodes[i].d[::7])
        [wanted] = drive.targets([drive], points.y)
        sizes = np.abs(wanted)
        for k, part in enumerate(system.parts):
            if part.state:
                z = part.family.sampling().z
                pressure = drive.pressure.at(part.family.sampling().y)
                own = part.state * friction * part.family.expand(pressure / np.sqrt(z))
            else:
                own = shear[k]
            half = half_integral(part.family, points) @ own
            wanted, sizes = wanted - half, sizes + np.abs(half)
        assert (np.abs(missed[::7, 0] - wanted) <= 1e-11 * sizes.max()).all()
        if system.parts[i].state:
            zone = system.parts[i].zone
            halves = system.slip_misfit(values[:, None], zone, system.slip_zone(zone))
            assert all(np.isfinite(one).all() for one in halves)


def test_loads_and_shears_are_those_of_the_pressure():
    system = zones((0, 1, 0, -1))
    drive, radii = system.drives[0], system.radii
    values = np.zeros(system.unknowns)
    values[0] = 1.0
    assert 2.0 * np.pi * system.load @ values[: system.count] == 1.0
    rests = np.array([one.rest for one in radii])
    inside = 1.0 - 2.0 * np.pi * Drive.loads_outside([drive], rests)[0]
    slipping = (inside[1] - inside[0]) - (1.0 - inside[2])
    assert system.total_shear(values) == pytest.approx(
        system.parameters.friction * slipping, rel=1e-7
    )


@pytest.mark.parametrize(
    ("alpha", "beta", "rtol"), [(0.5, 0.5, 1e-2), (18.0, 0.59, 1e-2), (1.0, 1.0, 3e-3)]
)
def test_loose_full_stick_is_within_its_estimate_at_the_edge(alpha, beta, rtol):
    scene, edge = Scene(0.1, alpha, beta, math.inf), 1e-14
    loose, tight = solve(scene, rtol), solve(scene, 1e-12)
    off = abs(loose.traction(from_edge=edge) / tight.traction(from_edge=edge) - 1.0)
    assert off + tight.error.traction <= loose.error.traction


@pytest.mark.parametrize(("alpha", "beta"), [(0.92, 3.7), (1.3, 10.0), (1.37, 5.0)])
def test_the_largest_ratio_is_found_where_a_loose_space_has_no_panels(alpha, beta):
    scene = Scene(0.0, alpha, beta, math.inf)
    loose, tight = (solve(scene, rtol) for rtol in (1e-2, 1e-12))
    off = abs(loose.critical_friction / tight.critical_friction - 1.0)
    assert off <= loose.error.critical_friction + tight.error.critical_friction
    assert loose.critical_friction > loose.edge_ratio
