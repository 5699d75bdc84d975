"""Applications as arrays: their inputs, and the figures of their duty cycles.

A figure of an application has shape (N, 1), so that it broadcasts against a figure of a gear, shape (G,); one
application and a chunk of a fleet go through the same lines.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application, CurvePoint, OutputLoad
from hpn.application.phase import ROOM
from hpn.engine.input_arrays import CURVE, InputArrays, curves_of
from hpn.physics import bearing, equations, shaft_load
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Course, StoppedLoad, tangential_force
from hpn.physics.stop import LoadTorques

_UNLOADED = OutputLoad()


@dataclass(frozen=True)
class Phases:
    """Phases of N cycles by magnitude, and the signs of their torques, each of shape (N, 1, phases).

    Shorter cycles are padded at the end with phases of no duration, which have no weight in any equation. Each load is
    the phase's own, else the cycle's, else 0. Missing peaks and RMS are those of a steady phase; a missing least torque
    is 0 where the phase varies.
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
        columns = [_columns(application) for application in applications]
        table = np.zeros((9, len(applications), 1, max(own.shape[1] for own in columns)))
        for place, own in enumerate(columns):
            table[:, place, 0, : own.shape[1]] = own
        sign = np.sign(table[0])
        np.abs(table, out=table)
        T, _, _, _, _, peak, _, rms, least = table
        table[8] = np.where(np.isnan(least), least_torque(torque_Nm=T, peak_torque_Nm=peak, rms_torque_Nm=rms), least)
        return cls(*[*table, sign])


def least_torque(*, torque_Nm: FloatArray, peak_torque_Nm: FloatArray, rms_torque_Nm: FloatArray) -> FloatArray:
    """Least torque in Nm, by magnitude, of phases without a given one: the mean where peak and RMS equal it, else 0."""
    steady = (peak_torque_Nm <= torque_Nm * (1 + ROOM)) & (rms_torque_Nm >= torque_Nm * (1 - ROOM))
    return np.where(steady, torque_Nm, 0.0)


def _columns(application: Application) -> FloatArray:
    """Columns of a cycle in the order of `Phases`, without the sign, shape (9, phases)."""
    load, motion = application.loads or _UNLOADED, application.duty_cycle.motion
    radial, axial = load.radial_N or 0.0, load.axial_N or 0.0
    if motion is not None:
        own = [[one.radial_N, one.axial_N] for one in motion.moves]
        loads = np.array([[a if r is None else r for r, a in zip(one, (radial, axial), strict=True)] for one in own])
        figures = [getattr(motion.course, name) for name in OF_COURSE]
        return np.array([*figures[:3], *loads[motion.course.move].T, *figures[3:]])
    rows = [
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
        for phase in application.duty_cycle.load_phases
    ]
    return np.array(rows).T


OF_COURSE = (
    "torque_Nm",
    "speed_rpm",
    "duration_s",
    "peak_torque_Nm",
    "peak_speed_rpm",
    "rms_torque_Nm",
    "least_torque_Nm",
)
"""Figures of a motion's phases, in this order."""


