"""Every public quantity: its name, the handbook's symbol for it, and one sentence on it.

A quantity's code is its place: an input's path in the application, or `duty`, `candidate`, `check`, `reserve` or `gear`
before a figure's field. Its unit is the suffix of the field. Page, report, workbook, Asset Administration Shell,
comparison, differences and the OpenAPI document all use this name.
"""

from collections.abc import Mapping
from typing import Literal

from hpn.words.motion import BODY, MOTION
from hpn.words.wording import N_, Named

CheckCode = Literal[
    "average_torque",
    "repeated_peak_torque",
    "momentary_peak_torque",
    "momentary_peak_count",
    "average_input_speed",
    "maximum_input_speed",
    "life",
    "output_bearing_load",
    "output_bearing_life",
    "motor_speed",
    "motor_peak_torque",
    "motor_rated_torque",
    "motor_rated_speed",
    "ambient_temperature",
    "backlash",
    "torsional_stiffness",
    "natural_frequency",
    "position_error",
    "weight",
    "length",
    "inertia_ratio",
]
"""Codes of the checks, in the order of the contract."""


INPUTS: Mapping[str, Named] = {
    "phase.torque_Nm": Named(N_("Torque"), "T"),
    "phase.speed_rpm": Named(N_("Speed"), "n"),
    "phase.duration_s": Named(N_("Duration"), "t"),
    "phase.radial_N": Named(N_("Radial load"), "F_R"),
    "phase.axial_N": Named(N_("Axial load"), "F_A"),
    "phase.peak_torque_Nm": Named(N_("Peak torque"), "T_pk"),
    "phase.peak_speed_rpm": Named(N_("Peak speed"), "n_pk"),
    "phase.rms_torque_Nm": Named(N_("RMS torque"), "T_rms"),
    "phase.least_torque_Nm": Named(N_("Least torque"), "T_min"),
    "phase.name": Named(N_("Name")),
    "duty_cycle.pause_s": Named(N_("Pause"), "t_p"),
    "emergency_stop.torque_Nm": Named(N_("Emergency-stop torque"), "T_k"),
    "emergency_stop.count": Named(N_("Expected emergency stops"), "N_k"),
    "emergency_stop.brake.torque_Nm": Named(N_("Brake torque"), "T_B"),
    "emergency_stop.brake.rise_time_s": Named(N_("Rise time of the brake"), "t_b"),
    "emergency_stop.brake.reaction_time_s": Named(N_("Reaction time"), "t_r"),
    "emergency_stop.brake.speed_rpm": Named(N_("Speed at the stop command"), "n_b"),
    "emergency_stop.brake.load_torque_Nm": Named(N_("Load’s torque in the stop"), "T_L"),
    "emergency_stop.brake.opposing_torque_Nm": Named(N_("Opposing torque in the stop"), "T_o"),
    "emergency_stop.brake.dynamic_factor": Named(N_("Dynamic factor"), "f"),
    "output_load.radial_N": Named(N_("Radial load of the cycle"), "F_R"),
    "output_load.axial_N": Named(N_("Axial load of the cycle"), "F_A"),
    "output_load.load_coefficient": Named(N_("Load coefficient"), "f_w"),
    "output_load.life_h": Named(N_("Required bearing life"), "L_b"),
    "output_load.life_basis": Named(N_("Life basis")),
    "output_load.model": Named(N_("Model of the bearing envelope")),
    "output_load.radial_position_mm": Named(N_("Radial load acts at"), "x"),
    "output_load.axial_radius_mm": Named(N_("Axial load acts at"), "y"),
    "output_load.shaft_centre_mm": Named(N_("Shaft’s centre at"), "x_c"),
    "output_load.from_motion": Named(N_("Load of the motion’s pinion or pulley")),
    "output_load.rack_helix_deg": Named(N_("Helix angle of the rack"), "β"),
    "output_load.belt_tension_factor": Named(N_("Tension factor of the belt"), "k_t"),
    "output_load.drive.type": Named(N_("On the gear’s shaft")),
    "output_load.drive.diameter_mm": Named(N_("Pitch diameter"), "d"),
    "requirements.life_h": Named(N_("Required gear life"), "L_10,req"),
    "requirements.utilisation": Named(N_("Maximum utilisation"), "u"),
    "requirements.worst_case_utilisation": Named(N_("Utilisation permitted in the worst case"), "u_w"),
    "requirements.over_tolerance": Named(N_("Gears judged")),
    "requirements.efficiency": Named(N_("Assumed efficiency"), "η"),
    "requirements.motor.maximum_speed_rpm": Named(N_("Maximum motor speed"), "n_mot"),
    "requirements.motor.peak_torque_Nm": Named(N_("Peak motor torque"), "T_mot"),
    "requirements.motor.rated_torque_Nm": Named(N_("Rated motor torque"), "T_mot,N"),
    "requirements.motor.rated_speed_rpm": Named(N_("Rated motor speed"), "n_mot,N"),
    "requirements.motor.inertia_kgm2": Named(N_("Inertia of the motor"), "J_m"),
    "requirements.motor.inertia_ratio": Named(N_("Largest inertia ratio"), "r_J"),
    "requirements.motor.stall_torque_Nm": Named(N_("Torque at standstill"), "M_0"),
    "requirements.motor.weight_kg": Named(N_("Weight of the motor"), "m_mot"),
    "requirements.motor.curve": Named(N_("Motor torque over speed"), "M_c"),
    "requirements.motor.name": Named(N_("Name of the motor")),
    "requirements.motor.designation": Named(N_("Motor of your list")),
    "requirements.load_inertia_kgm2": Named(N_("Inertia of the load"), "J_L"),
    "requirements.natural_frequency_Hz": Named(N_("Minimum natural frequency"), "f_req"),
    "requirements.position_error_arcmin": Named(N_("Maximum position error"), "φ_req"),
    "requirements.position_error_mm": Named(N_("Maximum position error as a length"), "s_req"),
    "requirements.position_radius_mm": Named(N_("Radius of the position"), "r_p"),
    "requirements.position_error_at": Named(N_("Position error counts")),
    "requirements.rest_friction_Nm": Named(N_("Dry friction at rest"), "T_f,rest"),
    "requirements.load_reverses": Named(N_("Torque acts both ways")),
    "requirements.ambient_temperature_degC": Named(N_("Ambient temperature"), "t_amb"),
    "requirements.backlash_arcmin": Named(N_("Maximum backlash"), "j_req"),
    "requirements.torsional_stiffness_Nm_per_rad": Named(N_("Minimum torsional stiffness"), "K_3,req"),
    "requirements.weight_kg": Named(N_("Maximum weight"), "m_req"),
    "requirements.length_mm": Named(N_("Maximum length"), "L_req"),
    "requirements.sizes": Named(N_("Only these sizes")),
    "requirements.ratios": Named(N_("Only these ratios"), "i"),
    "application_area": Named(N_("Area of use")),
    "rank_by": Named(N_("Rank by")),
}
"""Inputs, in the order of a file."""

