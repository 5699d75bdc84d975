"""Cost, not only bytes: whatever a file stands for, reading it ends within its bounds, and the reading is small.

Most such files are refused with a sentence that says what there is too much of; the rest meet the bounds of the
process.
"""

import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import msgspec
import pytest

from hpn.tables.files import TableBounds
from hpn.tables.reading import Reading, reading_of
from hpn.tables.sheets import MAXIMUM_CHARACTERS
from hpn.tables.table import Table
from hpn.tables.workbooks import LONGEST_NAME, sheets_of
from hpn.web.axis_tables import BOUNDS as AXES
from hpn.web.door.beside import EndedError, ProcessBeside
from hpn.web.door.pools import FILE_BOUNDS
from hpn.web.pages.paste import BOUNDS as PHASES
from hpn.words.wording import Sentence
from tests.fuzz import cells as of_cells
from tests.fuzz.costly import OBJECTS, PACKED, TABLES, TEXTS, WORKBOOKS, made

SMALL_BYTES = 100_000
"""Of what the issue of cost is about; some that were reported are larger."""

LARGER = {"attributes", "a cell in the last column of each row", "a long text in each cell"} | {
    *("a text as long as may be in each cell", "14,000 rows, each with a key of its own", "objects in one another"),
    *("Parquet of 10⁸ rows", "Parquet of 10⁷ phases", "Parquet of 10⁷ rows as the command names them"),
    *("Parquet of many columns", "Parquet of many groups of rows", "Arrow of columns", "columns", "header rows"),
}
SHORT = {"a workbook of brackets", "a workbook of ratios", "gzip of 131,000 brackets", "entities in one another"} | {
    *("Parquet with ratios of blanks", "a ratio of blanks", "lines in quotes"),
    *("times on a clock", "headings as long as any is read", "a sheet with a long name", "UTF-16 of brackets"),
}
"""Files of cells that the short form has as well."""

SLOW = {"phonetic parts", "cells by the row", "inline texts", "formulas", "elements in one another", "attributes"} | (
    {*of_cells.WORKBOOKS, *of_cells.TABLES, *of_cells.TEXTS, *of_cells.PACKED} - SHORT
)
"""Files that take some seconds within the limits, left to the long form."""

MOST_SENT = 20_000_000
"""Bytes that come back to the service at most."""

FOR_PHASES = {**WORKBOOKS, **TABLES, **TEXTS, **PACKED}
FOR_AXES = {**of_cells.WORKBOOKS, **TABLES, **TEXTS, **PACKED, **OBJECTS}
CASES = [
    pytest.param(name, wanted, marks=[pytest.mark.soak] if name in SLOW else [], id=f"{name}, for {of}")
    for names, wanted, of in ((FOR_PHASES, PHASES, "phases"), (FOR_AXES, AXES, "axes"))
    for name in names
]


@pytest.fixture(scope="module")
def beside() -> Iterator[ProcessBeside]:
    """A process like that of the service."""
    beside = ProcessBeside(FILE_BOUNDS)
    yield beside
    beside.close()


def peak_of(beside: ProcessBeside) -> int:
    """Most memory that the process has had, in bytes; 0 where it has ended."""
    process = beside._process
    status = Path(f"/proc/{process.pid if process else 0}/status")
    return int(status.read_text().partition("VmHWM:")[2].split()[0]) * 1024 if status.exists() else 0


@pytest.mark.parametrize(("name", "bounds"), CASES)
def test_a_file_is_read_or_refused_within_its_bounds(beside: ProcessBeside, name: str, bounds: TableBounds) -> None:
    content = made(name)
    assert len(content) <= SMALL_BYTES or name in LARGER

    start = time.monotonic()
    try:
        reading = beside.call(partial(reading_of, content, bounds), threading.Event())
    except EndedError as ended:
        assert ended.is_excess, ended
        reading = Reading(table=Table(problem=Sentence("too large")))

    assert time.monotonic() - start < FILE_BOUNDS.seconds + 10
    assert peak_of(beside) < FILE_BOUNDS.memory_bytes * 1.3  # code and what is mapped come on top
    assert len(msgspec.msgpack.encode(reading)) < MOST_SENT


def problem_of(reading: Reading) -> str:
    """Why there is no table, in English; blank where there is one."""
    return reading.table.problem.text if reading.table and reading.table.problem else ""


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("1,500,000 formats", "too many styles"),
        ("fonts", "too many styles"),
        ("rich texts", "too many texts"),
        ("one rich text of very many parts", "too many texts"),
        ("shared strings", "too many texts"),
        ("empty rows", "too many rows"),
        ("empty cells", "too many cells"),
        ("merged cells", "too many merged cells"),
        ("defined names", "too many names"),
        ("very many parts", "too many parts"),
        ("rules of conditional formats", "too many conditional formats"),
        ("a long text in each cell", "a cell is longer"),
        ("a text as long as may be in each cell", "more than 4000000 characters"),
        ("Parquet of 10⁸ rows", "more than 150000 cells"),
        ("Parquet with a long text", "take more than 64 MB"),
        ("Arrow of 20 columns and 10⁷ rows", "more than 150000 cells"),
        ("Arrow of nothing, 2⁴⁰ times", "more than 150000 cells"),
        ("14,000 rows, each with a key of its own", "no table of axes"),
    ],
)
def test_a_refusal_says_what_there_is_too_much_of(name: str, words: str) -> None:
    assert words in problem_of(reading_of(made(name), AXES))


def test_a_cell_far_away_is_read_like_any_other() -> None:
    content = made("a cell in the last row of 20 sheets")
    assert len(reading_of(content, PHASES).sheets) == 20
    grid = sheets_of(content)["S20"].grid()
    assert (grid.rows, grid.numbers) == ((("1",),), (1048576,))


def test_a_sheet_has_a_short_name() -> None:
    assert [len(name) for name in reading_of(made("a sheet with a long name"), PHASES).sheets] == [LONGEST_NAME]


def test_long_cells_are_not_kept_in_mind() -> None:
    from hpn.tables import cells, headings

    record = (cells._entry, cells._seconds_of, cells._moment_of, headings._heading_of)
    before = [each.cache_info().currsize for each in record]
    for number in range(10):
        cell = f"{number}" * 20_000
        assert not cells.is_number(cell) and not headings.heading_of(cell).kind
        assert cells.seconds_of(cell) is None and cells.moment_of(cell) is None
    assert before == [each.cache_info().currsize for each in record]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.soak] if name in SLOW else []) for name in TEXTS]
)
def test_text_of_the_largest_size_is_read_or_refused(beside: ProcessBeside, name: str) -> None:
    part = made(name)
    content = (part * (MAXIMUM_CHARACTERS // len(part) + 1))[:MAXIMUM_CHARACTERS]

    reading = beside.call(partial(reading_of, content, PHASES), threading.Event())

    assert len(msgspec.msgpack.encode(reading)) < MOST_SENT
