"""Scenes of normal contact and of full stick whose numbers follow from spectra, without a solve.

The spectra (`spectra`) are decompositions that serve all compliances, with errors of `error_maps`.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields import Array
from spectral_contact.fields.shakedown import shakedown
from spectral_contact.quantities import FULL_STICK_RATIOS
from spectral_contact.sweeps.error_maps import certified_normal, certified_stick
from spectral_contact.sweeps.request import Request, Served
from spectral_contact.sweeps.sweep_parameters import Columns

Mask = NDArray[np.bool_]

_NORMAL_QUANTITIES: Final = frozenset({"approach", "pressure"})
#: Quantities that the spectra have only where nothing slips.
_STICK_QUANTITIES: Final = frozenset({"total_shear", "stick_radius"})
#: Below this compliance, normal or tangential, the edge layer is so thin that the spectra lose
#: digits of values at a point: their errors are about eps over the root of the compliance, and now
#: and then much larger. `solve` keeps these digits by an endpoint weight and a correction.
_LEAST_POINTWISE: Final = 1e-6


def eligible(columns: Columns, request: Request) -> Mask:
    """Return a mask of the scenes that the spectra may serve, judged by their parameters alone."""
    names = frozenset(request.quantities)
    alpha = columns.alpha
    beta = columns.beta
    friction = columns.friction
    mask: Mask = (alpha > 0.0) & ~columns.coupled & columns.at_largest_load
    thin = np.minimum(alpha, beta) < _LEAST_POINTWISE
    if names & FULL_STICK_RATIOS:
        mask &= ~thin
    elif (
        names & _STICK_QUANTITIES
    ):  # whether anything slips depends on the critical friction, a ratio
        mask &= ~thin | (friction == np.inf)
    if not names <= _NORMAL_QUANTITIES | FULL_STICK_RATIOS | _STICK_QUANTITIES:
        mask[:] = False
    if "pressure" in names and not request.at_edge_alone:
        mask[:] = False
    if names & (FULL_STICK_RATIOS | _STICK_QUANTITIES):  # NaN, no friction, compares False
        mask &= (beta > 0.0) & (columns.kappa != 0.0) & (friction >= 0.0)
    return mask


def served_by_spectra(columns: Columns, request: Request) -> Served:
    """Return the results that spectra have to the tolerance; other scenes are left to `solve`."""
    mask = eligible(columns, request)
    values: dict[str, Array] = {}
    errors: dict[str, Array] = {}
    candidates = columns[mask]
    if len(candidates):
        names = frozenset(request.quantities)
        if names & _NORMAL_QUANTITIES:
            _normal(candidates, values, errors)
        accurate = np.ones(len(candidates), dtype=bool)
        if names & (FULL_STICK_RATIOS | _STICK_QUANTITIES):
            accurate = _full_stick(candidates, request, values, errors)
        for name in names:
            # next to the critical friction the shakedown ratio has fewer digits than rtol, also if
            # the scene is solved
            bound = "critical_friction" if name == "shakedown_ratio" else name
            accurate &= errors[bound] <= request.rtol
        mask[mask] = accurate
        values = {name: values[name][accurate] for name in names}
        errors = {name: errors[name][accurate] for name in names}
    return Served(mask, values, errors)


def _normal(columns: Columns, values: dict[str, Array], errors: dict[str, Array]) -> None:
    """Add approach and edge pressure, a field at one place, with their errors."""
    fields, field_errors = certified_normal().approach(columns.alpha)
    values["approach"], pressure = fields
    values["pressure"] = pressure[:, None]
    errors["approach"], errors["pressure"] = field_errors


def _full_stick(
    columns: Columns, request: Request, values: dict[str, Array], errors: dict[str, Array]
) -> Mask:
    """Add the quantities of full stick, and return a mask of the scenes that have these values.

    The ratios are defined by full stick, whatever the friction of a scene. Total shear and stick
    radius are those of full stick only if its friction is above the critical one, by more than the
    error of that.
    """
    alpha = columns.alpha
    beta = columns.beta
    friction = columns.friction
    kappa = np.abs(columns.kappa)
    stick = certified_stick(request.rtol)
    (shear, edge), (shear_error, edge_error) = stick.shear_and_edge(alpha, beta)
    values.update(
        total_shear=columns.kappa * shear,
        edge_ratio=kappa * edge,
        stick_radius=np.ones(len(columns)),
    )
    errors.update(
        total_shear=shear_error, edge_ratio=edge_error, stick_radius=np.zeros(len(columns))
    )
    names = frozenset(request.quantities)
    sticks = friction == np.inf
    may_slip = bool(names & _STICK_QUANTITIES) and not sticks.all()
    if not names.isdisjoint(("critical_friction", "shakedown_ratio")) or may_slip:
        critical, critical_error = stick.critical(alpha, beta, edge)
        values["critical_friction"], errors["critical_friction"] = kappa * critical, critical_error
        values["shakedown_ratio"], errors["shakedown_ratio"] = shakedown(
            kappa * critical, critical_error, friction
        )
        sticks |= friction > kappa * critical * (1.0 + 2.0 * critical_error)
    return sticks if names & _STICK_QUANTITIES else np.ones(len(columns), dtype=bool)
