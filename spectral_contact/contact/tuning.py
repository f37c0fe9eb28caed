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
#: ``q/s`` at one place. It is least accurate at the centre, where ten scenes have an error of
#: 9e-14: validation/honesty/honesty.py.
TRACTION_ROUNDING = 60.0 * ROUNDING
#: TRACTION_ROUNDING is multiplied by this in full stick whose pressure is unknown or infinite at
#: the edge. Two solves of 400 scenes on different panels differ by 1.8e-13 at most:
#: validation/honesty/honesty.py --coupled.
CENTRE_ROUNDING_FACTOR = 1.8
#: TRACTION_ROUNDING is multiplied by this where the tangential compliance is too small to
#: regularise the traction (beta over the stick radius below `spectral.regularised.HARMLESS`). 43
#: scenes against 20 digits have errors of 4.7e-13 at most: validation/honesty/honesty.py.
RIGID_ROUNDING_FACTOR = 4.2
#: Approach and shear of full stick: rounding that adds to their estimates. Not measured by itself;
#: validation/honesty/honesty.py would show an estimate that is too small.
STICK_INTEGRAL_ROUNDING = 2.0 * ROUNDING
#: The same with slip under a known pressure. The shears of 60 random scenes, solved at 1e-12 by two
#: methods, differ by 9.6 ROUNDING at most, half of them by 0.1: validation/honesty/honesty.py.
KNOWN_PRESSURE_INTEGRAL_ROUNDING = 12.0 * ROUNDING
#: The same with slip and an unknown pressure: validation/honesty/coupled_slip_honesty.py.
COUPLED_INTEGRAL_ROUNDING = 2.0 * FIELD_ROUNDING
#: Boundary residuals and relative changes of fields that are smaller than this are rounding. With
#: 1e-15 or 1e-12 no space of 91 scenes is another one: validation/honesty/honesty.py.
RESIDUAL_NOISE = 1e-13

# Tolerances of inner steps

#: Corrections that are smaller than this share of the tolerance are left out. With 0.1 the
#: estimates of shear and boundaries are 1.7 and 1.9 times as large in the mean of 50 random scenes:
#: validation/honesty/sharpness.py.
NEGLIGIBLE_SHARE = 0.01
#: Tolerance of the space and of the steps in which several boundaries are located first. Its cost:
#: validation/cost/bench_coupled.py.
COARSE_TOL = 1e-3
#: Boundaries superconverge: a space for the root of the tolerance has nearly all of their digits,
#: so they are moved in it first, if that root is below this. Its cost:
#: validation/cost/bench_solve.py.
HALFWAY_TOL = 1e-4
#: Tolerance of the space in which the boundary of one stick disk is located, and in which a field
#: is evaluated to decide what to try. With 0.03 it takes 1 % fewer solutions:
#: validation/cost/bench_solve.py.
PROBE_TOL = 1e-2
#: Error of the fields from which the Jacobian is taken by differences. With 1e-5 in place of 1e-8,
#: 25 scenes take 214 corrections, not 212: validation/cost/bench_coupled.py.
JACOBIAN_FIELD_TOL = 1e-8

# Error estimates

#: The error of a field on a panel is estimated by this times ``change * rate``, where the change is
#: what the top two degrees contribute and the rate is the decay of the coefficients per degree: the
#: change is about ``rate**-2`` times the error. Of 4400 random scenes the estimate is 1.1 times the
#: error or more: validation/honesty/honesty.py.
POINTWISE_SAFETY = 1.6
#: The error of a functional, or of a linear map of a field, is estimated by this times its change
#: and a power of the rate. Of 300 random scenes the largest errors of shear and boundaries are 0.57
#: and 0.53 of their estimates: validation/honesty/honesty.py, validation/honesty/sharpness.py.
FUNCTIONAL_SAFETY = 4.5
#: Rate of decay that is taken for changes of boundary residuals, which may be small by
#: cancellation, and the least one by which panels with slow decay are found:
#: validation/honesty/honesty.py.
BOUNDARY_DECAY_RATE = 0.25
#: Bounds of the rate of decay per degree, and the rate that is taken where a rate from coefficients
#: is below that of ``exp(-x)``, so that it must be an accident of signs. With these none of 10,000
#: random scenes has an estimate below its error: validation/honesty/honesty.py.
MIN_DECAY_RATE = 0.05
MAX_DECAY_RATE = 0.6
DEFAULT_DECAY_RATE = 0.3
#: Least rate of decay on the last panel toward a sticking edge under a known pressure, where q has
#: terms ``y ln y``, whose coefficients fall only like a power of the degree. Of 870 scenes and
#: tolerances errors are 0.75 of estimates at most: validation/honesty/honesty.py.
EDGE_DECAY_RATE = 0.5
#: The error of a field at an edge where it has a square root is this times the change of its tail,
#: of which it was 1.9 times at most: validation/honesty/honesty.py.
ROOT_EDGE_SAFETY = 2.5
#: The bound of q/p on a panel, a sum of moduli of coefficients, is multiplied by this for q/p at
#: one place. Of 10,000 errors none is above 0.6 of its estimate; with 1/6 one was 1.8 times its
#: estimate: validation/honesty/honesty.py.
RATIO_BOUND_FACTOR = 0.5
#: Relative change of the Jacobian of the boundary residual while a boundary moves by the width of
#: the narrowest zone. Not measured again; validation/honesty/honesty_thresholds.py compares the
#: boundaries of narrow zones with their estimates.
JACOBIAN_CURVATURE = 8.0
#: Least contraction of one correction of the fields that is taken for the estimate of what is left.
#: With 1e-4 estimates of stick radii are 0.6 times as large in the mean of 91 scenes, and the
#: largest error is 0.55 of its estimate in place of 0.50: validation/honesty/sharpness.py.
MIN_CONTRACTION = 0.01

