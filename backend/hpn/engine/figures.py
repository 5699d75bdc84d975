"""Figures of gears under duty cycles: speeds, lives, stops, torques at the motor, load on the output bearing."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hpn.catalogue import Catalogue, GearList
from hpn.engine.duty import Duty
from hpn.engine.input_arrays import TextArray
from hpn.engine.motor_curves import CurveFigures, along_curves
from hpn.engine.motor_torques import torque_limit, torques_at_motor
from hpn.engine.stops import Stops
from hpn.physics import bearing, equations, shaft_load, stiffness
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.physics.stop import impact_speed


@dataclass(frozen=True, eq=False)
class Figures:
    """Figures of G gears under N applications, each array broadcasting to (N, G) and computed on first use.

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
        """NaN in place of a figure that no application asks for, shape (N, 1)."""
        return np.full_like(self.duty.average_torque_Nm, np.nan)

    @cached_property
    def motor_inertia_kgm2(self) -> FloatArray:
        """Inertia in kg m² of the motor, plus the gear's at its input from a supplement; shape (N, G)."""
        return self.duty.inputs["requirements.motor.inertia_kgm2"] + np.nan_to_num(self.gears.columns.inertia_kgm2)

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
        """The same as a length in mm at the requested radius, shape (N, G)."""
        radius = self.duty.inputs["requirements.position_radius_mm"]
        return stiffness.arc_length(angle_arcmin=self.position_error_arcmin, radius_mm=radius)

    @cached_property
    def stops(self) -> Stops:
        """Emergency stops by the brake."""
        return Stops(self.duty, self.gears.columns, self.motor_inertia_kgm2)

    @cached_property
    def stop_torque_Nm(self) -> FloatArray:
        """Torque T_k of an emergency stop in Nm: as given, else from the brake; shape (N, 1) or (N, G)."""
        torque = self.duty.typed_stop_torque_Nm
        return torque if self.duty.brakes is None else np.where(self.duty.brakes, self.stops.torque_Nm, torque)

    @cached_property
    def stop_radial_N(self) -> FloatArray:
        """Radial load in N of pinion or pulley in an emergency stop, shape (N, 1) or (N, G): 2 T_k / d at the rack."""
        duty = self.duty
        if not duty.has_shaft_drive:
            return self._unasked
        force: FloatArray = 2000 * self.stop_torque_Nm / duty.shaft_diameter_mm
        radial, _ = shaft_load.rack_load(force_N=force, helix_deg=duty.inputs["output_load.rack_helix_deg"])
        is_rack = duty.inputs.shaft_drive == "rack_and_pinion"
        return np.where(is_rack, radial, np.maximum(force, duty.shaft_radial_N))

    @cached_property
    def stop_energy_J(self) -> FloatArray:
        """Energy in J that the brake absorbs in one stop, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else self.stops.course.energy_J

    @cached_property
    def stopping_time_s(self) -> FloatArray:
        """Time of a stop in s from the command to rest, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else self.stops.course.time_s

    @cached_property
    def stopping_angle_deg(self) -> FloatArray:
        """Angle of the output in a stop in degrees, shape (N, G)."""
        return self._unasked if self.duty.brakes is None else np.degrees(self.stops.course.angle_rad)

    @cached_property
    def stopping_distance_mm(self) -> FloatArray:
        """The same as a length in mm at the requested radius, shape (N, G)."""
        radius = self.duty.inputs["requirements.position_radius_mm"]
        return self._unasked if self.duty.brakes is None else self.stops.course.angle_rad * radius

    @cached_property
    def end_stop_speed_rpm(self) -> FloatArray:
        """Lowest output speed in rpm at which the load, meeting an end stop, brings the gear to T_M, shape (N, G)."""
        at_output = np.square(self.gears.columns.ratio) * self.motor_inertia_kgm2
        return self._impact_speed_rpm(at_output)

    @cached_property
    def motor_lock_speed_rpm(self) -> FloatArray:
        """Lowest output speed in rpm at which a locking motor brings the gear to T_M, shape (N, G)."""
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
        """Permissible load factor k of the output bearing at speed and required life, shape (N, 1). [-]"""
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
    def judged_bearing_life_h(self) -> FloatArray:
        """Life of the output bearing in hours on the basis (L10 or L50) of the required life, shape (N, G)."""
        return np.where(self.duty.inputs.life_basis == "L10", self.bearing_life_L10_h, self.bearing_life_L50_h)

    @cached_property
    def shortest_life_h(self) -> FloatArray:
        """The smaller of gear life L10 and judged bearing life in hours, shape (N, G); the gear's without a load.

        NaN if one of them is not rated.
        """
        loaded = ~np.isnan(self.duty.inputs["output_load.load_coefficient"])
        return np.where(loaded, np.minimum(self.life_L10_h, self.judged_bearing_life_h), self.life_L10_h)

    @cached_property
    def shortest_life_of(self) -> TextArray:
        """Name of the shortest life, shape (N, G): gear or bearing, with its basis; blank without a number."""
        of_bearing = np.where(self.duty.inputs.life_basis == "L10", "bearing_L10", "bearing_L50")
        is_gear = self.shortest_life_h >= self.life_L10_h * (1 - ROUNDING)
        return np.where(np.isfinite(self.shortest_life_h), np.where(is_gear, "gear_L10", of_bearing), "")

    @cached_property
    def motor_peak_torque_Nm(self) -> FloatArray:
        """Largest torque of the cycle at the motor in Nm, shape (N, G)."""
        return self._motor_torques[0]

    @cached_property
    def motor_rated_torque_Nm(self) -> FloatArray:
        """RMS torque of the cycle at the motor in Nm, shape (N, G)."""
        return self._motor_torques[1]

    @cached_property
    def by_curve(self) -> CurveFigures:
        """Figures of the motor along its torque curve."""
        return along_curves(self.duty, self.gears, self.catalogue)

    @cached_property
    def motor_thermal_torque_Nm(self) -> FloatArray:
        """RMS torque in Nm at which the motor's losses balance along its curve, shape (N, G)."""
        return self.by_curve.thermal_Nm

    @cached_property
    def motor_mean_speed_torque_Nm(self) -> FloatArray:
        """Continuous torque in Nm of the motor's curve at its mean speed, shape (N, G)."""
        return self.by_curve.at_mean_speed_Nm

    @cached_property
    def motor_torque_limit_Nm(self) -> FloatArray:
        """Torque limit in Nm of the drive that keeps the output at or below T_R; shape (N, G)."""
        return torque_limit(self.duty, self.gears, self.catalogue)

    @cached_property
    def _bearing_loads(self) -> tuple[FloatArray, FloatArray]:
        return _bearing_loads(self.duty, self.gears, radial_at_centre(self.duty, self.gears))

    @cached_property
    def bearing_loads_at_least(self) -> tuple[FloatArray, FloatArray]:
        """Lower bounds of both loads where only the shaft's centre is unknown, else NaN; shape (N, G).

        They count the loads at the shaft's centre and along its axis: no lever makes them smaller.
        """
        at_centre = self.duty.phases.radial_N
        if radial_at_centre(self.duty, self.gears) is at_centre:
            return self._unasked, self._unasked
        largest, mean = _bearing_loads(self.duty, self.gears, at_centre)
        unknown = np.isnan(self.bearing_load)
        return np.where(unknown, largest, np.nan), np.where(unknown, mean, np.nan)

    @cached_property
    def _motor_torques(self) -> tuple[FloatArray, FloatArray]:
        return torques_at_motor(self.duty, self.gears, self.catalogue)


