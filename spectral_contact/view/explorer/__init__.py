"""A scene to look at while it is moved: a page on this machine, or a cell of a notebook.

`state` has what is set and `look` what is shown, without a browser; `page` and `widgets` show it
with Panel and Bokeh (extra: explore), which are imported when they are used.
"""

from spectral_contact.view.explorer.page import explore, serve

__all__ = ["explore", "serve"]
