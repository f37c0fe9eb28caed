r"""Proved bounds of the approach and of the edge pressure, by ball arithmetic.

For a flat punch on a linear layer, with ``A = alpha + N`` and ``<a, b> = int a b s ds``, let
``w = A^-1 1`` be the pressure of unit approach. Any pressure u leaves a residual ``r = 1 - A u``,
and as N is positive (docs/theory, Two-sided bounds of the approach)

    m = <1, w> = 1/(2 pi delta)    is in    <1, u> + <r, u> + [0, <r, r>/alpha].

Here u is a sum of Legendre polynomials ``P_n(2 s**2 - 1)``, whose coefficients are doubles. Of such
u the residual is known exactly (docs/theory, Proved bounds):

    <P_m, P_k> = [m = k]/(2 (2 m + 1)),
    <P_m, N P_k> = -(h(m - k) - h(m + k + 1))/(2 pi (2 m + 1) (2 k + 1)),  h(j) = 1/(4 j**2 - 1),

and ``<r, r> = sum 2 (2 k + 1) <r, P_k>**2`` by Parseval, with a bound of the tail. All of this is
computed in balls, midpoints with radii that contain every rounding (python-flint). So the bounds
are a proof: the doubles decide how narrow they are, not whether they hold. Nothing is shared with
``spectral_contact.spectral``, nor with `reference`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import floor, log10, pi
from typing import Any, Final, NamedTuple

import numpy as np
from mpmath.ctx_mp import MPContext
from mpmath.libmp import from_man_exp
from scipy.fft import irfft, next_fast_len, rfft

from spectral_contact.errors import ConvergenceError, NotComputedError, SceneError, optional
from spectral_contact.io import checks
from spectral_contact.io.choices import suggesting
from spectral_contact.scene import Scene

__all__ = ["Enclosure", "enclose_approach", "enclose_edge_pressure"]

#: Bits of the midpoints of balls: their rounding is far below the residuals of doubles.
_BITS: Final = 192
#: Number of polynomials of the first trial; it is doubled up to `_MOST_TERMS`.
_FEWEST_TERMS: Final = 256
_MOST_TERMS: Final = 65536
#: The residual is expanded in more polynomials than the solution, by this factor; the rest of it,
#: its tail, is bounded.
_EXPANDED: Final = 4
#: Conjugate gradients stop when the width that their residual adds to the interval is this many
#: digits below the width asked for.
_SPARE_DIGITS: Final = 2
_MOST_DIGITS: Final = 30


@dataclass(frozen=True, slots=True)
class Enclosure:
    """An interval that is proved to contain a number; ``value in enclosure`` asks for it.

    Attributes
    ----------
    lower, upper : mpf
        Its ends, exactly. The number is dimensionless, as in `Solution`.
    terms : int
        Number of Legendre polynomials that it comes from; 0 for a closed form.
    """

    lower: Any
    upper: Any
    terms: int

    @property
    def width(self) -> float:
        """The width over the upper end; half of it bounds the relative error of the middle."""
        return float((self.upper - self.lower) / self.upper)

    @property
    def digits(self) -> int | None:
        """The digits that are proved, ``-log10(width)`` rounded down; None if the width is 0."""
        return None if self.lower == self.upper else max(floor(-log10(self.width)), 0)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the ends exactly: mpmath rounds numbers to the precision of who reads them."""
        ends = ((int(m), int(e)) for m, e in (self.lower.man_exp, self.upper.man_exp))
        return _rebuilt, (*ends, self.terms)

    def __contains__(self, value: Any) -> bool:
        return bool(self.lower <= value <= self.upper)

    def __str__(self) -> str:
        """Return the interval in decimals, rounded outward, with three digits of the width."""
        ends = [_fraction(end) for end in (self.lower, self.upper)]
        width = ends[1] - ends[0]
        if width == 0:
            return f"[{self.lower}, {self.upper}]"
        places = 2 - floor(log10(width))
        first = floor(ends[0] * Fraction(10) ** places)
        last = -floor(-ends[1] * Fraction(10) ** places)
        return f"[{_decimal(first, places)}, {_decimal(last, places)}]"


