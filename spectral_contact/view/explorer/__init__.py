"""A scene to look at while it is moved: a page on this machine, or a cell of a notebook.

`state` has what is set, `shown` what is shown, and `look` makes it, without a browser.
`solver_processes` has processes that solve, each a `worker`, in the time that `budget` gives.
`page` and `widgets` show it with Panel and Bokeh (extra: explore), which are imported when they are
used, and `server` serves the page.
"""

from spectral_contact.view.explorer.page import explore
from spectral_contact.view.explorer.server import serve

__all__ = ["explore", "serve"]