DUTY: Mapping[str, Named] = {
    "average_torque_Nm": Named(N_("Average torque"), "T_av", "Average output torque T_av.", "17.2"),
    "average_output_speed_rpm": Named(
        N_("Average output speed"), "n_out,av", "Average output speed n_out,av, pause included.", "17.4"
    ),
    "maximum_torque_Nm": Named(N_("Maximum torque"), "T_max", "Largest torque T_max of the cycle."),
    "maximum_output_speed_rpm": Named(
        N_("Maximum output speed"), "n_out,max", "Largest output speed n_out,max of the cycle."
    ),
}

PHASE: Mapping[str, Named] = {
    name.removeprefix("phase."): Named(named.name, named.symbol, sentence)
    for (name, named), sentence in zip(
        INPUTS.items(),
        (
            "Mean torque weighted as in equation 17.2, with the torque’s sign.",
            "Mean speed, with the direction of the motion.",
            "Duration.",
            "Radial load; left out where the move has none.",
            "Axial load; left out where the move has none.",
            "Largest torque in the phase.",
            "Largest speed in the phase.",
            "RMS of the torque over the phase.",
            "Least magnitude of the torque in the phase.",
            "Name of the move that it belongs to; left out where it has none.",
        ),
        strict=False,
    )
}
"""Figures of a phase that results from a motion."""

