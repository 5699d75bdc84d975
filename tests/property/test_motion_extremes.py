"""Motions at the ends of every bound: refused in words, or phases that may be typed; never a warning or a NaN."""

import math
import random

from pydantic import ValidationError

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import encode, select
from tests.build import Json


def extreme(chance: random.Random, low: float, high: float) -> float:
    return min(high, chance.choice([low, high, 1.0, math.exp(chance.uniform(math.log(low), math.log(high)))]))


def mechanism_at_random(chance: random.Random) -> Json:
    wide = [extreme(chance, 1e-12, 1e12) for _ in range(6)]
    if chance.random() < 0.6:
        mechanism: Json = {"type": "rotary", "inertia_kgm2": wide[0]}
        own = wide[1] * (wide[2] / 1000) ** 2
        if chance.random() < 0.5 and own <= 1e12:
            inertia = max(wide[0], own)
            mechanism |= {"gravity_mass_kg": wide[1], "gravity_radius_mm": wide[2], "inertia_kgm2": inertia}
        if chance.random() < 0.5:
            mechanism |= {"friction_torque_Nm": min(wide[3], 1e6), "viscous_friction_Nm_per_rpm": min(wide[4], 1e6)}
    else:
        kind, size = chance.choice([("belt", "diameter_mm"), ("ball_screw", "lead_mm")])
        mechanism = {"type": kind, "mass_kg": wide[0], size: wide[1]}
        if chance.random() < 0.5:
            mechanism |= {"incline_deg": chance.choice([-90, 90, 30]), "inertia_kgm2": wide[2]}
            mechanism |= {"counterweight_kg": wide[3], "friction_force_N": min(wide[4], 1e9)}
    return mechanism | ({"efficiency": min(wide[3], 1), "ratio": wide[5]} if chance.random() < 0.3 else {})


def move_at_random(chance: random.Random, rotary: bool) -> Json:
    way, speed, acceleration, external = (
        ("angle_deg", "speed_rpm", "acceleration_deg_per_s2", "external_torque_Nm")
        if rotary
        else ("distance_mm", "speed_mm_per_s", "acceleration_mm_per_s2", "external_force_N")
    )
    profile = chance.choice(["trapezoidal", "triangular", "s_curve", "modified_sine", "dwell"])
    move: Json = {"profile": profile, "time_s": extreme(chance, 1e-12, 1e9)}
    if profile != "dwell":
        move[way] = chance.choice([1, -1]) * extreme(chance, 1e-12, 1e9)
    if profile in ("trapezoidal", "s_curve"):
        message = chance.randrange(4)
        move |= {speed: extreme(chance, 1e-12, 1e12)} if message in (1, 3) else {}
        move |= {acceleration: extreme(chance, 1e-12, 1e12)} if message in (2, 3) else {}
        if message == 3:
            del move["time_s"]
    if profile == "s_curve" and chance.random() < 0.5:
        jerk = acceleration.replace("acceleration", "jerk").replace("s2", "s3")
        move |= chance.choice([{"jerk_share": extreme(chance, 1e-12, 1)}, {jerk: extreme(chance, 1e-12, 1e12)}])
    return move | ({external: -extreme(chance, 1e-12, 1e6)} if chance.random() < 0.3 else {})


def test_motions_at_the_ends_of_their_bounds_are_refused_or_come_to_phases(catalogue: Catalogue, soak: bool) -> None:
    accepted = 0
    for seed in range(6000 if soak else 300):
        chance = random.Random(seed)
        mechanism = mechanism_at_random(chance)
        rotary = mechanism["type"] == "rotary"
        motion: Json = {
            "mechanism": mechanism,
            "moves": [move_at_random(chance, rotary) for _ in range(chance.randrange(1, 4))],
        }
        if rotary:
            motion["start_deg"] = chance.choice([0, 90, 1e6, -1e6, chance.uniform(-400, 400)])
        motor = {"inertia_kgm2": extreme(chance, 1e-12, 1e12)}
        try:
            application = Application.model_validate(
                {"duty_cycle": {"motion": motion}, "requirements": {"motor": motor, "sizes": ["20A"]}}
            )
        except ValidationError:
            continue
        accepted += 1
        typed = [phase.model_dump() for phase in application.duty_cycle.load_phases]
        Application.model_validate({"duty_cycle": {"phases": typed}})
        encode(select(application, catalogue))
    assert accepted > 30
