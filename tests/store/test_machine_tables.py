"""Machines out of tables over REST: each format, questions and their answers, and a machine's own table taken back."""

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.web.api.machine_tables import TABLES, WORKBOOK
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example
from tests.fleet.test_machine_axes import HARD
from tests.machines import axis

ADDRESS = "/api/v1/machines"
CSV, PARQUET, ARROW, STREAM, GZIP = TABLES[2], TABLES[0], TABLES[1], TABLES[3], TABLES[4]
ROWS: list[Json] = [
    {"axis": "Lift", "torque_Nm": [40.0, 32.0], "speed_rpm": [250.0, 500.0], "duration_s": [0.3, 3.0], "quantity": 2},
    {"axis": "Turn", "torque_Nm": [9.0], "speed_rpm": [60.0], "duration_s": [8.0], "quantity": None},
]
CELLS = "Achse;Stück;Moment;Drehzahl [1/min];Dauer [s]\nLift;3;40,5;250;2\n;;20;100;1\nGreifer;;4;300;1\n"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A service for all tests: what reads tables takes a second to start. test_machines_api saves on each database."""
    file = tmp_path_factory.mktemp("tables") / "store.sqlite3"
    with TestClient(create_app(Settings(database_url=f"sqlite:///{file}"))) as client:
        yield client


def post(client: TestClient, content: bytes, kind: str, query: str = "", **headers: str) -> Any:
    return client.post(ADDRESS + query, content=content, headers={"Content-Type": kind, **headers})


def machine(client: TestClient, answer: Any) -> Json:
    assert answer.status_code == 201, answer.text
    found: Json = client.get(answer.headers["location"]).json()
    return found


def written(write: Any) -> bytes:
    sink = BytesIO()
    write(pa.Table.from_pylist(ROWS), sink)
    return sink.getvalue()


def arrow(table: pa.Table, sink: BytesIO) -> None:
    with pa.ipc.new_file(sink, table.schema) as file:
        file.write_table(table)


def stream(table: pa.Table, sink: BytesIO) -> None:
    with pa.ipc.new_stream(sink, table.schema) as file:
        file.write_table(table)


@pytest.mark.parametrize(("kind", "write"), [(PARQUET, pq.write_table), (ARROW, arrow), (STREAM, stream)])
def test_a_typed_table_becomes_a_machine(client: TestClient, kind: str, write: Any) -> None:
    found = machine(client, post(client, written(write), kind))
    assert [(each["name"], each["quantity"], each["answer"]["status"]) for each in found["axes"]] == [
        ("Lift", 2, "suitable"),
        ("Turn", 1, "suitable"),
    ]
    assert found["axes"][0]["application"]["duty_cycle"]["phases"] == [phase(40, 250, 0.3), phase(32, 500, 3)]
    same = [{"name": each["name"], "application": each["application"]} for each in found["axes"]]
    other = machine(client, client.post(ADDRESS, json={"axes": same}))
    assert [each["answer"] for each in other["axes"]] == [each["answer"] for each in found["axes"]]


def workbook(text: str) -> bytes:
    book, sink = openpyxl.Workbook(), BytesIO()
    sheet: Any = book.active
    for line in text.splitlines():
        sheet.append([float(cell.replace(",", ".")) if cell[:1].isdigit() else cell for cell in line.split(";")])
    book.save(sink)
    return sink.getvalue()


@pytest.mark.parametrize(("kind", "content"), [(CSV, CELLS.encode("cp1252")), (WORKBOOK, workbook(CELLS))])
def test_open_questions_are_listed_and_answered(client: TestClient, kind: str, content: bytes) -> None:
    asked = post(client, content, kind)
    assert asked.status_code == 422
    (error,) = asked.json()["errors"]
    assert (error["pointer"], error["code"]) == ("/answer", "question") and "Moment" in error["detail"]

    found = machine(client, post(client, content, kind, "?answer=Moment:Nm"))
    assert [(each["name"], each["quantity"]) for each in found["axes"]] == [("Lift", 3), ("Greifer", 1)]
    assert found["axes"][0]["application"]["duty_cycle"]["phases"][0]["torque_Nm"] == 40.5
    by_number = machine(client, post(client, content, kind, "?answer=3:T&answer=3:Nm&answer=2:skip"))
    assert [each["quantity"] for each in by_number["axes"]] == [1, 1]


def test_a_question_with_options_names_them(client: TestClient) -> None:
    text = "axis;T [Nm];n [1/min];t [s]\na;1.234;250;2\nb;2.345;250;2\n"
    asked = post(client, text.encode(), CSV)
    assert asked.status_code == 422 and "answer=decimal:" in asked.json()["errors"][0]["detail"]
    found = machine(client, post(client, text.encode(), CSV, "?answer=decimal:."))
    assert found["axes"][0]["application"]["duty_cycle"]["phases"][0]["torque_Nm"] == 1.234


@pytest.mark.parametrize(
    "pair", [("Moment:Nm", "Moment:kNm"), ("3:Nm", "Moment:kNm"), ("3:T", "3:skip"), ("decimal:,", "decimal:.")]
)
def test_of_two_answers_to_one_question_none_is_chosen(client: TestClient, pair: tuple[str, str]) -> None:
    refused = post(client, CELLS.encode(), CSV, f"?answer={pair[0]}&answer={pair[1]}")
    assert refused.status_code == 422, refused.text
    assert f"{pair[1]}: an earlier answer about " in refused.json()["detail"]
    assert {error["code"] for error in refused.json()["errors"]} == {"answer"}


@pytest.mark.parametrize("answer", ["nothing", "Unknown:T", "Moment:colour", ":T", "99:T", "Moment:", "%00:%00"])
def test_an_answer_that_answers_nothing_is_refused(client: TestClient, answer: str) -> None:
    refused = post(client, CELLS.encode(), CSV, f"?answer={answer}")
    assert refused.status_code == 422, refused.text
    assert {error["code"] for error in refused.json()["errors"]} == {"answer"}


@pytest.mark.parametrize(
    ("kind", "content"),
    [
        (CSV, b""),
        (CSV, b"\x00\x01"),
        (PARQUET, b"PAR1 broken PAR1"),
        (ARROW, b"ARROW1 broken"),
        (WORKBOOK, b"PK\x03\x04 broken"),
        (GZIP, b"\x1f\x8b broken"),
        (CSV, b"{}"),
    ],
)
def test_what_is_no_table_is_refused(client: TestClient, kind: str, content: bytes) -> None:
    assert post(client, content, kind).status_code == 422


def test_a_table_with_the_same_key_is_saved_once(client: TestClient) -> None:
    content = written(pq.write_table)
    first = post(client, content, PARQUET, **{"Idempotency-Key": "table"})
    again = post(client, content, PARQUET, **{"Idempotency-Key": "table"})
    assert first.status_code == again.status_code == 201 and first.json() == again.json()
    assert post(client, content + b" ", PARQUET, **{"Idempotency-Key": "table"}).status_code == 422


def test_a_wrong_cell_leaves_its_axis_open_and_loses_no_other(client: TestClient) -> None:
    head = "axis,torque_Nm,speed_rpm,duration_s,quantity,requirements.life_h"
    rows = ("a,[40],[250],[2],0,", "b,[40],[250],[2],2,long", "c,[40],[250],[2],2,", "c,[40],[250],[2],2,")
    more = ('d,"[40, 3]",[250],[2],2,', "e,[40],[0],[2],2,", "f,[40],[250],[2],4,9")
    text = "\n".join([head, *rows, *more])
    found = machine(client, post(client, text.encode(), CSV))
    states = {each["name"]: each["answer"]["status"] for each in found["axes"]}
    assert states == {"a": "open", "b": "open", "c": "open", "d": "open", "e": "open", "f": "suitable"}
    reasons = {each["name"]: each["answer"]["faults"][0]["pointer"] for each in found["axes"][:-1]}
    assert reasons["a"] == "/quantity" and reasons["b"] == "/requirements/life_h" and reasons["c"] == "/axis"
    assert found["axes"][0]["application"]["duty_cycle"]["phases"] == [phase(40, 250, 2)]  # the cycle of a is kept
    changed = client.patch(f"{ADDRESS}/{found['id']}", json={"common": {"rank_by": "life"}}).json()
    assert {each["name"]: each["answer"]["status"] for each in changed["axes"]} == states  # no lost cell is forgotten


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_the_table_of_a_machine_is_taken_back(client: TestClient, suffix: str) -> None:
    axes = [*HARD, axis("long", worked_example(), note="x" * 1900), axis("", cycle(phase(3, 50)), 7)]
    sent = machine(client, client.post(ADDRESS, json={"axes": axes}))
    table = client.get(f"{ADDRESS}/{sent['id']}/axes.{suffix}").content
    found = machine(client, post(client, table, CSV if suffix == "csv" else PARQUET))

    own = ("name", "quantity", "note", "ordering_code", "without", "application")
    assert [[each[name] for name in own] for each in found["axes"]] == [
        [each[name] for name in own] for each in sent["axes"]
    ]
    assert [each["answer"] for each in found["axes"]] == [each["answer"] for each in sent["axes"]]


NAMES = ("Quantity", "Qty", "Anzahl", "Stück", "Stk.", "Menge", "Quantité", "Qté", "Quantità", "Q.tà", "Pezzi")


@pytest.mark.parametrize("name", NAMES)
def test_a_column_of_quantities_is_kept_on_the_page(client: TestClient, name: str) -> None:
    text = f"Axis;{name};T [Nm];n [rpm];t [s]\nLift;4;40;250;2\n;;20;100;1\nTurn;;9;60;8\n"
    sized = client.post("/machines", data={"text": text, "size": "1"}, follow_redirects=False)
    assert sized.status_code == 303, sized.text
    found = client.get(f"/api/v1{sized.headers['location']}").json()
    assert [(each["name"], each["quantity"]) for each in found["axes"]] == [("Lift", 4), ("Turn", 1)]
