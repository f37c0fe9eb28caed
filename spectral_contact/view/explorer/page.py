"""The explorer as a page of Panel and Bokeh, in a notebook or for `server` to serve."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from html import escape
from typing import Any, Final

from spectral_contact.errors import optional
from spectral_contact.scene import Scene
from spectral_contact.view.explorer.shown import Look
from spectral_contact.view.explorer.solver_processes import LookRequest, Solvers
from spectral_contact.view.explorer.state import query_of, texts_of
from spectral_contact.view.explorer.widgets import Controls, Figures, grid

_COMPLAINT: Final = {
    "background": "#FBE5D6",
    "border-left": "4px solid #D55E00",
    "padding": "6px 10px",
    "font-size": "15px",
}
_TABLES: Final = """
table { border-collapse: collapse; font-size: 13px; margin: 6px 0; }
td, th { padding: 1px 12px 1px 0; text-align: left; vertical-align: top; }
td:nth-child(2) { white-space: nowrap; }
pre { font-size: 12.5px; padding: 8px; background: #F4F4F4; white-space: pre-wrap; }
svg { max-width: 100%; }
"""
#: After so many seconds without an answer the page says that it waits.
_PATIENCE: Final = 0.2
#: So many seconds after the last move the address has the state: each is a step of "back".
_REST: Final = 0.3
#: A solve that is still running so many seconds after its scene was changed is ended. Ending it at
#: once would show nothing while a slider moves, and a new process imports the library for a second.
_GRACE: Final = 2.0


def explore(scene: Scene | None = None, *, rtol: float | None = None) -> Any:
    """Return the explorer of a scene, which a notebook shows: sliders, fields, zones, errors.

    ``spectral-contact explore`` opens the same in a browser.

    Parameters
    ----------
    scene : Scene, optional
        Where to begin; of a scene in SI units the dimensionless one.
    rtol : float, optional
        Tolerance of the solves; 1e-8 by default.

    Returns
    -------
    panel.viewable.Viewable

    Raises
    ------
    SceneError
        If it is no scene, or one with a nonlinear layer, adhesion, a load below the largest, two
        elastic bodies, or a profile of points, of functions or of a sum.
    MissingDependencyError
        If Panel is not installed (extra: explore).
    """
    texts = texts_of(scene, rtol)
    panel = optional("panel", "explore")
    if panel.state.curdoc is None:
        panel.extension()
    solvers = Solvers()
    page = Page(texts, solvers)
    look = solvers.request(texts).future.result()
    assert look is not None
    page.show(texts, look)
    return page.view


class Page:
    """What one visitor sees, and what he has set.

    Parameters
    ----------
    texts : mapping
        The state to begin with; it is shown when `begin` is called.
    solvers : Solvers
    follow : callable, optional
        Is told the query of the link to every state that is shown.

    Attributes
    ----------
    view : panel.viewable.Viewable
    controls : Controls
    message, code : panel.pane.HTML
        Why the last change was refused, and the Python lines of the last that was not.
    """

    def __init__(
        self,
        texts: Mapping[str, str],
        solvers: Solvers,
        follow: Callable[[str], object] | None = None,
    ) -> None:
        self._panel = optional("panel", "explore")
        self._solvers = solvers
        self._follow = follow
        self._wanted: dict[str, str] | None = None
        self._request: LookRequest | None = None
        self._superseded = False
        self._busy = False
        self._shown = texts
        self.controls = Controls(self._panel, texts, self.begin)
        self._figures = Figures(self._panel)
        pane = self._panel.pane
        self.message = pane.HTML(
            "",
            visible=False,
            styles=_COMPLAINT,
            stylesheets=[_TABLES],
            sizing_mode="stretch_width",
        )
        self._tables = pane.HTML("", stylesheets=[_TABLES], sizing_mode="stretch_width")
        self._waits = pane.HTML("solving …", visible=False)
        self._cost = pane.HTML("", sizing_mode="stretch_width")
        self.code = pane.HTML("", stylesheets=[_TABLES], sizing_mode="stretch_width")
        self._copied = self._panel.widgets.TextInput(visible=False)
        self.view = self._layout()

    @property
    def texts(self) -> dict[str, str]:
        """The state that the widgets have."""
        return self.controls.texts

    def complain(self, message: str, code: str = "") -> None:
        """Show why something is refused; the last scene that was not stays where it is.

        Parameters
        ----------
        message : str
        code : str
            Python lines that do it elsewhere, if there are any.
        """
        lines = f"<pre>{escape(code)}</pre>" if code else ""
        self.message.param.update(object=escape(message) + lines, visible=True)

    def close(self, *_: Any) -> None:
        """End the solve that is running: nobody looks at the page any more."""
        self._wanted = None
        if self._request is not None:
            self._request.cancel()

    def _layout(self) -> Any:
        panel = self._panel
        copy = panel.widgets.Button(label="copy Python", width=110)
        copy.js_on_click({"text": self._copied}, code="navigator.clipboard.writeText(text.value)")
        buttons = [self._copied, copy]  # what is on no page is unknown to its scripts
        if self._follow is not None:
            link = panel.widgets.Button(label="copy link", width=110)
            link.js_on_click(code="navigator.clipboard.writeText(window.location.href)")
            buttons.append(link)
        left = panel.Column(
            grid(panel, 160, self.controls.view), styles={"flex": "1 1 270px", "max-width": "100%"}
        )
        right = panel.Column(
            self.message,
            self._waits,
            self._cost,
            self._figures.view,
            panel.FlexBox(
                panel.Column(self._tables, styles={"flex": "2 1 340px", "min-width": "0"}),
                panel.Column(
                    panel.Row(*buttons), self.code, styles={"flex": "1 1 300px", "min-width": "0"}
                ),
                sizing_mode="stretch_width",
            ),
            styles={"flex": "5 1 340px", "min-width": "0"},
        )
        return panel.FlexBox(left, right, sizing_mode="stretch_width", styles={"gap": "12px"})

    async def begin(self, *_: Any) -> None:
        """Show what is set. What is set while a scene is solved waits, and only the last of it."""
        self._wanted = self.texts
        if self._busy:
            self._supersede()
            return
        self._busy = True
        try:
            while self._wanted is not None:
                texts, self._wanted = self._wanted, None
                look = await self._look(texts)
                if look is not None:
                    self._panel.state.execute(lambda t=texts, one=look: self.show(t, one))
        finally:
            self._busy = False
        await asyncio.sleep(_REST)
        if self._follow is not None and texts == self._shown and not self._busy:
            self._panel.state.execute(self._tell)

    async def _look(self, texts: Mapping[str, str]) -> Look | None:
        """Return what is to be shown of a state, None if the solve was ended for a later one."""
        self._superseded = False
        self._request = self._solvers.request(texts)
        try:
            answer = asyncio.wrap_future(self._request.future)
            await asyncio.wait([answer], timeout=_PATIENCE)
            if not answer.done():
                self._panel.state.execute(self._wait)
            return await answer
        finally:
            self._request = None

    def _supersede(self) -> None:
        """End the solve that is running in a while: another state is set."""
        if self._request is not None and not self._superseded:
            self._superseded = True
            asyncio.get_running_loop().call_later(_GRACE, self._request.cancel)

    def _wait(self) -> None:
        """Say that what is shown is not what is set, yet."""
        self._waits.visible = True

    def show(self, texts: Mapping[str, str], look: Look) -> None:
        """Show a state that was looked at, or why it is refused."""
        self._waits.visible = False
        if look.complaint:
            self.complain(look.complaint, look.code)
            return
        with self._panel.io.hold():
            self.message.param.update(object="", visible=False)
            self._figures.show(look)
            self._tables.object = look.tables
            self._cost.object = escape(look.cost)
            self.code.object = f"<pre>{escape(look.code)}</pre>"
            self._copied.value = look.code
        self._shown = texts

    def _tell(self) -> None:
        """Tell the link to what is shown."""
        assert self._follow is not None
        self._follow(query_of(self._shown))