@dataclass(frozen=True, eq=False)
class Duty:
    """Phases and inputs of N applications, and the figures of their duty cycles.

    Each figure has shape (N, 1), is NaN if not asked for, and is computed on first use.

    `courses` are the courses of the motions, and `stopped_loads` the loads of motions that a brake stops; both by the
    place of their application. `typed` are the phases with typed loads only.
    """

    typed: Phases
    inputs: InputArrays
    courses: Mapping[int, Course] = field(default_factory=dict)
    stopped_loads: Mapping[int, StoppedLoad] = field(default_factory=dict)

    @cached_property
    def phases(self) -> Phases:
        """Phases with all loads: the load of a pinion or pulley on the shaft is added to the typed loads."""
        if not self.has_shaft_drive:
            return self.typed
        radial, axial = self.shaft_load_of(self.shaft_force_N)
        return replace(self.typed, radial_N=self.typed.radial_N + radial, axial_N=self.typed.axial_N + axial)

    @cached_property
    def has_shaft_drive(self) -> bool:
        """True where a pinion or pulley loads the shaft of at least one axis."""
        return bool((self.inputs.shaft_drive != "").any())

    @cached_property
    def shaft_diameter_mm(self) -> FloatArray:
        """Pitch diameter of pinion or pulley in mm."""
        diameter = self.inputs["output_load.drive.diameter_mm"].copy()
        for place, course in self.courses.items():
            if self.inputs.shaft_drive[place, 0]:
                diameter[place] = 2000 * course.load.external_Nm
        return diameter

    @cached_property
    def shaft_force_N(self) -> FloatArray:
        """Tangential force F_t in N at pinion or pulley in each phase, shape (N, 1, phases); of phases 2 T / d."""
        force: FloatArray = 2000 * self.typed.peak_torque_Nm / self.shaft_diameter_mm[..., None]
        for place, course in self.courses.items():
            if self.inputs.shaft_drive[place, 0]:
                force[place, 0, : len(course.move)] = tangential_force(course)
        return force

    def shaft_load_of(self, force_N: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Radial and axial load in N of pinion or pulley at tangential forces, 0 without one; shape (N, 1, phases).

        A belt's load is that of its largest force at all times.
        """
        kind, inputs = self.inputs.shaft_drive[..., None], self.inputs
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
        return equations.average_output_speed(speed_rpm=n, duration_s=t, pause_s=self.inputs["duty_cycle.pause_s"])

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
        return equations.rms_torque(torque_Nm=T, duration_s=t, pause_s=self.inputs["duty_cycle.pause_s"])

    @cached_property
    def brakes(self) -> NDArray[np.bool_] | None:
        """True where a brake stops the axis, shape (N, 1); None without any brake."""
        has_brake = ~np.isnan(self.inputs["emergency_stop.brake.torque_Nm"])
        return has_brake if has_brake.any() else None

    @cached_property
    def typed_stop_torque_Nm(self) -> FloatArray:
        """Torque T_k of an emergency stop in Nm, NaN if not given."""
        return np.abs(self.inputs["emergency_stop.torque_Nm"])

    @cached_property
    def stop_speed_rpm(self) -> FloatArray:
        """Output speed in rpm at which the brake is told to stop the axis: as given, else the largest."""
        speed = self.inputs["emergency_stop.brake.speed_rpm"]
        return np.where(np.isnan(speed), self.maximum_output_speed_rpm, speed)

    @cached_property
    def stop_load(self) -> LoadTorques:
        """Torques T_d, T_v and T_o of the load in a stop: from its motion, else as given, else 0."""
        T_d = np.nan_to_num(self.inputs["emergency_stop.brake.load_torque_Nm"])
        opposing = self.inputs["emergency_stop.brake.opposing_torque_Nm"]
        T_v, T_o = T_d.copy(), np.where(np.isnan(opposing), T_d, opposing)
        for place, load in self.stopped_loads.items():
            T_d[place], T_v[place] = load.pulling_at_gear_Nm, load.driving_at_gear_Nm
            T_o[place] = load.opposing_at_gear_Nm(self.stop_speed_rpm.item(place))
        return LoadTorques(T_d, T_v, T_o)

    @cached_property
    def torque_both_ways(self) -> NDArray[np.bool_]:
        """True where the torque counts in both directions: as asked, else where no sign forbids it."""
        reverses = self.inputs.load_reverses
        return np.where(np.isnan(reverses), self._are_unsigned, reverses == 1)

    @cached_property
    def _are_unsigned(self) -> NDArray[np.bool_]:
        """True where no torque is negative and there is no motion, since the handbook enters magnitudes; shape
        (N, 1).
        """
        unsigned: NDArray[np.bool_] = np.array((self.phases.torque_sign >= 0).all(axis=-1))
        unsigned[list(self.courses)] = False
        return unsigned

    @cached_property
    def rest_friction_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Torque in Nm at the gear that dry friction may hold in each phase, shape (N, 1, phases), and in the pause.

        0 where the axis moves. For a motion from its mechanism, else as given.
        """
        paused = self.inputs["requirements.rest_friction_Nm"].copy()
        phases = np.where(self.phases.speed_rpm == 0, paused[..., None], 0.0)
        for place, course in self.courses.items():
            count = len(course.move)
            at_rest = course.load.rest_friction_Nm(course.peak_torque_Nm)
            phases[place, 0, :count] = np.where(course.speed_rpm == 0, at_rest, 0.0)
            paused[place] = course.load.rest_friction_Nm(0.0)
        return phases, paused

    @cached_property
    def torque_range_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest signed torque T_lo and T_hi in Nm, between which the gear winds up.

        Over the whole cycle or its phases at rest, plus dry friction there; a pause only has that friction.
        """
        phases, at_rest = self.phases, self.inputs.position_error_at == "rest"
        friction, of_pause = self.rest_friction_Nm
        counts = (phases.duration_s > 0) & (~at_rest[..., None] | (phases.speed_rpm == 0))  # a cycle's padding doesn't
        lasts = self.inputs["duty_cycle.pause_s"] > 0
        ends = self._signed_torques_Nm
        lowest = np.where(counts, np.minimum(*ends) - friction, np.inf).min(axis=-1)
        highest = np.where(counts, np.maximum(*ends) + friction, -np.inf).max(axis=-1)
        lowest = np.where(lasts, np.minimum(lowest, -of_pause), lowest)
        highest = np.where(lasts, np.maximum(highest, of_pause), highest)
        both, largest = self.torque_both_ways, np.maximum(-lowest, highest)
        return np.where(both, -largest, lowest), np.where(both, largest, highest)

    @property
    def _signed_torques_Nm(self) -> tuple[FloatArray, FloatArray]:
        """Ends of the torque range in each phase, without friction at rest, shape (N, 1, phases).

        A torque with a mean of 0 has its peak in both directions, unless no torque reverses.
        """
        phases, one_way = self.phases, (self.inputs.load_reverses == 0) & self._are_unsigned
        sign = np.where(one_way[..., None] & (phases.torque_sign == 0), 1.0, phases.torque_sign)
        peak, least = phases.peak_torque_Nm, phases.least_torque_Nm
        return np.where(sign == 0, -peak, sign * least), np.where(sign == 0, peak, sign * peak)

    @cached_property
    def required_bearing_life_L50_h(self) -> FloatArray:
        """Life asked of the output bearing, as L50 in hours."""
        return bearing.required_L50(life_h=self.inputs["output_load.life_h"], basis=self.inputs.life_basis)

    @cached_property
    def load_inertia_kgm2(self) -> FloatArray:
        """Inertia J_L of the load at the output in kg m²: the motion's own, else as given."""
        inertia = self.inputs["requirements.load_inertia_kgm2"].copy()
        for place, course in self.courses.items():
            inertia[place] = course.load_inertia_kgm2
        return inertia

    def with_motors(self, figures: Mapping[str, FloatArray], points: Sequence[Sequence[CurvePoint] | None]) -> "Duty":
        """The duty of one application with many motors: their figures by name, shape (motors, 1), NaN if unknown, and
        the points of their torque curves.

        Figures that depend on the motor then have one row per motor; all others have one row and broadcast.
        """
        numbers = {**self.inputs.numbers, **{f"requirements.motor.{name}": column for name, column in figures.items()}}
        curves, numbers[CURVE] = curves_of(points)
        return replace(self, inputs=replace(self.inputs, numbers=numbers, motor_curves=curves))

    @classmethod
    def of(cls, applications: Sequence[Application]) -> "Duty":
        """Duty of applications, in their order."""
        motions = {place: motion for place, one in enumerate(applications) if (motion := one.duty_cycle.motion)}
        braked = [stop is not None and stop.brake is not None for stop in (one.emergency_stop for one in applications)]
        courses = {place: motion.course for place, motion in motions.items()}
        stopped = {place: motion.stopped_load for place, motion in motions.items() if braked[place]}
        return cls(Phases.of(applications), InputArrays.of(applications), courses, stopped)


def unasked_shaft_load_N(application: Application) -> float | None:
    """Largest radial load in N of a motion's pinion or pulley that is neither counted nor typed; None without one."""
    load, motion = application.output_load or _UNLOADED, application.duty_cycle.motion
    if motion is None or motion.wheel is None or application.shaft_drive:
        return None
    if load.radial_N is not None or any(move.radial_N is not None for move in motion.moves):
        return None
    counted = application.model_copy(update={"output_load": load.model_copy(update={"from_motion": True})})
    return Duty.of([counted]).shaft_radial_N.item()
