"""Live page and its assets over HTTP."""

import gzip
import re
from collections.abc import Iterator
from html import unescape

import brotli
import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient

from hpn.links.row_symbols import PHASE_SYMBOLS
from hpn.links.symbols import SYMBOLS
from hpn.web.app import create_app
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.words.quantities import QUANTITIES

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
HTMX = {"HX-Request": "true"}


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app()) as client:
        yield client


def heading(html: str) -> str:
    """Designation in big type; blank without one."""
    found = re.search(r'<h2 class="designation"[^>]*>\s*(?:<a [^>]*>)?([^<\s]+)', html)
    return found[1] if found else ""


def lasting(html: str) -> str:
    """Page without the one-time keys of its buttons to save."""
    return re.sub(r'(name="once" value=")[A-Za-z0-9_-]{22}"', r'\1"', html)


def test_page_without_a_query_is_the_worked_example(client: TestClient) -> None:
    bare, linked = client.get("/"), client.get(EXAMPLE)
    assert bare.status_code == 200
    assert heading(bare.text) == "HPN-20A-5"
    first, save = r'<section class="first".*?</section>\s*', r'class="(quiet|primary)( script-only" title="Keeps)'
    told = re.sub(first, "", bare.text, flags=re.S)
    assert told != bare.text and re.search(first, linked.text) is None
    # only the text for a first visit, and the look of Save beside it, differ
    assert re.sub(save, r'class="\2', lasting(told)) == re.sub(save, r'class="\2', lasting(linked.text))


def test_page_agrees_with_the_API(client: TestClient) -> None:
    query = EXAMPLE.replace("&i=5", "&Lh=20000&FR=500&u=0.9")
    page = client.get(query).text
    body = {
        "duty_cycle": {
            "phases": [
                {"torque_Nm": T, "speed_rpm": n, "duration_s": t}
                for T, n, t in ((40, 250, 0.3), (32, 500, 3), (20, 250, 0.4))
            ],
            "pause_s": 4,
        },
        "emergency_stop": {"torque_Nm": 200},
        "output_load": {"radial_N": 500},
        "requirements": {"life_h": 20000, "utilisation": 0.9},
    }
    reply = client.post("/api/v1/select", json=body).json()
    assert heading(page) == reply["selected"]
    listed = re.findall(r'<tr id="row-(HPN-\w+-\d+)" class="(\w+)', page)
    # Rejected gears are listed by size, sizes in the order of their nearest gear.
    sizes = list(dict.fromkeys(c["size"] for c in reply["candidates"] if c["status"] == "unsuitable"))
    ranked = [c for c in reply["candidates"] if c["status"] == "suitable"]
    rejected = [c for size in sizes for c in reply["candidates"] if (c["size"], c["status"]) == (size, "unsuitable")]
    unrated = [c["designation"] for c in reply["candidates"] if c["status"] == "unrated"]
    assert listed == [(c["designation"], c["status"]) for c in (*ranked, *rejected)]
    assert re.findall(r">(HPN-\w+-\d+)</a>", page[page.index('id="unrated"') :])[: len(unrated)] == unrated
    shown = [float(value) for value in re.findall(r'class="percent"\s+data-value="([^"]+)"', page)]
    best = next(c for c in reply["candidates"] if c["designation"] == reply["selected"])
    assert shown[: len(best["checks"])] == [check["utilisation"] for check in best["checks"]]


def test_htmx_gets_the_part_that_changes_and_the_canonical_address(client: TestClient) -> None:
    part = client.get("/?T=40.0&n=250&t=0.30&rank=weight&Tk=&gear=14-5", headers=HTMX)
    assert "<html" not in part.text
    assert "<form" in part.text
    assert part.headers["HX-Push-Url"] == "/?T=40&n=250&t=0.3&gear=HPN-14A-5"
    assert "HX-Request" in part.headers["Vary"]


@pytest.mark.parametrize("headers", [{}, HTMX], ids=["page", "part"])
@pytest.mark.parametrize(
    ("query", "field", "message"),
    [
        ("/?T=9,3&n=250&t=0.3", "e-T-0", "write 9.3"),
        ("/?T=40&n=250&t=0.3&T=30", "e-n-1", "missing"),
        ("/?T=40&n=250&t=0.3&Tk=1&Tk=2", "e-Tk", "must be a single value"),
        ("/?T=40&n=250&t=0.3&u=1.5", "e-u", "must be at most 1"),
    ],
)
def test_error_is_422_with_the_form_the_input_and_the_message(
    client: TestClient, query: str, field: str, message: str, headers: dict[str, str]
) -> None:
    response = client.get(query, headers=headers)
    assert response.status_code == 422
    assert re.search(rf'id="{field}">{message}', response.text)
    assert f'aria-describedby="{field}' in response.text
    first = re.search("T=([^&]*)", query)
    assert first and f'value="{first[1]}"' in response.text
    assert "HX-Push-Url" not in response.headers


