"""The files of a catalogue folder: each is read once, within a limit, cell by cell; anything but a table is an
error.
"""

import codecs
import csv
import os
import re
import stat
from collections.abc import Collection, Iterator
from decimal import Decimal
from pathlib import Path, PurePath
from typing import Any

from pydantic import ValidationError

from hpn.catalogue.tables import CatalogueError, CatalogueRow, Cell, Cells, TableRow
from hpn.tables.cells import split_unit
from hpn.tables.numbers import unit_code
from hpn.words.designations import canonical_size
from hpn.words.units import NUMBER, entered, quantity_of, quotient_of, suffix_of
from hpn.words.wording import Sentence

MAXIMUM_FILE_BYTES = 4_000_000

SHEETS = (".csv", ".tsv", ".txt", ".xls", ".xlsx", ".ods")
"""Suffixes of files that may hold a table."""

LONGEST_CELL = 1000

UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff\ufffe\uffff]")
"""Control characters, separators of lines that editors don't count, marks that change the direction of text."""

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def read_folder(folder: Path, tables: Collection[str]) -> dict[str, bytes]:
    """Contents of a folder's tables by their names.

    Raises CatalogueError for a folder or a table that can't be read, and for a file that looks like a table but has
    none of their names: otherwise its owner would believe that it counts.
    """
    try:
        names = sorted(os.listdir(folder))
    except (FileNotFoundError, NotADirectoryError):
        raise CatalogueError(folder, None, None, "is not a folder") from None
    except OSError as error:
        raise CatalogueError(folder, None, None, f"can’t be read: {error.strerror}") from None
    for name in names:
        if name not in tables and _is_meant(name, tables):
            detail = f"is not a table of the catalogue; there are {', '.join(sorted(tables))}"
            if name.lower() in tables:
                detail = f"is not a table of the catalogue: its name is {name.lower()}, in small letters"
            raise CatalogueError(folder / name, None, None, detail)
    return {name: _content(folder / name) for name in names if name in tables}


def _is_meant(name: str, tables: Collection[str]) -> bool:
    """True for a file that seems to be a table: a CSV file of any name, or a sheet such as `ratings.xlsx`."""
    ending = PurePath(name.lower()).suffix
    return ending == ".csv" or (ending in SHEETS and f"{name.lower().partition('.')[0]}.csv" in tables)


