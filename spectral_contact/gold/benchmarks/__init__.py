"""Ten benchmark problems to test other codes against, as data: statement, numbers, fields.

The files are in ``data``, written by validation/make_benchmarks.py; docs/benchmarks_to_cite shows
them, a page each. Nothing here knows the solver: the folder can be copied into another project.
"""

from .benchmark_loader import (
    VERSION,
    Benchmark,
    CheckNumber,
    Recipe,
    Stiffness,
    export,
    load,
    names,
)

__all__ = ["VERSION", "Benchmark", "CheckNumber", "Recipe", "Stiffness", "export", "load", "names"]
