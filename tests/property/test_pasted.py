"""A pasted table says what it said in the spreadsheet, or asks; it is never silently something else."""

import csv
import io
import re
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hpn.application import DutyCycle
from hpn.application.input_fields import PHASE_FIGURES
from hpn.application.phase import Phase
from hpn.tables.cells import DECIMALS, harmless
from hpn.tables.cells import Decimal as Mark
from hpn.tables.columns import Choices
from hpn.tables.cycles import read_text
from hpn.tables.table import Table
from hpn.web.pages.transfer import write_table
from tests.property.draw import NAMES

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False).map(lambda value: round(value, 4))
PEAKS = st.none() | st.floats(1e5, 1e6).map(lambda value: round(value, 4))
PHASES = st.builds(
    Phase,
    torque_Nm=st.floats(-1e5, 1e5, allow_subnormal=False).map(lambda value: round(value, 4)),
    speed_rpm=st.floats(1, 1e4).map(lambda value: round(value, 3)),
    duration_s=st.floats(0.001, 1e4).map(lambda value: round(value, 3)),
    radial_N=st.none() | NUMBERS,
    axial_N=st.none() | NUMBERS,
    peak_torque_Nm=PEAKS,
    peak_speed_rpm=PEAKS,
    rms_torque_Nm=st.none() | st.just(0.0),
    name=st.none() | st.sampled_from(NAMES),
)
CYCLES = st.lists(PHASES, min_size=1, max_size=8).map(lambda phases: DutyCycle(phases=tuple(phases)))


@given(CYCLES, st.sampled_from(DECIMALS))
def test_a_written_table_reads_back_once_what_it_leaves_open_is_said(cycle: DutyCycle, decimal: Mark) -> None:
    text = write_table(cycle, decimal)
    table = read_text(text, Choices(decimal=decimal, last="phase"))
    assert not table.questions
    wanted = [tuple(getattr(phase, name) for name in PHASE_FIGURES) for phase in cycle.load_phases]
    assert phases_of(table) == wanted
    names = [harmless(phase.name) or "" for phase in cycle.load_phases]
    assert table.names == (tuple(names) if any(names) else ())


def phases_of(table: Table) -> list[tuple[float | None, ...]]:
    return [tuple(float(cell) if cell else None for cell in phase) for phase in table.phases]


# --- Any way of writing a cycle ---------------------------------------------------------------------------------------

LOCALES = {
    "en": (".", ","),
    "de": (",", "."),
    "de-CH": (".", "’"),
    "fr": (",", "\u202f"),
    "it": (",", "."),
    "sv": (",", "\u00a0"),
    "pl": (",", " "),
    "hu": (",", "\u2009"),
}
HEADINGS = {
    "T": ("Torque", "Drehmoment", "T", "Couple", "Coppia", "Par", "Vridmoment"),
    "n": ("Speed", "Drehzahl", "n", "Vitesse", "Velocità", "Velocidad", "Varvtal"),
    "t": ("Duration", "Zeit", "t", "Durée", "Time", "Dauer", "Tid"),
}
UNITS: dict[str, dict[str, Decimal | int]] = {
    "T": {
        **{"Nm": 1, "kNm": 1000, "N·m": 1, "Nmm": Decimal("0.001")},
        **{"lbf·in": Decimal("0.1129848290276167"), "kg·cm": Decimal("0.0980665")},
    },
    "n": {"rpm": 1, "1/min": 1, "min-1": 1, "turns/s": 60, "krpm": 1000, "°/s": 1 / Decimal(6)},
    "t": {"s": 1, "ms": Decimal("0.001"), "min": 60, "sec": 1, "d": 86_400},
}
"""Spellings of units, and how many of the wire's each is."""

LETTERS = "Tnt"
SHIFTS = {"none": 0, "index": 1, "names": 1}
numbers = st.builds(lambda digits, places: Decimal(digits).scaleb(-places), st.integers(1, 99_999), st.integers(0, 4))


@dataclass(frozen=True)
class Writing:
    """Notation of a cycle: locale, separators and units."""

    locale: str
    separator: str
    grouped: bool
    headings: int
    units: tuple[str, str, str]
    place_of_units: str
    order: tuple[int, ...]
    first: str
    last: str
    instants: bool
    turned: bool
    padded: bool
    above: int = 0
    marked: bool = False
    tail: bool = False
    clock: bool = False


