"""Notices on pairs of gear and motor: assumptions behind all of them, and motors that no ratio can save."""

from collections.abc import Iterator, Sequence

import numpy as np

from hpn.application import Application, MotorEntry
from hpn.catalogue import Catalogue, GearList
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.motor_torques import efficiencies
from hpn.engine.motors import with_figures
from hpn.engine.notice import Notice, notice
from hpn.engine.notices import notices_of
from hpn.physics.equations import ROUNDING
from hpn.physics.motion.motor import least_square_per_inertia

OF_ONE_GEAR = frozenset(("gear_below_motor", "limit_below_need", "ramp_shorter_than_period", "counterweight_slack"))
"""Notices on the first candidate of a selection, whose figures each pair has for itself."""

JUDGED = ("maximum_speed_rpm", "rated_torque_Nm", "peak_torque_Nm")
"""Figures of a motor without which it is not fully judged; rated speed and inertia are often left out."""

NAMED = 20
"""Motors that a notice names."""


def notices_on(
    application: Application,
    motors: Sequence[MotorEntry],
    gears: GearList,
    catalogue: Catalogue,
    *,
    needs_inertia: bool,
) -> Iterator[Notice]:
    """Notices on all pairs; `needs_inertia` says that a motor without an inertia is not rated."""
    yield notice("pairs_not_mated")
    if lost := _beyond_ratios(application, motors, gears, catalogue):
        names, least = lost
        yield notice("no_ratio_for_motor", names=_named(names), rate_kW_per_s=least / 1000)
    if partial := [motor.designation for motor in motors if None in [getattr(motor, name) for name in JUDGED]]:
        yield notice("motor_figures_unknown", names=_named(partial))
    if needs_inertia and (light := [motor.designation for motor in motors if motor.inertia_kgm2 is None]):
        yield notice("motor_inertia_unknown", names=_named(light))
    known = next((motor for motor in motors if motor.inertia_kgm2 is not None), motors[0])
    equipped = with_figures(application, known)
    evaluation = evaluate(Duty.of([equipped]), gears, catalogue)
    yield from (one for one in notices_of(equipped, evaluation, 0) if one.code not in OF_ONE_GEAR)


def _named(names: Sequence[str]) -> str:
    return ", ".join([*names[:NAMED], *(["…"] if len(names) > NAMED else [])])


def _beyond_ratios(
    application: Application, motors: Sequence[MotorEntry], gears: GearList, catalogue: Catalogue
) -> tuple[list[str], float] | None:
    """Motors whose RMS torque is above their rated torque at any ratio, and the M² / J_m in W/s that would do.

    None where there are no such motors, with typed phases, and where a gear has a torque at no load, which the closed
    form leaves out. The gear's own inertia counts.
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
    torque, inertia = (
        np.array([[getattr(motor, name) or np.nan] for motor in motors], dtype=np.float64)
        for name in ("rated_torque_Nm", "inertia_kgm2")
    )
    beyond = (torque**2 < (inertia + own) * least * (1 - ROUNDING)).all(axis=1)
    names = [motors[place].designation for place in np.flatnonzero(beyond).tolist()]
    return (names, float(least.min())) if names else None
