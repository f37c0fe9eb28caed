"""README.md leads somewhere, CITATION.cff cites this version, and install hints work in a clone."""

import re
import tomllib
from pathlib import Path

import spectral_contact

ROOT = Path(__file__).parents[2]


def heading_anchors(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w -]", "", one.lower()).replace(" ", "-") for one in headings}


def test_links_of_the_readme_lead_somewhere():
    links = re.findall(r"\]\(([^)]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(links) > 10
    for link in links:
        path, _, anchor = link.partition("#")
        assert (ROOT / path).is_file(), link
        assert not anchor or anchor in heading_anchors(ROOT / path), link


def test_the_version_to_cite_is_this_one():
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {spectral_contact.__version__}" in lines


def test_install_hints_name_extras_of_a_clone():
    # the library is on no package index: only "." of a clone can be installed
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = set(project["optional-dependencies"])
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("spectral_contact/**/*.py")]
    named = set()
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"pip install \"?spectral[_-]contact", text), page
        for several in re.findall(r"pip install (?:-e )?\"?\.\[([\w,]+)\]", text):
            assert extras.issuperset(several.split(",")), (page, several)
            named.update(several.split(","))
    assert {"plot", "sweep", "units"} <= named


def test_the_changelog_has_versions_with_dates_and_few_lines():
    text = (ROOT / "docs" / "changelog.md").read_text(encoding="utf-8")
    sections = re.split(r"^## ", text, flags=re.M)[1:]
    for section in sections:
        heading, *lines = section.splitlines()
        assert re.fullmatch(r"\d+\.\d+\.\d+ \((unreleased|\d{4}-\d\d-\d\d)\)", heading)
        assert sum(bool(line.strip()) for line in lines) <= 40, heading
    assert any(section.startswith(spectral_contact.__version__) for section in sections)
