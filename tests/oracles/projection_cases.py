"""Matrices as the solver builds them, entry by entry beside the oracle.

The tests take a sample of these, validation/honesty/projections.py all. A `Case` has blocks of the
lowest and highest degree that two panels have in a space of the solver.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import log, pi, sqrt

import numpy as np

from oracles.projection_oracle import Place, basis, entries, moments, mp, rows
from oracles.whole_spaces import ordered
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.normal import WEIGHT_SHIFT, solve_normal
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import EdgeWeight
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.spaces import unit_space

TAIL = -1


@dataclass
class Case:
    """Blocks by the library and by the oracle.

    Attributes
    ----------
    doubles : dict
        For each kernel the block, the scales ``sqrt(A_ii)`` of its rows and those of its columns.
    places : tuple of list
        Rows and columns in the whole basis.
    exact : callable
        Blocks of the same kernels by the oracle with rules of the given density.
    """

    doubles: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]
    places: tuple[list[int], list[int]]
    exact: Callable[[float], dict]


# --- the disk -------------------------------------------------------------------------------------


@cache
def solver_matrix(resolution: DiscreteSpace, kernel: str):
    """Return the Gram matrix of a space of the solver, and the functions it has, increasing."""
    space = unit_space(resolution.panels, resolution.degrees, shear=kernel == "K2")
    return ordered(space, space.gram), np.sort(space.index)


def extremes(resolution: DiscreteSpace, number: int) -> tuple[int, int]:
    """Return the lowest and the highest degree on a panel."""
    panels = resolution.panels
    return (0, panels.tail_terms - 1) if number == TAIL else (0, resolution.degrees[number])


def disk_case(resolution: DiscreteSpace, first: int, second: int) -> Case:
    """Return two panels of the unit disk; the first is not the deeper one."""
    panels = resolution.panels
    degrees = {n: extremes(resolution, n) for n in (first, second)}
    pieces = {n: basis(panels, n, degrees[n]) for n in degrees}
    places = tuple(rows(panels, n, degrees[n]) for n in (first, second))
    doubles = {}
    for kernel in ("K1", "K2"):
        gram, columns = solver_matrix(resolution, kernel)
        index = [np.searchsorted(columns, place) for place in places]
        scale = np.sqrt(gram.diagonal())
        doubles[kernel] = gram[np.ix_(*index)], scale[index[0]], scale[index[1]]

    def exact(density):
        blocks = entries(pieces[first], pieces[second], density)
        return dict(zip(("K1", "K2"), blocks, strict=True))

    return Case(doubles, places, exact)


# --- the right-hand side of the endpoint lift -----------------------------------------------------


def lift_case(resolution: DiscreteSpace, compliance: float, number: int) -> Case:
    """Return a panel against the lift, two columns: ``<phi, 1 - N lift>`` and ``<phi, lift>``.

    The scale of the first column is the energy norm of what the lift leaves, that of the second
    is the lift's norm in ``s ds``.
    """
    panels = resolution.panels
    weight = EdgeWeight(4.0 / pi, WEIGHT_SHIFT * compliance)
    degrees = extremes(resolution, number)
    place = rows(panels, number, degrees)
    space = unit_space(panels, resolution.degrees)
    deficit = weight.deficit(space.y)
    gram, columns = solver_matrix(resolution, "K1")
    right = np.zeros(panels.size)
    right[space.index] = space.moments(deficit)
    load = load_vector(panels, lambda d: 0.5 * weight(d))
    own = np.searchsorted(columns, place)
    scale = np.sqrt(gram.diagonal()[own])
    left = sqrt(float(space.measure @ deficit**2))
    norm = weight.amplitude * sqrt(log((1.0 + weight.shift) / weight.shift) / 2.0)
    doubles = {
        "K1": (right[place, None], scale, np.array([left])),
        "load": (
            load[place, None],
            np.sqrt(ordered(space, space.mass).diagonal()[own]),
            np.array([norm]),
        ),
    }
    shift = mp.mpf(weight.shift)

    def lift(d):
        return 4 / mp.pi / mp.sqrt(d + shift)

    own = basis(panels, number, degrees, extra=lift)
    order = [*range(panels.count), TAIL]

    def exact(density):
        column = mp.matrix(moments(own, density)[:2])
        for other in order:
            if other == number:
                column -= entries(own, own, density)[0][:2, 2]
                continue
            piece = basis(panels, other, (), extra=lift)
            if order.index(other) < order.index(number):
                column -= entries(piece, own, density)[0][0, :2].T
            else:
                column -= entries(own, piece, density)[0][:2, 0]
        return {"K1": column, "load": mp.matrix(moments(own, density, lift)[:2])}

    return Case(doubles, (place, [0]), exact)


# --- a stick annulus and the stick disk inside of it ----------------------------------------------


class Zones:
    """Stick, slip and stick to the edge: the matrices of the solver at these boundaries."""

    def __init__(self, alpha: float, beta: float, friction: float, boundaries, tolerance: float):
        contact = solve_normal(alpha, tolerance, 3000).best.value
        logits = tuple(log(b * b / (1.0 - b * b)) for b in boundaries)
        parameters = Parameters(alpha, beta, 1.0, friction)
        layout = Layout(logits, (0, 1, 0))
        problem = FreeBoundaryProblem(parameters, layout, tolerance, known=contact)
        system = problem.system(problem.spaces(tolerance, np.array(logits)), np.array(logits))
        self.radii, self.parts = system.radii, system.parts
        self.fields = {field.part: field for field in system.fields}
        self.gram = np.zeros((system.unknowns, system.unknowns))
        operators = system.operators
        for outer, weights in zip(operators.outer_stick, operators.shear_weights, strict=True):
            for k, j, product in outer.products(outer, weights, other_values=True):
                self.gram[self.fields[k].place, self.fields[j].place] += product

    def space(self, k: int) -> DiscreteSpace:
        """Return the space of a part: 0 is the disk, the last two are the stick annulus."""
        return DiscreteSpace(self.fields[k].panels, self.fields[k].degrees)

    def places(self, k: int, number: int, degrees) -> list[int]:
        """Return where functions of a panel are in a vector."""
        field = self.fields[k]
        found = np.searchsorted(field.functions, rows(field.panels, number, degrees))
        return (field.place.start + found).tolist()

    @property
    def disk(self) -> DiscreteSpace:
        """The space on the disk."""
        return self.space(0)

    def half(self, half: int) -> DiscreteSpace:
        """Return the space on a half of the annulus (0: inner, 1: outer)."""
        return self.space(3 + half)

    def panel(self, half: int, number: int):
        """Return a panel of a half of the annulus, and its places."""
        space = self.half(half)
        degrees = extremes(space, number)
        inner, rest = self._exact(self.radii[-1])
        # the outer end is the edge; the meshes meet in the middle, in s^2
        ends = Place(inner**2, rest, rest / 2), Place(mp.mpf(1), mp.mpf(0), -rest / 2)
        piece = basis(space.panels, number, degrees, ends[half])
        return piece, self.places(3 + half, number, degrees)

    @staticmethod
    def _exact(radius):
        """Return a radius and 1 less its square."""
        edge = mp.mpf(radius.from_edge)
        return 1 - edge, edge * (2 - edge)

    def annulus_case(self, first: tuple[int, int], second: tuple[int, int]) -> Case:
        """Return two panels of the annulus, each given by its half and its number."""
        one, left = self.panel(*first)
        two, right = (one, left) if first == second else self.panel(*second)
        scale = np.sqrt(self.gram.diagonal())
        doubles = {"K2": (self.gram[np.ix_(left, right)], scale[left], scale[right])}
        return Case(doubles, (left, right), lambda density: {"K2": entries(one, two, density)[1]})

    def cross_case(self, number: int, other: tuple[int, int]) -> Case:
        """Return a panel of the disk and one of the annulus."""
        c, rest = self._exact(self.radii[0])
        degrees = extremes(self.disk, number)
        one = basis(self.disk.panels, number, degrees, Place(c * c, rest, -c * c))
        two, right = self.panel(*other)
        left, scale = self.places(0, number, degrees), np.sqrt(self.gram.diagonal())
        doubles = {"K2": (self.gram[np.ix_(left, right)], scale[left], scale[right])}
        return Case(doubles, (left, right), lambda density: {"K2": entries(one, two, density)[1]})


@cache
def interior_slip() -> Zones:
    """Return the solver's matrices for an interior slip annulus of the reference numbers."""
    return Zones(0.05, 1.0, 0.23, (0.6431432853, 0.9805181303), 1e-12)
