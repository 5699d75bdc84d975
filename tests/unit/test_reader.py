"""Numbers, units and fields as a reader sees them, and that nothing is lost on the way there and back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hpn.tables.numbers import read_decimal
from hpn.web.door.readers import accepted_language
from hpn.web.form import link_reader
from hpn.web.form.form import Form, for_reader
from hpn.words import units
from hpn.words.reader import GROUP, Reader
from hpn.words.wording import Quantity, Sentence

AMERICAN = Reader("en", units.PRESETS["US"])
GERMAN = Reader("de")
EVERY_UNIT = [(code, unit) for choices in units.CHOICES.values() for code in choices for unit in list(choices)[:1]]
NUMBERS = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12).filter(
    lambda value: value == 0 or abs(value) > 1e-12
)


def form_of(**texts: str) -> Form:
    return link_reader.parse(list(texts.items()))


@pytest.mark.parametrize(
    ("value", "unit", "american"),
    [
        (40.0, "Nm", "354"),
        (1000.0, "N", "225"),
        (25.4, "mm", "1"),
        (1.0, "kg", "2.20"),
        (25.0, "degC", "77"),
        (143000.0, "Nm/rad", f"1{GROUP}265{GROUP}657"),
        (254.0, "mm_per_s", "10"),  # an inch is 25.4 mm
        (9810.0, "mm/s²", "386"),
        (1.0, "Nm_per_rpm", "8.85"),
        (1500.0, "rpm", f"1{GROUP}500"),
        (20000.0, "h", f"20{GROUP}000"),
    ],
)
def test_figures_follow_the_units_of_the_reader(value: float, unit: str, american: str) -> None:
    assert AMERICAN.figure(value, unit) == american


def test_symbols_follow_suffixes_and_symbols_of_the_wire_alike() -> None:
    assert [AMERICAN.unit(unit) for unit in ("Nm", "Nm_per_rad", "Nm/rad", "degC", "°C", "s", "percent")] == [
        *("lb·in", "lb·in/rad", "lb·in/rad", "°F", "°F", "s", "%")
    ]
    assert Reader("en", ("lb_ft", "rad_per_s", "mrad")).unit("Nm_per_rad") == "lb·ft/rad"
    assert [AMERICAN.unit(unit) for unit in ("mm_per_s", "mm/s²", "Nm_per_rpm", "deg_per_s2", "g_per_cm3")] == [
        *("in/s", "in/s²", "lb·in/rpm", "°/s²", "g/cm³")
    ]


def test_numbers_follow_the_language() -> None:
    assert GERMAN.figure(1167275.9) == "1.167.276"
    assert GERMAN.figure(9.3, "Nm") == "9,3"
    assert GERMAN.percent(0.0123) == f"1,2{GROUP}%"
    assert Reader().figure(12345.0) == f"12{GROUP}345"
    sentence = Sentence("Pause {pause}.", {"pause": Quantity(12345.6, "s", 6)})
    assert GERMAN.sentence(sentence) == f"Pause 12.345,6{GROUP}s."


def test_a_number_in_a_sentence_has_the_whole_digits_that_it_has_in_a_table() -> None:
    for value in (6391.2, 2454.6, 1_234_567.8, 818.18, 32.0613):
        assert Reader().number(Quantity(value, "rpm")) == Reader().figure(value, "rpm"), value


def test_a_bound_is_rounded_to_the_safe_side_in_the_unit_that_is_shown() -> None:
    assert AMERICAN.quantity(Quantity(107.0, "Nm", 3, "down")).startswith("947")  # 947.03
    assert AMERICAN.quantity(Quantity(106.99, "Nm", 3, "down")).startswith("946")  # 946.94


@given(NUMBERS, st.sampled_from(EVERY_UNIT))
def test_every_number_can_be_written_in_every_unit_and_comes_back_the_same(value: float, unit: tuple[str, str]) -> None:
    measure = units.measure(unit[1], () if unit[0] == unit[1] else (unit[0],))
    assert measure.wire(measure.shortest(value)) == value


@given(
    st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=5),
    st.sampled_from([AMERICAN, GERMAN, Reader("de", ("lb_ft", "deg_per_s")), Reader("en", ("rad_per_s", "mrad"))]),
)
def test_a_form_sent_back_untouched_says_what_the_link_said(pairs: list[tuple[float, float]], reader: Reader) -> None:
    texts = [(name, repr(value)) for pair in pairs for name, value in zip("Tn", pair, strict=True)]
    shown = for_reader(link_reader.parse([*texts, ("bl", "7"), ("ta", "25")]), reader)
    sent = [(name, row[name]) for row in shown.rows for name in "Tn"]
    sent += [*shown.texts.items(), ("written", shown.written or ""), ("was", shown.was)]
    back = link_reader.parse(sent)
    assert [float(row[name]) for row in back.rows for name in "Tn"] == [value for pair in pairs for value in pair]
    assert [float(back.texts[name]) for name in ("bl", "ta")] == [7, 25]


def test_numbers_that_would_look_alike_are_told_apart() -> None:
    form = link_reader.parse([("T", "40"), ("T", "40.0000001"), ("n", "1"), ("n", "1"), ("t", "1"), ("t", "1")])
    first, second = (row["T"] for row in for_reader(form, AMERICAN).rows)
    assert first != second


def test_a_typed_number_stays_as_typed_and_is_converted_exactly() -> None:
    form = form_of(written="lb_in", T="354.0", n="1", t="1")
    assert form.application is not None
    assert form.application.duty_cycle.load_phases[0].torque_Nm == pytest.approx(354 * 0.1129848290276167, rel=1e-11)
    assert for_reader(form, Reader("en", ("lb_in",))).rows[0]["T"] == "354.0"


@pytest.mark.parametrize(
    ("text", "plain"),
    [("9,3", "9.3"), ("9.3", "9.3"), ("1.234,5", "1234.5"), ("1.234.567", "1234567"), ("-0,5", "-0.5"), ("x", None)],
)
def test_a_german_form_reads_a_decimal_comma(text: str, plain: str | None) -> None:
    assert read_decimal(text, ",") == plain


def test_a_german_form_asks_what_could_be_two_numbers() -> None:
    form = form_of(written="de", T="1.234", n="1", t="1")
    assert [problem.message.text for problem in form.problems] == ["write 1,234 or 1234"]
    assert for_reader(form, GERMAN).rows[0]["T"] == "1.234"


def test_a_link_takes_no_decimal_comma_whatever_its_reader() -> None:
    assert [problem.message.text for problem in form_of(T="9,3", n="1", t="1").problems] == ["write 9.3"]


@pytest.mark.parametrize("marker", ["de.lb_in", "lb_in.lb_ft", "xx", "", "de" * 500, "lb_in\n", ".."])
def test_any_marker_is_read_as_what_is_known_of_it(marker: str) -> None:
    reader = Reader.of_marker(marker)
    assert Reader.of_marker(reader.marker) == reader


@pytest.mark.parametrize(
    ("header", "language"),
    [
        ("de-AT,de;q=0.9,en;q=0.8", "de"),
        ("en-GB,en;q=0.9,de;q=0.8", "en"),
        ("fr,de;q=0.3,en;q=0.9", "en"),
        ("fr", "en"),
        ("de;q=0", "en"),
        ("", "en"),
        ("de;q=nonsense, *", "en"),
        ("\x00,,;q=1", "en"),
    ],
)
def test_language_is_the_best_that_the_browser_asks_for(header: str, language: str) -> None:
    assert accepted_language(header) == language


@pytest.mark.parametrize(
    ("value", "english", "german"),
    [
        (None, "–", "–"),
        (0.0, "0", "0"),
        (12.345, "12.3", "12,3"),
        (345.6, "346", "346"),
        (90_642.0, "90 642", "90.642"),
        (1_167_275.94, "1 167 276", "1.167.276"),  # as the handbook prints it, but for its rounded torque and speed
        (100_000_000.0, "100 000 000", "100.000.000"),
        (100_000_000.6, "> 100 000 000", "> 100.000.000"),
        (3.2e14, "> 100 000 000", "> 100.000.000"),
    ],
)
def test_lives_are_written_in_whole_hours_up_to_a_hundred_million(
    value: float | None, english: str, german: str
) -> None:
    assert (Reader().figure(value, "h"), GERMAN.figure(value, "h")) == tuple(
        text.replace(" ", GROUP) for text in (english, german)
    )


@pytest.mark.parametrize(
    ("value", "beside", "unit", "written"),
    [
        (183_456.1, 20_000.0, "h", "183 456"),
        (19_999.6, 20_000.0, "h", "19 999.6"),
        (20_000.0, 20_000.0, "h", "20 000"),
        (20_000.00000000001, 20_000.0, "h", "20 000"),
        (80.04, 80.0, "Nm", "80.04"),  # 80.0 would read as met
        (80.0, 80.04, "Nm", "80"),
        (80.0412, 80.0435, "Nm", "80.041"),
        (79.96, 80.0, "Nm", "79.96"),
        (39_810.0, 1000.0, "", "39 810"),
        (1000.2, 1000.0, "", "1 000.2"),
    ],
)
def test_a_figure_beside_its_limit_has_the_digits_that_tell_them_apart(
    value: float, beside: float, unit: str, written: str
) -> None:
    assert Reader().figure(value, unit, beside) == written.replace(" ", GROUP)


@given(st.floats(1e-3, 1e7), st.integers(-(10**6), 10**6), st.sampled_from(["Nm", "rpm", "h", "N", ""]))
def test_two_figures_side_by_side_read_in_their_order(value: float, steps: int, unit: str) -> None:
    other = value * (1 + steps * 1e-7)
    one, two = (
        float(Reader().figure(mine, unit, yours).replace(GROUP, "")) for mine, yours in ((value, other), (other, value))
    )
    assert (one < two, one > two) == (value < other, value > other) or math.isclose(value, other, rel_tol=1e-12)
