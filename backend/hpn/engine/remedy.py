"""Changes that make a rejected gear fit, and the growth that each check leaves to its drivers, in words.

Based on the reserve's powers (`hpn.engine.reserve.MOVES`) and a candidate of the reply. Every bound in a sentence is
rounded to the safe side: an application changed accordingly passes.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace

from hpn.engine.candidates import BEARING_CHECKS, Candidate, CheckResult
from hpn.engine.check import Driver
from hpn.engine.checks import BY_CODE
from hpn.engine.reserve import MOVES
from hpn.physics.equations import ROUNDING
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Quantity, Sentence, listed

DIGITS = 4
"""Digits of a bound; a percentage has one less."""

LIVES = ("life", "output_bearing_life")
"""Checks that depend on two drivers: slower running mends them as well as a smaller torque or load."""

MOTOR_TORQUE_CHECKS = ("motor_peak_torque", "motor_rated_torque")
"""Checks without a closed form where the motor's torque is not proportional to the load's."""


@dataclass(frozen=True, slots=True)
class Way:
    """Factors on the drivers at which every load check that depends on them passes; 1 where a driver may stay.

    If the emergency stop exceeds a limit, the way has its largest torque, or its brake's, and as an alternative its
    largest number.
    """

    torque: float = 1.0
    speed: float = 1.0
    load: float = 1.0
    emergency_stop_torque_Nm: float | None = None
    emergency_stop_count: int | None = None
    brake_torque_Nm: float | None = None


def ways_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> tuple[Way, ...]:
    """Ways to make every load check of a rejected gear pass; each of them is enough.

    Empty if nothing is exceeded, or if a check can't be judged. Two if a life still fails after the changes for the
    other checks: less torque or load, or less speed. `reserve_utilisation` is the user's u.
    """
    if not candidate.is_judged:
        return ()
    u = reserve_utilisation
    used = {check.code: check.utilisation for check in candidate.checks if check.utilisation is not None}
    torque, speed, load = (_needed(used, u, driver, _is_open(candidate, driver)) for driver in MOVES)
    life = _excess(used.get("life", 0.0) * torque ** (10 / 3) * speed / u)
    bearing = _excess(used.get("output_bearing_life", 0.0) * load * speed ** (1 / 3) / u)
    stop = _stop(candidate, u)
    gentler = Way(torque * life**-0.3, speed, load / bearing, *stop)
    slower = Way(torque, speed / max(life, bearing**3), load, *stop)
    return () if gentler == Way() else (gentler,) if gentler == slower else (gentler, slower)


def _needed(used: Mapping[str, float], u: float, driver: Driver, is_open: bool) -> float:
    """Factor on a driver that its own checks need, those that no other driver influences.

    Where the driver has no closed form, a check against the user's own limit is left to a change of that limit.
    """
    rooms = [
        u / used[code]
        for code in MOVES[driver]
        if code in used and code not in LIVES and not (is_open and BY_CODE[code].accepted)
        if _excess(used[code] / u) > 1
    ]
    return min(rooms, default=1.0)


def slowing_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> float:
    """Factor on all speeds at which the checks that only speeds influence pass; 1 if they do.

    Beside a motor's torque curve, whose torque at this speed is another, it is where the other checks have to be tried.
    """
    used = {check.code: check.utilisation for check in candidate.checks if check.utilisation is not None}
    return _needed(used, reserve_utilisation, "speed", is_open=False)


def _is_open(candidate: Candidate, driver: Driver) -> bool:
    """True for a driver without a closed form on a judged gear: one of its checks is used, but the reserve has no
    factor.

    This holds for the torque where motor torques follow an efficiency curve or include the gear's no-load torque, and
    for torque and speed where they include the motor's own inertia, which follows the motion.
    """
    used = (check.utilisation or 0.0 for check in candidate.checks if check.code in MOVES[driver])
    return getattr(candidate.reserve, f"{driver}_factor") is None and any(share > _LEAST for share in used)


def _excess(relative: float) -> float:
    """Factor by which a utilisation exceeds its bound; 1 if it does not."""
    return relative if relative > 1 + ROUNDING else 1.0


def _stop(candidate: Candidate, u: float) -> tuple[float | None, int | None, float | None]:
    """Largest torque of the stop, largest number of stops and largest torque of its brake, if one is exceeded."""
    checks = {check.code: check for check in candidate.failing}
    torque, count = checks.get("momentary_peak_torque"), checks.get("momentary_peak_count")
    if not torque and not count:
        return None, None, None
    fewer = math.floor(u * (count.limit or 0) * (1 + ROUNDING)) if count and not torque else 0
    brake = candidate.reserve.brake_torque_Nm
    return None if brake is not None else candidate.reserve.emergency_stop_torque_Nm, fewer or None, brake


# --- Alternatives -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Requirement:
    """User's limit that must change: path of the input, its new value, and the clause about it."""

    path: str
    value: Quantity
    clause: str


