"""How a contact has grown: its load, approach, shear and stick radius at every contact radius."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import reals
from spectral_contact.io.choices import one_of
from spectral_contact.io.documents import path_text, replace_file, reported

__all__ = ["ContactHistory"]

#: The quantities of a history, in the order of the columns of `errors`.
_QUANTITIES: Final = ("load", "approach", "total_shear", "stick_radius")
#: Relative rounding of a radius that is stored as its logarithm, over one plus the modulus of the
#: logarithm: some ulp (chosen).
_LOG_ROUNDING: Final = 1e-15


@dataclass(frozen=True, slots=True, eq=False)
class ContactHistory:
    """The history of a growing contact, from where the load was negligible to today.

    Built by `solve`; it is `Solution.history`. Contact radii and approaches are in L, loads and
    shears in E'L^2; of SI data L is 1 m. Methods take contact radii, by default those of `radii`.

    Attributes
    ----------
    ends : ndarray
        Logarithms of the contact radii at which panels begin, and of today's.
    loads, approaches, shears, sticks : ndarray
        Coefficients of Chebyshev series in the logarithm of the contact radius b, a row for each
        panel: of ``ln P``, ``ln delta``, ``Q/P`` and ``ln(c/b)``, with the load P, the approach
        delta, the total shear Q and the stick radius c.
    errors : ndarray
        Estimates of the relative errors on every panel: a column for each of the four.
    """

    ends: Array
    loads: Array
    approaches: Array
    shears: Array
    sticks: Array
    errors: Array

    @property
    def radii(self) -> Array:
        """Contact radii of the Chebyshev points of all panels, ascending, and today's last."""
        count = self.loads.shape[1]
        t = -np.cos(np.pi * (np.arange(count) + 0.5) / count)
        logs = self.ends[:-1, None] + np.diff(self.ends)[:, None] * (1.0 + t) / 2.0
        return np.asarray(np.exp(np.append(logs, self.ends[-1])))

    def load(self, contact_radius: ArrayLike | None = None) -> Any:
        """Return the load when the contact had these radii.

        Parameters
        ----------
        contact_radius : array_like, optional
            Within the history, any shape.

        Returns
        -------
        float or ndarray
            Of the shape of the input.

        Raises
        ------
        SceneError
            For a radius before the history begins, or beyond today's.
        """
        return np.exp(self._evaluated(self.loads, contact_radius))[()]

    def approach(self, contact_radius: ArrayLike | None = None) -> Any:
        """Return the approach; parameters, result and exceptions are as of `load`."""
        return np.exp(self._evaluated(self.approaches, contact_radius))[()]

    def total_shear(self, contact_radius: ArrayLike | None = None) -> Any:
        """Return the total shear; parameters, result and exceptions are as of `load`."""
        return self._evaluated(self.shears, contact_radius)[()] * self.load(contact_radius)

    def stick_radius(self, contact_radius: ArrayLike | None = None) -> Any:
        """Return the ratio c/b of the stick radius to the contact radius.

        Parameters, result and exceptions are as of `load`.
        """
        return np.exp(np.minimum(self._evaluated(self.sticks, contact_radius), 0.0))[()]

    def error(self, quantity: str, contact_radius: ArrayLike | None = None) -> Any:
        """Return the estimate of the relative error of a quantity.

        Parameters
        ----------
        quantity : str
            ``"load"``, ``"approach"``, ``"total_shear"`` or ``"stick_radius"``.
        contact_radius : array_like, optional
            As of `load`.

        Raises
        ------
        SceneError
            For another quantity, or as `load` does.
        """
        one_of("quantity", quantity, _QUANTITIES)
        panel, _ = self._places(contact_radius)
        return self.errors[panel, _QUANTITIES.index(quantity)][()]

    def table(self) -> dict[str, Array]:
        """Return columns over `radii`: the contact radius, every quantity and its error."""
        columns: dict[str, Array] = {"contact_radius": self.radii}
        for name in _QUANTITIES:
            columns[name] = np.asarray(getattr(self, name)())
            columns[f"{name}_error"] = np.asarray(self.error(name))
        return columns

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the `table`, a row for each contact radius.

        Raises
        ------
        SolutionFileError
            If the path cannot be written.
        """
        path = path_text(path)
        columns = self.table()
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        with reported(path, "cannot be written"):
            replace_file(path, ("\n".join(lines) + "\n").encode())

    def _evaluated(self, series: Array, contact_radius: ArrayLike | None) -> Array:
        """Return the values of one of the four Chebyshev series."""
        panel, t = self._places(contact_radius)
        return np.asarray(chebyshev.chebval(t, np.moveaxis(series[panel], -1, 0), tensor=False))

    def _places(self, contact_radius: ArrayLike | None) -> tuple[NDArray[np.intp], Array]:
        """Return the panel of every contact radius, and its place in [-1, 1] on the panel."""
        low = float(np.exp(self.ends[0]))
        high = float(np.exp(self.ends[-1]))
        given: Any = self.radii if contact_radius is None else contact_radius
        allowed = f"in [{low:.17g}, {high:.17g}], the range of the history"
        radii = reals("contact_radius", given, allowed)
        # the ends are stored as logarithms, and known to the rounding of these
        low_rounding, high_rounding = (1.0 + np.abs(self.ends[[0, -1]])) * _LOG_ROUNDING
        inside = (radii >= low * (1.0 - low_rounding)) & (radii <= high * (1.0 + high_rounding))
        if not inside.all():
            raise SceneError("contact_radius", radii[~inside].flat[0], allowed)
        logs = np.log(np.asarray(radii, dtype=np.float64))
        last_panel = len(self.loads) - 1
        panel = np.clip(np.searchsorted(self.ends, logs, side="right") - 1, 0, last_panel)
        fraction = (logs - self.ends[panel]) / (self.ends[panel + 1] - self.ends[panel])
        return panel, np.clip(2.0 * fraction - 1.0, -1.0, 1.0)
