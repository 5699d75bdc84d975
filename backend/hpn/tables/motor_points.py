"""Points of torque curves in a table of motors: in rows of a motor, or in columns of the torques at one speed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from re import IGNORECASE
from typing import Any

from hpn.tables.cells import is_blank, is_number
from hpn.tables.factors import is_factor
from hpn.tables.inputs import Input
from hpn.tables.sheets import Grid
from hpn.words.patterns import Pattern
from hpn.words.spellings import codes_for
from hpn.words.wording import N_, Named

SPEED, CONTINUOUS, PEAK = "ncv", "Tcc", "Tcp"
POINT: Mapping[str, str] = {
    "curve_speed_rpm": "speed_rpm",
    "curve_continuous_Nm": "continuous_Nm",
    "curve_peak_Nm": "peak_Nm",
}
"""Columns of a point, and its fields."""

POINTS = (SPEED, CONTINUOUS, PEAK)
"""Roles of these columns."""

COLUMNS = (
    Input(SPEED, "curve_speed_rpm", Named(N_("Speed of a point of the curve"), "n_c")),
    Input(CONTINUOUS, "curve_continuous_Nm", Named(N_("Continuous torque at this speed"), "M_c")),
    Input(PEAK, "curve_peak_Nm", Named(N_("Peak torque at this speed"), "M_p")),
)

WORDS: Mapping[str, str] = {
    SPEED: "speed of point; point speed; curve speed; speed of a point of the curve; speed n; stützstelle drehzahl; "
    "drehzahl stützstelle; drehzahl der kennlinie; kennlinie drehzahl; kennliniendrehzahl; nc; n c",
    CONTINUOUS: "continuous torque at this speed; continuous torque at speed; s1 torque; torque s1; m s1; mc; m c; "
    "curve continuous torque; dauerdrehmoment bei drehzahl; dauerdrehmoment bei dieser drehzahl; s1-drehmoment; "
    "s1-moment; kennlinie dauerdrehmoment",
    PEAK: "peak torque at this speed; peak torque at speed; maximum torque at speed; curve peak torque; "
    "spitzendrehmoment bei drehzahl; spitzendrehmoment bei dieser drehzahl; maximaldrehmoment bei drehzahl; "
    "kennlinie spitzendrehmoment",
}

PARTIAL = N_(
    "Rows with a part of a point of a torque curve, which needs speed, continuous and peak torque, are left out as "
    "points ({count}): row {rows}."
)

Row = tuple[int, dict[str, Any]]


def is_part(values: Mapping[str, Any]) -> bool:
    """True for a row with some figures of a point, but not all."""
    return 0 < sum(place in values for place in POINT) < len(POINT)


def with_curves(rows: list[Row]) -> list[Row]:
    """Motors from their rows; rows of one name with a point each, and no contradicting figure, become one motor."""
    motors: list[Row] = []
    last: dict[str, int] = {}
    for number, values in rows:
        point = {field: values.pop(place) for place, field in POINT.items() if place in values}
        whole = len(point) == len(POINT)
        name = values["designation"]
        motor = motors[last[name]][1] if name in last else None
        if point and motor is not None and all(motor.get(place, value) == value for place, value in values.items()):
            motor |= values
            if whole:
                motor.setdefault("curve", []).append(point)
        else:
            last[name] = len(motors)
            motors.append((number, values | ({"curve": [point]} if whole else {})))
    for _, motor in motors:
        motor.get("curve", []).sort(key=itemgetter("speed_rpm"))
    return motors


# --- Columns of speeds ------------------------------------------------------------------------------------------------

HEAD_ROWS, MOST_SPEEDS = 5, 50
"""Limits: rows that are searched for headings, and speeds with columns of their own."""

_UNIT_BEHIND = Pattern(r"[\[(]([^\])]{1,20})[\])]\s*$", 200)

_AT_SPEED = Pattern(
    r"(?:(continuous|s1|m_?c\b|dauer)|(peak|max|m_?p\b|spitze))([^0-9]*?)\b([0-9]{1,6})\s*(?:rpm|u/min|1/min|min-1|min⁻¹)",
    200,
    IGNORECASE,
)
"""Heading of a column with the torques at one speed, such as `continuous 3000 rpm [Nm]`."""

_BESIDE = Pattern(r"[\s\[\](){}<>,;:.=@_|/–-]+", 200)
_WORDS = (
    "torque torques moment drehmoment nmoment ndrehmoment couple coppia par imum imal imales continuous dauer peak max "
    "s1 t m at bei à a for of n"
)
_OF_TORQUE = frozenset(_WORDS.split())
"""Words of such a heading besides its unit: any other word may mean another quantity or a factor."""

Pair = tuple[str, int, int]
"""A speed, and the columns of the continuous and the peak torque at it."""


def with_rows_of_points(grid: Grid) -> Grid:
    """A table with columns of torques at one speed each, turned into a row per point, which repeats all other cells.

    Tables with other text in these headings, different units, or factors below them stay as they are: the user is
    asked.
    """
    for place, heads in enumerate(grid.rows[:HEAD_ROWS]):
        speeds = {column: match for column, head in enumerate(heads) if (match := _AT_SPEED.search(head))}
        peaks = {match[4]: column for column, match in speeds.items() if match[2]}
        pairs = [
            (match[4], column, peaks[match[4]]) for column, match in speeds.items() if match[1] and match[4] in peaks
        ]
        if 1 < len(pairs) <= MOST_SPEEDS:
            sides = [column for _, column, _ in pairs], [column for _, _, column in pairs]
            rests = {
                column: f"{heads[column][: match.start()]} {match[3]} {heads[column][match.end() :]}"
                for column, match in speeds.items()
            }
            units = [_one_unit([_unit_in(rests[column]) for column in side]) for side in sides]
            return grid if None in units else _parted(grid, place, pairs, [unit or "Nm" for unit in units])
    return grid


def _unit_in(rest: str) -> str | None:
    """Unit of torque in the rest of a heading, empty without a unit; None where there is other text."""
    if bracketed := _UNIT_BEHIND.search(rest):
        rest = rest[: bracketed.start()]
    words = [word for word in _BESIDE.split(rest) if word and word.casefold() not in _OF_TORQUE | {"in"}]
    texts = [bracketed[1], *words] if bracketed else [" ".join(words)] if words else []
    if not texts:
        return ""
    return texts[0] if len(texts) == 1 and codes_for(texts[0], "torque") else None


def _one_unit(units: Sequence[str | None]) -> str | None:
    """The only unit of some headings, where headings without a unit share it; None for several."""
    known = {*units} - {""}
    return None if None in known or len(known) > 1 else next(iter(known), "")


def _parted(grid: Grid, place: int, pairs: Sequence[Pair], units: Sequence[str]) -> Grid:
    """The table with its columns of torques at a speed turned into rows, below a row of headings."""
    curve_columns, heads = {column for _, *both in pairs for column in both}, grid.rows[place]
    names = ("curve continuous torque", "curve peak torque")
    own = [f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)]
    rows, numbers = list[tuple[str, ...]](), list[int]()
    for number, row in list(zip(grid.numbers, grid.rows, strict=True))[place:]:
        others = tuple(cell for column, cell in enumerate(row) if column not in curve_columns)
        points: list[tuple[str, ...]] = [("curve speed [rpm]", *own)]
        if row is not heads:
            cells = [row[column] for column in curve_columns if not is_blank(row[column])]
            if cells and (all(map(is_factor, cells)) or not any(map(is_number, cells))):
                return grid  # a row of factors or units
            points = [(n, row[c], row[p]) for n, c, p in pairs if not (is_blank(row[c]) and is_blank(row[p]))]
        for point in points or [("", "", "")]:
            rows.append((*others, *point))
            numbers.append(number)
    return replace(grid, rows=tuple(rows), numbers=tuple(numbers), counts=())