@suggesting()
def enclose_approach(scene: Scene, digits: int = 20) -> Enclosure:
    """Return an interval that is proved to contain the approach of a flat punch.

    Friction does not matter, nor does Poisson's ratio. The compliance is taken as exactly the
    double it is. Needs python-flint (extra: proof).

    Parameters
    ----------
    scene : Scene
        Without profile, nonlinear layer and elastic coupling.
    digits : int
        The width of the interval over its upper end is at most ``10**-digits``; from 1 to 30.

    Returns
    -------
    Enclosure
        Of δ*, in units of the largest load, as in `Solution`. On a smooth surface it is 1/8 at that
        load, by the closed form (docs/theory, Closed forms).

    Raises
    ------
    SceneError
        For an argument out of its range.
    NotComputedError
        With a profile, a nonlinear layer or elastic coupling.
    ConvergenceError
        If 65,536 polynomials give a wider interval, as they do for thin layers; it carries that as
        ``solution``, which is proved just as well.
    MissingDependencyError
        Without python-flint.

    Examples
    --------
    >>> import spectral_contact as sc
    >>> print(sc.proof.enclose_approach(sc.Scene(0.3, normal_compliance=0.5)))
    [0.29295979691047814139883, 0.29295979691047814140050]
    """
    _check(scene, digits)
    if scene.normal_compliance == 0.0:
        numerator, denominator = (scene.unloaded_to / 8.0).as_integer_ratio()
        closed_form = _exact(numerator, 1 - denominator.bit_length())
        return Enclosure(closed_form, closed_form, 0)
    return _narrow(scene, digits, edge=False)


@suggesting()
def enclose_edge_pressure(scene: Scene, digits: int = 20) -> Enclosure:
    """Return an interval that is proved to contain the edge pressure p*(1) of a flat punch.

    It follows from bounds of the approach delta and of its derivative, by the identity
    ``2 pi alpha p(1)**2 = delta + alpha d delta/d alpha`` (docs/theory, Proved bounds). Parameters,
    result and errors are as of `enclose_approach`.

    Raises
    ------
    NotComputedError
        On a smooth surface, too, where the pressure is infinite at the edge.

    Examples
    --------
    >>> import spectral_contact as sc
    >>> print(sc.proof.enclose_edge_pressure(sc.Scene(0.3, normal_compliance=0.5), digits=15))
    [0.379809955079743071, 0.379809955079743129]
    """
    _check(scene, digits)
    if scene.normal_compliance == 0.0:
        raise NotComputedError("the edge pressure", "it is infinite on a smooth surface")
    return _narrow(scene, digits, edge=True)


def _check(scene: Scene, digits: int) -> None:
    if not isinstance(scene, Scene):
        raise SceneError("scene", scene, "a Scene")
    if checks.whole("digits", digits, 1) > _MOST_DIGITS:
        raise SceneError("digits", digits, f"at most {_MOST_DIGITS}")
    for reason, holds in {
        "a profile": scene.profile is not None,
        "a nonlinear layer": scene.layer is not None,
        "elastic coupling": scene.couples,
    }.items():
        if holds:
            raise NotComputedError("an enclosure", f"there is none with {reason}")


def _narrow(scene: Scene, digits: int, *, edge: bool) -> Enclosure:
    """Return the first interval that is narrow enough."""
    flint = optional("flint", "proof")
    terms = _FEWEST_TERMS
    with flint.ctx.workprec(_BITS):
        while True:
            expansion = _Expansion(flint, scene.normal_compliance, terms, digits)
            ball = expansion.edge_pressure() if edge else expansion.approach()
            ball *= flint.arb(scene.unloaded_to)  # both are proportional to the load
            enclosure = Enclosure(_end(ball.lower()), _end(ball.upper()), terms)
            if enclosure.width <= 10.0**-digits:
                return enclosure
            if terms == _MOST_TERMS:
                cause = f"{enclosure.digits} of {digits} digits are proved with {terms} polynomials"
                remedy = "ask for fewer digits, or take `solution` of this error, the interval"
                raise ConvergenceError(cause, remedy, enclosure)
            terms *= 2


