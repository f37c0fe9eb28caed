"""The baseline: the commit that the net compares with, and what its library made of every scene."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

REPOSITORY = Path(__file__).parents[2]
FILE = Path(__file__).parent / "before.json"

Records = dict[str, dict[str, dict[str, Any]]]


def load() -> tuple[str, Records]:
    """Return the commit, and what became of every scene there, by section and name."""
    document = json.loads(FILE.read_text(encoding="utf-8"))
    return document["commit"], document["before"]


def save(commit: str, before: Records) -> None:
    """Store the records of a commit, one scene a line."""
    sections = [
        f"{json.dumps(section)}: {{\n"
        + ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
        + "\n}"
        for section, rows in before.items()
    ]
    inner = ",\n".join(sections)
    text = f'{{\n"commit": {json.dumps(commit)},\n"before": {{\n{inner}\n}}\n}}\n'
    FILE.write_text(text, encoding="utf-8")


def git(*arguments: str) -> bytes:
    """Return what a command of git prints; without the commit it names, the process ends."""
    run = subprocess.run(["git", *arguments], cwd=REPOSITORY, capture_output=True, check=False)
    if run.returncode:
        sys.exit(f"git {' '.join(arguments)}: {run.stderr.decode().strip()}")
    return run.stdout


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """Yield a folder with the files of a commit."""
    with TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(git("archive", commit))) as files:
            files.extractall(folder, filter="data")
        yield Path(folder)
