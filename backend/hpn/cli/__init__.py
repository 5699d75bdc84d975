"""Command line: `hpn select application.json`, `hpn catalogue`, `hpn serve`, `hpn key NAME`.

Each command is a module of this package, which is imported when the command runs: none waits for what others need.
"""

import argparse
import os
import signal
import sys
from importlib import import_module


def main(arguments: list[str] | None = None) -> int:
    """Run a command; 0 for success, 1 where no gear is suitable, 2 for input that can't be used."""
    options = _parser().parse_args(arguments)
    try:
        result: int = import_module(f"hpn.cli.{options.command}").run(options)
        sys.stdout.flush()
        return result
    except BrokenPipeError:  # whoever reads has seen enough, such as head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else the interpreter's last flush complains
        return 128 + signal.SIGPIPE
    except Exception as error:
        lines = import_module("hpn.cli.refusals").lines_of(error, options)
        if lines is None:
            raise
        print("\n".join(lines), file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("hpn", description="Select a Harmonic Drive HPN planetary gear.")
    commands = parser.add_subparsers(required=True, metavar="command", dest="command")
    one = commands.add_parser("select", help="select a gear for an application file (JSON; - for standard input)")
    one.add_argument("file")
    form = one.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print the whole reply of the API; the default into a pipe")
    form.add_argument("--table", action="store_true", help="print a table; the default on a terminal")
    listing = commands.add_parser("catalogue", help="list the gears, or show one")
    listing.add_argument("designation", nargs="?")
    serve = commands.add_parser("serve", help="serve page and API")
    serve.add_argument("--host", help="address to listen on, instead of HPN_HOST")
    serve.add_argument("--port", type=int, help="port to listen on, instead of HPN_PORT")
    serve.add_argument("--workers", type=int, help="number of processes, instead of HPN_WORKERS")
    key = commands.add_parser("key", help="make an API key")
    key.add_argument("name", help="who gets it; the logs name it")
    return parser
