"""Notices: each where it belongs, and nowhere else."""

from typing import get_args

import pytest

from hpn.application import Application, ApplicationArea
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.notice import AREAS
from hpn.engine.selection import Judgement, Selection, select
from tests.build import Json, answer, candidate, check, cycle, notices, phase
from tests.conftest import Supplement

PLAIN = cycle(phase(10, 100), requirements={"sizes": ["20A"], "load_reverses": False})


def codes(application: Json, catalogue: Catalogue) -> set[str]:
    return set(notices(answer(application, catalogue)))


def test_a_plain_application_on_rated_gears_needs_a_notice_on_the_efficiency_alone(catalogue: Catalogue) -> None:
    assert codes(PLAIN, catalogue) == {"limit_without_efficiency"}


@pytest.mark.parametrize(("ramp_s", "has_notice"), [(0.034, True), (0.036, False)])
def test_a_ramp_shorter_than_a_period_of_the_load_is_told_with_both(
    ramp_s: float, has_notice: bool, catalogue: Catalogue
) -> None:
    """f_1 = √(26000 / 0.8) / 2π = 28.692 Hz, and its period 34.85 ms."""
    move = {"profile": "trapezoidal", "angle_deg": 9.0, "time_s": 1.0, "acceleration_time_s": ramp_s}
    motion = {"mechanism": {"type": "rotary", "inertia_kgm2": 0.8}, "moves": [move]}
    result = notices(answer({"duty_cycle": {"motion": motion}, "requirements": {"sizes": ["20A"]}}, catalogue))
    assert ("ramp_shorter_than_period" in result) is has_notice
    if has_notice:
        assert result["ramp_shorter_than_period"].startswith(
            "A ramp of 0.034 s is shorter than a period of 0.0348528 s of the load’s natural frequency on HPN-20A-"
        )


def test_an_unrated_size_is_announced_with_the_reason(catalogue: Catalogue) -> None:
    reply = answer(cycle(phase(10, 100)), catalogue)

    assert "HPN-40A" in notices(reply)["size_unrated"]
    assert "752 Nm" in notices(reply)["size_unrated"]
    for gear in reply["candidates"]:
        assert (gear["status"] == "unrated") == (gear["size"] == "40A")


def test_of_a_size_that_is_rated_in_part_the_gears_without_ratings_are_named(supplemented: Supplement) -> None:
    titles = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source"
    filled = supplemented(ratings=f"{titles}\n40A,5,752,400,1250,page 12\n40A,3,700,400,1250,page 12\n")

    def text(**requirements: list[int]) -> str | None:
        return notices(answer(cycle(phase(10, 100), requirements=requirements), filled)).get("size_unrated")

    assert (text(ratios=[4, 5, 10]) or "").startswith("HPN-40A-4, HPN-40A-10 are not rated. The rating table")
    assert (text(ratios=[5, 10]) or "").startswith("HPN-40A-10 is not rated. ")
    assert (text(ratios=[10]) or "").startswith("HPN-40A-10 is not rated. ")
    assert text(ratios=[5]) is None


@pytest.mark.parametrize("area", get_args(ApplicationArea))
def test_every_area_of_section_2_4_needs_the_makers_approval(catalogue: Catalogue, area: str) -> None:
    reply = answer(PLAIN | {"application_area": area}, catalogue)

    assert "approval" in notices(reply)["application_area"]
    assert AREAS[area] in notices(reply)["application_area"]


def test_there_are_the_nine_areas_of_section_2_4() -> None:
    assert len(get_args(ApplicationArea)) == len(AREAS) == 9
    assert set(get_args(ApplicationArea)) == set(AREAS)


@pytest.mark.parametrize(("T_k", "below"), [(9.999, True), (10, False), (-10, False), (11, False)])
def test_an_emergency_stop_below_the_largest_torque_is_questioned(
    catalogue: Catalogue, T_k: float, below: bool
) -> None:
    result = codes(PLAIN | {"emergency_stop": {"torque_Nm": T_k}}, catalogue)

    assert ("emergency_stop_below_maximum" in result) == below


