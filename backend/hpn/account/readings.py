"""Demand and limit of each check in an engineer's terms.

The two checks of the output bearing compare pure numbers (f_w P with 1 and k). Shown instead are the load in N beside
the published maximum in its own direction, and the life beside the required one, both on the requested basis: the same
comparisons, since P grows in proportion with a load along its direction and the life with its power -3.
"""

import math
from dataclasses import dataclass

import numpy as np

from hpn.account.lines import drive_limit
from hpn.application import Application, LifeBasis, Motor, OutputLoad
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate, CheckResult, LifeOf
from hpn.engine.check import Kind
from hpn.engine.checks import BY_CODE
from hpn.engine.duty import Duty
from hpn.engine.figures import phase_loads
from hpn.engine.notices import on_torque_limit
from hpn.engine.selection import Selection
from hpn.words.quantities import CANDIDATE
from hpn.words.wording import N_, Quantity, Sentence, Value, listed

OTHERWISE = {"≤": ">", "≥": "<"}
"""Sign of a passing check between demand and limit -> sign of a failing one."""


@dataclass(frozen=True, slots=True)
class CheckReading:
    """Demand and limit in `unit`, a suffix or symbol; None without one, or where nothing limits the demand.

    `part` is the factor of the user's own u on the limit, for a minimum the divisor. `limit_name` is a msgid,
    `relation` the comparison in symbols. If it `is_unlimited`, the larger side is above every number: the demand of a
    minimum, the limit of a maximum.
    """

    demand: float | None
    limit: float | None
    unit: str
    kind: Kind
    limit_name: str
    relation: str
    part: float = 1.0
    is_unlimited: bool = False

    @property
    def has_unlimited_demand(self) -> bool:
        """True for a demand above every number, such as the life without a torque."""
        return self.is_unlimited and self.kind == "minimum"

    @property
    def has_unlimited_limit(self) -> bool:
        """True for a limit above every number, such as the number of stops below the repeated peak torque."""
        return self.is_unlimited and self.kind != "minimum"

    @property
    def bound(self) -> float | None:
        """Limit with the user's own u; None without a limit."""
        if self.limit is None:
            return None
        return self.limit / self.part if self.kind == "minimum" else self.limit * self.part

    @property
    def sign(self) -> str:
        """Required sign between demand and limit."""
        return "≥" if self.kind == "minimum" else "≤"

    def actual_sign(self, failed: bool) -> str:
        """Actual sign between demand and limit."""
        return OTHERWISE[self.sign] if failed else self.sign


@dataclass(frozen=True, slots=True)
class Life:
    """A life in hours with its check and basis; None if unlimited."""

    check: str
    life_h: float | None
    basis: LifeBasis

    @property
    def hours(self) -> float:
        """The life in hours; infinite if unlimited."""
        return math.inf if self.life_h is None else self.life_h

    @property
    def sentence(self) -> Sentence:
        """The life with its basis, such as "68 678 h (bearing L50)"."""
        if self.life_h is None:
            return Sentence(N_("unlimited"))
        text = N_("{life} (gear {basis})") if self.check == "life" else N_("{life} (bearing {basis})")
        return Sentence(text, {"life": Quantity(self.life_h, "h"), "basis": self.basis})


def shortest_life(candidate: Candidate) -> Life | None:
    """Shortest life of a gear, with its check; None if a life is not rated, or missing in the reply."""
    loaded = candidate.check("output_bearing_life") is not None
    endless = candidate.is_unlimited("life_L10_h") and (not loaded or candidate.is_unlimited("bearing_life_L50_h"))
    known = endless or candidate.shortest_life_h is not None
    return life_of(candidate.shortest_life_h, candidate.shortest_life_of) if known else None


def life_of(life_h: float | None, of: LifeOf | None) -> Life:
    """A shortest life from a reply; unlimited without a number."""
    if of is None:
        return Life("life", None, "L10")
    return Life("life" if of == "gear_L10" else "output_bearing_life", life_h, "L50" if of == "bearing_L50" else "L10")


AT_MOTOR = {"motor_peak_torque_Nm": "T_in,max", "motor_rated_torque_Nm": "T_in,rms"}
"""Symbols of motor torques that include inertia or no-load torque, and so are more than a quotient of the load's
torque.
"""

