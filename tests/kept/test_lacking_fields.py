"""A saved answer without any one of its fields still opens, or says that a part is missing which all versions gave."""

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.candidates import FIGURES
from hpn.engine.kept import UnreadableReplyError, decode
from hpn.engine.selection import encode, select
from hpn.files.aas.submodel import package
from hpn.files.export import Export, ExportTitle
from hpn.files.report.content import content
from hpn.files.workbook.workbook import workbook
from hpn.links.writer import to_link
from hpn.store.saved import packed
from hpn.words.quantities import CANDIDATE
from hpn.words.reader import Reader
from tests.kept.content import APPLICATIONS
from tests.kept.kept import opened
from tests.report.cases import CREATED

Json = dict[str, Any]
Path_ = tuple[str, ...]
CATALOGUE: Catalogue = load_catalogue()
ANY = "*"

NEEDED = {
    *(("duty",), ("candidates",), ("check_definitions",), ("notices",), ("selected",), ("link",)),
    *(("engine_version",), ("catalogue_version",)),
    *(("duty", name) for name in ("average_torque_Nm", "average_output_speed_rpm")),
    *(("duty", name) for name in ("maximum_torque_Nm", "maximum_output_speed_rpm")),
    *(("candidates", ANY, name) for name in ("designation", "size", "ratio", "stages", "status", "rank")),
    *(("candidates", ANY, name) for name in ("utilisation", "governing_check", "reason")),
    *(("candidates", ANY, "checks", ANY, name) for name in ("code", "demand", "limit", "utilisation", "status")),
    *(("check_definitions", ANY, name) for name in ("title", "equation", "unit", "kind", "group")),
    *(("notices", ANY, name) for name in ("code", "text")),
    *(("duty", "phases", ANY, name) for name in ("torque_Nm", "speed_rpm", "duration_s")),
    *(("duty", "phases", ANY, f"{name}") for name in ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")),
}
"""Parts that the answers of every version have: without one of them nothing true could be shown."""


def reply_of(name: str) -> Json:
    """Answer of today's engine to an application as JSON."""
    application = Application.model_validate(APPLICATIONS[name])
    reply: Json = msgspec.json.decode(encode(select(application, CATALOGUE, to_link)))
    return reply


def fields_of(part: Any, place: Path_ = ()) -> Iterator[Path_]:
    """Places of all fields, those of the items of a list or a mapping by codes once for all of them."""
    items = part.items() if isinstance(part, dict) else ((ANY, one) for one in part) if isinstance(part, list) else ()
    for name, value in items:
        inner = (*place, ANY if place in (("check_definitions",), ("notices", ANY, "values")) else name)
        if isinstance(part, dict):
            yield inner
        yield from fields_of(value, inner)


def without(part: Any, place: Path_) -> Any:
    """A part without a field, which goes from each of the items that have it."""
    name, *rest = place
    if isinstance(part, list):
        return [without(one, tuple(rest)) for one in part]
    if not rest:
        return {key: value for key, value in part.items() if name not in (ANY, key)}
    return {
        key: without(value, tuple(rest)) if name in (ANY, key) and isinstance(value, dict | list) else value
        for key, value in part.items()
    }


NAMES = ("brake", "turning", "everything")
PLACES = {name: sorted(set(fields_of(reply_of(name)))) for name in NAMES}


def export_of(name: str, reply: bytes) -> Export:
    """Export of a saved answer."""
    application = Application.model_validate(APPLICATIONS[name])
    return Export(application, decode(reply), "/", ExportTitle(name), CREATED, catalogue=CATALOGUE, reply=reply)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """File of a database with a selection, whose answer each test replaces."""
    return tmp_path_factory.mktemp("lacking") / "store.sqlite3"


@pytest.fixture(scope="module")
def client(file: Path) -> Iterator[TestClient]:
    """Client of a service on it."""
    with opened(file) as client:
        yield client


@pytest.fixture(scope="module")
def ids(client: TestClient) -> dict[str, str]:
    """Ids of the saved selections."""
    saved = {name: client.post("/api/v1/selections", json={"application": APPLICATIONS[name]}) for name in NAMES}
    return {name: answer.json()["id"] for name, answer in saved.items()}


def put(file: Path, id: str, reply: bytes) -> None:
    """Replace a saved answer."""
    with sqlite3.connect(file) as connection:
        connection.execute("UPDATE revisions SET result_packed = ? WHERE document = ?", (packed(reply), id))
    connection.close()


@pytest.mark.parametrize("name", NAMES)
def test_pages_and_json_open_without_any_one_field(
    name: str, client: TestClient, file: Path, ids: dict[str, str], soak: bool
) -> None:
    reply, place = reply_of(name), f"/selections/{ids[name]}"
    other = next(id for id in ids.values() if id != ids[name])
    for missing in PLACES[name] if soak or name == "brake" else PLACES[name][::12]:
        put(file, ids[name], msgspec.json.encode(without(reply, missing)))

        addresses = (place, f"/api/v1{place}", f"/selections/compare?a={ids[name]}&b={other}")
        answers = {address: client.get(address, headers={"Accept-Language": "de"}) for address in addresses}

        expected = 409 if missing in NEEDED else 200
        assert {address: answer.status_code for address, answer in answers.items()} == dict.fromkeys(answers, expected)
    put(file, ids[name], msgspec.json.encode(reply))


@pytest.mark.parametrize("name", NAMES)
def test_files_are_made_without_any_one_field(name: str, soak: bool) -> None:
    """The report's content and the workbook without each, the package, which sets the report, without some."""
    reply = reply_of(name)
    for number, missing in enumerate(PLACES[name] if soak or name == "brake" else PLACES[name][::12]):
        lacking = msgspec.json.encode(without(reply, missing))
        if missing in NEEDED:
            with pytest.raises(UnreadableReplyError, match="can’t be read"):
                decode(lacking)
            continue
        export = export_of(name, lacking)
        assert content(export, Reader("de")) and workbook(export, Reader())
        if soak or number % 4 == 0:
            assert package(export)
        if missing[-1] in FIGURES:
            derived = [row["label"] for row in content(export, Reader())["derived"]]
            assert CANDIDATE[missing[-1]].name not in map(str, derived)
