"""Options of the command line and what its subcommands do; the program is ``__main__``."""

__all__: list[str] = []
