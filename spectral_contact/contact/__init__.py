"""The steps of a solve: normal contact, full stick, partial slip; internal, entered by `solve`."""

__all__: list[str] = []