def _content(path: Path) -> bytes:
    try:
        target, kind = path.resolve(strict=True), stat.S_IFMT(path.stat().st_mode)
        if not target.is_relative_to(path.parent.resolve()):
            raise CatalogueError(path, None, None, f"is a link out of its folder, to {target}")
        if kind != stat.S_IFREG:
            raise CatalogueError(path, None, None, f"is {KINDS.get(kind, 'something else')}, where a file belongs")
        with path.open("rb") as file:
            content = file.read(MAXIMUM_FILE_BYTES + 1)
    except FileNotFoundError:
        raise CatalogueError(path, None, None, "is a link that leads nowhere") from None
    except (OSError, RuntimeError) as error:  # RuntimeError: a link to itself
        raise CatalogueError(path, None, None, f"can’t be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > MAXIMUM_FILE_BYTES:
        raise CatalogueError(path, None, None, f"is larger than {MAXIMUM_FILE_BYTES} bytes")
    return content


# --- Cells of a file --------------------------------------------------------------------------------------------------

Key = tuple[str, ...]


def read(path: Path, content: bytes, table: type[CatalogueRow], *, supplied: bool) -> dict[Key, Cells]:
    """Cells of one CSV file by key.

    Raises CatalogueError for a file that is not text, a wrong header, no row or too many, a row of the wrong length, a
    blank or repeated key.
    """
    rows: dict[Key, Cells] = {}
    may_lack = frozenset(table.columns()) - {*table.key} if supplied else table.optional
    for line, row in _lines(path, _text(path, content), table, may_lack):
        texts = {column: text.strip() for column, text in row.items()}
        cells = {column: Cell(text, texts["source"], str(path), line, supplied) for column, text in texts.items()}
        for column in table.key:
            if not cells[column].text:
                raise CatalogueError(path, line, column, "is blank, but it identifies the row")
        key = tuple(_key_text(column, cells[column].text) for column in table.key)
        if key in rows:
            first = next(iter(rows[key].values())).line
            raise CatalogueError(path, line, table.key[0], f"repeats the row of line {first}")
        if len(rows) == table.most_rows:
            raise CatalogueError(path, line, None, f"the table has more than {table.most_rows} rows")
        rows[key] = cells
    if not rows and (supplied or not table.may_be_empty):
        raise CatalogueError(path, 1, None, "there is a header, but no row below it")
    return rows


def merge(rows: dict[Key, Cells], supplement: dict[Key, Cells]) -> dict[Key, Cells]:
    """Rows with cells filled or corrected by a supplement; its blank cells change nothing."""
    merged = dict(rows)
    for key, cells in supplement.items():
        before = merged.get(key, {})
        texts = {column: cell for column, cell in cells.items() if cell.text or column not in before}
        merged[key] = before | texts
    return merged


def validated(table: type[TableRow], rows: dict[Key, Cells]) -> list[TableRow]:
    """Typed rows; raises CatalogueError, which names file, line and column of the first wrong cell."""
    result = []
    for cells in rows.values():
        values: dict[str, Any] = {column: cell.text or None for column, cell in cells.items()}
        try:
            result.append(table.model_validate({**values, "cells": cells}))
        except ValidationError as error:
            first = error.errors()[0]
            column = str(first["loc"][0])
            cell = cells[column]
            message = first["msg"].removeprefix("Value error, ").replace("Input should", "must")
            detail = f"{message} (found {cell.text[:60]!r})"
            raise CatalogueError(cell.file, cell.line, column, detail) from None
    return result


def _text(path: Path, content: bytes) -> str:
    content = content.removeprefix(codecs.BOM_UTF8)
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        place = _place(content[: error.start].decode())
        detail = f"byte {content[error.start]:#04x} is not UTF-8 text; save the file as UTF-8"
        raise CatalogueError(path, *place, detail) from None
    if character := UNPRINTABLE.search(text):
        detail = f"the character U+{ord(character[0]):04X} does not belong in a table; save the file as UTF-8 text"
        raise CatalogueError(path, *_place(text[: character.start()]), detail)
    return text


def _place(before: str) -> tuple[int, str | None]:
    """Line and column of the place behind a text."""
    lines = (before + "?").splitlines()
    try:
        header, broken = next(csv.reader(lines)), next(csv.reader(lines[-1:]))
    except csv.Error:  # the text is not a table either
        return len(lines), None
    return len(lines), header[len(broken) - 1] if len(broken) <= len(header) and len(lines) > 1 else None


def _lines(
    path: Path, text: str, table: type[CatalogueRow], may_lack: frozenset[str]
) -> Iterator[tuple[int, dict[str, str]]]:
    """Yield line and cells of every row by column; a column that the file may lack is blank.

    Raises CatalogueError for a header other than the table's and for a row that does not fit it.
    """
    reader = csv.reader(text.splitlines(), strict=True)
    columns = table.columns()
    try:
        written = next(reader, [])
        header, codes = _header(path, written, columns)
        lacking = [column for column in columns if column in may_lack and column not in header]
        if sorted(header + lacking) != sorted(columns):
            wrong = [name[:40] for name in sorted(set(header + lacking) ^ set(columns)) or header]
            detail = f"the header must have the columns {', '.join(columns)}; see {', '.join(wrong[:20])}"
            raise CatalogueError(path, 1, None, detail)
        columns = [column for column in columns if column not in lacking]
        order = [header.index(column) for column in columns]
        for row in reader:
            if not row:
                continue
            if len(row) != len(columns):
                place = header[min(len(row), len(header) - 1)]  # the first column without a cell, else the last column
                detail = f"has {len(row)} cells where the header has {len(columns)} (a decimal comma splits a cell)"
                raise CatalogueError(path, reader.line_num, place, f"the row {detail}")
            if max(map(len, row)) > LONGEST_CELL:
                place = next(column for column, cell in zip(header, row, strict=True) if len(cell) > LONGEST_CELL)
                detail = f"the cell has more than {LONGEST_CELL} characters"
                raise CatalogueError(path, reader.line_num, place, detail)
            texts = [_in_wire(row[index], columns[k], codes[index]) for k, index in enumerate(order)]
            for column, part in zip(columns, texts, strict=True):
                if isinstance(part, Sentence):
                    raise CatalogueError(path, reader.line_num, column, part.text)
            yield reader.line_num, dict(zip(columns, map(str, texts), strict=True)) | dict.fromkeys(lacking, "")
    except csv.Error as error:
        detail = {"unexpected end of data": "a quote is opened and not closed"}.get(str(error), str(error))
        raise CatalogueError(path, reader.line_num, None, detail) from None


def _header(path: Path, written: list[str], columns: list[str]) -> tuple[list[str], list[str]]:
    """Columns by their names in a header, and codes of their units: `inertia_kgcm2` is `inertia_kgm2` in kg·cm²."""
    names, codes = list(written), [""] * len(written)
    for place, name in enumerate(written):
        for column in columns if name not in columns else ():
            unit = suffix_of(column)
            stem = column.removesuffix(unit).rstrip("_")
            if _takes_units(unit) and name.startswith((f"{stem}_", f"{stem} ")):
                code = unit_code(name.removeprefix(stem).strip("_ []()"), unit)
                if isinstance(code, Sentence):
                    raise CatalogueError(path, 1, name[:40], code.text)
                names[place], codes[place] = column, code
    return names, codes


def _takes_units(unit: str) -> bool:
    """True for a unit of the wire that may be replaced by others."""
    return bool(quantity_of(quotient_of(unit).dividend))


def _in_wire(text: str, column: str, code: str) -> str | Sentence:
    """A cell in the unit of its column; a unit in the cell has precedence over that of the header."""
    unit = suffix_of(column)
    if not _takes_units(unit):
        return text
    number, own = split_unit(text.strip())
    measured_in = unit_code(own, unit) if own else code
    if isinstance(measured_in, Sentence):
        return measured_in
    if not measured_in or not NUMBER.fullmatch(number) or (measure := entered(unit, measured_in)).same:
        return number if own else text
    return f"{Decimal(repr(measure.wire(number))):f}"


def _key_text(column: str, text: str) -> str:
    if column == "size":
        return str(canonical_size(text))
    try:
        return repr(float(text))
    except ValueError:
        return text
