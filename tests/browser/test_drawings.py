"""Drawings of the page: elements that are marked together, and texts that don't overlap."""

import re
from random import Random
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.engine.selection import select
from hpn.explain.drawings import Subject, chart
from hpn.explain.drawings.chart import LARGE, SMALL
from hpn.explain.drawings.envelope import envelope_scene
from hpn.explain.drawings.picture import bearing_picture
from hpn.explain.drawings.svg import STYLE, markup
from hpn.words.reader import Reader
from tests.browser.conftest import Visitor
from tests.browser.test_plots import EXAMPLE, PHASES, STATIC
from tests.build import cycle, phase

# --- Drawings ---------------------------------------------------------------------------------------------------------


def marked(page: Page) -> dict[str, list[str]]:
    """Phases that are marked in the table, the chart of the cycle and the drawing."""
    places = "each => each.dataset.phase ?? each.id.split('-')[1]"
    kinds = {"row": "#duty tr.marked", "step": "#cycle .phase-step.marked", "load": "#envelope .mark.marked"}
    return {
        kind: page.locator(path).locator("visible=true").evaluate_all(f"all => all.map({places})")
        for kind, path in kinds.items()
    }


def seen(page: Page, path: str) -> Any:
    """Part of the visible one of the envelope's two drawings."""
    return page.locator(f"#envelope {path}").locator("visible=true")


def test_row_step_and_load_of_a_phase_are_marked_together_by_pointer_and_by_focus(visitor: Visitor) -> None:
    page = visitor.open(PHASES)
    second = {"row": ["1"], "step": ["1"], "load": ["1"]}

    seen(page, '[data-phase="1"] .number').hover()
    assert marked(page) == second
    page.mouse.move(700, 880)
    assert marked(page) == {"row": [], "step": [], "load": []}

    page.get_by_label("Speed, phase 2").focus()
    assert marked(page) == second
    page.keyboard.press("End")
    page.keyboard.type("0")
    expect(page).to_have_url(re.compile("n=5000"))
    expect(page.locator("#envelope .mark.marked").locator("visible=true")).to_have_count(1)
    assert marked(page) == second

    seen(page, '[data-phase="2"]').focus()
    assert marked(page) == {"row": ["2"], "step": ["2"], "load": ["2"]}
    assert seen(page, '[data-phase="2"]').evaluate("each => each.matches(':focus-visible')")


def test_a_move_is_marked_together_with_all_its_phases(visitor: Visitor) -> None:
    page = visitor.open(
        "/?mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.8&mv=dwell&ms=&mt=0.4&mv=triangular&ms=-90&mt=1&i=5"
    )
    page.get_by_label("Time, move 3").focus()
    assert marked(page) == {"row": ["2"], "step": ["4", "5"], "load": []}
    page.locator('#cycle [data-phase="3"] .number').hover()
    assert marked(page) == {"row": ["1"], "step": ["3"], "load": []}


def test_each_phase_of_a_long_table_has_its_step(visitor: Visitor) -> None:
    page = visitor.open("/?" + "&".join(f"T={20 + k % 7}&n=100&t=0.3" for k in range(60)) + "&i=5")
    page.get_by_label("Torque, phase 41").focus()
    assert marked(page) == {"row": ["40"], "step": ["40"], "load": []}


@pytest.mark.parametrize(
    ("link", "width", "room"),
    [
        (f"{EXAMPLE}&FR=500&FA=200", 1440, (348, 400)),
        (f"{EXAMPLE}&FR=500&FA=200", 1920, (640, 480)),
        (PHASES, 1440, (348, 400)),  # a table with loads narrows the result
        (PHASES, 1920, (448, 515)),
    ],
)
def test_the_drawing_fits_its_place_on_the_overview(
    visitor: Visitor, link: str, width: int, room: tuple[int, int]
) -> None:
    page = visitor.open(link, width=width)
    box = seen(page, "svg").bounding_box()
    assert box
    assert room[0] * 0.85 <= box["width"] <= room[0]
    assert box["height"] <= room[1] + 1


OVERLAPS = """(least) => [...document.querySelectorAll("svg")].flatMap((svg) => {
  if (!svg.getClientRects().length) return [];
  const frame = svg.getBoundingClientRect();
  const found = [];
  const scale = svg.getScreenCTM().a;
  // A text may be turned: its letters are boxes about their middles.
  const lettersOf = (text, size) => [...Array(text.getNumberOfChars()).keys()].map((k) => {
    const [start, end] = [text.getStartPositionOfChar(k), text.getEndPositionOfChar(k)];
    const lifted = new DOMPoint((start.x + end.x) / 2, (start.y + end.y) / 2 - size / scale / 3);
    const { x, y } = lifted.matrixTransform(text.getScreenCTM());
    return { x, y, half: Math.max(end.x - start.x, 1) * scale / 2 };
  });
  const texts = [...svg.querySelectorAll("text")].map((text) => {
    const size = scale * parseFloat(getComputedStyle(text).fontSize);
    return { said: text.textContent, letters: lettersOf(text, size), size };
  });
  texts.forEach(({ said, letters, size }, k) => {
    if (size < least) found.push([said, "small", size]);
    const inside = letters.every(({ x, y, half }) =>
      x - half > frame.left - 1 && x + half < frame.right + 1 && y + size / 3 < frame.bottom + 1);
    if (!inside) found.push([said, "outside"]);
    for (const other of texts.slice(k + 1)) {
      const over = letters.some((one) => other.letters.some((two) =>
        Math.abs(one.x - two.x) < (one.half + two.half) * 0.9 && Math.abs(one.y - two.y) < 0.6 * size));
      if (over) found.push([said, other.said]);
    }
  });
  return found;
})"""


def test_no_text_lies_over_another_as_a_browser_sets_them_and_none_is_smaller_than_12_pixels(chromium: Browser) -> None:
    catalogue, chance = load_catalogue(), Random(16)
    gears = [catalogue.by_designation[name] for name in ("HPN-11A-5", "HPN-20A-5", "HPN-32A-25")]
    drawn = []
    for count in (0, 1, 1, 2, 3, 7, 7, 12, 24, 40):
        loads = [(chance.uniform(0, 3000), chance.uniform(0, 3000)) for _ in range(count)]
        phases = [phase(1, chance.uniform(10, 900), radial_N=r, axial_N=a) for r, a in loads] or [phase(1, 300)]
        subject = Subject(Application.model_validate(cycle(*phases)), chance.choice(gears), catalogue)
        candidate = select(subject.application, catalogue).candidate(subject.gear.designation)
        assert candidate is not None
        picture = bearing_picture(subject, candidate.check("output_bearing_life"))
        assert picture is not None
        for reader in (Reader(), Reader("de", ("lbf",))):
            drawn.append(
                "".join(markup(chart(envelope_scene(picture, reader), reader, size)) for size in (SMALL, LARGE))
            )
    page = chromium.new_page()
    styles = "".join(path.read_text() for path in (STATIC / "app.css", STYLE, STATIC / "plots.css"))
    for width in (330, 348, 370, 395, 410, 440, 470, 500, 515, 560, 600, 640):
        figures = "".join(f'<figure class="envelope" style="width: {width}px">{svg}</figure>' for svg in drawn)
        page.set_content(f"<style>{styles}</style><main>{figures}</main>")
        assert page.evaluate(OVERLAPS, 11.95) == [], width
    page.close()
