"""A notice on a result: a code and values; its sentence is one of NOTICES, filled in where it is shown."""

from collections.abc import Mapping
from string import Formatter
from typing import Annotated

from msgspec import field
from pydantic import Field

from hpn.words.reply import Mixed, Reply
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Quantity, Rounding, Sentence

DIGITS: Mapping[str, int] = {"Nm": 6, "percent": 3, "s": 6, "h": 6, "N": 6, "kW_per_s": 4}
"""Digits of the numbers in a notice, by unit."""

NOTICES: Mapping[str, str] = {
    "motion_triangle": N_(
        "Moves {moves} leave no time at constant speed: they become triangular, although another profile was chosen."
    ),
    "motion_left_off": N_("The motion does not end at its start angle, so gravity acts differently in the next cycle."),
    "friction_without_effect": N_(
        "At an incline of ±90° no weight rests on the guide: its coefficient of friction has no effect. Give the "
        "friction of seals, wipers or pressed gibs as a force."
    ),
    "shaft_load_of_motion": N_(
        "The motion’s pinion or pulley loads the gear’s shaft with up to {radial_N} where it sits there: not counted."
    ),
    "shaft_load_counted": N_(
        "Pinion or pulley load the gear’s shaft with up to {radial_N}, from a tangential force of {force_N}; typed "
        "loads are added, their directions being unknown. A belt’s pretension acts at all times."
    ),
    "stop_radial_above_limit": N_(
        "In an emergency stop pinion or pulley load the shaft with up to {radial_N}, above the permissible radial load "
        "of {names}; not checked."
    ),
    "tolerances_of_motion_sampled": N_(
        "The motion itself varies with {count} tolerances. It is looked at in every corner with up to {most} of load, "
        "friction and efficiency; else it is sampled, as here, and a worse case may lie between the samples."
    ),
    "application_area": N_(
        "Use in this area ({area}) needs a risk assessment and the manufacturer’s approval (handbook 2.4)."
    ),
    "emergency_stop_below_maximum": N_(
        "The emergency-stop torque of {stop_Nm} is below the largest torque of the cycle, {largest_Nm}: check T_k."
    ),
    "momentary_peak_count_unlimited": N_(
        "Where the emergency-stop torque is at or below T_R, equation 17.9 sets no limit to the number of stops; the "
        "permitted number stays blank there."
    ),
    "stops_not_counted": N_(
        "An emergency stop is given without the number of stops: whether equation 17.9 permits that many is not "
        "checked."
    ),
    "bearing_life_at_default": N_(
        "A life of {gear_life_h} (L10) is required of the gear, but its output bearing is checked for the default of "
        "{bearing_life_h} (L50)."
    ),
    "radial_load_not_used": N_("The radial load of the whole cycle, {load_N}, is not used: every phase has its own."),
    "axial_load_not_used": N_("The axial load of the whole cycle, {load_N}, is not used: every phase has its own."),
    "life_unlimited": N_(
        "The average torque is 0 or so small that equation 17.10 gives an unlimited life; the field stays blank."
    ),
    "bearing_envelope_supplied": N_("The output bearing is checked against curve points that you supplied."),
    "speed_above_average": N_(
        "With ratio {ratios} the input runs above n_av(max) for {longest_s} without a break. The handbook’s average "
        "has no time scale: beyond {bound_s} (our assumption, setting HPN_AVERAGING_SECONDS) the thermal average may "
        "not hold."
    ),
    "bearing_envelope_computed": N_(
        "The envelope of the output bearing is interpolated between the two published limits; printed curve not "
        "available."
    ),
    "bearing_iso281": N_(
        "Model ISO 281 keeps the factor Y constant, set by the published axial limit; the standard tabulates a Y that "
        "falls as the axial load rises. It leaves out the thrust that a radial load induces in bearings in "
        "O-arrangement: in random geometries loads that it permits came to 1.38 times the limit with that thrust, 1.09 "
        "without. The straight line between the limits is the safe model."
    ),
    "bearing_load_position": N_(
        "Loads act at the centre of the output shaft and along its axis; give their positions where they act elsewhere."
    ),
    "bearing_lever": N_(
        "The loads act off the shaft’s centre and count as the radial load F_R · max(1, |x| / x_c) + F_A · y / x_c "
        "there: an upper bound for any bearing spacing. The shaft beyond its shoulder is not checked."
    ),
    "bearing_centre_unknown": N_(
        "The loads act off the shaft’s centre, whose distance from the shoulder is not published for {names}: give "
        "it, so that their bearings can be checked."
    ),
    "bearing_life_basis": N_(
        "Bearing life L10 = L50 / 5 is taken from the manufacturer’s other handbooks, not printed in this one; a "
        "Weibull slope of 10/9 gives 5.45."
    ),
    "bearing_life_unlimited": N_(
        "The equivalent load of the moving phases is 0 or so small that the bearing life is unlimited; the field "
        "stays blank."
    ),
    "efficiency_assumed": N_("Motor torques use the efficiency of {efficiency_percent} that you assume."),
    "efficiency_supplied": N_(
        "Motor torques use the efficiency curves that you supplied; a gear without one counts as loss-free, a lower "
        "bound."
    ),
    "efficiency_beyond_curve": N_(
        "Torques of the cycle lie beyond the ends of the efficiency curves of {names}: there the efficiency at the "
        "nearer end is used."
    ),
    "efficiency_unknown": N_(
        "Motor torques are loss-free, a lower bound: the handbook’s efficiency curves were not available and no "
        "efficiency is given."
    ),
    "motor_torque_partial": N_(
        "Motor torques leave out the inertia of motor and gear (which needs a motion and the motor’s inertia) and, "
        "where no supplement gives them, no-load losses."
    ),
    "motor_losses_included": N_(
        "Motor torques include the gear’s no-load torque; they leave out the inertia of motor and gear."
    ),
    "motor_inertia_included": N_(
        "Motor torques include the motor’s own inertia; the gear’s inertia and no-load losses are not published, and "
        "left out where no supplement gives them."
    ),
    "rotor_not_included": N_(
        "The torque that accelerates the motor’s rotor is not compared with its curve, which takes a motion and the "
        "motor’s inertia. Of typed phases each peak is judged against the least peak torque up to its peak speed."
    ),
    "motor_all_included": N_("Motor torques include the inertia of motor and gear and the gear’s no-load torque."),
    "limit_without_efficiency": N_(
        "The drive’s torque limit leaves out losses (no efficiency is known): in braking the gear can carry up to "
        "T_R / η."
    ),
    "limit_below_need": N_(
        "The cycle needs {need_Nm} at the motor of {name}, above the drive’s torque limit of {limit_Nm} that keeps the "
        "gear at or below T_R: choose a gear with a larger T_R, or accelerate more gently."
    ),
    "gear_below_motor": N_(
        "The motor’s peak torque of {peak_Nm} can put {torque_Nm} on {name} (T_R {repeated_Nm}): set the drive’s "
        "torque limit to {limit_Nm}, {share_percent} of that peak."
    ),
    "gear_far_below_motor": N_(
        "The motor can break the gear: its peak torque of {peak_Nm} puts {torque_Nm} on {name} (T_M {momentary_Nm}). "
        "Set the drive’s torque limit to {limit_Nm}, {share_percent} of that peak, before the axis is started."
    ),
    "pairs_not_mated": N_("Whether motor and gear fit mechanically (flange, shaft, coupling) is not judged."),
    "no_ratio_for_motor": N_(
        "No ratio can save these motors: {names}. With their inertia the RMS torque is above the rated torque at any "
        "ratio. Less inertia or more torque would do, M² / J_m of at least {rate_kW_per_s}; gentler ramps lower that."
    ),
    "motor_figures_unknown": N_(
        "Maximum speed, rated torque or peak torque of these motors are not known, and not checked: {names}."
    ),
    "motor_inertia_unknown": N_(
        "These motors are not rated, since an inertia ratio or a resonance is required and their inertia is not known: "
        "{names}."
    ),
    "torque_signs_not_given": N_(
        "No torque has a sign, so the position error assumes each of them in both directions. Where that is not so, "
        "choose “no torque reverses” or give signs."
    ),
    "torque_range_not_given": N_(
        "The torque varies in phases {phases}, whose least torque is not given: the position error counts it from 0. "
        "Give the least torque where it stays above 0."
    ),
    "ramp_shorter_than_period": N_(
        "A ramp of {ramp_s} is shorter than a period of {period_s} of the load’s natural frequency on {name}: the "
        "axis will oscillate after the move."
    ),
    "brake_does_not_hold": N_(
        "Weight and external load may pull with {torque_Nm} at the gear: with the ratios {ratios} the brake stops the "
        "load but does not hold it at rest."
    ),
    "brake_bound": N_(
        "T_k of the brake is an upper bound at any instant of the motion: the gear’s own backlash is crossed under the "
        "brake’s whole torque, and the motor may go off before, at or through the brake’s rise, which does not lower "
        "it. Not in it: backlash of what is behind the gear, and that the gear is softer below 15 % of T_N."
    ),
    "brake_factor_typed": N_(
        "T_k of the brake goes by your dynamic factor, and is no bound: a load that crosses the gear’s backlash may "
        "exceed it."
    ),
    "brake_efficiency_unknown": N_(
        "No efficiency is given, so the stop by the brake counts η as 1, which is not the safe side: losses raise T_k, "
        "up to 1 / η times."
    ),
    "brake_without_load": N_(
        "The stop by the brake takes the load for one that nothing pulls and that does not accelerate: give the torque "
        "of weight and process force at the gear, and that with friction and J · α."
    ),
    "brake_while_accelerating": N_(
        "J · α of a stop during acceleration is in T_k only as far as the opposing torque that you give includes it."
    ),
    "counterweight_slack": N_(
        "A stop on {name} may decelerate the load by up to {share_percent} of g: above g the counterweight’s rope goes "
        "slack, and T_k is no bound when it tightens again."
    ),
    "brake_inertia_unknown": N_(
        "Without the inertias of motor and load the full brake torque counts, an upper bound; time and angle of the "
        "stop stay unknown."
    ),
    "size_unrated": N_("{name} is not rated. {note}"),
    "gears_unrated": N_("{names} are not rated. {note}"),
    "catalogue_supplement": N_("Some catalogue figures are supplied by the user; their sources say so."),
}
"""Sentences by code; a value whose name ends in a unit is a number in that unit."""

