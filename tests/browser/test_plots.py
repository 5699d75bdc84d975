"""Pictures in a real browser: drawings at once, plots on demand; they follow the form and agree with the API."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Page, Playwright, expect

from tests.browser.conftest import PATIENCE_S, Visitor, open_section, violations

STATIC = Path(__file__).parents[2] / "frontend/static"
CONSTANT = "/?T=40&n=300&t=1&i=5&FR={FR}&FA={FA}&bm={bm}&gear=HPN-20A-5#bearing"
PHASES = (
    "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&Nk=1000&i=5&fw=1.2"
    "&FRi=900&FRi=500&FRi=700&FAi=300&FAi=200&FAi=500"
)
EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


def section(page: Page) -> Any:
    return page.get_by_role("region", name=re.compile("^Output bearing of"))


def plot(page: Page, name: str = "Loads in the envelope") -> Any:
    """Plot, unfolded and drawn; clicked only if folded, as a second click would fold a plot that still loads."""
    element = page.get_by_role("img", name=re.compile(name))
    zoom = page.locator("#sizes_figure" if "size" in name else "#bearing_figure")
    if zoom.get_attribute("open") is None:
        zoom.locator("summary").click()
    element.scroll_into_view_if_needed()
    expect(element.locator(".main-svg").first).to_be_visible()
    return element


def drawn(page: Page, name: str = "Loads in the envelope") -> Any:
    """Plotly's data and axes of a plot."""
    return plot(page, name).evaluate(
        "({ firstElementChild: p }) => ({"
        " data: p.data.map(({ x, y, text, meta, line }) => ({ x, y, text, meta, line })),"
        " ranges: [p._fullLayout.xaxis.range, p._fullLayout.yaxis.range] })"
    )


def once(page: Page, holds: Callable[[Any], bool]) -> Any:
    """Data and axes of a plot once a condition holds."""
    for _ in range(20 * PATIENCE_S):
        if holds(state := drawn(page)):
            return state
        page.wait_for_timeout(50)
    raise AssertionError("the picture did not change")


def curves(data: Any) -> dict[float, tuple[list[float], list[float]]]:
    """Life envelopes of a plot by load coefficient."""
    values = [trace for trace in data if trace["meta"]["kind"] in ("limit", "coefficient")]
    return {trace["meta"]["load_coefficient"]: (trace["x"], trace["y"]) for trace in values}


def envelopes(visitor: Visitor, driver: Playwright, size: str, **query: str | float) -> Any:
    """Curves of the API by load coefficient."""
    with_server = driver.request.new_context(base_url=visitor.server)
    reply = with_server.get(f"/api/v1/bearing-envelopes/{size}", params=query).json()
    with_server.dispose()
    return {curve["load_coefficient"]: (curve["radial_N"], curve["axial_N"]) for curve in reply["curves"]}


def average_speed_rpm(visitor: Visitor, driver: Playwright, link: str) -> float:
    """Average output speed of a link's cycle, by the API."""
    query = parse_qs(urlsplit(link).query)
    columns = zip(query["T"], query["n"], query["t"], strict=True)
    phases = [{"torque_Nm": float(T), "speed_rpm": float(n), "duration_s": float(t)} for T, n, t in columns]
    with_server = driver.request.new_context(base_url=visitor.server)
    cycle = {"phases": phases, "pause_s": float(query.get("tp", ["0"])[0])}
    reply = with_server.post("/api/v1/select", data={"duty_cycle": cycle}).json()
    with_server.dispose()
    return float(reply["duty"]["average_output_speed_rpm"])


@pytest.mark.parametrize("model", ["linear", "iso281"])
def test_the_plots_own_data_equal_the_APIs(visitor: Visitor, playwright_driver: Playwright, model: str) -> None:
    page = visitor.open(f"{PHASES}&bm={model}&Lb=30000&Lbb=L10&gear=HPN-20A-5#bearing")
    question = envelopes(
        visitor,
        playwright_driver,
        "20A",
        speed_rpm=average_speed_rpm(visitor, playwright_driver, page.url),
        life_h=150_000,
        load_coefficient=1.2,
        model=model,
    )
    assert curves(drawn(page)["data"]) == question


@pytest.mark.parametrize(
    ("model", "axial"),
    [
        ("linear", 0.0),
        ("linear", 400.0),
        ("iso281", 900.0),
    ],
)
def test_verdict_changes_where_the_constant_load_crosses_the_drawn_curve(
    visitor: Visitor, playwright_driver: Playwright, model: str, axial: float
) -> None:
    page = visitor.open(CONSTANT.format(FR=100, FA=axial, bm=model))
    radial, limit = envelopes(visitor, playwright_driver, "20A", speed_rpm=300, model=model)[1.0]
    assert curves(drawn(page)["data"])[1.0] == (radial, limit)
    # On the segment between two corners that contains this axial load.
    k = next(k for k in range(len(limit) - 1) if limit[k] >= axial >= limit[k + 1])
    crossing = radial[k] + (radial[k + 1] - radial[k]) * (limit[k] - axial) / (limit[k] - limit[k + 1])

    for share, carries in ((0.9, True), (1 - 1e-6, True), (1 + 1e-6, False), (1.1, False)):
        load = f"{share * crossing:.6f}"
        page.get_by_label("Radial load of the cycle").fill(load)
        expect(page).to_have_url(re.compile(f"FR={re.escape(load.rstrip('0'))}"))
        assert ("The output bearing carries" in section(page).inner_text()) == carries, share


