"""The steady loop of a load that cycles, as `steady_cycle` returns it."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.fields.evaluation import over_r, over_s
from spectral_contact.io import checks, storage
from spectral_contact.io.choices import Suggesting, one_of
from spectral_contact.io.codecs import Float, Maybe, Plain, Record, Several
from spectral_contact.io.documents import path_text, replace_file, reported
from spectral_contact.io.schema import SCENE, SOLUTION
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution, Zone
from spectral_contact.sweeps.forward_slip import admissible_tractions
from spectral_contact.sweeps.mean_slip import annulus_nodes
from spectral_contact.view.physical_solution import PhysicalSolution
from spectral_contact.view.report import digits_text, estimate_text, scene_text, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["CycleErrors", "LoopBranch", "PhysicalSteadyCycle", "SteadyCycle"]

#: The ends of a loop.
_ENDS: Final = ("highest", "lowest")
#: Largest number of rows of a table; chosen.
_MOST_POINTS: Final = 1_000_000
#: Why `unloading_dissipation` is None.
FORWARD = (
    "the surface goes on to slip forward while the load falls, which the formulas for unloading "
    "exclude"
)


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Estimates of relative errors of a steady loop; None where there is no number.

    The error of `slip_amplitude` is relative to its largest value over the contact, that of
    `traction` to the value at each radius, as in `ErrorEstimates`.
    """

    shakedown_ratio: float
    stick_radius: float | None
    slip_amplitude: float | None
    traction: float
    reloading_dissipation: float
    unloading_dissipation: float | None
    dissipation: float | None


