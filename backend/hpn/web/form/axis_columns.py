"""Columns of a table of axes that somebody uploads: what each is read as, and in which unit.

Beside the phases' columns there is one that names the axis, and one for every other input of an application. Headings
are the names of the inputs in every language, their symbols, or the names that `hpn fleet` gives its columns.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby, pairwise

from hpn.tables.bodies import Body
from hpn.tables.cells import is_blank, is_number
from hpn.tables.columns import NUMBERS, SKIP, Choices, Column, in_steps, is_angular, said_of, unit_by
from hpn.tables.headings import INDEX, LONGEST, QUANTITIES, SUM, UNIT, Over, heading_of, heading_over, parts_of
from hpn.web.form.symbols import PHASE_SYMBOLS, SYMBOLS, Symbol
from hpn.words import units
from hpn.words.quantities import Named
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.wording import N_, Sentence

AXIS = "axis"
AXIS_NAMED = Named(N_("Axis"))

BY_ROLE: dict[str, Symbol] = {symbol.name: symbol for symbol in (*PHASE_SYMBOLS, *SYMBOLS)}
"""Every role but that of the axis, by its link symbol."""

PHASES = tuple(symbol.name for symbol in PHASE_SYMBOLS)

FURTHER = {
    AXIS: "axis name, achse, achsname, achsbezeichnung, achse nr, antrieb, drive, joint, gelenk, bezeichnung, name",
    "tp": "pause, pausenzeit, dwell",
    "Tk": "not-halt-moment, nothaltmoment, not-halt-drehmoment",
    "Nk": "emergency stops, not-halt-vorgänge, anzahl not-halt",
    "Lh": "gear life, lebensdauer getriebe",
    "Lb": "bearing life, lagerlebensdauer",
    "i": "ratio, ratios, übersetzung, übersetzungen",
    "size": "size, sizes, baugröße, baugrößen",
    "ta": "ambient, umgebungstemperatur",
    "fw": "betriebsfaktor",
}
"""Further names by role. One that fits two inputs, such as “life” or “motor torque”, is in none: it is asked for."""


@dataclass(frozen=True, slots=True)
class AxisColumn(Column):
    """A column of a table of axes: its role may be the axis and every other input."""

    @property
    def symbol(self) -> Symbol | None:
        """The input that it holds."""
        return BY_ROLE.get(self.role)

    @property
    def quantity(self) -> str:
        """What its unit measures, blank for a pure number or a text, and where there is one unit alone."""
        return quantity_of(self.role)

    @property
    def numbers_phases(self) -> bool:
        """Whether it is left out because its cells number the rows."""
        return self.role == SKIP and self.skipped is not None and self.skipped.template == NUMBERS

    @property
    def is_number(self) -> bool:
        """Whether its cells hold one number each."""
        return self.symbol is not None and self.symbol.kind != "text" and not self.symbol.many


def quantity_of(role: str) -> str:
    """What the unit of a role measures."""
    unit = BY_ROLE[role].unit if role in BY_ROLE else ""
    quantity = "" if unit.endswith("_per_rad") else units.quantity_of(unit)
    return quantity if quantity in units.READ else ""


def columns_of(body: Body, choices: Choices, assumed: Collection[str]) -> tuple[AxisColumn, ...]:
    """What each column that is not empty is; without a unit it is in that of the wire, where that may be assumed."""
    filled = [place for place in range(body.grid.width) if any(not is_blank(row[place]) for row in body.rows)]
    proposed = [_proposed(body, place) for place in filled]
    return tuple(_with_unit(body, column, choices, assumed) for column in said_of(proposed, choices, (AXIS, *BY_ROLE)))


def _proposed(body: Body, place: int) -> AxisColumn:
    headings = body.headings[place]
    heading = " ".join(" ".join(text.split()) for text in headings)[:LONGEST]
    said = heading_over(headings)
    if role := _role_over(headings, said):
        return AxisColumn(place, heading, role)
    kind = said.kind
    if kind in (INDEX, SUM):
        why = Sentence(NUMBERS) if kind == INDEX else Sentence(N_("a sum"))
        counts = kind == INDEX and not _numbers_rows([row[place] for row in body.rows if not is_blank(row[place])])
        return AxisColumn(place, heading, "" if counts else SKIP, skipped=why)
    if kind in QUANTITIES:
        return AxisColumn(place, heading, kind, lasting=said.lasting, instant=said.instant or place in body.dated)
    if not any(is_number(row[place]) for row in body.rows):
        return AxisColumn(place, heading, SKIP, skipped=Sentence(N_("text")))
    return AxisColumn(place, heading)


def _role_over(headings: Sequence[str], said: Over) -> str:
    """Role by the name of an input that all texts above a column make together, or by the same name in each."""
    found = {role for text in headings if (role := _role_of(text))}
    names = [text for text in headings if heading_of(text).kind != UNIT]
    if len(names) > 1:
        found = {role} if (role := _role_of(said.name)) else found if len(found) == len(names) == 1 else set()
    return found.pop() if len(found) == 1 else ""


def _numbers_rows(cells: Sequence[str]) -> bool:
    """Whether cells can number axes, all rows, or those of each axis anew: texts, or numbers that go on in steps."""
    texts = [cell.removesuffix(".") for cell, _ in groupby(cells)]
    if not all(map(is_number, cells)):
        return True
    if not all(re.fullmatch("[0-9]{1,9}", text) for text in texts):
        return False
    back = [k for k, (before, after) in enumerate(pairwise(map(int, texts)), start=1) if after < before]
    return all(in_steps(texts[start:end]) for start, end in pairwise([0, *back, len(texts)]))


def _role_of(heading: str) -> str:
    """Role by one of the names of an input, with or without a unit behind it."""
    if len(heading) > LONGEST:
        return ""
    return _names().get(_folded(heading)) or _names().get(_folded(parts_of(heading)[0]), "")


@cache
def _names() -> dict[str, str]:
    names: dict[str, str] = {}
    readers = [Reader(language) for language in LANGUAGES]
    for symbol in BY_ROLE.values():
        if symbol in PHASE_SYMBOLS:
            continue
        path = symbol.path[-1:] if symbol.path[0] == "duty_cycle" else symbol.path
        names |= {
            _folded(text): symbol.name for text in (".".join(path), *(r.text(symbol.named.name) for r in readers))
        }
        if len(symbol.named.symbol) > 2:
            names[_folded(symbol.named.symbol)] = symbol.name
    names |= {_folded(symbol.path[0]): symbol.name for symbol in PHASE_SYMBOLS} | {_folded(AXIS): AXIS}
    return names | {_folded(word): role for role, words in FURTHER.items() for word in words.split(", ")}


def _folded(text: str) -> str:
    return " ".join(text.casefold().replace("_", " ").split()).strip(" :.")


def _with_unit(body: Body, column: AxisColumn, choices: Choices, assumed: Collection[str]) -> AxisColumn:
    """A column with its unit, as somebody has said it or as it is written."""
    if not column.quantity:
        return replace(column, unit=column.symbol.unit if column.symbol else "")
    unit = choices.units.get(column.place, "")
    return replace(column, unit=unit if unit in units.READ[column.quantity] else _unit(body, column, assumed))


def _unit(body: Body, column: AxisColumn, assumed: Collection[str]) -> str:
    """Unit as the headings say it, else that of the wire if it may be assumed; else blank."""
    wire = BY_ROLE[column.role].unit
    written = {_written_unit(text, wire) for text in body.headings[column.place]} - {""}
    if not written:
        return wire if wire in assumed and not is_angular(body, column) else ""
    return wire if written == {wire} else unit_by(written, column.quantity)


def _written_unit(text: str, wire: str) -> str:
    """Unit that a heading has, blank for none: `Dauer ms`, `duration_s`."""
    if text.strip().casefold().endswith(f"_{wire}".casefold()):
        return wire
    return heading_of(text).unit or parts_of(text)[1]


_UNIT = re.compile(r"[%‰/²³^·*]|[0-9]{2}|[A-Za-z][0-9]")
"""What an unknown unit has in it, and no word."""


def foreign_unit(body: Body, column: AxisColumn) -> str:
    """Unit in the headings of a column that is read in one alone, where it is another; blank for none."""
    if column.quantity or column.symbol is None or column.symbol.kind == "text":
        return ""
    wire = column.symbol.unit
    own = {wire, _plain(units.SYMBOLS.get(wire, ""))} - {""}
    found = {_written_unit(text, wire or "1") for text in body.headings[column.place]} - {"1"}
    strange = [unit for unit in sorted(found) if unit not in own and _plain(unit) not in own]
    return next((unit for unit in strange if _UNIT.search(unit) or units.codes_for(unit)), "")


def _plain(unit: str) -> str:
    return unit.casefold().translate(_AS_PLAIN)


_AS_PLAIN = str.maketrans({"²": "2", "³": "3", **dict.fromkeys(" ·*^.⋅", "")})
