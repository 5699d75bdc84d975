"""Page of pairs: its ranking equals the answer of `POST /api/v1/pairs`, and a taken pair keeps its judgement."""

import re
from html import unescape
from urllib.parse import parse_qs, urlencode, urlsplit

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.links.writer import to_link
from tests.build import TURNING, Json, cycle, phase
from tests.web.test_motor_list_pages import hidden, kept, sent

SHEET = """Motor;M_N [Nm];M_max [Nm];n_N [rpm];n_max [rpm];J_m [kg·cm²];m [kg]
S40-0.6;0.64;1.9;3000;6000;0.17;0.9
S60-1.3;1.27;3.8;3000;6000;0.41;1.4
S80-2.4;2.39;7.2;3000;6000;1.14;2.7
"""
TYPED: Json = cycle(phase(10, 100, 1), phase(-8, 60, 0.5)) | {"requirements": {"load_inertia_kgm2": 0.05}}
MOVED: Json = {"duty_cycle": {"motion": TURNING}}


@pytest.fixture(scope="module")
def list_id(keeping: TestClient) -> str:
    """Id of a list of three motors."""
    return kept(keeping, "Three", SHEET).rpartition("/")[2]


def query(application: Json, **own: str) -> str:
    """Address of the pairs of an application."""
    link = to_link(Application.model_validate(application)).removeprefix("/?")
    return f"/pairs?{link}&{urlencode(own)}"


def ranked(page: str) -> list[tuple[str, str]]:
    """Gears and motors of the ranked table of a page."""
    start = page.index("pairs-table")
    rows = re.findall(r"<tr[^>]*>(.*?)</tr>", page[start : page.index("</table>", start)], re.S)[1:]
    plain = [re.sub(r"<[^>]+>", "|", row) for row in rows]
    cells = [[cell.strip() for cell in row.split("|") if cell.strip()] for row in plain]
    return [(row[1], row[2]) for row in cells]


def taken(page: str) -> str:
    """Address of the application with the chosen pair."""
    found = re.search(r'class="primary button" href="([^"]*)"', page)
    assert found
    return unescape(found[1])


@pytest.mark.parametrize("application", [TYPED, MOVED])
@pytest.mark.parametrize("by", ["weight", "utilisation", "inertia_ratio", "resonance"])
def test_the_page_ranks_as_the_api_does(keeping: TestClient, list_id: str, application: Json, by: str) -> None:
    body = {"application": application, "list": list_id, "rank_by": by, "best_of": "motor"}
    answer = keeping.post("/api/v1/pairs", json=body).json()

    page = keeping.get(query(application, list=list_id, by=by))

    assert page.status_code == 200
    assert ranked(page.text) == [(pair["designation"], pair["motor"]) for pair in answer["pairs"]]
    every = keeping.get(query(application, list=list_id, by=by, all="1", more="1")).text
    answer = keeping.post("/api/v1/pairs", json=body | {"best_of": None}).json()
    assert ranked(every) == [(pair["designation"], pair["motor"]) for pair in answer["pairs"]]


def test_a_pair_that_is_taken_judges_as_the_pair_did(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(MOVED, list=list_id)).text
    (pair, *_) = keeping.post("/api/v1/pairs", json={"application": MOVED, "list": list_id}).json()["pairs"]

    address = taken(page)

    given = parse_qs(urlsplit(address).query)
    assert given["gear"] == [pair["designation"]]
    motor = {"maximum_speed_rpm": "nm", "peak_torque_Nm": "Tm", "rated_torque_Nm": "Tmn", "inertia_kgm2": "Jm"}
    figures = {name: float(given[symbol][0]) for name, symbol in motor.items()}
    figures["rated_speed_rpm"] = float(given["nmr"][0])
    answer = keeping.post("/api/v1/select", json=MOVED | {"requirements": {"motor": figures}}).json()
    judged = next(one for one in answer["candidates"] if one["designation"] == pair["designation"])
    assert judged["status"] == pair["status"] == "suitable"
    assert judged["utilisation"] == pytest.approx(pair["utilisation"], rel=1e-12)  # one engine, another order of sums
    assert keeping.get(address).status_code == 200


