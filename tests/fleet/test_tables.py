"""Tables as they may look, and the words for those that can't be used, as a whole or in a row."""

from pathlib import Path
from typing import Any

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.engine.selection import select
from hpn.fleet import run
from hpn.fleet.columns import COLUMNS
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from tests.fleet.conftest import Size
from tests.fleet.tables import AXES, HEAD, Row, faults, in_long_form, phases, read, write

# --- Rows that are rejected -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_an_axis_whose_rows_are_not_together_is_rejected_whole(suffix: str, size: Size, tmp_path: Path) -> None:
    rows = [{"axis": axis, "torque_Nm": 40.0, "speed_rpm": 250.0, "duration_s": 1.0} for axis in "aabcca"]
    answers = size(rows, suffix)
    assert [(row["axis"], bool(row["error"])) for row in answers] == [("a", True), ("b", False), ("c", False)]
    assert faults(tmp_path) == [("a", "axis", "must be unique, with its rows together")]
    assert answers[0]["suitable"] is None


def test_an_axis_torn_over_batches_has_one_row_where_it_comes_first(
    size: Size, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "SLICE_WITH_CANDIDATES", 2)
    rows = [{**AXES[0], "axis": axis} for axis in (7, 1, 2, 7, 3, 4, 7)]
    write(tmp_path / "in.parquet", rows, unit_rows=2)
    answers = size(rows, ".parquet", candidates=tmp_path / "all.parquet")
    assert [row["axis"] for row in answers] == [7, 1, 2, 3, 4]
    assert [fault[0] for fault in faults(tmp_path)] == [7]
    assert {row["axis"] for row in read(tmp_path / "all.parquet")} == {1, 2, 3, 4}


OTHERS = {"pause_s": 4.0, "rank_by": "life", "requirements.sizes": ["14A", "20A"], "requirements.load_reverses": True}


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".arrow"])
@pytest.mark.parametrize("repeated", [False, True])
def test_other_inputs_stand_in_the_first_row_of_an_axis_or_in_all(
    repeated: bool, suffix: str, size: Size, tmp_path: Path
) -> None:
    axes: list[Row] = [AXES[0] | OTHERS, AXES[1], AXES[2] | {"pause_s": 5.0}]
    as_lists = size(axes, suffix)

    assert size(in_long_form(axes, repeated=repeated), suffix) == as_lists
    assert faults(tmp_path) == []


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@pytest.mark.parametrize(
    ("name", "first", "second"),
    [
        ("pause_s", 4.0, 5.0),
        ("pause_s", None, 4.0),
        ("rank_by", "life", "weight"),
        ("requirements.sizes", ["14A", "20A"], ["20A", "14A"]),
        ("requirements.ratios", None, [5]),
    ],
)
def test_two_values_of_an_input_reject_their_axis_by_the_name_of_the_column(
    name: str, first: Any, second: Any, suffix: str, size: Size, tmp_path: Path
) -> None:
    rows = in_long_form(AXES[:3])
    rows[2] |= {name: first}
    rows[3] |= {name: second}
    answers = size(rows, suffix)
    assert [bool(row["error"]) for row in answers] == [False, True, False]
    assert faults(tmp_path) == [
        ("a1", name, "must stand in the first row of an axis, or be the same in all of its rows")
    ]
    assert [row["code"] for row in read(tmp_path / "rejected.parquet")] == ["differs"]


def test_cells_that_are_no_numbers_are_told_by_axis_and_column(size: Size, tmp_path: Path) -> None:
    size(HEAD + 'a,"40,5",250,1\nb,40,,1\nc,40,250,1\nc,40,2 50,x\nd,1e3,2.5e+2, 1 \n', ".csv")
    number = "must be a number with a decimal point, such as 9.3"
    assert faults(tmp_path) == [
        ("a", "torque_Nm", f"phase 1: {number}"),
        ("b", "speed_rpm", "phase 1: is required"),
        ("c", "duration_s", f"phase 2: {number}"),
        ("c", "speed_rpm", f"phase 2: {number}"),
    ]