@dataclass(frozen=True, slots=True)
class Alternative:
    """Changes that together make a rejected gear pass every check; at most one of them is about the emergency stop."""

    way: Way
    requirements: tuple[Requirement, ...] = ()


def alternatives_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> tuple[Alternative, ...]:
    """Alternatives that each make a rejected gear suitable, those with the fewest changes first.

    Each failing check has its change, though another change may mend it too: `tried.needed_of` removes needless ones.
    Empty for a gear that is not rejected, if a check can't be judged, and if only a driver without a closed form would
    do: the motor's torque then depends on its curve, or on the motion.
    """
    if candidate.status != "unsuitable" or not candidate.is_judged or not _is_known(candidate):
        return ()
    ways, changed = ways_of(candidate, reserve_utilisation), tuple(_requirements(candidate, reserve_utilisation))
    open_drivers = [driver for driver in MOVES if _is_open(candidate, driver)]
    closed = tuple(way for way in ways if all(getattr(way, driver) == 1 for driver in open_drivers))
    if ways and not closed:
        return ()
    ways = closed
    swings = candidate.reserve.brake_torque_Nm is not None and candidate.drive_resonance_Hz is not None
    if swings and any(
        change.path == LOAD_INERTIA for change in changed
    ):  # with it the stop by the brake passes unchanged
        ways = tuple(dict.fromkeys(replace(way, emergency_stop_count=None, brake_torque_Nm=None) for way in ways))
    if any(way.brake_torque_Nm == 0 for way in ways) or _never_stops(candidate):
        return ()
    alternatives = [Alternative(one, changed) for way in ways or (Way(),) for one in _by_stop(way)]
    return in_order(alternatives)


def _is_known(candidate: Candidate) -> bool:
    """False for a candidate of another version with an unknown check or without a reserve needed here."""
    codes = all(check.code in BY_CODE for check in candidate.failing)
    return codes and all(candidate.says(f"reserve.{driver}_factor") for driver in MOVES)


def in_order(alternatives: Iterable[Alternative]) -> tuple[Alternative, ...]:
    """Alternatives that change something, each once, those with the fewest changes first."""
    return tuple(sorted(filter(_clauses, dict.fromkeys(alternatives)), key=lambda one: len(_clauses(one))))


def parts_less(alternative: Alternative) -> Iterator[Alternative]:
    """Yield the alternative without one of its clauses, for each clause, the last first."""
    for requirement in reversed(alternative.requirements):
        yield replace(alternative, requirements=tuple(one for one in alternative.requirements if one != requirement))
    for change in reversed(fields(Way)):
        if getattr(alternative.way, change.name) != change.default:
            yield replace(alternative, way=replace(alternative.way, **{change.name: change.default}))


def _never_stops(candidate: Candidate) -> bool:
    """True where the brake does not stop the load; no smaller torque mends that."""
    return any(check.code == "momentary_peak_torque" and check.utilisation is None for check in candidate.failing)


def _by_stop(way: Way) -> Iterable[Way]:
    """Yield the way with a smaller emergency stop, and if that suffices with fewer of them."""
    yield replace(way, emergency_stop_count=None)
    if way.emergency_stop_count is not None:
        yield replace(way, emergency_stop_torque_Nm=None, brake_torque_Nm=None)


LOAD_INERTIA = "requirements.load_inertia_kgm2"
LESS_INERTIA = N_("the load’s inertia drops to {value}")
_AMBIENT = (N_("the ambient temperature drops to {value}"), N_("the ambient temperature rises to {value}"))


