"""Random applications: by Hypothesis for what must hold, by a plain generator for comparison in bulk."""

import random
from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

from tests.build import Json, cycle, phase
from tests.property.motors import curve_at_random

RANKS = ("weight", "utilisation", "length", "motor_torque", "life", "stiffness", "position_error")

signs = st.sampled_from([-1.0, 1.0])
torques = st.one_of(st.just(0.0), st.sampled_from([9.0, 26.0, 80.0, 149.0, 256.0]), st.floats(0.01, 400))
speeds = st.one_of(st.sampled_from([100.0, 120.0, 600.0, 1200.0]), st.floats(0.1, 1500))
durations = st.floats(0.01, 100)
seeds = st.integers(0, 2**32)
loads = st.one_of(st.just(0.0), st.floats(0.1, 5000))
NAMES = ("lift", "1.0", "2e+05", "Rück & ab; =?#%", "T_av", '"a", b', "=1+1")
"""Names of phases and moves, of which some look like a figure, or like something that means more in a file."""


def _wishes(curves: bool) -> st.SearchStrategy[Json]:
    curve = st.builds(lambda seed, last: curve_at_random(random.Random(seed), last), seeds, st.floats(500, 1e4))
    motor = st.fixed_dictionaries(
        {},
        optional={
            "maximum_speed_rpm": st.floats(100, 10000),
            "peak_torque_Nm": st.floats(0.1, 100),
            "rated_torque_Nm": st.floats(0.1, 100),
            **({"curve": curve} if curves else {}),
        },
    )
    return st.fixed_dictionaries(
        {},
        optional={
            "life_h": st.floats(1, 1e6),
            "backlash_arcmin": st.sampled_from([4.9, 5.0, 6.0, 7.0]),
            "torsional_stiffness_Nm_per_rad": st.sampled_from([1000.0, 9300.0, 26001.0, 143000.0]),
            "weight_kg": st.sampled_from([0.5, 1.0, 2.6, 8.0]),
            "length_mm": st.sampled_from([60.0, 122.0, 190.0]),
            "ambient_temperature_degC": st.floats(-30, 60),
            "utilisation": st.sampled_from([0.5, 0.8, 1.0]),
            "efficiency": st.floats(0.5, 1),
            "motor": motor,
        },
    )


@st.composite
def applications(draw: st.DrawFn, wishes: bool = True, curves: bool = True) -> Json:
    """A valid application with any of its parts; with `curves` also torque curves of motors."""
    phases = [
        phase(draw(signs) * draw(torques), draw(signs) * (draw(speeds) if k == 0 else draw(st.just(0.0) | speeds)), t)
        for k, t in enumerate(draw(st.lists(durations, min_size=1, max_size=6)))
    ]
    phases = [entry | draw(st.just({}) | st.fixed_dictionaries({"name": st.sampled_from(NAMES)})) for entry in phases]
    parts: Json = {"rank_by": draw(st.sampled_from(RANKS))}
    if draw(st.booleans()):
        parts["emergency_stop"] = {"torque_Nm": draw(signs) * draw(st.floats(0, 700))}
        if draw(st.booleans()):
            parts["emergency_stop"]["count"] = draw(st.integers(0, 10**8))
    if draw(st.booleans()):
        parts["output_load"] = {
            "radial_N": draw(signs) * draw(loads),
            "axial_N": draw(signs) * draw(loads),
            "load_coefficient": draw(st.sampled_from([1.0, 1.2, 1.5, 3.0])),
            "life_h": draw(st.floats(1, 1e6)),
            "life_basis": draw(st.sampled_from(["L50", "L10"])),
            "model": draw(st.sampled_from(["linear", "iso281"])),
        }
    if wishes:
        parts["requirements"] = draw(_wishes(curves))
    return cycle(*phases, pause_s=draw(st.just(0.0) | st.floats(0, 100)), **parts)


