"""The tuned numbers of the contact problems: what each means, and what it was measured against.

A number stands here if it was chosen by a measurement. What follows from a formula stands where the
formula is. A comment says what the number means, what it was measured against, and the study that
shows its effect: change the number and run that command again. "Not measured again" stands where no
study shows the effect.
"""

from __future__ import annotations

# Spaces, refinement, error estimates
#
# "digits" below means ``-ln`` of the tolerance, "depth" means ``x = -ln d`` with the distance d to
# the end of a part in units of its extent, and a "slope of degrees" is degrees per digit.

# Rounding. Each of these is a relative error that no refinement removes.

#: Integral quantities (approach, total shear). Measured against 20 digits:
#: validation/honesty/honesty.py.
ROUNDING = 2e-15
#: Values of closed forms: validation/honesty/honesty.py.
CLOSED_FORM_ROUNDING = 4.0 * ROUNDING
#: The pressure, or a ratio q/p, at one place: validation/honesty/honesty.py.
FIELD_ROUNDING = 20.0 * ROUNDING
#: ``q/s`` at one place. It is least accurate at the centre: two solves of 400 scenes on different
#: panels differ by 1.8e-13 at most: validation/honesty/honesty.py coupled.
TRACTION_ROUNDING = 110.0 * ROUNDING
#: The same in full stick or on one stick disk where the tangential compliance is too small to
#: regularise the traction (beta over the stick radius below UNCORRECTED_COMPLIANCE of
#: `spectral.tuning`). 43 scenes against 20 digits have errors of 4.7e-13 at most:
#: validation/honesty/honesty.py.
RIGID_TRACTION_ROUNDING = 250.0 * ROUNDING
#: Approach and shear with slip under a known pressure. The shears of 60 random scenes, solved at
#: 1e-12 by two methods, differ by 9.6 ROUNDING at most, half of them by 0.1:
#: validation/honesty/honesty.py.
INTEGRAL_ROUNDING = 12.0 * ROUNDING
#: Boundary residuals and relative changes of fields that are smaller than this are rounding. With
#: 1e-15 or 1e-12 no space of 91 scenes is another one: validation/honesty/honesty.py.
RESIDUAL_NOISE = 1e-13

# Tolerances of inner steps

#: An error below this fraction of what it is compared with is negligible: a correction below it of
#: the tolerance is left out, and a step of the boundaries is taken when the error of the fields is
#: below it of the step. With 0.1 for corrections the estimates of shear and boundaries are 1.7 and
#: 1.9 times as large in the mean of 50 random scenes: validation/honesty/sharpness.py.
NEGLIGIBLE_FRACTION = 0.01
#: Tolerance of the space and of the steps in which boundaries are located first, and in which a
#: field is evaluated to decide what to try. A space for the root of the tolerance, in which
#: boundaries have nearly all of their digits, comes next if that root is below this. Its cost:
#: validation/cost/bench_coupled.py.
COARSE_TOL = 1e-3
#: Error of the fields from which the Jacobian is taken by differences. With 1e-5 in place of 1e-8,
#: 25 scenes take 214 corrections, not 212: validation/cost/bench_coupled.py.
JACOBIAN_FIELD_TOL = 1e-8

# Error estimates

#: The error of a field at an edge where it has a square root is this times the change of its tail,
#: of which it was 1.9 times at most: validation/honesty/honesty.py.
ROOT_EDGE_SAFETY = 2.5
#: The bound of q/p on a panel, a sum of moduli of coefficients, is multiplied by this for q/p at
#: one place. Of 120 errors none is above 0.11 of its estimate: validation/honesty/honesty.py.
RATIO_BOUND_FACTOR = 0.2
#: Relative change of the Jacobian of the boundary residual while a boundary moves by the width of
#: the narrowest zone. Not measured again; validation/honesty/honesty.py thresholds compares the
#: boundaries of narrow zones with their estimates.
JACOBIAN_CURVATURE = 8.0
#: Least contraction of one correction of the fields that is taken for the estimate of what is left.
#: With 1e-4 estimates of stick radii are 0.6 times as large in the mean of 91 scenes, and the
#: largest error is 0.55 of its estimate in place of 0.50: validation/honesty/sharpness.py.
MIN_CONTRACTION = 0.01