def _requirements(candidate: Candidate, u: float) -> Iterable[Requirement]:
    """Requirements that would pass, for failing checks without a closed form in any driver."""
    for check in candidate.failing:
        known = BY_CODE[check.code]
        inertia = candidate.reserve.load_inertia_kgm2
        if check.code == "natural_frequency" and inertia:  # 0 where no inertia lets the stop pass
            yield Requirement(LOAD_INERTIA, Quantity(inertia, "kgm2", DIGITS, "down"), LESS_INERTIA)
            continue
        if not known.trigger or check.demand is None or check.limit is None:
            continue
        if known.kind == "range":
            rises = check.demand < check.limit
            value = Quantity(check.limit, "degC", DIGITS, "up" if rises else "down")
            yield Requirement(known.trigger, value, _AMBIENT[rises])
        elif known.accepted and all(_is_open(candidate, driver) for driver in known.moves):
            least, allowed = known.kind == "minimum", known.allowed(u)
            needed = check.demand * (allowed if least else 1 / allowed)
            bound = Quantity(needed, suffix_of(known.trigger), DIGITS, "down" if least else "up")
            yield Requirement(known.trigger, bound, known.accepted)


# --- In words ---------------------------------------------------------------------------------------------------------

BY_CURVE = N_("no single factor: the efficiency follows your curve, or the gear’s no-load torque counts")
BY_INERTIA = N_("no single factor: the motor’s own inertia changes with the motion, or its torque with the speed")
BY_SHAFT = N_(
    "no single factor: pinion or pulley load the shaft, less with a larger pitch diameter, a smaller tension factor "
    "or a smaller distance x"
)
NOT_CLOSED = N_("The change that would make it fit is {reason}.")
"""Reasons for a missing factor, and the sentence that gives them."""

BEYOND_CURVE = N_("At least, speeds must drop to {value}: the motor’s torque is known up to {speed}.")
"""Sentence on a gear whose motor turns faster than its torque curve, where no change is known to suffice."""

_DRIVERS = {
    "torque": (N_("torques drop to {value}"), N_("torques to {value}")),
    "speed": (N_("speeds drop to {value}"), N_("speeds to {value}")),
    "load": (N_("output loads drop to {value}"), N_("output loads to {value}")),
}
_STOP_TORQUE = (N_("T_k drops to {value}"), N_("T_k to {value}"))
_BRAKE = (N_("the brake’s torque drops to {value}"), N_("the brake’s torque to {value}"))
_STOP_COUNT = (N_("N_k drops to {value}"), N_("N_k to {value}"))
"""Texts about a drop to a value: as the first clause of a sentence, and as a later one."""


def remedy_of(candidate: Candidate, alternatives: Iterable[Alternative]) -> Sentence | None:
    """Sentence on the alternatives that make a rejected gear fit, or on the reason why no closed form gives one.

    None for a gear that is not rejected, and if a check can't be judged, except beyond the motor's torque curve.
    """
    conditions = [condition_of(alternative) for alternative in alternatives]
    if not conditions:
        if beyond := _beyond_curve(candidate):
            return beyond
        reason = _reason(candidate) if candidate.status == "unsuitable" and candidate.is_judged else ""
        return Sentence(NOT_CLOSED, {"reason": reason}, ("reason",)) if reason else None
    if len(conditions) == 1:
        return Sentence(N_("Fits if {conditions}."), {"conditions": conditions[0]})
    numbered = [
        Sentence("({number}) {condition}", {"number": number, "condition": condition})
        for number, condition in enumerate(conditions, start=1)
    ]
    return Sentence(
        N_("Fits if one of these holds: {conditions}."), {"conditions": listed(numbered, "{first}; {rest}")}
    )


def _beyond_curve(candidate: Candidate) -> Sentence | None:
    """Sentence on the speed at which the torque curve of the motor ends; None for a motor within its curve."""
    speed, torques = candidate.check("motor_speed"), [candidate.check(code) for code in MOTOR_TORQUE_CHECKS]
    if speed is None or not speed.demand or not speed.limit or speed.status != "fail":
        return None
    if not any(check is not None and check.status == "not_rated" for check in torques):
        return None
    share = _bound(100 * speed.limit / speed.demand, "percent")
    return Sentence(BEYOND_CURVE, {"value": share, "speed": Quantity(speed.limit, "rpm", DIGITS, "down")})


def _reason(candidate: Candidate) -> str:
    """Reason for the missing closed form, a msgid; blank if there is one."""
    if not _is_known(candidate):
        return ""
    if _is_open(candidate, "load"):
        return BY_SHAFT
    by_curve = BY_CURVE if _is_open(candidate, "torque") else ""
    return BY_INERTIA if _is_open(candidate, "speed") else by_curve


def condition_of(alternative: Alternative) -> Sentence:
    """The changes of an alternative as a list in words: `a, b and c`."""
    *early, last = _clauses(alternative)
    if not early:
        return last
    return Sentence(N_("{first} and {second}"), {"first": listed(early, "{first}, {rest}"), "second": last})


