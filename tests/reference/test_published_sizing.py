"""Sizing examples that others have published, reproduced to their printed digits.

They take g as 9.8 m/s²; the friction coefficient is scaled so that the friction is theirs.
"""

import math
from typing import Any

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.physics.motion.mechanisms import GRAVITY
from tests.build import Json, answer, check

THEIR_G = 9.8 / GRAVITY


def phases_of(motion: Json) -> tuple[Any, ...]:
    return Application.model_validate({"duty_cycle": {"motion": motion}}).duty_cycle.load_phases


def load_inertia_of(motion: Json) -> float:
    moving = Application.model_validate({"duty_cycle": {"motion": motion}}).duty_cycle.motion
    assert moving is not None
    return moving.load_inertia_kgm2


def cylinder(density: float, length: float, diameter: float) -> float:
    """Moment of inertia of a solid cylinder in kgm², all in SI units."""
    return math.pi / 32 * density * length * diameter**4


def test_ball_screw_behind_a_reducer() -> None:
    """Yaskawa Electric, User's manual Σ-V series, Design and Maintenance (E-V-MD), section 2.2.2, page 2-5.

    The motor's shaft stands where the gear's output stands here: its ratio is 2.
    """
    screw, coupling = cylinder(7.87e3, 1.0, 0.02) / 4, 0.40e-4
    motion = {
        "mechanism": {
            "type": "ball_screw",
            "mass_kg": 250,
            "lead_mm": 10,
            "friction_coefficient": 0.2 * THEIR_G,
            "inertia_kgm2": 4 * (screw + coupling),
            "efficiency": 0.9,
            "ratio": 2,
        },
        "moves": [{"profile": "trapezoidal", "distance_mm": 275, "time_s": 1.2, "speed_mm_per_s": 15000 / 60}],
    }
    ramp, run, _ = phases_of(motion)

    assert (round(ramp.duration_s, 6), round(run.duration_s, 6)) == (0.1, 1.0)  # t_a and t_c
    assert round(run.speed_rpm) == round(ramp.peak_speed_rpm) == 3000  # n_M
    assert round(run.torque_Nm, 2) == 0.43  # T_L
    assert round(screw * 1e4, 2) == 0.31  # J_B
    assert round((load_inertia_of(motion) - screw - coupling) * 1e4, 2) == 1.58  # J_L1
    assert round(load_inertia_of(motion) * 1e4, 2) == 2.29  # J_L
    assert round(round(run.torque_Nm, 2) * run.speed_rpm * math.pi / 30) == 135  # P_O in W, from the rounded torque


@pytest.mark.parametrize(
    ("mass", "screw", "lead", "coupling", "printed"),
    [
        (80, (0.8, 0.016), 5, (0.3, 0.03), (3000, 0.139, 1.25)),
        (500, (1.4, 0.04), 10, (1.0, 0.06), (1500, 1.73, 44.9)),
    ],
)
def test_ball_screws_driven_directly(
    mass: float, screw: tuple[float, float], lead: float, coupling: tuple[float, float], printed: tuple[float, ...]
) -> None:
    """Load speed, load torque and load inertia (in 1e-4 kgm²) of two examples of Yaskawa Electric.

    Product manual of the rotary servomotors SGMMV, section 2.1.2, page 2-5; user's manual Σ-II series SGMVH, section
    11.1.1, page 11-2.
    """
    speed, torque, inertia = printed
    motion = {
        "mechanism": {
            "type": "ball_screw",
            "mass_kg": mass,
            "lead_mm": lead,
            "friction_coefficient": 0.2 * THEIR_G,
            "inertia_kgm2": cylinder(7.87e3, *screw) + coupling[0] * coupling[1] ** 2 / 8,
            "efficiency": 0.9,
        },
        "moves": [{"profile": "trapezoidal", "distance_mm": 275, "time_s": 1.2, "speed_mm_per_s": 250}],
    }
    _, run, _ = phases_of(motion)

    assert round(run.speed_rpm) == speed
    assert round(run.torque_Nm, 3 if torque < 1 else 2) == torque
    assert round(load_inertia_of(motion) * 1e4, 2 if inertia < 10 else 1) == inertia


def test_table_whose_gibs_are_pressed() -> None:
    """A published task: 1200 kg on a screw of 20 mm, gibs pressed with 490 N, 2.97 Nm by its maker.

    Friction of 0.8 Nm at the screw stands behind the efficiency there: (m g μ + F_f) h / (2 π η) + T_f. Here the
    efficiency of a mechanism counts for all that it moves.
    """
    screw = {"type": "ball_screw", "mass_kg": 1200, "lead_mm": 20, "friction_coefficient": 0.05}
    screw |= {"friction_force_N": 0.05 * 490, "friction_torque_Nm": 0.8, "efficiency": 0.9}
    motion = {"mechanism": screw, "moves": [{"profile": "trapezoidal", "distance_mm": 100, "time_s": 1}]}
    _, run, _ = phases_of(motion)

    assert round(run.torque_Nm, 2) == 3.06
    assert round(run.torque_Nm - 0.8 / 0.9 + 0.8, 2) == 2.97


