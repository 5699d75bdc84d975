"""Figures of gears under duty cycles: speeds, lives, stops, torques at the motor, load on the output bearing."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hpn.catalogue import Catalogue, GearColumns, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.duty import Duty
from hpn.engine.stops import Stops
from hpn.physics import bearing, equations, stiffness
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Course, motor_torques
from hpn.physics.stop import impact_speed


@dataclass(frozen=True, eq=False)
class Figures:
    """Figures of G gears under N applications, each array broadcasting to (N, G) and computed when it is first read.

    NaN: not published, or not asked for; infinity: without a limit.
    """

    duty: Duty
    gears: GearList
    catalogue: Catalogue

    @cached_property
    def average_input_speed_rpm(self) -> FloatArray:
        """Average input speed n_in_av in rpm, equation 17.5; shape (N, G)."""
        return equations.average_input_speed(
            ratio=self.gears.columns.ratio, average_output_speed_rpm=self.duty.average_output_speed_rpm
        )

    @cached_property
    def maximum_input_speed_rpm(self) -> FloatArray:
        """Maximum input speed n_in_max in rpm, equation 17.6; shape (N, G)."""
        return equations.maximum_input_speed(
            ratio=self.gears.columns.ratio, maximum_output_speed_rpm=self.duty.maximum_output_speed_rpm
        )

    @cached_property
    def life_L10_h(self) -> FloatArray:
        """Life L10 of the gear in hours, equation 17.10; shape (N, G)."""
        return equations.life(
            average_torque_Nm=self.duty.average_torque_Nm,
            average_input_speed_rpm=self.average_input_speed_rpm,
            rated_torque_Nm=self.gears.columns.rated_torque_Nm,
            rated_input_speed_rpm=self.catalogue.rated_input_speed_rpm,
            life_at_rated_torque_h=self.catalogue.life_at_rated_torque_h,
        )

    @cached_property
    def momentary_peak_count(self) -> FloatArray:
        """Permitted number N_k,max of emergency stops, equation 17.9; shape (N, G). [-]"""
        return equations.allowed_momentary_peaks(
            emergency_stop_torque_Nm=self.stop_torque_Nm,
            repeated_peak_torque_Nm=self.gears.columns.repeated_peak_torque_Nm,
        )

    @cached_property
    def _unasked(self) -> FloatArray:
        """NaN in place of a figure that nobody asked for, shape (N, 1)."""
        return np.full_like(self.duty.average_torque_Nm, np.nan)

    @cached_property
    def motor_inertia_kgm2(self) -> FloatArray:
        """Inertia of the motor, and of the gear at its input where a supplement gives it, in kg m²; shape (N, G)."""
        return self.duty.asked["requirements.motor.inertia_kgm2"] + np.nan_to_num(self.gears.columns.inertia_kgm2)

    @cached_property
    def natural_frequency_Hz(self) -> FloatArray:
        """Natural frequency of the load on the gear in Hz, the motor held; shape (N, G)."""
        if np.isnan(self.duty.load_inertia_kgm2).all():
            return self._unasked
        return stiffness.natural_frequency(
            torsional_stiffness_Nm_per_rad=self.gears.columns.torsional_stiffness_Nm_per_rad,
            load_inertia_kgm2=self.duty.load_inertia_kgm2,
        )

    @cached_property
    def drive_resonance_Hz(self) -> FloatArray:
        """Resonance of load and motor against each other in Hz, shape (N, G)."""
        if np.isnan(self.duty.load_inertia_kgm2).all() or np.isnan(self.motor_inertia_kgm2).all():
            return self._unasked
        return stiffness.drive_resonance(
            torsional_stiffness_Nm_per_rad=self.gears.columns.torsional_stiffness_Nm_per_rad,
            load_inertia_kgm2=self.duty.load_inertia_kgm2,
            ratio=self.gears.columns.ratio,
            motor_inertia_kgm2=self.motor_inertia_kgm2,
        )

    @cached_property
    def wind_up_arcmin(self) -> FloatArray:
        """Wind-up of the gear under T_max in arcmin, shape (N, G)."""
        return stiffness.wind_up(
            torque_Nm=self.duty.maximum_torque_Nm,
            torsional_stiffness_Nm_per_rad=self.gears.columns.torsional_stiffness_Nm_per_rad,
        )

    @cached_property
    def position_error_arcmin(self) -> FloatArray:
        """Position error of the output over the cycle in arcmin, shape (N, G)."""
        lowest, highest = self.duty.torque_range_Nm
        return stiffness.position_error(
            smallest_torque_Nm=lowest,
            largest_torque_Nm=highest,
            torsional_stiffness_Nm_per_rad=self.gears.columns.torsional_stiffness_Nm_per_rad,
            transmission_accuracy_arcmin=self.gears.columns.transmission_accuracy_arcmin,
            backlash_arcmin=self.gears.columns.backlash_arcmin,
        )

    @cached_property
    def position_error_mm(self) -> FloatArray:
        """The same as a length in mm at the radius that is asked for, shape (N, G)."""
        radius = self.duty.asked["requirements.position_radius_mm"]
        return stiffness.arc_length(angle_arcmin=self.position_error_arcmin, radius_mm=radius)

    @cached_property
    def stops(self) -> Stops:
        """Emergency stops by the brake."""
        return Stops(self.duty, self.gears.columns, self.drive_resonance_Hz, self.motor_inertia_kgm2)

    @cached_property
    def stop_torque_Nm(self) -> FloatArray:
        """Torque T_k of an emergency stop in Nm: as it is given, else that of the brake; shape (N, 1) or (N, G)."""
        given = self.duty.typed_stop_torque_Nm
        return given if self.duty.brakes is None else np.where(self.duty.brakes, self.stops.torque_Nm, given)

    @cached_property
    def stop_energy_J(self) -> FloatArray:
        """Energy of one stop in J that the brake takes, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else self.stops.course.energy_J

    @cached_property
    def stopping_time_s(self) -> FloatArray:
        """Time of a stop in s from the command to rest, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else self.stops.course.time_s

    @cached_property
    def stopping_angle_deg(self) -> FloatArray:
        """Angle in degrees that the output turns in a stop, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else np.degrees(self.stops.course.angle_rad)

    @cached_property
    def stopping_distance_mm(self) -> FloatArray:
        """The same as a length in mm at the radius that is asked for, shape (N, G)."""
        radius = self.duty.asked["requirements.position_radius_mm"]
        return self._unasked if self.duty.brakes is None else self.stops.course.angle_rad * radius

    @cached_property
    def end_stop_speed_rpm(self) -> FloatArray:
        """Output speed in rpm from which an end stop that the load meets brings the gear to T_M, shape (N, G)."""
        at_output = np.square(self.gears.columns.ratio) * self.motor_inertia_kgm2
        return self._impact_speed_rpm(at_output)

    @cached_property
    def motor_lock_speed_rpm(self) -> FloatArray:
        """Output speed in rpm from which a motor that locks brings the gear to T_M, shape (N, G)."""
        return self._impact_speed_rpm(self.duty.load_inertia_kgm2)

    def _impact_speed_rpm(self, inertia_kgm2: FloatArray) -> FloatArray:
        if np.isnan(inertia_kgm2).all():
            return self._unasked
        return impact_speed(
            momentary_peak_torque_Nm=self.gears.columns.momentary_peak_torque_Nm,
            torsional_stiffness_Nm_per_rad=self.gears.columns.torsional_stiffness_Nm_per_rad,
            inertia_kgm2=inertia_kgm2,
        )

    @cached_property
    def bearing_load(self) -> FloatArray:
        """Largest f_w P of a phase on the output bearing, shape (N, G). [-]"""
        return self._bearing_loads[0]

    @cached_property
    def bearing_mean_load(self) -> FloatArray:
        """Equivalent load f_w P_m of the cycle on the output bearing, shape (N, G). [-]"""
        return self._bearing_loads[1]

    @cached_property
    def bearing_life_factor(self) -> FloatArray:
        """Load factor k that speed and required life allow on the output bearing, shape (N, 1). [-]"""
        reference_speed_rpm, reference_life_h = self.catalogue.bearing_reference
        return bearing.life_factor(
            average_output_speed_rpm=self.duty.average_output_speed_rpm,
            required_life_L50_h=self.duty.required_bearing_life_L50_h,
            reference_speed_rpm=reference_speed_rpm,
            reference_life_h=reference_life_h,
        )

    @cached_property
    def bearing_life_L50_h(self) -> FloatArray:
        """Life L50 of the output bearing in hours, shape (N, G)."""
        reference_speed_rpm, reference_life_h = self.catalogue.bearing_reference
        return bearing.life_L50(
            equivalent_load=self.bearing_mean_load,
            average_output_speed_rpm=self.duty.average_output_speed_rpm,
            reference_speed_rpm=reference_speed_rpm,
            reference_life_h=reference_life_h,
        )

    @cached_property
    def bearing_life_L10_h(self) -> FloatArray:
        """Life L10 of the output bearing in hours, shape (N, G)."""
        return self.bearing_life_L50_h / bearing.L50_PER_L10

    @cached_property
    def motor_peak_torque_Nm(self) -> FloatArray:
        """Largest torque of the cycle at the motor in Nm, shape (N, G)."""
        return self._motor_torques[0]

    @cached_property
    def motor_rated_torque_Nm(self) -> FloatArray:
        """RMS torque of the cycle at the motor in Nm, shape (N, G)."""
        return self._motor_torques[1]

    @cached_property
    def _bearing_loads(self) -> tuple[FloatArray, FloatArray]:
        return _bearing_loads(self.duty, self.gears)

    @cached_property
    def _motor_torques(self) -> tuple[FloatArray, FloatArray]:
        return _motor_torques(self.duty, self.gears, self.catalogue)


