"""Pairs of gear and motor: against `select` with each motor, an independent program, and the motion's samples."""

import itertools
import math
import random
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient

from hpn.application import Application, InputError, MotorEntry, Pairing
from hpn.catalogue import Catalogue, load_catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.motors import with_figures
from hpn.engine.notice import notice
from hpn.engine.pairs import Pairs, pairs_of, table_of
from hpn.engine.selection import Selection, select
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import LIFTING, TURNING, Json, candidate, check, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.property.draw import at_random, motions
from tests.property.motors import motors
from tests.reference import contract, motion
from tests.reference.contract_gears import printed_gears
from tests.reference.test_motion import CONTRACT, PENDULUM, SCREW, VISCOUS
from tests.unit.test_fitting_motors import CURVE, HEADER, OWN

CATALOGUE = load_catalogue()
CLOSE = 1e-12  # one engine either way: a last bit of its own in each of a few steps
BRAKE = {"brake": {"torque_Nm": 8, "rise_time_s": 0.02, "load_torque_Nm": 5}, "count": 100}


def paired(application: Json, some: list[MotorEntry], catalogue: Catalogue = CATALOGUE, **more: Any) -> Pairs:
    """All pairs of an application, or as many as are asked for."""
    failing = more.pop("failing", False)
    wanted = Pairing.model_validate({"application": application, "motors": some, "top": 1000} | more)
    return pairs_of(wanted, some, catalogue, lambda equipped, gear: None, failing=failing)


# --- One engine -------------------------------------------------------------------------------------------------------

APPLICATIONS: dict[str, Json] = {
    "typed": worked_example(requirements={"load_inertia_kgm2": 0.5, "utilisation": 0.8, "efficiency": 0.9}),
    "ratio": worked_example(requirements={"load_inertia_kgm2": 0.05, "motor": {"inertia_ratio": 5}}),
    "loaded": cycle(
        phase(20, 100), output_load={"radial_N": 300, "radial_position_mm": 40}, requirements={"life_h": 20000}
    ),
    "braked": cycle(phase(20, 100), emergency_stop=BRAKE, requirements={"load_inertia_kgm2": 0.2}),
    "turning": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {"motor": {"inertia_ratio": 60}}},
    "lifting": {"duty_cycle": {"motion": LIFTING}, "emergency_stop": BRAKE | {"brake": {"torque_Nm": 8}}},
}


@pytest.mark.parametrize("own", [{}, {"gears": OWN, "efficiency": CURVE}], ids=["", "own figures"])
@pytest.mark.parametrize("application", APPLICATIONS.values(), ids=APPLICATIONS)
def test_a_pair_is_judged_as_the_selection_with_that_motor(
    supplemented: Supplement, application: Json, own: dict[str, str]
) -> None:
    catalogue, some = supplemented(**own) if own else CATALOGUE, motors(random.Random(51), 12, curved=True)
    asked = Pairing.model_validate({"application": application, "motors": some}).application
    table = table_of(asked, some, catalogue)
    found = paired(application, some, catalogue).pairs + paired(application, some, catalogue, failing=True).pairs
    assert len(found) == table.verdict.size == 12 * len(table.gears.rows)

    replies: dict[str, Selection] = {}
    for pair in found:
        motor = some[int(pair.motor.split()[1])]
        if motor.inertia_kgm2 is None and asked.requirements.motor is not None:
            assert pair.status != "suitable"  # which `select` refuses
            continue
        if pair.motor not in replies:
            replies[pair.motor] = select(with_figures(asked, motor), catalogue)
        gear = replies[pair.motor].candidate(pair.designation)
        assert gear is not None
        assert (pair.status, pair.governing_check) == (gear.status, gear.governing_check)
        thermal = gear.check("motor_rated_torque")
        for figure, expected in (
            (pair.utilisation, gear.utilisation),
            (pair.thermal, thermal and thermal.utilisation),
            (pair.drive_resonance_Hz, gear.drive_resonance_Hz),
            (pair.motor_torque_limit_Nm, gear.motor_torque_limit_Nm),
        ):
            assert figure == (None if expected is None else pytest.approx(expected, rel=CLOSE)), (pair, expected)


