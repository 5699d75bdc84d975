"""The public contract of `select`, worked out slowly: one gear, one check, one phase at a time, in plain Python.

Written from the contract and the handbook alone, on the tests' own transcription; it shares no code with the product.
Where both agree on thousands of applications, a misreading would have to have been made twice.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tests.reference import handbook as book
from tests.reference.contract_bearing import at_centre, equivalent, of_wheel
from tests.reference.contract_curve import AlongCurve, along_curve
from tests.reference.contract_gears import FLOATS, Answer, Arithmetic, Candidate, Check, Gear, own_of, peak_of

ROOM = 1e-12
INFINITE = math.inf


def answer(application: Mapping[str, Any], gears: Sequence[Gear], by: Arithmetic = FLOATS) -> Answer:
    """Everything that the contract fixes of a reply, in its order.

    With another arithmetic than floats, application and gears have to be of its numbers.
    """
    wishes = application.get("requirements", {})
    chosen = [
        gear
        for gear in gears
        if (not wishes.get("sizes") or gear.size in wishes["sizes"])
        and (not wishes.get("ratios") or gear.ratio in wishes["ratios"])
    ]
    duty = _duty(application["duty_cycle"], by)
    result = Answer(
        {
            "average_torque_Nm": duty.T_av,
            "average_output_speed_rpm": duty.n_av,
            "maximum_torque_Nm": duty.T_max,
            "maximum_output_speed_rpm": duty.n_max,
        }
    )
    judged = [_judge(application, wishes, duty, gear, by) for gear in chosen]
    result.candidates = _ordered(judged, application.get("rank_by", "weight"))
    return result


@dataclass
class _Duty:
    T_av: float
    n_av: float
    T_max: float
    n_max: float
    T_rms: float


def _duty(cycle: Mapping[str, Any], by: Arithmetic) -> _Duty:
    phases, pause = cycle["phases"], cycle.get("pause_s", 0)
    T_max = max(peak_of(p, "torque_Nm") for p in phases)
    way = by.total(abs(p["speed_rpm"]) * p["duration_s"] for p in phases)
    time = by.total(p["duration_s"] for p in phases) + pause
    T_av = T_rms = by.number(0)
    if T_max > 0:
        shares = [
            (abs(p["speed_rpm"]) * p["duration_s"] / way, abs(p["torque_Nm"]) / T_max, p["duration_s"] / time)
            for p in phases
        ]
        T_av = T_max * by.total(w * r ** (by.number(10) / 3) for w, r, _ in shares) ** (by.number(3) / 10)
        squares = [(own_of(p, "rms_torque_Nm", "torque_Nm") / T_max) ** 2 for p in phases]
        T_rms = T_max * by.total(s * r for (_, _, s), r in zip(shares, squares, strict=True)) ** (by.number(1) / 2)
    return _Duty(T_av, way / time, T_max, max(peak_of(p, "speed_rpm") for p in phases), T_rms)


def _judge(
    application: Mapping[str, Any], wishes: Mapping[str, Any], duty: _Duty, gear: Gear, by: Arithmetic
) -> Candidate:
    u = wishes.get("utilisation", by.number(1))
    checks: list[Check] = []

    def compare(code: str, demand: float | None, limit: float | None, used: float | None, bound: float) -> None:
        status = "not_rated" if used is None else "pass" if used <= bound * (1 + ROOM) else "fail"
        checks.append(Check(code, demand, limit, used, status))

    def at_most(
        code: str, demand: float | None, limit: float | None, bound: float = u, least: float | None = None
    ) -> None:
        used = None if demand is None or limit is None else demand / limit
        if used is None and limit is not None and least is not None and least / limit > bound * (1 + ROOM):
            demand, used = least, least / limit
        compare(code, demand, limit, used, bound)
        if used is None and least is not None and limit is not None:
            checks[-1].at_least = least / limit

    def at_least(code: str, demand: float | None, limit: float, bound: float = u) -> None:
        compare(code, demand, limit, None if demand is None else limit / demand, bound)

    n_in_av, n_in_max = gear.ratio * duty.n_av, gear.ratio * duty.n_max
    life = None
    if gear.T_N is not None:
        life = INFINITE
        if duty.T_av > 0:
            life = 20000 * (book.RATED_INPUT_SPEED_RPM / n_in_av) * (gear.T_N / duty.T_av) ** (by.number(10) / 3)
    at_most("average_torque", duty.T_av, gear.T_N)
    at_most("repeated_peak_torque", duty.T_max, gear.T_R)

    allowed: float | None = None
    stop, T_k = application.get("emergency_stop"), None
    if stop is not None:
        T_k = abs(stop["torque_Nm"]) if "torque_Nm" in stop else _stop_torque(stop["brake"], wishes, gear)
        if _stops(stop.get("brake"), gear):
            at_most("momentary_peak_torque", T_k, gear.T_M)
        else:
            compare("momentary_peak_torque", T_k, gear.T_M, INFINITE, u)
        if gear.T_R is not None and T_k is not None:
            allowed = INFINITE
            if T_k > gear.T_R:
                allowed = by.floor(by.number(10) ** max(8.5 - 1.5 * T_k / gear.T_R, -300) * (1 + ROOM))
        if stop.get("count") is not None:
            used = None if allowed is None else INFINITE if allowed == 0 else stop["count"] / allowed
            compare("momentary_peak_count", stop["count"], allowed, used, u)

    at_most("average_input_speed", n_in_av, gear.n_av)
    at_most("maximum_input_speed", n_in_max, gear.n_max)
    if wishes.get("life_h") is not None:
        at_least("life", life, wishes["life_h"])

    bearing_life = _bearing(application, duty, gear, at_most, by)

    loss = gear.ratio * (wishes.get("efficiency") or 1.0)
    motor = wishes.get("motor") or {}
    curve, along, top = motor.get("curve"), AlongCurve(), motor.get("maximum_speed_rpm")
    if curve:
        along = along_curve(curve, application["duty_cycle"], gear.ratio, loss, by)
        at_most("motor_speed", n_in_max, min(curve[-1]["speed_rpm"], INFINITE if top is None else top))
        at_most("motor_peak_torque", along.demand, along.peak)
        at_most("motor_rated_torque", duty.T_rms / loss, along.continuous)
    else:
        for code, demand, key in (
            ("motor_speed", n_in_max, "maximum_speed_rpm"),
            ("motor_peak_torque", duty.T_max / loss, "peak_torque_Nm"),
            ("motor_rated_torque", duty.T_rms / loss, "rated_torque_Nm"),
            ("motor_rated_speed", n_in_av, "rated_speed_rpm"),
        ):
            if motor.get(key) is not None:
                at_most(code, demand, motor[key])
    load_checks = len(checks)

    temperature = wishes.get("ambient_temperature_degC")
    if temperature is not None:
        used, end = None, None
        if gear.ambient is not None:
            low, high = gear.ambient
            used = abs(temperature - (low + high) / 2) / ((high - low) / 2)
            end = high if temperature >= (low + high) / 2 else low
        compare("ambient_temperature", temperature, end, used, 1)
    if wishes.get("backlash_arcmin") is not None:
        at_most("backlash", gear.backlash, wishes["backlash_arcmin"], 1)
    if wishes.get("torsional_stiffness_Nm_per_rad") is not None:
        at_least("torsional_stiffness", gear.K3, wishes["torsional_stiffness_Nm_per_rad"], 1)
    error, frequency = _position_error(application, wishes, gear), None
    if gear.K3 is not None and wishes.get("load_inertia_kgm2") is not None:
        frequency = (gear.K3 / wishes["load_inertia_kgm2"]) ** (by.number(1) / 2) / (2 * math.pi)
    if wishes.get("natural_frequency_Hz") is not None:
        at_least("natural_frequency", frequency, wishes["natural_frequency_Hz"], 1)
    if wishes.get("position_error_arcmin") is not None:
        at_most("position_error", error, wishes["position_error_arcmin"], 1)
    elif wishes.get("position_error_mm") is not None:
        angle = wishes["position_error_mm"] / wishes["position_radius_mm"] * 10800 / math.pi
        at_most("position_error", error, angle, 1)
    if wishes.get("weight_kg") is not None:
        at_most("weight", gear.weight, wishes["weight_kg"], 1)
    if wishes.get("length_mm") is not None:
        at_most("length", gear.length, wishes["length_mm"], 1)
    if motor.get("inertia_ratio") is not None:
        reflected = wishes["load_inertia_kgm2"] / gear.ratio**2
        at_most("inertia_ratio", reflected / motor["inertia_kgm2"], motor["inertia_ratio"], 1)

    result = Candidate(
        gear,
        checks,
        {
            "average_input_speed_rpm": n_in_av,
            "maximum_input_speed_rpm": n_in_max,
            "life_L10_h": life,
            "momentary_peak_count": allowed,
            "bearing_life_L50_h": bearing_life,
            "bearing_life_L10_h": None if bearing_life is None else bearing_life / 5,
            "shortest_life_h": _shortest_life(application, life, bearing_life, checks),
            "motor_peak_torque_Nm": duty.T_max / loss,
            "motor_rated_torque_Nm": duty.T_rms / loss,
            "motor_thermal_torque_Nm": along.thermal,
            "motor_mean_speed_torque_Nm": along.mean_speed,
            "stop_torque_Nm": T_k,
            "natural_frequency_Hz": frequency,
            "wind_up_arcmin": None if gear.K3 is None else duty.T_max / gear.K3 * 10800 / math.pi,
            "position_error_arcmin": error,
        },
    )
    _conclude(result, load_checks)
    return result


def _shortest_life(
    application: Mapping[str, Any], life: float | None, bearing_life: float | None, checks: list[Check]
) -> float | None:
    """The smaller of gear life and judged bearing life; None where one of them is not rated."""
    if not any(check.code == "output_bearing_life" for check in checks):
        return life
    if life is None or bearing_life is None:
        return None
    return min(life, bearing_life / (5 if (application.get("output_load") or {}).get("life_basis") == "L10" else 1))


def _stops(brake: Mapping[str, Any] | None, gear: Gear) -> bool:
    """True for a stop whose brake, if it is one, is stronger at the gear than what pulls the load."""
    return brake is None or bool(gear.ratio * brake["torque_Nm"] > (brake.get("load_torque_Nm") or 0.0) * (1 + ROOM))


def _stop_torque(brake: Mapping[str, Any], wishes: Mapping[str, Any], gear: Gear) -> float | None:
    """T_k of a stop by the brake, without a motion."""
    J, J_m = wishes.get("load_inertia_kgm2"), (wishes.get("motor") or {}).get("inertia_kgm2")
    i, eta, T_B = gear.ratio, wishes.get("efficiency") or 1.0, brake["torque_Nm"]
    T_d = brake.get("load_torque_Nm") or 0.0
    T_o = T_d if brake.get("opposing_torque_Nm") is None else brake["opposing_torque_Nm"]
    T_r, B = max(i * T_B / eta, T_d), 1 / eta**2
    if J is not None and J_m is not None:
        lam = J / (i**2 * J_m)
        T_r, B = (lam * i * T_B + T_d) / (1 + eta * lam), (1 + lam / eta) / (1 + eta * lam)
    f = brake.get("dynamic_factor")
    if f is not None:
        return float(f * T_r + (f - 1) * T_o)
    if gear.K3 is None or gear.backlash is None:
        return None
    crossed = gear.K3 * gear.backlash * math.pi / 10800
    return float(T_r + math.sqrt(T_r**2 + 2 * T_r * (T_o + crossed) + B * T_o**2))


def _position_error(application: Mapping[str, Any], wishes: Mapping[str, Any], gear: Gear) -> float | None:
    if gear.accuracy is None or gear.K3 is None or gear.backlash is None:
        return None
    low, high = torque_range(application["duty_cycle"], wishes)
    error: float = gear.accuracy + (high - low) / gear.K3 * 10800 / math.pi
    return error + (gear.backlash if low <= 0 <= high else 0)


def torque_range(cycle: Mapping[str, Any], wishes: Mapping[str, Any]) -> tuple[Any, Any]:
    """T_lo and T_hi of typed phases."""
    reverses, friction = wishes.get("load_reverses"), wishes.get("rest_friction_Nm", 0)
    signed, torques = any(p["torque_Nm"] < 0 for p in cycle["phases"]), []
    for p in cycle["phases"]:
        if wishes.get("position_error_at") == "rest" and p["speed_rpm"] != 0:
            continue
        T, peak, R = p["torque_Nm"], peak_of(p, "torque_Nm"), friction if p["speed_rpm"] == 0 else 0
        least = p.get("least_torque_Nm")
        if least is None:
            steady = peak <= abs(T) * (1 + 1e-9) and own_of(p, "rms_torque_Nm", "torque_Nm") >= abs(T) * (1 - 1e-9)
            least = abs(T) if steady else 0
        ends = [-peak, peak] if T == 0 else [least, peak] if T > 0 else [-peak, -least]
        if T == 0 and reverses is False and not signed:
            ends = [least, peak]
        torques += [ends[0] - R, ends[1] + R]
    if cycle.get("pause_s"):
        torques += [-friction, friction]
    if reverses or (reverses is None and not signed):
        torques = [M := max(map(abs, torques)), -M]
    return min(torques), max(torques)


def _bearing(application: Mapping[str, Any], duty: _Duty, gear: Gear, at_most: Any, by: Arithmetic) -> float | None:
    """Both checks of the output bearing; its life L50."""
    phases = application["duty_cycle"]["phases"]
    inputs = application.get("output_load")
    own = any(p.get(key) is not None for p in phases for key in ("radial_N", "axial_N"))
    if inputs is None and not own:
        return None
    inputs = inputs or {}
    f_w = inputs.get("load_coefficient", by.number(1))
    loads = [
        tuple(
            abs(p[key] if p.get(key) is not None else inputs[key] if inputs.get(key) is not None else 0.0)
            for key in ("radial_N", "axial_N")
        )
        for p in phases
    ]
    loads = [(F_R + own[0], F_A + own[1]) for (F_R, F_A), own in zip(loads, of_wheel(phases, inputs, by), strict=True)]
    x, y, x_c = inputs.get("radial_position_mm"), inputs.get("axial_radius_mm", 0), inputs.get("shaft_centre_mm")
    if isinstance(x_c, Mapping):
        x_c = x_c.get(gear.size, x_c.get("others"))
    centred = [at_centre(F_R, F_A, x, y, x_c) for F_R, F_A in loads]
    P = [
        None if F_R is None else equivalent(inputs.get("model", "linear"), F_R, F_A, gear)
        for F_R, (_, F_A) in zip(centred, loads, strict=True)
    ]
    required = inputs.get("life_h", 20000) * (5 if inputs.get("life_basis") == "L10" else 1)
    k = (100 * 20000 / (duty.n_av * required)) ** (by.number(1) / 3)
    known = [p for p in P if p is not None]
    weights = [abs(p["speed_rpm"]) * p["duration_s"] for p in phases]

    def mean_of(loads: list[float]) -> Any:
        cubes = by.total(w * p**3 for w, p in zip(weights, loads, strict=True))
        return (cubes / by.total(weights)) ** (by.number(1) / 3)

    if len(known) < len(P):
        plain = [equivalent(inputs.get("model", "linear"), F_R, F_A, gear) for F_R, F_A in loads]
        least = [p for p in plain if p is not None]
        whole = len(least) == len(plain)
        at_most("output_bearing_load", None, 1.0, least=f_w * max(least) if whole else None)
        at_most("output_bearing_life", None, k, least=f_w * mean_of(least) if whole else None)
        return None
    mean = mean_of(known)
    at_most("output_bearing_load", f_w * max(known), 1.0)
    at_most("output_bearing_life", f_w * mean, k)
    return 20000 * (100 / duty.n_av) / (f_w * mean) ** 3 if mean > 0 else INFINITE


def _conclude(result: Candidate, load_checks: int) -> None:
    states = [check.status for check in result.checks]
    if "fail" in states:
        result.status = "unsuitable"
    elif "not_rated" in states:
        result.status = "unrated"
        return
    else:
        result.status = "suitable"
    counting = [check for place, check in enumerate(result.checks) if place < load_checks or check.status == "fail"]
    used = [(check.utilisation, check.code) for check in counting if check.utilisation is not None]
    result.utilisation = max(utilisation for utilisation, _ in used)
    result.governing = next(code for utilisation, code in used if utilisation >= result.utilisation * (1 - ROOM))


def _places(values: Sequence[float]) -> list[int]:
    """Places in ascending order; sorted neighbours that differ by less than 1e-12 of themselves share one."""
    places, place, before = [0] * len(values), 0, None
    for index in sorted(range(len(values)), key=values.__getitem__):
        value = values[index]
        if before is not None and value != before and not value - before < ROOM * abs(value) < INFINITE:
            place += 1
        places[index], before = place, value
    return places


def _judged(candidate: Candidate) -> float:
    """Largest utilisation, or lower bound of one, of what is judged of a gear."""
    return max(
        value for check in candidate.checks for value in (check.utilisation, check.at_least) if value is not None
    )


def _ordered(candidates: list[Candidate], rank_by: str) -> list[Candidate]:
    def last(value: float | None, sign: int = 1) -> float:
        return INFINITE if value is None else sign * value

    def ties(c: Candidate) -> tuple[float, ...]:
        return (last(c.gear.weight), last(c.utilisation), last(c.figures["life_L10_h"], -1), c.gear.ratio)

    def wish(c: Candidate) -> float:
        return {
            "weight": last(c.gear.weight),
            "utilisation": last(c.utilisation),
            "length": last(c.gear.length),
            "motor_torque": last(c.figures["motor_peak_torque_Nm"]),
            "life": last(c.figures["shortest_life_h"], -1),
            "stiffness": last(c.gear.K3, -1),
            "natural_frequency": last(c.figures["natural_frequency_Hz"], -1),
            "position_error": last(c.figures["position_error_arcmin"]),
        }[rank_by]

    def ordered(status: str, first: Callable[[Candidate], float]) -> list[Candidate]:
        some = [c for c in candidates if (c.lacks_input if status == "lacking" else c.status == status)]
        keys = zip(*map(_places, zip(*[(first(c), *ties(c)) for c in some], strict=True)), strict=True)
        return [c for _, _, c in sorted(zip(keys, itertools.count(), some, strict=False), key=lambda entry: entry[:2])]

    good, bad = ordered("suitable", wish), ordered("unsuitable", lambda c: last(c.utilisation))
    for place, c in enumerate(good):
        c.rank = place + 1
    lacking = ordered("lacking", _judged)
    return good + lacking + bad + [c for c in candidates if c.status == "unrated" and not c.lacks_input]
