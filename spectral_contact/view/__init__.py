"""What a reader sees: reports, pictures, radii to draw at, a line of progress."""

__all__: list[str] = []
