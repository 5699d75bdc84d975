"""Loads on a gear's shaft from the pinion or pulley on it, computed from the tangential force at the pitch circle."""

import numpy as np

from hpn.physics.equations import FloatArray

PRESSURE_ANGLE_DEG = 20.0
"""Normal pressure angle of the teeth of rack and pinion."""


def rack_load(*, force_N: FloatArray, helix_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Radial load F_t √(1 + (tan 20° / cos β)²) and axial load F_t tan β in N of a pinion; shapes broadcast."""
    helix = np.radians(helix_deg)
    separating = np.tan(np.radians(PRESSURE_ANGLE_DEG)) / np.cos(helix)
    return force_N * np.sqrt(1 + np.square(separating)), force_N * np.tan(helix)


def belt_load(*, largest_force_N: FloatArray, tension_factor: FloatArray) -> FloatArray:
    """Radial load k F_t in N of a pulley, at all times: the belt is tensioned for the largest tangential force."""
    load: FloatArray = tension_factor * largest_force_N
    return load