# --- An independent program -------------------------------------------------------------------------------------------

OF_MOTOR = ("motor_speed", "motor_peak_torque", "motor_rated_torque", "motor_rated_speed")


def searched(application: Json, some: list[MotorEntry]) -> list[tuple[Any, ...]]:
    """Every pair by the tests' own program: status, gear, motor, utilisation, governing check, weight, of the motor."""
    found = []
    for motor in some:
        figures = motor.model_dump(exclude={"designation", "weight_kg"}, exclude_none=True)
        for one in contract.answer(with_wishes(application, motor=figures), printed_gears()).candidates:
            own = [each.utilisation for each in one.checks if each.code in OF_MOTOR and each.utilisation is not None]
            weight = None if one.gear.weight is None or not motor.weight_kg else one.gear.weight + motor.weight_kg
            row = (one.status, one.gear.name, motor.designation, one.utilisation, one.governing, weight)
            found.append((*row, max(own, default=None)))
    return found


def test_pairs_are_those_that_an_exhaustive_search_finds_in_its_order(soak: bool) -> None:
    """Over all gears, typed phases: the reference shares no code with the engine. Long: a thousand motors."""
    chance, suitable = random.Random(51), 0
    drawn = (at_random(chance) for _ in itertools.count())
    bare = (with_wishes(one, motor=None) for one in drawn)
    found_some = (one for one in bare if contract.answer(one, printed_gears()).selected)
    for application in itertools.islice(found_some, 4 if soak else 10):
        some = motors(chance, 1000 if soak else 20, curved=True)
        expected = searched(application, some)

        found = paired(application, some)
        best = sorted((one for one in expected if one[0] == "suitable"), key=by_weight)
        suitable += len(best)
        assert [(pair.designation, pair.motor) for pair in found.pairs] == [one[1:3] for one in best][:1000]
        for pair, (_, _, _, used, governing, weight, own) in zip(found.pairs, best, strict=False):
            assert pair.governing_check == governing
            for figure, value in ((pair.utilisation, used), (pair.weight_kg, weight), (pair.motor_utilisation, own)):
                assert figure == (None if value is None else pytest.approx(value, rel=CLOSE))
        assert found.failing == Counter(one[4] for one in expected if one[0] == "unsuitable")
    assert suitable > 100


def with_wishes(application: Json, **wishes: Any) -> Json:
    """The application with other requirements; None is none."""
    asked = application.get("requirements", {}) | wishes
    return application | {"requirements": {name: value for name, value in asked.items() if value is not None}}


def by_weight(one: tuple[Any, ...]) -> tuple[Any, ...]:
    """Weight, utilisation and names; rounded, since the last bit of a sum decides nothing."""
    weight = math.inf if one[5] is None else round(one[5], 9)
    return weight, round(one[3], 12), one[1], one[2]


# --- Motions ----------------------------------------------------------------------------------------------------------

SAMPLES = 60


def sampled(given: Json) -> tuple[Any, Any, Any, Any]:
    """Steps in s, and torque, speed and acceleration at the gear at their middle, from the reference in mpmath."""
    rows = []
    for one in motion.stretches(given):
        step = (one.end - one.start) / SAMPLES
        middles = [one.start + step * (k + 0.5) for k in range(SAMPLES)]
        rows += [[step, one.torque(t), one.speed(t), one.acceleration(t)] for t in middles]
    columns = np.array([[float(value) for value in row] for row in rows]).T
    return columns[0], columns[1], columns[2], columns[3]


def at_motor(
    samples: tuple[Any, Any, Any, Any], ratio: int, eta: float, inertia: float, without_load: float = 0.0
) -> tuple[float, float]:
    """Peak and integral of the square of the torque at the motor, by the contract's words."""
    step, T, omega, alpha = samples
    torque = np.where(T * omega >= 0, T / eta, T * eta) / ratio + inertia * ratio * alpha
    torque = torque + without_load * np.sign(omega)
    return float(np.abs(torque).max()), float((torque**2 * step).sum())


