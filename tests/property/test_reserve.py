"""The reserve in closed form against the selection run again with the driver changed by it."""

import copy
import math

import pytest
from hypothesis import assume, given

from hpn.catalogue import Catalogue, load_catalogue
from tests.build import Json, answer, candidate, cycle, phase
from tests.property.draw import applications

CATALOGUE: Catalogue = load_catalogue()

MOVED = {
    "torque": {"average_torque", "repeated_peak_torque", "life", "motor_peak_torque", "motor_rated_torque"},
    "speed": {"average_input_speed", "maximum_input_speed", "life", "output_bearing_life", "motor_speed"},
    "load": {"output_bearing_load", "output_bearing_life"},
}
FIELDS = {
    "torque": ("torque_Nm",),
    "speed": ("speed_rpm",),
    "load": ("radial_N", "axial_N"),
}
# A root 3/10 or 1/3 of a quotient and its power again.
ROUNDING = 1e-11


def scaled(application: Json, driver: str, factor: float) -> Json:
    changed = copy.deepcopy(application)
    parts = [*changed["duty_cycle"]["phases"], *([changed["output_load"]] if driver == "load" else [])]
    for part in parts:
        for name in FIELDS[driver]:
            if name in part:
                part[name] *= factor
    return changed


@given(applications())
def test_a_driver_grown_by_its_reserve_meets_a_limit_exactly(application: Json) -> None:
    """Each factor in turn on two gears: the fullest of the checks that it moves is then full, by the check itself."""
    reply = answer(application, CATALOGUE)
    reserve = application.get("requirements", {}).get("utilisation", 1.0)
    for designation in ("HPN-14A-4", "HPN-32A-25"):
        for driver, codes in MOVED.items():
            factor = candidate(reply, designation)["reserve"][f"{driver}_factor"]
            if factor is None:
                continue
            assume(1e-3 < factor < 1e3)  # inside the bounds of the input
            again = answer(scaled(application, driver, factor), CATALOGUE)
            used = [c["utilisation"] for c in candidate(again, designation)["checks"] if c["code"] in codes]
            assert math.isclose(max(used), reserve, rel_tol=ROUNDING), (designation, driver, factor)


STEADY = [phase(30.0, 200.0)]
SHORT_PEAK = [phase(30.0, 100.0, 100.0), phase(120.0, 700.0, 0.01)]
LOADED = [phase(1.0, 1.0, radial_N=300.0)]
FAST_LOADED = [phase(1.0, 300.0, radial_N=1100.0)]


@pytest.mark.parametrize(
    ("driver", "code", "power", "phases", "wishes"),
    [
        ("torque", "average_torque", 1.0, STEADY, {}),
        ("torque", "repeated_peak_torque", 1.0, SHORT_PEAK, {}),
        ("torque", "life", 0.3, STEADY, {"life_h": 1e8}),
        ("torque", "motor_peak_torque", 1.0, SHORT_PEAK, {"motor": {"peak_torque_Nm": 1.0}}),
        ("torque", "motor_rated_torque", 1.0, STEADY, {"motor": {"rated_torque_Nm": 1.0}}),
        ("speed", "average_input_speed", 1.0, STEADY, {}),
        ("speed", "maximum_input_speed", 1.0, SHORT_PEAK, {}),
        ("speed", "life", 1.0, STEADY, {"life_h": 1e8}),
        ("speed", "output_bearing_life", 3.0, FAST_LOADED, {}),
        ("speed", "motor_speed", 1.0, STEADY, {"motor": {"maximum_speed_rpm": 100.0}}),
        ("load", "output_bearing_load", 1.0, LOADED, {}),
        ("load", "output_bearing_life", 1.0, FAST_LOADED, {}),
    ],
)
def test_each_check_can_be_the_one_that_limits_its_driver(
    driver: str, code: str, power: float, phases: list[Json], wishes: Json
) -> None:
    """The powers by hand: torque enters life with 10/3, speed bearing life with 1/3, all else linearly."""
    gear = candidate(answer(cycle(*phases, requirements=wishes), CATALOGUE), "HPN-20A-5")
    used = {check["code"]: check["utilisation"] for check in gear["checks"]}

    assert math.isclose(gear["reserve"][f"{driver}_factor"], used[code] ** -power, rel_tol=ROUNDING)


@given(applications())
def test_the_largest_permissible_emergency_stop_passes_and_a_larger_one_fails(application: Json) -> None:
    assume("emergency_stop" in application)
    reply = answer(application, CATALOGUE)
    codes = ("momentary_peak_torque", "momentary_peak_count")
    for designation in ("HPN-14A-4", "HPN-32A-25"):
        largest = candidate(reply, designation)["reserve"]["emergency_stop_torque_Nm"]
        assert largest is not None
        for factor, expected in ((1 - 1e-9, True), (1 + 1e-6, False)):
            changed = copy.deepcopy(application)
            changed["emergency_stop"]["torque_Nm"] = largest * factor
            checks = candidate(answer(changed, CATALOGUE), designation)["checks"]
            passes = all(check["status"] == "pass" for check in checks if check["code"] in codes)
            assert passes == expected, (designation, largest, factor)


@given(applications())
def test_a_size_that_is_not_rated_has_no_reserve_of_torque_and_no_number_that_is_made_up(application: Json) -> None:
    gear = candidate(answer(application, CATALOGUE), "HPN-40A-5")

    assert gear["reserve"]["torque_factor"] is None
    assert gear["reserve"]["emergency_stop_torque_Nm"] is None
