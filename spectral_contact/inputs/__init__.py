"""Checks of what users give: numbers, names, units; internal."""

__all__: list[str] = []
