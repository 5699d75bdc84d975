"""Rows of a machine's page beyond their columns: links, why an axis is open, and what would make its gear fit."""

from collections.abc import Iterable
from typing import NamedTuple

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.remedy import condition_of
from hpn.engine.selection import select
from hpn.engine.tried import needed_of
from hpn.fleet.faults import Reason
from hpn.links.labels import query_of
from hpn.links.writer import to_link
from hpn.web.columns import answer_in, resolved
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.pages.machine_view import MachineRow, MachineView
from hpn.words.titles import faults_of
from hpn.words.wording import Sentence

MOST_REMEDIES = 5
"""Axes without a suitable gear whose remedies a page works out; the others say theirs once they are opened."""


class Opened(NamedTuple):
    """Content of an axis's row beyond its columns: its link, why it is open, and what would make its gear fit."""

    link: str = ""
    reasons: tuple[Reason, ...] = ()
    remedies: tuple[Sentence, ...] = ()


def opened(view: MachineView, rows: Iterable[MachineRow]) -> dict[int, Opened]:
    """The same of some axes, by their numbers."""
    by_number: dict[int, Opened] = {}
    worked_out = 0
    for row in rows:
        application, remedies = resolved(row.axis, view.common).application, tuple[Sentence, ...]()
        if application and row.status == "unsuitable" and worked_out < MOST_REMEDIES:
            worked_out, remedies = worked_out + 1, _remedies(row, application, view.catalogue)
        reasons = _reasons(row) if row.status == "open" else ()
        by_number[row.axis.number] = Opened(link_of(row, application) if application else "", reasons, remedies)
    return by_number


def _reasons(row: MachineRow) -> tuple[Reason, ...]:
    from hpn.web.pages.machine_answers import reasons  # needs Arrow

    return tuple(reasons(answer_in(row.answer).faults))


def link_of(row: MachineRow, application: Application) -> str:
    """Address of an axis in the workbench; blank where it is too long for one."""
    titled = "" if any(faults_of(row.name)) else query_of({"title": row.name})
    link = to_link(application) + titled
    return link if len(link) <= MAXIMUM_QUERY_BYTES else ""


def _remedies(row: MachineRow, application: Application, catalogue: Catalogue) -> tuple[Sentence, ...]:
    """Changes that each alone make the nearest gear fit."""
    try:
        candidate = select(application, catalogue).candidate(row.gear or "")
    except InputError:
        return ()
    return tuple(map(condition_of, needed_of(candidate, application, catalogue))) if candidate else ()
