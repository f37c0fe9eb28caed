"""What the work of the load becomes: energy of the body and of the layer, friction, a defect."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.equations.interior.mesh import BodyMesh, BodyPoints
from spectral_contact.equations.interior.results import Displacement, Energies
from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.profiles import Flat
from spectral_contact.view.progress import ProgressLine

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

Move = Callable[[BodyPoints], Displacement]

#: A ring that carries less than this share changes no digit.
_NEGLIGIBLE = 1e-17
#: Of the rings, after each of which progress is told.
_PORTIONS = 10


def energies(
    solution: Solution, mesh: BodyMesh, move: Move, unit: float, tell: ProgressLine
) -> Energies:
    """Return the energies of a solution.

    Under a flat punch the load grows in proportion, so that each is half of what the final
    tractions would do over the final displacements; so it is below the largest load if nothing has
    slipped. Under a profile it does not; but without
    friction that is still what body and layer store, and together it is the work of the load. With
    friction they are no functions of the final state, and refused.

    Parameters
    ----------
    solution : Solution
        With approach, pressure, traction and slip.
    mesh : BodyMesh
        Panels to integrate over.
    move : callable
        Dimensionless displacements of the body at points.
    unit : float
        What an energy is multiplied by, as is the square of the contact radius of a profile.
    tell : ProgressLine
        Is told how far it is.
    """
    if solution.scene.unloaded_to < 1.0 and _slipped(solution):
        told = "below the largest load, after slip, they are no functions of the state"
        raise NotComputedError("energies", told)
    external, doubt = _external(solution)
    surface, size = _surface(solution, external)
    parts, missing = _parts(solution, mesh, move, tell)
    error = missing + abs(external - surface - parts.sum()) + doubt * size
    error += (solution.error.slip or 0.0) * abs(parts[2])
    strain, layer, friction, defect = (float(one) * unit for one in parts)
    share = float(error / size) if size else 0.0
    given = external * unit, strain, layer, friction, defect, share
    return Energies(*given, surface * unit)


def _slipped(solution: Solution) -> bool:
    """Return whether the surface slips, or has slipped at a larger load."""
    if solution.traction_field is None:
        return False
    return any(zone.kind == "slip" or zone.memory for zone in solution.zones)


def _external(solution: Solution) -> tuple[float, float]:
    """Return the work of the load over the square of the contact radius, and its error."""
    if solution.scene.profile is None:
        load = solution.scene.unloaded_to  # over the largest one
        return load * solution.approach / 2.0, solution.error.approach or 0.0
    if solution.traction_field is not None:
        told = "the energy that friction dissipates in a growing contact depends on its history"
        raise NotComputedError("energies", told)
    work = solution.indentation_work / solution.contact_radius**2
    return work, solution.error.indentation_work or 0.0


def _surface(solution: Solution, external: float) -> tuple[float, float]:
    """Return the energy of the surfaces in contact, and what errors are relative to.

    It is counted along the curve of states that grow from no contact. Under a flat punch the
    contact is there at any load, so that nothing is gained by a load.
    """
    scene = solution.scene
    if scene.work_of_adhesion is None or isinstance(scene.profile, Flat):
        return 0.0, external
    size = solution.error_scales["indentation_work"] / solution.contact_radius**2
    return -np.pi * scene.work_of_adhesion, size


def _parts(
    solution: Solution, mesh: BodyMesh, move: Move, tell: ProgressLine
) -> tuple[Array, float]:
    """Return strain energy, energy in the layer, friction and defect, and what they may miss by."""
    points, rings = mesh.surface
    inside = mesh.carried()
    carried = np.abs(rings[:2]).sum(axis=0)
    counts = np.flatnonzero(carried > _NEGLIGIBLE * carried.sum())
    parts, missing = np.zeros(4), 0.0
    for k, some in enumerate(np.array_split(counts, _PORTIONS)):
        tell("energies", k / _PORTIONS)
        more, less = _of_rings(solution, points[some], rings[:2, some], inside[some], move)
        parts, missing = parts + more, missing + less
    tell("energies", 1.0)
    return parts, missing


def _of_rings(
    solution: Solution, points: BodyPoints, rings: Array, inside: Array, move: Move
) -> tuple[Array, float]:
    """Return what some rings add to the parts, and to what these may miss by."""
    scene, error, (pressure, traction) = solution.scene, solution.error, rings
    moved = move(points)
    at = {"from_edge": points.from_edge}
    p, q = solution.pressure(**at), solution.traction(**at)
    slip = 0.0 if solution.traction_field is None else solution.slip(**at)
    strain = pressure * moved.z + traction * moved.r
    layer = np.zeros_like(strain)
    if scene.normal_compliance > 0.0:  # else p may be infinite
        layer += scene.normal_compliance * p * pressure
    if scene.tangential_compliance > 0.0:
        layer += scene.tangential_compliance * q * traction
    friction = -traction * slip
    defect = np.zeros_like(strain)
    if not scene.couples:
        defect = scene.kappa * traction * inside / points.r
    terms = np.pi * np.stack([strain, layer, friction, defect])
    loads = (error.pressure or 0.0) + (error.traction or 0.0)
    missing = 2.0 * loads * np.abs(terms).sum() + np.pi * (
        (np.abs(pressure) + np.abs(traction)) @ (moved.modulus * moved.error)
    )
    return terms.sum(axis=1), float(missing)
