"""The matrix of a contact system: where its entries are filled in.

It is minus the derivative of `ContactSystem.residual` by the unknowns. ``T q`` and ``N p`` are Gram
matrices of half-integrals, summed over the nodes of each part (docs/theory, Abel factorisation).
Where an equation is tested without boundary weights (`ContactOperators`), the Gram matrix of the
central disk is a power of its radius times that of the unit disk, which is cached, and the coupling
of the two equations is a sum of products of loads, in which no kernel is left.

Two cases have their matrices elsewhere: normal contact alone, and a known pressure on one stick
disk or in full stick (`factored.CholeskyFactoredSystem`). They take the Gram matrix of the unit
disk from `spaces.Space.gram` and add the compliance in `regularised.RegularisedProblem`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.spectral.blocks import cached_disk_gram
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.moments import outer_moments
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters

Array = NDArray[np.float64]


def system_matrix(system: ContactSystem) -> Array:
    """Return minus the derivative of `ContactSystem.residual` by the unknowns.

    A step that removes a residual is the solution with this matrix; it is added to the vector.
    """
    matrix = _without_masses(system)
    for place, mass in system.masses:
        matrix[place, place] += block_diag(*mass.blocks())
    return matrix


def _without_masses(system: ContactSystem) -> Array:
    """Return the matrix without masses; coupled full stick has a cached one for kappa = 1."""
    if system.radii or system.pressure_known:
        return _assembled(system)
    [part] = system.parts
    space = DiscreteSpace(part.mesh.panels, part.degrees)
    matrix = _full_stick_matrix(space, system.parameters.beta == 0.0).copy()
    matrix[: system.pressure_terms, system.pressure_terms :] *= system.parameters.kappa
    matrix[system.pressure_terms :, : system.pressure_terms] *= system.parameters.kappa
    return matrix


def _assembled(system: ContactSystem) -> Array:
    """Return the matrix without masses, assembled part by part."""
    matrix = np.zeros((system.unknowns, system.unknowns))
    for i in range(system.stick_parts[-1] + 1):
        _add_shear_equation(system, matrix, i)
    if system.pressure_known:
        return matrix
    for i in range(len(system.parts)):
        _add_normal_equation(system, matrix, i)
        if not system.operators.unweighted_normal:
            _add_traction_to_normal(system, matrix, i)
        if not system.operators.unweighted_shear and i <= system.stick_parts[-1]:
            _add_pressure_to_shear(system, matrix, i)
    _add_moments(system, matrix)
    return matrix


def _add_shear_equation(system: ContactSystem, matrix: Array, i: int) -> None:
    """Add ``T q``, tested at the nodes of a part."""
    part = system.parts[i]
    stick = system.operators.outer_stick[i]
    all_shear = stick if system.pressure_known else system.operators.outer_shear[i]
    gram = None
    if part.zone == 0 and system.operators.unweighted_shear:
        gram = cached_disk_gram(part.shear_mesh.panels, part.degrees, shear=True)
        gram = part.mesh.boundary.value**3 * gram
    products = stick.products(
        all_shear,
        system.operators.shear_tests[i],
        other_values=system.operators.unweighted_shear,
        node_sums=gram,
    )
    for k, j, product in products:
        system.shear_maps[j].add(matrix[system.shear_maps[k].place], product)


def _add_normal_equation(system: ContactSystem, matrix: Array, i: int) -> None:
    """Add ``N p``, tested at the nodes of a part."""
    part = system.parts[i]
    outer = system.operators.outer_pressure[i]
    gram = None
    if part.zone == 0 and system.operators.unweighted_normal:
        gram = cached_disk_gram(part.mesh.panels, part.degrees, shear=False)
        gram = part.mesh.boundary.value * gram
    for k, j, product in outer.products(
        outer, system.operators.normal_tests[i], other_values=True, node_sums=gram
    ):
        system.pressure_maps[j].add(matrix[system.pressure_maps[k].place], product)


def _add_traction_to_normal(system: ContactSystem, matrix: Array, i: int) -> None:
    """Add what the traction adds to the normal equation at the nodes i, with boundary weights."""
    outer = system.operators.outer_pressure[i]
    inner = system.operators.inner_shear[i]
    t = system.operators.t[i]
    weights = system.operators.normal_tests[i]
    coupling = 2.0 * system.parameters.kappa
    for k, j, product in outer.products(inner, weights * t):
        system.shear_maps[j].add(matrix[system.pressure_maps[k].place], coupling * product)
    # with I(t) the inner integral of q: t I(t) is t I(b) and t times an increment. Column 0 of the
    # sums is for I(b), column 1 for the load ``int q ds``
    weighted = coupling * np.column_stack([weights * t, weights])
    for k, sums in outer.project(weighted):
        rows = matrix[system.pressure_maps[k].place]
        for j, block in inner.blocks.items():
            system.shear_maps[j].add(rows, block.scale * sums[:, :1] * block.boundary_value)
        for j, shear_load in enumerate(system.shear_loads):
            system.shear_maps[j].add(rows, -sums[:, 1:] * shear_load)


def _add_pressure_to_shear(system: ContactSystem, matrix: Array, i: int) -> None:
    """Add what the pressure adds to the shear equation at the nodes i, with boundary weights."""
    outer = system.operators.outer_stick[i]
    inner = system.operators.inner_pressure[i]
    factor = system.operators.shear_tests[i] * 2.0 * system.parameters.kappa / system.operators.t[i]
    for k, j, product in outer.products(inner, factor):
        system.pressure_maps[j].add(matrix[system.shear_maps[k].place], -product)
    decrements = factor * system.operators.from_boundary[i] / system.parts[i].mesh.boundary.value
    for k, sums in outer.project(decrements[:, None]):
        rows = matrix[system.shear_maps[k].place]
        for j, block in inner.blocks.items():
            system.pressure_maps[j].add(rows, block.scale * sums * block.boundary_value)


def _add_moments(system: ContactSystem, matrix: Array) -> None:
    """Add the coupling terms of equations without boundary weights, in which no kernel is left.

    With ``g[p] = int_0^s p s ds / s`` (docs/theory, symbols)

    ``<phi, int_s^1 q> = int phi s ds int q ds`` where q lies outside of phi, and
    ``<s psi, g[p]> = int psi s ds int p s ds`` where p lies inside of psi.
    """
    kappa = system.parameters.kappa
    for k, part in enumerate(system.parts):
        nested = kappa * _nested_moments(system, k)
        coupled_load = kappa * system.loads[k][:, None]
        coupled_shear_load = kappa * system.shear_loads[k][:, None]
        if system.operators.unweighted_normal:
            rows = matrix[system.pressure_maps[k].place]
            system.shear_maps[k].add(rows, -nested)
            for j in range(k + 1, len(system.parts)):
                system.shear_maps[j].add(rows, -coupled_load * system.shear_loads[j])
        if system.operators.unweighted_shear and part.sticks:
            rows = matrix[system.shear_maps[k].place]
            system.pressure_maps[k].add(rows, -nested.T)
            for j in range(k):
                system.pressure_maps[j].add(rows, -coupled_shear_load * system.loads[j])


def _nested_moments(system: ContactSystem, k: int) -> Array:
    """Return ``int phi s ds int psi s ds`` with psi outside of phi, on a part.

    Rows are the functions phi of p, columns the functions psi of u.
    """
    part = system.parts[k]
    pressure_panels = part.mesh.panels
    shear_panels = part.shear_mesh.panels
    moments = outer_moments(pressure_panels, shear_panels, part.mesh.sign)
    used = np.ix_(
        pressure_panels.functions(part.pressure_degrees),
        shear_panels.functions(part.shear_degrees),
    )
    return np.asarray((0.5 * part.mesh.extent) ** 2 * moments[used])


@bounded_cache("full-stick matrices", 8)
def _full_stick_matrix(space: DiscreteSpace, singular_traction: bool) -> Array:
    """Return the matrix of coupled full stick without masses, for kappa = 1.

    Without tangential compliance the traction is singular at the edge, and u has other functions.
    """
    parameters = Parameters(0.0, 0.0 if singular_traction else 1.0, 1.0, 0.0)
    return _assembled(ContactSystem((), (0,), [space], parameters))
