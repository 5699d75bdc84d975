"""Command line: `hpn select application.json`, `hpn fleet axes.parquet answers.parquet`, `hpn verify report.pdf`,
`hpn catalogue`, `hpn serve`, `hpn machine export ID FILE`, `hpn mcp`, `hpn database`, `hpn key NAME`, `hpn --version`.

Each command is a module of this package, which is imported when the command runs: none waits for what others need.
"""

import argparse
import gc
import io
import os
import signal
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

from hpn.installed import require

EXTRAS = {"serve": "serve", "database": "serve", "machine": "serve", "fleet": "fleet", "mcp": "mcp"}
"""Extras of commands that need one."""
EXIT_CODES = """exit codes:
  0    success: a gear is suitable, all rows are answered, nothing differs
  1    hpn select: no gear is suitable; other commands: stopped, or could not continue
  2    what the caller gave can’t be used: the text says why
  3    hpn select: could not continue; hpn verify: a shown figure differs
  128+ ended by a signal"""
COMMANDS = "select, fleet, machine, verify, catalogue, serve, mcp, database or key"


def main(arguments: list[str] | None = None) -> int:
    """Run a command.

    0 for success; 1 where something went wrong, of `hpn select` where no gear is suitable, and 3 where something went
    wrong; 2 for what the caller can mend; 128 and the number of the signal that ended it, as a shell says it.
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.command is None:
        parser.error(f"a command is required: {COMMANDS}")
    if sys.stdout is None:  # closed by the caller, who wants to see nothing
        sys.stdout = io.StringIO()
    try:
        result: int = _command(options.command).run(options)
        sys.stdout.flush()
        return result
    except BrokenPipeError:  # the reader has seen enough, such as head
        _discard_output()
        return 128 + signal.SIGPIPE
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except Exception as error:
        return _refused(error, options)


def _command(name: str) -> ModuleType:
    """Module of a command. Its imports are never garbage: collecting while they load takes a fifth of a start."""
    if name in EXTRAS:
        require(EXTRAS[name])
    gc.disable()
    try:
        return import_module(f"hpn.cli.{name}")
    finally:
        gc.freeze()
        gc.enable()


def _refused(error: Exception, options: argparse.Namespace) -> int:
    """Say in words what went wrong; the exit code says whose mistake it is."""
    module = "hpn.cli.system" if isinstance(error, OSError) else "hpn.cli.refusals"
    code, lines = import_module(module).words_of(error, options)
    if lines is None:
        if os.environ.get("HPN_LOG_LEVEL", "").lower() == "debug":
            raise error
        lines = [f"hpn made a mistake: {type(error).__name__}: {error}", "HPN_LOG_LEVEL=debug shows where"]
    print("\n".join(lines), file=sys.stderr)
    if isinstance(error, OSError) and error.filename is None:  # may be the output itself, on a full disk
        _discard_output()
    return int(code)


def _discard_output() -> None:
    """Write what is left of the output nowhere, else the interpreter's last flush complains."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


class _CommandParser(argparse.ArgumentParser):
    """Parser of `hpn`, whose help ends with exit codes and settings; those are loaded when they are asked for."""

    def format_help(self) -> str:
        """The help, for the terminal's width."""
        return f"{super().format_help()}\n{EXIT_CODES}\n\n{import_module('hpn.cli.settings').text()}"


