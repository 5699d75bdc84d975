"""`python -m hpn.cli.tethered COMMAND …`: a command that ends when the process that started it is gone, killed or not.

That one leads a group of processes for it, and holds the other end of its standard input, which never says anything.
"""

import os
import signal
import sys
import threading

from hpn.cli import main


def _end_with_input() -> None:
    os.read(0, 1)
    if os.getpgrp() == os.getpid():
        os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    threading.Thread(target=_end_with_input, daemon=True).start()
    sys.exit(main())
