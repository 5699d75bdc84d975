"""From the bytes of a file, or a text, to the cells of its sheets.

A file of kilobytes may expand to gigabytes: a service reads it in a process with limited memory and time. The sizes
that a file states are checked before reading, so that most such files get an error message.
"""

import base64
import codecs
import csv
import io
import json
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace

from hpn.installed import ExtraMissingError, require
from hpn.tables.cells import Figure, plain_number
from hpn.tables.heads import MOST_COLUMNS
from hpn.tables.inputs import Inputs
from hpn.tables.sheets import MOST_CELLS, Grid, RefusedError, Takes, grid_of, grids_of, too_many_cells
from hpn.tables.workbooks import MAGIC, OLD_MAGIC, sheets_of
from hpn.words.wording import N_, Sentence

OLD_WORKBOOK = N_("a workbook of this old format can’t be read: save it as XLSX or CSV")
LINES = N_("objects of JSON are no table of axes: save the table as CSV, XLSX, Parquet or Arrow")
PARQUET, ARROW, STREAM, GZIP = b"PAR1", b"ARROW1", b"\xff\xff\xff\xff", b"\x1f\x8b"
MOST_HEAD = 2_000_000
"""Characters of a text that are searched for the header and the first row."""

MOST_CELLS_IN_ALL = 4 * MOST_CELLS
"""Cells of all sheets, including blank ones that fill rows up to the widest."""


@dataclass(frozen=True, slots=True)
class TableBounds:
    """Limits for the table of a file: inputs that its columns may hold, its most rows, its longest text, and the test
    for tables that are taken unread.

    Without that test an object of JSON is an application. `numbers` are those of a text's lines for the user, from 1 on
    by default.
    """

    inputs: Inputs
    most_rows: int
    most_characters: int
    takes: Takes | None = None
    numbers: tuple[int, ...] | None = None


@dataclass(frozen=True, slots=True)
class Contents:
    """Contents of a file: cells of each sheet by each possible separator, or the reason why they can't be read.

    Without sheets: `suffix` names the format of a table that is taken unread, and `is_application` marks an object of
    JSON.
    """

    sheets: Mapping[str, tuple[Grid, ...] | Sentence] = field(default_factory=dict)
    text: str = ""
    suffix: str = ""
    is_application: bool = False
    problem: Sentence | None = None


def contents_of(content: bytes | str, bounds: TableBounds) -> Contents:
    """Contents of a file or a text; raises nothing but MemoryError, `problem` tells why it can't be read."""
    if isinstance(content, str):
        return _of_text(content, bounds)
    try:
        if content.startswith(OLD_MAGIC):
            raise RefusedError(OLD_WORKBOOK)
        if content.startswith(MAGIC):
            return Contents(_sheets(content))
        if content.startswith((PARQUET, ARROW, STREAM)):
            require("fleet")
            from hpn.tables import records  # Arrow takes half a second to import

            readers = {PARQUET: records.parquet, ARROW: records.arrow, STREAM: records.arrow_stream}
            reader = next(reader for mark, reader in readers.items() if content.startswith(mark))
            suffix, grid = reader(content, bounds.takes)
            return Contents({"": (grid,)}) if grid else Contents(suffix=suffix)
        if content.startswith(GZIP):
            return _of_gzip(content, bounds)
        text = tidied(text_of(content))
    except (RefusedError, ExtraMissingError) as refused:
        return Contents(problem=refused.sentence)
    return _of_text(text, bounds)


def _of_gzip(content: bytes, bounds: TableBounds) -> Contents:
    """Contents of a CSV file in gzip, unpacked only up to the longest text of a table; a table that is taken unread is
    recognised by its first lines.
    """
    try:
        unpacked = zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(content, 4 * bounds.most_characters + 4)
    except zlib.error:
        raise RefusedError(NO_TEXT) from None
    contents = _of_text(tidied(text_of(unpacked)), bounds)
    return replace(contents, suffix=".csv.gz") if contents.suffix else contents


