"""What slow oracles say, kept in tests/data/truths, so that no run waits for them again.

``MAKE_TRUTHS=1 python -m pytest -n0 FILE`` asks the oracles of a test file for everything and keeps
it. Without, they are asked for a sample, and must say what they said.
"""

import atexit
import json
import os
from pathlib import Path
from zlib import crc32

from mpmath.ctx_mp import MPContext

FOLDER = Path(__file__).parents[1] / "data" / "truths"
MAKING = "MAKE_TRUTHS" in os.environ
mp = MPContext()
mp.dps = 40


def texts(value):
    """Return numbers, in lists of lists or none, with 30 digits."""
    if isinstance(value, (list, tuple)):
        return [texts(one) for one in value]
    return mp.nstr(mp.mpf(value), 30)


def numbers(value, kind):
    """Return texts as numbers of a kind."""
    return [numbers(one, kind) for one in value] if isinstance(value, list) else kind(value)


def flat(value):
    """Return the numbers of lists of lists."""
    if not isinstance(value, list):
        return [value]
    return [number for one in value for number in flat(one)]


class Kept:
    """The answers for one test file; one key in `every` is asked for again, always the same."""

    def __init__(self, name, every):
        self.path, self.every = FOLDER / f"{name}.json", every
        if MAKING:
            self.answers = {}
            atexit.register(self._keep)
        else:
            self.answers = json.loads(self.path.read_text(encoding="utf-8"))

    def __call__(self, key, oracle, kind=float):
        """Return what `oracle()` says, numbers of a `kind` in lists; the key names the question."""
        if MAKING:
            self.answers[key] = texts(oracle())
        kept = self.answers[key]
        if not MAKING and crc32(key.encode()) % self.every == 0:
            before, now = flat(numbers(kept, mp.mpf)), flat(numbers(texts(oracle()), mp.mpf))
            scale = max(map(abs, before))
            for one, other in zip(before, now, strict=True):
                assert abs(one - other) <= 1e-20 * scale, f"{self.path}: {key} is no longer so"
        return numbers(kept, kind)

    def _keep(self):
        if self.answers:
            lines = (
                f"{json.dumps(key)}: {json.dumps(self.answers[key])}"
                for key in sorted(self.answers)
            )
            text = "{\n" + ",\n".join(lines) + "\n}\n"
            self.path.write_text(text, encoding="utf-8")
