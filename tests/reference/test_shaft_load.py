"""Loads of a pinion or pulley on the gear's shaft: worked figures, and an independent program of random axes."""

import math
import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.duty import Duty
from tests.build import Json, answer, candidate, check, cycle, notices, phase

RACK: Json = {"type": "rack_and_pinion", "mass_kg": 120, "diameter_mm": 60, "friction_coefficient": 0.05}
RACK |= {"efficiency": 0.95}
MOVE: Json = {"profile": "trapezoidal", "distance_mm": 600, "time_s": 0.8}


def axis(mechanism: Json = RACK, *moves: Json, pause_s: float = 0.0, **load: Any) -> Json:
    motion = {"mechanism": mechanism, "moves": list(moves or (MOVE,))}
    parts = {"output_load": {"from_motion": True, **load}} if load is not None else {}
    return {"duty_cycle": {"motion": motion, "pause_s": pause_s}, "requirements": {"sizes": ["20A"]}, **parts}


def loads_of(application: Json) -> tuple[list[float], list[float]]:
    phases = Duty.of([Application.model_validate(application)]).phases
    return phases.radial_N[0, 0].tolist(), phases.axial_N[0, 0].tolist()


def test_tangential_forces_are_the_rack_s_or_the_torque_s_whichever_is_larger() -> None:
    """120 kg · 4.21875 m/s² and μ m g, through an efficiency of 0.95 where the gear drives; braking, the rack's own."""
    duty = Duty.of([Application.model_validate(axis())])
    assert [round(F, d) for F, d in zip(duty.shaft_force_N[0, 0].tolist(), (3, 4, 3), strict=True)] == [
        594.831, 61.9367, 447.410
    ]  # fmt: skip


def test_a_straight_rack_pushes_the_pinion_off(catalogue: Catalogue) -> None:
    radial, axial = loads_of(axis())
    assert [round(F, d) for F, d in zip(radial, (3, 4, 3), strict=True)] == [633.006, 65.9117, 476.124]
    assert axial == [0, 0, 0]
    reply = answer(axis(), catalogue)
    assert round(candidate(reply, "HPN-20A-5")["bearing_life_L50_h"]) == 539_643


def test_a_helical_rack_pushes_it_along_the_shaft_too() -> None:
    radial, axial = loads_of(axis(rack_helix_deg=19.5283))
    assert (round(radial[0], 3), round(axial[0], 3)) == (637.647, 210.972)


def test_a_belt_s_pretension_acts_always(catalogue: Catalogue) -> None:
    belt = RACK | {"type": "belt"}
    dwell = {"profile": "dwell", "time_s": 2}
    radial, axial = loads_of(axis(belt, MOVE, dwell))
    assert [round(F, 2) for F in radial] == [1189.66] * 4
    assert axial == [0] * 4
    reply = answer(axis(belt), catalogue)
    assert round(candidate(reply, "HPN-20A-5")["bearing_life_L50_h"], 1) == 29_017.8


def test_a_rack_that_passed_without_its_own_load_fails_with_it(catalogue: Catalogue) -> None:
    """300 kg, ∅60, μ 0.1, 1000 mm in 1.2 s, 2 s of dwell, and back: 1311 N at the teeth."""
    rack = {"type": "rack_and_pinion", "mass_kg": 300, "diameter_mm": 60, "friction_coefficient": 0.1}
    there = {"profile": "trapezoidal", "distance_mm": 1000, "time_s": 1.2}
    dwell = {"profile": "dwell", "time_s": 2}
    moves = [there, dwell, there | {"distance_mm": -1000}]
    before: Json = {"duty_cycle": {"motion": {"mechanism": rack, "moves": moves}}, "requirements": {"sizes": ["14A"]}}

    reply = answer(before, catalogue)
    assert candidate(reply, "HPN-14A-5")["status"] == "suitable"
    assert "1310.75 N" in notices(reply)["shaft_load_of_motion"]

    reply = answer(before | {"output_load": {"from_motion": True}}, catalogue)
    assert round(100 * check(reply, "HPN-14A-5", "output_bearing_load")["utilisation"], 1) == 156.0
    life = check(reply, "HPN-14A-5", "output_bearing_life")
    assert round(100 * life["utilisation"], 1) == 117.1