class _Residual(NamedTuple):
    """Products with a residual and its square, as balls.

    Attributes
    ----------
    products : list of arb
        ``<r, P_k>`` of the polynomials of the trial function.
    squared : arb
        A ball that contains ``<r, r>``.
    """

    products: list[Any]
    squared: Any


class _Expansion:
    """Legendre series, with coefficients in doubles, and their residuals in balls.

    Parameters
    ----------
    flint : module
    compliance : float
        ``alpha*``, positive.
    terms : int
        Number of polynomials.
    digits : int
        Of the width that is asked for.
    """

    def __init__(self, flint: Any, compliance: float, terms: int, digits: int) -> None:
        self.flint = flint
        self.alpha = flint.arb(compliance)
        self.terms = terms
        self.digits = digits
        unit = np.zeros(terms)
        unit[0] = 1.0
        self.trial = _galerkin(compliance, unit, digits)
        self.residual = self._residual(unit, self.trial)

    def approach(self) -> Any:
        """Return ``delta`` as a ball."""
        first, last = (1 / (2 * self.flint.arb.pi() * m) for m in self._moments())
        return first.union(last)

    def edge_pressure(self) -> Any:
        """Return ``p(1)`` as a ball."""
        twice_pi = 2 * self.flint.arb.pi()
        least, most = self._moments()
        lower, upper = self._norms()
        # d delta/d alpha is <w, w>/(2 pi m**2), and at least 1/pi, as by Schwarz's inequality
        # m**2 = <1, w>**2 is at most <1, 1> <w, w> = <w, w>/2
        slopes = (lower / (twice_pi * most**2)).max(2 / twice_pi), upper / (twice_pi * least**2)
        ends = []
        for moment, slope in zip((most, least), slopes, strict=True):
            sides = 1 / (twice_pi * moment) + self.alpha * slope
            ends.append((sides / (twice_pi * self.alpha)).sqrt())
        return ends[0].union(ends[1])

    def _moments(self) -> tuple[Any, Any]:
        """Return a lower and an upper bound of ``m = <1, w>``, each as a ball."""
        trial = self._balls(self.trial)
        ritz = trial[0] / 2 + self._product(trial, self.residual.products)
        return ritz, ritz + self.residual.squared / self.alpha

    def _norms(self) -> tuple[Any, Any]:
        """Return a lower and an upper bound of ``-dm/d alpha = <w, w>``, each as a ball.

        With ``v`` near ``A^-1 u`` and its residual ``rho = u - A v``, it is
        ``<u, u> + 2 <v, r> + 2 <rho, A^-1 r> + <A^-1 r, A^-1 r>``.
        """
        second = _galerkin(float(self.alpha), self.trial, self.digits)
        second_residual = self._residual(self.trial, second)
        trial = self._balls(self.trial)
        norm = self._product(trial, [a / (2 * (2 * k + 1)) for k, a in enumerate(trial)])
        first = norm + 2 * self._product(self._balls(second), self.residual.products)
        mixed_term = 2 * (second_residual.squared * self.residual.squared).sqrt() / self.alpha
        return first - mixed_term, first + mixed_term + self.residual.squared / self.alpha**2

    def _residual(self, source: np.ndarray, trial: np.ndarray) -> _Residual:
        """Return ``source - A trial``."""
        arb = self.flint.arb
        terms = self.terms
        expanded = _EXPANDED * self.terms
        source_balls = self._balls(source)
        balls = self._balls(trial)
        scaled = [a / (2 * k + 1) for k, a in enumerate(balls)]
        near = self._convolved(range(1 - terms, expanded), scaled)  # sum_k h(m - k) b_k
        far = self._convolved(range(1, expanded + terms), scaled[::-1])  # sum_k h(m + k + 1) b_k
        products = [(near[m] - far[m]) / (2 * arb.pi() * (2 * m + 1)) for m in range(expanded)]
        for m in range(terms):
            products[m] += (source_balls[m] - self.alpha * balls[m]) / (2 * (2 * m + 1))
        squared = sum((2 * (2 * k + 1) * r**2 for k, r in enumerate(products)), arb(0))
        # the tail, by the bound of docs/theory, Proved bounds
        largest = 2 / arb.pi() * sum((abs(a) for a in balls), arb(0))
        reach = arb((2 * expanded - 1) ** 2 - (2 * terms) ** 2)
        tail = largest**2 / (6 * reach**3)
        return _Residual(products[:terms], squared + arb(0).union(tail))

    def _convolved(self, indices: range, coefficients: list[Any]) -> list[Any]:
        """Return the convolution of ``h`` at indices with coefficients.

        Only the sums over all coefficients are returned, not those that the ends cut short.
        """
        poly = self.flint.arb_poly
        kernel = poly([self.flint.fmpq(1, 4 * j**2 - 1) for j in indices])
        product = kernel * poly(coefficients)
        return [product[i] for i in range(self.terms - 1, len(indices))]

    def _product(self, first: list[Any], second: list[Any]) -> Any:
        return sum((a * b for a, b in zip(first, second, strict=True)), self.flint.arb(0))

    def _balls(self, values: np.ndarray) -> list[Any]:
        return list(map(self.flint.arb, values.tolist()))