CANDIDATE: Mapping[str, Named] = {
    "designation": Named(N_("Gear"), "", "Designation such as HPN-20A-5."),
    "size": Named(N_("Size"), "", "Size such as 20A."),
    "ratio": Named(N_("Ratio"), "i", "Ratio i."),
    "stages": Named(N_("Number of stages"), "", "Number of stages."),
    "status": Named(N_("Verdict"), "", "Verdict on the candidate."),
    "rank": Named(N_("Rank"), "", "Place among the suitable candidates; null for the rest."),
    "utilisation": Named(
        N_("Utilisation"), "", "Largest utilisation of the load checks and of failing property checks."
    ),
    "governing_check": Named(N_("Governing check"), "", "Code of the check with this utilisation."),
    "reason": Named(N_("Reason"), "", "Reason for the candidate’s status."),
    "missing": Named(
        N_("Missing inputs"),
        "",
        "Paths of the missing inputs, if nothing else keeps an unrated candidate from being rated; else empty.",
    ),
    "average_input_speed_rpm": Named(N_("Average input speed"), "n_in,av", "Average input speed.", "17.5"),
    "maximum_input_speed_rpm": Named(N_("Maximum input speed"), "n_in,max", "Maximum input speed.", "17.6"),
    "life_L10_h": Named(
        N_("Gear life"),
        "L_10",
        "Life as equation 17.10 gives it, named L10; the hours include the pause. Null where unlimited or not rated.",
        "17.10",
        caveat=N_("L10 as in eq. 17.10; the glossary’s basis is L50. The hours include the pause."),
    ),
    "momentary_peak_count": Named(
        N_("Permitted emergency stops"),
        "N_k,max",
        "Permitted number of emergency stops; null where the equation sets no limit.",
        "17.9",
    ),
    "bearing_life_L50_h": Named(
        N_("Bearing life L50"),
        "L_b,50",
        "Life of the output bearing on the basis L50: 50 % of the bearings survive it.",
    ),
    "bearing_life_L10_h": Named(
        N_("Bearing life L10"),
        "L_b,10",
        "Life of the output bearing on the basis L10: 90 % of the bearings survive it, L50 / 5.",
        caveat=N_("L10 = L50 / 5, a relation from other handbooks. The hours include the pause."),
    ),
    "shortest_life_h": Named(
        N_("Shortest life"),
        "",
        "The smaller of gear life L10 and, under a load, bearing life on its required basis. Null where both are "
        "unlimited or one is not rated.",
    ),
    "shortest_life_of": Named(
        N_("Shortest life of"), "", "Kind of the shortest life, with its basis; null without a number."
    ),
    "motor_peak_torque_Nm": Named(
        N_("Peak motor torque needed"),
        "T_max/(i·η)",
        "Largest torque at the motor, T/(i·η), without the emergency stop; along a motion with the motor’s own "
        "inertia, where that is given. Where no efficiency is known η is 1, and the torque a lower bound.",
    ),
    "motor_rated_torque_Nm": Named(
        N_("RMS motor torque needed"),
        "T_rms/(i·η)",
        "RMS torque at the motor, T/(i·η), over the cycle with pause; along a motion with the motor’s own inertia, "
        "where that is given. Where no efficiency is known η is 1, and the torque a lower bound.",
    ),
    "motor_thermal_torque_Nm": Named(
        N_("RMS torque by the motor’s losses"),
        "T_th",
        "RMS torque with which the motor’s losses balance along its torque curve: the root of the mean of M_c(n)² over "
        "the cycle, the pause at speed 0. Null without a curve, and beyond its last speed.",
    ),
    "motor_mean_speed_torque_Nm": Named(
        N_("RMS torque by the makers’ rule"),
        "M_c,av",
        "Continuous torque of the motor’s curve at the mean speed; the makers’ rule compares it with the RMS. Null "
        "likewise.",
    ),
    "motor_torque_limit_Nm": Named(
        N_("Torque limit of the drive"),
        "T_lim",
        "Torque η·T_R/i to set in the drive as the motor’s limit: with it the output stays at or below T_R, whether "
        "the motor drives or brakes. Where no efficiency is known η is 1. Null where T_R is not published.",
        caveat=N_("For torque that changes slowly against 1 / f_2: a step rings above it."),
    ),
    "natural_frequency_Hz": Named(
        N_("Natural frequency"),
        "f_1",
        "Natural frequency of the load on the gear, the motor held: an upper bound. Null without the load’s inertia.",
        caveat=N_("An upper bound: couplings and the gear’s own inertia lower it."),
    ),
    "drive_resonance_Hz": Named(
        N_("Drive resonance"),
        "f_2",
        "Resonance of load and motor against each other; null without both inertias.",
        caveat=N_("Load and motor free to turn; couplings lower it."),
    ),
    "wind_up_arcmin": Named(
        N_("Wind-up at T_max"),
        "φ_w",
        "Wind-up of the output under the largest torque: a lower bound.",
        caveat=N_("A lower bound, of the largest magnitude: the gear is softer below 15 % of the rated torque."),
    ),
    "position_error_arcmin": Named(
        N_("Position error"),
        "φ_e",
        "Transmission accuracy, wind-up over the torques of the cycle or of its rest and, where they pass 0, backlash.",
        caveat=N_(
            "Approximate: limits of a new gear, added; wind-up from the lowest to the highest torque, with their signs."
        ),
    ),
    "position_error_mm": Named(
        N_("Position error at the radius"),
        "s_e",
        "The same as a length at the given radius; null without one.",
    ),
    "stop_torque_Nm": Named(
        N_("Emergency-stop torque"),
        "T_k",
        "Torque of the gear in an emergency stop: as given, else the bound from the brake.",
    ),
    "stopping_time_s": Named(
        N_("Stopping time"),
        "t_stop",
        "Longest time from the command until brake and motor stand; null without both inertias, and where the brake "
        "does not stop the load.",
        caveat=N_("Until brake and motor stand; the load may swing on the gear for longer."),
    ),
    "stopping_angle_deg": Named(
        N_("Stopping angle"), "φ_stop", "Largest angle of the output from the command to rest; null likewise."
    ),
    "stopping_distance_mm": Named(
        N_("Stopping distance"), "s_stop", "The same as a length at the given radius; null without one."
    ),
    "stop_energy_J": Named(
        N_("Energy of one stop"), "E", "Largest energy that the brake takes in one stop; null likewise."
    ),
    "stop_radial_N": Named(
        N_("Radial load of the emergency stop"),
        "F_R,k",
        "Radial load of pinion or pulley at T_k; shown, not checked; null without an emergency stop, pinion or pulley.",
        caveat=N_("Load of pinion or pulley at T_k; not checked."),
    ),
    "end_stop_speed_rpm": Named(
        N_("Speed into an end stop"),
        "n_end",
        "Output speed from which a load that meets an end stop brings the gear to T_M; shown, not checked.",
        caveat=N_("From here on a load that meets an end stop brings the gear to T_M; not checked."),
    ),
    "motor_lock_speed_rpm": Named(
        N_("Speed with a locked motor"),
        "n_lock",
        "Output speed from which a motor that locks brings the gear to T_M; shown, not checked.",
        caveat=N_("From here on a motor that locks brings the gear to T_M; not checked."),
    ),
    "reserve": Named(N_("Reserve"), "", "Reserve per driver, the other inputs as given."),
    "checks": Named(N_("Checks"), "", "Every required check, in a fixed order."),
}

