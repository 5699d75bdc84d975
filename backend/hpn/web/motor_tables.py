"""Tables of motors for a list: limits of their size, motors made of their rows, and lists written as tables."""

import csv
from collections.abc import Sequence
from io import StringIO

from pydantic import ValidationError

from hpn.application import MotorEntry
from hpn.application.faults import sentences_of
from hpn.tables.answers import reading_by_answers
from hpn.tables.files import TableBounds
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.motor_points import POINT
from hpn.tables.motors import NO_FIGURE, NO_FIGURES, NO_NAME
from hpn.tables.reading import Reading, reading_of
from hpn.tables.table import Table
from hpn.web.motor_lists import MOST_LISTED
from hpn.words.wording import N_, Sentence

BOUNDS = TableBounds(MOTORS, most_rows=4 * MOST_LISTED, most_characters=2_000_000)
"""Limits of a table of motors: rows, with headings and titles, and characters."""


def read_answered(content: bytes, texts: Sequence[str]) -> tuple[Reading, tuple[Sentence, ...]]:
    """Reading of a file with a program's answers, and faults of these answers; no unit is assumed."""
    return reading_by_answers(
        texts,
        MOTORS,
        lambda choices: reading_of(content, BOUNDS, choices),
        lambda reading: reading.table.columns if reading.table else (),
    )


MOST_TOLD = 5
_LEFT_OUT = N_("Row {row}, {name}, is left out: {fault}.")
_MORE = N_("Further motors are left out for such reasons: {count}.")


def motors_in(table: Table) -> tuple[list[MotorEntry], list[Sentence]]:
    """Motors of a table, and sentences on those left out, whose figures contradict one another."""
    motors, notes, count = list[MotorEntry](), list[Sentence](), 0
    for values in table.motors:
        try:
            motors.append(MotorEntry.model_validate(values))
        except ValidationError as error:
            count += 1
            if count <= MOST_TOLD:
                (location, fault, _), *_ = sentences_of(error)
                row = table.origins[values["designation"]][0]
                sentence = Sentence("{field} {fault}", {"field": str(location[0]) if location else "", "fault": fault})
                notes.append(Sentence(_LEFT_OUT, {"row": row, "name": values["designation"][:60], "fault": sentence}))
    if count > MOST_TOLD:
        notes.append(Sentence(_MORE, {"count": count - MOST_TOLD}))
    return motors, notes


def left_out(table: Table, notes: Sequence[Sentence]) -> list[Sentence]:
    """Sentences on motors that nobody asked to leave out: `notes` of `motors_in`, and notes on unreadable rows."""
    return [*notes, *(note for note in table.notes if note.template in (NO_FIGURE, NO_FIGURES, NO_NAME))]


COLUMNS = (
    "designation",
    "rated_torque_Nm",
    "peak_torque_Nm",
    "stall_torque_Nm",
    "rated_speed_rpm",
    "maximum_speed_rpm",
    "inertia_kgm2",
    "weight_kg",
)
"""Columns of a list in a written table, in the units of the wire."""


def as_text(motors: Sequence[MotorEntry]) -> str:
    """List as a table for editing: unknown figures are blank, and each point of a torque curve has a row."""
    points = tuple(POINT) if any(motor.curve for motor in motors) else ()
    lines: list[Sequence[str]] = [(*COLUMNS, *points)]
    for motor in motors:
        figures: Sequence[object] = [getattr(motor, name, None) for name in COLUMNS]
        for point in motor.curve or (None,):
            own = [getattr(point, field) if point else None for field in POINT.values()] if points else []
            lines.append(["" if value is None else _as_cell(value) for value in (*figures, *own)])
            figures = [motor.designation, *[None] * (len(COLUMNS) - 1)]
    return written(lines)


def written(lines: Sequence[Sequence[str]]) -> str:
    """Lines of cells as a text with tabs, in which a mark of quotation is part of its cell."""
    text = StringIO()
    csv.writer(text, delimiter="\t", lineterminator="\n").writerows(lines)
    return text.getvalue().removesuffix("\n")


def _as_cell(value: object) -> str:
    return " ".join((f"{value:.17g}" if isinstance(value, float) and value.is_integer() else str(value)).split())
