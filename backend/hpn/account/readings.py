"""Demand and limit of each check as an engineer reads them.

The two checks of the output bearing compare pure numbers (f_w P with 1 and k). Shown instead are the load in N beside
the published maximum in its own direction, and the life beside the required one, both on the basis asked for: the same
comparisons, since P grows in proportion with a load along its direction and the life with its power -3.
"""

import math
from dataclasses import dataclass

import numpy as np

from hpn.application import Application, LifeBasis, OutputLoad
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
"""Sign between demand and limit of a failing check, by the sign of one that passes."""


@dataclass(frozen=True, slots=True)
class CheckReading:
    """Demand and limit in `unit`, a suffix or symbol; None where there is none, or where nothing limits the demand.

    `part` is the share of the limit that the user's own u leaves: the limit times it, for a minimum over it.
    `limit_name` is a msgid, `relation` the comparison in symbols. Where it `is_unlimited`, the larger side is above
    every number: the demand of a minimum, the limit of a maximum.
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
        """True for a limit above every number, such as that of stops below the repeated peak torque."""
        return self.is_unlimited and self.kind != "minimum"

    @property
    def bound(self) -> float | None:
        """Limit that the user's own u leaves; None where there is no limit."""
        if self.limit is None:
            return None
        return self.limit / self.part if self.kind == "minimum" else self.limit * self.part

    @property
    def sign(self) -> str:
        """Sign between demand and limit that the check requires."""
        return "≥" if self.kind == "minimum" else "≤"

    def found(self, failed: bool) -> str:
        """Sign between demand and limit as they are."""
        return OTHERWISE[self.sign] if failed else self.sign


@dataclass(frozen=True, slots=True)
class Life:
    """A life in hours by the name of the check that it belongs to, on a basis; None where it is unlimited."""

    check: str
    life_h: float | None
    basis: LifeBasis

    @property
    def hours(self) -> float:
        """The life in hours; infinite where it is unlimited."""
        return math.inf if self.life_h is None else self.life_h

    @property
    def sentence(self) -> Sentence:
        """The life with its basis, such as "68 678 h (bearing L50)"."""
        if self.life_h is None:
            return Sentence(N_("unlimited"))
        text = N_("{life} (gear {basis})") if self.check == "life" else N_("{life} (bearing {basis})")
        return Sentence(text, {"life": Quantity(self.life_h, "h"), "basis": self.basis})


def shortest_life(candidate: Candidate) -> Life | None:
    """Shortest life of a gear, by the check that it belongs to; None where one is not rated, or no reply has it."""
    loaded = candidate.check("output_bearing_life") is not None
    endless = candidate.is_unlimited("life_L10_h") and (not loaded or candidate.is_unlimited("bearing_life_L50_h"))
    known = endless or candidate.shortest_life_h is not None
    return life_of(candidate.shortest_life_h, candidate.shortest_life_of) if known else None


def life_of(life_h: float | None, of: LifeOf | None) -> Life:
    """A shortest life as a reply has it; unlimited without a number."""
    if of is None:
        return Life("life", None, "L10")
    return Life("life" if of == "gear_L10" else "output_bearing_life", life_h, "L50" if of == "bearing_L50" else "L10")


AT_MOTOR = {"motor_peak_torque_Nm": "T_in,max", "motor_rated_torque_Nm": "T_in,rms"}
"""Symbols of torques at the motor to which inertia or no-load torque adds: no quotient of the load's torque."""

_RELATIONS = {"motor_peak_torque": "T_in,max ≤ T_mot", "motor_rated_torque": "T_in,rms ≤ T_mot,N"}


def adds_at_motor(selection: Selection, gear: Gear | None) -> bool:
    """True where more than the load's torque counts at the motor of a gear, whose figures may be unknown."""
    return selection.adds_at_motor or (gear is not None and gear.no_load_torque_Nm is not None)