def at_random(chance: random.Random, models: Sequence[str] = ("linear", "iso281")) -> Json:
    """A valid application; every part with even chance, and figures that often meet a limit or a tie exactly."""

    def some(low: float, high: float, *exact: float) -> float:
        return float(chance.choice(exact)) if exact and chance.random() < 0.4 else chance.uniform(low, high)

    def maybe(probability: float = 0.5) -> bool:
        return chance.random() < probability

    scale = 10 ** chance.uniform(-2, 0.3)
    phases = []
    for k in range(chance.choice([1, 1, 2, 3, 5, 12])):
        T = chance.choice([1, -1]) * some(0, 300, 0, 9, 14, 26, 80, 149, 200, 376) * (1 if maybe() else scale)
        n = chance.choice([1, -1]) * some(1, 1200, 60, 100, 120, 200, 600, 1000, 1200) * (1 if maybe() else scale)
        entry = phase(T, n if k == 0 or maybe(0.8) else 0.0, some(0.01, 30, 1, 2))
        if maybe(0.2):
            entry["peak_torque_Nm"] = abs(T) * some(1, 3, 1)
            entry["rms_torque_Nm"] = entry["peak_torque_Nm"] * some(0, 1, 1)
        if entry["speed_rpm"] and maybe(0.2):
            entry["peak_speed_rpm"] = abs(entry["speed_rpm"]) * some(1, 3, 1)
        phases.append(entry)
    if maybe(0.3):
        for entry in phases:
            if maybe(0.7):
                entry["radial_N"] = chance.choice([1, -1]) * some(0, 3000, 0, 480, 1800)
            if maybe(0.7):
                entry["axial_N"] = chance.choice([1, -1]) * some(0, 3000, 0, 640, 2200)
        phases[0].setdefault("axial_N", 0.0)
    parts: dict[str, Any] = {"rank_by": chance.choice((*RANKS, "natural_frequency"))} if maybe(0.8) else {}
    if maybe(0.6):
        parts["emergency_stop"] = {"torque_Nm": chance.choice([1, -1]) * some(0, 900, 26, 40, 80, 149, 250, 256, 376)}
        if maybe():
            parts["emergency_stop"]["count"] = chance.choice([0, 1, 10, 1000, 10**5, 10**7, chance.randrange(10**8)])
    if maybe():
        load: dict[str, Any] = {"model": chance.choice(models)} if maybe(0.8) else {}
        if maybe(0.8) or not any("axial_N" in entry for entry in phases):
            load["radial_N"] = chance.choice([1, -1]) * some(0, 2000, 0, 480, 840) * scale
        if maybe():
            load["axial_N"] = chance.choice([1, -1]) * some(0, 2000, 0, 640, 900) * scale
        if maybe():
            load["load_coefficient"] = some(1, 3, 1, 1.2, 1.5)
        if maybe():
            load["life_h"] = 10 ** chance.uniform(2, 6)
        if maybe():
            load["life_basis"] = chance.choice(["L50", "L10"])
        if maybe(0.3):
            load["radial_position_mm"] = some(-80, 80, 0, 21, 45)
        if maybe(0.2):
            load["axial_radius_mm"] = some(0, 80, 0, 40)
        if maybe(0.8) and ("radial_position_mm" in load or "axial_radius_mm" in load):
            load["shaft_centre_mm"] = some(10, 60, 21, 45)
        parts["output_load"] = load
    wishes: dict[str, Any] = {}
    if maybe(0.2):
        wishes["ratios"] = chance.sample([4, 5, 7, 10, 15, 20, 50], chance.choice([1, 3]))
    if maybe(0.2):
        wishes["sizes"] = chance.sample(["11A", "14A", "20A", "32A", "40A"], chance.choice([1, 2, 4]))
    for name, value in (
        ("life_h", 10 ** chance.uniform(2, 6)),
        ("backlash_arcmin", some(4, 8, 5, 7)),
        ("torsional_stiffness_Nm_per_rad", some(1000, 150000, 9300, 26000, 143000)),
        ("weight_kg", some(0.4, 8, 0.44, 2.6, 7.2)),
        ("length_mm", some(50, 200, 60, 122, 190)),
        ("ambient_temperature_degC", some(-20, 60, 0, 20, 40)),
        ("utilisation", some(0.3, 1, 1, 0.8)),
        ("efficiency", some(0.6, 1, 0.95)),
    ):
        if maybe(0.2):
            wishes[name] = value
    if maybe(0.3):
        wishes["motor"] = {
            name: value
            for name, value in (
                ("maximum_speed_rpm", some(500, 8000, 3000, 6000)),
                ("peak_torque_Nm", some(0.5, 60, 8, 16)),
                ("rated_torque_Nm", some(0.5, 40, 8)),
                ("rated_speed_rpm", some(500, 6000, 3000)),
            )
            if maybe(0.6)
        }
        if maybe():
            wishes["motor"] |= {"inertia_kgm2": 10 ** chance.uniform(-5, -3), "inertia_ratio": some(1, 10, 3, 5)}
            wishes["load_inertia_kgm2"] = 10 ** chance.uniform(-3, 0)
    if maybe(0.3):
        wishes["load_inertia_kgm2"] = wishes.get("load_inertia_kgm2", 10 ** chance.uniform(-3, 1))
        wishes["natural_frequency_Hz"] = some(5, 200, 25)
    if maybe(0.3):
        wishes["load_reverses"] = maybe()
    if maybe(0.3):
        wishes |= (
            {"position_error_arcmin": some(10, 60, 15, 20)}
            if maybe()
            else {
                "position_error_mm": some(0.2, 5, 1),
                "position_radius_mm": some(50, 500, 250),
            }
        )
    if "emergency_stop" in parts and maybe(0.3):
        brake = {"torque_Nm": some(0.2, 40, 8)}
        if maybe():
            brake["rise_time_s"] = some(0, 0.05, 0, 0.005)
        elif maybe(0.3):
            brake["dynamic_factor"] = some(1, 2, 1, 2)
        if maybe(0.4):
            brake["load_torque_Nm"] = some(0, 30, 0, 12)
        if maybe(0.3):
            brake["opposing_torque_Nm"] = brake.get("load_torque_Nm", 0.0) + some(0, 30, 0, 5)
        parts["emergency_stop"] = {"brake": brake} | {
            name: count for name, count in parts["emergency_stop"].items() if name == "count"
        }
    rank = parts.get("rank_by")
    if rank == "natural_frequency":
        wishes.setdefault("load_inertia_kgm2", 10 ** chance.uniform(-3, 0))
    if wishes:
        parts["requirements"] = wishes
    pause_s = some(0, 20, 0) if maybe() else 0.0
    if maybe(0.3):
        phases = [entry | ({"name": chance.choice(NAMES)} if maybe(0.7) else {}) for entry in phases]
    return _with_curve(_with_centres(_with_drive(_with_rest(cycle(*phases, pause_s=pause_s, **parts)))))


