"""Stored answers of a machine as a table, and their differences from today's. This module imports Arrow."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import msgspec
import pyarrow as pa

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisFault, AxisQuestion, answers
from hpn.explain.comparison import is_same
from hpn.files.machine.words import fault_of
from hpn.fleet.columns import AXIS
from hpn.fleet.faults import Reason
from hpn.fleet.listing import NEAREST
from hpn.fleet.outcome import FAULTS, answer_fields, located
from hpn.store import Machine
from hpn.web.columns import answer_in, common_of, resolved
from hpn.words.wording import Sentence

COMPARED = ("selected", "governing_check", "utilisation", "suitable")


def answers_of(machine: Machine) -> pa.Table:
    """Answers of the axes of a machine, with the columns of a listing."""
    fields = [*answer_fields(pa.string()), *NEAREST]
    cells = [{AXIS: axis.name or str(axis.number), **_cells(answer_in(axis.answer))} for axis in machine.items]
    table = pa.Table.from_pylist(cells, pa.schema(fields))
    return table.drop_columns("error")  # FAULTS has the reasons instead


def _cells(answer: AxisAnswer) -> dict[str, Any]:
    """Cells of an axis's answer in a listing: figures of the selected gear, else the nearest miss; faults if open."""
    if answer.status == "open":
        return {FAULTS: msgspec.json.encode(reasons(answer.faults)).decode()}
    brief = {"suitable": answer.suitable, "average_torque_Nm": answer.average_torque_Nm}
    if answer.selected is None:
        nearest = (answer.designation, answer.governing_check, answer.utilisation)
        return brief | dict(zip(NEAREST.names, nearest, strict=True))
    figures = ("selected", "governing_check", "utilisation", "life_L10_h", "shortest_life_h", "motor_torque_limit_Nm")
    brief |= {name: getattr(answer, name) for name in (*figures, "runner_up")}
    known = "shortest_life_h" not in answer.unknown
    return brief | {"shortest_life_of": answer.shortest_life_of if known else ""}


def reasons(faults: Iterable[AxisFault]) -> list[Reason]:
    """Reasons of a listing for faults, by the columns of a table."""
    return [_reason(fault) for fault in faults]


def _reason(fault: AxisFault) -> Reason:
    if not fault.pointer:
        return Reason("", fault.code, fault.wording)
    cell = located(0, fault.location, fault.wording, fault.code)
    return Reason(cell.column, cell.code, cell.reason)


# --- Today ------------------------------------------------------------------------------------------------------------


class AxisChange(NamedTuple):
    """Axis whose answer is different today, or the reasons why it has none."""

    axis: str
    saved: dict[str, Any]
    today: dict[str, Any]
    reasons: Sequence[Sentence]


def changes(machine: Machine, catalogue: Catalogue) -> list[AxisChange]:
    """Axes whose answer is different today, among those that had an answer."""
    answered = [axis for axis in machine.items if axis.answer["status"] != "open"]
    common = common_of(machine)
    today = answers([AxisQuestion(resolved(axis, common), axis.ordering_code) for axis in answered], catalogue)
    differing = []
    for axis, now in zip(answered, today, strict=True):
        before, after = _compared(answer_in(axis.answer)), _compared(now)
        if _differs(before, after):
            differing.append(AxisChange(axis.name or str(axis.number), before, after, [*map(fault_of, now.faults)]))
    return differing


def _compared(answer: AxisAnswer) -> dict[str, Any]:
    return dict.fromkeys(COMPARED) | _cells(answer)


def _differs(saved: Mapping[str, Any], today: Mapping[str, Any]) -> bool:
    return today["suitable"] is None or not all(is_same(saved[name], today[name]) for name in COMPARED)
