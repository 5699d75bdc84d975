"""Factors by which each driver of an application may grow, or must shrink, until one of its checks is at the limit.

In closed form, because every utilisation is a power of each driver: a check's `moves` gives the powers. The other
inputs stay as they are. A rejected gear needs a factor below 1; all factors below 1 together are the remedy.
"""

from collections.abc import Mapping

import numpy as np

from hpn.engine.check import DRIVERS, Driver
from hpn.engine.checks import CHECKS
from hpn.engine.evaluation import Evaluation
from hpn.engine.input_arrays import CURVE
from hpn.physics import equations
from hpn.physics.equations import ROUNDING, FloatArray

MOVES: Mapping[Driver, Mapping[str, float]] = {
    driver: {check.code: check.moves[driver] for check in CHECKS if driver in check.moves} for driver in DRIVERS
}
"""Driver -> check -> power of the driver in the check's utilisation (eq. 17.2 to 17.10, ISO 281)."""

MOTOR_TORQUE_INPUTS = ("requirements.motor.peak_torque_Nm", "requirements.motor.rated_torque_Nm", CURVE)


def reserves(evaluation: Evaluation, index: int) -> dict[str, FloatArray]:
    """Reserve of application `index` on every gear, shape (G,) each: infinite without a limit, NaN where not rated.

    Factors on all torques of the duty cycle (not the emergency stop), on all speeds and on all loads, the largest
    permissible emergency-stop torque and brake torque in Nm and the largest load inertia in kg m². The mean, peak and
    RMS of a torque share one factor, and so do the mean and peak of a speed.

    A factor is NaN also where it influences none of the checks, and where a motor torque has no closed form: the torque
    factor if the motor torque follows the gear's efficiency curve or includes its no-load torque; the factors of torque
    and speed if it includes the motor's own inertia, which depends on the motion's acceleration; the speed factor also
    if the motor's limit depends on its speed.
    """
    inputs, duty = evaluation.case.inputs, evaluation.case.duty
    u = inputs["requirements.utilisation"].item(index)
    with np.errstate(all="ignore"):
        factors = {f"{driver}_factor": _factor(evaluation, index, driver, u) for driver in DRIVERS}
    if any(not np.isnan(inputs[path].item(index)) for path in MOTOR_TORQUE_INPUTS):
        follows_curve = np.array(
            [gear.designation in evaluation.catalogue.efficiency for gear in evaluation.gears.rows]
        )
        stated = not np.isnan(inputs["requirements.efficiency"].item(index))
        own_inertia = not np.isnan(inputs["requirements.motor.inertia_kgm2"].item(index))
        turns = own_inertia and duty.courses.get(index) is not None
        apart = follows_curve & ~np.bool_(stated) | (evaluation.gears.columns.no_load_torque_Nm > 0)
        factors["torque_factor"] = np.where(apart | np.bool_(turns), np.nan, factors["torque_factor"])
        falls = duty.inputs.motor_curves[index, 0] is not None
        factors["speed_factor"] = np.where(np.bool_(turns or falls), np.nan, factors["speed_factor"])
    if duty.inputs.shaft_drive[index, 0]:
        factors |= _beside_shaft_drive(evaluation, index, factors)
    return {**factors, **_of_stop(evaluation, index, u), "load_inertia_kgm2": _load_inertia(evaluation, index, u)}


def _beside_shaft_drive(
    evaluation: Evaluation, index: int, factors: Mapping[str, FloatArray]
) -> Mapping[str, FloatArray]:
    """Factors where a pinion or pulley loads the shaft: its load follows the torques, and no factor scales it alone.

    With additional typed loads the torques have no closed form either.
    """
    typed = evaluation.case.duty.typed
    alone = not (typed.radial_N[index].any() or typed.axial_N[index].any())
    torque = np.minimum(factors["torque_factor"], factors["load_factor"]) if alone else np.array(np.nan)
    return {"torque_factor": torque, "load_factor": np.array(np.nan)}


