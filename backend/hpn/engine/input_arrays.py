"""Inputs of applications as arrays, except those of phases."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application, CurvePoint
from hpn.application.input_fields import NUMBERS
from hpn.application.shaft_centre import by_size, of_others
from hpn.physics.equations import FloatArray
from hpn.physics.torque_curve import TorqueCurve

TextArray = NDArray[np.str_]
CurveArray = NDArray[np.object_]
"""Torque curves of motors, None without one."""

CURVE = "requirements.motor.curve"
"""Path of a motor's torque curve; the number at this path is the curve's last speed in rpm."""


@dataclass(frozen=True)
class InputArrays:
    """Inputs of N applications besides their phases, each array of shape (N, 1).

    `numbers` holds every single number of the application model by its path with dots, such as `requirements.life_h`;
    NaN if not given. Without a load the conditions of a load are NaN as well. `load_reverses` is NaN, 0 or 1,
    `position_error_at` the word of the application. `motor_curves` are the torque curves of the motors; the number at
    the path of a curve is its last speed. `shaft_centres_mm` has the distances given for single sizes, by size; the
    number at its path is the distance for all other sizes.
    """

    numbers: Mapping[str, FloatArray]
    bearing_model: TextArray
    life_basis: TextArray
    rank_by: TextArray
    position_error_at: TextArray
    shaft_drive: TextArray
    motor_curves: CurveArray
    load_reverses: FloatArray
    shaft_centres_mm: Mapping[str, FloatArray] = field(default_factory=dict)

    @classmethod
    def of(cls, applications: Sequence[Application]) -> "InputArrays":
        """Inputs of applications, in their order."""
        table = np.array([_numbers(application) for application in applications], dtype=np.float64)
        loads = [application.loads for application in applications]
        motors = [application.requirements.motor for application in applications]
        curves, last = curves_of([motor.curve if motor else None for motor in motors])
        numbers = {".".join(path): table[:, place, None] for place, path in enumerate(NUMBERS)}
        return cls(
            {**numbers, CURVE: last},
            np.array([[load.model if load else ""] for load in loads]),
            np.array([[load.life_basis if load else ""] for load in loads]),
            np.array([[application.rank_by] for application in applications]),
            np.array([[application.requirements.position_error_at] for application in applications]),
            np.array([[application.shaft_drive] for application in applications]),
            curves,
            np.array([[application.requirements.load_reverses] for application in applications], dtype=np.float64),
            _by_size([by_size(load.shaft_centre_mm) if load else {} for load in loads]),
        )

    def __getitem__(self, path: str) -> FloatArray:
        return self.numbers[path]

    def shaft_centre_mm(self, sizes: Sequence[str]) -> FloatArray:
        """Distance x_c in mm given for each size: its own, else the distance for all others.

        Shape (N, sizes); (N, 1) if no size has its own.
        """
        others = self[SHAFT_CENTRE]
        if self.shaft_centres_mm.keys().isdisjoint(sizes):
            return others
        columns = [self.shaft_centres_mm.get(size, others) for size in sizes]
        return np.concatenate([np.where(np.isnan(column), others, column) for column in columns], axis=1)


SHAFT_CENTRE = "output_load.shaft_centre_mm"


def _by_size(tables: Sequence[Mapping[str, float]]) -> Mapping[str, FloatArray]:
    """Numbers of N applications by size, each of shape (N, 1): NaN where an application has none for the size."""
    sizes = dict.fromkeys(size for one in tables for size in one)
    return {size: np.array([[one.get(size, np.nan)] for one in tables]) for size in sizes}


def _numbers(application: Application) -> list[float | None]:
    """Numbers of one application in the order of NUMBERS; None if not given."""
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


def curves_of(points: Sequence[Sequence[CurvePoint] | None]) -> tuple[CurveArray, FloatArray]:
    """Torque curves of motors and their last speeds in rpm, shape (N, 1) each: None and NaN without one."""
    curves, last = np.full((len(points), 1), None, np.object_), np.full((len(points), 1), np.nan)
    for place, own in enumerate(points):
        if own:
            columns = np.array([(one.speed_rpm, one.continuous_Nm, one.peak_Nm) for one in own], dtype=np.float64).T
            curves[place, 0], last[place] = TorqueCurve(*columns), own[-1].speed_rpm
    return curves, last
