"""Every check explains itself, and the codes and their order are those of the contract."""

import dataclasses

import pytest

from hpn.catalogue import Catalogue
from hpn.checks import CHECKS
from hpn.explanations import EXPLANATIONS
from tests.build import answer, cycle, phase

IN_ORDER = [
    *("average_torque", "repeated_peak_torque", "momentary_peak_torque", "momentary_peak_count"),
    *("average_input_speed", "maximum_input_speed", "life", "output_bearing_load", "output_bearing_life"),
    *("motor_speed", "motor_peak_torque", "motor_rated_torque"),
    *("ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"),
]
LOAD_CHECKS = IN_ORDER[:12]
EVERYTHING = cycle(
    phase(10, 100, radial_N=100),
    emergency_stop={"torque_Nm": 50, "count": 10},
    requirements={
        "life_h": 1,
        "backlash_arcmin": 7,
        "torsional_stiffness_Nm_per_rad": 1,
        "weight_kg": 9,
        "length_mm": 200,
        "ambient_temperature_degC": 20,
        "motor": {"maximum_speed_rpm": 4000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
    },
)


def test_the_checks_stand_in_the_order_of_the_contract() -> None:
    assert [check.code for check in CHECKS] == IN_ORDER
    assert [check.code for check in CHECKS if check.is_load_check] == LOAD_CHECKS


@pytest.mark.parametrize("code", IN_ORDER)
def test_every_check_has_an_explanation_with_every_text(code: str) -> None:
    explanation = EXPLANATIONS[code]

    for field in dataclasses.fields(explanation):
        text = getattr(explanation, field.name)
        if field.name not in ("equation", "unit"):
            assert text and text.strip() == text, field.name
    for name in ("tests", "consequence", "basis", "remedy"):
        assert getattr(explanation, name).endswith("."), name
        assert len(getattr(explanation, name)) > 12, name
    assert explanation.kind in ("maximum", "minimum", "range")


def test_no_explanation_is_left_over() -> None:
    assert set(EXPLANATIONS) == {check.code for check in CHECKS}


def test_a_minimum_is_a_minimum_and_units_are_those_of_the_demand() -> None:
    assert {code for code, entry in EXPLANATIONS.items() if entry.kind == "minimum"} == {"life", "torsional_stiffness"}
    assert {code for code, entry in EXPLANATIONS.items() if entry.kind == "range"} == {"ambient_temperature"}
    units = {
        "Nm": {"average_torque", "repeated_peak_torque", "momentary_peak_torque", "motor_peak_torque"}
        | {"motor_rated_torque"},
        "rpm": {"average_input_speed", "maximum_input_speed", "motor_speed"},
        "h": {"life"},
        "": {"momentary_peak_count", "output_bearing_load", "output_bearing_life"},
        "°C": {"ambient_temperature"},
        "arcmin": {"backlash"},
        "Nm/rad": {"torsional_stiffness"},
        "kg": {"weight"},
        "mm": {"length"},
    }
    assert {code: entry.unit for code, entry in EXPLANATIONS.items()} == {
        code: unit for unit, codes in units.items() for code in codes
    }


def test_equations_are_numbered_as_printed() -> None:
    numbers = {code: entry.equation for code, entry in EXPLANATIONS.items() if entry.equation}

    assert numbers == {
        "average_torque": "17.2",
        "repeated_peak_torque": "17.7",
        "momentary_peak_torque": "17.8",
        "momentary_peak_count": "17.9",
        "average_input_speed": "17.5",
        "maximum_input_speed": "17.6",
        "life": "17.10",
        "motor_speed": "17.6",
    }


def test_a_reply_defines_every_check_that_it_contains_and_no_other(catalogue: Catalogue) -> None:
    everything, little = answer(EVERYTHING, catalogue), answer(cycle(phase(1, 1)), catalogue)

    assert list(everything["check_definitions"]) == IN_ORDER
    always = ["average_torque", "repeated_peak_torque", "average_input_speed", "maximum_input_speed"]
    assert list(little["check_definitions"]) == always
    for reply, codes in ((everything, IN_ORDER), (little, always)):
        for gear in reply["candidates"]:
            assert [check["code"] for check in gear["checks"]] == codes
    definition = everything["check_definitions"]["average_torque"]
    for name in ("title", "equation", "unit", "kind", "tests", "basis", "remedy"):
        assert definition[name]
