"""Remedy, reserve and calculation under phases that vary, motions and listed motors."""

import math
import random
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import parse_qsl

from hypothesis import assume, given
from hypothesis import strategies as st

from hpn.application import STOP_LOADS, Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.checks import BY_CODE
from hpn.engine.remedy import alternatives_of, growths_of, remedy_of
from hpn.engine.selection import select
from hpn.engine.tried import needed_of, tried
from hpn.explain.calculation import calculation_of
from hpn.explain.calculation.formula import Formula, Subtraction, value_of
from hpn.links.writer import to_link
from hpn.web.form.link_reader import parse
from tests.build import Json
from tests.property.draw import at_random, motions
from tests.property.test_calculation import NINE_DIGITS, READERS, shown

MOTORS = (
    "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    "M 1,3000,2000,0.5,1.5,0.00002,p\nM 8,6000,3000,8,24,0.0005,p\n"
)


FEW = {"sizes": ["11A", "20A"], "ratios": [5, 20], "utilisation": 0.9, "life_h": 30_000.0}
"""Gears that fail in different ways, as few as they may be."""


def varied(chance: random.Random, asked: Json) -> Json:
    """The application with peaks and RMS in some of its phases."""
    for phase in asked["duty_cycle"]["phases"]:
        T, n = abs(phase["torque_Nm"]), abs(phase["speed_rpm"])
        if chance.random() < 0.6:
            phase["peak_torque_Nm"] = T * chance.choice([1, 1.5, 4])
            phase["rms_torque_Nm"] = chance.uniform(0, phase["peak_torque_Nm"])
            phase["least_torque_Nm"] = min(phase.get("least_torque_Nm", 0.0), phase["rms_torque_Nm"])
        if n and chance.random() < 0.6:
            phase["peak_speed_rpm"] = n * chance.uniform(1, 3)
    return asked


def motored(chance: random.Random, asked: Json, *, moving: bool) -> Json:
    """The application with limits of a motor, stated or by the name of a listed one, and with its inertia."""
    wishes = asked["requirements"] = {**asked.get("requirements", {})}
    for name in ("load_inertia_kgm2", "natural_frequency_Hz"):
        wishes.pop(name, None)
    if asked.get("rank_by") == "natural_frequency":
        del asked["rank_by"]
    listed = {"designation": chance.choice(["M 1", "M 8"])}
    stated = {
        "peak_torque_Nm": chance.uniform(1, 40),
        "rated_torque_Nm": 8,
        "rated_speed_rpm": chance.uniform(500, 3000),
    }
    wishes["motor"] = chance.choice([listed, stated, stated | {"inertia_kgm2": 10 ** chance.uniform(-5, -3)}])
    if "designation" in wishes["motor"] or "inertia_kgm2" in wishes["motor"]:
        wishes["motor"]["inertia_ratio"] = chance.uniform(0.5, 8)
        if not moving:
            wishes["load_inertia_kgm2"] = 10 ** chance.uniform(-3, 0)
    return asked


def moved(chance: random.Random, motion: Json) -> Json:
    """An application of a motion, some of its moves under a load."""
    asked = at_random(chance) | {"requirements": FEW}
    for move in motion["moves"]:
        if chance.random() < 0.4:
            move["radial_N"] = chance.uniform(100, 3000)
    asked["duty_cycle"] = {"motion": motion, "pause_s": asked["duty_cycle"]["pause_s"]}
    for name in STOP_LOADS:  # a motion has its own
        asked.get("emergency_stop", {}).get("brake", {}).pop(name, None)
    asked.get("output_load", {}).pop("drive", None)
    wheel = motion["mechanism"]["type"] in ("rack_and_pinion", "belt") and motion["mechanism"].get("ratio", 1) == 1
    if wheel and chance.random() < 0.5:
        asked["output_load"] = {"shaft_centre_mm": 30.0} | asked.get("output_load", {}) | {"from_motion": True}
    elif "radial_N" not in asked.get("output_load", {}) and not any("radial_N" in move for move in motion["moves"]):
        asked.pop("output_load", None)
    return motored(chance, asked, moving=True) if chance.random() < 0.7 else asked


def followed(asked: Json, catalogue: Catalogue, chance: random.Random) -> Iterator[tuple[Application, Candidate]]:
    """Application that opens with the link to each alternative of some gears, and the gear as it was."""
    application = Application.model_validate(asked)
    rejected = [
        one for one in select(application, catalogue).candidates if one.status == "unsuitable" and one.is_judged
    ]
    for candidate in chance.sample(rejected, min(3, len(rejected))):
        for alternative in needed_of(candidate, application, catalogue):
            query = to_link(tried(application, alternative, catalogue)).partition("?")[2]
            form = parse(parse_qsl(query, keep_blank_values=True))
            assert form.application is not None, form.problems
            yield form.application, candidate


def passes(application: Application, candidate: Candidate, catalogue: Catalogue) -> bool:
    """True for a suitable gear."""
    again = select(application, catalogue).candidate(candidate.designation)
    return again is not None and again.status == "suitable"


