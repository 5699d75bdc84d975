"""The shaft's centre x_c by size: as one number for all sizes, or as an object, in REST, links, form and files."""

from typing import Any
from urllib.parse import parse_qsl

import pytest
from pydantic import ValidationError

from hpn.account.inputs import LOADS, lines_of
from hpn.application import Application, InputError, OutputLoad
from hpn.application.faults import faults_of
from hpn.application.input_fields import FIELDS
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.links.writer import to_link
from hpn.web.form.form import Form, for_reader
from hpn.web.form.link_reader import parse
from hpn.words.reader import Reader
from tests.build import Json, answer, candidate, check, notices, worked_example
from tests.conftest import Supplement
from tests.unit.test_calculation import steps_of

LINK = "T=40&n=250&t=0.3&FR=400&xR=45"
SIZES = "11A, 14A, 20A, 32A, 40A"


def off_centre(centre: Any, radial_N: float = 400.0) -> Json:
    """The worked example with a radial load 45 mm from the shoulder."""
    return worked_example(output_load={"radial_N": radial_N, "radial_position_mm": 45.0, "shaft_centre_mm": centre})


def read(query: str, marker: str = "") -> Form:
    """Form of a link, or of what a reader has filled in."""
    return parse([*parse_qsl(query, keep_blank_values=True), *([("written", marker)] if marker else [])])


# --- Application ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("inputs", "taken"),
    [
        (21, 21.0),
        ({"20A": 21, "others": 18}, {"20A": 21.0, "others": 18.0}),
        ({"Others": 18, "32": 30, "hpn-20a": 21}, {"20A": 21.0, "32A": 30.0, "others": 18.0}),
        ({"20A": 21, "32A": None}, {"20A": 21.0}),
        ({"others": 18}, 18.0),
        ({"20A": None}, None),
        ({}, None),
        (None, None),
    ],
)
def test_a_centre_is_a_number_or_an_object_by_size(inputs: Any, taken: Any) -> None:
    """An object without a size says no more than a number, or nothing; sizes stand in one order."""
    load = OutputLoad(radial_N=1, shaft_centre_mm=inputs)
    assert load.shaft_centre_mm == taken
    assert not isinstance(taken, dict) or list(load.shaft_centre_mm) == list(taken)  # type: ignore[arg-type]
    assert OutputLoad.model_validate_json(load.model_dump_json()) == load


@pytest.mark.parametrize(
    ("inputs", "place", "code"),
    [
        (0, (), "greater_than"),
        (True, (), "shaft_centre"),
        ("21", (), "shaft_centre"),
        ([21], (), "shaft_centre"),
        ({"20A": 0}, ("20A",), "greater_than"),
        ({"20A": 1e13}, ("20A",), "less_than_equal"),
        ({"20A": "21"}, ("20A",), "float_type"),
        ({"20A": True}, ("20A",), "float_type"),
        ({"20A": 21, "20": 22}, ("20",), "size_twice"),
        ({str(k): 1 for k in range(101)}, (), "too_long"),
    ],
)
def test_a_wrong_centre_is_refused_where_it_stands(inputs: Any, place: tuple[str, ...], code: str) -> None:
    with pytest.raises(ValidationError) as refused:
        OutputLoad(radial_N=1, shaft_centre_mm=inputs)
    [fault] = faults_of(refused.value)
    assert (fault.location, fault.code) == (("shaft_centre_mm", *place), code)


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ("20B", f"the catalogue has no 20B (available: {SIZES}, others)"),
        ("other", f"the catalogue has no other; it looks like others (available: {SIZES}, others)"),
        ("99A", f"the catalogue has no 99A (available: {SIZES}, others)"),
        ("?", f"the catalogue has no ? (available: {SIZES}, others)"),
    ],
)
def test_an_unknown_size_is_an_input_error_that_names_those_there_are(
    size: str, message: str, catalogue: Catalogue
) -> None:
    with pytest.raises(InputError) as refused:
        select(Application.model_validate(off_centre({size: 21})), catalogue)
    assert refused.value.problems == ((("output_load", "shaft_centre_mm", size), message),)


def test_the_field_keeps_the_bounds_of_its_number() -> None:
    field = FIELDS["output_load.shaft_centre_mm"]
    assert (field.kind, field.by_size, field.least, field.most) == ("number", True, 1e-12, 1e12)
    assert not any(other.by_size for path, other in FIELDS.items() if path != "output_load.shaft_centre_mm")


# --- Figures ----------------------------------------------------------------------------------------------------------


def test_each_size_counts_with_its_own_centre(catalogue: Catalogue) -> None:
    """By hand: 400 N at 45 mm over 1800 N of HPN-20A and 3500 N of HPN-32A (table 12.1)."""
    reply = answer(off_centre({"20A": 21, "others": 30}), catalogue)
    limit = catalogue.by_designation["HPN-32A-5"].dynamic_radial_load_N
    assert limit
    used = [check(reply, name, "output_bearing_load")["utilisation"] for name in ("HPN-20A-5", "HPN-32A-5")]
    assert used == pytest.approx([400 * 45 / 21 / 1800, 400 * 45 / 30 / limit], rel=1e-12)


def test_a_size_that_nobody_gives_lacks_its_centre_alone(catalogue: Catalogue) -> None:
    reply = answer(off_centre({"20A": 21}), catalogue)

    assert candidate(reply, "HPN-20A-5")["missing"] == []
    assert candidate(reply, "HPN-32A-5")["missing"] == ["output_load.shaft_centre_mm"]
    assert "HPN-20A" not in notices(reply)["bearing_centre_unknown"]
    assert "HPN-32A" in notices(reply)["bearing_centre_unknown"]


