"""Work in proportion: a cell of 131,072 characters, whatever they are and wherever it stands, costs no more than one of
half as many but for what goes through a text once.

Counted in lines that are run, which no busy machine changes, and in characters that patterns are given at once: a line
goes through a text once at most. A text whose characters part cells has a row or a cell for each.
"""

import ast
import itertools
import sys
from collections.abc import Callable, Iterator
from functools import partial
from html import escape
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import hpn
from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.axes import read_axes
from hpn.tables.cells import harmless, tidy
from hpn.tables.columns import Choices
from hpn.tables.cycles import read_grids
from hpn.tables.files import TableBounds
from hpn.tables.headings import LONGEST_WRITTEN, parts_of
from hpn.tables.numbers import Notation, read_value, to_fields
from hpn.tables.reading import reading_of
from hpn.tables.sheets import LONGEST_TEXT, Grid, grid_of
from hpn.tables.table import Table
from hpn.web.axis_tables import BOUNDS as AXES
from hpn.web.pages.paste import BOUNDS as PHASES
from hpn.words.patterns import Pattern
from hpn.words.reader import Reader
from tests.fuzz.formats import workbook

ROOM = Path(hpn.__file__).parent
SIGNS = "[](){}<>\"'-−.,;:/|\\°_#=%*+^ \t5aexiσ1ª½²"
FEW = '[( 5x"-.°:/'
"""Of triples."""

