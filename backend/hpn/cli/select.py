"""`hpn select`: a gear for an application file."""

import argparse
import sys
from pathlib import Path

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.checks import allowed
from hpn.selection import Candidate, Selection, encode, select
from hpn.web.form.write import to_link
from hpn.web.settings import Settings
from hpn.wording import telling_decimals


def run(options: argparse.Namespace) -> int:
    """Print the reply, as JSON into a pipe and as a table on a terminal unless asked otherwise."""
    content = sys.stdin.buffer.read() if options.file == "-" else Path(options.file).read_bytes()
    application, settings = Application.model_validate_json(content), Settings()
    catalogue = load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    selection = select(application, catalogue, to_link(application))
    if options.json or not (options.table or sys.stdout.isatty()):
        sys.stdout.write(encode(selection).decode() + "\n")
    else:
        _print_table(selection, application.requirements.utilisation)
    return 0 if selection.selected else 1


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