@given(motions(), st.integers(0, 2**32))
def test_thermal_load_and_peak_along_a_motion_are_those_of_its_samples(given_: Json, seed: int) -> None:
    """The direct integral over instants: 60 steps of a phase leave 1 % of a smooth square, and no peak above."""
    check_by_samples(given_, seed)


@pytest.mark.parametrize("given_", [CONTRACT, PENDULUM, SCREW, VISCOUS, TURNING, LIFTING])
def test_thermal_load_and_peak_of_known_motions_are_those_of_their_samples(given_: Json) -> None:
    check_by_samples(given_, 51)


@pytest.mark.parametrize("given_", [CONTRACT, PENDULUM, TURNING, LIFTING])
def test_inertia_and_torque_without_load_of_a_gear_count_at_every_instant(
    supplemented: Supplement, given_: Json
) -> None:
    """Both are at the input: J_g is added to that of the motor, T_0 is against the sense of its turning."""
    catalogue = supplemented(gears=OWN)
    check_by_samples(given_, 51, catalogue, [next(g for g in catalogue.gears if g.designation == "HPN-20A-5")])


def check_by_samples(
    given_: Json, seed: int, catalogue: Catalogue = CATALOGUE, gears: Sequence[Gear] = CATALOGUE.gears[:16]
) -> None:
    chance, eta = random.Random(seed), 0.85
    some = [motor for motor in motors(chance, 6) if motor.inertia_kgm2 and motor.rated_torque_Nm]
    asked = {"duty_cycle": {"motion": given_, "pause_s": 0.7}, "requirements": {"efficiency": eta}}
    table = table_of(Application.model_validate(asked), some, catalogue)
    samples = sampled(given_)
    cycle_s = samples[0].sum() + 0.7
    for row, motor in enumerate(some):
        for gear in gears:
            assert motor.inertia_kgm2 is not None
            column, own = table.gears.rows.index(gear), gear.inertia_kgm2 or 0.0
            without_load = gear.no_load_torque_Nm or 0.0
            peak, square = at_motor(samples, gear.ratio, eta, motor.inertia_kgm2 + own, without_load)
            thermal = math.sqrt(square / cycle_s) / (motor.rated_torque_Nm or math.nan)
            assert table.thermal[row, column] == pytest.approx(thermal, rel=1e-2, abs=1e-9)
            if motor.peak_torque_Nm and motor.maximum_speed_rpm and motor.rated_speed_rpm:
                assert table.of_motor[row, column] >= peak / motor.peak_torque_Nm * (1 - 1e-9)


@pytest.mark.parametrize("given_", [CONTRACT, SCREW, TURNING, LIFTING])
def test_motors_that_no_ratio_can_save_are_those_above_their_rated_torque_at_every_ratio_tried(given_: Json) -> None:
    """20,000 ratios from 0.001 to 10,000: they come within 1e-6 of the least RMS, and below it by the samples alone."""
    some = [motor for motor in motors(random.Random(7), 60, inertia=10) if motor.inertia_kgm2 and motor.rated_torque_Nm]
    asked = {"duty_cycle": {"motion": given_, "pause_s": 0.7}, "requirements": {"efficiency": 0.85}}
    step, T, omega, alpha = sampled(given_)
    at_gear, cycle_s = np.where(T * omega >= 0, T / 0.85, T * 0.85), step.sum() + 0.7
    A, B, C = (float((part * step).sum()) / cycle_s for part in (at_gear**2, at_gear * alpha, alpha**2))
    i = np.geomspace(1e-3, 1e4, 20_000)
    lost, near = set(), set()
    for motor in some:
        J, rated = motor.inertia_kgm2 or 0.0, motor.rated_torque_Nm or 0.0
        least = math.sqrt((A / i**2 + 2 * B * J + C * (i * J) ** 2).min())
        if least > rated:
            lost.add(motor.designation)
        if abs(least / rated - 1) < 1e-2:  # too near to be told by samples
            near.add(motor.designation)

    notices = {notice.code: notice for notice in paired(asked, some).notices}
    named = str(notices["no_ratio_for_motor"].values["names"]).split(", ") if "no_ratio_for_motor" in notices else []
    assert set(named) - near - {"…"} <= lost
    assert "…" in named or lost - near <= set(named)  # the first twenty are named
    assert lost, "a motion that asks nothing of a motor shows nothing"
    rate = float(notices["no_ratio_for_motor"].values["rate_kW_per_s"]) * 1000
    assert rate == pytest.approx(2 * (math.sqrt(A * C) + B), rel=2e-2)


