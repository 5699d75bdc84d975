"""`hpn select`: a gear for an application file."""

import argparse
import codecs
import errno
import sys

from hpn.application import Application
from hpn.application.unique import require_unique
from hpn.engine.candidates import Candidate
from hpn.engine.checks import allowed
from hpn.engine.selection import Selection, encode, select
from hpn.files.aas.opened import is_shell, sizing_in
from hpn.links.writer import to_link
from hpn.web.settings import Settings
from hpn.words.wording import MendableError, telling_decimals

MAXIMUM_FILE_BYTES = 32_000_000
"""Most bytes of an application: enough for 10,000 phases in any layout."""


def run(options: argparse.Namespace) -> int:
    """Print the reply, by default as JSON into a pipe and as a table on a terminal; returns 1 without a suitable
    gear."""
    application, settings = _application(options.file), Settings()
    catalogue = settings.catalogue()
    selection = select(application, catalogue, to_link)
    if options.json or not (options.table or sys.stdout.isatty()):
        sys.stdout.write(encode(selection).decode() + "\n")
    else:
        _print_table(selection, application.requirements.utilisation)
    return 0 if selection.selected else 1


def _application(name: str) -> Application:
    """Application of a file; raises ValidationError, and InputError for a name twice in one object."""
    content = _content(name)
    if is_shell(content):
        content = _of_sizing(name, content)
    application = Application.model_validate_json(content)
    require_unique(content)
    return application


def _of_sizing(name: str, content: bytes) -> bytes:
    """JSON of the application in a sizing by IDTA 02021; its unused elements go to standard error."""
    sizing = sizing_in(content)
    if sizing.problem:
        raise MendableError(f"{name}: {sizing.problem.text}")
    for place in sizing.unused:
        print(f"not used: {place}", file=sys.stderr)
    if sizing.note:
        print(sizing.note.text, file=sys.stderr)
    return sizing.text.encode()


def _content(name: str) -> bytes:
    """Content of a file, or of standard input for -; a byte order mark at its beginning is dropped."""
    if name == "-":
        if sys.stdin is None:
            raise OSError(errno.EBADF, "is closed", "standard input")
        content = sys.stdin.buffer.read(MAXIMUM_FILE_BYTES + 1)
    else:
        with open(name, "rb") as file:
            content = file.read(MAXIMUM_FILE_BYTES + 1)
    if len(content) > MAXIMUM_FILE_BYTES:
        raise OSError(errno.EFBIG, f"is larger than an application can be, {MAXIMUM_FILE_BYTES} bytes", name)
    return content.removeprefix(codecs.BOM_UTF8)


def _print_table(selection: Selection, utilisation: float) -> None:
    print(f"selected: {selection.selected or 'none is suitable'}")
    for candidate in selection.candidates:
        used = _percent(candidate, utilisation)
        print(f"{candidate.designation:<11} {candidate.status:<10} {used:>8}  {candidate.reason}")
    for notice in selection.notices:
        print(f"note: {notice.text}")


def _percent(candidate: Candidate, utilisation: float) -> str:
    if candidate.utilisation is None:
        return ""
    used, bound = 100 * candidate.utilisation, 100 * allowed(candidate.governing_check, utilisation)
    return f"{used:.{telling_decimals(used, bound, 1)}f}%"
