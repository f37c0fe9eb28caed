"""Numbers to test any solver against: gold tables here, `benchmarks` to cite beside them.

Gold tables are scenes solved to 25 certified digits and more, and to 18 in the first unloading.
``gold["slip_unequal"]`` is ``gold.table("slip_unequal")``.
"""

import sys
from types import ModuleType

from spectral_contact.gold.table_loader import (
    GoldPoint,
    GoldSolution,
    GoldTable,
    find,
    load,
    names,
    table,
    tables,
)

__all__ = ["GoldPoint", "GoldSolution", "GoldTable", "find", "load", "names", "table", "tables"]


class _Tables(ModuleType):
    """The module, in which a table is found by its name."""

    def __getitem__(self, name: str) -> GoldTable:
        return table(name)


sys.modules[__name__].__class__ = _Tables