#: Relative distance from the critical friction up to which full stick may stand for slip that no
#: search resolves: validation/honesty/honesty.py thresholds.
ONSET_BAND = 1e-4

# Refinement

#: Refinement aims at this fraction of the tolerance, so that one more solve is rarely needed. Its
#: cost: validation/cost/bench_solve.py.
REFINEMENT_MARGIN = 0.15
#: Most degrees that one refinement adds to a panel. Its cost: validation/cost/bench_solve.py.
MAX_ADDED_DEGREES = 8
#: Highest degree of a panel. Beyond it rounding grows and the error does not fall: not measured
#: again.
MAX_DEGREE = 40
#: Most spaces that a refinement tries: not measured again.
MAX_SPACES = 12
#: Where refinement of unknown zones stalls, it begins again with the first space of this fraction
#: of the tolerance, this many times in all, and never with that of a tolerance below the last of
#: the three: not measured again. validation/net/net.py lists scenes that no longer converge.
RESTART_FACTOR = 0.1
MAX_STARTS = 3
MIN_RESTART_TOL = 1e-12

# Meshes

#: Width of a panel in x. It is cheapest at a tolerance of 1e-12: validation/cost/bench_solve.py.
PANEL_WIDTH = 2.0
#: Depth past a layer at which a singular field is its leading term, to 1e-13, ``exp(-30)``.
LEADING_TERM_DEPTH = 30.0
#: How far a tail begins below the narrowest feature at least, in x = -ln d. A boundary is off by
#: exp(-1.5 * depth) for a tail of square roots, of which the top degrees of panels show nothing.
#: With 13, at rtol 1e-4, a stick radius had an error of 5e-10 and an estimate of 3e-13.
TAIL_DEPTH = 20.0
#: How far a tail of roots begins below the narrowest feature, in x = -ln d. Derived: the three
#: polynomials that a known pressure has on its tail leave exp(-3 * 12), which is rounding. With 7
#: they left 9e-12 in a smooth scene. The traction's half-integer powers would do with 7.
ROOT_TAIL_DEPTH = 12.0
#: Meshes toward a boundary go deeper than its rounding by this in x: fields next to the end of a
#: mesh still depend on where it ends. Not measured again.
EXTRA_BOUNDARY_DEPTH = 10.0
#: Below this normal compliance the layer at the edge is thin, and the endpoint weight joins the
#: functions of the pressure: validation/cost/bench_solve.py.
SMALL_COMPLIANCE = 1e-2

# First spaces. A number that is too small costs a second solve, one that is too large unknowns:
# validation/cost/bench_solve.py and bench_coupled.py show both. An estimate decides whether a space
# is accepted; that it still bounds the error is shown by validation/honesty/honesty.py.

#: Degrees on every panel beyond those of the digits, degrees per digit, and degrees per digit in
#: addition on the first panel of a part whose far end is a singularity. With 0.55 and none in
#: addition, coupled slip takes up to 2.5 times as long: validation/cost/bench_coupled.py.
SPARE_DEGREES = 3.0
DEGREES_PER_DIGIT = 0.5
START_DEGREES = 0.4
#: A known pressure is expanded in slip to this accuracy or better: without it the slip displacement
#: of an annulus of 4e-9 has an error of 0.14 at rtol 2e-7, with it of 0.02:
#: validation/honesty/honesty.py.
MAX_SLIP_TOL = 1e-11
#: Depth by which a layer of the pressure reaches beyond its width.
LAYER_REACH = 3.0

# Free boundaries. Logits are those of the boundaries, ``ln(b**2/(1 - b**2))``.

