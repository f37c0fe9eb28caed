"""Balance of energy: work of the load, energy of body and layer, friction, and a defect."""

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

#: Rings whose load is below this fraction of the sum of all are left out: they change no digit.
_NEGLIGIBLE = 1e-17
#: Number of portions of the rings, after each of which progress is reported.
_PORTIONS = 10


def energies(
    solution: Solution, mesh: BodyMesh, move: Move, unit: float, tell: ProgressLine
) -> Energies:
    """Return the energies of a solution.

    Under a flat punch the state is proportional to the load, and each energy is half of the final
    tractions times the final displacements. Once the load has fallen this is so only if nothing has
    slipped. Under a profile the state is not proportional to the load. Without friction body and
    layer still store these halves, and their sum is the work of the load. With friction the
    energies depend on the history, and are refused.

    Parameters
    ----------
    solution : Solution
        With approach, pressure, traction and slip.
    mesh : BodyMesh
        Panels to integrate over.
    move : callable
        Dimensionless displacements of the body at points.
    unit : float
        Factor of all energies into the units that are asked for, from those of a flat punch, or
        under a profile from E' L**3 times the square of the contact radius.
    tell : ProgressLine
        Shows the progress.
    """
    if solution.scene.unloaded_to < 1.0 and _slipped(solution):
        reason = "below the largest load, after slip, they are no functions of the state"
        raise NotComputedError("energies", reason)
    external, external_error = _external(solution)
    adhesion, scale = _adhesion(solution, external)
    parts, parts_error = _parts(solution, mesh, move, tell)
    error = parts_error + abs(external - adhesion - parts.sum()) + external_error * scale
    error += (solution.error.slip or 0.0) * abs(parts[2])
    strain, layer, friction, defect = (float(part) * unit for part in parts)
    return Energies(
        external=external * unit,
        strain=strain,
        layer=layer,
        friction=friction,
        defect=defect,
        error=float(error / scale) if scale else 0.0,
        surface=adhesion * unit,
    )


def _slipped(solution: Solution) -> bool:
    """Return whether the surface slips, or has slipped at a larger load."""
    if solution.traction_field is None:
        return False
    return any(zone.kind == "slip" or zone.memory for zone in solution.zones)


def _external(solution: Solution) -> tuple[float, float]:
    """Return the work of the load over the square of the contact radius, and its relative error."""
    if solution.scene.profile is None:
        load = solution.scene.unloaded_to  # over the largest load
        return load * solution.approach / 2.0, solution.error.approach or 0.0
    if solution.traction_field is not None:
        reason = "the energy that friction dissipates in a growing contact depends on its history"
        raise NotComputedError("energies", reason)
    work = solution.indentation_work / solution.contact_radius**2
    return work, solution.error.indentation_work or 0.0


def _adhesion(solution: Solution, external: float) -> tuple[float, float]:
    """Return the energy of the surfaces in contact, and the energy that errors are relative to.

    Both are over the square of the contact radius. The energy is 0 before the contact begins, and
    minus the work of adhesion times the area after. A flat punch is in contact at any load, so that
    the energy of its surfaces does not change with the load: 0.
    """
    scene = solution.scene
    if scene.work_of_adhesion is None or isinstance(scene.profile, Flat):
        return 0.0, external
    scale = solution.error_scales["indentation_work"] / solution.contact_radius**2
    return -np.pi * scene.work_of_adhesion, scale


def _parts(
    solution: Solution, mesh: BodyMesh, move: Move, tell: ProgressLine
) -> tuple[Array, float]:
    """Return strain energy, energy of the layer, friction and defect, and the error of the sum."""
    points, rings = mesh.surface
    loads = rings[:2]  # pressure and traction
    load_inside = mesh.carried()
    moduli = np.abs(loads).sum(axis=0)
    needed = np.flatnonzero(moduli > _NEGLIGIBLE * moduli.sum())
    parts = np.zeros(4)
    error = 0.0
    for k, portion in enumerate(np.array_split(needed, _PORTIONS)):
        tell("energies", k / _PORTIONS)
        added = _parts_of_rings(
            solution, points[portion], loads[:, portion], load_inside[portion], move
        )
        parts = parts + added[0]
        error = error + added[1]
    tell("energies", 1.0)
    return parts, error


def _parts_of_rings(
    solution: Solution, points: BodyPoints, loads: Array, load_inside: Array, move: Move
) -> tuple[Array, float]:
    """Return the contribution of some rings to the parts, and to the error of their sum.

    Parameters
    ----------
    solution : Solution
    points : BodyPoints
        The rings, as points of the surface.
    loads : ndarray, shape (2, rings)
        Loads of the rings, ``p s ds`` and ``q s ds``.
    load_inside : ndarray, shape (rings,)
        The integral of ``p s ds`` within each ring.
    move : callable
    """
    scene = solution.scene
    error = solution.error
    normal_load, shear_load = loads
    displacement = move(points)
    p = solution.pressure(from_edge=points.from_edge)
    q = solution.traction(from_edge=points.from_edge)
    sheared = solution.traction_field is not None
    slip = solution.slip(from_edge=points.from_edge) if sheared else 0.0
    strain = normal_load * displacement.z + shear_load * displacement.r
    layer = np.zeros_like(strain)
    if scene.normal_compliance > 0.0:  # else p may be infinite
        layer += scene.normal_compliance * p * normal_load
    if scene.tangential_compliance > 0.0:
        layer += scene.tangential_compliance * q * shear_load
    friction = -shear_load * slip  # the slip, positive outward, opposes the traction
    defect = np.zeros_like(strain)
    if not scene.couples:
        defect = scene.kappa * shear_load * load_inside / points.r
    # half of 2 pi, the s ds being in the loads
    parts = np.pi * np.stack([strain, layer, friction, defect])
    # each part has two factors, which are as wrong as the loads
    load_errors = 2.0 * ((error.pressure or 0.0) + (error.traction or 0.0)) * np.abs(parts).sum()
    displacement_error = displacement.modulus * displacement.error
    moduli = np.abs(normal_load) + np.abs(shear_load)
    return parts.sum(axis=1), float(load_errors + np.pi * (moduli @ displacement_error))
