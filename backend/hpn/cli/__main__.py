"""`python -m hpn.cli`."""

import sys

from hpn.cli import main

sys.exit(main())
