"""Run the command line: ``python -m spectral_contact``."""

import sys

from spectral_contact.cli.commands import main

sys.exit(main())