def test_unknown_name_is_422_and_suggests_the_nearest(client: TestClient) -> None:
    response = client.get("/?T=40&n=250&t=0.3&ratio=5")
    assert response.status_code == 422
    assert "ratio is not a parameter of this page; did you mean i?" in response.text


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ("i=6", "the catalogue has no 6"),
        ("size=99", "the catalogue has no 99A"),
        ("size=11A&i=3", "there is no gear of this size and ratio"),
        ("gear=HPN-99A-5", "HPN-99A-5 is not a gear of the catalogue"),
        ("FR=100&bm=digitised", "bearing_envelopes.csv"),
    ],
)
def test_wish_that_nothing_can_meet_is_422_and_says_what_there_is(client: TestClient, wish: str, message: str) -> None:
    response = client.get(f"/?T=40&n=250&t=0.3&{wish}")
    assert response.status_code == 422
    assert message in response.text


def test_input_is_shown_as_text_never_as_markup(client: TestClient) -> None:
    attack = "%22%3E%3Cscript%3Ealert(1)%3C/script%3E%3Chx-partial%3E"
    for name in [s.name for s in (*SYMBOLS, *PHASE_SYMBOLS)] + ["gear", "do", attack]:
        response = client.get(f"/?T=40&n=250&t=0.3&{name}={attack}", headers=HTMX)
        assert "<script" not in response.text
        assert response.text.count("<hx-partial") == response.text.count("<hx-partial hx-target=")  # the page's own


@given(st.binary(max_size=300))
def test_no_query_is_a_server_error(query: bytes) -> None:
    with TestClient(app, raise_server_exceptions=True) as client:
        assert (
            client.get(
                "/?" + "".join(f"%{byte:02x}" if byte % 3 else chr(byte % 64 + 60) for byte in query)
            ).status_code
            < 500
        )


app = create_app()


@pytest.mark.parametrize(
    "value", ["1e999", "nan", "-inf", "0x10", "%D9%A4", "%00", "1e308", "-1e308", "1e-300", "5e-324", "9" * 5000]
)
@pytest.mark.parametrize("name", [s.name for s in (*SYMBOLS, *PHASE_SYMBOLS)])
def test_odd_values_are_answered_in_every_field(client: TestClient, name: str, value: str) -> None:
    assert client.get(f"/?T=40&n=250&t=0.3&Tk=50&FR=10&FRi=&FAi=&{name}={value}").status_code in (200, 422)


def test_link_that_is_too_long_is_414_and_names_the_API(client: TestClient) -> None:
    response = client.get("/?T=" + "9" * MAXIMUM_QUERY_BYTES)
    assert response.status_code == 414
    assert "/api/v1/select" in response.text


def test_long_cycle_within_the_limit_is_answered_without_repeating_it_per_gear(client: TestClient) -> None:
    query = "&".join(["T=40&n=250&t=0.3"] * 1500)
    response = client.get("/?" + query, headers=HTMX)
    assert response.status_code == 200
    # Once in the form that saves and makes files, not again for each file or gear.
    assert response.text.count("T=40&amp;n=250&amp;t=0.3") == 1500
    assert '<button type="submit" form="application" name="gear" value="HPN-32A-5"' in response.text


def test_assets_are_hashed_immutable_and_precompressed(client: TestClient) -> None:
    page = client.get("/").text
    addresses = re.findall(r'(?:href|src)="(/static/[^"]+)"', page)
    assert {address.rpartition(".")[2] for address in addresses} == {"css", "js", "svg", "woff2"}
    for address in addresses:
        plain = client.get(address, headers={"Accept-Encoding": "identity"})
        assert plain.headers["Cache-Control"] == "public, max-age=31536000, immutable"
        assert re.search(r"\.[0-9a-f]{8}\.", address)
        if address.endswith(".woff2"):
            continue  # its format is compressed
        for coding, unpack in (("br", brotli.decompress), ("gzip", gzip.decompress)):
            with client.stream("GET", address, headers={"Accept-Encoding": coding}) as packed:
                assert packed.headers["Content-Encoding"] == coding
                assert packed.headers["Vary"] == "Accept-Encoding"
                assert packed.headers["Content-Type"] == plain.headers["Content-Type"]
                assert unpack(b"".join(packed.iter_raw())) == plain.content


