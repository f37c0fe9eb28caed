"""The explorer as a page of Panel and Bokeh, served on this machine alone, or in a notebook."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Mapping
from html import escape
from typing import Any, Final

from spectral_contact.errors import SceneError, optional
from spectral_contact.io.checks import whole
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve
from spectral_contact.view.explorer.look import Look, look_at
from spectral_contact.view.explorer.state import query_of, texts_from, texts_of
from spectral_contact.view.explorer.widgets import Controls, Figures, grid

#: The loopback address: nobody else on the network reaches the page.
ADDRESS: Final = "127.0.0.1"
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
_TEMPLATE: Final = """
{% extends base %}
{% block preamble %}
<meta name="viewport" content="width=device-width, initial-scale=1">
{% endblock %}
{% block contents %}{{ embed(roots.explorer) }}{{ embed(roots.location) }}{% endblock %}
"""


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
        If it is no scene, or one with a layer or a sampled profile.
    MissingDependencyError
        If Panel is not installed (extra: explore).
    """
    texts = texts_of(scene, rtol)
    panel = optional("panel", "explore")
    if panel.state.curdoc is None:
        panel.extension()
    return Page(texts).view


def serve(
    scene: Scene | None = None,
    *,
    started: Callable[[str], object],
    rtol: float | None = None,
    port: int = 0,
    show: bool = True,
) -> None:
    """Serve the explorer on the loopback address until it is interrupted.

    Parameters
    ----------
    scene, rtol
        As of `explore`.
    started : callable
        Is told the address when the page can be opened.
    port : int
        0 is any that is free.
    show : bool
        Whether to open it in the user's browser.

    Raises
    ------
    SceneError
        As `explore` does, and for a port that cannot be had.
    MissingDependencyError
        If Panel is not installed (extra: explore).
    """
    query = query_of(texts_of(scene, rtol))
    panel = optional("panel", "explore")
    port = _free_port(port)
    origins = [f"{ADDRESS}:{port}", f"localhost:{port}"]
    server = panel.io.server.get_server(
        {"/": lambda: _session(panel)},
        port=port,
        address=ADDRESS,
        websocket_origin=origins,
        title="spectral_contact explorer",
        index=None,
    )
    address = f"http://{ADDRESS}:{port}/{query}"
    server.io_loop.asyncio_loop.set_exception_handler(_unless_gone)
    server.start()
    started(address)
    if show:
        import webbrowser

        webbrowser.open_new_tab(address)
    try:
        server.io_loop.start()
    finally:
        server.stop()


def _unless_gone(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Say nothing of a visitor who leaves while he is told something."""
    from tornado.websocket import WebSocketClosedError

    if not isinstance(context.get("exception"), WebSocketClosedError):
        loop.default_exception_handler(context)


def _session(panel: Any) -> Any:
    """Return the page of one visitor, in the state that the address has."""
    location = panel.state.location
    complaint = ""
    try:
        texts = texts_from(location.search or "")
    except SceneError as error:
        texts, complaint = texts_of(None), str(error)
    page = Page(texts, follow=lambda query: setattr(location, "search", query))
    if complaint:
        page.complain(complaint)
    template = panel.Template(_TEMPLATE, location=True)
    template.add_panel("explorer", page.view)
    return template


def _free_port(port: int) -> int:
    """Return a port of the loopback address that is free now."""
    number = whole("port", port, 0)
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((ADDRESS, number))
            return int(probe.getsockname()[1])
    except (OSError, OverflowError) as error:
        raise SceneError("port", port, f"a port of {ADDRESS} that is free ({error})") from error


class Page:
    """What one visitor sees, and what he has set.

    Parameters
    ----------
    texts : mapping
        The state to begin with.
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
        self, texts: Mapping[str, str], follow: Callable[[str], object] | None = None
    ) -> None:
        self._panel, self._follow = optional("panel", "explore"), follow
        self._wanted: dict[str, str] | None = None
        self._busy, self._shown = False, texts
        self.controls = Controls(self._panel, texts, self._refresh)
        self._figures = Figures(self._panel)
        pane = self._panel.pane
        self.message = pane.HTML("", visible=False, styles=_COMPLAINT, sizing_mode="stretch_width")
        self._tables = pane.HTML("", stylesheets=[_TABLES], sizing_mode="stretch_width")
        self._waits = pane.HTML("solving …", visible=False)
        self._cost = pane.HTML("", sizing_mode="stretch_width")
        self.code = pane.HTML("", stylesheets=[_TABLES], sizing_mode="stretch_width")
        self._copied = self._panel.widgets.TextInput(visible=False)
        self.view = self._layout()
        self.show(texts, look_at(texts, solve))

    @property
    def texts(self) -> dict[str, str]:
        """The state that the widgets have."""
        return self.controls.texts

    def complain(self, message: str) -> None:
        """Show why something is refused; the last scene that was not stays where it is."""
        self.message.param.update(object=escape(message), visible=True)

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

    async def _refresh(self, *_: Any) -> None:
        """Show what is set. What is set while a scene is solved waits, and only the last of it."""
        self._wanted = self.texts
        if self._busy:
            return
        self._busy = True
        try:
            while self._wanted is not None:
                texts, self._wanted = self._wanted, None
                loop = asyncio.get_running_loop()
                work = loop.run_in_executor(None, look_at, texts, solve)
                await asyncio.wait([work], timeout=_PATIENCE)
                if not work.done():
                    self._panel.state.execute(self._wait)
                look = await work
                self._panel.state.execute(lambda t=texts, one=look: self.show(t, one))
        finally:
            self._busy = False
        await asyncio.sleep(_REST)
        if self._follow is not None and texts == self._shown and not self._busy:
            self._panel.state.execute(self._tell)

    def _wait(self) -> None:
        """Say that what is shown is not what is set, yet."""
        self._waits.visible = True

    def show(self, texts: Mapping[str, str], look: Look) -> None:
        """Show a state that was looked at, or why it is refused."""
        self._waits.visible = False
        if look.complaint:
            self.complain(look.complaint)
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