def test_typing_a_load_moves_its_point_and_no_axis(visitor: Visitor) -> None:
    page = visitor.open(CONSTANT.format(FR=100, FA=200, bm=""))
    before = drawn(page)
    frame = plot(page).bounding_box()
    page.get_by_label("Radial load of the cycle").fill("600")
    expect(page).to_have_url(re.compile("FR=600&"))
    page.wait_for_function("() => document.querySelector('#plot-bearing > div').data.at(-1).x[0] === 600")
    after = drawn(page)
    assert after["ranges"] == before["ranges"]
    assert after["data"][-1]["x"] == [600]
    moved = plot(page).bounding_box()
    assert [moved[side] for side in ("x", "width", "height")] == [frame[side] for side in ("x", "width", "height")]


def test_data_and_library_of_a_plot_come_when_somebody_unfolds_it(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "#bearing")
    expect(section(page).locator("svg .line.limit").locator("visible=true").first).to_be_visible()
    assert page.locator("[data-figure]").count() == 0
    assert not page.evaluate("performance.getEntriesByType('resource').some(entry => /plotly/.test(entry.name))")
    plot(page)
    assert page.locator("[data-figure]").count() == 1
    assert page.evaluate("performance.getEntriesByType('resource').some(entry => /plotly/.test(entry.name))")


def test_all_sizes_stand_below_the_gear_s_own_and_follow_what_is_typed(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "#bearing")
    assert len([t for t in drawn(page, "of each size")["data"] if t["meta"]["kind"] in ("size", "limit")]) == 4
    table = page.get_by_role("table", name="Sizes that carry the load")
    expect(table.get_by_role("row", name=re.compile("14A"))).to_contain_text("does not carry it")
    expect(table.get_by_role("row", name=re.compile("20A"))).to_contain_text("carries the load")
    page.get_by_label("Load coefficient").fill("2")
    expect(page).to_have_url(re.compile("fw=2"))
    expect(table).to_be_visible()
    expect(table.get_by_role("row", name=re.compile("20A"))).to_contain_text("does not carry it")


def test_of_two_questions_only_the_figure_that_fails_is_marked(visitor: Visitor) -> None:
    page = visitor.open("/?T=40&n=250&t=0.3&T=32&n=500&t=3&FR=1200#bearing")
    row = page.get_by_role("table", name="Sizes that carry the load").get_by_role("row", name=re.compile("20A"))
    weight = "cell => getComputedStyle(cell.firstElementChild).fontWeight"
    phase, cycle = row.get_by_role("cell").nth(1), row.get_by_role("cell").nth(3)
    assert float(cycle.inner_text().split()[0]) > 100 > float(phase.inner_text().split()[0])
    assert (cycle.evaluate(weight), phase.evaluate(weight)) == ("620", "500")


def test_enlarged_part_stays_while_typing_until_the_whole_view_is_asked_for(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "#bearing")
    whole = drawn(page)["ranges"]
    frame = plot(page).bounding_box()
    page.mouse.move(frame["x"] + 150, frame["y"] + 80)
    page.mouse.down()
    page.mouse.move(frame["x"] + 350, frame["y"] + 220, steps=5)
    page.mouse.up()
    part = once(page, lambda state: state["ranges"] != whole)["ranges"]
    page.get_by_label("Load coefficient").fill("1.3")
    expect(page).to_have_url(re.compile("fw=1.3"))
    assert once(page, lambda state: 1.3 in curves(state["data"]))["ranges"] == part
    page.get_by_role("button", name="Whole", exact=True).click()
    assert drawn(page)["ranges"] == whole


NAMES = """plot => [...plot.querySelectorAll(".annotation")].map(name => {
  const box = name.getBoundingClientRect();
  return [name.textContent.replaceAll("\\u200b", ""), box.left, box.top, box.right, box.bottom];
})"""
"""Names along the curves of a plot, with their bounding boxes."""


def test_a_zoomed_plot_is_as_wide_as_its_section_and_names_what_is_in_sight(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "#bearing")
    before = section(page).locator(".envelope svg:visible").bounding_box()
    frame = plot(page).bounding_box()
    width = section(page).evaluate("part => part.getBoundingClientRect().width")
    assert frame["width"] >= width - 2 > before["width"] * 1.5
    expect(section(page).locator(".envelope svg:visible")).to_have_count(0)
    curves_named = {"single load", "limit now, fw 1.2", "fw 1", "fw 1.5"}
    assert {name for name, *_ in plot(page).evaluate(NAMES)} == curves_named

    page.mouse.move(frame["x"] + 300, frame["y"] + 60)
    page.mouse.down()
    page.mouse.move(frame["x"] + 700, frame["y"] + 400, steps=5)
    page.mouse.up()
    expect(plot(page).locator(".annotation", has_text="Pm")).to_be_visible()  # its load is outside: at the edge

    names = plot(page).evaluate(NAMES)
    assert curves_named & {name for name, *_ in names}
    frame = plot(page).bounding_box()
    for _, left, top, right, bottom in names:
        assert frame["x"] <= left < right <= frame["x"] + frame["width"]
        assert frame["y"] <= top < bottom <= frame["y"] + frame["height"]


