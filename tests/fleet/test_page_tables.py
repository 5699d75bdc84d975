"""Tables that the page of machines takes, and those that it refuses."""

import csv
import gzip
import io
import re
from html import unescape
from pathlib import Path

import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.links.writer import to_link
from hpn.tables.files import NO_TEXT
from hpn.tables.reading import Reading, reading_of
from hpn.web.axis_tables import BOUNDS
from hpn.words.wording import Sentence
from tests.fleet.page import GERMAN, HEAVY, HUB, fields_of, post
from tests.fleet.tables import REQUIRED, in_long_form, row_of, table_of, write
from tests.fuzz.costly import made


@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".arrow"])
def test_tables_of_hpn_fleet_are_taken_as_they_are(tmp_path: Path, suffix: str, form: str) -> None:
    rows = [row_of("one", HUB), row_of("two", HEAVY)]
    phases = [{name: row[name] for name in ("axis", *REQUIRED)} for row in rows]
    file = write(tmp_path / f"axes{suffix}", rows if form == "list" else in_long_form(phases))

    assert reading_of(file.read_bytes(), BOUNDS) == Reading(suffix=suffix)


def as_written_elsewhere(kind: str, folder: Path) -> bytes:
    """A table of two axes as another tool writes it."""
    rows = [row_of("one", HUB), row_of("two", HEAVY)]
    table, path = table_of(rows), folder / "file"
    if kind == ".feather":
        feather.write_feather(table, str(path), compression="lz4")
    elif kind == ".arrows":
        with pa.ipc.new_stream(str(path), table.schema) as stream:
            stream.write_table(table, max_chunksize=1)
    elif kind == ".csv.gz":
        path.write_bytes(gzip.compress(write(folder / "axes.csv", rows).read_bytes()))
    elif kind == "CSV with an index":
        write(folder / "axes.csv", [{"": number, **row} for number, row in enumerate(rows)]).rename(path)
    else:
        pq.write_table(table.append_column("__index_level_0__", pa.array([7, 8])), path)
    return path.read_bytes()


@pytest.mark.parametrize("kind", [".feather", ".arrows", ".csv.gz", "CSV with an index", "Parquet with an index"])
def test_tables_that_other_tools_write_are_sized_at_once(kind: str, client: TestClient, tmp_path: Path) -> None:
    sized = post(client, as_written_elsewhere(kind, tmp_path))

    assert sized.status_code == 303, sized.text
    place = sized.headers["location"]
    assert "two" in client.get(place).text
    assert to_link(Application.model_validate(HUB)) in unescape(client.get(f"{place}/axes/1").text)


@pytest.mark.parametrize("kind", [".csv.gz", ".arrows"])
def test_gzip_and_streams_with_other_headings_are_read(kind: str, tmp_path: Path) -> None:
    row = {"Antrieb": "A", "Moment Nm": 12.5, "Drehzahl rpm": 1234.567, "Zeitdauer s": 1e-3}
    sink = io.BytesIO()
    if kind == ".arrows":
        table = pa.Table.from_pylist([row])
        with pa.ipc.new_stream(sink, table.schema) as stream:
            stream.write_table(table)
    else:
        sink.write(gzip.compress(f"{','.join(row)}\n{','.join(map(str, row.values()))}\n".encode()))

    table = reading_of(sink.getvalue(), BOUNDS).table

    assert table is not None
    assert table.axes == ({"axis": "A", "torque_Nm": [12.5], "speed_rpm": [1234.567], "duration_s": [1e-3]},)


@pytest.mark.parametrize(
    "content",
    [
        gzip.compress(gzip.compress(b"axis")),
        b"\x1f\x8bno gzip at all",
    ],
    ids=["gzip in gzip", "no gzip"],
)
def test_gzip_without_a_table_is_said(content: bytes) -> None:
    table = reading_of(content, BOUNDS).table
    assert table is not None and table.problem == Sentence(NO_TEXT)


def test_a_table_of_hpn_fleet_is_sized_at_once(client: TestClient, tmp_path: Path) -> None:
    file = write(tmp_path / "axes.csv", [row_of("one", HUB), row_of("two", HEAVY)])

    sized = post(client, file.read_bytes())

    assert sized.status_code == 303, sized.text
    assert to_link(Application.model_validate(HUB)) in unescape(client.get(f"{sized.headers['location']}/axes/1").text)


def test_names_of_phases_reach_the_link_of_their_axis(client: TestClient) -> None:
    table = "Achse;Phase;Moment [Nm];Drehzahl [1/min];Dauer [s]\nA;hoch;40;250;1\nA;runter;32;500;2\n"

    sized = post(client, fields={**fields_of(post(client, table.encode()).text), "size": "1"})

    assert sized.status_code == 303
    assert "n=250&t=1&pn=hoch&T=32&n=500&t=2&pn=runter" in unescape(
        client.get(f"{sized.headers['location']}/axes/1").text
    )


