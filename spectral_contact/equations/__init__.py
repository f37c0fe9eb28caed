"""What loads do to the half-space, on its surface and inside, by quadrature; knows no solver."""

__all__: list[str] = []
