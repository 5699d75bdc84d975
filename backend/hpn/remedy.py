"""What would make a rejected gear fit, and how far the drivers of a suitable one may grow, in words.

Built on the reserve's powers (`hpn.reserve.MOVES`) and on a candidate of the reply. Every bound in a sentence is
rounded to the safe side, so that following the words passes.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

from hpn.application import Application
from hpn.check import Driver
from hpn.checks import BY_CODE
from hpn.equations import ROUNDING
from hpn.gear import Gear
from hpn.reserve import MOVES
from hpn.selection import Candidate
from hpn.units import suffix_of
from hpn.wording import N_, Quantity, Sentence, rounded

LIVES = ("life", "output_bearing_life")
"""Checks that two drivers move: slower running mends them as well as a smaller torque or load."""

_MOTOR_TORQUES = {
    "motor_peak_torque": N_("the motor's peak torque is at least {value}"),
    "motor_rated_torque": N_("the motor's rated torque is at least {value}"),
}


@dataclass(frozen=True, slots=True)
class Way:
    """Factors on the drivers with which every load check passes that they move; 1 where one may stay as it is.

    The emergency stop has its largest torque, and as an alternative its largest number, where one is exceeded.
    """

    torque: float = 1.0
    speed: float = 1.0
    load: float = 1.0
    emergency_stop_torque_Nm: float | None = None
    emergency_stop_count: int | None = None


def ways_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> tuple[Way, ...]:
    """Ways to make every load check of a rejected gear pass; any one of them is enough.

    None where nothing is exceeded, and where not every check can be judged.
    Where a life fails beyond what the other checks ask for anyway there are two: less torque or load, or less speed.
    `reserve_utilisation` is the user's u.
    """
    if not candidate.is_judged:
        return ()
    u = reserve_utilisation
    used = {check.code: check.utilisation for check in candidate.checks if check.utilisation is not None}
    curve = candidate.reserve.torque_factor is None  # motor torques that no closed form follows
    torque, speed, load = (_needed(used, u, driver, curve) for driver in MOVES)
    life = _excess(used.get("life", 0.0) * torque ** (10 / 3) * speed / u)
    bearing = _excess(used.get("output_bearing_life", 0.0) * load * speed ** (1 / 3) / u)
    stop = _stop(candidate, u)
    gentler = Way(torque * life**-0.3, speed, load / bearing, *stop)
    slower = Way(torque, speed / max(life, bearing**3), load, *stop)
    return () if gentler == Way() else (gentler,) if gentler == slower else (gentler, slower)


def _needed(used: Mapping[str, float], u: float, driver: Driver, curve: bool) -> float:
    """Factor on a driver that the checks ask for which no other driver moves."""
    rooms = [
        u / used[code]
        for code in MOVES[driver]
        if code in used and code not in LIVES and not (curve and code in _MOTOR_TORQUES)
        if _excess(used[code] / u) > 1
    ]
    return min(rooms, default=1.0)


def _excess(relative: float) -> float:
    """How far a utilisation lies above its bound, as a factor; 1 where it does not."""
    return relative if relative > 1 + ROUNDING else 1.0


def _stop(candidate: Candidate, u: float) -> tuple[float | None, int | None]:
    checks = {check.code: check for check in candidate.failing}
    torque, count = checks.get("momentary_peak_torque"), checks.get("momentary_peak_count")
    if not torque and not count:
        return None, None
    fewer = math.floor(u * (count.limit or 0) * (1 + ROUNDING)) if count and not torque else 0
    return candidate.reserve.emergency_stop_torque_Nm, fewer or None


def followed(application: Application, way: Way) -> Application:
    """The application changed by a way, with its figures as the words print them."""
    torque, speed, load = (_printed(factor, 3) for factor in (way.torque, way.speed, way.load))
    phases = tuple(
        phase.model_copy(
            update={
                "torque_Nm": _scaled(phase.torque_Nm, torque),
                "speed_rpm": _scaled(phase.speed_rpm, speed),
                "radial_N": _scaled(phase.radial_N, load),
                "axial_N": _scaled(phase.axial_N, load),
            }
        )
        for phase in application.duty_cycle.phases
    )
    parts: dict[str, Any] = {"duty_cycle": application.duty_cycle.model_copy(update={"phases": phases})}
    if (given := application.output_load) is not None:
        loads = {name: _scaled(getattr(given, name), load) for name in ("radial_N", "axial_N")}
        parts["output_load"] = given.model_copy(update={k: v for k, v in loads.items() if v is not None})
    if (stop := application.emergency_stop) is not None and way.emergency_stop_torque_Nm is not None:
        limit = _printed(way.emergency_stop_torque_Nm, 4)
        parts["emergency_stop"] = stop.model_copy(update={"torque_Nm": math.copysign(limit, stop.torque_Nm)})
    return application.model_copy(update=parts)


def _printed(value: float, digits: int) -> float:
    return value if value == 1 else float(rounded(value, digits, "down"))


def _scaled(value: float | None, factor: float) -> float | None:
    """A figure by a factor, as somebody would type it: without the last digits of floating point."""
    if value is None or factor == 1:
        return value
    return math.copysign(float(rounded(abs(value * factor), 12, "down")), value)


# --- In words ---------------------------------------------------------------------------------------------------------

_CLAUSES = {
    "torque": (N_("the duty torques are at most {factor} of these"), N_("the duty torques at most {factor} of these")),
    "speed": (N_("the speeds are at most {factor} of these"), N_("the speeds at most {factor} of these")),
    "load": (N_("the output loads are at most {factor} of these"), N_("the output loads at most {factor} of these")),
}
"""What is asked of a driver, as the first clause of a sentence and as a later one."""

_STOP = (N_("T_k is at most {limit}"), N_("T_k at most {limit}"))
_FEWER = (
    N_("T_k is at most {limit} or the number of stops at most {count}"),
    N_("T_k at most {limit} or the number of stops at most {count}"),
)


def remedy_of(candidate: Candidate, gear: Gear, reserve_utilisation: float = 1.0) -> Sentence | None:
    """What makes a rejected gear fit; None for one that is suitable, and where not every check can be judged."""
    if candidate.status != "unsuitable" or not candidate.is_judged:
        return None
    found, motors = ways_of(candidate, reserve_utilisation), list(_motors(candidate, reserve_utilisation))
    if motors and any(way.torque < 1 for way in found):
        return None  # what the motor has to give at a smaller torque is a matter of the curve
    ways, accepted = [_way(way) for way in found], _joined([*motors, *_accepted(candidate, gear, reserve_utilisation)])
    if not ways:
        return Sentence(N_("Fits if {conditions}."), {"conditions": accepted}) if accepted else None
    conditions = reduce(_or, ways)
    if accepted is None:
        return Sentence(N_("Fits if {conditions}."), {"conditions": conditions})
    template = N_("Fits if {conditions}, and if {accepted}.")
    if len(ways) > 1:
        template = N_("Fits if {conditions}; either way only if {accepted}.")
    return Sentence(template, {"conditions": conditions, "accepted": accepted})


def _way(way: Way) -> Sentence:
    clauses: list[Sentence] = []
    for driver, wording in _CLAUSES.items():
        if (factor := getattr(way, driver)) < 1:
            clauses.append(Sentence(wording[bool(clauses)], {"factor": _bound(factor, "")}))
    if (limit := way.emergency_stop_torque_Nm) is not None:
        later = bool(clauses)
        if way.emergency_stop_count:
            values = {"limit": _bound(limit, "Nm", 4), "count": _bound(way.emergency_stop_count, "", 16)}
            clauses.append(Sentence(_FEWER[later], values))
        else:
            clauses.append(Sentence(_STOP[later], {"limit": _bound(limit, "Nm", 4)}))
    joined = _joined(clauses)
    assert joined is not None  # `ways_of` leaves out a way that changes nothing
    return joined


def _bound(value: float, unit: str, digits: int = 3) -> Quantity:
    return Quantity(value, unit, digits, "down")


def _motors(candidate: Candidate, u: float) -> Iterable[Sentence]:
    """What the motor has to give where its torque follows an efficiency curve."""
    if candidate.reserve.torque_factor is not None:
        return
    for check in candidate.failing:
        if check.code in _MOTOR_TORQUES:
            yield Sentence(_MOTOR_TORQUES[check.code], {"value": Quantity((check.demand or 0.0) / u, "Nm", 4, "up")})


def _accepted(candidate: Candidate, gear: Gear, u: float) -> Iterable[Sentence]:
    """What would have to be accepted of the gear as it is."""
    for check in candidate.failing:
        known = BY_CODE[check.code]
        if check.code == "ambient_temperature":
            low, high = gear.ambient_temperature_minimum_degC, gear.ambient_temperature_maximum_degC
            assert low is not None and high is not None  # a check that fails was rated
            values = {"low": Quantity(low, "degC", 4), "high": Quantity(high, "degC", 4)}
            yield Sentence(N_("the ambient temperature lies between {low} and {high}"), values)
        elif known.accepted:
            unit, allowed = suffix_of(known.asked or "") or "", known.allowed(u)
            least = known.kind == "minimum"
            value = (check.demand or 0.0) * (allowed if least else 1 / allowed)
            yield Sentence(known.accepted, {"value": Quantity(value, unit, 6, "down" if least else "up")})


def _joined(clauses: list[Sentence]) -> Sentence | None:
    """Clauses as a list in words: `a, b and c`."""
    if not clauses:
        return None
    *early, last = clauses
    if not early:
        return last
    joined = Sentence(N_("{first} and {second}"), {"first": early.pop(), "second": last})
    for clause in reversed(early):
        joined = Sentence(N_("{first}, {rest}"), {"first": clause, "rest": joined})
    return joined


def _or(first: Sentence, second: Sentence) -> Sentence:
    return Sentence(N_("{first}, or if {second}"), {"first": first, "second": second})


# --- Room -------------------------------------------------------------------------------------------------------------

DRIVER_NAMES = {
    "torque": N_("All duty torques"),
    "speed": N_("All speeds"),
    "load": N_("All output loads"),
    "emergency_stop": N_("Emergency-stop torque"),
}


@dataclass(frozen=True, slots=True)
class Room:
    """How far one driver may go: in words, and the check that limits it then. `value` is None without a limit."""

    driver: str
    value: float | None
    bound: Sentence
    check: str | None

    @property
    def exceeded(self) -> bool:
        """Whether the driver is beyond what it may be."""
        return self.driver != "emergency_stop" and self.value is not None and self.value < 1 - ROUNDING


def rooms_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> tuple[Room, ...]:
    """Reserve of every driver, each with the check that limits it; empty where not every check can be judged."""
    if not candidate.is_judged:
        return ()
    used = {check.code: check.utilisation for check in candidate.checks}
    rooms = [
        _room(driver, getattr(candidate.reserve, f"{driver}_factor"), used, reserve_utilisation)
        for driver, powers in MOVES.items()
        if powers.keys() & used.keys()
    ]
    stop = candidate.reserve.emergency_stop_torque_Nm
    if stop is not None:
        limit = _limit_of_stop(candidate, stop, reserve_utilisation)
        bound = Sentence(N_("up to {limit}"), {"limit": _bound(stop, "Nm", 4)})
        rooms.append(Room("emergency_stop", stop, bound, limit))
    return tuple(rooms)


def _room(driver: Driver, factor: float | None, used: Mapping[str, float | None], u: float) -> Room:
    full = {code: (used[code] or 0.0) / u for code in MOVES[driver] if code in used}
    if factor is None:
        if any(full.values()):
            return Room(driver, None, Sentence(N_("not in closed form: the efficiency follows your curve")), None)
        return Room(driver, None, Sentence(N_("without limit")), None)
    first = max(full, key=lambda code: full[code] ** (1 / MOVES[driver][code]))
    return Room(driver, factor, Sentence(N_("up to {factor} times"), {"factor": _bound(factor, "")}), first)


def _limit_of_stop(candidate: Candidate, largest: float, u: float) -> str:
    """Which of the two checks holds the emergency-stop torque at its largest."""
    check = candidate.check("momentary_peak_torque")
    full = check is not None and check.limit is not None and largest >= u * check.limit * (1 - ROUNDING)
    return "momentary_peak_torque" if full else "momentary_peak_count"