#: Relative distance from the critical friction up to which full stick may stand for slip that no
#: search resolves: validation/honesty/honesty_thresholds.py.
ONSET_BAND = 1e-4

# Refinement

#: Refinement aims at this share of the tolerance, so that one more solve is rarely needed. Its
#: cost: validation/cost/bench_solve.py.
REFINEMENT_MARGIN = 0.15
#: Most degrees that one refinement adds to a panel. Its cost: validation/cost/bench_solve.py.
MAX_ADDED_DEGREES = 8
#: Highest degree of a panel. Beyond it rounding grows and the error does not fall: not measured
#: again.
MAX_DEGREE = 40
#: Most spaces that a refinement tries: not measured again.
MAX_SPACES = 12
#: Where refinement of unknown zones stalls, it begins again with the first space of this share of
#: the tolerance, this many times in all, and never with that of a tolerance below the last of the
#: three: not measured again. validation/net.py lists scenes that no longer converge.
RESTART_FACTOR = 0.1
MAX_STARTS = 3
MIN_RESTART_TOL = 1e-12

# Meshes

#: Width of a panel in x. It is cheapest at a tolerance of 1e-12: validation/cost/bench_solve.py.
PANEL_WIDTH = 2.0
#: Depth past a layer at which a singular field is its leading term, to 1e-13, ``exp(-30)``.
LEADING_TERM_DEPTH = 30.0
#: Depth past a layer at which the powers of ``sqrt(d)`` of a tail of roots (`spectral.panels`) are
#: exact to rounding: validation/honesty/honesty.py, scenes with beta = 0.
ROOT_TAIL_DEPTH = 7.0
#: Meshes toward a boundary go deeper than its rounding by this in x: fields next to the end of a
#: mesh still depend on where it ends. Not measured again.
EXTRA_BOUNDARY_DEPTH = 10.0
#: Below this normal compliance the layer at the edge is thin, and the endpoint weight joins the
#: functions of the pressure: validation/cost/bench_solve.py.
SMALL_COMPLIANCE = 1e-2

# First spaces. A number that is too small costs a second solve, one that is too large unknowns:
# validation/cost/bench_solve.py and bench_coupled.py show both. An estimate decides whether a space
# is accepted; that it still bounds the error is shown by validation/honesty/honesty.py.

#: Slope of degrees on any panel and, in addition, at a bend of the pressure (normal contact). With
#: 0.43 in place of 0.45 four of 46 random scenes of full stick need another space; with 0.15 in
#: place of 0.2 the critical friction of one was 18 times as far off under the same estimate.
NORMAL_DEGREES = 0.45
NORMAL_BEND_DEGREES = 0.2
#: A bend adds all its degrees to panels whose middles are nearer than BEND_REACH - 1 of BEND_TAPER
#: panels, and none to those farther than BEND_REACH of them.
BEND_REACH = 2.6
BEND_TAPER = 1.2
#: Slope of degrees toward the ends of a slip zone: with 0.5 estimates of the slip are 6 times as
#: large: validation/honesty/honesty.py.
SLIP_DEGREES = 0.7
#: A known pressure is expanded in slip to this share of the tolerance, and to MAX_SLIP_TOL or
#: closer. Without that bound the slip displacement of an annulus of 4e-9 has an error of 0.14 at
#: rtol 2e-7, with it of 0.02: validation/honesty/honesty.py.
SLIP_TOL_SHARE = 0.01
MAX_SLIP_TOL = 1e-11
#: Slopes of degrees of two fields on zones: on any panel; in addition at a bend; and at a weak
#: bend, where a layer only changes the amplitude, or on the second panel.
ZONE_DEGREES = 0.43
BEND_DEGREES = 0.15
WEAK_BEND_DEGREES = 0.08
#: In addition on the first panel, whose far end is a singularity at a depth of ``-ln 2``: of the
#: stick disk, which has none at the centre but above its rim; of other parts; and at the edge.
DISK_START_DEGREES = 0.28
ANNULUS_START_DEGREES = 0.54
EDGE_START_DEGREES = 0.43
#: Depth before a layer at which the fields bend: in full stick, or toward a boundary.
BEND_LEAD = 3.0
#: Depth by which a layer of the pressure reaches beyond its width, toward an edge with slip around
#: it: it bends so much before, and settles so much after it.
EDGE_LAYER_REACH = 4.0
#: Degrees on every panel beyond those of the digits. In full stick with unknown pressure: with 1,
#: and none of WEAK_BEND_DEGREES at the centre, 32 of 820 scenes and tolerances need a second space;
#: with these, one.
STICK_SPARE_DEGREES = 1.1
#: In full stick under a known pressure, which decides on slip, and on a stick disk without
#: tangential compliance, whose traction has a root at the rim: with 1 the friction at which slip
#: begins is not accurate.
KNOWN_PRESSURE_SPARE_DEGREES = 3.0

