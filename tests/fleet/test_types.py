"""Types of columns: every kind of Arrow that other tools write is read, or refused by the column's name."""

import io
import random
from decimal import Decimal
from pathlib import Path
from typing import Any
from uuid import UUID

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from hpn.catalogue import Catalogue
from hpn.fleet.gathering import axes_of
from hpn.fleet.listing import listing_of
from hpn.fleet.opened import open_axes
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from tests.fleet.conftest import Size
from tests.fleet.tables import AXES, faults, phases, read

NAMES = ("lift", "turn", "lift 2")
ITEMS = [40.0, 20.0, 40.0, 20.0, 40.0, 32.0]
OFFSETS = [0, 2, 4, 6]
PLAIN = {
    "axis": pa.array(NAMES),
    "torque_Nm": pa.ListArray.from_arrays(pa.array(OFFSETS, pa.int32()), pa.array(ITEMS)),
    "speed_rpm": pa.array([[250.0, 100.0]] * 3),
    "duration_s": pa.array([[0.5, 3.0]] * 3),
    "rank_by": pa.array(["weight", None, "weight"]),
    "pause_s": pa.array([1.0, 2.0, 1.0]),
}

SAID = {"axis": "text, integers or UUIDs belong", "torque_Nm": "numbers belong", "rank_by": "texts belong"}


def views(values: pa.Array) -> pa.Array:
    """A Categorical as polars writes it."""
    coded = values.dictionary_encode()
    return pa.DictionaryArray.from_arrays(coded.indices, coded.dictionary.cast(pa.string_view()))


def lists(items: pa.Array) -> pa.Array:
    """Lists of items of any kind."""
    return pa.ListArray.from_arrays(pa.array(OFFSETS, pa.int32()), items)


READ: dict[str, tuple[str, Any]] = {
    "axis of dictionary<string_view>": ("axis", views(PLAIN["axis"])),
    "axis of string_view": ("axis", PLAIN["axis"].cast(pa.string_view())),
    "axis of large_string": ("axis", PLAIN["axis"].cast(pa.large_string())),
    "rank_by of dictionary<string_view>": ("rank_by", views(PLAIN["rank_by"])),
    "rank_by in runs": ("rank_by", pa.RunEndEncodedArray.from_arrays([1, 2, 3], PLAIN["rank_by"])),
    "large_list": ("torque_Nm", PLAIN["torque_Nm"].cast(pa.large_list(pa.float64()))),
    "fixed_size_list": ("torque_Nm", PLAIN["torque_Nm"].cast(pa.list_(pa.float64(), 2))),
    "list_view": ("torque_Nm", pa.array(PLAIN["torque_Nm"].to_pylist(), pa.list_view(pa.float64()))),
    "large_list_view": ("torque_Nm", pa.array(PLAIN["torque_Nm"].to_pylist(), pa.large_list_view(pa.float64()))),
    "large_list<dictionary>": (
        "torque_Nm",
        pa.LargeListArray.from_arrays(pa.array(OFFSETS, pa.int64()), pa.array(ITEMS).dictionary_encode()),
    ),
    **{
        f"pause_s of {kind}": ("pause_s", PLAIN["pause_s"].cast(kind))
        for kind in (pa.float16(), pa.float32(), pa.decimal128(9, 3), pa.decimal256(40, 9), pa.int8(), pa.uint64())
    },
    **{
        f"list of {kind}": ("torque_Nm", lists(pa.array(ITEMS).cast(kind)))
        for kind in (pa.float16(), pa.float32(), pa.decimal128(9, 3), pa.decimal256(40, 9), pa.int16(), pa.uint32())
    },
}


def arrow(columns: dict[str, Any], path: Path) -> Path:
    """A file of columns."""
    table = pa.table(columns)
    with pa.ipc.new_file(str(path), table.schema) as file:
        file.write_table(table)
    return path


@pytest.mark.parametrize("kind", READ)
def test_every_kind_of_column_is_read(kind: str, tmp_path: Path, catalogue: Catalogue) -> None:
    name, column = READ[kind]
    plain = Order(arrow(PLAIN, tmp_path / "plain.arrow"), tmp_path / "plain.parquet")
    other = Order(arrow(PLAIN | {name: column}, tmp_path / "other.arrow"), tmp_path / "other.parquet")

    size_fleet(plain, catalogue)
    size_fleet(other, catalogue)

    assert read(other.answers) == read(plain.answers)
    assert not any(row["error"] for row in read(other.answers))


