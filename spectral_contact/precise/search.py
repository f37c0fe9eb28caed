"""Zones on which the friction law holds: solve, check the law everywhere, change the zones."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from spectral_contact.errors import ConvergenceError, NotComputedError
from spectral_contact.fields.series import Radius
from spectral_contact.precise.law_breaches import Breach, obeying
from spectral_contact.precise.precise_coupled_run import PreciseCoupledRun
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.zone_trial import PreciseLayout
from spectral_contact.scene import Scene
from spectral_contact.view.progress import silent

_MOST_ROUNDS = 12
#: If a boundary is found farther than this from its guess, in logits, the zones are solved again on
#: meshes that are made for the boundary found.
_FAR = 0.5


def solved(
    scene: Scene,
    digits: int,
    width: float,
    layout: PreciseLayout | None,
    tell: Callable[[str], None] = silent,
    near: PreciseRun | PreciseCoupledRun | None = None,
    *,
    held: bool = False,
) -> PreciseRun | PreciseCoupledRun:
    """Return the solution on one mesh and these zones, whether or not the friction law holds.

    The arguments are those of `PreciseRun`.
    """
    if scene.couples:
        return PreciseCoupledRun(scene, digits, width, tell)
    assert not isinstance(near, PreciseCoupledRun)
    run = PreciseRun(scene, digits, width, layout, tell, near, held=held)
    _ = run.approach, run.total_shear  # properties that solve when they are first read
    return run


def lawful(
    scene: Scene,
    digits: int,
    width: float,
    layout: PreciseLayout | None,
    tell: Callable[[str], None] = silent,
) -> PreciseRun | PreciseCoupledRun:
    """Return the solution on zones on which the friction law holds.

    Parameters
    ----------
    scene : Scene
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width in ``-ln d``.
    layout : PreciseLayout or None
        The zones at which the search begins. None leaves the tangential problem out.
    tell : callable
        Is told every step.

    Raises
    ------
    ConvergenceError
        If no such zones are found, or these digits do not decide whether the law holds.
    NotComputedError
        With elastic coupling, if friction is too small for full stick.
    """
    held = False
    found = list[Breach]()
    for _ in range(_MOST_ROUNDS):
        try:
            run = solved(scene, digits, width, layout, tell, held=held)
        except ConvergenceError:
            # boundaries can be held at any place only if there is a tangential compliance: without,
            # there is a solution at the right boundaries alone
            if held or layout is None or not (layout.radii and scene.tangential_compliance):
                raise
            # with boundaries held where they are the problem is linear, and the breaches of the law
            # on its solution show how to change the zones
            held = True
            continue
        tell("friction law")
        found = run.breaches()
        if not (found or held or _moved(layout, run) > _FAR):
            return run
        if isinstance(run, PreciseCoupledRun):
            raise NotComputedError("the reference", f"it slips: {found[0]}")
        layout = _changed(run, found)
        held = False
    raise _no_zones(found)


def _no_zones(found: list[Breach]) -> ConvergenceError:
    """Return the error of a search that ends without zones."""
    last = f"on the last zones {found[0]}" if found else "the last boundaries did not settle"
    cause = f"the friction law holds on no zones that were tried; {last}"
    return ConvergenceError(cause, "ask for more digits")


def _changed(run: PreciseRun, found: list[Breach]) -> PreciseLayout:
    """Return zones whose states are changed where the friction law does not hold."""
    assert run.layout is not None
    states = run.layout.states
    logits = run.logits
    if found:
        known = [one for one in found if one.decided]
        if not known:
            raise ConvergenceError(f"{found[0]}", "ask for more digits")
        states, logits = obeying(states, logits, known)
    # the centre sticks; zones that slip in opposite directions cannot meet, as the traction between
    # them would pass 0
    slip_meets_slip = any(a and b for a, b in pairwise(states))
    if states[0] or slip_meets_slip:
        raise _no_zones(found)
    return PreciseLayout(states, tuple(_radius(run, x) for x in logits))


def _radius(run: PreciseRun, logit: Any) -> Radius:
    """Return a boundary as a radius in doubles and its distance from the edge."""
    mp = run.fixed.mp
    value = 1 / mp.sqrt(1 + mp.exp(-logit))
    return Radius(float(value), float(1 / ((1 + mp.exp(logit)) * (1 + value))))


def _moved(layout: PreciseLayout | None, run: PreciseRun | PreciseCoupledRun) -> float:
    """Return the largest distance, in logits, of a boundary from its guess."""
    if layout is None or isinstance(run, PreciseCoupledRun):
        return 0.0
    pairs = zip(layout.radii, run.logits, strict=True)
    return max((abs(float(x) - radius.logit) for radius, x in pairs), default=0.0)