def _galerkin(compliance: float, source: np.ndarray, digits: int) -> np.ndarray:
    """Return the coefficients that Galerkin's method has for ``A u = source``, in doubles.

    By conjugate gradients with the diagonal as preconditioner, until ``<r, r>/alpha`` is below
    ``<source, u>`` by as many digits as are wanted. The matrix of N is a Toeplitz and a Hankel
    matrix between diagonal ones: products are convolutions. `residual` has ``<r, P_k>``.
    """
    terms = len(source)
    k = np.arange(terms)
    scale = 1.0 / (2.0 * k + 1.0)
    length = next_fast_len(3 * terms, real=True)
    near = rfft(_kernel(np.arange(1 - terms, terms)), length)
    far = rfft(_kernel(np.arange(1, 2 * terms)), length)

    def applied(u: np.ndarray) -> np.ndarray:
        b = scale * u
        transformed = near * rfft(b, length) - far * rfft(b[::-1], length)
        elastic = irfft(transformed, length)[terms - 1 : 2 * terms - 1]
        image: np.ndarray = compliance * b / 2.0 - scale * elastic / (2.0 * pi)
        return image

    diagonal = compliance * scale / 2.0 + scale**2 * (1.0 + _kernel(2.0 * k + 1.0)) / (2.0 * pi)
    solution = np.zeros(terms)
    weighted_source = source * scale / 2.0
    residual = weighted_source.copy()
    direction = residual / diagonal
    energy = float(residual @ direction)
    allowed = compliance * 10.0 ** -(digits + _SPARE_DIGITS)
    while residual @ (2.0 * residual / scale) > allowed * (weighted_source @ solution):
        image = applied(direction)
        step = energy / float(direction @ image)
        solution += step * direction
        residual -= step * image
        conditioned = residual / diagonal
        before = energy
        energy = float(residual @ conditioned)
        direction = conditioned + energy / before * direction
    return solution


def _kernel(j: np.ndarray) -> np.ndarray:
    """Return ``h(j) = 1/(4 j**2 - 1)``."""
    return 1.0 / (4.0 * np.asarray(j, dtype=float) ** 2 - 1.0)


def _end(ball: Any) -> Any:
    """Return the midpoint of a ball as an mpf, exactly; a ball of radius 0 is its midpoint."""
    mantissa, exponent = ball.mid().man_exp()
    return _exact(int(mantissa), int(exponent))


def _exact(mantissa: int, exponent: int) -> Any:
    """Return ``mantissa * 2**exponent`` as an mpf, without rounding.

    Its context has as many bits as balls, which numbers computed from it then have, too.
    """
    context = MPContext()
    context.prec = _BITS
    return context.make_mpf(from_man_exp(mantissa, exponent))


def _rebuilt(lower: tuple[int, int], upper: tuple[int, int], terms: int) -> Enclosure:
    """Return an enclosure from mantissas and exponents of its ends."""
    return Enclosure(_exact(*lower), _exact(*upper), terms)


def _fraction(value: Any) -> Fraction:
    mantissa, exponent = value.man_exp
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _decimal(number: int, places: int) -> str:
    """Return ``number / 10**places``."""
    if places <= 0:
        return str(number * 10**-places)
    whole, part = divmod(number, 10**places)
    return f"{whole}.{part:0{places}d}"
