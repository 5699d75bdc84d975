"""Command line: `hpn select application.json`, `hpn fleet axes.parquet answers.parquet`, `hpn verify report.pdf`,
`hpn catalogue`, `hpn serve`, `hpn machine export ID FILE`, `hpn mcp`, `hpn database`, `hpn key NAME`, `hpn --version`.

Each command is a module of this package, imported when it runs: no command waits for the imports of another.
"""

import argparse
import gc
import io
import os
import re
import signal
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType

from hpn.installed import require

EXTRAS = {"serve": "serve", "database": "serve", "machine": "serve", "fleet": "fleet", "mcp": "mcp"}
"""Extras of the commands that need one."""
EXIT_CODES = """exit codes:
  0    success: a gear is suitable, all rows are answered, nothing differs
  1    hpn select: no gear is suitable; other commands: stopped, or could not continue
  2    what the caller gave can’t be used: the text says why
  3    hpn select: could not continue; hpn verify: a shown figure differs
  128+ ended by a signal"""
MORE = "hpn --help has the exit codes and all settings."
COMMANDS = "select, fleet, machine, verify, catalogue, serve, mcp, database or key"


def main(arguments: list[str] | None = None) -> int:
    """Run a command; returns its exit code.

    0 for success. 1 where the command could not continue; for `hpn select` where no gear is suitable, and 3 where it
    could not continue. 2 for a fault that the caller can mend. 128 plus the number of the signal that ended it, as in a
    shell.
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.command is None:
        parser.error(f"a command is required: {COMMANDS}")
    if sys.stdout is None:  # closed by a caller who wants no output
        sys.stdout = io.StringIO()
    try:
        result: int = _command(options.command).run(options)
        sys.stdout.flush()
        return result
    except BrokenPipeError:  # the reader, such as head, has stopped reading
        _discard_output()
        return 128 + signal.SIGPIPE
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except Exception as error:
        return _print_error(error, options)


def _command(name: str) -> ModuleType:
    """Module of a command. Its imports are never garbage: a collection while they load takes a fifth of a start."""
    if name in EXTRAS:
        require(EXTRAS[name])
    gc.disable()
    try:
        return import_module(f"hpn.cli.{name}")
    finally:
        gc.freeze()
        gc.enable()


def _print_error(error: Exception, options: argparse.Namespace) -> int:
    """Print the error in words; returns the exit code, which tells whose fault it is."""
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
    """Discard the rest of the output, else the interpreter's last flush fails."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


class _CommandParser(argparse.ArgumentParser):
    """Parser of `hpn`, whose help ends with exit codes and settings; settings are loaded only for the help."""

    def format_help(self) -> str:
        """Help text, for the terminal's width."""
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
    add = partial(_add_command, commands.add_parser)
    one = add("select", "select a gear for an application file")
    one.add_argument("file", help="application as JSON, or an AASX or JSON with a sizing; - for standard input")
    form = one.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print the whole reply of the API; the default into a pipe")
    form.add_argument("--table", action="store_true", help="print a table; the default on a terminal")
    _add_fleet(add("fleet", "select gears for a table of axes"))
    _add_machine(add("machine", "export a machine of the database to a file, or import one"))
    _add_verify(add("verify", "calculate the figures of a file again, and compare what it shows"))
    listing = add("catalogue", "list the gears, or show one")
    listing.add_argument("designation", nargs="?", help="the gear to show, such as HPN-20A-5")
    serve = add("serve", "serve page and API")
    serve.add_argument("--host", help="address to listen on, instead of HPN_HOST")
    serve.add_argument("--port", type=_number, help="port to listen on, instead of HPN_PORT")
    serve.add_argument("--workers", type=_number, help="number of processes, instead of HPN_WORKERS")
    agents = add("mcp", "answer agents over standard input and output")
    agents.add_argument("--service", metavar="URL", type=_address, help="address of the service that its links lead to")
    add("database", "update the database, and check that saving works")
    key = add("key", "make an API key")
    key.add_argument("name", help="owner of the key, as in the logs")
    return parser


def _add_command(add: Callable[..., argparse.ArgumentParser], name: str, text: str) -> argparse.ArgumentParser:
    """Parser of a command, whose own help repeats the text as its description."""
    return add(name, help=text, description=f"{text[0].upper()}{text[1:]}.", epilog=MORE)


def _add_machine(machine: argparse.ArgumentParser) -> None:
    actions = machine.add_subparsers(metavar="action", dest="action", required=True)
    export = _add_command(
        actions.add_parser, "export", "write a machine with its revisions as JSON, or its axes as a table"
    )
    export.add_argument("id", metavar="ID", help="its id, or the address of its page")
    export.add_argument("file", metavar="FILE", help=".json, .csv or .parquet; - for JSON on standard output")
    loading = _add_command(actions.add_parser, "import", "save a machine of a file as a new one, and print its address")
    loading.add_argument("file", metavar="FILE", help=".json that was exported, or a table of axes")
    loading.add_argument("--title", help="title of a machine out of a table")
    loading.add_argument(
        "--answer",
        metavar="COLUMN:MEANING",
        action="append",
        default=[],
        help="answer to a question about a table, such as Moment:Nm, 3:skip or decimal:,",
    )


def _add_verify(check: argparse.ArgumentParser) -> None:
    check.add_argument("file", type=Path, help="PDF, XLSX or AASX of a selection, JSON of a selection or machine")
    check.add_argument(
        "--application",
        type=Path,
        metavar="FILE",
        help="application, or JSON of the saved selection, of an older file that has none",
    )
    check.add_argument("--json", action="store_true", help="print the verdict as JSON")


def _add_fleet(fleet: argparse.ArgumentParser) -> None:
    formats = "Parquet, Arrow IPC or CSV, by the suffix .parquet, .arrow, .arrows, .feather, .csv or .csv.gz"
    fleet.add_argument("input", type=Path, metavar="INPUT", help=f"the axes, or the phases of axes: {formats}")
    fleet.add_argument("output", type=Path, metavar="OUTPUT", help="a row for each axis; .parquet, .arrow, .csv")
    fleet.add_argument("--axes", help=argparse.SUPPRESS)  # removed; the refusal names its replacement
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
    fleet.add_argument("--service", metavar="URL", type=_address, help="address of the service that its links lead to")
    fleet.add_argument("--engine", choices=("local", "dask"), default="local", help="threads of this machine, or Dask")
    fleet.add_argument("--scheduler", metavar="URL", help="address of a Dask cluster, such as tcp://host:8786")
    fleet.add_argument("--workers", type=_workers, metavar="N", help="threads; as many as there are cores by default")


def _workers(text: str) -> int:
    if not 1 <= (number := _number(text)) <= 1024:
        raise argparse.ArgumentTypeError("must be from 1 to 1024")
    return number


def _address(text: str) -> str:
    if not re.fullmatch(r"https?://[^/\s]+(/\S*)?", text):
        raise argparse.ArgumentTypeError(f"must be an address, such as https://plm.example; {text[:40]!r} is none")
    return text


def _number(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, such as 4; {text[:40]!r} is none") from None