def test_an_unlimited_count_is_null_beside_its_notice_and_a_limited_one_is_given(catalogue: Catalogue) -> None:
    free = answer(PLAIN | {"emergency_stop": {"torque_Nm": 30, "count": 5}}, catalogue)
    bound = answer(
        cycle(
            phase(1, 1),
            emergency_stop={"torque_Nm": 300, "count": 5},
            requirements={"sizes": ["20A"], "ratios": [5]},
        ),
        catalogue,
    )

    assert candidate(free, "HPN-20A-5")["momentary_peak_count"] is None
    assert check(free, "HPN-20A-5", "momentary_peak_count")["limit"] is None
    assert check(free, "HPN-20A-5", "momentary_peak_count")["utilisation"] == 0
    assert "momentary_peak_count_unlimited" in notices(free)
    # Above T_M the number is still given: 10^(8.5 - 1.5 * 300 / 149) = 301901.8, rounded down.
    assert candidate(bound, "HPN-20A-5")["momentary_peak_count"] == 301901
    assert "momentary_peak_count_unlimited" not in notices(bound)


def test_a_cycle_without_torque_has_an_unlimited_life_beside_its_notice(catalogue: Catalogue) -> None:
    idle = cycle(phase(0, 100), requirements={"sizes": ["20A"], "life_h": 1e6})

    reply = answer(idle, catalogue)

    assert candidate(reply, "HPN-20A-5")["life_L10_h"] is None
    assert check(reply, "HPN-20A-5", "life")["utilisation"] == 0
    assert check(reply, "HPN-20A-5", "life")["status"] == "pass"
    assert check(reply, "HPN-20A-5", "average_torque")["utilisation"] == 0
    assert "life_unlimited" in notices(reply)
    assert "life_unlimited" not in codes(PLAIN, catalogue)
    # The other checks stand: 100 rpm at ratio 50 is 5000 rpm at the input, above the average of 3000.
    assert check(reply, "HPN-20A-50", "average_input_speed")["status"] == "fail"


def test_bearing_loads_bring_the_standing_of_the_envelope_and_of_its_life(catalogue: Catalogue) -> None:
    reply = answer(PLAIN | {"output_load": {"radial_N": 100}}, catalogue)

    result = notices(reply)
    assert "interpolated between the two published limits" in result["bearing_envelope_computed"]
    assert "printed curve not available" in result["bearing_envelope_computed"]
    assert "centre" in result["bearing_load_position"]
    assert "L50 / 5" in result["bearing_life_basis"]
    assert "5.45" in result["bearing_life_basis"]
    assert not {code for code in codes(PLAIN, catalogue) if code.startswith("bearing")}


def test_a_bearing_without_load_has_an_unlimited_life_beside_its_notice(catalogue: Catalogue) -> None:
    reply = answer(PLAIN | {"output_load": {"radial_N": 0}}, catalogue)

    assert candidate(reply, "HPN-20A-5")["bearing_life_L50_h"] is None
    assert candidate(reply, "HPN-20A-5")["bearing_life_L10_h"] is None
    assert "bearing_life_unlimited" in notices(reply)
    for code in ("output_bearing_load", "output_bearing_life"):
        assert check(reply, "HPN-20A-5", code)["utilisation"] == 0


def test_a_motor_without_a_stated_efficiency_is_a_lower_bound(catalogue: Catalogue) -> None:
    motor = PLAIN["requirements"] | {"motor": {"peak_torque_Nm": 20}}

    assert "lower bound" in notices(answer(PLAIN | {"requirements": motor}, catalogue))["efficiency_unknown"]
    ranked = codes(PLAIN | {"rank_by": "motor_torque"}, catalogue)
    assert ranked == {"efficiency_unknown", "limit_without_efficiency", "motor_torque_partial"}
    stated = PLAIN | {"requirements": motor | {"efficiency": 0.9}}
    assert codes(stated, catalogue) == {"efficiency_assumed", "motor_torque_partial"}


def on_end(*seconds: float, pause_s: float = 0.0, ratio: int = 10, bound_s: float = 300.0) -> str | None:
    """Notice on a cycle of 3500 and 500 rpm at the input in turn, which averages below 3000 rpm."""
    fast, slow = 3500 / ratio, 500 / ratio
    phases = [phase(1, fast if place % 2 == 0 else slow, t) for place, t in enumerate(seconds)]
    question = cycle(*phases, pause_s=pause_s, requirements={"sizes": ["20A"], "ratios": [ratio]})
    return notices(answer(question, load_catalogue(averaging_s=bound_s))).get("speed_above_average")


@pytest.mark.parametrize(
    ("seconds", "pause_s", "has_notice"),
    [
        ((300.0, 300.0), 0.0, False),
        ((300.1, 300.0), 0.0, True),
        ((301.0, 0.001), 100.0, True),
        ((200.0, 200.0, 150.0), 0.0, True),  # the end of the cycle runs into its start
        ((200.0, 200.0, 150.0), 1.0, False),  # a pause parts them
    ],
)
def test_running_on_end_above_the_average_speed_is_told_beyond_the_bound(
    seconds: tuple[float, ...], pause_s: float, has_notice: bool
) -> None:
    assert bool(on_end(*seconds, pause_s=pause_s)) == has_notice


