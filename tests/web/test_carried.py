"""Inputs that the form does not show survive every door unchanged: motions, varying phases, motors."""

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlencode

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.application.input_fields import PHASE_FIGURES
from hpn.cli import main
from hpn.links.writer import to_link
from hpn.tables.cycles import read_text
from hpn.web.form.link_reader import parse
from tests.build import LIFTING, TURNING, cycle, phase

MOTOR = {"inertia_kgm2": 1e-4, "inertia_ratio": 5, "rated_speed_rpm": 3000, "peak_torque_Nm": 20}
VARYING = (
    phase(40, 250, 1, peak_torque_Nm=60.123456789, peak_speed_rpm=400, rms_torque_Nm=45, radial_N=300),
    phase(-20, 100, 2),
)
APPLICATIONS = {
    "rotary": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {"motor": MOTOR}},
    "linear": {"duty_cycle": {"motion": LIFTING}, "rank_by": "motor_torque"},
    "many moves": {"duty_cycle": {"motion": LIFTING | {"moves": LIFTING["moves"] * 60}}},
    "varying": cycle(*VARYING, requirements={"load_inertia_kgm2": 0.2, "motor": MOTOR}),
    "many phases": cycle(*VARYING * 60),
}


@pytest.fixture(params=APPLICATIONS, ids=str)
def application(request: pytest.FixtureRequest) -> Application:
    return Application.model_validate(APPLICATIONS[request.param])


def body_of(application: Application) -> dict[str, Any]:
    return application.model_dump(mode="json", exclude_none=True)


class Fields(HTMLParser):
    """Fields that the page's form submits, as a browser collects them, and its method."""

    def __init__(self) -> None:
        super().__init__()
        self.inside = self.area = ""
        self.method, self.select = "", ""
        self.pairs: list[tuple[str, str]] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Note a field of the form."""
        by_name = {name: value or "" for name, value in attributes}
        if tag == "form":
            self.inside = by_name.get("id", "")
            self.method = by_name["method"] if self.inside == "application" else self.method
        if self.inside != "application" and by_name.get("form") != "application":
            return
        if (
            tag == "input"
            and by_name.get("name")
            and (by_name.get("type") not in ("checkbox", "radio") or "checked" in by_name)
        ):
            self.pairs.append((by_name["name"], by_name.get("value", "")))
        elif tag == "select":
            self.select = by_name["name"]
        elif tag == "option" and "selected" in by_name:
            self.pairs.append((self.select, by_name["value"]))
        elif tag == "textarea":
            self.area = by_name["name"]
            self.pairs.append((self.area, ""))

    def handle_endtag(self, tag: str) -> None:
        """Leave the form or a field."""
        self.inside = "" if tag == "form" else self.inside
        self.area = "" if tag == "textarea" else self.area

    def handle_data(self, data: str) -> None:
        """Take the text of a field, without the line break after its tag."""
        if self.area:
            name, text = self.pairs.pop()
            self.pairs.append((name, text + (data if text else data.removeprefix("\n"))))


def opened(api: TestClient, application: Application, cookies: str = "") -> tuple[str, str, list[tuple[str, str]]]:
    """Page of a link: its text, the method of its form, and the fields that the form submits."""
    page = api.get(to_link(application), headers={"Cookie": cookies})
    assert page.status_code == 200
    fields = Fields()
    fields.feed(page.text)
    return page.text, fields.method, fields.pairs


@pytest.mark.parametrize("cookies", ["", "hpn_language=de; hpn_units=lb_in.lbf.deg_per_s"])
def test_the_form_of_a_link_submits_what_the_link_says(api: TestClient, application: Application, cookies: str) -> None:
    _, method, pairs = opened(api, application, cookies)
    headers = {"Cookie": cookies, "HX-Request": "true", "HX-Target": "result"}

    if method == "get":
        again = api.get(f"/?{urlencode(pairs)}", headers=headers)
    else:
        encoded = {"Content-Type": "application/x-www-form-urlencoded"}
        again = api.post("/", content=urlencode(pairs), headers=headers | encoded)

    assert again.status_code == 200
    assert again.headers["HX-Push-Url"] == to_link(application)


def test_typing_beside_a_motion_changes_nothing_else(api: TestClient) -> None:
    application = Application.model_validate(APPLICATIONS["rotary"])
    _, _, pairs = opened(api, application)

    typed = urlencode([(name, "3" if name == "tp" else value) for name, value in pairs])
    again = api.get(f"/?{typed}", headers={"HX-Request": "true"})

    assert again.headers["HX-Push-Url"] == to_link(application).replace("&tp=0.5", "&tp=3")


def test_saving_the_page_keeps_the_application_and_today_says_the_same(
    api: TestClient, application: Application
) -> None:
    text, _, _ = opened(api, application)
    link = to_link(application)

    answer = api.post("/selections", data={"link": link, "once": str(len(text))}, follow_redirects=False)

    place = answer.headers["location"]
    saved = api.get(f"/api/v1{place}").json()
    assert Application.model_validate(saved["application"]) == application
    assert saved["result"]["link"] == link
    assert (saved["today"]["difference_count"], saved["today"]["problem"]) == (0, None)
    assert api.get(place).status_code == 200
    copied = api.get(f"{place}/copy", follow_redirects=False)
    assert copied.status_code in (200, 303)


def test_saving_over_rest_keeps_the_application_and_its_files_open(api: TestClient, application: Application) -> None:
    saved = api.post("/api/v1/selections", json={"application": body_of(application)}).json()
    again = api.get(f"/api/v1/selections/{saved['id']}").json()
    assert Application.model_validate(again["application"]) == application
    for name in ("report.pdf", "report.xlsx", "submodel.aasx"):
        assert api.get(f"/api/v1/selections/{saved['id']}/{name}").status_code == 200
    assert api.get(f"/selections/compare?a={saved['id']}&b={saved['id']}").status_code == 200


def test_batches_answer_with_the_link(api: TestClient, application: Application) -> None:
    body = body_of(application)
    replies = api.post("/api/v1/select/batch", json={"applications": [body]}).json()["results"]
    lines = {"Content-Type": "application/x-ndjson"}
    streamed = api.post("/api/v1/select/batch", content=json.dumps(body), headers=lines).json()
    assert [reply["link"] for reply in (*replies, streamed)] == [to_link(application)] * 2


def test_files_of_a_link_are_of_its_application(api: TestClient, application: Application) -> None:
    query = to_link(application).removeprefix("/?")
    assert Application.model_validate(api.get(f"/application.json?{query}").json()) == application
    for path in ("/report.pdf", "/report.xlsx", "/submodel.aasx"):
        assert api.get(f"{path}?{query}").status_code == 200


def test_the_csv_of_a_cycle_has_its_phases_with_peaks_and_rms(api: TestClient, application: Application) -> None:
    text = api.get(f"/cycle.csv?{to_link(application).removeprefix('/?')}").text
    values = [tuple(getattr(phase, name) for name in PHASE_FIGURES) for phase in application.duty_cycle.load_phases]
    rows = [tuple(float(cell) if cell else None for cell in phase) for phase in read_text(text).phases]
    assert rows == values


def test_the_command_line_answers_with_the_link(
    application: Application, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "axis.json"
    file.write_text(json.dumps(body_of(application)))
    main(["select", "--json", str(file)])
    link = json.loads(capsys.readouterr().out)["link"]
    assert parse(parse_qsl(link.removeprefix("/?"), keep_blank_values=True)).application == application
