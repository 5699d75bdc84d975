"""Kinds of problems: each problem links to a page with cause and remedy, and each of its errors has a code."""

import re

import pytest
from starlette.testclient import TestClient

from hpn.web.door.kinds import KINDS, OF_STATUS, PATH
from hpn.web.door.problems import Problem
from tests.build import worked_example
from tests.operations.proxy import ROOT


@pytest.mark.parametrize("name", KINDS)
def test_the_type_of_a_problem_is_a_page_with_its_cause_and_remedy(api: TestClient, name: str) -> None:
    page = api.get(Problem(KINDS[name].status, "x", kind=name).body()["type"])

    assert page.status_code == 200
    for text in (KINDS[name].title, KINDS[name].cause, KINDS[name].remedy):
        assert text in page.text.replace("&#39;", "'")
    german = api.get(PATH + name, headers={"Cookie": "hpn_language=de"}).text
    assert KINDS[name].cause not in german


def test_an_unknown_kind_is_no_page(api: TestClient) -> None:
    assert api.get(f"{PATH}nothing").status_code == 404


def test_each_error_of_an_input_has_a_code(api: TestClient) -> None:
    phases = [{"torque_Nm": "x", "speed_rpm": 1, "duration_s": 0, "more": 1}]
    problem = api.post("/api/v1/select", json={"duty_cycle": {"phases": phases}}).json()

    assert problem["type"] == "/problems/input-errors"
    codes = {error["pointer"].rpartition("/")[2]: error["code"] for error in problem["errors"]}
    assert codes == {"torque_Nm": "float_type", "duration_s": "greater_than", "more": "extra_forbidden"}
    lacking = api.post("/api/v1/select", json=worked_example(requirements={"ratios": [6]})).json()
    assert [error["code"] for error in lacking["errors"]] == ["not_available"]


@pytest.mark.parametrize("query", ["", "?url=/selections/x", "?url=/?T=40%26n=250%26t=1&format=json"])
def test_oembed_is_gone_and_the_problem_names_the_tags_that_replace_it(api: TestClient, query: str) -> None:
    answer = api.get(f"/oembed{query}", headers={"Accept": "text/html,*/*"})

    assert (answer.status_code, answer.headers["Content-Type"]) == (410, "application/problem+json")
    assert answer.json()["type"] == f"{PATH}gone"
    page = api.get("/?T=40&n=250&t=1").text
    for tag in ("og:title", "og:description"):
        assert tag in answer.json()["detail"]
        assert f'property="{tag}"' in page


def test_neither_page_nor_document_leads_to_oembed(api: TestClient) -> None:
    assert "oembed" not in api.get("/?T=40&n=250&t=1").text.lower()
    assert "oembed" not in api.get("/openapi.json").text.lower()


def test_nginx_names_the_kinds_of_the_service() -> None:
    named = re.search(r"map \$status \$kind \{(.*?)\n    \}", (ROOT / "backend/nginx.conf").read_text(), re.DOTALL)
    assert named
    kinds = dict(line.strip().rstrip(";").split() for line in named[1].strip().splitlines())

    assert kinds.pop("default") == OF_STATUS[400]
    assert kinds.pop("~^5") == OF_STATUS[503]
    assert kinds == {str(status): OF_STATUS[status] for status in (404, 405, 408, 413, 414, 421, 429, 431)}


def test_a_script_gets_the_reason_of_a_refusal_in_the_readers_language(api: TestClient) -> None:
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept-Language": "de", "HX-Request": "true"}

    answer = api.post("/", content=b"T=" + b"9" * 2_000_001, headers=headers)

    assert answer.status_code == 413
    assert answer.json()["detail"] == "die Anfrage darf höchstens 2000000 Byte haben"
    assert answer.json()["type"] == "/problems/too-large"
