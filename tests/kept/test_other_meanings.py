"""A figure that another version calculated otherwise stays as saved, without an equation that does not give it."""

from io import BytesIO
from typing import Any

import msgspec
import openpyxl
import pytest

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.engine.kept import decode
from hpn.engine.selection import select
from hpn.explain.calculation import OTHERWISE, Step, calculation_of
from hpn.explain.calculation.mathml import compared
from hpn.files.aas.submodel import package
from hpn.files.report.content import content
from hpn.files.workbook.workbook import workbook
from hpn.words.reader import Reader
from tests.build import candidate
from tests.kept.content import APPLICATIONS
from tests.kept.test_lacking_fields import export_of, reply_of

CATALOGUE = load_catalogue()
GEAR = "HPN-20A-5"


def steps_of(name: str, reply: dict[str, Any], designation: str = GEAR) -> dict[str, Step]:
    """Calculation of a saved answer, by the codes of its steps."""
    selection, application = decode(msgspec.json.encode(reply)), Application.model_validate(APPLICATIONS[name])
    chosen, gear = selection.candidate(designation), CATALOGUE.by_designation[designation]
    assert chosen is not None
    return {step.code: step for step in calculation_of(chosen, selection.duty, gear, application, CATALOGUE)}


def is_as_saved(step: Step) -> bool:
    """True for a step without equations that says why."""
    return not step.lines and [note.text for note in step.notes] == [OTHERWISE]


@pytest.mark.parametrize("name", APPLICATIONS)
def test_every_equation_of_todays_answers_is_printed(name: str) -> None:
    application = Application.model_validate(APPLICATIONS[name])
    selection = select(application, CATALOGUE)
    for chosen in selection.candidates:
        gear = CATALOGUE.by_designation[chosen.designation]
        steps = calculation_of(chosen, selection.duty, gear, application, CATALOGUE)
        assert not any(map(is_as_saved, steps))


@pytest.mark.parametrize(
    ("figure", "code"),
    [
        ("stop_torque_Nm", "stop"),
        ("position_error_arcmin", "position_error"),
        ("life_L10_h", "life"),
        ("motor_peak_torque_Nm", "motor_peak_torque"),
        ("bearing_life_L50_h", "bearing_life"),
        ("average_input_speed_rpm", "average_input_speed"),
        ("natural_frequency_Hz", "natural_frequency"),
    ],
)
def test_an_equation_that_does_not_give_the_saved_figure_is_not_printed(figure: str, code: str) -> None:
    reply = reply_of("brake")
    assert not is_as_saved(steps_of("brake", reply)[code])

    candidate(reply, GEAR)[figure] *= 1.01

    assert is_as_saved(steps_of("brake", reply)[code])


def test_a_comparison_of_a_figure_shows_the_saved_value() -> None:
    reply = reply_of("brake")
    entry = candidate(reply, GEAR)
    entry["stop_torque_Nm"] = next(c for c in entry["checks"] if c["code"] == "momentary_peak_torque")["demand"] = (
        77.125
    )

    steps = steps_of("brake", reply)

    assert steps["momentary_peak_torque"].comparisons[0].value == 77.125
    assert "77.125" in compared(Reader(), steps["momentary_peak_torque"].comparisons[0])


def test_an_average_of_the_cycle_that_was_calculated_otherwise_stays_as_saved() -> None:
    reply = reply_of("example")
    reply["duty"]["average_output_speed_rpm"] *= 1.01

    steps = steps_of("example", reply)

    assert {code for code, step in steps.items() if is_as_saved(step)} == {
        "average_output_speed",
        "average_input_speed",
    }


def test_a_step_whose_figure_the_version_did_not_know_is_left_out_and_no_other() -> None:
    reply = reply_of("brake")
    whole = steps_of("brake", reply).keys()
    for name, code in (
        ("life_L10_h", "life"),
        ("momentary_peak_count", "momentary_peak_count"),
        ("wind_up_arcmin", "position_error"),
        ("natural_frequency_Hz", "natural_frequency"),
        ("motor_peak_torque_Nm", "motor_peak_torque"),
        ("bearing_life_L10_h", "bearing_life"),
    ):
        lacking = reply | {"candidates": [{k: v for k, v in c.items() if k != name} for c in reply["candidates"]]}
        assert whole - steps_of("brake", lacking).keys() == {code}


def test_the_workbook_has_a_figure_as_it_was_saved() -> None:
    reply = reply_of("example")
    candidate(reply, GEAR)["motor_peak_torque_Nm"] *= 1.01
    saved = [candidate(reply, gear)["motor_peak_torque_Nm"] for gear in (GEAR, "HPN-14A-5")]

    book = openpyxl.load_workbook(BytesIO(workbook(export_of("example", msgspec.json.encode(reply)), Reader())))
    heads, *rows = book["Candidates"].iter_rows(values_only=True)
    column = [str(head) for head in heads].index("T_max/(i·η) [Nm]")
    by_name = {row[0]: row[column] for row in rows}

    assert [by_name[gear] for gear in (GEAR, "HPN-14A-5")] == saved


def test_a_check_and_a_notice_of_another_version_are_told_as_it_told_them() -> None:
    reply = msgspec.json.encode(reply_of("everything")).replace(b'"life"', b'"life_of_then"')
    known = msgspec.json.decode(reply)
    known["notices"].append({"code": "speed_above_average", "text": "Old.", "values": {"longest_h": 1.0}})
    known["notices"].append({"code": "bearing_lever", "text": "New.", "values": {"lever_parsec": 1.0}})
    governed = candidate(known, GEAR)
    governed["governing_check"], governed["status"] = "life_of_then", "unsuitable"

    export = export_of("everything", msgspec.json.encode(known))
    output = content(export, Reader("de"))

    assert "Old." in str(output["notices"]) and workbook(export, Reader()) and package(export)
    assert export.selection.name_of("life_of_then") == known["check_definitions"]["life_of_then"]["title"]
