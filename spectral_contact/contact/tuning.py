"""The tuned numbers of the contact problems: what each means, and what it was measured against.

A number stands here if it was chosen by a measurement. What follows from a formula stands where the
formula is. A comment says what the number means, what it was measured against, and the study that
shows its effect: change the number and run that command again. "Not measured again" stands where no
study shows the effect.
"""

from __future__ import annotations

# Spaces, refinement, error estimates
#
# "depth" below means ``x = -ln d`` with the distance d to the end of a part in units of its extent.

# Rounding: relative errors that no refinement removes. An error estimate is at least as large.

#: Error of the approach, of the total shear where there is no free boundary, and of the free
#: boundaries themselves. Measured against solutions with 20 digits: validation/honesty/honesty.py.
ROUNDING = 2e-15
#: Error of p or q/p at one radius, of closed forms, and of approach and total shear with slip, for
#: which two methods differ by half of this at most in 60 scenes: validation/honesty/honesty.py.
FIELD_ROUNDING = 20.0 * ROUNDING
#: Boundary residuals and relative changes of fields that are smaller than this are rounding. With
#: 1e-15 or 1e-12 no space of 91 scenes is another one; with 4e-14 coupled slip inside takes 1.5
#: times as long at rtol 1e-12: validation/honesty/honesty.py, validation/cost/bench.py coupled.
RESIDUAL_NOISE = 1e-13
#: Error of ``q/s`` at one radius. It is least accurate at the centre: two solves of 400 scenes on
#: different panels differ by 1.8e-13 at most: validation/honesty/honesty.py coupled.
TRACTION_ROUNDING = 110.0 * ROUNDING
#: The same in full stick or on one stick disk where the tangential compliance is too small to
#: regularise the traction (beta over the stick radius below UNCORRECTED_COMPLIANCE of
#: `spectral.tuning`). Of 106 scenes against 20 digits the largest error is 5.3e-13:
#: validation/honesty/honesty.py coupled.
RIGID_TRACTION_ROUNDING = 300.0 * ROUNDING

# Tolerances of inner steps

#: A part below this fraction of the whole is negligible:
#:
#: - a correction below this fraction of the tolerance is left out;
#: - a step of the boundaries is taken when the error of the fields is below this fraction of it;
#: - a correction is assumed to leave at least this fraction of an error;
#: - the pressure that loads the tangential problem has this fraction of the tolerance;
#: - coupled full stick that decides on the onset of slip has this fraction of `ONSET_BAND` as its
#:   tolerance.
#:
#: With 0.1 for corrections the estimates of shear and boundaries are 1.7 and 1.9 times as large in
#: the mean of 50 random scenes: validation/honesty/sharpness.py.
NEGLIGIBLE_FRACTION = 0.01
#: The coarse tolerance. Boundaries are located to it first, in a space for it, and in such a space
#: fields are evaluated to choose the zones to be tried. Next comes a space for the square root of
#: the tolerance of the solve, if this root is smaller: boundaries have nearly all of their digits
#: there. Its cost: validation/cost/bench.py coupled.
COARSE_TOL = 1e-3

# Error estimates

#: The error of a field at an edge where it has a square root is this times the change of its tail,
#: of which it was 1.9 times at most: validation/honesty/honesty.py.
ROOT_EDGE_SAFETY = 2.5
#: The relative changes of p and q on a panel, sums of moduli of the coefficients that a coarser
#: space lacks, bound the error of q/p anywhere on it. At one radius the error is estimated as this
#: fraction of their sum. Of 120 such errors none exceeds 0.11 of the estimate with this factor:
#: validation/honesty/honesty.py.
RATIO_BOUND_FACTOR = 0.2

#: Relative distance from the critical friction up to which full stick may stand for slip that no
#: search resolves: validation/honesty/honesty.py thresholds.
ONSET_BAND = 1e-4

# Refinement

#: Refinement aims at this fraction of the tolerance, so that one more solve is rarely needed. Its
#: cost: validation/cost/bench.py solve.
REFINEMENT_MARGIN = 0.15
#: Highest degree of a panel. Beyond it rounding grows and the error does not fall: not measured
#: again.
MAX_DEGREE = 40

# Meshes

#: Width of a panel in x. It is cheapest at a tolerance of 1e-12: validation/cost/bench.py solve.
PANEL_WIDTH = 2.0

# First spaces. A number that is too small costs a second solve, one that is too large unknowns:
# validation/cost/bench.py solve and bench.py coupled show both. An estimate decides whether a space
# is accepted; that it still bounds the error is shown by validation/honesty/honesty.py.

#: Degree of a panel: SPARE_DEGREES + DEGREES_PER_EFOLD times ``-ln`` of the tolerance. The panels
#: of a part are graded to one of its ends. Where the field is singular at the other end, too,
#: START_DEGREES_PER_EFOLD times ``-ln`` of the tolerance is added on the panel next to that end,
#: which is the first one. With 0.55 degrees per e-fold and nothing added, coupled slip takes up to
#: 2.5 times as long: validation/cost/bench.py coupled.
SPARE_DEGREES = 3.0
DEGREES_PER_EFOLD = 0.5
START_DEGREES_PER_EFOLD = 0.4
#: Depth by which a layer of the pressure reaches beyond its width.
LAYER_REACH = 3.0

# Free boundaries. Logits are those of the boundaries, ``ln(b**2/(1 - b**2))``.

