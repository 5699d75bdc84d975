"""Pages of the catalogue over HTTP."""

import dataclasses
import gzip
import re
from html import unescape
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.account.published import groups_of
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.web.app import create_app
from hpn.web.pages.catalogue import COLUMNS
from hpn.web.settings import Settings
from hpn.words.reader import Reader


@pytest.fixture(scope="module")
def client() -> TestClient:
    return TestClient(create_app(), follow_redirects=False)


def test_every_gear_has_a_page_that_the_catalogue_links(client: TestClient, catalogue: Catalogue) -> None:
    listed = set(re.findall(r'href="/catalogue/(HPN-\w+-\d+)"', client.get("/catalogue").text))
    assert listed == set(catalogue.by_designation)
    for designation in listed:
        page = client.get(f"/catalogue/{designation}")
        assert page.status_code == 200
        assert f"<title>{designation} · HPN Select</title>" in page.text
        assert f'<link rel="canonical" href="http://testserver/catalogue/{designation}">' in page.text


def test_each_published_figure_stands_in_one_group_of_the_page_of_a_gear(catalogue: Catalogue) -> None:
    """A range counts for both of its ends."""
    grouped = [line.code for _, lines in groups_of(catalogue.gears[0]) for line in lines]
    ranges = {"length": {"length_min_mm", "length_max_mm"}}
    ranges["ambient_temperature"] = {"ambient_temperature_minimum_degC", "ambient_temperature_maximum_degC"}
    fields = [name for code in grouped for name in ranges.get(code.removeprefix("gear."), {code.removeprefix("gear.")})]
    assert sorted(fields) == sorted(field.name for field in dataclasses.fields(Gear) if "file" in field.metadata)


def test_page_of_a_gear_gives_each_figure_with_its_source(client: TestClient) -> None:
    page = client.get("/catalogue/HPN-20A-5").text
    rows = {
        name: (value, source)
        for name, value, source in re.findall(
            r'<th scope="row">([^<]+?)\s*(?:<var.*?</var>)?</th>\s*<td class="figure">.*?value="([^"]*)".*?'
            r'<td class="origin">\s*([^<]*?)\s*</td>',
            page,
            re.S,
        )
    }
    for name, value, table, number in (
        ("Rated torque", "80.0", "table 12.1", "12"),
        ("Torsional stiffness", "26000.0", "table 15.2", "15"),
        ("Backlash", "5.0", "table 15.1", "15"),
        ("Weight", "2.6", "table 12.1", "12"),
    ):
        assert rows[name][0] == value
        assert rows[name][1].startswith(table) and rows[name][1].endswith(number)


@pytest.mark.parametrize("spelling", ["HPN-20-5", "HPN-20A-05", "20A-5", "hpn-20a-5", "HPN-20A-5-J6-BH-AF1"])
def test_other_spellings_lead_to_the_page(client: TestClient, spelling: str) -> None:
    reply = client.get(f"/catalogue/{spelling}?T=1")
    assert (reply.status_code, reply.headers["location"]) == (308, "/catalogue/HPN-20A-5?T=1")


def test_an_address_that_leads_nowhere_is_a_page_for_readers_alone(client: TestClient) -> None:
    read = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8", "Accept-Language": "de"}
    page = client.get("/nope", headers=read)

    assert (page.status_code, page.headers["content-type"]) == (404, "text/html; charset=utf-8")
    assert "Seite nicht gefunden" in page.text
    for path, headers in (("/nope", {}), ("/api/v1/nope", read)):
        answer = client.get(path, headers=headers)
        assert (answer.status_code, answer.headers["content-type"]) == (404, "application/problem+json")


@pytest.mark.parametrize("name", ["HPN-20A-6", "20A", "nonsense", "%00", "..%2f..", "<b>", "x" * 5000])
def test_unknown_gear_is_404_that_helps(client: TestClient, name: str) -> None:
    page = client.get(f"/catalogue/{name}")
    assert page.status_code == 404
    if len(name) < 20 and ".." not in name:
        assert "HPN-20-5, HPN-20A-05 and a full ordering code" in page.text
        assert "<b>" not in page.text
    if "20A" in name:
        assert "/catalogue/HPN-20A-5" in page.text


def test_filters_are_links_that_narrow_the_table(client: TestClient, catalogue: Catalogue) -> None:
    of_14A, of_5 = sum(gear.size == "14A" for gear in catalogue.gears), sum(gear.ratio == 5 for gear in catalogue.gears)
    counts = {"size=14A": of_14A, "i=5": of_5, "size=14&i=5": 1, "size=11A&i=3": 0, "size=%00&i=x": 0}
    for query, count in counts.items():
        page = client.get(f"/catalogue?{query}")
        assert len(set(re.findall(r'<th scope="row"><a href="/catalogue/([^"]+)"', page.text))) == count
        assert page.status_code == (200 if count else 404)