def test_a_pair_has_its_pdf(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(MOVED, list=list_id)).text
    address = re.search(r'href="(/report\.pdf[^"]*)"', page)

    assert address and keeping.get(unescape(address[1])).content.startswith(b"%PDF")


def test_rejected_pairs_are_folded_by_the_check_that_fails(keeping: TestClient, list_id: str) -> None:
    answer = keeping.post("/api/v1/pairs", json={"application": TYPED, "list": list_id}).json()

    page = keeping.get(query(TYPED, list=list_id)).text

    folded = page[page.index("pairs-rejected") :]
    counts = [int(text) for text in re.findall(r"<strong>(\d+)</strong>", folded)]
    assert sorted(counts) == sorted(answer["failing"].values())
    assert counts == sorted(counts, reverse=True)


def test_a_marked_pair_is_looked_at_suitable_or_not(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(TYPED, list=list_id, at="HPN-11A-50 S80-2.4")).text

    heading = re.search(r'id="pair-heading">(.*?)</h2>', page, re.S)
    assert heading and "HPN-11A-50" in heading[1] and "S80-2.4" in heading[1]


def test_a_failing_pair_says_what_would_make_it_fit_as_its_selection_does(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(TYPED, list=list_id, at="HPN-11A-50 S60-1.3")).text
    remedy = re.search(r"<p>(Fits if [^<]*)</p>", page)

    assert "not suitable · " in " ".join(re.sub(r"<[^>]+>", "", page).split())
    assert remedy and unescape(remedy[1]) in unescape(keeping.get(taken(page)).text)
    beside = keeping.get(query(TYPED, list=list_id, at="HPN-11A-50 S60-1.3", fd="9999")).text
    assert "Fits if" not in beside  # a resonance that is too low has no remedy


def test_all_pairs_and_the_best_of_each_motor_are_a_link_apart(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(TYPED, list=list_id)).text
    (every,) = re.findall(r'<a href="(/pairs[^"]*)">All suitable pairs</a>', page)
    whole = keeping.get(unescape(every)).text
    (best,) = re.findall(r'<a href="(/pairs[^"]*)">Best of each motor</a>', whole)

    assert len(ranked(whole)) > len(ranked(page))
    assert ranked(keeping.get(unescape(best)).text) == ranked(page)


def test_bounds_stand_in_the_form_with_the_readers_decimal_mark(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(TYPED, list=list_id, fd="12.5") + "&eta=0.95", headers={"accept-language": "de"}).text

    assert 'value="0,95"' in page and 'value="12,5"' in page


def test_the_limit_of_the_drive_is_said_with_what_the_motor_would_do(keeping: TestClient, list_id: str) -> None:
    page = keeping.get(query(TYPED, list=list_id, at="HPN-11A-50 S80-2.4")).text

    assert "Set the drive’s torque limit to" in page
    assert "would put" in page


def test_bounds_of_pairs_are_read_from_the_form(keeping: TestClient, list_id: str) -> None:
    wide, narrow = (
        keeping.get(query(TYPED, list=list_id, all="1", more="1") + f"&Jr={Jr}").text for Jr in ("1e6", "0,5")
    )

    assert len(ranked(wide)) > (len(ranked(narrow)) if "pairs-table" in narrow else 0)
    assert "must be a number above 0" in keeping.get(query(TYPED, list=list_id) + "&Jr=x").text
    assert "must be a number above 0" in keeping.get(query(TYPED, list=list_id, fd="-1")).text


def test_a_list_that_is_pasted_on_the_page_leads_to_its_pairs(keeping: TestClient) -> None:
    link = query(TYPED).partition("?")[2].rstrip("&")
    shown = sent(keeping, {"text": SHEET, "link": link})

    answer = sent(keeping, {**hidden(shown.text), "name": "Pasted", "keep": "1"})

    assert answer.headers["location"].startswith(f"/pairs?{link}&list=")
    assert ranked(keeping.get(answer.headers["location"]).text)


def test_an_axis_of_a_machine_has_pairs_and_takes_one(keeping: TestClient, list_id: str) -> None:
    axes = [{"name": "Arm", "application": TYPED}]
    machine = {"title": "Line", "common": {"requirements": {"life_h": 5000}}, "axes": axes}
    id = keeping.post("/api/v1/machines", json=machine).json()["id"]

    page = keeping.get(f"/machines/{id}/axes/1/pairs?list={list_id}").text
    address = taken(page)

    assert address.startswith(f"/machines/{id}/axes/1?")
    given = parse_qs(urlsplit(address).query)
    assert "Tmn" in given and "Lh" not in given  # common values stay the machine's
    assert keeping.get(address).status_code == 200