WRITINGS = st.builds(
    Writing,
    locale=st.sampled_from(sorted(LOCALES)),
    separator=st.sampled_from(["\t", ";", ",", " ", "   "]),
    grouped=st.booleans(),
    headings=st.integers(-1, 6),
    units=st.tuples(*(st.sampled_from(sorted(UNITS[name])) for name in LETTERS)),
    place_of_units=st.sampled_from(["none", "none", "header", "row", "cells"]),
    order=st.permutations(range(3)).map(tuple),
    first=st.sampled_from(["none", "none", "index", "names"]),
    last=st.sampled_from(["none", "none", "labelled", "sum", "time"]),
    instants=st.sampled_from([False, False, False, True]),
    turned=st.sampled_from([False, False, True]),
    padded=st.booleans(),
    above=st.sampled_from([0, 0, 1, 12]),
    marked=st.sampled_from([False, False, True]),
    tail=st.sampled_from([False, False, True]),
    clock=st.sampled_from([False, False, True]),
)
ABOVE = ("Project 7", "Operator: M. Muster", "Range 200 Nm", "State warm, dry")
"""Lines about a table, as loggers write them above it."""


def written(rows: list[tuple[Decimal, ...]], how: Writing) -> tuple[str, list[tuple[Decimal, ...]]]:
    """The text of a cycle, and the cycle in units of the wire."""
    units = how.units if how.place_of_units != "none" else ("Nm", "rpm", "s")
    units = (*units[:2], "s") if how.clock else units
    wire = [
        tuple(value * UNITS[name][unit] for name, value, unit in zip(LETTERS, row, units, strict=True)) for row in rows
    ]
    order = how.order if how.headings >= 0 or how.place_of_units != "none" else (0, 1, 2)
    times = list(accumulate(row[2] for row in rows)) if how.instants else [row[2] for row in rows]
    body = [[*row[:2], time] for row, time in zip(rows, times, strict=True)]
    cells = [[_cell(k, row[k], units[k], how) for k in order] for row in body]
    cells = [[*_first(how, number), *row] for number, row in enumerate(cells, start=1)]
    shift = SHIFTS[how.first]
    if how.last != "none":
        totals = [_cell(k, sum((row[k] for row in rows), Decimal(0)), units[k], how) for k in range(3)]
        sums = [totals[k] if k == 2 or how.last == "sum" else "" for k in order]
        label = ["Total"] if how.last == "labelled" else [""]
        cells.append([*label[:shift], *sums])
    head = _head(how, units, order)
    table = [*head, *cells]
    if how.turned and head:  # bare numbers are rows of phases, as the page says
        table = [list(column) for column in zip(*table, strict=True)]
    text = _text(table, how)
    above = "".join(f"{ABOVE[k % len(ABOVE)]}\n" for k in range(how.above))
    if how.tail and how.separator.strip():
        text = "".join(line.rstrip("\r\n") + how.separator + "\n" for line in text.splitlines())
    return f"{above}{'# ' if how.marked and how.headings >= 0 else ''}{text}", wire


def _cell(k: int, value: Decimal, unit: str, how: Writing) -> str:
    if LETTERS[k] != "t" or not how.clock:
        return _number(value, how) + _behind(unit, how)
    whole, _, fraction = f"{value:f}".partition(".")
    minutes, seconds = divmod(int(whole), 60)
    mark = f"{LOCALES[how.locale][0]}{fraction}" if fraction else ""
    return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}{mark}"


def _number(value: Decimal, how: Writing) -> str:
    decimal, group = LOCALES[how.locale]
    text = f"{value:,f}" if how.grouped else f"{value:f}"
    return text.replace(",", "\0").replace(".", decimal).replace("\0", group)


def _behind(unit: str, how: Writing) -> str:
    return f" {unit}" if how.place_of_units == "cells" else ""


def _first(how: Writing, number: int) -> list[str]:
    return {"none": [], "index": [str(number)], "names": [f"phase {chr(96 + number)}"]}[how.first]


