"""Gold tables: scenes solved to 25 certified digits and more, to test any solver against."""

from spectral_contact.gold.loader import (
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
