"""Applications changed by a remedy, with its figures as printed, and the changes that are needed."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, overload

from hpn.application import LISTED_FIGURES, Application, DutyCycle, EmergencyStop, Requirements
from hpn.application.motion import Motion
from hpn.application.phase import Phase
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate, candidates_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import SUITABLE, evaluate
from hpn.engine.remedy import DIGITS, Alternative, Requirement, Way, alternatives_of, in_order, parts_less, slowing_of
from hpn.physics.equations import ROUNDING
from hpn.physics.stiffness import ARCMIN_PER_RAD
from hpn.words.wording import Quantity, rounded


def needed_of(candidate: Candidate, application: Application, catalogue: Catalogue) -> tuple[Alternative, ...]:
    """Alternatives that each make a rejected gear suitable, without needless changes.

    Less torque may also mend a position error, and less inertia an inertia ratio, which then need no change of their
    own. A limit asked for as a length is answered as a length. Those with the fewest changes come first.
    """
    if application.requirements.over_tolerance and application.tolerances:
        return ()  # remedies refer to the values as given
    gears = catalogue.listed([catalogue.by_designation[candidate.designation]])

    @cache
    def fits(alternative: Alternative) -> bool:
        return _fits(application, alternative, gears, catalogue)

    closed = alternatives_of(candidate, application.requirements.utilisation)
    remedies = list(_verified(closed, candidate, application, fits))
    if not remedies:
        remedies = list(
            _verified(_slower(candidate, application, gears, catalogue, fits), candidate, application, fits)
        )
    return in_order(remedies)


Fits = Callable[[Alternative], bool]


def _verified(
    proposed: Iterable[Alternative], candidate: Candidate, application: Application, fits: Fits
) -> Iterator[Alternative]:
    """Yield the alternatives that suffice, without needless changes."""
    for one in proposed:
        requirements = tuple(_as_asked(limit, application.requirements) for limit in one.requirements)
        one = replace(one, requirements=requirements)
        while less := next(filter(fits, parts_less(one)), None):
            one = less
        if not _is_bounded(application, candidate) or fits(one):
            yield one


def _slower(
    candidate: Candidate, application: Application, gears: GearList, catalogue: Catalogue, fits: Fits
) -> Iterator[Alternative]:
    """Yield alternatives with less speed beside a motor's torque curve, and what it leaves to change at that speed.

    None for a rotor that takes part in a motion: slower phases would leave it out.
    """
    u, motor = application.requirements.utilisation, application.requirements.motor
    turns = application.duty_cycle.motion is not None and motor is not None and motor.inertia_kgm2 is not None
    slower = Alternative(Way(speed=slowing_of(candidate, u)))
    if motor is None or motor.curve is None or turns or slower == Alternative(Way()):
        return
    if fits(slower):
        yield slower
        return
    duty = Duty.of([tried(application, slower, catalogue)])
    [left] = candidates_of(evaluate(duty, gears, catalogue), 0)
    for one in alternatives_of(left, u):
        yield replace(one, way=replace(one.way, speed=slower.way.speed))


def _is_bounded(application: Application, candidate: Candidate) -> bool:
    """True where a change may not suffice, so that it must be tried.

    That is where the motor's limit depends on its speed, and where phases replace a motion as a bound of it: the
    largest dry friction is assumed in each rest, and the whole load drives in a stop that the brake may not hold.
    """
    motor = application.requirements.motor
    if motor is not None and motor.curve is not None:
        return True
    stop, motion = application.emergency_stop, application.duty_cycle.motion
    if motion is None or application.duty_cycle.rest_friction_Nm:
        return motion is not None
    if stop is None or stop.brake is None:
        return False
    return candidate.ratio * stop.brake.torque_Nm <= motion.stopped_load.pulling_at_gear_Nm * (1 + ROUNDING)


def _fits(application: Application, alternative: Alternative, gears: GearList, catalogue: Catalogue) -> bool:
    """True if an alternative makes the gear, alone in its list, suitable."""
    if alternative == Alternative(Way()):
        return False
    changed = with_listed_motor(tried(application, alternative, catalogue), catalogue)
    return evaluate(Duty.of([changed]), gears, catalogue).verdict.item() == SUITABLE


def _as_asked(limit: Requirement, requirements: Requirements) -> Requirement:
    """The limit, a position error as a length if it is asked for as one."""
    if limit.path != POSITION_ERROR or requirements.position_error_mm is None:
        return limit
    length = limit.value.value * (requirements.position_radius_mm or 0.0) / ARCMIN_PER_RAD
    value = Quantity(length, "mm", limit.value.digits, limit.value.rounding)
    return replace(limit, path="requirements.position_error_mm", value=value)


def tried(application: Application, alternative: Alternative, catalogue: Catalogue) -> Application:
    """The application changed by an alternative, with its figures as printed.

    If a figure of a listed motor changes, the motor's figures replace its name.
    """
    changed = followed(application, alternative.way)
    figures = {f"requirements.motor.{name}" for name in LISTED_FIGURES}
    if any(requirement.path in figures for requirement in alternative.requirements):
        changed = with_listed_motor(changed, catalogue)
        changed = _with(changed, ("requirements", "motor", "designation"), None)
    for requirement in alternative.requirements:
        limit = _as_asked(requirement, application.requirements)
        printed = rounded(limit.value.value, limit.value.digits, limit.value.rounding)
        changed = _with(changed, limit.path.split("."), float(printed))
    return changed


POSITION_ERROR = "requirements.position_error_arcmin"


def _with(model: Any, path: Sequence[str], value: float | None) -> Any:
    name, *below = path
    return model.model_copy(update={name: _with(getattr(model, name), below, value) if below else value})


def followed(application: Application, way: Way) -> Application:
    """The application changed by a way, with its figures as printed.

    If torques or speeds change, phases replace a motion, and their signs count as a motion's do.
    """
    torque, speed, load = (_printed(factor, 3) for factor in (way.torque, way.speed, way.load))
    cycle, stop, parts = application.duty_cycle, application.emergency_stop, dict[str, Any]()
    if cycle.motion is not None and (torque, speed) == (1, 1):
        parts["duty_cycle"] = cycle.model_copy(update={"motion": _loaded(cycle.motion, load)})
    else:
        phases = _with_shaft_loads(application, _driven(cycle, torque, speed, load), load)
        parts["duty_cycle"] = cycle.model_copy(update={"phases": phases, "motion": None})
        requirements = application.requirements
        if cycle.motion is None:
            friction = _scaled(requirements.rest_friction_Nm, torque) or 0.0  # a torque of the cycle like the others
            parts["requirements"] = requirements.model_copy(update={"rest_friction_Nm": friction})
        else:
            parts["requirements"] = requirements.model_copy(
                update=_of_motion(cycle, cycle.motion, requirements, torque)
            )
            stop = stop and _pulled(stop, cycle.motion)
    if cycle.motion is not None and parts["duty_cycle"].motion is None:
        tolerances = {
            path: one for path, one in (application.tolerances or {}).items() if not path.startswith("motion.")
        }
        parts["tolerances"] = tolerances or None
    if (output := application.output_load) is not None:
        loads = {name: _scaled(getattr(output, name), load) for name in LOADS}
        loads |= {"from_motion": output.from_motion and parts["duty_cycle"].motion is not None}
        parts["output_load"] = output.model_copy(update={k: v for k, v in loads.items() if v is not None})
    if stop is not None:
        parts["emergency_stop"] = _stopped(stop, way)
    return application.model_copy(update=parts)


def _of_motion(cycle: DutyCycle, motion: Motion, requirements: Requirements, torque: float) -> dict[str, float | bool]:
    """Requirements that replace those of a motion whose phases are typed, their torques times a factor."""
    return {
        "load_inertia_kgm2": motion.load_inertia_kgm2,
        "load_reverses": bool(requirements.load_reverses),
        "rest_friction_Nm": _scaled(cycle.rest_friction_Nm, torque) or 0.0,
    }


LOADS = ("radial_N", "axial_N")


def _loaded(motion: Motion, load: float) -> Motion:
    """The motion with the loads of its moves times a factor."""
    if load == 1:
        return motion
    content = motion.model_dump(exclude_unset=True)  # validated again: a copy would keep the old phases
    for move in content["moves"]:
        move |= {name: _scaled(move[name], load) for name in LOADS if move.get(name) is not None}
    return type(motion).model_validate(content)


def _driven(cycle: DutyCycle, torque: float, speed: float, load: float) -> tuple[Phase, ...]:
    """Phases of a cycle with torques, speeds and loads times factors; mean, peak and RMS share one factor."""
    return tuple(
        phase.model_copy(
            update={
                "torque_Nm": _scaled(phase.torque_Nm, torque),
                "peak_torque_Nm": _scaled(phase.peak_torque_Nm, torque),
                "rms_torque_Nm": _scaled(phase.rms_torque_Nm, torque),
                "least_torque_Nm": _scaled(phase.least_torque_Nm, torque),
                "speed_rpm": _scaled(phase.speed_rpm, speed),
                "peak_speed_rpm": _scaled(phase.peak_speed_rpm, speed),
                **{name: _scaled(getattr(phase, name), load) for name in LOADS},
            }
        )
        for phase in cycle.load_phases
    )


def _pulled(stop: EmergencyStop, motion: Motion) -> EmergencyStop:
    """The stop with the torques of the motion's load, which phases lack; an upper bound where torques fall."""
    if stop.brake is None:
        return stop
    speed_rpm = stop.brake.speed_rpm or max(phase.peak_speed_rpm or 0.0 for phase in motion.phases)
    load = motion.stopped_load
    torques = {"load_torque_Nm": load.pulling_at_gear_Nm, "opposing_torque_Nm": load.opposing_at_gear_Nm(speed_rpm)}
    brake = stop.brake.model_copy(update=torques)
    return stop.model_copy(update={"brake": brake})