def _clauses(alternative: Alternative) -> list[Sentence]:
    way, changes = alternative.way, []
    for driver, wording in _DRIVERS.items():
        if (factor := getattr(way, driver)) < 1:
            changes.append((wording, _bound(100 * factor, "percent")))
    if way.emergency_stop_torque_Nm is not None:
        changes.append((_STOP_TORQUE, _bound(way.emergency_stop_torque_Nm, "Nm", DIGITS)))
    if way.brake_torque_Nm is not None:
        changes.append((_BRAKE, _bound(way.brake_torque_Nm, "Nm", DIGITS)))
    if way.emergency_stop_count is not None:
        changes.append((_STOP_COUNT, _bound(way.emergency_stop_count, "", DIGITS)))
    drops = [Sentence(wording[place > 0], {"value": value}) for place, (wording, value) in enumerate(changes)]
    return drops + [Sentence(one.clause, {"value": one.value}) for one in alternative.requirements]


def _bound(value: float, unit: str, digits: int = 3) -> Quantity:
    return Quantity(value, unit, digits, "down")


# --- Reserve ----------------------------------------------------------------------------------------------------------

DRIVER_NAMES = {
    "torque": N_("All duty torques"),
    "speed": N_("All speeds"),
    "load": N_("All output loads"),
    "emergency_stop": N_("Emergency-stop torque"),
    "emergency_stop_count": N_("Emergency stops"),
}


@dataclass(frozen=True, slots=True)
class Growth:
    """Factor on one driver at which one check reaches its limit, the rest unchanged.

    None without a limit, and without a closed form: `reason` then says why.
    """

    driver: str
    factor: float | None
    reason: str = ""

    @property
    def change(self) -> float:
        """Size of the change, equal for more and for less: the factor or its inverse; infinite without a factor."""
        return math.inf if not self.factor else max(self.factor, 1 / self.factor)

    @property
    def bound(self) -> Sentence:
        """Text such as `up to 249 %`, rounded down."""
        if self.factor is None:
            return Sentence(self.reason or N_("without limit"))
        return Sentence(N_("up to {limit}"), {"limit": _bound(100 * self.factor, "percent")})

    @property
    def share(self) -> Quantity | None:
        """The same for a column of a table: 249 %."""
        return None if self.factor is None else _bound(100 * self.factor, "percent")


def growths_of(candidate: Candidate, reserve_utilisation: float = 1.0) -> dict[str, tuple[Growth, ...]]:
    """Growth of every driver by check of a candidate until that check is at its limit, the smallest change first.

    Below 1 where the check fails. Empty for a check that no driver influences, and for an unrated one. Without a factor
    for motor torques that depend on an efficiency curve, a no-load torque or an inertia, which have no closed form;
    empty for motor torques of an unjudged gear, whose reserve is unknown too.
    """
    reason = _reason(candidate)
    loaded = reason == BY_SHAFT
    without = (BEARING_CHECKS if loaded else ()) + (MOTOR_TORQUE_CHECKS if _is_open(candidate, "torque") else ())
    return {
        check.code: ()
        if (reason and check.code in without and not candidate.is_judged)
        or (candidate.lacks_lever and check.code in BEARING_CHECKS)
        else tuple(
            sorted(
                _growths(check, reserve_utilisation, reason if check.code in without else ""),
                key=lambda growth: growth.change,
            )
        )
        for check in candidate.checks
    }


def _growths(check: CheckResult, u: float, reason: str) -> Iterable[Growth]:
    if check.utilisation is None:
        return
    if check.code == "momentary_peak_torque":
        yield _growth("emergency_stop", check.utilisation / u, 1.0)
    elif check.code == "momentary_peak_count" and check.demand:
        most = None if check.limit is None else math.floor(u * check.limit * (1 + ROUNDING))
        yield Growth("emergency_stop_count", None if most is None else most / check.demand)
    for driver, power in BY_CODE[check.code].moves.items() if check.code in BY_CODE else ():
        yield Growth(driver, None, reason) if reason else _growth(driver, check.utilisation / u, power)


def _growth(driver: str, full: float, power: float) -> Growth:
    return Growth(driver, full ** (-1 / power) if full > _LEAST else None)


_LEAST = 1e-99
"""Share of a limit that counts as none: its inverse to the power 3 would overflow below it."""
