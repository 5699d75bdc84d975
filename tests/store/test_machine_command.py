"""`hpn machine export` and `import`: a machine of one database in another, with its revisions."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn import cli
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example
from tests.store.test_machines_api import ADDRESS, MACHINE

Hpn = Callable[..., tuple[int, str, str]]


@pytest.fixture
def hpn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Hpn:
    """Runs the command on a database by its name."""

    def run(database: str, *arguments: str) -> tuple[int, str, str]:
        monkeypatch.setenv("HPN_DATABASE_URL", f"sqlite:///{tmp_path}/{database}.sqlite3")
        capsys.readouterr()  # the log of services that a test has run
        code = cli.main(["machine", *arguments])
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def file(tmp_path: Path, hpn: Hpn) -> Path:
    """A machine with two revisions that was exported, once changed since."""
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/one.sqlite3"))) as client:
        place = client.post(ADDRESS, json=MACHINE).headers["location"]
        client.post(f"{place}/revisions", json={"label": "A", "author": "MA", "checked": "KR"})
        client.patch(place, json={"common": {"rank_by": "life"}})
        client.post(f"{place}/revisions", json={"label": "B.1", "note": "longer life"})
        client.patch(f"{place}/axes/2", json={"quantity": 9})
    file = tmp_path / "line.json"
    assert hpn("one", "export", f"http://127.0.0.1:8000{place.removeprefix('/api/v1')}", str(file)) == (0, "", "")
    return file


def read(tmp_path: Path, database: str, address: str) -> Json:
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/{database}.sqlite3"))) as client:
        found: Json = client.get(f"/api/v1{address}").json()
    return found


def test_a_machine_is_the_same_in_another_database(tmp_path: Path, hpn: Hpn, file: Path) -> None:
    code, printed, _ = hpn("other", "import", str(file))
    address = printed.strip()
    assert code == 0 and address.startswith("/machines/")
    again = tmp_path / "again.json"
    assert hpn("other", "export", address, str(again))[0] == 0

    def same(path: Path) -> Any:
        found = json.loads(path.read_text())
        own = [{k: v for k, v in axis.items() if k not in ("updated", "updated_by")} for axis in found["axes"]]
        moments = ("id", "url", "created", "updated", "saved")
        return {k: v for k, v in found.items() if k not in (*moments, "axes")}, own

    assert same(again) == same(file)
    assert [each["revision"]["label"] for each in json.loads(again.read_text())["revisions"]] == ["A", "B.1"]
    frozen = read(tmp_path, "other", f"{address}/revisions/A")
    assert frozen["revision"]["checked"] == "KR" and frozen["common"]["rank_by"] == "weight"
    changed = read(tmp_path, "other", f"{address}/differences?from=B.1&to=now")
    assert [axis["number"] for axis in changed["axes"]] == [2]


def test_its_axes_go_through_a_table(tmp_path: Path, hpn: Hpn, file: Path) -> None:
    id = json.loads(file.read_text())["id"]
    table = tmp_path / "axes.csv"
    assert hpn("one", "export", id, str(table))[0] == 0
    code, printed, _ = hpn("other", "import", str(table), "--title", "Out of a table")
    found = read(tmp_path, "other", printed.strip())
    assert code == 0 and found["title"] == "Out of a table"
    assert [axis["quantity"] for axis in found["axes"]] == [2, 9, 1]


def test_open_questions_about_a_table_are_said_and_answered(tmp_path: Path, hpn: Hpn) -> None:
    table = tmp_path / "cells.csv"
    table.write_text("Axis;Torque;Speed [rpm];Duration [s]\nA;40;250;2\n")
    code, printed, said = hpn("other", "import", str(table))
    assert (code, printed) == (2, "") and "Torque" in said
    assert hpn("other", "import", str(table), "--answer", "Torque:Nm")[0] == 0
    code, _, said = hpn("other", "import", str(table), "--answer", "Moment:Nm")
    assert code == 2 and "Moment" in said


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("line.json", "", "no machine"),
        ("line.json", "[]", "no machine"),
        ("line.json", "[" * 100_000, "nested too deeply"),
        ("line.json", '{"axes": [{"quantity": 0}]}', "/axes/0/quantity"),
        ("line.json", '{"axes": [], "nonsense": 1}', "nonsense"),
        ("line.json", '{"revisions": [{"revision": {}}]}', "no machine"),
        ("line.json", '{"title": "a", "title": "b"}', "title"),
        ("line.txt", "", "suffix"),
        ("axes.csv", "", "axes.csv"),
        ("axes.parquet", "PAR1", "axes.parquet"),
    ],
)
def test_what_is_no_machine_is_refused(tmp_path: Path, hpn: Hpn, name: str, content: str, said: str) -> None:
    (tmp_path / name).write_text(content)
    code, printed, error = hpn("other", "import", str(tmp_path / name))
    assert (code, printed) == (2, "") and said in error and "Traceback" not in error


def test_each_line_about_a_file_names_it(tmp_path: Path, hpn: Hpn) -> None:
    for content in (json.dumps(worked_example()), '{"title": "a", "title": "b"}'):
        (wrong := tmp_path / "wrong.json").write_text(content)
        code, _, error = hpn("other", "import", str(wrong))
        assert code == 2 and error
        assert all(line.startswith(f"{wrong}: ") for line in error.splitlines()), error


def test_a_file_that_cannot_be_written_is_named_with_the_reason(tmp_path: Path, hpn: Hpn, file: Path) -> None:
    id, folder = json.loads(file.read_text())["id"], tmp_path / "nowhere"
    (tmp_path / "folder.json").mkdir()
    code, _, error = hpn("one", "export", id, str(folder / "x.json"))
    assert (code, error.strip()) == (2, f"{folder}/x.json: there is no folder {folder}")
    code, _, error = hpn("one", "export", id, str(tmp_path / "folder.json"))
    assert (code, error.strip()) == (2, f"{tmp_path}/folder.json: is a folder, where a file belongs")


def test_a_wrong_label_is_refused(tmp_path: Path, hpn: Hpn, file: Path) -> None:
    for label in ("now", "a/b", "B.1"):
        content = json.loads(file.read_text())
        content["revisions"][0]["revision"]["label"] = label
        (wrong := tmp_path / "wrong.json").write_text(json.dumps(content))
        assert hpn("other", "import", str(wrong))[0] == 2


def test_what_is_not_there_is_said(tmp_path: Path, hpn: Hpn, file: Path) -> None:
    assert hpn("one", "export", "nothing", str(tmp_path / "x.json"))[0] == 2
    assert hpn("other", "import", str(tmp_path / "nothing.json"))[0] == 2
    assert hpn("one", "export", "nothing", str(tmp_path / "x.pdf"))[0] == 2
    code, printed, _ = hpn("one", "export", json.loads(file.read_text())["id"], "-")
    assert code == 0 and json.loads(printed) == json.loads(file.read_text())


def test_help_names_both_actions() -> None:
    command = [str(Path(sys.executable).with_name("hpn")), "machine", "--help"]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=60, env=dict(os.environ), check=True).stdout
    assert "export" in shown and "import" in shown


def test_a_machine_of_a_table_is_answered_as_over_rest(tmp_path: Path, hpn: Hpn) -> None:
    axes = [{"name": "A", "application": cycle(phase(40, 250))}]
    (tmp_path / "line.json").write_text(json.dumps({"axes": axes}))
    address = hpn("other", "import", str(tmp_path / "line.json"))[1].strip()
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/other.sqlite3"))) as client:
        rest = client.post(ADDRESS, json={"axes": axes}).headers["location"]
        one, other = (client.get(place).json()["axes"][0]["answer"] for place in (f"/api/v1{address}", rest))
    assert one == other