#: Range of logits of stick radii: radii between 1e-54 and 1 - 1e-43, whose fifth powers are
#: doubles.
MIN_LOGIT = -250.0
MAX_LOGIT = 100.0
#: Least logit of the stick disk without a layer of the pressure: not measured again.
MIN_SMOOTH_LOGIT = -40.0
#: Longest step of a boundary, as a logit: not measured again.
MAX_LOGIT_STEP = 2.0
#: The Jacobian is valid while boundaries move by less than this fraction of the narrowest zone, and
#: half the step of its differences is this fraction at most. With steps of 0.03 or 0.5 no digit of
#: 25 scenes changes. validation/honesty/honesty.py thresholds counts scenes that are refused.
JACOBIAN_RANGE = 0.1
#: A last zone that is narrower than this times alpha is taken for none: 1e-12 loses annuli of
#: 4e-12, and with 1e-16 no digit of them changes: validation/honesty/honesty.py thresholds.
MIN_EDGE_ZONE_WIDTH = 1e-14
#: The matrix is factored anew when a correction is more than this fraction of the one before. Its
#: cost: validation/cost/bench_coupled.py.
MAX_CONTRACTION = 0.2
#: The search ends after more than so many steps in a row that leave more than half of the boundary
#: residual. Not measured again; validation/honesty/honesty.py thresholds counts scenes that are
#: refused.
MAX_STALLED_STEPS = 8
#: Most steps of the boundaries, and most corrections of the fields at given boundaries. Not
#: measured again.
MAX_STEPS = 40
#: Broyden's update drops combinations of steps whose singular value is below this fraction of the
#: largest one: steps that are nearly parallel show one derivative only. Not measured again.
MIN_STEP_ANGLE = 0.03

# Derivatives by parameters

#: Half the width of the interval of the nodes at which the boundary residual is evaluated for its
#: Jacobian, as a fraction of the narrowest zone. The factors of the middle still serve, and
#: polynomials through DERIVATIVE_NODES nodes are right to 1e-12: validation/honesty/sensitivity.py.
DERIVATIVE_SPAN = 0.06
DERIVATIVE_NODES = 8
#: Corrections of the derivatives of the fields, and Newton steps of the boundaries before these are
#: taken: validation/honesty/sensitivity.py.
DERIVATIVE_CORRECTIONS = 4
DERIVATIVE_NEWTON_STEPS = 2

# Samples: numbers of points at which functions are evaluated together. Not measured again: more
# cost time, and fewer may miss two changes of sign, or a maximum, between two points.

#: Least depth at which a field is evaluated: at 0 ``q/s`` is 0/0 and rounds like 1/s, here by 30.
MIN_SAMPLE_DEPTH = 1e-3
#: Points of one section of the search for a change of sign, of the first search for the largest q/p
#: on the panels and in the tail beyond them, and on either side of the radius of that maximum,
#: where the set that violates the law may be tiny.
SAMPLES = 129
#: Points over the whole depth at which q/p of full stick is compared with the friction.
ONSET_SAMPLES = 4001

# Zones, friction law, search

# .. search (contact/zone_search.py)

#: Tolerance of the fields, as a power of the tolerance of total shear and stick radius, where only
#: those two are wanted: they converge about twice as fast as the fields. Of 216 scenes of sweeps
#: with rtol 1e-8 and 1e-12 none is solved a second time; with 0.5 there are 43. Not measured again.
FIELD_TOLERANCE_EXPONENT = 0.52
#: Least width of a zone, as a difference of logits, at which the zones of a like scene are a start:
#: the Jacobian of a narrower zone changes within the width of the zone. Not measured again.
MIN_WARM_START_WIDTH = 1e-3
#: Least width in ``y = 1 - s**2`` of the stick at the edge of a smooth surface (alpha = 0 < beta)
#: for which it is a zone of the search; below, the contact is one stick disk. Not measured again.
MIN_EDGE_STICK_WIDTH = 1e-80
#: Most zones of a candidate: no scene is known to have more than four, and noise at the onset of
#: slip looks like many more. Not measured again.
MAX_ZONES = 6
#: The closed form of the stick at a smooth edge is tried if its expected relative error is below
#: this many tolerances. `python validation/physics/edge_stick.py` measures that error.
EDGE_MATCHING_SLACK = 10.0
#: The closed form of the stick at a smooth edge is tried in any case if its expected relative error
#: is below this: panels leave an error of 1e-9 at a width of 1e-20 in ``y``, of 4e-7 at 1e-24.
#: `python validation/physics/edge_stick.py`.
EDGE_MATCHING_ERROR = 1e-8
#: If ``1 - f/f_crit`` is below this, slip occupies the set where full stick has ``|q| > f p``: to
#: 0.01 in the logit of its boundary at half this value. Boundaries from a rough space are off by as
#: much in the logit. Not measured again.
NARROW_SLIP_BAND = 0.02
#: Relative error C of the pressure ``s**-e/sqrt(1 - s**2)`` in slip, over ``kappa f s**2``. The
#: measured C is 2. Not measured again.
CENTRAL_ASYMPTOTE_ERROR = 5.0
#: Distance in the logit from a stick radius that was found to the first one of the scan for larger
#: ones, and the step of that scan. On smooth surfaces radii are 10 and more apart.
#: `python validation/physics/coupled_uniqueness.py` finds the radii of random scenes.
SCAN_START = 1.0
SCAN_STEP = 4.0