def test_spindle_slide_with_its_counterweight() -> None:
    """A vertical screw moves 180 kg and a counterweight of 120 kg: 300 kg are moved, 60 kg are lifted."""
    screw = {"type": "ball_screw", "mass_kg": 180, "lead_mm": 20, "incline_deg": 90, "counterweight_kg": 120}
    moves = [{"profile": "trapezoidal", "distance_mm": sign * 100, "time_s": 1} for sign in (1, -1)]
    motion = {"mechanism": screw, "moves": [*moves, {"profile": "dwell", "time_s": 1}]}
    radius = 0.02 / (2 * math.pi)
    a = 0.15 / (1 / 3)  # 100 mm in 1 s, a third of it for each ramp

    up, raised, _, down, lowered, _, value_held = phases_of(motion)

    lifted = 60 * GRAVITY * radius
    for phase in (raised, lowered, value_held):
        assert math.isclose(phase.torque_Nm, lifted, rel_tol=1e-12)
    assert math.isclose(up.torque_Nm, lifted + 300 * a * radius, rel_tol=1e-12)
    assert math.isclose(down.torque_Nm, lifted - 300 * a * radius, rel_tol=1e-12)
    assert math.isclose(load_inertia_of(motion), 300 * radius**2, rel_tol=1e-12)
    screw["incline_deg"] = -90  # the other way round: positive motion lowers the mass
    assert math.isclose(phases_of(motion)[1].torque_Nm, -lifted, rel_tol=1e-12)


def test_timing_belt_behind_gears() -> None:
    """Yaskawa Electric, User's manual JUNMA series, Selection of Servomotor Size, page 38.

    Friction of 0.05 Nm at the pulley comes on top of that of the guide, which is taken as a force here. Of the inertias
    on the load's shaft 0.687 is printed where their formula gives 0.689; the sum is printed right.
    """
    pulleys, gear = 2 * cylinder(2690, 0.02, 0.064), cylinder(7870, 0.02, 0.1)
    at_motor = cylinder(7870, 0.02, 0.02) + 0.3 * 0.03**2 / 8
    motion = {
        "mechanism": {
            "type": "belt",
            "mass_kg": 4,
            "diameter_mm": 64,
            "friction_force_N": 0.2 * 9.8 * 4,
            "friction_torque_Nm": 0.05,
            "inertia_kgm2": pulleys + gear + 25 * at_motor,
            "efficiency": 0.9,
            "ratio": 5,
        },
        "moves": [
            {
                "profile": "trapezoidal",
                "distance_mm": 500,
                "time_s": 1.1,
                "speed_mm_per_s": 500,
            }
        ],
    }
    ramp, run, _ = phases_of(motion)

    assert (round(ramp.duration_s, 6), round(run.duration_s, 6)) == (0.1, 0.9)  # t_a and t_c
    assert round(run.speed_rpm / 5) == 149  # N
    assert round(run.torque_Nm, 4) == 0.0669  # T_L
    assert round(at_motor * 1e4, 3) == 0.362  # J_L3
    assert round(load_inertia_of(motion) * 1e4, 2) == 2.69  # J_L


def test_belt_behind_a_reducer_and_a_pair_of_pulleys() -> None:
    """MachineMFG, Servo Motor Sizing, case two: 50 kg at 30 m/min in 200 ms, behind ratios of 10 and 2.

    The inertia is printed behind the ratio of 10 alone.
    """
    belt = {"type": "belt", "mass_kg": 50, "diameter_mm": 120, "friction_coefficient": 0.6 * THEIR_G}
    move = {"profile": "trapezoidal", "distance_mm": 1000, "speed_mm_per_s": 500, "acceleration_mm_per_s2": 500 / 0.2}
    motion = {"mechanism": belt | {"ratio": 20}, "moves": [move]}
    ramp, run, _ = phases_of(motion)

    assert round(run.torque_Nm, 3) == 0.882  # T_f
    assert round(ramp.torque_Nm - run.torque_Nm, 3) == 0.375  # T_a
    assert round(load_inertia_of({"mechanism": belt | {"ratio": 10}, "moves": [move]}) * 1e4, 9) == 18  # J_L


def test_rotary_table(catalogue: Catalogue) -> None:
    """MachineMFG, Servo Motor Sizing, case one: a disc of 50 kg and 500 mm turns at 60 rpm.

    A motor of 8.17 kg·cm² may have three times its inertia, so that the ratio has to be above the root of 637.
    """
    motion = {
        "mechanism": {"type": "rotary", "inertia_kgm2": 50 * 0.5**2 / 8},
        "moves": [{"profile": "triangular", "angle_deg": 90, "speed_rpm": 60}],
    }
    motor = {"inertia_kgm2": 8.17e-4, "inertia_ratio": 3, "maximum_speed_rpm": 2000}
    document = {"sizes": ["32A"], "ratios": [25, 30], "motor": motor}
    reply = answer({"duty_cycle": {"motion": motion}, "requirements": document}, catalogue)

    assert reply["duty"]["load_inertia_kgm2"] * 1e4 == 15625  # J_L in kg·cm²
    assert math.isclose(reply["duty"]["maximum_output_speed_rpm"], 60, rel_tol=1e-14)
    least = check(reply, "HPN-32A-25", "inertia_ratio")["demand"] * 25**2 / 3
    assert math.floor(least) == 637
    assert check(reply, "HPN-32A-25", "inertia_ratio")["status"] == "fail"  # R > 25
    assert check(reply, "HPN-32A-30", "inertia_ratio")["status"] == "pass"
