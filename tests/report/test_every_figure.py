"""Every figure that page, report, workbook and comparison show of a selection, against the reply that REST gives of it.

A number that is shown rounded has to lie within half of its last digit of the reply's; a workbook has all digits.
Numbers are read from the finished pages and files, names and symbols from the one table that names every quantity.
"""

import html
import random
import re
from collections.abc import Iterator, Mapping
from io import BytesIO
from itertools import pairwise

import openpyxl
import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from hpn.words.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.words.units import symbol_of
from hpn.words.wording import Named
from tests.build import TURNING, Json, candidate, worked_example
from tests.property.draw import at_random
from tests.report.test_pdf import text as pdf_text

SEED, NUMBER = 48, r">?[−-]?\d+(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
BRAKED = {
    "duty_cycle": {"motion": TURNING},
    "emergency_stop": {"brake": {"torque_Nm": 12.0}},
    "requirements": {"motor": {"inertia_kgm2": 1e-4}, "position_radius_mm": 150.0},
}
EXAMPLES = (worked_example(), BRAKED, worked_example(requirements={"position_error_at": "rest"}))


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder = tmp_path_factory.mktemp("figures")
    with TestClient(create_app(Settings(database_url=f"sqlite:///{folder}/store.sqlite3"))) as client:
        client.headers["Accept-Language"] = "en"
        yield client


@pytest.fixture(scope="module")
def saved(client: TestClient, soak: bool) -> list[tuple[str, Json]]:
    """Ids of saved selections and their replies: some in the short form, 100 in the long one."""
    chance, count = random.Random(SEED), 100 if soak else 10
    replies = []
    for application in (*EXAMPLES, *(at_random(chance) for _ in range(count - len(EXAMPLES)))):
        response = client.post("/api/v1/selections", json={"application": application})
        if response.status_code == 201:  # some ask for sizes and ratios that leave no gear
            kept = client.get(f"/api/v1/selections/{response.json()['id']}").json()
            replies.append((kept["id"], kept))
    assert len(replies) > 0.8 * count
    return replies


def chosen(kept: Json) -> Json:
    """The gear that pages and files show first, as the reply has it."""
    return candidate(kept["result"], kept["designation"])


def figures(kept: Json) -> Iterator[tuple[str, Named, float]]:
    """Figures of the cycle and of the gear under it that the reply has: field, name and number."""
    duty, gear, asked = kept["result"]["duty"], chosen(kept), kept["application"].get("requirements", {})
    turns = any(n["code"] in ("motor_inertia_included", "motor_all_included") for n in kept["result"]["notices"])
    for field, named in {**DUTY, "load_inertia_kgm2": INPUTS["requirements.load_inertia_kgm2"]}.items():
        if isinstance(duty.get(field), float):
            yield field, named, duty[field]
    for field, named in CANDIDATE.items():
        symbol = {"motor_peak_torque_Nm": "T_in,max", "motor_rated_torque_Nm": "T_in,rms"}.get(field) if turns else None
        at_rest = field == "position_error_arcmin" and asked.get("position_error_at") == "rest"
        if isinstance(gear.get(field), float) and field != "utilisation":
            yield field, Named(named.name + " at rest" * at_rest, symbol or named.symbol), gear[field]


def flat(text: str) -> str:
    """A text without spaces, indices and marks between thousands."""
    return re.sub(r"[\s_\u202f\u00ad]", "", text)


LIMIT = "motor_torque_limit_Nm"


def agrees(shown: str, value: float, field: str = "") -> bool:
    """True for a number that is the value, rounded to its digits; the limit of the drive is rounded down."""
    if field == LIMIT:
        return float(value) * (1 - 1e-3) < float(flat(shown)) <= float(value)
    over, plain = shown.startswith(">"), flat(shown).translate(SUPERSCRIPTS).lstrip(">")
    mantissa, _, exponent = plain.partition("·10")
    scale = 10.0 ** int(exponent or 0)
    half = 0.5 * scale * 10.0 ** -len(mantissa.partition(".")[2])
    number = float(mantissa) * scale
    return value > number if over else abs(number - value) <= half * (1 + 1e-9)


def page_rows(page: str) -> dict[str, list[str]]:
    """Cells of every row and every pair of a list of a page, by the flat text of its head."""
    found: dict[str, list[str]] = {}
    for row in re.findall(r"<tr[^>]*>.*?</tr>|<div>\s*<dt.*?</dd>", page, re.S):
        head, *cells = re.findall(r"<(?:t[hd]|d[td])[^>]*>(.*?)</(?:t[hd]|d[td])>", row, re.S) or [""]
        head = re.sub(r'<span class="(?:below|unit)">.*?</span>', "", head, flags=re.S)
        plain = [flat(html.unescape(re.sub("<[^>]*>", "", cell))) for cell in (head, *cells)]
        found.setdefault(plain[0].removesuffix(",lowerbound"), plain[1:])
    return found


def number_of(cell: str) -> str:
    """Number with which a cell begins."""
    number = re.match(NUMBER, cell.lstrip("≤"))
    return number[0] if number else cell


