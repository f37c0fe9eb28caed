"""The command line: `main` and its commands."""

from spectral_contact.cli.commands import main

__all__ = ["main"]