def _parser() -> argparse.ArgumentParser:
    parser = _CommandParser("hpn", description="Select a Harmonic Drive HPN planetary gear.")
    parser.add_argument(
        "--version",
        action="store_const",
        const="version",
        dest="command",
        help="print versions of engine and catalogue",
    )
    commands = parser.add_subparsers(metavar="command", dest="command", parser_class=argparse.ArgumentParser)
    one = commands.add_parser(
        "select", help="select a gear for an application file (JSON, or AASX with a sizing; - for standard input)"
    )
    one.add_argument("file")
    form = one.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print the whole reply of the API; the default into a pipe")
    form.add_argument("--table", action="store_true", help="print a table; the default on a terminal")
    _add_fleet(commands.add_parser("fleet", help="select gears for a table of axes"))
    _add_machine(commands.add_parser("machine", help="export a machine of the database to a file, or import one"))
    _add_verify(commands.add_parser("verify", help="calculate the figures of a file again, and compare what it shows"))
    listing = commands.add_parser("catalogue", help="list the gears, or show one")
    listing.add_argument("designation", nargs="?")
    serve = commands.add_parser("serve", help="serve page and API")
    serve.add_argument("--host", help="address to listen on, instead of HPN_HOST")
    serve.add_argument("--port", type=_number, help="port to listen on, instead of HPN_PORT")
    serve.add_argument("--workers", type=_number, help="number of processes, instead of HPN_WORKERS")
    agents = commands.add_parser("mcp", help="answer agents over standard input and output")
    agents.add_argument("--service", metavar="URL", help="address of the service that its links lead to")
    commands.add_parser("database", help="update the database, and check that saving works")
    key = commands.add_parser("key", help="make an API key")
    key.add_argument("name", help="owner of the key, as in the logs")
    return parser


def _add_machine(machine: argparse.ArgumentParser) -> None:
    actions = machine.add_subparsers(metavar="action", dest="action", required=True)
    export = actions.add_parser("export", help="write a machine with its revisions as JSON, or its axes as a table")
    export.add_argument("id", metavar="ID", help="its id, or the address of its page")
    export.add_argument("file", metavar="FILE", help=".json, .csv or .parquet; - for JSON on standard output")
    taken = actions.add_parser("import", help="save a machine of a file as a new one, and print its address")
    taken.add_argument("file", metavar="FILE", help=".json that was exported, or a table of axes")
    taken.add_argument("--title", help="title of a machine out of a table")
    taken.add_argument(
        "--answer",
        metavar="COLUMN:MEANING",
        action="append",
        default=[],
        help="answer to a question about a table, such as Moment:Nm, 3:skip or decimal:,",
    )


def _add_verify(check: argparse.ArgumentParser) -> None:
    check.add_argument("file", type=Path, help="PDF, XLSX or AASX of a selection, JSON of a selection or machine")
    check.add_argument("--application", type=Path, metavar="FILE", help="application of an older file that has none")
    check.add_argument("--json", action="store_true", help="print the verdict as JSON")


def _add_fleet(fleet: argparse.ArgumentParser) -> None:
    formats = "Parquet, Arrow IPC or CSV, by the suffix .parquet, .arrow, .arrows, .feather, .csv or .csv.gz"
    fleet.add_argument("input", type=Path, metavar="INPUT", help=f"the axes, or the phases of axes: {formats}")
    fleet.add_argument("output", type=Path, metavar="OUTPUT", help="a row for each axis; .parquet, .arrow, .csv")
    fleet.add_argument("--axes", help=argparse.SUPPRESS)  # gone, and refused with what takes its place
    fleet.add_argument("--candidates", type=Path, metavar="FILE", help="write every candidate of every axis")
    fleet.add_argument("--rejected", type=Path, metavar="FILE", help="write the faults of axes that have no answer")
    fleet.add_argument(
        "--ignore",
        metavar="NAME",
        nargs="+",
        action="extend",
        default=[],
        help="leave out columns that no application has",
    )
    fleet.add_argument("--report", type=Path, metavar="FILE", help="write counts and the first 10,000 axes as HTML")
    fleet.add_argument("--lang", choices=("en", "de"), help="language of the report")
    fleet.add_argument("--service", metavar="URL", help="address of the service that its links lead to")
    fleet.add_argument("--engine", choices=("local", "dask"), default="local", help="threads of this machine, or Dask")
    fleet.add_argument("--scheduler", metavar="URL", help="address of a Dask cluster, such as tcp://host:8786")
    fleet.add_argument("--workers", type=_workers, metavar="N", help="threads; as many as there are cores by default")


def _workers(text: str) -> int:
    if not 1 <= (number := _number(text)) <= 1024:
        raise argparse.ArgumentTypeError("must be from 1 to 1024")
    return number


def _number(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, such as 4; {text[:40]!r} is none") from None
