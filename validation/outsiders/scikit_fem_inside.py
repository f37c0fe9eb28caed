"""Stress and displacement in the body against scikit-fem: finite meshes without truncation error.

Axisymmetric quadratic elements. On the far sides of the mesh the half-space's own displacements
are prescribed, so that nothing is lost by cutting it off. Two problems: a block below the surface,
all of whose sides are prescribed, where the rates of the elements are seen; and a block under the
contact, loaded by pressure and traction, with a mesh that is graded to the edge and to the boundary
of stick and slip. Errors are norms over the mesh. Writes validation/results/scikit_fem_inside.md.
"""

from pathlib import Path

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, sym_grad, trace

from spectral_contact import Scene, solve

NU, SIDE, DEPTH = 0.2, 2.0, 0.25
SHEAR = 2.0 * (1.0 - NU)  # E = 4 (1 - nu^2)
LAME = 2.0 * SHEAR * NU / (1.0 - 2.0 * NU)
SOLUTION = solve(Scene(NU, 0.2, 0.2, 0.1, coupling=True), rtol=1e-11)
BODY = SOLUTION.inside
RESULTS = Path(__file__).parents[1] / "results"


@skfem.BilinearForm
def work(u, v, w):
    """Return the virtual work per angle, over 2 pi."""
    r = w.x[0]
    strain, other, hoop, virtual = sym_grad(u), sym_grad(v), u[0] / r, v[0] / r
    volume = (trace(strain) + hoop) * (trace(other) + virtual)
    return (2.0 * SHEAR * (ddot(strain, other) + hoop * virtual) + LAME * volume) * r


@skfem.LinearForm
def load(v, w):
    """Return the virtual work of pressure and traction, over 2 pi."""
    s = w.x[0]
    return (SOLUTION.pressure(s) * v[1] + SOLUTION.traction(s) * v[0]) * s


def errors(r_lines, z_lines):
    """Return unknowns and relative errors of displacement and stress on a tensor mesh."""
    mesh = skfem.MeshQuad.init_tensor(r_lines, z_lines)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=5)
    matrix = work.assemble(basis).tocsr()
    r, z = basis.doflocs
    axial = np.zeros(basis.N, bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        axial[dofs[1::2].ravel()] = True
    own = (r == r_lines[-1]) | (z == z_lines[-1]) | ((z == z_lines[0]) & (z > 0.0))
    given, force = np.zeros(basis.N), np.zeros(basis.N)
    moved = BODY.displacement(r[own], z[own])  # this is the table for another code
    given[own] = np.where(axial[own], moved.z, moved.r)
    if z_lines[0] == 0.0:
        contact = mesh.facets_satisfying(lambda x: (x[1] == 0.0) & (x[0] < 1.0))
        facets = skfem.FacetBasis(mesh, basis.elem, facets=contact, intorder=9)
        force = load.assemble(facets)
    free = np.flatnonzero(~(own | ((r == 0.0) & ~axial)))
    inner = matrix[free]
    factor = splu(inner[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0)
    given[free] = factor.solve(force[free] - inner @ given)
    return basis.N, *_norms(basis, given)


def _norms(basis, found):
    """Return the errors of displacement and stress over their norms, at the Gauss points."""
    r, z = basis.global_coordinates()
    weight = basis.dx * r
    u = basis.interpolate(found)
    gradient, hoop = u.grad, u[0] / r
    volume = LAME * (gradient[0, 0] + gradient[1, 1] + hoop)
    stress = {
        "rr": volume + 2.0 * SHEAR * gradient[0, 0],
        "tt": volume + 2.0 * SHEAR * hoop,
        "zz": volume + 2.0 * SHEAR * gradient[1, 1],
        "rz": SHEAR * (gradient[0, 1] + gradient[1, 0]),
    }
    shift = BODY.displacement(r, z, rtol=1e-9)
    exact = BODY.stress(r, z, rtol=1e-9)
    apart = (u[0] - shift.r) ** 2 + (u[1] - shift.z) ** 2
    off = sum((one - getattr(exact, k)) ** 2 * (1 + (k == "rz")) for k, one in stress.items())
    return tuple(
        float(np.sqrt((weight * error).sum() / (weight * size**2).sum()))
        for error, size in ((apart, shift.modulus), (off, exact.norm))
    )


def block(count):
    """Return the lines of a mesh below the surface."""
    lines = np.linspace(0.0, SIDE, count + 1)
    return lines, DEPTH + lines


def contact(count):
    """Return the lines of a mesh under the contact, graded to its singular points."""
    c = SOLUTION.stick_radius
    steps = np.linspace(0.0, 1.0, count + 1)[1:] ** 2
    parts = [[0.0, c, 1.0, SIDE]]
    parts += [c - c / 2 * steps, c + (1 - c) / 2 * steps, 1 - (1 - c) / 2 * steps, 1 + steps]
    parts.append(np.linspace(0.0, c / 2, count // 2 + 1))
    r = np.unique(np.round(np.concatenate(parts), 14))
    return r, SIDE * np.concatenate([[0.0], steps])


def main():
    """Print and write the errors and their rates."""
    lines = [
        "| problem | unknowns | error of displacement | rate | error of stress | rate |",
        "|---|---|---|---|---|---|",
    ]
    for name, mesh in (("block below the surface", block), ("block under the contact", contact)):
        before = None
        for count in (4, 8, 16, 32):
            size, *now = errors(*mesh(count))
            rates = ["", ""]
            if before is not None:
                rates = [f"{np.log2(a / b):.2f}" for a, b in zip(before, now, strict=True)]
            cells = f"{now[0]:.2e} | {rates[0]} | {now[1]:.2e} | {rates[1]}"
            lines.append(f"| {name} | {size} | {cells} |")
            print(lines[-1], flush=True)
            before = now
    text = "\n".join(lines) + "\n"
    (RESULTS / "scikit_fem_inside.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