@pytest.mark.parametrize(
    ("centre", "by_supplement", "note"),
    [
        ({"20A": 21, "others": 18}, "", "x_c is the distance that you gave for HPN-20A."),
        ({"32A": 30, "others": 21}, "", "x_c is the distance that you gave for all sizes without one of their own."),
        (21, "", "x_c is the distance that you gave for all sizes without one of their own."),
        (
            {"20A": 18},
            "21",
            "x_c is the figure of HPN-20A in your catalogue supplement, which goes before a typed one.",
        ),
    ],
)
def test_the_calculation_says_which_centre_counts(
    centre: Any, by_supplement: str, note: str, supplemented: Supplement
) -> None:
    columns = (
        "size,maximum_input_speed_rpm,average_input_speed_rpm,ambient_temperature_minimum_degC,"
        "ambient_temperature_maximum_degC,dynamic_radial_load_N,dynamic_axial_load_N,shaft_centre_mm,note,source\n"
    )
    catalogue = supplemented(sizes=columns + f"20A,,,,,,,{by_supplement},,drawing\n")
    step = steps_of(off_centre(centre), "HPN-20A-5", catalogue)["output_bearing_load"]

    assert note in [message.text for message in step.notes]
    assert step.comparisons[0].value == pytest.approx(400 * 45 / 21 / 1800, rel=1e-12)


# --- Links and form ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("query", "centre", "link"),
    [
        ("xc=21", 21.0, "xc=21"),
        ("xc=20A:21", {"20A": 21.0}, "xc=20A:21"),
        ("xc=20A%3A21&xc=18", {"20A": 21.0, "others": 18.0}, "xc=20A:21&xc=18"),
        ("xc=18&xc=32:30&xc=20a:21", {"20A": 21.0, "32A": 30.0, "others": 18.0}, "xc=20A:21&xc=32A:30&xc=18"),
        ("xc=20A: 21; 32A: 30.5; others: 18", {"20A": 21, "32A": 30.5, "others": 18}, "xc=20A:21&xc=32A:30.5&xc=18"),
        ("xc=others:18", 18.0, "xc=18"),
        ("xc=", None, ""),
    ],
)
def test_links_give_one_centre_or_one_for_each_size(query: str, centre: Any, link: str) -> None:
    application = read(f"{LINK}&{query}").application
    assert application and application.output_load
    assert application.output_load.shaft_centre_mm == centre
    assert to_link(application) == f"/?{LINK}&{link}".rstrip("&")
    assert read(to_link(application)[2:]).application == application


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("xc=20A:21&xc=20:22", "20A is given twice: give each size once"),
        ("xc=18&xc=others:19", "others is given twice: give each size once"),
        ("xc=21&xc=22", "must be a single value; given: 21, 22"),
        ("xc=20A:", "20A: is not a number; write one such as 9.3"),
        ("xc=:21", "is not a number; write one such as 9.3"),
        ("xc=20A:0", "20A: must be above 0 mm"),
        ("xc=20A:1,234", "20A: write 1.234 or 1234"),
        ("xc=" + ";".join(f"{k}:1" for k in range(200)), "must have at most 100 values"),
    ],
)
def test_a_wrong_centre_of_a_link_is_told_beside_its_field(query: str, said: str) -> None:
    form = read(f"{LINK}&{query}")
    assert form.application is None
    assert [(problem.name, problem.index, problem.message.text) for problem in form.problems] == [("xc", None, said)]
    assert all(not problem.message.offers for problem in form.problems)  # none would take the place of the whole text


@pytest.mark.parametrize(
    ("marker", "typed", "centre", "text"),
    [
        ("de", "20A: 21,5; übrige: 18", {"20A": 21.5, "others": 18.0}, "20A: 21,5; übrige: 18"),
        ("de", "others: 18;20A:21,5", {"20A": 21.5, "others": 18.0}, "übrige: 18; 20A: 21,5"),
        ("in", "20A: 1; 18 mm", {"20A": 25.4, "others": 18.0}, "20A: 1; others: 18 mm"),
        ("in", "2", 50.8, "2"),
        ("in", "20A: x", None, "20A: x"),
    ],
)
def test_the_field_takes_and_shows_the_words_and_units_of_its_reader(
    marker: str, typed: str, centre: Any, text: str
) -> None:
    form = read(f"T=40&n=250&t=0.3&FR=400&xR=45&xc={typed}", marker)
    load = form.application.output_load if form.application else None
    assert (load.shaft_centre_mm if load else None) == (None if centre is None else pytest.approx(centre, rel=1e-12))
    assert for_reader(form, Reader.of_marker(marker)).texts["xc"] == text


def test_a_centre_of_a_link_is_shown_in_the_units_of_the_reader_and_taken_back_to_the_last_digit() -> None:
    view = for_reader(read(f"{LINK}&xc=20A:21&xc=18"), Reader.of_marker("in"))
    assert view.texts["xc"] == "20A: 0.82677; others: 0.70866"
    sent = parse(
        [
            *parse_qsl("T=40&n=250&t=0.3&FR=400&xR=45"),
            ("xc", view.texts["xc"]),
            ("written", "in"),
            ("was", view.was),
        ]
    )
    assert sent.application and sent.application.output_load
    assert sent.application.output_load.shaft_centre_mm == {"20A": 21.0, "others": 18.0}


# --- Files ------------------------------------------------------------------------------------------------------------


def test_the_report_lists_each_size_with_its_unit() -> None:
    application = Application.model_validate(off_centre({"20A": 21, "others": 18}))
    for marker, text in (("", "20A: 21\u202fmm; others: 18\u202fmm"), ("de", "20A: 21\u202fmm; übrige: 18\u202fmm")):
        reader = Reader.of_marker(marker)
        lines = {line.named.symbol: line.text(reader) for line in lines_of(application, LOADS)}
        assert lines["x_c"] == text
