"""Output of a solution: SI values, tables, pictures, files.

The modules that make this output import `solution`, which imports this module. So each method here
imports the module that it needs when it is called. What shows scenes, plans and gold tables in
notebooks has the same reason to be here.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, cast, overload

from numpy.typing import ArrayLike

from spectral_contact.io.choices import Suggesting

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from spectral_contact.equations.interior import Inside
    from spectral_contact.gold.table_loader import GoldSolution, GoldTable
    from spectral_contact.records import Plan
    from spectral_contact.scene import Scene
    from spectral_contact.solution import Solution
    from spectral_contact.studies.derivatives import Sensitivity
    from spectral_contact.view.physical_solution import PhysicalSolution


def notebook_table(shown: Scene | Plan | Solution) -> str:
    """Return what notebooks show of a record, as HTML."""
    from spectral_contact.view.html import html_of

    return html_of(shown)


def notebook_gold(shown: GoldSolution) -> str:
    """Return what notebooks show of a gold solution, as HTML."""
    from spectral_contact.view.html import of_gold

    return of_gold(shown)


def notebook_gold_table(shown: GoldTable) -> str:
    """Return what notebooks show of a gold table, as HTML."""
    from spectral_contact.view.html import of_gold_table

    return of_gold_table(shown)


def inside_of(solution: Solution) -> Inside:
    """Return stress and displacement inside the body under a solution."""
    from spectral_contact.equations.interior import Inside

    return Inside(solution)


class _Load:
    """The name `load`: of the class `Solution` it reads a file, of a solution it is the load."""

    @overload
    def __get__(
        self, instance: None, owner: type[Solution]
    ) -> Callable[[str | os.PathLike[str]], Solution]: ...
    @overload
    def __get__(self, instance: Solution, owner: type[Solution]) -> float: ...
    def __get__(self, instance: Solution | None, owner: type[Solution]) -> Any:
        if instance is None:
            return _loaded
        return float(instance._value("load"))


def _loaded(path: str | os.PathLike[str]) -> Solution:
    """Load what `Solution.save` stored.

    Raises
    ------
    SolutionFileError
        For a file that is not there, not ours, damaged, or of another version.
    """
    from spectral_contact.io import storage

    solution: Solution = storage.load(path)
    return solution


class Output(Suggesting):
    """Base of `Solution`: every method hands the solution to the module that does it."""

    __slots__ = ()

    @property
    def _solution(self) -> Solution:
        return cast("Solution", self)

    @property
    def _comparable(self) -> object:
        """What is compared of two solutions: everything but the times of the work."""
        from spectral_contact.io import storage

        return storage.comparable(self._solution)

    @property
    def physical(self) -> PhysicalSolution:
        """The same quantities in Pa, m and N.

        Raises
        ------
        NotComputedError
            If the scene was not made by `Scene.from_physical`.
        """
        from spectral_contact.view.physical_solution import PhysicalSolution

        return PhysicalSolution(self._solution)

    def summary(self) -> str:
        """Return the report of the command line: quantities with errors, zones, plan and work."""
        from spectral_contact.view.report import report

        return report(self._solution)

    def plot(self) -> Figure:
        """Draw the fields, the zones and the errors; see `plotting.plot_solution`.

        Raises
        ------
        NotComputedError
            If neither pressure nor traction was asked for.
        MissingDependencyError
            If matplotlib is not installed (extra: plot).
        """
        from spectral_contact.view.plotting import plot_solution

        return plot_solution(self._solution)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a table of the fields with estimates of their errors; comments have all the rest.

        The radii resolve the edge layer and every zone.

        Raises
        ------
        NotComputedError
            If no field was asked for.
        SolutionFileError
            If the path cannot be written.
        """
        from spectral_contact.view.report import write_csv

        write_csv(self._solution, path)

    def to_xarray(
        self, s: ArrayLike | None = None, *, from_edge: ArrayLike | None = None
    ) -> xarray.Dataset:
        """Return everything as a dataset with names, units and estimates of errors.

        Parameters
        ----------
        s, from_edge : array_like, optional
            Where the fields are taken: radii in [0, 1], or distances from the edge. By default at
            radii that resolve the edge layer and every zone.

        Returns
        -------
        xarray.Dataset
            As that of `sweep`, for one scene.

        Raises
        ------
        SceneError
            For both arguments, or a radius outside [0, 1].
        NotComputedError
            If the solution has no quantity.
        MissingDependencyError
            If xarray is not installed (extra: sweep).
        """
        from spectral_contact.sweeps.dataset import of_solution

        return of_solution(self._solution, s, from_edge)

    def sensitivity(
        self,
        parameters: Iterable[str] | None = None,
        *,
        s: ArrayLike | None = None,
        from_edge: ArrayLike | None = None,
        progress: bool | None = None,
    ) -> Sensitivity:
        """Return derivatives of approach, total shear, stick radius, and fields by the parameters.

        They are exact: by the implicit function theorem, with one linear solve for each parameter.
        The note of a derivative says if it is infinite or one-sided.

        Parameters
        ----------
        parameters : iterable of str, optional
            By which: names out of ``"normal_compliance"``, ``"tangential_compliance"``,
            ``"friction"``, ``"poisson_ratio"`` and, below the largest load, ``"unloaded_to"``, all
            dimensionless; by default all of them. With adhesion ``"work_of_adhesion"`` is the only
            one, by which load, approach and contact radius are differentiated.
        s, from_edge : array_like, optional
            Radii in [0, 1], or distances from the edge, for derivatives of pressure and traction;
            by default there are none.
        progress : bool, optional
            Whether to show progress (extra: progress); by default on a terminal and in notebooks.

        Returns
        -------
        Sensitivity
            ``found["stick_radius", "friction"]`` has the value, its estimated relative error and a
            note. ``found.fields["traction", "friction"]`` has the values at the radii, their
            estimated absolute errors and a note. ``found.boundaries["friction"]`` has a derivative
            for each boundary between zones.

        Raises
        ------
        SceneError
            For another parameter, a radius outside [0, 1], or a scene with a profile, unless it
            has adhesion.
        NotComputedError
            With elastic coupling, if no zones are found that obey the friction law.
        """
        from spectral_contact.studies.derivatives import sensitivity

        return sensitivity(self._solution, parameters, s=s, from_edge=from_edge, progress=progress)

    def _repr_html_(self) -> str:
        return notebook_table(self._solution)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Store the solution in one ``.npz`` or ``.json`` file, every value exactly.

        Raises
        ------
        SolutionFileError
            For another suffix, or a path that cannot be written.
        """
        from spectral_contact.io import storage

        storage.save(self._solution, path)

    #: Of the class, ``Solution.load(path)``: load what `save` stored. Of a solution with a profile,
    #: ``solution.load``: its load, in E'L² with E' = E/(4(1−ν²)).
    load = _Load()

    def to_json(self) -> str:
        """Return the solution as one line of strict JSON; its numbers are exact.

        Raises
        ------
        SolutionFileError
            If it holds NaN.
        """
        from spectral_contact.io import storage

        return storage.to_json(self._solution)

    @classmethod
    def from_json(cls, text: str) -> Solution:
        """Return the solution that `to_json` wrote, equal to it bit for bit.

        Raises
        ------
        SolutionFileError
            If the text is not JSON, not ours, damaged, or of another version.
        """
        from spectral_contact.io import storage

        return storage.from_json(text)
