"""Torque curves of motors: what an application takes of them, and the motor judged along them."""

import math
import random
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from hpn.application import Application, CurvePoint, MotorEntry
from hpn.application.faults import faults_of
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.pairs import table_of
from hpn.engine.remedy import remedy_of
from hpn.engine.selection import select
from hpn.engine.tried import needed_of, tried
from hpn.links.writer import to_link
from hpn.web.form.form import for_reader
from hpn.web.form.link_reader import parse
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, Json, answer, candidate, check, cycle, notices, phase
from tests.property.draw import motions
from tests.property.motors import curve_at_random
from tests.reference.test_motion import CONTRACT, PENDULUM, SCREW, VISCOUS
from tests.unit.test_pairs import sampled

CATALOGUE = load_catalogue()
POINTS = [
    {"speed_rpm": 0.0, "continuous_Nm": 2.8, "peak_Nm": 7.2},
    {"speed_rpm": 3000.0, "continuous_Nm": 2.4, "peak_Nm": 7.2},
    {"speed_rpm": 6000.0, "continuous_Nm": 1.5, "peak_Nm": 3.0},
]
STILL = phase(0, 0, 0.5)
PEAK = "motor_peak_torque"


def with_curve(duty: Json, points: list[Json] = POINTS, **motor: Any) -> Json:
    requirements = {"sizes": ["20A"], "ratios": [10], "motor": {"curve": points, **motor}}
    return duty | {"requirements": requirements}


# --- What an application takes ----------------------------------------------------------------------------------------


def changed(place: int, **values: float) -> list[Json]:
    return [point | values if k == place else point for k, point in enumerate(POINTS)]


@pytest.mark.parametrize(
    ("motor", "pointer", "text"),
    [
        ({"curve": POINTS[:1]}, ("curve",), "at least 2"),
        ({"curve": [{**POINTS[0], "speed_rpm": float(k)} for k in range(51)]}, ("curve",), "at most 50"),
        ({"curve": changed(0, speed_rpm=1.0)}, ("curve", 0, "speed_rpm"), "must be 0"),
        ({"curve": changed(2, speed_rpm=3000.0)}, ("curve", 2, "speed_rpm"), "above the speed of the point before"),
        ({"curve": changed(1, continuous_Nm=0.0)}, ("curve", 1, "continuous_Nm"), "greater than 0"),
        ({"curve": changed(1, peak_Nm=-1.0)}, ("curve", 1, "peak_Nm"), "greater than 0"),
        ({"curve": changed(2, continuous_Nm=3.1)}, ("curve", 2, "continuous_Nm"), "above the peak torque"),
        ({"curve": POINTS, "stall_torque_Nm": 2.7}, ("curve", 0, "continuous_Nm"), "above stall_torque_Nm"),
        ({"curve": [POINTS[0], {"speed_rpm": 9.0}]}, ("curve", 1, "continuous_Nm"), "required"),
        ({"curve": changed(1, speed=1.0)}, ("curve", 1, "speed"), "it looks like speed_rpm"),
        ({"curve": "0:1:2"}, ("curve",), "list"),
        ({"name": "x" * 41}, ("name",), "40"),
        ({"weight_kg": 0.0}, ("weight_kg",), "greater than 0"),
        ({"curve": POINTS, "designation": "M 40"}, ("designation",), "not both"),
        ({"stall_torque_Nm": 2.0, "designation": "M 40"}, ("designation",), "not both"),
    ],
)
def test_what_is_wrong_with_a_motor_is_said_at_its_place(
    motor: Json, pointer: tuple[str | int, ...], text: str
) -> None:
    with pytest.raises(ValidationError) as refusal:
        Application.model_validate(cycle(phase(5, 50), requirements={"motor": motor}))
    first = faults_of(refusal.value)[0]

    assert first.location == ("requirements", "motor", *pointer)
    assert text in first.text