# .. stick radii with elastic coupling (contact/coupled_radii.py)

#: The scan ends where ``y = 1 - c**2`` is below the smaller compliance by a factor of exp of this:
#: there the slip is within the layers, where nothing changes any more. Not measured again.
SCAN_PAST_LAYERS = 8.0
#: Accuracy, in the logit, of a stick radius of the scan. Not measured again.
SCAN_ACCURACY = 0.02

# .. friction law (contact/friction_law.py, slip_outcome.py, edge_stick.py)

#: Slip in the wrong sense that rounding makes, relative to the largest slip. Not measured again.
SLIP_ROUNDING = 1e-10
#: Error of slip relative to its largest value over ``w**(3/2)``, where the boundaries of a slip
#: zone are off by a fraction w of its width: slip over a narrow annulus is like
#: ``(x (1 - x))**(3/2)``, which is ``8 x**(3/2)`` of its largest value next to an end. 10 leaves
#: room.
BOUNDARY_SLIP_FACTOR = 10.0
#: Violation of the friction law at which zones are refuted if no digit of the slip is known: a
#: missing zone violates it by 1, and zones that follow from less are noise. Not measured again.
DOUBTFUL_VIOLATION = 0.5
#: Relative error of slip from which on a zone of slip inside is taken to be off by as much of its
#: width: at the onset of slip, where an ulp of f moves its boundaries by 1e-4 of the width, both
#: errors grow together. `python validation/honesty/honesty.py thresholds` checks the estimates.
UNCERTAIN_SLIP_ERROR = 0.1
#: Violation of the friction law that rounding cannot explain, so that other zones are tried.
#: Not measured again.
REFUTING_VIOLATION = 1e-6
#: Factor by which the relative error of the displacement is below that of E in slip, because the
#: displacement is an integral of E over ``1/sqrt(d)``. Estimates of slip are 4 times as large with
#: 1; with 16 none of 300 true errors exceeds its estimate.
#: `python validation/honesty/honesty.py coupled_slip` checks the estimates.
DISPLACEMENT_SMOOTHING = 16.0

# .. onset of slip (contact/onset.py, solving/coupled_run.py)

#: Least relative error of a stick radius of 1 if slip is about to start: an annulus opens like the
#: square root of ``1 - f/f_crit``, which is 1e-13 at best.
UNRESOLVED_SLIP = 1e-6
#: Slip is wider than the set where full stick violates ``|q| <= f p``; the set for ``1 - f/f_crit``
#: enlarged by this factor contains the slip. The slip is less than twice as wide where the width of
#: the set goes like ``sqrt(1 - f/f_crit)``, less than four times where like ``1 - f/f_crit``.
#: Not measured again.
SLIP_WIDENING = 4.0
#: Slip narrower than this in the logit may fall between rings, so that the place where full stick
#: violates the law is tried before the zones on rings. Not measured again.
NARROW_SLIP = 0.25
#: Error of full stick in place of slip that was not resolved, over ``1 - f/f_crit``.
#: `python validation/honesty/honesty.py thresholds` checks the estimates.
ONSET_ERROR_FACTOR = 3.0
#: With coupling, slip is not looked for if ``1 - f/f_crit`` is below this and full stick meets the
#: tolerance in its place. Not measured again.
OPTIONAL_SEARCH = 1e-8
#: With coupling, slip is never looked for if ``1 - f/f_crit`` is below this, because rounding hides
#: it: at 1e-11 all annuli were found, at 1e-12 some, at 1e-13 hardly any. Not measured again.
HIDDEN_SLIP = 3e-13