def _head(how: Writing, units: tuple[str, ...], order: tuple[int, ...]) -> list[list[str]]:
    before = {"none": [], "index": ["Nr."], "names": ["Phase"]}[how.first]
    rows = []
    if how.headings >= 0:
        ends = [f" [{units[k]}]" if how.place_of_units == "header" else "" for k in order]
        names = [HEADINGS[LETTERS[k]][how.headings] for k in order]
        if how.instants:  # a table whose points in time are called durations can't be told from one of durations
            names = ["t" if k == 2 else name for k, name in zip(order, names, strict=True)]
        rows.append([*before, *(name + end for name, end in zip(names, ends, strict=True))])
    if how.place_of_units == "row" or (how.place_of_units == "header" and how.headings < 0):
        rows.append([*["-"][: len(before)], *(units[k] for k in order)])
    return rows


def _text(table: list[list[str]], how: Writing) -> str:
    if how.separator.strip() or how.separator == "\t":
        out = io.StringIO()
        csv.writer(out, delimiter=how.separator, lineterminator="\r\n" if how.padded else "\n").writerows(table)
        return out.getvalue()
    return "\n".join(how.separator.join(row) for row in table)


@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=5), WRITINGS)
def test_a_cycle_in_any_writing_is_read_exactly_or_asked_about_or_refused(
    rows: list[tuple[Decimal, ...]], how: Writing
) -> None:
    text, wire = written(rows, how)
    table = read_text(text)
    if not table.whole:
        assert table.problem or table.questions
        return
    wanted = [pytest.approx([float(value) for value in row], rel=1e-9) for row in wire]
    assert [list(phase[:3]) for phase in phases_of(table)] == wanted, text


@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=5), WRITINGS)
def test_answers_to_what_is_asked_lead_to_the_cycle(rows: list[tuple[Decimal, ...]], how: Writing) -> None:
    if how.headings < 0 or how.place_of_units == "row" or how.last == "time":
        return
    text, wire = written(rows, how)
    mark = LOCALES[how.locale][0]
    times = "ends" if how.instants else "durations"
    last = "sum" if how.last == "sum" else "phase"
    table = read_text(text, Choices(decimal=mark, times=times, last=last))
    if table.whole and not (how.instants and not table.choice("times")) and (how.last != "sum" or table.choice("last")):
        wanted = [pytest.approx([float(value) for value in row], rel=1e-9) for row in wire]
        assert [list(phase[:3]) for phase in phases_of(table)] == wanted, text


UNKNOWN = ("Motor speed", "Motormoment", "Drehzahl n1", "Temp", "Position", "I_eff")


@given(
    st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=5),
    WRITINGS,
    st.sampled_from(LETTERS),
    st.sampled_from(UNKNOWN),
)
def test_a_column_under_a_name_that_nobody_knows_is_asked_whatever_its_unit_says(
    rows: list[tuple[Decimal, ...]], how: Writing, letter: str, name: str
) -> None:
    how = replace(how, headings=max(how.headings, 0))
    known = HEADINGS[letter][how.headings] if not (how.instants and letter == "t") else "t"
    text, _ = written(rows, how)
    lines = text.splitlines()
    head = min(how.above, len(lines) - 1)
    if known not in text or how.turned or not (how.separator.strip() or how.separator == "\t"):
        return
    lines[head] = re.sub(rf"(?<![^\W_]){re.escape(known)}(?![^\W_])", name, lines[head], count=1)
    table = read_text("\n".join(lines))
    assert not any(column.role in set(LETTERS) and name in column.heading for column in table.columns), lines
    assert not table.whole, lines


@given(st.text(max_size=200))
def test_any_text_is_read_or_asked_about_or_refused_with_a_reason(text: str) -> None:
    table = read_text(text)
    assert (table.problem is not None) + bool(table.questions) + table.whole == 1


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("1;2;3\n" * 10_002, "more than 10000 rows"),
        ("1;" * 200_000, "more than"),
        ("1" * 1_000_001, "too long"),
        ('"' + "1" * 200_000 + '";2;3', "longer than any number"),
        ("1\n" * 400_000, "more than"),
    ],
)
def test_what_is_larger_than_any_cycle_is_refused(text: str, part: str) -> None:
    problem = read_text(text).problem
    assert problem is not None
    assert part in problem.text