def test_a_continuous_torque_as_large_as_that_at_standstill_and_the_peak_is_taken() -> None:
    points = [{"speed_rpm": 0.0, "continuous_Nm": 2.8, "peak_Nm": 2.8}, POINTS[1] | {"continuous_Nm": 2.8}]
    motor = {"curve": points, "stall_torque_Nm": 2.8}
    asked = Application.model_validate(cycle(phase(5, 50), requirements={"motor": motor}))

    assert asked.requirements.motor is not None
    assert asked.requirements.motor.curve == tuple(CurvePoint(**point) for point in points)


def query(text: str) -> list[tuple[str, str]]:
    return [(name, value) for pair in text.split("&") for name, _, value in [pair.partition("=")]]


def test_a_link_has_the_points_of_a_curve_and_comes_back_as_the_same_application() -> None:
    motor = {"curve": POINTS, "stall_torque_Nm": 2.8, "weight_kg": 2.1, "name": "S60 blue"}
    asked = Application.model_validate(cycle(phase(40, 250, 0.3), requirements={"motor": motor}))
    link = to_link(asked)

    points = "mcv=0:2.8:7.2&mcv=3000:2.4:7.2&mcv=6000:1.5:3"
    assert link == f"/?T=40&n=250&t=0.3&Tst=2.8&mmo=2.1&{points}&mnm=S60%20blue"
    form = parse(query(link.removeprefix("/?").replace("%20", " ")))
    assert not form.problems
    assert form.application == asked
    alone = parse(query("T=40&n=250&t=0.3&mcv=0:2.8:7.2;3000:2.4:7.2&mcv=6000:1.5:3&Tst=2.8&mmo=2.1&mnm=S60 blue"))
    assert alone.application == asked


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mcv=0:2,8:7", "point 1: write 2.8"),
        ("mcv=0:2.8:7;100:1:a", "point 2: is not a number"),
        ("mcv=0:2.8", "point 1: give speed, continuous and peak torque"),
        ("mcv=0:2:7:8", "point 1: give speed, continuous and peak torque"),
        ("mcv=0:2.8:7&mcv=0:1:2", "point 2: must be above the speed of the point before"),
        ("mcv=0:2.8:7", "must have at least 2 values"),
        ("mcv=" + ";".join(f"{k}:1:2" for k in range(60)), "must have at most 50 values"),
        ("mcv=0:2:7;7:2:7&Tst=1", "point 1: must not be above “Torque at standstill”"),
        ("mnm=" + "x" * 41, "must have at most 40 characters"),
    ],
)
def test_what_is_wrong_with_a_link_is_said_beside_the_field(text: str, words: str) -> None:
    form = parse(query(f"T=40&n=250&t=1&{text}"))

    assert form.application is None
    assert form.problems[0].name == text.partition("=")[0]
    assert form.problems[0].index is None
    assert form.problems[0].message.text.startswith(words)


def test_a_form_takes_a_line_per_point_in_the_readers_own_notation() -> None:
    form = parse(query("written=de&T=40&n=250&t=1&mcv=0 : 2,8 : 7\r\n\r\n3000 : 1,5 : 2\r\n"))

    assert form.application is not None
    assert form.application.requirements.motor is not None
    curve = form.application.requirements.motor.curve or ()
    assert [(point.speed_rpm, point.continuous_Nm, point.peak_Nm) for point in curve] == [(0, 2.8, 7), (3000, 1.5, 2)]
    assert for_reader(form, Reader("de")).texts["mcv"] == "0 : 2,8 : 7\n3000 : 1,5 : 2"
    assert for_reader(form, Reader("en")).texts["mcv"] == "0 : 2.8 : 7\n3000 : 1.5 : 2"


# --- Typed phases -----------------------------------------------------------------------------------------------------