LISTED: Mapping[str, Named] = {
    "shortest_life_h": Named(N_("Life")),
    "maximum_input_speed_rpm": Named(N_("Input speed")),
}
"""Figures that the page lists for all candidates, with names short enough for a column."""

RESERVE: Mapping[str, Named] = {
    "torque_factor": Named(
        N_("All duty torques"), "", "Factor on all duty torques; null where nothing limits it or it is not rated."
    ),
    "speed_factor": Named(N_("All speeds"), "", "Factor on all speeds; null likewise."),
    "load_factor": Named(N_("All output loads"), "", "Factor on all output loads; null likewise."),
    "emergency_stop_torque_Nm": Named(N_("Emergency-stop torque"), "T_k", "Largest permissible emergency-stop torque."),
    "brake_torque_Nm": Named(
        N_("Largest permissible brake torque"),
        "T_B",
        "Largest brake torque at which the emergency stop passes by T_M, u and number; null without a brake.",
    ),
    "brake_torque_repeated_Nm": Named(
        N_("Largest brake torque, at T_R"),
        "T_B",
        "Largest brake torque that keeps the emergency stop at T_R, where equation 17.9 sets no limit; null likewise.",
        caveat=N_("With a stronger brake the number of stops is limited (17.9)."),
    ),
    "load_inertia_kgm2": Named(
        N_("Largest inertia of the load"),
        "J_L",
        "Largest inertia of the load with which natural frequency and inertia ratio pass; null where neither is "
        "required.",
    ),
}

