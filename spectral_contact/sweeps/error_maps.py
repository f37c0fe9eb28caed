"""Errors of the spectra: maps over all compliances, made once and looked up for each scene.

Every spectrum is compared with the one of two degrees less, on a lattice of compliances from 1e-14
to 1e14. The difference is the error of the lower degree, and that of the higher one is smaller;
where rounding prevails, the difference is a sample of the rounding. Over the natural logarithms of
the compliances the difference varies within lengths of about 1, with the width of the panels of the
mesh, 2, as a period, and it is small where it changes its sign. So the estimate of a scene is the
largest difference within a decade around it.
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

#: Decimal logarithms of the least and the largest compliance of the lattice.
_LEAST_EXPONENT: Final = -14
_LARGEST_EXPONENT: Final = 14
#: Points of the lattice in a decade.
_POINTS_PER_DECADE: Final = 2
#: Degree for normal contact: its quantities superconverge, and are good to rounding from this on.
_NORMAL_DEGREE: Final = 10
#: Degrees for full stick, each with the least tolerance that it is used for. Higher ones have as
#: much rounding as 18, and take longer.
_STICK_DEGREES: Final = ((1e-8, 14), (0.0, 18))
#: Factors of the difference in the estimates of the edge ratio and of the largest ratio. The
#: difference is only a sample of the rounding of pointwise values: over 3000 random scenes the
#: largest one within a decade was up to twice too small. With these factors errors were at most
#: 0.09 and 0.52 of the estimates in 1500 scenes.
_EDGE_SAFETY: Final = 4.0
_CRITICAL_SAFETY: Final = 8.0
#: Relative rounding of the edge ratio: with one build of LAPACK the error was 1.5e-13 where the
#: difference of degrees was 1e-14.
_EDGE_ROUNDING: Final = 100.0 * ROUNDING
#: Rounding of the largest ratio, which has the largest rounding of hundreds of places.
_CRITICAL_ROUNDING: Final = 110.0 * ROUNDING
#: Rounding of the edge ratio times the root of the tangential compliance. It may be the same at
#: both degrees, so that their difference does not show it. In 2000 scenes it was up to 1.7
#: `ROUNDING`.
_THIN_ROUNDING: Final = 3.0 * ROUNDING


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
        fine = self.spectrum.approach(lattice)
        rough = NormalSpectrum(degree - 2).approach(lattice)
        #: estimates of the errors of approach and edge pressure at the points of the lattice
        self._maps = [_widened(a, b) + 2.0 * ROUNDING for a, b in zip(fine, rough, strict=True)]

    def approach(self, alpha: Array) -> tuple[Array, Array]:
        """Return approach and edge pressure, and the estimates of their errors, (2, scenes)."""
        nearest = _nearest(alpha)
        errors = np.array([one[nearest] for one in self._maps])
        return np.array(self.spectrum.approach(alpha)), errors


class CertifiedStick:
    """Full stick for every pair of compliances, with estimates of relative errors; kappa is 1.

    Parameters
    ----------
    degree : int
        On every panel, at least 4.
    """

    def __init__(self, degree: int) -> None:
        self.spectrum = StickSpectrum(degree)
        lower = StickSpectrum(degree - 2)
        alpha, beta = (grid.ravel() for grid in np.meshgrid(_lattice(), _lattice(), indexing="ij"))
        self._shape = len(_lattice()), len(_lattice())
        shear, edge = self.spectrum.shear_and_edge(alpha, beta)
        rough_shear, rough_edge = lower.shear_and_edge(alpha, beta)
        self._shear_map = self._widened(shear, rough_shear) + 4.0 * ROUNDING
        # beta is the second dimension of a map
        thin = _THIN_ROUNDING / np.sqrt(np.minimum(_lattice(), 1.0))
        self._edge_map = _EDGE_SAFETY * self._widened(edge, rough_edge) + _EDGE_ROUNDING + thin
        largest, _ = self.spectrum.critical(alpha, beta, edge)
        rough_largest, _ = lower.critical(alpha, beta, rough_edge)
        widened = self._widened(largest, rough_largest)
        self._critical_map = _CRITICAL_SAFETY * widened + _CRITICAL_ROUNDING + thin

    def _widened(self, fine: Array, rough: Array) -> Array:
        """Return the map of a quantity at all pairs of compliances, (alphas, betas)."""
        return _widened(fine.reshape(self._shape), rough.reshape(self._shape))

    def shear_and_edge(self, alpha: Array, beta: Array) -> tuple[Array, Array]:
        """Return ``Q*/kappa`` and ``q/(kappa p)`` at the edge, and their errors, (2, scenes)."""
        nearest = _nearest(alpha), _nearest(beta)
        errors = np.array([self._shear_map[nearest], self._edge_map[nearest]])
        return np.array(self.spectrum.shear_and_edge(alpha, beta)), errors

    def critical(self, alpha: Array, beta: Array, edge_ratio: Array) -> tuple[Array, Array]:
        """Return the largest ``|q|/(kappa p)``, and the estimate of its error."""
        # the jump of q/p between two panels is rounding that the map does not have
        critical, jump = self.spectrum.critical(alpha, beta, edge_ratio)
        return critical, self._critical_map[_nearest(alpha), _nearest(beta)] + jump


@bounded_cache("normal spectra", 1)
def certified_normal() -> CertifiedNormal:
    """Return normal contact for every compliance (cached)."""
    return CertifiedNormal(_NORMAL_DEGREE)


_cached_stick = bounded_cache("full-stick spectra", 2)(CertifiedStick)


def certified_stick(rtol: float) -> CertifiedStick:
    """Return full stick for every pair of compliances, at a degree that suits `rtol` (cached)."""
    degree = next(degree for least, degree in _STICK_DEGREES if rtol >= least)
    return _cached_stick(degree)


def _lattice() -> Array:
    """Return the compliances of the lattice."""
    return np.logspace(
        _LEAST_EXPONENT,
        _LARGEST_EXPONENT,
        (_LARGEST_EXPONENT - _LEAST_EXPONENT) * _POINTS_PER_DECADE + 1,
    )


def _nearest(compliance: Array) -> NDArray[np.intp]:
    """Return the numbers of the nearest points of the lattice."""
    return np.asarray(
        np.rint((np.log10(compliance) - _LEAST_EXPONENT) * _POINTS_PER_DECADE), dtype=np.intp
    )


def _widened(fine: Array, rough: Array) -> Array:
    """Return the largest relative difference within a decade around every point of the lattice."""
    with np.errstate(invalid="ignore"):
        difference = np.nan_to_num(np.abs(rough / fine - 1.0), nan=np.inf)
    return np.asarray(maximum_filter(difference, size=2 * _POINTS_PER_DECADE + 1, mode="nearest"))