#: The Jacobian is valid while boundaries move by less than this fraction of the narrowest zone, and
#: half the step of its differences is this fraction at most. With steps of 0.03 or 0.5 no digit of
#: 25 scenes changes. validation/honesty/honesty.py thresholds counts scenes that are refused.
JACOBIAN_RANGE = 0.1
#: The matrix is factored anew when a correction is more than this fraction of the one before. Its
#: cost: validation/cost/bench.py coupled.
MAX_CONTRACTION = 0.2
#: Most steps of the boundaries, and most corrections of the fields at given boundaries: not
#: measured again.
MAX_STEPS = 40
#: Broyden's update drops combinations of steps whose singular value is below this fraction of the
#: largest one: steps that are nearly parallel show one derivative only. Not measured again.
MIN_STEP_ANGLE = 0.03

# Derivatives by parameters

#: Steps of iterative refinement of the derivatives of the fields. A step divides the error by about
#: ``1/(eps cond)`` of the matrix, with the precision eps it is factored in. Against differences of
#: solutions to 24 digits: tests/unit/studies/test_derivatives.py.
DERIVATIVE_CORRECTIONS = 4

# Samples: how many radii a field is evaluated at in one call, to look for a change of sign or a
# maximum. Not measured again: more cost time, and fewer may miss two changes of sign, or a maximum,
# between two of them.

#: Least depth x at which a field is evaluated. At the centre, x = 0, ``q/s`` is 0/0 and its
#: rounding grows like 1/s; with ``s**2 = 1 - exp(-x)`` that is a factor of 30 here.
MIN_SAMPLE_DEPTH = 1e-3
#: Radii of each step of the search for a change of sign; and of each of three looks for the largest
#: q/p: on the panels, in the tail beyond them, and around the radius of the maximum of the first
#: two, where the set that violates the friction law may be tiny. The largest q/p of full stick is
#: looked for in four steps more, each between the neighbours of the largest sample.
SAMPLES = 129
#: Points over the whole depth at which q/p of full stick is compared with the friction.
ONSET_SAMPLES = 4001

# Zones, friction law, search

# .. search (contact/zone_search.py)

#: Least stick radius that is looked for with coupling, on a smooth surface with tangential
#: compliance; where a smaller one is expected full slip is taken. At rtol 1e-6 a disk of 1e-10
#: takes 2 s and one of 1e-12 takes 42 s; at rtol 1e-10 one of 1e-10 takes 73 s. One of
#: 1.2e-8 is in tests/reference/test_coupled_zones.py.
MIN_STICK_RADIUS = 1e-10
#: Where slip goes to the centre, the pressure approaches ``s**-e/sqrt(1 - s**2)`` as s falls. The
#: relative error of this asymptote is taken to be ``C kappa f s**2``, with this number as C; a
#: measurement gave 2. Not measured again.
CENTRAL_ASYMPTOTE_ERROR = 5.0

# .. friction law (contact/friction_law.py, slip_outcome.py, slip_displacement.py, edge_stick.py)

#: Slip in the wrong sense that rounding makes, relative to the largest slip. Not measured again.
SLIP_ROUNDING = 1e-10
#: If the relative error of the slip is at least this, the boundaries of a slip zone inside the
#: contact are taken to be off by that error times the width of the zone. At the onset of slip,
#: where an ulp of f moves these boundaries by 1e-4 of the width, both errors grow together.
#: `python validation/honesty/honesty.py thresholds` checks the estimates.
UNCERTAIN_SLIP_ERROR = 0.1
#: The relative error of the displacement in slip is estimated as that of E divided by this number:
#: the displacement is an integral of E over ``1/sqrt(d)``, which is smoother than E. With 1 in its
#: place estimates of slip are 4 times as large; with 16 none of 300 true errors exceeds its
#: estimate.
#: `python validation/honesty/honesty.py coupled_slip` checks the estimates.
DISPLACEMENT_SMOOTHING = 16.0

# .. onset of slip (solving/coupled_run.py)

#: Just below the critical friction f_crit full stick stands for slip in a zone too narrow to be
#: resolved. The relative error of the fields is then this factor times ``1 - f/f_crit``.
#: `python validation/honesty/honesty.py thresholds` checks the estimates.
ONSET_ERROR_FACTOR = 3.0

# .. slip everywhere under little friction (contact/little_friction.py)

#: The *regularising disk* is the stick disk that is solved for where the true one is too small.
#: Within this number n of its radii from the centre the pressure is that of
#: the asymptote for ``s -> 0``, beyond it that of the solution, in which the disk leaves a relative
#: error of ``0.1 kappa f/n**3``. Not measured again.
CENTRAL_CLEARANCE = 128.0

# .. stick at a smooth edge (contact/edge_stick.py)
#
# The closed form of the stick at the edge is the first term for a small width w, in
# ``y = 1 - s**2``; theta is the exponent of the pressure next to it, ``p ~ y**(theta - 1/2)``. Its
# errors are those of the terms that are left out.
# `python validation/physics/edge_stick.py` measures the two errors against panels.

#: Relative error of the fields outside the stick at the edge, over ``w**(1/2 + theta)``: at most
#: 1.1 against panels.
EDGE_ERROR_OUTSIDE = 2.5
#: Relative error of the traction in the stick at the edge, over ``w ln(1/w)/beta``: at most 0.08
#: against panels.
EDGE_ERROR_INSIDE = 0.2

# .. runs and continuation (solving/run.py, solving/sharing.py)

#: The search for boundaries begins at those of similar scenes: in a sweep, extrapolated from at
#: most so many scenes before; in a growing contact, interpolated from the stick radii at at most so
#: many other contact radii. Not measured again.
PATH_POINTS = 6
