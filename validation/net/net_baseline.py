"""The baseline: the commit that the net compares with, and what its library made of the scenes."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

REPOSITORY = Path(__file__).parents[2]
FILE = Path(__file__).parent / "before.json"


@dataclass
class Baseline:
    """A commit, which of its solutions did not converge, and its estimates of hard cases.

    Of the scenes that commit c22aa78 does not know, nine are listed: loads below the largest one,
    at the tightest tolerance.
    """

    commit: str
    unconverged: dict[str, list[str]] = field(default_factory=dict)
    estimates: dict[str, dict[str, float]] = field(default_factory=dict)


def load() -> Baseline:
    """Return the baseline."""
    return Baseline(**json.loads(FILE.read_text(encoding="utf-8")))


def save(baseline: Baseline) -> None:
    """Store a baseline."""
    FILE.write_text(json.dumps(asdict(baseline), indent=1) + "\n", encoding="utf-8")


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
