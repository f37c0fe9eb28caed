"""What the times of a study hang on: the machine and the versions."""

from __future__ import annotations

import os
import platform
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine and the versions on it.

    Attributes
    ----------
    processor : str
        Its model.
    cores : int
        As many as the system has, not as many as are used.
    system : str
        Operating system and architecture.
    python, numpy, scipy, library : str
        Versions; `library` is that of spectral_contact.
    blas : str
        Name and version of the BLAS of NumPy.
    """

    processor: str
    cores: int
    system: str
    python: str
    numpy: str
    scipy: str
    library: str
    blas: str

    def __str__(self) -> str:
        return (
            f"{self.processor}, {self.cores} cores, {self.system}; Python {self.python}, "
            f"numpy {self.numpy} ({self.blas}), scipy {self.scipy}, spectral_contact {self.library}"
        )


def this_machine() -> Machine:
    """Return the machine that runs this."""
    import scipy

    return Machine(
        _processor(),
        os.cpu_count() or 1,
        f"{platform.system()} {platform.machine()}",
        platform.python_version(),
        np.__version__,
        scipy.__version__,
        sys.modules["spectral_contact"].__version__,
        _blas(),
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:  # no Linux
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def _blas() -> str:
    config: Any = np.show_config(mode="dicts")
    found = config.get("Build Dependencies", {}).get("blas", {})
    return f"{found.get('name', 'unknown BLAS')} {found.get('version', '')}".strip()
