"""Files as other tools write them: other suffixes of the same formats, streams, and columns that no application has."""

import csv
import gzip
import io
import json
from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.fleet import csv_tables
from hpn.fleet.opened import open_axes
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from hpn.web.api.fleet import MEDIA_TYPES, READ_TYPES
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.fleet.tables import Row, read, table_of, write


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A service in this process."""
    (tmp_path / "spool").mkdir()
    app = create_app(Settings(spool_folder=tmp_path / "spool", log_level="error"))
    with TestClient(app) as opened:
        yield opened


ROWS: list[Row] = [
    {"axis": f"a{number}", "torque_Nm": [40.0, 20.0], "speed_rpm": [250.0, 100.0], "duration_s": [0.5, 3.0 + number]}
    for number in range(4)
]


def stream_of(table: pa.Table) -> bytes:
    """An Arrow stream."""
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, table.schema) as stream:
        stream.write_table(table, max_chunksize=2)
    return sink.getvalue()


def content(suffix: str, folder: Path) -> bytes:
    """The rows in a format."""
    table = table_of(ROWS)
    if suffix in (".arrows", "stream.arrow"):
        return stream_of(table)
    if suffix == ".feather":
        feather.write_feather(table, str(folder / "f.feather"), compression="lz4")
        return (folder / "f.feather").read_bytes()
    return gzip.compress(write(folder / "f.csv", ROWS).read_bytes())


ANSWERED_IN = {
    ".arrows": ".arrow",
    "stream.arrow": ".arrow",
    ".feather": ".arrow",
    ".csv.gz": ".csv",
}


@pytest.mark.parametrize("suffix", ANSWERED_IN)
def test_other_suffixes_and_streams_are_read(suffix: str, tmp_path: Path, catalogue: Catalogue) -> None:
    path = tmp_path / f"in{suffix}"
    path.write_bytes(content(suffix, tmp_path))
    size_fleet(Order(write(tmp_path / "plain.parquet", ROWS), tmp_path / "plain.out.parquet"), catalogue)
    size_fleet(Order(path, tmp_path / "out.parquet"), catalogue)
    assert read(tmp_path / "out.parquet") == read(tmp_path / "plain.out.parquet")


@pytest.mark.parametrize("suffix", ANSWERED_IN)
def test_rest_answers_in_the_format_that_is_written(suffix: str, client: TestClient, tmp_path: Path) -> None:
    kinds = {".arrows": READ_TYPES[".arrows"], ".csv.gz": READ_TYPES[".csv.gz"]}
    headers = {"Content-Type": kinds.get(suffix, MEDIA_TYPES[".arrow"])}
    response = client.post("/api/v1/fleet", content=content(suffix, tmp_path), headers=headers)
    assert response.status_code == 200, response.text
    path = tmp_path / f"out{ANSWERED_IN[suffix]}"
    path.write_bytes(response.content)
    assert [row["axis"] for row in read(path)] == ["a0", "a1", "a2", "a3"]


@pytest.mark.parametrize("suffix", [".feather", ".arrows", ".csv.gz"])
def test_these_are_not_written(suffix: str, tmp_path: Path, catalogue: Catalogue) -> None:
    with pytest.raises(FleetError, match=r"the suffix must be one of \.parquet, \.arrow, \.csv$"):
        order = Order(write(tmp_path / "in.parquet", ROWS), tmp_path / f"out{suffix}")
        size_fleet(order, catalogue)


@pytest.mark.parametrize("suffix", [".csv.gz", ".arrows"])
def test_neither_gzip_nor_a_stream_is_held(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_tables, "BLOCK_BYTES", 100)
    path = tmp_path / f"in{suffix}"
    path.write_bytes(content(suffix, tmp_path))
    assert [batch.rows.num_rows for batch in open_axes(path).batches()] in ([1] * 4, [2] * 2)


@pytest.mark.parametrize(
    "damaged", [b"\x1f\x8b", b"\x1f\x8bhello, no gzip", gzip.compress(b"axis" * 99, mtime=0)[:-9], b"axis"]
)
def test_damaged_gzip_is_refused_with_a_sentence(damaged: bytes, tmp_path: Path, catalogue: Catalogue) -> None:
    (tmp_path / "in.csv.gz").write_bytes(damaged)
    with pytest.raises(FleetError, match=r"in\.csv\.gz: "):
        size_fleet(Order(tmp_path / "in.csv.gz", tmp_path / "out.csv"), catalogue)


# --- Columns that no application has ----------------------------------------------------------------------------------


def with_index(suffix: str, path: Path) -> None:
    """A table with the index that pandas writes."""
    table = table_of(ROWS).append_column("__index_level_0__", pa.array([7, 8, 9, 10]))
    if suffix == ".parquet":
        pq.write_table(table, path)
    elif suffix == "named.parquet":
        named = table.rename_columns([*table.column_names[:-1], "row number"])
        notice = {"index_columns": ["row number"], "columns": []}
        pq.write_table(named.replace_schema_metadata({"pandas": json.dumps(notice)}), path)
    else:
        write(path, [{"": number, **row} for number, row in enumerate(ROWS)])


@pytest.mark.parametrize(
    ("suffix", "name"), [(".parquet", "__index_level_0__"), ("named.parquet", "row number"), (".csv", "")]
)
def test_an_index_of_pandas_is_ignored_and_said_so(
    suffix: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"in{suffix}"
    with_index(suffix, path)
    assert main(["fleet", str(path), str(tmp_path / "out.parquet")]) == 0
    assert f"column {name!r} is an index that pandas wrote, and ignored" in capsys.readouterr().err
    assert [row["axis"] for row in read(tmp_path / "out.parquet")] == ["a0", "a1", "a2", "a3"]
    assert not any(row["error"] for row in read(tmp_path / "out.parquet"))


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_a_column_that_no_application_has_is_refused_but_for_ignore(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [{**row, "machine": "press 3", "note": 1.5} for row in ROWS]
    path = tmp_path / f"in{suffix}"
    if suffix in (".parquet", ".arrow"):
        table = table_of(ROWS).append_column("machine", pa.array(["press"] * 4)).append_column("note", pa.nulls(4))
        if suffix == ".parquet":
            pq.write_table(table, path)
        else:
            feather.write_feather(table, str(path), compression="uncompressed")
    else:
        write(path, rows)
    call = ["fleet", str(path), str(tmp_path / "out.parquet")]
    assert main(call) == 2
    assert "column 'machine' is unknown" in capsys.readouterr().err
    assert main([*call, "--ignore", "machine", "note"]) == 0
    assert not any(row["error"] for row in read(tmp_path / "out.parquet"))


def test_rest_ignores_by_its_query(client: TestClient, tmp_path: Path) -> None:
    body = write(tmp_path / "in.csv", [{**row, "machine": "-press", "note": [1]} for row in ROWS]).read_bytes()
    headers = {"Content-Type": "text/csv"}
    refused = client.post("/api/v1/fleet", content=body, headers=headers)
    taken = client.post("/api/v1/fleet?ignore=machine&ignore=note", content=body, headers=headers)
    assert refused.status_code == 422
    assert "column 'machine' is unknown" in refused.json()["detail"]
    assert taken.status_code == 200, taken.text
    assert [row["error"] for row in csv.DictReader(taken.text.splitlines())] == [""] * 4


def test_rest_names_an_index_that_it_has_ignored(client: TestClient, tmp_path: Path) -> None:
    with_index(".parquet", tmp_path / "in.parquet")
    kinds = [{"Content-Type": MEDIA_TYPES[suffix]} for suffix in (".parquet", ".csv")]
    answer = client.post("/api/v1/fleet", content=(tmp_path / "in.parquet").read_bytes(), headers=kinds[0])
    assert (answer.status_code, answer.headers["HPN-Ignored-Columns"]) == (200, '"__index_level_0__"')
    plain = client.post("/api/v1/fleet", content=write(tmp_path / "in.csv", ROWS).read_bytes(), headers=kinds[1])
    assert (plain.status_code, "HPN-Ignored-Columns" in plain.headers) == (200, False)
