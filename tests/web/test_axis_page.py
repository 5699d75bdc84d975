"""Page of an axis: own and inherited values, saving, and two people on one axis."""

import re
from collections.abc import Iterator
from html import unescape
from html.parser import HTMLParser
from typing import Any
from urllib.parse import parse_qsl, urlencode

import pytest
from starlette.testclient import TestClient

from hpn.links.writer import to_link
from hpn.web.app import create_app
from hpn.web.form import link_reader
from hpn.web.form.own_part import carried_over, pairs_of_own, written
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example

COMMON: Json = {"requirements": {"utilisation": 0.9, "life_h": 20000}, "rank_by": "utilisation"}
OWN: Json = worked_example(requirements={"utilisation": 1.0, "ratios": [5]})
AXES: list[Json] = [
    {"name": "X1", "application": cycle(phase(20, 300))},
    {"name": "Y bridge", "quantity": 2, "application": OWN, "without": ["requirements.life_h"]},
    {"name": "not ready", "application": {"requirements": {"life_h": 1000}}},
]
HTMX = {"HX-Request": "true", "HX-Target": "section#result"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = Settings(database_url=f"sqlite:///{tmp_path_factory.mktemp('axes')}/kept.sqlite3")
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of the page of a machine."""
    answer = client.post("/api/v1/machines", json={"title": "Packing line", "common": COMMON, "axes": AXES})
    assert answer.status_code == 201, answer.text
    return f"/machines/{answer.json()['id']}"


def axis_of(client: TestClient, place: str) -> Json:
    reply: Json = client.get(f"/api/v1{place}").json()
    return reply


class Fields(HTMLParser):
    """Fields of the page's form, as a browser sends them."""

    def __init__(self) -> None:
        super().__init__()
        self.pairs: list[tuple[str, str]] = []
        self.inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        by_name = {name: value or "" for name, value in attrs}
        if tag in ("form", "template"):
            self.inside.append(by_name.get("id", ""))
        of_form = self.inside == ["application"] or by_name.get("form") == "application"
        if tag == "option" and self.inside == ["application"]:
            if "selected" in by_name:
                self.pairs[-1] = (self.pairs[-1][0], by_name["value"])
        elif of_form and "name" in by_name and tag in ("input", "select", "textarea"):
            is_left_out = by_name.get("type") in ("checkbox", "radio") and "checked" not in by_name
            self.pairs += [] if is_left_out else [(by_name["name"], by_name.get("value", ""))]

    def handle_endtag(self, tag: str) -> None:
        if tag in ("form", "template"):
            self.inside.pop()


def fields_of(html: str) -> list[tuple[str, str]]:
    """Fields of the form of a page."""
    result = Fields()
    result.feed(html)
    return result.pairs


def saved(client: TestClient, place: str, html: str, **changed: str) -> Any:
    """Answer to saving the form of a page with some fields changed."""
    pairs = [(name, changed.get(name, value)) for name, value in fields_of(html)]
    return client.post(f"{place}/save", data={"link": f"/?{urlencode(pairs)}"})


def test_an_axis_opens_with_its_own_values_and_what_it_inherits_in_grey(client: TestClient, machine: str) -> None:
    html = client.get(f"{machine}/axes/2").text

    assert "Packing line" in html and "2 of 3" in html
    own = dict(fields_of(html))
    assert (own["name"], own["quantity"], own["u"], own["i"], own["wo"]) == ("Y bridge", "2", "1", "5", "Lh")
    assert own["rank"] == ""  # inherited
    first = client.get(f"{machine}/axes/1").text
    assert re.search(r'id="f-u"[^>]*value=""[^>]*placeholder="0.9"', first)
    assert re.search(r'id="f-Lh"[^>]*value=""[^>]*placeholder="20000"', first)


def test_what_is_opened_and_saved_again_is_as_it_was(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/2"
    before = axis_of(client, place)

    answer = saved(client, place, client.get(place).text)

    assert (answer.status_code, answer.headers["location"]) == (303, place)
    after = axis_of(client, place)
    for name in ("name", "quantity", "note", "ordering_code", "without", "application", "resolved"):
        assert after[name] == before[name]  # u = 1 is the default, and stays own under a common 0.9
    assert after["application"]["requirements"]["utilisation"] == 1


def test_a_changed_torque_is_saved_back_and_the_next_axis_is_a_link(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/1"
    html = client.get(place).text
    assert re.search(rf'href="{machine}/axes/2"[^>]*aria-keyshortcuts="\]"', html)

    assert saved(client, place, html, T="24").status_code == 303

    result = axis_of(client, place)
    assert result["application"]["duty_cycle"]["phases"][0]["torque_Nm"] == 24
    assert result["resolved"]["requirements"]["utilisation"] == 0.9
    assert axis_of(client, f"{machine}/axes/2")["application"] == OWN


def test_what_is_typed_stands_in_the_address_with_how_the_axis_was_opened(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/1"
    fields = fields_of(client.get(place).text)

    unchanged = client.get(f"{place}?{urlencode(fields)}", headers=HTMX)
    assert unchanged.headers["hx-push-url"] == place
    changed = [(name, "24" if name == "T" else value) for name, value in fields]
    address = client.get(f"{place}?{urlencode(changed)}", headers=HTMX).headers["hx-push-url"]
    assert address.startswith(f"{place}?T=24&n=300")
    assert "u=" not in address.partition("&opened=")[0]  # it is the machine's
    again = client.get(address)
    assert again.status_code == 200 and ("T", "24") in fields_of(again.text)


def test_a_field_leaves_the_common_value_and_takes_it_again(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/1"
    fields = fields_of(client.get(place).text)
    left = client.get(f"{place}?{urlencode([*fields, ('do', 'without:u')])}").text
    assert ("wo", "u") in fields_of(left)

    assert saved(client, place, left).status_code == 303
    result = axis_of(client, place)
    assert result["without"] == ["requirements.utilisation"] and "utilisation" not in result["resolved"]["requirements"]

    fields = fields_of(client.get(place).text)
    taken = client.get(f"{place}?{urlencode([*fields, ('do', 'common:u')])}").text
    assert saved(client, place, taken).status_code == 303
    assert axis_of(client, place)["without"] == []


def test_an_open_axis_opens_and_is_saved_while_it_has_no_cycle(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/3"
    html = client.get(place)
    assert html.status_code == 200 and dict(fields_of(html.text))["Lh"] == "1000"

    assert saved(client, place, html.text, name="later", quantity="3").status_code == 303

    result = axis_of(client, place)
    assert (result["name"], result["quantity"], result["answer"]["status"]) == ("later", 3, "open")
    assert result["application"] == {"requirements": {"life_h": 1000}}


def test_two_people_on_one_axis_lose_nothing(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/1"
    html = client.get(place).text
    assert saved(client, place, html, T="24", name="X left").status_code == 303

    second = saved(client, place, html, n="350")

    assert second.status_code == 412
    rows = re.findall(r"<tr[^>]*>\s*<th scope=\"row\">(.*?)</tr>", second.text, re.S)
    cells = [
        [re.sub(r"<[^>]+>|\s+", " ", cell).strip() for cell in re.findall(r"<td[^>]*>(.*?)</td>", row, re.S)]
        for row in rows
    ]
    assert cells == [["20", "24", "20"], ["300", "300", "350"], ["X1", "X left", "X1"]]
    assert axis_of(client, place)["application"]["duty_cycle"]["phases"][0]["torque_Nm"] == 24

    together = re.search(r'class="primary button"\s+href="([^"]+)"', second.text)
    assert together
    joined = client.get(unescape(together[1])).text
    own = dict(fields_of(joined))
    assert (own["T"], own["n"], own["name"]) == ("24", "350", "X left")
    assert saved(client, place, joined).status_code == 303
    phases = axis_of(client, place)["application"]["duty_cycle"]["phases"]
    assert (phases[0]["torque_Nm"], phases[0]["speed_rpm"]) == (24, 350)


def test_a_form_that_is_sent_twice_is_saved_once(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/1"
    html = client.get(place).text
    assert saved(client, place, html, T="24").status_code == 303
    assert saved(client, place, html, T="24").status_code == 303  # a repeat, as if the first answer was lost


def test_a_pasted_table_stays_on_the_axis(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/2"
    fields = fields_of(client.get(place).text)
    answer = client.post("/paste", data={"link": urlencode(fields), "text": "T\tn\tt\n10\t100\t1\n", "take": "replace"})
    assert answer.status_code == 303 and answer.headers["location"].startswith(f"{place}?")
    own = fields_of(client.get(answer.headers["location"]).text)
    assert [text for name, text in own if name == "T"] == ["10"] and ("u", "1") in own and ("wo", "Lh") in own


def test_an_axis_says_which_others_have_its_gear(client: TestClient) -> None:
    """Two ways that agree: the page of an axis, and the order of gears over REST; removed axes are in neither."""
    same, other = cycle(phase(20, 300)), cycle(phase(200, 100))
    axes = [{"name": f"Lift {n}", "quantity": n, "application": same} for n in range(1, 8)]
    axes += [{"name": "Press", "application": other}, {"application": other}, {"name": "open", "application": {}}]
    machine = client.post("/api/v1/machines", json={"title": "Packing line", "axes": axes}).json()["url"]
    assert client.delete(f"/api/v1{machine}/axes/7").status_code == 204
    lifts, presses = client.get(f"/api/v1{machine}/gears").json()["gears"]

    def said(number: int) -> str:
        page = client.get(f"{machine}/axes/{number}").text
        match = re.search(r'<section[^>]*aria-labelledby="alike-heading".*?</section>', page, re.DOTALL)
        return " ".join(re.sub("<[^>]+>", " ", unescape(match[0])).split()) if match else ""

    gear = lifts["designation"]
    assert lifts["quantity"] == 21
    assert said(2) == (f"In this machine 21 gears of this kind Lift 1, Lift 3, Lift 4 and 2 more axes have {gear} too.")
    assert f'href="{machine}?gear={gear}"' in client.get(f"{machine}/axes/2").text
    assert (
        said(9) == f"In this machine {presses['quantity']} gears of this kind Press has {presses['designation']} too."
    )
    assert said(8).endswith(f"Axis 9 has {presses['designation']} too.")
    assert said(10) == ""
    edited = client.get(f"{machine}/axes/2?T=200&n=100&t=1", headers=HTMX).text
    assert presses["designation"] in edited and "Press, Axis 9" in edited


@pytest.mark.parametrize("place", ["axes/4", "axes/0", "axes/x", "axes/99999999999"])
def test_an_axis_that_is_not_there_is_a_page_with_the_reason(client: TestClient, machine: str, place: str) -> None:
    answer = client.get(f"{machine}/{place}")
    assert answer.status_code == 404 and "<h2>" in answer.text


@pytest.mark.parametrize(
    "query",
    ["quantity=x&T=1&n=1&t=1", "v=1&T=1&n=1&t=1&opened=%FF&wo=zz", "u=abc", "do=without:zz", "v=99&u=1&opened=a"],
)
def test_no_query_of_an_axis_is_an_error_of_the_server(client: TestClient, machine: str, query: str) -> None:
    assert client.get(f"{machine}/axes/1?{query}").status_code in (200, 422)
    assert client.post(f"{machine}/axes/1/save", data={"link": f"/?{query}"}).status_code in (303, 412, 422)


def test_an_own_part_is_read_back_from_its_pairs_as_it_was_sent() -> None:
    assert written(pairs_of_own({})) == "T=&n=&t="
    seen: list[Json] = []

    def whole(document: Json) -> Json:
        seen[:] = [document]
        return document

    link_reader.parse(parse_qsl(written(pairs_of_own(OWN)), keep_blank_values=True), whole)
    assert seen[0] == OWN


def test_a_link_to_another_application_keeps_what_is_inherited() -> None:
    def pairs(own: Json) -> list[tuple[str, str]]:
        application = link_reader.parse(pairs_of_own(own)).application
        assert application
        return parse_qsl(to_link(application).partition("?")[2])

    own = {"duty_cycle": {"phases": [phase(20, 300)]}}
    now = pairs(own | {"requirements": {"utilisation": 0.9, "life_h": 20000.0}})
    then = pairs(
        {"duty_cycle": {"phases": [phase(10, 300)]}} | {"requirements": {"utilisation": 0.9, "life_h": 10000.0}}
    )
    result = carried_over(now, then, pairs_of_own(own), {"u", "Lh"})
    assert result == [("T", "10"), ("n", "300"), ("t", "1"), ("Lh", "10000")]
    assert ("wo", "Lh") in carried_over(
        now, pairs(own | {"requirements": {"utilisation": 0.9}}), pairs_of_own(own), {"u", "Lh"}
    )


# --- Revisions --------------------------------------------------------------------------------------------------------


def frozen_as(client: TestClient, machine: str, label: str, **block: str) -> None:
    api = f"/api/v1{machine}"
    condition = {"If-Match": client.get(api).headers["etag"]}
    answer = client.post(f"{api}/revisions", json={"label": label, **block}, headers=condition)
    assert answer.status_code == 201, answer.text


def test_an_axis_names_the_revisions_of_its_machine_below_its_input(client: TestClient, machine: str) -> None:
    place = f"{machine}/axes/2"
    assert 'class="chain' not in client.get(place).text  # nothing is saved yet

    frozen_as(client, machine, "A", author="MA", note="first issue")
    frozen_as(client, machine, "B")
    page = client.get(place).text
    chain = page[page.index('<ol class="chain') : page.index("Compare revisions")]

    assert page.index('id="application"') < page.index('<ol class="chain') < page.index("</form>", page.index("chain"))
    assert re.findall(r'href="([^"]*)"', chain) == [
        f"{machine}?revision=B#axis-2",
        f"{machine}?revision=A#axis-2",
        f"{machine}/revisions",
    ]
    assert "first issue" in chain and ", MA" in chain and chain.count('aria-current="true"') == 1
    assert 'id="axis-2"' in client.get(f"{machine}?revision=A").text


def test_a_refused_save_keeps_the_revisions_and_the_axes_with_the_same_gear(client: TestClient, machine: str) -> None:
    frozen_as(client, machine, "A")
    refused = client.post(f"{machine}/axes/1/save", data={"T": "x", "n": "300", "t": "1"})

    assert "needs correction" in refused.text and f'href="{machine}?revision=A#axis-1"' in refused.text


def test_a_part_of_the_page_of_an_axis_keeps_the_revisions_that_it_lacks(client: TestClient, machine: str) -> None:
    frozen_as(client, machine, "A")
    part = client.get(f"{machine}/axes/2", headers={"HX-Request": "true"}).text

    assert '<div id="revisions" hx-preserve>' in part and 'class="chain' not in part


def test_the_axis_of_a_selection_leads_to_the_revisions_of_the_selection(client: TestClient) -> None:
    saved = client.post("/api/v1/selections", json={"application": worked_example()}).json()["id"]
    page = client.get(f"/machines/{saved}/axes/1").text

    assert f'href="/selections/{saved}?revision=saved"' in page and f'href="/selections/{saved}/revisions"' in page