def test_what_a_motor_needs_at_least_is_rounded_up() -> None:
    told = notice("no_ratio_for_motor", names="M", rate_kW_per_s=1.23412)

    assert "M² / J_m of at least 1.235" in told.text


# --- What is asked ----------------------------------------------------------------------------------------------------


def test_the_least_resonance_is_the_last_check(catalogue: Catalogue) -> None:
    """By hand: K3 26000 Nm/rad, 0.2 kg m² and 25 · 0.001 kg m² swing with √(26000 (1/0.2 + 40)) / 2π = 172.2 Hz."""
    application = cycle(phase(5, 50), requirements={"sizes": ["20A"], "ratios": [5], "load_inertia_kgm2": 0.2})
    some = [
        MotorEntry(designation="M", rated_torque_Nm=9, peak_torque_Nm=27, inertia_kgm2=0.001),
        MotorEntry(designation="unknown", rated_torque_Nm=9),
    ]
    by_hand = math.sqrt(26000 * (1 / 0.2 + 1 / 0.025)) / (2 * math.pi)

    [pair] = [one for one in paired(application, some, catalogue, drive_resonance_Hz=by_hand * 0.999).pairs]
    assert pair.drive_resonance_Hz == pytest.approx(by_hand, rel=1e-12)
    assert pair.utilisation is not None
    assert pair.utilisation < 0.5  # a property that passes does not count
    reply = paired(application, some, catalogue, drive_resonance_Hz=by_hand * 1.001, failing=True)
    assert reply.failing == {"drive_resonance": 1}
    fails, unrated = reply.pairs
    assert (fails.rank, fails.governing_check) == (None, "drive_resonance")
    assert fails.utilisation == pytest.approx(1.001, rel=1e-12)
    assert (unrated.status, unrated.governing_check, unrated.utilisation) == ("unrated", None, None)
    assert {"motor_inertia_unknown", "motor_figures_unknown"} <= {notice.code for notice in reply.notices}


@pytest.mark.parametrize(
    ("rank_by", "key"),
    [
        ("utilisation", lambda pair: pair.utilisation),
        ("inertia_ratio", lambda pair: pair.inertia_ratio),
        ("resonance", lambda pair: -pair.drive_resonance_Hz),
        ("weight", lambda pair: pair.weight_kg),
    ],
)
def test_pairs_are_ranked_as_asked_and_the_best_of_each_motor_is_its_first(rank_by: str, key: Any) -> None:
    application, some = APPLICATIONS["typed"], motors(random.Random(3), 30)
    known = [motor for motor in some if motor.inertia_kgm2 and motor.weight_kg]
    every = paired(application, known, rank_by=rank_by).pairs
    assert [pair.rank for pair in every] == list(range(1, len(every) + 1))
    assert [key(pair) for pair in every] == sorted(key(pair) for pair in every)

    best = paired(application, known, rank_by=rank_by, best_of="motor").pairs
    first: dict[str, str] = {}
    for pair in every:
        first.setdefault(pair.motor, pair.designation)
    assert [(pair.motor, pair.designation) for pair in best] == list(first.items())
    assert paired(application, known, rank_by=rank_by, top=3).pairs == every[:3]


def test_what_is_not_known_comes_last(catalogue: Catalogue) -> None:
    application = cycle(phase(5, 50), requirements={"sizes": ["20A"], "ratios": [5], "load_inertia_kgm2": 0.2})
    light, heavy = {"weight_kg": 1.0, "inertia_kgm2": 1e-4}, {"weight_kg": 9.0, "inertia_kgm2": 1e-3}
    some = [
        MotorEntry(designation=name, rated_torque_Nm=9, **figures)
        for name, figures in (("none", {}), ("heavy", heavy), ("light", light))
    ]
    for rank_by, names in (
        ("weight", ["light", "heavy", "none"]),
        ("inertia_ratio", ["heavy", "light", "none"]),
        ("resonance", ["light", "heavy", "none"]),
    ):
        assert [pair.motor for pair in paired(application, some, catalogue, rank_by=rank_by).pairs] == names


