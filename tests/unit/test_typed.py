"""A number typed with a unit of its own, or as a sum; the link carries the plain number."""

from fractions import Fraction

import pytest

from hpn.application import Application
from hpn.links.writer import to_link
from hpn.tables.numbers import Entry, Kind, Notation, read_decimal, read_value
from hpn.web.form import link_reader
from hpn.web.form.form import for_reader
from hpn.web.form.offers import beside_fields
from hpn.words import spellings, units
from hpn.words.reader import Reader
from hpn.words.wording import Sentence


def typed(name: str, text: str, written: str = "") -> Application | str:
    inputs = {"T": "40", "n": "250", "t": "0.3"} | {name: text, "written": written}
    form = link_reader.parse(
        [*inputs.items(), ("Tk", inputs.get("Tk", "50"))] if name != "Tk" else list(inputs.items())
    )
    return form.application or form.problems[0].message.text


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("20.000", "whole", "write 20 or 20000"),
        ("1.230", "whole", "write 1230"),
        ("20.5", "whole", "must be a whole number"),
        ("1" * 60, "whole", int(float("1" * 60))),
        ("1" * 61, "whole", "is too long for a number"),
    ],
)
def test_a_whole_number_with_a_mark_is_asked_about(text: str, kind: Kind, message: str | int) -> None:
    result = read_value(text, kind)
    assert (result.text if isinstance(result, Sentence) else result) == message


@pytest.mark.parametrize(("unit", "message"), [("h", "write 20 h or 20000 h"), ("Nm", "write 20.000 Nm or 20000 Nm")])
def test_only_hours_are_mostly_whole(unit: str, message: str) -> None:
    entry = Notation({"written": "de"}).entry(f"20.000 {unit}", unit)
    assert isinstance(entry, Entry) and entry.refusal is not None
    assert entry.refusal.text == message


@pytest.mark.parametrize(
    ("name", "text", "link"),
    [
        ("T", "40 Nm", "T=40&"),
        ("T", "40Nm", "T=40&"),
        ("T", "0.04 kNm", "T=40&"),
        ("T", "100 lbf·in", "T=11.2984829028&"),
        ("T", "-1e2 N.m", "T=-100&"),
        ("n", "360 °/s", "n=60&"),
        ("n", "250 min-1", "n=250&"),
        ("n", "250 1/min", "n=250&"),
        ("n", "250 /min", "n=250&"),
        ("n", "4 rev/s", "n=240&"),
        ("t", "300 ms", "t=0.3&"),
        ("t", "2 min", "t=120&"),
        ("Lh", "60 min", "&Lh=1"),
        ("ta", "77 °F", "&ta=25"),
        ("ta", "32 °F", "&ta=0"),
        ("K3", "2 kNm/rad", "&K3=2000"),
        ("n", "2.5 krpm", "n=2500&"),
        ("n", "4 turns/s", "n=240&"),
        ("T", "100 kg·cm", "T=9.80665&"),
        ("T", "1000 oz-in", "T=7.06155181423&"),
        ("Lh", "2 d", "&Lh=48"),
        ("Lh", "2 days", "&Lh=48"),
        ("JL", "1.5 kg·cm²", "&JL=0.00015"),
        ("JL", "1.5 kgcm2", "&JL=0.00015"),
        ("JL", "1.5 kg cm^2", "&JL=0.00015"),
        ("JL", "1500 g·cm²", "&JL=0.00015"),
        ("JL", "0.15 kgm²", "&JL=0.15"),
        ("JL", "1 lb·in²", "&JL=0.000292639653429"),
        ("JL", "1 lb-in2", "&JL=0.000292639653429"),
        ("JL", "1 oz·in·s²", "&JL=0.00706155181423"),
        ("JL", "1 oz-in-sec²", "&JL=0.00706155181423"),
        ("T", "=40*2", "T=80&"),
        ("T", "=0.1+0.2", "T=0.3&"),
        ("T", "=-(12 - 3.5) / 2", "T=-4.25&"),
        ("T", "=8÷4·3×2", "T=12&"),
        ("Nk", "=10*100", "&Nk=1000"),
    ],
)
def test_link_of_a_typed_unit_or_sum_carries_the_plain_number(name: str, text: str, link: str) -> None:
    application = typed(name, text)
    assert isinstance(application, Application), application
    assert link in to_link(application) + ("&" if link.endswith("&") else "")


