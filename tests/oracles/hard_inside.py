"""Hard cases from inside the solver: over-refined spaces, and the matrices that it factors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from unittest import mock

import numpy as np

from spectral_contact.contact import normal, zone_problem
from spectral_contact.spectral import factored as factors
from spectral_contact.spectral import regularised
from spectral_contact.spectral.cache import clear_caches
from spectral_contact.spectral.contact_matrix import system_matrix
from spectral_contact.spectral.regularised import Cholesky


@contextmanager
def overrefined(degree: int = 40, more: int = 12) -> Iterator[None]:
    """Make the solver start in spaces of this degree everywhere, with more panels."""
    normal_space, all_parts = normal.graded_space, zone_problem.first_spaces
    known_pressure_parts = zone_problem.known_pressure_spaces

    def enlarged(space):
        count = space.panels.count + more
        panels = replace(space.panels, count=count, degree=degree)
        return space._replace(panels=panels, degrees=(degree,) * count)

    def larger(layer, tolerance):
        space = normal_space(layer, tolerance)
        # where boundaries are only searched for
        return space if tolerance > 1e-7 else enlarged(space)

    def finer(parameters, radii, states, tolerance, *options):
        tighter = tolerance if tolerance > 1e-7 or len(radii) < 2 else 1e-4 * tolerance
        return all_parts(parameters, radii, states, tighter, *options)

    def known_pressure(parameters, radii, states, tolerance):
        if tolerance > 1e-7:
            return known_pressure_parts(parameters, radii, states, tolerance)
        if len(radii) < 2:
            return list(map(enlarged, known_pressure_parts(parameters, radii, states, tolerance)))
        return known_pressure_parts(parameters, radii, states, 1e-4 * tolerance)

    clear_caches()
    with (
        mock.patch.object(normal, "graded_space", larger),
        mock.patch.object(zone_problem, "first_spaces", finer),
        mock.patch.object(zone_problem, "known_pressure_spaces", known_pressure),
    ):
        yield
    clear_caches()


@contextmanager
def condition_numbers() -> Iterator[dict[str, float]]:
    """Collect the condition of the last scaled matrix of each kind that the solver factors."""
    found: dict[str, float] = {}
    last: dict[str, regularised.RegularisedProblem] = {}
    pairs: list[np.ndarray] = []
    systems: list[factors.FactoredSystem] = []

    class RecordedCholesky(Cholesky):
        def __init__(self, matrix):
            scale = 1.0 / np.sqrt(matrix.diagonal())
            pairs[:] = [matrix * scale * scale[:, None]]
            super().__init__(matrix)

    class Recorded(regularised.RegularisedProblem):
        def __init__(self, space, compliance):
            super().__init__(space, compliance)
            last["T" if space.shear else "N"] = self

    class RecordedSystem(factors.FactoredSystem):
        def __init__(self, system):
            super().__init__(system)
            systems[:] = [self]

    with (
        mock.patch.object(regularised, "RegularisedProblem", Recorded),
        mock.patch.object(factors, "FactoredSystem", RecordedSystem),
        mock.patch.object(factors, "Cholesky", RecordedCholesky),
    ):
        yield found
    for kind, factored in last.items():
        matrix = factored.compliance * factored.space.mass + factored.space.gram
        scale = 1.0 / np.sqrt(matrix.diagonal())
        found[kind] = float(np.linalg.cond(matrix * scale * scale[:, None]))
    if pairs:
        found["coupled"] = float(np.linalg.cond(pairs[-1]))
    if systems:
        matrix, scale = system_matrix(systems[-1].system), systems[-1].scale
        found["annuli"] = float(np.linalg.cond(matrix * scale * scale[:, None]))