def _with_curve(application: Json) -> Json:
    """The application with a torque curve of its motor in one of three, by chance of its own likewise."""
    chance, motor = random.Random(f"curve of {application!r}"), application.get("requirements", {}).get("motor")
    if motor is not None and chance.random() < 1 / 3:
        motor["curve"] = curve_at_random(chance, chance.choice([3000.0, 6000.0, chance.uniform(500, 12000)]))
        if chance.random() < 1 / 3:
            motor["stall_torque_Nm"] = motor["curve"][0]["continuous_Nm"] * chance.choice([1.0, 1.2])
    return application


def _with_centres(application: Json) -> Json:
    """The application with its shaft's centre by size in one of three, by chance of its own likewise."""
    chance, load = random.Random(f"centres of {application!r}"), application.get("output_load", {})
    if "shaft_centre_mm" not in load or chance.random() > 1 / 3:
        return application
    sizes = chance.sample(["11A", "14A", "20A", "32A", "40A", "others"], chance.choice([1, 2, 4]))
    centres = {size: chance.choice([21.0, 45.0, chance.uniform(10, 60)]) for size in sizes}
    return application | {"output_load": load | {"shaft_centre_mm": centres}}


def _with_drive(application: Json) -> Json:
    """The application with a pinion or pulley on the shaft where there is a load, by chance of its own likewise."""
    chance = random.Random(repr(application))
    if "output_load" in application and chance.random() < 0.25:
        drive = {"type": chance.choice(["rack_and_pinion", "belt"]), "diameter_mm": chance.uniform(20, 300)}
        more = {"rack_helix_deg": chance.choice([0.0, chance.uniform(0, 45)])}
        more |= {"belt_tension_factor": chance.choice([2.0, chance.uniform(1, 5)])}
        application["output_load"] |= {"drive": drive} | more
    return application


