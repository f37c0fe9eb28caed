"""Series that fields are given by, with what evaluates them; internal."""

__all__: list[str] = []