@pytest.mark.parametrize(("format", "start"), [("SVG", b"<svg"), ("PNG", b"\x89PNG")])
def test_plot_is_saved_without_any_service(visitor: Visitor, tmp_path: Path, format: str, start: bytes) -> None:
    page = visitor.open(PHASES + "#bearing")
    plot(page)
    with page.expect_download() as download:
        section(page).get_by_role("button", name="Save figure").first.click()
        section(page).get_by_role("button", name=format).first.click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    content = path.read_bytes()
    assert path.suffix == f".{format.lower()}"
    assert content.startswith(start)
    if format == "SVG":
        text = re.sub("<[^>]+>", "", content.decode())
        assert "Basis: interpolated between the two published limits" in text
        assert "Output bearing of HPN-20A" in text


def test_plot_follows_the_switch_to_dark_and_prints_on_white(visitor: Visitor) -> None:
    def colour(state: Any) -> Any:
        return state["data"][0]["line"]["color"]

    page = visitor.open(PHASES + "#bearing")
    light = colour(drawn(page))
    page.emulate_media(color_scheme="dark")
    dark = colour(once(page, lambda state: colour(state) != light))
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert colour(drawn(page)) == light
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert colour(drawn(page)) == dark


def test_going_back_brings_the_plot_of_the_earlier_load(visitor: Visitor) -> None:
    page = visitor.open(CONSTANT.format(FR=100, FA=200, bm=""))
    plot(page)
    page.get_by_label("Radial load of the cycle").fill("700")
    expect(page).to_have_url(re.compile("FR=700&"))
    page.go_back()
    expect(page.get_by_label("Radial load of the cycle")).to_have_value("100")
    assert drawn(page)["data"][-1]["x"] == [100]


def test_without_script_sentence_and_tables_say_it_all(visitor: Visitor) -> None:
    page = visitor.open(PHASES, script=False)
    expect(section(page)).to_contain_text("The output bearing carries these loads.")
    expect(section(page)).to_contain_text("Largest single load: 76.4")
    expect(section(page)).to_contain_text("Basis: interpolated between the two published limits")
    page.get_by_text("Data: loads and curves as tables").click()
    expect(page.get_by_role("table", name="Loads of the phases").get_by_role("row")).to_have_count(5)
    expect(page.get_by_role("table", name="Sizes that carry the load")).to_be_visible()
    expect(page.get_by_role("button", name="Save figure")).to_have_count(0)


def test_a_size_without_published_limits_says_why_it_has_no_envelope(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "&gear=HPN-40A-5#bearing")
    expect(section(page)).to_contain_text("Not rated.")
    expect(section(page)).to_contain_text("This catalogue lacks the bearing limits")
    expect(section(page)).to_contain_text("sizes.csv")


def test_a_candidate_outside_the_wishes_has_its_pictures_too(visitor: Visitor) -> None:
    page = visitor.open(PHASES + "&gear=HPN-32A-10#bearing")
    (loads,) = [trace for trace in drawn(page)["data"] if trace["meta"]["kind"] == "load"]
    assert loads["text"] == ["phase 1", "phase 2", "phase 3"]


def test_without_loads_the_drawing_leads_to_the_field(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    drawing = page.get_by_role("figure", name="Load on the output shaft")
    expect(drawing.locator(".line.limit").locator("visible=true")).to_be_in_viewport()
    drawing.get_by_role("link", name="Add a load").click()
    expect(page.get_by_label("Radial load of the cycle")).to_be_focused()


def test_picture_of_the_cycle_follows_the_form_and_outlives_an_error(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    picture = page.get_by_role("img", name="Torque and speed over time, beside the limits of HPN-20A-5")
    expect(picture).to_be_in_viewport()
    expect(page.locator("#cycle").get_by_text("3 phases. Torque from 20")).to_be_attached()
    before = picture.locator(".steps").first.get_attribute("d")
    page.get_by_label("Torque, phase 1").fill("-40")
    expect(page.locator("#cycle").get_by_text(re.compile("Torque from [-−]40"))).to_be_attached()
    after = picture.locator(".steps").first.get_attribute("d")
    assert after != before
    place = picture.bounding_box()
    page.get_by_label("Pause").fill("x")
    expect(page.get_by_text("Not recalculated")).to_be_visible()
    assert picture.locator(".steps").first.get_attribute("d") == after
    box = picture.bounding_box()
    assert box and place and box["width"] == place["width"]


def test_accessibility_check_of_drawings_and_plots_finds_nothing(visitor: Visitor) -> None:
    page = visitor.open(PHASES)
    open_section(page, "Bearing")
    for summary in section(page).locator("summary:visible").all():
        summary.click()
    plot(page)
    assert violations(page) == []