def test_typed_phases_are_judged_along_the_curve_by_hand(catalogue: Catalogue) -> None:
    """i = 10, lossless: 40 Nm at 100 rpm up to 450 rpm, 10 Nm at 300 rpm, 1 s of pause.

    Peak: 4 Nm against the least up to 4500 rpm, 7.2 − 4.2 / 2 = 5.1; 1 Nm at 3000 rpm is far below 7.2. M_c is 2.8 −
    0.4 / 3 = 2.6667 at 1000 rpm, 2.4 at 3000 rpm and 2.8 at rest.
    """
    duty = cycle(phase(40, 100, 0.3, peak_speed_rpm=450), phase(10, 300, 0.5), pause_s=1)
    reply = answer(with_curve(duty), catalogue)
    gear = candidate(reply, "HPN-20A-10")

    peak = check(reply, "HPN-20A-10", "motor_peak_torque")
    assert (peak["demand"], peak["limit"]) == (pytest.approx(4, rel=1e-12), pytest.approx(5.1, rel=1e-12))
    at_1000 = 2.8 - 0.4 / 3
    balance = math.sqrt((at_1000**2 * 0.3 + 2.4**2 * 0.5 + 2.8**2) / 1.8)
    rms = math.sqrt((4**2 * 0.3 + 1**2 * 0.5) / 1.8)
    makers = 2.8 - 0.4 / 3000 * (100 * 0.3 + 300 * 0.5) / 1.8 * 10
    assert gear["motor_thermal_torque_Nm"] == pytest.approx(balance, rel=1e-12)
    assert gear["motor_mean_speed_torque_Nm"] == pytest.approx(makers, rel=1e-12)
    thermal = check(reply, "HPN-20A-10", "motor_rated_torque")
    assert thermal["demand"] == pytest.approx(rms, rel=1e-12)
    assert thermal["limit"] == pytest.approx(min(balance, makers), rel=1e-12)
    assert thermal["utilisation"] == pytest.approx(rms / min(balance, makers), rel=1e-12)
    speed = check(reply, "HPN-20A-10", "motor_speed")
    assert (speed["demand"], speed["limit"]) == (pytest.approx(4500), 6000)
    assert gear["reserve"]["speed_factor"] is None  # no power of the speed
    assert gear["reserve"]["torque_factor"] is not None


def test_the_worse_of_both_rules_is_judged(catalogue: Catalogue) -> None:
    """A curve that sags: half the time at full speed, half at rest. By losses (1² + 0.2²)/2, at the mean speed 0.9."""
    points = [
        {"speed_rpm": 0.0, "continuous_Nm": 1.0, "peak_Nm": 9.0},
        {"speed_rpm": 1000.0, "continuous_Nm": 0.9, "peak_Nm": 9.0},
        {"speed_rpm": 2000.0, "continuous_Nm": 0.2, "peak_Nm": 9.0},
    ]
    reply = answer(with_curve(cycle(phase(3, 200, 0.5), STILL), points), catalogue)
    gear, thermal = candidate(reply, "HPN-20A-10"), check(reply, "HPN-20A-10", "motor_rated_torque")

    assert gear["motor_thermal_torque_Nm"] == pytest.approx(math.sqrt((0.2**2 + 1) / 2), rel=1e-12)
    assert gear["motor_mean_speed_torque_Nm"] == pytest.approx(0.9, rel=1e-12)
    assert thermal["limit"] == gear["motor_thermal_torque_Nm"]
    straight = [points[0], points[2]]
    reply = answer(with_curve(cycle(phase(3, 200, 0.5), STILL), straight), catalogue)
    assert candidate(reply, "HPN-20A-10")["motor_mean_speed_torque_Nm"] == pytest.approx(0.6, rel=1e-12)
    assert check(reply, "HPN-20A-10", "motor_rated_torque")["limit"] == pytest.approx(0.6, rel=1e-12)


