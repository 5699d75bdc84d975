"""Every check explains itself, and the codes and their order are those of the contract."""

from typing import get_args

import pytest

from hpn.catalogue import Catalogue
from hpn.engine.checks import BY_CODE, CHECKS
from hpn.engine.remedy import MOTOR_TORQUE_CHECKS
from hpn.words.quantities import CheckCode
from hpn.words.units import suffix_of
from tests.build import answer, cycle, phase

IN_ORDER = [
    *("average_torque", "repeated_peak_torque", "momentary_peak_torque", "momentary_peak_count"),
    *("average_input_speed", "maximum_input_speed", "life", "output_bearing_load", "output_bearing_life"),
    *("motor_speed", "motor_peak_torque", "motor_rated_torque", "motor_rated_speed"),
    *("ambient_temperature", "backlash", "torsional_stiffness", "natural_frequency", "position_error"),
    *("weight", "length", "inertia_ratio"),
]
LOAD_CHECKS = IN_ORDER[:13]
EVERYTHING = cycle(
    phase(10, 100, radial_N=100),
    emergency_stop={"torque_Nm": 50, "count": 10},
    requirements={
        "life_h": 1,
        "backlash_arcmin": 7,
        "torsional_stiffness_Nm_per_rad": 1,
        "natural_frequency_Hz": 1,
        "position_error_arcmin": 90,
        "weight_kg": 9,
        "length_mm": 200,
        "ambient_temperature_degC": 20,
        "load_inertia_kgm2": 0.2,
        "motor": {
            "maximum_speed_rpm": 4000,
            "peak_torque_Nm": 20,
            "rated_torque_Nm": 8,
            "rated_speed_rpm": 3000,
            "inertia_kgm2": 0.001,
            "inertia_ratio": 5,
        },
    },
)


def test_the_checks_stand_in_the_order_of_the_contract() -> None:
    assert [check.code for check in CHECKS] == IN_ORDER == list(get_args(CheckCode))
    assert [check.code for check in CHECKS if check.group == "load"] == LOAD_CHECKS


@pytest.mark.parametrize("code", IN_ORDER)
def test_every_check_has_all_its_texts(code: str) -> None:
    check = BY_CODE[code]

    for name in ("title", "name", "limit_name", "source", "relation"):
        text = getattr(check, name)
        assert text and text.strip() == text, name
    for name in ("tests", "consequence", "basis", "remedy"):
        assert getattr(check, name).endswith("."), name
        assert len(getattr(check, name)) > 12, name
    assert check.kind in ("maximum", "minimum", "range")


def test_a_remedy_has_words_for_every_check() -> None:
    """One without would go unsaid, and "fits if …" would be wrong on a gear that fails it besides another."""
    of_its_own = {"momentary_peak_torque", "momentary_peak_count", "ambient_temperature"}
    not_in_closed_form = {*MOTOR_TORQUE_CHECKS, "motor_speed", "motor_rated_speed"}

    for check in CHECKS:
        notice = [bool(check.moves), "{value}" in check.accepted, check.code in of_its_own].count(True)
        assert notice == (2 if check.code in not_in_closed_form else 1), check.code
        assert not check.accepted or (check.trigger and (suffix_of(check.trigger) or not check.unit)), check.code


def test_no_check_is_listed_twice() -> None:
    assert list(BY_CODE) == [check.code for check in CHECKS]


def test_a_minimum_is_a_minimum_and_units_are_those_of_the_demand() -> None:
    assert {code for code, check in BY_CODE.items() if check.kind == "minimum"} == {
        "life",
        "torsional_stiffness",
        "natural_frequency",
    }
    assert {code for code, check in BY_CODE.items() if check.kind == "range"} == {"ambient_temperature"}
    units = {
        "Nm": {"average_torque", "repeated_peak_torque", "momentary_peak_torque", "motor_peak_torque"}
        | {"motor_rated_torque"},
        "rpm": {"average_input_speed", "maximum_input_speed", "motor_speed", "motor_rated_speed"},
        "h": {"life"},
        "": {"momentary_peak_count", "output_bearing_load", "output_bearing_life", "inertia_ratio"},
        "°C": {"ambient_temperature"},
        "arcmin": {"backlash", "position_error"},
        "Hz": {"natural_frequency"},
        "Nm/rad": {"torsional_stiffness"},
        "kg": {"weight"},
        "mm": {"length"},
    }
    assert {code: check.unit for code, check in BY_CODE.items()} == {
        code: unit for unit, codes in units.items() for code in codes
    }