def figure_symbol(name: str, *, adds_at_motor: bool) -> str:
    """Symbol of a candidate's figure; `adds_at_motor` says whether more than the load's torque counts there."""
    own = AT_MOTOR.get(name) if adds_at_motor else None
    return own or CANDIDATE[name].symbol


def relation_of(code: str, *, adds_at_motor: bool) -> str:
    """Comparison of a check in symbols; blank for a check that this version does not know."""
    if adds_at_motor and code in _RELATIONS:
        return _RELATIONS[code]
    return BY_CODE[code].relation if code in BY_CODE else ""


def readings_of(
    candidate: Candidate,
    selection: Selection,
    application: Application | None,
    catalogue: Catalogue | None,
) -> dict[str, CheckReading]:
    """Readings of a candidate's checks by code; as they were computed where application or catalogue is not known."""
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
        readings[check.code] = reading or _as_computed(check, selection, gear, u)
    return readings


def _as_computed(check: CheckResult, selection: Selection, gear: Gear | None, u: float) -> CheckReading:
    known, definition = BY_CODE.get(check.code), selection.check_definitions[check.code]
    part = known.allowed(u) if known else 1.0
    relation = relation_of(check.code, adds_at_motor=adds_at_motor(selection, gear))
    larger = check.demand if definition.kind == "minimum" else check.limit
    unlimited = larger is None and check.utilisation is not None
    return CheckReading(
        check.demand, check.limit, definition.unit, definition.kind, definition.limit_name, relation, part, unlimited
    )


_REQUIRED = {"L50": N_("L50 required"), "L10": N_("L10 required")}


def _bearing_life(candidate: Candidate, check: CheckResult, load: OutputLoad, u: float) -> CheckReading:
    """Life on the basis of the required one. A load that may be u times as large leaves a life of L / u³."""
    basis = load.life_basis
    life = candidate.bearing_life_L50_h if basis == "L50" else candidate.bearing_life_L10_h
    relation = f"L_b,{basis[1:]} ≥ L_b"
    unlimited = life is None and check.utilisation is not None
    return CheckReading(life, load.life_h, "h", "minimum", _REQUIRED[basis], relation, u**3, unlimited)


def _bearing_load(
    check: CheckResult, application: Application, load: OutputLoad, catalogue: Catalogue, gear: Gear, u: float
) -> CheckReading | None:
    """Load vector of the worst phase times f_w, and how long it may be in its own direction; None without a load."""
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
    """Sentences on the torque to which a drive has to limit its motor; `warns` where motor or cycle is above it."""

    lines: tuple[Sentence, ...] = ()
    warns: bool = False


def torque_limit_of(candidate: Candidate, gear: Gear | None, application: Application | None) -> TorqueLimit:
    """Torque limit of the drive on a gear, with a further line where the cycle needs more.

    No line where it is not known; without the gear's figures or the motor's peak torque the limit alone. The
    application has the figures of a motor that it names.
    """
    limit, need = candidate.motor_torque_limit_Nm, candidate.motor_peak_torque_Nm
    if limit is None:
        return TorqueLimit()
    motor = application.requirements.motor if application else None
    peak = (motor and motor.peak_torque_Nm) or math.nan
    need = math.nan if need is None else need
    warnings = on_torque_limit(gear, limit_Nm=limit, need_Nm=need, peak_Nm=peak) if gear else ()
    sentences = {notice.code: notice.sentence for notice in warnings}
    values: dict[str, Value] = {
        "limit": Quantity(limit, "Nm", 4, "down"),
        "share": Quantity(100 * limit / peak, "percent", 3, "down"),
        "peak": Quantity(peak, "Nm", 6),
    }
    plain = Sentence(LIMIT if math.isnan(peak) else NO_LIMIT if peak <= limit else WITHIN, values)
    warns = bool(sentences)
    return TorqueLimit((sentences.pop("gear_below_motor", plain), *sentences.values()), warns)


def stiffness_of(candidate: Candidate) -> Sentence:
    """Natural frequency and position error of a candidate, as far as they are known."""
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