def test_beyond_its_last_speed_a_curve_says_nothing_and_the_speed_fails(catalogue: Catalogue) -> None:
    duty = cycle(phase(5, 601, 1), pause_s=1)
    reply = answer(with_curve(duty, maximum_speed_rpm=9000.0), catalogue)
    at_end = answer(with_curve(cycle(phase(5, 600, 1))), catalogue)

    assert {one["code"]: one["status"] for one in candidate(reply, "HPN-20A-10")["checks"]} | {
        "motor_speed": "fail",
        "motor_peak_torque": "not_rated",
        "motor_rated_torque": "not_rated",
    } == {one["code"]: one["status"] for one in candidate(reply, "HPN-20A-10")["checks"]}
    assert check(reply, "HPN-20A-10", "motor_speed")["limit"] == 6000
    assert candidate(reply, "HPN-20A-10")["motor_thermal_torque_Nm"] is None
    assert check(at_end, "HPN-20A-10", "motor_speed")["utilisation"] == pytest.approx(1, rel=1e-12)
    assert check(at_end, "HPN-20A-10", "motor_rated_torque")["limit"] == pytest.approx(1.5, rel=1e-12)
    slower = answer(with_curve(cycle(phase(5, 500, 1)), maximum_speed_rpm=5500.0), catalogue)
    assert check(slower, "HPN-20A-10", "motor_speed")["limit"] == 5500


@pytest.mark.parametrize("near", [5e-324, 1e-300, 1e-9])
def test_of_points_next_to_one_another_each_counts_at_its_speed(catalogue: Catalogue, near: float) -> None:
    """At rest the first, 7.2 Nm; above it the second falls from 6 Nm to 3 at 6000 rpm: 5.5 at 1000 rpm."""
    second = {"speed_rpm": near, "continuous_Nm": 2.0, "peak_Nm": 6.0}
    for speed, limit in ((0.0, 7.2), (100.0, 5.5)):
        duty = cycle(phase(50, speed, 1), phase(0, 1, 1))
        peak = check(answer(with_curve(duty, [POINTS[0], second, POINTS[2]]), catalogue), "HPN-20A-10", PEAK)
        assert (peak["demand"], peak["limit"]) == (pytest.approx(5, rel=1e-12), pytest.approx(limit, rel=1e-9))


def test_beside_a_curve_rated_figures_are_not_judged_and_without_one_nothing_changes(catalogue: Catalogue) -> None:
    rated: Json = {"rated_torque_Nm": 0.01, "rated_speed_rpm": 1.0, "peak_torque_Nm": 0.01}
    duty = cycle(phase(5, 100, 1))
    beside = answer(with_curve(duty, **rated), catalogue)
    without = answer(duty | {"requirements": {"motor": rated | {"stall_torque_Nm": 9.0, "weight_kg": 3.0}}}, catalogue)

    codes = [one["code"] for one in candidate(beside, "HPN-20A-10")["checks"]]
    assert "motor_rated_speed" not in codes
    assert check(beside, "HPN-20A-10", "motor_peak_torque")["status"] == "pass"
    assert check(without, "HPN-20A-10", "motor_rated_torque")["limit"] == 0.01
    assert check(without, "HPN-20A-10", "motor_rated_speed")["limit"] == 1.0
    assert candidate(without, "HPN-20A-10")["motor_thermal_torque_Nm"] is None
    assert "motor_torque_partial" in notices(beside)


def test_a_motor_that_is_judged_without_its_rotor_says_so(catalogue: Catalogue) -> None:
    """Of typed phases, which have no acceleration, and of a motion without the motor's inertia; not without a curve."""
    moving: Json = {"duty_cycle": {"motion": TURNING}}
    code, J_m = "rotor_not_included", 2e-4
    for duty in (cycle(phase(5, 100, 1)), moving):
        assert code in notices(answer(with_curve(duty), catalogue))
        assert code not in notices(answer(duty | {"requirements": {"motor": {"peak_torque_Nm": 9.0}}}, catalogue))
    assert code in notices(answer(with_curve(cycle(phase(5, 100, 1)), inertia_kgm2=J_m), catalogue))
    assert code not in notices(answer(with_curve(moving, inertia_kgm2=J_m), catalogue))


