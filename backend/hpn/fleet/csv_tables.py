"""Tables of axes as comma-separated values."""

import csv
import gzip
import io
import re
import zlib
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, BinaryIO, cast

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
from numpy.typing import NDArray

from hpn.fleet.columns import AXIS, INDEX, NUMBER, InputColumn, is_list
from hpn.fleet.faults import CellFault
from hpn.fleet.order import FleetError
from hpn.fleet.tables import AxisTable, Progress, RowBatch
from hpn.words.wording import N_, Sentence

BLOCK_BYTES = HEAD_BYTES = 8_000_000
"""Bytes read at once, and bytes of a file's beginning that hold its header and first row."""

MOST_LINE_BYTES = 64_000_000
"""Longest line in bytes; an axis of 10,000 phases has about 1 MB."""

MOST_BROKEN = 100_000
"""Most lines of a block that are no rows; a file with more is no table of axes, and ends the run."""

MOST_SHOWN = 60
Reason = tuple[Sentence, str]
"""Sentence with the accepted form, and a code for programs."""

OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
BOM = b"\xef\xbb\xbf"
NO_NUMBER = Sentence(N_("must be a number with a decimal point, such as 9.3")), "float_parsing"
NO_FLAG = Sentence(N_("must be true or false")), "bool_parsing"
NO_NUMBERS = Sentence(N_("must be a JSON list of numbers, such as [40, 32.5]")), "list_type"
NO_TEXTS = Sentence(N_('must be a JSON list of texts, such as ["14A", "20A"]')), "list_type"
WRONG_LENGTH = N_("the row has {found} cells where the header has {expected}, in {row}")
NOT_UTF8 = Sentence(N_("must be UTF-8")), "string_unicode"
QUOTED = re.compile(rb'(?:\A|(?<=[,\r\n]))"[^"]*(?:""[^"]*)*(?:"(?![^,\r\n])|("?))')
"""Cell in quotes; group 1 exists where the cell has no closing quote, or where text follows that quote."""

REPLACED = "\ufffd"
"""Stand-in for bytes that are not UTF-8, here and in texts that were decoded before."""


def cut(text: str) -> str:
    """Text to quote in a reason, shortened; `; ` is reserved for the space between reasons."""
    text = text.replace("; ", ";")
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}…"