def test_pairs_over_tolerances_are_refused(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"over_tolerance": True})
    with pytest.raises(InputError, match="as given"):
        paired(application, motors(random.Random(1), 1), catalogue)


# --- REST -------------------------------------------------------------------------------------------------------------

MOTOR = {"designation": "M 40", "maximum_speed_rpm": 6000, "rated_torque_Nm": 9, "peak_torque_Nm": 27, "weight_kg": 3}


OWN_MOTOR = "/application/requirements/motor"


@pytest.fixture(scope="module")
def api() -> TestClient:
    return TestClient(create_app(Settings()))


def test_a_pair_that_is_taken_opens_as_the_page_and_is_judged_alike(api: TestClient) -> None:
    asked = {"application": worked_example(), "motors": [MOTOR], "top": 1}
    [pair] = api.post("/api/v1/pairs", json=asked).raise_for_status().json()["pairs"]

    assert "&nm=6000&Tm=27&Tmn=9" in pair["link"]
    assert pair["link"].endswith(f"&gear={pair['designation']}")
    assert api.get(pair["link"]).status_code == 200
    equipped = worked_example(requirements={"motor": {k: MOTOR[k] for k in MOTOR if k[-3:] in ("rpm", "_Nm")}})
    reply = api.post("/api/v1/select", json=equipped).json()
    assert candidate(reply, pair["designation"])["utilisation"] == pair["utilisation"]
    assert check(reply, pair["designation"], "motor_rated_torque")["utilisation"] == pair["thermal"]


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"motors": None}, "/motors"),
        ({"list": "server"}, "/motors"),
        ({"motors": []}, "/motors"),
        ({"motors": [MOTOR, MOTOR]}, "/motors/1/designation"),
        ({"motors": [MOTOR | {"rated_torque_Nm": 28}]}, "/motors/0/rated_torque_Nm"),
        ({"motors": [MOTOR | {"rated_torque_Nm": 0}]}, "/motors/0/rated_torque_Nm"),
        ({"motors": [{}]}, "/motors/0/designation"),
        ({"motors": None, "list": "none"}, "/list"),
        ({"motors": None, "list": "server"}, "/list"),
        ({"top": 1001}, "/top"),
        ({"best_of": "gear"}, "/best_of"),
        ({"drive_resonance_Hz": 15}, "/drive_resonance_Hz"),
        ({"application": worked_example(requirements={"motor": {"rated_torque_Nm": 3}})}, OWN_MOTOR),
        ({"application": worked_example(requirements={"motor": {"designation": "M"}})}, OWN_MOTOR),
        (
            {"application": worked_example(requirements={"motor": {"inertia_ratio": 3}})},
            f"{OWN_MOTOR}/inertia_ratio",
        ),
        ({"application": worked_example(requirements={"sizes": ["99A"]})}, "/application/requirements/sizes/0"),
        ({"application": {}}, "/application/duty_cycle"),
    ],
)
def test_what_is_wrong_with_a_request_is_said_at_its_place(api: TestClient, change: Json, pointer: str) -> None:
    reply = api.post("/api/v1/pairs", json={"application": worked_example(), "motors": [MOTOR]} | change)

    assert reply.status_code == 422, reply.text
    assert pointer in [error["pointer"] for error in reply.json()["errors"]], reply.text


def test_the_list_server_is_motors_csv(tmp_path: Path) -> None:
    (tmp_path / "motors.csv").write_text(HEADER + "M 40,6000,3000,9,27,0.001,sheet\n", encoding="utf-8")
    api = TestClient(create_app(Settings(catalogue_supplement=tmp_path)))
    reply = api.post("/api/v1/pairs?failing=1", json={"application": worked_example(), "list": "server"})

    assert {pair["motor"] for pair in reply.raise_for_status().json()["pairs"]} == {"M 40"}
