"""``spectral-contact inside``."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from spectral_contact import Scene, plotting, solve
from spectral_contact.equations.interior.grids import QUANTITIES, SUFFIXES
from spectral_contact.io.checks import tolerance
from spectral_contact.io.columns import Expected, NumberTable
from spectral_contact.view.cli.files import Reading
from spectral_contact.view.cli.options import Number, Picture, UsageError, Values, chosen, written
from spectral_contact.view.cli.scene_options import SceneOptions
from spectral_contact.view.report import report_inside


def run(
    scene: SceneOptions,
    reading: Reading,
    *,
    r: Values | None = None,
    z: Values | None = None,
    points: str | None = None,
    punch: bool = False,
    rtol: Number = 1e-8,
    quantity: Annotated[str, chosen(*QUANTITIES)] = "von_mises",
    output: Annotated[str | None, written(*SUFFIXES)] = None,
    plot: Picture | None = None,
) -> None:
    r"""Stress and displacement inside the body.

    Solve one scene; print the largest stresses and the energies, store and plot stress and
    displacement below the surface. Exit status: 0 done, 1 tolerance not met, 2 bad input or file,
    130 interrupted.

    Parameters
    ----------
    r : VALUES
        Distances from the axis, of a grid: numbers (0.1,0.2) or LOW:HIGH:COUNT, in contact radii,
        or in m for a scene in SI units; by default 0 to two radii.
    z : VALUES
        Depths of the grid, in the same form and units; by default 0 to two radii.
    points : FILE
        Instead of a grid: a text file with columns r and z, in the units above or those of its
        headings.
    punch : flag
        Points in an elastic punch, depths counted into it.
    rtol : X
        Bound on relative errors.
    quantity : NAME
        Quantity to plot.
    output : FILE
        Store all quantities at the points.
    plot : FILE
        Plot contours (needs the extra: plot).

    Examples
    --------
    spectral-contact inside --poisson-ratio 0.3 --normal-compliance 0.5 --plot body.png \
        --output body.csv
    """
    tolerance(rtol)
    contact = scene.build().scene
    _check_bodies(contact, punch=punch)
    table = _points(points, reading, "" if contact.physical is None else "m")
    _check_places(points, output, grid=bool(r or z))
    solution = solve(contact, min(rtol, 1e-10))
    shown = solution if contact.physical is None else solution.physical
    body = solution.physical.punch_inside if punch else shown.inside
    if output is not None:
        if table is None:
            default = np.linspace(0.0, 2.0 * body.radius, 81)
            radii, depths = np.meshgrid(r or default, z or default, sparse=True)
        else:
            radii, depths = table.values["r"], table.values["z"]
        body.save(output, radii, depths, rtol=rtol)
    if plot:
        plotting.save(plotting.plot_inside(body, quantity), plot)
    print(*([] if table is None else [table]), repr(solution), report_inside(body), sep="\n")


def _points(path: str | None, reading: Reading, unit: str) -> NumberTable | None:
    """Return the radii and depths of a file, None without one."""
    if path is not None:
        return reading.read(path, [Expected(name, unit, at_least=0.0) for name in ("r", "z")])
    if reading != Reading():
        raise UsageError("--columns, --header, --decimal and --skip-invalid need --points, a file")
    return None


def _check_places(points: str | None, output: str | None, *, grid: bool) -> None:
    """Refuse, before the work, places that are given twice, or of which nothing is stored."""
    if points is not None and (grid or (output or "").lower().endswith(".nc")):
        raise UsageError("--points is instead of a grid: of --r and --z, and not for a .nc file")
    if output is None and (grid or points is not None):
        raise UsageError("--r, --z and --points need --output, the file of the values there")


def _check_bodies(contact: Scene, *, punch: bool) -> None:
    """Refuse, before the work, bodies of unknown materials, and points in a rigid punch."""
    if contact.poisson_ratio is None:
        told = "stress inside takes --poisson-ratio of the half-space, and --youngs-modulus"
        raise UsageError(f"--reduced-modulus and --kappa do not tell the bodies apart: {told}")
    if punch and (contact.physical is None or contact.physical.punch_youngs_modulus is None):
        needed = "--punch-youngs-modulus and --punch-poisson-ratio"
        raise UsageError(f"--punch goes with {needed}: without them the punch is rigid")
