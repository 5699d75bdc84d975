"""A year later the files of a saved selection still say the same, whatever has become of the catalogue."""

import asyncio
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import brotli
import openpyxl
import pytest
from alembic import command
from alembic.config import Config
from pypdf import PdfReader
from sqlalchemy import Connection, text
from starlette.testclient import TestClient

from hpn.store import Store, upgrade
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, worked_example
from tests.report.test_workbook import assert_lists
from tests.store.drafts import change, draft

FILES = ("report.pdf", "report.xlsx", "submodel.aasx")
APPLICATION = worked_example(
    requirements={"ratios": [5], "weight_kg": 5}, output_load={"radial_N": 500, "axial_N": 100, "load_coefficient": 1.2}
)
WEIGHTS = "size,stages,weight_kg,source\n20A,1,4.321,scales\n32A,1,9.87,scales\n"
LIMITS = "size,dynamic_radial_load_N,dynamic_axial_load_N,source\n20A,777,888,letter\n"

Change = Callable[[Path, Path], dict[str, Path]]


def by_supplement(folder: Path, place: Path) -> dict[str, Path]:
    """Settings with a supplement that changes weights and bearing limits."""
    place.mkdir()
    (place / "weights.csv").write_text(WEIGHTS)
    columns = (folder / "sizes.csv").read_text().splitlines()[0]
    inputs = dict(zip(*(line.split(",") for line in LIMITS.splitlines()), strict=True))
    (place / "sizes.csv").write_text(columns + "\n" + ",".join(inputs.get(c, "") for c in columns.split(",")) + "\n")
    return {"catalogue_folder": folder, "catalogue_supplement": place}


def by_csv(folder: Path, place: Path) -> dict[str, Path]:
    """Settings with the catalogue's own files changed: every weight, stiffness and radial limit."""
    for file, column in (
        ("weights.csv", "weight_kg"),
        ("sizes.csv", "dynamic_radial_load_N"),
        ("stiffness.csv", "torsional_stiffness_Nm_per_rad"),
    ):
        head, *rows = (line.split(",") for line in (folder / file).read_text().splitlines())
        for row in rows:
            row[head.index(column)] = row[head.index(column)] and str(float(row[head.index(column)]) * 2)
        (folder / file).write_text("\n".join(map(",".join, [head, *rows])) + "\n")
    return {"catalogue_folder": folder}


@contextmanager
def serving(database: str, **parts: Any) -> Iterator[TestClient]:
    """A client of a service that has just started."""
    with TestClient(create_app(Settings(database_url=database, **parts))) as client:
        yield client


def save(client: TestClient, application: Json = APPLICATION) -> str:
    """Address of a new saved selection in the API."""
    response = client.post("/api/v1/selections", json={"application": application, "title": "Axis 7"})
    assert response.status_code == 201, response.text
    return str(response.headers["location"])


def files_of(client: TestClient, address: str) -> dict[str, bytes]:
    """Every file of a saved selection."""
    answers = {(name, lang): client.get(f"{address}/{name}?lang={lang}") for name in FILES for lang in ("en", "de")}
    assert {answer.status_code for answer in answers.values()} == {200}
    return {f"{name} {lang}": answer.content for (name, lang), answer in answers.items()}


