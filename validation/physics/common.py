"""What the studies of this folder take from validation/reporting.py, and from tests/."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2]))

from reporting import DOCS, RESULTS, options, picture, table, write

__all__ = ["DOCS", "RESULTS", "options", "picture", "table", "write"]
