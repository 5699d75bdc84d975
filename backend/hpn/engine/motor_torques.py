"""Torques at the motor under duty cycles, with the efficiency, the inertia and the torque without load of gears."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, GearColumns, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.duty import Duty
from hpn.physics import equations
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Course, motor_torques

BoolArray = NDArray[np.bool_]


def torques_at_motor(duty: Duty, gears: GearList, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at the motor, shape (N, G); loss-free where no efficiency is known.

    A stated efficiency has precedence over a supplied curve, which is read at a phase's peak for the peak and at its
    RMS for the RMS. In a motion with a known motor inertia the torque counts at every instant, that inertia included.
    A gear's own inertia and no-load torque from a supplement count as well. With many motors of one application shape
    (motors, G).
    """
    stated, ratio = duty.asked["requirements.efficiency"], gears.columns.ratio
    eta = np.where(np.isnan(stated), 1.0, stated)
    peak = equations.motor_torque(output_torque_Nm=duty.maximum_torque_Nm, ratio=ratio, efficiency=eta)
    rated = equations.motor_torque(output_torque_Nm=duty.rms_torque_Nm, ratio=ratio, efficiency=eta)
    peaks, squares = duty.phases.peak_torque_Nm[:, 0], duty.phases.rms_torque_Nm[:, 0]
    for place in _apart(duty, gears, catalogue):
        own, some = _by_curve(duty, place, gears, catalogue)
        at_peak, at_rms = (_at_motor(T, duty, place, own, gears, catalogue) for T in (peaks, squares))
        rms = equations.rms_torque(
            torque_Nm=at_rms,
            duration_s=duty.phases.duration_s[:, 0],
            pause_s=duty.asked["duty_cycle.pause_s"][:, 0],
        )
        peak[some, place], rated[some, place] = at_peak.max(axis=1)[some], rms[some]
    inertia = duty.asked["requirements.motor.inertia_kgm2"][:, 0]
    many = len(inertia) > len(peak)
    if many:
        peak, rated = (np.repeat(torque, len(inertia), axis=0) for torque in (peak, rated))
    for index, course in duty.courses.items():
        rows = np.arange(len(inertia)) if many else np.array([index])
        heavy = rows[~np.isnan(inertia[rows])]
        if heavy.size:
            peak[heavy], rated[heavy] = _with_own_inertia(duty, index, course, inertia[heavy], gears, catalogue)
    return peak, rated


