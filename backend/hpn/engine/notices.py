"""Notices on a result: assumptions behind its numbers, unpublished figures, unlimited values."""

from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpn.application import BEARING_LIFE_H, Application, DutyCycle, OutputLoad
from hpn.catalogue import Catalogue, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.duty import unasked_shaft_load_N
from hpn.engine.evaluation import SUITABLE, Evaluation
from hpn.engine.figures import shaft_centre_mm
from hpn.engine.input_arrays import CURVE, InputArrays
from hpn.engine.members import MOST_CONVEX, members_of
from hpn.engine.motor_torques import known_efficiency, leaves_curve
from hpn.engine.notice import AREAS, Notice, notice
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.physics.motion.mechanisms import Linear
from hpn.words.wording import Sentence, first_of


def notices_of(application: Application, evaluation: Evaluation, index: int) -> tuple[Notice, ...]:
    """Notices on application `index` of an evaluation, the most general ones last."""
    notices: list[Notice] = []
    if application.application_area is not None:
        notices.append(notice("application_area", area=AREAS[application.application_area]))
    notices += _on_the_motion(application.duty_cycle)
    notices += _on_tolerances(application, evaluation)
    notices += _on_the_shaft(application, evaluation, index)
    notices += _on_stop_and_life(application, evaluation, index)
    notices += _on_stiffness(application, evaluation, index)
    notices += _on_speed(evaluation, index)
    if application.loads is not None:
        notices += _on_unused_loads(application.loads, application.duty_cycle)
        notices += _on_the_bearing(application.loads, evaluation, index)
    notices += _on_the_motor(application, evaluation, index)
    notices += _on_the_torque_limit(evaluation, index)
    notices += _unrated(evaluation.gears, evaluation.catalogue)
    return (*notices, *([notice("catalogue_supplement")] if evaluation.catalogue.supplement else ()))


ADDED_AT_MOTOR = frozenset(("motor_losses_included", "motor_inertia_included", "motor_all_included"))
"""Codes of the notices on motor torques that are more than a quotient of the load's torque."""

ON_MOTOR_TORQUES = ADDED_AT_MOTOR | {"motor_torque_partial"}
"""Codes of the notices on the contents of motor torques; a selection with a motor has one of them."""


def on_motor_torques(notices: Iterable[Notice]) -> Sentence:
    """Sentence on the contents of a selection's motor torques; holds also without such a notice."""
    first = (one for one in notices if one.code in ON_MOTOR_TORQUES)
    return next(first, notice("motor_torque_partial")).sentence


def _on_the_motion(cycle: DutyCycle) -> Iterable[Notice]:
    if cycle.motion is None:
        return
    if cycle.motion.triangles:
        yield notice("motion_triangle", moves=_ranges(cycle.motion.triangles))
    if cycle.motion.is_left_off:
        yield notice("motion_left_off")
    if isinstance(cycle.motion.mechanism, Linear) and cycle.motion.mechanism.has_idle_coefficient:
        yield notice("friction_without_effect")


def _on_tolerances(application: Application, evaluation: Evaluation) -> Iterable[Notice]:
    if not application.tolerances or application.duty_cycle.motion is None:
        return
    members = members_of(application, evaluation.catalogue)
    if members.moving and not members.is_fixed:
        yield notice("tolerances_of_motion_sampled", count=str(len(members.moving)), most=str(MOST_CONVEX))


