"""Work on a machine from its page: by keyboard, with a preview of the effect, on a desktop and on a phone."""

import re

import httpx
import pytest
from playwright.sync_api import Locator, expect

from tests.browser.conftest import Visitor, in_german, violations
from tests.fleet.test_machine_page import MACHINE


@pytest.fixture
def machine(server: str) -> str:
    """Address of a machine."""
    return str(httpx.post(f"{server}/api/v1/machines", json=MACHINE, trust_env=False).json()["url"])


def test_marked_axes_are_changed_by_keys_and_undone(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine)
    page.keyboard.press("/")
    expect(page.get_by_role("searchbox")).to_be_focused()
    page.get_by_role("searchbox").press("Escape")
    page.get_by_role("checkbox", name="Mark Infeed belt").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Space")
    expect(page.get_by_role("checkbox", name="Mark Infeed belt")).to_be_checked()
    page.get_by_label("Maximum utilisation").last.fill("0.4")
    expect(page.locator(".bulk .effect")).to_contain_text("gear")
    assert violations(page) == []
    page.get_by_role("button", name="Set for the marked axes").click()
    expect(page.get_by_role("row", name="Infeed belt")).to_contain_text("u 40")

    page.keyboard.press("Control+z")

    expect(page.get_by_text("Undone.")).to_be_visible()
    expect(page.get_by_role("row", name="Infeed belt")).not_to_contain_text("u 40")


def test_common_values_open_in_place_and_say_their_effect_while_they_are_typed(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine)
    page.keyboard.press("e")
    expect(page.get_by_role("button", name="Apply to 4 axes")).to_be_hidden()
    page.get_by_label("Maximum utilisation").fill("0.5")
    expect(page.locator("#every-axis .effect")).to_contain_text("take")
    assert violations(page) == []
    page.get_by_role("button", name="Apply to 4 axes").click()
    expect(page.locator("#every-axis")).to_contain_text("50")
    told = page.locator(".machine-strap:not([hidden])")
    assert told.evaluate("told => told.scrollHeight") <= 48  # one line: sentence and Undo, without a blank line below
    assert page.evaluate("document.documentElement.scrollWidth") == page.evaluate("innerWidth")
    page.go_back()


@pytest.mark.parametrize("script", [True, False])
def test_applied_common_values_do_not_open_again_with_the_page(visitor: Visitor, machine: str, script: bool) -> None:
    page = visitor.open(f"{machine}?show=todo&edit=common", script=script)
    page.get_by_label("Maximum utilisation").fill("0.5")
    if not script:
        page.get_by_role("button", name="Show the effect").click()
    page.get_by_role("button", name="Apply to 4 axes").click()
    expect(page.locator(".machine-strap:not([hidden])")).to_contain_text("Changed.")
    expect(page).not_to_have_url(re.compile("edit="))

    page.goto(page.url)  # as from a bookmark: a change is sent once

    expect(page.locator("#every-axis")).to_contain_text("50")
    expect(page.get_by_role("button", name="Apply to 4 axes")).to_have_count(0)
    expect(page.locator(".filter [aria-current]")).to_contain_text("To do")
    assert page.url.endswith(f"{machine}?show=todo")


def test_who_types_after_somebody_else_has_saved_sees_theirs_and_applies_own_values(
    visitor: Visitor, server: str, machine: str
) -> None:
    page = visitor.open(machine)
    page.keyboard.press("e")
    theirs = {"common": {"requirements": {"utilisation": 0.8}}}
    httpx.patch(f"{server}/api/v1{machine}", json=theirs, trust_env=False).raise_for_status()
    page.get_by_label("Maximum utilisation").fill("0.5")
    expect(page.locator("#every-axis .effect")).to_contain_text("Somebody else has changed this")
    expect(page.locator("#every-axis")).to_contain_text("somebody else has set 0.8 since")
    expect(page.get_by_label("Maximum utilisation")).to_be_focused()
    expect(page.get_by_label("Maximum utilisation")).to_have_value("0.5")
    page.get_by_role("button", name="Apply to 4 axes").click()
    expect(page.get_by_text("Changed.")).to_be_visible()
    kept = httpx.get(f"{server}/api/v1{machine}?fields=common", trust_env=False).json()
    assert kept["common"]["requirements"]["utilisation"] == 0.5


