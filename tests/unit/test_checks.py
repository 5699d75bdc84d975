"""A limit that is met exactly passes, and so does what floating point may add; what lies beyond that fails."""

import math
from collections.abc import Callable

import pytest

from hpn.application.input_fields import NUMBERS
from hpn.catalogue import Catalogue
from hpn.engine.checks import BY_CODE, CHECKS, allowed
from tests.build import Json, answer, candidate, check, cycle, phase
from tests.conftest import Supplement
from tests.unit.test_supplements import SIZES

GEAR = "HPN-20A-5"
ONLY = {"sizes": ["20A"], "ratios": [5]}


def with_wish(**wishes: object) -> Json:
    return cycle(phase(1, 1), requirements=ONLY | wishes)


# Code of the check, and the application whose utilisation is x for HPN-20A-5 by the printed limits, for x near 1.
AT: dict[str, Callable[[float], Json]] = {
    "average_torque": lambda x: cycle(phase(80 * x, 100), requirements=ONLY),
    "repeated_peak_torque": lambda x: cycle(phase(149 * x, 0), phase(1, 1), requirements=ONLY),
    "momentary_peak_torque": lambda x: with_wish() | {"emergency_stop": {"torque_Nm": 256 * x}},
    "average_input_speed": lambda x: cycle(phase(1, 600 * x), requirements=ONLY),
    "maximum_input_speed": lambda x: cycle(phase(1, 1200 * x), pause_s=9, requirements=ONLY),
    "output_bearing_load": lambda x: with_wish() | {"output_load": {"radial_N": 1800 * x, "life_h": 1}},
    "output_bearing_life": lambda x: cycle(phase(1, 100), output_load={"axial_N": 2200 * x}, requirements=ONLY),
    "motor_speed": lambda x: cycle(phase(1, 100), requirements=ONLY | {"motor": {"maximum_speed_rpm": 500 / x}}),
    "motor_peak_torque": lambda x: cycle(phase(40 * x, 100), requirements=ONLY | {"motor": {"peak_torque_Nm": 8}}),
    "motor_rated_torque": lambda x: cycle(phase(40 * x, 100), requirements=ONLY | {"motor": {"rated_torque_Nm": 8}}),
    "motor_rated_speed": lambda x: cycle(phase(1, 100), requirements=ONLY | {"motor": {"rated_speed_rpm": 500 / x}}),
    # A load of 25 times the motor's inertia at a ratio of 5
    "inertia_ratio": lambda x: with_wish(
        load_inertia_kgm2=0.025 * x, motor={"inertia_kgm2": 0.001, "inertia_ratio": 1}
    ),
    # 80 Nm is T_N, so at 600 rpm (3000 rpm at the input) the life is 20000 h
    "life": lambda x: cycle(phase(80, 600), requirements=ONLY | {"life_h": 20000 * x}),
    "ambient_temperature": lambda x: with_wish(ambient_temperature_degC=20 - 20 * x),
    "backlash": lambda x: with_wish(backlash_arcmin=5 / x),
    "torsional_stiffness": lambda x: with_wish(torsional_stiffness_Nm_per_rad=26000 * x),
    # An inertia of K3 / (2π · 10)² swings with 10 Hz
    "natural_frequency": lambda x: with_wish(
        load_inertia_kgm2=26000 / (2 * math.pi * 10) ** 2, natural_frequency_Hz=10 * x
    ),
    "position_error": lambda x: with_wish(position_error_arcmin=(8 + 2 / 26000 * 10800 / math.pi + 5) / x),
    "weight": lambda x: with_wish(weight_kg=2.6 / x),
    "length": lambda x: with_wish(length_mm=122 / x),
}
PROPERTIES = {"ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"} | {
    "natural_frequency",
    "position_error",
    "inertia_ratio",
}


def test_every_check_is_tried_at_its_limit() -> None:
    counted = {"momentary_peak_count"}  # whole numbers: tried below by counts
    assert AT.keys() | counted == BY_CODE.keys()


@pytest.mark.parametrize("code", AT)
def test_a_limit_passes_when_met_and_within_rounding_and_fails_beyond(catalogue: Catalogue, code: str) -> None:
    # The contract's tolerance is 1e-12; an eighth of it to either side is far above the rounding of these few steps.
    for x, expected in (
        (1.0, "pass"),
        (1 + 0.875e-12, "pass"),
        (1 + 1.125e-12, "fail"),
        (1.001, "fail"),
        (0.9, "pass"),
    ):
        result = check(answer(AT[code](x), catalogue), GEAR, code)
        assert result["utilisation"] == pytest.approx(x, rel=3e-15, abs=1e-14)
        assert result["status"] == expected, x


@pytest.mark.parametrize("code", AT)
def test_a_reserve_of_the_user_bounds_load_checks_and_leaves_properties(catalogue: Catalogue, code: str) -> None:
    for x, expected in (
        (0.75, "pass"),
        (0.75 * (1 + 0.875e-12), "pass"),
        (0.75 * (1 + 1.125e-12), "fail"),
        (0.9, "fail"),
    ):
        application = AT[code](x)
        application["requirements"]["utilisation"] = 0.75
        reply = answer(application, catalogue)
        assert check(reply, GEAR, code)["status"] == ("pass" if code in PROPERTIES else expected), x
        # A property that passes never governs, however close it is.
        assert candidate(reply, GEAR)["governing_check"] not in PROPERTIES


