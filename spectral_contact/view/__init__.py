"""What people see and type: reports, pictures, progress, the explorer, the command line."""

__all__: list[str] = []
