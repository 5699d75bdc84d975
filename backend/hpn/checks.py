"""Every check, in one table.

The functions of an entry take a `Case`, in which what belongs to an application has shape (N, 1) and what belongs to a
gear (G,); NaN is not published or not asked for, infinity without a limit.
"""

import numpy as np

from hpn import equations
from hpn.check import Case, Check
from hpn.equations import FloatArray
from hpn.wording import N_


def _share_of_stops(case: Case) -> FloatArray:
    """Expected over allowed stops; infinite where not one is allowed, even for an expected number of 0."""
    expected, allowed = case.asked["emergency_stop.count"], case.figures.momentary_peak_count
    return np.where((allowed == 0) & ~np.isnan(expected), np.inf, expected / allowed)


def _middle_and_half(case: Case) -> tuple[FloatArray, FloatArray]:
    lowest, highest = case.gears.ambient_temperature_minimum_degC, case.gears.ambient_temperature_maximum_degC
    return (lowest + highest) / 2, (highest - lowest) / 2


def _nearer_end(case: Case) -> FloatArray:
    """The end of the permitted range of temperature on whose side of the middle the asked one lies."""
    asked, gears = case.asked["requirements.ambient_temperature_degC"], case.gears
    middle, _ = _middle_and_half(case)
    end = np.where(asked >= middle, gears.ambient_temperature_maximum_degC, gears.ambient_temperature_minimum_degC)
    return np.where(np.isnan(middle), np.nan, end)


def _distance_from_middle(case: Case) -> FloatArray:
    middle, half = _middle_and_half(case)
    distance: FloatArray = np.abs(case.asked["requirements.ambient_temperature_degC"] - middle) / half
    return distance


RATING_TABLES = N_("rating tables 10.1 to 12.2")
BEARING_LIMITS = N_("F_R,dyn(max) and F_A,dyn(max), rating tables 10.1 to 12.2")

