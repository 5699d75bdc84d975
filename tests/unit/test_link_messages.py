"""Messages on links that somebody writes by hand: each stands at its input and says what would be right."""

from urllib.parse import parse_qsl

import pytest

from hpn.links.writer import to_link
from hpn.web.form import link_reader
from tests.unit.test_links import PHASE, found, read


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("9,3", "write 9.3"),
        ("1.234,5", "write 1234.5"),
        ("1,234.5", "write 1234.5"),
        ("1,234,567", "write 1234567"),
        ("1,234", "write 1.234 or 1234"),
        ("1.234.567", "write 1234567"),
        ("1 234.5", "write 1234.5"),
        ("5,", "write 5"),
        ("1 000", "write 1000"),
        ("+ 1 000,5", "write +1000.5"),
        ("40 1", "is not a number; write one such as 9.3"),
        ("1 0000", "is not a number; write one such as 9.3"),
        ("1e999", "is too large"),
        ("1e-400", "is too small"),
        ("-0.0001e-999", "is too small"),
        ("0.3,3", "is not a number; write one such as 9.3"),
        ("1.5,2", "is not a number; write one such as 9.3"),
        ("4,,5", "is not a number; write one such as 9.3"),
        ("1,2345.6", "is not a number; write one such as 9.3"),
        ("nan", "is not a number; write one such as 9.3"),
        ("0x10", "is not a number; write one such as 9.3"),
        ("٤٢", "is not a number; write one such as 9.3"),
        ("4\0", "is not a number; write one such as 9.3"),
        ("1_000", "is not a number; write one such as 9.3"),
        ("12 Nm 5", "is not a number; write one such as 9.3"),
        ("9" * 50_000, "is too long for a number"),
    ],
)
def test_text_that_is_no_number_is_answered_with_what_to_write(text: str, message: str) -> None:
    form = link_reader.parse([("T", text), ("n", "250"), ("t", "0.3")])
    assert [(p.name, p.index, p.message.text) for p in form.problems] == [("T", 0, message)]
    assert form.rows[0]["T"] == text


@pytest.mark.parametrize("text", ["40", "40.", "+40", " 40 ", "4e1", "040", "40.00"])
def test_number_may_be_written_in_any_plain_way(text: str) -> None:
    form = link_reader.parse([("T", text), ("n", "250"), ("t", "0.3")])
    assert form.application is not None
    assert form.application.duty_cycle.load_phases[0].torque_Nm == 40


@pytest.mark.parametrize("dash", ["–", "\u2011"])
def test_dashes_of_documents_are_a_minus(dash: str) -> None:
    form = link_reader.parse([("T", f"{dash}40"), ("T", f"{dash}40 Nm"), *[("n", "250"), ("t", "0.3")] * 2])
    assert form.application is not None
    assert [phase.torque_Nm for phase in form.application.duty_cycle.load_phases] == [-40, -40]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("Nk", "1.000", "write 1 or 1000"),
        ("Lb", "20.000", "write 20 or 20000"),
        ("Lh", "20.000 h", "write 20 or 20000"),
        ("Lh", "20 000 h", "write 20000 h"),
        ("Lh", "2.500", "write 2.5 or 2500"),
        ("Nk", "2.500", "write 2500"),
        ("u", "90 %", "write 0.9"),
        ("i", "5,0", "write 5.0"),
    ],
)
def test_whole_number_that_may_have_thousands_in_it_is_asked(name: str, text: str, message: str) -> None:
    assert found(f"{PHASE}&{name}={text}&FR=5&Tk=9")[name, 0 if name == "i" else None] == message


@pytest.mark.parametrize("name", ["Nk", "Lh", "Lb", "T", "tp"])
@pytest.mark.parametrize("text", ["1,000", "2,500", "20,000", "1.000", "1,234.0", "20,000 h", "2.500 h"])
def test_a_spelling_advised_in_place_of_a_number_is_taken(name: str, text: str) -> None:
    if text.endswith("h") and not name.startswith("L"):
        text = text.removesuffix(" h")
    link = f"n=250&t=0.3&FR=5&Tk=9&{'' if name == 'T' else 'T=40&'}"
    for message in found(f"{link}{name}={text}").values():
        for advised in message.removeprefix("write ").split(" or "):
            assert found(f"{link}{name}={advised}") == {}


@pytest.mark.parametrize("name", ["T", "t", "n", "N"])
@pytest.mark.parametrize("form", ["%20{}", "{} ", "{}[]"])
def test_name_that_is_only_written_otherwise_is_proposed_itself(name: str, form: str) -> None:
    written = form.format(name)
    meant = "n" if name == "N" else name
    values = [p.message.text for p in read(f"{PHASE}&{written}=1").problems]
    assert any(text.endswith(f"did you mean {meant}?") for text in values)


def test_minus_sign_of_a_word_processor_is_a_minus() -> None:
    application = link_reader.parse([("T", "−40"), ("n", "250"), ("t", "1")]).application
    assert application is not None
    assert application.duty_cycle.load_phases[0].torque_Nm == -40


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ("T=40,32&n=250&t=0.3", "write 40.32; if 40 and 32 are meant, give two phases"),
        ("T=40&n=250,500&t=3", "write 250.500 or 250500; if 250 and 500 are meant, give two phases"),
        ("T=9,3&n=250&t=0.3", "write 9.3"),
        ("T=40,05&n=250&t=0.3", "write 40.05"),
        ("T=40,32&n=250&t=0.3&T=20&n=250&t=1", "write 40.32"),
        ("T=40&n=250&t=0.3&tp=10,25", "write 10.25"),
    ],
)
def test_a_comma_in_the_only_phase_may_stand_between_two_values(link: str, message: str) -> None:
    assert list(found(link).values()) == [message]


