"""Command line: `hpn select application.json`, `hpn catalogue`, `hpn serve`, `hpn key NAME`."""

import argparse
import asyncio
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

import orjson
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.candidates import Candidate
from hpn.catalogue import Catalogue, load_catalogue
from hpn.catalogue.tables import CatalogueError
from hpn.checks import allowed, telling_decimals
from hpn.selection import select
from hpn.store import Store, StoreError, StoreUnavailableError
from hpn.web import serve as serving
from hpn.web.door.keys import new_key
from hpn.web.door.problems import Problem, plain_message
from hpn.web.form.write import to_link
from hpn.web.pages.gear_figures import is_supplied
from hpn.web.settings import Settings


def main(arguments: list[str] | None = None) -> int:
    """Run a command; 0 for success, 1 where no gear is suitable, 2 for input that can't be used."""
    options = _parser().parse_args(arguments)
    try:
        result: int = options.run(options)
        sys.stdout.flush()
        return result
    except BrokenPipeError:  # whoever reads has seen enough, such as head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else the interpreter's last flush complains
        return 128 + signal.SIGPIPE
    except (CatalogueError, StoreError, OSError) as error:
        return _refuse(str(error))
    except (ValidationError, InputError) as error:
        if isinstance(error, ValidationError) and error.title == Settings.__name__:
            return _refuse(_wrong_settings(error, options))
        problem = Problem.of(error)
        lines = [f"{entry['pointer'] or '/'}: {entry['detail']}" for entry in problem.body().get("errors", ())]
        return _refuse("\n".join(lines) or problem.detail)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("hpn", description="Select a Harmonic Drive HPN planetary gear.")
    commands = parser.add_subparsers(required=True, metavar="command")
    one = commands.add_parser("select", help="select a gear for an application file (JSON; - for standard input)")
    one.add_argument("file")
    form = one.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print the whole reply of the API; the default into a pipe")
    form.add_argument("--table", action="store_true", help="print a table; the default on a terminal")
    one.set_defaults(run=_select)
    listing = commands.add_parser("catalogue", help="list the gears, or show one")
    listing.add_argument("designation", nargs="?")
    listing.set_defaults(run=_catalogue)
    serve = commands.add_parser("serve", help="serve page and API")
    serve.add_argument("--host", help="address to listen on, instead of HPN_HOST")
    serve.add_argument("--port", type=int, help="port to listen on, instead of HPN_PORT")
    serve.add_argument("--workers", type=int, help="number of processes, instead of HPN_WORKERS")
    serve.set_defaults(run=_serve)
    key = commands.add_parser("key", help="make an API key")
    key.add_argument("name", help="who gets it; the logs name it")
    key.set_defaults(run=_key)
    return parser


def _select(options: argparse.Namespace) -> int:
    content = sys.stdin.buffer.read() if options.file == "-" else Path(options.file).read_bytes()
    application = Application.model_validate_json(content)
    selection = select(application, _loaded())
    link = to_link(application)
    if options.json or not (options.table or sys.stdout.isatty()):
        sys.stdout.write(selection.json(link).decode() + "\n")
    else:
        reply = selection.reply(link)
        print(f"selected: {reply['selected'] or 'none is suitable'}")
        for candidate in reply["candidates"]:
            used = _percent(candidate, application.requirements.utilisation)
            print(f"{candidate['designation']:<11} {candidate['status']:<10} {used:>8}  {candidate['reason']}")
        for notice in reply["notices"]:
            print(f"note: {notice['text']}")
    return 0 if selection.selected else 1


def _percent(candidate: Candidate, utilisation: float) -> str:
    used, bound = candidate["utilisation"], allowed(candidate["governing_check"], utilisation)
    return "" if used is None else f"{100 * used:.{telling_decimals(100 * used, 100 * bound, 1)}f}%"


def _catalogue(options: argparse.Namespace) -> int:
    catalogue = _loaded()
    if options.designation is None:
        for gear in catalogue.gears:
            rated = f"T_N {gear.rated_torque_Nm:g} Nm" if gear.rated_torque_Nm else "unrated"
            mark = " (supplied by the user)" if is_supplied(gear, "rated_torque_Nm") else ""
            print(f"{gear.designation:<11} {gear.stages}-stage  {rated}{mark}")
        return 0
    found = catalogue.find(options.designation)
    if found is None:
        return _refuse(f"the catalogue has no gear {options.designation!r}; a designation is written like HPN-20A-5")
    print(orjson.dumps(found, option=orjson.OPT_INDENT_2).decode())
    return 0


def _serve(options: argparse.Namespace) -> int:
    given = {name: getattr(options, name) for name in ("host", "port", "workers")}
    settings = Settings(**{name: value for name, value in given.items() if value is not None})
    load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)  # a wrong one stops here, with its place
    asyncio.run(_migrate(Store(settings.database_url.get_secret_value(), seconds=settings.database_seconds)))
    serving.run(settings)
    return 0


def _key(options: argparse.Namespace) -> int:
    try:
        key, pair = new_key(options.name)
    except ValueError as error:
        return _refuse(str(error))
    print(f"key, to be given to {options.name}; it is shown only now:\n  {key}")
    print(f"pair, to be added to HPN_API_KEYS:\n  {pair}")
    return 0


async def _migrate(store: Store) -> None:
    """Bring the database up to date before any worker starts, so that a refusal is a text and not a trace."""
    with suppress(StoreUnavailableError):  # the calculator works without
        await store.open()
    await store.close()


def _loaded() -> Catalogue:
    settings = Settings()
    return load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)


def _wrong_settings(error: ValidationError, options: argparse.Namespace) -> str:
    """A line for each wrong setting, named as it was given: by option or by variable."""
    lines = []
    for entry in error.errors(include_url=False, include_context=False, include_input=False):
        text = plain_message(entry["type"], entry["msg"])
        for name in map(str, entry["loc"][:1]):
            given = f"--{name}" if getattr(options, name, None) is not None else f"HPN_{name.upper()}"
            text = f"{given}: {text}"
        lines.append(text)
    return "\n".join(dict.fromkeys(lines))


def _refuse(text: str) -> int:
    print(text, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