CHECK: Mapping[str, Named] = {
    "code": Named(N_("Check"), "", "Code of the check; its definition stands in check_definitions."),
    "demand": Named(
        N_("Demand"), "", "Tested value, in the check’s unit; null where it is unlimited or not published."
    ),
    "limit": Named(
        N_("Limit"), "", "Limit of the tested value, in the check’s unit; null where it is unlimited or not published."
    ),
    "utilisation": Named(
        N_("Utilisation"), "", "Demand over limit (limit over demand for a minimum); null where there is none."
    ),
    "status": Named(N_("Verdict"), "", "Verdict of the check."),
    "at_least": Named(
        N_("Utilisation, at least"),
        "",
        "Lower bound of the utilisation if the check lacks an input to be rated; else null.",
    ),
}

GEAR: Mapping[str, Named] = {
    "designation": Named(N_("Gear"), "", "Designation such as HPN-20A-5."),
    "size": Named(N_("Size"), "", "Size such as 20A."),
    "ratio": Named(N_("Ratio"), "i", "Ratio i."),
    "stages": Named(N_("Number of stages"), "", "Number of stages."),
    "rated_torque_Nm": Named(N_("Rated torque"), "T_N", "Rated torque T_N."),
    "repeated_peak_torque_Nm": Named(N_("Repeated peak torque"), "T_R", "Repeated peak torque T_R."),
    "momentary_peak_torque_Nm": Named(N_("Momentary peak torque"), "T_M", "Momentary peak torque T_M."),
    "maximum_input_speed_rpm": Named(
        N_("Permissible maximum input speed"), "n_in(max)", "Permissible maximum input speed, grease."
    ),
    "average_input_speed_rpm": Named(
        N_("Permissible average input speed"), "n_av(max)", "Permissible average input speed, grease."
    ),
    "ambient_temperature_minimum_degC": Named(N_("Lowest ambient temperature"), "t_min", "Lowest ambient temperature."),
    "ambient_temperature_maximum_degC": Named(
        N_("Highest ambient temperature"), "t_max", "Highest ambient temperature."
    ),
    "backlash_arcmin": Named(N_("Backlash"), "j", "Largest backlash."),
    "transmission_accuracy_arcmin": Named(N_("Transmission accuracy"), "φ_a", "Largest transmission error."),
    "torsional_stiffness_Nm_per_rad": Named(N_("Torsional stiffness"), "K_3", "Torsional stiffness K_3."),
    "length_min_mm": Named(N_("Shortest length"), "L_min", "Shortest length L; it depends on the motor."),
    "length_max_mm": Named(N_("Longest length"), "L_max", "Longest length L; it depends on the motor."),
    "weight_kg": Named(N_("Weight"), "m", "Net weight of the standard version."),
    "dynamic_radial_load_N": Named(
        N_("Radial load without axial load"), "F_R,dyn(max)", "Permissible radial load at L50 20000 h and 100 rpm."
    ),
    "dynamic_axial_load_N": Named(
        N_("Axial load without radial load"), "F_A,dyn(max)", "Permissible axial load at L50 20000 h and 100 rpm."
    ),
    "shaft_centre_mm": Named(
        N_("Shoulder to shaft’s centre"),
        "x_c",
        "Distance from the shaft’s shoulder to its centre; only from a supplement.",
    ),
    "inertia_kgm2": Named(
        N_("Inertia at the input"), "J_g", "Moment of inertia of the gear at its input; only from a supplement."
    ),
    "no_load_torque_Nm": Named(N_("No-load torque"), "T_0", "No-load torque at the input; only from a supplement."),
    "clamp_bolts": Named(N_("Motor coupling bolt"), "", "Bolts of the motor coupling."),
    "housing_bolts": Named(N_("Housing bolts"), "", "Bolts of the housing flange."),
    "note": Named(N_("Note"), "", "Note on the size."),
    "sources": Named(N_("Source"), "", "Source of each figure, by field name."),
}

