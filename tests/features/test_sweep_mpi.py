"""A sweep on MPI, as docs/maps.md starts it; skipped where there is no mpi4py or no mpiexec."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene
from spectral_contact.sweeps import sweep

pytest.importorskip("mpi4py", reason="part of the extra: mpi")
xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

SCRIPT = """
import os
from mpi4py import MPI
from mpi4py.futures import MPIPoolExecutor
from spectral_contact import Scene
from spectral_contact.sweeps import sweep
import numpy as np

if __name__ == "__main__":
    with MPIPoolExecutor() as pool:
        assert pool.num_workers == 1, "one of two ranks is the master"
        assert pool.submit(os.getpid).result() != os.getpid()
        assert pool.submit(MPI.Comm.Get_rank, MPI.COMM_WORLD).result() == 1
        found = sweep(
            Scene(0.3, 0.5, 0.5, 0.1),
            friction=np.linspace(0.02, 0.2, 6),
            quantities=["stick_radius", "zones"],
            chunk=2,
            executor=pool,
            store="map",
        )
    found.to_netcdf("map.nc")
"""
#: As root, and with more ranks than cores, Open MPI runs only if told.
OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


def starter():
    """Return the mpiexec of this environment, or that of the system."""
    beside = Path(sys.executable).with_name("mpiexec")
    found = str(beside) if beside.exists() else shutil.which("mpiexec")
    return found or pytest.skip("there is no mpiexec")


def test_two_ranks_give_the_numbers_of_one_process(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    command = [starter(), "-n", "2", sys.executable, "-m", "mpi4py.futures", "script.py"]
    started = subprocess.Popen(
        command,
        cwd=tmp_path,
        env=os.environ | OPEN_MPI,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = started.communicate(timeout=240)
    finally:
        if started.poll() is None:
            os.killpg(started.pid, signal.SIGKILL)
    assert started.returncode == 0, output
    asked = {
        "friction": np.linspace(0.02, 0.2, 6),
        "quantities": ["stick_radius", "zones"],
        "chunk": 2,
    }
    expected = sweep(Scene(0.3, 0.5, 0.5, 0.1), **asked)
    assert xarray.load_dataset(tmp_path / "map.nc").identical(expected)
    assert len(list((tmp_path / "map").glob("*.npz"))) == 3
    again = sweep(Scene(0.3, 0.5, 0.5, 0.1), **asked, store=tmp_path / "map")
    assert again.identical(expected)
