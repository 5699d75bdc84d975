"""The files over HTTP, and the preview of a pasted link."""

import html
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import get_args
from zipfile import ZipFile

import jsonschema_rs
import openpyxl
import pytest
from pypdf import PdfReader
from starlette.testclient import TestClient

from hpn.application import WORKED_EXAMPLE, RankBy
from hpn.catalogue import Catalogue
from hpn.engine.evaluation import RANKED_BY
from hpn.web.api.files import FILES as FORMATS
from hpn.web.app import create_app
from hpn.web.settings import Settings
from hpn.words.terms import RANKINGS
from tests.report.cases import language, typed_export_of

QUERY = "T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
FILES = {
    "report.pdf": ("application/pdf", b"%PDF-"),
    "report.xlsx": ("application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", b"PK"),
    "submodel.aasx": ("application/asset-administration-shell-package", b"PK"),
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A service of its own."""
    database = f"sqlite:///{tmp_path_factory.mktemp('files') / 'hpn.sqlite3'}"
    with TestClient(create_app(Settings(database_url=database, log_level="error"))) as client:
        yield client


@pytest.fixture(scope="module")
def saved(client: TestClient) -> str:
    """Address of a saved selection in the API."""
    body = {"application": WORKED_EXAMPLE, "title": 'Axis <7> & "more"', "reference": "PLM-4711"}
    return str(client.post("/api/v1/selections", json=body).headers["location"])


@pytest.mark.parametrize("name", FILES)
def test_saved_posted_and_linked_selections_are_files(name: str, client: TestClient, saved: str) -> None:
    media_type, start = FILES[name]
    linked, posted = client.get(f"/{name}?{QUERY}"), client.post(f"/api/v1/{name}", json=WORKED_EXAMPLE)
    for response in (client.get(f"{saved}/{name}"), linked, posted):
        assert response.status_code == 200
        assert response.headers["content-type"] == media_type
        assert response.content.startswith(start)
        assert f'filename="HPN-20A-5.{name[-4:].strip(".")}"' in response.headers["content-disposition"]
    assert linked.content == posted.content


@pytest.mark.parametrize("rank_by", get_args(RankBy))
def test_page_and_files_open_by_every_ranking(rank_by: RankBy, client: TestClient) -> None:
    question = f"{QUERY.removesuffix('&i=5')}&JL=0.8&rank={rank_by}"
    pages = [client.get(f"/?{question}"), *(client.get(f"/{name}?{question}") for name in FILES)]
    assert [page.status_code for page in pages] == [200] * len(pages)
    assert RANKINGS[rank_by].first in html.unescape(pages[0].text)
    assert RANKED_BY.keys() == RANKINGS.keys() == set(get_args(RankBy))


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_the_same_each_time_and_known_by_its_tag(name: str, client: TestClient, saved: str) -> None:
    first = client.get(f"{saved}/{name}")
    assert client.get(f"{saved}/{name}").content == first.content
    again = client.get(f"{saved}/{name}", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


SERVED = """
import sys
from starlette.testclient import TestClient
from hpn.web.serve import served_app

with TestClient(served_app()) as client:
    for address in ("/", "/?T=40&n=250&t=1", "/catalogue", "/selections", "/api/v1/catalogue"):
        assert client.get(address).status_code == 200, address
    assert client.get("/report.xlsx?T=40&n=250&t=1").content.startswith(b"PK")
print(*sys.modules.keys() & {"typst", "basyx", "xlsxwriter", "pint", "pyarrow", "openpyxl", "mcp"})
"""


def test_the_service_loads_no_library_that_makes_or_reads_files(tmp_path: Path) -> None:
    """They are loaded in the processes beside it, which end with their work."""
    settings = {**os.environ, "HPN_DATABASE_URL": f"sqlite:///{tmp_path / 'hpn.sqlite3'}", "HPN_LOG_LEVEL": "error"}
    command = [sys.executable, "-c", SERVED]
    run = subprocess.run(command, env=settings, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout.split() == []


def test_language_is_asked_for_or_the_browsers(client: TestClient, saved: str) -> None:
    weighted = {"Accept-Language": "en;q=0.2, de;q=0.9"}
    assert client.get(f"{saved}/report.pdf", headers=weighted).headers["content-language"] == "de"
    german = {"Accept-Language": "fr, de-DE;q=0.9, en;q=0.8"}
    assert client.get(f"{saved}/report.pdf", headers=german).headers["content-language"] == "de"
    assert client.get(f"{saved}/report.pdf?lang=en", headers=german).headers["content-language"] == "en"
    assert client.get(f"/report.pdf?{QUERY}&lang=de").headers["content-language"] == "de"
    assert (
        client.get(f"{saved}/report.pdf", headers={"Accept-Language": "xx;q=,,;"}).headers["content-language"] == "en"
    )


def test_a_link_too_long_for_an_address_is_posted(client: TestClient) -> None:
    for name in FILES:
        posted = client.post(f"/{name}", data={"link": f"/?{QUERY}", "once": "x", "title": ""})
        assert posted.content == client.get(f"/{name}?{QUERY}").content
        wrong = client.post(f"/{name}", data={"link": "/?T=1,5&n=2&t=3"})
        assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/T/0")


def test_a_link_with_a_gear_makes_files_of_that_gear(client: TestClient) -> None:
    for gear in ("HPN-32A-5", "HPN-20A-7"):  # the ratio of the second is not asked for
        report = client.get(f"/report.pdf?{QUERY}&gear={gear}")
        assert f'"{gear}.pdf"' in report.headers["content-disposition"]
        assert f"Checks of {gear}" in PdfReader(BytesIO(report.content)).pages[0].extract_text()
        book = openpyxl.load_workbook(BytesIO(client.get(f"/report.xlsx?{QUERY}&gear={gear}").content))
        assert gear in [cell.value for cell in book.worksheets[0]["B"]]
    unknown = client.get(f"/report.pdf?{QUERY}&gear=HPN-99A-5")
    assert (unknown.status_code, unknown.json()["errors"][0]["pointer"]) == (422, "/gear")


NONE_FITS = "T=900&n=100&t=1&i=5"


@pytest.mark.parametrize(
    ("query", "message"),
    [
        (
            f"{QUERY}&gear=HPN-20A-7",
            "2 of 5 gears are suitable HPN-20A-7 It passes every check, but its ratio or size was not",
        ),
        (f"{QUERY}&gear=HPN-14A-7", "HPN-20A-5 would be suitable. Fits if"),
        (NONE_FITS, "0 of 5 gears are suitable HPN-32A-5 No gear is suitable. HPN-32A-5 comes closest; “Load limit 1"),
        (f"{NONE_FITS}&gear=HPN-32A-5", "HPN-32A-5 No gear is suitable. HPN-32A-5 comes closest; “Load limit 1"),
        (
            f"{NONE_FITS}&gear=HPN-20A-5",
            "HPN-20A-5 was chosen, but “Load limit 1: average torque” fails at 1 125 %. No gear",
        ),
        (f"{NONE_FITS}&gear=HPN-20A-7", "0 of 5 gears are suitable HPN-20A-7 HPN-20A-7 was chosen, but “Load limit 1"),
    ],
)
def test_a_chosen_gear_is_neither_called_the_closest_nor_counted_where_it_is_not(
    client: TestClient, query: str, message: str
) -> None:
    first = PdfReader(BytesIO(client.get(f"/report.pdf?{query}").content)).pages[0].extract_text()
    assert message in " ".join(first.replace("\u202f", " ").split())


def test_the_title_block_is_of_the_link_or_as_it_was_saved(client: TestClient) -> None:
    labels = {"title": "Axis 7", "reference": "4711", "author": "M. Muster", "revision": "B"}
    code = "HPN-32A-5-J8-BH-AF1"
    body = {"application": WORKED_EXAMPLE, **labels, "ordering_code": code}
    saved = client.post("/api/v1/selections", json=body).headers["location"]
    link = f"{QUERY}&gear=HPN-32A-5&title=Axis+7&ref=4711&author=M.+Muster&rev=B&order_output=J8&order_motor=BH-AF1"
    for address in (f"{saved}/report.pdf", f"/report.pdf?{link}"):
        page = PdfReader(BytesIO(client.get(address).content)).pages[0]
        result = page.extract_text()
        for text in (*labels.values(), code, "Checks of HPN-32A-5"):
            assert text in result, (address, text)
        assert ("Not saved" in result) == ("report.pdf?" in address)
    assert page.annotations is not None
    note = page.annotations[0].get_object()
    opened = client.get(str(note["/A"]["/URI"])).text
    assert "Axis 7" in opened and code in opened


def test_a_report_is_in_the_language_and_units_of_its_reader(client: TestClient, saved: str) -> None:
    cookies = {"Cookie": "hpn_language=de; hpn_units=lb_in.lbf"}
    for address in (f"/report.pdf?{QUERY}", f"{saved}/report.pdf"):
        report = client.get(address, headers=cookies)
        first = PdfReader(BytesIO(report.content)).pages[0].extract_text()
        assert report.headers["content-language"] == "de"
        assert "lb·in" in first and "Nm" not in first.replace("Drehmoment in Nm", "")
        assert "Cookie" in report.headers["vary"]


@pytest.mark.parametrize("name", FILES)
def test_files_are_refused_with_their_reason(name: str, client: TestClient, saved: str) -> None:
    problems = {
        404: client.get(f"/api/v1/selections/0123456789abcdefghijkl/{name}"),
        422: client.get(f"{saved}/{name}?lang=fr"),
        414: client.get(f"/{name}?{QUERY}&size={'x' * 61_000}"),
        415: client.post(f"/api/v1/{name}", content=b"{}"),
        400: client.post(f"/api/v1/{name}", content=b"{", headers={"Content-Type": "application/json"}),
    }
    for status, response in problems.items():
        assert response.status_code == status
        assert response.headers["content-type"] == "application/problem+json"
    assert problems[422].json()["errors"][0]["pointer"] == "/lang"
    comma = client.get(f"/{name}?T=1,5&n=2&t=3")
    assert (comma.status_code, comma.json()["errors"][0]["pointer"]) == (422, "/T/0")
    assert client.get(f"/{name}").status_code == 422
    assert client.post(f"/api/v1/{name}", json={"duty_cycle": {"phases": []}}).status_code == 422


def test_a_package_is_of_metamodel_30_and_of_31_on_request(client: TestClient, saved: str) -> None:
    for path, method in (
        (f"{saved}/submodel.aasx", "GET"),
        ("/submodel.aasx", "GET"),
        ("/api/v1/submodel.aasx", "POST"),
    ):
        query = "&" + QUERY if path == "/submodel.aasx" else ""
        body = WORKED_EXAMPLE if method == "POST" else None
        for case, view in (("", "3/0"), ("aas=3.0", "3/0"), ("aas=3.1", "3/1")):
            response = client.request(method, f"{path}?{case}{query}", json=body)
            content = ZipFile(BytesIO(response.content)).read("aasx/data.xml")
            assert re.findall(rb'xmlns:aas="https://admin-shell.io/aas/([^"]+)"', content) == [view.encode()]
        refused = client.request(method, f"{path}?aas=2{query}", json=body)
        assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/aas")


ANY_TITLE = (
    'Ося 轴 مرحبا 😀\u200d \u202e7 \u0301 \u0378 \ue000 བོ \x00\x1b\x7f\uffff \U0001ffff"\r\nX-Header: 1;\t' + "x" * 60
)


SHOWABLE = re.sub(r"[\x00-\x1f\x7f\u202e\uffff]", "", ANY_TITLE)
"""The same without what the service refuses of a title."""


def test_a_title_of_any_characters_is_refused_or_makes_every_file(client: TestClient) -> None:
    answers = []
    for title in (ANY_TITLE, "a\ud800b", SHOWABLE):
        content = json.dumps({"application": WORKED_EXAMPLE, "title": title, "reference": title})
        headers = {"Content-Type": "application/json"}
        answers.append(client.post("/api/v1/selections", content=content, headers=headers))
    assert [answer.status_code for answer in answers] == [422, 400, 201]
    for name, (media_type, _) in FILES.items():
        response = client.get(f"{answers[-1].headers['location']}/{name}")
        assert (response.status_code, response.headers["content-type"]) == (200, media_type)
        assert response.headers["content-disposition"].isascii()


def test_controls_that_an_older_version_saved_make_every_file(catalogue: Catalogue) -> None:
    export = typed_export_of(dict(WORKED_EXAMPLE), catalogue, title=ANY_TITLE, reference="a\ud800b")
    for file in FORMATS:
        assert file.content(export, language("en"), {})().startswith(FILES[file.name][1])
        assert file.named(export).isascii()


def test_schema_of_the_application_accepts_what_the_service_accepts(client: TestClient) -> None:
    schema = client.get("/api/v1/application.schema.json").json()
    assert schema["$id"] == "application.schema.json"
    jsonschema_rs.meta.validate(schema)
    jsonschema_rs.validate(schema, WORKED_EXAMPLE)
    with pytest.raises(jsonschema_rs.ValidationError):
        jsonschema_rs.validate(schema, {**WORKED_EXAMPLE, "colour": "red"})
    assert schema["$defs"]["Phase"]["properties"]["torque_Nm"]["x-unit"] == "Nm"


def test_a_pasted_link_unfolds_into_gear_and_verdict(client: TestClient, saved: str) -> None:
    page = saved.removeprefix("/api/v1")
    for path, title in (
        (page, 'Axis <7> & "more": HPN-20A-5, suitable'),
        (f"/?{QUERY}", "HPN Select: HPN-20A-5, suitable"),
    ):
        document = client.get(path).text
        match = re.search(r'<meta property="og:title" content="([^"]*)"', document)
        assert match and html.unescape(match[1]) == title
        described = re.search(r'<meta property="og:description" content="([^"]*)"', document)
        assert described and described[1].startswith("Average torque ") and ", HPN-20A-5: " in described[1]


def test_templates_and_catalogues_are_part_of_the_package() -> None:
    folder = Path(__file__).parents[2] / "backend/hpn/files/report"
    assert "report.typ" in {path.name for path in folder.iterdir()}


def test_guarded_reading_guards_files_and_previews_of_saved_selections(tmp_path: Path) -> None:
    settings = Settings(
        database_url=f"sqlite:///{tmp_path / 'hpn.sqlite3'}",
        api_keys=f"me:{'0' * 64}",
        guarded="reading",
        log_level="error",
    )
    with TestClient(create_app(settings)) as client:
        for path in (
            "/selections/0123456789abcdefghijkl",
            *(f"/api/v1/selections/0123456789abcdefghijkl/{name}" for name in FILES),
        ):
            assert client.get(path).status_code == 401
        assert client.get(f"/report.pdf?{QUERY}").status_code == 200
