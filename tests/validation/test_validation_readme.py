"""validation/README.md names every script, and whoever cites a script cites one that is there."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "validation" / "README.md").read_text(encoding="utf-8")
SCRIPTS = [
    path
    for path in sorted((ROOT / "validation").rglob("*.py"))
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
]
CITING = [
    *(ROOT / "docs").glob("*.md"),
    *(ROOT / "spectral_contact").rglob("*.py"),
    *(ROOT / "tests").rglob("*.py"),
    *(ROOT / "validation").rglob("*.py"),
    *(ROOT / "validation").rglob("*.md"),
    ROOT / "README.md",
    ROOT / "tests" / "README.md",
]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_every_script_is_in_the_table(script):
    assert re.search(rf"\b{re.escape(script.name)}\b", README)


def cited(pattern):
    return {
        (path.name, found)
        for path in CITING
        for found in re.findall(pattern, path.read_text(encoding="utf-8"))
    }


def test_scripts_that_are_cited_are_there():
    scripts = cited(r"(?<!tests/)\bvalidation/(?:\w+/)*\w+\.(?:py|toml)\b")
    assert len(scripts) > 100
    assert [one for one in scripts if not (ROOT / one[1]).exists()] == []


def test_strata_that_are_cited_are_there():
    table = (ROOT / "validation" / "honesty" / "strata.toml").read_text(encoding="utf-8")
    strata = tomllib.loads(table)
    commands = cited(r"python validation/honesty/honesty\.py ([a-z]\w*)")
    assert len(commands) > 8
    assert [one for one in commands if one[1] not in strata] == []
