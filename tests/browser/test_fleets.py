"""Axes of a machine: a table with German headings is uploaded, corrected, sized, and saved as a machine."""

import re
from pathlib import Path

from playwright.sync_api import expect

from tests.browser.conftest import Visitor, violations

AXES = 40


def table() -> str:
    """CSV of a German spreadsheet: a title, the phases of the axes, a column with an unclear heading."""
    rows = ["Anlage 4;;;;;", "Achse;Nr.;Moment [Nm];Wert;Dauer [ms];Bemerkung"]
    for axis in range(1, AXES + 1):
        for phase, (share, milliseconds) in enumerate(((1, 300), (0.4, 2000)), start=1):
            torque = f"{3 + axis * share:.1f}".replace(".", ",")
            rows.append(f"{f'Hubachse {axis}' if phase == 1 else ''};{phase};{torque};3,5;{milliseconds};links")
    return "\r\n".join(rows)


def test_a_table_of_axes_becomes_a_project(visitor: Visitor, tmp_path: Path) -> None:
    file = tmp_path / "achsen.csv"
    file.write_bytes(table().encode("cp1252"))
    page = visitor.open("/machines")

    page.get_by_label("File", exact=False).first.set_input_files(file)
    page.get_by_role("button", name="Read table").click()
    expect(page.get_by_text("What is column “Wert”?")).to_be_visible()
    assert violations(page) == []
    page.get_by_label("Quantity of Wert").select_option("Speed")
    page.get_by_role("button", name="Read again").click()
    page.get_by_label("Unit of Wert").select_option("rev/s")
    page.get_by_role("button", name="Size the axes").click()

    expect(page.get_by_role("heading", level=1)).to_have_text("Untitled machine")
    expect(page.get_by_text(f"{AXES} of {AXES}")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    page.set_viewport_size({"width": 1440, "height": 900})
    gears = page.get_by_role("table", name="Gear list")
    most = gears.get_by_role("link").first.inner_text()
    gears.get_by_role("link", name=most, exact=True).click()
    rows = page.get_by_role("table", name="Axes", exact=True).get_by_role("row")
    expect(rows.nth(1).locator(".gear")).to_contain_text(most)
    rows.nth(1).get_by_role("link").click()
    expect(page.get_by_role("heading", name=re.compile(f"^{most}"))).to_be_visible()
    expect(page.locator("#duty [name=n]").first).to_have_value("210")
    page.go_back()

    page.get_by_text("Save machine").click()
    page.get_by_role("textbox", name="Title").fill("Line 4")
    page.get_by_label("Reference").fill("P-77")
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("link", name="Machines").last.click()
    page.get_by_role("link", name="Line 4").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("Line 4")
    expect(page.get_by_text("P-77")).to_be_visible()
    assert violations(page) == []
    expect(page.get_by_text(f"{AXES} of {AXES}")).to_be_visible()


def test_an_example_machine_is_opened_sized_and_its_axes_lead_to_selections(visitor: Visitor) -> None:
    page = visitor.open("/machines")
    assert violations(page) == []
    page.get_by_role("button", name="Open the example machine").click()
    expect(page.get_by_text("5 of 5")).to_be_visible()
    expect(page.get_by_text("5 suitable")).to_be_visible()
    page.get_by_role("link", name="Tool arm").first.click()
    expect(page.locator("#duty tbody tr")).to_have_count(3)
