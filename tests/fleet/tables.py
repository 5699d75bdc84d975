"""Tables of axes for tests: rows of applications, faults in them, and every way to write them."""

import csv
import json
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

from tests.build import Json

PHASE = (
    *("torque_Nm", "speed_rpm", "duration_s", "radial_N", "axial_N"),
    *("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "least_torque_Nm"),
    "name",
)
REQUIRED = PHASE[:3]
LISTS = {"requirements.ratios": pa.list_(pa.int64()), "requirements.sizes": pa.list_(pa.string())}
TEXTS = (
    *("output_load.life_basis", "output_load.model", "output_load.drive.type", "rank_by", "application_area"),
    *("requirements.motor.designation", "requirements.motor.curve", "requirements.position_error_at"),
)

CENTRE = "output_load.shaft_centre_mm"
"""A number, or an object by size, which stands as JSON in tables."""

CURVE = "requirements.motor.curve"
"""Points, which stand as JSON in tables."""

Row = dict[str, Any]

AXES = [
    {"axis": f"a{number}", "torque_Nm": [40.0, 20.0 + number], "speed_rpm": [250.0, 100.0], "duration_s": [0.5, 3.0]}
    for number in range(6)
]
HEAD = "axis,torque_Nm,speed_rpm,duration_s\n"


def row_of(axis: str | int, application: Json) -> Row:
    """An application as a row in list form; phases whose loads nobody gives have no such list."""
    row: Row = {"axis": axis, **_flat({name: part for name, part in application.items() if name != "duty_cycle"})}
    cycle = application["duty_cycle"]
    if "pause_s" in cycle:
        row["pause_s"] = cycle["pause_s"]
    for name in PHASE:
        values = [entry.get(name) for entry in cycle["phases"]]
        if name in REQUIRED or any(value is not None for value in values):
            row[name] = values
    return row


def _flat(part: Json, path: str = "") -> Row:
    row: Row = {}
    for name, value in part.items():
        if isinstance(value, dict) and f"{path}{name}" != CENTRE:
            row |= _flat(value, f"{path}{name}.")
        else:
            row[f"{path}{name}"] = json.dumps(value) if f"{path}{name}" == CURVE else value
    return row


def _unequal(row: Row) -> None:
    row["speed_rpm"] = [*row["speed_rpm"], 1.0]


def _named(row: Row, first: str) -> list[str | None]:
    return [first, *[None] * (len(row["torque_Nm"]) - 1)]


FAULTS: dict[str, Callable[[Row], None]] = {
    "torque_Nm: phase 1: must be less than or equal to 1000000": lambda row: row["torque_Nm"].__setitem__(0, 2e6),
    "torque_Nm: phase 1: must be a finite number": lambda row: row["torque_Nm"].__setitem__(0, math.nan),
    "duration_s: phase 1: is required": lambda row: row["duration_s"].__setitem__(0, None),
    "duration_s: phase 1: must be greater than 0": lambda row: row["duration_s"].__setitem__(0, 0.0),
    "peak_torque_Nm: phase 1: must be less than or equal to 1000000": lambda row: row.update(
        peak_torque_Nm=[sys.float_info.max] + [None] * (len(row["torque_Nm"]) - 1)
    ),
    "speed_rpm: has": _unequal,
    "name: phase 1: must not contain the invisible character U+200B": lambda row: row.update(
        name=_named(row, "a\u200bb")
    ),
    "name: phase 1: must have at most 40 characters": lambda row: row.update(name=_named(row, "x" * 41)),
    "no phase moves": lambda row: row.update(
        speed_rpm=[0.0] * len(row["speed_rpm"]), peak_speed_rpm=[None] * len(row["speed_rpm"])
    ),
    "emergency_stop.torque_Nm: is required": lambda row: row.update(
        {"emergency_stop.torque_Nm": None, "emergency_stop.count": 5}
    ),
    "emergency_stop.brake.opposing_torque_Nm: must be at least load_torque_Nm": lambda row: row.update(
        {"emergency_stop.torque_Nm": None, "emergency_stop.count": None}
        | {f"emergency_stop.brake.{name}_Nm": 9.0 for name in ("torque", "load_torque")}
        | {"emergency_stop.brake.opposing_torque_Nm": 8.9}
    ),
    "requirements.utilisation: must be less than or equal to 1": lambda row: row.update(
        {"requirements.utilisation": 1.5}
    ),
    "pause_s: must be greater than or equal to 0": lambda row: row.update(pause_s=-1.0),
    "emergency_stop.count: must be a JSON integer, such as 5": lambda row: row.update(
        {"emergency_stop.torque_Nm": 1.0, "emergency_stop.count": 1.5}
    ),
    "rank_by: must be": lambda row: row.update(rank_by="price"),
    f"{CENTRE}: size 20A: must be greater than 0": lambda row: row.update(
        {CENTRE: {"20A": 0.0}, "output_load.radial_N": 1.0}
    ),
    f"{CENTRE}: size 12A: the catalogue has no 12A (available: ": lambda row: row.update(
        {CENTRE: {"12A": 9.0, "others": 8.0}, "output_load.radial_N": 1.0}
    ),
    "requirements.ratios: item 1: the catalogue has no 6": lambda row: row.update({"requirements.ratios": [6]}),
    "requirements.sizes: item 2: the catalogue has no 12A": lambda row: row.update(
        {"requirements.sizes": ["11A", "12"]}
    ),
}
"""Faults of a row by their reasons, and how each is made."""


def spoiled(row: Row, fault: str) -> Row:
    """The row with a fault."""
    copy = {name: list(value) if isinstance(value, list) else value for name, value in row.items()}
    FAULTS[fault](copy)
    return copy


# --- Writing ----------------------------------------------------------------------------------------------------------


def table_of(rows: Sequence[Row]) -> pa.Table:
    """Rows in list form as an Arrow table."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    return pa.table({name: _column(name, [row.get(name) for row in rows]) for name in names})


def _column(name: str, values: list[Any]) -> pa.Array:
    if name == CENTRE and any(isinstance(value, dict) for value in values):
        return pa.array([None if value is None else json.dumps(value) for value in values], pa.string())
    return pa.array(values, _type(name))


def _type(name: str) -> pa.DataType | None:
    if name == "axis":
        return None
    if name in PHASE:
        return pa.list_(pa.string() if name == "name" else pa.float64())
    if name == "requirements.load_reverses":
        return pa.bool_()
    return LISTS.get(name) or (pa.string() if name in TEXTS else pa.float64())


def in_long_form(rows: Sequence[Row], *, repeated: bool = False) -> list[Row]:
    """Rows of phases, with the other inputs of an axis in its first row or in all of them; a list that is shorter than
    another ends in nulls."""
    result = []
    for row in rows:
        lists = {name: row[name] for name in PHASE if row.get(name) is not None}
        others = {name: value for name, value in row.items() if name not in PHASE}
        for index in range(max(map(len, lists.values()))):
            cells = {name: values[index] for name, values in lists.items() if index < len(values)}
            result.append((others if repeated or not index else {"axis": row["axis"]}) | cells)
    return result


def write(path: Path, rows: Sequence[Row], *, unit_rows: int = 1000) -> Path:
    """Rows in a file, in the format of its suffix; units are so many rows where the format has such."""
    is_long = not any(isinstance(row.get("torque_Nm"), list) for row in rows)
    if path.suffix != ".csv":
        table = _long_table(rows) if is_long else table_of(rows)
        if path.suffix == ".parquet":
            pq.write_table(table, path, row_group_size=unit_rows)
        else:
            with pa.ipc.new_file(str(path), table.schema) as file:
                file.write_table(table, max_chunksize=unit_rows)
    else:
        names = list(dict.fromkeys(name for row in rows for name in row))
        with path.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(names)
            writer.writerows([_cell(row.get(name)) for name in names] for row in rows)
    return path


def _long_table(rows: Sequence[Row]) -> pa.Table:
    names = list(dict.fromkeys(name for row in rows for name in row))
    kinds = {name: pa.string() if name == "name" else pa.float64() for name in PHASE}
    values = {name: [row.get(name) for row in rows] for name in names}
    of_phases = {name: pa.array(values[name], kinds[name]) for name in names if name in kinds}
    return pa.table({name: of_phases[name] if name in kinds else _column(name, values[name]) for name in names})


def _cell(value: Any) -> Any:
    return "" if value is None else json.dumps(value) if isinstance(value, list | dict) else value


# --- Reading ----------------------------------------------------------------------------------------------------------


def read(path: Path) -> list[Row]:
    """Rows of a file that the fleet has written."""
    if path.suffix == ".parquet":
        rows: list[Row] = pq.read_table(path).to_pylist()
    elif path.suffix == ".arrow":
        rows = pa.ipc.open_file(str(path)).read_all().to_pylist()
    else:
        rows = pacsv.read_csv(path, convert_options=pacsv.ConvertOptions(strings_can_be_null=True)).to_pylist()
    return rows


def faults(folder: Path) -> list[tuple[Any, str, str]]:
    """Rows of the rejected."""
    return [(row["axis"], row["column"], row["reason"]) for row in read(folder / "rejected.parquet")]


def phases(*axes: str) -> str:
    """CSV in long form, a line for each name."""
    return HEAD + "".join(f"{axis},40,250,1\n" for axis in axes)
