"""Motion of a mechanism: what a person says of mechanism and moves, and the load phases that come out."""

from hpn.motion.course import Course
from hpn.motion.motion import MAXIMUM_MOVES, LinearMotion, Motion, RotaryMotion

__all__ = ["MAXIMUM_MOVES", "Course", "LinearMotion", "Motion", "RotaryMotion"]
