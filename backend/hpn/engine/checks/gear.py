"""Checks of the gear itself: torques, stops, input speeds and life (equations 17.2 to 17.10)."""

import numpy as np

from hpn.engine.check import RATING_TABLES, Case, Check
from hpn.engine.checks.dependence import AVERAGE_SPEED, STOP, holds_load
from hpn.physics import equations
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_


def _share_of_stops(case: Case) -> FloatArray:
    """Ratio of expected to allowed stops; infinite where none is allowed, even for an expected number of 0."""
    expected, allowed = case.inputs["emergency_stop.count"], case.figures.momentary_peak_count
    return np.where((allowed == 0) & ~np.isnan(expected), np.inf, expected / allowed)


def _share_of_peak(case: Case) -> FloatArray:
    """T_k / T_M; infinite where the brake does not stop the load."""
    share = equations.momentary_peak_torque_utilisation(
        emergency_stop_torque_Nm=case.figures.stop_torque_Nm,
        momentary_peak_torque_Nm=case.gears.momentary_peak_torque_Nm,
    )
    return share if case.duty.brakes is None else np.where(case.figures.stops.never_stops, np.inf, share)


GEAR: tuple[Check, ...] = (
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
        consequence=N_("Teeth and planet bearings fatigue: pitting and wear set in long before the planned life."),
        basis=N_(
            "The handbook tabulates no average torque T_A for HPN. Its worked example uses the rated torque T_N "
            "as T_A (equation 18.2), and so does this check."
        ),
        remedy=N_("Lower or shorten the phases with high torque, or choose a gear with a larger rated torque."),
        demand=lambda c: c.duty.average_torque_Nm,
        limit=lambda c: c.gears.rated_torque_Nm,
        limited_by="rated_torque_Nm",
        relation="T_av ≤ T_A = T_N",
        moves={"torque": 1.0},
        over={"torque_Nm": "rising", "speed_rpm": "weight", "duration_s": "weight", "motion": "ends"},
        weighted=lambda c: equations.power_ten_thirds(c.duty.phases.torque_Nm),
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
        remedy=N_("Accelerate and brake more gently, or choose a gear with a larger repeated peak torque."),
        demand=lambda c: c.duty.maximum_torque_Nm,
        limit=lambda c: c.gears.repeated_peak_torque_Nm,
        share=lambda c: equations.repeated_peak_torque_utilisation(
            maximum_torque_Nm=c.duty.maximum_torque_Nm, repeated_peak_torque_Nm=c.gears.repeated_peak_torque_Nm
        ),
        limited_by="repeated_peak_torque_Nm",
        relation="T_max ≤ T_R",
        moves={"torque": 1.0},
        over={"peak_torque_Nm": "rising", "motion": "ends"},
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
        tests=N_("The emergency-stop torque T_k stays within the momentary peak torque T_M."),
        consequence=N_("A single event can deform or break teeth, or make the input coupling slip."),
        basis=N_("Limit T_M of the rating table. Such a torque must not occur in the normal cycle."),
        remedy=N_("Limit the emergency-stop torque, or choose a gear with a larger momentary peak torque."),
        trigger="emergency_stop.torque_Nm",
        instead="emergency_stop.brake.torque_Nm",
        demand=lambda c: c.figures.stop_torque_Nm,
        limit=lambda c: c.gears.momentary_peak_torque_Nm,
        share=_share_of_peak,
        limited_by="momentary_peak_torque_Nm",
        relation="T_k ≤ T_M",
        over=STOP,
        proven=holds_load,
    ),
    Check(
        code="momentary_peak_count",
        name=N_("number of emergency stops"),
        title=N_("Number of emergency stops"),
        equation="17.9",
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("N_k,max"),
        source=RATING_TABLES,
        tests=N_("The expected number of emergency stops stays within the number that T_k / T_R permits."),
        consequence=N_("Each stop uses up part of a fatigue budget; when it is spent, teeth may break."),
        basis=N_("The equation holds for T_k above T_R; at or below T_R it sets no limit. The number is rounded down."),
        remedy=N_(
            "Make emergency stops rarer or gentler: the permitted number grows tenfold when T_k falls by two thirds"
            " of T_R."
        ),
        trigger="emergency_stop.count",
        demand=lambda c: c.inputs["emergency_stop.count"],
        limit=lambda c: c.figures.momentary_peak_count,
        share=_share_of_stops,
        limited_by="repeated_peak_torque_Nm",
        relation="N_k ≤ N_k,max",
        over=STOP,
        proven=holds_load,
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
        remedy=N_("Lengthen the pause, run slower, or choose a smaller ratio."),
        demand=lambda c: c.figures.average_input_speed_rpm,
        limit=lambda c: c.gears.average_input_speed_rpm,
        limited_by="average_input_speed_rpm",
        relation="n_in,av ≤ n_av(max)",
        moves={"speed": 1.0},
        over=AVERAGE_SPEED,
        weighted=lambda c: c.duty.phases.speed_rpm,
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
        remedy=N_("Lower the top speed, or choose a smaller ratio."),
        demand=lambda c: c.figures.maximum_input_speed_rpm,
        limit=lambda c: c.gears.maximum_input_speed_rpm,
        limited_by="maximum_input_speed_rpm",
        relation="n_in,max ≤ n_in(max)",
        moves={"speed": 1.0},
        over={"peak_speed_rpm": "rising", "motion": "ends"},
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
        tests=N_("The calculated life of the gear reaches the required life."),
        consequence=N_("The gear wears out before the planned end of its service."),
        basis=N_(
            "The equation gives the result as L10 (90 % survive), and so does this tool. The glossary describes the "
            "rated torque on a basis of 50 % failures (L50); the handbook leaves open which applies. Rated input "
            "speed 3000 rpm (glossary). The hours include the pause."
        ),
        remedy=N_("Lower the torque (it counts to the power 10/3), the speed or the duty, or choose a larger gear."),
        trigger="requirements.life_h",
        demand=lambda c: c.figures.life_L10_h,
        limited_by="rated_torque_Nm",
        relation="L_10 ≥ L_10,req",
        moves={"torque": 10 / 3, "speed": 1.0},
        over={**AVERAGE_SPEED, "torque_Nm": "rising", "requirements.life_h": "rising"},
        weighted=lambda c: c.duty.phases.speed_rpm * equations.power_ten_thirds(c.duty.phases.torque_Nm),
    ),
)
