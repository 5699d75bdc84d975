"""`python -m hpn`."""

import sys

from hpn.cli import main

if __name__ == "__main__":  # processes that are started from here read this file, too
    sys.exit(main())
