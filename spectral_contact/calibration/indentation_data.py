"""Measured curves of depths and loads, from arrays or from the file of an instrument."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NoReturn, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.calibration.force_curves import (
    PARTS,
    Rows,
    baseline,
    curve_parts,
    loop_height,
    signs,
)
from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.fields import Array
from spectral_contact.io.checks import reals
from spectral_contact.io.choices import instance, one_of
from spectral_contact.io.columns import Expected, NumberTable, read_columns
from spectral_contact.io.headings import NoColumnError

_EXPECTED: Final = (
    Expected("depth", "m"),
    Expected("load", "N"),
    Expected("sigma", "N", required=False, at_least=0.0),
)
#: What headings call the approach and the retraction, if both are side by side.
_DIRECTIONS: Final = (
    ("Ex", "Rt"),
    ("extend", "retract"),
    ("approach", "retract"),
    ("approach", "retraction"),
    ("loading", "unloading"),
)
#: Approach and retraction are two curves if their loads differ on average by more standard
#: deviations than this.
_LOOP: Final = 3.0
#: Lines that a remark names.
_NAMED: Final = 5
_DEPTH_TURNED: Final = "loads grow as depths fall: the sign of the depth is turned"
_LOAD_TURNED: Final = "loads fall as the contact grows: the sign of the load is turned"


@dataclass(frozen=True, slots=True)
class IndentationData:
    """A force-indentation curve of one punch under growing load.

    Parameters
    ----------
    depth : array_like
        As the instrument has them [m], from any zero; increasing is not needed.
    load : array_like
        P at each [N].
    sigma : array_like, optional
        Standard deviations of the loads [N], > 0; one for all, or one each. By default that of the
        loads about the baseline, a straight line through at least ten points before the contact.

    Attributes
    ----------
    remarks : tuple of str
        How a file was read, which part of the curve it is, and what is unusual about it.

    Raises
    ------
    SceneError
        If they are not finite numbers, as many of each; without `sigma` if there is no baseline.
    """

    depth: tuple[float, ...]
    load: tuple[float, ...]
    sigma: tuple[float, ...]
    remarks: tuple[str, ...]

    def __init__(self, depth: ArrayLike, load: ArrayLike, sigma: ArrayLike | None = None) -> None:
        depths = _finite("depth", depth, "m")
        loads = _finite("load", load, "N")
        if not depths.size:
            raise SceneError("depth", depth, "at least one number")
        if len(loads) != len(depths):
            raise SceneError("load", load, f"{len(depths)} numbers, one for each depth")
        remarks = [
            f"{told}? give {name} with the other sign"
            for name, sign, told in zip(
                ("depth", "load"), signs(depths, loads), (_DEPTH_TURNED, _LOAD_TURNED), strict=True
            )
            if sign < 0.0
        ]
        if sigma is None:
            deviation, told = _noise(depths, loads)
            sigma = deviation
            remarks.append(told)
        self._hold(depths, loads, sigma, remarks)

    def _hold(self, depths: Array, loads: Array, sigma: ArrayLike, remarks: Sequence[str]) -> None:
        sizes = _sizes(sigma, len(depths))
        values: dict[str, Any] = {
            "depth": depths.tolist(),
            "load": loads.tolist(),
            "sigma": np.broadcast_to(sizes, depths.shape).tolist(),
            "remarks": remarks,
        }
        for name, several in values.items():
            object.__setattr__(self, name, tuple(several))  # into a frozen dataclass

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        *,
        part: str | None = None,
        sigma: ArrayLike | None = None,
        columns: str | Sequence[str] | None = None,
        header: int | None = None,
        decimal: str | None = None,
        invalid: str = "missing",
        option: str = "columns",
    ) -> Self:
        """Read the force curve that an instrument wrote, see docs/files.

        Signs are turned so that loads grow with depth, and `remarks` say so.

        Parameters
        ----------
        path : path-like
            Text with columns of depths and loads, and of standard deviations if there is one.
        part : str, optional
            ``"approach"``, the rows up to the largest depth, ``"retraction"``, those after it, or
            ``"all"``. By default the approach, or the part that there is.
        sigma : array_like, optional
            One standard deviation of all loads [N]. By default the column of the file or, if it
            has none, that of the baseline.
        columns : str or sequence of str, optional
            Which column is which, if the headings do not tell: ``"depth=1 [nm], load=3 [nN]"``.
        header : int, optional
            Line of the headings.
        decimal : str, optional
            The decimal sign.
        invalid : str
            Rows without a value are left out and named; with ``"raise"`` they are errors, and with
            ``"skip"`` other rows that cannot be read are left out, too.
        option : str
            What `columns` is called where the user gave it, for errors.

        Returns
        -------
        IndentationData

        Raises
        ------
        SolutionFileError
            If the file cannot be read, with line and column.
        SceneError
            If it has not the part asked for, or neither deviations nor a baseline.
        """
        return read_curve(
            path,
            cls,
            part=part,
            sigma=sigma,
            columns=columns,
            header=header,
            decimal=decimal,
            invalid=invalid,
            option=instance("option", option, str),
        )


_D = TypeVar("_D", bound=IndentationData)


def read_curve(
    path: str | os.PathLike[str],
    kind: type[_D],
    *,
    part: str | None,
    sigma: ArrayLike | None,
    option: str = "columns",
    **reading: Any,
) -> _D:
    """Return the curve of a file, as of `IndentationData.from_file`; errors name the option."""
    if part is not None:
        one_of("part", part, PARTS)
    if sigma is not None:
        sigma = _sizes(sigma, 1)
    tables = _tables(path, option, reading)
    depth, load, lines = (
        np.concatenate([np.asarray(values) for values in each])
        for each in zip(
            *((one.values["depth"], one.values["load"], one.lines) for one in tables), strict=True
        )
    )
    remarks = [str(one) for one in tables]
    of_depth, of_load = signs(depth, load)
    if of_depth < 0.0:
        remarks.append(_DEPTH_TURNED)
    if of_load < 0.0:
        remarks.append(_LOAD_TURNED)
    depth = of_depth * depth
    load = of_load * load
    parts = curve_parts(depth)
    if len(tables) > 1:
        parts = _side_by_side(depth, len(tables[0].lines))
    rows, name = _chosen(part, parts, len(depth))
    remarks += _on_part(name, parts, rows, lines)
    remarks += _on_order(name, depth[rows], lines[rows])
    of_file = tables[0].values.get("sigma")
    given: ArrayLike | None = sigma if sigma is not None else of_file
    if given is None:
        given, told = _noise(depth[rows], load[rows])
        remarks.append(told)
    elif sigma is None and of_file is not None:
        given = of_file[rows]
    if len(parts) > 1:
        remarks += _on_loop(name, loop_height(depth, load, parts), given)
    found = kind.__new__(kind)
    found._hold(depth[rows], load[rows], given, remarks)
    return found


def _tables(
    path: str | os.PathLike[str], option: str, reading: dict[str, Any]
) -> list[NumberTable]:
    """Return the columns of a file; two tables if it has approach and retraction side by side."""
    try:
        return [read_columns(path, _EXPECTED, option=option, **reading)]
    except SolutionFileError as error:
        if reading.get("columns") is not None or not isinstance(error.__cause__, NoColumnError):
            raise
        for directions in _DIRECTIONS:
            each = [[one.toward(to) for one in _EXPECTED if one.required] for to in directions]
            try:
                return [read_columns(path, some, option=option, **reading) for some in each]
            except SolutionFileError as other:
                if not isinstance(other.__cause__, NoColumnError):
                    raise
        raise


def _side_by_side(depth: Array, count: int) -> dict[str, Rows]:
    """Return the rows of both parts, of which the first `count` are the approach.

    They are turned so that depths grow in the approach and fall in the retraction.
    """
    rows = np.arange(len(depth))
    first = rows[:count]
    second = rows[count:]
    if depth[first[0]] > depth[first[-1]]:
        first = first[::-1]
    if depth[second[0]] < depth[second[-1]]:
        second = second[::-1]
    return {"approach": first, "retraction": second}


def _finite(name: str, values: ArrayLike, unit: str) -> Array:
    """Return a list of finite numbers; an error says how many are not."""
    array = reals(name, values, "finite", anything=True, unit=unit)
    if array.ndim != 1:
        raise SceneError(name, values, "a list of numbers")
    with np.errstate(over="ignore"):  # a long double may be beyond the doubles
        doubles = np.asarray(array + 0.0, dtype=np.float64)
    wrong = np.flatnonzero(~np.isfinite(doubles))
    if len(wrong):
        told = f"finite, which {len(wrong)} of {len(doubles)} are not, the first at {wrong[0]}"
        raise SceneError(name, float(doubles[wrong[0]]), told)
    return doubles


def _sizes(sigma: ArrayLike, count: int) -> Array:
    """Return standard deviations, one or as many as there are loads."""
    sizes = np.ravel(reals("sigma", sigma, "finite and > 0", low=0.0, unit="N"))
    if len(sizes) not in (1, count) or not ((sizes > 0) & np.isfinite(sizes)).all():
        several = f", one number or {count}" if count > 1 else ", one number"
        raise SceneError("sigma", sigma, f"finite and > 0{several}")
    with np.errstate(over="ignore"):
        doubles = np.asarray(sizes, dtype=np.float64)
    if not (np.isfinite(doubles) & (doubles > 0.0)).all():  # of long doubles
        raise SceneError("sigma", sigma, "within the range of doubles")
    return doubles


def _noise(depth: Array, load: Array) -> tuple[float, str]:
    """Return the standard deviation of the loads about the baseline, and where it is from."""
    line = baseline(depth, load)
    if line is None:
        told = "given: the curve has no noisy baseline of ten points or more, to estimate it from"
        raise SceneError("sigma", None, told)
    where = f"{line.points} points of the baseline, up to a depth of {line.end:.6g} m"
    return line.sigma, f"sigma is not given: {line.sigma:.3g} N, from {where}"


def _chosen(part: str | None, parts: dict[str, Rows], count: int) -> tuple[Rows, str]:
    """Return the rows of the part asked for, and its name."""
    if part == "all" or not parts:
        if part not in (None, "all"):
            _refuse_part(part, "all: the rows are in no order of depth")
        return np.arange(count), "all"
    name = part or next(iter(parts))
    if name not in parts:
        _refuse_part(name, f"{next(iter(parts))} or all: the curve has no other part")
    return parts[name], name


def _refuse_part(part: str | None, allowed: str) -> NoReturn:
    raise SceneError("part", part, allowed)


def _on_part(name: str, parts: dict[str, Rows], rows: Rows, lines: Any) -> list[str]:
    """Return which part of the curve is taken."""
    ends = f"lines {lines[rows[0]]} to {lines[rows[-1]]}"
    if not parts:
        return [f"the rows are in no order of depth: all are one curve ({ends})"]
    told = f"part: {name}, {len(rows)} points ({ends})"
    others = [f"{other} has {len(some)} points" for other, some in parts.items() if other != name]
    return [f"{told}; {', '.join(others)}" if others and name != "all" else told]


def _on_loop(name: str, height: float, sigma: ArrayLike) -> list[str]:
    """Return that approach and retraction differ, if they do."""
    noise = float(np.mean(np.asarray(sigma)))
    if not abs(height) > _LOOP * noise:
        return []
    told = f"approach and retraction differ by {height:.3g} N on average"
    if name == "all":
        return [f"{told}, and are fitted as one curve: choose a part"]
    return [f"{told}, which is no elastic contact: plastic flow, adhesion or viscous loss"]


def _on_order(name: str, depth: Array, lines: Any) -> list[str]:
    """Return how many points of a part go back, and where."""
    if name == "all" or len(depth) < 2:
        return []
    steps = np.diff(depth) * (1.0 if name == "approach" else -1.0)
    back = np.flatnonzero(steps < 0.0)
    if not len(back):
        return []
    where = ", ".join(str(lines[k + 1]) for k in back[:_NAMED])
    more = f" and {len(back) - _NAMED} more" if len(back) > _NAMED else ""
    largest = float(-steps.min())
    told = f"the depth goes back at {len(back)} of {len(depth)} points"
    return [f"{told}, by {largest:.3g} m at most (lines {where}{more}); they are kept"]