REPORTED = (
    "[",
    "(",
    "i ",
    ": ",
    ":1",
    "1 1",
    "5 x",
    "1a",
    "/ ",
    "_a",
    "a ",
    "# ",
    "-|",
    '="',
    "'1",
    "1e1",
    "max ",
    "in ",
)
LENGTHS = (LONGEST_TEXT // 2, LONGEST_TEXT)
SAME = 40
"""Lines more than for half the length: a text may end in the middle of what is repeated, and then be another."""

LONGEST_GIVEN = LONGEST_WRITTEN
"""Characters that a pattern is given at most."""

MOST_GROWTH = 2.1
"""Of lines where a text has a cell for each of its characters: twice as many, and what is run once."""


def kinds() -> list[str]:
    """Characters, pairs and triples that fill a cell."""
    pairs = map("".join, itertools.product(SIGNS, repeat=2))
    triples = map("".join, itertools.product(FEW, repeat=3))
    return list(dict.fromkeys([*SIGNS, *REPORTED, *pairs, *triples]))


def few_kinds() -> list[str]:
    """Some of them."""
    return list(dict.fromkeys([*SIGNS, *REPORTED, *kinds()[len(SIGNS) + len(REPORTED) :: 300]]))


PHASE, AXIS = ["40", "250", "0.3"], ["A", "40", "250", "0.3", "5", "14", ""]
HEAD = ["T [Nm]", "n [rpm]", "t [s]"]
AXIS_HEAD = ["Achse", "T [Nm]", "n [rpm]", "t [s]", "Ratio", "Size", "Lebensdauer Getriebe"]
CYCLES: dict[str, Callable[[str], list[list[str]]]] = {
    "a heading": lambda text: [[text, "n", "t"], PHASE],
    "a heading more": lambda text: [[*HEAD, text], [*PHASE, "1"]],
    "a heading behind a name": lambda text: [["T", "n", "Dauer " + text[6:]], PHASE],
    "a row of units": lambda text: [["T", "n", "t"], ["Nm", "rpm", text], PHASE],
    "a cell": lambda text: [HEAD, ["40", "250", text]],
    "a number and more": lambda text: [HEAD, ["40", "250", "5" + text[2:] + "x"]],
    "a name": lambda text: [["Name", *HEAD], [text, *PHASE], ["b", *PHASE]],
    "a title": lambda text: [[text, "", ""], HEAD, PHASE],
    "a title between": lambda text: [HEAD, PHASE, [text, "", ""], PHASE],
    "a sum": lambda text: [HEAD, PHASE, ["Summe " + text[6:], "40", "250"]],
}
MACHINES: dict[str, Callable[[str], list[list[str]]]] = {
    **{
        f"a cell below {heading}": lambda text, place=place: [  # type: ignore[misc]
            AXIS_HEAD,
            [*AXIS[:place], "5" + text[2:] + "x", *AXIS[place + 1 :]],
        ]
        for place, heading in enumerate(AXIS_HEAD)
    },
    "a heading of a machine": lambda text: [[*AXIS_HEAD, text], [*AXIS, "1"]],
    "a heading that begins well": lambda text: [[*AXIS_HEAD, "Not-Halt-Moment " + text[16:]], [*AXIS, "1"]],
}
SKIPPING = Choices(rest="skip")


def steps(work: Callable[[], Any], given: list[int]) -> int:
    """Lines of the program that work runs."""
    count = 0

    def trace(frame: FrameType, event: str, argument: Any) -> Any:
        nonlocal count
        if not frame.f_code.co_filename.startswith(str(ROOM)):
            return None
        count += event == "line"
        return trace

    given.clear()
    before = sys.gettrace()
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(before)
    return count


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Characters that patterns were given, one number for each time."""
    lengths: list[int] = []

    class Watched:
        def __init__(self, compiled: Any) -> None:
            self._compiled = compiled

        def __getattr__(self, name: str) -> Any:
            method = getattr(self._compiled, name)

            def called(*arguments: Any) -> Any:
                lengths.append(len(arguments[-1]))
                return method(*arguments)

            return called

    for pattern in patterns():
        monkeypatch.setattr(pattern, "_compiled", Watched(pattern._compiled))
    return lengths


def patterns() -> Iterator[Pattern]:
    """All that modules have."""
    for name, module in list(sys.modules.items()):
        if name.startswith("hpn."):
            for value in vars(module).values():
                yield from (
                    each for each in (value.values() if isinstance(value, dict) else [value]) if type(each) is Pattern
                )


def written(text: str, unit: int) -> str:
    """A text over and over again, so many characters of it."""
    return (text * (unit // len(text) + 1))[:unit]


def read(place: str, text: str) -> Table:
    """Reading of a table with a text in a place."""
    if place in MACHINES:
        return read_axes(_grid(MACHINES[place](text)), AXIS_INPUTS, SKIPPING, tuple(AXIS_INPUTS.units))
    return read_grids([_grid(CYCLES[place](text))], SKIPPING)


def _grid(rows: list[list[str]]) -> Grid:
    return grid_of([tidy(cell) for cell in row] for row in rows)


@pytest.mark.parametrize("place", [*CYCLES, *MACHINES])
def test_a_long_cell_costs_no_more_steps_than_one_of_half_its_length(place: str, soak: bool, given: list[int]) -> None:
    for kind in kinds() if soak else few_kinds():
        counts = [steps(partial(read, place, written(kind, length)), given) for length in LENGTHS]
        assert counts[1] <= counts[0] + SAME, (kind, counts)
        assert max(given, default=0) <= LONGEST_GIVEN, kind


@pytest.mark.parametrize("bounds", [PHASES, AXES], ids=["cycle", "machine"])
def test_a_text_and_a_workbook_of_such_cells_cost_twice_as_much_at_most(
    bounds: TableBounds, soak: bool, given: list[int]
) -> None:
    for kind in few_kinds() if soak else [*SIGNS, *REPORTED][::5]:
        for make in (as_text, as_workbook):
            counts = []
            for length in LENGTHS:
                content = make(written(kind, length))
                counts.append(steps(partial(reading_of, content, bounds), given))
            assert counts[1] <= MOST_GROWTH * counts[0], (kind, counts)
            assert max(given, default=0) <= LONGEST_GIVEN, kind


def as_text(text: str) -> str:
    """A text with a long one as heading and as cell."""
    return f"T [Nm]\t{text}\tn [rpm]\tt [s]\n40\t5{text}x\t250\t0.3\n"


def as_workbook(text: str) -> bytes:
    """The same as a workbook."""
    message = "".join(
        f'<c t="inlineStr"><is><t>{escape(cell)}</t></is></c>' for cell in as_text(text).split("\n")[0].split("\t")
    )
    return workbook(f"<row>{message}</row><row><c><v>40</v></c><c><v>1</v></c><c><v>250</v></c><c><v>1</v></c></row>")


def test_a_long_text_in_a_field_costs_no_more_steps(given: list[int]) -> None:
    def take(text: str) -> None:
        for marker in ("", "de.SI"):
            entry = Notation({"written": marker}).entry(text, "Nm")
            to_fields([(entry, "Nm")], Reader("de"), marker or None)
            for kind in ("number", "whole", "text", "flag"):
                read_value(entry, kind)
        harmless(f"={text}")

    for kind in few_kinds():
        counts = [steps(partial(take, written(kind, length)), given) for length in LENGTHS]
        assert counts[1] <= counts[0] + SAME, (kind, counts)
        assert max(given, default=0) <= LONGEST_GIVEN, kind


def test_no_pattern_over_cells_is_without_a_bound() -> None:
    """Modules of tables, and those of words that look at what a cell says, have no patterns but bounded ones."""
    looked_at = [*(ROOM / "tables").glob("*.py"), ROOM / "words/spellings.py", ROOM / "words/units.py"]
    for path in looked_at:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                assert "re" not in [name.name for name in node.names], path
            if isinstance(node, ast.ImportFrom) and node.module == "re":
                assert all(name.name.isupper() for name in node.names), path
    assert all(pattern.longest <= LONGEST_GIVEN for pattern in patterns())


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("Drehzahl [1/min]", ("Drehzahl", "1/min")),
        ("Drehzahl\n[1/min]", ("Drehzahl", "1/min")),
        ("Moment (Abtrieb) (Nm)", ("Moment Abtrieb", "Nm")),
        ("Moment , { Nm }", ("Moment", "Nm")),
        ("[Nm]", ("", "Nm")),
        ("Moment [Nm] max", ("Moment max", "Nm")),
        ("Moment ]", ("Moment ]", "")),
    ],
)
def test_a_unit_in_brackets_is_parted_from_the_name_that_keeps_other_words_in_brackets(
    text: str, parts: tuple[str, str]
) -> None:
    assert parts_of(text) == parts
