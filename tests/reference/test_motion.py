"""The phases of a motion against mpmath, and against closed forms worked out by hand."""

import math
from typing import Any

import pytest

from hpn.application import Application
from tests.build import Json
from tests.reference import motion as reference

# Quadrature and zeros are good to 1e-10; what is compared carries some 1e-14 of rounding beside it.
CLOSE = 1e-9
FIELDS = ("torque_Nm", "speed_rpm", "duration_s", "peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")

CONTRACT: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.8,
        "gravity_mass_kg": 12,
        "gravity_radius_mm": 250,
        "friction_torque_Nm": 1.5,
        "viscous_friction_Nm_per_rpm": 0.01,
        "efficiency": 0.9,
        "ratio": 1,
    },
    "start_deg": 0,
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 90, "time_s": 0.8, "acceleration_deg_per_s2": 900},
        {"profile": "dwell", "time_s": 0.4, "external_torque_Nm": 30},
        {"profile": "s_curve", "angle_deg": -90, "time_s": 1.0, "speed_rpm": 25, "jerk_share": 0.5},
        {"profile": "modified_sine", "angle_deg": 45, "time_s": 0.5},
    ],
}

PENDULUM: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.3,
        "gravity_mass_kg": 5,
        "gravity_radius_mm": 200,
        "efficiency": 0.8,
        "ratio": 3,
    },
    "start_deg": 90,
    "moves": [
        {"profile": "s_curve", "angle_deg": 400, "time_s": 3.0},
        {"profile": "modified_sine", "angle_deg": -400, "time_s": 1.5},
    ],
}

SCREW: Json = {
    "mechanism": {
        "type": "ball_screw",
        "mass_kg": 200,
        "lead_mm": 10,
        "incline_deg": 30,
        "friction_coefficient": 0.1,
        "friction_force_N": 24.5,
        "friction_torque_Nm": 0.3,
        "counterweight_kg": 60,
        "inertia_kgm2": 0.01,
        "efficiency": 0.9,
        "ratio": 2,
    },
    "moves": [
        {
            "profile": "s_curve",
            "distance_mm": 300,
            "time_s": 0.8,
            "acceleration_mm_per_s2": 2600,
            "external_force_N": 50,
        },
        {"profile": "trapezoidal", "distance_mm": -300, "time_s": 0.8},
        {"profile": "s_curve", "distance_mm": 5, "speed_mm_per_s": 900, "acceleration_mm_per_s2": 2600},
    ],
}

VISCOUS: Json = {
    "mechanism": {"type": "rotary", "inertia_kgm2": 0.02, "viscous_friction_Nm_per_rpm": 0.2},
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 180, "time_s": 0.8},
        {"profile": "s_curve", "angle_deg": -180, "time_s": 0.8, "jerk_share": 1},
        {"profile": "triangular", "angle_deg": 90, "acceleration_deg_per_s2": 2000},
        {"profile": "modified_sine", "angle_deg": -180, "time_s": 0.8},
    ],
}

BELT: Json = {
    "mechanism": {"type": "belt", "mass_kg": 30, "diameter_mm": 80, "incline_deg": -90, "inertia_kgm2": 0.004},
    "moves": [
        {"profile": "modified_sine", "distance_mm": -900, "time_s": 0.9},
        {"profile": "triangular", "distance_mm": 900, "speed_mm_per_s": 2500, "external_force_N": -400},
    ],
}

UNEQUAL: Json = {
    "mechanism": {"type": "rotary", "inertia_kgm2": 0.5, "friction_torque_Nm": 2, "efficiency": 0.9},
    "moves": [
        {"angle_deg": 90, "time_s": 0.8, "acceleration_time_s": 0.1, "deceleration_time_s": 0.4},
        {"angle_deg": -120, "time_s": 1.0, "deceleration_time_s": 0.3},
        {"angle_deg": 100, "time_s": 0.8, "acceleration_deg_per_s2": 2000, "deceleration_deg_per_s2": 600},
        {"angle_deg": -100, "time_s": 0.8, "acceleration_time_s": 0.2, "deceleration_deg_per_s2": 700},
        {"angle_deg": 80, "speed_rpm": 25, "acceleration_time_s": 0.2, "deceleration_time_s": 0.5},
        {"angle_deg": 30, "speed_rpm": 60, "acceleration_time_s": 0.2, "deceleration_deg_per_s2": 400},
        {"angle_deg": -80, "speed_rpm": 25, "deceleration_deg_per_s2": 900},
        {"angle_deg": 90, "time_s": 1.0, "speed_rpm": 20, "acceleration_deg_per_s2": 600},
        {"angle_deg": -90, "time_s": 1.0, "speed_rpm": 20, "deceleration_time_s": 0.15},
    ],
}