def _on_the_shaft(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    if (radial_N := unasked_shaft_load_N(application)) is not None:
        yield notice("shaft_load_of_motion", radial_N=radial_N)
    gears, loads = evaluation.gears, evaluation.case.figures.stop_radial_N
    if application.shaft_drive:
        duty = evaluation.case.duty
        force_N = float(duty.shaft_force_N[index].max())
        yield notice("shaft_load_counted", radial_N=duty.shaft_radial_N.item(index), force_N=force_N)
        stop_N = np.broadcast_to(loads, evaluation.verdict.shape)[index]
        above = (evaluation.verdict[index] == SUITABLE) & (
            stop_N > gears.columns.dynamic_radial_load_N * (1 + ROUNDING)
        )
        if above.any():
            names = ", ".join(gears.rows[place].designation for place in np.flatnonzero(above).tolist())
            yield notice("stop_radial_above_limit", radial_N=float(stop_N[above].max()), names=names)


def _ranges(places: Sequence[int]) -> str:
    """Numbers of places, consecutive ones as a range: `1, 3–5`."""
    rows: list[list[int]] = []
    for place in places:
        if rows and rows[-1][-1] == place - 1:
            rows[-1].append(place)
        else:
            rows.append([place])
    listed = [f"{row[0] + 1}" if len(row) == 1 else f"{row[0] + 1}–{row[-1] + 1}" for row in rows]
    return first_of(listed, RANGES_NAMED)


RANGES_NAMED = 20
"""Ranges of phases or moves, at most, that a notice names."""


def _is_unlimited(figure: FloatArray, index: int) -> bool:
    """True where a figure of an application is unlimited on at least one gear."""
    return bool(np.isinf(figure[index if len(figure) > 1 else 0]).any())


def _on_stop_and_life(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    figures, duty = evaluation.case.figures, evaluation.case.duty
    stop, largest = duty.typed_stop_torque_Nm.item(index), duty.maximum_torque_Nm.item(index)
    if stop < largest * (1 - ROUNDING):
        yield notice("emergency_stop_below_maximum", stop_Nm=stop, largest_Nm=largest)
    if application.emergency_stop is not None and application.emergency_stop.count is None:
        yield notice("stops_not_counted")
    first = evaluation.order.item(index, 0)
    sentence = figures.stops.sentence_on(application, index, first, evaluation.gears.rows[first].designation)
    yield from (notice(code, **values) for code, values in sentence)
    if _is_unlimited(figures.momentary_peak_count, index):
        yield notice("momentary_peak_count_unlimited")
    if _is_unlimited(figures.life_L10_h, index):
        yield notice("life_unlimited")


def _on_stiffness(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    duty, best = evaluation.case.duty, evaluation.order.item(index, 0)
    if np.isnan(duty.inputs.load_reverses.item(index)) and duty.torque_both_ways.item(index):
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
    """Places of the phases with a varying torque and no given least torque, except those with a mean torque of 0."""
    least = evaluation.case.duty.phases.least_torque_Nm[index, 0].tolist()
    phases = enumerate(application.duty_cycle.load_phases)
    return [place for place, phase in phases if phase.least_torque_Nm is None and phase.torque_Nm and not least[place]]


def _on_speed(evaluation: Evaluation, index: int) -> Iterable[Notice]:
    """Notice on suitable gears whose input runs above the permissible average speed for longer than the
    averaging time.
    """
    bound, gears, phases = evaluation.catalogue.averaging_s, evaluation.gears.columns, evaluation.case.duty.phases
    lasting = phases.duration_s[index, 0] > 0  # padding of shorter cycles has no duration
    n, t = phases.speed_rpm[index, 0][lasting], phases.duration_s[index, 0][lasting]
    if t.sum() <= bound:
        return
    circular = not evaluation.case.inputs["duty_cycle.pause_s"].item(index)
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
    """Longest uninterrupted time in s of the phases above; without a pause the cycle's end runs into its start."""
    if above.all() or not above.any():
        return float(duration_s.sum()) if above.any() else 0.0
    if circular:
        start = int(np.argmin(above))  # a phase below, so that no run crosses the end
        above, duration_s = np.roll(above, -start), np.roll(duration_s, -start)
    ends = np.flatnonzero(~above)
    return max(float(part.sum()) for part in np.split(np.where(above, duration_s, 0.0), ends))


def _on_unused_loads(load: OutputLoad, cycle: DutyCycle) -> Iterable[Notice]:
    """Notices on loads of the whole cycle that go unused because every phase has its own, with a different one
    in some.
    """
    for direction in ("radial", "axial"):
        whole, own = getattr(load, f"{direction}_N"), [getattr(phase, f"{direction}_N") for phase in cycle.load_phases]
        if whole is not None and None not in own and set(own) != {whole}:
            yield notice(f"{direction}_load_not_used", load_N=whole)


def _on_the_bearing(load: OutputLoad, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    yield notice("bearing_envelope_supplied" if load.model == "digitised" else "bearing_envelope_computed")
    if load.model == "iso281":
        yield notice("bearing_iso281")
    asked_h = evaluation.case.inputs["requirements.life_h"].item(index)
    if not np.isnan(asked_h) and (load.life_h, load.life_basis) == (BEARING_LIFE_H, "L50"):
        yield notice("bearing_life_at_default", gear_life_h=asked_h, bearing_life_h=load.life_h)
    yield from _on_the_lever(load, evaluation, index)
    yield notice("bearing_life_basis")
    if _is_unlimited(evaluation.case.figures.bearing_life_L50_h, index):
        yield notice("bearing_life_unlimited")


def _on_the_lever(load: OutputLoad, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    if load.radial_position_mm is None and not load.axial_radius_mm:
        yield notice("bearing_load_position")
        return
    yield notice("bearing_lever")
    gears = evaluation.gears
    centres = np.broadcast_to(shaft_centre_mm(evaluation.case.duty, gears)[index], gears.first_of_size.shape)
    lacking = {gears.rows[place].name for place in gears.first_of_size[np.isnan(centres)].tolist()}
    if lacking and (load.radial_position_mm or load.axial_radius_mm):
        yield notice("bearing_centre_unknown", names=", ".join(sorted(lacking)))


def _on_the_motor(application: Application, evaluation: Evaluation, index: int) -> Iterable[Notice]:
    requirements, catalogue = application.requirements, evaluation.catalogue
    if requirements.efficiency is not None:
        yield notice("efficiency_assumed", efficiency_percent=100 * requirements.efficiency)
    elif requirements.motor is not None or application.rank_by == "motor_torque":
        yield notice("efficiency_supplied" if catalogue.efficiency else "efficiency_unknown")
        curved = (gear for gear in evaluation.gears.rows if gear.designation in catalogue.efficiency)
        beyond_curve = [
            gear.designation for gear in curved if leaves_curve(catalogue, gear, evaluation.case.duty, index)
        ]
        if beyond_curve:
            yield notice("efficiency_beyond_curve", names=", ".join(beyond_curve))
    if requirements.motor is not None or application.rank_by == "motor_torque":
        included = not np.isnan(evaluation.case.inputs["requirements.motor.inertia_kgm2"].item(index))
        moving = application.duty_cycle.motion is not None
        gears = evaluation.gears.columns
        has_inertia, has_losses = (
            not np.isnan(column).any() for column in (gears.inertia_kgm2, gears.no_load_torque_Nm)
        )
        if moving and included:
            yield notice("motor_all_included" if has_inertia and has_losses else "motor_inertia_included")
        else:
            yield notice("motor_losses_included" if has_losses else "motor_torque_partial")
            if not np.isnan(evaluation.case.inputs[CURVE].item(index)):
                yield notice("rotor_not_included")


def _on_the_torque_limit(evaluation: Evaluation, index: int) -> Iterable[Notice]:
    """Notices on the drive's torque limit of the first candidate, and on the efficiency behind all limits."""
    figures, inputs, best = evaluation.case.figures, evaluation.case.inputs, evaluation.order.item(index, 0)
    limits = figures.motor_torque_limit_Nm[index]
    without = np.isnan(known_efficiency(evaluation.gears, evaluation.catalogue)) & ~np.isnan(limits)
    if np.isnan(inputs["requirements.efficiency"].item(index)) and without.any():
        yield notice("limit_without_efficiency")
    yield from on_torque_limit(
        evaluation.gears.rows[best],
        limit_Nm=limits.item(best),
        need_Nm=figures.motor_peak_torque_Nm[index].item(best),
        peak_Nm=largest_torque_Nm(inputs, index),
    )


def largest_torque_Nm(inputs: InputArrays, index: int) -> float:
    """Peak torque of a motor in Nm, else the largest of its curve, else NaN."""
    peak, curve = inputs["requirements.motor.peak_torque_Nm"].item(index), inputs.motor_curves[index, 0]
    return float(curve.peak_Nm.max()) if np.isnan(peak) and curve is not None else float(peak)


def on_torque_limit(gear: Gear, *, limit_Nm: float, need_Nm: float, peak_Nm: float) -> Iterable[Notice]:
    """Notices on a gear whose torque limit η T_R / i is below the motor's peak torque or the need of the cycle.

    NaN stands for an unknown torque.
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
    """One notice per size with unrated gears; it names the gears where a supplement rates others of the size."""
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
