"""Units in fields: every unit printed beside a field may be typed into it, and so may others that engineers write."""

import re
from collections.abc import Iterator
from html import unescape

import pytest
from starlette.testclient import TestClient

from hpn.links.symbols import units_of
from hpn.tables.numbers import Entry, Notation
from hpn.web.form.link_reader import parse
from hpn.words.reader import Reader
from hpn.words.wording import Sentence

UNITS = {"": "SI", "lb_in.lbf.lb.in.degF": "US"}
PHASES = "/?T=40&n=250&t=0.3&FRi=1&FAi=2&Tpk=50&npk=300&Trms=45&pn=a&xR=1"
MOVES = "&mv=s_curve&ms=90&mt=1&mj=0.5&mjk=&mx=1&mv=trapezoidal&ms=-90&mt=1&ma=900&mj=&mjk=&mx=&tp=1"
PAGES = {
    "phases": ("", PHASES),
    "rotary": ("rotary", f"/?mech=rotary&J=0.8{MOVES}"),
    "rack": ("rack_and_pinion", f"/?mech=rack_and_pinion&ml=80&d=60{MOVES}"),
    "belt": ("belt", f"/?mech=belt&ml=80&d=60{MOVES}"),
    "screw": ("ball_screw", f"/?mech=ball_screw&ml=80&h=10{MOVES}"),
}
BESIDE = re.compile(r'name="(\w+)"\s+type="text"[^>]*>\s*<span class="unit">([^<]+)</span>')
WITHIN = re.compile(r'name="(\w+)"\s+type="text"[^>]*aria-label="[^"]* in ([^" ]+)"')


def printed(page: str) -> set[tuple[str, str]]:
    """Names of a page's fields, each with the unit beside it, or in tables within its label."""
    result = [*BESIDE.findall(page), *WITHIN.findall(page)]
    return {(name, unescape(unit).strip()) for name, unit in result if unit.strip()}


def typed(name: str, text: str, marker: str, mechanism: str) -> str:
    """Text of a field in the wire's unit and notation."""
    wire = Notation({"written": marker}).entry(text, units_of(mechanism)[name])
    assert not (isinstance(wire, Entry) and wire.refusal), (name, text, getattr(wire, "refusal", ""))
    return wire


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("units", list(UNITS))
@pytest.mark.parametrize("kind", list(PAGES))
def test_every_unit_that_a_page_prints_beside_a_field_may_be_typed_into_it(
    kind: str, units: str, language: str, client: TestClient
) -> None:
    """A number typed with the unit equals the number alone, which has the unit beside the field."""
    mechanism, address = PAGES[kind]
    cookies = {"Cookie": f"hpn_units={units}; hpn_language={language}"}
    fields = printed(client.get(address, headers=cookies).text)
    marker = Reader(language, tuple(filter(None, units.split(".")))).marker or "en"

    assert len(fields) > 30
    for name, unit in fields:
        alone, measured = (typed(name, text, marker, mechanism) for text in ("7", f"7 {unit}"))
        assert float(measured) == float(alone), (name, unit)


@pytest.mark.parametrize(
    ("mechanism", "name", "text", "value"),
    [
        ("", "fn", "25 Hz", 25),
        ("", "fn", "0.025 kHz", 25),
        ("rotary", "b", "0.01 Nm/rpm", 0.01),
        ("rotary", "b", "0.01 Nm/min⁻¹", 0.01),
        ("rotary", "ma", "900 °/s²", 900),
        ("rotary", "ma", "900 deg/s2", 900),
        ("rotary", "ma", "900 deg/s^2", 900),
        ("rotary", "ma", "10 rad/s²", 572.957795131),  # 1800 / π
        ("rotary", "ms", "0.25 rev", 90),
        ("rotary", "ms", "1 rad", 57.2957795131),  # 180 / π
        ("belt", "mn", "300 mm/s", 300),
        ("belt", "mn", "0.3 m/s", 300),
        ("belt", "mn", "18 m/min", 300),
        ("belt", "ma", "2000 mm/s²", 2000),
        ("belt", "ma", "2 m/s²", 2000),
        ("rotary", "mjk", "20000 °/s³", 20000),
        ("rotary", "mjk", "20000 deg/s^3", 20000),
        ("belt", "mjk", "50 m/s³", 50000),
        ("belt", "Ff", "2.5 daN", 25),
        ("", "hx", "0.5 rad", 28.6478897565),  # 90 / π
        ("", "K3", "26000 Nm/rad", 26000),
        ("", "K3", "7.5 Nm/arcmin", 25783.1007809),  # 7.5 · 10800 / π
        ("", "K3", "7.5 Nm/′", 25783.1007809),
        ("", "FR", "100 kgf", 980.665),
        ("", "m", "16 oz", 0.45359237),
        ("", "bl", "20′", 20),
        ("", "bl", "20'", 20),
        ("", "bl", "30″", 0.5),
        ("", "bl", '30"', 0.5),
        ("", "bl", "0.001 rad", 3.43774677078),  # 10.8 / π
        ("", "Lh", "2 years", 17532),  # 2 · 365.25 · 24
        ("", "Lb", "2 yr", 17532),
        ("", "Lh", "2 Jahre", 17532),
    ],
)
def test_a_unit_as_engineers_write_it_has_its_value(mechanism: str, name: str, text: str, value: float) -> None:
    """A number in another unit has twelve digits after conversion."""
    assert float(typed(name, text, "en", mechanism)) == pytest.approx(value, rel=1e-11)


def test_the_bodies_take_their_units_too() -> None:
    for name, text, value in (
        ("qr", "7.85 g/cm³", 7.85),
        ("qr", "7850 kg/m³", 7.85),
        ("qr", "7850 kg/m^3", 7.85),
    ):
        assert float(typed(name, text, "en", "rotary")) == pytest.approx(value, rel=1e-11), (name, text)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("K3", "26000 Nm", "Nm/rad"),
        ("ma", "900 °/s", "°/s²"),
        ("fn", "25 rpm", "Hz"),
        ("m", "5 kgf", "kg"),
        ("u", "1 rad", "must be a number without a unit"),
    ],
)
def test_a_unit_of_another_quantity_is_refused_with_those_there_are(name: str, text: str, message: str) -> None:
    wire = Notation({"written": "en"}).entry(text, units_of("rotary")[name])
    assert isinstance(wire, Entry)
    assert isinstance(wire.refusal, Sentence)
    assert message in wire.refusal.text


def test_a_form_with_years_is_an_application_with_their_hours_and_the_page_says_how_many(client: TestClient) -> None:
    years = "/?T=40&n=250&t=0.3&Lh=2+years"
    form = parse([*fields_of(years), ("written", "en")])
    assert form.application is not None
    assert form.application.requirements.life_h == 17532

    link = client.get(f"{years}&written=en").headers["location"]
    assert "Lh=17532" in link
    assert "A year (yr) counts as 8766 h" in client.get(link).text


def fields_of(address: str) -> Iterator[tuple[str, str]]:
    """Yield names and texts of an address."""
    for pair in address.partition("?")[2].split("&"):
        name, _, text = pair.partition("=")
        yield name, text.replace("+", " ")