TRANSLATED = ("area", "note")
"""Values with texts to translate."""

AREAS: Mapping[str, str] = {
    "aerospace": N_("aerospace"),
    "explosive_area": N_("areas at risk of explosion"),
    "nuclear": N_("machines for a nuclear purpose"),
    "vacuum": N_("vacuum"),
    "household": N_("household devices"),
    "medical": N_("medical equipment"),
    "human_contact": N_("devices that interact directly with the human body"),
    "people_transport": N_("machines for transporting or lifting people"),
    "amusement": N_("devices for funfairs and leisure parks"),
}
"""Application areas of section 2.4 by their code; English msgids."""


class Notice(Reply, frozen=True):
    """A note on the result: a code for programs, its sentence in English, and the values in it."""

    code: Annotated[str, Field(description="Code of the notice.")]
    text: Annotated[str, Field(description="The notice.")]
    values: Annotated[dict[str, Mixed], Field(description="The values in the notice, each with its unit.")] = field(
        default_factory=dict
    )

    @property
    def sentence(self) -> Sentence:
        """The notice for any language and units; its English text if an earlier version kept no values."""
        template = NOTICES.get(_template_of(self.code, self.values), "")
        names = {name for _, name, *_ in Formatter().parse(template) if name}
        if not template or not names <= self.values.keys():
            return Sentence("{text}", {"text": self.text})
        return _sentence(template, {name: self.values[name] for name in names})


