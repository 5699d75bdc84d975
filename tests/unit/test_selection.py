"""Reasons, refusals and the answer in brief, by two limits of HPN-20A-5: T_N = 80 Nm and T_R = 149 Nm."""

import weakref

import msgspec
import pytest

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.candidates import Candidate, reason_of
from hpn.engine.evaluation import Evaluation
from hpn.engine.selection import CheckDefinition, Judgement, Outcome, Selection, judge, select
from tests.build import Json, cycle, phase
from tests.conftest import Supplement

ONLY = {"sizes": ["20A"], "ratios": [5]}
TORQUE = "Load limit 1: average torque"


def first(application: Json, catalogue: Catalogue) -> Candidate:
    return select(Application.model_validate(application), catalogue).candidates[0]


@pytest.mark.parametrize(
    ("torque", "reason", "message"),
    [
        (40, f"Every check passes; the closest is {TORQUE} at 50.0 % of its limit.", "at 50 %"),
        (40.046, f"Every check passes; the closest is {TORQUE} at 50.1 % of its limit.", "at 50.1 %"),
        (100, f"{TORQUE} is at 125.0 % of its limit.", "at 125 %"),
        (80.0008, f"{TORQUE} is at 100.001 % of its limit.", "at 100.001 %"),
        (160, f"{TORQUE} is at 200.0 % of its limit; checks that fail: 2.", "at 200 %"),
    ],
)
def test_a_reason_names_the_closest_check_in_percent_that_tell_it_from_its_limit(
    catalogue: Catalogue, torque: float, reason: str, message: str
) -> None:
    gear = first(cycle(phase(torque, 100), requirements=ONLY), catalogue)

    assert gear.reason == reason
    sentence = reason_of(gear, 1.0)
    assert message in sentence.text
    assert sentence.text.replace(message, "") == reason.replace(f"{message.removesuffix(' %')}.0 %", "").replace(
        message, ""
    )
    assert sentence.translated == ("check",)


def test_a_share_that_the_user_allows_is_what_the_percent_are_told_from(catalogue: Catalogue) -> None:
    """40.0005 Nm are 50.000625 % of T_N: with fewer decimals than three it would read like what is allowed."""
    gear = first(cycle(phase(40.0005, 100), requirements=ONLY | {"utilisation": 0.5}), catalogue)

    assert gear.reason == f"{TORQUE} is at 50.001 % of its limit."
    assert "50.001 %" in reason_of(gear, 0.5).text


def test_percent_too_large_for_decimals_are_told_as_they_are(catalogue: Catalogue) -> None:
    """1e6 Nm over i = 5 on a motor of 3e-9 Nm: two thirds of 1e14 times the limit."""
    gear = first(cycle(phase(1e6, 100), requirements=ONLY | {"motor": {"peak_torque_Nm": 3e-9}}), catalogue)

    assert gear.utilisation is not None
    assert gear.utilisation == pytest.approx(2e14 / 3, rel=1e-15)
    assert gear.reason.startswith(f"Motor peak torque is at {100 * gear.utilisation!r} %")
    assert "at 6.66666666667e+15 % of" in reason_of(gear, 1.0).text  # twelve digits


def test_where_there_is_no_utilisation_the_reason_says_why(catalogue: Catalogue) -> None:
    stop = {"torque_Nm": 52, "count": 0}  # more than 17/3 of T_R = 9 Nm: not one stop
    hard = first(cycle(phase(1, 1), emergency_stop=stop, requirements={"sizes": ["11A"], "ratios": [10]}), catalogue)
    unrated = first(cycle(phase(1, 1), requirements={"sizes": ["40A"], "ratios": [5]}), catalogue)

    assert hard.reason == "T_k is too high: no emergency stop is permitted (eq. 17.9)."
    assert unrated.reason == "Not rated: figures of HPN-40A that the checks need are not in this catalogue’s source."
    for gear in (hard, unrated):
        assert reason_of(gear, 1.0).text == gear.reason


@pytest.mark.parametrize(
    ("wishes", "problems"),
    [
        (
            {"sizes": ["20A", "99A"]},
            [(("requirements", "sizes", 1), "the catalogue has no 99A (available: {sizes})")],
        ),
        (
            {"sizes": ["98A"], "ratios": [5, 6]},
            [
                (("requirements", "sizes", 0), "the catalogue has no 98A (available: {sizes})"),
                (
                    ("requirements", "ratios", 1),
                    "the catalogue has no 6 (available: 3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50)",
                ),
            ],
        ),
        (
            {"sizes": ["11A", "11A"], "ratios": [3]},
            [
                (
                    ("requirements", "ratios"),
                    "there is no gear of this size and ratio (available: "
                    "11A: 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50)",
                )
            ],
        ),
    ],
)
def test_a_wish_that_leaves_no_gear_is_refused_with_what_there_is(
    catalogue: Catalogue, wishes: Json, problems: list[tuple[object, str]]
) -> None:
    with pytest.raises(InputError) as refused:
        select(Application.model_validate(cycle(phase(1, 1), requirements=wishes)), catalogue)

    document = {"sizes": ", ".join(catalogue.sizes)}
    assert list(refused.value.problems) == [(place, text.format_map(document)) for place, text in problems]