def test_the_notice_on_long_runs_says_how_long_and_that_the_bound_is_ours() -> None:
    text = on_end(60.5, 60.0, bound_s=60.0) or ""
    assert text.startswith("With ratio 10 the input runs above n_av(max) for 60.5 s without a break.")
    assert "beyond 60 s (our assumption, setting HPN_AVERAGING_SECONDS)" in text


def test_splitting_a_long_phase_changes_nothing_about_it() -> None:
    question = cycle(
        phase(1, 350, 200), phase(1, 350, 200), phase(1, 50, 400), requirements={"sizes": ["20A"], "ratios": [10]}
    )
    assert "for 400 s without a break" in notices(answer(question, load_catalogue()))["speed_above_average"]


def test_a_cycle_beside_longer_ones_has_the_same_notice_on_long_runs() -> None:
    document = {"sizes": ["20A"], "ratios": [10]}
    phases = [phase(1, 350, 200), phase(1, 50, 600), phase(1, 350, 200)]
    short, long = (
        Application.model_validate(cycle(*one, requirements=document)) for one in (phases, [*phases, *phases])
    )
    catalogue = load_catalogue()
    selection = judge_batch([short, long], catalogue, Judgement.selection)[0]

    assert isinstance(selection, Selection)
    assert selection.notices == select(short, catalogue).notices
    assert "speed_above_average" in [one.code for one in selection.notices]


def test_models_and_motor_torques_say_what_they_leave_out(catalogue: Catalogue) -> None:
    load = {"output_load": {"radial_N": 10.0, "model": "iso281"}}
    assert "bearing_iso281" in codes(PLAIN | load, catalogue)
    load["output_load"]["model"] = "linear"
    assert "bearing_iso281" not in codes(PLAIN | load, catalogue)
    assert "motor_torque_partial" in codes(PLAIN | {"rank_by": "motor_torque"}, catalogue)
    assert "motor_torque_partial" not in codes(PLAIN, catalogue)


@pytest.mark.parametrize(
    ("load", "has_notice"),
    [
        ({"radial_N": 1500}, True),
        ({"radial_N": 1500, "life_h": 40000}, False),
        ({"radial_N": 1500, "life_basis": "L10"}, False),
        (None, False),
    ],
)
def test_a_life_asked_of_the_gear_alone_says_for_which_life_its_bearing_is_judged(
    catalogue: Catalogue, load: Json | None, has_notice: bool
) -> None:
    """HPN-20A-5 lasts 40000 h as asked, and its bearing 34600 h as L50, which is more than the default of 20000 h."""
    parts = {"output_load": load} if load else {}
    long = cycle(phase(25, 150, 2), pause_s=1, requirements={"life_h": 40000}, **parts)

    text = notices(answer(long, catalogue)).get("bearing_life_at_default", "")

    assert ("40000 h (L10)" in text, "20000 h (L50)" in text) == (has_notice, has_notice)


@pytest.mark.parametrize(("stop", "has_notice"), [({"torque_Nm": 200}, True), ({"torque_Nm": 200, "count": 9}, False)])
def test_stops_without_their_number_say_that_it_is_not_judged(
    catalogue: Catalogue, stop: Json, has_notice: bool
) -> None:
    assert ("stops_not_counted" in codes(PLAIN | {"emergency_stop": stop}, catalogue)) == has_notice


@pytest.mark.parametrize(
    ("own", "whole", "has_notice"),
    [
        ((620, 310), 900, True),
        ((620, None), 900, False),
        ((None, None), 900, False),
        ((900, 900), 900, False),
        ((620, 310), None, False),
    ],
)
@pytest.mark.parametrize("direction", ["radial", "axial"])
def test_a_load_of_the_cycle_that_counts_in_no_phase_is_said_not_to_be_used(
    catalogue: Catalogue, direction: str, own: tuple[float | None, ...], whole: float | None, has_notice: bool
) -> None:
    name = f"{direction}_N"
    phases = [phase(10, 100) | ({name: load} if load else {}) for load in own]
    document = cycle(*phases) | ({"output_load": {name: whole}} if whole else {})

    text = notices(answer(document, catalogue)).get(f"{direction}_load_not_used", "")

    assert (f"The {direction} load of the whole cycle, 900 N, is not used" in text) == has_notice