def test_over_tolerances_nothing_is_proved_along_a_curve(catalogue: Catalogue) -> None:
    duty = with_curve(cycle(phase(30, 300, 1), pause_s=1)) | {"tolerances": {"speed_rpm": {"percent": 20}}}
    reply = answer(duty, catalogue)
    thermal = check(reply, "HPN-20A-10", "motor_rated_torque")

    assert thermal["exact"] is False
    assert thermal["worst"] > thermal["utilisation"]
    faster = answer(with_curve(cycle(phase(30, 360, 1), pause_s=1)), catalogue)
    assert thermal["worst"] == pytest.approx(
        check(faster, "HPN-20A-10", "motor_rated_torque")["utilisation"], rel=1e-12
    )


def test_over_tolerances_along_a_curve_all_inputs_count_at_their_worse_ends_together(catalogue: Catalogue) -> None:
    """The RMS rises with each torque and M_c falls with each speed: all upper ends together, which no sample is near.

    A gear by itself has the same worst case as among all others.
    """
    cycles = [
        cycle(*(phase(T * k, n * k, 1) for T, n in ((30, 300), (20, 200), (10, 400))), pause_s=1) for k in (1, 1.1)
    ]
    tolerances: Json = {"torque_Nm": {"percent": 10}, "speed_rpm": {"percent": 10}}
    alone = with_curve(cycles[0]) | {"tolerances": tolerances}
    among = alone | {"requirements": {"motor": alone["requirements"]["motor"]}}
    reply, corner = answer(among, catalogue), answer(with_curve(cycles[1]), catalogue)

    for code in (PEAK, "motor_rated_torque"):
        worst = check(reply, "HPN-20A-10", code)
        assert worst["exact"] is False
        assert worst["worst"] >= check(corner, "HPN-20A-10", code)["utilisation"] * (1 - 1e-12)
        assert check(answer(alone, catalogue), "HPN-20A-10", code)["worst"] == pytest.approx(worst["worst"], rel=1e-12)


def test_a_remedy_that_is_offered_along_a_curve_passes(catalogue: Catalogue) -> None:
    """The torques that it names are tried."""
    asked = Application.model_validate(with_curve(cycle(phase(60, 300, 1), pause_s=0.2)))
    reply = select(asked, catalogue)
    gear = reply.candidates[0]
    assert gear.status == "unsuitable"
    factor = gear.reserve.torque_factor
    assert factor is not None
    lighter = select(Application.model_validate(with_curve(cycle(phase(60 * factor, 300, 1), pause_s=0.2))), catalogue)
    assert lighter.candidates[0].status == "suitable"


def remedies(asked: Application, catalogue: Catalogue) -> tuple[str, Sequence[str]]:
    """Remedy of the only gear in words, and its verdict with each alternative as printed."""
    [gear] = select(asked, catalogue).candidates
    alternatives = needed_of(gear, asked, catalogue)
    verdicts = [select(tried(asked, one, catalogue), catalogue).candidates[0].status for one in alternatives]
    words = remedy_of(gear, alternatives)
    return words.text if words else "", verdicts


@pytest.mark.parametrize(
    ("duty", "motor", "words"),
    [
        (cycle(phase(5, 700, 1), pause_s=1), {}, "Fits if speeds drop to 85.7 %."),  # 7000 to 6000 rpm
        (cycle(phase(5, 700, 1), pause_s=1), {"maximum_speed_rpm": 5000.0}, "Fits if speeds drop to 71.4 %."),
        # at 85.7 % of 7000 rpm the motor's peak is a little above 3.0 Nm: 30 of 60 Nm at the gear
        (cycle(phase(60, 700, 0.1), pause_s=9), {}, "Fits if torques drop to 50 % and speeds to 85.7 %."),
    ],
)
def test_a_motor_faster_than_its_curve_fits_at_the_speed_at_which_the_curve_ends(
    catalogue: Catalogue, duty: Json, motor: Json, words: str
) -> None:
    said, verdicts = remedies(Application.model_validate(with_curve(duty, **motor)), catalogue)
    assert said == words
    assert verdicts == ["suitable"]


