"""Fleets over REST: what the command gives, refusals in words, bounds, and a service that stays fast beside them."""

import os
import random
import signal
import socket
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from hpn.fleet.order import Order
from hpn.fleet.run import size_fleet
from hpn.web import fleets
from hpn.web.app import create_app
from hpn.web.door import beside
from hpn.web.door.pools import Pool
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.fleet.tables import Row, in_long_form, row_of, spoiled, table_of, write
from tests.operations.service import Service, children_of, is_gone, serving, until
from tests.property.draw import at_random
from tests.state import state_of

PATH = "/api/v1/fleet"
TYPES = {
    ".parquet": "application/vnd.apache.parquet",
    ".arrow": "application/vnd.apache.arrow.file",
    ".csv": "text/csv",
}
CSV = {"Content-Type": "text/csv"}
HEADINGS = b"axis,torque_Nm,speed_rpm,duration_s\n"
ONE_AXIS = HEADINGS + b'1,"[40]","[250]","[2]"\n'


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that sets files aside in a folder of its own."""
    folder = tmp_path_factory.mktemp("service")
    (folder / "spool").mkdir()
    with serving(folder, {"HPN_SPOOL_FOLDER": str(folder / "spool"), "HPN_FLEET_MEMORY_BYTES": "500000000"}) as running:
        yield running


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    """Random axes, one of them with a fault."""
    chance = random.Random(1717)
    values = [row_of(f"axis {number}", at_random(chance, ("linear", "iso281"))) for number in range(60)]
    return [*values[:7], spoiled(values[7], "pause_s: must be greater than or equal to 0"), *values[8:]]


def spool_of(service: Service) -> list[Path]:
    """Folders of fleets that the service holds."""
    return list((service.log.parent / "spool").iterdir())


def fleet_processes(service: Service) -> list[int]:
    """Processes that size fleets for the service, oldest first: others have another bound in time."""
    seconds = f"\0{fleets.bounds_of(Settings()).seconds}\0".encode()
    children = children_of(service.process.pid)
    return [pid for pid in children if Path(f"/proc/{pid}/cmdline").read_bytes().endswith(seconds)]


# --- Answers ----------------------------------------------------------------------------------------------------------

CASES: list[tuple[str, str, fleets.Kind]] = [
    (".parquet", "long", "answers"),
    (".arrow", "list", "candidates"),
    (".csv", "long", "rejected"),
]
OTHER_FORM = {"long": "list", "list": "long"}


@pytest.mark.parametrize(
    ("suffix", "form", "give"),
    [*CASES, *(pytest.param(s, OTHER_FORM[f], g, marks=pytest.mark.soak) for s, f, g in CASES)],
)
def test_an_answer_is_what_the_command_writes_to_the_byte(
    suffix: str, form: str, give: fleets.Kind, rows: list[Row], service: Service, catalogue: Catalogue, tmp_path: Path
) -> None:
    files = {kind: tmp_path / f"{kind}{suffix}" for kind in ("answers", "rejected", "candidates")}
    table = write(tmp_path / f"axes{suffix}", in_long_form(rows) if form == "long" else rows)
    order = Order(table, files["answers"], candidates=files["candidates"], rejected=files["rejected"])
    size_fleet(order, catalogue)
    sent: dict[str, Any] = {"content": table.read_bytes(), "headers": {"Content-Type": TYPES[suffix]}}

    answer = service.client.post(PATH, params={"give": give}, **sent)

    assert answer.status_code == 200, answer.text
    assert answer.headers["Content-Type"].partition(";")[0] == TYPES[suffix]
    assert answer.headers["Content-Disposition"] == f'attachment; filename="{give}{suffix}"'
    assert answer.content == files[give].read_bytes()
    assert spool_of(service) == []


@pytest.mark.soak
def test_a_table_without_rows_has_an_answer_without_rows(service: Service) -> None:
    answer = service.client.post(PATH, content=HEADINGS, headers=CSV)

    assert answer.status_code == 200, answer.text
    assert answer.text.count("\n") == 1 and '"axis"' in answer.text


# --- Refusals ---------------------------------------------------------------------------------------------------------


def parquet(**columns: Any) -> bytes:
    """A Parquet file with these columns and those that are required."""
    required = {"axis": ["a"], "torque_Nm": [[40.0]], "speed_rpm": [[250.0]], "duration_s": [[2.0]]}
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(required | columns), sink, compression="none")
    return bytes(sink.getvalue())


def spoiled_at(content: bytes, place: int) -> bytes:
    """A file with other bytes in a place."""
    return content[:place] + bytes(255 - byte for byte in content[place : place + 60]) + content[place + 60 :]


PARQUET, ARROW = ({"Content-Type": TYPES[suffix]} for suffix in (".parquet", ".arrow"))
FORM, LINES = (
    {"Content-Type": "multipart/form-data; boundary=b"},
    {"Content-Type": "application/x-ndjson; charset=utf-8"},
)
REFUSED: list[tuple[str, bytes, dict[str, str], int, str]] = [
    ("empty", b"", CSV, 422, "input: is empty"),
    ("no table", b"\x00\xff" * 50, CSV, 422, "input: column axis is missing"),
    ("UTF-16", "axis\ttorque_Nm\n".encode("utf-16"), CSV, 422, "input: is UTF-16, where UTF-8 belongs"),
    ("truncated Parquet", parquet()[:-9], PARQUET, 422, "input: can’t be read as parquet"),
    ("CSV as Arrow", ONE_AXIS, ARROW, 422, "input: can’t be read as arrow"),
    ("no content type", ONE_AXIS, {}, 415, "application/gzip"),
    ("JSON", b"{}", {"Content-Type": "application/json"}, 415, "text/csv"),
    ("form", ONE_AXIS, FORM, 400, "is gone: one table has all columns, in long form in the first row of an axis"),
    ("lines", ONE_AXIS, LINES, 400, "tables in lines of JSON are gone: use Parquet, Arrow or CSV"),
    # Errors that only the command finds
    (
        "unknown column",
        b"torqe_Nm," + ONE_AXIS,
        CSV,
        422,
        "input: column 'torqe_Nm' is unknown; it looks like torque_Nm",
    ),
    ("wrong type", parquet(speed_rpm=["fast"]), PARQUET, 422, "input: column speed_rpm is string"),
    ("spoiled Parquet", spoiled_at(parquet(), 20), PARQUET, 422, "input: "),
]


IN_SOAK = ("wrong type",)
"""A refusal of the command, which takes a second of start, beside two others of which the short form sees."""


@pytest.mark.parametrize(
    ("content", "headers", "status", "words"),
    [pytest.param(*case, id=name, marks=[pytest.mark.soak] * (name in IN_SOAK)) for name, *case in REFUSED],
)
def test_a_file_that_is_no_table_of_axes_is_refused_in_words_without_a_path(
    content: bytes, headers: dict[str, str], status: int, words: str, service: Service
) -> None:
    answer = service.client.post(PATH, content=content, headers=headers)

    assert answer.status_code == status, answer.text
    assert answer.headers["Content-Type"] == "application/problem+json"
    assert words in answer.json()["detail"]
    assert str(service.log.parent) not in answer.text
    assert spool_of(service) == []


def test_a_small_file_that_stands_for_more_than_memory_is_refused(service: Service, tmp_path: Path) -> None:
    zeros = pa.array(np.zeros(30_000_000, np.int8))
    table = table_of([row_of("a", worked_example())])
    torques = pa.ListArray.from_arrays(pa.array([0, len(zeros)], pa.int32()), zeros)
    table = table.set_column(table.column_names.index("torque_Nm"), "torque_Nm", torques)
    pq.write_table(table, tmp_path / "bomb.parquet", compression="zstd", write_statistics=False)
    content = (tmp_path / "bomb.parquet").read_bytes()

    answer = service.client.post(PATH, content=content, headers=PARQUET)

    assert len(content) < 20_000
    assert answer.status_code in (413, 422), answer.text
    assert service.client.post("/api/v1/select", json=worked_example()).status_code == 200


# --- Bounds -----------------------------------------------------------------------------------------------------------


@pytest.fixture
def bounded(tmp_path: Path) -> Iterator[Callable[..., TestClient]]:
    """Makes clients of a service in this process with these settings, which sets files aside in a folder."""
    opened: list[TestClient] = []

    def make(**settings: Any) -> TestClient:
        (tmp_path / "spool").mkdir(exist_ok=True)
        address = f"sqlite:///{tmp_path}/store.sqlite3"
        app = create_app(Settings(database_url=address, spool_folder=tmp_path / "spool", log_level="error", **settings))
        opened.append(TestClient(app, raise_server_exceptions=False).__enter__())
        return opened[-1]

    yield make
    for client in opened:
        client.__exit__()


@pytest.mark.parametrize("sent", ["whole", "in chunks"])
def test_a_body_that_is_too_large_is_a_413(sent: str, bounded: Callable[..., TestClient], tmp_path: Path) -> None:
    client = bounded(maximum_fleet_bytes=1000)
    content = ONE_AXIS + b"x" * 1000

    answer = client.post(
        PATH, content=content if sent == "whole" else iter([content[:600], content[600:]]), headers=CSV
    )

    assert (answer.status_code, "1000 bytes" in answer.text) == (413, True)
    assert list((tmp_path / "spool").iterdir()) == []


@pytest.mark.parametrize(
    ("setting", "status", "words"),
    [({"fleet_seconds": 0.2}, 503, "within 0.2 s"), ({"maximum_spool_bytes": 100}, 413, "more than 100 bytes")],
    ids=["time", "disk"],
)
def test_a_fleet_that_takes_too_much_is_refused_and_leaves_nothing(
    setting: dict[str, Any], status: int, words: str, bounded: Callable[..., TestClient], tmp_path: Path
) -> None:
    answer = bounded(**setting).post(PATH, content=ONE_AXIS, headers=CSV)

    assert (answer.status_code, words in answer.text) == (status, True), answer.text
    assert ("Retry-After" in answer.headers) == (status == 503)
    assert list((tmp_path / "spool").iterdir()) == []


def killed(*_: Any) -> None:
    """End as the system ends a process where memory runs out."""
    signal.raise_signal(signal.SIGKILL)


def test_a_fleet_that_the_system_kills_is_refused_with_a_sentence_and_not_asked_for_again(
    bounded: Callable[..., TestClient], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    client = bounded()
    monkeypatch.setattr(fleets, "sized", killed)

    answer = client.post(PATH, content=ONE_AXIS, headers=CSV)

    assert (answer.status_code, "Retry-After" in answer.headers) == (413, False)
    assert "takes more memory than this machine has" in answer.json()["detail"]
    assert list((tmp_path / "spool").iterdir()) == []


def test_where_too_many_wait_the_next_is_a_503(bounded: Callable[..., TestClient]) -> None:
    client = bounded()
    pool: Pool = state_of(client).pools["fleets"]
    with ExitStack() as stack:
        for _ in range(4):
            stack.enter_context(pool.place())
        refused = client.post(PATH, content=ONE_AXIS, headers=CSV)

    assert (refused.status_code, "Retry-After" in refused.headers) == (503, True)
    assert client.post(PATH, content=b"", headers=CSV).status_code == 422


def test_the_memory_of_the_service_does_not_grow_with_the_body(service: Service) -> None:
    """100 MB of lines that are refused when they have arrived."""

    def peak() -> int:
        status = Path(f"/proc/{service.process.pid}/status").read_text()
        return int(status.partition("VmHWM:")[2].split()[0]) // 1024

    lines = [b"x" * 999_999 + b"\n"] * 100
    service.client.post(PATH, content=b"", headers=CSV)
    before = peak()

    table = service.client.post(PATH, content=iter(lines), headers=CSV)

    assert (table.status_code, "column axis is missing" in table.text) == (422, True)
    assert peak() - before < 20
    assert "libarrow" not in Path(f"/proc/{service.process.pid}/maps").read_text()


# --- Beside others ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def long_work(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A table that takes minutes with its candidates."""
    count, phases = 100_000, 3
    offsets = pa.array(np.arange(0, phases * count + 1, phases), pa.int32())
    names = {"torque_Nm": 20.0, "speed_rpm": 100.0, "duration_s": 1.0}
    lists = {
        name: pa.ListArray.from_arrays(offsets, pa.array(np.linspace(value, 2 * value, phases * count)))
        for name, value in names.items()
    }
    path = tmp_path_factory.mktemp("long") / "axes.parquet"
    pq.write_table(pa.table({"axis": pa.array(np.arange(count)), **lists}), path, compression="none")
    return path.read_bytes()