@pytest.mark.parametrize("place", ["machine", "revisions", "list"])
def test_a_phone_has_room_for_a_utilisation_far_beyond_every_gear(visitor: Visitor, server: str, place: str) -> None:
    phases = [{"torque_Nm": 9000, "speed_rpm": 100, "duration_s": 1}]
    application = {"duty_cycle": {"phases": phases}, "requirements": {"life_h": 20000}}
    draft = {"title": "Press of a far utilisation", "application": application}
    httpx.post(f"{server}/api/v1/selections", json=draft, trust_env=False).raise_for_status()
    saved = httpx.post(
        f"{server}/api/v1/machines", json={"axes": [{"application": application}]}, trust_env=False
    ).json()
    httpx.post(f"{server}/api/v1{saved['url']}/revisions", json={"label": "A"}, trust_env=False).raise_for_status()
    addresses = {"machine": saved["url"], "revisions": f"{saved['url']}/revisions?from=A&to=now&show=all"}
    page = visitor.open(str(addresses.get(place, "/selections?search=far")), 390, touch=True)

    share = page.locator(".axes .percent, .saved-list .percent").first
    assert len(share.inner_text()) >= len("1 000 000 %")
    cell = share.locator("xpath=ancestor::td")
    assert cell.evaluate("cell => cell.scrollWidth <= cell.clientWidth")
    assert page.evaluate("document.documentElement.scrollWidth") == 390


def test_a_phone_shows_every_axis_and_its_marks(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine, 390, touch=True)

    assert page.evaluate("document.documentElement.scrollWidth") == 390
    for name in ("Infeed belt", "Press ram", "Pallet lift", "Carton erector"):
        expect(page.get_by_role("checkbox", name=f"Mark {name}")).to_be_visible()
    page.get_by_role("checkbox", name="Mark Press ram").check()
    expect(page.get_by_role("button", name="Remove")).to_be_visible()
    expect(page.get_by_role("heading", name="Fewest kinds")).to_be_visible()
    assert violations(page) == []


def test_common_values_typed_while_the_server_is_silent_are_applied_once_it_answers(
    visitor: Visitor, machine: str
) -> None:
    page = visitor.open(f"{machine}?edit=common")
    page.route("**/change*", lambda route: route.abort())
    page.get_by_label("Maximum utilisation").fill("0.5")
    expect(page.locator("#every-axis .effect")).to_contain_text("No answer: the connection broke off")
    expect(page.get_by_label("Maximum utilisation")).to_have_value("0.5")

    page.unroute("**/change*")
    for watch in visitor.watches:
        watch.console = [text for text in watch.console if "ERR_FAILED" not in text]
    page.get_by_role("button", name="Apply to 4 axes").click()

    expect(page.locator(".machine-strap:not([hidden])")).to_contain_text("Changed.")
    expect(page.locator("#every-axis")).to_contain_text("50")


@pytest.fixture
def revised(server: str, machine: str) -> str:
    """Address of a machine that differs from its revision A and has tolerances."""
    api = f"{server}/api/v1{machine}"
    httpx.post(f"{api}/revisions", json={"label": "A"}, trust_env=False).raise_for_status()
    httpx.delete(f"{api}/axes/3", trust_env=False).raise_for_status()
    stop = {"emergency_stop": {"torque_Nm": 60}}
    httpx.patch(f"{api}/axes/1", json={"application": stop}, trust_env=False).raise_for_status()
    common = {"tolerances": {"torque_Nm": {"percent": 5}}}
    httpx.patch(api, json={"common": common}, trust_env=False).raise_for_status()
    return machine


@pytest.mark.parametrize("width", [1440, 1024, 390])
def test_what_changed_since_the_revision_stands_in_the_table_and_beside_it(
    visitor: Visitor, revised: str, width: int
) -> None:
    page = visitor.open(f"{revised}?show=changed", width, touch=width < 600)

    beside = page.get_by_role("region", name="Changed since revision A")
    expect(beside).to_contain_text("Removed: Pallet lift")
    expect(beside.get_by_role("listitem").filter(has_text="Infeed belt")).to_contain_text("60 Nm")
    expect(page.locator("#axis-1 + .since-row")).to_contain_text("HPN-")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_table_of_axes_fits_beside_the_gear_list(visitor: Visitor, revised: str, language: str) -> None:
    page = visitor.open(revised)
    if language == "de":
        in_german(page)

    assert page.locator(".panel.axes").evaluate("axes => axes.scrollWidth <= axes.clientWidth")