def test_a_rotor_that_takes_part_beyond_its_curve_is_told_the_least_change_and_promised_nothing(
    catalogue: Catalogue,
) -> None:
    """The motion's fastest move turns the input at 250 rpm; slower phases would leave the rotor out."""
    moving: Json = {"duty_cycle": {"motion": TURNING, "pause_s": 1}}
    points = [POINTS[0], POINTS[1] | {"speed_rpm": 200.0}]
    for motor, promised in (({}, True), ({"inertia_kgm2": 1e-5}, False)):
        said, verdicts = remedies(Application.model_validate(with_curve(moving, points, **motor)), catalogue)
        assert verdicts == ["suitable"] * promised
        start = "Fits if speeds drop to " if promised else "At least, speeds must drop to "
        assert said.startswith(start), said
        assert said.endswith("the motor’s torque is known up to 200 rpm.") is not promised


# --- Motions ----------------------------------------------------------------------------------------------------------


def entry(chance: random.Random, number: int, fastest_rpm: float) -> MotorEntry:
    """A motor with a curve that at times ends below the fastest gear; the inertia of the first is not known."""
    figures: Json = {
        "inertia_kgm2": 10 ** chance.uniform(-5, -2),
        "curve": curve_at_random(chance, fastest_rpm * chance.uniform(0.8, 2)),
    }
    if not number:
        del figures["inertia_kgm2"]
    return MotorEntry.model_validate({"designation": f"M {number}", **figures})


def interpolated(points: tuple[CurvePoint, ...], name: str, speed: Any) -> Any:
    return np.interp(speed, [p.speed_rpm for p in points], [getattr(p, name) for p in points])


ETA, PAUSE = 0.85, 0.7


def check_by_samples(given_: Json, seed: int) -> None:
    """Balance of losses ∫M² + ∫(M₀² − M_c²) against M₀² T, by a direct sum over instants, and the nearest instant."""
    chance = random.Random(seed)
    step, T, omega, alpha = sampled(given_)
    output = np.abs(omega) * 30 / math.pi
    some = [entry(chance, number, 20 * output.max()) for number in range(4)]
    asked = {"duty_cycle": {"motion": given_, "pause_s": PAUSE}, "requirements": {"efficiency": ETA, "sizes": ["20A"]}}
    table = table_of(Application.model_validate(asked), some, CATALOGUE)
    time = step.sum() + PAUSE
    for row, motor in enumerate(some):
        for column, gear in enumerate(table.gears.rows):
            i, J, points = gear.ratio, motor.inertia_kgm2, motor.curve or ()
            if i * output.max() > points[-1].speed_rpm * 0.99:
                continue  # beyond the curve, or too near to be told by samples
            M = T / ETA / i if J is None else np.where(T * omega >= 0, T / ETA, T * ETA) / i + J * i * alpha
            M_c, M_p = (interpolated(points, name, i * output) for name in ("continuous_Nm", "peak_Nm"))
            M_0 = points[0].continuous_Nm
            heat = float((M**2 * step).sum() + ((M_0**2 - M_c**2) * step).sum()) / (M_0**2 * time)
            mean_speed = i * float((output * step).sum()) / time
            rms = math.sqrt(float((M**2 * step).sum()) / time)
            balance = rms / math.sqrt(float((M_c**2 * step).sum() + M_0**2 * PAUSE) / time)
            makers = rms / float(interpolated(points, "continuous_Nm", mean_speed))
            # the steps of a phase leave up to 1 % of a smooth square
            assert table.thermal[row, column] == pytest.approx(max(balance, makers), rel=1e-2, abs=1e-9)
            if table.thermal[row, column] < 0.98:  # what is judged to pass never gains more heat than S1 loses
                assert heat < 1
            nearest = float((np.abs(M) / M_p).max())
            assert table.peak[row, column] >= nearest * (1 - 1e-9)
            # between two of 60 steps the peak falls by half of a tenth at most
            assert table.peak[row, column] == pytest.approx(nearest, rel=0.1, abs=1e-9)


@given(motions(), st.integers(0, 2**32))
def test_thermal_load_and_peak_along_a_curve_are_those_of_the_motions_instants(given_: Json, seed: int) -> None:
    check_by_samples(given_, seed)