def test_printed_curves_that_nobody_supplied_are_refused_where_they_are_asked_for(catalogue: Catalogue) -> None:
    for model in ("linear", "iso281"):
        assert first(cycle(phase(1, 1), output_load={"radial_N": 1, "model": model}), catalogue)
    with pytest.raises(InputError) as refused:
        first(cycle(phase(1, 1), output_load={"radial_N": 1, "model": "digitised"}), catalogue)

    [(location, text)] = refused.value.problems
    assert location == ("output_load", "model")
    assert text.startswith("no candidate has points of a printed curve: enter them in bearing_envelopes.csv")
    assert text.endswith("or choose linear or iso281")


def test_the_answer_in_brief_is_that_of_the_first_suitable_gear(catalogue: Catalogue) -> None:
    fits, fails = (Application.model_validate(cycle(phase(T, 100), requirements=ONLY)) for T in (40, 160))

    brief = judge(fits, catalogue).outcome()
    assert (brief.selected, brief.governing_check, brief.suitable) == ("HPN-20A-5", "average_torque", 1)
    assert brief.utilisation == pytest.approx(0.5, rel=1e-12)
    assert judge(fails, catalogue).outcome() == Outcome(None, None, None, 0)
    assert [judge(one, catalogue).selection().selected for one in (fits, fails)] == ["HPN-20A-5", None]
    assert judge(fits, catalogue).selection().link == ""


def test_the_foremost_gear_is_judged_wherever_one_is(catalogue: Catalogue) -> None:
    def selected(sizes: list[str]) -> Selection:
        wishes = {"sizes": sizes, "ratios": [5]}
        return select(Application.model_validate(cycle(phase(1000, 1), requirements=wishes)), catalogue)

    assert selected(["20A", "40A"]).foremost.designation == "HPN-20A-5"
    assert selected(["40A"]).foremost.designation == "HPN-40A-5"
    result = selected(["20A", "32A"])
    assert [gear and gear.size for gear in (result.candidate("HPN-32A-5"), result.candidate("HPN-9A-5"))] == [
        "32A",
        None,
    ]
    assert [check.code for check in result.candidates[0].failing] == ["average_torque", "repeated_peak_torque"]
    assert result.selected is None
    assert result.link == ""


def test_a_gear_is_judged_where_every_check_is_rated_and_names_its_checks(catalogue: Catalogue) -> None:
    wishes = {"sizes": ["20A", "40A"], "ratios": [5], "torsional_stiffness_Nm_per_rad": 1}
    rated, unrated = select(Application.model_validate(cycle(phase(1, 1), requirements=wishes)), catalogue).candidates

    assert [check.status == "not_rated" for check in unrated.checks] == [True, True, True, True, False]
    assert (rated.is_judged, unrated.is_judged) == (True, False)
    assert [result and result.code for result in map(rated.check, ("torsional_stiffness", "life"))] == [
        "torsional_stiffness",
        None,
    ]


def test_a_definition_that_was_saved_with_less_has_blank_texts() -> None:
    saved = b'{"title": "Life", "equation": "17.10", "unit": "h", "kind": "minimum", "group": "load"}'
    definition = msgspec.json.decode(saved, type=CheckDefinition)

    blank = ("limit_name", "source", "tests", "consequence", "basis", "remedy")
    assert [getattr(definition, name) for name in blank] == [""] * len(blank)


def test_suitable_gears_are_counted_from_one_and_no_other(catalogue: Catalogue) -> None:
    wishes = {"sizes": ["11A", "14A", "20A", "32A", "40A"], "ratios": [5, 50]}
    # Four sizes with 5 suit; 50 is too fast for 120 rpm, and 40A is not rated.
    ranked = select(Application.model_validate(cycle(phase(10, 120), requirements=wishes)), catalogue).candidates

    assert [gear.rank for gear in ranked if gear.status == "suitable"] == [1, 2, 3, 4]
    assert {gear.rank for gear in ranked if gear.status != "suitable"} == {None}


def test_of_several_sizes_each_is_told_with_its_ratios(supplemented: Supplement) -> None:
    grown = supplemented(gears="size,ratio,stages,source\n99A,5,1,mine\n")
    with pytest.raises(InputError) as refused:
        first(cycle(phase(1, 1), requirements={"sizes": ["11A", "99A"], "ratios": [3]}), grown)

    [(_, text)] = refused.value.problems
    assert text.endswith("(available: 11A: 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50; 99A: 5)")


def test_a_batch_keeps_one_evaluation_at_a_time(catalogue: Catalogue) -> None:
    """Those of ten thousand applications with every check would fill 250 MB."""
    alive: weakref.WeakSet[Evaluation] = weakref.WeakSet()

    def number_alive(judged: Judgement) -> int:
        alive.add(judged.evaluation)
        return len(alive)

    wishes = ({"ratios": [ratio]} for ratio in (4, 5, 10))
    applications = [Application.model_validate(cycle(phase(10, 100), requirements=wish)) for wish in wishes]
    assert judge_batch(applications, catalogue, number_alive) == [1, 1, 1]
