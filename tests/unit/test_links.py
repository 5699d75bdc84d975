"""Links in both directions: what they mean, that nothing is lost, and that nothing breaks the reader."""

import re
from typing import Any
from urllib.parse import parse_qsl

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from hpn.application import Application
from hpn.links import symbols
from hpn.links.row_symbols import PHASE_SYMBOLS, STROKE_SYMBOLS, TURN_SYMBOLS
from hpn.links.symbol import MOTION_PATH
from hpn.links.writer import to_link
from hpn.web.form import link_reader
from hpn.web.form.form import Form
from tests.property.draw import NAMES

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
PHASE = "T=40&n=250&t=0.3"
UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")
"""Characters that a copied link may have got and nobody sees; a link is read without them."""


def some(**fields: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    """Any of these fields, in any combination."""
    return st.fixed_dictionaries({}, optional=fields)


amounts = st.floats(1e-6, 1e6)
signed = st.floats(-1e6, 1e6)
shares = st.floats(0, 1)
names = st.sampled_from(NAMES) | st.text(st.characters(categories=["L", "N", "P", "S"]), min_size=1, max_size=40)


def varying(phase: dict[str, Any], torque: float | None, speed: float | None, rms: float | None) -> dict[str, Any]:
    """A phase with peaks as many times larger than its own magnitudes, and an RMS of a share of the peak."""
    peak = abs(phase["torque_Nm"]) if torque is None else min(abs(phase["torque_Nm"]) * (1 + torque), 1e6)
    figures = {
        "peak_torque_Nm": None if torque is None else peak,
        "peak_speed_rpm": None if speed is None else min(phase["speed_rpm"] * (1 + speed), 1e6),
        "rms_torque_Nm": None if rms is None else rms * peak,
    }
    return phase | {name: value for name, value in figures.items() if value is not None}


phases = st.tuples(
    st.builds(
        varying,
        st.fixed_dictionaries({"torque_Nm": signed, "speed_rpm": amounts, "duration_s": amounts}),
        *(st.none() | shares for _ in range(3)),
    ),
    some(radial_N=signed, axial_N=signed, name=names),
).map(lambda parts: parts[0] | parts[1])
requirements = some(
    ratios=st.lists(st.integers(1, 10_000), min_size=1, max_size=4),
    sizes=st.lists(st.sampled_from(["11A", "14A", "40A", "A&B =ß"]), min_size=1, max_size=3),
    life_h=amounts,
    backlash_arcmin=amounts,
    torsional_stiffness_Nm_per_rad=st.floats(1e-12, 1e12),
    weight_kg=amounts,
    length_mm=amounts,
    ambient_temperature_degC=st.floats(-273, 1000),
    utilisation=st.floats(1e-12, 1),
    efficiency=st.floats(1e-12, 1),
    motor=some(
        peak_torque_Nm=amounts,
        rated_torque_Nm=amounts,
        maximum_speed_rpm=amounts,
        rated_speed_rpm=amounts,
        inertia_kgm2=amounts,
    ).filter(bool)
    | st.fixed_dictionaries({"designation": st.sampled_from(["M 40", "A&B =ß+%", "x" * 100])}),
)
conditions = some(
    load_coefficient=st.floats(1, 3),
    life_h=amounts,
    life_basis=st.sampled_from(["L50", "L10"]),
    model=st.sampled_from(["linear", "iso281", "digitised"]),
)
applications = st.fixed_dictionaries(
    {
        "duty_cycle": st.fixed_dictionaries(
            {"phases": st.lists(phases, min_size=1, max_size=5)}, optional={"pause_s": amounts}
        )
    },
    optional={
        "emergency_stop": st.fixed_dictionaries({"torque_Nm": signed}, optional={"count": st.integers(0, 10**15)}),
        "output_load": st.tuples(some(radial_N=signed, axial_N=signed), conditions).map(lambda p: p[0] | p[1]),
        "requirements": requirements,
        "application_area": st.sampled_from(["vacuum", "medical"]),
        "rank_by": st.sampled_from(["weight", "utilisation", "life"]),
    },
)


def loaded(document: dict[str, Any]) -> bool:
    """True for an output load with a load, or none at all."""
    carriers = [document.get("output_load", {}), *document["duty_cycle"]["phases"]]
    return "output_load" not in document or any("radial_N" in c or "axial_N" in c for c in carriers)


def read(query: str) -> Form:
    return link_reader.parse(parse_qsl(query, keep_blank_values=True))


def found(query: str) -> dict[tuple[str, int | None], str]:
    """Message by place."""
    return {(problem.name, problem.index): problem.message.text for problem in read(query).problems}


def test_worked_example_has_the_link_of_the_contract() -> None:
    assert to_link(Application.worked_example()) == EXAMPLE
    assert read(EXAMPLE[2:]).application == Application.worked_example()


@given(applications.filter(loaded))
def test_every_application_survives_its_link(document: dict[str, Any]) -> None:
    application = Application.model_validate(document)
    again = read(to_link(application).removeprefix("/?"))
    assert again.problems == ()
    assert again.application == application


@given(
    st.lists(
        st.tuples(
            st.sampled_from(
                [*"TntLmuiJbdh", "mech", "mv", "ms", "Tpk", "md", "tp", "Nk", "size", "gear", "do", "FRi", "rank", "x"]
            ),
            st.text(),
        )
    )
)
def test_no_query_breaks_the_reader_and_all_of_it_comes_back(pairs: list[tuple[str, str]]) -> None:
    form = link_reader.parse(pairs)
    assert form.application is None or not form.problems
    assert all(problem.message.text for problem in form.problems)
    given_rows = [UNSEEN.sub("", text) for name, text in pairs if name == "T"]
    if "loads" not in form.groups and not any(name == "do" for name, _ in pairs):
        assert [row["T"] for row in form.rows][: len(given_rows)] == given_rows


def test_blank_fields_of_the_plain_form_count_as_absent() -> None:
    form = read(PHASE + "&tp=&Tk=&Nk=&Lh=&rank=&gear=&u=&T=&n=&t=")
    assert form.problems == ()
    assert form.application == read(PHASE).application
    assert len(form.rows) == 2


def test_errors_name_the_row_that_is_seen_though_a_blank_row_stands_above() -> None:
    assert found("T=&n=&t=&T=40&n=250&t=-1") == {("t", 1): "must be above 0 s"}


def test_untouched_form_is_neither_answer_nor_error() -> None:
    assert read("T=&n=&t=&rank=&Tk=").empty
    assert found("tp=4") == {("T", 0): "is missing"}


def test_loads_of_phases_may_be_blank_but_not_left_out() -> None:
    form = read("T=1&n=2&t=3&FRi=500&T=1&n=2&t=3&FRi=")
    assert form.application is not None
    assert [phase.radial_N for phase in form.application.duty_cycle.load_phases] == [500, None]
    assert ("FRi", 1) in found("T=1&n=2&t=3&FRi=500&T=1&n=2&t=3")


@pytest.mark.parametrize(
    ("do", "torques", "focus"),
    [
        ("add", ["1", "2", "3", ""], "T-3"),
        ("remove:2", ["1", "3"], "T-1"),
        ("remove:3", ["1", "2"], "T-1"),
        ("up:3", ["1", "3", "2"], "T-1"),
        ("up:1", ["1", "2", "3"], "T-0"),
        ("down:2", ["1", "3", "2"], "T-2"),
        ("down:1", ["2", "1", "3"], "T-1"),
        ("remove:9", ["1", "2", "3"], None),
        ("remove:x", ["1", "2", "3"], None),
        ("dance", ["1", "2", "3"], None),
    ],
)
def test_buttons_edit_rows_without_script(do: str, torques: list[str], focus: str | None) -> None:
    form = read(f"T=1&n=1&t=1&T=2&n=1&t=1&T=3&n=1&t=1&do={do}")
    assert [row["T"] for row in form.rows] == torques
    assert form.focus == focus


def test_buttons_are_played_one_after_the_other() -> None:
    rows = "T=1&n=1&t=1&T=2&n=1&t=1&T=3&n=1&t=1"
    form = read(f"{rows}&do=up:3&do=take:T-0:7&do=remove:2&do=loads&do=add")
    assert [(row["T"], row["FRi"]) for row in form.rows] == [("7", ""), ("2", ""), ("", "")]
    assert form.focus == "T-2"


def test_a_number_that_a_german_form_offers_is_read_as_its_fields_are() -> None:
    pressed = read("T=1,234&n=1&t=1&written=de.lb_in&do=take:T-0:1.234,5")
    typed = read("T=1.234,5&n=1&t=1&written=de.lb_in")
    assert pressed.application == typed.application
    assert pressed.application is not None


def test_phases_kept_aside_come_back_although_blank_ones_stand_beside_the_motion() -> None:
    motion = "mech=rotary&J=1&mv=trapezoidal&ms=90&mt=1"
    form = read(f"{motion}&T=&n=&t=&aside=T%3D5%26n%3D6%26t%3D7&do=way:phases")
    assert [dict(row) for row in form.rows] == [{"T": "5", "n": "6", "t": "7"}]
    assert form.asides == (motion,)


def test_no_number_is_offered_in_place_of_numbers_by_size() -> None:
    load = "T=1&n=1&t=1&FR=100&xR=2"
    assert [problem.message.offers for problem in read(f"{load}&xc=1,234&written=en").problems] == [("1.234", "1234")]
    assert [problem.message.offers for problem in read(f"{load}&xc=1,234; 20A: 21&written=en").problems] == [()]


def test_last_row_removed_leaves_a_blank_one() -> None:
    assert [dict(row) for row in read("T=1&n=1&t=1&do=remove:1").rows] == [{"T": "", "n": "", "t": ""}]


def test_every_field_of_the_application_has_a_symbol() -> None:
    def leaves(model: type[BaseModel], path: tuple[str, ...] = ()) -> set[tuple[str, ...]]:
        found: set[tuple[str, ...]] = set()
        for name, info in model.model_fields.items():
            parts = models(info.annotation)
            found |= {leaf for part in parts for leaf in leaves(part, (*path, name))} if parts else {(*path, name)}
        return found

    def models(annotation: Any) -> list[type[BaseModel]]:
        parts = [part for one in getattr(annotation, "__args__", ()) for part in models(one)]
        return [annotation, *parts] if hasattr(annotation, "model_fields") else parts

    phases = {("duty_cycle", "phases", *symbol.path) for symbol in PHASE_SYMBOLS}
    moves = {(*MOTION_PATH, "moves", symbol.path[-1]) for symbol in (*TURN_SYMBOLS, *STROKE_SYMBOLS)}
    single = {path for path in leaves(Application) if path[0] != "tolerances"}  # those stand for a field each
    curve = ("requirements", "motor", "curve")
    single = {curve if path[:-1] == curve else path for path in single}  # a point is one text
    assert single == phases | moves | set(symbols.BY_PATH)


def test_a_canonical_number_is_as_short_as_it_can_be() -> None:
    phases = [
        {"torque_Nm": 1e-7, "speed_rpm": -2.5, "duration_s": 30.0},
        {"torque_Nm": 0.0, "speed_rpm": 1e6, "duration_s": 1e-12},
    ]
    application = {"duty_cycle": {"phases": phases, "pause_s": 1e-5}, "output_load": {"axial_N": 10.0}}

    link = to_link(Application.model_validate(application))

    assert link == "/?T=1e-7&n=-2.5&t=30&T=0&n=1000000&t=1e-12&tp=1e-5&FA=10"


def test_every_input_stands_in_one_group_of_the_form_by_its_name() -> None:
    grouped = [name for group in symbols.GROUPS for name in group.names]
    assert sorted(["tp", *grouped]) == sorted(symbol.name for symbol in symbols.SYMBOLS)
    every = (
        *PHASE_SYMBOLS,
        *symbols.BY_PATH.values(),
        *TURN_SYMBOLS,
        *STROKE_SYMBOLS,
    )
    assert all(symbol.named.name for symbol in every)


def test_the_field_of_a_size_is_read_in_the_notation_of_the_form_and_a_blank_one_is_absent() -> None:
    typed = [("xc.20A", "21,5"), ("xc.32A", ""), ("xc", ""), ("written", "de")]
    form = link_reader.parse([*parse_qsl("T=40&n=250&t=1&xR=45&FR=500"), *typed])
    assert form.application and form.application.output_load
    assert form.application.output_load.shaft_centre_mm == {"20A": 21.5}
    assert to_link(form.application).endswith("&xR=45&xc=20A:21.5")