@pytest.mark.parametrize(("kind", "loads"), [("rack_and_pinion", (212.8, 425.7)), ("belt", (800.0, 800.0))])
def test_typed_phases_have_the_load_of_a_pinion_or_pulley_that_is_told(
    catalogue: Catalogue, kind: str, loads: tuple[float, float]
) -> None:
    """2 T / d is 200 and 400 N; a rack's by √(1 + tan² 20°), a belt's largest by 2."""
    load: Json = {"drive": {"type": kind, "diameter_mm": 100}}
    phases = phase(10, 100), phase(-15, 100, peak_torque_Nm=20)
    application = cycle(*phases, output_load=load, emergency_stop={"torque_Nm": 90}, requirements={"sizes": ["20A"]})
    assert [round(F, 1) for F in loads_of(application)[0]] == list(loads)

    reply = answer(application, catalogue)
    at_stop = 1800 * (math.hypot(1, math.tan(math.radians(20))) if kind != "belt" else 1)
    assert math.isclose(candidate(reply, "HPN-20A-5")["stop_radial_N"], at_stop, rel_tol=1e-12)
    assert ("stop_radial_above_limit" in notices(reply)) is (kind != "belt")  # 1800 N are permitted
    assert "shaft_load_of_motion" not in notices(reply)
    added = application | {"output_load": load | {"radial_N": -50, "axial_N": 7}}
    assert [round(F, 1) for F in loads_of(added)[0]] == [round(F + 50, 1) for F in loads]
    assert loads_of(added)[1] == [7, 7]


def test_a_belt_s_stop_is_never_below_its_pretension(catalogue: Catalogue) -> None:
    stopped = axis(RACK | {"type": "belt"}) | {"emergency_stop": {"torque_Nm": 20}}
    assert round(candidate(answer(stopped, catalogue), "HPN-20A-5")["stop_radial_N"], 2) == 1189.66


# --- An independent program -------------------------------------------------------------------------------------------

G, SAMPLES = 9.80665, 4000
LIMITS = (1800.0, 2200.0)
"""Published radial and axial limits of size 20A in N."""


@dataclass
class Stretch:
    """Part of a move in which the torque keeps its sign: tangential force in N, way in mm, time in s."""

    force: float
    way: float
    time: float


def stretches_of(mechanism: Json, move: Json) -> Iterator[Stretch]:
    """Parts of a move, stepped through in time with plain numbers: ramps by their shape, sums of forces, losses."""
    r, eta = mechanism["diameter_mm"] / 2000, mechanism["efficiency"]
    beta, hanging = math.radians(mechanism["incline_deg"]), mechanism["counterweight_kg"]
    weight = G * (mechanism["mass_kg"] * math.sin(beta) - hanging * math.copysign(1, beta) * bool(beta))
    rubbing = G * mechanism["mass_kg"] * mechanism["friction_coefficient"] * math.cos(beta)
    rubbing += mechanism["friction_force_N"]
    outer = weight + move.get("external_force_N", 0.0)
    if move["profile"] == "dwell":
        yield Stretch(abs(outer), 0.0, move["time_s"])
        return
    D, T, sign = abs(move["distance_mm"]), move["time_s"], math.copysign(1, move["distance_mm"])
    t1, t2 = move["acceleration_time_s"], move["deceleration_time_s"]
    V = D / (T - (t1 + t2) / 2)
    u = (np.arange(SAMPLES) + 0.5) / SAMPLES
    rise = 1 / 4 if move["profile"] == "s_curve" else 0.0  # a jerk share of 0.5
    shape = np.minimum(1, np.minimum(u, 1 - u) / rise) / (1 - rise) if rise else np.ones(SAMPLES)
    speed = V * np.cumsum(shape) / SAMPLES
    for time, a, v in (
        (t1, V / t1 * shape, speed),
        (T - t1 - t2, 0 * u, V + 0 * u),
        (t2, -V / t2 * shape, speed[::-1]),
    ):
        a = a / 1000 * sign
        F = (mechanism["mass_kg"] + hanging) * a + outer + rubbing * sign
        torque = F * r + mechanism["inertia_kgm2"] * a / r + mechanism["friction_torque_Nm"] * sign
        at_gear = np.where(torque * sign > 0, torque / eta, torque * eta)
        for part in (torque >= 0, torque < 0):
            if part.any():
                force = max(np.abs(at_gear[part]).max() / r, np.abs(F[part]).max())
                yield Stretch(float(force), float(v[part].sum()) * time / SAMPLES, time * float(part.mean()))