def test_typeface_is_light_goes_with_its_licence_and_is_no_original_name(client: TestClient) -> None:
    """Upright and italic have 40 kB at most; the licence reserves the name of the original."""
    page = client.get("/").text
    sheet = re.search(r'href="(/static/page\.[^"]+\.css)"', page)
    assert sheet
    style = client.get(sheet[1]).text
    faces = [client.get(f"/static/{name}") for name in re.findall(r"url\((hpn-sans[^)]+)\)", style)]
    licence = client.get(client.app.state.assets.url("hpn-sans.txt"))  # type: ignore[attr-defined]

    assert [face.content[:4] for face in faces] == [b"wOF2"] * 2
    assert {face.headers["Content-Type"] for face in faces} == {"font/woff2"}
    assert sum(len(face.content) for face in faces) <= 40_000
    assert "font-family:HPN Sans" in style
    assert "SIL OPEN FONT LICENSE" in licence.text.upper()


@pytest.mark.parametrize(
    "name", ["page.css", "manifest.json", "../static/app.css", "..%2f..%2fbuild.py", "%00", "x" * 5000]
)
def test_only_built_files_are_served(client: TestClient, name: str) -> None:
    assert client.get(f"/static/{name}").status_code == 404


def test_a_new_row_leaves_the_title_block_folded_and_a_gear_that_nobody_makes_is_asked_for_once(
    client: TestClient,
) -> None:
    form = client.get("/?T=40&n=250&t=0.3&order_output=J6&do=add", headers={"HX-Request": "true"}).text
    refused = client.get("/?T=40&n=250&t=0.3&gear=HPN-99A-5")
    assert '<details class="group" id="group-title">' in form
    assert refused.status_code == 422 and "HPN-99A-5 is not a gear" in refused.text
    assert 'id="chosen-gear" value=""' in refused.text


def test_first_view_stays_light(client: TestClient) -> None:
    """60 kB for everything but plots and fonts, with the page compressed as by a proxy."""
    page = client.get("/")
    addresses = set(re.findall(r'(?:href|src)="(/static/[^"]+(?<!\.woff2))"', page.text))
    total = len(gzip.compress(page.content))
    for address in addresses:
        with client.stream("GET", address, headers={"Accept-Encoding": "br"}) as packed:
            total += len(b"".join(packed.iter_raw()))
    assert total < 60_000, total


def figure(html: str, name: str) -> str:
    """Text of a figure of the verdict."""
    found = re.search(rf"<dt[^>]*>{name}.*?</dt><dd>(.*?)</dd>", html, re.S)
    assert found, name
    return re.sub("<[^>]*>", "", found[1]).strip()


def test_a_gear_whose_rating_lacks_has_no_unlimited_life(client: TestClient) -> None:
    query = {"T": 100, "n": 10, "t": 1, "Tk": 5000}
    unrated = client.get("/", params=query | {"gear": "HPN-40A-5", "bl": 4}).text
    free = client.get("/", params=query | {"T": 0, "Tk": 1, "gear": "HPN-20A-5"}).text
    unasked = client.get("/", params={"T": 0, "n": 10, "t": 1, "gear": "HPN-20A-5"}).text

    assert (figure(unrated, "Gear life"), figure(unrated, "Permitted emergency stops")) == ("–", "–")
    assert (figure(free, "Gear life"), figure(free, "Permitted emergency stops")) == ("unlimited", "unlimited")
    assert (figure(unasked, "Gear life"), figure(unasked, "Permitted emergency stops")) == ("unlimited", "–")


def test_a_motor_gives_no_figures_to_the_row_of_a_size_without_ratings(client: TestClient) -> None:
    page = client.get("/", params={"T": 40, "n": 250, "t": 0.3, "nm": 300, "Tm": 20}).text
    row = re.search(r'<th scope="row">40A</th>(.*?)</tr>', page, re.S)
    assert row and "Not rated: figures of HPN-40A" in row[1] and "<button" not in row[1]


