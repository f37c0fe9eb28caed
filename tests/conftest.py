"""What every test shares: one thread for BLAS, set before numpy is imported, and no deadlines."""

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from hypothesis import settings  # noqa: E402  (after the threads are set)

settings.register_profile("untimed", deadline=None)  # machines differ, and share their cores
settings.load_profile("untimed")
