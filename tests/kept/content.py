"""Contents of a database of a version: applications of every kind that it may know, few gears in each answer."""

from typing import Any

from tests.build import LIFTING, TURNING, Json, cycle, phase, worked_example

FEW: Json = {"sizes": ["14A", "20A", "32A", "40A"], "ratios": [5]}
"""Requirement that leaves four gears: one that fails, two that suit and one that isn’t rated in most answers."""

MOTOR = {"inertia_kgm2": 1e-4, "rated_speed_rpm": 3000, "peak_torque_Nm": 20, "rated_torque_Nm": 8}
LOADS = {"radial_N": 500, "axial_N": 200, "load_coefficient": 1.2}
BRAKE = {"torque_Nm": 8, "rise_time_s": 0.005, "reaction_time_s": 0.02, "speed_rpm": 250}
LABELS = {"reference": "axis-7", "author": "M. Muster", "revision": "B"}


def example(**parts: Any) -> Json:
    """The worked example on a few gears."""
    return worked_example(**{"requirements": FEW, **parts})


APPLICATIONS: dict[str, Json] = {
    "example": example(),
    "loads": example(output_load=LOADS | {"model": "iso281", "life_basis": "L10"}),
    "everything": cycle(
        phase(40, 250, 0.3, radial_N=900, axial_N=300),
        phase(32, 500, 3.0),
        phase(-20, 250, 0.4, radial_N=700),
        pause_s=4.0,
        emergency_stop={"torque_Nm": 200, "count": 1000},
        output_load=LOADS,
        requirements={
            **FEW,
            "life_h": 20000,
            "backlash_arcmin": 7,
            "torsional_stiffness_Nm_per_rad": 5000,
            "weight_kg": 5,
            "length_mm": 200,
            "ambient_temperature_degC": 25,
            "utilisation": 0.9,
            "efficiency": 0.95,
            "motor": {"maximum_speed_rpm": 4000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
        },
        application_area="medical",
        rank_by="life",
    ),
    "turning": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {**FEW, "motor": MOTOR}},
    "unnamed moves": {
        "duty_cycle": {
            "motion": TURNING | {"moves": [{k: v for k, v in m.items() if k != "name"} for m in TURNING["moves"]]}
        },
        "output_load": LOADS,
        "requirements": {**FEW, "motor": MOTOR | {"inertia_ratio": 50}},
    },
    "lifting": {"duty_cycle": {"motion": LIFTING}, "requirements": FEW, "rank_by": "motor_torque"},
    "varying": cycle(
        phase(40, 250, 1, peak_torque_Nm=60, peak_speed_rpm=400, rms_torque_Nm=45, radial_N=300),
        phase(-20, 100, 2),
        requirements=FEW,
    ),
    "brake": example(
        emergency_stop={"brake": BRAKE, "count": 100},
        output_load=LOADS | {"radial_position_mm": 40, "axial_radius_mm": 10, "shaft_centre_mm": 30},
        requirements={
            **FEW,
            "motor": MOTOR,
            "load_inertia_kgm2": 0.2,
            "natural_frequency_Hz": 5,
            "position_error_arcmin": 20,
            "load_reverses": True,
        },
    ),
    "named phases": cycle(
        phase(40, 250) | {"name": "lift"},
        phase(-10, 300),
        requirements={**FEW, "position_error_mm": 2, "position_radius_mm": 250},
    ),
    "nothing fits": cycle(phase(900, 900), emergency_stop={"torque_Nm": 5000, "count": 5}, requirements=FEW),
    "not rated": cycle(phase(400, 90), requirements={"sizes": ["40A"], "ratios": [5]}),
    "deleted": example(),
    "renamed": example(),
}
"""Applications by title; a version saves those that it knows."""

ORDERED = {"everything": "HPN-20A-5-J6", "example": "HPN-32A-5"}
DELETED, RENAMED = "deleted", "renamed"

SELECTIONS: dict[str, Json] = {
    name: {"application": application, "title": name}
    | (LABELS if name in ORDERED else {})
    | ({"ordering_code": ORDERED[name]} if name in ORDERED else {})
    for name, application in APPLICATIONS.items()
}
"""Bodies that save them, the ordering code of two with a gear that is not the first."""

PAGES: dict[str, Json] = {"by the page": example(output_load=LOADS)}
"""Application that the form of the page saves."""

HUB = {
    "axis": "hub",
    "torque_Nm": [40, 20],
    "speed_rpm": [250, 100],
    "duration_s": [0.5, 3],
    "requirements.life_h": 2e4,
}
BELT = {"axis": "belt", "torque_Nm": [9000], "speed_rpm": [100], "duration_s": [0.5]}
FLEETS: dict[str, list[Json]] = {"line 4": [HUB, BELT, HUB | {"axis": "grip", "speed_rpm": [1]}]}
"""Axes by the title under which the fleet is saved."""
