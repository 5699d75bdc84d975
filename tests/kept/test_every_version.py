"""Every page, file and REST address of what each earlier version has saved still opens, and shows what was saved."""

import json
import re
import sqlite3
from collections.abc import Iterator
from html import unescape
from io import BytesIO
from itertools import cycle
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import openpyxl
import pyarrow.parquet as pq
import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import Connection
from starlette.testclient import TestClient

from hpn.documents import revision
from hpn.store.saved import unpacked
from hpn.store.tables import metadata
from hpn.words.quantities import CANDIDATE
from hpn.words.reader import Reader
from tests.kept.kept import VERSIONS, loaded, opened, replies
from tests.report.test_pdf import page_texts
from tests.state import state_of

Json = dict[str, Any]
LANGUAGES = ("en", "de")
WHOLE = VERSIONS[-1:]
"""Version that knew most: of each selection every page and file, of the others every page and JSON, and two with all
their files. The long form opens everything of all.
"""


@pytest.fixture(scope="module", params=VERSIONS)
def version(request: pytest.FixtureRequest) -> str:
    """Name of the database of a version."""
    return str(request.param)


@pytest.fixture(scope="module")
def file(version: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its SQLite file."""
    return loaded(version, tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="module")
def saved(file: Path) -> dict[str, Json]:
    """Its answers by the ids of their selections, read before today's service has seen it."""
    return replies(file)


@pytest.fixture(scope="module")
def fleets(file: Path, saved: dict[str, Json]) -> dict[str, list[Json]]:
    """Answers of its fleets by their ids, read before, too."""
    with sqlite3.connect(file) as connection:
        tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master")}
        query = "SELECT id, answers FROM fleets WHERE saved IS NOT NULL"
        rows = connection.execute(query).fetchall() if "fleets" in tables else []
    connection.close()
    return {id: pq.read_table(BytesIO(content)).to_pylist() for id, content in rows}


@pytest.fixture(scope="module")
def client(file: Path, saved: dict[str, Json], fleets: dict[str, list[Json]]) -> Iterator[TestClient]:
    """Client of today's service on it."""
    with opened(file) as client:
        yield client


def got(client: TestClient, address: str, language: str = "en") -> Any:
    """Answer of an address that opens."""
    answer = client.get(address, headers={"Accept-Language": language})
    assert answer.status_code == 200, (address, answer.text[:300])
    return answer


def shown(reply: Json, designation: str) -> Json:
    """Candidate of an answer that a selection's page shows first."""
    return next(entry for entry in reply["candidates"] if entry["designation"] == designation)


def used(candidate: Json) -> list[str]:
    """Utilisations of a candidate's checks as the page carries them for scripts."""
    shares = [check["utilisation"] for check in candidate["checks"]]
    return [f'data-value="{share}"' for share in shares if share is not None]


def test_the_database_has_todays_tables(client: TestClient) -> None:
    def differences(connection: Connection) -> object:
        return compare_metadata(MigrationContext.configure(connection, opts={"compare_type": True}), metadata)

    async def compared() -> object:
        async with state_of(client).store._engine.connect() as connection:
            return await connection.run_sync(differences)

    assert client.portal is not None
    assert client.portal.call(compared) == []


def test_lists_have_every_selection_as_it_was(client: TestClient, saved: dict[str, Json]) -> None:
    listed = got(client, "/api/v1/selections?limit=200").json()["selections"]
    pages = {language: unescape(got(client, "/selections", language).text) for language in LANGUAGES}

    assert {line["id"] for line in listed} == saved.keys()
    for line in listed:
        candidate = shown(saved[line["id"]], line["designation"])
        assert (line["status"], line["utilisation"]) == (candidate["status"], candidate["utilisation"])
        assert all(f"/selections/{line['id']}" in page and line["title"] in page for page in pages.values())


def test_rest_gives_the_saved_answer(client: TestClient, saved: dict[str, Json]) -> None:
    for id, reply in saved.items():
        answer = got(client, f"/api/v1/selections/{id}").json()

        assert answer["result"] == reply
        fields = {one["field"] for one in answer["today"]["differences"] if one["saved"] is None}
        assert fields.isdisjoint(CANDIDATE.keys() - reply["candidates"][0].keys())


def test_pages_show_the_saved_answer(client: TestClient, version: str, saved: dict[str, Json], soak: bool) -> None:
    listed = got(client, "/api/v1/selections?limit=200").json()["selections"]
    for number, (line, (first, second)) in enumerate(zip(listed, cycle((LANGUAGES, LANGUAGES[::-1])))):
        reply, place = saved[line["id"]], f"/selections/{line['id']}"
        rejected = [one["designation"] for one in reply["candidates"] if one["status"] != "suitable"]

        for designation, address, language in (
            (line["designation"], place, first),
            ((rejected or [line["designation"]])[0], f"{place}?gear={(rejected or [''])[0]}", second),
        ):
            page, candidate = got(client, address, language).text, shown(reply, designation)
            assert designation in page and all(share in page for share in used(candidate))
            for name in ("wind_up_arcmin", "stop_energy_J"):
                assert name in candidate or Reader(language).text(CANDIDATE[name].name) not in page
        if number < 2 or version in WHOLE or soak:
            assert line["designation"].rpartition("-")[0] in got(client, f"{place}/copy", second).text


def test_a_difference_of_today_reads_otherwise_than_what_was_saved(client: TestClient, saved: dict[str, Json]) -> None:
    for number, id in enumerate(saved):
        page = got(client, f"/selections/{id}", LANGUAGES[number % 2]).text
        for row in re.findall(r'<tr(?: class="changed-verdict")?>\s*<td class="gear">.*?</tr>', page, re.DOTALL):
            before, after = re.findall(r"<td>(.*?)</td>", row, re.DOTALL)
            assert before != after, row


def test_files_hold_the_saved_answer(client: TestClient, version: str, saved: dict[str, Json], soak: bool) -> None:
    listed = got(client, "/api/v1/selections?limit=200").json()["selections"]
    for number, (line, language) in enumerate(zip(listed, cycle(LANGUAGES))):
        if number > 1 and version not in WHOLE and not soak:
            break
        place, name = f"/api/v1/selections/{line['id']}", line["designation"]

        shell = ZipFile(BytesIO(got(client, f"{place}/submodel.aasx").content))
        assert json.loads(shell.read("aasx/result.json")) == saved[line["id"]]
        book = openpyxl.load_workbook(BytesIO(got(client, f"{place}/report.xlsx", language).content), data_only=True)
        listed_gears = {row[0]: row[2] for row in book[Reader(language).text("Candidates")].values}
        assert line["utilisation"] is None or listed_gears[name] == pytest.approx(line["utilisation"], rel=1e-12)
        if number % 3 == 0 or soak:  # a PDF takes as long as all the rest
            pages = page_texts(got(client, f"{place}/report.pdf", language).content, 2)
            assert name in "".join(pages).replace("\u200b", "")


def test_neighbours_compare(client: TestClient, saved: dict[str, Json]) -> None:
    ids = list(saved)
    for one, other, language in zip(ids, ids[1:], cycle(LANGUAGES)):
        page = got(client, f"/selections/compare?a={one}&b={other}", language).text
        assert all(saved[id]["candidates"][0]["size"] in page for id in (one, other))


def test_fleets_open_with_their_files(client: TestClient, fleets: dict[str, list[Json]]) -> None:
    for language in LANGUAGES:
        assert all(id in got(client, "/machines", language).text for id in fleets)
    for id in fleets:
        for language in LANGUAGES:
            assert all(axis in got(client, f"/machines/{id}", language).text for axis in ("hub", "belt", "grip"))
        for suffix in ("csv", "xlsx", "parquet"):
            assert got(client, f"/machines/{id}/axes.{suffix}").content


def test_fleets_are_machines_with_the_answers_that_were_saved(
    client: TestClient, fleets: dict[str, list[Json]]
) -> None:
    for id, answers in fleets.items():
        content = got(client, f"/machines/{id}/axes.parquet").content
        for row, then in zip(pq.read_table(BytesIO(content)).to_pylist(), answers, strict=True):
            assert {name: value for name, value in row.items() if name in then} == {
                name: value for name, value in then.items() if name in row
            }


def test_everything_has_its_first_revision(client: TestClient, file: Path, saved: dict[str, Json]) -> None:
    with sqlite3.connect(file) as connection:
        rows = connection.execute(
            "SELECT d.id, d.kind, d.revision, r.label, r.note, r.content_packed, d.title FROM documents d "
            "JOIN revisions r ON r.document = d.id AND r.number = 1 WHERE d.saved IS NOT NULL"
        ).fetchall()
    connection.close()
    assert {row[0] for row in rows if row[1] == "selection"} == saved.keys()
    for _, _, named, label, note, content, title in rows:
        frozen = revision.decode(unpacked(content))
        assert frozen.title == title and [axis.number for axis in frozen.axes] == list(range(1, len(frozen.axes) + 1))
        assert (label, note) == ((named, None) if named == "B" else ("saved", named))