@pytest.mark.parametrize(
    ("content", "rejected"),
    [
        (HEAD + "a,40,250,1\nb,40,250,1\nb,40,2", ["b"]),
        (HEAD + "a,40,250,1\nb,40,250,1\nb", ["b"]),  # whose row it is can't be known
        (HEAD + "a,40,250,1\n,,\nb,40,250,1\nc,40,250,1\n", ["a", "b"]),
        (HEAD + "a,40,250,1,9\nb,40,250,1\n", ["a"]),
    ],
)
def test_a_row_that_is_cut_rejects_the_axis_that_it_may_belong_to(
    content: str, rejected: list[str], size: Size, tmp_path: Path
) -> None:
    answers = size(content, ".csv")
    assert [row["axis"] for row in answers if row["error"]] == rejected
    assert sorted({fault[0] for fault in faults(tmp_path)}) == rejected


def test_a_row_with_too_few_or_too_many_cells_is_quoted_since_it_may_have_no_axis(size: Size, tmp_path: Path) -> None:
    size(HEAD + 'a,"[40]","[250]","[1]"\n,"[40]",5\nb,"[40]",5,1,9; 9\n', ".csv")
    message = "the row has {} cells where the header has 4, in {}"
    assert faults(tmp_path) == [
        (None, "axis", message.format(3, ',"[40]",5')),
        ("b", "axis", message.format(5, 'b,"[40]",5,1,9;9')),
    ]


def test_too_many_phases_are_an_error_of_their_axis(size: Size, tmp_path: Path) -> None:
    answers = size(phases("a", *["b"] * 10_001, "c", *["d"] * 10_000), ".csv")
    assert [bool(row["error"]) for row in answers] == [False, True, False, False]


def test_an_axis_needs_a_name(size: Size, tmp_path: Path) -> None:
    answers = size([{**AXES[0], "axis": axis} for axis in ("a", None, "b", None)], ".parquet")
    assert [(row["axis"], bool(row["error"])) for row in answers] == [
        ("a", False), (None, True), ("b", False), (None, True),
    ]  # fmt: skip
    assert faults(tmp_path) == [(None, "axis", "is required")] * 2


