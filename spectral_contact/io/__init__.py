"""Files: solutions, scenes and tables as JSON and npz, written whole or not at all; internal."""

__all__: list[str] = []
