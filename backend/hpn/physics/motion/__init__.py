"""Motion of a mechanism: the user's mechanism and moves, and the resulting load phases."""

from hpn.physics.motion.course import Course
from hpn.physics.motion.curve import DriveTrains, judged_along
from hpn.physics.motion.motor import motor_torques, square_torque
from hpn.physics.motion.stopped import StoppedLoad
from hpn.physics.motion.trace import Trace, motor_trace, peak_instant, trace_of
from hpn.physics.motion.traction import tangential_force

__all__ = [
    "Course",
    "DriveTrains",
    "StoppedLoad",
    "Trace",
    "judged_along",
    "motor_torques",
    "motor_trace",
    "peak_instant",
    "square_torque",
    "tangential_force",
    "trace_of",
]
