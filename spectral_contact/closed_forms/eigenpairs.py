"""Eigenpairs of the half-space operators N and T on the unit disk.

Popov's spectral relations: with y = 1 − s²,

    N[P_l(√y)/√y] = λ P_l(√y), l even;      T[P_l¹(√y)/√y] = λ P_l¹(√y), l odd,

where N = (1/π)∫·K1 dη and T = (1/π)∫·K2 dη are the operators of equations (3.5) and (5.8). The
functions are Jacobi polynomials in s² with the weight 1/√y of the smooth punch.
"""

import mpmath
import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from ._inputs import Array, Position, Values, position, refusal

#: Largest degree of an eigenfunction: there its recurrence takes a second at a hundred points. And
#: of an eigenvalue: beyond, it is 1/(2l) to all digits of a double.
_LARGEST_FUNCTION = 10**6
_LARGEST_EIGENVALUE = 10**100


def eigenvalue(degree: int, order: int) -> float:
    """Return the eigenvalue λ of N (order 0) or T (order 1) that belongs to the degree l.

    Parameters
    ----------
    degree : int
        l ≥ 0: even for order 0, odd for order 1.
    order : int
        m: 0 for the normal operator N, 1 for the tangential operator T.

    Returns
    -------
    float
        λ = Γ((l+m+1)/2) Γ((l−m+1)/2) / [4 Γ((l+m)/2+1) Γ((l−m)/2+1)], dimensionless, right to the
        last bit or so for every degree; ~ 1/(2l) for large l.

    Raises
    ------
    ValueError
        If the order is neither 0 nor 1, or the degree does not belong to it or is above 1e100.
    """
    l, m = _check(degree, order, _LARGEST_EIGENVALUE)  # noqa: E741 (the field's name for it)
    # Ratios of gamma functions at large arguments: their logarithms cancel in double precision, and
    # the half-integers need all their digits.
    with mpmath.workdps(30 + 2 * len(str(l))):
        half = mpmath.mpf(1) / 2
        upper = [(l + m + 1) * half, (l - m + 1) * half]
        lower = [(l + m) * half + 1, (l - m) * half + 1]
        return float(mpmath.gammaprod(upper, lower) / 4)


def eigenfunction(
    degree: int, order: int, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
) -> Values:
    """Return the eigenfunction P_l^m(√y)/√y, y = 1 − s²: a pressure or a traction.

    Parameters
    ----------
    degree, order : int
        l and m as in `eigenvalue`.
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        The function in the shape of the argument (a float for a scalar); inf or −inf at the edge.
        P_l¹ is taken without the sign (−1)^m, so that it starts like + l(l+1)s/2 at the centre.
        Absolute error, against the amplitude: 1e-14 for l = 40, 1e-13 for 200, 1e-11 for 1000.

    Raises
    ------
    ValueError
        If degree and order do not belong together, the degree is above 1e6, not exactly one of the
        coordinates is given, or a value of it lies outside [0, 1].

    Notes
    -----
    P_2k(√y) = P_k^(0,−1/2)(1 − 2s²) and P¹_2k+1(√y) = (2k + 1) s P_k^(1,−1/2)(1 − 2s²).
    """
    l, m = _check(degree, order, _LARGEST_FUNCTION)  # noqa: E741
    at = position(s, from_edge)
    with np.errstate(divide="ignore"):  # the weight is infinite at the edge
        return at.output(np.asarray(_legendre(l, m, at) / np.sqrt(at.y)))


def eigenfunction_image(
    degree: int, order: int, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
) -> Values:
    """Return λ P_l^m(√y), the displacement that N or T makes of `eigenfunction`.

    Parameters
    ----------
    degree, order : int
        l and m as in `eigenvalue`.
    s : array_like, optional
        Distance from the centre, dimensionless, in [0, 1]; any shape.
    from_edge : array_like, optional
        Distance 1 − s from the edge, in [0, 1]; give either this or `s`.

    Returns
    -------
    float or ndarray
        The displacement in the shape of the argument (a float for a scalar); bounded.

    Raises
    ------
    ValueError
        As `eigenfunction`.
    """
    l, m = _check(degree, order, _LARGEST_FUNCTION)  # noqa: E741
    at = position(s, from_edge)
    return at.output(eigenvalue(l, m) * _legendre(l, m, at))


def _legendre(degree: int, order: int, at: Position) -> Array:
    """Return P_l^m(√y) as a Jacobi polynomial in s²."""
    k = degree // 2
    a = float(order)
    # The recurrence is stable and its argument exact where that is near +1, so the outer half of
    # the disk takes P_k^(a,b)(−x) = (−1)^k P_k^(b,a)(x).
    inner = special.eval_jacobi(k, a, -0.5, 1.0 - 2.0 * at.s * at.s)
    outer = (-1) ** k * special.eval_jacobi(k, -0.5, a, 1.0 - 2.0 * at.y)
    polynomial = np.where(at.y > 0.5, inner, outer)
    return np.asarray(polynomial if order == 0 else degree * at.s * polynomial)


def _check(degree: int, order: int, largest: int) -> tuple[int, int]:
    for name, value in (("degree", degree), ("order", order)):
        if isinstance(value, bool | np.timedelta64) or not isinstance(value, int | np.integer):
            raise refusal(name, value, "an integer")
    if order not in (0, 1):
        raise refusal("order", order, "0 (normal) or 1 (tangential)")
    if degree < 0 or degree % 2 != order:
        parity = "odd for order 1" if order else "even for order 0"
        raise refusal("degree", degree, f">= 0 and {parity}")
    if degree > largest:
        raise refusal("degree", degree, f"at most {largest:.0e}")
    return int(degree), int(order)
