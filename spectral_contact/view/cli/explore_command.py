"""``spectral-contact explore``."""

from __future__ import annotations

from functools import partial

from spectral_contact.view.cli.options import Number, Whole
from spectral_contact.view.cli.scene_options import SceneOptions
from spectral_contact.view.explorer.server import serve


def run(
    scene: SceneOptions,
    *,
    rtol: Number | None = None,
    port: Whole = 0,
    no_browser: bool = False,
) -> None:
    """Interactive explorer in a browser.

    Open a page with sliders in the browser (needs the extra: explore). It shows the scene of the
    options first. Only this machine can reach it; Ctrl-C ends it. Exit status: 0 ended by Ctrl-C,
    2 bad input or no free port.

    Parameters
    ----------
    rtol : X
        Bound on relative errors, 1e-12 to 1e-2; by default 1e-8.
    port : N
        Port of 127.0.0.1; 0 is any free one.
    no_browser : flag
        Print the address and open no browser.

    Examples
    --------
    spectral-contact explore --poisson-ratio 0.3 --friction 0.05
    """
    # it is called with the address of the page
    started = partial(print, flush=True)
    serve(scene.build().scene, rtol=rtol, port=port, started=started, show=not no_browser)