def _with_shaft_loads(application: Application, phases: tuple[Phase, ...], load: float) -> tuple[Phase, ...]:
    """Phases that replace a motion, with its unchanged load of pinion or pulley, an upper bound where torques fall."""
    if not (application.output_load and application.output_load.from_motion):
        return phases
    duty = Duty.of([application])
    typed = [getattr(duty.typed, name)[0, 0].tolist() for name in LOADS]
    shaft = [part[0, 0].tolist() for part in duty.shaft_load_of(duty.shaft_force_N)]
    return tuple(
        phase.model_copy(update={name: _scaled(typed[k][at], load) + shaft[k][at] for k, name in enumerate(LOADS)})
        for at, phase in enumerate(phases)
    )


def _stopped(stop: EmergencyStop, way: Way) -> EmergencyStop:
    """The emergency stop with the brake's or its own largest torque, else with its largest number, else unchanged."""
    if stop.brake is not None and way.brake_torque_Nm is not None:
        brake = stop.brake.model_copy(update={"torque_Nm": _printed(way.brake_torque_Nm, DIGITS)})
        return stop.model_copy(update={"brake": brake})
    if way.emergency_stop_torque_Nm is not None:
        limit = _printed(way.emergency_stop_torque_Nm, DIGITS)
        return stop.model_copy(update={"torque_Nm": math.copysign(limit, stop.torque_Nm or 0.0)})
    if way.emergency_stop_count is None:
        return stop
    return stop.model_copy(update={"count": int(_printed(way.emergency_stop_count, DIGITS))})


def _printed(value: float, digits: int) -> float:
    return value if value == 1 else float(rounded(value, digits, "down"))


@overload
def _scaled(value: float, factor: float) -> float: ...
@overload
def _scaled(value: float | None, factor: float) -> float | None: ...
def _scaled(value: float | None, factor: float) -> float | None:
    """A figure times a factor, with at most 12 digits, as somebody would type it."""
    if value is None or factor == 1:
        return value
    return math.copysign(float(rounded(abs(value * factor), 12, "down")), value)