_RELATIONS = {"motor_peak_torque": "T_in,max ≤ T_mot", "motor_rated_torque": "T_in,rms ≤ T_mot,N"}
ALONG_CURVE = {"motor_peak_torque": "T_in ≤ M_p(n)", "motor_rated_torque": "T_in,rms ≤ M_c"}
"""Comparisons of a motor with a torque curve, at the point nearest to it and by its continuous torque."""


def adds_at_motor(selection: Selection, gear: Gear | None) -> bool:
    """True if motor torques include more than the load's torque; the gear's figures may be unknown."""
    return selection.adds_at_motor or (gear is not None and gear.no_load_torque_Nm is not None)


def figure_symbol(name: str, *, adds_at_motor: bool) -> str:
    """Symbol of a candidate's figure; `adds_at_motor` is True if motor torques include more than the load's torque."""
    own = AT_MOTOR.get(name) if adds_at_motor else None
    return own or CANDIDATE[name].symbol


def relation_of(code: str, *, adds_at_motor: bool, has_curve: bool = False) -> str:
    """Comparison of a check in symbols; blank for a check of another version."""
    if has_curve and code in ALONG_CURVE:
        return ALONG_CURVE[code]
    if adds_at_motor and code in _RELATIONS:
        return _RELATIONS[code]
    return BY_CODE[code].relation if code in BY_CODE else ""


def readings_of(
    candidate: Candidate,
    selection: Selection,
    application: Application | None,
    catalogue: Catalogue | None,
) -> dict[str, CheckReading]:
    """Readings of a candidate's checks by code; without application or catalogue as computed."""
    load = application.loads if application else None
    gear = catalogue.by_designation.get(candidate.designation) if catalogue else None
    u = application.requirements.utilisation if application else 1.0
    readings: dict[str, CheckReading] = {}
    for check in candidate.checks:
        reading = None
        if check.code == "output_bearing_life" and load and candidate.says(f"bearing_life_{load.life_basis}_h"):
            reading = _bearing_life(candidate, check, load, u)
        if check.code == "output_bearing_load" and application and load and catalogue and gear:
            reading = _bearing_load(check, application, load, catalogue, gear, u)
        readings[check.code] = reading or _as_computed(check, selection, application, gear)
    return readings


def _as_computed(
    check: CheckResult, selection: Selection, application: Application | None, gear: Gear | None
) -> CheckReading:
    known, definition = BY_CODE.get(check.code), selection.check_definitions[check.code]
    u = application.requirements.utilisation if application else 1.0
    motor = application.requirements.motor if application else None
    has_curve = motor is not None and motor.curve is not None
    part = known.allowed(u) if known else 1.0
    relation = relation_of(check.code, adds_at_motor=adds_at_motor(selection, gear), has_curve=has_curve)
    larger = check.demand if definition.kind == "minimum" else check.limit
    unlimited = larger is None and check.utilisation is not None
    return CheckReading(
        check.demand, check.limit, definition.unit, definition.kind, definition.limit_name, relation, part, unlimited
    )


_REQUIRED = {"L50": N_("L50 required"), "L10": N_("L10 required")}


def _bearing_life(candidate: Candidate, check: CheckResult, load: OutputLoad, u: float) -> CheckReading:
    """Life on the basis of the required one. Within the share u of the permissible load the required life becomes L /
    u³.
    """
    basis = load.life_basis
    life = candidate.bearing_life_L50_h if basis == "L50" else candidate.bearing_life_L10_h
    relation = f"L_b,{basis[1:]} ≥ L_b"
    unlimited = life is None and check.utilisation is not None
    return CheckReading(life, load.life_h, "h", "minimum", _REQUIRED[basis], relation, u**3, unlimited)


def _bearing_load(
    check: CheckResult, application: Application, load: OutputLoad, catalogue: Catalogue, gear: Gear, u: float
) -> CheckReading | None:
    """Load vector of the worst phase times f_w, and its largest permissible length in its own direction; None without a
    load.
    """
    if not check.demand:
        return None
    duty = Duty.of([application])
    used = phase_loads(duty, catalogue.listed([gear]))[0, 0]
    worst = int(np.argmax(used))
    radial, axial = duty.phases.radial_N[0, 0, worst], duty.phases.axial_N[0, 0, worst]
    demand = load.load_coefficient * float(np.hypot(radial, axial))
    name = N_("maximum in this direction")
    return CheckReading(demand, demand / check.demand, "N", "maximum", name, "f_w · F ≤ F_max", u)