# --- Quotes -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "behind", ["", "c,40,250,1\n", 'c,"40",250,1\n', '"c",40,250,1\n', 'c,"40",250,"1"\nd,40,250,1']
)
@pytest.mark.parametrize("broken", ['b,"40,250,1\n', 'b,40,250,"1\n', '"b,40,250,1\n', 'b,40,"25""0,1\n'])
def test_a_quote_that_nothing_closes_is_named_by_its_line(
    broken: str, behind: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    (tmp_path / "in.csv").write_text(f'{HEAD}a,40,250,1\n"a",40,250,2\n{broken}{behind}')
    message = refusal(Order(tmp_path / "in.csv", tmp_path / "out.csv"), catalogue)
    assert message.endswith("in.csv: line 4 has a quote that nothing closes in its cell")


def test_a_quote_that_another_line_closes_is_named_where_lines_between_would_vanish(
    tmp_path: Path, catalogue: Catalogue
) -> None:
    (tmp_path / "in.csv").write_text(f'{HEAD}a,40,"250,1\nb,40,250,1\nc,40,250",1\n')
    message = refusal(Order(tmp_path / "in.csv", tmp_path / "out.csv"), catalogue)
    assert message.endswith("in.csv: line 2 has a quote that nothing closes in its cell")


def test_line_breaks_in_quotes_belong_to_a_list(size: Size) -> None:
    cell = '"[40,\n32, 20, 10, 5,\n2]"'
    answers = size(HEAD + f'a,{cell},{cell},{cell}\nb,"[40]","[250]","[1]"\n', ".csv")
    assert [(row["axis"], row["error"]) for row in answers] == [("a", None), ("b", None)]


def test_line_breaks_in_quotes_belong_to_a_name(size: Size) -> None:
    answers = size(HEAD + '"a\nb",40,250,1\n"c ""d"" \n\n",40,250,1\ne,"40",250,1\n', ".csv")
    assert [(row["axis"], row["error"]) for row in answers] == [("a\nb", None), ('c "d" \n\n', None), ("e", None)]


# --- Tables that can't be used ----------------------------------------------------------------------------------------


def refusal(order: Order, catalogue: Catalogue) -> str:
    """Words for a fleet that can't be sized."""
    with pytest.raises(FleetError) as refused:
        size_fleet(order, catalogue)
    assert not order.answers.exists()
    return str(refused.value)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("axis,torque_Nm,speed_rpm", "column duration_s is missing"),
        ("torque_Nm,speed_rpm", "column axis is missing"),
        ("axis,torque_Nm,speed_rpm,duration_s,speed", "column 'speed' is unknown"),
        (
            "Nr.;Achse;Moment [Nm]",
            "separated by semicolons, where commas belong, with a point as decimal mark; the page",
        ),
        ("axis\ttorque_Nm\tspeed_rpm\tduration_s", "separated by tabs, where commas belong"),
        ("axis,torque_Nm,speed_rpm,duration_s,radial_n", "it looks like radial_N"),
        ("axis,torque_Nm,speed_rpm,duration_s,axis", "column axis is there twice"),
        ("axis,torque_Nm,speed_rpm" + "".join(f",c{k}" for k in range(3000)), "column 'c19' is unknown; 2981 more"),
    ],
)
def test_columns_that_are_missing_or_unknown_are_named(
    header: str, message: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    (tmp_path / "in.csv").write_text(f"{header}\na,1,2,3,4\n")
    assert message in refusal(Order(tmp_path / "in.csv", tmp_path / "out.csv"), catalogue)


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
@pytest.mark.parametrize("content", [b"", b"\x00\x01hello", b"PAR1PAR1", b"ARROW1\x00\x00"])
def test_a_file_that_is_none_is_named(suffix: str, content: bytes, tmp_path: Path, catalogue: Catalogue) -> None:
    (tmp_path / f"in{suffix}").write_bytes(content)
    assert f"in{suffix}: " in refusal(Order(tmp_path / f"in{suffix}", tmp_path / "out.csv"), catalogue)


@pytest.mark.parametrize("suffix", [".ndjson", ".jsonl"])
def test_lines_of_json_are_refused_with_what_takes_their_place(
    suffix: str, tmp_path: Path, catalogue: Catalogue
) -> None:
    path = tmp_path / f"in{suffix}"
    path.write_text('{"axis": 1, "torque_Nm": [1]}\n')
    sound = write(tmp_path / "in.csv", AXES)
    for order in (Order(path, tmp_path / "out.csv"), Order(sound, tmp_path / f"out{suffix}")):
        assert "tables in lines of JSON are gone: use Parquet, Arrow or CSV" in refusal(order, catalogue)


@pytest.mark.parametrize("suffix", [".csv"])
@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
def test_a_table_in_utf16_is_told_so(suffix: str, encoding: str, tmp_path: Path, catalogue: Catalogue) -> None:
    (tmp_path / f"in{suffix}").write_bytes("\ufeffaxis\ttorque_Nm\n".encode(encoding))
    message = refusal(Order(tmp_path / f"in{suffix}", tmp_path / "out.csv"), catalogue)
    assert f"in{suffix}: is UTF-16, where UTF-8 belongs" in message


def test_a_column_of_a_wrong_type_is_named(tmp_path: Path, catalogue: Catalogue) -> None:
    texts = [{**row, "speed_rpm": ["1", "2"]} for row in AXES]
    pq.write_table(pa.Table.from_pylist(texts), tmp_path / "in.parquet")
    message = refusal(Order(tmp_path / "in.parquet", tmp_path / "out.csv"), catalogue)
    assert "column speed_rpm is list<element: string>, where lists of numbers belong" in message
    pq.write_table(pa.Table.from_pylist([{**row, "axis": True} for row in AXES]), tmp_path / "in.parquet")
    assert "column axis is bool" in refusal(Order(tmp_path / "in.parquet", tmp_path / "out.csv"), catalogue)


def test_a_row_group_that_is_corrupt_is_named(size: Size, tmp_path: Path, catalogue: Catalogue) -> None:
    path = write(tmp_path / "in.parquet", AXES, unit_rows=2)
    column = pq.ParquetFile(path).metadata.row_group(1).column(1)
    content = bytearray(path.read_bytes())
    for place in range(column.data_page_offset, column.data_page_offset + 20):
        content[place] ^= 0xFF
    path.write_bytes(content)
    assert "row group 2 can’t be read" in refusal(Order(path, tmp_path / "out.csv"), catalogue)


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_no_rows_give_no_rows(suffix: str, tmp_path: Path, catalogue: Catalogue) -> None:
    path = tmp_path / f"in{suffix}"
    if suffix in (".parquet", ".arrow"):
        write(path, AXES)
        table = pq.read_table(path) if suffix == ".parquet" else pa.ipc.open_file(str(path)).read_all()
        if suffix == ".parquet":
            pq.write_table(table.slice(0, 0), path)
        else:
            path.unlink()
            with pa.ipc.new_file(str(path), table.schema):
                pass
    else:
        path.write_text(HEAD if suffix == ".csv" else "\n")
    rows = size_fleet(Order(path, tmp_path / "out.arrow"), catalogue)
    assert rows == {"answers": 0}
    assert pa.ipc.open_file(str(tmp_path / "out.arrow")).read_all().num_rows == 0


def test_the_option_of_a_second_table_is_refused_with_what_takes_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "in.csv", in_long_form(AXES))
    assert main(["fleet", str(path), str(tmp_path / "out.csv"), "--axes", str(path)]) == 2
    assert "--axes: is gone: one table has all columns" in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()