@cache
def equipped() -> Catalogue:
    """The shipped catalogue with two motors of a list; no fixture, of which a failing draw would print all."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "motors.csv").write_text(MOTORS, encoding="utf-8")
        return load_catalogue(supplement=Path(folder))


def test_what_would_make_a_gear_fit_does_under_phases_that_vary(soak: bool) -> None:
    chance, seen, reached = random.Random(18), 0, 0
    for _ in range(1500 if soak else 80):
        asked = varied(chance, at_random(chance))
        asked = motored(chance, asked, moving=False) if chance.random() < 0.5 else asked
        for application, candidate in followed(asked, equipped(), chance):
            seen += 1
            reached += any(phase.peak_torque_Nm for phase in application.duty_cycle.load_phases)
            assert passes(application, candidate, equipped()), (asked, candidate.designation)
    assert seen > 50
    assert reached > 25


@given(motions(), st.integers(0, 2**32))
def test_what_would_make_a_gear_fit_does_under_a_motion(motion: Json, seed: int) -> None:
    chance = random.Random(seed)
    asked = moved(chance, motion)
    for application, candidate in followed(asked, equipped(), chance):
        assert passes(application, candidate, equipped()), (asked, candidate.designation)


def digits_lost(formula: Formula) -> float:
    """Error by the ninth digit of both sides of a subtraction, which may cancel most of the others; 0 otherwise."""
    if not isinstance(formula, Subtraction):
        return 0.0
    return 1e-8 * (abs(value_of(formula.left)) + abs(value_of(formula.right)))


@given(motions(), st.integers(0, 2**32))
def test_a_calculation_of_a_motion_gives_the_figures_of_the_reply(motion: Json, seed: int) -> None:
    application = Application.model_validate(moved(random.Random(seed), motion))
    selection = select(application, equipped())
    candidate = next((one for one in selection.candidates if one.is_judged), None)
    assume(candidate)  # a load off the centre leaves all sizes without one unrated
    assert candidate
    gear = equipped().by_designation[candidate.designation]
    steps = calculation_of(candidate, selection.duty, gear, application, equipped())
    lines = [(step.code, line) for step in steps for line in step.lines]
    for code, line in lines:
        value = value_of(line.formula)
        value = math.floor(value * (1 + 1e-12)) if line.rounded_down else value
        assert math.isclose(value, line.result.value, rel_tol=1e-9, abs_tol=1e-12), code
        for reader in READERS:
            found, printed = shown(line, reader)
            bound = NINE_DIGITS * max(abs(printed), 1e-6) + digits_lost(line.formula)
            assert abs(found - printed) <= bound, (code, found, printed)
    assert {"motor_peak_torque", "motor_rated_torque"} <= {code for code, _ in lines}
    written = {c.code for c in candidate.checks if BY_CODE[c.code].group == "load" or c.code == "inertia_ratio"}
    judged = {c.code for c in candidate.checks if c.limit is not None}
    assert {comparison.code for step in steps for comparison in step.comparisons} == written & judged


TURNING: Json = {
    "mechanism": {"type": "rotary", "inertia_kgm2": 2.0},
    "moves": [{"profile": "trapezoidal", "angle_deg": 90, "time_s": 0.5}],
}


def test_a_motor_that_turns_its_own_inertia_leaves_no_closed_form_and_says_why() -> None:
    motor = {"inertia_kgm2": 0.0005, "peak_torque_Nm": 50}
    asked = {"duty_cycle": {"motion": TURNING}, "requirements": {"motor": motor}}
    selection = select(Application.model_validate(asked), equipped())
    assert selection.foremost.reserve.torque_factor is selection.foremost.reserve.speed_factor is None
    told = {growth.bound.text for growth in growths_of(selection.foremost)["motor_peak_torque"]}
    assert told == {"no single factor: the motor’s own inertia changes with the motion, or its torque with the speed"}


def test_a_load_that_has_to_drop_drops_in_the_moves() -> None:
    moves = [TURNING["moves"][0] | {"radial_N": 4000.0}]
    asked = {"duty_cycle": {"motion": TURNING | {"moves": moves}}, "requirements": {"sizes": ["20A"], "ratios": [5]}}
    application = Application.model_validate(asked)
    [candidate] = select(application, equipped()).candidates
    assert remedy_of(candidate, alternatives_of(candidate)) is not None
    for changed, _ in followed(asked, equipped(), random.Random(1)):
        motion = changed.duty_cycle.motion
        assert motion is not None
        assert motion.moves[0].radial_N == changed.duty_cycle.load_phases[0].radial_N
        assert (motion.moves[0].radial_N or 0) < 4000


def test_a_speed_that_has_to_drop_promises_nothing_where_the_motor_turns_its_own_inertia() -> None:
    """The torques pass, so that the speed alone decides: without the motor's inertia there is a way, with it none."""
    moves = [{"profile": "trapezoidal", "angle_deg": 360, "time_s": 0.5}]
    motion = {"mechanism": {"type": "rotary", "inertia_kgm2": 0.001}, "moves": moves}
    ways = {}
    for inertia in (None, 1e-6):
        requirements = {"sizes": ["20A"], "ratios": [50], "motor": {"inertia_kgm2": inertia, "peak_torque_Nm": 50}}
        asked = {"duty_cycle": {"motion": motion}, "requirements": requirements}
        application = Application.model_validate(asked)
        [candidate] = select(application, equipped()).candidates
        assert {check.code for check in candidate.failing} <= {"average_input_speed", "maximum_input_speed"}
        assert candidate.failing and candidate.is_judged
        ways[inertia] = alternatives_of(candidate)
        remedy = remedy_of(candidate, ways[inertia])
        assert remedy is not None
        assert (
            "The change that would make it fit is no single factor: the motor’s own inertia" in remedy.text
        ) == bool(inertia)
    assert ways[1e-6] == ()
    assert [(alternative.way.torque, alternative.way.speed < 1) for alternative in ways[None]] == [(1.0, True)]
