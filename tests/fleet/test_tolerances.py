"""Fleets whose axes have tolerances: columns of their paths, and what `select` says of each axis."""

import random
from pathlib import Path

import pytest
from pydantic import ValidationError

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.fleet.columns import tolerance_column
from hpn.fleet.order import Order
from hpn.fleet.run import here, size_fleet
from tests.build import worked_example
from tests.fleet.tables import Row, read, row_of, write
from tests.fleet.test_equality import expected
from tests.property.boxes import box_at_random

COLUMNS = {
    "tolerances.torque_Nm.percent": ("tolerances", "torque_Nm", "percent"),
    "tolerances.phases.1.torque_Nm.minus.absolute": ("tolerances", "phases.1.torque_Nm", "minus", "absolute"),
    "tolerances.pause_s.plus.percent": ("tolerances", "pause_s", "plus", "percent"),
    "tolerances.output_load.axial_N.absolute": ("tolerances", "output_load.axial_N", "absolute"),
}


@pytest.mark.parametrize("name", COLUMNS)
def test_a_column_of_a_tolerance_is_its_path(name: str) -> None:
    column = tolerance_column(name)
    assert column is not None
    assert column.path == COLUMNS[name]


@pytest.mark.parametrize("name", ["torque_Nm", "tolerances.torque_Nm", "tolerances.name.percent"])
def test_no_other_name_is_a_column_of_a_tolerance(name: str) -> None:
    assert tolerance_column(name) is None


def test_axes_with_tolerances_are_answered_as_select_answers_them(catalogue: Catalogue, tmp_path: Path) -> None:
    chance = random.Random(7)
    rows: list[Row] = []
    target: list[Row] = []
    while len(rows) < 40:
        document = box_at_random(chance)
        try:
            Application.model_validate(document)
        except ValidationError:
            continue
        axis = f"axis {len(rows)}"
        rows.append(row_of(axis, document))
        target.append(expected(axis, document, catalogue))
    rows.append(row_of("wrong", worked_example(tolerances={"speed_rpm": {"percent": 100.0}})))

    order = Order(write(tmp_path / "axes.parquet", rows), tmp_path / "answers.parquet")
    size_fleet(order, catalogue, here)
    answers = read(order.answers)

    assert answers[:-1] == target
    assert "tolerances.speed_rpm: must leave the input on its side of 0" in answers[-1]["error"]
    assert any(row["holds"] for row in target)