@pytest.mark.parametrize(
    ("text", "torque"), [("40,5 Nm", 40.5), ("=40,5*2", 9.15177115124), ("100", 11.2984829028), ("0,1 kNm", 100.0)]
)
def test_unit_of_its_own_counts_before_the_readers_and_a_sum_is_in_the_readers(text: str, torque: float) -> None:
    application = typed("T", text, "de.lb_in")
    assert isinstance(application, Application)
    assert application.duty_cycle.load_phases[0].torque_Nm == torque


def test_a_temperature_of_32_degrees_fahrenheit_is_0_degrees_celsius() -> None:
    assert Notation({"written": "en.degF"}).entry("32", "degC") == "0"


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("T", "5 N", "N is not a unit of this quantity; possible: Nm, lb·in"),
        ("T", "5 MNm", "MNm is not a unit"),
        ("n", "5 1/s", "1/s can be rev/s or rad/s"),
        ("n", "50 Hz", "Hz can be rev/s or an electrical frequency"),
        ("JL", "5 kg·cm", "kg·cm is not a unit of this quantity; possible: kg·m², kg·cm², kg·mm², g·cm², lb·in²"),
        ("T", "5 kg·cm²", "kg·cm² is not a unit of this quantity; possible: Nm, lb·in"),
        ("Lh", "2 weeks", "weeks is not a unit of this quantity; possible: s, ms, µs, min, h, d"),
        ("fw", "1 Nm", "must be a number without a unit"),
        ("K3", "5 Nm", "Nm is not a unit of this quantity; possible: Nm/rad"),
        ("T", "=40,5*2", "write 40.5"),
        ("T", "=40,500*2", "write 40.500 or 40500"),
        ("T", "=1e-400", "is too small"),
        ("T", "1e-400 kNm", "is too small"),
        ("T", "1,5 Nm", "write 1.5 Nm"),
        ("T", "1,234 Nm", "write 1.234 Nm or 1234 Nm"),
        ("T", "=", "can’t be calculated"),
        ("T", "=2**3", "can’t be calculated"),
        ("T", "=(2", "can’t be calculated"),
        ("T", "=2 3", "can’t be calculated"),
        ("T", "=__import__('os')", "can’t be calculated"),
        ("T", "=" + "(" * 59, "can’t be calculated"),
        ("T", "=" + "9" * 5000, "can’t be calculated"),
        ("T", "=9e999*9e999*9e999*9e999*9e999", "is too large"),
        ("T", "=1/(2-2)", "divides by zero"),
        ("Nk", "=1/3", "must be a whole number"),
    ],
)
def test_a_fault_of_a_unit_or_a_sum_is_said(name: str, text: str, problem: str) -> None:
    assert problem in str(typed(name, text))


def test_ambiguous_number_with_a_unit_is_asked_about() -> None:
    assert typed("T", "1.234 Nm", "de") == "write 1,234 Nm or 1234 Nm"
    assert typed("T", "=1.234*2", "de") == "write 1,234 or 1234"


PRINTED = [
    ("en", "20 000", 20000),
    ("en", "20\u00a0000", 20000),
    ("en", "20\u2007000", 20000),
    ("en", "20\u2009000", 20000),
    ("en", "20\u202f000", 20000),
    ("en", "20'000", 20000),
    ("en", "20’000", 20000),
    ("en", "1\u202f167\u202f276", 1167276),
    ("en", "1,167,276.5", 1167276.5),
    ("en", "−1\u202f486.786", -1486.786),
    ("en", "1.5·10⁻³", 0.0015),
    ("en", "1.5·10⁴ Nm", 15000),
    ("en", "20 000 Nm", 20000),
    ("de", "−486,786", -486.786),
    ("de", "1.167.276", 1167276),
    ("de", "1.167.276,5", 1167276.5),
    ("de", "20 000", 20000),
    ("de", "20’000,5", 20000.5),
    ("de", "1,5·10⁻³", 0.0015),
]


@pytest.mark.parametrize(("written", "text", "torque"), PRINTED)
def test_number_as_pages_print_it_may_be_typed(written: str, text: str, torque: float) -> None:
    assert float(Notation({"written": written}).entry(text, "Nm")) == torque


@pytest.mark.parametrize("text", [text for _, text, _ in PRINTED])
def test_link_takes_no_number_as_pages_print_it(text: str) -> None:
    assert isinstance(typed("T", text), str)


