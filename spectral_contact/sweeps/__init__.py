"""Maps: thousands of scenes at once, on one core, on all of them, or on a cluster.

`sweep` solves a grid or a list of scenes and returns an `xarray.Dataset`; it needs the extra
``sweep``.
"""

from spectral_contact.sweeps.pictures import plot_slice
from spectral_contact.sweeps.run import sweep

__all__ = ["plot_slice", "sweep"]