BOLT: Mapping[str, Named] = {
    "number_of_bolts": Named(N_("Number of bolts"), "", "Number of bolts."),
    "bolt_size": Named(N_("Thread"), "", "Thread."),
    "pitch_diameter_mm": Named(N_("Bolt pitch diameter"), "", "Bolt pitch diameter."),
    "tightening_torque_Nm": Named(N_("Tightening torque"), "", "Tightening torque."),
    "source": Named(N_("Source"), "", "Source of the figures."),
}

MOTOR: Mapping[str, Named] = {
    "designation": Named(N_("Motor"), "", "Designation of the motor."),
    "maximum_speed_rpm": Named(N_("Maximum motor speed"), "n_mot", "Maximum speed."),
    "rated_speed_rpm": Named(N_("Rated motor speed"), "n_mot,N", "Rated speed."),
    "rated_torque_Nm": Named(N_("Rated motor torque"), "T_mot,N", "Continuous torque."),
    "peak_torque_Nm": Named(N_("Peak motor torque"), "T_mot", "Peak torque."),
    "inertia_kgm2": Named(N_("Inertia of the motor"), "J_m", "Moment of inertia of the rotor."),
    "source": Named(N_("Source"), "", "Source of the figures."),
}

SERIES: Mapping[str, Named] = {
    "value": Named(N_("Value"), "", "The figure or text."),
    "unit": Named(N_("Unit"), "", "Its unit."),
    "source": Named(N_("Source"), "", "Source of the figure."),
}

ENVELOPE: Mapping[str, Named] = {
    "load_coefficient": Named(N_("Load coefficient"), "f_w", "Load coefficient f_w."),
    "radial_N": Named(N_("Radial load"), "F_R", "Radial loads, from the axial to the radial axis."),
    "axial_N": Named(N_("Axial load"), "F_A", "Axial loads, likewise."),
}

QUANTITIES: Mapping[str, Named] = {
    **INPUTS,
    **{f"motion.{place}": named for place, named in MOTION.items()},
    **{f"body.{place}": named for place, named in BODY.items()},
    **{
        f"{place}.{name}": named
        for place, table in (
            ("duty", DUTY),
            ("candidate", CANDIDATE),
            ("reserve", RESERVE),
            ("check", CHECK),
            ("gear", GEAR),
            ("bolt", BOLT),
            ("series", SERIES),
            ("motor", MOTOR),
            ("envelope", ENVELOPE),
        )
        for name, named in table.items()
    },
}