def test_a_file_is_never_written_over_what_is_read(tmp_path: Path, catalogue: Catalogue) -> None:
    path = write(tmp_path / "in.csv", in_long_form(AXES))
    with pytest.raises(FleetError, match="is named twice"):
        size_fleet(Order(path, path), catalogue)
    assert "no folder" in refusal(Order(path, tmp_path / "none" / "out.csv"), catalogue)
    assert "suffix" in refusal(Order(path, tmp_path / "out.txt"), catalogue)


def test_candidates_are_those_of_the_reply(size: Size, tmp_path: Path, catalogue: Catalogue) -> None:
    size(AXES, candidates=tmp_path / "all.parquet")
    rows = read(tmp_path / "all.parquet")
    assert len(rows) == 6 * len(catalogue.gears)
    expected: list[Row] = []
    for row in AXES:
        for candidate in select(Application.model_validate(COLUMNS.application_of(row)), catalogue).candidates:
            fields = msgspec.json.decode(msgspec.json.encode(candidate))
            reserve = {f"reserve.{name}": value for name, value in fields.pop("reserve").items()}
            worst = dict.fromkeys(("worst.utilisation", "worst.governing_check", "worst.status"))  # no tolerances
            expected.append({"axis": row["axis"], **fields, **reserve, **worst})
            del expected[-1]["checks"]
            expected[-1]["missing"] = ", ".join(fields["missing"]) or None  # a cell is one text
    assert rows == expected


def test_a_name_that_is_no_utf8_rejects_the_axes_that_its_row_may_belong_to(size: Size, tmp_path: Path) -> None:
    lines = phases("a", "b", "c", "d").replace("c,", "ä,").encode("latin-1")
    assert [(row["axis"], bool(row["error"])) for row in size(lines, ".csv")] == [
        ("a", False),
        ("b", True),
        ("d", True),
    ]
    assert ("b", "axis", "phase 2: must be UTF-8") in faults(tmp_path)


# --- Texts that are too long ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit_rows", [2, 100])
@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_an_axis_whose_name_is_too_long_is_rejected_under_its_beginning(
    suffix: str, form: str, unit_rows: int, size: Size, tmp_path: Path
) -> None:
    rows = [AXES[0], {**AXES[1], "axis": "ü" * 1001}, AXES[2], {**AXES[3], "axis": "b" * 1000}]
    inputs = write(tmp_path / f"in{suffix}", rows if form == "list" else in_long_form(rows), unit_rows=unit_rows)

    answers = size(inputs.read_bytes(), suffix)

    assert [row["axis"] for row in answers] == ["a0", "ü" * 1000, "a2", "b" * 1000]
    assert [bool(row["error"]) for row in answers] == [False, True, False, False]
    assert faults(tmp_path) == [("ü" * 1000, "axis", "must have at most 1000 characters")]


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_a_text_that_is_too_long_is_a_fault_of_its_axis(suffix: str, size: Size, tmp_path: Path) -> None:
    rows = [
        {**AXES[0], "rank_by": "weight", "requirements.sizes": ["14A"]},
        {**AXES[1], "rank_by": "x" * 5000, "requirements.sizes": ["20A", "14A"]},
        {**AXES[2], "rank_by": "weight", "requirements.sizes": ["20A", "y" * 5000]},
    ]

    answers = size(rows, suffix)

    assert [bool(row["error"]) for row in answers] == [False, True, True]
    assert faults(tmp_path) == [
        ("a1", "rank_by", "must have at most 1000 characters"),
        ("a2", "requirements.sizes", "must have at most 1000 characters"),
    ]