def test_without_an_application_the_page_says_where_to_begin_and_shows_no_error(keeping: TestClient) -> None:
    page = keeping.get("/pairs")

    assert page.status_code == 200
    assert 'class="error"' not in page.text
    step = page.text[page.text.index("first-step") :].partition("</p>")[0]
    assert re.findall(r'href="([^"]*)"', step) == ["/", "/machines"]


def test_an_axis_without_a_cycle_leads_to_its_fields(keeping: TestClient) -> None:
    machine = {"title": "Open", "common": {}, "axes": [{"name": "Arm"}]}
    id = keeping.post("/api/v1/machines", json=machine).json()["id"]

    page = keeping.get(f"/machines/{id}/axes/1/pairs")

    assert page.status_code == 200 and 'class="error"' not in page.text
    assert f'href="/machines/{id}/axes/1"' in page.text[page.text.index("first-step") :]


def figures(page: str) -> list[str]:
    """Facts of the axis on a page, each in one line."""
    part = page[page.index("pairs-axis") : page.index("</dl>", page.index("pairs-axis"))]
    return [
        " ".join(unescape(re.sub(r"<[^>]+>", " ", fact)).split()) for fact in re.findall(r"<dd>(.*?)</dd>", part, re.S)
    ]


def test_the_axis_stands_beside_its_pairs(keeping: TestClient, list_id: str) -> None:
    """TYPED has 10 Nm at 100 rpm and 8 Nm at 60 rpm; the service's answer has T_max and n_out,max of the motion."""
    typed = figures(keeping.get(query(TYPED, list=list_id)).text)
    assert typed == ["10 Nm · 100 rpm · 1 s −8 Nm · 60 rpm · 0.5 s", "0.05 kg·m²", "10 Nm", "100 rpm"]

    moved = figures(keeping.get(query(MOVED, list=list_id)).text)
    duty = keeping.post("/api/v1/select", json=MOVED).json()["duty"]
    shown = [float(text.split()[0].replace("\u202f", "")) for text in moved[1:]]
    names = ("load_inertia_kgm2", "maximum_torque_Nm", "maximum_output_speed_rpm")
    assert shown == pytest.approx([duty[name] for name in names], rel=5e-3)  # three digits are shown


def test_a_screenful_of_motors_is_open_and_the_rest_folded_with_its_count(keeping: TestClient) -> None:
    text = "Motor;M_N [Nm];M_max [Nm]\n" + "".join(f"M{k};1.5;5\n" for k in range(1, 316))
    id = kept(keeping, "Many motors", text).rpartition("/")[2]

    page = keeping.get(query(TYPED, list=id)).text

    before, _, folded = page[page.index("pairs-form") :].partition("303 further motors")
    assert (before.count('scope="row"'), folded.partition("</details>")[0].count('scope="row"')) == (12, 288)
    assert "M_0" not in before and '<var class="symbol">J' not in before  # figures that no motor has
    assert f'href="/motor-lists/{id}"' in folded


@pytest.mark.parametrize(
    "tail",
    [
        "",
        "?list=x",
        "?T=x",
        "?T=1&n=1&t=1&at=%00",
        "?T=1&n=1&t=1&fd=1e999",
        "?T=1&n=1&t=1&Jr=nan",
        "?all=" + "9" * 5000,
    ],
)
def test_no_address_breaks_the_page(keeping: TestClient, list_id: str, tail: str) -> None:
    assert keeping.get(f"/pairs{tail}").status_code in (200, 422)


def test_the_limit_of_a_pair_is_one_figure_in_sentence_and_column(keeping: TestClient, list_id: str) -> None:
    """T_R / i by hand: 26 / 30 = 0.8666… Nm for HPN-11A-30, which three digits would raise to 0.867."""
    page = keeping.get(query(TYPED, list=list_id, all="1", more="1", at="HPN-11A-30 S80-2.4")).text

    assert "0.8666\u202fNm" in page and '<td class="figure">0.8666</td>' in page
