"""`import hpn`: light, and the same answers as REST and `hpn select`."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import Any

import pandas as pd
import polars as pl
import pyarrow as pa
import pypdf
import pytest
from starlette.testclient import TestClient

import hpn
from hpn.application import Application
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, worked_example


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """Client of a service whose answers are compared."""
    file = tmp_path_factory.mktemp("store") / "store.sqlite3"
    with TestClient(create_app(Settings(database_url=f"sqlite:///{file}", log_level="error"))) as client:
        yield client


HEAVY = ("babel", "fastapi", "jinja2", "plotly", "pyarrow", "sqlalchemy", "starlette", "typst", "uvicorn")


def loaded(*lines: str) -> set[str]:
    """Packages from outside the standard library that a program of these lines has loaded at its end."""
    program = "\n".join((*lines, "import json, sys; print(json.dumps(sorted(sys.modules)))"))
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("HPN_", "PYTEST", "COV"))}
    outcome = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    names = {name.partition(".")[0] for name in json.loads(outcome.stdout.splitlines()[-1])}
    before = subprocess.run([sys.executable, "-c", "import sys; print(*sys.modules)"], capture_output=True, text=True)
    return names - sys.stdlib_module_names - {name.partition(".")[0] for name in before.stdout.split()} - {"__main__"}


def test_the_import_loads_nothing_and_a_selection_only_what_it_calculates_with() -> None:
    assert loaded("import hpn", "dir(hpn)") == {"hpn"}
    assert not loaded("import hpn", f"hpn.select({worked_example()!r})._repr_html_()") & {*HEAVY}
    assert not loaded("import hpn", "hpn.catalogue()._repr_html_()") & {*HEAVY}


def test_each_public_name_is_there_and_no_other() -> None:
    assert {*hpn.__all__} <= {*dir(hpn)}
    for name in hpn.__all__:
        assert getattr(hpn, name)
    with pytest.raises(AttributeError, match="nothing"):
        hpn.nothing  # noqa: B018


def test_an_answer_is_that_of_rest_to_the_byte(api: TestClient) -> None:
    for application in (worked_example(), worked_example(requirements={"ratios": [5]})):
        reply = api.post("/api/v1/select", json=application)
        answer = hpn.select(application)

        assert answer.to_json().encode() == reply.content
        assert answer.to_dict() == reply.json()
        assert answer.selected == reply.json()["selected"]
        assert answer.link == reply.json()["link"]
        assert (answer.duty.average_torque_Nm, len(answer.notices)) == (
            reply.json()["duty"]["average_torque_Nm"],
            len(reply.json()["notices"]),
        )
        assert hpn.select(Application.model_validate(application)).to_json() == answer.to_json()


def test_a_candidate_is_found_by_any_spelling() -> None:
    answer = hpn.select(worked_example(requirements={"ratios": [5]}))

    assert answer.candidate("hpn-14-05").designation == "HPN-14A-5"
    with pytest.raises(KeyError, match="none of the gears"):
        answer.candidate("HPN-20A-7")
    with pytest.raises(KeyError, match="no gear of the catalogue"):
        answer.candidate("HPN-99")


def test_what_cannot_be_answered_names_each_fault_as_rest_does(api: TestClient) -> None:
    wrong: list[Json] = [
        {"duty_cycle": {"phases": [{"torque_Nm": [], "speed_rpm": 1, "duration_s": 1}]}, "rank": 1},
        worked_example(requirements={"ratios": [6]}),
        {},
    ]
    for application in wrong:
        with pytest.raises(hpn.ApplicationError) as caught:
            hpn.select(application)
        reply = api.post("/api/v1/select", json=application)
        assert {(place, code) for place, _, code in caught.value.faults} == {
            (error["pointer"], error["code"]) for error in reply.json()["errors"]
        }
        assert all(f"{place}: {text}" in str(caught.value) for place, text, _ in caught.value.faults)
        assert isinstance(caught.value, ValueError)
    for number in (float("nan"), float("inf"), 10**400):
        with pytest.raises(hpn.ApplicationError, match=r"^/duty_cycle/phases/0/torque_Nm: "):
            hpn.select({"duty_cycle": {"phases": [{"torque_Nm": number, "speed_rpm": 1, "duration_s": 1}]}})


class Tags(HTMLParser):
    """Elements of a text of HTML that are left open, and its names of elements and attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.names = list[str](), set[str]()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        self.names |= {tag, *(name for name, _ in attrs)}

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_a_notebook_shows_verdict_checks_and_candidates_without_anything_to_load() -> None:
    answer = hpn.select(worked_example())
    for view in (answer._repr_html_(), hpn.catalogue()._repr_html_()):
        tags = Tags(view)
        assert tags.open == []
        assert tags.names == {*("table", "caption", "thead", "tbody", "tr", "th", "td"), "style", "scope"}
    assert answer.selected and answer.selected in answer._repr_html_()
    assert "Load limit 3: momentary peak torque" in answer._repr_html_()
    assert answer.selected in repr(answer)
    assert "no gear is suitable" in repr(hpn.select(worked_example(requirements={"utilisation": 0.01})))


def test_candidates_and_catalogue_are_columns_for_any_library() -> None:
    answer, gears = hpn.select(worked_example()), hpn.catalogue()
    for columns, count in ((answer.columns(), len(answer.candidates)), (gears.columns(), len(gears))):
        for frame in (pd.DataFrame(columns), pl.DataFrame(columns), pa.table(columns)):
            assert (len(frame), frame.shape[1]) == (count, len(columns))
    assert answer.columns()["designation"] == [one.designation for one in answer.candidates]
    assert gears["HPN-20A-5"].weight_kg == 2.6
    assert [gear.designation for gear in gears] == gears.columns()["designation"]


def test_a_supplement_counts_where_it_is_given(tmp_path: Path) -> None:
    (tmp_path / "weights.csv").write_text("size,stages,weight_kg,source\n20A,1,2.2,my scales\n")

    gears = hpn.catalogue(tmp_path)

    assert gears["HPN-20A-5"].weight_kg == 2.2
    assert gears.version != hpn.catalogue().version
    answer = hpn.select(worked_example(), catalogue=gears)
    assert answer.to_dict()["catalogue_version"] == gears.version
    (tmp_path / "weights.csv").write_text("size,stages,weight_kg,source\n20A,1,heavy,my scales\n")
    with pytest.raises(hpn.ApplicationError, match=r"weights\.csv"):
        hpn.catalogue(tmp_path)


@pytest.mark.parametrize(("format", "mark"), [("pdf", b"%PDF"), ("xlsx", b"PK"), ("aasx", b"PK")])
def test_an_answer_becomes_each_file_of_the_service(format: Any, mark: bytes) -> None:
    output = hpn.report(hpn.select(worked_example()), format, title="Axis 7", reference="4711")

    assert output.startswith(mark)
    if format == "pdf":
        assert "Axis 7" in pypdf.PdfReader(BytesIO(output)).pages[0].extract_text()


def test_a_report_is_on_the_gear_that_is_asked_for() -> None:
    answer = hpn.select(worked_example(requirements={"ratios": [5]}))
    text = pypdf.PdfReader(BytesIO(hpn.report(answer, gear="HPN-14-5", language="de"))).pages[0].extract_text()

    assert "HPN-14A-5" in text
    assert "Nicht gespeichert" in text
    with pytest.raises(hpn.ApplicationError, match="format: must be pdf, xlsx or aasx"):
        hpn.report(answer, "docx")  # type: ignore[arg-type]