@pytest.mark.parametrize("name", SAID)
@pytest.mark.parametrize(
    "kind", [pa.bool_(), pa.date32(), pa.timestamp("ns"), pa.binary(), pa.struct([("a", pa.int8())]), pa.duration("s")]
)
def test_a_kind_that_cant_be_read_is_refused_by_the_name_of_its_column(
    kind: pa.DataType, name: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    path = arrow(PLAIN | {name: pa.nulls(3, kind)}, tmp_path / "in.arrow")
    with pytest.raises(FleetError, match=rf"column {name} is .*, where .*{SAID[name]}"):
        size_fleet(Order(path, tmp_path / "out.parquet"), catalogue)


# --- Decimals ---------------------------------------------------------------------------------------------------------


def typed_decimals() -> list[str]:
    """Figures as people type them."""
    draw = random.Random(37)
    texts = [f"{draw.randint(0, 10 ** draw.randint(1, 7))}.{draw.randint(0, 99999)}" for _ in range(4000)]
    return ["254.230", "0.1", "0.30", "1000000.000001", *texts]


@pytest.mark.parametrize("suffix", [".csv", ".arrow", ".parquet"])
@pytest.mark.parametrize("form", ["list", "long"])
def test_decimals_are_read_by_their_digits(suffix: str, form: str, tmp_path: Path) -> None:
    texts = typed_decimals()
    path = tmp_path / f"in{suffix}"
    if suffix == ".csv":
        path.write_text(in_lines(texts, form))
    else:
        path.write_bytes(in_arrow(texts, suffix, form))
    table = open_axes(path)

    values = [
        value for axes in axes_of(table) for value in axes.rows["torque_Nm"].combine_chunks().flatten().to_pylist()
    ]

    assert values == [float(text) for text in texts]


def in_lines(texts: list[str], form: str) -> str:
    """Rows of one phase each."""
    cell = '"[{}]"' if form == "list" else "{}"
    rows = [f"a{row},{cell.format(text)},{cell.format(1)},{cell.format(1)}" for row, text in enumerate(texts)]
    return "\n".join(["axis,torque_Nm,speed_rpm,duration_s", *rows, ""])


def in_arrow(texts: list[str], suffix: str, form: str) -> bytes:
    """The same as columns of decimals."""
    torque, ones = pa.array([Decimal(text) for text in texts], pa.decimal128(20, 6)), pa.array([1] * len(texts))
    if form == "list":
        ends = pa.array(range(len(texts) + 1), pa.int32())
        torque, ones = (pa.ListArray.from_arrays(ends, values) for values in (torque, ones))
    names = [f"a{row}" for row in range(len(texts))]
    table = pa.table({"axis": names, "torque_Nm": torque, "speed_rpm": ones, "duration_s": ones})
    sink = io.BytesIO()
    if suffix == ".parquet":
        pq.write_table(table, sink)
    else:
        with pa.ipc.new_file(sink, table.schema) as file:
            file.write_table(table)
    return sink.getvalue()


# --- Axes and numbers -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [pa.int8(), pa.uint64(), pa.int64(), pa.string(), pa.large_string()])
def test_an_axis_comes_back_in_its_type(kind: pa.DataType, tmp_path: Path, catalogue: Catalogue) -> None:
    rows = [{**AXES[0], "axis": number} for number in range(3)]
    table = pa.table({name: [row[name] for row in rows] for name in rows[0]})
    pq.write_table(table.set_column(0, "axis", table["axis"].cast(kind)), tmp_path / "in.parquet")
    size_fleet(Order(tmp_path / "in.parquet", tmp_path / "out.arrow"), catalogue)
    assert pa.ipc.open_file(str(tmp_path / "out.arrow")).schema.field("axis").type == kind


UUIDS = [UUID("00000000-0000-0000-0000-00000000000f"), UUID("f0e1d2c3-b4a5-9687-7869-5a4b3c2d1e0f"), None]


def with_uuids(path: Path) -> Path:
    """A table with axes that are UUIDs, the last of which is null; its columns begin within what Arrow keeps."""
    rows = [{**AXES[0], "axis": number} for number in range(4)]
    record = pa.array([UUID(int=7).bytes, *(each and each.bytes for each in UUIDS)], pa.binary(16))
    axes = pa.ExtensionArray.from_storage(pa.uuid(), record)
    table = pa.table({name: [row[name] for row in rows] for name in rows[0]}).set_column(0, "axis", axes).slice(1)
    if path.suffix == ".parquet":
        pq.write_table(table, path)
    else:
        with pa.ipc.new_file(str(path), table.schema) as file:
            file.write_table(table)
    return path


@pytest.mark.parametrize("suffix", [".parquet", ".arrow"])
def test_axes_that_are_uuids_come_back_as_uuids_and_as_text_where_there_is_no_such_type(
    suffix: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    """As the standard library writes them."""
    path, texts = with_uuids(tmp_path / f"in{suffix}"), [each and str(each) for each in UUIDS]
    for target in (".parquet", ".arrow", ".csv"):
        out, rejected = tmp_path / f"out{target}", tmp_path / f"rejected{target}"
        order = Order(path, out, rejected=rejected, candidates=tmp_path / f"all{target}")
        answers = list[pa.Table]()
        size_fleet(order, catalogue, use=answers.extend)
        assert [answer["axis"] and str(answer["axis"]) for answer in read(out)] == texts
        if target in (".parquet", ".arrow"):
            result = pq.read_table(out) if target == ".parquet" else pa.ipc.open_file(str(out)).read_all()
            assert result["axis"].type == pa.uuid()
            assert result["axis"].to_pylist() == UUIDS
    listing = listing_of(order, iter(answers), catalogue)
    assert listing.axes["axis"].to_pylist() == texts[:2]
    assert faults(tmp_path) == [(None, "axis", "is required")]


def test_a_uuid_that_is_there_twice_is_rejected_whole(tmp_path: Path, catalogue: Catalogue) -> None:
    rows = [{**AXES[0], "axis": number} for number in range(3)]
    axes = pa.array([UUIDS[0], UUIDS[1], UUIDS[0]], pa.uuid())
    table = pa.table({name: [row[name] for row in rows] for name in rows[0]}).set_column(0, "axis", axes)
    pq.write_table(table, tmp_path / "in.parquet")

    size_fleet(Order(tmp_path / "in.parquet", tmp_path / "out.parquet"), catalogue)

    answers = pq.read_table(tmp_path / "out.parquet")
    assert answers["axis"].to_pylist() == UUIDS[:2]
    assert [error is None for error in answers["error"].to_pylist()] == [False, True]


@pytest.mark.parametrize("suffix", [".parquet", ".arrow"])
@pytest.mark.parametrize(
    "kind", [pa.float16(), pa.float32(), pa.float64(), pa.decimal128(9, 0), pa.dictionary(pa.int8(), pa.float64())]
)
def test_axes_that_are_whole_floats_are_integers(
    kind: pa.DataType, suffix: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    table = pa.Table.from_pylist([{**AXES[0], "axis": axis} for axis in (7.0, None, 12.0)])
    values = table["axis"].combine_chunks()
    values = values.dictionary_encode() if pa.types.is_dictionary(kind) else values.cast(kind)
    table = table.set_column(0, "axis", values)
    if suffix == ".parquet":
        pq.write_table(table, tmp_path / "in.parquet")
    else:
        with pa.ipc.new_file(str(tmp_path / "in.arrow"), table.schema) as file:
            file.write_table(table)
    size_fleet(Order(tmp_path / f"in{suffix}", tmp_path / "out.parquet"), catalogue)
    answers = pq.read_table(tmp_path / "out.parquet")
    assert answers["axis"].type == pa.int64()
    assert answers["axis"].to_pylist() == [7, None, 12]
    assert answers["error"].to_pylist() == [None, "axis: is required", None]


def test_an_axis_that_is_no_whole_number_is_rejected_alone(size: Size, tmp_path: Path) -> None:
    answers = size([{**AXES[0], "axis": axis} for axis in (7.0, 7.5, float("nan"), 1e300, 12.0)], ".parquet")
    assert [row["axis"] for row in answers if not row["error"]] == [7, 12]
    assert faults(tmp_path) == [(None, "axis", "must be text or a whole number")] * 3


def test_axes_of_csv_are_integers_if_every_one_is_written_as_one(tmp_path: Path, catalogue: Catalogue) -> None:
    for names, kind in ((("7", "12"), pa.int64()), (("7", "012"), pa.string())):
        (tmp_path / "in.csv").write_text(phases(*names))
        size_fleet(Order(tmp_path / "in.csv", tmp_path / "out.parquet"), catalogue)
        assert pq.read_schema(tmp_path / "out.parquet").field("axis").type == kind


@pytest.mark.parametrize(
    "kind", [pa.float32(), pa.int16(), pa.decimal128(9, 3), pa.dictionary(pa.int8(), pa.float64())]
)
def test_any_numeric_type_counts(kind: pa.DataType, size: Size, tmp_path: Path, catalogue: Catalogue) -> None:
    expected = size(AXES, ".parquet")
    table = pq.read_table(tmp_path / "in.parquet")
    for place, name in enumerate(table.column_names):
        if name in ("torque_Nm", "speed_rpm"):
            values = pa.concat_arrays([pa.array(item, pa.float64()) for item in table[name].to_pylist()])
            values = values.dictionary_encode() if pa.types.is_dictionary(kind) else values.cast(kind)
            lists = pa.ListArray.from_arrays(pa.array(range(0, len(values) + 1, 2), pa.int32()), values)
            table = table.set_column(place, name, lists)
    pq.write_table(table, tmp_path / "other.parquet")
    size_fleet(Order(tmp_path / "other.parquet", tmp_path / "out.parquet"), catalogue)
    assert read(tmp_path / "out.parquet") == expected


def test_whole_floats_count_as_integers_and_nulls_as_not_given(size: Size) -> None:
    plain = {**AXES[0], "emergency_stop.torque_Nm": 90.0, "emergency_stop.count": 1000, "requirements.ratios": [5]}
    as_floats = plain | {"emergency_stop.count": 1000.0, "requirements.ratios": [5.0], "pause_s": None, "rank_by": None}
    assert size([plain]) == size([as_floats])