# .. active set on rings (contact/active_set.py)
#
# `python validation/honesty/ring_zones.py` measures, for all of these together, in how many scenes
# the zones are right, the systems solved and the time, with several numbers of rings and splits.

#: Rings of the first grid, without those next to the centre and the edge.
FIRST_RINGS = 60
#: How often the rings around boundaries are split.
RING_SPLITS = 2
#: Changes of all wrong rings at once that may fail to lower their number before one ring is changed
#: at a time.
RING_PATIENCE = 4
#: Most systems of one active set: random scenes took 12, or 33 where friction and coupling are
#: strong.
MAX_RING_SYSTEMS = 40
#: Distances of ring boundaries from the edge are even numbers to this power. With 3 or 5 the
#: approach is as good (a relative error of 1e-5 with 60 rings); rings that are equally wide in the
#: logit all the way err 60 times as much.
RING_GRADING = 4
#: Width in the logit of the widest rings; 25 scenes have the same zones with 0.75 and with 3.
MAX_RING_WIDTH = 1.5
#: Number of rings into which a ring next to a boundary is split.
RINGS_PER_SPLIT = 4
#: Number of rings that are split on either side of a boundary.
SPLIT_NEIGHBOURS = 2
#: Zones of at most so many rings between others are taken for an error of the rings, which is
#: largest where wide rings meet narrow ones. A third of random scenes near an onset had up to three
#: rings that stick amid slip, or slip amid stick.
MAX_SPURIOUS_RINGS = 3

# .. slip everywhere under little friction (contact/little_friction.py)

#: Number of regularising radii from the centre at which the pressure is used: at n radii its error
#: is ``0.1 kappa f/n**3``. Not measured again.
CENTRAL_CLEARANCE = 128.0
#: Largest radius of the stick disk in place of a smaller one. Not measured again.
MAX_REGULARISING_RADIUS = 2.0**-11

# .. stick at a smooth edge (contact/edge_stick.py)
#
# `python validation/physics/edge_stick.py` measures the two errors against panels.

#: Relative error of the fields outside the stick at the edge, over ``w**(1/2 + theta)``: at most
#: 1.1 against panels.
EDGE_ERROR_OUTSIDE = 2.5
#: Relative error of the traction in the stick at the edge, over ``w ln(1/w)/beta``: at most 0.08
#: against panels.
EDGE_ERROR_INSIDE = 0.2
#: Least width of the stick at the edge in ``y``: down to it a radius keeps its distance from the
#: edge within the range of doubles. A narrower one is left out.
MIN_MATCHED_WIDTH = 1e-290
#: Largest width of the stick at the edge over that of half the slip zone; a wider stick is refused,
#: because the closed form is that of a narrow one. Not measured again.
MAX_MATCHED_WIDTH = 0.1
#: Degree of the panels on which the closed form is sampled: right to rounding. Not measured again.
EDGE_SAMPLING_DEGREE = 24
#: How far below the width w the panels of the closed form reach, in ``-ln y``, beyond the depth of
#: the rounding of doubles, ``-ln eps``. Not measured again.
EDGE_SAMPLING_MARGIN = 4.0

# .. runs and continuation (solving/run.py, solving/sharing.py)

#: The tolerance of an inner problem is this times what its error adds to, of which it is then a
#: small part: a pressure that loads the tangential problem, whose error adds to that of the
#: traction, and coupled full stick, whose critical friction decides whether ``1 - f/f_crit`` is
#: below `ONSET_BAND`. With 0.1 full stick at alpha = 0.01, beta = 0 does not converge at rtol
#: 1e-11, because the error of the pressure is 30 times as large in the traction at the centre.
INNER_TOLERANCE_FACTOR = 0.01
#: Number of scenes of a path from which boundaries are extrapolated, and of stick radii of a
#: growing contact from which another one is interpolated. Not measured again.
PATH_POINTS = 6
#: Largest step in a logarithm of alpha, beta or f over which boundaries are extrapolated.
#: Not measured again.
MAX_EXTRAPOLATION = 1.0
#: Scenes are on one line if they are off it by less than this part of their largest distance.
COLLINEARITY = 1e-6
