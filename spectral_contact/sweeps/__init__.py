"""Maps: thousands of scenes at once, on one core, on all of them, or on a cluster.

`sweep` solves a grid or a list of scenes and returns an `xarray.Dataset`; it needs the extra
``sweep``.
"""

from spectral_contact.sweeps.slice_pictures import plot_slice
from spectral_contact.sweeps.sweep_run import sweep

__all__ = ["plot_slice", "sweep"]