@pytest.mark.parametrize(
    ("query", "message"),
    [
        ("pn=a%E2%80%8Bb", "must not contain the invisible character U+200B ZERO WIDTH SPACE"),
        ("pn=a%0Ab", "must not contain control characters or line breaks"),
        (f"pn={'x' * 41}", "must have at most 40 characters"),
        ("T=1&n=2&t=3&pn=a", "missing: the link gives 1 × pn, but 2 × T"),
    ],
)
@pytest.mark.parametrize("row", [PHASE, "mech=rotary&J=1&ms=9&mt=1&mv=triangular"])
def test_a_name_keeps_the_rules_of_titles_and_stands_beside_each_row(row: str, query: str, message: str) -> None:
    if row == PHASE:
        assert found(f"{row}&{query}")["pn", int("T=1" in query)] == message
    elif "T=1" not in query:
        assert found(f"{row}&{query}") == {("pn", 0): message}


def test_a_name_is_written_as_it_is_and_blank_where_a_phase_has_none() -> None:
    link = "T=40&n=250&t=0.3&pn=1.0%20%26%202e%2B05&T=32&n=500&t=3&pn=&tp=4"
    form = read(link)
    assert form.application is not None
    assert [phase.name for phase in form.application.duty_cycle.load_phases] == ["1.0 & 2e+05", None]
    assert to_link(form.application) == f"/?{link}"
    assert read(f"{PHASE}&pn=%20&T=3&n=1&t=1&pn=").application == read(f"{PHASE}&T=3&n=1&t=1").application


def test_unequal_lists_are_reported_where_the_value_is_missing() -> None:
    problems = found("T=40&n=250&t=0.3&T=3&n=2")
    assert problems == {("t", 1): "missing: the link gives 1 × t, but 2 × T"}


def test_repeated_scalar_is_reported_and_kept() -> None:
    form = read(PHASE + "&Tk=200&Tk=300")
    assert form.texts["Tk"] == "200"
    assert found(PHASE + "&Tk=200&Tk=300") == {("Tk", None): "must be a single value; given: 200, 300"}
    assert found(PHASE + "&tp=4&tp=") == {("tp", None): 'must be a single value; given: 4, ""'}
    assert found(PHASE + "&tp=&tp= ") == {("tp", None): 'must be a single value; given: "", ""'}


@pytest.mark.parametrize(
    ("query", "name", "message"),
    [
        ("i=5,7", "i", "give one value per field: i=5&i=7"),
        ("i=4 5;7", "i", "give one value per field: i=4&i=5&i=7"),
        ("i=x", "i", "is not a number; write one such as 9.3"),
        ("Tk=200&Nk=5,7", "Nk", "must be a whole number"),
        ("Tk=200&Nk=1,000", "Nk", "write 1 or 1000"),
    ],
)
def test_a_spelling_advised_in_place_of_several_or_broken_whole_numbers_is_taken(
    query: str, name: str, message: str
) -> None:
    assert found(f"{PHASE}&{query}") == {(name, 0 if name == "i" else None): message}


@pytest.mark.parametrize(
    ("name", "near"), [("ratio", "i"), ("torque_Nm", "T"), ("Tkk", "Tk"), ("rnak", "rank"), ("life_h", "Lh")]
)
def test_unknown_name_is_answered_with_the_nearest(name: str, near: str) -> None:
    assert found(f"{PHASE}&{name}=1")[name, None].endswith(f"did you mean {near}?")


def test_each_error_of_the_model_stands_at_its_field() -> None:
    problems = found("T=1&n=2&t=-1&T=4000000&n=5&t=6&u=2&rank=best&K3=0&Nk=1.5")
    assert problems == {
        ("t", 0): "must be above 0 s",
        ("T", 1): "must be at most 1000000 Nm",
        ("u", None): "must be at most 1",
        ("rank", None): "must be one of weight, utilisation, length, motor_torque, life, stiffness, "
        "natural_frequency, position_error",
        ("K3", None): "must be above 0 Nm/rad",
        ("Nk", None): "must be a whole number",
    }


def test_cycle_without_motion_is_reported_at_the_speed() -> None:
    assert "no phase moves" in found("T=40&n=0&t=1")["n", 0]


def test_count_without_a_torque_asks_for_the_torque() -> None:
    assert found(PHASE + "&Nk=5") == {("Tk", None): "is required, unless a brake is given"}


def test_load_coefficient_without_a_load_asks_for_a_load() -> None:
    assert found(PHASE + "&fw=1.2") == {("FR", None): "give a radial or an axial load, here or in a phase"}


@pytest.mark.parametrize(
    ("query", "name", "example"),
    [("T=40&n=250,500,250&t=1", "n", "n=250&n=500&n=250"), ("T=40,32,-20&n=250&t=1", "T", "T=40&T=32&T=-20")],
)
def test_values_of_several_phases_in_one_field_are_told_to_repeat_the_name(query: str, name: str, example: str) -> None:
    (problem,) = link_reader.parse(parse_qsl(query)).problems

    assert (problem.name, problem.message.text) == (name, f"give one value per field: {example}")


def test_a_ratio_may_be_written_to_one() -> None:
    form = link_reader.parse(parse_qsl("T=40&n=250&t=1&i=5:1"))

    assert form.application is not None
    assert form.application.requirements.ratios == (5,)