def test_map_and_candidates_say_alike_which_gears_without_ratings_fail_in_any_case(client: TestClient) -> None:
    query = {"T": 10, "n": 250, "t": 0.3, "nm": 3000}
    body = {"duty_cycle": {"phases": [{"torque_Nm": 10, "speed_rpm": 250, "duration_s": 0.3}]}}
    motor = {"requirements": {"motor": {"maximum_speed_rpm": 3000}}}
    reply = client.post("/api/v1/select", json=body | motor).json()
    failing = [c for c in reply["candidates"] if (c["size"], c["status"]) == ("40A", "unsuitable")]
    page = client.get("/", params=query).text

    assert len(failing) > 1 and f"{len(failing)} gears fail in any case." in page
    group = re.search(r'id="rejected-40A".*?</summary>', page, re.S)
    assert group and f"{len(failing)} gears" in group[0] and "The other checks are not rated." in group[0]


def test_the_printed_page_says_whose_it_is_of_when_and_where_it_stands(client: TestClient) -> None:
    page = client.get("/", params={"T": 40, "n": 250, "t": 0.3, "title": "Axis 7", "author": "M. M.", "rev": "B"}).text
    head = re.search(r'<p class="on-paper">(.*?)</p>', page, re.S)
    assert head and re.search(r"Axis 7 · M. M. · Revision B · \d{4}-\d\d-\d\d\s", head[1])
    assert re.search(r"http://testserver/\?T=40&amp;n=250&amp;t=0.3&amp;title=Axis\+7", head[1])

    long = client.get("/?" + "&".join(["T=40&n=250&t=0.3"] * 60)).text
    assert "Save the selection to print a short link." in long


def test_a_default_in_a_field_is_written_as_results_are(client: TestClient) -> None:
    page = client.get("/", headers={"Accept-Language": "de"}).text
    assert re.search(r'id="f-Lb".*?placeholder="20\.000"', page, re.S)


def test_the_drive_says_once_what_the_motor_torques_leave_out(client: TestClient) -> None:
    page = client.get("/", params={"T": 10, "n": 250, "t": 0.3, "nm": 3000, "Tm": 9}).text
    drive = page[page.index('id="drive"') : page.index('id="candidates"')]
    assert drive.count("a lower bound") == len(re.findall(r"η = 1[^.]*a lower bound", drive)) == 1


def test_an_unlimited_limit_keeps_its_sign(client: TestClient) -> None:
    page = client.get("/", params={"T": 40, "n": 250, "t": 0.3, "Tk": 41, "Nk": 500, "gear": "HPN-32A-4"}).text
    assert re.search(r'id="check-momentary_peak_count".*?<span class="sign">≤</span>\s*unlimited', page, re.S)


def test_a_life_is_named_with_its_basis_and_a_column_with_its_unit(client: TestClient) -> None:
    page = client.get("/", params={"T": 40, "n": 250, "t": 0.3, "FR": 500}).text
    assert re.search(r">Bearing life L50</dt>\s*<dd>", page) and "L50, asked" not in page
    assert re.search(r">\s*radial\s<span class=\"unit\">N</span>", page)


@pytest.mark.parametrize(
    ("section", "names"),
    [
        ("candidates", ["life_L10_h"]),
        ("compare", ["life_L10_h", "bearing_life_L10_h"]),
        ("bearing", ["bearing_life_L10_h"]),
    ],
)
def test_where_a_life_stands_its_basis_stands_too(client: TestClient, section: str, names: list[str]) -> None:
    asked = client.get(EXAMPLE + "&FR=500", headers={"HX-Request": "true", "HX-Target": f"section#{section}"}).text

    caveats = " ".join(re.findall(r'<(?:p class="hint caveat|span class="below)">(.*?)</', asked, re.S))
    for named in names:
        assert QUANTITIES[f"candidate.{named}"].caveat in caveats


def test_sentences_below_the_cycle_stand_apart(api: TestClient) -> None:
    page = api.get("/?T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&Tk=200").text
    assert re.search(r"Pause 4.s\.\s+</span>Short phases are drawn wider than they are\.\s*</figcaption>", page)


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("query", ["", "?T=400&n=250&t=3&FR=500&u=0.8&gear=HPN-14A-5&i=5"])
def test_a_space_parts_each_sentence_from_the_one_before(client: TestClient, query: str, language: str) -> None:
    page = client.get(f"/{query}", headers={"Accept-Language": language}).text
    without_inline = re.sub(r"</?(?:a|abbr|data|em|span|strong|sub|sup|var)\b[^>]*>", "", page)
    texts = unescape(re.sub(r"<[^>]+>", "\n", without_inline))

    assert re.findall(r".*[a-zäöüß)%][.:!?][A-ZÄÖÜ][a-zäöüß].*", texts) == []