class CsvTable(AxisTable):
    """Comma-separated values with a header row; lists are JSON in their cells."""

    has_untyped_axes = True

    def open(self) -> BinaryIO:
        """File opened at its start."""
        return open(self.path, "rb") if self.content is None else io.BytesIO(self.content)

    @cached_property
    def head(self) -> bytes:
        """First lines of the file."""
        with self.open() as file:
            return self.read(file, HEAD_BYTES)

    def read(self, file: BinaryIO, size: int) -> bytes:
        """Next bytes of the file, none at its end."""
        return file.read(size)

    def blocks(self) -> Iterator[bytes]:
        """Lines after the header, some at a time."""
        with self.open() as file:
            file.seek(self.first_byte)
            rest, line = b"", 1 + self.head[: self.first_byte].count(b"\n")
            while piece := self.read(file, BLOCK_BYTES):
                content = rest + piece
                end = self.end_of_lines(content, line)
                if not end and len(content) > MOST_LINE_BYTES:
                    text = f"line {line} is longer than {MOST_LINE_BYTES} bytes, or a quote in it is never closed"
                    raise FleetError(f"{self.path}: {text}")
                block, rest = content[:end], content[end:]
                line += block.count(b"\n")
                self._note_progress(file)
                if block:
                    yield block
            if rest:
                self.end_of_lines(rest, line, is_whole=True)
                yield rest

    def _note_progress(self, file: BinaryIO) -> None:
        packed: Any = getattr(file, "fileobj", file)  # gzip has its compressed file there
        total = self.path.stat().st_size if self.content is None else len(self.content)
        self.progress = Progress(packed.tell(), total, "B")

    def too_many_broken(self, first: str) -> FleetError:
        """Error of a file with hardly a line that is a row."""
        return FleetError(
            f"{self.path}: more than {MOST_BROKEN} lines of one stretch of {BLOCK_BYTES} bytes can’t be read as rows, "
            f"the first of them is {cut(first)}; mend them or leave them out"
        )

    @cached_property
    def _header(self) -> tuple[list[str], int]:
        """Names of the columns, and the byte where the rows begin."""
        content = self.head.removeprefix(BOM)
        line, _, _ = content.partition(b"\n")
        try:
            names = next(csv.reader([line.decode().rstrip("\r")]), [])
        except (UnicodeDecodeError, csv.Error) as error:
            raise self.unreadable(error) from None
        if not names:
            raise FleetError(f"{self.path}: has no header row with the names of its columns")
        if len(names) == 1 and (used := next((mark for mark in OTHER_SEPARATORS if mark in names[0]), None)):
            raise FleetError(
                f"{self.path}: its columns are separated by {OTHER_SEPARATORS[used]}, where commas belong, with a "
                "point as decimal mark; the page /machines reads such files as they are"
            )
        return names, len(self.head) - len(content) + len(line) + 1

    @property
    def all_names(self) -> Sequence[str]:
        return self._header[0]

    @property
    def first_byte(self) -> int:
        """Byte of the file where the rows begin."""
        return self._header[1]

    @cached_property
    def is_in_list_form(self) -> bool:
        if "torque_Nm" not in self.names or "axis_name" in self.names:
            return "torque_Nm" in self.names  # a machine's axes are rows, and each may lack phases
        batches = self._texts(["torque_Nm"])
        first = next((cells[0].as_py() for batch in batches if len(cells := batch.rows[0].drop_null())), None)
        return first is not None and bool(first.lstrip().startswith("["))

    @property
    def axis_type(self) -> pa.DataType:
        return pa.string()

    def end_of_lines(self, content: bytes, line: int, *, is_whole: bool = False) -> int:
        """Byte after the last whole line of content, 0 where there is none; content begins with line `line` of the
        file.

        Whole content ends with the file. Raises FleetError for a quote that nothing closes in its cell.
        """
        if b'"' not in content:
            return content.rfind(b"\n") + 1
        characters = np.frombuffer(content, np.uint8)
        ends, marks = np.flatnonzero(characters == ord("\n")), np.flatnonzero(characters == ord('"'))
        inside = np.searchsorted(marks, ends) % 2 == 1
        has_lines_in_cells = bool(inside[ends < marks[-1]].any()) or (is_whole and len(marks) % 2 == 1)
        if _are_of_cells(characters, marks) and not has_lines_in_cells:
            ends = ends[~inside]
            return int(ends[-1]) + 1 if len(ends) else 0
        quoted = np.zeros(len(content), np.bool_)
        for match in QUOTED.finditer(content):
            if self._is_broken(match, is_at_end=match.end() == len(content) and not is_whole):
                number = line + content.count(b"\n", 0, match.start())
                raise FleetError(f"{self.path}: line {number} has a quote that nothing closes in its cell")
            quoted[match.start() : match.end()] = True
        ends = ends[~quoted[ends]]
        return int(ends[-1]) + 1 if len(ends) else 0

    def _is_broken(self, cell: re.Match[bytes], *, is_at_end: bool) -> bool:
        """True for a cell that swallows other lines: it has no closing quote, or a quote in one of those lines closes
        it.

        At the end of the content, more of a cell may follow.
        """
        lines = cell[0].split(b"\n")
        if len(lines) == 1 or (cell[1] is not None and not is_at_end):
            return len(lines) > 1
        is_list = lines[0].startswith(b'"[')
        return not is_list and any(line.count(b",") >= max(len(self.all_names) - 1, 1) for line in lines[1:-1])

    def _batches(self) -> Iterator[RowBatch]:
        for texts in self._texts(self.names):
            faults, broken = list(texts.faults), {fault.row for fault in texts.faults}
            columns = []
            for name in self.names:
                column, wrong = _parsed(texts.rows[name].combine_chunks(), self.columns.get(name), self.type_of(name))
                columns.append(column)
                faults += (CellFault(row, name, *reason) for row, reason in wrong if row not in broken)
            yield RowBatch(pa.Table.from_arrays(columns, names=list(self.names)), faults)

    def _texts(self, names: Sequence[str]) -> Iterator[RowBatch]:
        """Cells as text; a row with too few or too many cells keeps only its axis."""
        for block in self.blocks():
            broken: list[pacsv.InvalidRow] = []

            def skip(row: pacsv.InvalidRow, broken: list[pacsv.InvalidRow] = broken) -> str:
                broken.append(row)
                return "skip" if len(broken) <= MOST_BROKEN else "error"

            try:
                rows = pacsv.read_csv(
                    io.BytesIO(_as_utf8(block)),
                    pacsv.ReadOptions(column_names=self.all_names, use_threads=False, block_size=2 * MOST_LINE_BYTES),
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
            yield self._with_broken(rows, broken)

    def _with_broken(self, rows: pa.Table, broken: Sequence[pacsv.InvalidRow]) -> RowBatch:
        """Rows with the broken ones, of too few or too many cells, in their places; row numbers count from 1."""
        if not broken:
            return RowBatch(rows)
        is_broken = np.zeros(rows.num_rows + len(broken), bool)
        is_broken[[row.number - 1 for row in broken]] = True
        placed = rows.take(pa.array(np.cumsum(~is_broken) - 1, mask=is_broken))
        if AXIS in rows.column_names:
            axes = pa.array([self._axis_of(row.text, row.actual_columns) for row in broken], pa.string())
            filled = pc.replace_with_mask(placed[AXIS].combine_chunks(), pa.array(is_broken), axes)
            placed = placed.set_column(placed.column_names.index(AXIS), AXIS, filled)
        return RowBatch(placed, [CellFault(row.number - 1, AXIS, _reason_of(row), "row_length") for row in broken])

    def _axis_of(self, line: str, cells: int) -> str | None:
        """Axis of a broken row, where its cell is complete and the header names it; else None."""
        place = list(self.all_names).index(AXIS)
        if cells <= place + 1:
            return None
        try:
            texts = next(csv.reader([line]), [])
        except csv.Error:
            return None
        return (texts[place] or None) if len(texts) > place + 1 else None

    @property
    def indices(self) -> Sequence[str]:
        return [name for place, name in enumerate(self.all_names) if INDEX.fullmatch(name) or not (place or name)]


class GzipCsvTable(CsvTable):
    """Table of CSV in a gzip file."""

    def open(self) -> BinaryIO:
        return cast(BinaryIO, gzip.open(self.path if self.content is None else io.BytesIO(self.content)))

    def read(self, file: BinaryIO, size: int) -> bytes:
        try:
            return super().read(file, size)
        except (OSError, EOFError, zlib.error) as error:
            raise FleetError(f"{self.path}: can’t be read as gzip: {error}") from None


def _reason_of(row: pacsv.InvalidRow) -> Sentence:
    """Reason of a row with too few or too many cells."""
    counts = {"found": str(row.actual_columns), "expected": str(row.expected_columns)}
    return Sentence(WRONG_LENGTH, {**counts, "row": cut(row.text)})


def _are_of_cells(characters: NDArray[np.uint8], marks: NDArray[np.intp]) -> bool:
    """True where every odd quote begins a cell or is the second of a doubled quote, and every even one ends a cell or
    is the first of a doubled quote."""
    opening, closing = marks[::2], marks[1::2]
    separators = np.frombuffer(b",\r\n", np.uint8)
    doubled = opening[1:] == closing[: len(opening) - 1] + 1
    begins = np.isin(characters[opening - 1], separators) | (opening == 0)
    ends = np.isin(characters[np.minimum(closing + 1, len(characters) - 1)], separators) | (
        closing == len(characters) - 1
    )
    begins[1:] |= doubled
    ends[: len(doubled)] |= doubled
    return bool(begins.all() and ends.all())


def _as_utf8(content: bytes) -> bytes:
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode(errors="replace").encode()
    return content


def _parsed(
    texts: pa.Array, column: InputColumn | None, target: pa.DataType
) -> tuple[pa.Array, list[tuple[int, Reason]]]:
    """Values of CSV cells, and the rows of invalid cells with the reasons."""
    if column is None or pa.types.is_string(target):
        broken = pc.fill_null(pc.match_substring(texts, REPLACED), False)
        return pc.if_else(broken, None, texts), [(int(row), NOT_UTF8) for row in np.flatnonzero(np.asarray(broken))]
    if is_list(target):
        kind = list[str | None] if column.kind == "string" else list[float | None]
        return _one_by_one(texts, msgspec.json.Decoder(kind).decode, target, no_list(column))
    texts = pc.ascii_trim_whitespace(texts)
    if column.kind == "boolean":
        is_flag = pc.match_substring_regex(texts, "^(true|false|0|1)$", ignore_case=True)
        wrong = np.flatnonzero(np.asarray(pc.fill_null(pc.invert(is_flag), False)))
        return pc.if_else(is_flag, texts, None).cast(target), [(int(row), NO_FLAG) for row in wrong]
    numbers = pc.match_substring_regex(texts, f"^({NUMBER.pattern})$", ignore_case=True)
    wrong = np.flatnonzero(np.asarray(pc.fill_null(pc.invert(numbers), False)))
    if len(wrong):
        texts = pc.if_else(numbers, texts, None)
    return texts.cast(target), [(int(row), NO_NUMBER) for row in wrong]


def no_list(column: InputColumn) -> Reason:
    """Reason for a cell that is no list."""
    return NO_TEXTS if column.kind == "string" else NO_NUMBERS


def _one_by_one(
    cells: pa.Array, parse: Any, target: pa.DataType, reason: Reason
) -> tuple[pa.Array, list[tuple[int, Reason]]]:
    values, wrong = [], []
    for row, cell in enumerate(cells.to_pylist()):
        try:
            values.append(None if cell is None else parse(cell))
        except (ValueError, RecursionError):
            values.append(None)
            wrong.append((row, reason))
    return pa.array(values, target), wrong
