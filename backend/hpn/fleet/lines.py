"""Tables of axes in lines of text: CSV and NDJSON."""

import csv
import gzip
import io
import os
import re
import zlib
from abc import abstractmethod
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, BinaryIO

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
from numpy.typing import NDArray

from hpn.application.faults import NOT_A_NUMBER
from hpn.application.unique import RepeatedNameError, require_unique
from hpn.fleet.columns import AXIS, COLUMNS, Column, is_list
from hpn.fleet.errors import FleetError
from hpn.fleet.tables import BATCH_ROWS, INDEX, MOST_HELD_BYTES, Batch, CellFault, Table, row_of
from hpn.words.wording import N_

UNIT_BYTES = 8_000_000
"""Length of a stretch of lines, which ends with a line."""

START_BYTES = 8_000_000
"""Beginning of a file, in which its header or its first row stands."""

MOST_LINE_BYTES = 64_000_000
"""Longest line; an axis of 10,000 phases has about 1 MB."""

MOST_BROKEN = 100_000
"""Lines of a stretch that are no rows; a file with more is no table of axes, and the run ends with that."""

OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
BOM = b"\xef\xbb\xbf"
NUMBER = r"^[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?$|^[+-]?(nan|inf|infinity)$"
NO_NUMBER = N_("must be a number with a decimal point, such as 9.3")
NO_NUMBERS = N_("must be a JSON list of numbers, such as [40, 32.5]")
NO_TEXTS = N_('must be a JSON list of texts, such as ["14A", "20A"]')
NO_TEXT = N_("must be text")
NOT_UTF8 = N_("must be UTF-8")
QUOTED = re.compile(rb'(?:\A|(?<=[,\r\n]))"[^"]*(?:""[^"]*)*"?')
"""A cell in quotes, up to the end of the file where nothing closes it."""

REPLACED = "\ufffd"
"""Stands for bytes that are no UTF-8, here and in every text that was read so before."""


class LinesTable(Table):
    """A table in lines; its units are stretches of lines."""

    def open(self) -> BinaryIO:
        """The file, to be read from its start."""
        return open(self.path, "rb")

    @cached_property
    def cuts(self) -> Sequence[int]:
        """Where stretches begin and end, in bytes from the start of the file."""
        cuts = [self.first_byte]
        with self.open() as file:
            size = file.seek(0, os.SEEK_END)
            while cuts[-1] < size:
                cuts.append(self._next_cut(file, cuts[-1], size))
        return cuts

    def _next_cut(self, file: Any, start: int, size: int) -> int:
        length = UNIT_BYTES
        while start + length < size:
            file.seek(start)
            end = self.last_line_end(file.read(length))
            if end:
                return start + end
            length *= 2
            if length > MOST_LINE_BYTES:
                raise FleetError(
                    f"{self.path}: a line is longer than {MOST_LINE_BYTES} bytes, or a quote is never closed"
                )
        return size

    @property
    @abstractmethod
    def first_byte(self) -> int:
        """Where the rows begin."""

    @abstractmethod
    def last_line_end(self, content: bytes) -> int:
        """Byte behind the last whole line, 0 where there is none."""

    measured_in = "B"

    @cached_property
    def unit_sizes(self) -> Sequence[int]:
        return [end - start for start, end in pairwise(self.cuts)]

    def content(self, unit: int) -> bytes:
        """The lines of a stretch."""
        with self.open() as file:
            file.seek(self.cuts[unit])
            return file.read(self.cuts[unit + 1] - self.cuts[unit])

    def too_many_broken(self, first: str) -> FleetError:
        """Refusal of a file of which hardly a line is a row."""
        return FleetError(
            f"{self.path}: more than {MOST_BROKEN} lines of one stretch of {UNIT_BYTES} bytes can’t be read as rows, "
            f"the first of them is {_cut(first)}; mend them or leave them out"
        )

    def start_of_file(self) -> bytes:
        """The first lines."""
        with self.open() as file:
            return file.read(START_BYTES)


# --- CSV --------------------------------------------------------------------------------------------------------------