@pytest.mark.parametrize("script", [True, False])
def test_an_axis_is_added_without_leaving_the_table(visitor: Visitor, machine: str, script: bool) -> None:
    page = visitor.open(machine, script=script)
    page.get_by_label("New axis").fill("Lift")
    page.get_by_role("combobox", name="with the values of").select_option("Infeed belt")
    page.get_by_role("button", name="Add axis").click()

    expect(page.locator("#axis-5")).to_contain_text("Lift")
    expect(page.locator("#axis-5")).to_contain_text("HPN-")
    expect(page.get_by_role("link", name="Open Lift")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_text("Undone.")).to_be_visible()
    expect(page.locator("#axis-5")).to_have_count(0)


@pytest.mark.parametrize("width", [1440, 390])
def test_common_tolerances_are_typed_beside_the_common_values(visitor: Visitor, revised: str, width: int) -> None:
    page = visitor.open(f"{revised}?edit=common", width, touch=width < 600)
    torque = page.get_by_label("Tolerance: Torque", exact=True)
    expect(torque).to_have_value("5 %")
    torque.fill("+8 −2")
    page.get_by_label("by the worst case").check()
    expect(page.locator("#every-axis .effect")).to_contain_text("take")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []
    page.get_by_role("button", name="Apply to 3 axes").click()

    expect(page.locator("#every-axis")).to_contain_text("+8")
    page.goto(f"{page.url.partition('?')[0]}/axes/1")
    expect(page.locator("#f-tol_T")).to_have_attribute("placeholder", "+8 % −2 %")
    expect(page.get_by_role("checkbox", name="by the worst case")).to_be_disabled()
    page.get_by_role("button", name="Not for this axis").last.click()
    expect(page.get_by_role("list", name="Tolerances of the machine")).to_contain_text("not for this axis")
    assert violations(page) == []


def test_a_long_change_shows_its_count_and_is_stopped_without_a_trace(visitor: Visitor, server: str) -> None:
    phases = [{"torque_Nm": 21, "speed_rpm": 150, "duration_s": 0.3}] * 8
    tolerances = {"torque_Nm": {"percent": 5}, "speed_rpm": {"percent": 3}, "duration_s": {"percent": 2}}
    axes = [{"name": f"A{k}", "application": {"duty_cycle": {"phases": phases, "pause_s": 0.4}}} for k in range(1200)]
    body = {"axes": axes, "common": {"tolerances": tolerances}}
    machine = str(httpx.post(f"{server}/api/v1/machines", json=body, trust_env=False, timeout=600).json()["url"])
    page = visitor.open()
    page.route("**/kinds", lambda route: route.fulfill(body=""))  # it would keep the server busy after this test
    page.goto(f"{server}{machine}?edit=common")
    page.get_by_label("Maximum utilisation").fill("0.5")
    apply, work = page.get_by_role("button", name="Apply to 1"), page.get_by_role("region", name="Sizing again")
    expect(apply).to_be_visible()

    apply.click()
    expect(work).to_contain_text("of 1")
    work.get_by_role("button", name="Stop").click()

    expect(page.get_by_text("Stopped: nothing was changed")).to_be_visible()
    expect(work).to_be_hidden()
    kept = httpx.get(f"{server}/api/v1{machine}?fields=common", trust_env=False).json()
    assert "requirements" not in kept["common"]
    expect(page.get_by_label("Maximum utilisation")).to_have_value("0.5")
    apply.click()
    expect(page.get_by_text("Changed.")).to_be_visible()


def test_the_head_and_the_columns_of_a_machine_with_tolerances_fit_in_german(visitor: Visitor, revised: str) -> None:
    page = visitor.open(revised)
    in_german(page)

    name, limit = page.locator(".machine-block .largest .name"), page.locator(".allowed text")
    expect(limit).to_contain_text("u = ")
    for width in (1440, 1280, 1100, 1024, 800, 390):
        page.set_viewport_size({"width": width, "height": 900})
        is_below, is_behind = (
            edge(name, one) <= edge(limit, other) for one, other in (("bottom", "top"), ("right", "left"))
        )
        assert is_below or is_behind, width
        table = page.locator(".panel.axes")
        assert table.evaluate("table => table.scrollWidth <= table.clientWidth"), width
        assert page.evaluate("document.documentElement.scrollWidth") == width
    expect(page.locator("td.worst").first).to_be_visible()  # on the phone, too


def edge(thing: Locator, name: str) -> float:
    """Edge of the content of an element."""
    content = "const content = new Range(); content.selectNodeContents(thing)"
    return float(thing.evaluate(f"thing => {{ {content}; return content.getBoundingClientRect().{name} }}"))
