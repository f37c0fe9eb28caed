"""The command line: ``spectral-contact solve``, ``inside``, ``cycle``, ``sweep``, ``explore`` ...

Also ``python -m spectral_contact``.

Exit status: 0 on success; 1 if the tolerance was not met, or no scene of several was solved; 2
for a bad option, value, file or missing dependency; 130 when interrupted, 143 when terminated. An
error is one line on stderr.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any, Final

from spectral_contact import ConvergenceError, SceneError, SpectralContactError
from spectral_contact.processes import PROGRAM, VERSION, failed, guarded
from spectral_contact.threads import one_thread
from spectral_contact.view.cli import (
    benchmark_command,
    compare_command,
    cycle_command,
    explore_command,
    fit_command,
    inside_command,
    solve_command,
    study_command,
    sweep_command,
)
from spectral_contact.view.cli.command import Parser, add_commands
from spectral_contact.view.cli.options import NotSolved, joined
from spectral_contact.view.cli.scene_options import SceneOptions

__all__ = ["COMMANDS", "main"]

#: The function that each command calls. Of a command of two words the second one is a command of
#: the group that the first one names.
COMMANDS: Final[dict[str, Callable[..., None]]] = {
    "solve": solve_command.run,
    "inside": inside_command.run,
    "cycle": cycle_command.run,
    "study convergence": study_command.run_convergence,
    "study work-precision": study_command.run_work_precision,
    "sweep": sweep_command.run,
    "fit": fit_command.run,
    "compare": compare_command.run,
    "benchmark list": benchmark_command.print_list,
    "benchmark show": benchmark_command.show,
    "benchmark export": benchmark_command.export,
    "explore": explore_command.run,
}
#: What each group of commands is about.
_ABOUT: Final = {
    "study": "Measure the errors and times of solvers, against solutions to many digits.",
    "benchmark": "Ten problems with numbers and fields to test other codes against.",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; by default those of the process.

    Returns
    -------
    int
        The exit status, see the module's description.
    """
    return guarded(lambda: _run(sys.argv[1:] if argv is None else argv))


def _run(argv: Sequence[str]) -> int:
    """Do what the arguments ask for, and return the exit status of it."""
    given: dict[str, Any] = {}
    try:
        given = vars(_parser().parse_args(joined(argv)))
        with one_thread():
            given["run"](given)
    except SystemExit as stop:  # argparse, after --help and --version
        return int(stop.code or 0)
    except ConvergenceError as error:
        hint = " (--no-strict prints what was reached)" if "no_strict" in given["options"] else ""
        return failed(f"{SceneOptions(given).worded(str(error))}{hint}", 1)
    except SceneError as error:
        return failed(SceneOptions(given).in_options(error), 2)
    except SpectralContactError as error:
        return failed(str(error), 1 if isinstance(error, NotSolved) else 2)
    return 0


def _parser() -> Parser:
    parser = Parser(
        prog=PROGRAM,
        description="Solve the contact of a rigid punch, flat or of any convex shape, with a rough "
        "elastic half-space under Coulomb friction. `spectral-contact COMMAND --help` begins with "
        "examples.",
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {VERSION}")
    add_commands(parser, COMMANDS, _ABOUT)
    return parser


if __name__ == "__main__":
    sys.exit(main())
