"""`python -m roslet` is the `roslet` command."""

import sys

from roslet.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
