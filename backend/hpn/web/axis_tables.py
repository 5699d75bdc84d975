"""Tables of axes to be stored: limits of their size, and axes with answers made of their rows.

This module imports Arrow.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from msgspec import structs

from hpn.catalogue import Catalogue
from hpn.documents.answers import MOST_FAULTS, AxisAnswer, AxisFault, AxisQuestion, answers
from hpn.documents.axis import Axis
from hpn.documents.merge import resolve
from hpn.fleet.columns import are_taken
from hpn.fleet.faults import CellFault
from hpn.fleet.machine import TableAxis, axes_in, in_row
from hpn.fleet.outcome import located
from hpn.links.symbols import AXIS_INPUTS
from hpn.store import AxisDraft
from hpn.tables.files import TableBounds
from hpn.web.columns import draft_of

BOUNDS = TableBounds(AXIS_INPUTS, most_rows=50_000, most_characters=4_000_000, takes=are_taken)
"""Limits of a table whose columns are not named as in `hpn fleet`: rows and characters."""


def drafts_in(
    rows: Sequence[Mapping[str, Any]],
    faults: Sequence[CellFault],
    origins: Mapping[str, Sequence[int]],
    catalogue: Catalogue,
) -> list[AxisDraft]:
    """Drafts of a table's axes, all answered together; an axis with a faulty cell is open.

    `origins` are the rows of the phases of each axis in a table of cells.
    """
    axes = axes_in(rows, faults)
    questions = [AxisQuestion(resolve(each.axis.application, {}), each.axis.ordering_code) for each in axes]
    judged = zip(axes, answers(questions, catalogue), strict=True)
    return [_draft(each, answer, origins.get(each.name or "", ())) for each, answer in judged]


def _draft(row: TableAxis, answer: AxisAnswer, numbers: Sequence[int]) -> AxisDraft:
    axis = row.axis
    if row.faults and answer.status != "open":  # a cell is faulty, even if the models accept the rest
        axis, answer = Axis(), AxisAnswer("open", catalogue_version=answer.catalogue_version)
    return replace(draft_of(axis, _with_places(row.faults, answer, numbers)), name=row.name)


def _with_places(faults: Sequence[CellFault], answer: AxisAnswer, numbers: Sequence[int]) -> AxisAnswer:
    """Answer whose faults name the columns of the table, and its rows if these are known."""
    if not faults and answer.status == "open" and numbers:
        faults = [located(0, each.location, each.wording, each.code) for each in answer.faults]
    if not faults:
        return answer
    faults_in_rows = (in_row(fault, numbers) for fault in faults[:MOST_FAULTS])
    of_cells = tuple(
        AxisFault.at(f"/{fault.column.replace('.', '/')}", fault.reason, fault.code) for fault in faults_in_rows
    )
    return structs.replace(answer, faults=of_cells)
