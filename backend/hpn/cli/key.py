"""`hpn key`: a new API key, and its pair for the settings."""

import argparse
import sys

from hpn.web.door.keys import new_key


def run(options: argparse.Namespace) -> int:
    """Print a new key, which is stored nowhere, and its pair for the settings."""
    try:
        key, pair = new_key(options.name)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"key, to be given to {options.name}; it is shown only now:\n  {key}")
    print(f"pair, to be added to HPN_API_KEYS:\n  {pair}")
    return 0
