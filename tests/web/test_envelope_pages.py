"""Loads in their envelopes on the pages: without script, with and without a load, live and saved."""

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&i=5"
LOADED = EXAMPLE + "&fw=1.2&FRi=900&FRi=500&FRi=700&FAi=300&FAi=200&FAi=500&gear=HPN-20A-5"
CURVE = "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,mine\n20A,1,0,1800,mine\n"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder = tmp_path_factory.mktemp("pages")
    settings = Settings(database_url=f"sqlite:///{folder}/selections.sqlite3")
    with TestClient(create_app(settings)) as client:
        yield client


def section(page: str, name: str) -> str:
    """Figure or section of a page by its id."""
    match = re.search(rf'<(figure|section)[^>]* id="{name}".*?</\1>', page, re.DOTALL)
    assert match, name
    return match[0]


def phases(part: str, kind: str) -> list[str]:
    """Numbers of the phases of all elements of a kind."""
    return re.findall(rf'class="{kind}[^"]*"[^>]* data-phase="([^"]*)"', part)


def test_the_overview_has_the_drawing_at_once_without_a_load_and_leads_to_its_field(client: TestClient) -> None:
    page = client.get(EXAMPLE).text
    figure = section(page, "envelope")

    assert 'class="line limit"' in figure
    assert "218\u202frpm, 20\u202f000\u202fh, L50" in unescape(figure)
    assert '<a href="#f-FR">Add a load</a>' in figure
    assert 'id="f-FR"' in page
    assert 'class="mark' not in figure


@pytest.mark.parametrize(
    ("model", "basis", "other"),
    [
        ("linear", "interpolated between the two", "constant Y"),
        ("iso281", "constant Y", "interpolated between the two"),
    ],
)
def test_each_envelope_says_what_it_stands_on(client: TestClient, model: str, basis: str, other: str) -> None:
    page = client.get(f"{LOADED}&bm={model}").text

    stated = re.findall(r'<p class="basis">(.*?)</p>', page)
    assert stated and all(basis in text and other not in text for text in stated)
    assert basis in section(page, "calculation").replace("Interpolated", "interpolated")
    assert "L10 = L50 / 5" in unescape(section(page, "bearing"))


def drawings_in(part: str) -> list[str]:
    """Drawings of a figure: one for a narrow and one for a wide place."""
    return re.findall(r"<svg.*?</svg>", part, re.S)


def test_phase_row_step_and_load_carry_the_same_number(client: TestClient) -> None:
    page = client.get(LOADED).text

    drawn = drawings_in(section(page, "envelope"))
    assert [phases(drawing, "mark load") for drawing in drawn] == 2 * [["0", "1", "2"]]
    assert phases(section(page, "cycle"), "phase-step") == ["0", "1", "2"]
    assert re.findall(r'<tr id="phase-(\d)"', page) == ["0", "1", "2"]
    assert "Add a load" not in page


def test_the_phase_that_governs_is_marked_alike_in_chart_and_drawing(client: TestClient) -> None:
    page = client.get(LOADED + "&FRi=5000&FAi=0&T=1&n=100&t=1").text
    chart, figure = section(page, "cycle"), section(page, "envelope")

    assert 'data-governing="3"' in chart
    assert phases(chart, "phase-step governing") == ["3"]
    assert [phases(drawing, "mark load governing") for drawing in drawings_in(figure)] == 2 * [["3"]]


def test_data_for_the_plot_library_come_only_when_somebody_unfolds_them(client: TestClient) -> None:
    page = client.get(LOADED).text
    part = client.get(LOADED, headers={"HX-Request": "true", "HX-Target": "details#bearing_figure"}).text

    assert "data-figure" not in section(page, "bearing")
    assert "plotly" not in section(page, "envelope")
    assert "data-figure" in part


@pytest.mark.parametrize(
    ("query", "message"),
    [("&gear=HPN-40A-5", "This catalogue lacks the bearing limits of HPN-40A"), ("&gear=HPN-40A-5&FR=1", "Not rated.")],
)
def test_a_gear_without_limits_has_a_message_in_place_of_the_drawing(
    client: TestClient, query: str, message: str
) -> None:
    figure = section(client.get(EXAMPLE + query).text, "envelope")
    assert message in unescape(figure)
    assert "<svg" not in figure


