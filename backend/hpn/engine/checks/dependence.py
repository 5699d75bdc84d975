"""Dependence of utilisations on inputs that several checks share, and the conditions under which it holds.

A share Σ w d / (Σ w + c) rises or falls with each weight w, whatever the others are; every other function here is
monotone in each input, or convex in it, and so is largest at one of its ends. Along a motion with fixed times and
speeds the torque at the gear is a convex function of mass, inertia, friction and external load, one at a time, at each
instant: losses bend it at 0, and only upwards. So its peak and the integrals of its powers are convex as well.
"""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, GearList
from hpn.engine.check import Case, Dependence
from hpn.engine.figures import phase_loads
from hpn.engine.motor_torques import torques_by_phase
from hpn.physics import stop
from hpn.physics.equations import FloatArray

BoolArray = NDArray[np.bool_]

AVERAGE_SPEED: Mapping[str, Dependence] = {
    "speed_rpm": "rising",
    "duration_s": "weight",
    "duty_cycle.pause_s": "falling",
    "motion": "ends",
}

STOP: Mapping[str, Dependence] = {
    "emergency_stop.torque_Nm": "rising",
    "emergency_stop.brake.torque_Nm": "ends",  # rising, but the smallest may not stop the load
    "emergency_stop.brake.load_torque_Nm": "rising",
    "emergency_stop.brake.opposing_torque_Nm": "rising",
    "emergency_stop.brake.dynamic_factor": "rising",
    "emergency_stop.brake.speed_rpm": "rising",
    "requirements.load_inertia_kgm2": "rising",
    "requirements.motor.inertia_kgm2": "falling",
    "requirements.efficiency": "falling",
    "motion": "ends",
    "counterweight": "unproven",
}

BEARING: Mapping[str, Dependence] = {
    "radial_N": "rising",
    "axial_N": "rising",
    "output_load.load_coefficient": "rising",
    "output_load.radial_position_mm": "rising",
    "output_load.axial_radius_mm": "rising",
    "output_load.shaft_centre_mm": "falling",
    "shaft_torque_Nm": "rising",
    "output_load.drive.diameter_mm": "falling",
    "output_load.rack_helix_deg": "rising",
    "output_load.belt_tension_factor": "rising",
    "motion": "ends",
}


def holds_load(case: Case) -> BoolArray:
    """True where T_k rises with the load's inertia: the brake holds the load, or an inertia is unknown."""
    stops = case.figures.stops
    if case.duty.brakes is None:
        return np.ones((1, 1), np.bool_)
    unknown = np.isnan(stops.brake.load_inertia_kgm2 + stops.brake.motor_at_output_kgm2)
    is_held: BoolArray = stop.is_held(brake=stops.brake, load=stops.load) | unknown | np.isnan(stops.brake.torque_Nm)
    return is_held


# --- Output bearing ---------------------------------------------------------------------------------------------------


def bearing_damages(case: Case) -> FloatArray:
    """Damage n (f_w P)³ of every phase on the bearing of every size, shape (N, sizes, phases).

    P is its lower bound where the shaft's centre is unknown.
    """
    gears = case.figures.gears
    P = phase_loads(case.duty, gears)
    if np.isnan(P).any():
        P = np.where(np.isnan(P), phase_loads(case.duty, gears, case.duty.phases.radial_N), P)
    damages: FloatArray = case.duty.phases.speed_rpm * (P * P * P)
    return damages


def has_rising_curves(case: Case) -> BoolArray:
    """True where the load on a bearing rises with each of its parts, which a size's printed curve does not
    guarantee.
    """
    if not (case.inputs.bearing_model == "digitised").any():
        return np.ones((1, 1), np.bool_)
    rising: BoolArray = (case.inputs.bearing_model != "digitised") | _rising_curves(case.figures.gears)
    return rising


@lru_cache(maxsize=256)
def _rising_curves(gears: GearList) -> BoolArray:
    """True for gears without a curve, or with a curve that never turns back to either axis, shape (G,)."""
    steps = [(np.diff(curve.radial_N), np.diff(curve.axial_N)) if curve else None for curve in gears.curves]
    return np.array([step is None or bool((step[0] <= 0).all() and (step[1] >= 0).all()) for step in steps])


# --- Motor ------------------------------------------------------------------------------------------------------------


def square_torques(case: Case) -> FloatArray:
    """Square of the RMS torque at the motor in each phase, shape (N, G or 1, phases)."""
    torque = torques_by_phase(case.duty, case.figures.gears, case.figures.catalogue)
    return torque * torque


def follows_torque(case: Case) -> BoolArray:
    """True where the motor's torque rises with the gear's: no part of it comes from the motor's own inertia."""
    stated = ~np.isnan(case.inputs["requirements.efficiency"])
    turns = np.zeros(stated.shape, np.bool_)
    for place in case.duty.courses:
        turns[place] = ~np.isnan(case.inputs["requirements.motor.inertia_kgm2"][place])
    return ~turns & (stated | _rising_torques(case.figures.gears, case.figures.catalogue))


def follows_rms(case: Case) -> BoolArray:
    """The same for the RMS, which along a motion must also be free of the gear's no-load torque and efficiency
    curve.
    """
    moved = np.zeros((len(case.inputs.rank_by), 1), np.bool_)
    moved[list(case.duty.courses)] = True
    stated, gears = ~np.isnan(case.inputs["requirements.efficiency"]), case.figures.gears
    curved = np.array([gear.designation in case.figures.catalogue.efficiency for gear in gears.rows])
    own = (gears.columns.no_load_torque_Nm > 0) | (curved & ~stated)
    return follows_torque(case) & ~(moved & own)


@lru_cache(maxsize=256)
def _rising_torques(gears: GearList, catalogue: Catalogue) -> BoolArray:
    """True for gears without an efficiency curve, or whose T / η rises with T along it, shape (G,)."""

    def rises(designation: str) -> bool:
        if designation not in catalogue.efficiency:
            return True
        torque, efficiency = (np.asarray(values, dtype=float) for values in catalogue.efficiency[designation])
        slope = np.diff(efficiency) / np.diff(torque)
        return bool((efficiency[:-1] - torque[:-1] * slope >= 0).all())

    return np.array([rises(gear.designation) for gear in gears.rows])
