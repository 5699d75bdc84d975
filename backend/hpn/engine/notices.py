"""Notices on a result: assumptions behind its numbers, unpublished figures, unlimited values.

A notice is a code and values; its sentence is one of NOTICES, and is put together where it is shown.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from string import Formatter
from typing import Annotated

import numpy as np
from msgspec import field
from numpy.typing import NDArray
from pydantic import Field

from hpn.application import BEARING_LIFE_H, Application, DutyCycle, OutputLoad
from hpn.catalogue import Catalogue, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.evaluation import SUITABLE, Evaluation
from hpn.engine.motor_torques import known_efficiency, leaves_curve
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.physics.motion.mechanisms import Linear
from hpn.words.reply import Reply
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Quantity, Rounding, Sentence

DIGITS: Mapping[str, int] = {"Nm": 6, "percent": 3, "s": 6, "h": 6}
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
"""Values that are texts to be translated."""

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

Value = float | str


class Notice(Reply, frozen=True):
    """A note on the result: a code for programs, its sentence in English, and the values in it."""

    code: Annotated[str, Field(description="Code of the notice.")]
    text: Annotated[str, Field(description="The notice.")]
    values: Annotated[dict[str, Value], Field(description="The values in the notice, each with its unit.")] = field(
        default_factory=dict
    )

    @property
    def sentence(self) -> Sentence:
        """The notice for any language and units; as it was written where its version kept no values."""
        template = NOTICES.get(_template_of(self.code, self.values), "")
        names = {name for _, name, *_ in Formatter().parse(template) if name}
        if not template or not names <= self.values.keys():
            return Sentence("{text}", {"text": self.text})
        return _sentence(template, {name: self.values[name] for name in names})


_OTHERWISE = {("size_unrated", "names"): "gears_unrated", ("gear_below_motor", "momentary_Nm"): "gear_far_below_motor"}
"""Other sentences of a code, by a value that they alone have."""


def _template_of(code: str, values: Mapping[str, Value]) -> str:
    return next((_OTHERWISE[code, name] for name in values if (code, name) in _OTHERWISE), code)


def _sentence(template: str, values: Mapping[str, Value]) -> Sentence:
    shown = {name: value if isinstance(value, str) else Quantity(value, *_told(name)) for name, value in values.items()}
    return Sentence(template, shown, TRANSLATED)


def _told(name: str) -> tuple[str, int, Rounding]:
    """Unit, digits and rounding of a value; what is to be set as a limit is rounded down."""
    return suffix_of(name), DIGITS[suffix_of(name)], "down" if name in ("limit_Nm", "share_percent") else "nearest"


def notice(code: str, **values: Value) -> Notice:
    """Notice of a code, with its English text."""
    return Notice(code, _sentence(NOTICES[_template_of(code, values)], values).text, values)


def notices_of(application: Application, evaluation: Evaluation, index: int) -> tuple[Notice, ...]:
    """Notices on an application, which is number `index` of an evaluation; the most general ones last."""
    found: list[Notice] = []
    if application.application_area is not None:
        found.append(notice("application_area", area=AREAS[application.application_area]))
    found += _on_the_motion(application.duty_cycle)
    found += _on_stop_and_life(application, evaluation, index)
    found += _on_stiffness(application, evaluation, index)
    found += _on_speed(evaluation, index)
    if application.loads is not None:
        found += _on_the_bearing(application.loads, evaluation, index)
    found += _on_the_motor(application, evaluation, index)
    found += _on_the_torque_limit(evaluation, index)
    found += _unrated(evaluation.gears, evaluation.catalogue)
    return (*found, *([notice("catalogue_supplement")] if evaluation.catalogue.supplement else ()))


ON_MOTOR_TORQUES = frozenset(
    ("motor_torque_partial", "motor_losses_included", "motor_inertia_included", "motor_all_included")
)
"""Codes of the notices on what the motor torques include; a selection that asks about a motor has one of them."""


def on_motor_torques(notices: Iterable[Notice]) -> Sentence:
    """Sentence on what the motor torques of a selection include, which holds without a notice on them too."""
    found = (one for one in notices if one.code in ON_MOTOR_TORQUES)
    return next(found, notice("motor_torque_partial")).sentence


def _on_the_motion(cycle: DutyCycle) -> Iterable[Notice]:
    if cycle.motion is None:
        return
    if cycle.motion.triangles:
        yield notice("motion_triangle", moves=_ranges(cycle.motion.triangles))
    if cycle.motion.is_left_off:
        yield notice("motion_left_off")
    if isinstance(cycle.motion.mechanism, Linear) and cycle.motion.mechanism.has_idle_coefficient:
        yield notice("friction_without_effect")


def _ranges(places: Sequence[int]) -> str:
    """Numbers of places, those in a row as a range: `1, 3–5`."""
    rows: list[list[int]] = []
    for place in places:
        if rows and rows[-1][-1] == place - 1:
            rows[-1].append(place)
        else:
            rows.append([place])
    listed = [f"{row[0] + 1}" if len(row) == 1 else f"{row[0] + 1}–{row[-1] + 1}" for row in rows[:RANGES_NAMED]]
    return ", ".join([*listed, "…"] if len(rows) > RANGES_NAMED else listed)


RANGES_NAMED = 20
"""Ranges of phases or moves that a notice names."""


def _is_unlimited(figure: FloatArray, index: int) -> bool:
    """True where a figure of an application is unlimited on some gear."""
    return bool(np.isinf(figure[index if len(figure) > 1 else 0]).any())


def _on_stop_and_life(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    figures, duty = evaluation.case.figures, evaluation.case.duty
    stop, largest = duty.typed_stop_torque_Nm.item(index), duty.maximum_torque_Nm.item(index)
    if stop < largest * (1 - ROUNDING):
        yield notice("emergency_stop_below_maximum", stop_Nm=stop, largest_Nm=largest)
    if application.emergency_stop is not None and application.emergency_stop.count is None:
        yield notice("stops_not_counted")
    first = evaluation.order.item(index, 0)
    said = figures.stops.said_of(application, index, first, evaluation.gears.rows[first].designation)
    yield from (notice(code, **values) for code, values in said)
    if _is_unlimited(figures.momentary_peak_count, index):
        yield notice("momentary_peak_count_unlimited")
    if _is_unlimited(figures.life_L10_h, index):
        yield notice("life_unlimited")


def _on_stiffness(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    duty, best = evaluation.case.duty, evaluation.order.item(index, 0)
    if np.isnan(duty.asked.load_reverses.item(index)) and duty.torque_both_ways.item(index):
        yield notice("torque_signs_not_given")
    if unsaid := _without_least_torque(application, evaluation, index):
        yield notice("torque_range_not_given", phases=_ranges(unsaid))
    if (motion := application.duty_cycle.motion) is None:
        return
    frequency = np.broadcast_to(evaluation.case.figures.natural_frequency_Hz, evaluation.verdict.shape)[index, best]
    ramps = [move.shortest_ramp_s for move in motion.moves if move.way]
    if min(ramps) * frequency < 1 - ROUNDING:
        name = evaluation.gears.rows[best].designation
        yield notice("ramp_shorter_than_period", ramp_s=min(ramps), period_s=float(1 / frequency), name=name)


def _without_least_torque(application: Application, evaluation: Evaluation, index: int) -> list[int]:
    """Places of the phases whose torque varies without a least one, but for those that have no sign on average."""
    least = evaluation.case.duty.phases.least_torque_Nm[index, 0].tolist()
    phases = enumerate(application.duty_cycle.load_phases)
    return [place for place, phase in phases if phase.least_torque_Nm is None and phase.torque_Nm and not least[place]]


def _on_speed(evaluation: Evaluation, index: int) -> Iterable[Notice]:
    """Suitable gears whose input runs above the permissible average speed for longer than is taken to average out."""
    bound, gears, phases = evaluation.catalogue.averaging_s, evaluation.gears.columns, evaluation.case.duty.phases
    lasting = phases.duration_s[index, 0] > 0  # what a shorter cycle is filled up with lasts no time
    n, t = phases.speed_rpm[index, 0][lasting], phases.duration_s[index, 0][lasting]
    if t.sum() <= bound:
        return
    circular = not evaluation.case.asked["duty_cycle.pause_s"].item(index)
    longest: dict[float, float] = {}
    for place in np.flatnonzero(evaluation.verdict[index] == SUITABLE).tolist():
        i = gears.ratio.item(place)
        time = _longest_run(n * i > gears.average_input_speed_rpm.item(place) * (1 + ROUNDING), t, circular=circular)
        if time > bound * (1 + ROUNDING):
            longest[i] = max(longest.get(i, 0.0), time)
    if longest:
        ratios = ", ".join(f"{i:g}" for i in sorted(longest))
        yield notice("speed_above_average", ratios=ratios, longest_s=max(longest.values()), bound_s=bound)


def _longest_run(above: NDArray[np.bool_], duration_s: FloatArray, *, circular: bool) -> float:
    """Longest time on end of the phases that are above; without a pause the cycle's end runs into its start."""
    if above.all() or not above.any():
        return float(duration_s.sum()) if above.any() else 0.0
    if circular:
        start = int(np.argmin(above))  # a phase below, so that no run goes round the end
        above, duration_s = np.roll(above, -start), np.roll(duration_s, -start)
    ends = np.flatnonzero(~above)
    return max(float(part.sum()) for part in np.split(np.where(above, duration_s, 0.0), ends))


