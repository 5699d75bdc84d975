"""Tangential force at pinion or pulley along a motion."""

import numpy as np

from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course


def tangential_force(course: Course) -> FloatArray:
    """Tangential force in N in each phase, shape (phases,), where pinion or pulley sit on the gear's shaft.

    The larger of 2 T / d at the gear's peak torque and the largest force at rack or belt, which excludes the wheel's
    own inertia and friction: in a ramp down the load drives, and the gear bears less than the rack. Every extreme of
    the force is at an end of a piece, since only the acceleration changes along one.
    """
    load, p = course.load, course.pieces
    moved, held = load.inertia_kgm2 - load.own_inertia_kgm2, p.held_Nm - load.own_friction_Nm * p.sign
    ends = [np.abs(moved * p.acceleration_at(t) * np.abs(p.sign) + held) for t in (p.start_s, p.end_s)]
    largest = course.peak_torque_Nm.copy()
    np.maximum.at(largest, course.phase, np.maximum(*ends))
    force: FloatArray = largest / load.external_Nm
    return force