def _factor(evaluation: Evaluation, index: int, driver: Driver, u: float) -> FloatArray:
    """Smallest (u / utilisation)^(1 / power) over the checks that depend on a driver; NaN if none does."""
    unknown = np.isfinite(evaluation.case.figures.bearing_loads_at_least[0])  # a lower bound is not a utilisation
    rooms = [
        room if power == 1 else room ** (1 / power)
        for place, check in enumerate(evaluation.checks)
        if (power := check.moves.get(driver)) and evaluation.applies.item(place, index, 0)
        for used in (evaluation.nominal[place, index],)
        for room in (u / (np.where(unknown[index], np.nan, used) if check.at_least else used),)
    ]
    return np.minimum.reduce(rooms) if rooms else np.array(np.nan)


def _of_stop(evaluation: Evaluation, index: int, u: float) -> dict[str, FloatArray]:
    """Largest T_k, and largest torques of the brake at which a stop stays within it and within T_R, shape (G,) each."""
    nothing, duty, T_R = np.array(np.nan), evaluation.case.duty, evaluation.gears.columns.repeated_peak_torque_Nm
    braked = duty.brakes is not None and bool(duty.brakes.item(index))
    if not braked and np.isnan(duty.typed_stop_torque_Nm.item(index)):
        return {name: nothing for name in ("emergency_stop_torque_Nm", "brake_torque_Nm", "brake_torque_repeated_Nm")}
    T_k, stops = _emergency_stop_torque(evaluation, index, u), evaluation.case.figures.stops
    brakes = [stops.largest_brake_torque_Nm(T)[index] if braked else nothing for T in (T_k, T_R)]
    return {"emergency_stop_torque_Nm": T_k, "brake_torque_Nm": brakes[0], "brake_torque_repeated_Nm": brakes[1]}


def _emergency_stop_torque(evaluation: Evaluation, index: int, u: float) -> FloatArray:
    """Largest T_k that equations 17.8 and 17.9 allow, shape (G,).

    Equation 17.9 must allow the expected number over u, rounded up, since it gives a count; with a reserve near 0 no
    stop may exceed T_R. Without an expected number T_M alone limits.
    """
    gears, count = evaluation.gears.columns, evaluation.case.inputs["emergency_stop.count"].item(index)
    by_torque = u * gears.momentary_peak_torque_Nm
    if np.isnan(count):
        return by_torque
    needed = max(np.ceil(count / u * (1 - ROUNDING)), 1.0)
    by_count = equations.emergency_stop_torque_for(
        momentary_peak_count=needed, repeated_peak_torque_Nm=gears.repeated_peak_torque_Nm
    )
    return np.minimum(by_torque, by_count)


def _load_inertia(evaluation: Evaluation, index: int, u: float) -> FloatArray:
    """Largest inertia of the load in kg m² at which natural frequency, inertia ratio and stop pass, shape (G,).

    NaN if none of them is asked for, and with a motion, whose torques depend on the inertia too. The frequency follows
    1 / √J. The gear's own inertia adds a fixed part to the ratio. The torque of a stop by the brake rises with the
    inertia; it is NaN where the brake does not hold the load.
    """
    case = evaluation.case
    J, f, n = (case.inputs[f"requirements.{name}"].item(index) for name in LOAD_INERTIA_INPUTS)
    J_m = case.inputs["requirements.motor.inertia_kgm2"].item(index)
    rooms = []
    if not np.isnan(f):
        rooms.append(case.gears.torsional_stiffness_Nm_per_rad / np.square(2 * np.pi * f))
    if not np.isnan(n):
        rooms.append(np.square(case.gears.ratio) * (n * J_m - np.nan_to_num(case.gears.inertia_kgm2)))
    if case.duty.brakes is not None and case.duty.brakes.item(index) and not np.isnan(J_m):
        T_k = _emergency_stop_torque(evaluation, index, u)
        rooms.append(case.figures.stops.largest_load_inertia_kgm2(T_k)[index])
    return np.minimum.reduce(rooms) if rooms and not np.isnan(J) else np.array(np.nan)


LOAD_INERTIA_INPUTS = ("load_inertia_kgm2", "natural_frequency_Hz", "motor.inertia_ratio")
