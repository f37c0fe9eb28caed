"""Reference solutions for the rough frictional contact of a rigid flat punch.

Quick start
-----------
>>> from spectral_contact import Scene, solve
>>> scene = Scene(poisson_ratio=0.1, normal_compliance=0.5)
>>> print(f"{solve(scene, rtol=1e-12).approach:.12f}")
0.292959796910
"""

from spectral_contact import processes

processes.quiet_imports()  # before what takes a second to import

from spectral_contact.errors import (
    ConvergenceError,
    MissingDependencyError,
    NotComputedError,
    SceneError,
    SolutionFileError,
    SpectralContactError,
)
from spectral_contact.planning import plan
from spectral_contact.scene import PhysicalData, Scene
from spectral_contact.solution import (
    QUANTITIES,
    Ending,
    ErrorEstimates,
    PhysicalSolution,
    Plan,
    PlannedStep,
    Solution,
    StepState,
    Work,
    Zone,
)
from spectral_contact.solver import solve
from spectral_contact.spectral.cache import cache_sizes, clear_caches

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
    "StepState",
    "Work",
    "Zone",
    "cache_sizes",
    "clear_caches",
    "plan",
    "solve",
]
__version__ = "0.1.0"
