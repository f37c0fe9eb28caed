"""What the spectra leave out, measured once over all compliances and looked up for each scene.

A spectrum is compared with the one of two degrees less, on a lattice of compliances from 1e-14 to
1e14. The difference is the error of the lesser one, that of the other is smaller; where rounding
prevails it is a sample of the rounding. As a function of the logarithms of the compliances it
varies over lengths of one, as everything here does, with the panels' width of two as a period. So
the estimate of a scene is the largest difference within a decade around it: no sign can make that
small by accident.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields import Array
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.sweeps.spectra import NormalSpectrum, StickSpectrum

#: Least and largest logarithm of a compliance, and lattice points in a decade.
_LEAST, _LARGEST, _DENSITY = -14, 14, 2
#: Of normal contact every quantity superconverges: this degree is good to rounding.
_NORMAL_DEGREE: Final = 10
#: Degrees for full stick, and the least tolerance of each: 20 rounds as much, and takes longer.
_STICK_DEGREES: Final = ((1e-8, 14), (0.0, 18))
#: Pointwise values have rounding of their own, of which the difference is a sample: over 3000
#: random scenes the largest one within a decade was up to twice too small. With these factors, of
#: the edge ratio and of the largest ratio, errors are at most 0.09 and 0.52 of estimates in 1500.
_EDGE_SAFETY, _CRITICAL_SAFETY = 4.0, 8.0
#: Rounding of the edge ratio, 1.5e-13 with one LAPACK where the sample was 1e-14, and of the
#: largest ratio, which is found among hundreds of places and their rounding.
_EDGE_ROUNDING, _CRITICAL_ROUNDING = 100.0 * ROUNDING, 110.0 * ROUNDING
#: Rounding at the edge times the root of the tangential compliance, where the sample shows nothing
#: if both degrees have it: up to 1.7 in 2000 scenes at degree 20.
_THIN_ROUNDING = 3.0 * ROUNDING


class CertifiedNormal:
    """Normal contact for every compliance, with estimates of relative errors.

    Parameters
    ----------
    degree : int
        On every panel, at least 4.
    """

    def __init__(self, degree: int) -> None:
        self.spectrum = NormalSpectrum(degree)
        lattice = _lattice()
        fine, rough = (one.approach(lattice) for one in (self.spectrum, NormalSpectrum(degree - 2)))
        self._maps = [_widened(a, b) + 2.0 * ROUNDING for a, b in zip(fine, rough, strict=True)]

    def approach(self, alpha: Array) -> tuple[Array, Array]:
        """Return approach and edge pressure, and the estimates of their errors, (2, scenes)."""
        place = _places(alpha)
        return np.array(self.spectrum.approach(alpha)), np.array([one[place] for one in self._maps])


class CertifiedStick:
    """Full stick for every pair of compliances, with estimates of relative errors; kappa is 1.

    Parameters
    ----------
    degree : int
        On every panel, at least 4.
    """

    def __init__(self, degree: int) -> None:
        self.spectrum = StickSpectrum(degree)
        lesser = StickSpectrum(degree - 2)
        alpha, beta = (grid.ravel() for grid in np.meshgrid(_lattice(), _lattice(), indexing="ij"))
        self._shape = len(_lattice()), len(_lattice())
        (shear, edge), (rough_shear, rough_edge) = (
            one.shear_and_edge(alpha, beta) for one in (self.spectrum, lesser)
        )
        self._shear_map = self._widened(shear, rough_shear) + 4.0 * ROUNDING
        thin = _THIN_ROUNDING / np.sqrt(np.minimum(_lattice(), 1.0))
        self._edge_map = _EDGE_SAFETY * self._widened(edge, rough_edge) + _EDGE_ROUNDING + thin
        (fine, _), (rough, _) = (
            one.critical(alpha, beta, ratio)
            for one, ratio in ((self.spectrum, edge), (lesser, rough_edge))
        )
        widened = self._widened(fine, rough)
        self._critical_map = _CRITICAL_SAFETY * widened + _CRITICAL_ROUNDING + thin

    def _widened(self, fine: Array, rough: Array) -> Array:
        return _widened(fine.reshape(self._shape), rough.reshape(self._shape))

    def shear_and_edge(self, alpha: Array, beta: Array) -> tuple[Array, Array]:
        """Return ``Q*/kappa`` and ``q/(kappa p)`` at the edge, and their errors, (2, scenes)."""
        place = _places(alpha), _places(beta)
        errors = np.array([self._shear_map[place], self._edge_map[place]])
        return np.array(self.spectrum.shear_and_edge(alpha, beta)), errors

    def critical(self, alpha: Array, beta: Array, edge_ratio: Array) -> tuple[Array, Array]:
        """Return the largest ``|q|/(kappa p)``, and the estimate of its error."""
        critical, jump = self.spectrum.critical(alpha, beta, edge_ratio)
        return critical, self._critical_map[_places(alpha), _places(beta)] + jump


@bounded_cache("normal spectra", 1)
def certified_normal() -> CertifiedNormal:
    """Return normal contact for every compliance (cached)."""
    return CertifiedNormal(_NORMAL_DEGREE)


_kept_stick = bounded_cache("full-stick spectra", 2)(CertifiedStick)


def certified_stick(rtol: float) -> CertifiedStick:
    """Return full stick for every pair of compliances, at a degree that suits `rtol` (cached)."""
    degree = next(degree for least, degree in _STICK_DEGREES if rtol >= least)
    return _kept_stick(degree)


def _lattice() -> Array:
    return np.logspace(_LEAST, _LARGEST, (_LARGEST - _LEAST) * _DENSITY + 1)


def _places(compliance: Array) -> NDArray[np.intp]:
    """Return the nearest points of the lattice."""
    return np.asarray(np.rint((np.log10(compliance) - _LEAST) * _DENSITY), dtype=np.intp)


def _widened(fine: Array, rough: Array) -> Array:
    """Return the largest relative difference within a decade to every side."""
    with np.errstate(invalid="ignore"):
        difference = np.nan_to_num(np.abs(rough / fine - 1.0), nan=np.inf)
    return np.asarray(maximum_filter(difference, size=2 * _DENSITY + 1, mode="nearest"))