# --- Output bearing ---------------------------------------------------------------------------------------------------


def phase_loads(duty: Duty, gears: GearList) -> FloatArray:
    """f_w P of every phase on the bearing of every size, shape (N, sizes, phases).

    NaN without a load, where the limits of a size are not published, and where the digitised model lacks its curve.
    """
    first, phases, model = gears.first_of_size, duty.phases, duty.asked.bearing_model[..., None]
    radial = radial_at_centre(duty, gears)
    with np.errstate(all="ignore"):
        r = radial / gears.columns.dynamic_radial_load_N[first][:, None]
        a = phases.axial_N / gears.columns.dynamic_axial_load_N[first][:, None]
    P = np.where(model == "iso281", bearing.iso281_load(radial=r, axial=a), bearing.linear_load(radial=r, axial=a))
    along = np.flatnonzero(model == "digitised")
    if along.size:
        P[along] = np.nan
        for place, gear in enumerate(first):
            if (curve := gears.curves[gear]) is not None:
                own = np.broadcast_to(radial, P.shape)[along, place]
                P[along, place] = curve.equivalent_load(own, phases.axial_N[along, 0])
    return P * duty.asked["output_load.load_coefficient"][..., None]


def radial_at_centre(duty: Duty, gears: GearList) -> FloatArray:
    """Radial load in N of every phase that stands for where it acts, on every size; shape (N, sizes or 1, phases).

    NaN where a lever acts and the shaft's centre is not known; the load itself where none is given.
    """
    asked, phases = duty.asked, duty.phases
    x, y = asked["output_load.radial_position_mm"], asked["output_load.axial_radius_mm"]
    if np.isnan(x).all() and not (y > 0).any():
        return phases.radial_N
    own, given = gears.columns.shaft_centre_mm[gears.first_of_size], asked["output_load.shaft_centre_mm"]
    return bearing.radial_load_at_centre(
        radial_N=phases.radial_N,
        axial_N=phases.axial_N,
        radial_position_mm=x[..., None],
        axial_radius_mm=np.where(np.isnan(y), 0.0, y)[..., None],
        shaft_centre_mm=np.where(np.isnan(own), given, own)[..., None],
    )


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

    A stated efficiency has precedence over a supplied curve, which is read at a phase's peak for the peak and at its
    RMS for the RMS. In a motion with a known motor inertia the torque counts at every instant, that inertia included.
    A gear's own inertia and no-load torque from a supplement count as well.
    """
    stated, ratio = duty.asked["requirements.efficiency"], gears.columns.ratio
    eta = np.where(np.isnan(stated), 1.0, stated)
    peak = equations.motor_torque(output_torque_Nm=duty.maximum_torque_Nm, ratio=ratio, efficiency=eta)
    rated = equations.motor_torque(output_torque_Nm=duty.rms_torque_Nm, ratio=ratio, efficiency=eta)
    peaks, squares, unstated = duty.phases.peak_torque_Nm[:, 0], duty.phases.rms_torque_Nm[:, 0], np.isnan(stated)[:, 0]
    curved = {place for place, gear in enumerate(gears.rows) if gear.designation in catalogue.efficiency}
    without_load = np.nan_to_num(gears.columns.no_load_torque_Nm)
    for place in sorted((curved if unstated.any() else set()) | set(np.flatnonzero(without_load).tolist())):
        gear, own = gears.rows[place], unstated & (place in curved)
        moving = np.where(duty.phases.speed_rpm[:, 0] > 0, without_load[place], 0.0)
        some = own | bool(without_load[place])
        at_peak, at_rms = (
            equations.motor_torque(
                output_torque_Nm=T,
                ratio=gear.ratio,
                efficiency=np.where(own[:, None], efficiency_along(catalogue, gear, T), eta) if own.any() else eta,
            )
            + moving
            for T in (peaks, squares)
        )
        rms = equations.rms_torque(
            torque_Nm=at_rms,
            duration_s=duty.phases.duration_s[:, 0],
            pause_s=duty.asked["duty_cycle.pause_s"][:, 0],
        )
        peak[some, place], rated[some, place] = at_peak.max(axis=1)[some], rms[some]
    for index, course in duty.courses.items():
        inertia = duty.asked["requirements.motor.inertia_kgm2"].item(index)
        if not np.isnan(inertia):
            peak[index], rated[index] = _with_own_inertia(duty, index, course, inertia, gears, catalogue)
    return peak, rated


def _with_own_inertia(
    duty: Duty, index: int, course: Course, inertia_kgm2: float, gears: GearList, catalogue: Catalogue
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque at the motor of application `index`, its own inertia included, shape (G,) each.

    Gears of one ratio without figures of their own have the same torques, which are computed once.
    """
    stated = duty.asked["requirements.efficiency"].item(index)
    curved = [np.isnan(stated) and gear.designation in catalogue.efficiency for gear in gears.rows]
    alone = [own or gear.inertia_kgm2 or gear.no_load_torque_Nm for gear, own in zip(gears.rows, curved, strict=True)]
    kinds = [gear.designation if own else str(gear.ratio) for gear, own in zip(gears.rows, alone, strict=True)]
    first = {kind: kinds.index(kind) for kind in kinds}
    eta = np.full((2, len(first), len(course.move)), 1.0 if np.isnan(stated) else stated)
    for row, place in enumerate(first.values()):
        if curved[place]:
            for at, T in enumerate((course.peak_torque_Nm, course.rms_torque_Nm)):
                eta[at, row] = efficiency_along(catalogue, gears.rows[place], T)
    peak, rms = torques_along(
        course,
        gears.columns,
        list(first.values()),
        efficiency_at_peak=eta[0],
        efficiency_at_rms=eta[1],
        inertia_kgm2=inertia_kgm2,
        pause_s=duty.asked["duty_cycle.pause_s"].item(index),
    )
    rows = [list(first).index(kind) for kind in kinds]
    return peak[rows], rms[rows]


