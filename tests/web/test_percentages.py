"""A failing check never reads like a passing one: a percentage has enough digits to differ from its limit."""

import html
import re

import pytest
from starlette.testclient import TestClient

from hpn.explain.drawings.words import share
from hpn.words.reader import Reader
from hpn.words.wording import telling_decimals
from tests.build import candidate, cycle, phase

# Torque against T_N = 80 Nm of HPN-20A-5, u, and the percentage, by hand: T / 0.8 Nm.
NEAR = [
    (80.001, 1.0, "100.001"),
    (79.999, 1.0, "99.999"),
    (64.01, 0.8, "80.01"),
    (63.99, 0.8, "79.99"),
    (80.01, 0.8, "100.01"),  # far from its bound, and beyond the whole limit
    (79.992, 0.85, "99.99"),
    (80.0000000008, 1.0, "100.000000001"),
]


def words(api: TestClient, address: str, language: str) -> str:
    """Text of a page, with each run of blanks as one blank."""
    page = api.get(address, headers={"Accept-Language": language}).text
    return re.sub("[ \n]+", " ", html.unescape(re.sub(r"<[^>]+>", "", page)))


@pytest.mark.parametrize(("torque", "u", "text"), NEAR)
def test_reply_and_page_say_it_alike_in_both_languages(api: TestClient, torque: float, u: float, text: str) -> None:
    wishes = {"ratios": [5], "sizes": ["20A"], "utilisation": u}
    reply = api.post("/api/v1/select", json=cycle(phase(torque, 50), requirements=wishes)).json()
    gear = candidate(reply, "HPN-20A-5")
    page = f"/?T={torque!r}&n=50&t=1&i=5&size=20A&u={u}"

    assert f" at {text} % of its limit" in gear["reason"]
    short = text.removesuffix(".0")
    english, german = (words(api, page, language) for language in ("en", "de"))
    assert re.search(rf"(Largest utilisation ?|average torque \(){re.escape(short)}\u202f%", english)
    assert f"{short.replace('.', ',')}\u202f%" in german


def test_only_part_of_a_limit_is_allowed_where_the_user_says_so(api: TestClient) -> None:
    text = words(api, "/?T=64.01&n=50&t=1&Lh=1000&i=5&size=20A&u=0.8", "en")

    assert "Fails on: average torque (80.01\u202f%). u allows 80\u202f%." in text
    assert "≤ 80\u202fNm ×\xa080\u202f%" in text
    assert "≥ 1\u202f000\u202fh ÷\xa080\u202f%" in text


def test_the_share_of_the_bearing_life_names_the_load_and_the_cube_of_u(api: TestClient) -> None:
    """108 h of 20,000 h at 569 %: the share is a ratio of loads, and a load limit u means a life limit u³."""
    over = words(api, "/?T=900&n=1500&t=3&FR=9000", "en")
    fits = words(api, "/?T=90&n=150&t=3&FR=900&u=0.9", "en")

    assert re.search(r"569\u202f% ✕ ?fails? load Pm ", over)
    assert re.search("↓needs: at most ?room: up to", over)
    assert "room: up to" in fits and "needs: at most" not in fits
    assert "at u = 90\u202f% a life counts × u³ (72.9\u202f%)" in fits


@pytest.mark.parametrize("allowed", [1.0, 0.8, 0.855, 1 / 3])
@pytest.mark.parametrize("distance", [1e-1, 1e-3, 1e-6, 1e-9, 2e-12])
def test_a_value_beside_its_bound_is_written_beside_it(allowed: float, distance: float) -> None:
    for write in (Reader().percent, Reader(digits=4).percent):
        under, at, over = (
            float(write(allowed * (1 + sign * distance), allowed).split("\u202f%")[0]) for sign in (-1, 0, 1)
        )
        assert under < at < over or (distance * allowed < 1e-11 and under <= at <= over)


def test_an_infinite_or_unknown_share_needs_no_digits() -> None:
    assert telling_decimals(float("inf"), 100.0, 1) == 1
    assert telling_decimals(float("nan"), 100.0, 1) == 1
    assert telling_decimals(100.0, 100.0, 0) == 0


@pytest.mark.parametrize("distance", [1e-1, 1e-3, 1e-6, 1e-9, 2e-12])
def test_a_sentence_tells_a_use_from_the_whole_limit(distance: float) -> None:
    under, at, over = (float(str(share(1 + sign * distance)).removesuffix(" %")) for sign in (-1, 0, 1))

    assert under < at == 100 < over


@pytest.mark.parametrize(
    ("query", "code", "column"),
    [("T=40&n=250&t=1&Tk=5&Nk=10&u=0.93", "momentary_peak_count", 1), ("T=0&n=250&t=1&Lh=10000", "life", 0)],
)
def test_a_figure_that_nothing_limits_is_a_word_beside_its_check(
    api: TestClient, query: str, code: str, column: int
) -> None:
    row = re.search(f'id="check-{code}".*?</tr>', api.get(f"/?{query}").text, re.DOTALL)
    assert row
    cell = re.findall(r'<td class="figure">(.*?)</td>', row[0], re.DOTALL)[column]
    assert "unlimited" in cell
    assert "–" not in cell and "93" not in cell


def test_a_demand_that_is_not_published_has_no_unit(client: TestClient) -> None:
    page = client.get("/?T=10&n=100&t=1&m=5&gear=HPN-40A-5").text
    row = re.search(r'id="check-weight">.*?</tr>', page, re.DOTALL)
    assert row and re.search(r">–\s*</data>\s*</td>", row[0])