class CsvTable(LinesTable):
    """Comma-separated values with a header row; lists are JSON in their cells."""

    @cached_property
    def _header(self) -> tuple[list[str], int]:
        """Names of the columns, and where the rows begin."""
        content = self.start_of_file()
        line, _, _ = content.removeprefix(BOM).partition(b"\n")
        skipped = len(content) - len(content.removeprefix(BOM)) + len(line) + 1
        try:
            names = next(csv.reader([line.decode().rstrip("\r")]), [])
        except (UnicodeDecodeError, csv.Error) as error:
            raise self.unreadable(error) from None
        if not names:
            raise FleetError(f"{self.path}: has no header row with the names of its columns")
        if len(names) == 1 and (used := next((mark for mark in OTHER_SEPARATORS if mark in names[0]), None)):
            raise FleetError(
                f"{self.path}: its columns are separated by {OTHER_SEPARATORS[used]}, where commas belong, with a "
                "point as decimal mark; the page /fleets reads such files as they are"
            )
        return names, min(skipped, len(content))

    @property
    def all_names(self) -> Sequence[str]:
        return self._header[0]

    @property
    def first_byte(self) -> int:
        return self._header[1]

    @cached_property
    def is_in_list_form(self) -> bool:
        if "torque_Nm" not in self.names:
            return False
        batches = (batch for unit in range(len(self.unit_sizes)) for batch in self._texts(unit, ["torque_Nm"]))
        first = next((cells[0].as_py() for batch in batches if len(cells := batch.rows[0].drop_null())), None)
        if first is None:
            return any(name in COLUMNS.others for name in self.names)
        return bool(first.lstrip().startswith("["))

    @property
    def axis_type(self) -> pa.DataType:
        return pa.string()

    def last_line_end(self, content: bytes) -> int:
        if b'"' not in content:
            return content.rfind(b"\n") + 1
        ends = np.flatnonzero((np.frombuffer(content, np.uint8) == ord("\n")) & ~_quoted(content))
        return int(ends[-1]) + 1 if len(ends) else 0

    def _batches(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        for texts in self._texts(unit, names):
            faults, broken = list(texts.faults), {fault.row for fault in texts.faults}
            columns = []
            for name in names:
                column, wrong = _parsed(texts.rows[name].combine_chunks(), COLUMNS.all.get(name), self.type_of(name))
                columns.append(column)
                faults += (CellFault(row, name, reason) for row, reason in wrong if row not in broken)
            yield Batch(pa.Table.from_arrays(columns, names=list(names)), faults)

    def _texts(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        """Cells as text; a row with too few or too many has none but its axis."""
        if unit + 1 >= len(self.cuts):
            return
        broken: list[pacsv.InvalidRow] = []

        def skip(row: pacsv.InvalidRow) -> str:
            broken.append(row)
            return "skip" if len(broken) <= MOST_BROKEN else "error"

        try:
            rows = pacsv.read_csv(
                io.BytesIO(_as_utf8(self.content(unit))),
                pacsv.ReadOptions(column_names=self.all_names, use_threads=False, block_size=MOST_LINE_BYTES),
                pacsv.ParseOptions(newlines_in_values=True, invalid_row_handler=skip),
                pacsv.ConvertOptions(
                    column_types=dict.fromkeys(self.all_names, pa.string()),
                    include_columns=list(names),
                    null_values=[""],
                    strings_can_be_null=True,
                    quoted_strings_can_be_null=False,
                ),
            )
        except pa.ArrowInvalid as error:
            if len(broken) > MOST_BROKEN:
                raise self.too_many_broken(broken[0].text) from None
            if "Empty CSV" not in str(error):
                raise self.unreadable(error) from None
            rows = pa.table({name: pa.array([], pa.string()) for name in names})
        rows, faults = self._with_broken(rows, broken)
        begun = 0
        for start in range(0, rows.num_rows, BATCH_ROWS):
            end = bisect_left(faults, start + BATCH_ROWS, begun, key=row_of)
            yield Batch(rows.slice(start, BATCH_ROWS), [f._replace(row=f.row - start) for f in faults[begun:end]])
            begun = end

    def _with_broken(self, rows: pa.Table, broken: Sequence[pacsv.InvalidRow]) -> tuple[pa.Table, list[CellFault]]:
        """Rows in their places that have too few or too many cells; the number of a row counts from 1."""
        if not broken:
            return rows, []
        is_broken = np.zeros(rows.num_rows + len(broken), bool)
        is_broken[[row.number - 1 for row in broken]] = True
        placed = rows.take(pa.array(np.cumsum(~is_broken) - 1, mask=is_broken))
        if AXIS in rows.column_names:
            axes = pa.array([self._axis_of(row.text, row.actual_columns) for row in broken], pa.string())
            filled = pc.replace_with_mask(placed[AXIS].combine_chunks(), pa.array(is_broken), axes)
            placed = placed.set_column(placed.column_names.index(AXIS), AXIS, filled)
        said = "the row has {} cells where the header has {}, in {}"
        return placed, [
            CellFault(row.number - 1, AXIS, said.format(row.actual_columns, row.expected_columns, _cut(row.text)))
            for row in broken
        ]

    def _axis_of(self, line: str, cells: int) -> str | None:
        """Axis of a broken row, where its cell has an end, and the header names it."""
        place = self._axis_place
        if place is None or cells <= place + 1:
            return None
        try:
            found = next(csv.reader([line]), [])
        except csv.Error:
            return None
        return (found[place] or None) if len(found) > place + 1 else None

    @cached_property
    def _axis_place(self) -> int | None:
        return list(self.all_names).index(AXIS) if AXIS in self.all_names else None

    @property
    def indices(self) -> Sequence[str]:
        return [name for place, name in enumerate(self.all_names) if INDEX.fullmatch(name) or not (place or name)]


class GzipCsvTable(CsvTable):
    """CSV in a gzip file, which is unfolded once and held."""

    @cached_property
    def _content(self) -> bytes:
        try:
            with gzip.open(self.path) as file:
                content = file.read(MOST_HELD_BYTES + 1)
        except (OSError, EOFError, zlib.error) as error:
            raise FleetError(f"{self.path}: can’t be read as gzip: {error}") from None
        if len(content) > MOST_HELD_BYTES:
            raise FleetError(f"{self.path}: unfolds to more than {MOST_HELD_BYTES:,} bytes; unpack it and send the CSV")
        return content

    def open(self) -> BinaryIO:
        """What the file holds, to be read from its start."""
        return io.BytesIO(self._content)


def _parsed(texts: pa.Array, column: Column | None, wanted: pa.DataType) -> tuple[pa.Array, list[tuple[int, str]]]:
    """Values of cells of CSV, and the rows of those that are none, with what would be right."""
    if column is None or (column.kind == "string" and not is_list(wanted)):
        broken = pc.fill_null(pc.match_substring(texts, REPLACED), False)
        return pc.if_else(broken, None, texts), [(int(row), NOT_UTF8) for row in np.flatnonzero(np.asarray(broken))]
    if is_list(wanted):
        kind = list[str | None] if column.kind == "string" else list[float | None]
        return _one_by_one(texts, msgspec.json.Decoder(kind).decode, wanted, _no_list(column))
    texts = pc.ascii_trim_whitespace(texts)
    numbers = pc.match_substring_regex(texts, NUMBER, ignore_case=True)
    wrong = np.flatnonzero(np.asarray(pc.fill_null(pc.invert(numbers), False)))
    if len(wrong):
        texts = pc.if_else(numbers, texts, None)
    return texts.cast(wanted), [(int(row), NO_NUMBER) for row in wrong]


def _quoted(content: bytes) -> NDArray[np.bool_]:
    """Bytes that are quoted, as the reader of the cells takes them: a quote inside of a bare cell is a character."""
    given = np.frombuffer(content, np.uint8)
    marks = np.flatnonzero(given == ord('"'))
    opening = marks[::2]
    before = given[opening - 1]
    follows = np.zeros(len(opening), np.bool_)
    follows[1:] = opening[1:] == marks[1::2][: len(opening) - 1] + 1
    if (np.isin(before, np.frombuffer(b",\r\n", np.uint8)) | (opening == 0) | follows).all():
        return np.asarray(np.cumsum(given == ord('"'), dtype=np.uint8) % 2 == 1)
    quoted = np.zeros(len(content), np.bool_)
    for found in QUOTED.finditer(content):
        quoted[found.start() : found.end()] = True
    return quoted


def _as_utf8(content: bytes) -> bytes:
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode(errors="replace").encode()
    return content


def _no_list(column: Column) -> str:
    return NO_TEXTS if column.kind == "string" else NO_NUMBERS


def _one_by_one(cells: pa.Array, read: Any, wanted: pa.DataType, reason: str) -> tuple[pa.Array, list[tuple[int, str]]]:
    values, wrong = [], []
    for row, cell in enumerate(cells.to_pylist()):
        try:
            values.append(None if cell is None else read(cell))
        except (ValueError, RecursionError):
            values.append(None)
            wrong.append((row, reason))
    return pa.array(values, wanted), wrong


# --- NDJSON -----------------------------------------------------------------------------------------------------------

AXIS_IN_LINE = re.compile(rb'"axis"\s*:\s*("(?:[^"\\]|\\.)*"|-?[0-9]+(?=[\s,}]))')
NAME_IN_LINE = re.compile(rb'"([^"\\]*)"\s*:')
Integer = Annotated[int, msgspec.Meta(ge=-(2**63), le=2**63 - 1)]
"""What Arrow holds in 64 bits."""

MOST_SHOWN = 60

READ_AS: dict[tuple[bool, bool], Any] = {
    (False, False): float,
    (False, True): list[float | None],
    (True, False): str,
    (True, True): list[str | None],
}
"""What msgspec reads a cell as: whether the column holds texts, and whether lists of them."""


class NdjsonTable(LinesTable):
    """A JSON object in each line, with the names of the columns as keys."""

    @cached_property
    def _first(self) -> dict[str, Any]:
        """The first row; empty where there is none."""
        for line in self.start_of_file().removeprefix(BOM).split(b"\n"):
            if line.strip():
                try:
                    return _object(line)
                except (ValueError, RecursionError) as error:
                    raise self.unreadable(error, "the first line ") from None
        return {}

    @property
    def all_names(self) -> Sequence[str]:
        """Every column that a row may have: they need not stand in the first one."""
        phases = COLUMNS.phases if "torque_Nm" in self._first or not self._first else ()
        others = COLUMNS.others if self.is_in_list_form or not phases else ()
        return list(dict.fromkeys((AXIS, *phases, *others, *self._first)))

    @property
    def first_byte(self) -> int:
        return len(BOM) if self.start_of_file().startswith(BOM) else 0

    @cached_property
    def is_in_list_form(self) -> bool:
        return isinstance(self._first.get("torque_Nm"), list)

    @property
    def axis_type(self) -> pa.DataType:
        return pa.int64() if isinstance(self._first_axis, int) else pa.string()

    @cached_property
    def _first_axis(self) -> str | int:
        """The first axis that may be one: a bad one decides nothing for the others."""
        for line in self.start_of_file().removeprefix(BOM).split(b"\n"):
            with suppress(ValueError, RecursionError):
                axis = _object(line).get(AXIS) if line.strip() else None
                if isinstance(axis, str | int) and not isinstance(axis, bool):
                    return axis
        return ""

    def last_line_end(self, content: bytes) -> int:
        return content.rfind(b"\n") + 1

    @cached_property
    def _kinds(self) -> dict[str, Any]:
        """What msgspec reads a cell of each column as."""
        kinds: dict[str, Any] = {AXIS: Integer if pa.types.is_integer(self.axis_type) else str}
        for name in self.names:
            if name != AXIS:
                kinds[name] = READ_AS[COLUMNS.all[name].kind == "string", is_list(self.type_of(name))]
        return kinds | dict.fromkeys(self.ignored, Any)

    def _batches(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        if unit + 1 >= len(self.cuts):
            return
        lines = [line for line in self.content(unit).split(b"\n") if line.strip()]
        broken = list[bytes]()
        for start in range(0, len(lines), BATCH_ROWS):
            yield self._batch(lines[start : start + BATCH_ROWS], names, broken)
            if len(broken) > MOST_BROKEN:
                raise self.too_many_broken(broken[0].decode(errors="replace"))

    def _batch(self, lines: Sequence[bytes], names: Sequence[str], broken: list[bytes]) -> Batch:
        """Rows of lines; those that are no JSON object are added to the broken ones."""
        fields = [(f"c{place}", kind | None, None) for place, kind in enumerate(self._kinds.values())]
        rename = {f"c{place}": name for place, name in enumerate(self._kinds)}
        row_type = msgspec.defstruct("Row", fields, rename=rename.get, forbid_unknown_fields=True)
        decoder = msgspec.json.Decoder(row_type)
        rows, faults = [], []
        for place, line in enumerate(lines):
            try:
                row = decoder.decode(line)
                if _may_repeat_a_name(line):
                    require_unique(line)
                rows.append(row)
            except (ValueError, RecursionError) as error:
                cells, wrong = self._one_by_one(line, error, broken)
                rows.append(msgspec.convert(cells, row_type) if cells else row_type())
                faults += [CellFault(place, *fault) for fault in wrong]
        field_of = {name: field for field, name in rename.items()}
        columns = [pa.array([getattr(row, field_of[name]) for row in rows], self.type_of(name)) for name in names]
        return Batch(pa.Table.from_arrays(columns, names=list(names)), faults)

    def _one_by_one(
        self, line: bytes, error: Exception, broken: list[bytes]
    ) -> tuple[dict[str, Any], list[tuple[str, str]]]:
        """The cells of a line that can be read, and what is wrong with the others."""
        try:
            given, wrong = _object(line), _repeated(line)
        except (ValueError, RecursionError):
            broken.append(line)
            cells = _axis_alone(line, self._kinds[AXIS])
            return cells, [(AXIS, f"the line is not a JSON object: {error}, in {_cut(line.decode(errors='replace'))}")]
        cells = {}
        for name, value in given.items():
            if name not in self._kinds:
                wrong.append((name, N_("is not a column")))
            elif _is(value, self._kinds[name]):
                cells[name] = value
            else:
                wrong.append((name, self._right(name, value)))
        return cells, wrong

    def _right(self, name: str, value: Any) -> str:
        """What would be right in place of a value."""
        if name == AXIS:
            expected = "an integer" if pa.types.is_integer(self.axis_type) else "text"
            return f"must be {expected}, as the first valid axis is, not {_shown(value)}"
        column = COLUMNS.all[name]
        right, kind = (NO_TEXT, str) if column.kind == "string" else (NOT_A_NUMBER, float)
        if not is_list(self.type_of(name)):
            return f"{right}, not {_shown(value)}"
        if not isinstance(value, list):
            return _no_list(column)
        place, item = next((place, item) for place, item in enumerate(value, start=1) if not _is(item, kind))
        return f"{'phase' if name in COLUMNS.phases else 'item'} {place}: {right}, not {_shown(item)}"


def _may_repeat_a_name(line: bytes) -> bool:
    """Whether a row may have a name more than once: always where it has one, seldom where not."""
    names = NAME_IN_LINE.findall(line)
    return len(set(names)) < len(names) or b"\\" in line


def _repeated(line: bytes) -> list[tuple[str, str]]:
    """Fault of a row that has a name more than once."""
    try:
        require_unique(line)
    except RepeatedNameError as repeated:
        return [(repeated.name, N_("is there more than once"))]
    return []


def _object(line: bytes) -> dict[str, Any]:
    """A line as a row; an axis that is a whole float is an integer."""
    row: dict[str, Any] = msgspec.json.decode(line, type=dict[str, Any])
    if isinstance(axis := row.get(AXIS), float) and axis.is_integer():
        row[AXIS] = int(axis)
    return row


def _shown(value: Any) -> str:
    """A value as it stands in JSON, in as many characters as have room in a reason."""
    return _cut(msgspec.json.encode(value).decode(errors="replace"))


def _cut(text: str) -> str:
    """A text to be quoted in a reason; `; ` stands between reasons alone."""
    text = text.replace("; ", ";")
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}…"


def _is(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind | None)
    except msgspec.ValidationError:
        return False
    return True


def _axis_alone(line: bytes, kind: Any) -> dict[str, Any]:
    """Axis of a line that is cut or broken, where it can be read."""
    found = AXIS_IN_LINE.search(line)
    if found is None:
        return {}
    try:
        axis = msgspec.json.decode(found[1])
    except ValueError:
        axis = None
    return {AXIS: axis} if _is(axis, kind) else {}