CHECKS: tuple[Check, ...] = (
    Check(
        code="average_torque",
        name=N_("average torque"),
        title=N_("Load limit 1: average torque"),
        equation="17.2",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_A = T_N"),
        source=RATING_TABLES,
        tests=N_(
            "The average output torque T_av of the moving phases, weighted with speed and time to the power 10/3,"
            " stays within the permissible average torque."
        ),
        consequence=N_("Teeth and planet bearings fatigue: pitting and wear long before the life that was planned."),
        basis=N_(
            "The handbook tabulates no average torque T_A for HPN. Its worked example uses the rated torque T_N "
            "as T_A (equation 18.2), and so does this check."
        ),
        remedy=N_("Lower or shorten the phases with high torque, or take a gear with a larger rated torque."),
        demand=lambda c: c.duty.average_torque_Nm,
        limit=lambda c: c.gears.rated_torque_Nm,
        limited_by="rated_torque_Nm",
        relation="T_av ≤ T_A = T_N",
        moves={"torque": 1.0},
    ),
    Check(
        code="repeated_peak_torque",
        name=N_("repeated peak torque"),
        title=N_("Load limit 2: repeated peak torque"),
        equation="17.7",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_R"),
        source=RATING_TABLES,
        tests=N_(
            "The largest torque of the cycle T_max, holding phases included, stays within the repeated peak torque."
        ),
        consequence=N_("Every start and stop overloads teeth and shaft; cracks grow from the tooth roots."),
        basis=N_("Limit T_R of the rating table."),
        remedy=N_("Accelerate and brake more gently, or take a gear with a larger repeated peak torque."),
        demand=lambda c: c.duty.maximum_torque_Nm,
        limit=lambda c: c.gears.repeated_peak_torque_Nm,
        share=lambda c: equations.repeated_peak_torque_utilisation(
            maximum_torque_Nm=c.duty.maximum_torque_Nm, repeated_peak_torque_Nm=c.gears.repeated_peak_torque_Nm
        ),
        limited_by="repeated_peak_torque_Nm",
        relation="T_max ≤ T_R",
        moves={"torque": 1.0},
    ),
    Check(
        code="momentary_peak_torque",
        name=N_("momentary peak torque"),
        title=N_("Load limit 3: momentary peak torque"),
        equation="17.8",
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("T_M"),
        source=RATING_TABLES,
        tests=N_("The emergency-stop or collision torque T_k stays within the momentary peak torque."),
        consequence=N_("A single event can deform or break teeth, or make the input coupling slip."),
        basis=N_("Limit T_M of the rating table. Such a torque must not belong to the normal cycle."),
        remedy=N_("Limit the braking torque, or take a gear with a larger momentary peak torque."),
        asked="emergency_stop.torque_Nm",
        demand=lambda c: c.duty.emergency_stop_torque_Nm,
        limit=lambda c: c.gears.momentary_peak_torque_Nm,
        share=lambda c: equations.momentary_peak_torque_utilisation(
            emergency_stop_torque_Nm=c.duty.emergency_stop_torque_Nm,
            momentary_peak_torque_Nm=c.gears.momentary_peak_torque_Nm,
        ),
        limited_by="momentary_peak_torque_Nm",
        relation="T_k ≤ T_M",
    ),
    Check(
        code="momentary_peak_count",
        name=N_("number of emergency stops"),
        title=N_("Number of momentary peak torques"),
        equation="17.9",
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("N_k,max"),
        source=RATING_TABLES,
        tests=N_("The expected number of emergency stops stays within the number that T_k / T_R permits."),
        consequence=N_("Each stop uses up part of a fatigue budget; when it is spent, teeth may break."),
        basis=N_(
            "The equation holds where T_k is above T_R; at or below T_R it sets no limit. The number is a count, "
            "rounded down."
        ),
        remedy=N_(
            "Make emergency stops rarer or gentler: the permitted number grows tenfold when T_k falls by two thirds"
            " of T_R."
        ),
        asked="emergency_stop.count",
        demand=lambda c: c.asked["emergency_stop.count"],
        limit=lambda c: c.figures.momentary_peak_count,
        share=_share_of_stops,
        limited_by="repeated_peak_torque_Nm",
        relation="N_k ≤ N_k,max",
    ),
    Check(
        code="average_input_speed",
        name=N_("average input speed"),
        title=N_("Average input speed"),
        equation="17.5",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("n_av(max)"),
        source=RATING_TABLES,
        tests=N_(
            "The average output speed of the cycle, pause included, times the ratio stays within the average "
            "input speed for grease lubrication."
        ),
        consequence=N_("The gear heats up; grease thins and ages, seals wear."),
        basis=N_("Limit n_av(max) of the rating table, for grease."),
        remedy=N_("Add pause, run slower, or take a smaller ratio."),
        demand=lambda c: c.figures.average_input_speed_rpm,
        limit=lambda c: c.gears.average_input_speed_rpm,
        limited_by="average_input_speed_rpm",
        relation="n_in,av ≤ n_av(max)",
        moves={"speed": 1.0},
    ),
    Check(
        code="maximum_input_speed",
        name=N_("maximum input speed"),
        title=N_("Maximum input speed"),
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("n_in(max)"),
        source=RATING_TABLES,
        tests=N_("The largest output speed of the cycle times the ratio stays within the maximum input speed."),
        consequence=N_("Input bearing and seal overheat, and the lubricant film breaks down."),
        basis=N_(
            "Limit n_in(max) of the rating table, for grease and for short periods (glossary); the average has its own "
            "limit."
        ),
        remedy=N_("Lower the top speed, or take a smaller ratio."),
        demand=lambda c: c.figures.maximum_input_speed_rpm,
        limit=lambda c: c.gears.maximum_input_speed_rpm,
        limited_by="maximum_input_speed_rpm",
        relation="n_in,max ≤ n_in(max)",
        moves={"speed": 1.0},
    ),
    Check(
        code="life",
        name=N_("gear life"),
        title=N_("Life"),
        equation="17.10",
        unit="h",
        kind="minimum",
        group="load",
        limit_name=N_("L10 required"),
        source=RATING_TABLES,
        tests=N_("The calculated life of the gear reaches the life that you require."),
        consequence=N_("The gear wears out before the planned end of its service."),
        basis=N_(
            "The equation prints the result as L10 (90 % survive) and so does this tool. The glossary describes the "
            "rated torque on a basis of 50 % failures (L50); the handbook does not settle which holds. Rated input "
            "speed 3000 rpm (glossary). The hours include the pause."
        ),
        remedy=N_("Lower the torque (life grows with the power 10/3), the speed or the duty, or take a larger gear."),
        asked="requirements.life_h",
        demand=lambda c: c.figures.life_L10_h,
        limit=lambda c: c.asked["requirements.life_h"],
        limited_by="rated_torque_Nm",
        relation="L_10 ≥ L_10,req",
        moves={"torque": 10 / 3, "speed": 1.0},
    ),
    Check(
        code="output_bearing_load",
        name=N_("largest load on the output bearing"),
        title=N_("Output bearing: largest load"),
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("1"),
        source=BEARING_LIMITS,
        tests=N_("In every phase the load times f_w stays inside the envelope of the published maxima."),
        consequence=N_("Balls and raceways are indented, or the shaft deflects so far that the teeth run crooked."),
        basis=N_(
            "Interpolated between the two published limits; printed curve not available. That the limits belong to "
            "f_w = 1 is our reading. Slower running never enlarges this envelope."
        ),
        remedy=N_("Support the load outside the gear, move it, or take a larger size."),
        asked="output_load.load_coefficient",
        demand=lambda c: c.figures.bearing_load,
        limit=lambda c: np.ones((1, 1)),
        limited_by="dynamic_radial_load_N",
        relation="max f_w · P_i ≤ 1",
        moves={"load": 1.0},
    ),
    Check(
        code="output_bearing_life",
        name=N_("life of the output bearing"),
        title=N_("Output bearing: life"),
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("k"),
        source=BEARING_LIMITS,
        tests=N_(
            "The equivalent load f_w P_m of the cycle stays within the load k at which the bearing reaches the "
            "required life at the average output speed."
        ),
        consequence=N_("The output bearing pits: play, noise and leakage at the shaft seal."),
        basis=N_(
            "Life by ISO 281 with exponent 3 from the published condition of 100 rpm and 20000 h as L50. L10 = "
            "L50 / 5 is the relation of the maker’s other handbooks, not printed in this one. The hours include the "
            "pause."
        ),
        remedy=N_("Lower load, speed or required life, choose f_w with more care, or take a larger size."),
        asked="output_load.load_coefficient",
        demand=lambda c: c.figures.bearing_mean_load,
        limit=lambda c: c.figures.bearing_life_factor,
        limited_by="dynamic_radial_load_N",
        relation="f_w · P_m ≤ k",
        moves={"speed": 1 / 3, "load": 1.0},
    ),
    Check(
        code="motor_speed",
        name=N_("motor speed"),
        title=N_("Motor speed"),
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s maximum"),
        source=N_("your input"),
        tests=N_("The largest output speed times the ratio stays within the motor’s maximum speed."),
        consequence=N_("The motor can’t reach the speed that the cycle asks for."),
        basis=N_("Limit as you stated it."),
        remedy=N_("Take a smaller ratio, a faster motor, or a lower top speed."),
        asked="requirements.motor.maximum_speed_rpm",
        demand=lambda c: c.figures.maximum_input_speed_rpm,
        limit=lambda c: c.asked["requirements.motor.maximum_speed_rpm"],
        relation="n_in,max ≤ n_mot",
        moves={"speed": 1.0},
    ),
    Check(
        code="motor_peak_torque",
        name=N_("motor peak torque"),
        title=N_("Motor peak torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s peak torque"),
        source=N_("your input"),
        tests=N_(
            "The largest torque of the cycle over ratio and efficiency stays within the motor’s peak torque. The "
            "emergency stop does not count."
        ),
        consequence=N_("The motor can’t accelerate the load as the cycle asks."),
        basis=N_(
            "T_max / (i · η) with the efficiency that you state or a supplement gives; without one loss-free, a "
            "lower bound. With a motion and the motor’s inertia J_m the largest T / (i · η) + J_m · i · α, "
            "or T · η / i where the load drives. The inertia of the gear and losses without load are left out, "
            "and so is that of a motor for which none is given."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or accelerate more gently."),
        asked="requirements.motor.peak_torque_Nm",
        demand=lambda c: c.figures.motor_peak_torque_Nm,
        limit=lambda c: c.asked["requirements.motor.peak_torque_Nm"],
        relation="T_max / (i · η) ≤ T_mot",
        moves={"torque": 1.0},
        accepted=N_("the motor’s peak torque rises to {value}"),
    ),
    Check(
        code="motor_rated_torque",
        name=N_("motor rated torque"),
        title=N_("Motor rated torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s rated torque"),
        source=N_("your input"),
        tests=N_(
            "The RMS of the torque over the cycle, pause included, over ratio and efficiency stays within the "
            "motor’s rated torque."
        ),
        consequence=N_("The motor overheats."),
        basis=N_(
            "RMS of T / (i · η) with the efficiency that you state or a supplement gives; without one loss-free, a "
            "lower bound. With a motion and the motor’s inertia J_m that of T / (i · η) + J_m · i · α, or T · η / i "
            "where the load drives. The inertia of the gear and losses without load are left out, "
            "and so is that of a motor for which none is given."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or add pause."),
        asked="requirements.motor.rated_torque_Nm",
        demand=lambda c: c.figures.motor_rated_torque_Nm,
        limit=lambda c: c.asked["requirements.motor.rated_torque_Nm"],
        relation="T_rms / (i · η) ≤ T_mot,N",
        moves={"torque": 1.0},
        accepted=N_("the motor’s rated torque rises to {value}"),
    ),
    Check(
        code="motor_rated_speed",
        name=N_("motor rated speed"),
        title=N_("Motor rated speed"),
        equation="17.5",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s rated speed"),
        source=N_("your input"),
        tests=N_("The average output speed times the ratio, pause included, stays within the motor’s rated speed."),
        consequence=N_("The motor heats up: its rated torque holds up to its rated speed."),
        basis=N_("Limit as you stated it."),
        remedy=N_("Take a smaller ratio, a faster motor, or add pause."),
        asked="requirements.motor.rated_speed_rpm",
        demand=lambda c: c.figures.average_input_speed_rpm,
        limit=lambda c: c.asked["requirements.motor.rated_speed_rpm"],
        relation="n_in,av ≤ n_mot,N",
        moves={"speed": 1.0},
    ),
    Check(
        code="inertia_ratio",
        name=N_("inertia ratio"),
        title=N_("Inertia ratio"),
        equation=None,
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("your limit"),
        source=N_("your input"),
        tests=N_("The inertia of the load, seen from the motor, over the motor’s own stays within your limit."),
        consequence=N_("The axis is hard to control: it swings, or follows slowly."),
        basis=N_("J_L / (i² · J_m). The inertia of the gear is left out: it is not published in this handbook."),
        remedy=N_("Take a larger ratio, a motor with more inertia, or a lighter load."),
        asked="requirements.motor.inertia_ratio",
        demand=lambda c: equations.inertia_ratio(
            load_inertia_kgm2=c.duty.load_inertia_kgm2,
            ratio=c.gears.ratio,
            motor_inertia_kgm2=c.asked["requirements.motor.inertia_kgm2"],
        ),
        limit=lambda c: c.asked["requirements.motor.inertia_ratio"],
        relation="J_L / (i² · J_m) ≤ r_J",
        accepted=N_("the permitted inertia ratio rises to {value}"),
    ),
    Check(
        code="ambient_temperature",
        name=N_("ambient temperature"),
        title=N_("Ambient temperature"),
        equation=None,
        unit="°C",
        kind="range",
        group="property",
        limit_name=N_("permitted range"),
        source=RATING_TABLES,
        tests=N_("The ambient temperature lies in the range of the rating table."),
        consequence=N_("Cold grease does not flow; warm grease ages and leaks."),
        basis=N_(
            "Utilisation is the distance from the middle of the range over half the range. The lubricant’s range "
            "reaches down to -10 °C, the gear’s does not."
        ),
        remedy=N_("Heat, cool or shield the gear, or ask the maker for another lubricant."),
        asked="requirements.ambient_temperature_degC",
        demand=lambda c: c.asked["requirements.ambient_temperature_degC"],
        limit=_nearer_end,
        share=_distance_from_middle,
        limited_by="ambient_temperature_maximum_degC",
        relation="t_min ≤ t_amb ≤ t_max",
    ),
    Check(
        code="backlash",
        name=N_("backlash"),
        title=N_("Backlash"),
        equation=None,
        unit="arcmin",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("table 15.1"),
        tests=N_("The largest backlash of the gear stays within your limit."),
        consequence=N_("Positioning error and knocking at reversal."),
        basis=N_("The published figure is an upper limit for new gears and follows the number of stages."),
        remedy=N_("Take a single-stage ratio, or accept more backlash."),
        asked="requirements.backlash_arcmin",
        demand=lambda c: c.gears.backlash_arcmin,
        limit=lambda c: c.asked["requirements.backlash_arcmin"],
        limited_by="backlash_arcmin",
        relation="j ≤ j_req",
        accepted=N_("the backlash limit rises to {value}"),
    ),
    Check(
        code="torsional_stiffness",
        name=N_("torsional stiffness"),
        title=N_("Torsional stiffness"),
        equation=None,
        unit="Nm/rad",
        kind="minimum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("table 15.2"),
        tests=N_("The torsional stiffness K_3 of the gear reaches what you require."),
        consequence=N_("The output winds up under torque and swings after a move."),
        basis=N_("K_3 holds above 15 % of the rated torque (glossary)."),
        remedy=N_("Take a larger size."),
        asked="requirements.torsional_stiffness_Nm_per_rad",
        demand=lambda c: c.gears.torsional_stiffness_Nm_per_rad,
        limit=lambda c: c.asked["requirements.torsional_stiffness_Nm_per_rad"],
        limited_by="torsional_stiffness_Nm_per_rad",
        relation="K_3 ≥ K_3,req",
        accepted=N_("the required torsional stiffness drops to {value}"),
    ),
    Check(
        code="weight",
        name=N_("weight"),
        title=N_("Weight"),
        equation=None,
        unit="kg",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=RATING_TABLES,
        tests=N_("The net weight of the standard version stays within your limit."),
        consequence=N_("The axis that carries the gear becomes slower."),
        basis=N_("Net weight without packing, by number of stages."),
        remedy=N_("Take a smaller size or a single-stage ratio."),
        asked="requirements.weight_kg",
        demand=lambda c: c.gears.weight_kg,
        limit=lambda c: c.asked["requirements.weight_kg"],
        limited_by="weight_kg",
        relation="m ≤ m_req",
        accepted=N_("the weight limit rises to {value}"),
    ),
    Check(
        code="length",
        name=N_("length"),
        title=N_("Length"),
        equation=None,
        unit="mm",
        kind="maximum",
        group="property",
        limit_name=N_("your limit"),
        source=N_("tables 11.2 to 13.4"),
        tests=N_("The largest length L of the gear, which depends on the motor, stays within your limit."),
        consequence=N_("The gear does not fit its space."),
        basis=N_("L_max of the table; with a small motor the gear may be as short as L_min."),
        remedy=N_("Take a smaller size or a single-stage ratio, or check the drawing for your motor."),
        asked="requirements.length_mm",
        demand=lambda c: c.gears.length_max_mm,
        limit=lambda c: c.asked["requirements.length_mm"],
        limited_by="length_max_mm",
        relation="L_max ≤ L_req",
        accepted=N_("the length limit rises to {value}"),
    ),
)
"""In the order of the contract; a tie for governing goes to the first."""

BY_CODE = {check.code: check for check in CHECKS}


def allowed(code: str | None, utilisation: float) -> float:
    """Largest utilisation with which the check of a code passes; 1 where there is none to name."""
    return 1.0 if code is None else BY_CODE[code].allowed(utilisation)