@pytest.mark.parametrize("given_", [CONTRACT, PENDULUM, SCREW, VISCOUS, TURNING, LIFTING])
def test_thermal_load_and_peak_of_known_motions_are_those_of_their_instants(given_: Json) -> None:
    check_by_samples(given_, 51)


@pytest.mark.parametrize("rotor", [True, False])
def test_the_nearest_point_between_two_instants_is_found(rotor: bool) -> None:
    """M of a triangle is constant while it speeds up, against a peak that falls from 7.2 by 1.4e-3 per rpm.

    The largest share is at the fastest instant: 500 rpm at the gear, 5000 rpm at the motor.
    """
    table = {"type": "rotary", "inertia_kgm2": 0.1}
    time, top = 0.5, 500.0
    angle = top * 6 * time / 2
    moves = [{"profile": "triangular", "angle_deg": angle, "time_s": time, "external_torque_Nm": 20.0}]
    duty = {"duty_cycle": {"motion": {"mechanism": table, "moves": moves}}}
    own: Json = {"inertia_kgm2": 1e-4} if rotor else {}
    reply = answer(with_curve(duty, **own), CATALOGUE)

    alpha = top * math.pi / 30 / (time / 2)
    demand = (20 + 0.1 * alpha) / 10 + (1e-4 * 10 * alpha if rotor else 0.0)
    peak = check(reply, "HPN-20A-10", "motor_peak_torque")
    assert peak["demand"] == pytest.approx(demand, rel=1e-12)
    assert peak["limit"] == pytest.approx(7.2 - 4.2 * 2 / 3, rel=1e-9)


def test_without_its_inertia_a_motor_is_judged_along_the_motion_by_hand() -> None:
    """An S-curve has its largest torque at half its speed, where the motor's peak is larger than at all of it.

    i = 10: 6000° in 3 s, of which each ramp takes 1 s, are 3000°/s or 5000 rpm at the motor, and 6000°/s² in the middle
    of a ramp: 0.5 kg m² take 5.24 Nm, against 7.2 Nm up to 3000 rpm. Against the 4.4 Nm of 5000 rpm it would fail.
    """
    moves = [{"profile": "s_curve", "angle_deg": 6000, "time_s": 3, "jerk_share": 1}]
    duty = {"duty_cycle": {"motion": {"mechanism": {"type": "rotary", "inertia_kgm2": 0.5}, "moves": moves}}}
    reply = answer(with_curve(duty), CATALOGUE)

    peak, by_hand = check(reply, "HPN-20A-10", "motor_peak_torque"), 0.5 * math.radians(6000) / 10
    assert (peak["demand"], peak["limit"]) == (pytest.approx(by_hand, rel=1e-12), pytest.approx(7.2, rel=1e-12))
    assert "rotor_not_included" in notices(reply)


@settings(max_examples=25, deadline=None)
@given(motions(), st.integers(0, 2**32))
def test_a_flat_curve_is_a_peak_torque_where_the_inertia_is_not_known(given_: Json, seed: int) -> None:
    """Along the motion with a peak of one torque at all speeds: as judged by that torque alone, without a curve."""
    M, moved = 10 ** random.Random(seed).uniform(-1, 2), {"duty_cycle": {"motion": given_}}
    points = [{"speed_rpm": speed, "continuous_Nm": M / 3, "peak_Nm": M} for speed in (0.0, 1e5)]
    flat = with_curve(moved, points)
    stated = moved | {"requirements": flat["requirements"] | {"motor": {"peak_torque_Nm": M}, "efficiency": ETA}}
    flat["requirements"]["efficiency"] = ETA
    by_curve, by_torque = (check(answer(one, CATALOGUE), "HPN-20A-10", "motor_peak_torque") for one in (flat, stated))

    assert by_curve["status"] in (by_torque["status"], "not_rated")
    if by_curve["status"] != "not_rated":  # as beyond the last speed
        assert by_curve["utilisation"] == pytest.approx(by_torque["utilisation"], rel=1e-12)
