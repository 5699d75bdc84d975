"""The sheet of a motion: mechanism and moves as they were given, in the units of the wire and in the reader's own."""

from typing import Any

from xlsxwriter.utility import xl_rowcol_to_cell

from hpn.application.motion import Motion
from hpn.files.motion import MOVES, MOVES_TITLE, Value, mechanism_of, moves_of, written
from hpn.files.workbook.sheets import Book
from hpn.words.units import symbol_of
from hpn.words.wording import N_

NOTE = N_(
    "The load phases on the sheet Inputs come from this motion, as saved: changes there are recalculated, changes "
    "here are not."
)


def write_motion(book: Book, sheet: Any, motion: Motion) -> None:
    """Write the sheet."""
    sheet.set_column(0, 0, 30)
    sheet.set_column(1, 16, 15)
    sheet.write_string(0, 0, book.reader.text(NOTE), book.style("quiet"))
    row = _mechanism(book, sheet, motion)
    _moves(book, sheet, motion, row + 1)
    book.page(sheet, landscape=True)


def _mechanism(book: Book, sheet: Any, motion: Motion) -> int:
    """Lines of the mechanism; the row behind them."""
    row = 2
    for row, (name, named, value) in enumerate(mechanism_of(motion), 2):
        unit = symbol_of(name) if name != "type" else ""
        sheet.write_string(row, 0, book.reader.text(named.name), book.style("label"))
        sheet.write_string(row, 1, named.symbol, book.style("quiet"))
        _cell(book, sheet, row, 2, name, value)
        sheet.write_string(row, 3, book.reader.unit(unit), book.style("unit"))
        if unit and book.converted(sheet, row, 4, xl_rowcol_to_cell(row, 2), unit, value):
            sheet.write_string(row, 5, book.shown.unit(unit), book.style("unit"))
    return row + 1


def _moves(book: Book, sheet: Any, motion: Motion, row: int) -> None:
    """A row for each move below its heads; columns in other units stand behind all others."""
    columns = moves_of(motion)
    converted = [name for name in columns if symbol_of(name) and not book.shown.measure(symbol_of(name)).same]
    sheet.write_string(row, 0, book.reader.text(MOVES_TITLE), book.style("section"))
    heads = [book.head(book.reader.text(MOVES[name].name), symbol_of(name)) for name in columns]
    heads += [f"{book.reader.text(MOVES[name].name)} [{book.shown.unit(symbol_of(name))}]" for name in converted]
    for column, head in enumerate((book.reader.text(N_("Move")), *heads)):
        sheet.write_string(row + 1, column, head, book.style("head of numbers" if column > 1 else "head"))
    sheet.set_row(row + 1, 48)
    for place, move in enumerate(motion.moves):
        own = row + 2 + place
        book.number(sheet, own, place, move.name)
        for column, (name, values) in enumerate(columns.items(), 1):
            _cell(book, sheet, own, column, name, values[place])
        for column, name in enumerate(converted, 1 + len(columns)):
            source = xl_rowcol_to_cell(own, 1 + list(columns).index(name))
            book.converted(sheet, own, column, source, symbol_of(name), columns[name][place])


def _cell(book: Book, sheet: Any, row: int, column: int, name: str, value: Value | None) -> None:
    if isinstance(value, str):
        book.put(sheet, row, column, written(value, name, book.reader), "label")
    elif value is not None:
        book.put(sheet, row, column, value, "figure")
