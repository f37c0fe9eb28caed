"""What the explorer is made of: widgets that move a scene, and figures of its fields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from spectral_contact.profiles.control import CONTROLS, SHAPES
from spectral_contact.view.explorer.state import FLAT, KNOBS, RTOL
from spectral_contact.view.figures import BLACK, BLUE, GREEN, SLIP_GREY, VERMILION

if TYPE_CHECKING:
    from spectral_contact.view.explorer.shown import Look

_HINT: Final = (
    "Type values beyond the sliders, such as a compliance of 0, friction <code>inf</code> (full "
    "stick) or <code>none</code> (no friction). Under a profile friction takes seconds for a "
    "scene, so the page does not follow the slider live."
)
#: What is drawn: the column, its label, how it looks.
_CURVES: Final = {
    "p": (("p", "p*", BLUE, "solid"),),
    "q": (("q", "q*", VERMILION, "solid"), ("fp", "f p*", BLACK, "dashed")),
    "slip": (("slip", "slip u_r*", GREEN, "solid"),),
}


def grid(panel: Any, least: int, children: Iterable[Any]) -> Any:
    """Return as many columns as fit, each of at least so many pixels."""
    columns = f"repeat(auto-fit, minmax(min(100%, {least}px), 1fr))"
    sheet = f":host {{ display: grid !important; grid-template-columns: {columns}; }}"
    return panel.Column(*children, sizing_mode="stretch_width", stylesheets=[sheet])


class Controls:
    """The widgets; a number is what its text says, and a slider moves the text.

    Attributes
    ----------
    boxes, sliders : dict
        Of every number, by its name.
    view : list
        All widgets, in their order on the page.
    """

    def __init__(self, panel: Any, texts: Mapping[str, str], moved: Callable[..., Any]) -> None:
        widgets = panel.widgets
        self.boxes = {
            name: widgets.TextInput(
                label=knob.label, value=texts.get(name, knob.start), sizing_mode="stretch_width"
            )
            for name, knob in KNOBS.items()
        }
        self.sliders = {name: self._slider(widgets, name) for name in KNOBS}
        wide: dict[str, Any] = {"sizing_mode": "stretch_width"}
        profile = texts.get("profile", "flat")
        self._profile = widgets.Select(
            label="punch", options=["flat", *SHAPES], value=profile, **wide
        )
        given = next((name for name in CONTROLS if name in texts), "load")
        self._control = widgets.Select(label="given", options=list(CONTROLS), value=given, **wide)
        self._coupling = widgets.Checkbox(
            label="elastic coupling", value=texts.get("coupling") == "true"
        )
        rtol = texts.get("rtol", RTOL)
        steps = sorted({"1e-4", "1e-6", "1e-8", "1e-10", "1e-12", rtol}, key=float, reverse=True)
        self._rtol = widgets.Select(label="tolerance", options=steps, value=rtol, **wide)
        self._rows = {
            name: panel.Column(self.boxes[name], self.sliders[name], **wide) for name in KNOBS
        }
        self.view = [
            *(self._rows[name] for name in FLAT),
            self._coupling,
            self._profile,
            *(self._rows[name] for name in KNOBS if name not in (*FLAT, *CONTROLS)),
            self._control,
            *(self._rows[name] for name in CONTROLS),
            self._rtol,
            panel.pane.HTML(_HINT, **wide),
        ]
        self._reveal()
        for one in (self._profile, self._control):
            one.param.watch(self._reveal, "value")
        for one in (self._profile, self._control, self._coupling, self._rtol, *self.boxes.values()):
            one.param.watch(moved, "value")

    @property
    def texts(self) -> dict[str, str]:
        """The state that is set."""
        shape = self._profile.value
        names = FLAT if shape == "flat" else (*FLAT, *SHAPES[shape], self._control.value)
        found = {name: self.boxes[name].value for name in names}
        if self._coupling.value:
            found["coupling"] = "true"
        if shape != "flat":
            found["profile"] = shape
        if self._rtol.value != RTOL:
            found["rtol"] = self._rtol.value
        return found

    def _reveal(self, *_: Any) -> None:
        """Show what belongs to the profile."""
        shape = self._profile.value
        shown = () if shape == "flat" else (*SHAPES[shape], self._control.value)
        for name in KNOBS:
            self._rows[name].visible = name in (*FLAT, *shown)
        self._control.visible = shape != "flat"

    def _slider(self, widgets: Any, name: str) -> Any:
        knob, text = KNOBS[name], self.boxes[name]
        low, high = knob.place(str(knob.low)), knob.place(str(knob.high))
        step = (high - low) / 400.0
        slider = widgets.FloatSlider(
            start=low,
            end=high,
            step=step,
            value=knob.place(text.value),
            show_value=False,
            margin=(0, 12, 2, 12),
            sizing_mode="stretch_width",
        )

        def apart() -> bool:
            return bool(abs(knob.place(text.value) - slider.value) > 0.5 * step)

        def typed(_: Any) -> None:
            if apart():
                slider.value = knob.place(text.value)

        def slid(_: Any) -> None:
            if apart():
                text.value = knob.text(slider.value)

        text.param.watch(typed, "value")
        slider.param.watch(slid, "value")
        return slider


class Figures:
    """The fields over the radius, and over the distance from the edge."""

    def __init__(self, panel: Any) -> None:
        from bokeh.models import ColumnDataSource

        names = ("s", "d", "p", "q", "fp", "slip")
        self._fields = ColumnDataSource({name: [] for name in names})
        self._zones = ColumnDataSource({name: [] for name in ("inner", "outer", "near", "far")})
        self._plots = {
            (symbol, over): self._plot(symbol, over)
            for symbol in _CURVES
            for over in ("s", "d")
            if (symbol, over) != ("slip", "d")
        }
        self._panes = {
            key: panel.pane.Bokeh(one, sizing_mode="stretch_width", visible=False)
            for key, one in self._plots.items()
        }
        self.view = grid(panel, 340, self._panes.values())
        self._panel = panel

    def _plot(self, symbol: str, over: str) -> Any:
        from bokeh.models import Range1d
        from bokeh.plotting import figure

        kind = "linear" if over == "s" else "log"
        plot = figure(
            height=230,
            sizing_mode="stretch_width",
            x_axis_type=kind,
            y_axis_type=kind,
            x_range=Range1d(0.0, 1.0),
            y_range=Range1d(0.0, 1.0),
            x_axis_label="radius s" if over == "s" else "distance from the edge 1 − s",
            visible=False,  # before there is anything to show
            tools="box_zoom,reset,save",
            toolbar_location="right",
        )
        plot.toolbar.autohide = True
        plot.toolbar.logo = None
        ends = ("inner", "outer") if over == "s" else ("far", "near")
        plot.vstrip(x0=ends[0], x1=ends[1], source=self._zones, color=SLIP_GREY, level="underlay")
        for name, label, colour, dash in _CURVES[symbol]:
            style: dict[str, Any] = {"color": colour, "line_dash": dash, "line_width": 2}
            plot.line(over, name, source=self._fields, legend_label=label, **style)
        plot.legend.orientation = "horizontal"
        plot.legend.padding = 0
        plot.legend.border_line_color = None
        plot.add_layout(plot.legend[0], "above")
        plot.axis.minor_tick_line_color = None
        return plot

    def show(self, look: Look) -> None:
        """Draw what is looked at."""
        assert look.columns is not None
        assert look.limits is not None
        inner, outer = np.array(look.zones or np.zeros((0, 2))).T
        depth = look.limits["d"][1]
        self._zones.data = {
            "inner": inner,
            "outer": outer,
            "far": np.minimum(1.0 - inner, 1.0),
            "near": np.maximum(1.0 - outer, depth),
        }
        self._fields.data = dict(look.columns)
        for (symbol, over), plot in self._plots.items():
            shown = bool(np.isfinite(look.columns[symbol]).any())
            # a page begins with the figures as they are, whatever their panes say
            plot.visible = self._panes[symbol, over].visible = shown
            if over == "d":
                plot.x_range.update(start=look.limits["d"][0], end=depth)
            limits = look.limits[symbol if over == "s" else f"log {symbol}"]
            plot.y_range.update(start=limits[0], end=limits[1])
        if self._panel.state.curdoc is None:
            self._panel.io.push_notebook(*self._panes.values())