_OTHERWISE = {("size_unrated", "names"): "gears_unrated", ("gear_below_motor", "momentary_Nm"): "gear_far_below_motor"}
"""Alternative sentences of a code, by a value that only these have."""


def _template_of(code: str, values: Mapping[str, Mixed]) -> str:
    return next((_OTHERWISE[code, name] for name in values if (code, name) in _OTHERWISE), code)


def _sentence(template: str, values: Mapping[str, Mixed]) -> Sentence:
    texts = {
        name: value if isinstance(value, str) else Quantity(value, *_unit_of(name)) for name, value in values.items()
    }
    return Sentence(template, texts, TRANSLATED)


def _unit_of(name: str) -> tuple[str, int, Rounding]:
    """Unit, digits and rounding of a value; a limit to be set is rounded down, a least need up."""
    return suffix_of(name), _DIGITS.get(name, DIGITS[suffix_of(name)]), _ROUNDING.get(name, "nearest")


_DIGITS: Mapping[str, int] = {"torque_Nm": 4, "need_Nm": 4, "limit_Nm": 4}
_ROUNDING: Mapping[str, Rounding] = {
    **dict.fromkeys(("limit_Nm", "share_percent"), "down"),
    **dict.fromkeys(("torque_Nm", "need_Nm", "rate_kW_per_s"), "up"),
}


def notice(code: str, **values: Mixed) -> Notice:
    """Notice of a code, with its English text."""
    return Notice(code, _sentence(NOTICES[_template_of(code, values)], values).text, values)
