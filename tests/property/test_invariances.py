"""Invariances of every application, whatever its numbers."""

import copy
import math
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from tests.build import Json, answer, candidate, suitable
from tests.property.draw import applications
from tests.wire import Selection, select, select_fleet

CATALOGUE: Catalogue = load_catalogue()  # Hypothesis does not mix with fixtures of a narrower scope

# Sums in another order and a power 10/3 of them: some tens of units in the last place.
ROUNDING = 1e-12


def assert_same(first: Json, second: Json) -> None:
    """Two replies agree in every number to rounding, gear by gear and check by check."""
    assert first["duty"].keys() == second["duty"].keys()
    for name, value in first["duty"].items():
        assert math.isclose(value, second["duty"][name], rel_tol=ROUNDING), name
    for gear in first["candidates"]:
        other = candidate(second, gear["designation"])
        for name, value in gear.items():
            if isinstance(value, float):
                assert other[name] is not None
                assert math.isclose(value, other[name], rel_tol=ROUNDING), (gear["designation"], name)
            elif value is None and name not in ("rank", "governing_check"):
                assert other[name] is None, (gear["designation"], name)
        for check, its_other in zip(gear["checks"], other["checks"], strict=True):
            assert check["code"] == its_other["code"]
            for name in ("demand", "limit", "utilisation"):
                one, two = check[name], its_other[name]
                assert (one is None) == (two is None), (gear["designation"], check, its_other)
                assert one is None or math.isclose(one, two, rel_tol=ROUNDING), (check, its_other)
            # On the very edge of the tolerance rounding may decide; anywhere else the verdict must stay.
            if check["status"] != its_other["status"]:
                assert check["utilisation"] is not None
                edge = first_edge(check["utilisation"])
                assert edge, (gear["designation"], check, its_other)


def first_edge(utilisation: float) -> bool:
    """True for a utilisation within rounding of the edge of the tolerance, for any of the drawn reserves."""
    return any(math.isclose(utilisation, u * (1 + 1e-12), rel_tol=ROUNDING) for u in (0.5, 0.8, 1.0))


@given(applications(), st.data())
def test_splitting_a_phase_changes_nothing(application: Json, data: st.DataObject) -> None:
    phases = application["duty_cycle"]["phases"]
    index = data.draw(st.integers(0, len(phases) - 1))
    share = data.draw(st.floats(0.01, 0.99))
    split = copy.deepcopy(application)
    first = split["duty_cycle"]["phases"][index]
    second = dict(first)
    first["duration_s"], second["duration_s"] = first["duration_s"] * share, first["duration_s"] * (1 - share)
    split["duty_cycle"]["phases"].insert(index, second)

    assert_same(answer(application, CATALOGUE), answer(split, CATALOGUE))


@given(applications(), st.randoms(use_true_random=False))
def test_the_order_of_phases_changes_nothing(application: Json, chance: Any) -> None:
    shuffled = copy.deepcopy(application)
    chance.shuffle(shuffled["duty_cycle"]["phases"])

    assert_same(answer(application, CATALOGUE), answer(shuffled, CATALOGUE))


@given(applications(), st.floats(1e-6, 1e6))
def test_the_unit_of_time_changes_nothing(application: Json, factor: float) -> None:
    scaled = copy.deepcopy(application)
    scaled["duty_cycle"]["pause_s"] *= factor
    for phase in scaled["duty_cycle"]["phases"]:
        phase["duration_s"] *= factor

    assert_same(answer(application, CATALOGUE), answer(scaled, CATALOGUE))


@given(applications(), st.data())
def test_signs_of_torque_speed_and_load_change_nothing(application: Json, data: st.DataObject) -> None:
    """Magnitudes enter, so not even a rounding may differ: in nothing at all without the torques of the phases."""
    flipped = copy.deepcopy(application)
    phases = flipped["duty_cycle"]["phases"]
    others = [(part, name) for part in (*phases, flipped.get("output_load", {})) for name in FLIPPED if name in part]
    flip([*others, *((stop, "torque_Nm") for stop in [flipped.get("emergency_stop")] if stop)], data)
    one, other = answer(application, CATALOGUE), answer(flipped, CATALOGUE)
    assert one == other

    flip([(part, "torque_Nm") for part in phases], data)
    assert without_position(one) == without_position(answer(flipped, CATALOGUE))


