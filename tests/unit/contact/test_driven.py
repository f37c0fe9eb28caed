"""The tangential equation under a known pressure: what is evaluated is what would be assembled."""

from math import inf

import numpy as np
import pytest
from oracles.family_integrals import half_integral

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.full_stick import solve_full_stick
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.one_disk import solve_one_disk
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.blocks import across, block
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Family

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
    diagonal = np.abs(system.matrix().diagonal())
    values = np.random.default_rng(1).standard_normal(system.unknowns) / np.sqrt(diagonal)
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
    _, shear = system.split(values)
    drive, friction = system.drives[0], system.parameters.friction
    nothing = np.zeros((len(system.radii), 1))
    misfit = system.misfit(values[:, None], np.ones(1), nothing).tangential
    assert len(misfit) == system.stick[-1] + 1
    for i, missed in enumerate(misfit):
        points = system.parts[i].family.points(system.nodes[i].d[::7])
        wanted, sizes = drive.target(points.y), np.abs(drive.target(points.y))
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
            found = system.slip_misfit(values[:, None], system.parts[i].family)[:, 0]
            assert found.shape == system.parts[i].family.sampling().offset.shape


def test_loads_and_shears_are_those_of_the_pressure():
    system = zones((0, 1, 0, -1))
    drive, radii = system.drives[0], system.radii
    values = np.zeros(system.unknowns)
    values[0] = 1.0
    assert 2.0 * np.pi * system.load @ values[: system.count] == 1.0
    inside = [1.0 - 2.0 * np.pi * float(drive.load_outside(np.array(r.rest))) for r in radii]
    slipping = (inside[1] - inside[0]) - (1.0 - inside[2])
    assert system.total_shear(values) == pytest.approx(
        system.parameters.friction * slipping, rel=1e-7
    )


def test_known_functions_across_a_boundary_are_those_of_their_block():
    boundary, panels = Radius(0.6, 0.4), LogPanels(7, 2.0, 9)
    source, target = Family(boundary, 1, 0.2, panels), Family(boundary, -1, 0.3, panels)
    used = (9, 8, 7, 6, 5, 4, 3)
    wanted = block(source, used, target, used, 1)
    values = np.random.default_rng(2).standard_normal((wanted.at.size, 2))
    at, more = across(source, used, target, used, values)
    assert np.allclose(at, wanted.scale * (wanted.at @ values), rtol=1e-13)
    found = wanted.more @ wanted.onto(values)
    assert np.abs(more - found).max() <= 1e-13 * np.abs(found).max()


def drive_of(alpha, tolerance):
    """Return the drive of normal contact, which is in closed form on a smooth surface."""
    found = solve_normal(alpha, tolerance, 20_000)
    return Drive(found.best.value if isinstance(found, Refinement) else found)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-11])
@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.5), (1e-6, 1e-6), (0.0, 0.3), (0.4, 0.0)])
def test_full_stick_is_the_system_without_a_boundary(alpha, beta, tolerance):
    """Its own solver is faster, and shares neither nodes nor matrices with the system."""
    drive = drive_of(alpha, tolerance)
    own = solve_full_stick(drive, beta, tolerance, 20_000).best
    problem = FreeBoundaryProblem(
        Parameters(alpha, beta, 1.0, inf), Layout((), (0,)), tolerance, drive=drive
    )
    found = refine(problem, tolerance, 20_000).best
    assert max(own.error, found.error) <= tolerance
    off = abs(found.value.total_shear / own.value.total_shear - 1.0)
    assert off <= own.value.shear_error + found.value.shear_error


@pytest.mark.parametrize("tolerance", [1e-4, 1e-11])
@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.5), (1e-6, 1e-6), (1e3, 1e-2)])
def test_one_disk_is_the_system_with_one_boundary(alpha, beta, tolerance):
    """Likewise."""
    drive = drive_of(alpha, tolerance)
    own = solve_one_disk(drive, beta, 0.1, tolerance, 20_000).best.value
    parameters = Parameters(alpha, beta, 1.0, 0.1)
    problem = FreeBoundaryProblem(parameters, own.layout, tolerance, drive=drive)
    found = refine(problem, tolerance, 20_000).best.value
    off = abs(found.radii[0].value / own.radii[0].value - 1.0)
    assert off <= own.radius_error + found.radius_error
    off = abs(found.total_shear / own.total_shear - 1.0)
    assert off <= own.shear_error + found.shear_error
