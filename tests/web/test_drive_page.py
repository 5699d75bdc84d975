"""Motion, torques, speeds and motors on the pages: live, saved, in parts, with and without a list of motors."""

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings

TYPED = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4"
TURNING = "/?mech=rotary&J=0.8&mg=12&rg=250&Tf=1.5&mv=trapezoidal&ms=90&mt=0.8&mv=dwell&ms=&mt=0.4&tp=1"
DRAWN = 'class="drawing plane'
SCREW = "/?mech=ball_screw&h=10&ml=80&inc=30&mv=trapezoidal&ms=500&mt=2&mv=trapezoidal&ms=-500&mt=2"
MOTORS = (
    "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    "M & 1,6000,3000,4,30,0.0001,mine\nM 2,6000,3000,20,60,0.002,mine\nM 3,60,30,20,60,,mine\n"
)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder = tmp_path_factory.mktemp("plain")
    with TestClient(create_app(Settings(database_url=f"sqlite:///{folder}/s.sqlite3"))) as client:
        yield client


@pytest.fixture(scope="module")
def supplied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder: Path = tmp_path_factory.mktemp("supplied")
    (folder / "motors.csv").write_text(MOTORS)
    settings = Settings(database_url=f"sqlite:///{folder}/s.sqlite3", catalogue_supplement=str(folder))
    with TestClient(create_app(settings)) as client:
        yield client


def drive(page: str) -> str:
    """Section on the drive of a page."""
    found = re.search(r'<section class="section panel drive".*?</section>', page, re.DOTALL)
    assert found
    return found[0]


def words(part: str) -> str:
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", part)).split())


@pytest.mark.parametrize("query", [TURNING, SCREW])
def test_a_motion_is_drawn_with_its_phases_and_both_planes_at_once(client: TestClient, query: str) -> None:
    page = client.get(query).text
    part = drive(page)

    assert part.count(DRAWN) == 2
    assert set(re.findall(r'class="phase-step[^"]*"[^>]* data-phase="(\d+)"', page)) >= {"0", "1", "2"}
    assert re.search(r"Motion of [^;]+; at most [^;]+; torque from ", words(page))
    assert "which needs a motion and the motor’s inertia" in words(part)


def test_typed_phases_without_a_motor_have_the_plane_of_the_gear_and_a_line_on_pairs(client: TestClient) -> None:
    part = drive(client.get(TYPED).text)

    assert part.count(DRAWN) == 1
    assert part.count("<table") == 2  # resonance and position need no motor
    assert "every gear with every motor of a list of yours" in words(part)


def test_an_edit_brings_the_section_where_it_is_in_sight_and_else_when_it_is_asked_for(client: TestClient) -> None:
    edit = {"HX-Request": "true", "HX-Target": "section#result"}

    assert DRAWN not in drive(client.get(TURNING, headers=edit).text)
    assert drive(client.get(TURNING, headers=edit | {"HPN-Parts": "drive"}).text).count(DRAWN) == 2
    asked = client.get(TURNING, headers={"HX-Request": "true", "HX-Target": "section#drive"}).text
    assert drive(asked).count(DRAWN) == 2
    assert "result-heading" not in asked


def test_motors_that_fit_are_listed_each_with_a_link_that_chooses_it(supplied: TestClient) -> None:
    page = supplied.get(TURNING + "&gear=HPN-20A-15").text
    part = drive(page)
    links = re.findall(r'<a href="([^"]+)" aria-label="Choose ([^"]+)"', part)

    assert [unescape(name) for _, name in links] == ["M & 1", "M 2"]
    chosen = drive(supplied.get(unescape(links[0][0])).text)
    assert "Torque and speed at the motor M & 1" in words(chosen)
    assert "Motor torques include the motor’s own inertia" in words(chosen)
    assert "Gears that fit with M & 1" in words(chosen)
    assert 'data-label="Ratios that fit"' in chosen
    assert re.search(r'<tr class="chosen">\s*<th scope="row">M &amp; 1</th>', chosen)
    assert "Nearest that does not fit: M 3" in words(part)


def test_a_required_inertia_ratio_leaves_out_motors_without_an_inertia_and_stays_in_every_link(
    supplied: TestClient,
) -> None:
    part = drive(supplied.get(TURNING + "&md=M+2&Jr=50&gear=HPN-20A-15").text)
    links = re.findall(r'<a href="([^"]+)" aria-label="Choose', part)

    assert links
    assert all("&amp;Jr=50&amp;" in link for link in links)
    assert "motors without an inertia in your list (1)" in words(part)
    assert "M 3" not in words(part)


def test_a_list_of_which_none_fits_says_so(supplied: TestClient) -> None:
    part = drive(supplied.get("/?T=4000&n=1&t=1&gear=HPN-11A-4").text)

    assert 'id="motors"' not in part
    assert "None of your motors fits HPN-11A-4. Nearest that does not fit:" in words(part)


@pytest.mark.parametrize("gear", ["HPN-40A-5", "HPN-11A-50"])
def test_every_gear_has_its_section(supplied: TestClient, gear: str) -> None:
    reply = supplied.get(TYPED + "&gear=" + gear)
    assert reply.status_code == 200
    assert drive(reply.text).count(DRAWN) == 2


@pytest.mark.parametrize("query", [TYPED, TURNING, SCREW + "&md=M%20%26%201&Jr=50"])
def test_the_saved_page_shows_the_same(supplied: TestClient, query: str) -> None:
    live = drive(supplied.get(query).text)
    saved = drive(supplied.post("/selections", data={"link": query}).text)

    assert re.findall("<svg.*?</svg>", saved, re.DOTALL) == re.findall("<svg.*?</svg>", live, re.DOTALL)
    assert re.findall("<td.*?</td>", saved, re.DOTALL) == re.findall("<td.*?</td>", live, re.DOTALL)
    assert re.findall('<a href="/[?][^"]*" aria-label="Choose[^>]*>', saved) == re.findall(
        '<a href="/[?][^"]*" aria-label="Choose[^>]*>', live
    )


def test_the_section_speaks_german(supplied: TestClient) -> None:
    part = words(drive(supplied.get(TURNING, headers={"Accept-Language": "de"}).text))

    for said in ("Am Umrichter einstellen", "Drehmoment und Drehzahl am Abtrieb", "Eigene Motoren"):
        assert said in part
    assert not re.search(r"\b(the|speed|torque|motors)\b", part)


def test_the_drives_torque_limit_is_one_figure_and_never_rounded_up(client: TestClient) -> None:
    """T_R / i by hand: 254 / 3 = 84.666…, which three digits would raise to 84.7."""
    page = client.get(TYPED + "&i=3&size=32A").text

    assert "Set the drive’s torque limit to 84.66 Nm." in words(page)
    assert re.search(r"Torque limit 84\.66 Nm", words(drive(page)))
    assert "Set the drive’s" not in words(drive(page))  # the head says it
