"""Picture of a fit: measured loads over depths with the fitted curve, and the residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spectral_contact.calibration.indentation_curve import IndentationFit
from spectral_contact.io.choices import instance
from spectral_contact.view.figures import BLUE, VERMILION, new_figure, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Lines are drawn at residuals of plus and minus this many standard deviations of the loads; most
#: residuals are between them.
_BAND = 2.0


def plot_fit(fitted: IndentationFit) -> Figure:
    """Plot the measured loads with the fitted curve, and the residuals below.

    Parameters
    ----------
    fitted : IndentationFit

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SceneError
        If it is no fit.
    MissingDependencyError
        If matplotlib is not installed.
    """
    instance("fitted", fitted, IndentationFit)
    depth = np.array(fitted.data.depth)
    order = np.argsort(depth, kind="stable")
    with style():
        figure = new_figure(figsize=(5.5, 4.5), layout="constrained")
        curve, residuals = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
        dots = {"marker": ".", "linestyle": "none", "markersize": 3.0}
        curve.plot(depth, fitted.data.load, color=BLUE, label="measured", **dots)
        curve.plot(depth[order], np.array(fitted.loads)[order], color=VERMILION, label="fitted")
        curve.set_ylabel("load / N")
        curve.legend()
        residuals.plot(depth, fitted.residuals, color=BLUE, **dots)
        for level in (-_BAND, 0.0, _BAND):
            residuals.axhline(level, color=VERMILION, linewidth=0.8 if level else 1.4)
        residuals.set_ylabel("residual / σ")
        residuals.set_xlabel("depth / m")
    return figure