def test_the_digitised_graph_is_offered_only_where_a_supplement_has_points(client: TestClient, tmp_path: Path) -> None:
    (tmp_path / "bearing_envelopes.csv").write_text(CURVE)
    settings = Settings(database_url=f"sqlite:///{tmp_path}/s.sqlite3", catalogue_supplement=str(tmp_path))

    assert "digitised graph" not in client.get(EXAMPLE).text.partition("_bearing_help")[0].partition("</form>")[0]
    response = client.get(EXAMPLE + "&FR=1&bm=digitised")
    assert '<option value="digitised" selected>digitised graph</option>' in response.text
    assert "bearing_envelopes.csv" in response.text
    with TestClient(create_app(settings)) as supplied:
        assert '<option value="digitised">digitised graph</option>' in supplied.get(EXAMPLE).text
        assert 'class="line limit"' in section(supplied.get(EXAMPLE + "&FR=1&bm=digitised").text, "envelope")


@pytest.mark.parametrize("query", [EXAMPLE, LOADED])
def test_the_saved_page_has_the_chart_of_the_cycle_the_envelope_and_the_life_of_the_bearing(
    client: TestClient, query: str
) -> None:
    page = client.post("/selections", data={"link": query}).text

    assert phases(section(page, "cycle"), "phase-step") == ["0", "1", "2"]
    bearing = section(page, "bearing")
    assert 'class="line limit"' in bearing
    if query == LOADED:
        assert "The largest single load decides." in bearing
        drawn = [phases(drawing, "mark load") for drawing in drawings_in(bearing) if 'class="drawing' in drawing]
        assert drawn == 2 * [["0", "1", "2"]]  # for a narrow and for a wide place
        assert "75\u202f594" in unescape(bearing)
    else:
        assert "Add a load" not in bearing


@pytest.mark.parametrize(("own", "thin"), [(1, {1.2, 1.5}), (1.2, {1, 1.5}), (1.3, {1, 1.2, 1.5})])
def test_the_page_of_a_gear_draws_each_curve_of_the_api_once(client: TestClient, own: float, thin: set[float]) -> None:
    """The requested coefficient is the strong line, also for 1, 1.2 or 1.5."""
    page = client.get(f"/catalogue/HPN-20A-5?at_n=900&at_fw={own}").text
    question = {"load_coefficient": own, "speed_rpm": 900}
    curves = client.get("/api/v1/bearing-envelopes/20A", params=question).json()["curves"]

    assert {curve["load_coefficient"] for curve in curves} == {own, *thin}
    assert page.count('class="line limit"') == 1
    assert page.count('class="line coefficient"') == len(thin)


def test_the_page_of_a_gear_says_its_basis_and_draws_nothing_without_limits(client: TestClient) -> None:
    page = client.get("/catalogue/HPN-20A-5").text
    assert "Basis: interpolated between the two published limits" in page
    assert 'class="line' not in client.get("/catalogue/HPN-40A-5").text


def test_a_cycle_too_long_for_a_link_has_its_plots_too(client: TestClient) -> None:
    rows = "\n".join(f"1 {100 + k % 7} 1 {k % 900} 100" for k in range(600))
    page = client.post("/", data={"phases": rows}).text
    question = {"HX-Request": "true", "HX-Target": "details#bearing_figure"}
    assert "data-figure" in client.post("/", data={"phases": rows}, headers=question).text
    drawn = drawings_in(section(page, "envelope"))
    assert [len(phases(drawing, "mark load")) for drawing in drawn] == [200, 200]


def test_a_load_beside_the_shafts_centre_stands_with_what_it_counts_there(client: TestClient) -> None:
    """600 N at 45 mm, the centre at 21 mm: 1286 N of 1800 N."""
    page = unescape(client.get(EXAMPLE + "&FR=600&xR=45&xc=21&gear=HPN-20A-5").text)
    part = section(page, "bearing")

    assert "radial 600 N where it acts, 1 286 N at the shaft’s centre".replace(" ", "\u202f") in part.replace(
        " ", "\u202f"
    )
    assert re.search(r'<span class="percent"[^>]*>71\u202f%', part)
    assert "n upper bound for any bearing spacing" in page and "can’t be judged" not in part
