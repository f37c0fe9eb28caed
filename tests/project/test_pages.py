"""What Sphinx and a browser need of a page, and no build of the site complains about."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
NOTEBOOKS = [page for page in PAGES if "{code-cell}" in page.read_text(encoding="utf-8")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_numbered_formula_ends_its_rows_with_cr(page):
    # Sphinx puts a formula with \\ in a split environment, in which MathJax allows no \tag
    formulas = re.findall(r"^\$\$\n(.*?)^\$\$", page.read_text(encoding="utf-8"), re.S | re.M)
    assert [one for one in formulas if r"\tag" in one and r"\\" in one] == []


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_every_picture_of_a_notebook_has_a_text(page):
    cells = re.findall(
        r"^```\{code-cell\}.*?\n(.*?)^```", page.read_text(encoding="utf-8"), re.S | re.M
    )
    drawing = [cell for cell in cells if re.search(r"plt\.subplots|\.plot\(|\.plot_", cell)]
    assert drawing
    assert [cell for cell in drawing if "alt: " not in cell] == []