def torques_along(
    course: Course,
    gears: GearColumns,
    places: list[int],
    *,
    efficiency_at_peak: FloatArray,
    efficiency_at_rms: FloatArray,
    inertia_kgm2: float | FloatArray,
    pause_s: float,
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque in Nm of motors with an inertia of their own along a motion, on the gears at some places.

    Of one motor on many gears, or of many motors on one gear; shape (gears,) or (motors,). The gear's own inertia and
    torque without load count where they are known.
    """
    own_inertia, without_load = (
        np.nan_to_num(column[places]) for column in (gears.inertia_kgm2, gears.no_load_torque_Nm)
    )
    return motor_torques(
        course,
        ratio=gears.ratio[places],
        efficiency_at_peak=efficiency_at_peak,
        efficiency_at_rms=efficiency_at_rms,
        motor_inertia_kgm2=inertia_kgm2 + own_inertia,
        pause_s=pause_s,
        no_load_torque_Nm=without_load,
    )


def inertia_ratio(duty: Duty, gears: GearColumns, motor_inertia_kgm2: FloatArray) -> FloatArray:
    """Inertia of the load at the motor, with the gear's own where it is known, over the motor's; broadcasts. [-]"""
    return equations.inertia_ratio(
        load_inertia_kgm2=duty.load_inertia_kgm2,
        ratio=gears.ratio,
        motor_inertia_kgm2=motor_inertia_kgm2,
        gear_inertia_kgm2=np.nan_to_num(gears.inertia_kgm2),
    )


def efficiency_along(catalogue: Catalogue, gear: Gear, torque_Nm: FloatArray) -> FloatArray:
    """Efficiency at torques by the curve that a supplement gives of a gear; beyond its ends that of the nearer end.

    Raises KeyError for a gear without a curve.
    """
    return np.interp(torque_Nm, *catalogue.efficiency[gear.designation])


def efficiencies(duty: Duty, gear: Gear, catalogue: Catalogue) -> tuple[FloatArray, FloatArray]:
    """Efficiency of a gear in each phase of one application, at the phase's peak and at its RMS; 1 where none is known.

    The same as for torques at the motor: stated, else by a supplied curve.
    """
    phases, stated = duty.phases, duty.asked["requirements.efficiency"].item()
    torques = phases.peak_torque_Nm[0, 0], phases.rms_torque_Nm[0, 0]
    if np.isnan(stated) and gear.designation in catalogue.efficiency:
        at_peak, at_rms = (efficiency_along(catalogue, gear, torque) for torque in torques)
        return at_peak, at_rms
    eta = np.full(len(torques[0]), 1.0 if np.isnan(stated) else stated)
    return eta, eta


def leaves_curve(catalogue: Catalogue, gear: Gear, duty: Duty, index: int) -> bool:
    """True where a torque of application `index` lies beyond the ends of a gear's efficiency curve, unless it is 0."""
    known, _ = catalogue.efficiency[gear.designation]
    torques = np.concatenate((duty.phases.peak_torque_Nm[index, 0], duty.phases.rms_torque_Nm[index, 0]))
    return bool(((torques > 0) & ((torques < known[0]) | (torques > known[-1]))).any())