def _with_rest(application: Json) -> Json:
    """The application with least torques of its phases, and what it asks of its rest: by chance of its own, so that
    seeds of before mean what they meant.
    """
    cycle, chance = application["duty_cycle"], random.Random(repr(application))
    for entry in cycle["phases"]:
        if chance.random() < 0.2:
            own = abs(entry["torque_Nm"])
            entry["least_torque_Nm"] = min(own, entry.get("rms_torque_Nm", own)) * chance.choice([0, 0.4, 1])
    asked: Json = {"rest_friction_Nm": chance.choice([0.0, 5.0, 40.0])} if chance.random() < 0.3 else {}
    if chance.random() < 0.3 and (cycle["pause_s"] or any(not entry["speed_rpm"] for entry in cycle["phases"])):
        asked["position_error_at"] = "rest"
    if asked:
        application["requirements"] = application.get("requirements", {}) | asked
    return application


# --- Motions ----------------------------------------------------------------------------------------------------------

ways = st.builds(lambda sign, size: sign * size, signs, st.floats(1, 500))
times = st.floats(0.2, 5)


def _moves(way: str, speed: str, unit: float, acceleration: str, external: str) -> st.SearchStrategy[Json]:
    """A possible move; what its ramps leave to say is said in each of the ways that there are."""

    deceleration = acceleration.replace("acc", "dec")
    jerk = acceleration.replace("acceleration", "jerk").replace("s2", "s3")

    def of(
        profile: str,
        size: float,
        time: float,
        ramps: tuple[float, float],
        said: int,
        share: float,
        load: float | None,
        by_jerk: bool,
    ) -> Json:
        move = by_share(profile, size, time, ramps, said, share, load)
        if profile == "s_curve" and by_jerk:
            move.pop("jerk_share", None)
            lengths = (1 / 3, 1 / 3) if said == 0 else (ramps[0],) * 2 if said < 4 else [min(r, 0.49) for r in ramps]
            V = abs(size) / (time * (1 - sum(lengths) / 2))
            # Twice that of the share in the shorter ramp: the longer one gets shorter by it, so that the speed drops.
            move[jerk] = 4 * V / ((1 - share / 2) * share * (time * min(lengths)) ** 2)
        return move

    def by_share(
        profile: str, size: float, time: float, ramps: tuple[float, float], said: int, share: float, load: float | None
    ) -> Json:
        ramp = ramps[0]
        move: Json = {"profile": profile, "time_s": time}
        if load is not None and load > 0:
            move["name"] = NAMES[said % len(NAMES)]
        if load is not None:
            move[external] = load
        if profile == "dwell":
            return move
        move[way] = size
        if profile in ("modified_sine", "triangular") or said == 0:
            return move
        if said > 3:
            return move | unequal(profile, abs(size), time, ramps, said, share)
        V = abs(size) / (time * (1 - ramp)) / unit
        a = abs(size) / (time * (1 - ramp)) / (time * ramp) / (1 - share / 2 if profile == "s_curve" else 1)
        if profile == "s_curve":
            move["jerk_share"] = share
        if said != 1:
            move[acceleration] = a * (1 + 1e-6)
        if said != 2:
            move[speed] = V * (1 + 1e-6)
        if said == 3:
            del move["time_s"]
        return move

    def unequal(profile: str, size: float, time: float, ramps: tuple[float, float], said: int, share: float) -> Json:
        ramps = (min(ramps[0], 0.49), min(ramps[1], 0.49))  # two halves leave a speed that is a little larger no run
        V, t = size / (time * (1 - sum(ramps) / 2)), [time * ramp for ramp in ramps]
        k = 1 - share / 2 if profile == "s_curve" else 1
        a = [V / (k * one) * (1 + 1e-6) for one in t]
        fast, short = V / unit * (1 + 1e-6), [one * (1 - 1e-6) for one in t]
        ways: dict[int, Json] = {
            4: {"acceleration_time_s": short[0], "deceleration_time_s": short[1]},
            5: {acceleration: a[0], deceleration: a[1]},
            6: {acceleration: a[0], "deceleration_time_s": short[1]},
            7: {"time_s": None, speed: fast, "acceleration_time_s": short[0], deceleration: a[1]},
            8: {"time_s": None, speed: fast, acceleration: a[0], deceleration: a[1]},
            9: {speed: fast, "acceleration_time_s": short[0]},
            10: {speed: fast, deceleration: a[1]},
        }
        return ways[said] | ({"jerk_share": share} if profile == "s_curve" else {})

    return st.builds(
        lambda *drawn: {name: value for name, value in of(*drawn).items() if value is not None},
        st.sampled_from(["trapezoidal", "triangular", "s_curve", "modified_sine", "dwell"]),
        ways,
        times,
        st.tuples(st.floats(0.05, 0.5), st.floats(0.05, 0.5)),
        st.integers(0, 10),
        st.sampled_from([0.1, 0.5, 1.0]),
        st.none() | st.floats(-40, 40),
        st.booleans(),
    )


