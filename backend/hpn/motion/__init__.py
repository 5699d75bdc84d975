"""Motion of a mechanism: what a person says of mechanism and moves, and the load phases that come out."""

from hpn.motion.course import Course
from hpn.motion.motion import MAXIMUM_MOVES, LinearMotion, Motion, RotaryMotion
from hpn.motion.motor import peak_torque, rms_torque

__all__ = ["MAXIMUM_MOVES", "Course", "LinearMotion", "Motion", "RotaryMotion", "peak_torque", "rms_torque"]
