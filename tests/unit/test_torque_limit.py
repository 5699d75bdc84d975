"""Torque limit of the drive: the torque that keeps the gear at T_R, and a motor that can put more on it."""

import msgspec
import pytest
from msgspec import structs

from hpn.account.readings import torque_limit_of
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import Selection, select
from hpn.explain.calculation import calculation_of
from hpn.explain.calculation.formula import value_of
from hpn.explain.differences import differences
from hpn.files.export import Export
from hpn.files.report.tables import derived
from hpn.words.reader import GROUP, Reader
from tests.build import Json, answer, candidate, cycle, notices, phase, worked_example
from tests.conftest import Supplement

RATED = "HPN-20A-4"
"""The gear that the worked example selects where no ratio is asked for: T_R 130 Nm and T_M 256 Nm (table 12.1)."""


def example(**requirements: object) -> Json:
    """The worked example of the handbook, with its cycle alone and other requirements."""
    return {"duty_cycle": worked_example()["duty_cycle"], "requirements": requirements}


def codes(application: Json, catalogue: Catalogue) -> set[str]:
    """Codes of the notices on an application."""
    return set(notices(answer(application, catalogue)))


def chosen(application: Json, catalogue: Catalogue) -> Selection:
    return select(Application.model_validate(application), catalogue)


def test_a_motor_that_can_put_more_than_the_repeated_peak_torque_on_its_gear_is_told(catalogue: Catalogue) -> None:
    """60 Nm on a ratio of 4 are 240 Nm, above T_R of 130 Nm, which 130 / 4 = 32.5 Nm at the motor keep."""
    reply = answer(example(motor={"peak_torque_Nm": 60}), catalogue)

    assert (reply["selected"], candidate(reply, RATED)["motor_torque_limit_Nm"]) == (RATED, 32.5)
    text = notices(reply)["gear_below_motor"]
    assert "60 Nm can put 240 Nm on HPN-20A-4 (T_R 130 Nm)" in text
    assert "torque limit to 32.5 Nm, 54.1 % of that peak" in text


def test_torques_of_a_notice_have_four_digits_on_the_safe_side(catalogue: Catalogue) -> None:
    """59.123456 Nm on a ratio of 4 are 236.493824 Nm."""
    text = notices(answer(example(motor={"peak_torque_Nm": 59.123456}), catalogue))["gear_below_motor"]

    assert "can put 236.5 Nm on HPN-20A-4" in text


def test_a_motor_that_can_break_its_gear_is_told_in_stronger_words(catalogue: Catalogue) -> None:
    """T_M of 256 Nm is met by 64 Nm at the motor, and passed by one more."""
    met, passed = (
        notices(answer(example(motor={"peak_torque_Nm": T}), catalogue))["gear_below_motor"] for T in (64, 65)
    )

    assert "can put 256 Nm" in met
    assert "can break the gear" not in met
    assert "The motor can break the gear: its peak torque of 65 Nm puts 260 Nm on HPN-20A-4 (T_M 256 Nm)" in passed


@pytest.mark.parametrize("requirements", [{}, {"motor": {"peak_torque_Nm": 32.5}}, {"motor": {"rated_torque_Nm": 60}}])
def test_a_motor_within_the_limit_or_without_a_peak_torque_is_not_told(
    requirements: Json, catalogue: Catalogue
) -> None:
    assert not {"gear_below_motor", "limit_below_need"} & codes(example(**requirements), catalogue)


def test_the_limit_takes_the_stated_efficiency_else_that_of_the_curve_at_T_R_else_1(
    supplemented: Supplement, catalogue: Catalogue
) -> None:
    """The curve gives 0.8 half way between 100 Nm and 160 Nm, which is T_R of HPN-20A-4."""
    curved = supplemented(efficiency="size,ratio,torque_Nm,efficiency,source\n20A,4,100,0.7,m\n20A,4,160,0.9,m\n")

    def limit(designation: str, book: Catalogue, **asked: object) -> float:
        return float(candidate(answer(example(**asked), book), designation)["motor_torque_limit_Nm"])

    assert limit(RATED, curved) == pytest.approx(0.8 * 130 / 4, rel=1e-12)
    assert limit(RATED, curved, efficiency=0.5) == pytest.approx(0.5 * 130 / 4, rel=1e-12)
    assert limit("HPN-20A-5", curved) == pytest.approx(149 / 5, rel=1e-12)
    assert limit(RATED, catalogue) == 32.5


def test_a_limit_without_an_efficiency_says_what_braking_adds(supplemented: Supplement, catalogue: Catalogue) -> None:
    curved = supplemented(efficiency="size,ratio,torque_Nm,efficiency,source\n20A,4,100,0.8,m\n")

    assert "up to T_R / η" in notices(answer(example(), catalogue))["limit_without_efficiency"]
    assert "limit_without_efficiency" not in codes(example(efficiency=1.0), catalogue)
    only = {"sizes": ["20A"], "ratios": [4]}
    assert "limit_without_efficiency" not in codes(example(**only), curved)
    assert "limit_without_efficiency" in codes(example(), curved)  # the other gears have no curve


def test_a_gear_without_a_published_repeated_peak_torque_has_no_limit(catalogue: Catalogue) -> None:
    reply = answer(example(sizes=["40A"], motor={"peak_torque_Nm": 900}), catalogue)

    assert {gear["motor_torque_limit_Nm"] for gear in reply["candidates"]} == {None}
    assert not {"gear_below_motor", "limit_below_need", "limit_without_efficiency"} & notices(reply).keys()


