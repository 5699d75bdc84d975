"""Motion of a mechanism: what a person says of mechanism and moves, and the load phases that come out."""

from hpn.motion.course import Course
from hpn.motion.motion import MAXIMUM_MOVES, LinearMotion, Motion, RotaryMotion
from hpn.motion.motor import motor_torques, square_torque
from hpn.motion.trace import Instant, Trace, motor_trace, peak_instant, trace_of

__all__ = [
    "MAXIMUM_MOVES",
    "Course",
    "Instant",
    "LinearMotion",
    "Motion",
    "RotaryMotion",
    "Trace",
    "motor_torques",
    "motor_trace",
    "peak_instant",
    "square_torque",
    "trace_of",
]