FLIPPED = ("speed_rpm", "radial_N", "axial_N")


def flip(figures: list[tuple[Json, str]], data: st.DataObject) -> None:
    """Turn the signs of some of these figures."""
    for part, name in figures:
        if data.draw(st.booleans()):
            part[name] = -part[name]


def without_position(reply: Json) -> Json:
    """A reply without what goes by the torques' signs: the position error, and whether they say anything."""
    by_sign = {"position_error_arcmin", "position_error_mm"}
    candidates = [{name: value for name, value in gear.items() if name not in by_sign} for gear in reply["candidates"]]
    told = [notice for notice in reply["notices"] if notice["code"] != "torque_signs_not_given"]
    return reply | {"candidates": candidates, "notices": told}


@given(applications(), st.floats(1e-3, 1e2))
def test_scaling_torque_scales_average_peak_and_motor_torque_and_leaves_speeds(
    application: Json, factor: float
) -> None:
    scaled = copy.deepcopy(application)
    for phase in scaled["duty_cycle"]["phases"]:
        phase["torque_Nm"] *= factor

    one, other = answer(application, CATALOGUE), answer(scaled, CATALOGUE)

    for name, value in one["duty"].items():
        expected = value * (factor if "torque" in name else 1)
        assert math.isclose(other["duty"][name], expected, rel_tol=ROUNDING), name
    for gear in one["candidates"]:
        for name in ("motor_peak_torque_Nm", "motor_rated_torque_Nm"):
            value = candidate(other, gear["designation"])[name]
            assert math.isclose(value, gear[name] * factor, rel_tol=ROUNDING), name


@given(applications())
def test_a_pause_lowers_speed_and_rms_but_not_the_average_torque(application: Json) -> None:
    resting = copy.deepcopy(application)
    resting["duty_cycle"]["pause_s"] += 10

    one, other = answer(application, CATALOGUE), answer(resting, CATALOGUE)

    assert one["duty"]["average_torque_Nm"] == other["duty"]["average_torque_Nm"]
    assert one["duty"]["average_output_speed_rpm"] > other["duty"]["average_output_speed_rpm"]
    for gear in one["candidates"]:
        rested = candidate(other, gear["designation"])
        assert rested["motor_rated_torque_Nm"] <= gear["motor_rated_torque_Nm"]


@given(applications(wishes=False), st.data())
def test_a_harder_requirement_never_adds_a_suitable_candidate(application: Json, data: st.DataObject) -> None:
    """Each requirement in turn: none at all, then some value, then a harder one."""
    harder = {
        "life_h": (st.floats(1, 1e6), 1.7),
        "backlash_arcmin": (st.floats(4, 9), 0.8),
        "torsional_stiffness_Nm_per_rad": (st.floats(1e3, 2e5), 1.9),
        "weight_kg": (st.floats(0.3, 9), 0.6),
        "length_mm": (st.floats(50, 200), 0.8),
        "utilisation": (st.floats(0.1, 1), 0.9),
    }
    for name, (values, factor) in harder.items():
        value = data.draw(values, label=name)
        none = suitable(answer(application, CATALOGUE))
        soft = suitable(answer(application | {"requirements": {name: value}}, CATALOGUE))
        hard = suitable(answer(application | {"requirements": {name: value * factor}}, CATALOGUE))
        assert hard <= soft <= none, name
    for name, values in {
        "maximum_speed_rpm": st.floats(100, 10000),
        "peak_torque_Nm": st.floats(0.1, 100),
        "rated_torque_Nm": st.floats(0.1, 100),
    }.items():
        value = data.draw(values, label=name)
        none = suitable(answer(application, CATALOGUE))
        soft = suitable(answer(application | {"requirements": {"motor": {name: value}}}, CATALOGUE))
        hard = suitable(answer(application | {"requirements": {"motor": {name: value * 0.8}}}, CATALOGUE))
        assert hard <= soft <= none, name
        lossy = {"motor": {name: value}, "efficiency": 0.7}
        assert suitable(answer(application | {"requirements": lossy}, CATALOGUE)) <= soft
    away = data.draw(st.floats(0, 30))
    near = suitable(answer(application | {"requirements": {"ambient_temperature_degC": 20 + away}}, CATALOGUE))
    far = suitable(answer(application | {"requirements": {"ambient_temperature_degC": 20 - away - 3}}, CATALOGUE))
    assert far <= near <= suitable(answer(application, CATALOGUE))


