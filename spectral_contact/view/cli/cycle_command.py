"""``spectral-contact cycle``."""

from __future__ import annotations

from typing import Annotated

from spectral_contact import plotting, steady_cycle
from spectral_contact.view.cli.options import Number, Picture, Whole, written
from spectral_contact.view.cli.scene_options import SceneOptions


def run(
    scene: SceneOptions,
    *,
    lowest: Number,
    rtol: Number = 1e-8,
    max_unknowns: Whole = 20_000,
    no_strict: bool = False,
    output: Annotated[str | None, written(".npz", ".json", ".csv")] = None,
    plot: Picture | None = None,
) -> None:
    r"""Find the steady loop of a load that cycles.

    The load on a flat punch cycles between the load of the scene and a lower one. Print what
    sticks, what slips how far, and the energy that friction dissipates in each cycle. Exit status:
    0 done, 1 tolerance not met, 2 bad input or file, 130 interrupted.

    Parameters
    ----------
    lowest : SHARE
        The lowest load over the largest one, which is that of the scene: between 0 and 1.
    rtol : X
        Bound on the relative error of what is dissipated, 1e-11 to 1e-2.
    max_unknowns : N
        Largest number of unknowns of one linear system.
    no_strict : flag
        If the tolerance cannot be met, print what was reached and exit with 0.
    output : FILE
        Store the cycle: .npz, .json; or slip amplitude and change of the traction over the radius:
        .csv.
    plot : FILE
        Plot the loop (needs the extra: plot).

    Examples
    --------
    spectral-contact cycle --poisson-ratio 0.1 --normal-compliance 0.5 \
        --tangential-compliance 0.5 --friction 0.1 --lowest 0.1
    spectral-contact cycle --youngs-modulus "210 GPa" --poisson-ratio 0.3 --radius "5 mm" \
        --load "5 kN" --normal-compliance-si 5e-15 --tangential-compliance-si 6e-15 \
        --friction 0.15 --lowest 0.2 --rtol 1e-4 --plot loop.png
    """
    contact, remarks = scene.build()
    cycle = steady_cycle(
        contact, lowest, rtol=rtol, max_unknowns=max_unknowns, strict=not no_strict
    )
    if output is not None:
        store = cycle.to_csv if output.lower().endswith(".csv") else cycle.save
        store(output)
    if plot:
        plotting.save(cycle.plot(), plot)
    print(cycle.summary(), *(f"remark: {one}" for one in remarks), sep="\n")
