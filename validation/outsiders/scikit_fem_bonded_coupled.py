"""The benchmark bonded_coupled with scikit-fem, from its page alone.

Axisymmetric quadratic elements, graded geometrically to the edge, in a cylinder of 100 radii. The
displacement of a unit point force is prescribed on its far sides: superposed with a unit approach
of the punch, it gives an approach for the load 1.
"""

import time

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, sym_grad, trace

NU, CHECK, FAR = 0.1, 1.0749503756558658, 100.0  # the first two are of the page
SHEAR = 2.0 * (1.0 - NU)  # E = 4 (1 - nu^2)
LAME = 2.0 * SHEAR * NU / (1.0 - 2.0 * NU)


def point_force(r, z):
    """Return the radial and the axial displacement of Boussinesq's unit point force."""
    d = np.hypot(r, z)
    radial = r * z / d**3 - (1.0 - 2.0 * NU) * r / (d * (d + z))
    axial = 2.0 * (1.0 - NU) / d + z**2 / d**3
    return radial / (4.0 * np.pi * SHEAR), axial / (4.0 * np.pi * SHEAR)


@skfem.BilinearForm
def work(u, v, w):
    """Return the virtual work per angle; the edge is at x = 0."""
    r = 1.0 + w.x[0]
    strain, other, hoop, virtual = sym_grad(u), sym_grad(v), u[0] / r, v[0] / r
    volume = (trace(strain) + hoop) * (trace(other) + virtual)
    return (2.0 * SHEAR * (ddot(strain, other) + hoop * virtual) + LAME * volume) * r


def stiffness_ratio(count):
    """Return k/k0 = 1/(8 delta) with so many elements per radius."""
    near = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, count)])
    away = np.concatenate([near, np.geomspace(1.0, FAR, count)[1:]])
    mesh = skfem.MeshQuad.init_tensor(np.concatenate([-near[:0:-1], away]), away)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=5)
    matrix = work.assemble(basis).tocsr()
    x, z = basis.doflocs
    axial = np.zeros(basis.N, bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        axial[dofs[1::2].ravel()] = True
    punch = (z == 0.0) & (x <= 0.0)
    far = (x == FAR) | (z == FAR)
    fixed = punch | far | ((x == -1.0) & ~axial)
    given = np.zeros((basis.N, 2))
    given[punch & axial, 0] = 1.0
    radial, down = point_force(1.0 + x[far], z[far])
    given[far, 1] = np.where(axial[far], down, radial)
    free = np.flatnonzero(~fixed)
    inner = matrix[free]
    factor = splu(inner[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0)
    given[free] = factor.solve(-(inner @ given))
    loads = 2.0 * np.pi * (matrix @ given)[punch & axial].sum(axis=0)
    return 1.0 / (8.0 * (1.0 - loads[1]) / loads[0])


for count in (8, 16, 24, 32):
    start = time.perf_counter()
    found = stiffness_ratio(count)
    seconds = time.perf_counter() - start
    print(f"{count:4d} elements: {found:.7f}, error {abs(found / CHECK - 1):.1e}, {seconds:.1f} s")
