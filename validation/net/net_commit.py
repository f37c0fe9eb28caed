"""The files of the commit that the net compares with."""

from __future__ import annotations

import io
import subprocess
import sys
import tarfile
from pathlib import Path

#: Every comparison is with this commit, so that small losses do not add up.
COMMIT = "1534185287957ff4abdeca3ccefcf474e4770f6b"
REPOSITORY = Path(__file__).parents[2]


def checked_out(folder: Path) -> Path:
    """Put the commit's files into a folder, and return it."""
    run = subprocess.run(
        ["git", "archive", COMMIT], cwd=REPOSITORY, capture_output=True, check=False
    )
    if run.returncode:
        sys.exit(f"no commit {COMMIT[:7]} in this clone: {run.stderr.decode().strip()}")
    with tarfile.open(fileobj=io.BytesIO(run.stdout)) as files:
        files.extractall(folder, filter="data")
    return folder