LIMIT, WITHIN = (
    N_("Set the drive’s torque limit to {limit}."),
    N_("Set the drive’s torque limit to {limit}, {share} of the motor’s peak torque."),
)
NO_LIMIT = N_("The motor’s peak torque of {peak} stays within the drive’s torque limit of {limit}.")


@dataclass(frozen=True, slots=True)
class TorqueLimit:
    """Sentences on the torque limit of the drive; `warns` if motor or cycle exceeds it."""

    lines: tuple[Sentence, ...] = ()
    warns: bool = False


def torque_limit_of(candidate: Candidate, gear: Gear | None, application: Application | None) -> TorqueLimit:
    """Torque limit of the drive on a gear, with a further line if the cycle needs more.

    Empty if unknown; without the gear's figures or the motor's peak torque only the limit. The application must have
    the figures of its listed motor.
    """
    limit, need = candidate.motor_torque_limit_Nm, candidate.motor_peak_torque_Nm
    if limit is None:
        return TorqueLimit()
    motor = application.requirements.motor if application else None
    peak = (motor and motor.largest_torque_Nm) or math.nan
    need = math.nan if need is None else need
    warnings = on_torque_limit(gear, limit_Nm=limit, need_Nm=need, peak_Nm=peak) if gear else ()
    sentences = {notice.code: notice.sentence for notice in warnings}
    values: dict[str, Value] = {
        "limit": drive_limit(limit),
        "share": Quantity(100 * limit / peak, "percent", 3, "down"),
        "peak": Quantity(peak, "Nm", 6),
    }
    plain = Sentence(LIMIT if math.isnan(peak) else NO_LIMIT if peak <= limit else WITHIN, values)
    warns = bool(sentences)
    return TorqueLimit((sentences.pop("gear_below_motor", plain), *sentences.values()), warns)


BOTH_RULES = N_(
    "Thermal load of the motor: {balance} by the balance of its losses along the curve (RMS {rms} of {thermal}), "
    "{makers} by the makers’ rule (of {at_mean} at the mean speed); the worse counts."
)


def thermal_of(*, rms_Nm: float | None, thermal_Nm: float | None, at_mean_Nm: float | None) -> Sentence | None:
    """Both rules of a motor with a torque curve in words; None without a curve, and beyond its last speed."""
    if rms_Nm is None or not thermal_Nm or not at_mean_Nm or math.isnan(thermal_Nm):
        return None
    values: dict[str, Value] = {
        "balance": Quantity(100 * rms_Nm / thermal_Nm, "percent", 3),
        "makers": Quantity(100 * rms_Nm / at_mean_Nm, "percent", 3),
        "rms": Quantity(rms_Nm, "Nm"),
        "thermal": Quantity(thermal_Nm, "Nm"),
        "at_mean": Quantity(at_mean_Nm, "Nm"),
    }
    return Sentence(BOTH_RULES, values)


def thermal_of_candidate(candidate: Candidate) -> Sentence | None:
    """Both rules for a candidate; None for an answer whose version did not know curves."""
    if not candidate.says("motor_thermal_torque_Nm"):
        return None
    return thermal_of(
        rms_Nm=candidate.motor_rated_torque_Nm,
        thermal_Nm=candidate.motor_thermal_torque_Nm,
        at_mean_Nm=candidate.motor_mean_speed_torque_Nm,
    )


OF_CURVE = N_("Between the points of the motor’s curve its torque is taken as a straight line.")
OF_ONE_POINT = N_(
    "Of the motor one rated point is known: its rated torque is taken as continuous up to its rated speed, its peak "
    "torque as available up to its maximum speed."
)


def assumed_of(motor: Motor | None) -> Sentence:
    """Assumption on a motor's torque between and beyond its known points."""
    return Sentence(OF_CURVE if motor is not None and motor.curve else OF_ONE_POINT)


def stiffness_of(candidate: Candidate) -> Sentence:
    """Natural frequency and position error of a candidate in words, if known."""
    f, error = candidate.natural_frequency_Hz, candidate.position_error_arcmin
    known = [
        Sentence(text, {"value": Quantity(value, unit)})
        for text, value, unit in (
            (N_("natural frequency {value}"), f, "Hz"),
            (N_("position error {value}"), error, "arcmin"),
        )
        if value is not None
    ]
    return listed(known, "{first}, {rest}") if known else Sentence("")