def torques_by_phase(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
    """RMS torque at the motor in each phase, its own inertia left out, shape (N, G, phases).

    Of all gears alike, shape (N, 1, phases), but for a factor, where no gear has figures of its own.
    """
    T = duty.phases.rms_torque_Nm
    apart = _apart(duty, gears, catalogue)
    if not apart:
        return T
    stated = duty.asked["requirements.efficiency"][..., None]
    eta = np.where(np.isnan(stated), 1.0, stated)
    torque = equations.motor_torque(output_torque_Nm=T, ratio=gears.columns.ratio[:, None], efficiency=eta)
    for place in apart:
        own, some = _by_curve(duty, place, gears, catalogue)
        torque[some, place] = _at_motor(T[:, 0], duty, place, own, gears, catalogue)[some]
    return torque


def _apart(duty: Duty, gears: GearList, catalogue: Catalogue) -> list[int]:
    """Places of gears whose torque at the motor goes by a curve, or has their torque without load in it."""
    unstated = bool(np.isnan(duty.asked["requirements.efficiency"]).any())
    curved = [place for place, gear in enumerate(gears.rows) if gear.designation in catalogue.efficiency]
    without_load = np.nan_to_num(gears.columns.no_load_torque_Nm)
    return sorted({*(curved if unstated else ()), *np.flatnonzero(without_load).tolist()})


def _by_curve(duty: Duty, place: int, gears: GearList, catalogue: Catalogue) -> tuple[BoolArray, BoolArray]:
    """True for applications in which a gear goes by its curve, and in which its figures count, shape (N,)."""
    unstated = np.isnan(duty.asked["requirements.efficiency"])[:, 0]
    own = unstated & (gears.rows[place].designation in catalogue.efficiency)
    return own, own | bool(np.nan_to_num(gears.columns.no_load_torque_Nm)[place])


def _at_motor(
    torque_Nm: FloatArray, duty: Duty, place: int, own: BoolArray, gears: GearList, catalogue: Catalogue
) -> FloatArray:
    """Torque at the motor for torques of the phases at one gear, shape (N, phases)."""
    gear, stated = gears.rows[place], duty.asked["requirements.efficiency"]
    eta = np.where(np.isnan(stated), 1.0, stated)
    if own.any():
        eta = np.where(own[:, None], efficiency_at(torque_Nm, gear, catalogue), eta)
    moving = np.where(duty.phases.speed_rpm[:, 0] > 0, np.nan_to_num(gears.columns.no_load_torque_Nm)[place], 0.0)
    return equations.motor_torque(output_torque_Nm=torque_Nm, ratio=gear.ratio, efficiency=eta) + moving


def _with_own_inertia(
    duty: Duty, index: int, course: Course, inertia_kgm2: FloatArray, gears: GearList, catalogue: Catalogue
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at motors of application `index`, their own inertia included, shape (motors, G) each.

    Gears of one ratio without figures of their own have the same torques, which are computed once.
    """
    stated = duty.asked["requirements.efficiency"].item(index)
    alone = [
        gear.designation in catalogue.efficiency or gear.inertia_kgm2 or gear.no_load_torque_Nm for gear in gears.rows
    ]
    kinds = [gear.designation if own else str(gear.ratio) for gear, own in zip(gears.rows, alone, strict=True)]
    first = {kind: kinds.index(kind) for kind in kinds}
    at_peak, at_rms = (
        np.array([efficiency_at(T, gears.rows[place], catalogue, stated) for place in first.values()])
        for T in (course.peak_torque_Nm, course.rms_torque_Nm)
    )
    places = np.array(list(first.values()))
    of_gear, of_motor = np.tile(np.arange(len(places)), len(inertia_kgm2)), np.repeat(inertia_kgm2, len(places))
    own_inertia, without_load = (
        np.nan_to_num(column[places])[of_gear]
        for column in (gears.columns.inertia_kgm2, gears.columns.no_load_torque_Nm)
    )
    peak, rms = motor_torques(
        course,
        ratio=gears.columns.ratio[places][of_gear],
        efficiency_at_peak=at_peak[of_gear],
        efficiency_at_rms=at_rms[of_gear],
        motor_inertia_kgm2=of_motor + own_inertia,
        pause_s=duty.asked["duty_cycle.pause_s"].item(index),
        no_load_torque_Nm=without_load,
    )
    row = {kind: place for place, kind in enumerate(first)}
    rows = [row[kind] for kind in kinds]
    return peak.reshape(-1, len(places))[:, rows], rms.reshape(-1, len(places))[:, rows]


def torque_limit(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Torque η T_R / i in Nm to which a drive limits its motor, shape (N, G); NaN where T_R is not published.

    With it the output stays at or below T_R, whether the motor drives (at most i M) or brakes (up to i M / η), as long
    as its torque changes slowly against 1 / f_2. η as stated, else by a supplied curve at T_R, else 1.
    """
    T_R = gears.columns.repeated_peak_torque_Nm
    stated, known = duty.asked["requirements.efficiency"], known_efficiency(gears, catalogue)
    return np.where(np.isnan(stated), np.where(np.isnan(known), 1.0, known), stated) * T_R / gears.columns.ratio


@lru_cache(maxsize=256)
def known_efficiency(gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Efficiency of each gear at its T_R by its curve of a supplement, shape (G,); NaN without one. [-]"""
    known = np.full(len(gears.rows), np.nan)
    for place, gear in enumerate(gears.rows):
        if gear.designation in catalogue.efficiency:
            known[place] = efficiency_at(gears.columns.repeated_peak_torque_Nm[place : place + 1], gear, catalogue)[0]
    return known


def inertia_ratio(duty: Duty, gears: GearColumns, motor_inertia_kgm2: FloatArray) -> FloatArray:
    """Inertia of the load at the motor, with the gear's own where it is known, over the motor's; broadcasts. [-]"""
    return equations.inertia_ratio(
        load_inertia_kgm2=duty.load_inertia_kgm2,
        ratio=gears.ratio,
        motor_inertia_kgm2=motor_inertia_kgm2,
        gear_inertia_kgm2=np.nan_to_num(gears.inertia_kgm2),
    )


def efficiency_at(torque_Nm: FloatArray, gear: Gear, catalogue: Catalogue, stated: float = np.nan) -> FloatArray:
    """Efficiency of a gear at torques: as stated, else by the curve that a supplement gives of it, else 1. [-]

    Beyond the ends of the curve it is that of the nearer end.
    """
    if np.isnan(stated) and gear.designation in catalogue.efficiency:
        return np.interp(torque_Nm, *catalogue.efficiency[gear.designation])
    return np.full(np.shape(torque_Nm), 1.0 if np.isnan(stated) else stated)


def efficiencies(duty: Duty, gear: Gear, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Efficiency of a gear in each phase of one application, at the phase's peak and at its RMS."""
    phases, stated = duty.phases, duty.asked["requirements.efficiency"].item()
    at_peak, at_rms = (
        efficiency_at(torque[0, 0], gear, catalogue, stated) for torque in (phases.peak_torque_Nm, phases.rms_torque_Nm)
    )
    return at_peak, at_rms


def leaves_curve(catalogue: Catalogue, gear: Gear, duty: Duty, index: int) -> bool:
    """True where a torque of application `index` lies beyond the ends of a gear's efficiency curve, unless it is 0."""
    known, _ = catalogue.efficiency[gear.designation]
    torques = np.concatenate((duty.phases.peak_torque_Nm[index, 0], duty.phases.rms_torque_Nm[index, 0]))
    return bool(((torques > 0) & ((torques < known[0]) | (torques > known[-1]))).any())
