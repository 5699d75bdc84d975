"""What gears come to under duty cycles: speeds, lives, stops, torques at the motor, load on the output bearing."""

from dataclasses import dataclass

import numpy as np

from hpn import bearing, equations
from hpn.catalogue import Catalogue, GearList
from hpn.duty import Duty
from hpn.equations import FloatArray
from hpn.gear import Gear
from hpn.motion import Course, peak_torque, rms_torque


@dataclass(frozen=True)
class Figures:
    """Figures of G gears under N applications, each array broadcasting to (N, G).

    NaN: not published, or not asked for; infinity: without a limit. `bearing_load` is the largest f_w P of a phase,
    `bearing_mean_load` f_w P_m of the cycle, `bearing_life_factor` the k that speed and required life allow.
    """

    average_input_speed_rpm: FloatArray
    maximum_input_speed_rpm: FloatArray
    life_L10_h: FloatArray
    momentary_peak_count: FloatArray
    bearing_life_L50_h: FloatArray
    bearing_life_L10_h: FloatArray
    motor_peak_torque_Nm: FloatArray
    motor_rated_torque_Nm: FloatArray
    bearing_load: FloatArray
    bearing_mean_load: FloatArray
    bearing_life_factor: FloatArray


def figures_of(duty: Duty, gears: GearList, catalogue: Catalogue) -> Figures:
    """Figures of gears under the applications of a duty."""
    columns, n_out_av = gears.columns, duty.average_output_speed_rpm
    n_in_av = equations.average_input_speed(ratio=columns.ratio, average_output_speed_rpm=n_out_av)
    reference_speed_rpm, reference_life_h = catalogue.bearing_reference
    load, mean_load = _bearing_loads(duty, gears)
    life_L50 = bearing.life_L50(
        equivalent_load=mean_load,
        average_output_speed_rpm=n_out_av,
        reference_speed_rpm=reference_speed_rpm,
        reference_life_h=reference_life_h,
    )
    motor_peak, motor_rated = _motor_torques(duty, gears, catalogue)
    return Figures(
        average_input_speed_rpm=n_in_av,
        maximum_input_speed_rpm=equations.maximum_input_speed(
            ratio=columns.ratio, maximum_output_speed_rpm=duty.maximum_output_speed_rpm
        ),
        life_L10_h=equations.life(
            average_torque_Nm=duty.average_torque_Nm,
            average_input_speed_rpm=n_in_av,
            rated_torque_Nm=columns.rated_torque_Nm,
            rated_input_speed_rpm=catalogue.rated_input_speed_rpm,
            life_at_rated_torque_h=catalogue.life_at_rated_torque_h,
        ),
        momentary_peak_count=equations.allowed_momentary_peaks(
            emergency_stop_torque_Nm=duty.emergency_stop_torque_Nm,
            repeated_peak_torque_Nm=columns.repeated_peak_torque_Nm,
        ),
        bearing_life_L50_h=life_L50,
        bearing_life_L10_h=life_L50 / bearing.L50_PER_L10,
        motor_peak_torque_Nm=motor_peak,
        motor_rated_torque_Nm=motor_rated,
        bearing_load=load,
        bearing_mean_load=mean_load,
        bearing_life_factor=bearing.life_factor(
            average_output_speed_rpm=n_out_av,
            required_life_L50_h=duty.required_bearing_life_L50_h,
            reference_speed_rpm=reference_speed_rpm,
            reference_life_h=reference_life_h,
        ),
    )


# --- Output bearing ---------------------------------------------------------------------------------------------------


def phase_loads(duty: Duty, gears: GearList) -> FloatArray:
    """f_w P of every phase on the bearing of every size, shape (N, sizes, phases).

    NaN without a load, where the limits of a size are not published, and where the digitised model lacks its curve.
    """
    first, phases, model = gears.first_of_size, duty.phases, duty.asked.bearing_model[..., None]
    with np.errstate(all="ignore"):
        r = phases.radial_N / gears.columns.dynamic_radial_load_N[first][:, None]
        a = phases.axial_N / gears.columns.dynamic_axial_load_N[first][:, None]
    P = np.where(model == "iso281", bearing.iso281_load(radial=r, axial=a), bearing.linear_load(radial=r, axial=a))
    along = np.flatnonzero(model == "digitised")
    if along.size:
        P[along] = np.nan
        for place, gear in enumerate(first):
            if (curve := gears.curves[gear]) is not None:
                P[along, place] = curve.equivalent_load(phases.radial_N[along, 0], phases.axial_N[along, 0])
    return P * duty.asked["output_load.load_coefficient"][..., None]


def _bearing_loads(duty: Duty, gears: GearList) -> tuple[FloatArray, FloatArray]:
    """Largest f_w P of a phase, and f_w P_m of the cycle, on every gear, shape (N, G)."""
    if np.isnan(duty.asked["output_load.load_coefficient"]).all():
        nothing = np.full((1, 1), np.nan)
        return nothing, nothing
    loads, phases = phase_loads(duty, gears), duty.phases
    mean = bearing.mean_equivalent_load(equivalent_load=loads, speed_rpm=phases.speed_rpm, duration_s=phases.duration_s)
    return loads.max(axis=-1)[:, gears.of_size], mean[:, gears.of_size]


