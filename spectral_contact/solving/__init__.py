"""The way of a scene through `solve`: the plan, its steps, what solves share; internal."""

__all__: list[str] = []