def _on_the_bearing(load: OutputLoad, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    yield notice("bearing_envelope_supplied" if load.model == "digitised" else "bearing_envelope_computed")
    if load.model == "iso281":
        yield notice("bearing_iso281")
    asked_h = evaluation.case.asked["requirements.life_h"].item(index)
    if not np.isnan(asked_h) and (load.life_h, load.life_basis) == (BEARING_LIFE_H, "L50"):
        yield notice("bearing_life_at_default", gear_life_h=asked_h, bearing_life_h=load.life_h)
    yield from _on_the_lever(load, evaluation)
    yield notice("bearing_life_basis")
    if _is_unlimited(evaluation.case.figures.bearing_life_L50_h, index):
        yield notice("bearing_life_unlimited")


def _on_the_lever(load: OutputLoad, evaluation: Evaluation) -> Iterable[Notice]:
    if load.radial_position_mm is None and not load.axial_radius_mm:
        yield notice("bearing_load_position")
        return
    yield notice("bearing_lever")
    lacking = {gear.name for gear in evaluation.gears.rows if gear.shaft_centre_mm is None}
    if load.shaft_centre_mm is None and lacking and (load.radial_position_mm or load.axial_radius_mm):
        yield notice("bearing_centre_unknown", names=", ".join(sorted(lacking)))


def _on_the_motor(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    asked, catalogue = application.requirements, evaluation.catalogue
    if asked.efficiency is not None:
        yield notice("efficiency_assumed", efficiency_percent=100 * asked.efficiency)
    elif asked.motor is not None or application.rank_by == "motor_torque":
        yield notice("efficiency_supplied" if catalogue.efficiency else "efficiency_unknown")
        curved = (gear for gear in evaluation.gears.rows if gear.designation in catalogue.efficiency)
        left = [gear.designation for gear in curved if leaves_curve(catalogue, gear, evaluation.case.duty, index)]
        if left:
            yield notice("efficiency_beyond_curve", names=", ".join(left))
    if asked.motor is not None or application.rank_by == "motor_torque":
        included = not np.isnan(evaluation.case.asked["requirements.motor.inertia_kgm2"].item(index))
        moving = application.duty_cycle.motion is not None
        gears = evaluation.gears.columns
        has_inertia, has_losses = (
            not np.isnan(column).any() for column in (gears.inertia_kgm2, gears.no_load_torque_Nm)
        )
        if moving and included:
            yield notice("motor_all_included" if has_inertia and has_losses else "motor_inertia_included")
        else:
            yield notice("motor_losses_included" if has_losses else "motor_torque_partial")


def _on_the_torque_limit(evaluation: Evaluation, index: int) -> Iterable[Notice]:
    """Notices on the drive's torque limit: of the first candidate, and on the efficiency behind those of all."""
    figures, asked, best = evaluation.case.figures, evaluation.case.asked, evaluation.order.item(index, 0)
    limits = figures.motor_torque_limit_Nm[index]
    without = np.isnan(known_efficiency(evaluation.gears, evaluation.catalogue)) & ~np.isnan(limits)
    if np.isnan(asked["requirements.efficiency"].item(index)) and without.any():
        yield notice("limit_without_efficiency")
    yield from on_torque_limit(
        evaluation.gears.rows[best],
        limit_Nm=limits.item(best),
        need_Nm=figures.motor_peak_torque_Nm[index].item(best),
        peak_Nm=asked["requirements.motor.peak_torque_Nm"].item(index),
    )


def on_torque_limit(gear: Gear, *, limit_Nm: float, need_Nm: float, peak_Nm: float) -> Iterable[Notice]:
    """Notices on a gear whose torque limit η T_R / i the motor's peak torque or the need of the cycle is above.

    NaN stands for a torque that is not known.
    """
    if peak_Nm > limit_Nm * (1 + ROUNDING):
        T_R, T_M = gear.repeated_peak_torque_Nm or np.nan, gear.momentary_peak_torque_Nm or np.nan
        torque = T_R * peak_Nm / limit_Nm
        above = {"momentary_Nm": T_M} if torque > T_M * (1 + ROUNDING) else {"repeated_Nm": T_R}
        share = 100 * limit_Nm / peak_Nm
        values = {"peak_Nm": peak_Nm, "torque_Nm": torque, "limit_Nm": limit_Nm, "share_percent": share, **above}
        yield notice("gear_below_motor", name=gear.designation, **values)
    if need_Nm > limit_Nm * (1 + ROUNDING):
        yield notice("limit_below_need", name=gear.designation, need_Nm=need_Nm, limit_Nm=limit_Nm)


@lru_cache(maxsize=256)
def _unrated(gears: GearList, catalogue: Catalogue) -> tuple[Notice, ...]:
    """A notice per size with gears that aren't rated; it names them where a supplement rates others of the size."""
    rated = {gear.name for gear in catalogue.gears if gear.rated_torque_Nm is not None}
    unrated: dict[str, list[Gear]] = {}
    for gear in gears.rows:
        if gear.note and gear.rated_torque_Nm is None:
            unrated.setdefault(gear.name, []).append(gear)
    return tuple(
        _size_unrated([gear.designation for gear in rows] if name in rated else [name], rows[0].note or "")
        for name, rows in unrated.items()
    )


def _size_unrated(names: list[str], note: str) -> Notice:
    if len(names) == 1:
        return notice("size_unrated", name=names[0], note=note)
    return notice("size_unrated", names=", ".join(names), note=note)
