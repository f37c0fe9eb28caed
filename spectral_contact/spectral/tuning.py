"""The tuned numbers of this subpackage: what each is, what it was measured against, and how.

A number that follows from a formula stays beside the formula. Capacities of caches change the time
of a solve and none of its digits.

Commands that measure these numbers again (change the number, then run):

ENTRIES
    ``python validation/honesty/projections.py``: entries of the Galerkin matrices beside double
    integrals of the kernels in many digits.
ABEL
    ``pytest tests/unit/spectral/test_abel.py``: Abel integrals beside mpmath.
NODES
    ``pytest tests/unit/spectral/test_graded.py tests/unit/spectral/test_blocks.py``: integrals at
    Galerkin nodes beside mpmath and beside direct rules.
TIME
    ``python validation/cost/bench_solve.py``: times of whole solves.
"""

from __future__ import annotations

import numpy as np

#: A panel of degree n takes n + EXTRA Gauss points, so that the analytic factors of an integrand
#: (exponentials, square roots away from their zeros) are integrated to rounding. ABEL, ENTRIES.
EXTRA = 12

#: A tail has three polynomials in the distance, because logarithms follow the constant only after
#: factors of the distance, which is tiny there. ENTRIES.
TAIL_TERMS = 3

#: A tail in the square root of the distance has nine polynomials, because all half-integer powers
#: occur there. ENTRIES (its singular pressures and tractions).
ROOT_TERMS = 9

#: A rule on the tail has so many Gauss points more than the tail has polynomials. ABEL, ENTRIES.
TAIL_EXTRA = 9

#: The rule of the left Abel integral on a tail with the endpoint weight has so many Gauss points
#: more than polynomials: there the integral has a logarithm at the boundary. ABEL.
WEIGHTED_TAIL_EXTRA = 24

#: Two points lie at the same place of their panels if these differ by less than this in ``x``,
#: which is the rounding of an ``x`` of 50. Derived from 50 * 2**-52, doubled.
SAME_PLACE = 2e-14

#: On a panel of degree n a function is sampled at n + 5 points, and at 18 at least, so that its
#: products with ``exp(-x)`` are expanded to rounding however low the degree is.
#: Measured against functions in closed form: ``pytest tests/unit/spectral/test_panels.py``.
SAMPLING_EXTRA = 5
LEAST_SAMPLING_POINTS = 18

#: On a panel this many Gauss points represent a function that is analytic in ``x`` up to an
#: imaginary part of pi, as functions of ``d + e`` are. The error is 6.4**-20 on panels of width 2
#: (derived from the ellipse of analyticity). NODES.
SAMPLES = 20

#: This many Chebyshev points represent a function on an interval with a singularity as far off as
#: the interval is wide. The error is 5.8**-24, which is rounding (derived from the ellipse). NODES.
FAR_POINTS = 24

#: This many Chebyshev points represent a function on an interval with a singularity seven times as
#: far off as the interval is wide. The error is 27**-12 (derived from the ellipse). NODES.
OPPOSITE_POINTS = 12

#: The tail has as many Galerkin nodes as a panel of degree 16: integrals of functions on other
#: parts, which may lie at any distance, vary there like square roots. NODES.
TAIL_NODES = 48

#: A panel of degree n has ``NODE_STEP * ceil(2 n / NODE_STEP + 1)`` Galerkin nodes, at least 16
#: more than 2 n. Entries of the Gram matrix are then right to 1.5e-14; with 10 more than 2 n those
#: of low degrees are off by up to 3e-9, and at the centre it takes 18 more. Few distinct counts let
#: panels share their blocks. ENTRIES.
NODE_STEP = 16

#: Up to this distance, in extents of the part, an increment of the integral over the other half of
#: an annulus is integrated as such; farther off the difference of the two integrals is right to
#: rounding. NODES (`test_differences_keep_their_digits_next_to_the_boundary`).
INCREMENT_REACH = 0.5

#: Half-integrals at the nodes of their own part are stored in at most this many strips, each with
#: at least this many functions: strips without most zeros save time that more products cost. TIME.
MAX_STRIPS = 8
FUNCTIONS_PER_STRIP = 24

#: This many entries of a kernel are evaluated at a time, so that they stay in the processor's
#: second-level cache (256 kB). TIME (scenes with slip).
KERNEL_ENTRIES = 32768

#: Above this compliance the normal equations of a regularised least-squares problem lose no more
#: than 30 roundings, and the correction is left out; of q/s at the centre they lose some thousand
#: roundings at compliances of 1e-3 ... 0.02. Measured against the corrected solution:
#: ``python validation/peers/naive.py``.
UNCORRECTED_COMPLIANCE = 0.1

#: A ring has this many Gauss points. Entries are right to 3e-12 on rings as wide as 1.5 in the
#: logit, but for the shear of the first ring on itself, a logarithm squared at the centre: 2e-6.
#: Measured against more points: ``python validation/honesty/ring_zones.py``.
RING_POINTS = 16

#: Entries of at least this many bytes, one MiB, are large. Together all caches hold at most
#: MAX_CACHE_BYTES. They are counted CACHE_COUNTS times while so many bytes of large entries are
#: made, since counting takes 3 ms. Measured as the memory of a long sweep:
#: ``python validation/cost/memory.py``.
LARGE_BYTES = 2**20
MAX_CACHE_BYTES = 256 * LARGE_BYTES
CACHE_COUNTS = 8
#: A cache keeps this many entries unless another number is given where it is made. Integrals of
#: parts at their own nodes need most: slip inside has 5 parts in some ten spaces. Measured as the
#: memory of a long sweep: ``python validation/cost/memory.py``.
CACHE_ENTRIES = 256

#: A cell of degree n has this many nodes beyond twice the degree, for the square roots of functions
#: on cells farther out. Measured against more nodes: ``pytest tests/unit/spectral/test_cells.py``.
CELL_EXTRA_NODES = 16

#: A polynomial on a cell of degree n is sampled at so many points more than n, since products with
#: a law's slope are expanded from them. Measured as the error of layered contacts:
#: ``python validation/honesty/honesty.py layers``.
POINTWISE_EXTRA = 8

#: A part is far off if it is at least this many of its own extents away: there `FAR_POINTS`
#: represent it. Derived: it is the 1 of that error, less what rounding may take of a distance.
FAR_DISTANCE = 1.0 - float(np.sqrt(np.finfo(float).eps))