def words(document: bytes) -> str:
    """Text of a PDF, spaces made plain."""
    result = "\n".join(page.extract_text() for page in PdfReader(BytesIO(document)).pages)
    return result.replace("\u00a0", " ").replace("\u200b", "").replace("\u202f", "")


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("sqlite", by_supplement),
        *(
            pytest.param(*case, marks=pytest.mark.soak)
            for case in (("sqlite", by_csv), ("postgresql", by_supplement), ("postgresql", by_csv))
        ),
    ],
    indirect=["kind"],
)
def test_after_a_change_of_the_catalogue_every_file_is_the_same_byte_for_byte(
    database: str, change: Change, folder: Path, tmp_path: Path
) -> None:
    with serving(database, catalogue_folder=folder) as client:
        address = save(client)
        before, saved = files_of(client, address), client.get(address).json()
        assert saved["today"]["figure_differences"] == []

    with serving(database, **change(folder, tmp_path / "supplement")) as client:
        after, reopened = files_of(client, address), client.get(address).json()
        page = client.get(address.removeprefix("/api/v1")).text
        anew = files_of(client, save(client))

    assert reopened["today"]["catalogue_version"] != saved["catalogue_version"]
    assert {**reopened, "today": None} == {**saved, "today": None}
    assert before == after
    assert words(before["report.pdf en"]) == words(after["report.pdf en"]) != words(anew["report.pdf en"])

    weight = saved["gear"]["weight_kg"]
    differences = {(d["candidate"], d["field"]): d for d in reopened["today"]["figure_differences"]}
    changed = differences[saved["selected"], "weight_kg"]
    assert (changed["saved"], changed["today"] != weight) == (weight, True)
    assert (saved["selected"], "dynamic_radial_load_N") in differences
    assert "Differences today" in page
    assert re.search(rf"Today’s catalogue publishes other figures for .*{saved['selected']}", page)
    assert re.search(rf"<strong>.*{re.escape(format(changed['today'], '.3g'))}", page[page.index('id="figures"') :])

    assert_lists(openpyxl.load_workbook(BytesIO(after["report.xlsx en"])), saved["result"])


def test_a_selection_saved_before_catalogues_were_kept_says_so(database: str, folder: Path, tmp_path: Path) -> None:
    with serving(database, catalogue_folder=folder) as client:
        address = save(client)
        whole = words(client.get(f"{address}/report.pdf").content)

    async def forget() -> None:
        store = Store(database)
        await store.open()
        await change(store, lambda connection: connection.execute(text("DELETE FROM catalogues")))
        await store.close()

    asyncio.run(forget())
    with serving(database, **by_csv(folder, tmp_path)) as client:
        files, reopened = files_of(client, address), client.get(address).json()
        page = client.get(address.removeprefix("/api/v1")).text

    assert (reopened["gear"], reopened["today"]["figure_differences"]) == (None, None)
    assert "The catalogue of that time is not kept" in page
    assert "not kept: published figures appear only" in " ".join(words(files["report.pdf en"]).split())
    assert "not kept" not in whole
    notes = openpyxl.load_workbook(BytesIO(files["report.xlsx en"]))["Selection"]
    assert any("not kept" in str(row[1]) for row in notes.iter_rows(values_only=True))


def test_a_database_from_before_is_brought_up_to_date_with_what_it_has(database: str) -> None:
    def older(connection: Connection) -> None:
        config = Config()
        config.set_main_option("script_location", str(upgrade.MIGRATIONS))
        config.attributes["connection"] = connection
        command.upgrade(config, "0001")

    async def main() -> None:
        first = Store(database)
        await change(first, older)
        columns = "id, created, engine_version, catalogue_version, application, result_brotli, selected"
        row = "'AAAAAAAAAAAAAAAAAAAAAA', '2026-01-01 00:00:00.000000', '1', 'v', '{}', :result, 'HPN-20A-5'"
        statement = text(f"INSERT INTO selections ({columns}) VALUES ({row})").bindparams(
            result=brotli.compress(b"xyz", quality=0)
        )
        await change(first, lambda connection: connection.execute(statement))
        await first.close()

        store = Store(database)
        await store.open()
        record = await store.find("A" * 22)
        assert record is not None
        assert (record.application, record.result, record.owner) == (b"{}", b"xyz", None)
        stored_record = await store.find(await store.save(draft(owner="plm")))
        assert stored_record is not None
        assert stored_record.owner == "plm"
        assert await store.catalogue("v") is None
        await store.close()

    asyncio.run(main())
