"""A duty table pasted from a spreadsheet or read from a CSV file, in whichever way numbers are written there.

Every way of reading the whole text (separator and decimal mark) is tried. Where exactly one reading makes numbers of
all cells, it holds; where several do and differ (`1.234` is 1.234 or 1234), none is chosen: the user is asked.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from hpn.application import MAXIMUM_PHASES, DutyCycle
from hpn.wording import N_, Sentence

Decimal = Literal[".", ","]
MAXIMUM_CHARACTERS = 1_000_000
COLUMNS = ("T", "n", "t", "FRi", "FAi")
"""Columns of the duty table by their link symbols, in the order in which they stand without a header."""

SEPARATORS = {"\t": N_("tab"), ";": N_("semicolon"), ",": N_("comma"), " ": N_("space")}
_HEADINGS = {
    "T": ("t_nm", "torque", "drehmoment", "moment", "torque_nm"),
    "n": ("n", "speed", "drehzahl", "speed_rpm"),
    "t": ("t_s", "duration", "time", "dauer", "zeit", "duration_s"),
    "FRi": ("fr", "fri", "radial", "radial_n", "radialkraft", "radiallast", "radial load"),
    "FAi": ("fa", "fai", "axial", "axial_n", "axialkraft", "axiallast", "axial load"),
}
_NAMES = {name.replace("_", " "): column for column, names in _HEADINGS.items() for name in names}
_UNITS = {
    "T": ("nm", "n·m", "n m", "n*m"),
    "n": ("rpm", "1/min", "min-1", "min^-1", "min⁻¹", "u/min", "r/min"),
    "t": ("s", "sec"),
    "FRi": ("n",),
    "FAi": ("n",),
}
_NUMBER: dict[Decimal, re.Pattern[str]] = {
    ".": re.compile(
        r"[+-]?(?=[.,]?\d)(?:\d+|\d{1,3}(?:[,'’ \u00a0\u202f]\d{3})+)?(?:\.\d*)?(?:[eE][+-]?\d{1,3})?", re.ASCII
    ),
    ",": re.compile(
        r"[+-]?(?=[.,]?\d)(?:\d+|\d{1,3}(?:[.'’ \u00a0\u202f]\d{3})+)?(?:,\d*)?(?:[eE][+-]?\d{1,3})?", re.ASCII
    ),
}
LONGEST_CELL = 400
"""Characters of a cell that could still be a number: written out, the largest has some 310 digits."""

LONGEST_HEADING = 80
MOST_COLUMNS = 50
_UNIT = re.compile(r"^(.*?)\s*(?:\[(.+)\]|\((.+)\)|\bin\s+(\S+)|/\s*(\S+))\s*$")


@dataclass(frozen=True, slots=True)
class Reading:
    """One way of reading the text: numbers in plain notation, row by row, and the columns they belong to."""

    separator: str
    decimal: Decimal
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Pasted:
    """What a text can be read as: one reading is certain, several must be asked about, none has problems instead."""

    readings: tuple[Reading, ...]
    problem: Sentence | None = None


class _RefusedError(ValueError):
    def __init__(self, template: str, **values: str | int) -> None:
        super().__init__(template)
        self.sentence = Sentence(template, dict(values))


def read_table(text: str) -> Pasted:
    """Every distinct way of reading a pasted table of phases; raises nothing, `problem` says why there is none."""
    try:
        lines = _lines(text)
        readings = [reading for separator in SEPARATORS for reading in _with_separator(lines, separator)]
        distinct = {(reading.columns, reading.rows): reading for reading in reversed(readings)}
        if distinct:
            return Pasted(tuple(reversed(distinct.values())))
        return Pasted((), _why_not(lines))
    except _RefusedError as refused:
        return Pasted((), refused.sentence)


def _lines(text: str) -> list[str]:
    if len(text) > MAXIMUM_CHARACTERS:
        raise _RefusedError(N_("the text is too long: at most {most} characters"), most=MAXIMUM_CHARACTERS)
    lines = [line for line in text.removeprefix("\ufeff").splitlines() if line.strip()]
    if not lines:
        raise _RefusedError(N_("there is nothing in the text"))
    if len(lines) > MAXIMUM_PHASES + 1:
        raise _RefusedError(N_("there are more than {most} rows"), most=MAXIMUM_PHASES)
    return lines


def _with_separator(lines: Sequence[str], separator: str) -> list[Reading]:
    """Readings with one separator; none where rows have not three or five cells each, or cells are no numbers."""
    try:
        columns, body = _shaped(lines, separator)
    except _RefusedError:
        return []  # the refusal matters only if no separator makes sense; `_why_not` finds it again then
    if not body or any(len(row) != len(columns) for row in body):
        return []
    readings = []
    for decimal in _NUMBER:
        if decimal != separator:
            rows = tuple(tuple(_plain(cell, decimal) for cell in row) for row in body)
            wanted = sum(bool(cell) for row in body for cell in row)
            if sum(bool(cell) for row in rows for cell in row) == wanted:
                readings.append(Reading(separator, decimal, columns, rows))
    return readings


def _shaped(lines: Sequence[str], separator: str) -> tuple[tuple[str, ...], list[list[str]]]:
    """Columns and rows; where some rows carry loads, the others end in blank cells."""
    table = [_cells(line, separator) for line in lines]
    width = max(len(row) for row in table)
    if width > MOST_COLUMNS:
        raise _RefusedError(N_("a row has {cells} cells: paste the columns of the duty cycle alone"), cells=width)
    columns, body = _header(table, width)
    if len(columns) > 3:
        body = [row + [""] * (len(columns) - len(row)) if len(row) >= 3 else row for row in body]
    return columns, body


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    try:
        row = next(csv.reader([line], delimiter=separator), [])
    except csv.Error:  # a cell longer than the module takes
        raise _RefusedError(N_("a cell is longer than any number or heading")) from None
    while len(row) > 3 and not row[-1].strip():
        row.pop()  # spreadsheets end their rows with empty cells
    return [cell.strip() for cell in row]


def _header(table: list[list[str]], width: int) -> tuple[tuple[str, ...], list[list[str]]]:
    """Columns and the rows below them. A first row without any digit is a header, and must say what they are.

    Without one the order is fixed.
    """
    first = table[0]
    if any(any(character.isdigit() for character in _heading(cell)[0]) for cell in first) or not any(first):
        return COLUMNS[: 5 if width > 3 else 3], table
    names = [_column_of(*_heading(cell)) for cell in first]
    columns = tuple(name or "" for name in names)
    if "" in columns or len(set(columns)) < len(columns) or not {"T", "n", "t"} <= set(columns):
        raise _RefusedError(
            N_("the header must name torque, speed and duration, and perhaps radial and axial load (found: {found})"),
            found=", ".join(first)[:80],
        )
    return columns, table[1:]


def _heading(cell: str) -> tuple[str, str | None]:
    """Name and unit of a header cell: `Drehzahl [1/min]`, `Drehzahl 1/min`, `Drehzahl_1/min` are (drehzahl, 1/min)."""
    cell = " ".join(cell.split())
    if len(cell) > LONGEST_HEADING:
        return cell, None
    spelled = cell.replace("_", " ")
    end = max((len(name) for name in _NAMES if f"{spelled.casefold()} ".startswith(f"{name} ")), default=0)
    if end and not re.match(r" ?[\[(/]| in\b", spelled[end:]):
        return spelled[:end], spelled[end:].strip() or None
    match = _UNIT.match(cell)
    if match is None:
        return cell, None
    return match[1].strip(), next(group for group in match.groups()[1:] if group)


def _column_of(name: str, unit: str | None) -> str | None:
    column = name if name in ("T", "t") else _NAMES.get(name.casefold(), "")
    if column and unit is not None and unit.casefold().strip() not in _UNITS[column]:
        raise _RefusedError(
            N_("the column {name} is in {unit}: give it in {wanted}"), name=name, unit=unit, wanted=_WANTED[column]
        )
    return column or None


_WANTED = {"T": "Nm", "n": "rpm", "t": "s", "FRi": "N", "FAi": "N"}


def _plain(cell: str, decimal: Decimal) -> str:
    """A number as this decimal mark reads it, with a point and without grouping; empty where it is none."""
    cell = cell.replace("\N{MINUS SIGN}", "-")
    if len(cell) > LONGEST_CELL:
        return ""
    if not _NUMBER[decimal].fullmatch(cell) or not any(character.isdigit() for character in cell):
        return ""
    mantissa = re.sub(r"[^0-9eE+\-,.]", "", cell)
    group = "," if decimal == "." else "."
    return mantissa.replace(group, "").replace(decimal, ".")


def _why_not(lines: Sequence[str]) -> Sentence:
    """What keeps the text from being read, by its most likely separator."""
    separator = next((mark for mark in ("\t", ";") if mark in lines[0]), " " if "," not in lines[0] else ",")
    columns, body = _shaped(lines, separator)
    if not body:
        return Sentence(N_("there is a header, but no row of numbers below it"))
    for number, row in enumerate(body, start=1 + len(lines) - len(body)):
        if len(row) != len(columns):
            return Sentence(
                N_("row {row} has {cells} cells; a row has torque, speed and duration, or these and both loads"),
                {"row": number, "cells": len(row)},
            )
        for cell in filter(None, row):
            if not _plain(cell, ".") and not _plain(cell, ","):
                return Sentence(N_("row {row}: {cell} is not a number"), {"row": number, "cell": cell[:40]})
    return Sentence(N_("the rows write their decimals in different ways: use a point or a comma throughout"))


def write_table(cycle: DutyCycle, decimal: Decimal = ".") -> str:
    """Phases as CSV that `read_table` and a spreadsheet of that language read back exactly, with loads if any."""
    separator = ";" if decimal == "," else ","
    fields = ["torque_Nm", "speed_rpm", "duration_s", "radial_N", "axial_N"]
    if all(phase.radial_N is None and phase.axial_N is None for phase in cycle.phases):
        fields = fields[:3]
    lines = [separator.join(fields)]
    for phase in cycle.phases:
        values = [getattr(phase, name) for name in fields]
        written = ["" if v is None else repr(v).removesuffix(".0").replace(".", decimal) for v in values]
        lines.append(separator.join(written))
    return "\n".join(lines) + "\n"
