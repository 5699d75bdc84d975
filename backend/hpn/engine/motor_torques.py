"""Motor torques under duty cycles, with the efficiency, inertia and no-load torque of gears."""

from collections.abc import Sequence
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
IntArray = NDArray[np.intp]


def torques_at_motor(duty: Duty, gears: GearList, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at the motor in Nm, shape (N, G); loss-free where no efficiency is known.

    A stated efficiency has precedence over a supplied curve, which is read at a phase's peak for the peak and at its
    RMS for the RMS. In a motion with a known motor inertia the torque counts at every instant, that inertia included. A
    gear's own inertia and no-load torque from a supplement count as well. With many motors of one application the shape
    is (motors, G).
    """
    stated, ratio = duty.inputs["requirements.efficiency"], gears.columns.ratio
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
            pause_s=duty.inputs["duty_cycle.pause_s"][:, 0],
        )
        peak[some, place], rated[some, place] = at_peak.max(axis=1)[some], rms[some]
    count = len(duty.inputs["requirements.motor.inertia_kgm2"])
    if count > len(peak):  # many motors of one application
        peak, rated = (np.repeat(torque, count, axis=0) for torque in (peak, rated))
    for courses, rows in _driven(duty):
        peak[rows], rated[rows] = _with_own_inertia(duty, courses, rows, gears, catalogue)
    return peak, rated


def _driven(duty: Duty) -> list[tuple[list[Course], IntArray]]:
    """Courses in which a motor's own inertia counts, and their rows, shape (times, courses).

    Courses with one row each form one group; a course with more rows, as for many motors or points of a box, is alone.
    """
    inertia = duty.inputs["requirements.motor.inertia_kgm2"][:, 0]
    known, many = ~np.isnan(inertia), len(inertia) > len(duty.typed.torque_Nm)
    rows_of = [
        (course, np.flatnonzero(known).tolist() if many else [index for index in indices if known[index]])
        for course, indices in courses_once(duty)
    ]
    single = [(course, rows[0]) for course, rows in rows_of if len(rows) == 1]
    groups = [([course], np.array(rows)[:, None]) for course, rows in rows_of if len(rows) > 1]
    if single:
        groups.append(([course for course, _ in single], np.array([[row for _, row in single]])))
    return groups


def courses_once(duty: Duty) -> list[tuple[Course, list[int]]]:
    """Distinct courses, and the applications with each of them: points of a box share one."""
    courses: dict[int, tuple[Course, list[int]]] = {}
    for index, course in duty.courses.items():
        courses.setdefault(id(course), (course, []))[1].append(index)
    return list(courses.values())


def asked_in(duty: Duty, path: str, rows: IntArray) -> FloatArray:
    """An input in some rows, of the shape of `rows`; for many motors of one application the single value is
    repeated.
    """
    values = duty.inputs[path][:, 0]
    return values[rows] if len(values) > 1 else np.full(rows.shape, values[0])


def torques_by_phase(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
    """RMS torque at the motor in Nm in each phase without its own inertia, shape (N, G, phases).

    Shape (N, 1, phases), correct up to a factor per gear, where no gear has figures of its own.
    """
    T = duty.phases.rms_torque_Nm
    apart = _apart(duty, gears, catalogue)
    if not apart:
        return T
    stated = duty.inputs["requirements.efficiency"][..., None]
    eta = np.where(np.isnan(stated), 1.0, stated)
    torque = equations.motor_torque(output_torque_Nm=T, ratio=gears.columns.ratio[:, None], efficiency=eta)
    for place in apart:
        own, some = _by_curve(duty, place, gears, catalogue)
        torque[some, place] = _at_motor(T[:, 0], duty, place, own, gears, catalogue)[some]
    return torque


def _apart(duty: Duty, gears: GearList, catalogue: Catalogue) -> list[int]:
    """Places of gears whose motor torque follows an efficiency curve or includes a no-load torque."""
    unstated = bool(np.isnan(duty.inputs["requirements.efficiency"]).any())
    curved = [place for place, gear in enumerate(gears.rows) if gear.designation in catalogue.efficiency]
    without_load = np.nan_to_num(gears.columns.no_load_torque_Nm)
    return sorted({*(curved if unstated else ()), *np.flatnonzero(without_load).tolist()})


def _by_curve(duty: Duty, place: int, gears: GearList, catalogue: Catalogue) -> tuple[BoolArray, BoolArray]:
    """True for applications in which a gear's curve counts, and True for those in which any of its figures counts,
    shape (N,).
    """
    unstated = np.isnan(duty.inputs["requirements.efficiency"])[:, 0]
    own = unstated & (gears.rows[place].designation in catalogue.efficiency)
    return own, own | bool(np.nan_to_num(gears.columns.no_load_torque_Nm)[place])


def _at_motor(
    torque_Nm: FloatArray, duty: Duty, place: int, own: BoolArray, gears: GearList, catalogue: Catalogue
) -> FloatArray:
    """Torque at the motor in Nm for torques of the phases at one gear, shape (N, phases)."""
    gear, stated = gears.rows[place], duty.inputs["requirements.efficiency"]
    eta = np.where(np.isnan(stated), 1.0, stated)
    if own.any():
        eta = np.where(own[:, None], efficiency_at(torque_Nm, gear, catalogue), eta)
    moving = np.where(duty.phases.speed_rpm[:, 0] > 0, np.nan_to_num(gears.columns.no_load_torque_Nm)[place], 0.0)
    return equations.motor_torque(output_torque_Nm=torque_Nm, ratio=gear.ratio, efficiency=eta) + moving


def _with_own_inertia(
    duty: Duty, courses: Sequence[Course], rows: IntArray, gears: GearList, catalogue: Catalogue
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque in Nm at motors along courses, their own inertia included, shape (times, courses, G) each.

    Gears of one ratio without figures of their own have the same torques, which are computed once. `rows` (times,
    courses) are the rows of inertia, pause and efficiency.
    """
    places, kinds = kinds_of(gears, catalogue)
    inertia, pause_s, stated = (
        asked_in(duty, path, rows)
        for path in ("requirements.motor.inertia_kgm2", "duty_cycle.pause_s", "requirements.efficiency")
    )
    at_peak, at_rms = (
        _efficiencies_along(courses, name, stated, [gears.rows[place] for place in places.tolist()], catalogue)
        for name in ("peak_torque_Nm", "rms_torque_Nm")
    )
    of_gear = np.tile(np.arange(len(places)), len(rows))
    own_inertia, without_load = (
        np.nan_to_num(column[places])[of_gear]
        for column in (gears.columns.inertia_kgm2, gears.columns.no_load_torque_Nm)
    )
    torques = motor_torques(
        courses,
        ratio=gears.columns.ratio[places][of_gear],
        efficiency_at_peak=at_peak,
        efficiency_at_rms=at_rms,
        motor_inertia_kgm2=np.repeat(inertia, len(places), axis=0) + own_inertia[:, None],
        pause_s=np.repeat(pause_s, len(places), axis=0),
        no_load_torque_Nm=without_load,
    )
    peak, rms = (torque.reshape(-1, len(places), len(courses))[:, kinds].swapaxes(1, 2) for torque in torques)
    return peak, rms


def _efficiencies_along(
    courses: Sequence[Course], torque: str, stated: FloatArray, gears: Sequence[Gear], catalogue: Catalogue
) -> FloatArray:
    """Efficiencies of gears at a torque of the phases of concatenated courses, shape (times × gears, phases).

    `stated` has shape (times, courses).
    """
    T = np.concatenate([getattr(course, torque) for course in courses])
    of_phases = np.repeat(stated, [len(course.move) for course in courses], axis=1)
    known = np.array([efficiency_at(T, gear, catalogue) for gear in gears])
    eta = np.where(np.isnan(of_phases)[:, None], known, of_phases[:, None])
    return eta.reshape(-1, len(T))


def kinds_of(gears: GearList, catalogue: Catalogue) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Places of the first gear of each kind, shape (kinds,), and the kind of each gear, (G,).

    Gears of one ratio without figures of their own form one kind: they have the same torques at the motor.
    """
    alone = [
        gear.designation in catalogue.efficiency or gear.inertia_kgm2 or gear.no_load_torque_Nm for gear in gears.rows
    ]
    names = [gear.designation if own else str(gear.ratio) for gear, own in zip(gears.rows, alone, strict=True)]
    first = {name: names.index(name) for name in names}
    kinds = {name: kind for kind, name in enumerate(first)}
    return np.array(list(first.values())), np.array([kinds[name] for name in names])


def peaks_by_phase(duty: Duty, places: NDArray[np.intp], gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Largest torque at the motor in Nm in each phase on some gears, without its own inertia, shape (N, places,
    phases).
    """
    peaks = duty.phases.peak_torque_Nm[:, 0]
    torques = (
        _at_motor(peaks, duty, place, _by_curve(duty, place, gears, catalogue)[0], gears, catalogue)
        for place in places.tolist()
    )
    return np.stack(list(torques), axis=1)


def torque_limit(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Torque limit η T_R / i in Nm for the drive's motor, shape (N, G); NaN where T_R is not published.

    It keeps the output at or below T_R, whether the motor drives (at most i M) or brakes (up to i M / η), as long as
    its torque changes slowly against 1 / f_2. η as stated, else by a supplied curve at T_R, else 1.
    """
    T_R = gears.columns.repeated_peak_torque_Nm
    stated, known = duty.inputs["requirements.efficiency"], known_efficiency(gears, catalogue)
    return np.where(np.isnan(stated), np.where(np.isnan(known), 1.0, known), stated) * T_R / gears.columns.ratio


@lru_cache(maxsize=256)
def known_efficiency(gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Efficiency of each gear at its T_R by its supplied curve, shape (G,); NaN without one. [-]"""
    known = np.full(len(gears.rows), np.nan)
    for place, gear in enumerate(gears.rows):
        if gear.designation in catalogue.efficiency:
            known[place] = efficiency_at(gears.columns.repeated_peak_torque_Nm[place : place + 1], gear, catalogue)[0]
    return known


def inertia_ratio(duty: Duty, gears: GearColumns, motor_inertia_kgm2: FloatArray) -> FloatArray:
    """Inertia of the load at the motor, plus the gear's own if known, over the motor's; broadcasts. [-]"""
    return equations.inertia_ratio(
        load_inertia_kgm2=duty.load_inertia_kgm2,
        ratio=gears.ratio,
        motor_inertia_kgm2=motor_inertia_kgm2,
        gear_inertia_kgm2=np.nan_to_num(gears.inertia_kgm2),
    )


def efficiency_at(torque_Nm: FloatArray, gear: Gear, catalogue: Catalogue, stated: float = np.nan) -> FloatArray:
    """Efficiency of a gear at torques: as stated, else by its supplied curve, else 1. [-]

    Beyond an end of the curve the value at that end counts.
    """
    if np.isnan(stated) and gear.designation in catalogue.efficiency:
        return np.interp(torque_Nm, *catalogue.efficiency[gear.designation])
    return np.full(np.shape(torque_Nm), 1.0 if np.isnan(stated) else stated)


def lines_of_efficiency(gears: Sequence[Gear], catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Torques in Nm and efficiencies of the gears' supplied curves, shape (gears, points); without one, 1 at any
    torque.

    Shorter curves end at infinite torques.
    """
    curves = [catalogue.efficiency.get(gear.designation, ((0.0,), (1.0,))) for gear in gears]
    shape = len(gears), max(len(torque) for torque, _ in curves)
    torques, efficiencies = np.full(shape, np.inf), np.ones(shape)
    for row, (torque, efficiency) in enumerate(curves):
        torques[row, : len(torque)], efficiencies[row] = torque, efficiency[-1]
        efficiencies[row, : len(torque)] = efficiency
    return torques, efficiencies


def efficiencies(duty: Duty, gear: Gear, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Efficiency of a gear in each phase of one application, at the phase's peak and at its RMS."""
    phases, stated = duty.phases, duty.inputs["requirements.efficiency"].item()
    at_peak, at_rms = (
        efficiency_at(torque[0, 0], gear, catalogue, stated) for torque in (phases.peak_torque_Nm, phases.rms_torque_Nm)
    )
    return at_peak, at_rms


def leaves_curve(catalogue: Catalogue, gear: Gear, duty: Duty, index: int) -> bool:
    """True where a non-zero torque of application `index` lies beyond the ends of a gear's efficiency curve."""
    known, _ = catalogue.efficiency[gear.designation]
    torques = np.concatenate((duty.phases.peak_torque_Nm[index, 0], duty.phases.rms_torque_Nm[index, 0]))
    return bool(((torques > 0) & ((torques < known[0]) | (torques > known[-1]))).any())
