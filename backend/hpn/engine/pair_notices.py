"""Notices on pairs of gear and motor: assumptions behind all pairs, and motors that no ratio can save."""

from collections.abc import Iterator, Sequence

import numpy as np

from hpn.application import Application, MotorEntry
from hpn.catalogue import Catalogue, GearList
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.motor_torques import efficiencies
from hpn.engine.motors import asks_inertia_ratio, with_figures
from hpn.engine.notice import Notice, notice
from hpn.engine.notices import notices_of
from hpn.physics.equations import ROUNDING
from hpn.physics.motion.motor import least_square_per_inertia
from hpn.words.wording import first_of

OF_ONE_GEAR = frozenset(("gear_below_motor", "limit_below_need", "ramp_shorter_than_period", "counterweight_slack"))
"""Notices on the first candidate of a selection; each pair has these figures itself."""

JUDGED = ("maximum_speed_rpm", "rated_torque_Nm", "peak_torque_Nm")
"""Figures that a full judgement of a motor needs; lists often lack rated speed and inertia."""

ELSEWHERE = OF_ONE_GEAR | {"rotor_not_included"}
"""These notices, and the one on all motors."""

NAMED = 20
"""Motors, at most, that a notice names."""


def notices_on(
    application: Application,
    motors: Sequence[MotorEntry],
    gears: GearList,
    catalogue: Catalogue,
    least_Hz: float | None,
) -> Iterator[Notice]:
    """Notices on all pairs; a motor without inertia is not rated if an inertia ratio or a resonance is limited."""
    needs_inertia = asks_inertia_ratio(application) or least_Hz is not None
    yield notice("pairs_not_mated")
    if beyond_ratios := _beyond_ratios(application, motors, gears, catalogue):
        names, least = beyond_ratios
        yield notice("no_ratio_for_motor", names=first_of(names, NAMED), rate_kW_per_s=least / 1000)
    partial = [one.designation for one in motors if not one.curve and None in [getattr(one, name) for name in JUDGED]]
    if partial:
        yield notice("motor_figures_unknown", names=first_of(partial, NAMED))
    if needs_inertia and (light := [motor.designation for motor in motors if motor.inertia_kgm2 is None]):
        yield notice("motor_inertia_unknown", names=first_of(light, NAMED))
    still = application.duty_cycle.motion is None
    if any(one.curve and (still or one.inertia_kgm2 is None) for one in motors):
        yield notice("rotor_not_included")
    known = next((motor for motor in motors if motor.inertia_kgm2 is not None), motors[0])
    equipped = with_figures(application, known)
    evaluation = evaluate(Duty.of([equipped]), gears, catalogue)
    yield from (one for one in notices_of(equipped, evaluation, 0) if one.code not in ELSEWHERE)


def _continuous_Nm(motor: MotorEntry) -> float:
    """Continuous torque in Nm, the upper limit of the RMS: at standstill along a curve, else the rated torque; NaN if
    unknown.
    """
    if motor.curve:
        return motor.stall_torque_Nm or motor.curve[0].continuous_Nm
    return motor.rated_torque_Nm or np.nan


def _beyond_ratios(
    application: Application, motors: Sequence[MotorEntry], gears: GearList, catalogue: Catalogue
) -> tuple[list[str], float] | None:
    """Motors whose RMS torque is above their rated torque at any ratio, and the M² / J_m in W/s that would suffice.

    None without such motors, with typed phases, and where a gear has a no-load torque, which the closed form leaves
    out. The gear's own inertia counts.
    """
    motion = application.duty_cycle.motion
    if motion is None or np.nan_to_num(gears.columns.no_load_torque_Nm).any():
        return None
    duty = Duty.of([application])
    at_rms = {gear.designation: efficiencies(duty, gear, catalogue)[1] for gear in gears.rows}
    least = least_square_per_inertia(
        motion.course, efficiency=np.array(list(at_rms.values())), pause_s=application.duty_cycle.pause_s
    )
    own = np.nan_to_num(gears.columns.inertia_kgm2)
    torque = np.array([[_continuous_Nm(motor)] for motor in motors])
    inertia = np.array([[motor.inertia_kgm2 or np.nan] for motor in motors])
    beyond = (torque**2 < (inertia + own) * least * (1 - ROUNDING)).all(axis=1)
    names = [motors[place].designation for place in np.flatnonzero(beyond).tolist()]
    return (names, float(least.min())) if names else None