# --- Output bearing ---------------------------------------------------------------------------------------------------


def phase_loads(duty: Duty, gears: GearList, radial_N: FloatArray | None = None) -> FloatArray:
    """Load f_w P of every phase on the bearing of every size, shape (N, sizes, phases); `radial_N` acts at the centre.

    NaN without a load, where the limits of a size are not published, and where the digitised model lacks its curve.
    """
    first, phases, model = gears.first_of_size, duty.phases, duty.inputs.bearing_model[..., None]
    radial = radial_at_centre(duty, gears) if radial_N is None else radial_N
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
    return P * duty.inputs["output_load.load_coefficient"][..., None]


def radial_at_centre(duty: Duty, gears: GearList) -> FloatArray:
    """Radial load in N at the shaft's centre equivalent to each phase's loads, on every size; shape (N, sizes or 1,
    phases).

    NaN where the shaft's centre is unknown and a lever acts in some phase; the radial load itself without a lever.
    """
    inputs, phases = duty.inputs, duty.phases
    x, y = inputs["output_load.radial_position_mm"], inputs["output_load.axial_radius_mm"]
    if np.isnan(x).all() and not (y > 0).any():
        return phases.radial_N
    radial = bearing.radial_load_at_centre(
        radial_N=phases.radial_N,
        axial_N=phases.axial_N,
        radial_position_mm=x[..., None],
        axial_radius_mm=np.where(np.isnan(y), 0.0, y)[..., None],
        shaft_centre_mm=shaft_centre_mm(duty, gears)[..., None],
    )
    return np.where(np.isnan(radial).any(axis=-1, keepdims=True), np.nan, radial)


def shaft_centre_mm(duty: Duty, gears: GearList) -> FloatArray:
    """Distance x_c in mm of the shaft's centre of every size, shape (N, sizes): the catalogue's, else as given.

    NaN if neither is known.
    """
    own = gears.columns.shaft_centre_mm[gears.first_of_size]
    typed = duty.inputs.shaft_centre_mm([gears.rows[place].size for place in gears.first_of_size.tolist()])
    return np.where(np.isnan(own), typed, own)


def _bearing_loads(duty: Duty, gears: GearList, radial_N: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest f_w P of a phase, and f_w P_m of the cycle, on every gear, shape (N, G)."""
    if np.isnan(duty.inputs["output_load.load_coefficient"]).all():
        nothing = np.full((1, 1), np.nan)
        return nothing, nothing
    loads, phases = phase_loads(duty, gears, radial_N), duty.phases
    mean = bearing.mean_equivalent_load(equivalent_load=loads, speed_rpm=phases.speed_rpm, duration_s=phases.duration_s)
    return loads.max(axis=-1)[:, gears.of_size], mean[:, gears.of_size]
