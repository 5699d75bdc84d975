"""No end of a block, a batch or a slice changes an answer: each kind of fault is moved over every border."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hpn.catalogue import Catalogue
from hpn.fleet import csv_tables, run, tables
from hpn.fleet.gathering import axes_of
from hpn.fleet.opened import open_axes
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from tests.fleet.tables import Row, read, write

AXES, PHASES = 5, 3
ROWS = AXES * PHASES
SIZES = (1, 2, 3, 7)
LINE_BYTES = 70

Change = Callable[[list[Row], int], Any]


def _row(axis: int, phase: int, *, is_list: bool) -> Row:
    cells: Row = {"torque_Nm": 40.0, "speed_rpm": 250.0, "duration_s": phase + 1.0}
    return {"axis": f"a{axis}", **{name: [cell] * 2 if is_list else cell for name, cell in cells.items()}}


def _sound(form: str) -> list[Row]:
    places = [(place, 0) for place in range(ROWS)] if form == "list" else [divmod(p, PHASES) for p in range(ROWS)]
    return [_row(axis, phase, is_list=form == "list") for axis, phase in places]


def _lines(rows: list[Row]) -> list[str]:
    return [",".join(_csv(cell) for cell in row.values()) for row in rows]


def _csv(cell: Any) -> str:
    return f'"{json.dumps(cell)}"' if isinstance(cell, list) else str(cell)


def _cell(name: str, value: Any) -> Callable[[Row], Row]:
    return lambda row: {**row, name: value}


OF_ROWS: dict[str, Callable[[Row], Row]] = {
    "no axis": _cell("axis", None),
    "another axis": _cell("axis", "other"),
    "the first axis again": _cell("axis", "a0"),
    "the last axis too early": _cell("axis", "a4"),
    "no torque": _cell("torque_Nm", None),
    "a name that is too long": _cell("axis", "n" * 1001),
    "no sound number": lambda row: {**row, "duration_s": [-1.0, 1.0] if isinstance(row["duration_s"], list) else -1.0},
}
OF_LINES: dict[str, Callable[[str], str]] = {
    "a line cut in its name": lambda line: line[:2],
    "a line cut behind its name": lambda line: line[: line.index("a") + 16],
    "a line without anything": lambda line: ",,",
    "a quote that nothing closes": lambda line: line.replace("250", '"250', 1),
    "a line with more": lambda line: line + ",9",
    "an empty line": lambda line: "",
    "no number": lambda line: line.replace("250", "2 50"),
    "a quote within a cell": lambda line: line.replace("40", '4"0', 1),
    "two quotes within a cell": lambda line: line.replace("40", '4""0', 1),
    "bytes that are no text": lambda line: line.replace("a", "\udcff", 1),
}


@pytest.fixture
def cut(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Makes blocks, batches and slices as small as wanted."""

    def into(size: int) -> None:
        for module, name in ((tables, "BATCH_AXES"), (tables, "BATCH_PHASES"), (run, "SLICE_AXES")):
            monkeypatch.setattr(module, name, size)
        monkeypatch.setattr(csv_tables, "BLOCK_BYTES", size * LINE_BYTES)

    return into


def axes(path: Path) -> list[Any]:
    """Axes of a file with their phases, and what is wrong with them, or with the file."""
    result = list[Any]()
    try:
        for batch in axes_of(open_axes(path)):
            reasons: list[Any] = [[] for _ in range(batch.rows.num_rows)]
            for fault in batch.faults:
                reasons[fault.row].append((fault.column, fault.reason))
            result += [(*row.values(), notice) for row, notice in zip(batch.rows.to_pylist(), reasons, strict=True)]
    except FleetError as error:
        return [str(error)]
    return result


@pytest.fixture
def answers(tmp_path: Path, catalogue: Catalogue) -> Callable[..., Any]:
    """Sizes a file: answers and rejected rows."""

    def run(path: Path) -> Any:
        order = Order(path, tmp_path / "out.parquet", rejected=tmp_path / "rejected.parquet")
        size_fleet(order, catalogue)
        return read(order.answers), read(tmp_path / "rejected.parquet")

    return run


