"""Machine of 40 axes in German: pasted, changed, revised, compared, printed; then by two people, then on a phone."""

import re
from io import BytesIO

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect
from pypdf import PdfReader

from tests.browser.conftest import Visitor, in_german, violations
from tests.machines import NAMES

PHASES = ((1.0, 90, 300), (0.5, 180, 1200), (-0.8, 90, 300))
"""Phases of each axis: share of the torque, speed in rpm, time in ms."""


def cells() -> str:
    """Cells of a German spreadsheet: 40 axes, three phases each, with their quantities and stop torques."""
    rows = ["Achse\tAnzahl\tDrehmoment [Nm]\tDrehzahl [1/min]\tDauer [ms]\tNot-Halt-Drehmoment [Nm]"]
    for place, name in enumerate(NAMES):
        torque = 6 + 9 * (place * 7 % 13)
        for share, speed, milliseconds in PHASES:
            first = share == 1.0
            own = (name, str(1 + place % 2)) if first else ("", "")
            stop = f"{1.9 * torque:.1f}".replace(".", ",") if first else ""
            moment = f"{share * torque:.1f}".replace(".", ",")
            rows.append("\t".join((*own, moment, str(speed), str(milliseconds), stop)))
    return "\n".join(rows)


def fits(page: Page, width: int) -> None:
    """Assert that the page does not scroll sideways, and that axe finds no violation."""
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []


def pasted(visitor: Visitor) -> Page:
    """Page of the machine made of the cells, sized and saved in German."""
    page = visitor.open("/machines")
    in_german(page)
    page.get_by_label("oder Zellen aus einer Tabellenkalkulation").fill(cells())
    page.get_by_role("button", name="Tabelle lesen").click()
    expect(page.get_by_text("40 Achsen", exact=True).first).to_be_visible()
    fits(page, 1440)
    page.get_by_role("button", name="Achsen auslegen").click()
    expect(page.get_by_text("40 von 40")).to_be_visible()
    page.locator("summary.primary").click()
    page.get_by_role("textbox", name="Titel").fill("Verpackungslinie VP-40")
    page.get_by_role("button", name="Speichern", exact=True).click()
    expect(page.get_by_role("heading", level=1)).to_have_text("Verpackungslinie VP-40")
    return page


def changed(page: Page, field: str, text: str) -> None:
    """Type into a cell of the first phase, and wait until the address contains the text."""
    page.locator(f"#{field}-0").fill(text)
    page.wait_for_url(f"**{field}={text}&**")


def saved(page: Page) -> None:
    """Save the axis by keyboard."""
    page.keyboard.press("Control+s")
    page.wait_for_url(re.compile(r"/axes/\d+$"))


def row(page: Page, name: str) -> Locator:
    """Row of an axis in the table of its machine."""
    return page.get_by_role("table", name="Achsen", exact=True).get_by_role("row", name=name)


def revision(page: Page, label: str, note: str) -> None:
    """Save the working copy as the next revision, whose label the page proposes."""
    page.get_by_text(f"Revision {label} speichern").click()
    form = page.get_by_role("form", name="Revision speichern")
    expect(form.get_by_label("Kennung")).to_have_value(label)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    form.get_by_label("Bemerkung").fill(note)
    form.get_by_role("button", name="Speichern").click()
    expect(page.get_by_role("heading", name=re.compile("→"))).to_be_visible()