# --- Motor ------------------------------------------------------------------------------------------------------------


def _motor_torques(duty: Duty, gears: GearList, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at the motor, shape (N, G); loss-free where no efficiency is known.

    A stated efficiency goes before a supplied curve, which is read at a phase's peak for the peak and at its RMS for
    the RMS. Of a motion whose motor's inertia is known the torque counts at every instant, that inertia included.
    """
    stated, ratio = duty.asked["requirements.efficiency"], gears.columns.ratio
    eta = np.where(np.isnan(stated), 1.0, stated)
    peak = equations.motor_torque(output_torque_Nm=duty.maximum_torque_Nm, ratio=ratio, efficiency=eta)
    rated = equations.motor_torque(output_torque_Nm=duty.rms_torque_Nm, ratio=ratio, efficiency=eta)
    peaks, squares, unstated = duty.phases.peak_torque_Nm[:, 0], duty.phases.rms_torque_Nm[:, 0], np.isnan(stated)[:, 0]
    for place, gear in enumerate(gears.rows):
        if not unstated.any() or gear.designation not in catalogue.efficiency:
            continue
        at_peak, at_rms = (
            equations.motor_torque(
                output_torque_Nm=T, ratio=gear.ratio, efficiency=efficiency_along(catalogue, gear, T)
            )
            for T in (peaks, squares)
        )
        rms = equations.rms_torque(
            torque_Nm=at_rms,
            duration_s=duty.phases.duration_s[:, 0],
            pause_s=duty.asked["duty_cycle.pause_s"][:, 0],
        )
        peak[unstated, place], rated[unstated, place] = at_peak.max(axis=1)[unstated], rms[unstated]
    for index, course in enumerate(duty.courses):
        inertia = duty.asked["requirements.motor.inertia_kgm2"].item(index)
        if course is not None and not np.isnan(inertia):
            peak[index], rated[index] = _with_own_inertia(duty, index, course, inertia, gears, catalogue)
    return peak, rated


PIECES_AT_ONCE = 200_000
"""Pieces times gears that are looked at together."""


def _with_own_inertia(
    duty: Duty, index: int, course: Course, inertia_kgm2: float, gears: GearList, catalogue: Catalogue
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at the motor of application `index`, its own inertia included, shape (G,) each.

    Gears of one ratio without a curve of their own have the same torques, which are worked out once.
    """
    stated = duty.asked["requirements.efficiency"].item(index)
    curved = [np.isnan(stated) and gear.designation in catalogue.efficiency for gear in gears.rows]
    kinds = [gear.designation if own else str(gear.ratio) for gear, own in zip(gears.rows, curved, strict=True)]
    first = {kind: kinds.index(kind) for kind in kinds}
    eta = np.full((2, len(first), len(course.move)), 1.0 if np.isnan(stated) else stated)
    for row, place in enumerate(first.values()):
        if curved[place]:
            for at, T in enumerate((course.peak_torque_Nm, course.rms_torque_Nm)):
                eta[at, row] = efficiency_along(catalogue, gears.rows[place], T)
    ratio = gears.columns.ratio[list(first.values())]
    step = max(1, PIECES_AT_ONCE // len(course.pieces))
    peaks = [
        peak_torque(course, ratio=ratio[k : k + step], efficiency=eta[0, k : k + step], motor_inertia_kgm2=inertia_kgm2)
        for k in range(0, len(first), step)
    ]
    pause_s = duty.asked["duty_cycle.pause_s"].item(index)
    rms = rms_torque(course, ratio=ratio, efficiency=eta[1], motor_inertia_kgm2=inertia_kgm2, pause_s=pause_s)
    rows = [list(first).index(kind) for kind in kinds]
    return np.concatenate(peaks)[rows], rms[rows]


def efficiency_along(catalogue: Catalogue, gear: Gear, torque_Nm: FloatArray) -> FloatArray:
    """Efficiency at torques by the curve that a supplement gives of a gear; beyond its ends that of the nearer end.

    Raises KeyError for a gear without a curve.
    """
    return np.interp(torque_Nm, *catalogue.efficiency[gear.designation])


def leaves_curve(catalogue: Catalogue, gear: Gear, duty: Duty, index: int) -> bool:
    """Whether a torque of application `index` lies beyond the ends of a gear's efficiency curve; one of 0 does not."""
    known, _ = catalogue.efficiency[gear.designation]
    torques = np.concatenate((duty.phases.peak_torque_Nm[index, 0], duty.phases.rms_torque_Nm[index, 0]))
    return bool(((torques > 0) & ((torques < known[0]) | (torques > known[-1]))).any())
