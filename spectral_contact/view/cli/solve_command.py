"""``spectral-contact solve``."""

from __future__ import annotations

from typing import Annotated

from spectral_contact import plan, plotting, solve
from spectral_contact.quantities import FIELDS, QUANTITIES
from spectral_contact.solution import GROWTH, StepState
from spectral_contact.view.cli import options
from spectral_contact.view.cli.options import UsageError
from spectral_contact.view.cli.scene_options import SceneOptions
from spectral_contact.view.report import report


def run(
    scene: SceneOptions,
    *,
    rtol: options.Number = 1e-10,
    quantities: Annotated[list[str] | None, options.several(options.names, *QUANTITIES)] = None,
    max_unknowns: options.Whole = 20_000,
    no_strict: bool = False,
    output: Annotated[str | None, options.written(".json", ".csv", ".npz")] = None,
    plot: options.Picture | None = None,
    history: Annotated[str | None, options.written(".csv")] = None,
) -> None:
    r"""Solve one scene.

    Print quantities, error estimates, zones, plan and work. Exit status: 0 solved, 1 tolerance not
    met, 2 bad input or file, 130 interrupted.

    Parameters
    ----------
    rtol : X
        Bound on relative errors, 1e-13 to 1e-2.
    quantities : NAME
        What to compute; by default all that the scene has but reverse_ratio and turning_ratio,
        which exist below the largest load. Under a profile also contact_radius, load, stiffness
        and indentation_work, with adhesion stiffness_on_branch; in general.
    max_unknowns : N
        Largest number of unknowns of one linear system.
    no_strict : flag
        If the tolerance cannot be met, print what was reached and exit with 0.
    output : FILE
        Store the solution, exactly or, in a .csv file, as a table of the fields.
    plot : FILE
        Plot the solution (needs the extra: plot).
    history : FILE
        Store load, approach, shear and stick radius as the contact grows, one row for each contact
        radius.

    Examples
    --------
    spectral-contact solve --poisson-ratio 0.3 --normal-compliance 0.05 \
        --tangential-compliance 1 --friction 0.03
    spectral-contact solve --youngs-modulus 210e9 --poisson-ratio 0.3 --radius 5e-3 --load 1000 \
        --normal-compliance-si 5e-14 --friction 0.05 --plot punch.png
    spectral-contact solve --profile sphere --radius 1 --load 0.1 --normal-compliance 0.01
    """
    contact, remarks = scene.build()
    # SI values need the load; if the approach is given, that is computed from `approach`
    if quantities is not None and contact.profile is None and scene.given.get("approach"):
        quantities = ["approach", *quantities]
    todo = plan(contact, quantities)
    is_table = output is not None and output.lower().endswith(".csv")
    if is_table and not set(FIELDS).intersection(todo.quantities):
        raise UsageError(f"a .csv file is a table of {', '.join(FIELDS)}: ask for one")
    if plot:
        plotting.check(todo)
    grows = any(one.name == GROWTH and one.state is StepState.RUN for one in todo.steps)
    if history is not None and not grows:
        raise UsageError(f"--history {history} needs a contact that grows: --profile, --friction")
    solution = solve(contact, rtol, quantities, max_unknowns=max_unknowns, strict=not no_strict)
    try:
        if output is not None:
            solution.to_csv(output) if is_table else solution.save(output)
        if plot:
            plotting.save(solution.plot(), plot)
        if history is not None:
            solution.history.to_csv(history)
    finally:  # a full disk must not cost the user the result
        print(report(solution, remarks))
