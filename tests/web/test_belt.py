"""The belt helper of the form: strands or power come to a radial load, which the link keeps."""

import html
import math
import re
from collections.abc import Iterator

import pytest
from starlette.testclient import TestClient

from hpn.physics.strands import Strands, radial_load
from hpn.web.app import create_app


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app()) as client:
        yield client


CYCLE = "/?T=40&n=250&t=0.3&i=5"


def page(client: TestClient, query: str) -> str:
    return html.unescape(client.get(CYCLE + query).text)


def test_the_load_of_two_strands_is_the_sum_of_their_vectors() -> None:
    for F_1, F_2, beta in ((900.0, 300.0, 180.0), (900.0, 300.0, 120.0), (500.0, 500.0, 60.0), (700.0, 0.0, 90.0)):
        turned = complex(math.cos(math.radians(beta)), math.sin(math.radians(beta)))
        # Seen along the first strand, the second one leaves the pulley turned by the wrap angle and pulls back.
        assert radial_load(tight_N=F_1, slack_N=F_2, wrap_deg=beta) == pytest.approx(abs(F_1 - F_2 * turned), rel=1e-12)


def test_power_speed_and_pretension_give_the_strands() -> None:
    belt = Strands(power_W=1500, speed_m_per_s=5, pretension_factor=2)
    assert belt.radial_N == pytest.approx(600)  # 300 N turn, 450 and 150 N in the strands


def test_page_without_script_keeps_the_belt_beside_its_sum(client: TestClient) -> None:
    answer = client.get(f"{CYCLE}&bF1=450&bF2=150&written=en", follow_redirects=False)
    assert answer.status_code == 200
    assert 'value="450"' in answer.text and "Sum of the strands" in answer.text


def test_the_page_shows_the_sum_and_takes_it_as_the_radial_load(client: TestClient) -> None:
    shown = page(client, "&bF1=450&bF2=150")
    assert re.search(r"Sum of the strands.*?600", shown, re.DOTALL)
    taken = page(client, "&bF1=450&bF2=150&do=belt")
    assert re.search(r'id="f-FR"[^>]*value="600"', taken)
    assert "FR=600" in taken and "bF1=450" not in re.sub(r"<input[^>]*>", "", taken)


@pytest.mark.parametrize(
    ("query", "place", "said"),
    [
        ("&bF1=450", "f-bF2", "is missing"),
        ("&bF1=-1&bF2=3", "f-bF1", "at least 0"),
        ("&bF1=9&bF2=3&bP=7", "f-bP", "give either"),
        ("&bP=7&bv=2", "f-bk", "is missing"),
        ("&bF1=9&bF2=3&bw=400", "f-bw", "at most 360"),
        ("&bF1=much&bF2=3", "f-bF1", "number"),
    ],
)
def test_a_belt_that_gives_no_load_says_why_and_leads_to_its_field(
    client: TestClient, query: str, place: str, said: str
) -> None:
    found = re.search(rf'<a href="#{place}">[^<]*</a>: <span>(.*?)</span>', page(client, query), re.DOTALL)
    assert found and said in found[1]