def _of_text(text: str, bounds: TableBounds) -> Contents:
    try:
        if not text.lstrip().startswith("{"):
            if bounds.takes is None and (phases := _phases(text, bounds)):
                return Contents({"": (phases,)}, text)
            if bounds.takes and _is_taken_csv(text, bounds.takes):
                return Contents(suffix=".csv")
            grids = grids_of(text, bounds.most_rows, bounds.most_characters, bounds.numbers)
            return Contents({"": tuple(grids)}, text)
        if bounds.takes is None:
            return Contents(text=text, is_application=True)
        raise RefusedError(LINES)
    except RefusedError as refused:
        return Contents(text=text if len(text) <= bounds.most_characters else "", problem=refused.sentence)


def _phases(text: str, bounds: TableBounds) -> Grid | None:
    """Table of phases from a JSON list of objects with plain values; None for any other text."""
    if not text.lstrip().startswith("[") or len(text) > bounds.most_characters:
        return None
    try:
        listed = json.loads(text, parse_float=_figure, parse_int=_figure)
    except (ValueError, RecursionError):
        return None
    if not all(isinstance(each, dict) for each in listed) or not 0 < len(listed) <= bounds.most_rows:
        return None
    names = list(dict.fromkeys(name for each in listed for name in each))
    values = [each.get(name) for each in listed for name in names] if len(names) <= MOST_COLUMNS else [()]
    if not all(value is None or isinstance(value, str) for value in values):
        return None
    return grid_of([names, *([each.get(name) or "" for name in names] for each in listed)])


def _figure(number: str) -> str:
    plain = plain_number(number, ".")
    return number if plain is None else Figure(plain)


def _sheets(content: bytes) -> dict[str, tuple[Grid, ...] | Sentence]:
    contents = dict[str, tuple[Grid, ...] | Sentence]()
    room = MOST_CELLS_IN_ALL
    for name, sheet in sheets_of(content).items():
        try:
            grid = sheet.grid()
            room -= len(grid.rows) * grid.width
            contents[name] = (grid,) if room >= 0 else too_many_cells().sentence
        except RefusedError as refused:
            contents[name] = refused.sentence
    return contents


def _is_taken_csv(text: str, takes: Takes) -> bool:
    rows = csv.reader(io.StringIO(text[:MOST_HEAD], newline=""))
    try:
        first, second = dict.fromkeys(next(rows, [])), next(rows, [])
    except csv.Error:
        return False
    cells = dict(zip(first, second, strict=False))
    return takes(list(first), cells.get("torque_Nm", "").lstrip().startswith("["))


# --- Text of a file, in the encoding that it is written in ------------------------------------------------------------

NO_TEXT = N_("the file is not text: save the sheet as CSV, or copy its cells")
WRONG_BYTE = N_(
    "the file is marked as {encoding}, but in line {line} the byte {byte}, number {place} of the file, is not valid "
    "in it: save the sheet as CSV again"
)
MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16: this mark begins with that of UTF-16
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks, and the encoding that each announces for the bytes behind it."""


def text_of(content: bytes) -> str:
    """Text in the encoding of its byte order mark, else UTF-8, else Windows-1252 as spreadsheets write CSV.

    Raises RefusedError, which names the place of a byte that is invalid in the marked encoding.
    """
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _marked(content.removeprefix(mark), encoding, len(mark))
    if b"\x00" not in content:  # a picture, or another file of numbers
        for encoding in ("utf-8", "cp1252"):
            with suppress(UnicodeDecodeError):
                return content.decode(encoding)
    raise RefusedError(NO_TEXT)


def _marked(content: bytes, encoding: str, mark: int) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = 1 + content[: error.start].decode(encoding).count("\n")
        raise RefusedError(
            WRONG_BYTE,
            encoding=encoding.upper(),
            line=line,
            byte=f"0x{content[error.start]:02x}",
            place=mark + error.start + 1,
        ) from None


def tidied(text: str) -> str:
    """A text without a leading byte order mark, and with `\n` at the ends of its lines."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n")


# --- A file that a form carries along ---------------------------------------------------------------------------------

MOST_CARRIED = 32_000_000


def packed(content: bytes) -> str:
    """A file as a hidden field, for a form that can't send it again."""
    return base64.b64encode(zlib.compress(content)).decode()


def unpacked(packed: bytes) -> bytes:
    """The file of such a hidden field; empty for an invalid field."""
    with suppress(ValueError, zlib.error):
        unpacking = zlib.decompressobj()
        content = unpacking.decompress(base64.b64decode(packed, validate=True), MOST_CARRIED)
        return content if unpacking.eof else b""
    return b""
