"""The remedy of a rejected gear and the reserve of every gear, against the selection run again with them applied."""

import copy
from typing import Any

from hypothesis import assume, example, given

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.remedy import Way
from hpn.engine.tried import followed as follow
from hpn.words.wording import rounded
from tests.build import Json, answer, candidate, cycle, phase, worked_example
from tests.property.draw import applications
from tests.wire import MOVES, rooms_of, ways_of

CATALOGUE: Catalogue = load_catalogue()
GEARS = ("HPN-11A-4", "HPN-14A-5", "HPN-20A-25", "HPN-32A-10")
FIELDS = {"torque": ("torque_Nm",), "speed": ("speed_rpm",), "load": ("radial_N", "axial_N")}
STOP = ("momentary_peak_torque", "momentary_peak_count")
PROPERTIES = {"ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"}
HAIR = 1e-9  # far above what floating point loses in the power 10/3, far below any figure that somebody types

LIFE_ALONE = worked_example(requirements={"life_h": 2e6})
BOTH_LIVES = worked_example(
    requirements={"life_h": 2e6}, output_load={"radial_N": 900.0, "axial_N": 100.0, "life_h": 1e6}
)
STOPS = cycle(phase(10.0, 100.0), emergency_stop={"torque_Nm": 200.0, "count": 10**6})


CLOSED = applications(curves=False)
"""Applications whose drivers have a factor each: along a motor's curve the speed has none, and ways are tried."""


def scaled(application: Json, **factors: float) -> Json:
    """The application with its drivers multiplied."""
    changed = copy.deepcopy(application)
    for driver, factor in factors.items():
        parts = [*changed["duty_cycle"]["phases"], *([changed["output_load"]] if "output_load" in changed else [])]
        for part in parts:
            for name in FIELDS[driver]:
                if name in part:
                    part[name] *= factor
    return changed


def statuses(application: Json, designation: str) -> dict[str, str]:
    checks = candidate(answer(application, CATALOGUE), designation)["checks"]
    return {check["code"]: check["status"] for check in checks}


def reserve_utilisation(application: Json) -> float:
    return float(application.get("requirements", {}).get("utilisation", 1.0))


@given(CLOSED)
@example(LIFE_ALONE)
@example(BOTH_LIVES)
def test_a_hair_below_a_reserve_passes_every_check_it_moves_and_a_hair_above_fails_one(application: Json) -> None:
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        for driver, codes in MOVES.items():
            factor = candidate(reply, designation)["reserve"][f"{driver}_factor"]
            if factor is None or not 1e-3 < factor < 1e3:  # inside the bounds of the input
                continue
            below = statuses(scaled(application, **{driver: factor * (1 - HAIR)}), designation)
            above = statuses(scaled(application, **{driver: factor * (1 + HAIR)}), designation)
            assert all(below[code] == "pass" for code in codes if code in below), (designation, driver, factor)
            assert any(above[code] == "fail" for code in codes if code in above), (designation, driver, factor)


@given(CLOSED)
@example(STOPS)
def test_a_hair_around_the_largest_emergency_stop_decides(application: Json) -> None:
    assume("emergency_stop" in application)
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        largest = candidate(reply, designation)["reserve"]["emergency_stop_torque_Nm"]
        for factor, expected in ((1 - HAIR, True), (1 + HAIR, False)):
            changed = copy.deepcopy(application)
            changed["emergency_stop"]["torque_Nm"] = largest * factor
            checks = statuses(changed, designation)
            assert all(checks[code] == "pass" for code in STOP if code in checks) == expected, (designation, largest)


@given(CLOSED)
@example(LIFE_ALONE)
@example(BOTH_LIVES)
@example(STOPS)
def test_every_way_of_a_remedy_followed_as_written_passes_every_load_check(application: Json) -> None:
    """With the figures as the words print them, and the emergency stop by its torque as well as by its number."""
    u = reserve_utilisation(application)
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        gear = candidate(reply, designation)
        ways = ways_of(gear, u)
        failing = {c["code"] for c in gear["checks"] if c["status"] == "fail"} - PROPERTIES
        assert bool(ways) == bool(failing), designation
        for changed in [change for way in ways for change in followed(application, way)]:
            checks = statuses(changed, designation)
            assert {code for code, status in checks.items() if status == "fail"} <= PROPERTIES, (designation, ways)