@pytest.mark.parametrize("value", [0.0015, 0.00001234, 9.3, 40.0, 486.786, 1167275.9, 90642.0, -20500.0, 2e10])
@pytest.mark.parametrize("language", ["en", "de"])
def test_every_figure_that_a_page_prints_is_read_as_that_figure_or_asked_about(value: float, language: str) -> None:
    reader = Reader(language)
    for printed in (reader.figure(value), reader.exact(value)):
        read = read_decimal(printed, reader.decimal)
        if read is None:
            assert language == "de" and printed.count(".") == 1
            assert str(typed("Lh", printed, language)).startswith("write ")
        else:
            assert float(read) == pytest.approx(value, rel=5e-3)


@pytest.mark.parametrize(
    ("written", "name", "text", "offers"),
    [
        ("de", "Lh", "20.000", ("20", "20000")),
        ("de", "T", "20.000", ("20,000", "20000")),
        ("de", "T", "20.000 Nm", ("20,000 Nm", "20000 Nm")),
        ("de", "T", "1,234.5", ("1234,5",)),
        ("de", "Nk", "2.500", ("2500",)),
        ("en", "Lh", "20,000", ("20", "20000")),
        ("en", "T", "20,000", ("20.000", "20000")),
        ("en", "T", "9,3", ("9.3",)),
        ("en", "fw", "120 %", ("1.2",)),
        ("en", "T", "=20,000*2", ()),
        ("de", "T", "=20.000*2", ()),
        ("en", "T", "x", ()),
    ],
)
def test_each_reading_of_a_number_is_offered_and_taken_with_one_press(
    written: str, name: str, text: str, offers: tuple[str, ...]
) -> None:
    values = [(key, text if key == name else value) for key, value in {"T": "40", "n": "250", "t": "0.3"}.items()]
    values += [("written", written), ("FR", "5"), ("Tk", "9"), *([] if name == "T" else [(name, text)])]
    (problem,) = link_reader.parse(values).problems
    assert problem.message.offers == offers
    for offer in offers:
        form = link_reader.parse([*values, ("do", f"take:{problem.place}:{offer}")])
        assert form.focus == problem.place
        if not offer.endswith(",000"):  # three decimals are asked about again
            assert form.application is not None, form.problems


def test_offer_is_taken_in_the_row_that_it_stands_in() -> None:
    rows = [("T", "40"), ("n", "250"), ("t", "1"), ("T", "20,000"), ("n", "250"), ("t", "1"), ("written", "en")]
    form = link_reader.parse([*rows, ("do", "take:T-1:20000")])
    assert [row["T"] for row in form.rows] == ["40", "20000"]
    assert form.application is not None


@pytest.mark.parametrize("press", ["take:", "take:T-9:1", "take:f-x:1", "take:T-99999999:1", "take:T--1:1", "take:f-T"])
def test_press_that_offers_nothing_changes_nothing(press: str) -> None:
    pairs = [("T", "40"), ("n", "250"), ("t", "1"), ("written", "en")]
    assert link_reader.parse([*pairs, ("do", press)]).application == link_reader.parse(pairs).application


def test_message_on_a_link_shows_both_notations_beside_german_fields() -> None:
    form = link_reader.parse([("T", "0,3"), ("n", "250"), ("t", "1")])
    (problem,) = beside_fields(form.problems, form.written, Reader("de"))
    assert problem.message.text == "in a link write 0.3, in this field 0,3"
    assert problem.message.offers == ("0,3",)
    assert beside_fields(form.problems, form.written, Reader()) == form.problems


def test_every_unit_is_read_by_its_own_symbol() -> None:
    for quantity, codes in units.READ.items():
        for code, symbol in codes.items():
            assert spellings.codes_for(symbol, quantity) == (code,), symbol


POUND, INCH = Fraction("0.45359237"), Fraction("0.0254")
"""In kg and m, by the agreement of 1959."""

STANDARD_GRAVITY = Fraction("9.80665")
"""In m/s², ISO 80000-4 and the third CGPM: a kilogram-force, or kilopond, is so many newtons."""


