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
    ``python validation/cost/bench.py solve``: times of whole solves.
"""

from __future__ import annotations

#: On a panel of degree n a function is integrated with n + EXTRA Gauss points, so that the analytic
#: factors of an integrand (exponentials, square roots away from their zeros) are integrated to
#: rounding. On a tail of n polynomials it takes n + EXTRA points, too, and n + 2 EXTRA where the
#: integrand has a logarithm at the boundary. ABEL, ENTRIES.
EXTRA = 12

#: Number of polynomials in the distance d to the boundary, of degrees 0, 1 and 2, that stand for a
#: field in the tail between the panels and the boundary. What they lack of its expansion begins
#: with ``d ln d``, and d is tiny. ENTRIES.
TAIL_TERMS = 3

#: On a panel of degree n a function is sampled at so many points more than n, so that its products
#: with ``exp(-x)`` are expanded to rounding; on panels of low degree at `jacobi.PANEL_SAMPLES`.
#: Measured against functions in closed form: ``pytest tests/unit/spectral/test_panels.py``.
SAMPLING_EXTRA = 5

#: A panel of degree n has ``NODE_STEP * ceil(2 n / NODE_STEP + 1)`` Galerkin nodes: 2 n and 16
#: more, rounded up to a multiple of 16. Entries of the Gram matrix are then right to 1.5e-14; with
#: 2 n and 10 those of low degrees are off by up to 3e-9. The multiples let panels of similar
#: degrees have the same nodes, and so share blocks. ENTRIES.
NODE_STEP = 16

#: Above this compliance the normal equations of a regularised least-squares problem lose no more
#: than 30 roundings. Then no step of iterative refinement follows their solution, and the pressure
#: of a flat punch is expanded without the weight that is singular at the edge. At smaller
#: compliances they lose more: at 1e-3 ... 0.02 ``q/s`` at the centre loses some thousand roundings.
#: Measured against refined solutions: ``python validation/peers/naive.py``.
UNCORRECTED_COMPLIANCE = 0.1

#: All caches are emptied if they hold more bytes than this, 256 MiB, when they are counted:
#: whenever entries of a quarter of that were made, as it takes 3 ms. Measured as the memory of a
#: long sweep: ``python validation/cost/memory.py``.
MAX_CACHE_BYTES = 256 * 2**20
#: A cache keeps this many entries unless another number is given where it is made. Integrals of
#: parts at their own nodes need most: slip inside has 5 parts in some ten spaces. Measured as the
#: memory of a long sweep: ``python validation/cost/memory.py``.
CACHE_ENTRIES = 256