def test_every_figure_of_the_report_is_the_replys(client: TestClient, saved: list[tuple[str, Json]]) -> None:
    for id, kept in saved:
        text = flat(pdf_text(client.get(f"/api/v1/selections/{id}/report.pdf").content))
        begin = text.index(flat("Figures of the cycle and the gear"))
        shown = re.sub(r"[-\u2010](?=[a-z])", "", text[begin:])  # a name may be parted at the end of a line
        typed = (kept["application"].get("emergency_stop") or {}).get("torque_Nm") is not None
        for field, named, value in figures(kept):
            if field == "stop_torque_Nm" and typed:
                continue  # stands with the inputs
            label = re.sub(r"[-\u2010](?=[a-z])", "", flat(named.name))
            line = re.search(
                re.escape(label) + "(?:,lowerbound)?" + re.escape(flat(named.symbol)) + f"({NUMBER})", shown
            )
            assert line and agrees(line[1], value, field), (id, field, value, line and line[0])


def test_every_figure_of_the_workbook_is_the_replys_to_its_last_digit(
    client: TestClient, saved: list[tuple[str, Json]]
) -> None:
    for id, kept in saved:
        book = openpyxl.load_workbook(BytesIO(client.get(f"/api/v1/selections/{id}/report.xlsx").content))
        rows = [[cell.value for cell in row] for row in book["Selection"].iter_rows()]
        begin = [row[0] for row in rows].index("Figures of the cycle")
        first = {row[0]: row[2] for row in reversed(rows[begin:]) if row[0] and row[2] is not None}
        for field, named, value in figures(kept):
            assert first[named.name] == value, (id, field)
        head, *candidates = [[cell.value for cell in row] for row in book["Candidates"].iter_rows()]
        for cells, reply in zip(candidates, kept["result"]["candidates"], strict=True):
            line = dict(zip(head, cells, strict=True))
            assert (line["Gear"], line["Utilisation"]) == (reply["designation"], reply["utilisation"])
            for field, named, _ in figures(kept):
                column = f"{named.symbol or named.name} [{symbol_of(field)}]".removesuffix(" []")
                if field in reply and column in line:
                    assert line[column] == reply[field] or (reply[field], line[column]) == (None, "unlimited"), column


def test_every_figure_of_a_saved_page_is_the_replys(client: TestClient, saved: list[tuple[str, Json]]) -> None:
    seen: set[str] = set()
    for id, kept in saved:
        page = client.get(f"/selections/{id}").text
        rows = page_rows(page)
        typed = (kept["application"].get("emergency_stop") or {}).get("torque_Nm") is not None
        for field, named, value in figures(kept):
            if field == "stop_torque_Nm" and typed:
                continue  # stands with the inputs
            if cells := rows.get(flat(named.name + named.symbol)):
                assert agrees(number_of(cells[0]), value), (id, field, value, cells)
                seen.add(field)
            elif field == LIMIT:  # stands under "Set in the drive" by a name of its own
                assert f'value="{value!r}"' in page, (id, value)
                seen.add(field)
        limit = repr(chosen(kept)[LIMIT])
        for value, shown in re.findall(r'<data class="quantity" value="([^"]+)">\s*([^<]*)', page):
            end = re.split("[–…]", flat(html.unescape(shown)))[-1]  # of a range
            assert agrees(number_of(end), float(value), LIMIT if value == limit else ""), (id, value, shown)
    assert {"life_L10_h", "momentary_peak_count", LIMIT, "wind_up_arcmin"} <= seen
    assert {"position_error_arcmin", "bearing_life_L50_h", "stopping_time_s", "end_stop_speed_rpm"} <= seen


def test_every_figure_of_a_comparison_is_the_replies(client: TestClient, saved: list[tuple[str, Json]]) -> None:
    for (a, first), (b, second) in pairwise(saved):
        page = client.get(f"/selections/compare?a={a}&b={b}").text
        rows = page_rows(page[page.index('id="compared-figures"') :])
        for place, kept in enumerate((first, second)):
            for field, named, value in figures(kept):
                cells = rows.get(flat(named.name + named.symbol)) or rows[_other_symbol(field, rows)]
                assert agrees(number_of(cells[place]), value, field), (a, b, field, value, cells)
        checks = page_rows(page[page.index('id="compared-checks"') : page.index('id="compared-figures"')])
        for place, kept in enumerate((first, second)):
            definitions = kept["result"]["check_definitions"]
            for check in chosen(kept)["checks"]:
                title, printed = definitions[check["code"]]["title"], definitions[check["code"]]["equation"]
                name = title.split(": ")[-1] if printed else title
                cell = checks[flat(name[:1].upper() + name[1:])][place]
                if check["utilisation"] is not None and not cell.startswith(">"):
                    assert agrees(number_of(cell), 100 * check["utilisation"]), (a, b, check, cell)


def _other_symbol(field: str, rows: Mapping[str, list[str]]) -> str:
    """Head of a figure that has the symbol or name of the other selection, such as that of a motor turned along."""
    return next(head for head in rows if head.startswith(flat(CANDIDATE[field].name)))


def test_published_figures_are_the_catalogues_wherever_they_stand(
    client: TestClient, saved: list[tuple[str, Json]]
) -> None:
    for id, kept in saved:
        gear = client.get(f"/api/v1/catalogue/gears/{chosen(kept)['designation']}").json()
        rows = page_rows(client.get(f"/selections/{id}").text)
        book = openpyxl.load_workbook(BytesIO(client.get(f"/api/v1/selections/{id}/report.xlsx").content))
        cells = {row[0].value: row[2].value for row in book["Selection"].iter_rows() if row[0].value}
        for field, named in GEAR.items():
            if symbol_of(field) and isinstance(value := gear.get(field), float):
                assert cells[named.name] == value, (id, field)
                if shown := rows.get(flat(named.name + named.symbol)):
                    assert agrees(number_of(shown[0]), value), (id, field, shown)