def test_a_cycle_that_needs_more_at_the_motor_than_the_limit_is_told_with_both_figures(catalogue: Catalogue) -> None:
    """120 Nm through losses of 0.9 and a ratio of 4 need 33.3 Nm; the limit is 0.9 · 130 / 4 = 29.25 Nm."""
    gear = {"sizes": ["20A"], "ratios": [4], "efficiency": 0.9}
    reply = answer(cycle(phase(120, 10, 0.1), phase(10, 10, 9), requirements=gear), catalogue)

    text = notices(reply)["limit_below_need"]
    assert "33.34 Nm at the motor of HPN-20A-4" in text
    assert "torque limit of 29.25 Nm" in text


@pytest.mark.parametrize("efficiency", [1.0, 0.9, 0.6])
def test_with_the_limit_set_the_output_stays_at_T_R_whichever_side_drives(
    efficiency: float, catalogue: Catalogue
) -> None:
    """Two ways agree: the reply, and a motor at its limit that drives (i M η at most i M) or brakes (i M / η)."""
    for gear in answer(example(efficiency=efficiency), catalogue)["candidates"]:
        if gear["motor_torque_limit_Nm"] is not None:
            T_R = catalogue.by_designation[gear["designation"]].repeated_peak_torque_Nm
            assert T_R is not None
            driving, braking = (gear["ratio"] * gear["motor_torque_limit_Nm"] / loss for loss in (1.0, efficiency))
            assert driving <= braking * (1 + 1e-12)
            assert braking == pytest.approx(T_R, rel=1e-12)


def test_the_calculation_sets_out_the_limit(catalogue: Catalogue) -> None:
    application = Application.model_validate(example(efficiency=0.9))
    selection = select(application, catalogue)
    best = selection.candidates[0]
    steps = calculation_of(best, selection.duty, catalogue.by_designation[best.designation], application, catalogue)

    line = next(step for step in steps if step.code == "torque_limit").lines[0]
    assert line.result.value == best.motor_torque_limit_Nm
    assert value_of(line.formula) == pytest.approx(0.9 * 130 / 4, rel=1e-12)


def told(application: Json, catalogue: Catalogue, designation: str = RATED, language: str = "en") -> list[str]:
    question = Application.model_validate(application)
    result = select(question, catalogue).candidate(designation)
    assert result
    reader = Reader(language)
    lines = torque_limit_of(result, catalogue.by_designation[designation], question).lines
    return [reader.sentence(line).replace(GROUP, " ") for line in lines]


def test_the_line_of_the_verdict_has_the_share_of_the_motor_s_peak_where_there_is_one(catalogue: Catalogue) -> None:
    assert told(example(), catalogue) == ["Set the drive’s torque limit to 32.5 Nm."]
    (within,) = told(example(motor={"peak_torque_Nm": 20}), catalogue)
    assert "peak torque of 20 Nm stays within the drive’s torque limit of 32.5 Nm" in within
    (above,) = told(example(motor={"peak_torque_Nm": 60}), catalogue)
    assert above.endswith("32.5 Nm, 54.1 % of that peak.")


def test_the_line_is_of_the_gear_that_is_looked_at(catalogue: Catalogue) -> None:
    """60 Nm on HPN-20A-5 are 300 Nm, above its T_M of 256 Nm."""
    (line,) = told(example(motor={"peak_torque_Nm": 60}), catalogue, "HPN-20A-5")
    assert "puts 300 Nm on HPN-20A-5" in line


def test_the_line_is_there_in_german(catalogue: Catalogue) -> None:
    (line,) = told(example(), catalogue, language="de")
    assert line == "Drehmomentgrenze des Umrichters auf 32,5 Nm einstellen."


def test_a_report_calls_the_torques_at_the_motor_alone_a_lower_bound(catalogue: Catalogue) -> None:
    """Neither the limit of the drive nor the speed with a locked motor, whose names begin like theirs."""
    stop = {"brake": {"torque_Nm": 8}}
    question = example(load_inertia_kgm2=0.8, motor={"inertia_kgm2": 0.0015}) | {"emergency_stop": stop}
    export = Export(Application.model_validate(question), chosen(question, catalogue), "/", catalogue=catalogue)

    labels = [str(line["label"]) for line in derived(export.account, Reader())]
    assert any("Torque limit of the drive" in label for label in labels)
    assert any("Speed with a locked motor" in label for label in labels)
    bounds = [label for label in labels if "lower bound" in label]
    assert [label.split(" motor torque")[0].strip("['") for label in bounds] == ["Peak", "RMS"]


def test_a_selection_of_a_version_without_the_limit_does_not_differ_by_having_none(catalogue: Catalogue) -> None:
    today = chosen(example(), catalogue)
    saved = msgspec.to_builtins(today)
    for one in saved["candidates"]:
        del one["motor_torque_limit_Nm"]
    other = [structs.replace(one, motor_torque_limit_Nm=1.0) for one in today.candidates]

    assert differences(saved, today) == []
    changed = differences(structs.replace(today, candidates=tuple(other)), today)
    assert {one.field for one in changed} == {"motor_torque_limit_Nm"}
