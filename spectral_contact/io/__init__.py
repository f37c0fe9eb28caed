"""What goes in and out: input is checked, files are written whole or not at all; internal."""

__all__: list[str] = []