JERKED: Json = {
    "mechanism": {
        "type": "rack_and_pinion",
        "mass_kg": 40,
        "diameter_mm": 60,
        "incline_deg": -90,
        "counterweight_kg": 55,
        "friction_force_N": 12,
        "friction_torque_Nm": 0.5,
        "efficiency": 0.9,
    },
    "moves": [
        {"distance_mm": 500, "time_s": 0.8},
        {"distance_mm": -500, "time_s": 0.8, "acceleration_mm_per_s2": 5500},
        {"distance_mm": 500, "time_s": 0.8, "speed_mm_per_s": 900},
        {"distance_mm": 500, "speed_mm_per_s": 900, "acceleration_mm_per_s2": 5000},
        {"distance_mm": 60, "speed_mm_per_s": 900, "acceleration_mm_per_s2": 4000},
        {"distance_mm": -400, "time_s": 0.9, "acceleration_mm_per_s2": 7000, "deceleration_time_s": 0.3},
        {"distance_mm": 400, "time_s": 0.9, "speed_mm_per_s": 700, "deceleration_mm_per_s2": 4000},
        {"distance_mm": 400, "speed_mm_per_s": 700, "acceleration_time_s": 0.3, "deceleration_mm_per_s2": 4000},
    ],
}
JERKED = JERKED | {
    "moves": [{"profile": "s_curve", "jerk_mm_per_s3": 85_000 + 900 * k} | m for k, m in enumerate(JERKED["moves"])]
}


def phases_of(motion: Json) -> list[Any]:
    """Phases that the application model gives."""
    application = Application.model_validate({"duty_cycle": {"motion": motion}})
    return list(application.duty_cycle.load_phases)


def with_profile(motion: Json, profile: str) -> Json:
    return motion | {"moves": [{"profile": profile} | move for move in motion["moves"]]}


@pytest.mark.parametrize(
    "motion",
    [
        CONTRACT,
        PENDULUM,
        SCREW,
        VISCOUS,
        BELT,
        JERKED,
        with_profile(UNEQUAL, "trapezoidal"),
        with_profile(UNEQUAL, "s_curve"),
    ],
)
def test_phases_are_those_that_mpmath_integrates(motion: Json) -> None:
    expected, result = reference.phases(motion), phases_of(motion)

    assert len(result) == len(expected)
    for one, other in zip(expected, result, strict=True):
        for name in FIELDS:
            assert math.isclose(one[name], getattr(other, name), rel_tol=CLOSE, abs_tol=1e-12), (one, name)


def test_a_constant_torque_and_its_ramps_come_out_in_closed_form() -> None:
    """2 kgm² over 360° with ramps of 0.5 s and a run of 1 s, 3 Nm of friction.

    The peak speed is 360° over 1.5 s, 4π/3 rad/s or 40 rpm, the acceleration 8π/3 rad/s², so that 16π/3 Nm speed up.
    """
    motion = {
        "mechanism": {"type": "rotary", "inertia_kgm2": 2, "friction_torque_Nm": 3, "efficiency": 0.5, "ratio": 4},
        "moves": [{"profile": "trapezoidal", "angle_deg": -360, "time_s": 2, "speed_rpm": 40}],
    }
    ramp, run, brake = phases_of(motion)

    up, level, down = (16 * math.pi / 3 + 3) / 2, 3 / 2, (16 * math.pi / 3 - 3) / 8
    for phase, T, n, t in ((ramp, -up, -80, 0.5), (run, -level, -160, 1.0), (brake, down, -80, 0.5)):
        assert math.isclose(phase.torque_Nm, T, rel_tol=1e-14)
        assert math.isclose(phase.speed_rpm, n, rel_tol=1e-14)
        assert math.isclose(phase.duration_s, t, rel_tol=1e-14)
        assert (phase.peak_torque_Nm, phase.rms_torque_Nm) == (abs(phase.torque_Nm), abs(phase.torque_Nm))
        assert math.isclose(phase.peak_speed_rpm, 160, rel_tol=1e-14)


