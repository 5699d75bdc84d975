"""Reader of a page: by browser, by cookie, never by address."""

import re
from collections.abc import Iterator

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
AMERICAN = {"Cookie": "hpn_units=lb_in.lbf.lb.in.degF"}
GERMAN = {"Cookie": "hpn_language=de"}


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app(), follow_redirects=False) as client:
        yield client


def test_language_comes_from_the_browser_until_the_reader_chooses(client: TestClient) -> None:
    german = client.get("/", headers={"Accept-Language": "de-DE,de;q=0.9,en;q=0.5"})
    assert '<html lang="de">' in german.text
    assert german.headers["content-language"] == "de"
    chosen = client.get("/", headers={"Accept-Language": "de", "Cookie": "hpn_language=en"})
    assert '<html lang="en">' in chosen.text


@pytest.mark.parametrize("path", [EXAMPLE, "/catalogue", "/paste", "/selections/nothing"])
def test_caches_are_told_what_a_page_depends_on(path: str, client: TestClient) -> None:
    vary = {part.strip() for part in client.get(path).headers["vary"].split(",")}
    assert {"Accept-Language", "Cookie"} <= vary


def test_settings_are_kept_in_cookies_and_lead_back(client: TestClient) -> None:
    answer = client.post("/reader", data={"language": "de", "torque": "lb_ft", "speed": "rpm", "back": EXAMPLE})
    assert (answer.status_code, answer.headers["location"]) == (303, EXAMPLE)
    cookies = answer.headers.get_list("set-cookie")
    assert [cookie.split(";")[0] for cookie in cookies] == ["hpn_language=de", "hpn_units=lb_ft"]
    assert all("SameSite=lax" in cookie and "HttpOnly" in cookie for cookie in cookies)
    client.cookies.clear()


@pytest.mark.parametrize(
    "back", ["//evil.example", "https://evil.example/", "/\\evil.example", "javascript:alert(1)", "", "/\r\nX: y", "/ä"]
)
def test_settings_lead_nobody_to_another_site(back: str, client: TestClient) -> None:
    assert client.post("/reader", data={"language": "xx", "back": back}).headers["location"] == "/"


def test_another_site_changes_no_settings(client: TestClient) -> None:
    answer = client.post("/reader", data={"language": "de"}, headers={"Origin": "https://evil.example"})
    assert answer.status_code == 403
    assert "set-cookie" not in answer.headers


@pytest.mark.parametrize("method", ["GET", "PUT"])
def test_no_address_changes_settings(method: str, client: TestClient) -> None:
    assert client.request(method, "/reader?language=de&preset=US").status_code == 405
    assert "set-cookie" not in client.get(f"{EXAMPLE}&written=de.lb_in").headers


def test_a_link_shows_each_reader_their_own_units(client: TestClient) -> None:
    american, german = client.get(EXAMPLE, headers=AMERICAN).text, client.get(EXAMPLE, headers=GERMAN).text
    assert 'value="354.03"' in american
    assert re.search(r'value="40"\s+aria-label="Drehmoment, Phase 1, in Nm"', german)
    assert 'aria-label="Torque, phase 1, in lb·in"' in american


def test_a_form_in_a_readers_units_leads_to_the_link_of_everybody(client: TestClient) -> None:
    query = {"written": "de.lb_in", "was": "Nm:40", "T": "354,03", "n": "250", "t": "0,3", "bl": "", "Tk": "1.000,5"}
    answer = client.get("/", params=query, headers={"Cookie": "hpn_language=de; hpn_units=lb_in"})
    assert (answer.status_code, answer.headers["location"]) == (303, "/?T=40&n=250&t=0.3&Tk=113.041321442")


def test_a_form_with_an_error_keeps_what_was_typed(client: TestClient) -> None:
    query = {"written": "lb_in", "T": "354.030", "n": "1,5", "t": "1"}
    answer = client.get("/", params=query, headers={"Cookie": "hpn_units=lb_in"})
    assert answer.status_code == 422
    assert 'value="354.030"' in answer.text
    assert 'value="1,5"' in answer.text


def test_bounds_are_told_in_the_units_of_the_field(client: TestClient) -> None:
    answer = client.get("/?T=2e6&n=1&t=1", headers=AMERICAN)
    assert "must be at most 8\N{NARROW NO-BREAK SPACE}850\N{NARROW NO-BREAK SPACE}750" in answer.text
    assert "darf höchstens 1.000.000 sein" in client.get("/?T=2e6&n=1&t=1", headers=GERMAN).text


def test_the_API_speaks_the_wires_units_and_english_to_everybody(client: TestClient) -> None:
    body = {"duty_cycle": {"phases": [{"torque_Nm": 40, "speed_rpm": 250, "duration_s": 1}]}}
    headers = {"Cookie": "hpn_language=de; hpn_units=lb_in", "Accept-Language": "de"}
    answer = client.post("/api/v1/select", json=body, headers=headers)
    assert answer.json() == client.post("/api/v1/select", json=body).json()


@pytest.mark.parametrize(
    "cookie", ["hpn_language=fr; hpn_units=parsec", "hpn_units=" + "a." * 3000, "=;;=", 'hpn_language="de', "a=b; b\tc"]
)
def test_any_cookie_is_survived(cookie: str, client: TestClient) -> None:
    assert client.get("/", headers={"Cookie": cookie}).status_code == 200


@pytest.mark.parametrize(
    "query",
    [
        "written=de.lb_in&was=Nm:x Nm:1e999 :: q",
        "written=lb_in&was=Nm:1e308&T=1e400&n=1&t=1",
        "written=&was=",
        "was=1",
        "T=1e400&n=1&t=1",
    ],
)
def test_any_marker_of_a_form_is_survived(query: str, client: TestClient) -> None:
    assert client.get(f"/?{query}", headers=AMERICAN).status_code < 500