def test_forty_axes_are_pasted_changed_revised_compared_and_printed(visitor: Visitor) -> None:
    page = pasted(visitor)
    machine = page.url
    expect(row(page, "X2 gantry, right")).to_contain_text("2")

    page.keyboard.press("e")
    page.get_by_label("Maximale Auslastung").fill("0,9")
    expect(page.locator("#every-axis .effect")).to_contain_text("Achse")
    page.get_by_role("button", name="Auf 40 Achsen anwenden").click()
    expect(page.locator("#every-axis:not(.editing)")).to_contain_text("90")  # it is saved only then
    page.goto(f"{machine}/revisions")
    revision(page, "A", "u gemeinsam")

    page.goto(machine)
    row(page, "X1 gantry, left").get_by_role("link", name="X1 gantry, left").click()
    expect(page.get_by_role("link", name="Verpackungslinie VP-40")).to_be_visible()
    changed(page, "T", "9")
    saved(page)
    page.locator("#result").focus()
    page.keyboard.press("]")
    page.wait_for_url("**/axes/2")
    expect(page.get_by_label("Name der Achse 2")).to_have_value("X2 gantry, right")

    page.goto(f"{machine}/revisions")
    revision(page, "B", "Portal leichter")
    page.goto(f"{machine}/revisions?from=A&to=B")
    expect(page.get_by_role("heading", name="A → B")).to_be_visible()
    expect(page.get_by_role("row", name="X1 gantry, left")).to_contain_text("Drehmoment, Phase 1")
    expect(page.get_by_role("row", name="X2 gantry, right")).to_have_count(0)
    fits(page, 1440)

    page.goto(f"{machine}/kinds")
    expect(page.get_by_role("heading", name="Wenigste Typen")).to_be_visible()
    fits(page, 1440)

    report = page.request.get(f"{machine.replace('/machines/', '/api/v1/machines/')}/report.pdf?revision=B")
    texts = [sheet.extract_text() for sheet in PdfReader(BytesIO(report.body())).pages]
    whole = " ".join(" ".join(texts).split())
    assert len(texts) >= 42 and "Verpackungslinie VP-40" in texts[0]
    assert all(name in whole for name in NAMES)
    assert "0,9" in texts[0]


@pytest.fixture
def machine(server: str) -> str:
    """Address of a machine with two axes."""
    phases = [{"torque_Nm": 20, "speed_rpm": 100, "duration_s": 1}]
    axes = [{"name": name, "application": {"duty_cycle": {"phases": phases}}} for name in ("Hub", "Dreh")]
    sent = {"title": "Zelle", "axes": axes}
    return str(httpx.post(f"{server}/api/v1/machines", json=sent, trust_env=False).json()["url"])


def test_two_browsers_never_meet_on_two_axes_and_lose_nothing_on_one(visitor: Visitor, machine: str) -> None:
    first, second = visitor.open(f"{machine}/axes/1"), visitor.open(f"{machine}/axes/2")
    for page, text in ((first, "24"), (second, "26")):
        in_german(page)
        changed(page, "T", text)
    saved(first)
    saved(second)  # opened before the other axis was saved
    expect(second.locator("#T-0")).to_have_value("26")

    second.goto(f"{visitor.server}{machine}/axes/1")
    changed(first, "T", "30")
    saved(first)
    changed(second, "n", "120")
    second.keyboard.press("Control+s")
    table = second.locator("#conflict")
    for word in ("geöffnet", "anderer Stand", "eigene Angabe"):
        expect(table.get_by_role("columnheader", name=word)).to_be_visible()
    expect(table.get_by_role("row", name="Drehmoment")).to_contain_text("24")
    expect(table.get_by_role("row", name="Drehmoment")).to_contain_text("30")
    expect(table.get_by_role("row", name="Drehzahl")).to_contain_text("120")
    fits(second, 1440)
    for watch in visitor.watches:  # the browser reports an answer 412
        watch.console = [text for text in watch.console if "status of 412" not in text]
    second.get_by_role("link", name="Anderer Stand mit meinen Änderungen").click()
    expect(second.locator("#T-0")).to_have_value("30")
    expect(second.locator("#n-0")).to_have_value("120")
    saved(second)

    first.goto(f"{visitor.server}{machine}/axes/1")
    expect(first.locator("#T-0")).to_have_value("30")
    expect(first.locator("#n-0")).to_have_value("120")


def test_every_step_is_reached_on_a_phone_and_nothing_scrolls_sideways(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine, 390, touch=True)
    in_german(page)
    fits(page, 390)
    page.get_by_role("link", name="Hub").first.click()
    page.wait_for_url("**/axes/1")
    fits(page, 390)
    changed(page, "T", "33")
    page.get_by_role("button", name="In Maschine speichern").click()
    page.wait_for_url(re.compile("/axes/1$"))
    page.get_by_role("link", name="Nächste Achse: Dreh").click()
    page.wait_for_url("**/axes/2")
    page.get_by_role("link", name="Zelle").click()
    page.get_by_role("button", name="Mehr").click()
    page.get_by_role("link", name="Revisionen").click()
    revision(page, "A", "erste")
    fits(page, 390)
    page.get_by_role("button", name="Mehr").click()
    expect(page.get_by_role("link", name="Vergleich als PDF")).to_be_visible()
    page.keyboard.press("Escape")
    page.goto(f"{visitor.server}{machine}/kinds")
    fits(page, 390)