@given(applications(), st.floats(1.01, 2))
def test_a_harder_load_or_more_stops_never_add_a_suitable_candidate(application: Json, factor: float) -> None:
    soft = suitable(answer(application, CATALOGUE))
    for part, name in (
        ("output_load", "radial_N"),
        ("output_load", "axial_N"),
        ("output_load", "load_coefficient"),
        ("output_load", "life_h"),
        ("emergency_stop", "torque_Nm"),
        ("emergency_stop", "count"),
    ):
        if application.get(part, {}).get(name) is None:
            continue
        harder = copy.deepcopy(application)
        value = harder[part][name] * factor
        harder[part][name] = min(value, 3) if name == "load_coefficient" else int(value) if name == "count" else value
        assert suitable(answer(harder, CATALOGUE)) <= soft, name


@given(applications())
def test_status_utilisation_governing_check_and_rank_fit_together(application: Json) -> None:
    reply = answer(application, CATALOGUE)
    reserve = application["requirements"].get("utilisation", 1.0)
    codes = list(reply["check_definitions"])
    groups = {code: definition["group"] for code, definition in reply["check_definitions"].items()}

    for gear in reply["candidates"]:
        assert [check["code"] for check in gear["checks"]] == codes
        for check in gear["checks"]:
            bound = (reserve if groups[check["code"]] == "load" else 1) * (1 + 1e-12)
            if check["status"] == "pass":
                assert check["utilisation"] <= bound
            elif check["status"] == "fail" and check["utilisation"] is not None:
                assert check["utilisation"] > bound
            elif check["status"] == "fail":
                assert check["code"] == "momentary_peak_count"
                assert check["limit"] == 0
            else:
                assert check["utilisation"] is None
        states = {check["status"] for check in gear["checks"]}
        expected = "unsuitable" if "fail" in states else "unrated" if "not_rated" in states else "suitable"
        assert gear["status"] == expected
        if expected == "unrated":
            assert (gear["utilisation"], gear["governing_check"]) == (None, None)
        else:
            governing = next(check for check in gear["checks"] if check["code"] == gear["governing_check"])
            if gear["utilisation"] is None:
                assert governing["utilisation"] is None
            else:
                assert governing["utilisation"] >= gear["utilisation"] * (1 - 1e-12)  # the first of those that tie
            assert expected == "suitable" or governing["status"] == "fail"
        assert gear["reason"]
    ranks = [gear["rank"] for gear in reply["candidates"]]
    count = sum(gear["status"] == "suitable" for gear in reply["candidates"])
    assert ranks == [*range(1, count + 1), *[None] * (len(ranks) - count)]
    assert reply["selected"] == (reply["candidates"][0]["designation"] if count else None)


@given(st.lists(applications(), min_size=1, max_size=8))
def test_a_fleet_gets_what_each_of_its_applications_gets_alone_to_the_last_bit(fleet: list[Json]) -> None:
    """Savings that come together are worked out together, and what is saved is what `select` replies."""
    models = [Application.model_validate(application) for application in fleet]

    for application, selection in zip(models, select_fleet(models, CATALOGUE), strict=True):
        assert isinstance(selection, Selection)
        assert selection.json("/x") == select(application, CATALOGUE).json("/x")
        assert selection.summary("/x") == select(application, CATALOGUE).summary("/x")
