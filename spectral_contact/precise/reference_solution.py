"""Solutions to many digits, as mpmath's numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.io import checks
from spectral_contact.io.units import plain_numbers
from spectral_contact.precise.precise_coupled_run import PreciseCoupledRun
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.records import ErrorEstimates, Zone
from spectral_contact.scene import Scene

if TYPE_CHECKING:
    from spectral_contact.precise.precise_profile_run import PreciseProfileRun


@dataclass(frozen=True)
class ReferenceSolution:
    """A solution to many digits; everything is dimensionless, as in `Solution`.

    Attributes
    ----------
    scene : Scene
    digits : int
        The number that was asked for.
    approach : mpf
        ``delta*``.
    total_shear : mpf
        ``Q*``; 0 without friction.
    stick_radius : mpf or None
        ``c*``; None without friction.
    zones : tuple of Zone
        From the centre to the edge; empty without friction.
    edge_ratio : mpf or None
        q/p at the edge where everything sticks, which may be infinite; None in partial slip, and
        with coupling where it has no limit, or where p changes sign.
    opening : mpf or None
        Largest distance from the edge at which coupling makes the pressure change sign.
    error : ErrorEstimates
        Relative errors, from a second solution on another mesh.
    converged : bool
        Whether all of these errors, and that of the opening, are at most ``10**-digits``.
    unknowns : int
        Dimension of the largest discrete space.
    bits : int
        Bits after the point of the fixed-point numbers; on a smooth surface under a profile, of the
        floating-point numbers.
    seconds : float
        Time that the solution took.
    contact_radius, load : mpf or None
        Of a scene with a profile. The approach and these have the units of the scene then.
    stiffness : mpf or None
        Under a profile the derivative of the load by the approach at a fixed contact radius.
    indentation_work : mpf or None
        Under a profile the work of the load from the first contact to this one. It is the elastic
        energy of body and layer, with adhesion less the work of adhesion times the contact area.
    domain_radius : mpf or None
        Where the contact has no edge: the radius that `s` = 1 stands for.
    """

    scene: Scene
    digits: int
    approach: Any
    total_shear: Any
    stick_radius: Any
    zones: tuple[Zone, ...]
    edge_ratio: Any
    opening: Any
    error: ErrorEstimates
    converged: bool
    unknowns: int
    bits: int
    seconds: float = field(compare=False)
    _run: PreciseRun | PreciseCoupledRun | PreciseProfileRun = field(repr=False, compare=False)
    contact_radius: Any = None
    load: Any = None
    stiffness: Any = None
    indentation_work: Any = None
    domain_radius: Any = None

    def pressure(self, s: Any = None, *, from_edge: Any = None) -> Any:
        """Evaluate p* (with a profile p) at radii `s`, or at distances `from_edge` from the edge.

        Parameters
        ----------
        s, from_edge : number or array_like of numbers
            In [0, 1], taken exactly; one of the two.

        Returns
        -------
        mpf or ndarray of mpf
            At the edge of a flat punch without normal compliance it is infinite; with coupling it
            may be minus infinity there, and without any compliance it is then NaN. Under a profile
            on a smooth surface it is infinite at tips and corners.

        Raises
        ------
        SceneError
            If a radius is no number in [0, 1].
        """
        return self._evaluated(self._run.pressures, s, from_edge)

    def traction(self, s: Any = None, *, from_edge: Any = None) -> Any:
        """Evaluate q* at radii `s`, or at distances `from_edge`; see `pressure`."""
        values = self._evaluated(self._run.tractions, s, from_edge)
        return -values if (self.scene.mismatch or 0.0) < 0.0 else values

    def _evaluated(self, function: Any, s: Any, from_edge: Any) -> Any:
        checks.exactly_one("s", s, "from_edge", from_edge)
        mp = self._run.fixed.mp
        name, given = ("s", s) if from_edge is None else ("from_edge", from_edge)
        checks.reals(name, given, "in [0, 1]", low=0.0, high=1.0)
        values = np.asarray(plain_numbers(name, given), dtype=object)
        exact = []
        for value in values.flat:
            checks.real(name, value, allowed="in [0, 1]", low=0.0, high=1.0)
            exact.append(_fraction(value))
            if not 0 <= exact[-1] <= 1:
                raise SceneError(name, value, "in [0, 1]")
        with mp.workprec(self.bits):  # more than the results have: the bits of the computation
            near = np.empty(len(exact), dtype=object)
            near[:] = [_rounded(mp, one) for one in exact]
            # 1 minus the given number, both from the edge and from the centre, without rounding
            far = np.empty(len(exact), dtype=object)
            far[:] = [_rounded(mp, 1 - one) for one in exact]
            found = function(near, far) if from_edge is None else function(far, near)
        result = np.empty(len(exact), dtype=object)
        result[:] = [+mp.mpf(v) for v in found]
        return result[0] if values.ndim == 0 else result.reshape(values.shape)


def _fraction(value: Any) -> Fraction:
    """Return exactly a real number of Python's, NumPy's or mpmath's."""
    if hasattr(value, "man_exp"):
        mantissa, exponent = value.man_exp
        return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    if isinstance(value, np.floating):
        return Fraction(*value.as_integer_ratio())
    return Fraction(int(value) if isinstance(value, np.integer) else value)


def _rounded(mp: Any, value: Fraction) -> Any:
    """Return a fraction as a number of mpmath's."""
    return mp.mpf(value.numerator) / value.denominator