@pytest.mark.parametrize(
    ("written", "code", "wire", "in_wire"),
    [
        ("kgf·m kgf.m kgfm kp·m kpm", "kgf_m", "Nm", STANDARD_GRAVITY),
        ("kgf·cm kgf-cm kgfcm kp·cm", "kgf_cm", "Nm", STANDARD_GRAVITY / 100),
        ("daNm daN·m", "daNm", "Nm", Fraction(10)),
        ("cNm cN·m", "Ncm", "Nm", Fraction(1, 100)),
        ("kN·mm kNmm N・m N‧m N･m N–m", "Nm", "Nm", Fraction(1)),
        ("in.-lb. in.lb. lb.-in. in-lb", "lb_in", "Nm", Fraction("0.45359237") * STANDARD_GRAVITY * Fraction("0.0254")),
        ("ft.-lb. ft.-lbs.", "lb_ft", "Nm", Fraction("0.45359237") * STANDARD_GRAVITY * Fraction("0.3048")),
        ("°/sec", "deg_per_s", "rpm", Fraction(60, 360)),
        ("°/min deg/min Grad/min", "deg_per_min", "rpm", Fraction(1, 360)),
        ("r.p.m. R.P.M. revs/min rev./min ot./min Umdr./min", "rpm", "rpm", Fraction(1)),
        ("tr.min-1 tr·min⁻¹ U·min-1 min–1 min−1 min^–1", "rpm", "rpm", Fraction(1)),
        ("revs/sec", "rev_per_s", "rpm", Fraction(60)),
        ("U·s-1 rev·s⁻¹ r·s-1 turns/s turn/s", "rev_per_s", "rpm", Fraction(60)),
        ("krpm kRPM kU/min", "krpm", "rpm", Fraction(1000)),
        ("turn/min turns/min", "rpm", "rpm", Fraction(1)),
        ("d day days Tage", "day", "h", Fraction(24)),
        ("kg·cm kg-cm kgcm kg.cm", "kgf_cm", "Nm", STANDARD_GRAVITY / 100),
        ("kg·m² kgm2 kgm² kg.m^2 kg*m**2 kg-m2", "kgm2", "kgm2", Fraction(1)),
        ("kg·cm² kgcm2 kgcm² kg.cm2 kg·cm^2 KG·CM²", "kg_cm2", "kgm2", Fraction(1, 10**4)),
        ("g·cm² gcm2 gcm² g-cm^2", "g_cm2", "kgm2", Fraction(1, 10**7)),
        ("kg·mm² kgmm2", "kg_mm2", "kgm2", Fraction(1, 10**6)),
        ("lb·in² lb-in² lbin2 lb.in^2 lbm·in²", "lb_in2", "kgm2", POUND * INCH**2),
        ("lb·ft² lb-ft2", "lb_ft2", "kgm2", POUND * (12 * INCH) ** 2),
        ("oz·in² oz-in2", "oz_in2", "kgm2", POUND / 16 * INCH**2),
        ("oz·in·s² oz-in-s² oz-in-sec² oz.in.s^2", "oz_in_s2", "kgm2", POUND / 16 * STANDARD_GRAVITY * INCH),
        ("lb·in·s² lb-in-sec² lbf·in·s²", "lb_in_s2", "kgm2", POUND * STANDARD_GRAVITY * INCH),
    ],
)
def test_unit_in_another_spelling_is_the_same_to_the_last_digit(
    written: str, code: str, wire: str, in_wire: Fraction
) -> None:
    assert {each: spellings.codes_for(each) for each in written.split()} == dict.fromkeys(written.split(), (code,))
    assert 1 / units.entered(wire, code).factor == in_wire


@pytest.mark.parametrize(("text", "link"), [("4 kgf·m", "T=39.2266&"), ("4 kp m", "T=39.2266&"), ("5 daNm", "T=50&")])
def test_kilogram_force_in_a_field_is_converted(text: str, link: str) -> None:
    application = typed("T", text)
    assert isinstance(application, Application), application
    assert link in to_link(application)


@pytest.mark.parametrize("spelling", ["mN", "MN", "MNm", "nN", "", "-1", "Pa", "x" * 300])
def test_an_unknown_unit_is_none(spelling: str) -> None:
    assert spellings.codes_for(spelling) == ()


def test_sum_stands_in_its_field_as_it_was_typed() -> None:
    form = link_reader.parse([("T", "=40*2"), ("n", "250"), ("t", "300 ms")])
    view = for_reader(form, Reader())
    assert dict(view.rows[0]) == {"T": "=40*2", "n": "250", "t": "300 ms"}
