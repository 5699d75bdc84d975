"""Axes of a machine as a table: written, read by the reader of fleets' tables, and the same axes."""

import json
from pathlib import Path
from typing import Any

import pytest

from hpn.catalogue import Catalogue
from hpn.documents.axis import Axis
from hpn.documents.revision import Frozen
from hpn.fleet import machine_axes
from hpn.fleet.columns import COLUMNS, OF_MACHINE
from hpn.fleet.opened import open_axes
from tests.build import TURNING, Json, cycle, phase, worked_example
from tests.machines import COMMON, axis, frozen, packing_line

HARD = [
    axis("Swivel", {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "rank_by": "life"}, 12, note='a\n=1+1, "b"'),
    axis("", {}),
    axis("open", {"duty_cycle": 7, "requirements": {"life_h": "long", "ratios": [5, 10]}, "more": {"x": [1]}}),
    axis("one phase lacks", cycle(phase(1e-5, 3), {"torque_Nm": 40})),
    axis("names", cycle(phase(3, 4) | {"name": 'up, "fast"'}, phase(5, 6, radial_N=7.25))),
    axis(
        "by size",
        worked_example(output_load={"radial_N": 5, "radial_position_mm": 30, "shaft_centre_mm": {"20A": 21.5}}),
    ),
    axis("one for all", worked_example(output_load={"radial_N": 5, "radial_position_mm": 30, "shaft_centre_mm": 20})),
    axis("list", worked_example(requirements={"sizes": ["20A", "14A"], "load_reverses": False}), without=["rank_by"]),
    axis("too large", worked_example(requirements={"life_h": 10**400, "weight_kg": True})),
]


def rows_of(path: Path, write: Any, document: Frozen) -> list[Json]:
    """Rows of a written table as the reader of fleets' tables gives them, beside the machine's own columns."""
    path.write_bytes(write(document))
    whole = machine_axes.table_of(document)
    own = whole.select([name for name in OF_MACHINE if name in whole.column_names])
    table = open_axes(path, own.column_names)
    rows = [row for batch in table.batches() for row in batch.rows.to_pylist()]
    return [row | more for row, more in zip(rows, own.to_pylist(), strict=True)]


@pytest.mark.parametrize(("suffix", "write"), [(".csv", machine_axes.csv), (".parquet", machine_axes.parquet)])
@pytest.mark.parametrize("axes", [packing_line(), HARD], ids=["line", "hard"])
def test_written_axes_are_read_as_the_same_axes(
    tmp_path: Path, catalogue: Catalogue, axes: list[Json], suffix: str, write: Any
) -> None:
    document = frozen(axes, catalogue, COMMON)

    rows = rows_of(tmp_path / f"axes{suffix}", write, document)

    assert [int(row["axis"]) for row in rows] == [each.number for each in document.axes]
    for row, sent in zip(rows, axes, strict=True):
        assert machine_axes.axis_of(row) == Axis.model_validate(sent)


def test_what_fits_into_columns_needs_no_rest(catalogue: Catalogue) -> None:
    table = machine_axes.table_of(frozen(packing_line(), catalogue, COMMON))
    assert "rest" not in table.column_names
    assert table.num_rows == 40 and set(table.column_names) <= {"axis", *OF_MACHINE, *COLUMNS.all}


def test_a_machine_without_axes_is_a_table_without_rows(catalogue: Catalogue) -> None:
    table = machine_axes.table_of(frozen([], catalogue))
    assert table.num_rows == 0 and "torque_Nm" in table.column_names


def test_lists_in_csv_are_json(catalogue: Catalogue) -> None:
    text = machine_axes.csv(frozen([axis("a", cycle(phase(1, 2), phase(3, 4)))], catalogue)).decode()
    assert json.dumps([1.0, 3.0]) in text