LISTED = re.compile(r'<th scope="row"><a href="/catalogue/([^"?]+)')


@pytest.mark.parametrize("field", COLUMNS)
def test_the_table_is_sorted_by_any_figure_and_a_gear_without_it_comes_last(
    client: TestClient, catalogue: Catalogue, field: str
) -> None:
    values = {gear.designation: getattr(gear, field) for gear in catalogue.gears}
    lacking = [name for name, value in values.items() if value is None]
    for sort, order in ((field, "ascending"), (f"-{field}", "descending")):
        page = client.get(f"/catalogue?sort={sort}").text
        names = LISTED.findall(page)
        listed = [values[name] for name in names if values[name] is not None]
        assert sorted(names) == sorted(values)
        assert listed == sorted(listed, reverse=sort != field)
        assert names[len(listed) :] == lacking
        assert page.count("aria-sort") == 1 and f'aria-sort="{order}"' in page


def test_sorting_keeps_filters_and_a_filter_the_order(client: TestClient) -> None:
    page = unescape(client.get("/catalogue?size=20A&sort=-gear").text)

    assert LISTED.findall(page)[0] == "HPN-20A-50"
    assert 'href="/catalogue?size=20A&sort=weight_kg"' in page
    assert 'href="/catalogue?size=20A&i=5&sort=-gear"' in page
    assert 'href="/catalogue?size=20A&sort=gear"' in page
    assert LISTED.findall(client.get("/catalogue?sort=sources").text) == LISTED.findall(client.get("/catalogue").text)


def test_finding_keeps_the_selection(client: TestClient) -> None:
    reply = client.get("/find", params={"gear": "hpn-14-05", "link": "/?T=40&n=250&t=0.3&gear=HPN-20A-5"})
    assert reply.headers["location"] == "/?T=40&n=250&t=0.3&gear=HPN-14A-5"
    assert client.get("/catalogue", params={"find": "../x"}).headers["location"] == "/catalogue/..%2Fx"


def test_missing_figures_say_how_to_supply_them_and_what_is_supplied_is_marked(tmp_path: Path) -> None:
    page = TestClient(create_app()).get("/catalogue/HPN-40A-5").text
    assert page.count("your supplement") == 13 and page.count("Not in this catalogue’s source") == 1
    files = dict(re.findall(r"<strong>(\w+\.csv)</strong></p>\s*<pre[^>]*>([^<]*)</pre>", page))
    assert set(files) == {"gears.csv", "ratings.csv", "sizes.csv", "weights.csv", "lengths.csv"}
    header, row = files["ratings.csv"].strip().splitlines()
    assert header == "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source"
    (tmp_path / "ratings.csv").write_text(f"{header}\n{row.replace('5,,,', '5,700,400,1300')}\n")
    filled = TestClient(create_app(Settings(catalogue_supplement=tmp_path)))
    supplied, other = (filled.get(f"/catalogue/{gear}").text for gear in ("HPN-40A-5", "HPN-40A-10"))
    assert 'value="700.0"' in supplied
    assert supplied.count('<span class="tag">yours</span>') == 3
    for rated, unrated in ((supplied, page), (supplied, other)):
        assert "The rating table and the lengths of HPN-40A are not in" not in rated
        assert "The rating table and the lengths of HPN-40A are not in" in unrated


def test_a_gear_that_lacks_a_figure_no_check_needs_is_not_said_to_be_unrated(client: TestClient) -> None:
    rated, unrated = (unescape(client.get(f"/catalogue/{gear}").text) for gear in ("HPN-20A-5", "HPN-40A-5"))

    assert "it is rated without them" in rated and "can’t be rated" not in rated
    assert "can’t be rated" in unrated
    assert rated.count("your supplement") == 3


def test_a_gear_of_a_supplement_may_have_any_number_of_stages(tmp_path: Path) -> None:
    (tmp_path / "gears.csv").write_text("size,ratio,stages,source\n40A,125,3,mine\n")
    page = TestClient(create_app(Settings(catalogue_supplement=tmp_path))).get("/catalogue/HPN-40A-125")
    assert page.status_code == 200
    assert "Planetary gear with 3 stages, ratio 125." in page.text


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("", "HPN-20A-5-J6"),
        ("output=J8", "HPN-20A-5-J8"),
        ("output=J8&motor=bh-af1", "HPN-20A-5-J8-BH-AF1"),
        ("output=X&motor=a!", "HPN-20A-5-J6"),
    ],
)
def test_ordering_code_is_put_together_without_script(client: TestClient, query: str, code: str) -> None:
    page = client.get(f"/catalogue/HPN-20A-5?{query}").text
    assert re.findall("<output[^>]*>([^<]*)</output>", page) == [code]
    assert ('aria-invalid="true"' in page) == ("!" in query)


