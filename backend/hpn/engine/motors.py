"""Motors of the user's list that fit a gear, and gears that fit a motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hpn.application import FURTHER_FIGURES, LISTED_FIGURES, Application, Motor, MotorEntry
from hpn.catalogue import Catalogue, GearList, ListedMotor
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate
from hpn.engine.checks import allowed
from hpn.engine.checks.motor import MOTOR, OF_MOTOR
from hpn.engine.duty import Duty
from hpn.engine.evaluation import Evaluation, evaluate
from hpn.engine.motor_torques import inertia_ratio
from hpn.engine.selection import Selection
from hpn.physics.equations import ROUNDING
from hpn.words.titles import LONGEST_NAME, is_title

MOTOR_CHECKS = tuple(check.code for check in OF_MOTOR)
"""Codes of the checks of the motor."""

LOADS = frozenset(check.code for check in MOTOR)


@dataclass(frozen=True, slots=True)
class MotorUse:
    """One of the user's motors on a gear: utilisation by check, for checks with known figures.

    `inertia_ratio` is the load's inertia over i² times the motor's; None if one of them is unknown.
    """

    motor: ListedMotor
    used: Mapping[str, float]
    inertia_ratio: float | None
    fits: bool

    @property
    def governing(self) -> str:
        """Code of the check nearest to its limit; the inertia ratio takes part only if it fails."""
        counting = {code: share for code, share in self.used.items() if code in LOADS or share > 1 + ROUNDING}
        return max(counting or self.used, key=self.used.__getitem__)


def motors_on(application: Application, gear: Gear, catalogue: Catalogue) -> list[MotorUse]:
    """The user's motors on a gear: fitting motors first, by ascending rated torque, then the others, the nearest miss
    first.

    Utilisations equal those of `select` with the motor. Motors are left out if no check has the figures it needs; and
    motors without an inertia are left out if an inertia ratio is asked for, since `select` refuses them.
    """
    motors = catalogue.motors
    if not motors:
        return []
    evaluation = with_motors(application, motors, catalogue.listed([gear]), catalogue)
    case, u = evaluation.case, application.requirements.utilisation
    ratios = inertia_ratio(case.duty, case.gears, case.inputs["requirements.motor.inertia_kgm2"])[:, 0].tolist()
    places = [place for place, check in enumerate(evaluation.checks) if check.code in MOTOR_CHECKS]
    uses = []
    for row, (motor, ratio) in enumerate(zip(motors, ratios, strict=True)):
        checks = [place for place in places if evaluation.applies.item(place, row, 0)]
        shares = {evaluation.checks[place].code: evaluation.used.item(place, row, 0) for place in checks}
        if shares and not np.isnan(list(shares.values())).any():
            fits = all(share <= allowed(code, u) * (1 + ROUNDING) for code, share in shares.items())
            uses.append(MotorUse(motor, shares, None if np.isnan(ratio) else ratio, fits))
    return sorted(uses, key=_order)


def asks_inertia_ratio(application: Application) -> bool:
    """True where the load's inertia is limited to a multiple of the motor's, which must then be known."""
    motor = application.requirements.motor
    return motor is not None and motor.inertia_ratio is not None


def _order(use: MotorUse) -> tuple[bool, float, float]:
    worst = use.used[use.governing]
    return not use.fits, (use.motor.rated_torque_Nm or np.inf) if use.fits else worst, -worst


def with_motors(
    application: Application, motors: Sequence[ListedMotor | MotorEntry], gears: GearList, catalogue: Catalogue
) -> Evaluation:
    """Evaluation of an application with each of many motors in place of its own, one row per motor.

    The permitted inertia ratio stays.
    """
    figures = {
        name: np.array([[getattr(motor, name)] for motor in motors], dtype=np.float64) for name in LISTED_FIGURES
    }
    curves = [motor.curve if isinstance(motor, MotorEntry) else None for motor in motors]
    motor = application.requirements.motor
    bound = Motor(inertia_ratio=motor.inertia_ratio) if asks_inertia_ratio(application) and motor else None
    return evaluate(Duty.of([application.requiring(motor=bound)]).with_motors(figures, curves), gears, catalogue)


def entries_of(motors: Sequence[ListedMotor]) -> list[MotorEntry]:
    """Motors of motors.csv as entries of a list."""
    names = ("designation", *LISTED_FIGURES)
    return [MotorEntry.model_construct(**{name: getattr(motor, name) for name in names}) for motor in motors]


def with_motor(application: Application, motor: ListedMotor) -> Application:
    """The application with a listed motor in place of its own; the permitted inertia ratio stays."""
    own = application.requirements.motor
    named = Motor(designation=motor.designation, inertia_ratio=own.inertia_ratio if own else None)
    return application.requiring(motor=named)


def with_figures(application: Application, motor: MotorEntry) -> Application:
    """The application with a motor's figures filled in; the permitted inertia ratio stays."""
    typed = application.requirements.motor
    figures = {name: getattr(motor, name) for name in (*LISTED_FIGURES, *FURTHER_FIGURES)}
    name = motor.designation if is_title(motor.designation, LONGEST_NAME) else None
    own = Motor(**figures, name=name, inertia_ratio=typed.inertia_ratio if typed else None)
    return application.requiring(motor=own)


# --- Which gears ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SizeWithMotor:
    """Gears of one size with the requested motor: those that fit, and those that only the motor rules out."""

    size: str
    fit: tuple[Candidate, ...]
    ruled_out: tuple[Candidate, ...]


def ratios_with_motor(selection: Selection) -> list[SizeWithMotor]:
    """Gears that are suitable with the motor, or would be without it, by size and ascending ratio."""
    sizes: dict[str, list[Candidate]] = {}
    for candidate in selection.candidates:
        by_motor_alone = bool(candidate.failing) and all(check.code in MOTOR_CHECKS for check in candidate.failing)
        if candidate.status == "suitable" or (candidate.is_judged and by_motor_alone):
            sizes.setdefault(candidate.size, []).append(candidate)
    ratios = []
    for size in sorted(sizes, key=lambda size: int(size.rstrip("A"))):
        own = sorted(sizes[size], key=lambda candidate: candidate.ratio)
        fit = tuple(one for one in own if one.status == "suitable")
        ratios.append(SizeWithMotor(size, fit, tuple(one for one in own if one.status != "suitable")))
    return ratios
