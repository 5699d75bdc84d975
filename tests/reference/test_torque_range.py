"""T_lo, T_hi and the position error of a motion: worked values, and a program that samples motions at random."""

import math
import random

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.duty import Duty
from tests.build import Json, answer, candidate
from tests.reference.torque_range import torque_range

SWIVEL: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.39,
        "gravity_mass_kg": 18.9,
        "gravity_radius_mm": 126,
        "friction_torque_Nm": 2.77,
        "efficiency": 0.754,
    },
    "moves": [
        {
            "profile": "trapezoidal",
            "angle_deg": -72.5,
            "speed_rpm": 33.7,
            "acceleration_deg_per_s2": 330,
            "deceleration_deg_per_s2": 67.1,
        }
    ],
}
INDEXED: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 2,
        "gravity_mass_kg": 4,
        "gravity_radius_mm": 200,
        "friction_torque_Nm": 6,
        "efficiency": 0.9,
    },
    "moves": [
        {"profile": "dwell", "time_s": 0.5},
        {"profile": "modified_sine", "angle_deg": 90, "time_s": 0.5},
        {"profile": "dwell", "time_s": 0.5},
        {"profile": "modified_sine", "angle_deg": -90, "time_s": 0.5},
    ],
}


@pytest.mark.parametrize(
    ("motion", "gear", "at", "error_arcmin"),
    [
        (SWIVEL, "HPN-11A-40", "cycle", 30.4763),
        (INDEXED, "HPN-20A-5", "rest", 15.9155),
        (INDEXED, "HPN-20A-5", "cycle", 36.2899),
    ],
)
def test_worked_position_errors_of_motions(
    catalogue: Catalogue, motion: Json, gear: str, at: str, error_arcmin: float
) -> None:
    document = {"duty_cycle": {"motion": motion}, "requirements": {"position_error_at": at}}
    error = candidate(answer(document, catalogue), gear)["position_error_arcmin"]
    assert error == pytest.approx(error_arcmin, abs=5e-5)  # as printed


def at_random(chance: random.Random) -> Json:
    """A cycle of a motion, of any mechanism and profile."""
    some = chance.uniform
    kind = chance.choice(["rotary", "rotary", "rack_and_pinion", "belt", "ball_screw"])
    mechanism: Json = {"type": kind}
    if kind == "rotary":
        mechanism |= {"inertia_kgm2": some(0.01, 5)}
        if some(0, 1) < 0.7:
            mass, radius = some(0.5, 30), some(10, 400)
            mechanism |= {"gravity_mass_kg": mass, "gravity_radius_mm": radius}
            mechanism["inertia_kgm2"] += mass * (radius / 1000) ** 2
        optional = {"friction_torque_Nm": some(0, 15), "viscous_friction_Nm_per_rpm": some(0, 0.3)}
    else:
        mechanism |= {"mass_kg": some(1, 500), "lead_mm" if kind == "ball_screw" else "diameter_mm": some(5, 150)}
        optional = {"incline_deg": chance.choice([-90, 90, some(-90, 90)]), "friction_coefficient": some(0, 0.3)}
        optional |= {"inertia_kgm2": some(0, 0.1), "friction_torque_Nm": some(0, 5), "friction_force_N": some(0, 200)}
        if optional["incline_deg"]:
            mechanism |= {"incline_deg": optional["incline_deg"], "counterweight_kg": chance.choice([0, some(0, 300)])}
    optional |= {"efficiency": some(0.4, 1), "ratio": some(0.5, 4)}
    mechanism |= {name: value for name, value in optional.items() if some(0, 1) < 0.6}
    moves = [_move_at_random(chance, kind == "rotary") for _ in range(chance.choice([1, 2, 3, 5]))]
    if all(move["profile"] == "dwell" for move in moves):
        moves.append({"profile": "modified_sine", "angle_deg" if kind == "rotary" else "distance_mm": 90, "time_s": 1})
    motion: Json = {"mechanism": mechanism, "moves": moves}
    if kind == "rotary":
        motion["start_deg"] = chance.choice([0, 90, -90, 180, some(-400, 400)])
    return {"motion": motion, "pause_s": chance.choice([0.0, 1.5])}


def _move_at_random(chance: random.Random, rotary: bool) -> Json:
    profile = chance.choice(["trapezoidal", "s_curve", "triangular", "modified_sine", "dwell"])
    way, time = chance.choice([1, -1]) * chance.uniform(5, 500), chance.uniform(0.2, 3)
    move: Json = {"profile": profile, "time_s": time}
    if chance.random() < 0.4:
        move["external_torque_Nm" if rotary else "external_force_N"] = chance.uniform(-60, 60)
    if profile == "dwell":
        return move
    move["angle_deg" if rotary else "distance_mm"] = way
    if profile == "s_curve":
        move["jerk_share"] = chance.choice([0.1, 0.5, 1.0])
    if profile in ("trapezoidal", "s_curve") and chance.random() < 0.7:
        ramps = [time * chance.uniform(0.05, 0.45) for _ in range(2)]
        if chance.random() < 0.5:
            return move | {"acceleration_time_s": ramps[0], "deceleration_time_s": ramps[1]}
        k = 1 - move.get("jerk_share", 0) / 2
        speed = abs(way) / (time - sum(ramps) / 2)
        unit = "deg" if rotary else "mm"
        a, b = (speed / (k * ramp) for ramp in ramps)
        move |= {f"acceleration_{unit}_per_s2": a, f"deceleration_{unit}_per_s2": b}
        del move["time_s"]
        move["speed_rpm" if rotary else "speed_mm_per_s"] = speed * (1 - 1e-6) / (6 if rotary else 1)
    return move


def test_a_motion_winds_the_gear_up_as_far_as_its_samples_and_never_less(catalogue: Catalogue, soak: bool) -> None:
    """Samples lie inside, so that they come from below: by the bow of the torque between two of them."""
    chance, rested = random.Random(46), 0
    gear = catalogue.by_designation["HPN-20A-5"]
    for _ in range(1500 if soak else 60):
        cycle = at_random(chance)
        rests = bool(cycle["pause_s"]) or any(move["profile"] == "dwell" for move in cycle["motion"]["moves"])
        for at in ("cycle", "rest")[: 1 + rests]:
            document = {"duty_cycle": cycle, "requirements": {"position_error_at": at, "ratios": [5], "sizes": ["20A"]}}
            values = [torque.item() for torque in Duty.of([Application.model_validate(document)]).torque_range_Nm]
            low, high = torque_range(cycle, at_rest=at == "rest")
            room = 1e-5 * max(abs(low), abs(high), 1e-3)
            assert low - room <= values[0] <= low + 1e-6 * room, (cycle, at)
            assert high + room >= values[1] >= high - 1e-6 * room, (cycle, at)
            if min(abs(low), abs(high)) < room:  # whether the torque passes 0 is left to rounding
                continue
            error = candidate(answer(document, catalogue), gear.designation)["position_error_arcmin"]
            assert gear.torsional_stiffness_Nm_per_rad and gear.transmission_accuracy_arcmin and gear.backlash_arcmin
            per_Nm = 10800 / math.pi / gear.torsional_stiffness_Nm_per_rad
            least = gear.transmission_accuracy_arcmin + (high - low) * per_Nm
            least += gear.backlash_arcmin if low <= 0 <= high else 0
            assert least * (1 - 1e-9) <= error <= least + 2 * room * per_Nm, (cycle, at)
            rested += at == "rest"
    assert rested > 10