# Free boundaries. Logits are those of the boundaries, ``ln(b**2/(1 - b**2))``.

#: Range of logits of stick radii: radii between 1e-54 and 1 - 1e-43, whose fifth powers are
#: doubles.
MIN_LOGIT = -250.0
MAX_LOGIT = 100.0
#: Least logit of the stick disk without a layer of the pressure: not measured again.
MIN_SMOOTH_LOGIT = -40.0
#: Longest step of a boundary, as a logit: not measured again.
MAX_LOGIT_STEP = 2.0
#: Secant steps for one stick radius begin with this slope of the boundary residual in the logit.
#: Not measured again.
FIRST_SECANT_SLOPE = 0.5
#: Most secant steps, of which 4 are enough but next to onsets: not measured again.
MAX_SECANT_STEPS = 10
#: Half the step of a central difference in a logit; a change below RESIDUAL_NOISE after a step so
#: short shows a slope to one per cent or worse, and is not used.
SHORT_LOGIT_STEP = 1e-3
#: Half the step of the same where SHORT_LOGIT_STEP shows rounding: right to two digits.
WIDE_LOGIT_STEP = 0.05
#: Largest step of a difference for the Jacobian, as a share of the narrowest zone: with 0.03 or 0.5
#: no digit of 25 scenes changes.
MAX_DIFFERENCE_SHARE = 0.2
#: The Jacobian is valid while boundaries move by less than this share of the narrowest zone: not
#: measured again. validation/honesty/honesty_thresholds.py counts scenes that are refused.
JACOBIAN_RANGE = 0.1
#: A last zone that is narrower than this share of alpha is taken for none: 1e-12 loses annuli of
#: 4e-12, and with 1e-16 no digit of them changes: validation/honesty/honesty_thresholds.py.
MIN_EDGE_ZONE_SHARE = 1e-14
#: The matrix is factored anew when a correction is more than this share of the one before. Its
#: cost: validation/cost/bench_coupled.py.
MAX_CONTRACTION = 0.2
#: A step of the boundaries is taken when the fields are accurate to this share of it: not measured
#: again.
FIELD_TO_STEP = 0.01
#: A step longer than this share of the one before is a stalled one, and the search ends after more
#: than so many stalled steps in a row. Not measured again; validation/honesty/honesty_thresholds.py
#: counts scenes that are refused.
STALLED_STEP_RATIO = 0.5
MAX_STALLED_STEPS = 8
#: Most steps of the boundaries, and most corrections of the fields at given boundaries. Not
#: measured again.
MAX_NEWTON_STEPS = 40
MAX_CORRECTIONS = 30
#: Broyden's update drops combinations of steps whose singular value is below this share of the
#: largest one: steps that are nearly parallel show one derivative only. Not measured again.
MIN_STEP_ANGLE = 0.03

# Derivatives by parameters

#: Half the width of the interval of the nodes at which the boundary residual is evaluated for its
#: Jacobian, as a share of the narrowest zone. The factors of the middle still serve, and
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
#: Points of one section of the search for a change of sign.
SIGN_CHANGE_SAMPLES = 65
#: Points of the first search for the largest q/p on the panels, and in the tail beyond them.
RATIO_SAMPLES = 129
RATIO_TAIL_SAMPLES = 64
#: Nodes of the polynomial of q/p between two of these points. As q/p is analytic up to an imaginary
#: part of about pi in x, it is right to rounding.
RATIO_NODES = 16
#: Points of a Gauss rule for the pressure over ``1/2 <= y <= 1``, where it is analytic up to the
#: edge, at a distance of half the interval or more: right to rounding.
CENTRAL_LOAD_POINTS = 40

# Zones, friction law, search