@pytest.mark.parametrize("count", [1, 10, 9999, 10**4])
def test_the_expected_number_of_stops_may_be_the_allowed_number_and_no_more(catalogue: Catalogue, count: int) -> None:
    """On HPN-11A-10 T_k = 27 Nm is three times T_R = 9 Nm: 10^(8.5 - 4.5) = 10000 stops, by mental arithmetic."""
    only = {"sizes": ["11A"], "ratios": [10]}
    for extra, expected in ((0, "pass"), (10**4 - count, "pass"), (10**4 - count + 1, "fail")):
        stop = {"torque_Nm": 27, "count": count + extra}
        result = check(
            answer(cycle(phase(1, 1), emergency_stop=stop, requirements=only), catalogue),
            "HPN-11A-10",
            "momentary_peak_count",
        )
        assert (result["limit"], result["status"]) == (10**4, expected)
        assert result["utilisation"] == (count + extra) / 10**4


def test_every_requirement_is_checked_or_enters_what_is_checked() -> None:
    names = {check.trigger for check in CHECKS} | {check.instead for check in CHECKS}
    entering = {"utilisation", "efficiency", "load_inertia_kgm2", "motor.inertia_kgm2", "position_radius_mm"}
    entering |= {"rest_friction_Nm", "worst_case_utilisation"}
    entering |= {"motor.stall_torque_Nm", "motor.weight_kg"}  # bound of the curve; weight of the pair
    values = {".".join(path) for path in NUMBERS if path[0] == "requirements"}

    assert values - names == {f"requirements.{name}" for name in entering}


def test_where_not_one_stop_is_allowed_even_none_expected_fails_without_a_utilisation(catalogue: Catalogue) -> None:
    """T_k / T_R above 17/3 leaves less than one stop: 52 Nm on T_R = 9 Nm."""
    for count in (0, 1):
        application = cycle(phase(1, 1), emergency_stop={"torque_Nm": 52, "count": count})
        reply = answer(application, catalogue)
        result = check(reply, "HPN-11A-10", "momentary_peak_count")
        assert (result["demand"], result["limit"], result["utilisation"]) == (count, 0, None)
        assert result["status"] == "fail"
        gear = candidate(reply, "HPN-11A-10")
        assert (gear["status"], gear["utilisation"]) == ("unsuitable", None)
        assert gear["governing_check"] == "momentary_peak_count"
        assert gear["momentary_peak_count"] == 0
        last = [c["designation"] for c in reply["candidates"] if c["status"] == "unsuitable"][-1]
        assert candidate(reply, last)["utilisation"] is None  # null stands last among the unsuitable


def test_known_figures_of_an_unrated_gear_are_judged(catalogue: Catalogue) -> None:
    stiff = cycle(phase(1, 1), requirements={"sizes": ["40A"], "torsional_stiffness_Nm_per_rad": 143_001})
    fast = cycle(phase(1, 100), requirements={"sizes": ["40A"], "motor": {"maximum_speed_rpm": 1000}})

    failed = answer(stiff, catalogue)["candidates"]
    assert {c["status"] for c in failed} == {"unsuitable"}
    assert {c["governing_check"] for c in failed} == {"torsional_stiffness"}
    by_ratio = {c["ratio"]: c["status"] for c in answer(fast, catalogue)["candidates"]}
    assert by_ratio == {ratio: "unrated" if ratio <= 10 else "unsuitable" for ratio in by_ratio}


def test_a_tie_for_governing_goes_to_the_first_check(catalogue: Catalogue) -> None:
    """80 Nm over T_N and 600 rpm times five over n_av are both 1."""
    reply = answer(cycle(phase(80, 600), requirements=ONLY), catalogue)

    used = {c["code"]: c["utilisation"] for c in candidate(reply, GEAR)["checks"]}
    assert used["average_torque"] == pytest.approx(1, rel=1e-12)  # by a power, which processors round differently
    assert used["average_input_speed"] == 1
    assert candidate(reply, GEAR)["governing_check"] == "average_torque"


@pytest.mark.parametrize(("question", "limit", "used"), [(10, 0, 0.5), (20, 40, 0), (35, 40, 0.75), (-5, 0, 1.25)])
def test_the_limit_of_a_temperature_is_the_end_of_the_range_that_it_is_nearer_to(
    catalogue: Catalogue, question: float, limit: float, used: float
) -> None:
    """0 to 40 °C: the middle is 20, half of the range 20."""
    result = check(answer(with_wish(ambient_temperature_degC=question), catalogue), GEAR, "ambient_temperature")

    assert (result["demand"], result["limit"], result["utilisation"]) == (question, limit, used)


def test_a_temperature_is_not_rated_where_no_range_is_published(catalogue: Catalogue) -> None:
    wishes = {"sizes": ["40A"], "ratios": [5], "ambient_temperature_degC": 20}
    result = check(answer(cycle(phase(1, 1), requirements=wishes), catalogue), "HPN-40A-5", "ambient_temperature")

    assert (result["limit"], result["utilisation"], result["status"]) == (None, None, "not_rated")


def test_the_users_share_bounds_load_checks_alone() -> None:
    assert [allowed(code, 0.8) for code in (None, "weight", "life", "motor_speed")] == [1, 1, 0.8, 0.8]


def test_a_range_of_temperature_need_not_begin_at_zero(supplemented: Supplement) -> None:
    """10 to 40 °C: the middle is 25, half of the range 15."""
    colder = supplemented(sizes=SIZES + "20A,,,10,40,,,,mine\n")
    used = [
        check(answer(with_wish(ambient_temperature_degC=case), colder), GEAR, "ambient_temperature")["utilisation"]
        for case in (10, 25, 31, 0)
    ]

    assert used == [1, 0, 0.4, pytest.approx(5 / 3, rel=1e-15)]