@pytest.mark.parametrize("known", [{"time_s": 2.0}, {"speed_mm_per_s": 1000}, {"acceleration_mm_per_s2": 1000}])
def test_a_triangle_is_the_same_by_time_speed_or_acceleration(known: Json) -> None:
    """1000 mm in 2 s: at most 1 m/s, 1 m/s²; 50 kg on a pinion of 100 mm and 0.05 kgm² make 50 · 0.05 + 0.05/0.05."""
    motion = {
        "mechanism": {"type": "rack_and_pinion", "mass_kg": 50, "diameter_mm": 100, "inertia_kgm2": 0.05},
        "moves": [{"profile": "triangular", "distance_mm": 1000, **known}],
    }
    ramp, brake = phases_of(motion)

    for phase, T in ((ramp, 3.5), (brake, -3.5)):
        assert math.isclose(phase.torque_Nm, T, rel_tol=1e-14)
        assert math.isclose(phase.duration_s, 1.0, rel_tol=1e-14)
        assert math.isclose(phase.peak_speed_rpm, 20 * 30 / math.pi, rel_tol=1e-14)
        assert math.isclose(phase.speed_rpm, 10 * 30 / math.pi, rel_tol=1e-14)


def test_a_viscous_ramp_has_the_mean_that_its_integral_has_in_closed_form() -> None:
    """Without friction but b n the torque of a ramp rises by a line: ∫ t (T_0 + c t)^(10/3) dt by parts."""
    motion = {
        "mechanism": {"type": "rotary", "inertia_kgm2": 0.5, "viscous_friction_Nm_per_rpm": 0.1},
        "moves": [{"profile": "trapezoidal", "angle_deg": 360, "time_s": 3, "speed_rpm": 30}],
    }
    ramp = phases_of(motion)[0]
    T_0, T_1 = 0.5 * math.pi, 0.5 * math.pi + 3  # 30 rpm in 1 s: π rad/s², and 3 Nm at 30 rpm

    def antiderivative(T: float) -> float:
        return float(T ** (16 / 3) / (16 / 3) - T_0 * T ** (13 / 3) / (13 / 3))

    mean = ((antiderivative(T_1) - antiderivative(T_0)) / 3**2 / 0.5) ** 0.3
    assert math.isclose(ramp.torque_Nm, mean, rel_tol=1e-12)
    assert math.isclose(ramp.peak_torque_Nm, T_1, rel_tol=1e-14)
    assert math.isclose(ramp.rms_torque_Nm, math.sqrt((T_1**3 - T_0**3) / 9), rel_tol=1e-13)


def test_a_modified_sine_has_the_peaks_of_its_table() -> None:
    """1 kgm² turns 1 rad in 1 s: c_v 1.760 and c_a 5.528, to their printed digits.

    C. N. Neklutin, Mechanisms and Cams for Automatic Machines, American Elsevier, 1969.
    """
    motion = {
        "mechanism": {"type": "rotary", "inertia_kgm2": 1},
        "moves": [{"profile": "modified_sine", "angle_deg": math.degrees(1), "time_s": 1}],
    }
    half, _ = phases_of(motion)

    assert round(half.peak_torque_Nm, 3) == 5.528
    assert round(half.peak_speed_rpm * math.pi / 30, 3) == 1.760


def test_a_dwell_holds_gravity_without_friction_and_efficiency() -> None:
    motion = {
        "mechanism": PENDULUM["mechanism"] | {"friction_torque_Nm": 7},
        "start_deg": 60,
        "moves": [
            {"profile": "dwell", "time_s": 2, "external_torque_Nm": -1, "radial_N": 9},
            {"profile": "trapezoidal", "angle_deg": 1, "time_s": 1},
        ],
    }
    value_held = phases_of(motion)[0]

    assert math.isclose(value_held.torque_Nm, (5 * 9.80665 * 0.2 * 0.5 - 1) / 3, rel_tol=1e-14)
    assert (value_held.speed_rpm, value_held.peak_speed_rpm, value_held.duration_s, value_held.radial_N) == (0, 0, 2, 9)