def _of(mechanism: st.SearchStrategy[Json], moves: st.SearchStrategy[Json], **more: Any) -> st.SearchStrategy[Json]:
    listed = st.lists(moves, min_size=1, max_size=4).filter(lambda few: any(m["profile"] != "dwell" for m in few))
    return st.fixed_dictionaries({"mechanism": mechanism, "moves": listed, **more})


def _weighted(mechanism: Json, gravity: Json) -> Json:
    """A mechanism with a mass off its axis, whose own moment of inertia counts in the whole."""
    own = gravity["gravity_mass_kg"] * (gravity["gravity_radius_mm"] / 1000) ** 2
    return mechanism | gravity | {"inertia_kgm2": mechanism["inertia_kgm2"] + own}


def rotary_motions() -> st.SearchStrategy[Json]:
    """A possible motion of a mass that turns, with and without gravity."""
    common = {
        "friction_torque_Nm": st.floats(0, 10),
        "viscous_friction_Nm_per_rpm": st.floats(0, 0.2),
        "efficiency": st.floats(0.5, 1),
        "ratio": st.floats(0.5, 4),
    }
    plain = st.fixed_dictionaries({"type": st.just("rotary"), "inertia_kgm2": st.floats(0.01, 5)}, optional=common)
    gravity = {"gravity_mass_kg": st.floats(0.5, 20), "gravity_radius_mm": st.floats(10, 400)}
    heavy = st.builds(_weighted, plain, st.fixed_dictionaries(gravity))
    moves = _moves("angle_deg", "speed_rpm", 6.0, "acceleration_deg_per_s2", "external_torque_Nm")
    return _of(plain | heavy, moves, start_deg=st.sampled_from([0, 90, -90, 180]) | st.floats(-400, 400))


def linear_motions() -> st.SearchStrategy[Json]:
    """A possible motion along a line."""
    common = {
        "incline_deg": st.floats(-90, 90),
        "friction_coefficient": st.floats(0, 0.3),
        "friction_force_N": st.floats(0, 300),
        "friction_torque_Nm": st.floats(0, 5),
        "counterweight_kg": st.floats(0, 300),
        "inertia_kgm2": st.floats(0, 0.1),
        "efficiency": st.floats(0.5, 1),
        "ratio": st.floats(0.5, 4),
    }
    size = {"rack_and_pinion": "diameter_mm", "belt": "diameter_mm", "ball_screw": "lead_mm"}
    mechanism = st.sampled_from(sorted(size)).flatmap(
        lambda kind: st.fixed_dictionaries(
            {"type": st.just(kind), "mass_kg": st.floats(1, 500), size[kind]: st.floats(5, 200)}, optional=common
        )
    )
    mechanism = mechanism.map(
        lambda one: one if one.get("incline_deg") else {k: v for k, v in one.items() if k != "counterweight_kg"}
    )
    return _of(mechanism, _moves("distance_mm", "speed_mm_per_s", 1.0, "acceleration_mm_per_s2", "external_force_N"))


def motions() -> st.SearchStrategy[Json]:
    """Any possible motion."""
    return rotary_motions() | linear_motions()