def test_small_calculations_are_answered_beside_a_fleet_which_ends_when_its_client_leaves(
    service: Service, long_work: bytes
) -> None:
    head = f"POST {PATH}?give=candidates HTTP/1.1\r\nHost: localhost\r\nContent-Type: {TYPES['.parquet']}\r\n"
    with socket.create_connection(("127.0.0.1", service.port)) as connection:
        connection.sendall(f"{head}Content-Length: {len(long_work)}\r\n\r\n".encode() + long_work)
        (command,) = until(lambda: fleet_processes(service))
        until(lambda: list((service.log.parent / "spool").glob("*/.unfinished.*.candidates")))

        for _ in range(20):
            assert service.client.post("/api/v1/select", json=worked_example()).status_code == 200

        assert fleet_processes(service) == [command]  # it has run all the time
        assert os.getpriority(os.PRIO_PROCESS, command) >= beside.NICENESS
        group = [int(pid) for pid in os.listdir("/proc") if pid.isdecimal() and _group_of(pid) == command]
    assert group
    until(lambda: all(is_gone(pid) for pid in group))
    until(lambda: not spool_of(service))


def _group_of(pid: str) -> int | None:
    with suppress(ProcessLookupError):
        return os.getpgid(int(pid))
    return None


@pytest.mark.soak
def test_a_fleet_ends_when_its_service_is_killed_and_the_next_one_cleans_up(long_work: bytes, tmp_path: Path) -> None:
    (tmp_path / "spool").mkdir()
    settings = {"HPN_SPOOL_FOLDER": str(tmp_path / "spool")}
    with ExitStack() as stack:
        first = stack.enter_context(serving(tmp_path, settings))
        connection = stack.enter_context(socket.create_connection(("127.0.0.1", first.port)))
        head = f"POST {PATH}?give=candidates HTTP/1.1\r\nHost: localhost\r\nContent-Type: {TYPES['.parquet']}\r\n"
        connection.sendall(f"{head}Content-Length: {len(long_work)}\r\n\r\n".encode() + long_work)
        (command,) = until(lambda: fleet_processes(first))
        until(lambda: list((tmp_path / "spool").glob("*/.unfinished.*.candidates")))
        first.process.kill()
        until(lambda: is_gone(command))

        assert spool_of(first)
        assert spool_of(stack.enter_context(serving(tmp_path, settings))) == []


def test_leftovers_of_a_killed_service_are_removed_at_the_next_start_and_nothing_else(
    bounded: Callable[..., TestClient], tmp_path: Path
) -> None:
    spool = tmp_path / "spool"
    for name in ("left", "held", "new"):
        (spool / f"{fleets.PREFIX}{name}").mkdir(parents=True)
    for name in ("left", "held"):
        (spool / f"{fleets.PREFIX}{name}" / "input.csv").touch()
    (spool / "other").mkdir()
    with fleets.folder_lock(spool / f"{fleets.PREFIX}held"):
        bounded()

    assert {path.name.removeprefix(fleets.PREFIX) for path in spool.iterdir()} == {"held", "new", "other"}
