"""The tuned numbers of the contact problems: what each means, and what it was measured against.

A number stands here if it was chosen by a measurement. What follows from a formula stands where the
formula is. The last column of a comment names the command that measures the number again.
"""

from __future__ import annotations

# Spaces, refinement, error estimates

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
#: errors grow together. `python validation/honesty/honesty_thresholds.py` checks the estimates.
UNCERTAIN_SLIP_ERROR = 0.1
#: Violation of the friction law that rounding cannot explain, so that other zones are tried.
#: Not measured again.
REFUTING_VIOLATION = 1e-6
#: Factor by which the relative error of the displacement is below that of E in slip, because the
#: displacement is an integral of E over ``1/sqrt(d)``. Estimates of slip are 4 times as large with
#: 1; with 16 none of 300 true errors exceeds its estimate.
#: `python validation/honesty/coupled_slip_honesty.py` checks the estimates.
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
#: `python validation/honesty/honesty_thresholds.py` checks the estimates.
ONSET_ERROR_FACTOR = 3.0
#: Tolerance of coupled full stick over `ONSET`: enough to see whether ``1 - f/f_crit < ONSET``.
ONSET_TOLERANCE_FACTOR = 0.1
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
#: The width of the stick at the edge is about ``(C beta f)**(1/(1/2 - theta))`` with this C;
#: factors from 11 to 64 occur. It decides only whether the closed form is tried. Not measured
#: again.
EDGE_WIDTH_FACTOR = 30.0
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

#: Tolerance of a pressure that loads the tangential problem, over that of the solve: the error of
#: the pressure is then a small part of that of the traction. Not measured again.
PRESSURE_TOLERANCE_FACTOR = 0.1
#: Least tolerance of that pressure; rounding does not let it be met below. Not measured again.
MIN_PRESSURE_TOLERANCE = 1.2e-13
#: Scenes of a path whose boundaries are extrapolated. Not measured again.
ZONE_PATH_POINTS = 6
#: Largest step in a logarithm of alpha, beta or f over which boundaries are extrapolated.
#: Not measured again.
MAX_EXTRAPOLATION = 1.0
#: Scenes are on one line if they are off it by less than this part of their largest distance.
COLLINEARITY = 1e-6
#: Stick radii of a growing contact from which another one is interpolated. Not measured again.
STICK_PATH_POINTS = 6
