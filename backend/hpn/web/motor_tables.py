"""Tables of motors on their way into a list: how long they may be, and motors out of their rows."""

from collections.abc import Sequence

from pydantic import ValidationError

from hpn.application import MotorEntry
from hpn.application.faults import sentences_of
from hpn.tables.answers import answered
from hpn.tables.files import TableBounds
from hpn.tables.motors import MOTORS
from hpn.tables.reading import Reading, reading_of
from hpn.tables.table import Table
from hpn.web.motor_lists import MOST_LISTED
from hpn.words.wording import N_, Sentence

WANTED = TableBounds(MOTORS, most_rows=MOST_LISTED + 1000, most_characters=2_000_000)
"""Most rows and characters of a table of motors, heads and titles among them."""


def read_answered(content: bytes, given: Sequence[str]) -> tuple[Reading, tuple[Sentence, ...]]:
    """Reading of a file by answers of a program, and what is wrong with these; no unit is assumed."""
    return answered(
        given,
        MOTORS,
        lambda choices: reading_of(content, WANTED, choices),
        lambda reading: reading.table.columns if reading.table else (),
    )


MOST_TOLD = 5
_LEFT_OUT = N_("Row {row}, {name}, is left out: {fault}.")
_MORE = N_("Further motors are left out for such reasons: {count}.")


def motors_in(table: Table) -> tuple[list[MotorEntry], list[Sentence]]:
    """Motors of a table, and what is said of those that can't be: in each figures that contradict one another."""
    motors, said, count = list[MotorEntry](), list[Sentence](), 0
    for values in table.motors:
        try:
            motors.append(MotorEntry.model_validate(values))
        except ValidationError as error:
            count += 1
            if count <= MOST_TOLD:
                (location, fault, _), *_ = sentences_of(error)
                row = table.origins[values["designation"]][0]
                told = Sentence("{field} {fault}", {"field": str(location[0]) if location else "", "fault": fault})
                said.append(Sentence(_LEFT_OUT, {"row": row, "name": values["designation"][:60], "fault": told}))
    if count > MOST_TOLD:
        said.append(Sentence(_MORE, {"count": count - MOST_TOLD}))
    return motors, said


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
"""Columns of a list as it is written, in the units of the wire."""


def as_text(motors: Sequence[MotorEntry]) -> str:
    """A list as a table to be edited: what is not known is blank."""
    lines = ["\t".join(COLUMNS)]
    for motor in motors:
        values = [getattr(motor, name, None) for name in COLUMNS]
        lines.append("\t".join("" if value is None else " ".join(str(value).split()) for value in values))
    return "\n".join(lines)
