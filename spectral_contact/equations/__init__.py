"""The kernels, and the equations evaluated by quadrature: they know nothing of the solver."""

__all__: list[str] = []