@pytest.mark.parametrize("form", ["long", "list"])
@pytest.mark.parametrize("fault", OF_LINES)
def test_a_damaged_line_is_told_alike_wherever_the_file_is_cut(
    fault: str, form: str, cut: Callable[[int], None], tmp_path: Path, soak: bool
) -> None:
    head = "axis,torque_Nm,speed_rpm,duration_s\n"
    step = 1 if soak else 2
    alone, in_pairs = range(1, ROWS, step), range(2, ROWS, step)
    for places in [(place,) for place in alone] + [(place - 1, place) for place in in_pairs]:
        rows = _lines(_sound(form))
        for place in places:
            rows[place] = OF_LINES[fault](rows[place])
        path = tmp_path / "in.csv"
        path.write_text(head + "\n".join(rows) + "\n", errors="surrogateescape")
        cut(10**6)
        whole = axes(path)
        for size in SIZES:
            cut(size)
            assert repr(axes(path)) == repr(whole), (places, size)


@pytest.mark.parametrize("form", ["long", "list"])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".arrow"])
@pytest.mark.parametrize("fault", OF_ROWS)
def test_a_row_that_is_wrong_is_told_alike_wherever_the_file_is_cut(
    fault: str, suffix: str, form: str, cut: Callable[[int], None], tmp_path: Path, soak: bool
) -> None:
    for place in range(1, ROWS, 1 if soak else 2):
        rows = _sound(form)
        rows[place] = OF_ROWS[fault](rows[place])
        cut(10**6)
        whole = axes(write(tmp_path / f"in{suffix}", rows))
        for size in SIZES:
            cut(size)
            assert repr(axes(write(tmp_path / f"in{suffix}", rows, unit_rows=size))) == repr(whole), (place, size)


@pytest.mark.parametrize("fault", ["another axis", "the first axis again", "the last axis too early"])
def test_a_torn_axis_is_told_alike_wherever_the_file_is_cut(
    fault: str, cut: Callable[[int], None], answers: Callable[..., Any], tmp_path: Path
) -> None:
    for place in range(2, ROWS, 3):
        rows = _sound("long")
        rows[place] = OF_ROWS[fault](rows[place])
        path = write(tmp_path / "in.csv", rows)
        cut(10**6)
        whole = answers(path)
        for size in (1, 4):
            cut(size)
            assert answers(path) == whole, (place, size)


OTHERS: dict[str, Change] = {
    "in the first row": lambda rows, axis: rows[PHASES * axis].update(pause_s=1.0),
    "in all rows": lambda rows, axis: [row.update(pause_s=1.0) for row in rows[PHASES * axis : PHASES * (axis + 1)]],
    "in the last row alone": lambda rows, axis: rows[PHASES * axis + 2].update(pause_s=1.0),
    "two values": lambda rows, axis: [rows[PHASES * axis + k].update(pause_s=1.0 + k) for k in range(2)],
}


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@pytest.mark.parametrize("fault", OTHERS)
def test_another_input_of_an_axis_counts_alike_wherever_the_file_is_cut(
    fault: str, suffix: str, cut: Callable[[int], None], answers: Callable[..., Any], tmp_path: Path
) -> None:
    path = tmp_path / f"in{suffix}"
    for axis in range(AXES):
        rows = [row | {"pause_s": None} for row in _sound("long")]
        OTHERS[fault](rows, axis)
        cut(10**6)
        whole = answers(write(path, rows))
        assert [bool(row["error"]) for row in whole[0]] == [
            each == axis and fault in ("in the last row alone", "two values") for each in range(AXES)
        ]
        for size in (1, 4):
            cut(size)
            assert answers(write(path, rows, unit_rows=size)) == whole, (axis, size)
