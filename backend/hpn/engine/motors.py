"""Motors of the user's list that fit a gear, and gears that fit a motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hpn.application import LISTED_FIGURES, Application, Motor
from hpn.catalogue import Catalogue, ListedMotor
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate, CheckResult
from hpn.engine.checks import allowed
from hpn.engine.checks.motor import MOTOR, OF_MOTOR
from hpn.engine.duty import Duty
from hpn.engine.figures import Figures
from hpn.engine.motor_torques import efficiencies, inertia_ratio, torques_along
from hpn.engine.selection import Selection
from hpn.physics.equations import ROUNDING, FloatArray

MOTOR_CHECKS = tuple(check.code for check in OF_MOTOR)
"""Codes of the checks of the motor."""

_LOADS = frozenset(check.code for check in MOTOR)


@dataclass(frozen=True, slots=True)
class MotorUse:
    """One of the user's motors on a gear: utilisation by check, of those whose figures are known.

    `inertia_ratio` is the load's inertia over i² times the motor's; None where one of them is not known.
    """

    motor: ListedMotor
    used: Mapping[str, float]
    inertia_ratio: float | None
    fits: bool

    @property
    def governing(self) -> str:
        """Code of the check that is nearest to its limit; the inertia ratio counts as one only where it fails."""
        counting = {code: share for code, share in self.used.items() if code in _LOADS or share > 1 + ROUNDING}
        counting = counting or self.used
        return max(counting, key=counting.__getitem__)


def motors_on(application: Application, gear: Gear, catalogue: Catalogue) -> list[MotorUse]:
    """The user's motors on a gear: those that fit first, by ascending rated torque, then the nearest miss first.

    Utilisations are those of `select` with that motor. A motor of which nothing is known that a check needs is left
    out, and where an inertia ratio is asked for, each of which the inertia is not known: `select` refuses it.
    """
    motors = catalogue.motors
    if not motors:
        return []
    own = {name: np.array([_known(getattr(motor, name)) for motor in motors]) for name in LISTED_FIGURES}
    used, inertia_ratio = _utilisations(application, gear, catalogue, own)
    u = application.requirements.utilisation
    uses = []
    for place, motor in enumerate(motors):
        shares = {code: values.item(place) for code, values in used.items() if not np.isnan(values[place])}
        ratio = inertia_ratio.item(place)
        if shares and not (asks_inertia_ratio(application) and motor.inertia_kgm2 is None):
            fits = all(share <= allowed(code, u) * (1 + ROUNDING) for code, share in shares.items())
            uses.append(MotorUse(motor, shares, None if np.isnan(ratio) else ratio, fits))
    return sorted(uses, key=_order)


def asks_inertia_ratio(application: Application) -> bool:
    """True where the load's inertia is limited to a multiple of the motor's, which then has to be known."""
    asked = application.requirements.motor
    return asked is not None and asked.inertia_ratio is not None


def _known(value: float | None) -> float:
    return np.nan if value is None else value


def _order(use: MotorUse) -> tuple[bool, float, float]:
    worst = use.used[use.governing]
    return not use.fits, (use.motor.rated_torque_Nm or np.inf) if use.fits else worst, -worst


def _utilisations(
    application: Application, gear: Gear, catalogue: Catalogue, own: Mapping[str, FloatArray]
) -> tuple[dict[str, FloatArray], FloatArray]:
    """Demand over limit by check, and inertia ratio; shape (motors,), NaN where a figure is not known."""
    asked = application.requirements.motor
    duty = Duty.of([_without_motor(application)])
    figures = Figures(duty, catalogue.listed([gear]), catalogue)
    peak, rms = (
        np.full(len(catalogue.motors), torque.item())
        for torque in (figures.motor_peak_torque_Nm, figures.motor_rated_torque_Nm)
    )
    heavy = np.flatnonzero(~np.isnan(own["inertia_kgm2"]))
    if duty.courses and heavy.size:
        at_peak, at_rms = efficiencies(duty, gear, catalogue)
        peak[heavy], rms[heavy] = torques_along(
            duty.courses[0],
            figures.gears.columns,
            [0],
            efficiency_at_peak=at_peak,
            efficiency_at_rms=at_rms,
            inertia_kgm2=own["inertia_kgm2"][heavy],
            pause_s=application.duty_cycle.pause_s,
        )
    ratios = inertia_ratio(duty, figures.gears.columns, own["inertia_kgm2"])[0]
    most = _known(asked.inertia_ratio if asked else None)
    used = {
        "motor_speed": figures.maximum_input_speed_rpm.item() / own["maximum_speed_rpm"],
        "motor_peak_torque": peak / own["peak_torque_Nm"],
        "motor_rated_torque": rms / own["rated_torque_Nm"],
        "motor_rated_speed": figures.average_input_speed_rpm.item() / own["rated_speed_rpm"],
        "inertia_ratio": ratios / most,
    }
    return used, ratios


def _without_motor(application: Application) -> Application:
    asked = application.requirements.model_copy(update={"motor": None})
    return application.model_copy(update={"requirements": asked})


def with_motor(application: Application, motor: ListedMotor) -> Application:
    """The application with a motor of the list in place of its own; the permitted inertia ratio stays."""
    asked = application.requirements.motor
    named = Motor(designation=motor.designation, inertia_ratio=asked.inertia_ratio if asked else None)
    return application.model_copy(update={"requirements": application.requirements.model_copy(update={"motor": named})})


# --- Which gears ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SizeWithMotor:
    """Gears of one size with the motor that is asked for: those that fit, and those that fail by the motor alone."""

    size: str
    fit: tuple[Candidate, ...]
    ruled_out: tuple[Candidate, ...]


def ratios_with_motor(selection: Selection) -> list[SizeWithMotor]:
    """Gears that are suitable with the motor or would be without it, by size and ascending ratio."""
    sizes: dict[str, list[Candidate]] = {}
    for candidate in selection.candidates:
        if candidate.status == "suitable" or (candidate.is_judged and _fails_by_motor_alone(candidate.failing)):
            sizes.setdefault(candidate.size, []).append(candidate)
    found = []
    for size in sorted(sizes, key=lambda size: int(size.rstrip("A"))):
        own = sorted(sizes[size], key=lambda candidate: candidate.ratio)
        fit = tuple(one for one in own if one.status == "suitable")
        found.append(SizeWithMotor(size, fit, tuple(one for one in own if one.status != "suitable")))
    return found


def _fails_by_motor_alone(failing: Sequence[CheckResult]) -> bool:
    return bool(failing) and all(check.code in MOTOR_CHECKS for check in failing)