def test_equations_are_numbered_as_printed() -> None:
    numbers = {code: check.equation for code, check in BY_CODE.items() if check.equation}

    assert numbers == {
        "average_torque": "17.2",
        "repeated_peak_torque": "17.7",
        "momentary_peak_torque": "17.8",
        "momentary_peak_count": "17.9",
        "average_input_speed": "17.5",
        "maximum_input_speed": "17.6",
        "life": "17.10",
        "motor_speed": "17.6",
        "motor_rated_speed": "17.5",
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


# Code: the check in the handbook's symbols, and the catalogue's figure that bounds it, None where the user does.
BOUNDS = {
    "average_torque": ("T_av ≤ T_A = T_N", "rated_torque_Nm"),
    "repeated_peak_torque": ("T_max ≤ T_R", "repeated_peak_torque_Nm"),
    "momentary_peak_torque": ("T_k ≤ T_M", "momentary_peak_torque_Nm"),
    "momentary_peak_count": ("N_k ≤ N_k,max", "repeated_peak_torque_Nm"),
    "average_input_speed": ("n_in,av ≤ n_av(max)", "average_input_speed_rpm"),
    "maximum_input_speed": ("n_in,max ≤ n_in(max)", "maximum_input_speed_rpm"),
    "life": ("L_10 ≥ L_10,req", "rated_torque_Nm"),
    "output_bearing_load": ("max f_w · P_i ≤ 1", "dynamic_radial_load_N"),
    "output_bearing_life": ("f_w · P_m ≤ k", "dynamic_radial_load_N"),
    "motor_speed": ("n_in,max ≤ n_mot", None),
    "motor_peak_torque": ("T_max / (i · η) ≤ T_mot", None),
    "motor_rated_torque": ("T_rms / (i · η) ≤ T_mot,N", None),
    "motor_rated_speed": ("n_in,av ≤ n_mot,N", None),
    "inertia_ratio": ("(J_L / i² + J_g) / J_m ≤ r_J", None),
    "ambient_temperature": ("t_min ≤ t_amb ≤ t_max", "ambient_temperature_maximum_degC"),
    "backlash": ("j ≤ j_req", "backlash_arcmin"),
    "torsional_stiffness": ("K_3 ≥ K_3,req", "torsional_stiffness_Nm_per_rad"),
    "natural_frequency": ("√(K_3 / J_L) / 2π ≥ f_req", "torsional_stiffness_Nm_per_rad"),
    "position_error": ("φ_e ≤ φ_req", "torsional_stiffness_Nm_per_rad"),
    "weight": ("m ≤ m_req", "weight_kg"),
    "length": ("L_max ≤ L_req", "length_max_mm"),
}


def test_a_check_says_in_symbols_what_it_compares_and_which_figure_bounds_it() -> None:
    assert {code: (check.relation, check.limited_by) for code, check in BY_CODE.items()} == BOUNDS


# Power with which a share grows with all torques, speeds or loads: by equations 17.2 to 17.10 and ISO 281's exponent 3.
POWERS = {
    "average_torque": {"torque": 1},
    "repeated_peak_torque": {"torque": 1},
    "average_input_speed": {"speed": 1},
    "maximum_input_speed": {"speed": 1},
    "motor_speed": {"speed": 1},
    "motor_rated_speed": {"speed": 1},
    "motor_peak_torque": {"torque": 1},
    "motor_rated_torque": {"torque": 1},
    "life": {"torque": 10 / 3, "speed": 1},
    "output_bearing_load": {"load": 1},
    "output_bearing_life": {"load": 1, "speed": 1 / 3},
}


def test_a_check_grows_with_its_drivers_as_its_equation_says() -> None:
    assert {code: check.moves for code, check in BY_CODE.items() if check.moves} == POWERS
