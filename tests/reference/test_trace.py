"""Motions over time as they are drawn, against mpmath: every point lies on the curve, and no peak or kink is missed."""

import json
import math
from functools import cache

import numpy as np
import pytest
from mpmath import mp, mpf

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.physics.motion import Course, Trace, motor_trace, trace_of
from tests.build import Json, answer, candidate
from tests.reference import motion as reference
from tests.reference.test_motion import CONTRACT, PENDULUM, SCREW, VISCOUS
from tests.reference.test_motor import MOTOR_INERTIA, at_motor

CLOSE = 1e-9
MOTIONS = pytest.mark.parametrize("motion", [CONTRACT, PENDULUM, SCREW, VISCOUS])


def course_of(motion: Json) -> Course:
    application = Application.model_validate({"duty_cycle": {"motion": motion}}).duty_cycle.motion
    assert application is not None
    return application.course


def stretches(motion: Json) -> list[reference.Stretch]:
    return _stretches(json.dumps(motion))


@cache
def _stretches(motion: str) -> list[reference.Stretch]:
    return reference.stretches(json.loads(motion))


def inside(trace: Trace, motion: Json) -> list[tuple[reference.Stretch, tuple[int, int], mpf]]:
    """Two points of every piece with the stretch of the reference that it is part of, and the instant in the move.

    At the ends of pieces the reference may stand on the other side of a jump.
    """
    result, begun = [], 0.0
    for place, phase in enumerate(trace.phase):
        one = stretches(motion)[phase]
        if place and one.move != stretches(motion)[trace.phase[place - 1]].move:
            begun = trace.time_s.item(place, 0)
        result += [(one, (place, k), mpf(trace.time_s.item(place, k) - begun)) for k in (3, 10)]
    return result


@MOTIONS
def test_points_of_a_trace_are_on_the_curve(motion: Json) -> None:
    trace = trace_of(course_of(motion))
    curves = (trace.speed_rpm, trace.acceleration_rad_per_s2, trace.torque_Nm)

    for one, at, t in inside(trace, motion):
        expected = (one.speed(t) * 30 / mp.pi, one.acceleration(t), one.torque(t))
        for curve, value in zip(curves, expected, strict=True):
            assert math.isclose(curve[at], value, abs_tol=CLOSE * np.abs(curve).max())


@MOTIONS
def test_the_angle_of_a_trace_is_the_speed_summed_up_and_ends_where_the_moves_do(motion: Json) -> None:
    trace = trace_of(course_of(motion))
    turned = [float(one.integral(one.speed)) for one in stretches(motion)]

    for phase, total in enumerate(np.cumsum(turned)):
        last = np.flatnonzero(trace.phase == phase)[-1]
        assert math.isclose(trace.angle_rad[last, -1], total, abs_tol=CLOSE * max(map(abs, turned)))
    assert math.isclose(
        trace.time_s[-1, -1], sum(float(one.end - one.start) for one in stretches(motion)), rel_tol=CLOSE
    )


@MOTIONS
def test_peaks_of_torque_and_speed_are_points_of_the_trace(motion: Json) -> None:
    course = course_of(motion)
    trace = trace_of(course)

    for phase in range(len(course.move)):  # whose figures are compared with mpmath elsewhere
        own = trace.phase == phase
        assert math.isclose(np.abs(trace.torque_Nm[own]).max(), course.peak_torque_Nm[phase], rel_tol=1e-12)
        assert math.isclose(np.abs(trace.speed_rpm[own]).max(), course.peak_speed_rpm[phase], rel_tol=1e-12)


@MOTIONS
@pytest.mark.parametrize("ratio", [4, 15])
def test_the_motors_trace_is_on_its_curve_and_holds_the_peak_that_the_check_goes_by(
    motion: Json, ratio: int, catalogue: Catalogue
) -> None:
    trace, torque = motor_trace(
        course_of(motion), ratio=ratio, efficiency=np.array([0.85]), motor_inertia_kgm2=MOTOR_INERTIA
    )
    document = {"efficiency": 0.85, "motor": {"inertia_kgm2": MOTOR_INERTIA}, "sizes": ["20A"], "ratios": [ratio]}
    reply = answer({"duty_cycle": {"motion": motion}, "requirements": document}, catalogue)

    peak = candidate(reply, f"HPN-20A-{ratio}")["motor_peak_torque_Nm"]
    assert math.isclose(np.abs(torque).max(), peak, rel_tol=CLOSE)
    for one, at, t in inside(trace, motion):
        assert math.isclose(torque[at], at_motor(one, ratio, 0.85)(t), abs_tol=CLOSE * peak)


def test_many_pieces_keep_their_ends() -> None:
    moves = [{"profile": "s_curve", "angle_deg": 90 * (-1) ** k, "time_s": 1} for k in range(1000)]
    course = course_of({"mechanism": {"type": "rotary", "inertia_kgm2": 1}, "moves": moves})
    trace = trace_of(course)

    assert trace.time_s.shape == (len(course.pieces), 2)
    assert math.isclose(np.abs(trace.torque_Nm).max(), course.peak_torque_Nm.max(), rel_tol=1e-12)
