"""Motion of a mechanism: what a person says of mechanism and moves, and the load phases that come out."""

from hpn.motion.course import Course
from hpn.motion.motion import MAXIMUM_MOVES, LinearMotion, Motion, RotaryMotion
from hpn.motion.motor import Instant, peak_instant, peak_torque, rms_torque, square_torque

__all__ = [
    "MAXIMUM_MOVES",
    "Course",
    "Instant",
    "LinearMotion",
    "Motion",
    "RotaryMotion",
    "peak_instant",
    "peak_torque",
    "rms_torque",
    "square_torque",
]
