"""Details below the rows of a machine's page: links, reasons of open axes, and remedies of gears that don't fit."""

from collections.abc import Iterable
from typing import NamedTuple

from hpn.application import Application, InputError
from hpn.engine.remedy import condition_of
from hpn.engine.selection import select
from hpn.engine.tried import needed_of, tried
from hpn.files.machine.words import fault_of
from hpn.links.labels import query_of
from hpn.links.writer import to_link
from hpn.web.columns import answer_in, resolved
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.form.own_part import written
from hpn.web.pages.axis_view import CHOSEN, AxisView, Neighbours, view_of
from hpn.web.pages.machine_view import MachineRow, MachineView
from hpn.words.titles import faults_of
from hpn.words.wording import Sentence

MOST_REMEDIES = 5
"""Axes without a suitable gear whose remedies a page calculates; the others show theirs on their own pages."""


class RowRemedy(NamedTuple):
    """A change by which the nearest gear fits, and the address of the axis with it; blank where there is none."""

    condition: Sentence
    link: str


class RowDetails(NamedTuple):
    """Details below an axis's row: its link to the workbench if a revision is shown, the reasons why it is open, and
    remedies that make its gear fit."""

    link: str = ""
    reasons: tuple[Sentence, ...] = ()
    remedies: tuple[RowRemedy, ...] = ()


def row_details(view: MachineView, rows: Iterable[MachineRow]) -> dict[int, RowDetails]:
    """Details of some axes, by their numbers."""
    by_number: dict[int, RowDetails] = {}
    worked_out = 0
    for row in rows:
        link, remedies = "", tuple[RowRemedy, ...]()
        is_remedied = row.status == "unsuitable" and worked_out < MOST_REMEDIES
        if (is_remedied or view.frozen) and (application := resolved(row.axis, view.common).application):
            link = link_of(row, application) if view.frozen else ""
            if is_remedied:
                worked_out, remedies = worked_out + 1, _remedies(view, row, application)
        by_number[row.axis.number] = RowDetails(link, _reasons(row) if row.status == "open" else (), remedies)
    return by_number


def _reasons(row: MachineRow) -> tuple[Sentence, ...]:
    return tuple(map(fault_of, answer_in(row.answer).faults))


def link_of(row: MachineRow, application: Application) -> str:
    """Address of an axis in the workbench; blank if it would be too long."""
    titled = "" if any(faults_of(row.name)) else query_of({"title": row.name})
    link = to_link(application) + titled
    return link if len(link) <= MAXIMUM_QUERY_BYTES else ""


def _remedies(view: MachineView, row: MachineRow, application: Application) -> tuple[RowRemedy, ...]:
    """Changes that each alone make the nearest gear fit; what a revision shows is tried nowhere."""
    catalogue = view.catalogue
    try:
        candidate = select(application, catalogue).candidate(row.gear or "")
    except InputError:
        return ()
    needed = needed_of(candidate, application, catalogue) if candidate else ()
    axis = None if view.frozen else view_of(view.machine, row.axis, Neighbours(), [], catalogue)[1]
    return tuple(
        RowRemedy(condition_of(one), _trial_address(axis, tried(application, one, catalogue)) if axis else "")
        for one in needed
    )


def _trial_address(axis: AxisView, application: Application) -> str:
    """Address of an axis with another application, and the gear that is ordered for it."""
    ordered = written([pair for pair in axis.typed if pair[0] in CHOSEN])
    link = axis.link(application) + (f"&{ordered}" if ordered else "")
    return link if len(link) <= MAXIMUM_QUERY_BYTES else ""