def followed(application: Json, way: Way) -> list[Json]:
    """The application changed as the sentence says; once more with fewer stops where it offers that."""

    def down(value: float, digits: int = 3) -> float:
        return float(rounded(value, digits, "down"))

    changed = scaled(application, **{d: down(f) for d in FIELDS if (f := getattr(way, d)) < 1})
    for part in changed["duty_cycle"]["phases"]:
        assume(abs(part["speed_rpm"]) > 1e-9 or part["speed_rpm"] == 0)
    if way.emergency_stop_torque_Nm is None:
        return [changed]
    gentler, rarer = copy.deepcopy(changed), copy.deepcopy(changed)
    gentler["emergency_stop"]["torque_Nm"] = down(way.emergency_stop_torque_Nm, 4)
    if way.emergency_stop_count is None:
        return [gentler]
    rarer["emergency_stop"]["count"] = way.emergency_stop_count
    return [gentler, rarer]


@given(CLOSED)
@example(BOTH_LIVES)
@example(STOPS)
def test_following_a_way_for_the_reader_passes_every_load_check(application: Json) -> None:
    """The link of the page: the first way applied to the application itself."""
    u = reserve_utilisation(application)
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        for way in ways_of(candidate(reply, designation), u):
            changed = follow(Application.model_validate(application), way)
            assume(any(abs(p.speed_rpm) * p.duration_s > 1e-9 for p in changed.duty_cycle.load_phases))
            checks = statuses(changed.model_dump(exclude_unset=True), designation)
            assert {code for code, status in checks.items() if status == "fail"} <= PROPERTIES, (designation, way)


@given(CLOSED)
@example(BOTH_LIVES)
def test_all_factors_below_one_together_leave_at_most_property_checks_failing(application: Json) -> None:
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        reserve = candidate(reply, designation)["reserve"]
        factors = {d: f * (1 - HAIR) for d in MOVES if (f := reserve[f"{d}_factor"]) is not None and f < 1}
        changed = scaled(application, **factors)
        if "emergency_stop" in changed:
            limit = reserve["emergency_stop_torque_Nm"] * (1 - HAIR)
            changed["emergency_stop"]["torque_Nm"] = min(abs(changed["emergency_stop"]["torque_Nm"]), limit)
        failing = {code for code, status in statuses(changed, designation).items() if status == "fail"}
        assert failing <= PROPERTIES, (designation, factors)


@given(CLOSED)
@example(LIFE_ALONE)
def test_no_way_asks_for_more_than_its_checks_need(application: Json) -> None:
    """Without its smallest step, a hair more of any driver that it lowers, some load check fails."""
    u = reserve_utilisation(application)
    reply = answer(application, CATALOGUE)
    for designation in GEARS:
        for way in ways_of(candidate(reply, designation), u):
            lowered = {d: f for d in FIELDS if (f := getattr(way, d)) < 1}
            assume(all(factor > 1e-3 for factor in lowered.values()))
            for driver in lowered:
                more = {d: f * ((1 + HAIR) if d == driver else (1 - 1e-12)) for d, f in lowered.items()}
                checks = statuses(scaled(application, **more), designation)
                assert "fail" in {status for code, status in checks.items() if code in MOVES[driver]}, (way, driver)


@given(CLOSED)
def test_the_room_of_a_driver_names_the_check_that_is_full_first(application: Json) -> None:
    u = reserve_utilisation(application)
    gear = candidate(answer(application, CATALOGUE), "HPN-20A-25")
    for room in rooms_of(gear, u):
        value: Any = room.value
        if room.driver not in FIELDS or value is None or not 1e-3 < value < 1e3:
            continue
        above = statuses(scaled(application, **{room.driver: value * (1 + HAIR)}), "HPN-20A-25")
        assert room.check is not None
        assert above[room.check] == "fail"
