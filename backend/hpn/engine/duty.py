"""Applications as arrays: their inputs, and the figures of their duty cycles.

A figure of an application has shape (N, 1), so that it broadcasts against a figure of a gear, shape (G,); one
application and a chunk of a fleet go through the same lines.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application, OutputLoad
from hpn.application.input_fields import NUMBERS
from hpn.application.phase import ROOM
from hpn.application.shaft_centre import by_size, of_others
from hpn.physics import bearing, equations, shaft_load
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Course, StoppedLoad, tangential_force
from hpn.physics.stop import LoadTorques

TextArray = NDArray[np.str_]

_UNLOADED = OutputLoad()


@dataclass(frozen=True)
class Phases:
    """Phases of N cycles by magnitude, and the signs of their torques, each of shape (N, 1, phases).

    Shorter cycles are padded at the end with phases of no duration, which have no weight in any equation. Each load is
    the phase's own, else the cycle's, else 0; peaks and RMS are those of a steady phase where none are given, and the
    least torque is 0 where it is not given and the phase varies.
    """

    torque_Nm: FloatArray
    speed_rpm: FloatArray
    duration_s: FloatArray
    radial_N: FloatArray
    axial_N: FloatArray
    peak_torque_Nm: FloatArray
    peak_speed_rpm: FloatArray
    rms_torque_Nm: FloatArray
    least_torque_Nm: FloatArray
    torque_sign: FloatArray

    @classmethod
    def of(cls, applications: Sequence[Application]) -> "Phases":
        """Phases of applications, each padded to the longest cycle."""
        longest = max(len(application.duty_cycle.load_phases) for application in applications)
        table = np.zeros((9, len(applications), 1, longest))
        for place, application in enumerate(applications):
            rows = _rows(application)
            table[:, place, 0, : len(rows)] = np.array(rows).T
        sign = np.sign(table[0])
        np.abs(table, out=table)
        T, _, _, _, _, peak, _, rms, least = table
        table[8] = np.where(np.isnan(least), least_torque(torque_Nm=T, peak_torque_Nm=peak, rms_torque_Nm=rms), least)
        return cls(*[*table, sign])


def least_torque(*, torque_Nm: FloatArray, peak_torque_Nm: FloatArray, rms_torque_Nm: FloatArray) -> FloatArray:
    """Least torque in Nm of phases that say none, by magnitude: their own where peak and RMS equal it, else 0."""
    steady = (peak_torque_Nm <= torque_Nm * (1 + ROOM)) & (rms_torque_Nm >= torque_Nm * (1 - ROOM))
    return np.where(steady, torque_Nm, 0.0)


def _rows(application: Application) -> list[tuple[float, ...]]:
    load, phases = application.loads or _UNLOADED, application.duty_cycle.load_phases
    radial, axial = load.radial_N or 0.0, load.axial_N or 0.0
    return [
        (
            T := phase.torque_Nm,
            n := phase.speed_rpm,
            phase.duration_s,
            radial if phase.radial_N is None else phase.radial_N,
            axial if phase.axial_N is None else phase.axial_N,
            T if phase.peak_torque_Nm is None else phase.peak_torque_Nm,
            n if phase.peak_speed_rpm is None else phase.peak_speed_rpm,
            T if phase.rms_torque_Nm is None else phase.rms_torque_Nm,
            np.nan if phase.least_torque_Nm is None else phase.least_torque_Nm,
        )
        for phase in phases
    ]


@dataclass(frozen=True)
class InputArrays:
    """Inputs of N applications besides their phases, each array of shape (N, 1).

    `numbers` holds every single number of the application model by its path with dots, such as `requirements.life_h`;
    NaN where it is not given. Where no load is given, neither are the conditions of a load. `load_reverses` is NaN, 0
    or 1, `position_error_at` the word of the application. `shaft_centres_mm` has the distances that are given for one
    size, by size; the number by its path is that of all others.
    """

    numbers: Mapping[str, FloatArray]
    bearing_model: TextArray
    life_basis: TextArray
    rank_by: TextArray
    position_error_at: TextArray
    shaft_drive: TextArray
    load_reverses: FloatArray
    shaft_centres_mm: Mapping[str, FloatArray] = field(default_factory=dict)

    @classmethod
    def of(cls, applications: Sequence[Application]) -> "InputArrays":
        """Inputs of applications, in their order."""
        table = np.array([_numbers(application) for application in applications], dtype=np.float64)
        loads = [application.loads for application in applications]
        return cls(
            {".".join(path): table[:, place, None] for place, path in enumerate(NUMBERS)},
            np.array([[load.model if load else ""] for load in loads]),
            np.array([[load.life_basis if load else ""] for load in loads]),
            np.array([[application.rank_by] for application in applications]),
            np.array([[application.requirements.position_error_at] for application in applications]),
            np.array([[application.shaft_drive] for application in applications]),
            np.array([[application.requirements.load_reverses] for application in applications], dtype=np.float64),
            _by_size([by_size(load.shaft_centre_mm) if load else {} for load in loads]),
        )

    def __getitem__(self, path: str) -> FloatArray:
        return self.numbers[path]

    def shaft_centre_mm(self, sizes: Sequence[str]) -> FloatArray:
        """Distance x_c in mm that is given for each size: its own, else that of all others.

        Shape (N, sizes); (N, 1) where none of them has one of its own.
        """
        others = self[SHAFT_CENTRE]
        if self.shaft_centres_mm.keys().isdisjoint(sizes):
            return others
        columns = [self.shaft_centres_mm.get(size, others) for size in sizes]
        return np.concatenate([np.where(np.isnan(column), others, column) for column in columns], axis=1)


SHAFT_CENTRE = "output_load.shaft_centre_mm"


def _by_size(tables: Sequence[Mapping[str, float]]) -> Mapping[str, FloatArray]:
    """Numbers of N applications by size, each of shape (N, 1): NaN where an application has none of it."""
    sizes = dict.fromkeys(size for one in tables for size in one)
    return {size: np.array([[one.get(size, np.nan)] for one in tables]) for size in sizes}


def _numbers(application: Application) -> list[float | None]:
    """Numbers of one application in the order of NUMBERS; None where it is not given."""
    stop = application.emergency_stop
    parts = {
        ("duty_cycle",): application.duty_cycle,
        ("emergency_stop",): stop,
        ("emergency_stop", "brake"): stop and stop.brake,
        ("output_load",): application.loads,
        ("output_load", "drive"): application.output_load and application.output_load.drive,
        ("requirements",): application.requirements,
        ("requirements", "motor"): application.requirements.motor,
    }
    values = [getattr(parts[path[:-1]], path[-1], None) for path in NUMBERS]
    return [of_others(value) if isinstance(value, dict) else value for value in values]


@dataclass(frozen=True, eq=False)
class Duty:
    """Phases and inputs of N applications, and the figures of their duty cycles.

    Each figure has shape (N, 1), is NaN where it is not asked for, and is computed when it is first read.

    `courses` are those of the motions, and `stopped_loads` their loads in a stop by the brake, where there is one; both
    by the place of their application. `typed` are the phases with the loads that are typed.
    """

    typed: Phases
    asked: InputArrays
    courses: Mapping[int, Course] = field(default_factory=dict)
    stopped_loads: Mapping[int, StoppedLoad] = field(default_factory=dict)

    @cached_property
    def phases(self) -> Phases:
        """Phases with all loads: those of a pinion or pulley on the shaft are added to the typed ones."""
        if not self.has_shaft_drive:
            return self.typed
        radial, axial = self.shaft_load_of(self.shaft_force_N)
        return replace(self.typed, radial_N=self.typed.radial_N + radial, axial_N=self.typed.axial_N + axial)

    @cached_property
    def has_shaft_drive(self) -> bool:
        """True where a pinion or pulley loads the shaft of some axis."""
        return bool((self.asked.shaft_drive != "").any())

    @cached_property
    def shaft_diameter_mm(self) -> FloatArray:
        """Pitch diameter of pinion or pulley in mm."""
        diameter = self.asked["output_load.drive.diameter_mm"].copy()
        for place, course in self.courses.items():
            if self.asked.shaft_drive[place, 0]:
                diameter[place] = 2000 * course.load.external_Nm
        return diameter

    @cached_property
    def shaft_force_N(self) -> FloatArray:
        """Tangential force F_t in N at pinion or pulley in each phase, shape (N, 1, phases); of phases 2 T / d."""
        force: FloatArray = 2000 * self.typed.peak_torque_Nm / self.shaft_diameter_mm[..., None]
        for place, course in self.courses.items():
            if self.asked.shaft_drive[place, 0]:
                force[place, 0, : len(course.move)] = tangential_force(course)
        return force

    def shaft_load_of(self, force_N: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Radial and axial load in N of pinion or pulley at tangential forces, 0 where none is; shape (N, 1, phases).

        A belt has that of its largest force at all times.
        """
        kind, inputs = self.asked.shaft_drive[..., None], self.asked
        radial, axial = shaft_load.rack_load(force_N=force_N, helix_deg=inputs["output_load.rack_helix_deg"][..., None])
        tension = inputs["output_load.belt_tension_factor"][..., None]
        by_belt = shaft_load.belt_load(largest_force_N=force_N.max(axis=-1, keepdims=True), tension_factor=tension)
        is_rack = kind == "rack_and_pinion"
        return np.where(is_rack, radial, np.where(kind == "belt", by_belt, 0.0)), np.where(is_rack, axial, 0.0)

    @cached_property
    def shaft_radial_N(self) -> FloatArray:
        """Largest radial load in N of pinion or pulley in the cycle, shape (N, 1)."""
        radial: FloatArray = self.shaft_load_of(self.shaft_force_N)[0].max(axis=-1)
        return radial

    @cached_property
    def average_torque_Nm(self) -> FloatArray:
        """Average output torque T_av in Nm, equation 17.2."""
        T, n, t = self.phases.torque_Nm, self.phases.speed_rpm, self.phases.duration_s
        return equations.average_output_torque(torque_Nm=T, speed_rpm=n, duration_s=t)

    @cached_property
    def average_output_speed_rpm(self) -> FloatArray:
        """Average output speed n_out_av in rpm, pause included, equation 17.4."""
        n, t = self.phases.speed_rpm, self.phases.duration_s
        return equations.average_output_speed(speed_rpm=n, duration_s=t, pause_s=self.asked["duty_cycle.pause_s"])

    @cached_property
    def maximum_torque_Nm(self) -> FloatArray:
        """Largest torque T_max of the cycle in Nm."""
        T_max: FloatArray = self.phases.peak_torque_Nm.max(axis=-1)
        return T_max

    @cached_property
    def maximum_output_speed_rpm(self) -> FloatArray:
        """Largest output speed n_out_max of the cycle in rpm."""
        n_out_max: FloatArray = self.phases.peak_speed_rpm.max(axis=-1)
        return n_out_max

    @cached_property
    def rms_torque_Nm(self) -> FloatArray:
        """RMS of the output torque over the cycle, pause included, in Nm."""
        T, t = self.phases.rms_torque_Nm, self.phases.duration_s
        return equations.rms_torque(torque_Nm=T, duration_s=t, pause_s=self.asked["duty_cycle.pause_s"])

    @cached_property
    def brakes(self) -> NDArray[np.bool_] | None:
        """True where a brake stops the axis, shape (N, 1); None where none does."""
        has_brake = ~np.isnan(self.asked["emergency_stop.brake.torque_Nm"])
        return has_brake if has_brake.any() else None

    @cached_property
    def typed_stop_torque_Nm(self) -> FloatArray:
        """Torque T_k of an emergency stop in Nm where it is given."""
        return np.abs(self.asked["emergency_stop.torque_Nm"])

    @cached_property
    def stop_speed_rpm(self) -> FloatArray:
        """Output speed in rpm at which the brake is told to stop the axis: as it is given, else the largest."""
        speed = self.asked["emergency_stop.brake.speed_rpm"]
        return np.where(np.isnan(speed), self.maximum_output_speed_rpm, speed)

    @cached_property
    def stop_load(self) -> LoadTorques:
        """Torques T_d, T_v and T_o of the load in a stop: of its motion, else as they are given, else 0."""
        T_d = np.nan_to_num(self.asked["emergency_stop.brake.load_torque_Nm"])
        opposing = self.asked["emergency_stop.brake.opposing_torque_Nm"]
        T_v, T_o = T_d.copy(), np.where(np.isnan(opposing), T_d, opposing)
        for place, load in self.stopped_loads.items():
            T_d[place], T_v[place] = load.pulling_at_gear_Nm, load.driving_at_gear_Nm
            T_o[place] = load.opposing_at_gear_Nm(self.stop_speed_rpm.item(place))
        return LoadTorques(T_d, T_v, T_o)

    @cached_property
    def torque_both_ways(self) -> NDArray[np.bool_]:
        """True where the torque is taken to act both ways: as asked, else where no sign says otherwise."""
        reverses = self.asked.load_reverses
        return np.where(np.isnan(reverses), self._are_unsigned, reverses == 1)

    @cached_property
    def _are_unsigned(self) -> NDArray[np.bool_]:
        """True where no torque is negative and there is no motion, as the handbook enters magnitudes; shape (N, 1)."""
        unsigned: NDArray[np.bool_] = np.array((self.phases.torque_sign >= 0).all(axis=-1))
        unsigned[list(self.courses)] = False
        return unsigned

    @cached_property
    def rest_friction_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Torque in Nm at the gear by which dry friction may hold each phase, shape (N, 1, phases), and the pause.

        0 where the axis moves. Of a motion by its mechanism, else as it is given.
        """
        paused = self.asked["requirements.rest_friction_Nm"].copy()
        phases = np.where(self.phases.speed_rpm == 0, paused[..., None], 0.0)
        for place, course in self.courses.items():
            count = len(course.move)
            held = course.load.rest_friction_Nm(course.peak_torque_Nm)
            phases[place, 0, :count] = np.where(course.speed_rpm == 0, held, 0.0)
            paused[place] = course.load.rest_friction_Nm(0.0)
        return phases, paused

    @cached_property
    def torque_range_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest torque in Nm, with its sign, between which the gear winds up: T_lo and T_hi.

        Of the whole cycle or of its rest, with the dry friction there; a pause holds that friction alone.
        """
        phases, at_rest = self.phases, self.asked.position_error_at == "rest"
        friction, of_pause = self.rest_friction_Nm
        counts = (phases.duration_s > 0) & (~at_rest[..., None] | (phases.speed_rpm == 0))  # a cycle's padding doesn't
        lasts = self.asked["duty_cycle.pause_s"] > 0
        ends = self._signed_torques_Nm
        lowest = np.where(counts, np.minimum(*ends) - friction, np.inf).min(axis=-1)
        highest = np.where(counts, np.maximum(*ends) + friction, -np.inf).max(axis=-1)
        lowest = np.where(lasts, np.minimum(lowest, -of_pause), lowest)
        highest = np.where(lasts, np.maximum(highest, of_pause), highest)
        both, largest = self.torque_both_ways, np.maximum(-lowest, highest)
        return np.where(both, -largest, lowest), np.where(both, largest, highest)

    @property
    def _signed_torques_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Ends of the range of torque in each phase, friction at rest left out, shape (N, 1, phases).

        A torque that is 0 on average has its peak both ways, unless no torque reverses.
        """
        phases, one_way = self.phases, (self.asked.load_reverses == 0) & self._are_unsigned
        sign = np.where(one_way[..., None] & (phases.torque_sign == 0), 1.0, phases.torque_sign)
        peak, least = phases.peak_torque_Nm, phases.least_torque_Nm
        return np.where(sign == 0, -peak, sign * least), np.where(sign == 0, peak, sign * peak)

    @cached_property
    def required_bearing_life_L50_h(self) -> FloatArray:
        """Life asked of the output bearing, as L50 in hours."""
        return bearing.required_L50(life_h=self.asked["output_load.life_h"], basis=self.asked.life_basis)

    @cached_property
    def load_inertia_kgm2(self) -> FloatArray:
        """Inertia J_L of the load at the output in kg m²: the motion's own, else as it is given."""
        inertia = self.asked["requirements.load_inertia_kgm2"].copy()
        for place, course in self.courses.items():
            inertia[place] = course.load_inertia_kgm2
        return inertia

    def with_motors(self, figures: Mapping[str, FloatArray]) -> "Duty":
        """The duty of one application with many motors: figures of theirs by name, shape (motors, 1), NaN not known.

        Every figure that a motor enters then has a row for each of them; all others have one and broadcast.
        """
        numbers = {**self.asked.numbers, **{f"requirements.motor.{name}": column for name, column in figures.items()}}
        return replace(self, asked=replace(self.asked, numbers=numbers))

    @classmethod
    def of(cls, applications: Sequence[Application]) -> "Duty":
        """Duty of applications, in their order."""
        motions = {place: motion for place, one in enumerate(applications) if (motion := one.duty_cycle.motion)}
        braked = [stop is not None and stop.brake is not None for stop in (one.emergency_stop for one in applications)]
        courses = {place: motion.course for place, motion in motions.items()}
        stopped = {place: motion.stopped_load for place, motion in motions.items() if braked[place]}
        return cls(Phases.of(applications), InputArrays.of(applications), courses, stopped)


def unasked_shaft_load_N(application: Application) -> float | None:
    """Largest radial load in N of a motion's pinion or pulley that neither counts nor is typed; None without one."""
    load, motion = application.output_load or _UNLOADED, application.duty_cycle.motion
    if motion is None or motion.wheel is None or application.shaft_drive:
        return None
    if load.radial_N is not None or any(move.radial_N is not None for move in motion.moves):
        return None
    counted = application.model_copy(update={"output_load": load.model_copy(update={"from_motion": True})})
    return Duty.of([counted]).shaft_radial_N.item()