def axis_at_random(chance: random.Random) -> Json:
    kind, some = chance.choice(["rack_and_pinion", "belt"]), chance.uniform
    mechanism = {"type": kind, "mass_kg": some(5, 400), "diameter_mm": some(30, 150), "efficiency": some(0.6, 1)}
    mechanism |= {"incline_deg": chance.choice([0.0, some(-90, 90)]), "friction_coefficient": some(0, 0.2)}
    mechanism |= {"friction_force_N": some(0, 200), "friction_torque_Nm": some(0, 5), "inertia_kgm2": some(0, 0.05)}
    mechanism["counterweight_kg"] = some(0, 300) if mechanism["incline_deg"] else 0.0
    moves: list[Json] = []
    for _ in range(chance.randrange(1, 5)):
        T = some(0.3, 3)
        ramps = {"acceleration_time_s": T * some(0.05, 0.45), "deceleration_time_s": T * some(0.05, 0.45)}
        way = chance.choice([-1, 1]) * some(20, 1500)
        moves.append({"profile": chance.choice(["trapezoidal", "s_curve"]), "distance_mm": way, "time_s": T} | ramps)
        if chance.random() < 0.5:
            moves.append({"profile": "dwell", "time_s": some(0.1, 2)})
    for move in moves:
        if chance.random() < 0.4:
            move["external_force_N"] = some(-500, 500)
    load = {"rack_helix_deg": some(0, 45), "belt_tension_factor": some(1, 5), "load_coefficient": some(1, 2)}
    if chance.random() < 0.4:
        load |= {"radial_N": some(-300, 300), "axial_N": some(-300, 300)}
    return axis(mechanism, *moves, pause_s=some(0, 2), **load)


def expected_of(application: Json) -> tuple[list[Stretch], float, float, float]:
    """Stretches of an axis, its largest radial load in N, its equivalent load f_w P_m, its bearing life L50 in h."""
    cycle, load = application["duty_cycle"], application["output_load"]
    mechanism = cycle["motion"]["mechanism"]
    values = [one for move in cycle["motion"]["moves"] for one in stretches_of(mechanism, move)]
    largest = max(one.force for one in values)
    radial, axial, beta = [], [], math.radians(load["rack_helix_deg"])
    for one in values:
        if mechanism["type"] == "belt":
            own = load["belt_tension_factor"] * largest, 0.0
        else:
            normal = one.force / (math.cos(beta) * math.cos(math.radians(20)))  # between the teeth
            along = one.force * math.tan(beta)
            own = math.sqrt(normal**2 - along**2), along
        radial.append(own[0] + abs(load.get("radial_N", 0)))
        axial.append(own[1] + abs(load.get("axial_N", 0)))
    P = [r / LIMITS[0] + a / LIMITS[1] for r, a in zip(radial, axial, strict=True)]
    ways = [one.way for one in values]
    mean = (sum(way * p**3 for way, p in zip(ways, P, strict=True)) / sum(ways)) ** (1 / 3) * load["load_coefficient"]
    turns = sum(ways) / (math.pi * mechanism["diameter_mm"])
    n_av = 60 * turns / (sum(one.time for one in values) + cycle["pause_s"])
    return values, max(radial), mean, 20_000 * (100 / n_av) / mean**3


@pytest.mark.parametrize("part", range(3))
def test_loads_and_life_are_those_of_an_independent_program(catalogue: Catalogue, part: int) -> None:
    """300 racks and belts. Steps of a ramp leave a peak by half a step short of it, and the way by its square."""
    for seed in range(100 * part, 100 * (part + 1)):
        application = axis_at_random(random.Random(seed))
        stretches, largest, mean, life = expected_of(application)
        reply = answer(application, catalogue)

        duty = Duty.of([Application.model_validate(application)])
        assert math.isclose(duty.phases.radial_N.max(), largest, rel_tol=1e-3), seed
        assert math.isclose(duty.shaft_force_N.max(), max(one.force for one in stretches), rel_tol=1e-3), seed
        assert math.isclose(check(reply, "HPN-20A-5", "output_bearing_life")["demand"], mean, rel_tol=1e-3), seed
        assert math.isclose(candidate(reply, "HPN-20A-5")["bearing_life_L50_h"], life, rel_tol=4e-3), seed