def test_selection_travels_along_and_back(client: TestClient) -> None:
    page = client.get("/catalogue/HPN-20A-5?T=40&n=250&t=0.3&output=J6").text
    assert 'href="/?T=40&amp;n=250&amp;t=0.3&amp;gear=HPN-20A-5"' in page
    assert 'href="/catalogue/HPN-20A-7?T=40&amp;n=250&amp;t=0.3"' in page
    assert 'href="/?T=&amp;n=&amp;t=&amp;i=5&amp;size=20A"' in client.get("/catalogue/HPN-20A-5").text


def test_robots_may_read_the_catalogue(client: TestClient) -> None:
    text = client.get("/robots.txt").text
    assert "Disallow: /selections\n" in text
    assert "Disallow: /catalogue" not in text


@pytest.mark.parametrize("path", ["/catalogue", "/api/v1/catalogue"])
def test_pages_and_replies_come_packed_where_the_client_takes_it(client: TestClient, path: str) -> None:
    plain = client.get(path, headers={"Accept-Encoding": "identity"})
    with client.stream("GET", path, headers={"Accept-Encoding": "gzip"}) as packed:
        content = b"".join(packed.iter_raw())

    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert gzip.decompress(content) == plain.content
    for reply in (plain, packed):
        assert reply.headers["vary"].split(", ").count("Accept-Encoding") == 1


def corners(page: str) -> list[list[str]]:
    """Cells of the table of corner points, row by row."""
    table = page[page.index("Corner points") :].split("</table>")[0]
    return [re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", row) for row in table.split("<tr>")[2:]]


def test_which_load_the_shaft_may_carry_is_answered_at_a_typed_speed_life_and_coefficient(client: TestClient) -> None:
    """The page draws the answer of the API, for input in any units."""
    question = {"speed_rpm": 150, "life_h": 30_000, "load_coefficient": 1.3}
    curves = client.get("/api/v1/bearing-envelopes/20A", params=question).json()["curves"]
    plain = client.get("/catalogue/HPN-20A-5", params={"at_n": "150", "at_life": "30000", "at_fw": "1.3"}).text
    typed = {"at_n": "2,5 rev/s", "at_life": "30 000", "at_fw": "1,3", "at_written": "de"}
    german = client.get("/catalogue/HPN-20A-5", params=typed, headers={"Accept-Language": "en"}).text
    reader = Reader()
    values = [
        [reader.figure(curve["load_coefficient"]), reader.figure(radial, "N"), reader.figure(axial, "N")]
        for curve in curves
        for radial, axial in zip(curve["radial_N"], curve["axial_N"], strict=True)
    ]
    assert corners(plain) == values
    assert "150 rpm for a life of 30 000 h" in unescape(plain).replace("\u202f", " ")
    assert corners(german) == values


@pytest.mark.parametrize(
    ("query", "message"),
    [
        ({"at_n": "0"}, "must be above 0"),
        ({"at_n": "fast"}, "is not a number"),
        ({"at_fw": "0.5"}, "must be at least 1"),
        ({"at_life": "1e99"}, "must be at most"),
        ({"at_life": "3 furlongs"}, "at_life-problem"),
        ({"at_n": "\0", "at_written": "xx"}, "at_n-problem"),
    ],
)
def test_what_a_condition_can_not_be_is_said_at_its_field(
    client: TestClient, query: dict[str, str], message: str
) -> None:
    reply = client.get("/catalogue/HPN-20A-5", params=query)
    assert reply.status_code == 200
    assert message in reply.text and 'aria-invalid="true"' in reply.text
    assert "100 rpm for a life of 20 000 h" in unescape(reply.text).replace("\u202f", " ")


def test_a_condition_is_no_part_of_the_selection_that_travels_along(client: TestClient) -> None:
    page = client.get("/catalogue/HPN-20A-5?T=40&n=250&t=0.3&fw=1.2&at_n=150&at_written=de").text
    assert re.search(r'href="(/\?T=40[^"]*)"', page)
    assert not [link for link in re.findall(r'(?:href|action)="([^"]*)"', page) if "at_" in link]