def test_typed_tables_with_other_headings_are_read_with_every_digit(tmp_path: Path) -> None:
    exact = 0.1 + 0.2
    row = {"Antrieb": "A", "Moment Nm": exact, "Drehzahl rpm": 1234.567, "Zeitdauer s": 1e-3}
    pq.write_table(pa.Table.from_pylist([row]), tmp_path / "axes.parquet")

    table = reading_of((tmp_path / "axes.parquet").read_bytes(), BOUNDS).table

    assert table is not None
    assert table.axes == ({"axis": "A", "torque_Nm": [exact], "speed_rpm": [1234.567], "duration_s": [1e-3]},)


@pytest.mark.parametrize(
    ("content", "status", "message"),
    [
        (b"", 422, "choose a file"),
        (b"PAR1 but not really", 422, "can’t be read as Parquet"),
        (b"\xd0\xcf\x11\xe0 old", 422, "old format"),
        (b'{"axis": 1, "torque_Nm": [1], "speed_rpm": [2], "duration_s": [3]}\n', 422, "JSON are no table of axes"),
        (b"axis,torque_Nm,speed_rpm\n1,2,3\n", 422, "The table: column duration_s is missing"),
        (b"hello", 422, ""),
    ],
)
def test_a_file_that_can_not_be_read_says_so(client: TestClient, content: bytes, status: int, message: str) -> None:
    answer = post(client, content)

    assert answer.status_code == status
    assert message in unescape(answer.text) and 'role="alert"' in answer.text


def test_a_reader_who_changes_language_over_a_table_comes_back_to_the_page_of_tables(client: TestClient) -> None:
    page = post(client, GERMAN.encode()).text

    assert re.findall(r'name="back" value="([^"]*)"', page) == ["/machines"]


def test_a_table_that_is_too_large_for_the_page_is_told_where_there_is_room(client: TestClient) -> None:
    rows = "".join(f"A{number};1;{number % 100};1\n" for number in range(37_600))

    answer = post(client, f"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n{rows}".encode())

    assert answer.status_code == 422
    assert "leave out the columns" in answer.text and "POST /api/v1/fleet, which have no such limit" in answer.text


def test_a_file_that_stands_for_too_much_is_a_413_and_what_was_typed_is_kept(client: TestClient) -> None:
    files = {"file": ("a.arrow", made("Arrow with a long text"))}

    answer = client.post("/machines", data={"text": "typed before"}, files=files)

    assert answer.status_code == 413
    assert "too much memory or time" in answer.text and "typed before" in answer.text


def test_an_axis_whose_name_is_too_long_is_a_rejected_one(client: TestClient, tmp_path: Path) -> None:
    """The same as over REST and by the command, since it is refused where tables are read."""
    rows = [{**row_of("x", HUB), "axis": "a" * 5000}, row_of("two", HUB)]
    content = write(tmp_path / "axes.csv", rows).read_bytes()

    sized = post(client, content)
    page = client.get(sized.headers["location"]).text
    answers = client.post("/api/v1/fleet", content=content, headers={"Content-Type": "text/csv"})

    assert "must have at most 1000 characters" in page and "a" * 1000 in page and "a" * 1001 not in page
    first, second = csv.DictReader(io.StringIO(answers.text))
    assert (first["axis"], first["error"]) == ("a" * 1000, "axis: must have at most 1000 characters")
    assert second["error"] == ""


@pytest.mark.parametrize("form", ["cells", "typed"])
def test_an_axis_that_is_torn_apart_is_one_rejected_row(form: str, client: TestClient) -> None:
    head = "Axis;Torque [Nm];Speed [rpm];Duration [s]" if form == "cells" else "axis,torque_Nm,speed_rpm,duration_s"
    rows = [f"{name},40,{speed},1" for name, speed in (("a", 100), ("b", 100), ("a", 200), ("c", 0), ("a", 9e9))]
    text = "\n".join([head, *(row.replace(",", ";") if form == "cells" else row for row in rows)])

    sized = post(client, text.encode())
    if sized.status_code == 200:
        sized = post(client, fields={**fields_of(sized.text), "size": "1"})

    answers = pq.read_table(io.BytesIO(client.get(f"{sized.headers['location']}/axes.parquet").content)).to_pylist()
    assert [row["axis"] for row in answers] == ["a", "b", "c"]
    assert answers[0]["error"] == "axis: must be unique, with its rows together"
    assert [bool(row["error"]) for row in answers] == [True, False, True]


@pytest.mark.parametrize("count", [10_001, 2])
def test_a_table_with_more_than_a_machine_has_is_told_where_there_is_room(
    count: int, client: TestClient, tmp_path: Path
) -> None:
    phases = 1 if count > 2 else 100_001
    lists = {name: [[1.0] * phases] * count for name in ("torque_Nm", "speed_rpm", "duration_s")}
    pq.write_table(pa.table({"axis": [str(number) for number in range(count)], **lists}), tmp_path / "axes.parquet")

    answer = post(client, (tmp_path / "axes.parquet").read_bytes())

    assert answer.status_code == 413
    assert "the limit of a page is" in answer.text and "POST /api/v1/fleet" in answer.text
