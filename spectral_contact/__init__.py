"""Reference solutions for a rigid punch on a rough elastic half-space with friction.

Quick start
-----------
>>> from spectral_contact import Scene, solve
>>> scene = Scene(poisson_ratio=0.1, normal_compliance=0.5)
>>> print(f"{solve(scene, rtol=1e-12).approach:.12f}")
0.292959796910
"""

import sys
from typing import TYPE_CHECKING, Any

from spectral_contact import processes

processes.quiet_imports()  # before what takes a second to import

from spectral_contact import layers, profiles
from spectral_contact.errors import (
    ConvergenceError,
    MissingDependencyError,
    NotComputedError,
    SceneError,
    SolutionFileError,
    SpectralContactError,
)
from spectral_contact.scene import PhysicalData, Scene
from spectral_contact.solution import (
    QUANTITIES,
    Ending,
    ErrorEstimates,
    Plan,
    PlannedStep,
    Solution,
    StepState,
    Work,
    Zone,
)
from spectral_contact.solving.planning import plan
from spectral_contact.solving.solver import solve
from spectral_contact.spectral.cache import cache_sizes, clear_caches

if TYPE_CHECKING:
    from spectral_contact import asperities as asperities
    from spectral_contact import calibration as calibration
    from spectral_contact import closed_forms as closed_forms
    from spectral_contact import gold as gold
    from spectral_contact import precise as precise
    from spectral_contact import studies as studies
    from spectral_contact import testing as testing
    from spectral_contact.calibration import fit as fit
    from spectral_contact.gold import benchmarks as benchmarks
    from spectral_contact.precise import proof as proof
    from spectral_contact.precise.reference import reference as reference
    from spectral_contact.solving.pull_off import adhesion_cycle as adhesion_cycle
    from spectral_contact.solving.pull_off import pull_off as pull_off
    from spectral_contact.studies import compare as compare
    from spectral_contact.sweeps import sweep as sweep
    from spectral_contact.sweeps.cycle_result import SteadyCycle as SteadyCycle
    from spectral_contact.sweeps.damping import damping_map as damping_map
    from spectral_contact.sweeps.steady_cycle import steady_cycle as steady_cycle
    from spectral_contact.view import plotting as plotting
    from spectral_contact.view.explorer import explore as explore
    from spectral_contact.view.physical_solution import PhysicalSolution as PhysicalSolution

__all__ = [
    "QUANTITIES",
    "ConvergenceError",
    "Ending",
    "ErrorEstimates",
    "MissingDependencyError",
    "NotComputedError",
    "PhysicalData",
    "PhysicalSolution",
    "Plan",
    "PlannedStep",
    "Scene",
    "SceneError",
    "Solution",
    "SolutionFileError",
    "SpectralContactError",
    "SteadyCycle",
    "StepState",
    "Work",
    "Zone",
    "adhesion_cycle",
    "asperities",
    "benchmarks",
    "cache_sizes",
    "calibration",
    "clear_caches",
    "closed_forms",
    "compare",
    "damping_map",
    "explore",
    "fit",
    "gold",
    "layers",
    "plan",
    "plotting",
    "precise",
    "profiles",
    "proof",
    "pull_off",
    "reference",
    "solve",
    "steady_cycle",
    "studies",
    "sweep",
    "testing",
]
__version__ = processes.VERSION

#: What is loaded when it is used: the module, and the name in it unless it is meant itself.
_LAZY: dict[str, tuple[str, str | None]] = {
    **{name: (name, None) for name in ("asperities", "calibration", "closed_forms")},
    **{name: (name, None) for name in ("gold", "precise", "studies", "testing")},
    "benchmarks": ("gold.benchmarks", None),
    "PhysicalSolution": ("view.physical_solution", "PhysicalSolution"),
    "SteadyCycle": ("sweeps.cycle_result", "SteadyCycle"),
    "adhesion_cycle": ("solving.pull_off", "adhesion_cycle"),
    "compare": ("studies", "compare"),
    "damping_map": ("sweeps.damping", "damping_map"),
    "explore": ("view.explorer", "explore"),
    "fit": ("calibration", "fit"),
    "plotting": ("view.plotting", None),
    "proof": ("precise.proof", None),
    "pull_off": ("solving.pull_off", "pull_off"),
    "reference": ("precise", "reference"),
    "steady_cycle": ("sweeps.steady_cycle", "steady_cycle"),
    "sweep": ("sweeps", "sweep"),
}


def __getattr__(name: str) -> Any:
    """Load what is not loaded yet."""
    if name not in _LAZY:
        told = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(told, name=name, obj=sys.modules[__name__])
    from importlib import import_module

    module, inner = _LAZY[name]
    found = import_module(f"{__name__}.{module}")
    globals()[name] = found = found if inner is None else getattr(found, inner)
    return found


def __dir__() -> list[str]:
    """Return the public names."""
    return [*__all__, "__version__"]