@dataclass(frozen=True, slots=True, eq=False)
class LoopBranch:
    """Total shear over the load, while it falls or while it rises.

    Attributes
    ----------
    load : ndarray, shape (n,)
        In the order of time.
    shear : ndarray, shape (n,)
        Total shear less that at the largest load, which depends on how the load was applied.
    """

    load: Array
    shear: Array


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SteadyCycle(Suggesting):
    """The steady loop of a load between 1 and `lowest`, in units of the largest load.

    Built by `steady_cycle`; SI values are in `physical`. Energies are in units of
    4 (1 - nu^2) P^2 / (a E), the largest load times the unit of displacements.

    Attributes
    ----------
    scene : Scene
        Of the largest load.
    lowest : float
        Lowest load over the largest one.
    rtol : float
    states : tuple of Solution
        Solutions of unit load by rising friction, from that of `solution` to full stick. When the
        load has fallen to l, the traction has changed by (1 - l) times that of the state with the
        friction f (1 + l)/(1 - l).
    shakedown_ratio : float
        As of `Solution`: if `lowest` is not below it, the loop dissipates nothing.
    reloading_dissipation, unloading_dissipation : float
        Energy that friction dissipates in each cycle while the load rises, and while it falls. That
        of unloading is None where the surface goes on to slip forward, as it does under a rising
        load, while the load begins to fall: its formula does not hold then. The other numbers do.
    slack : float
        The upper less the lower bound of `traction_bounds` at the largest load, over f p: the least
        value of all radii. Where the surface slips back it is 0. It is negative if at some radius
        no traction is within the bounds: there the surface slips forward while the load falls.
    error : CycleErrors
    converged : bool
        Whether the errors of the dissipation are at most `rtol`. A loop may be so close to
        shakedown that it is not known whether it slips: its dissipation is 0 with the error 1, and
        it counts as converged.
    """

    scene: Scene
    lowest: float
    rtol: float
    states: tuple[Solution, ...]
    shakedown_ratio: float
    reloading_dissipation: float
    unloading_dissipation: float | None
    slack: float
    error: CycleErrors
    converged: bool = False

    @property
    def solution(self) -> Solution:
        """Solution of unit load under the friction of the loop, ``f (1 + lowest)/(1 - lowest)``.

        Its zones are those of the loop. Its traction and slip, times ``1 - lowest``, are the
        changes from one end of the loop to the other.
        """
        return self.states[0]

    @property
    def dissipation(self) -> float | None:
        """Energy that friction dissipates in each cycle; None where that of unloading is."""
        if self.unloading_dissipation is None:
            return None
        return self.unloading_dissipation + self.reloading_dissipation

    @property
    def stick_radius(self) -> float:
        """Outer radius of the zone at the centre that never slips, over the contact radius."""
        return float(self.solution.stick_radius or 0.0)

    @property
    def zones(self) -> tuple[Zone, ...]:
        """Zones that stick in the whole cycle, and zones that slip."""
        return self.solution.zones

    @property
    def worst_error(self) -> float:
        """Largest error estimate of the dissipation while the load falls, and while it rises."""
        errors = self.error.reloading_dissipation, self.error.unloading_dissipation
        return max(error for error in errors if error is not None)

    @over_s
    def slip_amplitude(
        self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> Any:
        """Evaluate how far the surface slips while the load rises, and back while it falls.

        Parameters
        ----------
        s : array_like, optional
            Dimensionless radii in [0, 1], any shape.
        from_edge : array_like, optional
            Instead of `s`: distances ``1 - s``.

        Returns
        -------
        float or ndarray
            Of the shape of the input, in the unit of `Solution.slip`, not negative.

        Raises
        ------
        SceneError
            For both or neither argument, or a radius outside [0, 1].
        """
        slip = self.solution.slip(**_radius_arguments(s, from_edge))
        return (1.0 - self.lowest) * np.abs(slip)[()]

    @over_s
    def traction_change(
        self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> Any:
        """Evaluate the traction at the largest load less that at the lowest one, anywhere.

        Parameters, return value and errors are those of `slip_amplitude`.
        """
        return (1.0 - self.lowest) * self.solution.traction(**_radius_arguments(s, from_edge))

    def traction(
        self,
        s: ArrayLike | None = None,
        at: str = "highest",
        *,
        from_edge: ArrayLike | None = None,
    ) -> Any:
        """Evaluate the traction at an end of the loop, where the surface slips.

        With the pressure p of the largest load it is ``f p`` at that load and ``-f lowest p`` at
        the lowest one, both times the sign of kappa. In stick it depends on how the load was
        applied: it is NaN, and `traction_bounds` has its bounds.

        Parameters
        ----------
        s, from_edge : array_like, optional
            As of `slip_amplitude`.
        at : str
            The load: ``"highest"`` or ``"lowest"``.

        Returns
        -------
        float or ndarray
            Of the shape of the input.

        Raises
        ------
        SceneError
            As `slip_amplitude`, or for another `at`.
        """
        one_of("at", at, _ENDS)
        _, distance = checks.radii(s, from_edge)
        return self._slip_traction(distance, at)[()]

    def _slip_traction(self, from_edge: Array, at: str) -> Array:
        """Return the traction where the surface slips, and NaN where it sticks."""
        slips = np.zeros(from_edge.shape, dtype=bool)
        for zone in self.zones:
            if zone.kind == "slip":
                slips |= (from_edge <= zone.inner_from_edge) & (from_edge >= zone.outer_from_edge)
        traction = np.full(from_edge.shape, np.nan)
        factor = np.sign(self.scene.kappa) * (1.0 if at == "highest" else -self.lowest)
        traction[slips] = factor * self._friction_bound(from_edge[slips])
        return traction

    def traction_bounds(
        self,
        s: ArrayLike | None = None,
        at: str = "highest",
        *,
        from_edge: ArrayLike | None = None,
    ) -> tuple[Any, Any]:
        """Return a lower and an upper bound of the traction at an end of the loop.

        With a traction within them nothing slips forward at any of the loads that were solved.
        Where the surface slips both bounds are the traction.

        Parameters
        ----------
        s, at, from_edge
            As of `traction`.

        Returns
        -------
        tuple of float or ndarray

        Raises
        ------
        SceneError
            As `traction`.
        NotComputedError
            Where the surface goes on to slip forward while the load falls.
        """
        one_of("at", at, _ENDS)
        self._require_unloading("traction_bounds")
        _, distance = checks.radii(s, from_edge)
        limit = self._friction_bound(distance)
        low, high = admissible_tractions(self.states, self._friction, limit, distance)
        if at == "lowest":
            # infinite bounds stay infinite
            change = np.where(limit < np.inf, self.traction_change(from_edge=distance), 0.0)
            low = low - change
            high = high - change
        slip_traction = self._slip_traction(distance, at)
        sticks = np.isnan(slip_traction)
        return np.where(sticks, low, slip_traction)[()], np.where(sticks, high, slip_traction)[()]

    def _friction_bound(self, from_edge: Array) -> Array:
        """Return f p at the largest load."""
        return np.asarray(self._friction * self.solution.pressure(from_edge=from_edge))

    def _require_unloading(self, name: str) -> None:
        """Refuse a quantity that holds only if nothing slips forward while the load falls."""
        if self.unloading_dissipation is None:
            raise NotComputedError(name, FORWARD)

    @property
    def unloading(self) -> LoopBranch:
        """Total shear on the way down.

        Raises
        ------
        NotComputedError
            Where the surface goes on to slip forward while the load falls.
        """
        self._require_unloading("unloading")
        friction = self._friction
        frictions = self._frictions_between()
        # each l solves f (1 + l)/(1 - l) = the friction of a state
        between = (frictions - friction) / (frictions + friction)
        load = np.array([1.0, *between, self.lowest])
        return LoopBranch(load, (load - 1.0) * self._state_shears())

    @property
    def reloading(self) -> LoopBranch:
        """Total shear on the way up."""
        friction = self._friction
        frictions = self._frictions_between()
        # each l solves f (l + lowest)/(l - lowest) = the friction of a state
        between = self.lowest * (frictions + friction) / (frictions - friction)
        load = np.array([self.lowest, *between, 1.0])
        shear_at_lowest = (self.lowest - 1.0) * self.solution.total_shear
        return LoopBranch(load, shear_at_lowest + (load - self.lowest) * self._state_shears())

    @property
    def _friction(self) -> float:
        """The coefficient of friction f, which a scene of a cycle always has."""
        return float(self.scene.friction or 0.0)

    def _frictions_between(self) -> Array:
        """Return the frictions of the states between the loop and full stick, as they fall."""
        return np.array([float(one.scene.friction or 0.0) for one in self.states[-2:0:-1]])

    def _state_shears(self) -> Array:
        """Return the total shears of the states by falling friction: that of full stick first."""
        return np.array([one.total_shear for one in self.states[::-1]])

    @property
    def physical(self) -> PhysicalSteadyCycle:
        """The same in m, N, Pa and J.

        Raises
        ------
        NotComputedError
            If the scene was not made by `Scene.from_physical`.
        """
        return PhysicalSteadyCycle(self)

    def plot(self) -> Figure:
        """Draw the loop of the total shear over the load, and the slip over the radius.

        Raises
        ------
        MissingDependencyError
            If matplotlib is not installed (extra: plot).
        """
        from spectral_contact.sweeps.cycle_pictures import plot_steady_cycle

        return plot_steady_cycle(self)

    def to_csv(self, path: str | os.PathLike[str], points: int = 200) -> None:
        """Write slip amplitude and change of the traction over the radius.

        Parameters
        ----------
        path : str or path-like
        points : int
            Number of radii, equally spaced, at most a million.

        Raises
        ------
        SolutionFileError
            If the path cannot be written.
        """
        path, points = path_text(path), checks.whole("points", points, 2, _MOST_POINTS)
        s = np.linspace(0.0, 1.0, points)
        columns = {"s": s, "slip_amplitude": self.slip_amplitude(s)}
        columns["traction_change"] = self.traction_change(s)
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [f"# {line}" for line in self.summary().splitlines()]
        lines += [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        with reported(path, "cannot be written"):
            replace_file(path, ("\n".join(lines) + "\n").encode())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Store the cycle, with its states, in one ``.npz`` or ``.json`` file, every value exactly.

        Raises
        ------
        SolutionFileError
            For another suffix, or a path that cannot be written.
        """
        storage.save(self, path, _DOCUMENT)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> SteadyCycle:
        """Return the cycle that `save` stored.

        Raises
        ------
        SolutionFileError
            For a file that is not there, not ours, damaged, or of another version.
        """
        cycle: SteadyCycle = storage.load(path, _DOCUMENT)
        return cycle

    @property
    def _rows(self) -> list[_TableRow]:
        error = self.error
        slip = float(self.slip_amplitude(from_edge=0.0))
        return [
            _TableRow("shakedown ratio", self.shakedown_ratio, error.shakedown_ratio),
            _TableRow("stick radius", self.stick_radius, error.stick_radius),
            _TableRow("slip amplitude, edge", slip, self._edge_slip_error),
            *_dissipation_rows(self, error),
        ]

    @property
    def _edge_slip_error(self) -> float | None:
        """Error of the slip amplitude at the edge, relative to its value there."""
        error = self.error.slip_amplitude
        if not error:
            return error
        slip_zones = [zone for zone in self.zones if zone.kind == "slip"]
        if not slip_zones:  # so close to shakedown that it is not known whether it slips
            return error
        if slip_zones[-1].outer_from_edge > 0.0:  # the edge sticks
            return 0.0
        at_edge = float(self.slip_amplitude(from_edge=0.0))
        # the error is relative to the largest slip, which is looked for at nodes of the zones
        nodes = [
            annulus_nodes(zone.inner_from_edge, zone.outer_from_edge, 2)[0] for zone in slip_zones
        ]
        largest = float(self.slip_amplitude(from_edge=np.concatenate(nodes)).max())
        return error * max(largest / at_edge, 1.0) if at_edge > 0.0 else np.inf

    def summary(self) -> str:
        """Return the numbers with their errors as text, in SI units as well if there are any."""
        load = f"load between 1 and {self.lowest!r} of the largest"
        parts = [
            f"{scene_text(self.scene)}\n{load}; rtol = {self.rtol!r}",
            _table("quantity", self._rows),
        ]
        if self.scene.physical is not None:
            parts.append(str(self.physical))
        if self.lowest >= self.shakedown_ratio:
            parts.append("shaken down: nothing slips")
        if self.unloading_dissipation is None:
            parts.append(f"unloading is not known: {FORWARD}")
        parts.append(f"converged: {'yes' if self.converged else 'no'}")
        return "\n\n".join(parts)

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        text = f"stick_radius={self.stick_radius:.16g}"
        if self.dissipation is None:
            text += f" reloading_dissipation={self.reloading_dissipation:.16g}"
            text += ", unloading is not known: the surface goes on to slip forward"
        else:
            text += f" dissipation={self.dissipation:.16g}"
        return f"<SteadyCycle lowest={self.lowest:.6g} {text} converged={self.converged}>"


_NUMBER: Final = Maybe(Float())
_ERRORS: Final = Record(
    "CycleErrors",
    CycleErrors,
    shakedown_ratio=Float(),
    stick_radius=_NUMBER,
    slip_amplitude=_NUMBER,
    traction=Float(),
    reloading_dissipation=Float(),
    unloading_dissipation=_NUMBER,
    dissipation=_NUMBER,
)
#: What a file of a cycle holds (docs/file_format.md).
_DOCUMENT: Final = storage.Document(
    "cycle",
    Record(
        "SteadyCycle",
        SteadyCycle,
        scene=SCENE,
        lowest=Float(),
        rtol=Float(),
        states=Several(SOLUTION),
        shakedown_ratio=Float(),
        reloading_dissipation=Float(),
        unloading_dissipation=_NUMBER,
        slack=Float(),
        error=_ERRORS,
        converged=Plain(bool, "true or false"),
    ),
)


class _TableRow(NamedTuple):
    """A line of a table: a number with its error estimate."""

    name: str
    value: float | None
    error: float | None
    unit: str = ""


def _dissipation_rows(
    cycle: SteadyCycle | PhysicalSteadyCycle, error: CycleErrors, unit: str = ""
) -> list[_TableRow]:
    """Return the lines of the dissipation, and of its parts while the load falls and rises."""
    return [
        _TableRow("dissipation", cycle.dissipation, error.dissipation, unit),
        _TableRow("  unloading", cycle.unloading_dissipation, error.unloading_dissipation, unit),
        _TableRow("  reloading", cycle.reloading_dissipation, error.reloading_dissipation, unit),
    ]


def _error_sum(error: float | None, load_error: float) -> float | None:
    """Return the sum of two errors; None and 0, as of exact numbers, are returned unchanged."""
    return error + load_error if error else error


def _table(title: str, rows: list[_TableRow]) -> str:
    cells = [(title, "value", "error estimate")]
    for one in rows:
        unit = f" {one.unit}" if one.unit and one.value is not None else ""
        cells.append((one.name, digits_text(one.value, one.error) + unit, estimate_text(one.error)))
    return table(cells)


def _radius_arguments(
    radius: ArrayLike | None, from_edge: ArrayLike | None, name: str = "s"
) -> dict[str, Any]:
    """Return radii, or distances from the edge, as keywords that fields of a solution take."""
    return {name: radius, "from_edge": from_edge}


@dataclass(frozen=True, slots=True, repr=False)
class PhysicalSteadyCycle(Suggesting):
    """A steady loop in SI units: m, N, Pa and J.

    Printed, it is the table of its numbers.
    """

    cycle: SteadyCycle

    def __post_init__(self) -> None:
        _ = self._solution  # refuses a scene without SI data

    @property
    def _solution(self) -> PhysicalSolution:
        return PhysicalSolution(self.cycle.solution)

    @property
    def load(self) -> float:
        """Largest load P [N]."""
        return self._solution.load

    @property
    def lowest_load(self) -> float:
        """Lowest load [N]."""
        return self.cycle.lowest * self.load

    @property
    def stick_radius(self) -> float:
        """Outer radius of the zone at the centre that never slips [m]."""
        return self.cycle.stick_radius * self._solution.radius

    @property
    def _load_error(self) -> float:
        """Relative error of the load [N].

        If the approach is given, the load is computed from it, and has the error of the
        dimensionless approach.
        """
        data = self.cycle.scene.physical
        given = data is not None and data.load is not None
        return 0.0 if given else float(self.cycle.solution.error.approach or 0.0)

    @property
    def _energy_unit(self) -> float:
        """Unit of energy [J]: the largest load times the unit of displacements."""
        return self.load * self._solution.units.displacement

    @property
    def dissipation(self) -> float | None:
        """Energy that friction dissipates in each cycle [J]; None where that of unloading is."""
        value = self.cycle.dissipation
        return None if value is None else value * self._energy_unit

    @property
    def unloading_dissipation(self) -> float | None:
        """The part of it while the load falls [J]; None where it is not known."""
        value = self.cycle.unloading_dissipation
        return None if value is None else value * self._energy_unit

    @property
    def reloading_dissipation(self) -> float:
        """The part of it while the load rises [J]."""
        return self.cycle.reloading_dissipation * self._energy_unit

    @over_r
    def slip_amplitude(
        self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> Any:
        """Evaluate how far the surface slips to and fro [m] at radii [m], or `from_edge` [m]."""
        return (1.0 - self.cycle.lowest) * np.abs(
            self._solution.slip(**_radius_arguments(r, from_edge, "r"))
        )[()]

    @over_r
    def traction_change(
        self, r: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> Any:
        """Evaluate the traction at the largest load less that at the lowest one [Pa]."""
        return (1.0 - self.cycle.lowest) * self._solution.traction(
            **_radius_arguments(r, from_edge, "r")
        )

    def __str__(self) -> str:
        error = self.cycle.error
        slip = float(self.slip_amplitude(from_edge=0.0))
        edge_error = self.cycle._edge_slip_error
        load_error = self._load_error
        # the unit of energy is the load times the unit of displacements, which is proportional to
        # the load: its relative error is twice that of the load
        energies = ("dissipation", "unloading_dissipation", "reloading_dissipation")
        energy_errors: dict[str, Any] = {
            name: _error_sum(getattr(error, name), 2.0 * load_error) for name in energies
        }
        rows = [
            _TableRow("largest load", self.load, load_error, "N"),
            _TableRow("lowest load", self.lowest_load, load_error, "N"),
            _TableRow("stick radius", self.stick_radius, error.stick_radius, "m"),
            _TableRow("slip amplitude, edge", slip, _error_sum(edge_error, load_error), "m"),
            *_dissipation_rows(self, replace(error, **energy_errors), "J"),
        ]
        return _table("SI", rows)

    def __repr__(self) -> str:
        return f"<PhysicalSteadyCycle of {self.cycle!r}>"
